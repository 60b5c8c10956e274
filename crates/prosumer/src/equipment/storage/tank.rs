//! A step of the tank: parts in which advection, coils, rod, conduction, loss and buoyancy follow each
//! other, and the booking of what the streams were promised.
//!
//! **Numerics** the temperature of what leaves is promised before a step and is a fact of it: it has been
//! mixed and has flowed on elsewhere. The tank is moved through the step as if water left with the temperature it has
//! ([`Tank::pass`]); what then left too much or too little through a port is given back to the layer it left
//! from ([`Tank::book`]), so heat is exact for any step. The promise is made by the same calculation with
//! the flows and temperatures of the step before: in steady operation nothing is left to give back, and
//! with parts as long as the step nothing at all in mixed layers. When a flow starts or changes within a
//! step that moves several layers, the rest can be larger than what its layer can hold between the coldest and
//! the warmest water of the step; it then goes on to the layers that the water came through. **Validity** steps that
//! move less than the tank: beyond, a promise of constant temperature can only be met by water of
//! temperatures that never were there.

use super::coil::{Coil, Line};
use super::exchange::{Surroundings, exchange, overturn};
use super::jet::Jet;
use super::layers::{Cells, Layers};
use super::mixed_layers::advect;
use super::plug_flow::{displace, merge};
use super::ports::{LayerFlows, MAX_PORTS, Openings};
use super::rod::Rod;
use anergy_core::port::{Port, PortFlow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest share of a layer that flows through it in a part of a step.
pub(super) const COURANT: f64 = 0.9;
/// Longest part of a step, s: what conduction and buoyancy do in it is small beside a layer.
const LONGEST_PART_S: f64 = 600.0;
/// Largest rise of the rod's layers in a part of a step, K.
const ROD_RISE_K: f64 = 5.0;

/// How water moves between the layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Scheme {
    /// Every layer is mixed: fronts are blurred over a few layers.
    #[default]
    MixedLayers,
    /// Parcels that move: fronts stay sharp.
    PlugFlow,
}

/// What becomes of warm water below cold water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Buoyancy {
    /// Heat rises with a conductance.
    #[default]
    Gradual,
    /// It mixes at once.
    AtOnce,
}

/// What stays the same during a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conditions<'a> {
    pub(super) dt_s: f64,
    pub(super) streams: &'a [PortFlow],
    /// Position of each port with two.
    pub(super) positions: &'a [f64; MAX_PORTS],
    pub(super) ambient_k: f64,
    /// Share of the rod's power, and its set temperature, K.
    pub(super) rod: (f64, f64),
}

/// What changes in a step.
#[derive(Debug)]
pub(super) struct Water<'a, const N: usize> {
    pub(super) cells: Cells<N>,
    /// Temperature of the content of each coil, K.
    pub(super) coils_k: &'a mut [f64],
    pub(super) rod_blocked: bool,
}

/// What a step did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Passed {
    /// Mean outlet of each port, K, those of coils over the temperature of their inlets; nothing for ports
    /// without flow.
    pub(super) outlets: [Line; MAX_PORTS],
    pub(super) lost_j: f64,
    pub(super) rod_j: f64,
}

/// The tank: all that stays.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tank {
    pub(super) layers: Layers,
    pub(super) scheme: Scheme,
    pub(super) openings: Openings,
    /// Ports into the tank; the coils are those after them.
    pub(super) ports: usize,
    pub(super) coils: Vec<Coil>,
    pub(super) rod: Option<Rod>,
    /// Conductance to the surroundings of each layer, W/K.
    pub(super) ua_w_k: Vec<f64>,
    pub(super) conductivity_w_m_k: f64,
    pub(super) jet: Option<Jet>,
    pub(super) buoyancy: Buoyancy,
    pub(super) buoyancy_w_k: f64,
}

impl Tank {
    fn cp(&self) -> f64 {
        self.layers.heat_capacity_j_kg_k
    }

    pub(super) fn layers_are_cells(&self) -> bool {
        self.scheme == Scheme::MixedLayers
    }

    /// Most cells that are kept from step to step.
    pub(super) fn most_cells(&self) -> usize {
        if self.layers_are_cells() { self.layers.count } else { 2 * self.layers.count }
    }

    /// Heat of the water above a temperature, J.
    pub(super) fn heat_j<const N: usize>(
        &self,
        cells: &Cells<N>,
        coils_k: &[f64],
        above_k: f64,
    ) -> f64 {
        let tank: f64 = (0..cells.count).map(|i| cells.mass_kg[i] * (cells.t_k[i] - above_k)).sum();
        let coils =
            self.coils.iter().zip(coils_k).map(|(coil, t_k)| coil.content_kg * (t_k - above_k));
        self.cp() * (tank + coils.sum::<f64>())
    }

