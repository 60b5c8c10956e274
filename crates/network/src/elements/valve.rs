//! A two-way control valve: linear or equal-percentage, tight or leaking, with stroke time.
//!
//! **Equation** `m = k_vs phi(y) sqrt(dp)`; leakage `l = k(0)/k(1)`.
//! Linear `phi = l + (1 - l) y`. Equal percentage (rangeability R, foot `delta = 0.01`):
//! `y < delta/2`: `phi = l + y (R^(delta-1) - l)/delta`; `y > 3 delta/2`: `phi = R^(y-1)`; between a
//! cubic with value and slope of both ends. Quick opening `phi = l + (1 - l) y^(1/alpha)`, whose slope
//! at the seat is made finite: `y (y^2 + delta^2)^((1/alpha - 1)/2)` for the power, scaled to 1 at full
//! stroke. Table `phi = l + (1 - l) f(y)` with a monotone curve f through the points. With
//! `command = "kappa"` the command is the wanted phi. An inverse valve takes `1 - command`, a switching
//! one `0` or `1`. A pulsing valve (`pulse_period_s` = T) with the command x is open for `x T`, then closed
//! for `(1 - x) T`, as events of the run; its steady state is the opening x, which at constant pressure
//! difference passes the mean flow where the characteristic is linear.
//!
//! **Assumptions** fully turbulent. **Numerics** the square law is regularised below `delta_m` times
//! the nominal flow; a closed tight valve is a prescribed flow of zero.
//!
//! **Sources** `wetter2014` (characteristics), `elizarov2021` (Kvs 2.5 m3/h, leakage 2e-3, 35 s).

mod curve;

use super::flow_coefficient;
use crate::two_port::{
    Actuator, Characteristic, EdgeState, ElementError, TwoPort, not_negative, positive, ratio,
};
use anergy_core::medium::Medium;
use anergy_core::numerics::regularize::quadratic;
use curve::{Curve, FOOT};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Longest stroke of a pulsing valve over its period.
const SLOWEST_STROKE: f64 = 0.1;
/// A relative flow coefficient below this is a closed valve.
const CLOSED: f64 = 1e-6;

/// Flow coefficient over the stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ValveCharacteristic {
    /// Proportional to the opening.
    Linear,
    /// Equal steps multiply the coefficient equally.
    #[default]
    EqualPercentage,
    /// Most of the coefficient in the first part of the stroke.
    QuickOpening,
    /// Points `table_opening`, `table_phi`.
    Table,
}

/// What the command signal means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ValveCommand {
    /// The stroke, 0 to 1.
    #[default]
    Opening,
    /// The relative flow coefficient (linearised command).
    Kappa,
}

/// A control valve as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValveParams {
    /// Flow in m3/h at 1 bar when fully open.
    pub kvs_m3_h: f64,
    /// Flow coefficient over the stroke.
    #[serde(default)]
    pub characteristic: ValveCharacteristic,
    /// Ratio of largest to smallest controllable coefficient (equal percentage).
    #[serde(default = "default_rangeability")]
    pub rangeability: f64,
    /// Root of the opening that the coefficient follows (quick opening).
    #[serde(default = "default_alpha")]
    pub alpha: f64,
    /// Openings of the table, rising from 0 to 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub table_opening: Vec<f64>,
    /// Relative flow coefficients of the table without the leakage, rising from 0 to 1.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub table_phi: Vec<f64>,
    /// Coefficient of the closed valve over that of the open one; 0 is tight.
    #[serde(default = "default_leakage")]
    pub leakage: f64,
    /// What the command means.
    #[serde(default)]
    pub command: ValveCommand,
    /// Name under which valves share one command, a signal `NAME.opening` (or `.kappa`). Absent: the
    /// command is its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub command_of: Option<String>,
    /// Whether it takes one minus the command, like the second way of a three-way valve.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub inverse: bool,
    /// Command from which on it opens fully, and below which it closes: a switching valve. Absent: it
    /// takes any opening.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub switch_at: Option<f64>,
    /// Period of a pulsing valve, s: it is open for the share of each period that its command has at the
    /// beginning of the period, then closed. Absent: the command is an opening.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pulse_period_s: Option<f64>,
    /// Opening commanded while nothing drives it. Not with `command = "kappa"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub opening: Option<f64>,
    /// Relative flow coefficient commanded while nothing drives it, with `command = "kappa"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kappa: Option<f64>,
    /// Opening at the start of a run. Absent: where the first command leads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_opening: Option<f64>,
    /// Time in which the stem follows a step by 99.6 %, s.
    #[serde(default = "default_stroke_time")]
    pub stroke_time_s: f64,
    /// Nominal flow for the regularisation, kg/s. Absent: flow at 0.1 bar when open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_nominal_kg_s: Option<f64>,
    /// Regularised below this share of the nominal flow.
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn default_rangeability() -> f64 {
    50.0
}

