//! What share of the electric power of a pump becomes hydraulic power: a constant, or a table over the
//! flow at full speed.

use super::PumpParams;
use crate::two_port::{ElementError, positive, ratio};
use anergy_core::numerics::interpolate::Pchip;

/// No pump is taken for worse: a table that begins with 0 has no power at zero flow otherwise.
const WORST: f64 = 0.05;

/// Overall efficiency of pump and motor.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Efficiency {
    Constant(f64),
    /// Over the volume flow at full speed; constant beyond its ends.
    Table(Pchip),
}

impl PumpParams {
    /// The efficiency with its parameters checked.
    pub(super) fn overall_efficiency(&self) -> Result<Efficiency, ElementError> {
        let constant = |field, value| positive(field, ratio(field, value)?);
        let hydraulic = constant("efficiency_hydraulic", self.efficiency_hydraulic)?;
        let motor = constant("efficiency_motor", self.efficiency_motor)?;
        if self.efficiency_v_flow_m3_s.is_empty() && self.efficiency.is_empty() {
            return Ok(Efficiency::Constant(hydraulic * motor));
        }
        for &value in &self.efficiency {
            ratio("efficiency", value)?;
        }
        match Pchip::new(&self.efficiency_v_flow_m3_s, &self.efficiency) {
            Ok(table) => Ok(Efficiency::Table(table)),
            Err(error) => Err(ElementError::Table {
                field: "efficiency_v_flow_m3_s",
                problem: error.to_string(),
            }),
        }
    }
}

impl Efficiency {
    /// At a volume flow, reduced to full speed.
    pub(super) fn at(&self, v: f64) -> f64 {
        match self {
            Self::Constant(efficiency) => *efficiency,
            Self::Table(table) => {
                let (first, last) = table.range();
                table.at(v.clamp(first, last)).value.max(WORST)
            }
        }
    }
}
