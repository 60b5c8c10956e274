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
mod ideal;

use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::Characteristic;
use anergy_core::error::FactorError;
use anergy_core::ids::{EdgeId, NodeId};
use assemble::NodalSystem;
use thiserror::Error;

/// Largest accepted pressure residual of an edge, Pa, at zero pressure level.
const RESIDUAL_PA: f64 = 1e-3;
/// The same relative to the largest pressure.
const RESIDUAL_RELATIVE: f64 = 1e-8;
/// Largest accepted mass residual of a node, kg/s.
const MASS_RESIDUAL_KG_S: f64 = 1e-9;
/// Largest accepted last step, kg/s and relative to the flow.
const STEP_KG_S: f64 = 1e-8;
const STEP_RELATIVE: f64 = 1e-7;
/// Water that a pressure reference may exchange, kg/s; more is an unbalanced circuit.
const REFERENCE_EXCHANGE_KG_S: f64 = 1e-6;
/// Bounds of the slopes that the matrix sees, Pa s/kg: beyond what any component has, so that they only
/// keep the matrix finite. A tighter floor shrinks the step of wide pipes, a tighter cap enlarges that of
/// closed valves.
const SLOPE_FLOOR: f64 = 1e-9;
const SLOPE_CAP: f64 = 1e16;
/// A step is accepted when the slope of the content has fallen to this share.
const CONTENT_SLOPE_SHARE: f64 = 0.5;
const MAX_ITERATIONS: u32 = 100;
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

/// Why there are no pressures and flows; ids, so that the caller can name them.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum HydraulicError {
    /// The iteration limit was reached.
    #[error(
        "no convergence after {iterations} iterations: edge {} misses its law by {residual_pa} Pa, node {} \
         its mass balance by {mass_residual_kg_s} kg/s", .edge.0, .node.0
    )]
    NotConverged {
        /// Iterations done.
        iterations: u32,
        /// The edge with the largest residual.
        edge: EdgeId,
        /// Its residual, Pa.
        residual_pa: f64,
        /// The node with the largest mass residual.
        node: NodeId,
        /// Its residual, kg/s.
        mass_residual_kg_s: f64,
    },
    /// More water enters than leaves a part of the network that is closed.
    #[error("{m_flow_kg_s} kg/s more enter than leave the closed part around node {}", .node.0)]
    Unbalanced {
        /// A node of the part.
        node: NodeId,
        /// Surplus, kg/s.
        m_flow_kg_s: f64,
    },
    /// An input is not a finite number.
    #[error("edge {} has a position or law that is not finite", .edge.0)]
    NotFinite {
        /// The edge.
        edge: EdgeId,
    },
    /// The nodal matrix could not be factorised.
    #[error(transparent)]
    Factor(#[from] FactorError),
}

/// The solver with its factorisation and work space; holds no state of the network.
pub struct HydraulicSolver {
    system: NodalSystem,
    /// Law of each edge at the present flow: loss Pa and slope Pa s/kg.
    loss: Vec<f64>,
    slope: Vec<f64>,
    imposed: Vec<bool>,
    /// Newton step of each edge, kg/s.
    step: Vec<f64>,
    trial: Vec<f64>,
    trial_loss: Vec<f64>,
    trial_slope: Vec<f64>,
}

