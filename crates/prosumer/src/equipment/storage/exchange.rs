//! What the water of a storage exchanges with itself and the surroundings: conduction, loss, buoyancy.
//!
//! **Equation** `C_i dT_i/dt = G_i (T_(i+1) - T_i) + G_(i-1) (T_(i-1) - T_i) - UA_i (T_i - T_amb)` with `G =
//! lambda A_c/distance`, and `k` more where a cell is warmer than the one above it. **Assumptions** `k` is
//! measured with layers of a given height and belongs to it: between parcels it is divided by their distance
//! in layers. **Numerics** implicit: one tridiagonal system, stable for any step, with which pairs lie the
//! wrong way round *after* the step found by trying (all at the start, then those of the solution; it
//! settles after a few). Two cells never more than equalise. Mixing at once merges neighbours that lie the wrong way round until
//! none is left (pool adjacent violators).
//!
//! Both end in the same state. The heat that buoyancy moves is never negative, and once it flows between two
//! cells the lower one stays the warmer one: only what warms it or cools the other comes after. In the limit
//! the flow between two cells and their difference are never both positive, which are the conditions of the
//! nearest profile that rises with the height (isotonic regression), and that is what the merging finds.
//!
//! **Sources** conductance of the reference storage, `zinsmeister2023`; `barlow1972` (pooling).

use super::layers::Cells;

/// Trials of which pairs lie the wrong way round.
const TRIALS: usize = 12;

/// What the water has around it in a part of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Surroundings<'a> {
    pub(super) dt_s: f64,
    pub(super) heat_capacity_j_kg_k: f64,
    pub(super) ambient_k: f64,
    /// Conductance to the surroundings of each cell, W/K.
    pub(super) ua_w_k: &'a [f64],
    /// Conductance between cells whose middles are 1 kg of water apart, W kg/K.
    pub(super) conduction_w_kg_k: f64,
    /// The same of buoyancy.
    pub(super) buoyancy_w_kg_k: f64,
    /// More conductance between each cell and the one above, W/K; nothing where it is empty.
    pub(super) jets_w_k: &'a [f64],
}

/// Conduction, loss and buoyancy over a part of a step; returns the heat lost, J.
pub(super) fn exchange<const N: usize>(cells: &mut Cells<N>, around: &Surroundings<'_>) -> f64 {
    let n = cells.count;
    let start_k = cells.t_k;
    let mut inverted = [false; N];
    for trial in 0..TRIALS {
        let mut same = trial > 0;
        for i in 1..n {
            let now = cells.t_k[i - 1] > cells.t_k[i];
            same &= now == inverted[i - 1];
            inverted[i - 1] = now;
        }
        if same {
            break;
        }
        solve(cells, &start_k, &inverted, around);
    }
    let lost = (0..n).map(|i| around.ua_w_k[i] * (cells.t_k[i] - around.ambient_k));
    lost.sum::<f64>() * around.dt_s
}

/// The temperatures after a part of a step with given pairs between which heat rises.
fn solve<const N: usize>(
    cells: &mut Cells<N>,
    start_k: &[f64; N],
    inverted: &[bool; N],
    around: &Surroundings<'_>,
) {
    let n = cells.count;
    // Forward elimination of (C/dt + UA + G_below + G_above) T_i - G_below T_(i-1) - G_above T_(i+1) =
    // C/dt T_i(before) + UA T_amb, without a subtraction; kept as T_i = above[i] T_(i+1) + rest[i].
    let (mut above, mut rest) = ([0.0; N], [0.0; N]);
    let (mut g_below, mut rest_below, mut not_above_below) = (0.0, 0.0, 0.0);
    let c_dt_kg = around.heat_capacity_j_kg_k / around.dt_s;
    for i in 0..n {
        let g_above = if i + 1 < n {
            let rises = if inverted[i] { around.buoyancy_w_kg_k } else { 0.0 };
            let jet_w_k = around.jets_w_k.get(i).copied().unwrap_or(0.0);
            2.0 * (around.conduction_w_kg_k + rises) / (cells.mass_kg[i] + cells.mass_kg[i + 1])
                + jet_w_k
        } else {
            0.0
        };
        let c_dt = cells.mass_kg[i] * c_dt_kg;
        let ua = around.ua_w_k[i];
        let held = c_dt + ua + g_below * not_above_below;
        let share = 1.0 / (held + g_above);
        above[i] = g_above * share;
        rest[i] = (c_dt * start_k[i] + ua * around.ambient_k + g_below * rest_below) * share;
        (g_below, rest_below, not_above_below) = (g_above, rest[i], held * share);
    }
    let mut next_k = 0.0;
    for i in (0..n).rev() {
        next_k = above[i] * next_k + rest[i];
        cells.t_k[i] = next_k;
    }
}

