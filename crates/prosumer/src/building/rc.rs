//! A network of thermal capacities and conductances, advanced exactly.
//!
//! **Equation** `C_i dT_i/dt = sum_j G_ij (T_j - T_i) + sum_b G_ib (T_b - T_i) + Q_i`: nodes with a capacity, or
//! without one (surfaces), boundaries of given temperature, gains of heat. Nodes without capacity are
//! eliminated; with `T = C^(-1/2) V z` and `V` the eigenvectors of `C^(-1/2) K C^(-1/2)` the modes are
//! independent, `dz/dt = -lambda z + b`, and over a step in which the inputs are constant
//! `mean(z) = phi z_0 + dt chi b`, `phi = (1 - e^-x)/x`, `chi = (1 - phi)/x`, `x = lambda dt`.
//! **Assumptions** capacities and conductances are constant; what varies (ventilation, an emitter) enters as a
//! gain that the caller finds from the linear response of the means.
//!
//! **Numerics** exact for any step, so stable without a limit, and nothing of a step length is kept. The change
//! is taken from the mean, `z_1 - z_0 = dt (b - lambda mean(z))`, so the heat that the outputs report is the
//! heat that is stored, to rounding. Everything is in arrays of the size of the types: nothing is allocated.
//! `N`: most capacities, `U`: inputs, `Y`: outputs.

use anergy_core::numerics::dense::DenseSystem;
use anergy_core::numerics::symmetric;

/// A node of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Node(usize);

/// Where a conductance ends or a gain is heard of.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Weight {
    node: usize,
    index: usize,
    value: f64,
}

/// A network while it is put together.
#[derive(Debug, Clone, Default)]
pub struct RcNetwork {
    capacity_j_k: Vec<f64>,
    links: Vec<(usize, usize, f64)>,
    boundaries: Vec<Weight>,
    gains: Vec<Weight>,
    observed: Vec<Weight>,
    observed_inputs: Vec<(usize, usize, f64)>,
}

impl RcNetwork {
    /// A node with a capacity, J/K; with none, a surface.
    pub fn node(&mut self, capacity_j_k: f64) -> Node {
        self.capacity_j_k.push(capacity_j_k);
        Node(self.capacity_j_k.len() - 1)
    }

    /// A conductance between two nodes, W/K.
    pub fn link(&mut self, a: Node, b: Node, conductance_w_k: f64) {
        self.links.push((a.0, b.0, conductance_w_k));
    }

    /// A conductance, W/K, to a boundary whose temperature is an input.
    pub fn boundary(&mut self, node: Node, input: usize, conductance_w_k: f64) {
        self.boundaries.push(Weight { node: node.0, index: input, value: conductance_w_k });
    }

    /// A share of the heat of an input that a node takes up.
    pub fn gain(&mut self, node: Node, input: usize, share: f64) {
        self.gains.push(Weight { node: node.0, index: input, value: share });
    }

    /// An output gets the temperature of a node times a weight.
    pub fn observe(&mut self, output: usize, node: Node, weight: f64) {
        self.observed.push(Weight { node: node.0, index: output, value: weight });
    }

    /// An output gets the heat that comes in from the boundary of an input, W.
    pub fn observe_boundary(&mut self, output: usize, input: usize) {
        for k in 0..self.boundaries.len() {
            let Weight { node, index, value } = self.boundaries[k];
            if index == input {
                self.observed.push(Weight { node, index: output, value: -value });
                self.observed_inputs.push((output, input, value));
            }
        }
    }

