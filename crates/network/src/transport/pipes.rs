//! Pipes during a step and in the steady state: their content, and the mixed volume that may stand for
//! the wall.
//!
//! **Equation** volume at port b with the capacity M of the wall (as kg of water), which loses its share of
//! the heat: `M dT/dt = |m| (T_in - T) - M (T - T_b)/tau`, solved exactly over the step. Steady state along a
//! stretch of a pipe with neighbours: `T = T_e + (T_in - T_e) exp(-NTU)`,
//! `NTU = (loss + sum G)/|m|`, T_e the mean of what it exchanges heat with.
//!
//! **Assumptions** the inlet of the volume is constant during a step. Flow from b passes the volume first.
//! The steady profile leaves dispersion out: its outlet differs by about `NTU^2 D/(v L)` of the difference.
//!
//! **Sources** `vanderheijde2017`.

use super::parcels::MERGE_TOLERANCE_K;
use super::plug_flow::{self, Decay, mean_decay};
use super::{Relation, Transport, cells, volume_shares};
use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::{EdgeThermal, PlugFlowPipe, Wall};
use anergy_core::port::Port;

/// Straight pieces of the steady profile of a pipe, at most: half of what it holds.
const MOST_PIECES: f64 = 100.0;

/// A stretch of a pipe in the steady state.
pub(super) struct Stretch {
    /// Temperature that its water approaches, K.
    pub(super) towards_k: f64,
    /// Transfer units; infinite without flow.
    pub(super) ntu: f64,
    /// Conductance to neighbours, kg/s, and that times their temperatures.
    pub(super) beside: (f64, f64),
}

/// Temperature of a mixed volume: shares of that at the start and of the inlet; the rest is of the
/// surroundings.
struct Mixed {
    of_start: f64,
    of_inlet: f64,
}

impl Mixed {
    fn k(&self, start_k: f64, inlet_k: f64, surroundings_k: f64) -> f64 {
        let around = (1.0 - self.of_start - self.of_inlet) * surroundings_k;
        self.of_start * start_k + self.of_inlet * inlet_k + around
    }
}

/// The end volume in the mean of a step and at its end.
fn end_volume(pipe: &PlugFlowPipe, m_flow_kg_s: f64, dt_s: f64) -> (Mixed, Mixed) {
    let (inflow, loss) =
        (m_flow_kg_s.abs() / pipe.wall_kg, 1.0 / pipe.loss_time_constant_s(m_flow_kg_s));
    let rate = inflow + loss;
    let (mean, end) = volume_shares(rate * dt_s, 1.0);
    let inlet = if rate > 0.0 { inflow / rate } else { 0.0 };
    let mixed = |of_start: f64| Mixed { of_start, of_inlet: (1.0 - of_start) * inlet };
    (mixed(mean), mixed(end))
}

/// The same in the steady state.
fn settled_volume(pipe: &PlugFlowPipe, m_flow_kg_s: f64) -> Mixed {
    end_volume(pipe, m_flow_kg_s, f64::INFINITY).1
}

impl Relation {
    /// This edge, then a mixed volume.
    fn then(self, volume: &Mixed, start_k: f64, surroundings_k: f64) -> Self {
        Self {
            constant_k: volume.k(start_k, self.constant_k, surroundings_k),
            of_inlet: volume.of_inlet * self.of_inlet,
            ..Relation::PASS
        }
    }

    /// A mixed volume, then this edge.
    fn after(self, volume: &Mixed, start_k: f64, surroundings_k: f64) -> Self {
        Self {
            constant_k: self.constant_k + self.of_inlet * volume.k(start_k, 0.0, surroundings_k),
            of_inlet: self.of_inlet * volume.of_inlet,
            ..Relation::PASS
        }
    }
}

impl Transport {
    /// Factors of the heat loss of all pipes over a step of this length.
    pub(super) fn prepare_decays(&mut self, network: &Network, dt_s: f64) {
        if self.decays_dt_s == dt_s {
            return;
        }
        self.decays_dt_s = dt_s;
        for (decay, edge) in self.decays.iter_mut().zip(&network.edges) {
            if let EdgeThermal::PlugFlow(pipe) = edge.element.thermal() {
                *decay = Decay::new(dt_s / pipe.loss_time_constant_s);
            }
        }
    }

    /// What leaves a pipe in a step as a function of what enters.
    pub(super) fn pipe_relation(
        &self,
        state: &NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        m: f64,
        dt_s: f64,
    ) -> Relation {
        let content = content_relation(state, i, pipe, m, dt_s);
        if pipe.wall != Wall::EndVolume {
            return content;
        }
        let volume = end_volume(pipe, m, dt_s).0;
        let (start_k, around_k) = (state.t_edge_k[i], state.surroundings_k[i]);
        match Port::upstream(m) {
            Port::A => content.then(&volume, start_k, around_k),
            Port::B => content.after(&volume, start_k, around_k),
        }
    }

