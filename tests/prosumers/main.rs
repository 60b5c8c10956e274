//! Prosumers and balancing units: units, stations, houses, ambient grids.

mod ambient_day;
mod ambient_topologies;
mod balancing_systems;
mod building;
mod coupling;
mod every_unit;
mod heat_pump_classes;
mod heat_pumps;
mod hot_water;
mod houses;
mod kpis;
mod laboratory_houses;
mod prosumer_station;
mod rules;
mod storage;
mod storage_charging;
mod three_levels;
mod two_pipe;
mod weather;
