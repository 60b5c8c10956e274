//! REGISTRY of the effects: adding one is one file, its `mod` line and its line below.

mod dispersion;
mod friction;
mod insulation;
mod length;
mod standstill;
mod surroundings;
mod wall;

use crate::effect::{EffectError, ModelChange};

anergy_core::registry! {
    /// Every effect a model file can name; the words are the catalogue's.
    pub enum Effect: dyn ModelChange, params EffectParams, context (), error EffectError {
        Wall("P1", wall::Wall, wall::Wall),
        Insulation("P2", insulation::Insulation, insulation::Insulation),
        Surroundings("P3", surroundings::Surroundings, surroundings::Surroundings),
        Standstill("P5", standstill::Standstill, standstill::Standstill),
        Dispersion("P7", dispersion::Dispersion, dispersion::Dispersion),
        Friction("P8", friction::Friction, friction::Friction),
        Length("P10", length::Length, length::Length),
    }
}
