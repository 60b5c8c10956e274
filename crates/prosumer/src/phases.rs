//! Phases of the low-voltage grid: on which a unit stands.
//!
//! **Equation** the powers of the three phases add up to that of the unit; a unit of one phase has all of its power there,
//! one of three phases a third on each. **Assumptions** real power only. **Sources** connection of single-phase
//! devices `vde4100`.

use crate::thermal_unit::{UnitError, UnitOutput};

/// Phases.
pub(crate) const PHASES: usize = 3;
/// Outputs of a unit that says its phases; a connection sums them up.
const OUTPUTS: [&str; PHASES] = ["phase_1_w", "phase_2_w", "phase_3_w"];

/// The outputs.
pub(crate) fn outputs() -> impl Iterator<Item = UnitOutput> {
    OUTPUTS.iter().map(|name| UnitOutput::new(name, "W"))
}

/// Refuses a phase that there is not.
pub(crate) fn check(phase: Option<u32>) -> Result<(), UnitError> {
    let requirement = "must be 1, 2 or 3; leave it out for a unit of three phases";
    match phase {
        None | Some(1..=3) => Ok(()),
        Some(phase) => {
            Err(UnitError::OutOfRange { field: "phase", value: f64::from(phase), requirement })
        }
    }
}

/// Writes the powers of the phases of a unit that stands on one; nothing of one that does not say it.
pub(crate) fn write(phase: Option<u32>, power_w: f64, out: &mut [f64]) {
    if let Some(phase) = phase {
        for (i, out) in out.iter_mut().enumerate() {
            *out = if i + 1 == phase as usize { power_w } else { 0.0 };
        }
    }
}
