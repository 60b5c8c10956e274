//! Hydraulics and thermal transport of a network graph; knows no prosumer and no names.
//!
//! A network is a directed multigraph of [`graph::Node`]s (pressure, temperature) and
//! [`graph::Edge`]s (mass flow). [`hydraulics`] solves pressures and flows, [`transport`] carries
//! temperatures, [`interface`] couples thermal-only units to edges.

pub mod blocking;
pub mod buried_pipe;
pub mod effectiveness;
pub mod elements;
pub mod film;
pub mod friction;
pub mod graph;
pub mod ground;
pub mod holding;
pub mod hydraulics;
pub mod inertia;
pub mod interface;
mod memory;
pub mod pipe_catalogue;
pub mod soil;
pub mod state;
pub mod transport;
pub mod two_port;
pub mod well_posed;

pub use hydraulics::linearize;
