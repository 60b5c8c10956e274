//! What a house is built of: areas from a few words, U-values from its age.
//!
//! **Equation** footprint `A_f = A_living/floors` with sides `1 : r`; walls `perimeter * floors * height`, without
//! the short sides where other buildings are attached, minus windows; gable roof of 40 deg over the footprint; cellar
//! below it. Insulation that was added: `1/U' = 1/U + d/lambda` on a share of the area.
//!
//! **Assumptions** U-values of single-family houses after the German building typology, rounded; the living area is
//! heated up to the top ceiling and down to the cellar ceiling, which have the insulation (roof and cellar themselves
//! have fixed constructions, see the constants). **Validity** houses of one to four floors; a house that is known
//! better states its own U-values. **Sources** `loga2015`; layout after the short procedure `loga2005`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// When a house was built.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
pub enum Construction {
    /// Until 1978.
    #[serde(rename = "until_1978")]
    Until1978,
    /// 1979 to 1994.
    #[serde(rename = "until_1994")]
    Until1994,
    /// 1995 to 2001.
    #[serde(rename = "until_2001")]
    Until2001,
    /// By the ordinance of 2002 and 2007.
    #[default]
    #[serde(rename = "enev_2007")]
    EnEv2007,
    /// By the ordinance of 2016, new.
    #[serde(rename = "enev_2016")]
    EnEv2016,
}

/// Heat transfer coefficients, W/(m2 K).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UValues {
    /// Outer walls, W/(m2 K).
    pub wall_w_m2_k: f64,
    /// Top ceiling below the roof space, W/(m2 K).
    pub ceiling_w_m2_k: f64,
    /// Floor above the cellar, W/(m2 K).
    pub floor_w_m2_k: f64,
    /// Windows, W/(m2 K).
    pub window_w_m2_k: f64,
}

impl Construction {
    /// Typical values.
    pub fn u_values(self) -> UValues {
        let (wall_w_m2_k, ceiling_w_m2_k, floor_w_m2_k, window_w_m2_k) = match self {
            Self::Until1978 => (1.2, 0.9, 1.0, 2.8),
            Self::Until1994 => (0.7, 0.45, 0.7, 2.8),
            Self::Until2001 => (0.35, 0.30, 0.45, 1.9),
            Self::EnEv2007 => (0.28, 0.22, 0.35, 1.4),
            Self::EnEv2016 => (0.20, 0.16, 0.25, 0.95),
        };
        UValues { wall_w_m2_k, ceiling_w_m2_k, floor_w_m2_k, window_w_m2_k }
    }
}

/// Shape of the footprint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layout {
    /// Sides 1 : 1.25.
    #[default]
    Compact,
    /// Sides 1 : 2.5.
    Elongated,
}

impl Layout {
    fn ratio(self) -> f64 {
        match self {
            Self::Compact => 1.25,
            Self::Elongated => 2.5,
        }
    }
}

/// Conductivity of insulation that is added, W/(m K).
pub const INSULATION_W_M_K: f64 = 0.035;
/// Pitch of the roof, rad.
const PITCH_RAD: f64 = 40.0 * PI / 180.0;
/// Dormers enlarge the roof by this.
const DORMERS: f64 = 1.3;
/// Depth of the cellar, m.
const CELLAR_M: f64 = 2.2;

/// Areas of a house, m2, and volumes, m3.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Areas {
    /// One floor, m2: also the top ceiling and the floor above the cellar.
    pub footprint_m2: f64,
    /// Outer walls without windows, m2.
    pub wall_m2: f64,
    /// Windows, m2.
    pub window_m2: f64,
    /// Long sides in the outer walls with windows: share of their windows and walls.
    pub long_share: f64,
    /// Roof with its gables, m2.
    pub roof_m2: f64,
    /// Floor and walls of the cellar, m2.
    pub cellar_m2: f64,
    /// Air of the living area, m3.
    pub living_m3: f64,
    /// Air of the roof space, m3.
    pub roof_m3: f64,
    /// Air of the cellar, m3.
    pub cellar_m3: f64,
}

