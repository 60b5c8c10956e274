//! A battery at the connection of a house.
//!
//! **Equation** with the power `P` at the connection, drawn positive: `dE/dt = eta_c max(P, 0) - max(-P, 0)/eta_d -
//! P_self`, within its largest powers and its limits of the energy. In `power` mode `P` is the set power, whatever the
//! house does; in `grid_power` mode `P = P_grid,set - P_site`, so that house and battery together draw the set power.
//!
//! **Assumptions** efficiencies do not depend on power or charge; no ageing. **Validity** means over a step: a
//! battery that becomes full within a step takes as much as fits. **Numerics** exact; energy closes to rounding.
//! Full cycles are the energy taken out of it per capacity.
//!
//! **Sources** values assumed (`docs/src/generators.md`).

use crate::phases;
use crate::thermal_unit::{
    Exchange, SITE_ELECTRICITY, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort,
    not_negative, positive, share,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a battery is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BatteryMode {
    /// Its own power, `power_w`.
    Power,
    /// The power of the house with it, `grid_set_w`.
    #[default]
    GridPower,
}

/// A battery as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BatteryParams {
    /// What it is told.
    pub mode: BatteryMode,
    /// Set power in `power` mode while nothing drives it, W; negative is discharged.
    pub power_w: f64,
    /// Set power of house and battery in `grid_power` mode while nothing drives it, W; negative is fed in.
    pub grid_set_w: f64,
    /// Capacity, J.
    pub capacity_j: f64,
    /// Largest power of charging at the connection, W.
    pub charge_max_w: f64,
    /// Largest power of discharging at the connection, W.
    pub discharge_max_w: f64,
    /// Efficiency of charging.
    pub charge_efficiency: f64,
    /// Efficiency of discharging.
    pub discharge_efficiency: f64,
    /// What it loses all the time, W.
    pub self_discharge_w: f64,
    /// Smallest state of charge to which it is discharged.
    pub soc_min: f64,
    /// Largest state of charge to which it is charged.
    pub soc_max: f64,
    /// State of charge at the start.
    pub initial_soc: f64,
    /// Phase of the grid on which its inverter stands, 1 to 3; three phases alike without this.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub phase: Option<u32>,
}

impl Default for BatteryParams {
    fn default() -> Self {
        Self {
            mode: BatteryMode::GridPower,
            power_w: 0.0,
            grid_set_w: 0.0,
            capacity_j: 3.6e7,
            charge_max_w: 5000.0,
            discharge_max_w: 5000.0,
            charge_efficiency: 0.95,
            discharge_efficiency: 0.95,
            self_discharge_w: 0.0,
            soc_min: 0.05,
            soc_max: 1.0,
            initial_soc: 0.5,
            phase: None,
        }
    }
}

/// A battery ready to run. State: energy, J; charged and discharged at the connection, taken out of it, lost so far, J.
#[derive(Debug, Clone, PartialEq)]
pub struct Battery {
    params: BatteryParams,
}

const ENERGY_J: usize = 0;
const CHARGED_J: usize = 1;
const DISCHARGED_J: usize = 2;
const TAKEN_OUT_J: usize = 3;
const LOST_J: usize = 4;

const SET: usize = 0;
const SITE: usize = 1;

impl BatteryParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<Battery, UnitError> {
        for (field, value) in [
            ("capacity_j", self.capacity_j),
            ("charge_efficiency", self.charge_efficiency),
            ("discharge_efficiency", self.discharge_efficiency),
        ] {
            positive(field, value)?;
        }
        for (field, value) in [
            ("charge_max_w", self.charge_max_w),
            ("discharge_max_w", self.discharge_max_w),
            ("self_discharge_w", self.self_discharge_w),
        ] {
            not_negative(field, value)?;
        }
        for (field, value) in [
            ("charge_efficiency", self.charge_efficiency),
            ("discharge_efficiency", self.discharge_efficiency),
            ("soc_min", self.soc_min),
            ("soc_max", self.soc_max),
            ("initial_soc", self.initial_soc),
        ] {
            share(field, value)?;
        }
        if self.soc_min >= self.soc_max {
            return Err(UnitError::OutOfRange {
                field: "soc_min",
                value: self.soc_min,
                requirement: "must be below soc_max",
            });
        }
        for (field, value) in [("power_w", self.power_w), ("grid_set_w", self.grid_set_w)] {
            if !value.is_finite() {
                let requirement = "must be finite";
                return Err(UnitError::OutOfRange { field, value, requirement });
            }
        }
        phases::check(self.phase)?;
        Ok(Battery { params: self.clone() })
    }
}

