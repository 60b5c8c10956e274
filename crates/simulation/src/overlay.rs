//! Changes of a typed model: what effects, sweeps and studies are made of.
//!
//! An overlay names a component and what to change; its neutral value leaves the model identical.

mod parameters;

use crate::model::{DriverSpec, EdgeSpec, Model, NodeSpec, Place};
use crate::model_file::NodeEntry;
use anergy_network::elements::ElementParams;
use serde_json::Value;
use smol_str::{SmolStr, format_smolstr};
use thiserror::Error;

/// One change of a model.
#[derive(Debug, Clone, PartialEq)]
pub enum Change {
    /// Sets a parameter (SI) of a component: `sf1-sf2.hot.length_m`.
    Set {
        /// Component and field.
        parameter: String,
        /// New value.
        value: Value,
    },
    /// Multiplies a numeric parameter; 1 is neutral.
    Scale {
        /// Component and field.
        parameter: String,
        /// Factor.
        factor: f64,
    },
    /// Adds a node.
    InsertNode {
        /// The node.
        entry: Box<NodeEntry>,
    },
    /// Adds an edge between existing nodes (in parallel to what is there).
    InsertEdge {
        /// Name of the new edge.
        id: String,
        /// Node at port a.
        from: String,
        /// Node at port b.
        to: String,
        /// The component.
        params: ElementParams,
    },
    /// Puts a new edge in series before port b of an edge, with a new node between them.
    InsertInSeries {
        /// The edge.
        edge: String,
        /// Name of the new edge; the new node is called `id.inner`.
        id: String,
        /// The component.
        params: ElementParams,
    },
    /// Replaces the component of an edge; its own parameters are neutral.
    ReplaceElement {
        /// The edge.
        edge: String,
        /// The new component.
        params: ElementParams,
    },
    /// Multiplies the pressure loss of an edge at every flow; 1 is neutral.
    WrapLaw {
        /// The edge.
        edge: String,
        /// Factor, positive.
        loss_factor: f64,
    },
    /// Drives a signal over time, instead of what drives it now.
    Drive {
        /// The signal and its values.
        driver: DriverSpec,
    },
}

/// A change that cannot be made.
#[derive(Debug, Error, Clone, PartialEq)]
pub enum OverlayError {
    /// No component, or no field, of that name.
    #[error("overlay: there is no parameter \"{parameter}\"")]
    UnknownParameter {
        /// What was named.
        parameter: String,
    },
    /// No edge of that name.
    #[error("overlay: there is no edge \"{edge}\"")]
    UnknownEdge {
        /// What was named.
        edge: String,
    },
    /// The component does not take the value.
    #[error("overlay: {parameter}: {reason}")]
    Value {
        /// Component and field.
        parameter: String,
        /// Why not.
        reason: String,
    },
    /// The name of a new component is taken.
    #[error("overlay: \"{id}\" exists already")]
    Taken {
        /// The name.
        id: String,
    },
}

impl Model {
    /// The model with changes made one after the other.
    ///
    /// # Errors
    /// [`OverlayError`] names the change that cannot be made.
    pub fn with(&self, changes: &[Change]) -> Result<Self, OverlayError> {
        let mut model = self.clone();
        for change in changes {
            model.apply(change)?;
        }
        Ok(model)
    }

    pub(crate) fn apply(&mut self, change: &Change) -> Result<(), OverlayError> {
        match change {
            Change::Set { parameter, value } => {
                self.change_parameter(parameter, |_| Some(value.clone()))
            }
            Change::Scale { parameter, factor } => self.change_parameter(parameter, |old| {
                old.as_f64().map(|old| Value::from(old * factor))
            }),
            Change::InsertNode { entry } => {
                if self.nodes.iter().any(|node| node.entry.id == entry.id) {
                    return Err(OverlayError::Taken { id: entry.id.to_string() });
                }
                let (site, place) = (SmolStr::default(), Place::default());
                self.nodes.push(NodeSpec { entry: (**entry).clone(), site, place });
                Ok(())
            }
            Change::InsertEdge { id, from, to, params } => {
                self.check_free(id)?;
                self.edges.push(EdgeSpec {
                    id: id.into(),
                    from: from.into(),
                    to: to.into(),
                    params: params.clone(),
                    loss_factor: 1.0,
                    station: SmolStr::default(),
                    place: Place::default(),
                });
                Ok(())
            }
            Change::InsertInSeries { edge, id, params } => self.insert_in_series(edge, id, params),
            Change::ReplaceElement { edge, params } => {
                self.edge_mut(edge)?.params = params.clone();
                Ok(())
            }
            Change::WrapLaw { edge, loss_factor } => {
                if !loss_factor.is_finite() || *loss_factor <= 0.0 {
                    return Err(OverlayError::Value {
                        parameter: format!("{edge}.loss_factor"),
                        reason: format!("{loss_factor} is not positive"),
                    });
                }
                self.edge_mut(edge)?.loss_factor *= loss_factor;
                Ok(())
            }
            Change::Drive { driver } => {
                self.drivers.retain(|other| other.signal != driver.signal);
                self.drivers.push(driver.clone());
                Ok(())
            }
        }
    }

    fn edge_mut(&mut self, id: &str) -> Result<&mut EdgeSpec, OverlayError> {
        self.edges
            .iter_mut()
            .find(|edge| edge.id == id)
            .ok_or_else(|| OverlayError::UnknownEdge { edge: id.to_owned() })
    }

    fn check_free(&self, id: &str) -> Result<(), OverlayError> {
        if self.edges.iter().any(|edge| edge.id == id) {
            return Err(OverlayError::Taken { id: id.to_owned() });
        }
        Ok(())
    }

    fn insert_in_series(
        &mut self,
        edge: &str,
        id: &str,
        params: &ElementParams,
    ) -> Result<(), OverlayError> {
        self.check_free(id)?;
        let spec = self.edge_mut(edge)?;
        let inner = format_smolstr!("{id}.inner");
        let end = std::mem::replace(&mut spec.to, inner.clone());
        let station = spec.station.clone();
        let before = self.nodes.iter().find(|node| node.entry.id == end).cloned();
        let Some(mut node) = before else {
            return Err(OverlayError::UnknownParameter { parameter: end.into() });
        };
        node.entry.id.clone_from(&inner);
        node.entry.kind = crate::model_file::NodeEntryKind::Junction;
        node.entry.volume_m3 = 0.0;
        // What a junction cannot have.
        node.entry.pressure_pa = None;
        node.entry.m_flow_kg_s = None;
        node.entry.temperature_k = None;
        self.nodes.push(node);
        self.edges.push(EdgeSpec {
            id: id.into(),
            from: inner,
            to: end,
            params: params.clone(),
            loss_factor: 1.0,
            station,
            place: Place::default(),
        });
        Ok(())
    }
}
