//! Soil around a pipe that stores heat: rings between its jacket and the undisturbed ground.
//!
//! **Equation** n rings between the jacket (r_0 = D/2) and [`RADIUS_M`] (the depth of the axis, if that is
//! less), their radii a geometric series; each has its heat capacity at the middle of its resistance:
//! ```text
//! C_k = rho c pi (r_k^2 - r_(k-1)^2),   R_k = ln(r_k/r_(k-1))/(2 pi lambda)
//! C_k dT_k/dt = q_(k-1,k) - q_(k,k+1),  q_(k,k+1) = (T_k - T_(k+1))/((R_k + R_(k+1))/2)
//! ```
//! The water loses `q_(0,1) = (T - T_1)/(R_pipe + R_1/2)`; beyond the last ring `R_n/2` and the rest of the
//! resistance of the soil lead to the undisturbed ground, so that the steady loss is that without rings.
//!
//! **Assumptions** the soil is warmed alike along the pipe; no heat flows along it; the soil beyond the
//! rings stores nothing. **Validity** days to weeks: beyond, the ground farther away than 0.5 m
//! takes part. Three rings take up within 2 % of the heat of 200 rings over one day to ten.
//!
//! **Numerics** in a step the water sees the ring as it was, the rings follow with what the water lost by
//! one implicit Euler step: the heat of soil, water and ground closes to rounding. Steps end after half the
//! time constant of the innermost ring at the latest. **Sources** specification 9.8.

use crate::buried_pipe::layer_k_m_w;
use crate::ground::Ground;
use crate::state::NetworkState;
use anergy_core::ids::EdgeId;

/// Radius around the axis within which soil stores heat, m.
pub const RADIUS_M: f64 = 0.5;
/// The most rings of a pipe.
pub const MOST_RINGS: usize = 5;

/// The rings around one pipe, of its whole length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SoilRings {
    /// The pipe.
    pub edge: EdgeId,
    /// Place of the innermost ring in the state.
    first: usize,
    rings: usize,
    /// Heat capacity of each ring, J/K.
    capacity_j_k: [f64; MOST_RINGS],
    /// From each ring outwards to the next one, or to the ground, W/K.
    outwards_w_k: [f64; MOST_RINGS],
    /// From the water to the innermost ring, W/K.
    inwards_w_k: f64,
}

/// Where a pipe with rings lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingsAround {
    /// Length of the pipe, m.
    pub length_m: f64,
    /// Outer diameter of its jacket, m.
    pub jacket_diameter_m: f64,
    /// Depth of its axis, m.
    pub depth_m: f64,
    /// From the water to the jacket, K m/W.
    pub inside_k_m_w: f64,
    /// From the jacket to the undisturbed ground, K m/W.
    pub outside_k_m_w: f64,
}

impl SoilRings {
    /// `rings` rings (1 to [`MOST_RINGS`]) around a pipe; `first` is their place in the state.
    pub fn new(
        edge: EdgeId,
        first: usize,
        rings: usize,
        around: &RingsAround,
        ground: &Ground,
    ) -> Self {
        let rings = rings.clamp(1, MOST_RINGS);
        let inner_m = 0.5 * around.jacket_diameter_m;
        let outer_m = RADIUS_M.min(around.depth_m);
        let ratio = (outer_m / inner_m).powf(1.0 / rings as f64);
        let conductivity = ground.soil.conductivity_w_m_k;
        // All rings have the same resistance.
        let ring_k_m_w = layer_k_m_w(1.0, ratio, conductivity);
        let beyond_k_m_w = around.outside_k_m_w - rings as f64 * ring_k_m_w;
        let mut capacity_j_k = [0.0; MOST_RINGS];
        let mut outwards_w_k = [0.0; MOST_RINGS];
        let mut radius_m = inner_m;
        for k in 0..rings {
            let next_m = radius_m * ratio;
            let area_m2 = std::f64::consts::PI * (next_m * next_m - radius_m * radius_m);
            capacity_j_k[k] = ground.capacity_j_m3_k() * area_m2 * around.length_m;
            let next_k_m_w =
                if k + 1 < rings { ring_k_m_w } else { 0.5 * ring_k_m_w + beyond_k_m_w };
            outwards_w_k[k] = around.length_m / next_k_m_w;
            radius_m = next_m;
        }
        let inwards_w_k = around.length_m / (around.inside_k_m_w + 0.5 * ring_k_m_w);
        Self { edge, first, rings, capacity_j_k, outwards_w_k, inwards_w_k }
    }

    /// One node of a heat capacity per length; `between_k_m_w` are the thermal resistances from the water to it, and from it to the ground.
    pub fn node(
        edge: EdgeId,
        first: usize,
        length_m: f64,
        capacity_j_m_k: f64,
        [inside_k_m_w, outside_k_m_w]: [f64; 2],
    ) -> Self {
        let (mut capacity_j_k, mut outwards_w_k) = ([0.0; MOST_RINGS], [0.0; MOST_RINGS]);
        capacity_j_k[0] = capacity_j_m_k * length_m;
        outwards_w_k[0] = length_m / outside_k_m_w;
        let inwards_w_k = length_m / inside_k_m_w;
        Self { edge, first, rings: 1, capacity_j_k, outwards_w_k, inwards_w_k }
    }

