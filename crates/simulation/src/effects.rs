//! REGISTRY of the effects: adding one is one file, its `mod` line and its line below.

mod auxiliary;
mod dead_leg;
mod dead_volume;
mod defrosting;
mod dispersion;
mod efficiency;
mod fouling;
mod friction;
mod ground_capacity;
mod inlet_jet;
mod insulation;
mod leak;
mod length;
mod metal;
mod node_leak;
mod parasitic_flow;
mod part_load;
mod pump_head;
mod standstill;
mod start;
mod storage_conductivity;
mod storage_loss;
mod suction;
mod surroundings;
mod three_way_leak;
mod wall;

use crate::effect::{EffectError, ModelChange};

anergy_core::registry! {
    /// Every effect a model file can name; the words are the catalogue's.
    pub enum Effect: dyn ModelChange, params EffectParams, context (), error EffectError {
        Wall("P1", wall::Wall, wall::Wall),
        Insulation("P2", insulation::Insulation, insulation::Insulation),
        Surroundings("P3", surroundings::Surroundings, surroundings::Surroundings),
        GroundCapacity("P4", ground_capacity::GroundCapacity, ground_capacity::GroundCapacity),
        Standstill("P5", standstill::Standstill, standstill::Standstill),
        DeadLeg("P6", dead_leg::DeadLeg, dead_leg::DeadLeg),
        Dispersion("P7", dispersion::Dispersion, dispersion::Dispersion),
        Friction("P8", friction::Friction, friction::Friction),
        Length("P10", length::Length, length::Length),
        ParasiticFlow("H1", parasitic_flow::ParasiticFlow, parasitic_flow::ParasiticFlow),
        Suction("H2", suction::Suction, suction::Suction),
        PumpHead("H3", pump_head::PumpHead, pump_head::PumpHead),
        Leak("H4", leak::Leak, leak::Leak),
        StorageLoss("T1", storage_loss::StorageLoss, storage_loss::StorageLoss),
        StorageConductivity("T2", storage_conductivity::StorageConductivity, storage_conductivity::StorageConductivity),
        DeadVolume("T3", dead_volume::DeadVolume, dead_volume::DeadVolume),
        InletJet("T4", inlet_jet::InletJet, inlet_jet::InletJet),
        EfficiencyLevel("G1", efficiency::EfficiencyLevel, efficiency::EfficiencyLevel),
        PartLoad("G2", part_load::PartLoad, part_load::PartLoad),
        Start("G3", start::Start, start::Start),
        Defrosting("G4", defrosting::Defrosting, defrosting::Defrosting),
        Auxiliary("G6", auxiliary::Auxiliary, auxiliary::Auxiliary),
        Metal("G7", metal::Metal, metal::Metal),
        Fouling("X1", fouling::Fouling, fouling::Fouling),
        ThreeWayLeak("H8", three_way_leak::ThreeWayLeak, three_way_leak::ThreeWayLeak),
        NodeLeak("P11", node_leak::NodeLeak, node_leak::NodeLeak),
    }
}
