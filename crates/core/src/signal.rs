//! Input signals: commands and boundary values by name, resolved to indices at build.

use crate::ids::SignalId;
use hashbrown::HashTable;
use smol_str::SmolStr;
use std::hash::{BuildHasher, RandomState};
use thiserror::Error;

/// What is known of one input signal.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalSpec {
    /// `component.quantity`, for example `sf2.feed_in_pump.speed`.
    pub name: SmolStr,
    /// Suffix of the SI unit the signal is given in (`kg_s`, `k`, `w`, `pa`), empty for ratios.
    pub unit: &'static str,
    /// Value while nothing drives the signal.
    pub initial: f64,
    /// Smallest value that makes sense.
    pub min: f64,
    /// Largest value that makes sense.
    pub max: f64,
}

/// Two signals of one name.
#[derive(Debug, Error, Clone, PartialEq, Eq)]
#[error("the signal \"{name}\" exists already")]
pub struct DoubledSignal {
    /// The name.
    pub name: SmolStr,
    /// The signal that has it.
    pub id: SignalId,
}

/// All input signals of a model; inside a step only [`SignalId`]s exist.
#[derive(Debug, Clone, Default)]
pub struct SignalTable {
    specs: Vec<SignalSpec>,
    /// Ids by the hash of the name, which stands in `specs` only.
    index: HashTable<SignalId>,
    hasher: RandomState,
}

impl SignalTable {
    /// Adds a signal.
    ///
    /// # Errors
    /// When a signal of this name exists: one of the two could never be driven.
    pub fn add(&mut self, spec: SignalSpec) -> Result<SignalId, DoubledSignal> {
        if let Some(id) = self.find(&spec.name) {
            return Err(DoubledSignal { name: spec.name, id });
        }
        let id = SignalId::from_index(self.specs.len());
        let Self { specs, index, hasher } = self;
        let hash = hasher.hash_one(spec.name.as_str());
        specs.push(spec);
        index.insert_unique(hash, id, |id| hasher.hash_one(specs[id.index()].name.as_str()));
        Ok(id)
    }

    /// The id of a name.
    pub fn find(&self, name: &str) -> Option<SignalId> {
        let is = |id: &SignalId| self.specs[id.index()].name == name;
        self.index.find(self.hasher.hash_one(name), is).copied()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_given_once() {
        let spec = |name: &str, initial| SignalSpec {
            name: name.into(),
            unit: "k",
            initial,
            min: 0.0,
            max: 500.0,
        };
        let mut table = SignalTable::default();
        let id = table.add(spec("ground.temperature_k", 285.0)).unwrap();
        assert_ne!(table.add(spec("hall.temperature_k", 290.0)).unwrap(), id);
        let doubled = table.add(spec("ground.temperature_k", 300.0)).unwrap_err();
        assert_eq!(doubled.id, id);
        assert_eq!(doubled.to_string(), "the signal \"ground.temperature_k\" exists already");
        assert_eq!(table.initial_values(), [285.0, 290.0]);
    }
}
