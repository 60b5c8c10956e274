//! What a pump is commanded: a speed, a flow or a head, within what it has.

use super::curve::HeadCurve;
use super::{PumpMode, PumpParams};
use crate::two_port::{Actuator, ElementError, not_negative};

impl PumpParams {
    /// What is commanded: the speed, or the flow or head up to what the curve has at full speed. Only a
    /// speed starts elsewhere than where its command leads.
    pub(super) fn actuator(
        &self,
        curve: &HeadCurve,
        speed_max: f64,
    ) -> Result<Actuator, ElementError> {
        let least = if self.reversible { -speed_max } else { 0.0 };
        let allowed = if self.reversible {
            "must lie between -speed_max and speed_max"
        } else {
            "must lie between 0 and speed_max"
        };
        within("speed", self.speed, least, speed_max, allowed)?;
        within("initial_speed", self.initial_speed, least, speed_max, allowed)?;
        within("speed_min", self.speed_min, 0.0, speed_max, "must lie between 0 and speed_max")?;
        let speeds = [self.speed, self.initial_speed, self.speed_min];
        let (position, unit, max) = match self.mode {
            PumpMode::Speed => ("speed", "", speed_max),
            PumpMode::Flow => ("m_flow_set_kg_s", "kg_s", speed_max * curve.m_free_kg_s),
            PumpMode::Head | PumpMode::ProportionalHead => {
                ("head_pa", "pa", speed_max * speed_max * curve.head_max_pa)
            }
        };
        let foreign = [
            (
                "speed, initial_speed and speed_min",
                speeds.iter().any(|&s| s != 0.0),
                &[PumpMode::Speed][..],
            ),
            ("reversible", self.reversible, &[PumpMode::Speed]),
            ("m_flow_set_kg_s", self.m_flow_set_kg_s.is_some(), &[PumpMode::Flow]),
            ("head_pa", self.head_pa.is_some(), &[PumpMode::Head, PumpMode::ProportionalHead]),
        ];
        if let Some((fields, ..)) =
            foreign.iter().find(|(_, given, modes)| *given && !modes.contains(&self.mode))
        {
            return Err(ElementError::Fields {
                problem: format!("{fields} given, but by its mode this pump holds {position}"),
            });
        }
        let up_to_full = |field, value: Option<f64>| {
            let allowed = "must lie between 0 and what the curve has at full speed";
            within(field, value.unwrap_or(0.0), 0.0, max, allowed)
        };
        let initial_command = match self.mode {
            PumpMode::Speed => self.speed,
            PumpMode::Flow => up_to_full("m_flow_set_kg_s", self.m_flow_set_kg_s)?,
            PumpMode::Head | PumpMode::ProportionalHead => up_to_full("head_pa", self.head_pa)?,
        };
        let starts_at_its_command = self.mode != PumpMode::Speed;
        Ok(Actuator {
            position,
            command: position,
            unit,
            initial_command,
            initial_position: if starts_at_its_command {
                initial_command
            } else {
                self.initial_speed
            },
            rise_time_s: not_negative("rise_time_s", self.rise_time_s)?,
            min: least,
            max,
        })
    }
}

fn within(
    field: &'static str,
    value: f64,
    min: f64,
    max: f64,
    requirement: &'static str,
) -> Result<f64, ElementError> {
    if (min..=max).contains(&value) {
        return Ok(value);
    }
    Err(ElementError::OutOfRange { field, value, requirement })
}
