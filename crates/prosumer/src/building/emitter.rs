//! What warms or cools a room: a radiator or a floor with the water in it.
//!
//! **Equation** `Q = Q_nom (LMTD/LMTD_nom)^n`: with the conductance `UA = Q/LMTD` of the moment and
//! `nu = UA/(m cp)` the water falls off exponentially along the emitter, which is what the law says. The emitter is
//! five cells in series, each with a fifth of capacity and conductance:
//! ```text
//! c dT_i/dt = m cp (T_i-1 - T_i) - q_i,   q_i = g (w T_i-1 + (1 - w) T_i - T_room)
//! w = 1/nu_i - 1/(e^nu_i - 1),   nu_i = g/(m cp)
//! ```
//! With this weight a cell at rest passes on `e^-nu_i` of the excess, so that the return temperature at rest is that
//! of the law at every flow; without flow w is 0 and the cells cool by themselves. Colder than the room the
//! conductance is a coefficient times an area, or that of the same law.
//!
//! **Assumptions** water and metal (or screed) of a cell have one temperature; the heat goes to the air and by
//! radiation to the surfaces. **Validity** the law of a radiator holds from about a tenth of its nominal excess;
//! below [`LEAST_EXCESS_K`] it is linear. **Numerics** over a step the inflow of each cell is its mean: exact
//! for the first cell, of first order for the others, stable without a limit; the heat is exact. The conductance
//! follows from the excess of the step before and is corrected within the step.
//! **Sources** `en442`; nominal points of the houses `prohmo`.

use super::rc::means;

/// Cells of an emitter.
pub const CELLS: usize = 5;
/// Below this mean excess the emission is linear, K.
pub const LEAST_EXCESS_K: f64 = 0.5;
/// The conductance is found again until it changes less than this ...
const SETTLED: f64 = 0.01;
/// ... but not more often than this; what is left is corrected in the next step.
const ROUNDS: usize = 3;

/// The law of an emitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Emitter {
    /// Heat at the nominal point, W.
    pub nominal_w: f64,
    /// Logarithmic mean excess over the room at the nominal point, K.
    pub nominal_excess_k: f64,
    /// Exponent.
    pub exponent: f64,
    /// Heat capacity of emitter and water, J/K.
    pub capacity_j_k: f64,
    /// Conductance while it is colder than the room, W/K; `None`: as of its law.
    pub cooling_w_k: Option<f64>,
}

/// Water that passes the emitter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stream {
    /// Flow times heat capacity, W/K.
    pub capacity_w_k: f64,
    /// Temperature at the inlet, K.
    pub t_in_k: f64,
}

/// A quantity over the temperature of the room: `at_zero + per_k T_room`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OfRoom {
    /// Value at a room temperature of 0 K.
    pub at_zero: f64,
    /// Its change per kelvin.
    pub per_k: f64,
}

impl OfRoom {
    /// The value at a temperature of the room, K.
    #[inline]
    pub fn at(self, t_room_k: f64) -> f64 {
        self.at_zero + self.per_k * t_room_k
    }
}

/// Means of a step over the temperature of the room.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Passage {
    /// Heat to the room, W.
    pub emitted_w: OfRoom,
    /// Temperature at which the water leaves, K.
    pub outlet_k: OfRoom,
    /// How much the outlet follows the inlet: 0 to 1.
    pub of_inlet: f64,
    cells_k: [OfRoom; CELLS],
    cells_w: [OfRoom; CELLS],
    capacity_w_k: f64,
}

/// Logarithmic mean of two differences of one sign, K; 0 where they have different ones.
pub fn logarithmic_mean_k(a_k: f64, b_k: f64) -> f64 {
    if a_k * b_k <= 0.0 {
        0.0
    } else if (a_k - b_k).abs() < 1e-6 * a_k.abs() {
        0.5 * (a_k + b_k)
    } else {
        (a_k - b_k) / (a_k / b_k).ln()
    }
}

