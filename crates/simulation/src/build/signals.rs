//! Signals, and who writes them: units, schedules, series.

use super::Builder;
use crate::diagnostic::did_you_mean;
use crate::document::Span;
use crate::drivers::Driver;
use crate::model::Place;
use crate::model_file::NodeEntryKind;
use crate::plan::NodeInputs;
use crate::temperatures::Temperatures;
use crate::wording::{in_percent, in_words};
use anergy_core::clock::Time;
use anergy_core::ids::SignalId;
use anergy_core::signal::{SignalSpec, SignalTable};
use anergy_core::units::Unit;
use smol_str::SmolStr;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;

/// Who writes a signal.
pub(super) struct Writer {
    pub what: SmolStr,
    pub span: Span,
}

impl Builder<'_> {
    pub(super) fn node_signals(&mut self, signals: &mut SignalTable) -> Vec<NodeInputs> {
        let mut inputs = Vec::new();
        for (node, spec) in self.model.nodes.iter().enumerate() {
            let entry = &spec.entry;
            let held = self.model.references.iter().find(|r| r.entry.node == entry.id);
            let pressure = held.map(|r| r.entry.pressure_pa).or(entry.pressure_pa);
            let mut add = |quantity: &str, unit: &'static str, value: f64| {
                let signal = free_signal(&format!("{}.{quantity}", entry.id), unit, value);
                self.add_signal(signals, signal, &spec.place)
            };
            let exchanges = entry.kind != NodeEntryKind::Junction;
            if held.is_some() || exchanges {
                let of_kind = |kind| entry.kind == kind;
                let held = held.is_some_and(|r| r.entry.vessel_volume_m3.is_none());
                let p_pa = (held || of_kind(NodeEntryKind::PressureBoundary))
                    .then(|| add("pressure_pa", "pa", pressure.unwrap_or(0.0)));
                let m_flow_kg_s = of_kind(NodeEntryKind::Source)
                    .then(|| add("m_flow_kg_s", "kg_s", entry.m_flow_kg_s.unwrap_or(0.0)));
                let t_k = exchanges.then(|| {
                    let value = entry.temperature_k.unwrap_or(self.model.run.initial_k);
                    let name = format!("{}.temperature_k", entry.id);
                    let signal = temperature_signal(&name, value, &self.liquid());
                    self.add_signal(signals, signal, &spec.place)
                });
                inputs.push(NodeInputs { node, p_pa, m_flow_kg_s, t_k });
            }
        }
        inputs
    }

    pub(super) fn drivers(
        &mut self,
        signals: &SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> Vec<Driver> {
        let mut drivers = Vec::new();
        // Columns of one file share their times.
        let mut known_times: HashMap<*const f64, Arc<[Time]>> = HashMap::new();
        // Signals that follow one column in one unit share its values.
        let mut known_values: HashMap<(*const f64, &str), Arc<[f64]>> = HashMap::new();
        for spec in &self.model.drivers {
            let Some(signal) = signals.find(&spec.signal) else {
                let names = signals.specs().iter().map(|signal| signal.name.as_str());
                let hint = did_you_mean(&spec.signal, names)
                    .unwrap_or_else(|| "`anergy check --signals` lists all signals".into());
                let message = format!("{}: there is no such signal", spec.source);
                self.report(message, spec.place.of("signal"), Some(hint));
                continue;
            };
            self.claim(writers, signal, signals, &spec.source, spec.place.of("signal"));
            let known = signals.spec(signal);
            let Some(unit) =
                self.driver_unit(spec.unit.as_deref(), known, &spec.source, &spec.place)
            else {
                continue;
            };
            let values: Arc<[f64]> = match unit {
                Some(unit) => {
                    let key = (spec.values.as_ptr(), unit.suffix);
                    let convert = || spec.values.iter().map(|value| unit.to_si(*value)).collect();
                    known_values.entry(key).or_insert_with(convert).clone()
                }
                None => spec.values.clone(),
            };
            if let Some(i) = values.iter().position(|v| !(known.min..=known.max).contains(v)) {
                let message = format!(
                    "{}: value {} at {} s is outside the range of the signal: {}",
                    spec.source,
                    spec.values[i],
                    spec.times_s[i],
                    range(known, unit)
                );
                let span =
                    spec.place.of(if spec.place.has("points") { "points" } else { "column" });
                let percent = || "for values in percent add unit = \"percent\"".to_owned();
                let hint = ratio_hint(known, values[i]).map(|_| percent());
                let hint = hint.or_else(|| celsius_hint(known, values[i]));
                self.report(message, span, hint.filter(|_| unit.is_none()));
                continue;
            }
            let key = spec.times_s.as_ptr();
            let times = known_times.get(&key).cloned().or_else(|| {
                let times: Option<Arc<[Time]>> =
                    spec.times_s.iter().map(|s| Time::from_s(*s)).collect();
                known_times.extend(times.iter().map(|times| (key, times.clone())));
                times
            });
            let Some(times) = times else {
                let message = format!("{}: a time is beyond what can be simulated", spec.source);
                self.report(message, spec.place.span.range(), None);
                continue;
            };
            drivers.push(Driver { signal, interpolation: spec.interpolation, times, values });
        }
        drivers
    }

    /// A signal has one writer.
    pub(super) fn claim(
        &mut self,
        writers: &mut HashMap<SignalId, Writer>,
        signal: SignalId,
        signals: &SignalTable,
        what: &str,
        span: Option<Range<usize>>,
    ) {
        let at = span.clone().map_or(Span::NONE, Span::from);
        let writer = Writer { what: what.into(), span: at };
        if let Some(before) = writers.insert(signal, writer) {
            let name = &signals.spec(signal).name;
            let message = format!("signal \"{name}\" is driven by {} and by {what}", before.what);
            self.report(
                message,
                span.or(before.span.range()),
                Some("a signal has one driver".into()),
            );
        }
    }

    /// The unit a driver's values are written in; the outer `None` after a report.
    pub(super) fn driver_unit(
        &mut self,
        unit: Option<&str>,
        signal: &SignalSpec,
        source: &str,
        place: &Place,
    ) -> Option<Option<Unit>> {
        let Some(word) = unit else { return Some(None) };
        let suffix = word.trim().to_lowercase().replace('/', "_").replace('%', "percent");
        let si = if signal.unit.is_empty() { "1" } else { signal.unit };
        if suffix == si {
            return Some(None);
        }
        let found = Unit::find(&suffix);
        if let Some(unit) = found.filter(|unit| unit.si == signal.unit) {
            return Some(Some(unit));
        }
        let possible: Vec<&str> = anergy_core::units::UNITS
            .iter()
            .filter(|unit| unit.si == signal.unit)
            .map(|unit| unit.suffix)
            .chain(std::iter::once(si))
            .collect();
        let message = format!("{source}: unit \"{word}\" does not fit the signal");
        let hint = format!("possible units: {}", possible.join(", "));
        self.report(message, place.of("unit"), Some(hint));
        None
    }
}

