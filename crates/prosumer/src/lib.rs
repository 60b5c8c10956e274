//! Thermal-only prosumer units: they see temperatures, flows and heat, never a pressure or the graph.

pub mod building;
pub mod circuit;
pub mod equipment;
pub mod thermal_unit;
