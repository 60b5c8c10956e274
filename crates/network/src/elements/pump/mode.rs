//! What a pump does with its set value: run at a speed, or choose the speed up to the full one that
//! holds a flow or a head.
//!
//! **Equation** A pump that controls itself can be anywhere between standstill, `R(m)`, and full speed,
//! `F(m) < R(m)` (both `p_a - p_b`). Its law is the median of the two and of the line `S(m)` that holds
//! the set value, `max(F, min(S, R))`: on the line where the speed for it exists, else at full speed or
//! at rest. All three rise, so the law does, and saturation is no status that could flicker. Flow:
//! `S = k (m - m_set)` with `k = u_max^2 H0/(1e-4 m_set)`. Head: `S = -h_set + k m` with a droop of 1e-3
//! of the head at the nominal flow, so that two such pumps in parallel share the flow.
//!
//! A proportional head is a set head that rises with the flow, `h_set (s + (1 - s) m/m_design)` up to the
//! design flow and constant beyond ([`Proportional`]). Its line falls where `phi` must rise, so it is no law:
//! the held head is an actuator position that follows this target at the last flow, with the rise time of the
//! pump, and in the steady state in rounds, which approach it from one side and never pass it as long as the
//! network's own curve is the steeper one. Of such pumps in parallel one takes all flow; one pump can be
//! proportional beside pumps of other modes.
//!
//! **Numerics** maximum and minimum are rounded within 1e-3 of the head at zero flow. A set value of
//! zero is a pump at rest; up to 1e-3 of the nominal flow or head the available speed rises linearly. The
//! corners of a held flow are sharper than a Newton step can foresee, which jumps between full speed and
//! rest over the line: the solver chooses the pieces ([`Pieces`], `hydraulics/pieces.rs`).

use super::PumpParams;
use super::curve::HeadCurve;
use crate::two_port::{ElementError, Pieces, positive, ratio};
use anergy_core::linear::Linear;
use anergy_core::numerics::regularize::{smooth_max, smooth_min};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Deviation from the set flow between standstill and full speed, relative to it.
const FLOW_BAND: f64 = 1e-4;
/// The band is that of this share of the nominal flow, at least.
const LEAST_FLOW: f64 = 1e-2;
/// Fall of a held head up to the nominal flow, relative to it.
const DROOP: f64 = 1e-3;
/// The droop is that of this share of the head at zero flow, at least.
const LEAST_HEAD: f64 = 1e-2;
/// Below this share of the nominal flow or the head at zero flow the pump is being switched off.
const SWITCHED_OFF: f64 = 1e-3;
/// Rounding of the joints relative to the head at zero flow and the available speed.
const ROUNDING: f64 = 1e-3;

/// What the command of a pump means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PumpMode {
    /// The relative speed.
    #[default]
    Speed,
    /// The mass flow, within what the curve at full speed allows.
    Flow,
    /// The head, within what the curve at full speed allows.
    Head,
    /// A head that rises with the flow up to the set one, within what the curve at full speed allows.
    ProportionalHead,
}

impl PumpMode {
    /// `p_a - p_b` at a position: speed, flow in kg/s or head in Pa.
    pub(super) fn loss(
        self,
        curve: &HeadCurve,
        m: f64,
        position: f64,
        density: f64,
        speed_max: f64,
    ) -> Linear {
        if self == Self::Speed && position < 0.0 {
            let mirrored = curve.loss(-m, -position, density);
            return Linear::new(-mirrored.value, mirrored.slope);
        }
        if self == Self::Speed {
            return curve.loss(m, position, density);
        }
        let Some((pieces, rounding)) = self.pieces(curve, m, position, density, speed_max) else {
            return curve.loss(m, 0.0, density);
        };
        let Pieces { lower, line, upper } = pieces;
        smooth_max(lower, smooth_min(line, upper, rounding), rounding)
    }

    /// Full speed, the line that holds the set value and rest, and the rounding of the corners; none at rest.
    pub(super) fn pieces(
        self,
        curve: &HeadCurve,
        m: f64,
        position: f64,
        density: f64,
        speed_max: f64,
    ) -> Option<(Pieces, f64)> {
        let (line, _, whole) = self.held(curve, m, position, speed_max);
        let head_max_pa = speed_max * speed_max * curve.head_max_pa;
        let available = (position / whole / SWITCHED_OFF).clamp(0.0, 1.0);
        if available == 0.0 {
            return None;
        }
        let rounding = ROUNDING * available * available * head_max_pa;
        let lower = curve.loss(m, available * speed_max, density);
        Some((Pieces { lower, line, upper: curve.loss(m, 0.0, density) }, rounding))
    }

