//! REGISTRY of the controllers: adding one is one file, its `mod` line and its line below.

pub mod pi;

use crate::controller::{ControlError, Controller};

anergy_core::registry! {
    /// Every controller a model file can name.
    pub enum LocalController: dyn Controller, params ControllerParams, context (), error ControlError {
        Pi("pi", pi::Pi, pi::PiParams),
    }
}
