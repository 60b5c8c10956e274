//! An electric load: a power that a schedule or series drives, or an electric car that is charged in the evening.
//!
//! **Equation** `P` is its signal; a car comes home every day at `t = t_0 + sigma z` with a normally distributed number
//! `z` of its seed and the date, and is charged with its power until the energy of the day is in it.
//!
//! **Assumptions** the same energy every day, charged before the next arrival. **Numerics** the car's number depends on
//! the date only: means over a step are exact. **Sources** power of a wall box; times assumed.

use crate::calendar::{DAY_S, Moment, normal};
use crate::phases;
use crate::thermal_unit::{
    Exchange, START_UNIX, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort, not_negative,
    positive,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An electric load as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ElectricLoadParams {
    /// Power while nothing drives it, W.
    pub power_w: f64,
    /// Phase of the grid on which it stands, 1 to 3; three phases alike without this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<u32>,
}

impl Default for ElectricLoadParams {
    fn default() -> Self {
        Self { power_w: 0.0, phase: None }
    }
}

/// An electric car at its wall box as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ElectricVehicleParams {
    /// Power while it charges, W.
    pub charging_w: f64,
    /// Phase of the grid on which it charges, 1 to 3; three phases alike without this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<u32>,
    /// Energy of a day, J.
    pub daily_j: f64,
    /// Mean time of day at which charging begins, s.
    pub arrival_s: f64,
    /// Standard deviation of that time, s.
    pub arrival_deviation_s: f64,
    /// Number that chooses the sequence of arrivals, with the name of the unit.
    pub seed: u64,
    /// Local clock over UTC, s.
    pub utc_offset_s: f64,
}

impl Default for ElectricVehicleParams {
    fn default() -> Self {
        Self {
            charging_w: 11_000.0,
            phase: None,
            daily_j: 8.0 * 3.6e6,
            arrival_s: 18.0 * 3600.0,
            arrival_deviation_s: 3600.0,
            seed: 1,
            utc_offset_s: 3600.0,
        }
    }
}

/// What an electric load draws. State: time since the start, s; electricity so far, J.
#[derive(Debug, Clone, PartialEq)]
pub enum ElectricLoad {
    /// What its signal says.
    Driven(ElectricLoadParams),
    /// What a car needs.
    Vehicle(ElectricVehicleParams),
}

impl ElectricLoadParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<ElectricLoad, UnitError> {
        not_negative("power_w", self.power_w)?;
        phases::check(self.phase)?;
        Ok(ElectricLoad::Driven(self.clone()))
    }
}

impl ElectricVehicleParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<ElectricLoad, UnitError> {
        positive("charging_w", self.charging_w)?;
        phases::check(self.phase)?;
        for (field, value) in [
            ("daily_j", self.daily_j),
            ("arrival_s", self.arrival_s),
            ("arrival_deviation_s", self.arrival_deviation_s),
        ] {
            not_negative(field, value)?;
        }
        let out_of_range =
            |field, value, requirement| Err(UnitError::OutOfRange { field, value, requirement });
        if self.arrival_s > DAY_S {
            return out_of_range("arrival_s", self.arrival_s, "must lie between 0 and 24 h");
        }
        if 4.0 * self.arrival_deviation_s > 0.5 * DAY_S {
            let requirement = "must not be above 3 h";
            return out_of_range("arrival_deviation_s", self.arrival_deviation_s, requirement);
        }
        if self.daily_j > 0.5 * DAY_S * self.charging_w {
            return out_of_range("daily_j", self.daily_j, "must be charged within 12 h");
        }
        if self.utc_offset_s.is_nan() || self.utc_offset_s.abs() > DAY_S {
            return out_of_range("utc_offset_s", self.utc_offset_s, "must lie within a day");
        }
        Ok(ElectricLoad::Vehicle(self.clone()))
    }

    /// Energy charged from the arrival of a day within a span of the run, J.
    fn energy_j(&self, start_unix_s: f64, from_s: f64, until_s: f64) -> f64 {
        let Moment { day, time_s } = Moment::after(start_unix_s, self.utc_offset_s, from_s);
        let length_s = self.daily_j / self.charging_w;
        let span_s = until_s - from_s;
        let mut charging_s = 0.0;
        // The day before may still be charging, and the day after arrive before midnight.
        for ahead in -2..=((time_s + span_s) / DAY_S) as i64 + 1 {
            let chance = normal(self.seed, day + ahead, 0).clamp(-4.0, 4.0);
            let arrives_s =
                ahead as f64 * DAY_S + self.arrival_s + self.arrival_deviation_s * chance;
            let (begin_s, end_s) = (arrives_s - time_s, arrives_s + length_s - time_s);
            charging_s += (end_s.min(span_s) - begin_s.max(0.0)).max(0.0);
        }
        charging_s * self.charging_w
    }
}

