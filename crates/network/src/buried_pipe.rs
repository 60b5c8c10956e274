//! Heat resistance between the water of a pipe and its surroundings, from the layers around it.
//!
//! **Equation** per length, K m/W:
//! ```text
//! film        1/(pi d_i alpha_i)
//! layer       ln(d_o/d_i)/(2 pi lambda)
//! soil        arcosh(2H'/D)/(2 pi lambda_g),  H' = H + R_0 lambda_g
//! neighbour   ln(((H1'+H2')^2 + E^2)/((H1'-H2')^2 + E^2))/(4 pi lambda_g)       (rise of one per W/m of the other)
//! air         1/(pi D alpha_o)
//! ```
//! H depth of the axis, D outer diameter, E distance of the axes, R_0 resistance of the surface. For deep
//! pipes arcosh(2H'/D) is ln(4H'/D) (2 % apart at H' = D). Two pipes in the ground: with
//! `a = R_1 + R_soil,1`, `b = R_2 + R_soil,2`, `m` the neighbour term and temperatures above the ground's,
//! `[T_1 T_2] = [[a m] [m b]] [q_1 q_2]`, hence `q_1 = T_1/R_g1 + (T_1 - T_2)/R_12` with
//! `1/R_12 = m/(ab - m^2)`, `1/R_g1 = (b - m)/(ab - m^2)`. Equal pipes: `R_s = a + m`, `R_a = a - m`. Two
//! pipes in one casing: first-order multipole of Wallenten.
//!
//! **Assumptions** steady; homogeneous soil whose surface has one temperature (that of the undisturbed
//! ground at the depth of the axis in its place); pipes are line sources for each other.
//!
//! **Validity** pipes below the surface (H' > D/2) that do not touch (E > (D_1 + D_2)/2). Twin pipes side
//! by side: within 0.1 % (equal temperatures) and 0.8 % (opposite) of a boundary collocation.
//!
//! **Numerics** closed forms. **Sources** `en13941`, `bohm2000`, `wallenten1991`, `iso12241`.

use std::f64::consts::PI;

/// Resistance of the surface of the ground, m2 K/W: 1/14.6 W/(m2 K).
pub const SURFACE_RESISTANCE_M2_K_W: f64 = 0.0685;
/// Stefan-Boltzmann constant, W/(m2 K4).
const STEFAN_BOLTZMANN: f64 = 5.670_374e-8;
/// Emissivity of a jacket that is not bright metal.
const EMISSIVITY: f64 = 0.9;

/// What lies around the pipes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Soil {
    /// Thermal conductivity, W/(m K).
    pub conductivity_w_m_k: f64,
    /// Resistance of the surface, m2 K/W.
    pub surface_resistance_m2_k_w: f64,
}

impl Default for Soil {
    fn default() -> Self {
        Self { conductivity_w_m_k: 1.6, surface_resistance_m2_k_w: SURFACE_RESISTANCE_M2_K_W }
    }
}

impl Soil {
    /// Depth at which the surface with its resistance acts like one without, m.
    pub fn corrected_depth_m(&self, depth_m: f64) -> f64 {
        depth_m + self.surface_resistance_m2_k_w * self.conductivity_w_m_k
    }
}

/// Water to wall, K m/W.
pub fn film_k_m_w(inner_diameter_m: f64, film_w_m2_k: f64) -> f64 {
    1.0 / (PI * inner_diameter_m * film_w_m2_k)
}

/// A layer between two diameters, K m/W.
pub fn layer_k_m_w(inner_diameter_m: f64, outer_diameter_m: f64, conductivity_w_m_k: f64) -> f64 {
    (outer_diameter_m / inner_diameter_m).ln() / (2.0 * PI * conductivity_w_m_k)
}

/// The soil around one pipe, K m/W; `outer_diameter_m` is that of what touches the soil.
pub fn soil_k_m_w(outer_diameter_m: f64, depth_m: f64, soil: &Soil) -> f64 {
    let ratio = 2.0 * soil.corrected_depth_m(depth_m) / outer_diameter_m;
    ratio.acosh() / (2.0 * PI * soil.conductivity_w_m_k)
}

/// By how much one pipe warms the soil at the other one per heat it loses, K m/W.
pub fn neighbour_k_m_w(depths_m: [f64; 2], spacing_m: f64, soil: &Soil) -> f64 {
    let [h1, h2] = depths_m.map(|depth_m| soil.corrected_depth_m(depth_m));
    let square = |x: f64| x * x;
    let to_image = square(h1 + h2) + square(spacing_m);
    let to_other = square(h1 - h2) + square(spacing_m);
    (to_image / to_other).ln() / (4.0 * PI * soil.conductivity_w_m_k)
}

