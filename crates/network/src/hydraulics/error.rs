//! Why a network has no pressures and flows.

use anergy_core::error::{FactorError, Legible};
use anergy_core::ids::{EdgeId, NodeId};
use thiserror::Error;

/// Why there are no pressures and flows; ids, so that the caller can name them.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum HydraulicError {
    /// The iteration limit was reached.
    #[error(
        "no convergence after {iterations} iterations: edge {} misses its law by {residual_pa:.3e} Pa, node {} \
         its mass balance by {mass_residual_kg_s:.3e} kg/s", .edge.0, .node.0
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
    /// The given flows would need pressures that nothing holds, and that cannot be computed either.
    #[error("edge {} would need {dp_pa:.3e} Pa to pass {} kg/s", .edge.0, Legible(*.m_flow_kg_s))]
    Absurd {
        /// The edge, for example a valve that is closed but for its leak.
        edge: EdgeId,
        /// Pressure difference, Pa.
        dp_pa: f64,
        /// Flow, kg/s.
        m_flow_kg_s: f64,
    },
    /// More water enters than leaves a part of the network that is closed.
    #[error("{} kg/s more enter than leave the closed part around node {}", Legible(*.m_flow_kg_s), .node.0)]
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
    /// The actuator of a free edge changes nothing of what is prescribed.
    #[error("the actuator of edge {} has no effect on what is prescribed for it", .edge.0)]
    NoEffect {
        /// The free edge.
        edge: EdgeId,
    },
    /// The pressure level beside a free edge is not determined.
    #[error("nothing determines the pressures beside the free edge {}", .edge.0)]
    Undetermined {
        /// The free edge.
        edge: EdgeId,
    },
    /// It could not be decided whether a prescription is held or at a limit.
    #[error("no position of the free edge {} was found for what is prescribed", .edge.0)]
    Undecided {
        /// The free edge.
        edge: EdgeId,
    },
    /// A self-acting valve does not come to rest.
    #[error("the self-acting valve on edge {} misses its opening by {miss}", .edge.0)]
    Hunting {
        /// The valve.
        edge: EdgeId,
        /// Largest miss of an opening.
        miss: f64,
    },
    /// The nodal matrix could not be factorised.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