impl Battery {
    /// The power that is possible over a step, W.
    fn possible_w(&self, wanted_w: f64, energy_j: f64, dt_s: f64) -> f64 {
        let p = &self.params;
        let wanted_w = wanted_w.clamp(-p.discharge_max_w, p.charge_max_w);
        if dt_s <= 0.0 {
            return wanted_w;
        }
        let kept_j = energy_j - p.self_discharge_w * dt_s;
        let room_w = (p.soc_max * p.capacity_j - kept_j).max(0.0) / (p.charge_efficiency * dt_s);
        let there_w = (kept_j - p.soc_min * p.capacity_j).max(0.0) * p.discharge_efficiency / dt_s;
        wanted_w.clamp(-there_w, room_w)
    }
}

impl ThermalUnit for Battery {
    fn ports(&self) -> Vec<UnitPort> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let power = |name, initial, follows| UnitInput {
            name,
            unit: "w",
            initial,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
            follows,
        };
        match self.params.mode {
            BatteryMode::Power => vec![power("power_w", self.params.power_w, None)],
            BatteryMode::GridPower => vec![
                power("grid_set_w", self.params.grid_set_w, None),
                power("site_w", 0.0, Some(SITE_ELECTRICITY)),
            ],
        }
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let own = [
            UnitOutput::new("electric_w", "W"),
            UnitOutput::new("soc", "1"),
            UnitOutput::new("energy_j", "J"),
            UnitOutput::new("loss_w", "W"),
            UnitOutput::new("charged_j", "J"),
            UnitOutput::new("discharged_j", "J"),
            UnitOutput::new("lost_j", "J"),
            UnitOutput::new("full_cycles", "1"),
        ];
        own.into_iter()
            .chain(self.params.phase.into_iter().flat_map(|_| phases::outputs()))
            .collect()
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        let mut state = vec![0.0; LOST_J + 1];
        state[ENERGY_J] = self.params.initial_soc * self.params.capacity_j;
        state
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
        let p = &self.params;
        let wanted_w = match p.mode {
            BatteryMode::Power => signals.get(SET),
            BatteryMode::GridPower => signals.get(SET) - signals.get(SITE),
        };
        let before_j = state[ENERGY_J];
        let power_w = self.possible_w(wanted_w, before_j, dt_s);
        let out_w = (-power_w).max(0.0) / p.discharge_efficiency;
        let cells_w = p.charge_efficiency * power_w.max(0.0) - out_w;
        let mut loss_w = power_w - cells_w;
        if dt_s > 0.0 {
            // An empty battery has nothing to lose.
            let left_j = before_j + dt_s * cells_w;
            let self_w = p.self_discharge_w.min(left_j.max(0.0) / dt_s);
            state[ENERGY_J] = left_j - dt_s * self_w;
            loss_w += self_w;
        }
        state[CHARGED_J] += dt_s * power_w.max(0.0);
        state[DISCHARGED_J] += dt_s * (-power_w).max(0.0);
        state[TAKEN_OUT_J] += dt_s * out_w;
        state[LOST_J] += dt_s * loss_w;
        let (own, phases) = out.split_at_mut(8);
        phases::write(p.phase, power_w, phases);
        own.copy_from_slice(&[
            power_w,
            state[ENERGY_J] / p.capacity_j,
            state[ENERGY_J],
            loss_w,
            state[CHARGED_J],
            state[DISCHARGED_J],
            state[LOST_J],
            state[TAKEN_OUT_J] / p.capacity_j,
        ]);
        Exchange { electric_w: power_w, external_w: -loss_w }
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        state[ENERGY_J]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(
        battery: &Battery,
        state: &mut [f64],
        signals: &[f64],
        dt_s: f64,
    ) -> (Exchange, [f64; 8]) {
        let mut out = [0.0; 8];
        let before_j = battery.stored_j(state);
        let exchange = battery.advance(dt_s, &Signals(signals), &[], state, &mut out);
        let left_j = battery.stored_j(state) - before_j;
        let left_j = left_j - dt_s * (exchange.electric_w + exchange.external_w);
        assert!(left_j.abs() < 1e-6, "{left_j}");
        (exchange, out)
    }

