//! Hydraulics: elements, networks of every shape, and programs nobody here wrote.

mod analytic;
mod epanet;
mod every_element;
mod gains;
mod ibpsa_components;
mod inertia;
mod pandapipes_ref;
mod plant;
mod prescribed;
mod pressure_holding;
mod pump_modes;
mod random_networks;
mod reference_network;
mod robustness;
mod self_acting;
mod tables;
mod three_way_valve;
mod topologies;
