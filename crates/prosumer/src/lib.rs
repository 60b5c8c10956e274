//! Thermal-only prosumer units: they see temperatures, flows and heat, never a pressure or the graph.

pub mod building;
pub mod circuit;
pub mod compressor;
pub mod direct_exchange;
pub mod equipment;
pub mod heat_pump;
pub mod performance_map;
pub mod thermal_unit;
