//! A definition that fits a model, and its members on all cores.
//!
//! **Numerics** a member is the model with the changes of an overlay, built and run as any other model. Nothing of it
//! depends on when or where it runs: values come from the seed of the ensemble, and so do the seeds of its random
//! numbers, `mix(seed, member, name)`, cut to 52 bits so that files of every kind can hold them.

use crate::definition::{Definition, How, Random, Variation};
use crate::member::{self, Outcome, Wanted};
use crate::members::Members;
use anergy_core::units::{Unit, is_difference, split_suffix};
use anergy_recording::selection::{choose, glob};
use anergy_simulation::build::build;
use anergy_simulation::diagnostic::{Diagnostic, Diagnostics};
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::run::RunOptions;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;
use thiserror::Error;

/// Real time between two looks at whether to go on.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);
/// Outcomes that wait for whoever keeps them, per thread: more would only take memory.
const WAITING: usize = 2;

/// Why there is no ensemble.
#[derive(Debug, Error)]
pub enum EnsembleError {
    /// The model is wrong before anything is varied.
    #[error("the model: {0}")]
    Model(Diagnostics),
    /// The definition does not fit the model.
    #[error("the variations: {0}")]
    Variations(Diagnostics),
}

/// A parameter of the model, and the unit of the values it is given in.
#[derive(Debug, Clone, PartialEq)]
struct Target {
    parameter: String,
    unit: Option<Unit>,
}

/// A model and its variations.
#[derive(Debug, Clone)]
pub struct Ensemble {
    model: Arc<Model>,
    definition: Definition,
    members: Members,
    /// Per variation.
    targets: Vec<Vec<Target>>,
    /// Names of what draws random numbers.
    draws: Vec<String>,
    wanted: Wanted,
    options: RunOptions,
}

impl Ensemble {
    /// Looks up everything that the definition names.
    ///
    /// # Errors
    /// Problems of the model, or of the definition with places in its text.
    pub fn new(model: Arc<Model>, definition: Definition) -> Result<Self, EnsembleError> {
        let plan = build(&model).map_err(EnsembleError::Model)?;
        let mut problems = Vec::new();
        let parameters = model.parameters();
        let known: HashMap<&str, &Value> =
            parameters.iter().map(|(name, value)| (name.as_str(), value)).collect();
        let targets = definition.variations.iter().map(|variation| {
            let found = targets(variation, &parameters, &known, &model);
            found.unwrap_or_else(|problem| {
                problems.push(problem);
                Vec::new()
            })
        });
        let targets = targets.collect();
        let patterns = &definition.keep.channels;
        let channels = match choose(plan.channels(), patterns, &[]) {
            Ok(_) if patterns.is_empty() => Vec::new(),
            Ok(chosen) => chosen.into_iter().map(|channel| channel.name).collect(),
            Err(error) => {
                let place = definition.keep_places.of_field(&["channels"]);
                problems.push(Diagnostic::new(format!("keep: {error}"), place));
                Vec::new()
            }
        };
        if !problems.is_empty() {
            return Err(EnsembleError::Variations(Diagnostics(problems)));
        }
        let draws = match definition.random() {
            Random::Same => Vec::new(),
            Random::Own => model.seeds().into_iter().map(|(name, _)| name).collect(),
        };
        Ok(Self {
            members: Members::of(&definition),
            targets,
            draws,
            wanted: Wanted { kpis: definition.keep.kpis.clone(), channels },
            options: RunOptions {
                until: definition.run.until.map(|until| until.0),
                step: definition.run.step,
                record: definition.run.record.map(|record| record.0),
            },
            model,
            definition,
        })
    }

    /// The model before anything is varied.
    pub fn model(&self) -> &Arc<Model> {
        &self.model
    }

    /// The definition.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Names of the channels that are kept.
    pub fn channels(&self) -> &[String] {
        &self.wanted.channels
    }

    /// Values of a member, one per variation, as written in the definition.
    pub fn values(&self, member: usize) -> Vec<Value> {
        self.members.values(&self.definition, member)
    }

