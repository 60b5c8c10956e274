//! A circulation pump that holds a speed, a flow or a head: affinity laws on a head curve, actuator lag,
//! electric power.
//!
//! **Equation** at relative speed u and `V = m/rho`: `p_b - p_a = u^2 H(V/u)`. The curve H at full speed
//! is one of: quadratic `H = H0 - a V|V|` with `a = H0/V_free^2`, so `p_a - p_b = -u^2 H0 + a V|V|`;
//! power law `H = H0 - H0 (V/V_free)^n`, odd in the flow, straight beyond `+-V_free`; a table of points
//! with monotone interpolation; or a polynomial `H = sum c_i V^i` up to its first zero. The last two are
//! continued linearly beyond their end and by `H0 + s|V| + a V^2` for reverse flow. Power
//! `P = V dp/eta` for pumping flow, plus standby, with `eta = eta_h eta_m` or a table `eta(V/u)`; with
//! `heat_to_water = f` the water takes up the heat `max(f P - V dp, 0)` in the pump (without the standby
//! power). The work `V dp` itself warms the water where it dissipates, if the model counts friction
//! (`transport/friction.rs`).
//!
//! A `reversible` pump turns backwards at a negative speed and is then its own mirror image,
//! `p_a - p_b = -(p_a - p_b)(-m, -u)`.
//!
//! With `mode = "flow"`, `"head"` or `"proportional_head"` the pump chooses the speed that holds its set
//! value, up to the full one and down to standstill: a median of three rising laws (`mode.rs`).
//!
//! **Assumptions** at rest the impeller is an orifice of the curve's curvature. Where a table or
//! polynomial does not fall, the nearest falling curve is taken and said so, up to 10 % of H0.
//! **Validity** any flow: reverse flow is resisted, flow beyond the curve makes the pump a resistance.
//!
//! **Numerics** `V|V|` and `V^n` are regularised below `delta_m` times the nominal flow, high powers up
//! to where they have the slope of the quadratic law at zero; all but the quadratic curve are blended into the orifice below 5 % speed. Below `speed_min` the pump is off.
//! Polynomials are sampled with their slopes, which is exact up to the third power.
//!
//! **Sources** `licklederer2021`, `wetter2014`, `elizarov2021` (rise time).

mod command;
mod curve;
mod efficiency;
mod mode;
#[cfg(test)]
mod tests;

pub use mode::PumpMode;

use crate::two_port::{
    Actuator, Characteristic, EdgeState, ElementError, Pieces, TwoPort, not_negative, positive,
    ratio,
};
use anergy_core::linear::Linear;
use anergy_core::medium::Medium;
use curve::HeadCurve;
use efficiency::Efficiency;
use mode::Proportional;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A pump as written in a model file: `head_max_pa` and `free_flow_m3_s`, or the two columns
/// `curve_v_flow_m3_s` and `curve_head_pa`, or `curve_polynomial`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PumpParams {
    /// Head at zero flow and full speed, Pa (quadratic curve or power law).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_max_pa: Option<f64>,
    /// Flow at zero head and full speed, m3/s (quadratic curve or power law).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_flow_m3_s: Option<f64>,
    /// Exponent of the flow between the two. Absent: 2, the quadratic curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_exponent: Option<f64>,
    /// Flows of the curve table at full speed, m3/s, rising from 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_v_flow_m3_s: Vec<f64>,
    /// Heads of the curve table, Pa, falling.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_head_pa: Vec<f64>,
    /// Head at full speed as a polynomial of the flow, Pa over m3/s: coefficients of increasing powers.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub curve_polynomial: Vec<f64>,
    /// Largest flow of the polynomial, m3/s. Absent: where its head becomes zero.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub curve_v_flow_max_m3_s: Option<f64>,
    /// What the pump holds and its command means.
    #[serde(default)]
    pub mode: PumpMode,
    /// Mass flow commanded while nothing else drives it, kg/s, with `mode = "flow"`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_set_kg_s: Option<f64>,
    /// Head commanded while nothing else drives it, Pa, with `mode = "head"`; with
    /// `mode = "proportional_head"` that from the design flow on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub head_pa: Option<f64>,
    /// Flow from which on a proportional head is `head_pa`, kg/s. Absent: where the curve at full speed has
    /// this head.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub m_flow_design_kg_s: Option<f64>,
    /// Share of `head_pa` that a proportional head has at zero flow. Absent: half of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub zero_flow_share: Option<f64>,
    /// Relative speed commanded while nothing else drives it.
    #[serde(default)]
    pub speed: f64,
    /// Relative speed at the start of a run.
    #[serde(default)]
    pub initial_speed: f64,
    /// Below this relative speed the pump is off.
    #[serde(default)]
    pub speed_min: f64,
    /// Largest relative speed.
    #[serde(default = "one")]
    pub speed_max: f64,
    /// Whether it turns both ways: a negative speed pumps from b to a, with the same curve.
    #[serde(default, skip_serializing_if = "is_false")]
    pub reversible: bool,
    /// Time in which the speed, or what else is commanded, follows a step by 99.6 %, s.
    #[serde(default = "default_rise_time")]
    pub rise_time_s: f64,
    /// Hydraulic efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_hydraulic: f64,
    /// Motor efficiency.
    #[serde(default = "default_efficiency")]
    pub efficiency_motor: f64,
    /// Flows of the efficiency table at full speed, m3/s.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub efficiency_v_flow_m3_s: Vec<f64>,
    /// Overall efficiencies of the table, from wire to water, instead of the two constants.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub efficiency: Vec<f64>,
    /// Share of the electric power (without the standby power) that ends in the water: 1 for a wet
    /// rotor, `efficiency_motor` for a dry motor in the open. Absent: the pump does not warm the water.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heat_to_water: Option<f64>,
    /// Electric power while off, W.
    #[serde(default)]
    pub standby_w: f64,
    /// Regularised below this share of the nominal flow (half the free flow).
    #[serde(default = "default_delta_m")]
    pub delta_m: f64,
}

