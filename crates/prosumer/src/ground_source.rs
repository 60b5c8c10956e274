//! What a brine heat pump takes its heat from: a given temperature, boreholes or pipes in the ground.
//!
//! **Equation** radial conduction from the wall of the hole or pipe in [`CELLS`] rings of geometric radii,
//! ```text
//! C_i dT_i/dt = G_(i-1) (T_(i-1) - T_i) + G_i (T_(i+1) - T_i),   G = 2 pi lambda L/ln(r_c,i+1/r_c,i)
//! T_brine,in = T_1 - Q (R_1 + R_b/L) + dT/2
//! ```
//! with the heat `Q` taken at the wall, the resistance `R_1` of half the first ring, `R_b` from brine to wall, and brine
//! that is warmed by `dT`. The last ring meets the undisturbed ground: for boreholes at `OUTER_M`; for pipes laid flat, at
//! half their spacing, through the ground above them, `G = lambda L s/depth`.
//!
//! **Assumptions** no flow of ground water, no heat along the hole, no freezing; boreholes do not meet within the time of
//! a run; a field of pipes is a ring per pipe. **Validity** hours to years; an hour after a change the brine in the pipe is
//! in equilibrium. **Numerics** implicit in time, so heat closes to rounding; tridiagonal.
//!
//! **Sources** line source as reference: `carslaw1959`; numbers assumed.

use std::f64::consts::PI;

/// Rings of ground.
pub const CELLS: usize = 14;
/// Radius at which a borehole no longer disturbs the ground, m.
const OUTER_M: f64 = 20.0;

/// A ground source ready to run; its state are the temperatures of its rings, K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroundSource {
    /// Heat capacities of the rings, J/K.
    capacity_j_k: [f64; CELLS],
    /// Conductance from each ring to the next one, the last to the undisturbed ground, W/K.
    conductance_w_k: [f64; CELLS],
    /// From the brine to the middle of the first ring, K/W.
    brine_k_w: f64,
}

/// What surrounds a pipe or hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Conductivity, W/(m K).
    pub conductivity_w_m_k: f64,
    /// Heat capacity, J/(m3 K).
    pub capacity_j_m3_k: f64,
}

impl GroundSource {
    /// Boreholes of a length in all, radius and resistance from brine to wall.
    pub fn boreholes(ground: Ground, length_m: f64, radius_m: f64, resistance_k_m_w: f64) -> Self {
        let mut source = Self::rings(ground, length_m, radius_m, OUTER_M, resistance_k_m_w);
        let ratio = (OUTER_M / radius_m).powf(0.5 / CELLS as f64);
        source.conductance_w_k[CELLS - 1] =
            2.0 * PI * ground.conductivity_w_m_k * length_m / ratio.ln();
        source
    }

    /// Pipes laid flat at a depth, with a distance between them.
    pub fn pipes(
        ground: Ground,
        length_m: f64,
        radius_m: f64,
        resistance_k_m_w: f64,
        (spacing_m, depth_m): (f64, f64),
    ) -> Self {
        let outer_m = 0.5 * spacing_m;
        let mut source = Self::rings(ground, length_m, radius_m, outer_m, resistance_k_m_w);
        source.conductance_w_k[CELLS - 1] =
            ground.conductivity_w_m_k * length_m * spacing_m / depth_m;
        source
    }

    fn rings(
        ground: Ground,
        length_m: f64,
        radius_m: f64,
        outer_m: f64,
        resistance_k_m_w: f64,
    ) -> Self {
        let ratio = (outer_m / radius_m).powf(1.0 / CELLS as f64);
        let between_w_k = 2.0 * PI * ground.conductivity_w_m_k * length_m / ratio.ln();
        let mut capacity_j_k = [0.0; CELLS];
        for (i, capacity) in capacity_j_k.iter_mut().enumerate() {
            let inner_m = radius_m * ratio.powi(i as i32);
            let area_m2 = PI * inner_m * inner_m * (ratio * ratio - 1.0);
            *capacity = ground.capacity_j_m3_k * area_m2 * length_m;
        }
        Self {
            capacity_j_k,
            conductance_w_k: [between_w_k; CELLS],
            brine_k_w: 0.5 / between_w_k + resistance_k_m_w / length_m,
        }
    }

    /// Temperature with which brine arrives while heat is taken, K.
    pub fn brine_k(&self, taken_w: f64, warmed_k: f64, rings_k: &[f64]) -> f64 {
        rings_k[0] - taken_w * self.brine_k_w + 0.5 * warmed_k
    }

