//! The seam of a controller that a user adds to a simulation: Rust code, or a Python object.
//!
//! It says less of itself than a [`Controller`](crate::controller::Controller) of a model file: the steady
//! solve and the analysis of stability hold its signals where they are.

use crate::controller::{ControlError, Timing};

/// A controller from outside of the model file. It takes its signals over from schedules and controllers.
pub trait UserController: Send + Sync {
    /// When it updates; the interval must be positive.
    fn timing(&self) -> Timing;

    /// Forgets what was: called at the start of a simulation and when it is reset.
    ///
    /// # Errors
    /// [`ControlError`] when it cannot begin.
    fn start(&mut self) -> Result<(), ControlError> {
        Ok(())
    }

    /// Reads the measured values of `time_s` and writes the outputs, which are given as they are now.
    ///
    /// # Errors
    /// [`ControlError`] when no output can be given.
    fn update(
        &mut self,
        time_s: f64,
        measured: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError>;
}