fn one() -> f64 {
    1.0
}

#[allow(clippy::trivially_copy_pass_by_ref)]
fn is_false(value: &bool) -> bool {
    !*value
}

fn default_rise_time() -> f64 {
    8.0
}

fn default_efficiency() -> f64 {
    0.7
}

fn default_delta_m() -> f64 {
    0.01
}

impl Default for PumpParams {
    /// The published feed-in pump (`FeedInQuadratic`): 402.21 hPa, 55.33 l/min.
    fn default() -> Self {
        Self {
            head_max_pa: Some(40_221.0),
            free_flow_m3_s: Some(55.33 / 60_000.0),
            curve_exponent: None,
            curve_v_flow_m3_s: Vec::new(),
            curve_head_pa: Vec::new(),
            curve_polynomial: Vec::new(),
            curve_v_flow_max_m3_s: None,
            mode: PumpMode::default(),
            m_flow_set_kg_s: None,
            head_pa: None,
            m_flow_design_kg_s: None,
            zero_flow_share: None,
            speed: 0.0,
            initial_speed: 0.0,
            speed_min: 0.0,
            speed_max: one(),
            reversible: false,
            rise_time_s: default_rise_time(),
            efficiency_hydraulic: default_efficiency(),
            efficiency_motor: default_efficiency(),
            efficiency_v_flow_m3_s: Vec::new(),
            efficiency: Vec::new(),
            heat_to_water: None,
            standby_w: 0.0,
            delta_m: default_delta_m(),
        }
    }
}

/// A pump ready to be solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Pump {
    curve: Box<HeadCurve>,
    mode: PumpMode,
    proportional: Option<Proportional>,
    efficiency: Efficiency,
    heat_to_water: Option<f64>,
    standby_w: f64,
    actuator: Box<Actuator>,
    speed_min: f64,
    speed_max: f64,
}

impl PumpParams {
    /// The runtime pump.
    ///
    /// # Errors
    /// Names the field that is out of range, or the point at which the curve rises too far.
    pub fn build(&self, medium: &Medium) -> Result<Pump, ElementError> {
        let curve = self.head_curve(medium.density_kg_m3)?;
        let speed_max = positive("speed_max", self.speed_max)?;
        let proportional = self.proportional(&curve, speed_max, medium.density_kg_m3)?;
        let actuator = self.actuator(&curve, speed_max)?;
        let actuator = match proportional {
            // As at zero flow, until a flow is known.
            Some(line) => Actuator {
                initial_position: line.head_pa(actuator.initial_command, 0.0),
                ..actuator
            },
            None => actuator,
        };
        Ok(Pump {
            proportional,
            curve: Box::new(curve),
            mode: self.mode,
            efficiency: self.overall_efficiency()?,
            heat_to_water: self
                .heat_to_water
                .map(|share| ratio("heat_to_water", share))
                .transpose()?,
            standby_w: not_negative("standby_w", self.standby_w)?,
            actuator: Box::new(actuator),
            speed_min: self.speed_min,
            speed_max,
        })
    }
}

