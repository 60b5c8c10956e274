//! REGISTRY of the controllers: adding one is one file, its `mod` line and its line below; one with more
//! than one channel and one signal also has a line in [`ports`].

pub mod cascade;
pub mod hysteresis;
pub mod pi;
pub mod thermostatic_valve;

use crate::controller::{ControlError, Controller, Ports};

anergy_core::registry! {
    /// Every controller a model file can name.
    pub enum LocalController: dyn Controller, params ControllerParams, context (), error ControlError {
        Pi("pi", pi::Pi, pi::PiParams),
        Cascade("cascade", cascade::Cascade, cascade::CascadeParams),
        ThermostaticValve("thermostatic_valve", thermostatic_valve::ThermostaticValve, thermostatic_valve::ThermostaticValveParams),
        Hysteresis("hysteresis", hysteresis::Hysteresis, hysteresis::HysteresisParams),
    }
}

/// The channels and signals that a kind names.
pub fn ports(kind: &str) -> Ports {
    match kind {
        "cascade" => cascade::PORTS,
        _ => Ports::SINGLE,
    }
}
