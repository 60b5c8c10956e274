//! REGISTRY of the hydraulic elements: adding one is one file, its `mod` line and its line below.

pub mod ball_valve;
pub mod check_valve;
pub mod dp_controller;
pub mod flow_limiter;
pub mod flow_source;
pub mod heat_exchanger;
pub mod heat_meter;
pub mod overflow_valve;
pub mod pipe;
pub mod pressure_reducing_valve;
pub mod pressure_source;
pub mod pressure_sustaining_valve;
pub mod pump;
pub mod resistance;
pub mod self_acting;
pub mod valve;

use crate::two_port::{ElementError, TwoPort};
use anergy_core::medium::Medium;

anergy_core::registry! {
    /// Every hydraulic element a model file can name.
    pub enum Element: dyn TwoPort, params ElementParams, context Medium, error ElementError {
        Pipe("pipe", pipe::Pipe, pipe::PipeParams),
        Pump("pump", pump::Pump, pump::PumpParams),
        Valve("valve", valve::Valve, valve::ValveParams),
        BallValve("ball_valve", ball_valve::BallValve, ball_valve::BallValveParams),
        OverflowValve("overflow_valve", overflow_valve::OverflowValve, overflow_valve::OverflowValveParams),
        FlowLimiter("flow_limiter", flow_limiter::FlowLimiter, flow_limiter::FlowLimiterParams),
        DpController("dp_controller", self_acting::SelfActing, dp_controller::DpControllerParams),
        PressureReducingValve("pressure_reducing_valve", self_acting::SelfActing, pressure_reducing_valve::PressureReducingValveParams),
        PressureSustainingValve("pressure_sustaining_valve", self_acting::SelfActing, pressure_sustaining_valve::PressureSustainingValveParams),
        CheckValve("check_valve", check_valve::CheckValve, check_valve::CheckValveParams),
        Resistance("resistance", resistance::Resistance, resistance::ResistanceParams),
        HeatExchanger("heat_exchanger", heat_exchanger::HeatExchanger, heat_exchanger::HeatExchangerParams),
        HeatMeter("heat_meter", heat_meter::HeatMeter, heat_meter::HeatMeterParams),
        FlowSource("flow_source", flow_source::FlowSource, flow_source::FlowSourceParams),
        PressureSource("pressure_source", pressure_source::PressureSource, pressure_source::PressureSourceParams),
    }
}

/// Flow coefficient k in kg/(s Pa^0.5) of a Kv value in m3/h at 1 bar (water of 1000 kg/m3).
///
/// `k = Kv rho/3600/sqrt(1e5) sqrt(1000/rho)`; for rho = 1000: `k = 8.784e-4 Kv`.
#[inline]
pub fn flow_coefficient(kv_m3_h: f64, density_kg_m3: f64) -> f64 {
    kv_m3_h * density_kg_m3 / 3600.0 / 1e5_f64.sqrt() * (1000.0 / density_kg_m3).sqrt()
}