impl ElectricLoad {
    fn phase(&self) -> Option<u32> {
        match self {
            Self::Driven(params) => params.phase,
            Self::Vehicle(params) => params.phase,
        }
    }
}

impl ThermalUnit for ElectricLoad {
    fn ports(&self) -> Vec<UnitPort> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let (name, unit, initial, min, follows) = match self {
            Self::Driven(params) => ("power_w", "w", params.power_w, 0.0, None),
            Self::Vehicle(_) => ("start_unix_s", "s", 0.0, f64::NEG_INFINITY, Some(START_UNIX)),
        };
        vec![UnitInput { name, unit, initial, min, max: f64::INFINITY, follows }]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let own = [UnitOutput::new("electric_w", "W"), UnitOutput::new("used_j", "J")];
        own.into_iter().chain(self.phase().into_iter().flat_map(|_| phases::outputs())).collect()
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0; 2]
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
        let electric_w = match self {
            Self::Driven(_) => signals.get(0),
            Self::Vehicle(car) => {
                let span_s = if dt_s > 0.0 { dt_s } else { 1.0 };
                car.energy_j(signals.get(0), state[0], state[0] + span_s) / span_s
            }
        };
        state[0] += dt_s;
        state[1] += dt_s * electric_w;
        let (own, phases) = out.split_at_mut(2);
        own.copy_from_slice(&[electric_w, state[1]]);
        phases::write(self.phase(), electric_w, phases);
        Exchange { electric_w, external_w: -electric_w }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_car_charges_its_energy_every_day() {
        let params = ElectricVehicleParams { seed: 4, ..ElectricVehicleParams::default() };
        let unit = params.build(&Medium::default()).unwrap();
        for dt_s in [60.0, 900.0, 3600.0, 5.0 * DAY_S] {
            let mut state = unit.initial_state(0.0);
            let mut out = [0.0; 2];
            let mut most_w = 0.0_f64;
            for _ in 0..(10.0 * DAY_S / dt_s) as usize {
                unit.advance(dt_s, &Signals(&[19_358.0 * DAY_S]), &[], &mut state, &mut out);
                most_w = most_w.max(out[0]);
            }
            // Ten days of 8 kWh; one of them may begin at midnight.
            assert!((out[1] - 80.0 * 3.6e6).abs() < 1.0, "{dt_s} s: {out:?}");
            assert!(dt_s > 900.0 || (most_w - 11_000.0).abs() < 1e-6);
        }
        // Who arrives about midnight arrives before it every other day: the same energy whatever the step.
        let night = ElectricVehicleParams { arrival_s: 0.0, ..params.clone() };
        let unit = night.build(&Medium::default()).unwrap();
        let charged = |dt_s: f64| {
            let (mut state, mut out) = (unit.initial_state(0.0), [0.0; 2]);
            for _ in 0..(10.0 * DAY_S / dt_s) as usize {
                unit.advance(dt_s, &Signals(&[19_358.0 * DAY_S]), &[], &mut state, &mut out);
            }
            out[1]
        };
        let (fine, coarse) = (charged(60.0), charged(3600.0));
        assert!((fine - coarse).abs() < 1.0 && fine > 70.0 * 3.6e6, "{fine} {coarse}");
        let wrong = ElectricVehicleParams { daily_j: 1e12, ..params };
        assert_eq!(wrong.build(&Medium::default()).unwrap_err().field(), Some("daily_j"));
    }
}