impl Pump {
    /// The relative speed at which the pump has `p_a - p_b = dp_pa` at a flow: the nearest one within
    /// its limits.
    pub fn speed_at(&self, m_flow_kg_s: f64, dp_pa: f64, density_kg_m3: f64) -> f64 {
        self.curve.speed_at(m_flow_kg_s, dp_pa, density_kg_m3, self.speed_max)
    }

    /// Head without flow at relative speed 1, Pa; at others by the square of the speed.
    pub fn head_without_flow_pa(&self) -> f64 {
        self.curve.head_max_pa
    }

    /// Whether the losses of the pump warm the water that passes.
    pub fn warms_water(&self) -> bool {
        self.heat_to_water.is_some()
    }

    /// The relative speed at a flow: commanded, or what the mode leads to.
    pub fn speed(&self, m_flow_kg_s: f64, state: &EdgeState) -> f64 {
        match self.mode {
            PumpMode::Speed => state.position,
            PumpMode::Flow | PumpMode::Head | PumpMode::ProportionalHead => {
                let dp_pa = self.loss(m_flow_kg_s, state).value;
                self.speed_at(m_flow_kg_s, dp_pa, state.density_kg_m3)
            }
        }
    }

    fn loss(&self, m: f64, state: &EdgeState) -> Linear {
        self.mode.loss(&self.curve, m, state.position, state.density_kg_m3, self.speed_max)
    }

    /// Hydraulic power, W, zero where the pump is off or a resistance, and the efficiency.
    fn pumping(&self, m: f64, state: &EdgeState) -> (f64, f64) {
        // Turning backwards it pumps the other way.
        let way = if state.position < 0.0 { -1.0 } else { 1.0 };
        let (head, m) = (-way * self.loss(m, state).value, way * m);
        let v = m / state.density_kg_m3;
        if m <= 0.0 || head <= 0.0 {
            return (0.0, 1.0);
        }
        let speed = way * self.speed(m, state);
        if speed > 0.0 { (v * head, self.efficiency.at(v / speed)) } else { (0.0, 1.0) }
    }
}

impl TwoPort for Pump {
    fn characteristic(&self, m: f64, state: &EdgeState) -> Characteristic {
        Characteristic::PressureLoss(self.loss(m, state))
    }

    fn loss_by_position(&self, m: f64, state: &EdgeState) -> f64 {
        let (position, density) = (state.position, state.density_kg_m3);
        self.mode.loss_by_position(&self.curve, m, position, density, self.speed_max)
    }

    fn has_corners(&self) -> bool {
        self.holds_flow()
    }

    fn pieces(&self, m: f64, state: &EdgeState) -> Option<Pieces> {
        let (position, density) = (state.position, state.density_kg_m3);
        let (pieces, _) = self.mode.pieces(&self.curve, m, position, density, self.speed_max)?;
        self.holds_flow().then_some(pieces)
    }

    fn m_flow_nominal_kg_s(&self) -> f64 {
        0.5 * self.curve.m_free_kg_s
    }

    fn actuator(&self) -> Option<Actuator> {
        Some(*self.actuator)
    }

    fn target_position(&self, command: f64) -> f64 {
        let target = command.clamp(self.actuator.min, self.actuator.max);
        if self.mode == PumpMode::Speed && target.abs() < self.speed_min { 0.0 } else { target }
    }

    fn follows_flow(&self) -> bool {
        self.proportional.is_some()
    }

    fn target_at_flow(&self, command: f64, m: f64) -> f64 {
        let target = self.target_position(command);
        self.proportional.map_or(target, |line| line.head_pa(target, m))
    }

    fn note(&self) -> Option<&str> {
        self.curve.note.as_deref()
    }

    fn electric_power_w(&self, m: f64, state: &EdgeState) -> Option<f64> {
        let (hydraulic_w, efficiency) = self.pumping(m, state);
        Some(self.standby_w + hydraulic_w / efficiency)
    }

    fn heat_to_water_w(&self, m: f64, state: &EdgeState) -> f64 {
        let Some(share) = self.heat_to_water else { return 0.0 };
        let (hydraulic_w, efficiency) = self.pumping(m, state);
        (share * hydraulic_w / efficiency - hydraulic_w).max(0.0)
    }
}
