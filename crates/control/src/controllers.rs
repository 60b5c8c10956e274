//! REGISTRY of the controllers: adding one is one file, its `mod` line and its line below; one with more
//! than one channel and one signal also has a line in [`ports`].

pub mod balancing;
pub mod cascade;
pub mod feed_forward;
pub mod hysteresis;
pub mod pi;
pub mod rule;
pub mod storage_charging;
pub mod tank_charging;
pub mod thermostatic_valve;
pub mod two_step;
pub mod weighted_pi;

use crate::controller::{ControlError, Controller, Ports};

anergy_core::registry! {
    /// Every controller a model file can name.
    pub enum LocalController: dyn Controller, params ControllerParams, context (), error ControlError {
        Pi("pi", pi::Pi, pi::PiParams),
        Cascade("cascade", cascade::Cascade, cascade::CascadeParams),
        ThermostaticValve("thermostatic_valve", thermostatic_valve::ThermostaticValve, thermostatic_valve::ThermostaticValveParams),
        Hysteresis("hysteresis", hysteresis::Hysteresis, hysteresis::HysteresisParams),
        WeightedPi("weighted_pi", weighted_pi::WeightedPi, weighted_pi::WeightedPiParams),
        TwoStep("two_step", two_step::TwoStep, two_step::TwoStepParams),
        StorageCharging("storage_charging", storage_charging::StorageCharging, storage_charging::StorageChargingParams),
        Balancing("balancing", balancing::Balancing, balancing::BalancingParams),
        TwoSensors("two_sensors", tank_charging::TankCharging, tank_charging::TwoSensorsParams),
        TankCharging("tank_charging", tank_charging::TankCharging, tank_charging::TankChargingParams),
        Rule("rule", rule::Rule, rule::RuleParams),
        FeedForward("feed_forward", feed_forward::FeedForward, feed_forward::FeedForwardParams),
    }
}

/// The channels and signals that a kind names.
pub fn ports(kind: &str) -> Ports {
    match kind {
        "balancing" => balancing::PORTS,
        "storage_charging" => storage_charging::PORTS,
        "cascade" => cascade::PORTS,
        "rule" => rule::PORTS,
        "tank_charging" => tank_charging::TANK,
        "two_sensors" => tank_charging::TWO_SENSORS,
        "two_step" => two_step::PORTS,
        "weighted_pi" => weighted_pi::PORTS,
        _ => Ports::SINGLE,
    }
}