impl Emitter {
    /// Heat per kelvin of a mean excess over the room, W/K.
    pub fn conductance_w_k(&self, excess_k: f64) -> f64 {
        if let (Some(cooling_w_k), true) = (self.cooling_w_k, excess_k < 0.0) {
            return cooling_w_k;
        }
        let share = excess_k.abs().max(LEAST_EXCESS_K) / self.nominal_excess_k;
        self.nominal_w / self.nominal_excess_k * share.powf(self.exponent - 1.0)
    }

    /// The passage of water during a step with a given conductance.
    pub fn passage(
        &self,
        dt_s: f64,
        conductance_w_k: f64,
        stream: Stream,
        cells_k: &[f64],
    ) -> Passage {
        let k = stream.capacity_w_k;
        let g = conductance_w_k / CELLS as f64;
        // Share of the inflow in what a cell emits by; k - g w.
        let (w, passed) = weight(g, k);
        let total = k + g * (1.0 - w);
        let (phi, _) = means(total * dt_s * CELLS as f64 / self.capacity_j_k);
        let (of_inflow, of_room) = ((1.0 - phi) * passed / total, (1.0 - phi) * g / total);
        let mut passage = Passage { of_inlet: 1.0, capacity_w_k: k, ..Passage::default() };
        let mut inflow = OfRoom { at_zero: stream.t_in_k, per_k: 0.0 };
        for (i, start_k) in cells_k.iter().enumerate().take(CELLS) {
            let mean = OfRoom {
                at_zero: of_inflow * inflow.at_zero + phi * start_k,
                per_k: of_inflow * inflow.per_k + of_room,
            };
            let emitted = OfRoom {
                at_zero: g * (w * inflow.at_zero + (1.0 - w) * mean.at_zero),
                per_k: g * (w * inflow.per_k + (1.0 - w) * mean.per_k - 1.0),
            };
            passage.emitted_w.at_zero += emitted.at_zero;
            passage.emitted_w.per_k += emitted.per_k;
            passage.cells_w[i] = emitted;
            passage.cells_k[i] = mean;
            passage.of_inlet *= of_inflow;
            inflow = mean;
        }
        passage.outlet_k = inflow;
        passage
    }

    /// The passage with the conductance that goes with its own excess; `room_k` gives the temperature of the room
    /// for a passage. The conductance becomes the one that the next step begins with.
    pub fn settled_passage(
        &self,
        dt_s: f64,
        conductance_w_k: &mut f64,
        stream: Stream,
        cells_k: &[f64],
        room_k: impl Fn(&Passage) -> f64,
    ) -> (Passage, f64) {
        let mut round = 1;
        loop {
            let passage = self.passage(dt_s, *conductance_w_k, stream, cells_k);
            let t_room_k = room_k(&passage);
            let excess_k = passage.emitted_w.at(t_room_k) / *conductance_w_k;
            let found = self.conductance_w_k(excess_k);
            let settled = (found - *conductance_w_k).abs() <= SETTLED * found;
            *conductance_w_k = found;
            if settled || round == ROUNDS {
                return (passage, t_room_k);
            }
            round += 1;
        }
    }

    /// Advances the cells with the heat the water gave off, W; what it gave more than the passage says goes
    /// to all cells alike.
    pub fn advance(
        &self,
        dt_s: f64,
        passage: &Passage,
        t_room_k: f64,
        stream: Stream,
        water_w: f64,
        cells_k: &mut [f64],
    ) {
        let k = passage.capacity_w_k;
        let more_w = water_w - k * (stream.t_in_k - passage.outlet_k.at(t_room_k));
        let rise_k_w = dt_s * CELLS as f64 / self.capacity_j_k;
        let mut inflow_k = stream.t_in_k;
        for (i, cell_k) in cells_k.iter_mut().enumerate().take(CELLS) {
            let mean_k = passage.cells_k[i].at(t_room_k);
            let heat_w = k * (inflow_k - mean_k) - passage.cells_w[i].at(t_room_k);
            *cell_k += rise_k_w * (heat_w + more_w / CELLS as f64);
            inflow_k = mean_k;
        }
    }