/// Mixes whatever lies the wrong way round, at once.
pub(super) fn overturn<const N: usize>(cells: &mut Cells<N>) {
    let n = cells.count;
    if (1..n).all(|i| cells.t_k[i - 1] <= cells.t_k[i]) {
        return;
    }
    // Blocks of equal temperature: first cell, mass, temperature.
    let (mut first, mut mass, mut t_k, mut blocks) = ([0; N], [0.0; N], [0.0; N], 0);
    for i in 0..n {
        (first[blocks], mass[blocks], t_k[blocks]) = (i, cells.mass_kg[i], cells.t_k[i]);
        while blocks > 0 && t_k[blocks - 1] > t_k[blocks] {
            let (below, whole) = (blocks - 1, mass[blocks - 1] + mass[blocks]);
            t_k[below] += (t_k[blocks] - t_k[below]) * mass[blocks] / whole;
            mass[below] = whole;
            blocks = below;
        }
        blocks += 1;
    }
    for block in 0..blocks {
        let end = if block + 1 < blocks { first[block + 1] } else { n };
        cells.t_k[first[block]..end].fill(t_k[block]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const CP: f64 = 4180.0;

    fn cells(t_k: &[f64]) -> Cells<128> {
        let mut cells = Cells::empty();
        for t in t_k {
            cells.push(1.0, *t);
        }
        cells
    }

    #[test]
    fn loss_is_an_exponential() {
        // 1 kg, 2 W/K for an hour: exp(-2*3600/4180) = 0.178623 of 60 K are left; the implicit rule of
        // parts of 1 s is dt UA/(2 C) = 0.024 % of the exponent off.
        let mut cells = cells(&[80.0]);
        let mut lost = 0.0;
        for _ in 0..3600 {
            let around = Surroundings {
                dt_s: 1.0,
                heat_capacity_j_kg_k: CP,
                ambient_k: 20.0,
                ua_w_k: &[2.0],
                conduction_w_kg_k: 0.0,
                buoyancy_w_kg_k: 0.0,
                jets_w_k: &[],
            };
            lost += exchange(&mut cells, &around);
        }
        assert!((cells.t_k[0] - 20.0 - 60.0 * 0.178_623).abs() < 60.0 * 1e-4, "{}", cells.t_k[0]);
        assert!((lost - CP * (80.0 - cells.t_k[0])).abs() < 1e-6);
    }

    #[test]
    fn conduction_is_a_decaying_cosine() {
        // Insulated rod: cos(pi z/H) decays with a (pi/H)^2; per cell (lambda A/dz)/(m cp) = G/C, so with n
        // cells the rate is 2 G/C (1 - cos(pi/n)).
        for n in [10, 100] {
            let shape = |i: usize| (PI * (i as f64 + 0.5) / n as f64).cos();
            let mut cells = cells(&(0..n).map(|i| 50.0 - 10.0 * shape(i)).collect::<Vec<_>>());
            let (g, ua_w_k) = (30.0, [0.0; 128]);
            let (time_s, parts) = (400.0, 4000);
            for _ in 0..parts {
                let around = Surroundings {
                    dt_s: time_s / f64::from(parts),
                    heat_capacity_j_kg_k: CP,
                    ambient_k: 20.0,
                    ua_w_k: &ua_w_k,
                    conduction_w_kg_k: g,
                    buoyancy_w_kg_k: 0.0,
                    jets_w_k: &[],
                };
                exchange(&mut cells, &around);
            }
            let rate = 2.0 * g / CP * (1.0 - (PI / n as f64).cos());
            let left = (-rate * time_s).exp();
            for i in 0..n {
                let expected = 50.0 - 10.0 * shape(i) * left;
                assert!((cells.t_k[i] - expected).abs() < 1e-3, "{n} {i}: {}", cells.t_k[i]);
            }
        }
    }

    fn rise<const N: usize>(cells: &mut Cells<N>, dt_s: f64, buoyancy_w_kg_k: f64) {
        let around = Surroundings {
            dt_s,
            heat_capacity_j_kg_k: CP,
            ambient_k: 0.0,
            ua_w_k: &[0.0; 128],
            conduction_w_kg_k: 0.0,
            buoyancy_w_kg_k,
            jets_w_k: &[],
        };
        assert_eq!(exchange(cells, &around), 0.0);
    }

    #[test]
    fn an_inverted_pair_equalises_at_the_rate_of_the_buoyancy() {
        // 900 W/K between two layers of 78.5 kg: rate 2*900/(78.5*4180) = 0.0054856 1/s; after 60 s in one
        // part 1/(1 + 0.32914) = 0.75237 of 20 K are left, in many exp(-0.32914) = 0.71954.
        for (parts, left) in [(1, 0.752_37), (6000, 0.719_54)] {
            let mut cells = cells(&[50.0, 30.0]);
            cells.mass_kg[..2].fill(78.5);
            for _ in 0..parts {
                rise(&mut cells, 60.0 / f64::from(parts), 900.0 * 78.5);
            }
            assert!((cells.t_k[0] - cells.t_k[1] - 20.0 * left).abs() < 1e-3);
            assert!((cells.t_k[0] + cells.t_k[1] - 80.0).abs() < 1e-10);
        }
        // Two cells that lie right exchange nothing, whatever the step.
        let mut cells = cells(&[30.0, 50.0]);
        rise(&mut cells, 1e6, 1e9);
        assert!((cells.t_k[0] - 30.0).abs() < 1e-9 && (cells.t_k[1] - 50.0).abs() < 1e-9);
    }

    #[test]
    fn heat_rises_through_a_sliver_and_through_what_it_warms() {
        // Between 40 kg and 40 kg lies 1 g: the conductance is nearly that of neighbours at 40 kg, and what it
        // warms is then warmer than the 40 kg above it.
        let mut with = cells(&[60.0, 30.0, 30.0, 30.0]);
        with.mass_kg[..4].copy_from_slice(&[40.0, 0.001, 40.0, 40.0]);
        rise(&mut with, 600.0, 900.0 * 40.0);
        let mut without = cells(&[60.0, 30.0, 30.0]);
        without.mass_kg[..3].fill(40.0);
        rise(&mut without, 600.0, 900.0 * 40.0);
        for (i, j) in [(0, 0), (2, 1), (3, 2)] {
            assert!((with.t_k[i] - without.t_k[j]).abs() < 1e-2, "{with:?} {without:?}");
        }
        assert!(without.t_k[2] > 33.0, "{without:?}");
    }

    #[test]
    fn buoyancy_ends_where_mixing_ends() {
        // By hand: [30, 10, 15] -> the first two meet at 20 above 15 -> all at 18.333.
        let mut by_hand = cells(&[30.0, 10.0, 15.0]);
        overturn(&mut by_hand);
        assert!(by_hand.temperatures().iter().all(|t| (t - 55.0 / 3.0).abs() < 1e-12));
        let mut seed = 12_345_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 40) as f64 / (1_u64 << 24) as f64
        };
        for _ in 0..20 {
            let mut mixed = cells(&(0..12).map(|_| 20.0 + 60.0 * random()).collect::<Vec<_>>());
            mixed.mass_kg[..12].iter_mut().for_each(|m| *m = 0.3 + random());
            let mut risen = mixed.clone();
            let before = mixed.content_kg_k();
            overturn(&mut mixed);
            for _ in 0..3000 {
                rise(&mut risen, 10.0, 4e3);
            }
            assert!((mixed.content_kg_k() - before).abs() < 1e-9);
            assert!((risen.content_kg_k() - before).abs() < 1e-9);
            for i in 0..12 {
                assert!((mixed.t_k[i] - risen.t_k[i]).abs() < 1e-6, "{mixed:?} {risen:?}");
            }
        }
    }
}
