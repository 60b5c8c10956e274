//! How the pump of a generator sets its flow, as the capacity flow in W/K.

use super::map::measured_share;
use anergy_core::medium::Medium;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A supply that is held leaves at least this above the return, K.
const LEAST_DIFFERENCE_K: f64 = 0.5;

/// How the pump of a generator sets its flow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GeneratorFlow {
    /// Supply and return differ by a given temperature.
    ConstantTemperatureDifference,
    /// They differ as measured at the reference boiler: less than the given temperature at part load.
    MeasuredTemperatureDifference,
    /// The flow is given, the temperature difference floats.
    ConstantFlow,
    /// The flow is set so that the water leaves with the set supply temperature.
    ConstantSupply,
}

/// What the command of a generator is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GeneratorCommand {
    /// The load, `modulation`.
    Power,
    /// The supply temperature, `supply_set_k`, with a constant flow; `modulation` above 0 releases it.
    SupplyTemperature,
}

/// How the flow follows from the heat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum FlowRule {
    Difference(f64),
    Measured(f64),
    /// Capacity flow, W/K.
    Flow(f64),
    /// Largest capacity flow, W/K.
    Supply(f64),
}

/// What the flow follows from.
pub(super) struct FlowWish {
    /// Steady heat times the share of the flow, W.
    pub heat_w: f64,
    /// Load.
    pub modulation: f64,
    /// Water that arrives, K.
    pub return_k: f64,
    /// Water as it is to leave, K.
    pub supply_set_k: f64,
    /// Share of the flow of the phase.
    pub flow: f64,
}

impl FlowRule {
    /// The capacity flow, W/K.
    pub(super) fn capacity_w_k(&self, wish: &FlowWish) -> f64 {
        match *self {
            Self::Difference(difference_k) => wish.heat_w / difference_k,
            Self::Measured(difference_k) => {
                wish.heat_w / (difference_k * measured_share(wish.modulation, wish.return_k))
            }
            Self::Flow(capacity_w_k) => capacity_w_k * wish.flow,
            Self::Supply(most_w_k) => {
                let lift_k = (wish.supply_set_k - wish.return_k).max(LEAST_DIFFERENCE_K);
                (wish.heat_w / lift_k).min(most_w_k)
            }
        }
    }
}

/// How the flow follows, from the fields of a model file: difference, K, constant and largest flow, m3/s.
pub(super) fn flow_rule(
    medium: &Medium,
    control: GeneratorFlow,
    difference_k: f64,
    (v_flow_m3_s, v_flow_max_m3_s): (f64, f64),
) -> FlowRule {
    let capacity_w_k =
        |v_flow_m3_s: f64| v_flow_m3_s * medium.density_kg_m3 * medium.heat_capacity_j_kg_k;
    match control {
        GeneratorFlow::ConstantTemperatureDifference => FlowRule::Difference(difference_k),
        GeneratorFlow::MeasuredTemperatureDifference => FlowRule::Measured(difference_k),
        GeneratorFlow::ConstantFlow => FlowRule::Flow(capacity_w_k(v_flow_m3_s)),
        GeneratorFlow::ConstantSupply => FlowRule::Supply(capacity_w_k(v_flow_max_m3_s)),
    }
}