fn default_alpha() -> f64 {
    2.0
}

fn default_leakage() -> f64 {
    1e-3
}

fn default_stroke_time() -> f64 {
    35.0
}

fn default_delta_m() -> f64 {
    0.02
}

impl Default for ValveParams {
    fn default() -> Self {
        Self {
            kvs_m3_h: 2.5,
            characteristic: ValveCharacteristic::default(),
            rangeability: default_rangeability(),
            alpha: default_alpha(),
            table_opening: Vec::new(),
            table_phi: Vec::new(),
            leakage: default_leakage(),
            command: ValveCommand::default(),
            command_of: None,
            inverse: false,
            switch_at: None,
            pulse_period_s: None,
            opening: None,
            kappa: None,
            initial_opening: None,
            stroke_time_s: default_stroke_time(),
            m_flow_nominal_kg_s: None,
            delta_m: default_delta_m(),
        }
    }
}

/// A control valve ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Valve {
    k_open: f64,
    curve: Curve,
    command: ValveCommand,
    inverse: bool,
    switch_at: Option<f64>,
    actuator: Box<Actuator>,
    m_flow_nominal_kg_s: f64,
    m_turbulent_kg_s: f64,
}

impl ValveParams {
    /// The runtime valve.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, medium: &Medium) -> Result<Valve, ElementError> {
        let k_open = flow_coefficient(positive("kvs_m3_h", self.kvs_m3_h)?, medium.density_kg_m3);
        let curve = self.curve()?;
        let (command_name, given, other, other_given) = match self.command {
            ValveCommand::Opening => ("opening", self.opening, "kappa", self.kappa),
            ValveCommand::Kappa => ("kappa", self.kappa, "opening", self.opening),
        };
        if other_given.is_some() {
            return Err(ElementError::Fields {
                problem: format!(
                    "{other} is given, but the command of this valve is {command_name}"
                ),
            });
        }
        let initial_command = ratio(command_name, given.unwrap_or(1.0))?;
        if let Some(switch_at) = self.switch_at {
            // At 0 it could never close.
            positive("switch_at", ratio("switch_at", switch_at)?)?;
        }
        self.check_pulse()?;
        let m_flow_nominal_kg_s = match self.m_flow_nominal_kg_s {
            Some(m) => positive("m_flow_nominal_kg_s", m)?,
            None => k_open * 1e4_f64.sqrt(),
        };
        let mut valve = Valve {
            k_open,
            curve,
            command: self.command,
            inverse: self.inverse,
            switch_at: self.switch_at,
            actuator: Box::new(Actuator {
                position: "opening",
                command: command_name,
                unit: "",
                initial_command,
                initial_position: 0.0,
                rise_time_s: not_negative("stroke_time_s", self.stroke_time_s)?,
                min: 0.0,
                max: 1.0,
            }),
            m_flow_nominal_kg_s,
            m_turbulent_kg_s: positive("delta_m", self.delta_m)? * m_flow_nominal_kg_s,
        };
        let target = valve.target_position(initial_command);
        valve.actuator.initial_position =
            ratio("initial_opening", self.initial_opening.unwrap_or(target))?;
        Ok(valve)
    }

    /// A pulsing valve is open or closed for most of its period.
    fn check_pulse(&self) -> Result<(), ElementError> {
        let Some(period_s) = self.pulse_period_s else { return Ok(()) };
        positive("pulse_period_s", period_s)?;
        if self.command == ValveCommand::Kappa || self.switch_at.is_some() {
            let problem = "pulse_period_s goes neither with command = \"kappa\" nor with switch_at";
            return Err(ElementError::Fields { problem: problem.into() });
        }
        if self.stroke_time_s > SLOWEST_STROKE * period_s {
            return Err(ElementError::OutOfRange {
                field: "stroke_time_s",
                value: self.stroke_time_s,
                requirement: "must be at most a tenth of pulse_period_s; 0 for exact shares",
            });
        }
        Ok(())
    }

    /// The characteristic with its parameters checked.
    fn curve(&self) -> Result<Curve, ElementError> {
        let out_of_range =
            |field, value, requirement| ElementError::OutOfRange { field, value, requirement };
        let has_table = !self.table_opening.is_empty() || !self.table_phi.is_empty();
        if has_table != (self.characteristic == ValveCharacteristic::Table) {
            return Err(ElementError::Fields {
                problem: "table_opening and table_phi belong to characteristic = \"table\"".into(),
            });
        }
        if self.rangeability < 2.0 || !self.rangeability.is_finite() {
            return Err(out_of_range("rangeability", self.rangeability, "must be at least 2"));
        }
        if self.alpha < 1.0 || !self.alpha.is_finite() {
            return Err(out_of_range("alpha", self.alpha, "must be at least 1"));
        }
        let largest_leakage = match self.characteristic {
            ValveCharacteristic::EqualPercentage => self.rangeability.powf(FOOT - 1.0),
            _ => 1.0,
        };
        if !(0.0..largest_leakage).contains(&self.leakage) {
            let requirement = "must not be negative and below the foot of the characteristic";
            return Err(out_of_range("leakage", self.leakage, requirement));
        }
        match self.characteristic {
            ValveCharacteristic::Linear => Ok(Curve::linear(self.leakage)),
            ValveCharacteristic::EqualPercentage => {
                Ok(Curve::equal_percentage(self.leakage, self.rangeability))
            }
            ValveCharacteristic::QuickOpening => Ok(Curve::quick_opening(self.leakage, self.alpha)),
            ValveCharacteristic::Table => {
                Curve::table(self.leakage, &self.table_opening, &self.table_phi)
            }
        }
    }
}

