//! Input signals: commands and boundary values by name, resolved to indices at build.

use crate::ids::SignalId;
use std::collections::HashMap;

/// What is known of one input signal.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalSpec {
    /// `component.quantity`, for example `sf2.feed_in_pump.speed`.
    pub name: String,
    /// Suffix of the SI unit the signal is given in (`kg_s`, `k`, `w`, `pa`), empty for ratios.
    pub unit: &'static str,
    /// Value while nothing drives the signal.
    pub initial: f64,
    /// Smallest value that makes sense.
    pub min: f64,
    /// Largest value that makes sense.
    pub max: f64,
}

/// All input signals of a model; inside a step only [`SignalId`]s exist.
#[derive(Debug, Clone, Default)]
pub struct SignalTable {
    specs: Vec<SignalSpec>,
    index: HashMap<String, SignalId>,
}

impl SignalTable {
    /// Adds a signal. A name that exists already keeps its first meaning; the old id is returned.
    pub fn add(&mut self, spec: SignalSpec) -> SignalId {
        if let Some(&id) = self.index.get(&spec.name) {
            return id;
        }
        let id = SignalId::from_index(self.specs.len());
        self.index.insert(spec.name.clone(), id);
        self.specs.push(spec);
        id
    }

    /// The id of a name.
    pub fn find(&self, name: &str) -> Option<SignalId> {
        self.index.get(name).copied()
    }

    /// What is known of a signal.
    pub fn spec(&self, id: SignalId) -> &SignalSpec {
        &self.specs[id.index()]
    }

    /// All signals in the order of their ids.
    pub fn specs(&self) -> &[SignalSpec] {
        &self.specs
    }

    /// The initial values in the order of the ids.
    pub fn initial_values(&self) -> Vec<f64> {
        self.specs.iter().map(|spec| spec.initial).collect()
    }
}

/// A thermal unit's or element's view of its own input signals, in the order it declared them.
#[derive(Debug, Clone, Copy)]
pub struct Signals<'a>(pub &'a [f64]);

impl Signals<'_> {
    /// The value of the i-th declared input.
    #[inline]
    pub fn get(&self, i: usize) -> f64 {
        self.0[i]
    }
}
