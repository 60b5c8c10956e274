//! The signals of the weather.

use super::Builder;
use super::signals::{Writer, free_signal, temperature_signal};
use crate::plan::Plan;
use crate::temperatures::SURROUNDINGS;
use crate::weather::{SIGNALS, SUN, T_GROUND, Weather};
use crate::wording::refused;
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_core::signal::{SignalSpec, SignalTable};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI};

impl Builder<'_> {
    /// Adds the signals that the weather has; what drives them over time.
    pub(super) fn weather_signals(
        &mut self,
        signals: &mut SignalTable,
        ground: SignalId,
    ) -> Option<Weather> {
        let spec = self.model.weather.as_ref()?;
        let mut weather = spec.records.clone().map(|records| Weather {
            records,
            start_unix_ns: super::start_unix_ns(self.model),
            signals: [None; SIGNALS.len()],
        });
        let values = match &weather {
            None => spec.entry.constants(),
            Some(weather) => {
                weather.values((Time::ZERO, Time::ZERO), &mut None).unwrap_or_default()
            }
        };
        let has = match &weather {
            None => [true; SIGNALS.len()],
            Some(weather) => weather.records.has(),
        };
        let mut ids: [Option<SignalId>; SIGNALS.len()] = [None; SIGNALS.len()];
        for (i, (name, unit)) in SIGNALS.into_iter().enumerate() {
            if !has[i] {
                continue;
            }
            let (min, max) = match name.rsplit('.').next() {
                Some("relative_humidity") => (0.0, 1.0),
                Some("sun_elevation_rad") => (-FRAC_PI_2, FRAC_PI_2),
                Some("sun_azimuth_rad") => (-PI, PI),
                _ => (0.0, f64::INFINITY),
            };
            let signal = match unit {
                "k" => temperature_signal(name, values[i], &SURROUNDINGS),
                _ => SignalSpec { min, max, ..free_signal(name, unit, values[i]) },
            };
            ids[i] = Some(self.add_signal(signals, signal, &spec.place));
        }
        let t_ground_k = signals.spec(ground).initial;
        let signal = temperature_signal(T_GROUND, t_ground_k, &SURROUNDINGS);
        self.add_signal(signals, signal, &spec.place);
        if let Some(weather) = &mut weather {
            weather.signals = ids;
        }
        weather
    }

    /// The ground of the weather is that of `[ground]`, where nothing else drives it: to, from.
    pub(super) fn weather_ground(
        &self,
        plan: &Plan,
        writers: &HashMap<SignalId, Writer>,
    ) -> Option<(SignalId, SignalId)> {
        let signal = plan.signals.find(T_GROUND)?;
        (!writers.contains_key(&signal)).then_some((signal, plan.ground))
    }

    /// A unit that follows the sun of a weather without sun would stand in the dark without a word.
    pub(super) fn check_sun(&mut self, plan: &Plan, writers: &HashMap<SignalId, Writer>) {
        if self.model.weather.is_none() {
            return;
        }
        for (unit, spec) in plan.units.iter().zip(&self.model.units) {
            let ids = unit.inputs.clone().map(SignalId::from_index);
            let dark = ids.zip(unit.equipment.inputs()).find_map(|(id, input)| {
                let sun = SIGNALS[SUN..].iter().any(|(name, _)| Some(*name) == input.follows);
                let missing = sun && plan.signals.find(input.follows?).is_none();
                (missing && !writers.contains_key(&id)).then_some(input.follows?)
            });
            if let Some(signal) = dark {
                let what = format!("unit \"{}\"", unit.name);
                let message = format!("it follows {signal}, which [weather] does not have");
                let problem = refused(&what, &spec.place, None, &message);
                let hint =
                    "the file needs irradiances, and the place latitude_deg and longitude_deg";
                self.problems.push(problem.with_hint(hint));
            }
        }
    }
}
