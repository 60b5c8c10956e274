//! Pressures and flows of the whole network: Newton in global gradient form.
//!
//! **Equation** with the slopes `D = d phi/d m` of the edges and `w = 1/D`, in increments `d p` of the
//! free node pressures: `(A w A^T) dp = net inflow of m + w r`, `r = p_a - p_b - rho g (z_b - z_a) -
//! phi(m)`, then `m += w (r + dp_a - dp_b)`. Solving for increments keeps the mass balance exact to
//! rounding whatever the pressure level.
//!
//! **Numerics** every law is strictly monotone, so the problem is the minimisation of a convex content:
//! after the first full step, which makes the flows satisfy the mass balance, a line search on the
//! derivative of the content always succeeds. Edges with imposed flow leave the matrix through
//! `w = 0`, so the pattern never changes; ideal head sources merge their nodes once and for all;
//! islands behind imposed flows keep their last pressure level.
//!
//! **Sources** Todini and Pilati 1988, Collins et al. 1978 (keys `todini1988`, `collins1978`).

mod assemble;
mod diagnosis;
mod error;
mod ideal;
pub mod linearize;
mod position;
mod prescribed;
mod reconsider;
mod regulated;
mod without;

use crate::graph::{Edge, Network};
use crate::state::NetworkState;
use crate::two_port::{Characteristic, EdgeState};
use anergy_core::ids::EdgeId;
use anergy_core::linear::Linear;
use assemble::NodalSystem;
pub use error::HydraulicError;
use prescribed::Stand;

/// Largest accepted pressure residual of an edge, Pa, at zero pressure level.
const RESIDUAL_PA: f64 = 1e-5;
/// The same relative to the largest pressure.
const RESIDUAL_RELATIVE: f64 = 1e-11;
/// Largest accepted mass residual of a node, kg/s.
const MASS_RESIDUAL_KG_S: f64 = 1e-9;
/// Flow by which an edge may still miss its law if its ends keep their pressures, kg/s and relative.
const CORRECTION_KG_S: f64 = 1e-11;
const CORRECTION_RELATIVE: f64 = 1e-10;
/// Water that a pressure reference may exchange, kg/s; more is an unbalanced circuit.
const REFERENCE_EXCHANGE_KG_S: f64 = 1e-6;
/// Bounds of the slopes that the matrix sees, Pa s/kg: beyond what any component has, so that they only
/// keep the matrix finite. A tighter floor shrinks the step of wide pipes, a tighter cap enlarges that of
/// closed valves.
const SLOPE_FLOOR: f64 = 1e-9;
const SLOPE_CAP: f64 = 1e16;
/// A step is accepted when the slope of the content has fallen to this share.
const CONTENT_SLOPE_SHARE: f64 = 0.5;
/// A full step that overshoots by less than this share is accepted in the first iterations; laws with
/// kinks could go round in circles so.
const OVERSHOOT_SHARE: f64 = 0.1;
const HASTY_ITERATIONS: u32 = 12;
/// Rounding of a pressure difference, relative to the largest pressure.
const PRESSURE_ROUNDING: f64 = 2e-15;
/// Beyond this pressure difference no component holds, and the rounding of pressures moves water.
const ABSURD_PA: f64 = 1e10;
const MAX_ITERATIONS: u32 = 300;
const MAX_LINE_SEARCH: u32 = 40;

/// How a solve went.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct HydraulicReport {
    /// Newton iterations.
    pub iterations: u32,
    /// Largest pressure residual of an edge, Pa.
    pub residual_pa: f64,
    /// Largest mass residual of a node, kg/s.
    pub mass_residual_kg_s: f64,
}

/// How an edge enters the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// With its law.
    Law,
    /// With a given flow.
    Imposed,
    /// As an ideal head source, which merges its nodes.
    Ideal,
}

/// Laws of the edges at some flows: loss Pa (or the imposed flow, kg/s) and slope Pa s/kg.
struct Laws {
    loss: Vec<f64>,
    slope: Vec<f64>,
}

/// What a trial step found.
struct Trial {
    /// Slope of the content along the step.
    content_slope: f64,
    /// Largest pressure residual, Pa.
    residual_pa: f64,
    /// Largest flow that an edge would change by if its ends kept their pressures, over the tolerance;
    /// misses within the rounding of the pressures do not count.
    correction: f64,
}