    /// The network ready to run; `None` where it has more than `N` capacities, or nodes without capacity that
    /// are connected to nothing.
    #[allow(clippy::needless_range_loop, reason = "rows and columns of several matrices at once")]
    pub fn model<const N: usize, const U: usize, const Y: usize>(
        &self,
    ) -> Option<RcModel<N, U, Y>> {
        let nodes = self.capacity_j_k.len();
        let (held, light): (Vec<usize>, Vec<usize>) =
            (0..nodes).partition(|node| self.capacity_j_k[*node] > 0.0);
        if held.len() > N {
            return None;
        }
        let mut k = vec![vec![0.0; nodes]; nodes];
        for &(a, b, g) in &self.links {
            k[a][a] += g;
            k[b][b] += g;
            k[a][b] -= g;
            k[b][a] -= g;
        }
        let mut inputs = vec![[0.0; U]; nodes];
        for boundary in &self.boundaries {
            k[boundary.node][boundary.node] += boundary.value;
            inputs[boundary.node][boundary.index] += boundary.value;
        }
        for gain in &self.gains {
            inputs[gain.node][gain.index] += gain.value;
        }
        // T = of_held T_held + of_inputs u of every node.
        let mut of_held = vec![[0.0; N]; nodes];
        let mut of_inputs = vec![[0.0; U]; nodes];
        for (column, node) in held.iter().enumerate() {
            of_held[*node][column] = 1.0;
        }
        let mut system = DenseSystem::with_room(light.len());
        system.begin(light.len());
        for (row, node) in light.iter().enumerate() {
            for (column, other) in light.iter().enumerate() {
                system.set(row, column, k[*node][*other]);
            }
        }
        if !light.is_empty() && !system.factor() {
            return None;
        }
        for (column, other) in held.iter().enumerate() {
            let mut rhs: Vec<f64> = light.iter().map(|node| -k[*node][*other]).collect();
            if !rhs.is_empty() && !system.solve_factored(&mut rhs) {
                return None;
            }
            light.iter().zip(&rhs).for_each(|(node, value)| of_held[*node][column] = *value);
        }
        for input in 0..U {
            let mut rhs: Vec<f64> = light.iter().map(|node| inputs[*node][input]).collect();
            if !rhs.is_empty() && !system.solve_factored(&mut rhs) {
                return None;
            }
            light.iter().zip(&rhs).for_each(|(node, value)| of_inputs[*node][input] = *value);
        }
        let mut scale = [1.0; N];
        for (mode, node) in held.iter().enumerate() {
            scale[mode] = 1.0 / self.capacity_j_k[*node].sqrt();
        }
        let mut reduced = [[0.0; N]; N];
        let mut force = [[0.0; U]; N];
        for (row, node) in held.iter().enumerate() {
            for column in 0..held.len() {
                let sum: f64 =
                    (0..nodes).map(|other| k[*node][other] * of_held[other][column]).sum();
                reduced[row][column] = sum * scale[row] * scale[column];
            }
            for input in 0..U {
                let away: f64 =
                    light.iter().map(|other| k[*node][*other] * of_inputs[*other][input]).sum();
                force[row][input] = inputs[*node][input] - away;
            }
        }
        for row in 0..N {
            for column in 0..row {
                let mean = 0.5 * (reduced[row][column] + reduced[column][row]);
                (reduced[row][column], reduced[column][row]) = (mean, mean);
            }
        }
        let (lambda, vectors) = symmetric::eigen(reduced);
        let mut model = RcModel {
            nodes: held.len(),
            capacity_j_k: [0.0; N],
            lambda: lambda.map(|value| value.max(0.0)),
            to_modes: [[0.0; N]; N],
            from_modes: [[0.0; N]; N],
            force: [[0.0; N]; U],
            of_modes: [[0.0; Y]; N],
            of_inputs: [[0.0; Y]; U],
        };
        for (i, node) in held.iter().enumerate() {
            model.capacity_j_k[i] = self.capacity_j_k[*node];
            for mode in 0..N {
                model.to_modes[i][mode] = vectors[i][mode] / scale[i];
                model.from_modes[mode][i] = vectors[i][mode] * scale[i];
            }
        }
        for mode in 0..N {
            for input in 0..U {
                model.force[input][mode] =
                    (0..held.len()).map(|i| vectors[i][mode] * scale[i] * force[i][input]).sum();
            }
        }
        for &Weight { node, index, value } in &self.observed {
            for mode in 0..N {
                let temperature: f64 =
                    (0..held.len()).map(|i| of_held[node][i] * model.from_modes[mode][i]).sum();
                model.of_modes[mode][index] += value * temperature;
            }
            for input in 0..U {
                model.of_inputs[input][index] += value * of_inputs[node][input];
            }
        }
        for &(output, input, value) in &self.observed_inputs {
            model.of_inputs[input][output] += value;
        }
        Some(model)
    }
}

/// A network ready to run. Its state is the temperatures of the nodes with a capacity, K, in their order.
#[derive(Debug, Clone, PartialEq)]
pub struct RcModel<const N: usize, const U: usize, const Y: usize> {
    nodes: usize,
    capacity_j_k: [f64; N],
    lambda: [f64; N],
    /// Matrices as columns: `to_modes[i]` is what temperature i does to all modes.
    to_modes: [[f64; N]; N],
    from_modes: [[f64; N]; N],
    force: [[f64; N]; U],
    of_modes: [[f64; Y]; N],
    of_inputs: [[f64; Y]; U],
}