    /// Moves the content of a pipe by a step; returns the heat lost over the heat capacity, kg K.
    pub(super) fn advance_pipe(
        &self,
        state: &mut NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        t_in_k: f64,
        dt_s: f64,
    ) -> f64 {
        let (m, around_k) = (state.m_flow_kg_s[i], state.surroundings_k[i]);
        if pipe.wall != Wall::EndVolume {
            let mut outlet = self.relation[i];
            outlet.constant_k -= state.friction_rise_k(i);
            return self.advance_content(state, i, pipe, t_in_k, dt_s, outlet);
        }
        let (mean, end) = end_volume(pipe, m, dt_s);
        let start_k = state.t_edge_k[i];
        let content =
            if m == 0.0 { Relation::PASS } else { content_relation(state, i, pipe, m, dt_s) };
        let (into_content_k, into_volume_k) = match Port::upstream(m) {
            Port::A => (t_in_k, content.constant_k + content.of_inlet * t_in_k),
            Port::B => (mean.k(start_k, t_in_k, around_k), t_in_k),
        };
        let lost = self.advance_content(state, i, pipe, into_content_k, dt_s, content);
        state.t_edge_k[i] = end.k(start_k, into_volume_k, around_k);
        let above_k = mean.k(start_k, into_volume_k, around_k) - around_k;
        lost + pipe.wall_kg * above_k * dt_s / pipe.loss_time_constant_s(m)
    }

    fn advance_content(
        &self,
        state: &mut NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        t_in_k: f64,
        dt_s: f64,
        outlet: Relation,
    ) -> f64 {
        let (m_flow_kg_s, surroundings_k) = (state.m_flow_kg_s[i], state.surroundings_k[i]);
        let port = Port::upstream(m_flow_kg_s);
        if let Some(mut content) = state.cells.seen_from(i, port, surroundings_k) {
            let step = cells::Step { m_flow_kg_s, dt_s };
            let passed = content.pass(pipe, &step, t_in_k - surroundings_k);
            state.cells.put(i, port, content, surroundings_k);
            return passed.lost;
        }
        let time_constant_s = pipe.loss_time_constant_s(m_flow_kg_s);
        let decay = if time_constant_s == pipe.loss_time_constant_s {
            self.decays[i]
        } else {
            Decay::new(dt_s / time_constant_s)
        };
        let step = plug_flow::Step { m_flow_kg_s, t_in_k, surroundings_k, dt_s, decay, outlet };
        plug_flow::advance(&mut state.parcels, i, pipe, &step)
    }

    /// What leaves a pipe in the steady state as a function of what enters.
    pub(super) fn steady_pipe(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        m: f64,
    ) -> Relation {
        let mut content = Relation::PASS;
        for k in 0..self.stretches(i) {
            let Stretch { towards_k, ntu, .. } = self.stretch(network, state, i, pipe, m, k);
            let decay = (-ntu).exp();
            content.constant_k = towards_k * (1.0 - decay) + content.constant_k * decay;
            content.of_inlet *= decay;
        }
        if pipe.wall != Wall::EndVolume {
            return content;
        }
        let (volume, around_k) = (settled_volume(pipe, m), state.surroundings_k[i]);
        match Port::upstream(m) {
            Port::A => content.then(&volume, around_k, around_k),
            Port::B => content.after(&volume, around_k, around_k),
        }
    }

    /// Fills a pipe with its steady profile; books what it exchanges with others.
    pub(super) fn settle_pipe(
        &self,
        network: &Network,
        state: &mut NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        t_in_k: f64,
    ) {
        let (m, around_k) = (state.m_flow_kg_s[i], state.surroundings_k[i]);
        let n = self.stretches(i);
        let inlet = Port::upstream(m);
        let mut t_k = t_in_k;
        if pipe.wall == Wall::EndVolume {
            let volume = settled_volume(pipe, m);
            if m < 0.0 {
                state.t_edge_k[i] = volume.k(around_k, t_in_k, around_k);
                t_k = state.t_edge_k[i];
            }
        }
        // Ends of the stretches in the order of the flow.
        let mut ends = Vec::with_capacity(n);
        let mut from_beside = 0.0;
        for k in 0..n {
            let stretch = self.stretch(network, state, i, pipe, m, k);
            if m == 0.0 && stretch.ntu == 0.0 {
                return;
            }
            let excess_k = t_k - stretch.towards_k;
            let (first_k, last_k) = if m == 0.0 {
                (stretch.towards_k, stretch.towards_k)
            } else {
                (t_k, stretch.towards_k + excess_k * (-stretch.ntu).exp())
            };
            let mean_k = if m == 0.0 {
                stretch.towards_k
            } else {
                stretch.towards_k + excess_k * mean_decay(stretch.ntu)
            };
            from_beside += stretch.beside.1 - stretch.beside.0 * mean_k;
            ends.push((first_k, last_k, stretch.towards_k));
            t_k = last_k;
        }
        if inlet == Port::B {
            ends.reverse();
            ends.iter_mut().for_each(|(first, last, _)| std::mem::swap(first, last));
        }
        if pipe.has_cells() {
            let wall_share = match pipe.wall {
                Wall::Film(film) => {
                    let outer = pipe.capacity_kg() / pipe.loss_time_constant_s(m);
                    let inner = film.conductance_kg_s(m);
                    inner / (inner + outer)
                }
                _ => 1.0,
            };
            state.cells.fill(i, |share| {
                let at = share * n as f64;
                let k = (at as usize).min(n - 1);
                let (a, b, towards) = ends[k];
                let ratio = if a == towards { 1.0 } else { (b - towards) / (a - towards) };
                let water_k = towards + (a - towards) * ratio.powf(at - k as f64);
                (water_k, around_k + (water_k - around_k) * wall_share)
            });
        } else if let [profile] = ends[..] {
            state.parcels.fill_stretches(i, &straight_pieces(profile));
        } else {
            state.parcels.fill_stretches(i, &ends);
        }
        if pipe.wall == Wall::EndVolume && m >= 0.0 {
            let inlet_k = if m == 0.0 { around_k } else { t_k };
            state.t_edge_k[i] = settled_volume(pipe, m).k(around_k, inlet_k, around_k);
        }
        state.q_flow_w[i] = from_beside * network.medium.heat_capacity_j_kg_k;
    }