    /// The parts of a step.
    pub(super) fn parts<const N: usize>(
        &self,
        with: &Conditions<'_>,
        flows: &LayerFlows<N>,
    ) -> usize {
        let layer_kg = self.layers.layer_kg();
        let mut per_s = flows.largest_through_kg_s(self.layers.count) / (COURANT * layer_kg);
        for (coil, stream) in self.coils.iter().zip(&with.streams[self.ports..]) {
            let layers = coil.share.iter().filter(|share| **share > 0.0).count() as f64;
            per_s = per_s.max(stream.m_flow_kg_s.abs() / (COURANT * layer_kg * layers));
        }
        if let Some(rod) = &self.rod {
            let layers = rod.share.iter().filter(|share| **share > 0.0).count() as f64;
            let rise_k_s = rod.wanted_w(with.rod.0) / (self.cp() * layer_kg * layers);
            per_s = per_s.max(rise_k_s / ROD_RISE_K);
        }
        (with.dt_s * per_s.max(1.0 / LONGEST_PART_S)).ceil().max(1.0) as usize
    }

    /// What each cell has of a quantity given per layer.
    fn of_cells<'a, const N: usize>(
        &self,
        per_layer: &'a [f64],
        cells: &Cells<N>,
        buffer: &'a mut [f64; N],
    ) -> &'a [f64] {
        if self.layers_are_cells() {
            return per_layer;
        }
        cells.spread(per_layer, self.layers.layer_kg(), buffer);
        &buffer[..]
    }

    /// Moves the water through a step as if it left with the temperature it has.
    pub(super) fn pass<const N: usize>(
        &self,
        with: &Conditions<'_>,
        water: &mut Water<'_, N>,
    ) -> Passed {
        let flows = LayerFlows::<N>::new(
            &self.openings,
            &with.streams[..self.ports],
            with.positions,
            self.layers.count,
        );
        let parts = self.parts(with, &flows);
        let dt_s = with.dt_s / parts as f64;
        let flows_at_all = with.streams[..self.ports].iter().any(|s| s.m_flow_kg_s != 0.0);
        let mut passed = Passed::default();
        for _ in 0..parts {
            if flows_at_all {
                self.move_water(with, &flows, &mut water.cells, dt_s, &mut passed);
            }
            self.pass_coils(with, water, dt_s, &mut passed);
            let mut buffer = [0.0; N];
            if let Some(rod) = &self.rod {
                let share = self.of_cells(&rod.share, &water.cells, &mut buffer);
                let wanted = (rod.wanted_w(with.rod.0), with.rod.1);
                let blocked = &mut water.rod_blocked;
                passed.rod_j += rod.heat(&mut water.cells, share, wanted, self.cp(), dt_s, blocked);
            }
            let section = self.layers.cross_section_m2();
            let jets = self.jet.map(|jet| {
                let streams = &with.streams[..self.ports];
                jet.conductances_w_k(&self.openings, streams, with.positions, &water.cells)
            });
            let around = Surroundings {
                dt_s,
                heat_capacity_j_kg_k: self.cp(),
                ambient_k: with.ambient_k,
                ua_w_k: self.of_cells(&self.ua_w_k, &water.cells, &mut buffer),
                // G = lambda A/distance, distance = mass between/(density A).
                conduction_w_kg_k: self.conductivity_w_m_k
                    * section
                    * section
                    * self.layers.density_kg_m3,
                jets_w_k: jets.as_ref().map_or(&[], |jets| &jets[..]),
                buoyancy_w_kg_k: match self.buoyancy {
                    Buoyancy::Gradual => self.buoyancy_w_k * self.layers.layer_kg(),
                    Buoyancy::AtOnce => 0.0,
                },
            };
            passed.lost_j += exchange(&mut water.cells, &around);
            if self.buoyancy == Buoyancy::AtOnce {
                overturn(&mut water.cells);
            }
        }
        for outlet in &mut passed.outlets {
            outlet.constant_k /= parts as f64;
            outlet.of_inlet /= parts as f64;
        }
        passed
    }

    /// Advection in a part of a step; adds the outlets to `passed`.
    fn move_water<const N: usize>(
        &self,
        with: &Conditions<'_>,
        flows: &LayerFlows<N>,
        cells: &mut Cells<N>,
        dt_s: f64,
        passed: &mut Passed,
    ) {
        let streams = &with.streams[..self.ports];
        if self.layers_are_cells() {
            for opening in &self.openings.0 {
                let (m, position) =
                    (streams[opening.port].m_flow_kg_s, with.positions[opening.port]);
                let flow = opening.entering_tank_kg_s(m, position);
                if flow < 0.0 {
                    passed.outlets[opening.port].constant_k -=
                        flow / m.abs() * cells.t_k[opening.layer];
                }
            }
            advect(cells, flows, dt_s);
        } else {
            let layer_kg = self.layers.layer_kg();
            let left = displace(cells, &self.openings, streams, with.positions, dt_s, layer_kg);
            for (outlet, (mass_kg, kg_k)) in passed.outlets.iter_mut().zip(left) {
                if mass_kg > 0.0 {
                    outlet.constant_k += kg_k / mass_kg;
                }
            }
            merge(cells, self.most_cells(), layer_kg);
        }
    }

    fn pass_coils<const N: usize>(
        &self,
        with: &Conditions<'_>,
        water: &mut Water<'_, N>,
        dt_s: f64,
        passed: &mut Passed,
    ) {
        let mut buffer = [0.0; N];
        for (i, coil) in self.coils.iter().enumerate() {
            let stream = &with.streams[self.ports + i];
            let share = self.of_cells(&coil.share, &water.cells, &mut buffer);
            let content_k = &mut water.coils_k[i];
            if stream.m_flow_kg_s == 0.0 {
                coil.stand(content_k, &mut water.cells, share, self.cp(), dt_s);
                continue;
            }
            let arriving = coil.warm(&mut water.cells, share, stream, self.cp(), dt_s);
            let line = coil.flush(content_k, arriving, stream, dt_s);
            let outlet = &mut passed.outlets[self.ports + i];
            outlet.constant_k += line.constant_k;
            outlet.of_inlet += line.of_inlet;
        }
    }

    /// The line of a coil with the cells as they are, for a flow that is expected.
    pub(super) fn coil_line<const N: usize>(
        &self,
        coil: usize,
        water: &Water<'_, N>,
        expected: &PortFlow,
    ) -> Line {
        let mut buffer = [0.0; N];
        let share = self.of_cells(&self.coils[coil].share, &water.cells, &mut buffer);
        self.coils[coil].at_rest(&water.cells, share, expected, self.cp())
    }

    /// Gives heat back to the cells from which a port drew, without new extremes where that can be: first
    /// to its outlet, then towards where the water came from, then to the other side.
    pub(super) fn book<const N: usize>(
        &self,
        cells: &mut Cells<N>,
        (start, upwards): (usize, bool),
        heat_j: f64,
        (low_k, high_k): (f64, f64),
    ) {
        let mut rest = heat_j / self.cp();
        let bound_k = if rest > 0.0 { high_k } else { low_k };
        let n = cells.count;
        let mut give = |cells: &mut Cells<N>, i: usize| {
            let room = cells.mass_kg[i] * (bound_k - cells.t_k[i]);
            let given = if rest > 0.0 { rest.min(room.max(0.0)) } else { rest.max(room.min(0.0)) };
            cells.t_k[i] += given / cells.mass_kg[i];
            rest -= given;
        };
        let (below, above) = ((0..start).rev(), start + 1..n);
        give(cells, start);
        if upwards {
            above.chain(below).for_each(|i| give(cells, i));
        } else {
            below.chain(above).for_each(|i| give(cells, i));
        }
        if rest != 0.0 {
            let each_k = rest / cells.mass_kg[..n].iter().sum::<f64>();
            cells.t_k[..n].iter_mut().for_each(|t_k| *t_k += each_k);
        }
    }

    /// The cell from which a port or coil draws at its outlet, and whether its water comes from above.
    pub(super) fn outlet_of<const N: usize>(
        &self,
        port: usize,
        m_flow_kg_s: f64,
        position: f64,
        cells: &Cells<N>,
    ) -> (usize, bool) {
        let at_mass = |below_kg: f64| cells.at_mass(below_kg);
        if let Some(coil) = port.checked_sub(self.ports).map(|i| &self.coils[i]) {
            let rises = coil.rises == (m_flow_kg_s >= 0.0);
            let touched = |l: &usize| coil.share[*l] > 0.0;
            let mut layers = 0..self.layers.count;
            let last = if rises { layers.rfind(touched) } else { layers.find(touched) };
            let middle_kg = (last.unwrap_or_default() as f64 + 0.5) * self.layers.layer_kg();
            return (at_mass(middle_kg), !rises);
        }
        let entering = Port::upstream(m_flow_kg_s);
        let out_kg = self.openings.middle_kg(port, entering.opposite(), position);
        let in_kg = self.openings.entering_kg(port, entering, position);
        (at_mass(out_kg), in_kg > out_kg)
    }
}