/// A step that is under way: inputs may still be added.
#[derive(Debug, Clone)]
pub struct RcStep<const N: usize, const U: usize> {
    dt_s: f64,
    /// Inputs: boundary temperatures in K, gains in W.
    inputs: [f64; U],
    start: [f64; N],
    force: [f64; N],
    /// Share of the start in the mean.
    phi: [f64; N],
    /// Mean over the step per unit of force, s.
    chi_s: [f64; N],
}

/// Below this `1 - e^-x` loses digits and the series is used.
const SMALL: f64 = 0.02;

/// `phi = (1 - e^-x)/x` and `chi = (1 - phi)/x`.
#[inline]
pub fn means(x: f64) -> (f64, f64) {
    if x < SMALL {
        // The first term left out is x^6/40320.
        let inner = 1.0 / 120.0 - x * (1.0 / 720.0 - x * (1.0 / 5040.0));
        let chi = 0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x * inner));
        (1.0 - x * chi, chi)
    } else {
        let inverse = 1.0 / x;
        let phi = (1.0 - (-x).exp()) * inverse;
        (phi, (1.0 - phi) * inverse)
    }
}

/// Adds a matrix, as its columns, times a vector: column by column, so that the sums are independent.
#[inline]
fn add_product<const M: usize>(columns: &[[f64; M]], vector: &[f64], sum: &mut [f64; M]) {
    for (column, x) in columns.iter().zip(vector) {
        for m in 0..M {
            sum[m] += column[m] * x;
        }
    }
}

impl<const N: usize, const U: usize, const Y: usize> RcModel<N, U, Y> {
    /// Number of temperatures in the state.
    pub fn nodes(&self) -> usize {
        self.nodes
    }

    /// Heat above 0 degC, J.
    pub fn stored_j(&self, t_k: &[f64]) -> f64 {
        let zero_k = anergy_core::medium::ZERO_CELSIUS_K;
        self.capacity_j_k.iter().zip(t_k).map(|(c, t)| c * (t - zero_k)).sum()
    }

    /// Begins a step from the temperatures of the state with inputs that are constant over it.
    #[inline]
    pub fn begin(&self, dt_s: f64, t_k: &[f64], inputs: [f64; U]) -> RcStep<N, U> {
        let mut step = RcStep {
            dt_s,
            inputs,
            start: [0.0; N],
            force: [0.0; N],
            phi: [0.0; N],
            chi_s: [0.0; N],
        };
        add_product(&self.to_modes, &t_k[..self.nodes], &mut step.start);
        add_product(&self.force, &inputs, &mut step.force);
        for mode in 0..N {
            let (phi, chi) = means(self.lambda[mode] * dt_s);
            (step.phi[mode], step.chi_s[mode]) = (phi, chi * dt_s);
        }
        step
    }

    /// How much the mean of an output rises per unit of an input that acts over the step.
    #[inline]
    pub fn response(&self, step: &RcStep<N, U>, output: usize, input: usize) -> f64 {
        let mut sum = self.of_inputs[input][output];
        for mode in 0..N {
            sum += self.of_modes[mode][output] * step.chi_s[mode] * self.force[input][mode];
        }
        sum
    }

    /// Mean of an output over the step with the inputs so far.
    #[inline]
    pub fn mean(&self, step: &RcStep<N, U>, output: usize) -> f64 {
        let mut sum = 0.0;
        for (of_input, value) in self.of_inputs.iter().zip(&step.inputs) {
            sum += of_input[output] * value;
        }
        for mode in 0..N {
            sum += self.of_modes[mode][output] * step.mean(mode);
        }
        sum
    }

    /// Adds to an input.
    #[inline]
    pub fn add(&self, step: &mut RcStep<N, U>, input: usize, value: f64) {
        step.inputs[input] += value;
        for mode in 0..N {
            step.force[mode] += self.force[input][mode] * value;
        }
    }

    /// Ends the step: the new temperatures, and the means of the outputs.
    #[inline]
    pub fn finish(&self, step: &RcStep<N, U>, t_k: &mut [f64]) -> [f64; Y] {
        let mut change = [0.0; N];
        let mut mean = [0.0; N];
        for mode in 0..N {
            mean[mode] = step.mean(mode);
            change[mode] = step.dt_s * (step.force[mode] - self.lambda[mode] * mean[mode]);
        }
        let mut rise = [0.0; N];
        add_product(&self.from_modes, &change, &mut rise);
        for (t, rise) in t_k.iter_mut().zip(rise).take(self.nodes) {
            *t += rise;
        }
        let mut out = [0.0; Y];
        add_product(&self.of_modes, &mean, &mut out);
        add_product(&self.of_inputs, &step.inputs, &mut out);
        out
    }
}