    /// The k-th stretch of a pipe in the order of the flow.
    fn stretch(
        &self,
        network: &Network,
        state: &NetworkState,
        i: usize,
        pipe: &PlugFlowPipe,
        m: f64,
        k: usize,
    ) -> Stretch {
        let around_k = state.surroundings_k[i];
        if self.coupled.of_edge(i).is_empty() {
            let ntu = if m == 0.0 { pipe.loss_kg_s(m) } else { pipe.steady_ntu(m) };
            return Stretch { towards_k: around_k, ntu, beside: (0.0, 0.0) };
        }
        let n = self.stretches(i) as f64;
        let (begin, end) = (k as f64 / n, (k as f64 + 1.0) / n);
        let range = if m < 0.0 { (1.0 - end, 1.0 - begin) } else { (begin, end) };
        let beside = self.coupled.beside(network, state, i, range);
        let loss_kg_s = pipe.loss_kg_s(m) / n;
        let all_kg_s = loss_kg_s + beside.0;
        if all_kg_s == 0.0 {
            return Stretch { towards_k: around_k, ntu: 0.0, beside };
        }
        Stretch {
            towards_k: (loss_kg_s * around_k + beside.1) / all_kg_s,
            ntu: all_kg_s / if m == 0.0 { 1.0 } else { m.abs() },
            beside,
        }
    }

    /// Number of stretches of a pipe in the steady state: more than one beside others.
    fn stretches(&self, i: usize) -> usize {
        self.coupled.stretches(i)
    }
}

/// Straight pieces of the exponential between its ends towards what it approaches, K. Between two of its points
/// a straight line is above it by at most `excess (ntu/n)^2/8`.
fn straight_pieces((t_a_k, t_b_k, towards_k): (f64, f64, f64)) -> Vec<(f64, f64, f64)> {
    let (a_k, b_k) = (t_a_k - towards_k, t_b_k - towards_k);
    let ratio = b_k / a_k;
    let pieces = ratio.ln().abs() * (a_k.abs().max(b_k.abs()) / (8.0 * MERGE_TOLERANCE_K)).sqrt();
    // Without excess there is one piece, and where a pipe cools down altogether as many as there may be.
    let n = if pieces.is_nan() { 1.0 } else { pieces.ceil().clamp(1.0, MOST_PIECES) };
    let at_k = |k: f64| match k {
        0.0 => t_a_k,
        k if k == n => t_b_k,
        k => towards_k + a_k * ratio.powf(k / n),
    };
    (0..n as usize).map(|k| (at_k(k as f64), at_k(k as f64 + 1.0), towards_k)).collect()
}

/// The content of a pipe without its end volume.
fn content_relation(
    state: &NetworkState,
    i: usize,
    pipe: &PlugFlowPipe,
    m_flow_kg_s: f64,
    dt_s: f64,
) -> Relation {
    let around_k = state.surroundings_k[i];
    match state.cells.seen_from(i, Port::upstream(m_flow_kg_s), around_k) {
        None => plug_flow::relation(&state.parcels, i, pipe, m_flow_kg_s, around_k, dt_s),
        Some(mut content) => {
            let step = cells::Step { m_flow_kg_s, dt_s };
            let passed_kg = m_flow_kg_s.abs() * dt_s;
            let of_inlet = content.cooled().pass(pipe, &step, 1.0).left / passed_kg;
            let of_content_k = content.pass(pipe, &step, 0.0).left / passed_kg;
            let constant_k = around_k + of_content_k - of_inlet * around_k;
            Relation { constant_k, of_inlet, ..Relation::PASS }
        }
    }
}
