//! Layers of equal height, counted from the bottom, and cells of water stacked in the tank.
//!
//! **Equation** layer of a height `floor(h/H n) + 1`, at most n; cross-section `A_c = V/H`, diameter of the
//! cylinder `sqrt(4 A_c/pi)`, envelope of a layer `pi D H/n`, with `A_c` more at the bottom and at the top.
//! **Assumptions** an upright cylinder. **Numerics** cells are the layers themselves, or parcels of any mass;
//! what is given per layer is spread over parcels by overlap, evenly within a layer.

use std::f64::consts::PI;

/// Most layers of a storage.
pub const MAX_LAYERS: usize = 200;

/// The tank cut into layers.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layers {
    pub(super) count: usize,
    pub(super) height_m: f64,
    pub(super) volume_m3: f64,
    pub(super) density_kg_m3: f64,
    pub(super) heat_capacity_j_kg_k: f64,
}

/// Side and cross-section of an upright cylinder, m2.
pub(super) fn side_and_section_m2(volume_m3: f64, height_m: f64) -> (f64, f64) {
    let section = volume_m3 / height_m;
    (PI * (4.0 * section / PI).sqrt() * height_m, section)
}

impl Layers {
    /// Mass of the water of a layer, kg.
    pub(super) fn layer_kg(&self) -> f64 {
        self.mass_kg() / self.count as f64
    }

    pub(super) fn mass_kg(&self) -> f64 {
        self.volume_m3 * self.density_kg_m3
    }

    pub(super) fn cross_section_m2(&self) -> f64 {
        self.volume_m3 / self.height_m
    }

    /// The layer of a height, counted from 0.
    pub(super) fn at_height(&self, height_m: f64) -> usize {
        let share = height_m / self.height_m * self.count as f64;
        (share.max(0.0) as usize).min(self.count - 1)
    }

    /// Envelope of each layer, m2.
    pub(super) fn envelope_m2(&self) -> Vec<f64> {
        let (side, section) = side_and_section_m2(self.volume_m3, self.height_m);
        let mut areas = vec![side / self.count as f64; self.count];
        areas[0] += section;
        areas[self.count - 1] += section;
        areas
    }

    /// The share of a stretch of the height that lies in each layer.
    pub(super) fn shares_of_stretch(&self, bottom_m: f64, top_m: f64) -> Vec<f64> {
        let layer_m = self.height_m / self.count as f64;
        let inside = |layer: usize| {
            let (low, high) = (layer as f64 * layer_m, (layer + 1) as f64 * layer_m);
            (high.min(top_m) - low.max(bottom_m)).max(0.0)
        };
        let lengths: Vec<f64> = (0..self.count).map(inside).collect();
        let whole: f64 = lengths.iter().sum();
        lengths.iter().map(|length| length / whole).collect()
    }

    /// Share of the layers in water that is drawn from a port: triangle of weights that falls to zero at
    /// `depth_m` above and below.
    pub(super) fn drawn_from(&self, port_m: f64, depth_m: f64) -> Vec<f64> {
        let mut weights = vec![0.0; self.count];
        if depth_m <= 0.0 {
            weights[self.at_height(port_m)] = 1.0;
            return weights;
        }
        // The integral of the triangle of height 1 from its middle to a distance.
        let integral = |z_m: f64| {
            let x = ((z_m - port_m) / depth_m).clamp(-1.0, 1.0);
            x - x * x.abs() / 2.0
        };
        let layer_m = self.height_m / self.count as f64;
        for (layer, weight) in weights.iter_mut().enumerate() {
            *weight = integral((layer + 1) as f64 * layer_m) - integral(layer as f64 * layer_m);
        }
        let whole: f64 = weights.iter().sum();
        weights.iter_mut().for_each(|weight| *weight /= whole);
        weights
    }