    /// The line that holds the set value, its change with that value, and the nominal flow or the head at
    /// zero flow.
    fn held(self, curve: &HeadCurve, m: f64, position: f64, speed_max: f64) -> (Linear, f64, f64) {
        let m_nominal = 0.5 * curve.m_free_kg_s;
        let head_max_pa = speed_max * speed_max * curve.head_max_pa;
        if self == Self::Flow {
            let least = LEAST_FLOW * m_nominal;
            let slope = head_max_pa / (FLOW_BAND * position.max(least));
            // Above the least flow the slope falls with the set flow as well.
            let by_position = -slope * if position > least { m / position } else { 1.0 };
            (Linear::new(slope * (m - position), slope), by_position, m_nominal)
        } else {
            let least = LEAST_HEAD * head_max_pa;
            let slope = DROOP * position.max(least) / m_nominal;
            let by_position = if position > least { DROOP * m / m_nominal - 1.0 } else { -1.0 };
            (Linear::new(slope * m - position, slope), by_position, head_max_pa)
        }
    }

    /// Change of `p_a - p_b` with the position at a given flow, Pa per unit of the position.
    pub(super) fn loss_by_position(
        self,
        curve: &HeadCurve,
        m: f64,
        position: f64,
        density: f64,
        speed_max: f64,
    ) -> f64 {
        if self == Self::Speed && position < 0.0 {
            return curve.loss_by_speed(-m, -position, density);
        }
        if self == Self::Speed {
            return curve.loss_by_speed(m, position, density);
        }
        let (held, by_position, whole) = self.held(curve, m, position, speed_max);
        if position < SWITCHED_OFF * whole {
            // Being switched off, which is no operating point: the quotient of differences will do.
            let step = 1e-3 * SWITCHED_OFF * whole;
            let (low, high) = ((position - step).max(0.0), position + step);
            let loss = |at: f64| self.loss(curve, m, at, density, speed_max).value;
            return (loss(high) - loss(low)) / (high - low);
        }
        let head_max_pa = speed_max * speed_max * curve.head_max_pa;
        let still = |law: Linear| Linear::new(law.value, 0.0);
        let rest = still(curve.loss(m, 0.0, density));
        let full = still(curve.loss(m, speed_max, density));
        let held = Linear::new(held.value, by_position);
        let rounding = ROUNDING * head_max_pa;
        // The weights of the rounding are those of the slopes.
        smooth_max(full, smooth_min(held, rest, rounding), rounding).slope
    }
}

/// How the set head of a pump follows the flow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Proportional {
    /// Flow from which on the set head holds, kg/s.
    pub m_design_kg_s: f64,
    /// Share of it at zero flow.
    pub zero_flow_share: f64,
}

impl Proportional {
    /// The head to hold at a flow, Pa.
    pub(super) fn head_pa(&self, set_pa: f64, m: f64) -> f64 {
        let share = (m / self.m_design_kg_s).clamp(0.0, 1.0);
        set_pa * (self.zero_flow_share + (1.0 - self.zero_flow_share) * share)
    }
}

impl PumpParams {
    /// How the set head follows the flow, with that mode.
    pub(super) fn proportional(
        &self,
        curve: &HeadCurve,
        speed_max: f64,
        density_kg_m3: f64,
    ) -> Result<Option<Proportional>, ElementError> {
        if self.mode != PumpMode::ProportionalHead {
            return match (self.m_flow_design_kg_s, self.zero_flow_share) {
                (None, None) => Ok(None),
                _ => Err(ElementError::Fields {
                    problem: "m_flow_design_kg_s and zero_flow_share belong to \
                              mode = \"proportional_head\""
                        .into(),
                }),
            };
        }
        let m_design_kg_s = match self.m_flow_design_kg_s {
            Some(m) => positive("m_flow_design_kg_s", m)?,
            None => {
                let head_pa = self.head_pa.unwrap_or(0.5 * curve.head_max_pa);
                curve.flow_at(head_pa, speed_max, density_kg_m3)
            }
        };
        let zero_flow_share = ratio("zero_flow_share", self.zero_flow_share.unwrap_or(0.5))?;
        Ok(Some(Proportional { m_design_kg_s, zero_flow_share }))
    }
}

impl super::Pump {
    /// Largest relative speed.
    pub fn speed_max(&self) -> f64 {
        self.speed_max
    }

    /// Whether the pump holds a value other than its speed.
    pub fn holds(&self) -> bool {
        self.mode != PumpMode::Speed
    }

    /// Whether what it holds is a flow, and not a head.
    pub fn holds_flow(&self) -> bool {
        self.mode == PumpMode::Flow
    }

    /// The same pump, holding a flow by its own choice of speed: its position is that flow, kg/s.
    #[must_use]
    pub fn holding_flow(&self) -> Self {
        Self { mode: PumpMode::Flow, proportional: None, ..self.clone() }
    }
}