    /// What makes the model of a member, seeds of its random numbers included.
    pub fn changes(&self, member: usize) -> Vec<Change> {
        let mut changes = Vec::new();
        let variations = self.definition.variations.iter().zip(&self.targets);
        for ((variation, targets), value) in variations.zip(self.values(member)) {
            changes.extend(targets.iter().map(|Target { parameter, unit }| {
                let parameter = parameter.clone();
                match (variation.how, value.as_f64()) {
                    (How::Scale, factor) => {
                        Change::Scale { parameter, factor: factor.unwrap_or(f64::NAN) }
                    }
                    (How::Set, Some(number)) if unit.is_some() => {
                        let si = unit.map_or(number, |unit| unit.to_si(number));
                        Change::Set { parameter, value: Value::from(si) }
                    }
                    (How::Set, _) => Change::Set { parameter, value: value.clone() },
                }
            }));
        }
        let seed = self.definition.ensemble.seed;
        changes.extend(self.draws.iter().map(|name| Change::Set {
            parameter: format!("{name}.seed"),
            value: Value::from(member_seed(seed, member, name)),
        }));
        changes
    }

    /// How a member is run.
    pub fn options(&self) -> RunOptions {
        self.options
    }

    /// The indicators that are kept, of the `kpis` of a summary: `component.quantity_unit` and number.
    pub fn indicators(&self, told: &Value) -> Map<String, Value> {
        member::indicators(told, &self.wanted.kpis)
    }

    /// Runs a member; `None` when `keep_going`, which is asked after every recorded row, said no.
    pub fn run(&self, member: usize, keep_going: &mut dyn FnMut() -> bool) -> Option<Outcome> {
        let model = self.model.with(&self.changes(member)).map_err(|error| error.to_string());
        let result = match model {
            Ok(model) => member::run(&model, self.options, &self.wanted, keep_going)?,
            Err(message) => Err(message),
        };
        Some(Outcome { member, values: self.values(member), result })
    }

