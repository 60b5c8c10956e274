//! Photovoltaics: peak power, temperature of the cells, losses of the system.
//!
//! **Equation** `P = P_peak G/1000 (1 + g (T_cell - 25 degC)) eta`, `T_cell = T_air + (NOCT - 20 degC)/800 G` with the
//! irradiance `G` on its plane ([`anergy_core::solar`]); at most the inverter's power.
//!
//! **Assumptions** one plane, no shadows; spectrum and angle of incidence are part of `eta`. **Validity** annual energy;
//! at low irradiance real modules lose a few percent more. **Numerics** closed form.
//!
//! **Sources** peak-power model and NOCT: `duffie2013`; values assumed (`docs/src/generators.md`).

use crate::phases;
use crate::thermal_unit::{
    Exchange, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, positive, share,
};
use anergy_core::medium::{Medium, ZERO_CELSIUS_K};
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use anergy_core::solar::{HorizontalIrradiance, Plane, PlaneIrradiance, Sky, SunPosition};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the sky is thought to shine on a plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SkyModel {
    /// Alike from everywhere.
    Isotropic,
    /// Brighter around the sun and along the horizon (Perez 1990).
    #[default]
    Perez,
}

impl SkyModel {
    pub(crate) fn sky(self) -> Sky {
        match self {
            Self::Isotropic => Sky::Isotropic,
            Self::Perez => Sky::Perez,
        }
    }
}

/// Inputs of a unit that stands in the weather, in their order: air, irradiances, sun.
pub(crate) fn weather_inputs(t_outdoor_k: f64) -> Vec<UnitInput> {
    const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    const POSITIVE: (f64, f64) = (0.0, f64::INFINITY);
    let input = |name, unit, initial, (min, max), follows| UnitInput {
        name,
        unit,
        initial,
        min,
        max,
        follows: Some(follows),
    };
    vec![
        input("t_outdoor_k", "k", t_outdoor_k, POSITIVE, "weather.t_outdoor_k"),
        input("global_w_m2", "w_m2", 0.0, POSITIVE, "weather.global_horizontal_w_m2"),
        input("beam_w_m2", "w_m2", 0.0, POSITIVE, "weather.beam_normal_w_m2"),
        input("diffuse_w_m2", "w_m2", 0.0, POSITIVE, "weather.diffuse_horizontal_w_m2"),
        input("sun_elevation_rad", "rad", 0.0, ANY, "weather.sun_elevation_rad"),
        input("sun_azimuth_rad", "rad", 0.0, ANY, "weather.sun_azimuth_rad"),
    ]
}

/// What a plane gets, from the inputs behind the first.
pub(crate) fn on_plane(plane: &Plane, sky: Sky, signals: &Signals<'_>) -> PlaneIrradiance {
    let horizontal = HorizontalIrradiance {
        global_w_m2: signals.get(1),
        beam_normal_w_m2: signals.get(2),
        diffuse_w_m2: signals.get(3),
    };
    let sun = SunPosition { elevation_rad: signals.get(4), azimuth_rad: signals.get(5) };
    plane.irradiance(sky, sun, horizontal)
}

/// Photovoltaics as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct PvParams {
    /// Power at 1000 W/m2 and cells of 25 degC, W.
    pub peak_w: f64,
    /// Tilt from the horizontal, rad.
    pub tilt_rad: f64,
    /// Where it looks, from south, west positive, rad.
    pub azimuth_rad: f64,
    /// Albedo of the ground before it.
    pub albedo: f64,
    /// How the sky shines.
    pub sky: SkyModel,
    /// Change of the power with the temperature of the cells, 1/K.
    pub power_slope: f64,
    /// Temperature of the cells at 800 W/m2 and air of 20 degC, K.
    pub noct_k: f64,
    /// Share of the power that cables, inverter, dirt and angles leave.
    pub system_efficiency: f64,
    /// Largest power of the inverter, W.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inverter_w: Option<f64>,
    /// Phase of the grid on which its inverter stands, 1 to 3; three phases alike without this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<u32>,
    /// Outdoor temperature while neither weather nor anything else drives it, K.
    pub t_outdoor_k: f64,
}

impl Default for PvParams {
    fn default() -> Self {
        Self {
            peak_w: 10_000.0,
            tilt_rad: 35.0_f64.to_radians(),
            azimuth_rad: 0.0,
            albedo: 0.2,
            sky: SkyModel::Perez,
            power_slope: -0.004,
            noct_k: 319.15,
            system_efficiency: 0.86,
            inverter_w: None,
            phase: None,
            t_outdoor_k: 283.15,
        }
    }
}

/// Photovoltaics ready to run. State: electricity so far, J.
#[derive(Debug, Clone, PartialEq)]
pub struct Pv {
    plane: Plane,
    params: PvParams,
    most_w: f64,
}

