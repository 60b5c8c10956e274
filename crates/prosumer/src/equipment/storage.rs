//! Thermal storage: an upright tank of stratified water, in one dimension.
//!
//! **Equation** per layer, from the bottom, `rho cp V_l dT_l/dt = sum_ports m_in cp (T_in - T_l) + cp m_up
//! (T_(l-1) - T_l) + cp m_down (T_(l+1) - T_l) + Q_buoy,(l-1)->l - Q_buoy,l->(l+1) + lambda A_c/dz (T_(l+1) -
//! 2 T_l + T_(l-1)) - UA_l (T_l - T_amb) + Q_coil,l + Q_rod,l`; see `layers` (geometry), `ports` (flows), `mixed_layers` and `plug_flow` (advection),
//! `exchange` (conduction, loss, buoyancy), `coil`, `rod`, `tank` (a step of all of it).
//!
//! **Assumptions** water of the same height has the same temperature; what enters mixes by its momentum only where a
//! `jet` is given (water of the wrong density mixes by buoyancy); the wall holds no heat of its own. **Validity** measured
//! for a storage of 785 l with ten layers; a step that moves less than the tank. **Numerics** parts of a
//! step by the flow through a layer; heat exact for any step.
//!
//! **State** six numbers, two per coil, and one per layer (mixed) or four per layer and one (plug flow): 8
//! bytes each.
//!
//! **Sources** `zinsmeister2023`; `kleinbach1993` (comparison of one-dimensional models with
//! measurements).

mod build;
mod coil;
mod exchange;
mod jet;
mod layers;
mod mixed_layers;
mod plug_flow;
mod ports;
mod promise;
mod rod;
mod tank;
mod unit;

pub use build::U_W_M2_K;
pub use coil::StorageCoil;
pub use layers::MAX_LAYERS;
pub use ports::{MAX_PORTS, StorageConnection, StoragePort};
pub use rod::StorageRod;
pub use tank::{Buoyancy, Scheme};
pub use unit::Storage;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A storage as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageParams {
    /// Volume of its water, m3.
    pub volume_m3: f64,
    /// Height of its water, m.
    pub height_m: f64,
    /// Number of layers of equal height, 1 to 200; layer 1 is at the bottom.
    #[serde(default = "default_layers")]
    pub layers: usize,
    /// How water moves between the layers: `mixed_layers` or `plug_flow`.
    #[serde(default)]
    pub scheme: Scheme,
    /// Where water passes through the tank, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub ports: BTreeMap<String, StoragePort>,
    /// Coils in the tank, by name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub coils: BTreeMap<String, StorageCoil>,
    /// Electric rod in the tank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rod: Option<StorageRod>,
    /// Loss per area of the envelope, W/(m2 K); 0.35 without this and `ua_w_k`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub u_w_m2_k: Option<f64>,
    /// Loss of the whole envelope, W/K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ua_w_k: Option<f64>,
    /// Loss of pipes, feet and other bridges at each layer, W/K, from the bottom.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bridges_w_k: Vec<f64>,
    /// Temperature around the storage while nothing drives it, K.
    #[serde(default = "default_ambient")]
    pub ambient_k: f64,
    /// Conductivity of water, wall and built-in parts over the cross-section of the water, W/(m K).
    #[serde(default = "default_conductivity")]
    pub conductivity_w_m_k: f64,
    /// What becomes of warm water below cold water: `gradual` or `at_once`.
    #[serde(default)]
    pub buoyancy: Buoyancy,
    /// Conductance with which heat rises from a layer to a colder one above it, W/K.
    #[serde(default = "default_buoyancy")]
    pub buoyancy_w_k: f64,
    /// How far below and above a port water is drawn along with what leaves, m.
    #[serde(default)]
    pub entrainment_m: f64,
    /// Share of the water that enters which mixes with the neighbouring layers where it has no buoyancy; 0 for none.
    #[serde(default)]
    pub jet_share: f64,
    /// Richardson number of the jet at which half of that is left.
    #[serde(default = "default_jet_richardson")]
    pub jet_richardson: f64,
    /// Inner diameter of the ports, m: it gives the velocity of the jet.
    #[serde(default = "default_port_diameter")]
    pub port_diameter_m: f64,
    /// Temperature at which the state of charge is 0, K.
    #[serde(default = "default_empty")]
    pub soc_empty_k: f64,
    /// Temperature at which the state of charge is 1, K.
    #[serde(default = "default_full")]
    pub soc_full_k: f64,
    /// Temperature at the start, K; without one of these fields that of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_k: Option<f64>,
    /// Temperature of the lowest layer at the start, K; linear up to `initial_top_k`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_bottom_k: Option<f64>,
    /// Temperature of the highest layer at the start, K.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub initial_top_k: Option<f64>,
    /// Temperatures of the layers at the start, K, from the bottom.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub initial_layers_k: Vec<f64>,
    /// Temperatures at the start of any number of sensors evenly along the height, K, from the bottom.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub initial_sensors_k: Vec<f64>,
}

fn default_layers() -> usize {
    10
}

fn default_ambient() -> f64 {
    291.15
}

fn default_conductivity() -> f64 {
    0.644
}

fn default_buoyancy() -> f64 {
    900.0
}

fn default_jet_richardson() -> f64 {
    1.0
}

fn default_port_diameter() -> f64 {
    0.025
}

fn default_empty() -> f64 {
    303.15
}

fn default_full() -> f64 {
    363.15
}

/// The reference storage of 785 l with a port for charging.
impl Default for StorageParams {
    fn default() -> Self {
        let charge =
            StoragePort { inlet_m: Some(1.6), outlet_m: Some(0.26), ..StoragePort::default() };
        Self {
            volume_m3: 0.785,
            height_m: 1.755,
            layers: default_layers(),
            scheme: Scheme::default(),
            ports: BTreeMap::from([("charge".to_owned(), charge)]),
            coils: BTreeMap::new(),
            rod: None,
            u_w_m2_k: None,
            ua_w_k: None,
            bridges_w_k: Vec::new(),
            ambient_k: default_ambient(),
            conductivity_w_m_k: default_conductivity(),
            buoyancy: Buoyancy::default(),
            buoyancy_w_k: default_buoyancy(),
            entrainment_m: 0.0,
            jet_share: 0.0,
            jet_richardson: default_jet_richardson(),
            port_diameter_m: default_port_diameter(),
            soc_empty_k: default_empty(),
            soc_full_k: default_full(),
            initial_k: None,
            initial_bottom_k: None,
            initial_top_k: None,
            initial_layers_k: Vec::new(),
            initial_sensors_k: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests;