    /// Temperatures of the layers from those of equal stretches (sensors), from bottom to top, by overlap:
    /// `T_l = sum_i T_i overlap(l, i) n`.
    pub(super) fn of_sensors(&self, sensors_k: &[f64]) -> Vec<f64> {
        let (n, sensors) = (self.count as f64, sensors_k.len() as f64);
        let layer = |l: usize| {
            let overlap = |i: usize| {
                let high = ((l + 1) as f64 / n).min((i + 1) as f64 / sensors);
                (high - (l as f64 / n).max(i as f64 / sensors)).max(0.0)
            };
            sensors_k.iter().enumerate().map(|(i, t_k)| t_k * overlap(i) * n).sum()
        };
        (0..self.count).map(layer).collect()
    }
}

/// Cells of water stacked from the bottom, on the stack while a step is computed.
#[derive(Debug, Clone)]
pub(super) struct Cells<const N: usize> {
    pub(super) count: usize,
    pub(super) mass_kg: [f64; N],
    pub(super) t_k: [f64; N],
}

impl<const N: usize> Cells<N> {
    pub(super) fn empty() -> Self {
        Self { count: 0, mass_kg: [0.0; N], t_k: [0.0; N] }
    }

    pub(super) fn push(&mut self, mass_kg: f64, t_k: f64) {
        self.mass_kg[self.count] = mass_kg;
        self.t_k[self.count] = t_k;
        self.count += 1;
    }

    /// The temperatures, from bottom to top.
    pub(super) fn temperatures(&self) -> &[f64] {
        &self.t_k[..self.count]
    }

    /// Lowest and highest temperature, K.
    pub(super) fn range_k(&self) -> (f64, f64) {
        let widened = |(low, high): (f64, f64), t: &f64| (low.min(*t), high.max(*t));
        self.temperatures().iter().fold((f64::INFINITY, f64::NEG_INFINITY), widened)
    }

    /// Sum of `m T`, kg K.
    #[cfg(test)]
    pub(super) fn content_kg_k(&self) -> f64 {
        (0..self.count).map(|i| self.mass_kg[i] * self.t_k[i]).sum()
    }

    /// Spreads what each layer has over the cells, by overlap.
    pub(super) fn spread(&self, per_layer: &[f64], layer_kg: f64, onto: &mut [f64; N]) {
        self.overlaps(layer_kg, per_layer.len(), |cell, layer, share, first| {
            let part = per_layer[layer] * share;
            onto[cell] = if first { part } else { onto[cell] + part };
        });
    }

    /// The cell that contains a height given as mass below it.
    pub(super) fn at_mass(&self, below_kg: f64) -> usize {
        let mut top_kg = 0.0;
        for cell in 0..self.count {
            top_kg += self.mass_kg[cell];
            if below_kg < top_kg {
                return cell;
            }
        }
        self.count - 1
    }

    /// Mean temperatures of layers.
    pub(super) fn layer_means_k(&self, layer_kg: f64, means_k: &mut [f64]) {
        means_k.fill(0.0);
        let layers = means_k.len();
        self.overlaps(layer_kg, layers, |cell, layer, share, _| {
            means_k[layer] += self.t_k[cell] * share;
        });
    }

