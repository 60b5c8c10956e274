//! Thermal-only prosumer units: they see temperatures, flows and heat, never a pressure or the graph.

pub mod building;
pub mod burner;
pub mod calendar;
pub mod circuit;
pub mod compressor;
pub mod coupling;
pub mod direct_exchange;
mod efficiency_factor;
pub mod equipment;
pub mod ground_source;
pub mod heat_pump;
pub mod hot_water_draws;
pub mod performance_map;
mod phases;
pub mod thermal_unit;
