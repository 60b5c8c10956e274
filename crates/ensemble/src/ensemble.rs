//! A definition that fits a model, and its members on all cores.
//!
//! **Numerics** a member is the model with the changes of an overlay, built and run as any other model. Nothing of it
//! depends on when or where it runs: values come from the seed of the ensemble, and so do the seeds of its random
//! numbers, `mix(seed, member, name)`, cut to 52 bits so that files of every kind can hold them.

use crate::definition::{Definition, Random};
use crate::member::{self, Outcome, Wanted};
use crate::members::Members;
use crate::target::{self, Target};
use anergy_recording::selection::choose;
use anergy_simulation::build::build;
use anergy_simulation::diagnostic::{Diagnostic, Diagnostics};
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::run::RunOptions;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::Duration;
use thiserror::Error;

/// Real time between two looks at whether to go on.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);
/// What to do when no member can be built.
const NO_MEMBER: &str = "neither the first member nor the one in the middle nor the last can be built: change the values";
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
        let (targets, mut problems) = target::find(&definition, &model);
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
            Random::Own => {
                // A seed that varies is not drawn.
                let varied: HashSet<&str> =
                    targets.iter().flatten().map(|target| target.parameter.as_str()).collect();
                let names = model.seeds().into_iter().map(|(name, _)| name);
                names.filter(|name| !varied.contains(seed_of(name).as_str())).collect()
            }
        };
        let ensemble = Self {
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
        };
        match ensemble.impossible() {
            Some(problem) => Err(EnsembleError::Variations(Diagnostics(vec![problem]))),
            None => Ok(ensemble),
        }
    }

    /// Why no member can be, as far as a few tell: the first, one in the middle, the last.
    fn impossible(&self) -> Option<Diagnostic> {
        let some = [0, self.len() / 2, self.len().saturating_sub(1)];
        let mut message = None;
        for member in some.into_iter().filter(|member| *member < self.len()) {
            let why = member::check(&self.model, &self.changes(member)).err()?;
            message.get_or_insert(why);
        }
        let message = message?;
        // The variation that is impossible alone is the culprit.
        let values = self.values(0);
        let alone = self.definition.variations.iter().zip(&self.targets).zip(&values);
        for ((variation, targets), value) in alone {
            let changes: Vec<Change> =
                targets.iter().map(|target| target.change(variation.how, value)).collect();
            if let Err(message) = member::check(&self.model, &changes) {
                let place = variation.places.of_field(&["values", "low", "mean"]);
                let message = format!("variation \"{}\": {message}", variation.name);
                return Some(Diagnostic::new(message, place).with_hint(NO_MEMBER));
            }
        }
        let message = format!("the variations together: {message}");
        Some(Diagnostic::new(message, Some(0..0)).with_hint(NO_MEMBER))
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
            changes.extend(targets.iter().map(|target| target.change(variation.how, &value)));
        }
        let seed = self.definition.ensemble.seed;
        changes.extend(self.draws.iter().map(|name| Change::Set {
            parameter: seed_of(name),
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
        let changes = self.changes(member);
        let result = member::run(&self.model, &changes, self.options, &self.wanted, keep_going)?;
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
    ///
    /// `writer` is who keeps them: folders of different writers have different files. `controllers` tells those that are
    /// not in the model.
    ///
    /// # Errors
    /// When the model cannot be written, and so not be recognised.
    pub fn identity(&self, writer: &str, controllers: Option<&str>) -> Result<Value, Diagnostics> {
        let mut hash = Sha256::new();
        hash.update(self.model.to_plain_toml()?);
        if let Some(records) = self.model.weather.as_ref().and_then(|w| w.records.as_ref()) {
            hash.update(format!("{records:?}"));
        }
        let hash: String = hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(json!({
            "program": format!("anergy {}", env!("CARGO_PKG_VERSION")),
            "writer": writer,
            "model": self.model.name,
            "model_sha256": hash,
            "controllers": controllers,
            "members": self.len(),
            "variations": self.definition.document,
        }))
    }
}

/// Threads that keep this machine busy.
pub fn all_threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// The parameter with the seed of what draws.
fn seed_of(name: &str) -> String {
    format!("{name}.seed")
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