    /// Number of rings.
    pub fn count(&self) -> usize {
        self.rings
    }

    /// Thermal resistance from the water to the innermost ring for a pipe of a length, K m/W.
    pub fn inwards_k_m_w(&self, length_m: f64) -> f64 {
        length_m / self.inwards_w_k
    }

    /// The longest step, s: half the time constant of the innermost ring.
    pub fn longest_step_s(&self) -> f64 {
        0.5 * self.capacity_j_k[0] / (self.inwards_w_k + self.outwards_w_k[0])
    }

    /// Advances the rings (`t_k`, innermost first) by `dt_s` with the heat that the pipe loses; returns the
    /// heat that reaches the ground of `ground_k`, W (mean of the step).
    pub fn advance(&self, t_k: &mut [f64], lost_w: f64, ground_k: f64, dt_s: f64) -> f64 {
        // (C/dt + G_in + G_out) T_k - G_in T_(k-1) - G_out T_(k+1) = C/dt T_k,old: elimination from the inside,
        // then from the outside back.
        let n = self.rings;
        let (mut diagonal, mut right) = ([0.0; MOST_RINGS], [0.0; MOST_RINGS]);
        for k in 0..n {
            let storage = self.capacity_j_k[k] / dt_s;
            diagonal[k] = storage + self.outwards_w_k[k];
            right[k] = storage * t_k[k] + if k == 0 { lost_w } else { 0.0 };
            if k > 0 {
                let inner = self.outwards_w_k[k - 1];
                diagonal[k] += inner - inner * inner / diagonal[k - 1];
                right[k] += inner * right[k - 1] / diagonal[k - 1];
            }
        }
        let mut outer_k = ground_k;
        for k in (0..n).rev() {
            t_k[k] = (right[k] + self.outwards_w_k[k] * outer_k) / diagonal[k];
            outer_k = t_k[k];
        }
        self.outwards_w_k[n - 1] * (t_k[n - 1] - ground_k)
    }

    /// Approaches the steady rings for the heat that the pipe loses at the present innermost ring: exact for
    /// water of one temperature.
    fn settle(&self, t_k: &mut [f64], lost_w: f64, ground_k: f64) {
        let beyond: f64 = self.outwards_w_k[..self.rings].iter().map(|g| 1.0 / g).sum();
        let inwards = 1.0 / self.inwards_w_k;
        let share = inwards / (inwards + beyond);
        let above_k = t_k[0] - ground_k;
        let settled_k =
            if lost_w == 0.0 { 0.0 } else { above_k + share * (lost_w * beyond - above_k) };
        let mut left = beyond;
        for (t_k, outwards_w_k) in t_k.iter_mut().zip(&self.outwards_w_k) {
            *t_k = ground_k + settled_k * left / beyond;
            left -= 1.0 / outwards_w_k;
        }
    }
}

/// The soil of a network during a run.
impl NetworkState {
    /// Each pipe with rings sees its innermost one; what is given around it is the ground beyond.
    pub fn see_soil(&mut self, soil: &[SoilRings]) {
        for (i, rings) in soil.iter().enumerate() {
            self.soil_ground_k[i] = self.surroundings_k[rings.edge.index()];
            self.surroundings_k[rings.edge.index()] = self.soil_k[rings.first];
        }
    }

    /// All rings as warm as the ground beyond.
    pub fn rest_soil(&mut self, soil: &[SoilRings]) {
        for (i, rings) in soil.iter().enumerate() {
            self.soil_k[rings.first..rings.first + rings.rings].fill(self.soil_ground_k[i]);
            self.surroundings_k[rings.edge.index()] = self.soil_ground_k[i];
        }
    }

    /// The rings take what their pipes have lost in a step.
    pub fn advance_soil(&mut self, soil: &[SoilRings], dt_s: f64) {
        for (i, rings) in soil.iter().enumerate() {
            let t_k = &mut self.soil_k[rings.first..rings.first + rings.rings];
            let lost_w = self.q_loss_w[rings.edge.index()];
            self.q_ground_w[i] = rings.advance(t_k, lost_w, self.soil_ground_k[i], dt_s);
        }
    }

    /// The rings approach the steady state of what their pipes lose.
    pub fn settle_soil(&mut self, soil: &[SoilRings]) {
        for (i, rings) in soil.iter().enumerate() {
            let t_k = &mut self.soil_k[rings.first..rings.first + rings.rings];
            let lost_w = self.q_loss_w[rings.edge.index()];
            rings.settle(t_k, lost_w, self.soil_ground_k[i]);
            self.q_ground_w[i] = lost_w;
        }
    }

    /// Temperature of the innermost ring of a pipe, K.
    pub fn ring_k(&self, rings: &SoilRings) -> f64 {
        self.soil_k[rings.first]
    }

