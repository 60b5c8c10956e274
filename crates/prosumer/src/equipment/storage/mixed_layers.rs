//! Advection between mixed layers.
//!
//! **Equation** `m_l dT_l/dt = sum m_in (T_in - T_l) + m_up (T_(l-1) - T_l) + m_down (T_(l+1) - T_l)`; what
//! leaves has the temperature of its layer. **Numerics** explicit upwind in parts whose flow is at most
//! [`super::tank::COURANT`] of a layer: no new extremes, and heat is conserved to rounding. It mixes as if
//! water dispersed with `u dz (1 - Courant)/2`: ten layers blur a front over a few layers, as measured.

use super::layers::Cells;
use super::ports::LayerFlows;

/// Moves the water through the layers for a part of a step.
pub(super) fn advect<const N: usize>(cells: &mut Cells<N>, flows: &LayerFlows<N>, dt_s: f64) {
    let n = cells.count;
    let (mut below_k, mut from_below) = (0.0, 0.0_f64);
    for l in 0..n {
        let t_k = cells.t_k[l];
        let up = flows.up_kg_s[l];
        let mut gain = flows.in_kg_k_s[l] - flows.in_kg_s[l] * t_k;
        if from_below > 0.0 {
            gain += from_below * (below_k - t_k);
        }
        if up < 0.0 {
            gain -= up * (cells.t_k[l + 1] - t_k);
        }
        cells.t_k[l] = t_k + gain * dt_s / cells.mass_kg[l];
        (below_k, from_below) = (t_k, up);
    }
}
