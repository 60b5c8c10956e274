//! The storage as a thermal unit: its state in a slice, its promises, its channels.

use super::StorageParams;
use super::layers::Cells;
use super::ports::MAX_PORTS;
use super::tank::{Conditions, Tank, Water};
use crate::thermal_unit::{Exchange, ThermalUnit, UnitInput, UnitOutput, UnitPort};
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

/// The water at the start of a run.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Initial {
    /// That of the run.
    OfRun,
    /// Temperatures of the layers, K.
    Layers(Vec<f64>),
}

// Places of the state; behind them the content of each coil, K, the last flow of each coil, kg/s, and the
// cells: temperatures of the layers, or count, masses and temperatures of parcels.
pub(super) const LAST_STEP_S: usize = 0;
const ROD_BLOCKED: usize = 1;
const LOST_J: usize = 2;
const ROD_J: usize = 3;
const CHARGED_J: usize = 4;
const DISCHARGED_J: usize = 5;
pub(super) const COILS: usize = 6;

/// Steps are not made shorter than this, s.
const SHORTEST_LIMIT_S: f64 = 60.0;

/// A storage ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct Storage {
    pub(super) tank: Tank,
    /// Names of the ports, then of the coils.
    names: Vec<String>,
    /// Ports with two positions.
    switched: Vec<usize>,
    initial: Initial,
    ambient_k: f64,
    soc_empty_k: f64,
    soc_full_k: f64,
}

impl Storage {
    pub(super) fn new(params: &StorageParams, tank: Tank, initial: Initial) -> Self {
        let switched =
            params.ports.values().enumerate().filter(|(_, port)| !port.positions.is_empty());
        Self {
            names: params.ports.keys().chain(params.coils.keys()).cloned().collect(),
            switched: switched.map(|(port, _)| port).collect(),
            initial,
            ambient_k: params.ambient_k,
            soc_empty_k: params.soc_empty_k,
            soc_full_k: params.soc_full_k,
            tank,
        }
    }

    fn first_cell(&self) -> usize {
        COILS + 2 * self.tank.coils.len()
    }

    /// Most cells during a step: what is kept, and what every stream adds before it is merged.
    fn cells_in_a_step(&self) -> usize {
        let openings = self.tank.openings.0.len().min(2 * MAX_PORTS);
        self.tank.most_cells() + if self.tank.layers_are_cells() { 0 } else { 2 * openings + 2 }
    }