    /// Heat stored in all rings above 0 degC, J.
    pub fn soil_stored_j(&self, soil: &[SoilRings]) -> f64 {
        let of = |rings: &SoilRings| -> f64 {
            let t_k = &self.soil_k[rings.first..rings.first + rings.rings];
            rings.capacity_j_k.iter().zip(t_k).map(|(c, t_k)| c * (t_k - 273.15)).sum()
        };
        soil.iter().map(of).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buried_pipe::soil_k_m_w;

    /// PE 63 in ordinary ground, 1 m deep, 1 m long: 0.083 K m/W to its outside.
    fn around() -> RingsAround {
        let outside_k_m_w = soil_k_m_w(0.063, 1.0, &Ground::default().soil);
        RingsAround {
            length_m: 1.0,
            jacket_diameter_m: 0.063,
            depth_m: 1.0,
            inside_k_m_w: 0.083,
            outside_k_m_w,
        }
    }

    fn rings(count: usize) -> SoilRings {
        SoilRings::new(EdgeId(0), 0, count, &around(), &Ground::default())
    }

    #[test]
    fn steady_loss_is_that_of_the_whole_soil() {
        let around = around();
        let whole_k_m_w = around.inside_k_m_w + around.outside_k_m_w;
        for count in 1..=MOST_RINGS {
            let rings = rings(count);
            let mut t_k = vec![283.15; count];
            let mut q_w = 0.0;
            for _ in 0..200_000 {
                let lost_w = (293.15 - t_k[0]) * rings.inwards_w_k;
                q_w =
                    rings.advance(&mut t_k, lost_w, 283.15, 1800.0_f64.min(rings.longest_step_s()));
            }
            assert!((q_w - 10.0 / whole_k_m_w).abs() < 1e-9, "{count}: {q_w}");
            // The steady state of `solve` is the same, found at once for water of one temperature.
            let mut settled_k = vec![283.15; count];
            let lost_w = 10.0 * rings.inwards_w_k;
            rings.settle(&mut settled_k, lost_w, 283.15);
            for (settled_k, t_k) in settled_k.iter().zip(&t_k) {
                assert!((settled_k - t_k).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn heat_of_the_soil_closes_in_every_step() {
        let rings = rings(3);
        let mut t_k = [288.15, 285.15, 283.15];
        let stored = |t_k: &[f64]| -> f64 { (0..3).map(|k| rings.capacity_j_k[k] * t_k[k]).sum() };
        for (lost_w, dt_s) in [(30.0, 60.0), (-12.0, 900.0), (0.0, 3600.0), (5.0, 1.0)] {
            let before = stored(&t_k);
            let to_ground_w = rings.advance(&mut t_k, lost_w, 283.15, dt_s);
            let closed = stored(&t_k) - before - (lost_w - to_ground_w) * dt_s;
            assert!(closed.abs() < 1e-9 * before, "{closed}");
        }
    }

    /// Heat taken up from water 10 K warmer than the ground over some days, J/m, by explicit conduction in many
    /// rings of the same soil.
    fn reference_j_m(days: f64) -> f64 {
        let (n, around, ground) = (50, around(), Ground::default());
        let ratio = (RADIUS_M / 0.0315_f64).powf(1.0 / f64::from(n));
        let r = layer_k_m_w(1.0, ratio, 1.6);
        let mut t = vec![0.0; n as usize];
        let capacity: Vec<f64> = (0..n)
            .map(|k| {
                let inner = 0.0315 * ratio.powi(k);
                ground.capacity_j_m3_k()
                    * std::f64::consts::PI
                    * inner
                    * inner
                    * (ratio * ratio - 1.0)
            })
            .collect();
        let beyond = around.outside_k_m_w - f64::from(n) * r + 0.5 * r;
        let (dt, mut heat) = (1.0, 0.0);
        for _ in 0..(days * 86_400.0 / dt) as usize {
            let mut inwards = (10.0 - t[0]) / (around.inside_k_m_w + 0.5 * r);
            heat += inwards * dt;
            for k in 0..t.len() {
                let next = if k + 1 < t.len() { (t[k] - t[k + 1]) / r } else { t[k] / beyond };
                t[k] += dt * (inwards - next) / capacity[k];
                inwards = next;
            }
        }
        heat
    }

    #[test]
    fn three_rings_store_like_many() {
        let rings = rings(3);
        for days in [1.0, 3.0] {
            let (mut t_k, mut heat, dt_s) = ([0.0; 3], 0.0, 600.0);
            for _ in 0..(days * 86_400.0 / dt_s) as usize {
                let lost_w = (10.0 - t_k[0]) * rings.inwards_w_k;
                heat += lost_w * dt_s;
                rings.advance(&mut t_k, lost_w, 0.0, dt_s);
            }
            let reference = reference_j_m(days);
            let error = heat / reference - 1.0;
            assert!(error.abs() < 0.02, "{days} d: {heat} J/m of {reference} J/m, {error}");
        }
    }
}