/// `0 to 1`: the values a signal can have, in the unit its values are written in.
pub(super) fn range(signal: &SignalSpec, unit: Option<Unit>) -> String {
    let written = |si: f64| {
        let value = unit.map_or(si, |unit| unit.of_si(si));
        // Without the rounding of the conversion.
        (value * 1e9).round() / 1e9
    };
    let (min, max) = (written(signal.min), written(signal.max));
    let suffix = in_words(unit.map_or(signal.unit, |unit| unit.suffix));
    let suffix = if suffix.is_empty() { suffix } else { format!(" {suffix}") };
    match (min.is_finite(), max.is_finite()) {
        (true, false) => format!("at least {min}{suffix}"),
        (false, true) => format!("at most {max}{suffix}"),
        _ => format!("{min} to {max}{suffix}"),
    }
}

/// A temperature in degC that was read in K.
fn celsius_hint(signal: &SignalSpec, value: f64) -> Option<String> {
    let meant = Unit::find("degc").filter(|unit| unit.si == signal.unit)?.to_si(value);
    (signal.min..=signal.max)
        .contains(&meant)
        .then(|| "for values in degC add unit = \"degC\"".to_owned())
}

/// What to write instead of a ratio in percent.
pub(super) fn ratio_hint(signal: &SignalSpec, value: f64) -> Option<String> {
    in_percent(value).filter(|_| signal.unit.is_empty() && signal.min >= 0.0 && signal.max <= 2.0)
}

pub(super) fn free_signal(name: &str, unit: &'static str, initial: f64) -> SignalSpec {
    SignalSpec { name: name.into(), unit, initial, min: f64::NEG_INFINITY, max: f64::INFINITY }
}

pub(super) fn temperature_signal(name: &str, initial: f64, range: &Temperatures) -> SignalSpec {
    let (min, max) = range.range_k();
    SignalSpec { name: name.into(), unit: "k", initial, min, max }
}
