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
mod heads;
mod ideal;
mod islands;
mod line_search;
pub mod linearize;
mod pieces;
mod position;
mod prescribed;
mod reconsider;
mod regulated;
mod without;

use crate::graph::{Edge, Network};
use crate::inertia::Opposition;
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
/// A full step that overshoots by less than this share is accepted in the first iterations; laws with
/// kinks could go round in circles so.
const OVERSHOOT_SHARE: f64 = 0.1;
const HASTY_ITERATIONS: u32 = 12;
/// Beyond this pressure difference no component holds, and the rounding of pressures moves water.
const ABSURD_PA: f64 = 1e10;
/// Iterations from given flows, and from those of a first solve.
const MAX_ITERATIONS_GIVEN: u32 = 100;
const MAX_ITERATIONS: u32 = 300;

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

/// The solver with its factorisation and work space; holds no state of the network.
pub struct HydraulicSolver {
    system: NodalSystem,
    kind: Vec<Kind>,
    laws: Laws,
    /// What `laws` was evaluated at, where `known`.
    known_state: Vec<EdgeState>,
    known_m_kg_s: Vec<f64>,
    known: bool,
    /// What the pressures drive less the loss at the flows of the last trial, Pa.
    miss_pa: Vec<f64>,
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
    corners: pieces::Corners,
    heads: heads::Heads,
    openings: regulated::Openings,
    opposition: Opposition,
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
            miss_pa: vec![0.0; edges],
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
            corners: pieces::Corners::new(network),
            heads: heads::Heads::new(network),
            openings: regulated::Openings::new(network),
            opposition: Opposition::new(),
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
        if self.opposition.take(network, state) {
            self.known = false;
        }
        let report = if network.regulators.is_empty() {
            self.solve_given(network, state)?
        } else {
            self.solve_regulated(network, state)?
        };
        self.check_references(network, state)?;
        state.hydraulics_valid = self.rests(state);
        Ok(report)
    }

    /// Whether the flows found are those that the pressures drive without inertia.
    fn rests(&self, state: &NetworkState) -> bool {
        state.m_flow_kg_s.iter().enumerate().all(|(i, m)| {
            let Some((resistance, before)) = self.opposition.get(i) else { return true };
            let steady_slope = self.laws.slope[i] - resistance;
            let allowed_kg_s = CORRECTION_KG_S + CORRECTION_RELATIVE * m.abs();
            (resistance * (m - before)).abs() <= steady_slope * allowed_kg_s
        })
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

    /// Solves with the laws, or what stands for them: from the flows of the state, and where they lead
    /// nowhere from those of a first solve.
    fn solve_laws(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<HydraulicReport, HydraulicError> {
        let mut starts = state.m_flow_kg_s.iter().zip(&network.edges);
        let first = starts.all(|(m, edge)| *m == edge.start_m_flow_kg_s());
        let mut before = 0;
        if !first {
            before = self.choose_pieces(network, state)?;
            if let Some(report) = self.iterate(network, state, MAX_ITERATIONS_GIVEN)? {
                return Ok(HydraulicReport { iterations: before + report.iterations, ..report });
            }
            before += MAX_ITERATIONS_GIVEN;
        }
        for (m, edge) in state.m_flow_kg_s.iter_mut().zip(&network.edges) {
            *m = edge.start_m_flow_kg_s();
        }
        self.system.forget_pressures(state);
        before += self.choose_pieces(network, state)?;
        match self.iterate(network, state, MAX_ITERATIONS)? {
            Some(report) => {
                let iterations = before + report.iterations;
                Ok(HydraulicReport { iterations, ..report })
            }
            None => Err(self.not_converged(network, state)),
        }
    }

    /// Newton from the flows of the state; none at the limit of iterations.
    fn iterate(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        most: u32,
    ) -> Result<Option<HydraulicReport>, HydraulicError> {
        self.evaluate(network, state)?;
        self.system.begin(network, state, &self.kind, &self.laws)?;
        self.system.misses(state, &self.laws, &mut self.miss_pa);
        let mut mass_balanced = false;
        for iteration in 1..=most {
            let overshoot = if iteration <= HASTY_ITERATIONS { OVERSHOOT_SHARE } else { 0.0 };
            // While the heads move the content does too: only full steps meet what is given.
            let together = self.heads.together;
            let line_search = mass_balanced && !(together && iteration <= heads::FULL_TOGETHER);
            let Self { system, kind, laws, miss_pa, step, .. } = self;
            system.newton_step(state, kind, laws, miss_pa, step)?;
            if together {
                self.meet(network, state)?;
            }
            let trial = self.take_step(network, state, line_search, overshoot)?;
            mass_balanced =
                iteration > reconsider::ITERATIONS || !self.reconsider(network, state)?;
            if !mass_balanced {
                continue;
            }
            let largest_p_pa = self.system.largest_p_pa();
            if self.corners.open && trial.residual_pa <= pieces::RESIDUAL * largest_p_pa {
                return Ok(Some(HydraulicReport { iterations: iteration, ..Default::default() }));
            }
            if trial.correction <= 1.0
                && trial.residual_pa <= RESIDUAL_PA + RESIDUAL_RELATIVE * largest_p_pa
                && self.surrounds(network, state)
                && (!together || self.largest_miss(network, state) <= 1.0)
            {
                let (mass_residual_kg_s, _) = self.system.mass_residual(state);
                if mass_residual_kg_s <= MASS_RESIDUAL_KG_S {
                    self.keep_known(state);
                    self.system.close(network, state);
                    return Ok(Some(HydraulicReport {
                        iterations: iteration,
                        residual_pa: trial.residual_pa,
                        mass_residual_kg_s,
                    }));
                }
            }
        }
        Ok(None)
    }

    /// The laws belong to the flows of the state, but for those for which something stands.
    fn keep_known(&mut self, state: &NetworkState) {
        self.known_m_kg_s.copy_from_slice(&state.m_flow_kg_s);
        for (m, stand) in self.known_m_kg_s.iter_mut().zip(&self.stand) {
            if *stand != Stand::Own {
                *m = f64::NAN;
            }
        }
        self.known = true;
    }

    /// What an edge answers, or what stands for it.
    #[inline]
    fn answer(&self, edge: &Edge, i: usize, m: f64, state: &EdgeState) -> Characteristic {
        match self.stand.get(i) {
            Some(stand) => stand.characteristic(m, || self.own_answer(edge, i, m, state)),
            None => self.own_answer(edge, i, m, state),
        }
    }

    #[inline]
    fn own_answer(&self, edge: &Edge, i: usize, m: f64, state: &EdgeState) -> Characteristic {
        let piece = self.corners.open.then(|| self.corners.characteristic(edge, i, m, state));
        let own = piece.flatten().unwrap_or_else(|| edge.characteristic(m, state));
        match (own, self.opposition.get(i)) {
            (Characteristic::PressureLoss(loss), Some((resistance, before))) => {
                let opposes = Linear::new(resistance * (m - before), resistance);
                Characteristic::PressureLoss(loss + opposes)
            }
            _ => own,
        }
    }

    /// Law of every edge at the flows of the state; those that are known are kept.
    fn evaluate(&mut self, network: &Network, state: &NetworkState) -> Result<(), HydraulicError> {
        let known = std::mem::replace(&mut self.known, false);
        for (i, edge) in network.edges.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            let edge_state = state.edge_state(network, i);
            let own = self.stand.get(i).is_none_or(|stand| *stand == Stand::Own);
            if known && own && self.known_m_kg_s[i] == m && self.known_state[i] == edge_state {
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
}