    /// All overlaps of cells and layers: cell, layer, share of the layer, whether it is the cell's first.
    fn overlaps(
        &self,
        layer_kg: f64,
        layers: usize,
        mut visit: impl FnMut(usize, usize, f64, bool),
    ) {
        let (mut layer, mut left) = (0, 1.0);
        for cell in 0..self.count {
            // The last cell reaches to the top, whatever rounding makes of its mass.
            let last = cell + 1 == self.count;
            let mut rest = if last { f64::INFINITY } else { self.mass_kg[cell] / layer_kg };
            let mut first = true;
            while rest > left && layer + 1 < layers {
                visit(cell, layer, left, first);
                rest -= left;
                (layer, left, first) = (layer + 1, 1.0, false);
            }
            let share = rest.min(left);
            visit(cell, layer, share, first);
            left -= share;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(count: usize) -> Layers {
        Layers {
            count,
            height_m: 1.755,
            volume_m3: 0.785,
            density_kg_m3: 1000.0,
            heat_capacity_j_kg_k: 4180.0,
        }
    }

    #[test]
    fn layer_of_a_height() {
        // floor(1.6/1.755 * 10) + 1 = floor(9.117) + 1 = 10; floor(0.26/1.755 * 10) + 1 = 2.
        assert_eq!((layers(10).at_height(1.6), layers(10).at_height(0.26)), (9, 1));
        assert_eq!((layers(10).at_height(0.0), layers(10).at_height(1.755)), (0, 9));
        assert_eq!(layers(1).at_height(1.6), 0);
    }

    #[test]
    fn envelope_of_a_cylinder() {
        // D = sqrt(4 * 0.785/1.755/pi) = 0.75467 m; pi D H + 2 A = 4.16088 + 2 * 0.44729 = 5.0555 m2.
        for count in [1, 10, 77] {
            let area: f64 = layers(count).envelope_m2().iter().sum();
            assert!((area - 5.0555).abs() < 1e-3, "{area}");
        }
    }

    #[test]
    fn drawing_from_around_a_port() {
        // 10 layers of 0.1755 m, port at 0.26 m, depth 0.1 m: the triangle from 0.16 to 0.36 m has the area
        // 0.1 m2; below 0.1755 m lies (0.0155)^2/(2*0.1) = 0.00120, above 0.351 m (0.009)^2/0.2 = 0.00041.
        let weights = layers(10).drawn_from(0.26, 0.1);
        assert!((weights[0] - 0.012_01).abs() < 1e-5, "{weights:?}");
        assert!((weights[2] - 0.004_05).abs() < 1e-5, "{weights:?}");
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        // Cut off by the bottom: all of it still comes from somewhere.
        let weights = layers(100).drawn_from(0.02, 0.3);
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert_eq!(layers(10).drawn_from(0.26, 0.0)[1], 1.0);
    }

    #[test]
    fn sensors_by_overlap() {
        // Four sensors on ten layers: layer 3 (0.2..0.3) is half of sensor 1 and half of sensor 2.
        let t = layers(10).of_sensors(&[10.0, 20.0, 30.0, 40.0]);
        assert!((t[0] - 10.0).abs() < 1e-12 && (t[2] - 15.0).abs() < 1e-12, "{t:?}");
        assert!((t.iter().sum::<f64>() / 10.0 - 25.0).abs() < 1e-12);
        // The shares of a layer sum to 1 whatever the numbers.
        for count in [1, 3, 7, 100, 200] {
            for sensors in [1, 2, 10, 13] {
                let t = layers(count).of_sensors(&vec![1.0; sensors]);
                assert!(t.iter().all(|t| (t - 1.0).abs() < 1e-12), "{count} {sensors}: {t:?}");
            }
        }
    }

    #[test]
    fn cells_and_layers_overlap() {
        let mut cells = Cells::<8>::empty();
        for (mass_kg, t_k) in [(1.5, 10.0), (0.5, 20.0), (0.25, 30.0), (0.75, 40.0)] {
            cells.push(mass_kg, t_k);
        }
        let mut means = [0.0; 3];
        cells.layer_means_k(1.0, &mut means);
        // Layer 2: half at 10, half at 20; layer 3: a quarter at 30.
        assert_eq!(means, [10.0, 15.0, 37.5]);
        let mut onto = [9.0; 8];
        cells.spread(&[1.0, 2.0, 4.0], 1.0, &mut onto);
        assert_eq!(onto[..4], [2.0, 1.0, 1.0, 3.0]);
        assert_eq!((cells.at_mass(1.49), cells.at_mass(2.1), cells.at_mass(9.0)), (0, 2, 3));
    }

    #[test]
    fn a_stretch_belongs_to_the_layers_it_touches() {
        // 0.3 to 0.9 m of 1.755 m in 10 layers (0.1755 m): layers 2 (0.051), 3, 4, 5 (0.1755), 6 (0.0225).
        let shares = layers(10).shares_of_stretch(0.3, 0.9);
        assert_eq!((shares[0], shares[6]), (0.0, 0.0));
        assert!(
            (shares[1] - 0.051 / 0.6).abs() < 1e-12 && (shares[5] - 0.0225 / 0.6).abs() < 1e-12
        );
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}