impl Valve {
    /// The actuator, for elements that are a valve with other words.
    pub(super) fn own_actuator(&self) -> Actuator {
        *self.actuator
    }
}

impl TwoPort for Valve {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        let phi = self.curve.phi(state.position);
        if phi < CLOSED {
            return Characteristic::ImposedFlow { m_flow_kg_s: 0.0 };
        }
        let k = self.k_open * phi;
        Characteristic::PressureLoss(quadratic(m, 1.0 / (k * k), self.m_turbulent_kg_s))
    }

    fn loss_by_position(&self, m: f64, state: &EdgeState) -> f64 {
        // dp = (m/(k phi))^2
        let share = -2.0 * self.curve.phi_slope(state.position) / self.curve.phi(state.position);
        match self.characteristic(m, state) {
            Characteristic::PressureLoss(loss) => share * loss.value,
            _ => 0.0,
        }
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        self.m_flow_nominal_kg_s
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(*self.actuator)
    }

    fn target_position(&self, command: f64) -> f64 {
        let command = command.clamp(0.0, 1.0);
        let command = match self.switch_at {
            Some(switch_at) => f64::from(u8::from(command >= switch_at)),
            None => command,
        };
        let command = if self.inverse { 1.0 - command } else { command };
        match self.command {
            ValveCommand::Opening => command,
            ValveCommand::Kappa => self.curve.opening(command),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(opening: f64) -> EdgeState {
        EdgeState { position: opening, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 }
    }

    fn loss(valve: &Valve, m: f64, opening: f64) -> f64 {
        match valve.characteristic(m, &state(opening)) {
            Characteristic::PressureLoss(loss) => loss.value,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn kv_check() {
        // Kvs 2.5: 2.5 m3/h = 0.69444 kg/s at 1 bar; leak l = 2e-3: that flow times 2e-3
        let valve = ValveParams { leakage: 2e-3, ..ValveParams::default() };
        let valve = valve.build(&Medium::default()).unwrap();
        assert!((loss(&valve, 2.5 / 3.6, 1.0) - 1e5).abs() < 1e-6);
        let leak = Valve { m_turbulent_kg_s: 1e-9, ..valve };
        assert!((loss(&leak, 2e-3 * 2.5 / 3.6, 0.0) - 1e5).abs() < 1e-6);
    }

    #[test]
    fn inverse_and_switching_valves() {
        let target = |params: ValveParams, command: f64| {
            params.build(&Medium::default()).unwrap().target_position(command)
        };
        let inverse = ValveParams { inverse: true, ..ValveParams::default() };
        assert_eq!(target(inverse.clone(), 0.3), 0.7);
        let switching = ValveParams { switch_at: Some(0.6), ..ValveParams::default() };
        assert_eq!(
            [0.0, 0.59, 0.6, 1.0].map(|x| target(switching.clone(), x)),
            [0.0, 0.0, 1.0, 1.0]
        );
        let both = ValveParams { switch_at: Some(0.6), ..inverse };
        assert_eq!([0.59, 0.6].map(|x| target(both.clone(), x)), [1.0, 0.0]);
        // An inverse valve starts where its command leads: opening 0.2 is 0.8 of the stroke.
        let start = ValveParams { opening: Some(0.2), ..both };
        let start = ValveParams { switch_at: None, ..start }.build(&Medium::default()).unwrap();
        assert_eq!(start.actuator.initial_position, 0.8);
        let never = ValveParams { switch_at: Some(0.0), ..ValveParams::default() };
        assert_eq!(never.build(&Medium::default()).unwrap_err().field(), Some("switch_at"));
    }

    #[test]
    fn characteristic_rises_and_a_tight_valve_closes() {
        for characteristic in [
            ValveCharacteristic::Linear,
            ValveCharacteristic::EqualPercentage,
            ValveCharacteristic::QuickOpening,
            ValveCharacteristic::Table,
        ] {
            let mut params = ValveParams { characteristic, leakage: 0.0, ..ValveParams::default() };
            if characteristic == ValveCharacteristic::Table {
                params.table_opening = vec![0.0, 0.3, 1.0];
                params.table_phi = vec![0.0, 0.9, 1.0];
            }
            let valve = params.build(&Medium::default()).unwrap();
            let mut last = -1.0;
            for i in 0..=1000 {
                let phi = valve.curve.phi(f64::from(i) / 1000.0);
                assert!(phi > last);
                last = phi;
            }
            assert!((last - 1.0).abs() < 1e-12);
            assert_eq!(
                valve.characteristic(0.1, &state(0.0)),
                Characteristic::ImposedFlow { m_flow_kg_s: 0.0 }
            );
        }
    }

    #[test]
    fn a_table_must_rise_from_0_to_1() {
        let error = |opening: &[f64], phi: &[f64]| {
            let params = ValveParams {
                characteristic: ValveCharacteristic::Table,
                table_opening: opening.to_vec(),
                table_phi: phi.to_vec(),
                ..ValveParams::default()
            };
            params.build(&Medium::default()).unwrap_err().to_string()
        };
        assert_eq!(
            error(&[0.0, 0.5, 1.0], &[0.0, 0.0, 1.0]),
            "table_phi: the coefficient must rise strictly with the opening: point 2 has 0, the \
             point before 0"
        );
        assert!(error(&[0.0, 0.9], &[0.0, 1.0]).contains("table_opening: must begin with 0"));
        assert!(error(&[0.0, 1.0], &[0.1, 1.0]).contains("table_phi: must begin with 0"));
        assert!(error(&[], &[]).contains("belong to"));
    }
}