/// The solver with its factorisation and work space; holds no state of the network.
pub struct HydraulicSolver {
    system: NodalSystem,
    kind: Vec<Kind>,
    laws: Laws,
    /// What `laws` was evaluated at, where `known`.
    known_state: Vec<EdgeState>,
    known_m_kg_s: Vec<f64>,
    known: bool,
    /// Newton step of each edge, kg/s.
    step: Vec<f64>,
    trial_m_kg_s: Vec<f64>,
    trial_laws: Laws,
    /// What stands for the law of each edge; empty without prescriptions.
    stand: Vec<Stand>,
    /// An edge through which nothing flows, whatever its law.
    shut: Option<EdgeId>,
    /// Sign of each prescribed flow in the free edge, where it carries it itself.
    carried: Vec<Option<f64>>,
    /// Whether each prescription was tried with its actuator open in this solve.
    opened: Vec<bool>,
    heads: prescribed::Heads,
    openings: regulated::Openings,
}

impl HydraulicSolver {
    /// Analyses the topology; the network must be free of [`crate::graph::GraphProblem`]s.
    ///
    /// # Errors
    /// [`HydraulicError::Factor`] when the pattern cannot be analysed.
    pub fn new(network: &Network) -> Result<Self, HydraulicError> {
        let edges = network.edges.len();
        let laws = || Laws { loss: vec![0.0; edges], slope: vec![1.0; edges] };
        let nowhere = EdgeState { position: 0.0, density_kg_m3: 0.0, viscosity_pa_s: 0.0 };
        Ok(Self {
            system: NodalSystem::new(network)?,
            kind: vec![Kind::Law; edges],
            laws: laws(),
            known_state: vec![nowhere; edges],
            known_m_kg_s: vec![0.0; edges],
            known: false,
            step: vec![0.0; edges],
            trial_m_kg_s: vec![0.0; edges],
            trial_laws: laws(),
            stand: if network.prescriptions.is_empty() {
                Vec::new()
            } else {
                vec![Stand::Own; edges]
            },
            shut: None,
            carried: prescribed::carried(network),
            opened: vec![false; network.prescriptions.len()],
            heads: prescribed::Heads::new(network),
            openings: regulated::Openings::new(network),
        })
    }

    /// Solves pressures and flows for the present positions and boundary values, starting from the
    /// flows in `state`. Returns at once when they already belong to them.
    ///
    /// # Errors
    /// [`HydraulicError`] names the culprit.
    pub fn solve(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        if state.hydraulics_valid {
            return Ok(HydraulicReport::default());
        }
        let report = if network.regulators.is_empty() {
            self.solve_given(network, state)?
        } else {
            self.solve_regulated(network, state)?
        };
        self.check_references(network, state)?;
        state.hydraulics_valid = true;
        Ok(report)
    }

    /// Solves at the present openings of the self-acting valves.
    fn solve_given(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        if network.prescriptions.is_empty() {
            self.solve_laws(network, state)
        } else {
            self.solve_prescribed(network, state)
        }
    }

    /// Solves with the laws, or what stands for them.
    fn solve_laws(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        self.evaluate(network, state)?;
        self.system.begin(network, state, &self.kind, &self.laws)?;
        let mut mass_balanced = false;
        for iteration in 1..=MAX_ITERATIONS {
            let overshoot = if iteration <= HASTY_ITERATIONS { OVERSHOOT_SHARE } else { 0.0 };
            self.system.newton_step(state, &self.kind, &self.laws, &mut self.step)?;
            let trial = self.take_step(network, state, mass_balanced, overshoot)?;
            mass_balanced =
                iteration > reconsider::ITERATIONS || !self.reconsider(network, state)?;
            if !mass_balanced {
                continue;
            }
            let largest_p_pa = self.system.largest_p_pa();
            if trial.correction <= 1.0
                && trial.residual_pa <= RESIDUAL_PA + RESIDUAL_RELATIVE * largest_p_pa
            {
                let (mass_residual_kg_s, _) = self.system.mass_residual(state);
                if mass_residual_kg_s <= MASS_RESIDUAL_KG_S {
                    self.known_m_kg_s.copy_from_slice(&state.m_flow_kg_s);
                    self.known = self.stand.is_empty();
                    self.system.close(network, state);
                    return Ok(HydraulicReport {
                        iterations: iteration,
                        residual_pa: trial.residual_pa,
                        mass_residual_kg_s,
                    });
                }
            }
        }
        Err(self.not_converged(network, state))
    }

    /// What an edge answers, or what stands for it.
    #[inline]
    fn answer(&self, edge: &Edge, i: usize, m: f64, state: &EdgeState) -> Characteristic {
        match self.stand.get(i) {
            Some(stand) => stand.characteristic(m, || edge.characteristic(m, state)),
            None => edge.characteristic(m, state),
        }
    }