/// Words that describe a house.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Heated area, m2.
    pub living_m2: f64,
    /// Floors.
    pub floors: f64,
    /// Clear height, m.
    pub height_m: f64,
    /// Shape of the footprint.
    pub layout: Layout,
    /// Buildings at its short sides: 0 to 2.
    pub attached: u32,
    /// Windows per heated area.
    pub window_share: f64,
    /// Whether the roof has dormers.
    pub dormers: bool,
}

impl Shape {
    /// The areas.
    pub fn areas(&self) -> Areas {
        let footprint_m2 = self.living_m2 / self.floors;
        let ratio = self.layout.ratio();
        let short_m = (footprint_m2 / ratio).sqrt();
        let long_m = ratio * short_m;
        let free_short_m = f64::from(2 - self.attached.min(2)) * short_m;
        let height_m = self.floors * self.height_m;
        let window_m2 = self.window_share * self.living_m2;
        let gross_m2 = (2.0 * long_m + free_short_m) * height_m;
        let ridge_m = 0.5 * short_m * PITCH_RAD.tan();
        let gables_m2 = 0.5 * ridge_m * free_short_m;
        let slopes_m2 = footprint_m2 / PITCH_RAD.cos();
        Areas {
            footprint_m2,
            wall_m2: gross_m2 - window_m2,
            window_m2,
            long_share: 2.0 * long_m / (2.0 * long_m + free_short_m),
            roof_m2: slopes_m2 * if self.dormers { DORMERS } else { 1.0 } + gables_m2,
            cellar_m2: footprint_m2 + 2.0 * (long_m + short_m) * CELLAR_M,
            living_m3: self.living_m2 * self.height_m,
            roof_m3: 0.5 * footprint_m2 * ridge_m,
            cellar_m3: footprint_m2 * CELLAR_M,
        }
    }
}

/// A U-value with insulation of a thickness on a share of the area, W/(m2 K).
pub fn insulated_w_m2_k(u_w_m2_k: f64, thickness_m: f64, share: f64) -> f64 {
    let covered = 1.0 / (1.0 / u_w_m2_k + thickness_m / INSULATION_W_M_K);
    share * covered + (1.0 - share) * u_w_m2_k
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_by_hand() {
        // 300 m2 on 2 floors: 150 m2, 10.954 m x 13.693 m; perimeter 49.295 m, walls 256.33 m2, windows 45 m2.
        let shape = Shape {
            living_m2: 300.0,
            floors: 2.0,
            height_m: 2.6,
            layout: Layout::Compact,
            attached: 0,
            window_share: 0.15,
            dormers: false,
        };
        let areas = shape.areas();
        assert!((areas.wall_m2 + areas.window_m2 - 256.334).abs() < 1e-3, "{areas:?}");
        assert!((areas.window_m2 - 45.0).abs() < 1e-12 && areas.living_m3 == 780.0);
        // Ridge 5.4772 m tan 40 deg = 4.5959 m; roof 150/cos 40 deg + 10.954 * 4.5959 = 195.81 + 50.345 m2.
        assert!((areas.roof_m2 - 246.156).abs() < 1e-2, "{areas:?}");
        // Two neighbours: the long sides stay, 2 * 13.693 * 5.2 = 142.41 m2.
        let row = Shape { attached: 2, ..shape }.areas();
        assert!((row.wall_m2 + row.window_m2 - 142.408).abs() < 1e-3 && row.long_share == 1.0);
        let dormers = Shape { dormers: true, ..shape }.areas();
        assert!(dormers.roof_m2 > areas.roof_m2);
    }

    #[test]
    fn insulation_by_hand() {
        // 1.2 W/(m2 K) below 12 cm: 1/(0.8333 + 3.4286) = 0.23464; on 60 % of the wall 0.62078.
        assert!((insulated_w_m2_k(1.2, 0.12, 1.0) - 0.234_637).abs() < 1e-6);
        assert!((insulated_w_m2_k(1.2, 0.12, 0.6) - 0.620_782).abs() < 1e-6);
        assert_eq!(insulated_w_m2_k(0.3, 0.0, 1.0), 0.3);
    }
}