impl HydraulicSolver {
    /// Analyses the topology; the network must be free of [`crate::graph::GraphProblem`]s.
    ///
    /// # Errors
    /// [`HydraulicError::Factor`] when the pattern cannot be analysed.
    pub fn new(network: &Network) -> Result<Self, HydraulicError> {
        let edges = network.edges.len();
        Ok(Self {
            system: NodalSystem::new(network)?,
            loss: vec![0.0; edges],
            slope: vec![1.0; edges],
            imposed: vec![false; edges],
            step: vec![0.0; edges],
            trial: vec![0.0; edges],
            trial_loss: vec![0.0; edges],
            trial_slope: vec![1.0; edges],
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
        self.evaluate(network, state)?;
        self.system.begin(network, state, &self.imposed)?;
        let mut mass_balanced = false;
        for iteration in 1..=MAX_ITERATIONS {
            self.bound_slopes();
            self.system.newton_step(
                network,
                state,
                &self.loss,
                &self.slope,
                &self.imposed,
                &mut self.step,
            )?;
            let largest_step = self.take_step(network, state, mass_balanced)?;
            mass_balanced = true;
            let residual = self.system.residuals(network, state, &self.loss, &self.imposed);
            if largest_step <= 1.0
                && residual.edge_pa.0 <= RESIDUAL_PA + RESIDUAL_RELATIVE * residual.largest_p_pa
                && residual.node_kg_s.0 <= MASS_RESIDUAL_KG_S
            {
                self.system.close(network, state);
                self.check_references(network, state)?;
                state.hydraulics_valid = true;
                return Ok(HydraulicReport {
                    iterations: iteration,
                    residual_pa: residual.edge_pa.0,
                    mass_residual_kg_s: residual.node_kg_s.0,
                });
            }
            if iteration == MAX_ITERATIONS {
                return Err(HydraulicError::NotConverged {
                    iterations: iteration,
                    edge: EdgeId::from_index(residual.edge_pa.1),
                    residual_pa: residual.edge_pa.0,
                    node: NodeId::from_index(residual.node_kg_s.1),
                    mass_residual_kg_s: residual.node_kg_s.0,
                });
            }
        }
        unreachable!("the loop returns in its last iteration")
    }

    /// Law of every edge at the flows of the state.
    fn evaluate(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
    ) -> Result<(), HydraulicError> {
        for (i, edge) in network.edges.iter().enumerate() {
            let law = edge.characteristic(state.m_flow_kg_s[i], &state.edge_state(network, i));
            let finite = match law {
                Characteristic::PressureLoss(law) => {
                    (self.loss[i], self.slope[i], self.imposed[i]) = (law.value, law.slope, false);
                    law.value.is_finite() && law.slope.is_finite()
                }
                Characteristic::ImposedFlow { m_flow_kg_s } => {
                    (self.loss[i], self.slope[i], self.imposed[i]) = (m_flow_kg_s, 1.0, true);
                    m_flow_kg_s.is_finite()
                }
                Characteristic::ImposedPressure { dp_pa } => {
                    (self.loss[i], self.slope[i], self.imposed[i]) = (dp_pa, 1.0, false);
                    dp_pa.is_finite()
                }
            };
            if !finite {
                return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
            }
        }
        Ok(())
    }

    /// Bounds the slopes that the matrix sees.
    fn bound_slopes(&mut self) {
        for slope in &mut self.slope {
            *slope = slope.clamp(SLOPE_FLOOR, SLOPE_CAP);
        }
    }

    /// Moves the flows along the Newton step; returns its largest size over the step tolerance.
    fn take_step(
        &mut self,
        network: &Network,
        state: &mut NetworkState,
        line_search: bool,
    ) -> Result<f64, HydraulicError> {
        let mut largest = 0.0_f64;
        // Slope of the content at the start of the step; pressures cancel, since the step has no net
        // inflow anywhere: g(alpha) = sum step (phi(m + alpha step) - (p_a - p_b) + rho g dz).
        let mut start = 0.0;
        for (i, step) in self.step.iter().enumerate() {
            let m = state.m_flow_kg_s[i];
            self.trial[i] = m + step;
            largest = largest.max(step.abs() / (STEP_KG_S + STEP_RELATIVE * self.trial[i].abs()));
            start -= step * step * self.slope[i];
        }
        let mut content_slope = self.evaluate_trial(network, state)?;
        if line_search && largest > 1.0 && content_slope > -CONTENT_SLOPE_SHARE * start {
            // The full step overshoots the minimum of the content along it: false position.
            let (mut low, mut low_slope, mut high, mut high_slope) =
                (0.0, start, 1.0, content_slope);
            for _ in 0..MAX_LINE_SEARCH {
                let secant = low + (high - low) * low_slope / (low_slope - high_slope);
                let alpha = secant.clamp(low + 0.1 * (high - low), high - 0.1 * (high - low));
                for (i, step) in self.step.iter().enumerate() {
                    self.trial[i] = state.m_flow_kg_s[i] + alpha * step;
                }
                content_slope = self.evaluate_trial(network, state)?;
                if content_slope.abs() <= -CONTENT_SLOPE_SHARE * start {
                    break;
                }
                if content_slope < 0.0 {
                    (low, low_slope) = (alpha, content_slope);
                } else {
                    (high, high_slope) = (alpha, content_slope);
                }
            }
        }
        std::mem::swap(&mut state.m_flow_kg_s, &mut self.trial);
        std::mem::swap(&mut self.loss, &mut self.trial_loss);
        std::mem::swap(&mut self.slope, &mut self.trial_slope);
        Ok(largest)
    }

    /// Laws at the trial flows and the slope of the content along the step there.
    fn evaluate_trial(
        &mut self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<f64, HydraulicError> {
        let mut content_slope = 0.0;
        for (i, edge) in network.edges.iter().enumerate() {
            match edge.characteristic(self.trial[i], &state.edge_state(network, i)) {
                Characteristic::PressureLoss(law) => {
                    (self.trial_loss[i], self.trial_slope[i]) = (law.value, law.slope);
                    let driving = state.dp_pa(network, i) - self.system.gravity_pa(i);
                    content_slope += self.step[i] * (law.value - driving);
                    if !law.value.is_finite() {
                        return Err(HydraulicError::NotFinite { edge: EdgeId::from_index(i) });
                    }
                }
                _ => (self.trial_loss[i], self.trial_slope[i]) = (self.loss[i], self.slope[i]),
            }
        }
        Ok(content_slope)
    }

    /// A pressure reference exchanges no water.
    fn check_references(
        &self,
        network: &Network,
        state: &NetworkState,
    ) -> Result<(), HydraulicError> {
        for (i, node) in network.nodes.iter().enumerate() {
            let exchange = state.exchange_kg_s[i];
            if node.kind == crate::graph::NodeKind::PressureReference
                && exchange.abs() > REFERENCE_EXCHANGE_KG_S
            {
                return Err(HydraulicError::Unbalanced {
                    node: NodeId::from_index(i),
                    m_flow_kg_s: -exchange,
                });
            }
        }
        Ok(())
    }
}