    /// Law of every edge at the flows of the state; those that are known are kept.
    fn evaluate(&mut self, network: &Network, state: &NetworkState) -> Result<(), HydraulicError> {
        let known = std::mem::replace(&mut self.known, false);
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let edge_state = state.edge_state(network, i);
            if known && self.known_m_kg_s[i] == m && self.known_state[i] == edge_state {
                continue;
            }
            self.known_state[i] = edge_state;
            let (kind, law) = match self.answer(edge, i, m, &edge_state) {
                Characteristic::PressureLoss(law) => (Kind::Law, law),
                Characteristic::ImposedFlow { m_flow_kg_s } => {
                    (Kind::Imposed, Linear::new(m_flow_kg_s, 1.0))
                }
                Characteristic::ImposedPressure { dp_pa } => (Kind::Ideal, Linear::new(dp_pa, 1.0)),
            };
            if !(law.value.is_finite() && law.slope.is_finite()) {
                return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
            }
            self.kind[i] = kind;
            self.laws.loss[i] = law.value;
            self.laws.slope[i] = law.slope.clamp(SLOPE_FLOOR, SLOPE_CAP);
        }
        Ok(())
    }

    /// Moves the flows along the Newton step.
    fn take_step(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        line_search: bool,
        overshoot: f64,
    ) -> Result<Trial, HydraulicError> {
        // Slope of the content at the start of the step; pressures cancel, since the step has no net
        // inflow anywhere: g(alpha) = sum step (phi(m + alpha step) - (p_a - p_b) + rho g dz).
        let mut start = 0.0;
        let mut moved = 0.0;
        for (i, step) in self.step.iter().enumerate() {
            if self.kind[i] == Kind::Law {
                moved += step.abs();
                start -= step * step * self.laws.slope[i];
            }
        }
        let mut trial = self.evaluate_trial(network, state, 1.0)?;
        // Below the rounding of the pressures the slope says nothing, and only a full step balances mass.
        let rounding = PRESSURE_ROUNDING * self.system.largest_p_pa() * moved;
        if line_search && trial.content_slope > rounding - overshoot * start {
            // The full step overshoots the minimum of the content along it: false position and halving.
            let (mut low, mut low_slope, mut high, mut high_slope) =
                (0.0, start, 1.0, trial.content_slope);
            for i in 0..MAX_LINE_SEARCH {
                let secant = low + (high - low) * low_slope / (low_slope - high_slope);
                let margin = 0.1 * (high - low);
                let alpha = if i % 2 == 0 {
                    secant.clamp(low + margin, high - margin)
                } else {
                    0.5 * (low + high)
                };
                trial = self.evaluate_trial(network, state, alpha)?;
                // The content has surely fallen: it is convex, so it fell by -low_slope low at least and
                // rose by content_slope (alpha - low) at most.
                let falls = trial.content_slope * (alpha - low).max(0.0) <= -0.5 * low_slope * low;
                if falls && trial.content_slope.abs() <= -CONTENT_SLOPE_SHARE * start {
                    break;
                }
                if trial.content_slope < 0.0 {
                    (low, low_slope) = (alpha, trial.content_slope);
                } else {
                    (high, high_slope) = (alpha, trial.content_slope);
                }
            }
        }
        std::mem::swap(&mut state.m_flow_kg_s, &mut self.trial_m_kg_s);
        std::mem::swap(&mut self.laws, &mut self.trial_laws);
        Ok(trial)
    }

    /// Laws at the flows that this share of the step leads to.
    fn evaluate_trial(
        &mut self,
        network: &Network,
        state: &NetworkState,
        share: f64,
    ) -> Result<Trial, HydraulicError> {
        let rounding = PRESSURE_ROUNDING * self.system.largest_p_pa();
        let mut trial = Trial { content_slope: 0.0, residual_pa: 0.0, correction: 0.0 };
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i] + share * self.step[i];
            self.trial_m_kg_s[i] = m;
            if self.kind[i] != Kind::Law {
                self.trial_laws.loss[i] = self.laws.loss[i];
                self.trial_laws.slope[i] = self.laws.slope[i];
                continue;
            }
            let Characteristic::PressureLoss(law) =
                self.answer(edge, i, m, &state.edge_state(network, i))
            else {
                return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
            };
            let miss = self.system.driving_pa(state, i) - law.value;
            let slope = law.slope.clamp(SLOPE_FLOOR, SLOPE_CAP);
            self.trial_laws.loss[i] = law.value;
            self.trial_laws.slope[i] = slope;
            trial.content_slope -= self.step[i] * miss;
            let size = miss.abs();
            if !size.is_finite() {
                return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
            }
            trial.residual_pa = trial.residual_pa.max(size);
            let tolerance = slope * (CORRECTION_KG_S + CORRECTION_RELATIVE * m.abs());
            if size - rounding > trial.correction * tolerance {
                trial.correction = (size - rounding) / tolerance;
            }
        }
        Ok(trial)
    }
}