    pub(super) fn water<'a, const N: usize>(
        &self,
        state: &[f64],
        coils_k: &'a mut [f64],
    ) -> Water<'a, N> {
        let stored = &state[self.first_cell()..];
        let mut cells = Cells::empty();
        if self.tank.layers_are_cells() {
            let layer_kg = self.tank.layers.layer_kg();
            stored.iter().for_each(|t_k| cells.push(layer_kg, *t_k));
        } else {
            let (count, parcels) = (stored[0] as usize, &stored[1..]);
            let (masses, temperatures) = parcels.split_at(self.tank.most_cells());
            (0..count).for_each(|i| cells.push(masses[i], temperatures[i]));
        }
        let coils = self.tank.coils.len();
        coils_k.copy_from_slice(&state[COILS..COILS + coils]);
        Water { cells, coils_k, rod_blocked: state[ROD_BLOCKED] != 0.0 }
    }

    fn keep<const N: usize>(&self, water: &Water<'_, N>, state: &mut [f64]) {
        state[COILS..COILS + water.coils_k.len()].copy_from_slice(water.coils_k);
        state[ROD_BLOCKED] = f64::from(u8::from(water.rod_blocked));
        let stored = &mut state[self.first_cell()..];
        let Cells { count, mass_kg, t_k } = &water.cells;
        if self.tank.layers_are_cells() {
            stored.copy_from_slice(&t_k[..*count]);
        } else {
            let (number, parcels) = stored.split_at_mut(1);
            number[0] = *count as f64;
            parcels.fill(0.0);
            let (masses, temperatures) = parcels.split_at_mut(self.tank.most_cells());
            masses[..*count].copy_from_slice(&mass_kg[..*count]);
            temperatures[..*count].copy_from_slice(&t_k[..*count]);
        }
    }

    pub(super) fn positions(&self, signals: &Signals<'_>) -> [f64; MAX_PORTS] {
        let mut positions = [0.0; MAX_PORTS];
        let first = if self.tank.rod.is_some() { 3 } else { 1 };
        for (i, port) in self.switched.iter().enumerate() {
            positions[*port] = signals.get(first + i).clamp(0.0, 1.0);
        }
        positions
    }

    pub(super) fn conditions<'a>(
        signals: &Signals<'_>,
        dt_s: f64,
        streams: &'a [PortFlow],
        positions: &'a [f64; MAX_PORTS],
        has_rod: bool,
    ) -> Conditions<'a> {
        let rod = if has_rod { (signals.get(1), signals.get(2)) } else { (0.0, 0.0) };
        Conditions { dt_s, streams, positions, ambient_k: signals.get(0), rod }
    }

    fn step<const N: usize>(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        streams: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let tank = &self.tank;
        let coils = tank.coils.len();
        let cp = tank.layers.heat_capacity_j_kg_k;
        let mut coils_k = [0.0; MAX_PORTS];
        let mut water = self.water::<N>(state, &mut coils_k[..coils]);
        let mut exchange = Exchange::default();
        let mut miss_k = 0.0_f64;
        if dt_s > 0.0 {
            let positions = self.positions(signals);
            let with = Self::conditions(signals, dt_s, streams, &positions, tank.rod.is_some());
            let before_k = water.cells.range_k();
            let passed = tank.pass(&with, &mut water);
            let after_k = water.cells.range_k();
            let mut range_k = (before_k.0.min(after_k.0), before_k.1.max(after_k.1));
            for stream in streams.iter().filter(|stream| stream.m_flow_kg_s != 0.0) {
                range_k = (range_k.0.min(stream.t_in_k), range_k.1.max(stream.t_in_k));
            }
            for (port, stream) in streams.iter().enumerate() {
                let m = stream.m_flow_kg_s;
                if m == 0.0 {
                    continue;
                }
                // What left in the model was hotter than what did leave: the rest is still there.
                let too_hot_k = passed.outlets[port].at(stream.t_in_k) - stream.t_out_k;
                let outlet = tank.outlet_of(port, m, positions[port], &water.cells);
                tank.book(&mut water.cells, outlet, m.abs() * cp * dt_s * too_hot_k, range_k);
                miss_k = miss_k.max(too_hot_k.abs());
                let heat_j = m.abs() * cp * dt_s * (stream.t_in_k - stream.t_out_k);
                state[if heat_j > 0.0 { CHARGED_J } else { DISCHARGED_J }] += heat_j.abs();
                if port >= tank.ports {
                    state[COILS + coils + port - tank.ports] = m;
                }
            }
            state[LAST_STEP_S] = dt_s;
            state[LOST_J] += passed.lost_j;
            state[ROD_J] += passed.rod_j;
            exchange.electric_w = passed.rod_j / dt_s;
            exchange.external_w = -passed.lost_j / dt_s;
            self.keep(&water, state);
        }
        self.settle(&water, streams, state, (exchange, miss_k), out);
        exchange
    }

    /// Writes the outputs.
    fn settle<const N: usize>(
        &self,
        water: &Water<'_, N>,
        streams: &[PortFlow],
        state: &[f64],
        (exchange, miss_k): (Exchange, f64),
        out: &mut [f64],
    ) {
        let tank = &self.tank;
        let (own, layers) = out.split_at_mut(OWN_OUTPUTS.len());
        let energy_j = tank.heat_j(&water.cells, water.coils_k, self.soc_empty_k);
        let capacity_j_k = tank.layers.heat_capacity_j_kg_k
            * (tank.layers.mass_kg() + tank.coils.iter().map(|coil| coil.content_kg).sum::<f64>());
        own.copy_from_slice(&[
            energy_j / (capacity_j_k * (self.soc_full_k - self.soc_empty_k)),
            energy_j,
            -exchange.external_w,
            state[LOST_J],
            exchange.electric_w,
            state[ROD_J],
            state[CHARGED_J],
            state[DISCHARGED_J],
            miss_k,
        ]);
        let (means_k, ports) = layers.split_at_mut(tank.layers.count);
        if tank.layers_are_cells() {
            means_k.copy_from_slice(water.cells.temperatures());
        } else {
            water.cells.layer_means_k(tank.layers.layer_kg(), means_k);
        }
        for (stream, out) in streams.iter().zip(ports.chunks_exact_mut(PORT_OUTPUTS.len())) {
            let PortFlow { m_flow_kg_s, t_in_k, t_out_k } = *stream;
            let heat_w = m_flow_kg_s.abs() * tank.layers.heat_capacity_j_kg_k * (t_in_k - t_out_k);
            out.copy_from_slice(&[m_flow_kg_s, t_in_k, t_out_k, heat_w]);
        }
    }
}

/// Outputs of the storage as a whole.
const OWN_OUTPUTS: [(&str, &str); 9] = [
    ("soc", "1"),
    ("energy_j", "J"),
    ("loss_w", "W"),
    ("loss_j", "J"),
    ("rod_w", "W"),
    ("rod_j", "J"),
    ("charged_j", "J"),
    ("discharged_j", "J"),
    ("outlet_miss_k", "K"),
];

/// Outputs of each port and coil; heat is positive into the storage.
const PORT_OUTPUTS: [(&str, &str); 4] =
    [("m_flow_kg_s", "kg s-1"), ("t_in_k", "K"), ("t_out_k", "K"), ("q_flow_w", "W")];