    /// Takes heat for a step; returns what came from the undisturbed ground, W.
    pub fn advance(&self, dt_s: f64, taken_w: f64, undisturbed_k: f64, rings_k: &mut [f64]) -> f64 {
        // From the wall outwards: T_i = c_i + f_i T_(i+1).
        let (mut constants, mut factors) = ([0.0; CELLS], [0.0; CELLS]);
        let (mut before_w_k, mut before): (f64, (f64, f64)) = (0.0, (0.0, 0.0));
        for i in 0..CELLS {
            let stored_w_k = self.capacity_j_k[i] / dt_s;
            let out_w_k = self.conductance_w_k[i];
            let mut own_w = stored_w_k * rings_k[i] + before_w_k * before.0;
            if i == 0 {
                own_w -= taken_w;
            }
            let sum_w_k = stored_w_k + before_w_k * (1.0 - before.1) + out_w_k;
            (constants[i], factors[i]) = (own_w / sum_w_k, out_w_k / sum_w_k);
            before_w_k = out_w_k;
            before = (constants[i], factors[i]);
        }
        let mut outer_k = undisturbed_k;
        for i in (0..CELLS).rev() {
            outer_k = constants[i] + factors[i] * outer_k;
            rings_k[i] = outer_k;
        }
        self.conductance_w_k[CELLS - 1] * (undisturbed_k - rings_k[CELLS - 1])
    }

    /// Heat of the rings above a temperature, J.
    pub fn stored_j(&self, above_k: f64, rings_k: &[f64]) -> f64 {
        self.capacity_j_k.iter().zip(rings_k).map(|(c, t_k)| c * (t_k - above_k)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROUND: Ground = Ground { conductivity_w_m_k: 2.0, capacity_j_m3_k: 2.2e6 };

    /// Exponential integral by its series.
    fn e1(x: f64) -> f64 {
        let mut sum = -0.577_215_664_901_532_9 - x.ln();
        let mut term = 1.0;
        for k in 1..40 {
            let k = f64::from(k);
            term *= -x / k;
            sum -= term / k;
        }
        sum
    }

    #[test]
    fn boreholes_follow_the_line_source() {
        // 5 kW of 100 m: 50 W/m; R_b = 0.1 K m/W: 5 K. The wall falls by 50/(4 pi 2) E1(r^2/(4 a t)).
        let source = GroundSource::boreholes(GROUND, 100.0, 0.075, 0.1);
        let diffusivity = 2.0 / 2.2e6;
        let mut rings_k = [283.15; CELLS];
        let (mut t_s, mut came_j) = (0.0, 0.0);
        for (until_d, tolerance) in [(1.0, 0.10), (10.0, 0.05), (100.0, 0.03), (365.0, 0.03)] {
            while t_s < until_d * 86_400.0 - 1.0 {
                came_j += 3600.0 * source.advance(3600.0, 5000.0, 283.15, &mut rings_k);
                t_s += 3600.0;
            }
            let x = 0.075 * 0.075 / (4.0 * diffusivity * t_s);
            let expected_k = 283.15 - 50.0 / (4.0 * PI * 2.0) * e1(x) - 5.0;
            let got_k = source.brine_k(5000.0, 0.0, &rings_k);
            let share = (got_k - expected_k) / (283.15 - expected_k - 5.0);
            assert!(share.abs() < tolerance, "{until_d} d: {got_k} {expected_k}");
        }
        // Heat closes.
        let left_j = source.stored_j(283.15, &rings_k) - came_j + 5000.0 * t_s;
        assert!(left_j.abs() < 1e-9 * 5000.0 * t_s, "{left_j}");
    }

    #[test]
    fn pipes_settle_with_the_ground_above() {
        // 400 m every 0.6 m in 1.5 m: 2 * 400 * 0.6/1.5 = 320 W/K; 4 kW: 12.5 K at the outer ring.
        let source = GroundSource::pipes(GROUND, 400.0, 0.016, 0.05, (0.6, 1.5));
        let mut rings_k = [283.15; CELLS];
        (0..10_000).for_each(|_| {
            source.advance(36_000.0, 4000.0, 283.15, &mut rings_k);
        });
        assert!((283.15 - rings_k[CELLS - 1] - 12.5).abs() < 1e-6, "{rings_k:?}");
        // To the pipe: ln(0.3/0.016)/(2 pi 2 400) less half a ring, and 0.05/400.
        let to_pipe = f64::ln(0.3 / 0.016) / (2.0 * PI * 2.0 * 400.0);
        let half = 0.5 * to_pipe / CELLS as f64;
        let expected = 12.5 + 4000.0 * (to_pipe - half + 0.05 / 400.0);
        let got = 283.15 - source.brine_k(4000.0, 0.0, &rings_k);
        assert!((got - expected).abs() < 1e-6, "{got} {expected}");
    }
}