    /// Runs members in threads. `each` gets what has finished, in any order, and nothing now and then in between; with
    /// `false` it stops the others, of which it hears no more.
    pub fn run_all(
        &self,
        members: &[usize],
        threads: usize,
        each: &mut dyn FnMut(Option<Outcome>) -> bool,
    ) {
        let threads = threads.clamp(1, members.len().max(1));
        let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (sender, receiver) = mpsc::sync_channel::<Outcome>(WAITING * threads);
        let work = |sender: mpsc::SyncSender<Outcome>| {
            while !stop.load(Ordering::Relaxed) {
                let Some(member) = members.get(next.fetch_add(1, Ordering::Relaxed)) else {
                    return;
                };
                let outcome = self.run(*member, &mut || !stop.load(Ordering::Relaxed));
                if outcome.is_some_and(|outcome| sender.send(outcome).is_err()) {
                    return;
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..threads {
                let sender = sender.clone();
                scope.spawn(|| work(sender));
            }
            drop(sender);
            loop {
                let outcome = match receiver.recv_timeout(LOOK_INTERVAL) {
                    Ok(outcome) => Some(outcome),
                    Err(RecvTimeoutError::Timeout) => None,
                    Err(RecvTimeoutError::Disconnected) => break,
                };
                if !each(outcome) {
                    break;
                }
            }
            stop.store(true, Ordering::Relaxed);
            drop(receiver);
        });
    }

    /// What tells this ensemble from others: a folder of results belongs to one.
    pub fn identity(&self) -> Value {
        let plain = self.model.to_plain_toml().unwrap_or_else(|_| self.model.text.to_string());
        let mut hash = Sha256::new();
        hash.update(&plain);
        if let Some(records) = self.model.weather.as_ref().and_then(|w| w.records.as_ref()) {
            hash.update(format!("{records:?}"));
        }
        let hash: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        json!({
            "program": format!("anergy {}", env!("CARGO_PKG_VERSION")),
            "model": self.model.name,
            "model_sha256": hash,
            "members": self.len(),
            "variations": self.definition.document,
        })
    }
}

/// Threads that keep this machine busy.
pub fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The seed of random numbers of a member: SplitMix64 over the seed of the ensemble, the member and who draws.
fn member_seed(seed: u32, member: usize, name: &str) -> u64 {
    let mix = |state: u64, word: u64| {
        let mut z = (state ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let start = mix(mix(0, u64::from(seed)), member as u64);
    name.bytes().fold(start, |state, byte| mix(state, u64::from(byte))) >> 12
}

/// The parameters that a variation means.
fn targets(
    variation: &Variation,
    parameters: &[(String, Value)],
    known: &HashMap<&str, &Value>,
    model: &Model,
) -> Result<Vec<Target>, Diagnostic> {
    let place = variation.places.of_field(&["parameter", "parameters"]);
    let problem = |message: String, hint: String| {
        let message = format!("variation \"{}\": {message}", variation.name);
        Diagnostic::new(message, place.clone()).with_hint(hint)
    };
    let mut found: Vec<Target> = Vec::new();
    for written in &variation.parameters {
        let before = found.len();
        let (pattern, unit) = in_si(written);
        for (form, unit) in [(written.as_str(), None), (pattern.as_str(), unit)] {
            if found.len() > before {
                break;
            }
            let matching: Vec<&str> = match form.contains(['*', '?']) {
                false => known.get_key_value(form).into_iter().map(|(name, _)| *name).collect(),
                // A pattern means the numbers.
                true => parameters
                    .iter()
                    .filter(|(name, value)| value.is_number() && glob(form, name))
                    .map(|(name, _)| name.as_str())
                    .collect(),
            };
            found
                .extend(matching.iter().map(|name| Target { parameter: (*name).to_owned(), unit }));
        }
        if found.len() == before {
            return Err(problem(
                format!("there is no parameter \"{written}\""),
                nearest(written, known),
            ));
        }
        if variation.how == How::Scale && unit.is_some_and(|unit| unit.suffix == "degc") {
            let hint = "scale it in K, or set values".to_owned();
            return Err(problem(format!("\"{written}\" in degC cannot be scaled"), hint));
        }
    }
    for target in &found {
        if model.drivers.iter().any(|driver| driver.signal == target.parameter) {
            let message = format!(
                "\"{}\" follows a schedule or a series: its own value is never used",
                target.parameter
            );
            return Err(problem(
                message,
                "take the schedule out of the model, or vary something else".into(),
            ));
        }
    }
    Ok(found)
}

/// A name in the SI unit of its field, and the unit it was written in.
fn in_si(written: &str) -> (String, Option<Unit>) {
    let (component, field) = written.rsplit_once('.').unwrap_or(("", written));
    let other = split_suffix(field).and_then(|(stem, suffix)| {
        let unit =
            Unit::find(suffix).filter(|unit| unit.suffix != "degc" || !is_difference(stem))?;
        Some((stem, unit))
    });
    match other {
        Some((stem, unit)) => {
            let field =
                if unit.si.is_empty() { stem.to_owned() } else { format!("{stem}_{}", unit.si) };
            (format!("{component}.{field}"), Some(unit))
        }
        None => (written.to_owned(), None),
    }
}

/// A hint for a parameter that does not exist.
fn nearest(written: &str, known: &HashMap<&str, &Value>) -> String {
    let best = known
        .keys()
        .map(|name| (strsim::damerau_levenshtein(written, name), *name))
        .filter(|(distance, name)| *distance <= 1 + name.len() / 4)
        .min();
    if let Some((_, name)) = best {
        return format!("did you mean `{name}`?");
    }
    let component = written.rsplit_once('.').map_or(written, |(component, _)| component);
    let mut fields: Vec<&str> = known
        .keys()
        .filter_map(|name| name.strip_prefix(component)?.strip_prefix('.'))
        .filter(|field| !field.contains('.'))
        .collect();
    fields.sort_unstable();
    if fields.is_empty() {
        return "names are those of `anergy check --expand`: component.field".into();
    }
    format!("\"{component}\" has {}", fields.join(", "))
}