/// Two pipes that lose heat to the ground and exchange heat with each other: three resistors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PipePair {
    /// Each pipe to the ground, K m/W.
    pub ground_k_m_w: [f64; 2],
    /// Between the pipes, W/(m K).
    pub between_w_m_k: f64,
}

impl PipePair {
    /// From the resistance of each pipe alone to the ground, its soil included, and the neighbour term.
    /// `None` where the neighbour term is not the smallest of the three: such pipes would touch.
    pub fn of(alone_k_m_w: [f64; 2], neighbour_k_m_w: f64) -> Option<Self> {
        let ([a, b], m) = (alone_k_m_w, neighbour_k_m_w);
        if !(m >= 0.0 && m < a && m < b) {
            return None;
        }
        let determinant = a * b - m * m;
        Some(Self {
            ground_k_m_w: [determinant / (b - m), determinant / (a - m)],
            between_w_m_k: m / determinant,
        })
    }

    /// Heat lost by each pipe, W/m, at temperatures above that of the ground, K.
    pub fn losses_w_m(&self, above_k: [f64; 2]) -> [f64; 2] {
        let between = self.between_w_m_k * (above_k[0] - above_k[1]);
        [above_k[0] / self.ground_k_m_w[0] + between, above_k[1] / self.ground_k_m_w[1] - between]
    }
}

/// Two equal pipes side by side in the insulation of one casing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwinPipe {
    /// Outer diameter of each medium pipe, m.
    pub pipe_diameter_m: f64,
    /// Distance of their axes, m.
    pub spacing_m: f64,
    /// Diameter of the casing, m.
    pub casing_diameter_m: f64,
    /// Conductivity of the insulation, W/(m K).
    pub insulation_w_m_k: f64,
    /// Depth of the axis of the casing, m.
    pub depth_m: f64,
}

impl TwinPipe {
    /// Whether the pipes lie apart, inside the casing, and that below the ground.
    pub fn fits(&self) -> bool {
        self.spacing_m > self.pipe_diameter_m
            && self.spacing_m + self.pipe_diameter_m < self.casing_diameter_m
            && 2.0 * self.depth_m > self.casing_diameter_m
    }

    /// Loss factors of Wallenten: `q_sym = 2 pi lambda_i h_s (T_sym - T_0)` and
    /// `q_asym = 2 pi lambda_i h_a T_asym` per pipe.
    fn loss_factors(&self, soil: &Soil) -> (f64, f64) {
        let h = soil.corrected_depth_m(self.depth_m);
        let (ri, rc) = (0.5 * self.pipe_diameter_m, 0.5 * self.casing_diameter_m);
        let d = 0.5 * self.spacing_m;
        let (li, lg) = (self.insulation_w_m_k, soil.conductivity_w_m_k);
        let sigma = (li - lg) / (li + lg);
        let square = |x: f64| x * x;
        let (rc2, rc4) = (square(rc), rc.powi(4));
        let (d2, d4) = (square(d), d.powi(4));
        let gamma = 2.0 * (1.0 - square(sigma)) / (1.0 - sigma * square(rc / (2.0 * h)));
        let symmetric = 2.0 * li / lg * (2.0 * h / rc).ln()
            + (rc2 / (2.0 * d * ri)).ln()
            + sigma * (rc4 / (rc4 - d4)).ln()
            - square(ri / (2.0 * d) - 2.0 * sigma * ri * d.powi(3) / (rc4 - d4))
                / (1.0 + square(ri / (2.0 * d)) + sigma * square(2.0 * ri * rc2 * d / (rc4 - d4)));
        let antisymmetric = (2.0 * d / ri).ln() + sigma * ((rc2 + d2) / (rc2 - d2)).ln()
            - square(
                ri / (2.0 * d) - gamma * d * ri / (4.0 * square(h))
                    + 2.0 * sigma * ri * rc2 * d / (rc4 - d4),
            ) / (1.0 - square(ri / (2.0 * d)) - gamma * ri / (2.0 * d)
                + 2.0 * sigma * square(ri) * rc2 * (rc4 + d4) / square(rc4 - d4))
            - gamma * square(d / (2.0 * h));
        (1.0 / symmetric, 1.0 / antisymmetric)
    }

