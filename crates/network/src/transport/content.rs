//! What pipes hold, as parcels or as cells.

use crate::graph::Network;
use crate::state::NetworkState;
use crate::two_port::{EdgeThermal, PlugFlowPipe, Wall};
use anergy_core::medium::Medium;
use anergy_core::port::Port;

impl NetworkState {
    /// Fills a pipe (water and wall) with one temperature, K.
    pub fn fill_pipe(&mut self, edge: usize, t_k: f64) {
        self.parcels.fill(edge, t_k);
        self.cells.fill(edge, |_| (t_k, t_k));
        self.t_edge_k[edge] = t_k;
    }

    /// Fills a pipe (water and wall) with a straight line from port a to port b, K.
    pub fn fill_pipe_linear(&mut self, edge: usize, t_a_k: f64, t_b_k: f64) {
        self.parcels.fill_linear(edge, t_a_k, t_b_k);
        self.cells.fill(edge, |share| {
            let t_k = t_a_k + (t_b_k - t_a_k) * share;
            (t_k, t_k)
        });
        self.t_edge_k[edge] = t_b_k;
    }

    /// Temperature of the water at an end of a pipe, K; `None` for other edges.
    pub fn pipe_end_k(&self, network: &Network, edge: usize, port: Port) -> Option<f64> {
        let EdgeThermal::PlugFlow(pipe) = network.edges[edge].element.thermal() else {
            return None;
        };
        if pipe.wall == Wall::EndVolume && port == Port::B {
            return Some(self.t_edge_k[edge]);
        }
        self.parcels.end_k(edge, port).or_else(|| self.cells.end_k(edge, port))
    }

    /// Mean temperature of the water in a pipe, K; `None` for other edges.
    pub fn pipe_mean_k(&self, edge: usize) -> Option<f64> {
        self.parcels.mean_k(edge).or_else(|| self.cells.whole_mean_k(edge))
    }

    /// The same between two shares of its length, from port a.
    pub(crate) fn pipe_mean_between_k(&self, edge: usize, from: f64, to: f64) -> Option<f64> {
        let parcels = self.parcels.mean_between_k(edge, from, to);
        parcels.or_else(|| self.cells.mean_k(edge, from, to))
    }

    /// Adds heat (over the heat capacity, kg K) to the content between two shares of the length.
    pub(crate) fn warm_pipe(
        &mut self,
        edge: usize,
        pipe: &PlugFlowPipe,
        (from, to): (f64, f64),
        heat: f64,
    ) {
        if pipe.has_cells() {
            self.cells.warm(edge, from, to, heat / pipe.content_kg);
        } else {
            self.parcels.warm(edge, pipe.content_kg, (from, to), heat);
        }
    }

    /// Sum over the water of a pipe of mass times a function of its temperature in K.
    pub fn sum_over_water(
        &self,
        edge: usize,
        pipe: &PlugFlowPipe,
        of_t_k: impl Fn(f64) -> f64,
    ) -> f64 {
        if let Some(cells) = self.cells.water(edge) {
            return cells.map(|(share, t_k)| share * pipe.water_kg * of_t_k(t_k)).sum();
        }
        let water = pipe.water_kg / pipe.content_kg;
        self.parcels.iter(edge).map(|p| p.mass_kg * water * of_t_k(p.mean_k())).sum()
    }

    /// Heat stored in water and wall of a pipe above 0 degC, J; 0 for other edges.
    pub fn pipe_holds_j(&self, network: &Network, edge: usize) -> f64 {
        match network.edges[edge].element.thermal() {
            EdgeThermal::PlugFlow(pipe) => self.pipe_stored_j(edge, &pipe, &network.medium),
            EdgeThermal::Pass | EdgeThermal::Exchanger(_) => 0.0,
        }
    }

    /// The same of a pipe with these data, J.
    pub fn pipe_stored_j(&self, edge: usize, pipe: &PlugFlowPipe, medium: &Medium) -> f64 {
        let beside_j = |t_k: f64| pipe.wall_kg * medium.enthalpy_j_kg(t_k);
        let wall_j = match pipe.wall {
            Wall::None | Wall::Equilibrium => 0.0,
            Wall::EndVolume => beside_j(self.t_edge_k[edge]),
            Wall::Film(_) => self.cells.wall_k(edge).map_or(0.0, beside_j),
        };
        let content_j = match self.cells.whole_mean_k(edge) {
            Some(t_k) => pipe.content_kg * medium.enthalpy_j_kg(t_k),
            None => self.parcels.stored_j(edge, medium),
        };
        content_j + wall_j
    }
}