impl PvParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<Pv, UnitError> {
        positive("peak_w", self.peak_w)?;
        positive("noct_k", self.noct_k)?;
        positive("t_outdoor_k", self.t_outdoor_k)?;
        share("albedo", self.albedo)?;
        share("system_efficiency", self.system_efficiency)?;
        phases::check(self.phase)?;
        let most_w = positive("inverter_w", self.inverter_w.unwrap_or(f64::MAX))?;
        for (field, value) in [("tilt_rad", self.tilt_rad), ("azimuth_rad", self.azimuth_rad)] {
            if !value.is_finite() {
                let requirement = "must be finite";
                return Err(UnitError::OutOfRange { field, value, requirement });
            }
        }
        if !(-0.05..=0.0).contains(&self.power_slope) {
            let requirement = "must lie between -0.05 and 0 per kelvin";
            let value = self.power_slope;
            return Err(UnitError::OutOfRange { field: "power_slope", value, requirement });
        }
        let plane = Plane::new(self.tilt_rad, self.azimuth_rad, self.albedo);
        Ok(Pv { plane, params: self.clone(), most_w })
    }
}

impl Pv {
    /// Power and temperature of the cells at an irradiance on the plane.
    fn power_w(&self, irradiance_w_m2: f64, air_k: f64) -> (f64, f64) {
        let p = &self.params;
        let cell_k = air_k + (p.noct_k - ZERO_CELSIUS_K - 20.0) / 800.0 * irradiance_w_m2;
        let warm = 1.0 + p.power_slope * (cell_k - ZERO_CELSIUS_K - 25.0);
        let power_w = p.peak_w * irradiance_w_m2 / 1000.0 * warm.max(0.0) * p.system_efficiency;
        (power_w.min(self.most_w), cell_k)
    }
}

impl ThermalUnit for Pv {
    fn ports(&self) -> Vec<UnitPort> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        weather_inputs(self.params.t_outdoor_k)
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let own = [
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("generated_w", "W"),
            UnitOutput::new("irradiance_w_m2", "W m-2"),
            UnitOutput::new("t_cell_k", "K"),
            UnitOutput::new("generated_j", "J"),
        ];
        own.into_iter()
            .chain(self.params.phase.into_iter().flat_map(|_| phases::outputs()))
            .collect()
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0]
    }

    fn request(
        &self,
        _signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        _wanted: &mut [PortRequest],
    ) {
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        _ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let irradiance =
            on_plane(&self.plane, self.params.sky.sky(), signals).total_w_m2().max(0.0);
        let (power_w, cell_k) = self.power_w(irradiance, signals.get(0));
        state[0] += dt_s * power_w;
        let (own, phases) = out.split_at_mut(5);
        own.copy_from_slice(&[-power_w, power_w, irradiance, cell_k, state[0]]);
        phases::write(self.params.phase, -power_w, phases);
        Exchange { electric_w: -power_w, external_w: power_w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let unit = PvParams::default().build(&Medium::default()).unwrap();
        // 1000 W/m2 and cells of 25 degC: air of 25 - 26/800 * 1000 = -7.5 degC; 10 kW * 0.86
        let (power_w, cell_k) = unit.power_w(1000.0, 265.65);
        assert!((cell_k - 298.15).abs() < 1e-9 && (power_w - 8600.0).abs() < 1e-6);
        // 800 W/m2 at 20 degC: cells of 46 degC, 8 kW * (1 - 0.004 * 21) * 0.86 = 6302.1 W
        assert!((unit.power_w(800.0, 293.15).0 - 6302.08).abs() < 0.01);
        let small = PvParams { inverter_w: Some(5000.0), ..PvParams::default() };
        assert_eq!(small.build(&Medium::default()).unwrap().power_w(1000.0, 265.65).0, 5000.0);
        let wrong = PvParams { power_slope: -0.4, ..PvParams::default() };
        assert_eq!(wrong.build(&Medium::default()).unwrap_err().field(), Some("power_slope"));
    }

    #[test]
    fn the_sun_on_its_plane() {
        // The sun in the south, 55 deg up, meets a plane of 35 deg at a right angle: beam 900 W/m2, isotropic sky
        // 100 (1 + cos 35)/2 = 90.96, ground 0.2 * 837.24 * (1 - cos 35)/2 = 15.14.
        let params = PvParams { sky: SkyModel::Isotropic, ..PvParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        let global = 900.0 * 55.0_f64.to_radians().sin() + 100.0;
        let signals = [283.15, global, 900.0, 100.0, 55.0_f64.to_radians(), 0.0];
        let (mut state, mut out) = (unit.initial_state(0.0), [0.0; 5]);
        let exchange = unit.advance(3600.0, &Signals(&signals), &[], &mut state, &mut out);
        assert!((out[2] - 1006.10).abs() < 0.02, "{out:?}");
        assert!(exchange.electric_w < 0.0 && exchange.electric_w + exchange.external_w == 0.0);
        assert!((out[4] + 3600.0 * exchange.electric_w).abs() < 1e-6);
    }
}
