//! What the inertia of the water delays between outputs and measured values.
//!
//! **Equation** at the operating point, with the gains G of flows and pressures over heads in the pipes (P), over outputs
//! (u) and in measured values (y), and the inertances `I = L/A` of the pipes: `(1 + s G_PP I) m_P = G_Pu u`,
//! `y = G_yu u - s G_yP I m_P`. G_PP is symmetric and has no negative eigenvalue, so with
//! `I^1/2 G_PP I^1/2 = V diag(tau) V^T` the water answers in lags: `y = (G_yu - sum g_k + sum g_k/(1 + s tau_k)) u`,
//! `g_k = (G_yP I^1/2 v_k)(v_k^T I^1/2 G_Pu)/tau_k`. One time constant for each independent loop of pipes.
//!
//! **Assumptions** as the linearised network. Runs follow the same water by backward Euler: equal where their steps are
//! short beside tau. **Validity** no free actuators that hold what is prescribed; outputs that set a flow answer with a
//! pulse of pressure, which is no lag. **Sources** specification 5.10.

use crate::channels::Source;
use crate::gains::{Gains, Reach};
use crate::plan::Plan;
use crate::state::State;
use anergy_core::ids::EdgeId;
use nalgebra::{DMatrix, SymmetricEigen};

/// More pipes than this are not worked through.
const MOST_PIPES: usize = 600;
/// Lags shorter than this are none, s; what a pulse may then leave, in the largest gain of a value times 1 s.
const LEAST_S: f64 = 1e-6;
const LEAST_PULSE: f64 = 1e-4;
/// Parts smaller than this beside the largest gain of a value are left out.
const LEAST_PART: f64 = 1e-7;
/// Lags that differ by less are one.
const SAME: f64 = 1e-6;

/// A part of the gains that comes behind a lag.
#[derive(Debug, Clone)]
pub(super) struct Late {
    pub lag_s: f64,
    pub gains: DMatrix<f64>,
}

/// The parts of `gains` that come behind the inertia of the water, or why they are not known.
pub(super) fn late(
    plan: &Plan,
    state: &State,
    network: &mut Gains,
    sources: &[(Source, Option<Source>)],
    reaches: &[Option<Reach>],
    gains: &DMatrix<f64>,
) -> Result<Vec<Late>, &'static str> {
    let inertance = |edge: usize| plan.network.edges[edge].element.inertance_1_m();
    let pipes: Vec<usize> =
        (0..plan.network.edges.len()).filter(|&edge| inertance(edge) > 0.0).collect();
    if pipes.len() > MOST_PIPES {
        return Err("water with inertia in more than 600 pipes is not analysed");
    }
    if network.follows() {
        return Err("water with inertia and free actuators that hold a quantity are not analysed");
    }
    let roots: Vec<f64> = pipes.iter().map(|&edge| inertance(edge).sqrt()).collect();
    let mut flows = DMatrix::zeros(pipes.len(), pipes.len());
    let mut values = DMatrix::zeros(sources.len(), pipes.len());
    for (column, &edge) in pipes.iter().enumerate() {
        network.push(plan, EdgeId::from_index(edge));
        for (row, &other) in pipes.iter().enumerate() {
            flows[(row, column)] = network.flow(other) * roots[row] * roots[column];
        }
        for (row, (of, minus)) in sources.iter().enumerate() {
            let mut value = |source: Source| network.value(plan, state, source).unwrap_or(0.0);
            let less = minus.map_or(0.0, &mut value);
            values[(row, column)] = (value(*of) - less) * roots[column];
        }
    }
    let mut driven = DMatrix::zeros(pipes.len(), reaches.len());
    for (column, reach) in reaches.iter().enumerate() {
        let Some(reach) = reach else { continue };
        network.each_answer(plan, reach, |share, answer| {
            for (row, &edge) in pipes.iter().enumerate() {
                driven[(row, column)] += share * answer.m_flow_kg_s[edge] * roots[row];
            }
        });
    }
    let symmetric = (&flows + flows.transpose()) * 0.5;
    let SymmetricEigen { eigenvalues, eigenvectors } = symmetric.symmetric_eigen();
    let scales: Vec<f64> = gains.row_iter().map(|row| row.amax()).collect();
    let mut parts: Vec<Late> = Vec::new();
    for (tau_s, vector) in eigenvalues.iter().zip(eigenvectors.column_iter()) {
        let pulse = (&values * vector) * (vector.transpose() * &driven);
        let over = |share: f64| {
            let mut rows = pulse.row_iter().zip(&scales);
            rows.any(|(row, scale)| row.amax() > share * scale)
        };
        if *tau_s < LEAST_S {
            if over(LEAST_PULSE) {
                return Err(
                    "it sets a flow, which water with inertia answers with a pulse of pressure",
                );
            }
        } else if over(LEAST_PART * tau_s) {
            let gains = pulse / *tau_s;
            match parts.iter_mut().find(|part| (part.lag_s - tau_s).abs() < SAME * tau_s) {
                Some(part) => part.gains += gains,
                None => parts.push(Late { lag_s: *tau_s, gains }),
            }
        }
    }
    parts.sort_by(|a, b| b.lag_s.total_cmp(&a.lag_s));
    Ok(parts)
}