    /// Heat above 0 degC, J.
    pub fn stored_j(&self, cells_k: &[f64]) -> f64 {
        let zero_k = anergy_core::medium::ZERO_CELSIUS_K;
        self.capacity_j_k / CELLS as f64 * cells_k.iter().map(|t_k| t_k - zero_k).sum::<f64>()
    }
}

/// Weight of the inflow in what a cell emits by, and `k - g w`: what of its flow passes on.
fn weight(g: f64, k: f64) -> (f64, f64) {
    // Where a cell passes less than e^-30 the weight is that of its own temperature.
    if k <= g / 30.0 {
        return if k > 0.0 { (k / g, 0.0) } else { (0.0, 0.0) };
    }
    let nu = g / k;
    if nu < 1e-4 {
        // 1/nu - 1/(e^nu - 1) = 1/2 - nu/12 + nu^3/720
        let w = 0.5 - nu / 12.0;
        return (w, k - g * w);
    }
    let passed = k * nu / nu.exp_m1();
    ((k - passed) / g, passed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn radiator() -> Emitter {
        Emitter {
            nominal_w: 6600.0,
            nominal_excess_k: logarithmic_mean_k(39.0, 24.0),
            exponent: 1.3,
            capacity_j_k: 60.0 * 6600.0,
            cooling_w_k: None,
        }
    }

    /// Runs to rest in a room that is held, with water of a flow; outlet in K, heat in W.
    fn at_rest(emitter: &Emitter, stream: Stream, t_room_k: f64, dt_s: f64) -> (f64, f64) {
        let mut cells = [t_room_k; CELLS];
        let mut conductance = emitter.conductance_w_k(0.0);
        let mut last = (0.0, 0.0);
        for _ in 0..(400_000.0 / dt_s) as usize {
            let (passage, _) =
                emitter.settled_passage(dt_s, &mut conductance, stream, &cells, |_| t_room_k);
            let outlet_k = passage.outlet_k.at(t_room_k);
            let water_w = stream.capacity_w_k * (stream.t_in_k - outlet_k);
            emitter.advance(dt_s, &passage, t_room_k, stream, water_w, &mut cells);
            last = (outlet_k, passage.emitted_w.at(t_room_k));
        }
        last
    }

    #[test]
    fn nominal_points() {
        // Radiator 60/45/21: 6600/15 = 440 W/K; LMTD (39 - 24)/ln(39/24) = 30.8955 K.
        let radiator = radiator();
        assert!((radiator.nominal_excess_k - 30.8955).abs() < 1e-4);
        for dt_s in [10.0, 300.0, 3600.0] {
            let stream = Stream { capacity_w_k: 440.0, t_in_k: 333.15 };
            let (outlet_k, q_w) = at_rest(&radiator, stream, 294.15, dt_s);
            assert!(
                (outlet_k - 318.15).abs() < 1e-6 && (q_w - 6600.0).abs() < 1e-4,
                "{outlet_k} {q_w}"
            );
        }
        // Floor 40/30/21 of 15 W/m2 and 300 m2: 450 W/K; LMTD (19 - 9)/ln(19/9) = 13.3833 K.
        let floor = Emitter {
            nominal_w: 4500.0,
            nominal_excess_k: logarithmic_mean_k(19.0, 9.0),
            exponent: 1.1,
            capacity_j_k: 40e3 * 300.0,
            cooling_w_k: Some(5.5 * 300.0),
        };
        let stream = Stream { capacity_w_k: 450.0, t_in_k: 313.15 };
        let (outlet_k, q_w) = at_rest(&floor, stream, 294.15, 300.0);
        assert!(
            (outlet_k - 303.15).abs() < 1e-6 && (q_w - 4500.0).abs() < 1e-4,
            "{outlet_k} {q_w}"
        );
        // Cooling 15 to 20 degC in a room of 23 degC: LMTD (8 - 3)/ln(8/3) = 5.0977 K, times 5.5 W/(m2 K) and
        // 300 m2 = 8411.3 W, with 8411.3/5 = 1682.2 W/K.
        let stream = Stream { capacity_w_k: 1682.252, t_in_k: 288.15 };
        let (outlet_k, q_w) = at_rest(&floor, stream, 296.15, 300.0);
        assert!(
            (outlet_k - 293.15).abs() < 1e-4 && (q_w + 8411.26).abs() < 0.1,
            "{outlet_k} {q_w}"
        );
    }

    #[test]
    fn part_load_is_the_law() {
        // A fifth of the flow: the outlet that solves Q = Q_nom (LMTD/LMTD_nom)^1.3 = m cp (39 - x), by bisection.
        let radiator = radiator();
        for share in [0.2, 0.02, 3.0] {
            let k = 440.0 * share;
            let (mut low, mut high) = (1e-12, 39.0);
            for _ in 0..200 {
                let x: f64 = 0.5 * (low + high);
                let excess = logarithmic_mean_k(39.0, x);
                let q = 6600.0 * (excess / radiator.nominal_excess_k).powf(1.3);
                if q > k * (39.0 - x) { high = x } else { low = x }
            }
            let stream = Stream { capacity_w_k: k, t_in_k: 333.15 };
            let (outlet_k, q_w) = at_rest(&radiator, stream, 294.15, 60.0);
            assert!((outlet_k - 294.15 - low).abs() < 1e-6, "{share}: {outlet_k} {low}");
            assert!((q_w - k * (39.0 - low)).abs() < 1e-4);
        }
    }

    #[test]
    fn without_flow_it_cools_and_keeps_its_heat() {
        // Linear law, all cells 40 K above the room: e^(-t UA/C); C/UA = 396e3/213.62 = 1853.8 s.
        let emitter = Emitter { exponent: 1.0, ..radiator() };
        let mut cells = [334.15; CELLS];
        let mut conductance = emitter.conductance_w_k(1.0);
        let none = Stream { capacity_w_k: 0.0, t_in_k: 1.0 };
        let before = emitter.stored_j(&cells);
        let mut emitted_j = 0.0;
        for dt_s in [1853.8 / 2.0, 1853.8 / 4.0, 1853.8 / 4.0] {
            let (passage, _) =
                emitter.settled_passage(dt_s, &mut conductance, none, &cells, |_| 294.15);
            emitter.advance(dt_s, &passage, 294.15, none, 0.0, &mut cells);
            emitted_j += dt_s * passage.emitted_w.at(294.15);
        }
        assert!((cells[0] - 294.15 - 40.0 * (-1.0_f64).exp()).abs() < 1e-3, "{cells:?}");
        assert!((before - emitter.stored_j(&cells) - emitted_j).abs() < 1e-6 * emitted_j);
        // Radiator from the same: never below the room, whatever the step.
        let emitter = radiator();
        let mut conductance = emitter.conductance_w_k(0.0);
        let mut cells = [334.15; CELLS];
        let (passage, _) = emitter.settled_passage(1e6, &mut conductance, none, &cells, |_| 294.15);
        emitter.advance(1e6, &passage, 294.15, none, 0.0, &mut cells);
        assert!(cells.iter().all(|t| (t - 294.15).abs() < 0.1), "{cells:?}");
    }

    #[test]
    fn the_outlet_is_linear_in_the_inlet_between_0_and_1() {
        let emitter = radiator();
        let cells = [310.0, 305.0, 300.0, 298.0, 296.0];
        for k in [0.0, 1e-9, 1e-3, 1.0, 440.0, 1e7] {
            for dt_s in [1e-3, 1.0, 60.0, 3600.0, 1e7] {
                let outlet = |t_in_k| {
                    let stream = Stream { capacity_w_k: k, t_in_k };
                    let passage = emitter.passage(dt_s, 200.0, stream, &cells);
                    (passage.outlet_k.at(294.15), passage.of_inlet)
                };
                let ((cold, of_inlet), (warm, _)) = (outlet(300.0), outlet(340.0));
                assert!((0.0..=1.0).contains(&of_inlet), "{k} {dt_s}: {of_inlet}");
                assert!((warm - cold - 40.0 * of_inlet).abs() < 1e-9, "{k} {dt_s}");
                assert!(cold > 294.0 && warm < 340.1, "{k} {dt_s}: {cold} {warm}");
            }
        }
    }
}
