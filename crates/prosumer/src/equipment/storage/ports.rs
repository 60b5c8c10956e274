//! Where water enters and leaves the tank: ports between two heights, with one or two positions each.
//!
//! **Equation** the net flow between two layers follows from the balance of mass, summed from the bottom:
//! `M_l = sum_(i<=l) (m_in,i - m_out,i)`, upwards positive. **Assumptions** water that enters stays in its
//! layer; water that leaves is drawn from its layer, or from all within the entrainment depth, the nearer
//! the more. A port with two positions has a three-way valve before both of its ends, which divides the flow
//! by its position: 0 all to the first, 1 all to the second.

use super::layers::{Cells, Layers};
use crate::thermal_unit::UnitError;
use anergy_core::port::{Port, PortFlow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most ports and coils of a storage.
pub const MAX_PORTS: usize = 16;

/// A port as written in a model file: heights, layers, or two positions.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StoragePort {
    /// Height above the bottom at which water enters, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_m: Option<f64>,
    /// Height above the bottom at which water leaves, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_m: Option<f64>,
    /// Layer into which water enters, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_layer: Option<usize>,
    /// Layer from which water leaves, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_layer: Option<usize>,
    /// Two positions between which a three-way valve divides the flow, instead of one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub positions: Vec<StorageConnection>,
}

/// A position of a port.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StorageConnection {
    /// Height above the bottom at which water enters, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_m: Option<f64>,
    /// Height above the bottom at which water leaves, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_m: Option<f64>,
    /// Layer into which water enters, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inlet_layer: Option<usize>,
    /// Layer from which water leaves, counted from 1 at the bottom, instead of a height.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outlet_layer: Option<usize>,
}

/// The share of a port's flow that an opening carries.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Share {
    All,
    First,
    Second,
}

/// Where a layer is connected to an end of a port.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Opening {
    /// Water below it, kg.
    pub(super) below_kg: f64,
    pub(super) layer: usize,
    pub(super) port: usize,
    /// A: water enters here at positive flow; B: it leaves here.
    end: Port,
    share: Share,
    entering: f64,
    leaving: f64,
}

impl Opening {
    fn share(&self, position: f64) -> f64 {
        match self.share {
            Share::All => 1.0,
            Share::First => 1.0 - position,
            Share::Second => position,
        }
    }

    /// Flow into the tank, kg/s; negative: out of it.
    pub(super) fn entering_tank_kg_s(&self, m_flow_kg_s: f64, position: f64) -> f64 {
        let flow = m_flow_kg_s.abs() * self.share(position);
        if self.end == Port::upstream(m_flow_kg_s) {
            flow * self.entering
        } else {
            -flow * self.leaving
        }
    }
}

/// All openings, from bottom to top.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Openings(pub(super) Vec<Opening>);

impl Openings {
    /// Temperature of what would leave at an end of a port now, K.
    pub(super) fn leaving_k<const N: usize>(
        &self,
        cells: &Cells<N>,
        layers_are_cells: bool,
        port: usize,
        end: Port,
        position: f64,
    ) -> f64 {
        let of_end = self.0.iter().filter(|opening| opening.port == port && opening.end == end);
        of_end
            .map(|opening| {
                let cell =
                    if layers_are_cells { opening.layer } else { cells.at_mass(opening.below_kg) };
                opening.share(position) * opening.leaving * cells.t_k[cell]
            })
            .sum()
    }

    /// Water below the middle of what leaves at an end, kg.
    pub(super) fn middle_kg(&self, port: usize, end: Port, position: f64) -> f64 {
        let of_end = self.0.iter().filter(|opening| opening.port == port && opening.end == end);
        of_end.map(|o| o.share(position) * o.leaving * o.below_kg).sum()
    }

    /// Water below the middle of where water enters at an end, kg.
    pub(super) fn entering_kg(&self, port: usize, end: Port, position: f64) -> f64 {
        let of_end = self.0.iter().filter(|opening| opening.port == port && opening.end == end);
        of_end.map(|o| o.share(position) * o.entering * o.below_kg).sum()
    }

    /// Adds the openings of a port.
    pub(super) fn add(
        &mut self,
        layers: &Layers,
        port: usize,
        name: &str,
        written: &StoragePort,
        entrainment_m: f64,
    ) -> Result<(), UnitError> {
        let StoragePort { inlet_m, outlet_m, inlet_layer, outlet_layer, positions } = written;
        let place = |heights, layer, field: &str| place(layers, name, heights, layer, field);
        let given = [inlet_m, outlet_m].iter().any(|m| m.is_some())
            || [inlet_layer, outlet_layer].iter().any(|l| l.is_some());
        let mut connect = |inlet: End, outlet: End, share| {
            let (inlet_kg, inlet_layer) = place(inlet.0, inlet.1, "inlet")?;
            let (outlet_kg, outlet_layer) = place(outlet.0, outlet.1, "outlet")?;
            if inlet_layer == outlet_layer && layers.count > 1 {
                return Err(refused(
                    name,
                    &format!("enters and leaves in layer {}", inlet_layer + 1),
                    "move one of its ends, or take more layers",
                ));
            }
            for (below_kg, layer, end) in
                [(inlet_kg, inlet_layer, Port::A), (outlet_kg, outlet_layer, Port::B)]
            {
                self.open(layers, port, (below_kg, layer, end, share), entrainment_m);
            }
            Ok(())
        };
        match positions.as_slice() {
            [] => connect((*inlet_m, *inlet_layer), (*outlet_m, *outlet_layer), Share::All)?,
            _ if given => {
                return Err(refused(
                    name,
                    "has heights or layers beside positions",
                    "give only one",
                ));
            }
            [first, second] => {
                for (at, share) in [(first, Share::First), (second, Share::Second)] {
                    connect((at.inlet_m, at.inlet_layer), (at.outlet_m, at.outlet_layer), share)?;
                }
            }
            other => {
                let problem = format!("has {} positions", other.len());
                return Err(refused(name, &problem, "a three-way valve switches between two"));
            }
        }
        self.0.sort_by(|a, b| a.below_kg.total_cmp(&b.below_kg));
        Ok(())
    }

