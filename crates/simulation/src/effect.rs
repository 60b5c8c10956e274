//! Effects: physics that a model lacks, as entries of its file.
//!
//! An `[[effect]]` names one of the catalogue ([`crate::effects`]), the component it belongs to and its
//! parameters. The model keeps what the user wrote; [`Model::with_effects`] is what is simulated. The
//! neutral value of an effect leaves the model identical.

use crate::diagnostic::{Diagnostic, Diagnostics, did_you_mean};
use crate::effects::EffectParams;
use crate::model::{BranchSpec, Model, Place};
use crate::overlay::{Change, OverlayError};
use crate::wording::refused;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::two_port::ElementError;
use anergy_prosumer::equipment::EquipmentParams;
use anergy_prosumer::equipment::storage::StorageParams;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::HashSet;
use thiserror::Error;

/// The fields of an `[[effect]]` that say where it comes from; they change nothing.
pub(crate) const PROVENANCE: &[&str] = &["because", "ci95"];

/// An effect as an entry of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct EffectSpec {
    /// The component it belongs to.
    pub component: String,
    /// Which effect, and how strong.
    pub params: EffectParams,
    /// Why it is here: `because` and `ci95` as they were written.
    pub provenance: serde_json::Map<String, Value>,
    /// Where it stands.
    pub place: Place,
}

/// What an effect does to a model.
pub trait ModelChange {
    /// The changes that make up the effect at a component.
    ///
    /// # Errors
    /// Names what the component lacks, or the value that cannot be.
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError>;
}

/// An effect that cannot be.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum EffectError {
    /// The component is not there, or is something else.
    #[error("there is no {wanted} \"{component}\"")]
    Component {
        /// What the effect belongs to, such as `pipe`.
        wanted: &'static str,
        /// What was named.
        component: String,
    },
    /// A value outside its range.
    #[error(transparent)]
    Value(#[from] ElementError),
    /// A field that needs something the model does not have.
    #[error("{field} = {value} {problem}")]
    Needs {
        /// The field, SI.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What is missing.
        problem: String,
    },
    /// The component does not take the change.
    #[error(transparent)]
    Change(#[from] OverlayError),
}

impl EffectError {
    /// The field concerned, where one field is.
    fn field(&self) -> Option<&'static str> {
        match self {
            Self::Component { .. } => Some("component"),
            Self::Value(error) => error.field(),
            Self::Needs { field, .. } => Some(field),
            Self::Change(_) => None,
        }
    }
}

/// The pipe of that name.
///
/// # Errors
/// [`EffectError::Component`] when there is none.
pub(crate) fn pipe<'a>(model: &'a Model, component: &str) -> Result<&'a PipeParams, EffectError> {
    match model.edge(component).map(|edge| &edge.params) {
        Some(ElementParams::Pipe(pipe)) => Ok(pipe),
        _ => Err(EffectError::Component { wanted: "pipe", component: component.to_owned() }),
    }
}

/// The error that there is no component of that kind.
pub(crate) fn wanted(wanted: &'static str, component: &str) -> EffectError {
    EffectError::Component { wanted, component: component.to_owned() }
}

/// The unit of that name.
///
/// # Errors
/// [`EffectError::Component`] when there is none.
pub(crate) fn unit<'a>(
    model: &'a Model,
    component: &str,
    kind: &'static str,
) -> Result<&'a EquipmentParams, EffectError> {
    let unit = model.units.iter().find(|unit| unit.id == component);
    unit.map(|unit| &unit.params).ok_or_else(|| wanted(kind, component))
}

/// The storage of that name.
///
/// # Errors
/// [`EffectError::Component`] when there is none.
pub(crate) fn storage<'a>(
    model: &'a Model,
    component: &str,
) -> Result<&'a StorageParams, EffectError> {
    match unit(model, component, "storage")? {
        EquipmentParams::Storage(storage) => Ok(storage),
        _ => Err(wanted("storage", component)),
    }
}

/// The circuit of that name that is a branch between two points.
///
/// # Errors
/// [`EffectError::Component`] when there is none.
pub(crate) fn branch<'a>(model: &'a Model, component: &str) -> Result<&'a BranchSpec, EffectError> {
    let circuit = model.circuits.iter().find(|circuit| circuit.id == component);
    let branch = circuit.and_then(|circuit| circuit.branch.as_ref());
    branch.ok_or_else(|| wanted("circuit between two points", component))
}

/// Whether a component of this kind is an edge.
fn edge_like(kind: &str) -> bool {
    ElementParams::KINDS.iter().any(|known| kind.contains(known)) || kind.starts_with("circuit")
}

impl Model {
    /// The model with its effects at work; the entries themselves are used up.
    ///
    /// # Errors
    /// All effects that cannot be, with their places.
    pub fn with_effects(&self) -> Result<Cow<'_, Self>, Diagnostics> {
        if self.effects.is_empty() {
            return Ok(Cow::Borrowed(self));
        }
        let mut model = self.clone();
        model.effects.clear();
        let mut problems = Vec::new();
        let mut seen = HashSet::new();
        for spec in &self.effects {
            let what = format!("effect {} of \"{}\"", spec.params.kind(), spec.component);
            if !seen.insert((spec.params.kind(), spec.component.as_str())) {
                let problem =
                    Diagnostic::new(format!("{what} is there twice"), spec.place.of("id"));
                problems.push(problem.with_hint("write one entry with both changes in one value"));
                continue;
            }
            if let Err(error) = model.take_effect(spec) {
                let problem = refused(&what, &spec.place, error.field(), &error.to_string());
                let hint = self.hint(spec, &error);
                problems.push(match hint {
                    Some(hint) => problem.with_hint(hint),
                    None => problem,
                });
            }
        }
        if problems.is_empty() { Ok(Cow::Owned(model)) } else { Err(Diagnostics(problems)) }
    }

    fn take_effect(&mut self, spec: &EffectSpec) -> Result<(), EffectError> {
        let effect = spec.params.build(&())?;
        for change in effect.changes(&spec.component, self)? {
            self.apply(&change)?;
        }
        Ok(())
    }

    fn hint(&self, spec: &EffectSpec, error: &EffectError) -> Option<String> {
        let EffectError::Component { wanted, .. } = error else { return None };
        let like = |edge: &&crate::model::EdgeSpec| edge.params.kind() == *wanted;
        let edges = self.edges.iter().filter(like).map(|edge| edge.id.as_str());
        let units = self.units.iter().filter(|_| !edge_like(wanted)).map(|unit| unit.id.as_str());
        let circuits =
            self.circuits.iter().filter(|_| wanted.starts_with("circuit")).map(|c| c.id.as_str());
        let names = edges.chain(units).chain(circuits);
        let kind = self.edge(&spec.component).map(|edge| edge.params.kind());
        did_you_mean(&spec.component, names).or_else(|| {
            kind.map(|kind| {
                format!("\"{}\" is a {kind}, the effect is one of a {wanted}", spec.component)
            })
        })
    }
}