impl<const N: usize, const U: usize> RcStep<N, U> {
    #[inline]
    fn mean(&self, mode: usize) -> f64 {
        self.phi[mode] * self.start[mode] + self.chi_s[mode] * self.force[mode]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_capacity_relaxes_exponentially() {
        // 1 MJ/K behind 100 W/K: tau = 10 000 s. From 0 towards 10 with 200 W: end value 10 + 2 = 12;
        // after 5000 s 12 (1 - e^-0.5) = 4.7216, mean 12 (1 - (1 - e^-0.5)/0.5) = 2.5567.
        let mut network = RcNetwork::default();
        let node = network.node(1e6);
        network.boundary(node, 0, 100.0);
        network.gain(node, 1, 1.0);
        network.observe(0, node, 1.0);
        network.observe_boundary(1, 0);
        let model = network.model::<2, 2, 2>().unwrap();
        let mut t_k = [0.0];
        let step = model.begin(5000.0, &t_k, [10.0, 200.0]);
        let out = model.finish(&step, &mut t_k);
        assert!(
            (t_k[0] - 4.721_632).abs() < 1e-6 && (out[0] - 2.556_735).abs() < 1e-6,
            "{t_k:?} {out:?}"
        );
        // Heat that came in: 100 (10 - 2.5567) W; with the gain it is what is stored.
        assert!((out[1] - 744.326_5).abs() < 1e-3);
        assert!((t_k[0] * 1e6 - 5000.0 * (out[1] + 200.0)).abs() < 1e-6);
        // A gain that is found later has the same effect; one unit of it raises the mean by `response`.
        let mut again = [0.0];
        let mut step = model.begin(5000.0, &again, [10.0, 0.0]);
        let (before, response) = (model.mean(&step, 0), model.response(&step, 0, 1));
        model.add(&mut step, 1, 200.0);
        assert!((model.mean(&step, 0) - before - 200.0 * response).abs() < 1e-12);
        model.finish(&step, &mut again);
        assert!((again[0] - t_k[0]).abs() < 1e-12);
    }

    #[test]
    fn steps_of_any_length_agree_and_close() {
        // Two capacities behind a surface without one, over six orders of magnitude of time constants.
        let mut network = RcNetwork::default();
        let (fast, surface, slow) = (network.node(10.0), network.node(0.0), network.node(1e7));
        network.link(fast, surface, 50.0);
        network.link(surface, slow, 20.0);
        network.boundary(slow, 0, 5.0);
        network.gain(surface, 1, 1.0);
        network.observe(0, surface, 1.0);
        network.observe_boundary(1, 0);
        let model = network.model::<2, 2, 2>().unwrap();
        let mut ends = Vec::new();
        for (dt_s, steps) in [(0.5, 172_800), (60.0, 1440), (86_400.0, 1)] {
            let mut t_k = [293.15, 293.15];
            let mut heat_j = 0.0;
            let before = model.stored_j(&t_k);
            for _ in 0..steps {
                let step = model.begin(dt_s, &t_k, [273.15, 150.0]);
                heat_j += dt_s * (model.finish(&step, &mut t_k)[1] + 150.0);
            }
            let stored = model.stored_j(&t_k) - before;
            assert!((stored - heat_j).abs() < 1e-9 * 150.0 * 86_400.0, "{dt_s}: {stored} {heat_j}");
            ends.push(t_k);
        }
        for end in &ends {
            assert!(
                (end[0] - ends[0][0]).abs() < 1e-8 && (end[1] - ends[0][1]).abs() < 1e-8,
                "{ends:?}"
            );
        }
    }

    #[test]
    fn what_cannot_be_is_refused() {
        let mut alone = RcNetwork::default();
        alone.node(0.0);
        assert!(alone.model::<2, 1, 1>().is_none());
        let mut many = RcNetwork::default();
        (0..3).for_each(|_| {
            many.node(1.0);
        });
        assert!(many.model::<2, 1, 1>().is_none() && many.model::<3, 1, 1>().is_some());
        for x in [0.0, 1e-9, 0.0199, 0.0201, 1.0, 700.0] {
            let (phi, chi) = means(x);
            let exact = if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x };
            assert!((phi - exact).abs() < 1e-15 && chi > 0.0 && chi <= 0.5, "{x}: {phi} {chi}");
        }
    }
}