    fn open(
        &mut self,
        layers: &Layers,
        port: usize,
        (below_kg, layer, end, share): (f64, usize, Port, Share),
        entrainment_m: f64,
    ) {
        let opening = Opening { below_kg, layer, port, end, share, entering: 1.0, leaving: 1.0 };
        if entrainment_m <= 0.0 {
            self.0.push(opening);
            return;
        }
        self.0.push(Opening { leaving: 0.0, ..opening.clone() });
        let port_m = below_kg / layers.mass_kg() * layers.height_m;
        for (layer, leaving) in layers.drawn_from(port_m, entrainment_m).into_iter().enumerate() {
            if leaving > 0.0 {
                let below_kg = (layer as f64 + 0.5) * layers.layer_kg();
                self.0.push(Opening { below_kg, layer, entering: 0.0, leaving, ..opening.clone() });
            }
        }
    }
}

/// An end of a port as written: height or layer.
type End = (Option<f64>, Option<usize>);

/// A sentence about a port.
pub(super) fn refused(name: &str, problem: &str, hint: &str) -> UnitError {
    UnitError::Within { field: "ports", problem: format!("ports.{name} {problem}: {hint}") }
}

/// Mass below and layer of an end.
fn place(
    layers: &Layers,
    name: &str,
    height_m: Option<f64>,
    layer: Option<usize>,
    end: &str,
) -> Result<(f64, usize), UnitError> {
    match (height_m, layer) {
        (Some(height_m), None) if (0.0..=layers.height_m).contains(&height_m) => {
            let below_kg = height_m / layers.height_m * layers.mass_kg();
            Ok((below_kg, layers.at_height(height_m)))
        }
        (Some(height_m), None) => Err(refused(
            name,
            &format!("has {end}_m = {height_m}"),
            &format!("the storage reaches from 0 to height_m = {}", layers.height_m),
        )),
        (None, Some(layer)) if (1..=layers.count).contains(&layer) => {
            Ok(((layer as f64 - 0.5) * layers.layer_kg(), layer - 1))
        }
        (None, Some(layer)) => Err(refused(
            name,
            &format!("has {end}_layer = {layer}"),
            &format!("there are layers 1 (bottom) to {}", layers.count),
        )),
        (None, None) => {
            Err(refused(name, &format!("has no {end}"), &format!("give {end}_m or {end}_layer")))
        }
        (Some(_), Some(_)) => {
            Err(refused(name, &format!("has both {end}_m and {end}_layer"), "give only one"))
        }
    }
}

/// The flows of a step by layers.
#[derive(Debug, Clone)]
pub(super) struct LayerFlows<const N: usize> {
    /// What enters each layer through ports, kg/s.
    pub(super) in_kg_s: [f64; N],
    /// Its `m T`, kg K/s.
    pub(super) in_kg_k_s: [f64; N],
    /// Net flow from each layer to the one above, kg/s.
    pub(super) up_kg_s: [f64; N],
}

impl<const N: usize> LayerFlows<N> {
    /// The flows between `layers` layers.
    pub(super) fn new(
        openings: &Openings,
        streams: &[PortFlow],
        positions: &[f64; MAX_PORTS],
        layers: usize,
    ) -> Self {
        let mut flows = Self { in_kg_s: [0.0; N], in_kg_k_s: [0.0; N], up_kg_s: [0.0; N] };
        for opening in &openings.0 {
            let stream = &streams[opening.port];
            let flow = opening.entering_tank_kg_s(stream.m_flow_kg_s, positions[opening.port]);
            flows.up_kg_s[opening.layer] += flow;
            if flow > 0.0 {
                flows.in_kg_s[opening.layer] += flow;
                flows.in_kg_k_s[opening.layer] += flow * stream.t_in_k;
            }
        }
        for layer in 1..layers {
            flows.up_kg_s[layer] += flows.up_kg_s[layer - 1];
        }
        // Nothing leaves through the top: what is there is rounding.
        flows.up_kg_s[layers - 1] = 0.0;
        flows
    }

    /// The largest flow through a layer, kg/s.
    pub(super) fn largest_through_kg_s(&self, layers: usize) -> f64 {
        let mut from_below = 0.0;
        let mut largest = 0.0_f64;
        for layer in 0..layers {
            let up = self.up_kg_s[layer];
            largest = largest.max(self.in_kg_s[layer] + f64::max(from_below, 0.0) + (-up).max(0.0));
            from_below = up;
        }
        largest
    }
}
