//! P6, missing piece: water that the plan does not show stands behind a pipe and is flushed when flow starts.
//!
//! **Equation** a plug of the volume V behind port b of the pipe: what enters leaves after `V` has passed.
//!
//! **Assumptions** it keeps its heat and has no friction: a piece three times as wide as the pipe, a ninth as long (its pressure loss
//! is below a two-thousandth of that of a piece of the pipe itself).
//!
//! **Neutral** `volume = 0`. **Looks like** a slug of always the same volume after a start or a switch; a longer pipe (P10) delays as
//! much but has friction and loss, a slow start of a generator (G3) does not depend on the flow.

use crate::effect::{EffectError, ModelChange, pipe};
use crate::model::Model;
use crate::overlay::Change;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::two_port::not_negative;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Bore of the piece over that of the pipe.
const WIDE: f64 = 3.0;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeadLeg {
    /// Water of the missing piece, m3; 0 changes nothing.
    pub volume_m3: f64,
}

impl DeadLeg {
    /// Checks the range.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("volume_m3", self.volume_m3)?;
        Ok(self.clone())
    }
}

impl ModelChange for DeadLeg {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let inner_diameter_m = WIDE * pipe(model, component)?.inner_diameter_m;
        if self.volume_m3 == 0.0 {
            return Ok(Vec::new());
        }
        let length_m = self.volume_m3 / (0.25 * PI * inner_diameter_m * inner_diameter_m);
        let piece = PipeParams { length_m, inner_diameter_m, ..PipeParams::default() };
        Ok(vec![Change::InsertInSeries {
            edge: component.to_owned(),
            id: format!("{component}.piece"),
            params: ElementParams::Pipe(piece),
        }])
    }
}
