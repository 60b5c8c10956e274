//! `[ground]`: what surrounds the pipes.

use anergy_network::buried_pipe::Soil;
use anergy_network::ground::{Ground, Seasons};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[ground]`: what surrounds the pipes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GroundEntry {
    /// How its temperature runs.
    #[serde(default)]
    pub kind: GroundKind,
    /// Temperature, K, of constant ground; also the signal `ground.temperature_k`.
    #[serde(default = "twelve_degc")]
    pub temperature_k: f64,
    /// Mean temperature of the year, K; kusuda.
    #[serde(default = "munich_mean")]
    pub mean_k: f64,
    /// Amplitude of the surface temperature over the year, K; kusuda.
    #[serde(default = "munich_amplitude")]
    pub amplitude_k: f64,
    /// Day of the year on which the surface is coldest, with decimals, 0 is New Year; kusuda.
    #[serde(default = "munich_coldest")]
    pub coldest_day: f64,
    /// Thermal diffusivity, m2/s.
    #[serde(default = "diffusivity")]
    pub diffusivity_m2_s: f64,
    /// Thermal conductivity, W/(m K).
    #[serde(default = "soil_conductivity")]
    pub conductivity_w_m_k: f64,
    /// Resistance between the surface and what warms and cools it, m2 K/W.
    #[serde(default = "surface_resistance")]
    pub surface_resistance_m2_k_w: f64,
    /// Depth of the axes of pipes that do not give theirs, m; that of the signal `ground.temperature_k`.
    #[serde(default = "depth")]
    pub depth_m: f64,
}

/// How the temperature of the ground runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GroundKind {
    /// It is `temperature_k`, or what drives the signal `ground.temperature_k`.
    #[default]
    Constant,
    /// It follows the year, damped and delayed with depth, after Kusuda and Achenbach; needs `[run] start`.
    Kusuda,
}

impl GroundEntry {
    /// The fields that mean something for one kind only.
    pub(crate) const OF_KIND: &'static [(&'static str, GroundKind)] = &[
        ("temperature_k", GroundKind::Constant),
        ("mean_k", GroundKind::Kusuda),
        ("amplitude_k", GroundKind::Kusuda),
        ("coldest_day", GroundKind::Kusuda),
    ];

    /// Whether a field means something for its kind.
    pub(crate) fn has(&self, field: &str) -> bool {
        Self::OF_KIND.iter().all(|(of_kind, kind)| *of_kind != field || *kind == self.kind)
    }

    /// Where the default of a field comes from.
    pub(crate) fn source(field: &str) -> &'static str {
        match field {
            "surface_resistance_m2_k_w" => "en13941: 1/14.6 W/(m2 K)",
            "conductivity_w_m_k" => "moist soil (assumed; 1.0 to 2.5)",
            "diffusivity_m2_s" => "moist soil (assumed)",
            "mean_k" | "amplitude_k" | "coldest_day" => "Munich (assumed)",
            "depth_m" => "the ground model of the laboratory (zinsmeister2023)",
            "temperature_k" => "elizarov2021",
            _ => "the component's default",
        }
    }

    /// The soil and the depth of the pipes.
    pub(crate) fn ground(&self) -> Ground {
        Ground {
            soil: Soil {
                conductivity_w_m_k: self.conductivity_w_m_k,
                surface_resistance_m2_k_w: self.surface_resistance_m2_k_w,
            },
            diffusivity_m2_s: self.diffusivity_m2_s,
            depth_m: self.depth_m,
        }
    }

    /// How the temperature follows the year, where it does.
    pub(crate) fn seasons(&self) -> Option<Seasons> {
        (self.kind == GroundKind::Kusuda).then_some(Seasons {
            mean_k: self.mean_k,
            amplitude_k: self.amplitude_k,
            coldest_s: self.coldest_day * 86_400.0,
            diffusivity_m2_s: self.diffusivity_m2_s,
        })
    }

    /// The problems of its numbers: field, and what is wrong.
    pub(crate) fn problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = Vec::new();
        for (field, value) in [
            ("diffusivity_m2_s", self.diffusivity_m2_s),
            ("conductivity_w_m_k", self.conductivity_w_m_k),
            ("depth_m", self.depth_m),
        ] {
            if value <= 0.0 {
                problems.push((field, format!("{field} = {value} must be positive")));
            }
        }
        for (field, value) in [
            ("amplitude_k", self.amplitude_k),
            ("surface_resistance_m2_k_w", self.surface_resistance_m2_k_w),
        ] {
            if value < 0.0 {
                problems.push((field, format!("{field} = {value} must not be negative")));
            }
        }
        if !(0.0..=366.0).contains(&self.coldest_day) {
            let message = format!("coldest_day = {} is no day of the year", self.coldest_day);
            problems.push(("coldest_day", message));
        }
        problems
    }
}

fn twelve_degc() -> f64 {
    285.15
}

fn munich_mean() -> f64 {
    282.65
}

fn munich_amplitude() -> f64 {
    10.0
}

fn munich_coldest() -> f64 {
    35.0
}

fn diffusivity() -> f64 {
    Ground::default().diffusivity_m2_s
}

fn soil_conductivity() -> f64 {
    Soil::default().conductivity_w_m_k
}

fn surface_resistance() -> f64 {
    Soil::default().surface_resistance_m2_k_w
}

fn depth() -> f64 {
    Ground::default().depth_m
}