/// A name for the rest of the process: each is kept once.
fn kept(name: String) -> &'static str {
    static NAMES: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut names = NAMES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = names.get(name.as_str()) {
        return known;
    }
    let name: &'static str = Box::leak(name.into_boxed_str());
    names.insert(name);
    name
}

/// Calls a method with cells for the size of a storage.
macro_rules! sized {
    ($storage:ident.$method:ident($($argument:expr),*)) => {
        match $storage.cells_in_a_step() {
            0..=32 => $storage.$method::<32>($($argument),*),
            33..=128 => $storage.$method::<128>($($argument),*),
            _ => $storage.$method::<512>($($argument),*),
        }
    };
}

impl ThermalUnit for Storage {
    fn ports(&self) -> Vec<UnitPort> {
        let port = |name: &String| UnitPort { name: name.into(), sets_flow: false, leads: false };
        self.names.iter().map(port).collect()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let share = |name, initial| UnitInput {
            name,
            unit: "",
            initial,
            min: 0.0,
            max: 1.0,
            follows: None,
        };
        let temperature = |name, initial| UnitInput {
            name,
            unit: "k",
            initial,
            min: 0.0,
            max: f64::INFINITY,
            follows: None,
        };
        let mut inputs = vec![temperature("ambient_k", self.ambient_k)];
        if let Some(rod) = &self.tank.rod {
            inputs.extend([share("rod", 0.0), temperature("rod_set_k", rod.t_max_k)]);
        }
        let position = |port: &usize| share(kept(format!("{}_position", self.names[*port])), 0.0);
        inputs.extend(self.switched.iter().map(position));
        inputs
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        let own = OWN_OUTPUTS.iter().map(|(name, unit)| UnitOutput::new(name, unit));
        let layers = (1..=self.tank.layers.count).map(|layer| (format!("t_{layer}_k"), "K", true));
        let ports = self.names.iter().flat_map(|port| {
            PORT_OUTPUTS.map(|(name, unit)| (format!("{port}_{name}"), unit, false))
        });
        let named = |(name, unit, is_state): (String, _, _)| {
            let name = name.into();
            UnitOutput { name, unit, is_state }
        };
        own.chain(layers.chain(ports).map(named)).collect()
    }

    fn initial_state(&self, initial_k: f64) -> Vec<f64> {
        let tank = &self.tank;
        let mut state = vec![0.0; COILS];
        let layers_k = match &self.initial {
            Initial::OfRun => vec![initial_k; tank.layers.count],
            Initial::Layers(layers_k) => layers_k.clone(),
        };
        for coil in &tank.coils {
            state.push(coil.share.iter().zip(&layers_k).map(|(share, t_k)| share * t_k).sum());
        }
        state.extend(tank.coils.iter().map(|coil| coil.m_flow_nominal_kg_s));
        if tank.layers_are_cells() {
            state.extend(layers_k);
        } else {
            let rest = tank.most_cells() - layers_k.len();
            state.push(layers_k.len() as f64);
            state.extend(layers_k.iter().map(|_| tank.layers.layer_kg()));
            state.extend(std::iter::repeat_n(0.0, rest));
            state.extend(&layers_k);
            state.extend(std::iter::repeat_n(0.0, rest));
        }
        state
    }

    fn request(
        &self,
        signals: &Signals<'_>,
        got: &[PortFlow],
        state: &mut [f64],
        wanted: &mut [PortRequest],
    ) {
        sized!(self.promise(signals, got, state, wanted));
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        sized!(self.step(dt_s, signals, ports, state, out))
    }

    /// A port or coil must not send more through the tank than it holds.
    fn longest_step_s(&self, ports: &[PortFlow], _state: &[f64]) -> f64 {
        let largest_kg_s = ports.iter().fold(0.0, |m, port| f64::max(m, port.m_flow_kg_s.abs()));
        (self.tank.layers.mass_kg() / largest_kg_s).max(SHORTEST_LIMIT_S)
    }

    fn stored_j(&self, state: &[f64]) -> f64 {
        let tank = &self.tank;
        let coils_k = &state[COILS..COILS + tank.coils.len()];
        let stored = &state[self.first_cell()..];
        let content: f64 = if tank.layers_are_cells() {
            stored.iter().map(|t_k| tank.layers.layer_kg() * (t_k - ZERO_CELSIUS_K)).sum()
        } else {
            let (masses, temperatures) = stored[1..].split_at(tank.most_cells());
            masses.iter().zip(temperatures).map(|(m, t_k)| m * (t_k - ZERO_CELSIUS_K)).sum()
        };
        let coils = tank.coils.iter().zip(coils_k);
        let in_coils: f64 = coils.map(|(coil, t_k)| coil.content_kg * (t_k - ZERO_CELSIUS_K)).sum();
        tank.layers.heat_capacity_j_kg_k * (content + in_coils)
    }
}