    /// The three resistors from outer pipe wall to outer pipe wall and ground. With
    /// `inside_k_m_w`, film and wall of each pipe, in series with both factors. `None` where the pipes
    /// would not exchange heat: the geometry is beyond the formula.
    pub fn pair(&self, inside_k_m_w: f64, soil: &Soil) -> Option<PipePair> {
        let (h_s, h_a) = self.loss_factors(soil);
        let per = 1.0 / (2.0 * PI * self.insulation_w_m_k);
        let (r_s, r_a) = (per / h_s + inside_k_m_w, per / h_a + inside_k_m_w);
        // R_s = alone + m, R_a = alone - m.
        let alone = 0.5 * (r_s + r_a);
        PipePair::of([alone, alone], 0.5 * (r_s - r_a))
    }
}

/// Outer film of a pipe in the air, W/(m2 K): radiation of a jacket at about `t_k`, and the wind across
/// it (`v_m_s`), after ISO 12241: laminar `8.1e-3/D + 3.14 sqrt(v/D)`, beyond v D = 8.55e-3 m2/s turbulent
/// `8.9 v^0.9/D^0.1`.
#[expect(clippy::approx_constant, reason = "an empirical coefficient of the standard")]
pub fn outer_film_w_m2_k(outer_diameter_m: f64, v_m_s: f64, t_k: f64) -> f64 {
    let radiation = 4.0 * EMISSIVITY * STEFAN_BOLTZMANN * t_k.powi(3);
    let convection = if v_m_s * outer_diameter_m <= 8.55e-3 {
        8.1e-3 / outer_diameter_m + 3.14 * (v_m_s / outer_diameter_m).sqrt()
    } else {
        8.9 * v_m_s.powf(0.9) / outer_diameter_m.powf(0.1)
    };
    radiation + convection
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(value: f64, expected: f64, within: f64) {
        assert!((value - expected).abs() <= within, "{value} is not {expected}");
    }

    fn bare(conductivity_w_m_k: f64) -> Soil {
        Soil { conductivity_w_m_k, surface_resistance_m2_k_w: 0.0 }
    }

    #[test]
    fn reference_pipe_in_air_free_of_resistance() {
        // specification 5.1: 1/(pi 0.022 3500) + ln(24/22)/(2 pi 395) + ln(62/24)/(2 pi 0.04)
        // = 0.004134 + 0.000035 + 3.776272 = 3.780440 K m/W
        let sum = film_k_m_w(0.022, 3500.0)
            + layer_k_m_w(0.022, 0.024, 395.0)
            + layer_k_m_w(0.024, 0.062, 0.04);
        close(sum, 3.780_440, 1e-6);
    }

    #[test]
    fn measured_pipes_of_pongau() {
        // ait_pongau/README.md: ln(0.18/0.0899)/(2 pi 0.024) + ln(2/0.18)/(2 pi 2.4) = 4.764 K m/W,
        // service pipe 5.070. Its soil term ln(2/D) is ours, ln(4 H/D), at H = 0.5 m: a depth to the
        // axis of "about 1 m" would be ln(4/D).
        let soil = |d: f64| (4.0 * 0.5 / d).ln() / (2.0 * PI * 2.4);
        close(layer_k_m_w(0.0899, 0.18, 0.024) + soil(0.18), 4.764, 5e-4);
        close(layer_k_m_w(0.0337, 0.07, 0.024) + soil(0.07), 5.070, 5e-4);
        // The exact form differs from the logarithm by (D/4H)^2 = 0.8 % of 1 of it: 0.0005 K m/W.
        close(soil_k_m_w(0.18, 0.5, &bare(2.4)), soil(0.18), 6e-4);
    }

    #[test]
    fn soil_with_its_surface_and_shallow_pipes() {
        // H' = 0.8 + 0.0685 * 1.6 = 0.9096; arcosh(2 * 0.9096/0.11) = ln(16.53818 + 16.50792)
        // = 3.497888, over 2 pi 1.6: 0.347942
        close(soil_k_m_w(0.11, 0.8, &Soil::default()), 0.347_942, 1e-5);
        // A pipe that touches the surface has no soil left: arcosh 1 = 0; the logarithm would give ln 2.
        assert_eq!(soil_k_m_w(0.5, 0.25, &bare(1.0)), 0.0);
        // H = D: arcosh 2 = 1.316958, and not ln 4 = 1.386294
        close(soil_k_m_w(0.5, 0.5, &bare(0.5 / PI)), 1.316_958, 1e-6);
    }

    #[test]
    fn two_equal_pipes_are_symmetric_and_antisymmetric() {
        // EN 13941: R_m = ln(1 + (2H'/E)^2)/(4 pi lambda); R_s = R + R_m, R_a = R - R_m
        let soil = Soil::default();
        let r_m = neighbour_k_m_w([0.8, 0.8], 0.25, &soil);
        close(r_m, (1.0 + (2.0_f64 * 0.9096 / 0.25).powi(2)).ln() / (4.0 * PI * 1.6), 1e-12);
        let alone = 4.0;
        let pair = PipePair::of([alone, alone], r_m).unwrap();
        let (t1, t2) = (70.0, 35.0);
        let (sym, asym) = (0.5 * (t1 + t2), 0.5 * (t1 - t2));
        let [q1, q2] = pair.losses_w_m([t1, t2]);
        close(q1, sym / (alone + r_m) + asym / (alone - r_m), 1e-12);
        close(q2, sym / (alone + r_m) - asym / (alone - r_m), 1e-12);
    }

    #[test]
    fn two_unequal_pipes_are_reciprocal() {
        // [T] = [[3 0.2] [0.2 5]] [q] at q = (2, 7): T = (7.4, 35.4)
        let pair = PipePair::of([3.0, 5.0], 0.2).unwrap();
        let [q1, q2] = pair.losses_w_m([7.4, 35.4]);
        close(q1, 2.0, 1e-12);
        close(q2, 7.0, 1e-12);
        // 1 K of either pipe gives the same to the other.
        let to_second = pair.losses_w_m([1.0, 0.0])[1];
        let to_first = pair.losses_w_m([0.0, 1.0])[0];
        assert_eq!(to_second, to_first);
        // Far apart each is alone.
        let far = neighbour_k_m_w([0.8, 0.8], 1e4, &Soil::default());
        let pair = PipePair::of([3.0, 5.0], far).unwrap();
        close(pair.ground_k_m_w[0], 3.0, 1e-6);
        assert_eq!(PipePair::of([1.0, 3.0], 1.5), None);
    }

    #[test]
    fn neighbours_at_different_depths() {
        // One above the other, 0.4 m between: image 1.6 + 0.4 = 2.0 m away, ln(2/0.4)/(2 pi) = 0.256150
        close(neighbour_k_m_w([0.8, 1.2], 0.0, &bare(1.0)), 0.256_150, 1e-6);
    }

    #[test]
    fn twin_pipes_of_the_specification() {
        // lambda_i, lambda_g, H, r_c, D, r_i; q_sym, q_asym of the formula, and of a boundary
        // collocation of the two-dimensional problem; T_1 = 70, T_2 = 40, T_0 = 0.
        let cases = [
            ([0.028, 1.5, 1.0, 0.080, 0.035, 0.0211], [6.7422, 3.2228], [6.7448, 3.245]),
            ([0.028, 2.0, 0.8, 0.1125, 0.050, 0.0302], [7.1678, 3.2869], [7.1695, 3.311]),
            ([0.024, 1.2, 0.6, 0.070, 0.030, 0.0135], [4.5647, 2.0014], [4.5652, 2.0041]),
        ];
        for ([li, lg, h, rc, d, ri], formula, collocation) in cases {
            let twin = TwinPipe {
                pipe_diameter_m: 2.0 * ri,
                spacing_m: 2.0 * d,
                casing_diameter_m: 2.0 * rc,
                insulation_w_m_k: li,
                depth_m: h,
            };
            assert!(twin.fits());
            let [q1, q2] = twin.pair(0.0, &bare(lg)).unwrap().losses_w_m([70.0, 40.0]);
            let found = [0.5 * (q1 + q2), 0.5 * (q1 - q2)];
            for i in 0..2 {
                close(found[i], formula[i], 1e-4);
                close(found[i] / collocation[i], 1.0, 0.01);
            }
        }
    }

    #[test]
    fn films_in_the_air() {
        // Radiation 4 * 0.9 * 5.670374e-8 * 283.15^3 = 4.6341. Still air on 0.1 m: 0.081. 2 m/s: turbulent
        // (v D = 0.2): 8.9 * 2^0.9/0.1^0.1 = 8.9 * 1.866066 * 1.258925 = 20.9083
        close(outer_film_w_m2_k(0.1, 0.0, 283.15), 4.6341 + 0.081, 1e-3);
        close(outer_film_w_m2_k(0.1, 2.0, 283.15), 4.6341 + 20.9083, 1e-3);
        // 0.05 m/s is laminar: 3.14 sqrt(0.5) = 2.2203
        close(outer_film_w_m2_k(0.1, 0.05, 283.15), 4.6341 + 0.081 + 2.2203, 1e-3);
    }
}