    #[test]
    fn charges_and_discharges_within_its_limits() {
        let params = BatteryParams { mode: BatteryMode::Power, ..BatteryParams::default() };
        let battery = params.build(&Medium::default()).unwrap();
        let mut state = battery.initial_state(0.0);
        // 5 kWh; 8 kW are wanted, 5 kW come: 4.75 kWh more in an hour.
        let (exchange, out) = step(&battery, &mut state, &[8000.0], 3600.0);
        assert!((exchange.electric_w - 5000.0).abs() < 1e-9 && (out[1] - 0.975).abs() < 1e-12);
        assert!((out[3] - 250.0).abs() < 1e-9);
        // 0.25 kWh fit in: 263.2 W over an hour.
        let (exchange, out) = step(&battery, &mut state, &[8000.0], 3600.0);
        assert!((exchange.electric_w - 250.0 / 0.95).abs() < 1e-9 && (out[1] - 1.0).abs() < 1e-12);
        // Down to 5 %: 9.5 kWh give 9.025 kWh, 4512.5 W over two hours; 0.95 of a cycle.
        let (exchange, out) = step(&battery, &mut state, &[-5000.0], 7200.0);
        assert!((exchange.electric_w + 4512.5).abs() < 1e-9, "{exchange:?}");
        assert!((out[1] - 0.05).abs() < 1e-12 && (out[7] - 0.95).abs() < 1e-12);
        assert_eq!(step(&battery, &mut state, &[-5000.0], 3600.0).0.electric_w, 0.0);
    }

    #[test]
    fn holds_the_power_of_the_house() {
        let battery = BatteryParams::default().build(&Medium::default()).unwrap();
        let mut state = battery.initial_state(0.0);
        // The house feeds in 3 kW, nothing shall pass: 3 kW into the battery; it draws 2 kW: 2 kW from it.
        assert_eq!(step(&battery, &mut state, &[0.0, -3000.0], 900.0).0.electric_w, 3000.0);
        assert_eq!(step(&battery, &mut state, &[0.0, 2000.0], 900.0).0.electric_w, -2000.0);
        // 1 kW shall be drawn.
        assert_eq!(step(&battery, &mut state, &[1000.0, 400.0], 900.0).0.electric_w, 600.0);
    }

    #[test]
    fn loses_what_it_has() {
        let params = BatteryParams {
            self_discharge_w: 1000.0,
            initial_soc: 0.05,
            mode: BatteryMode::Power,
            ..BatteryParams::default()
        };
        let battery = params.build(&Medium::default()).unwrap();
        let mut state = battery.initial_state(0.0);
        // 0.5 kWh are lost in half an hour.
        let (exchange, out) = step(&battery, &mut state, &[0.0], 3600.0);
        assert!(out[1] == 0.0 && (exchange.external_w + 500.0).abs() < 1e-9);
        let wrong = BatteryParams { soc_min: 1.0, ..params };
        assert_eq!(wrong.build(&Medium::default()).unwrap_err().field(), Some("soc_min"));
    }
}
