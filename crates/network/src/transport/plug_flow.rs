//! The parcels of a pipe during one step: what leaves, given what enters.
//!
//! **Equation** `A rho cp dT/dt + m cp dT/dx = -(T - T_b)/R`. A parcel cools by
//! `T_b + (T - T_b) exp(-dt/tau_R)`, `tau_R = R rho A cp`, moving or not. In constant flow this is
//! `T_out(t) = T_b + (T_in(t - tau) - T_b) exp(-tau/tau_R)`, `tau = content/|m|`. A wall in equilibrium with
//! the water is a larger content: the water that passes is the same.
//!
//! **Assumptions** T_b constant during a step; no axial conduction. **Numerics** every drop is
//! aged exactly by the time it spends inside, whatever the step; a step may be longer than the transit. **Sources** `vanderheijde2017`.

use super::Relation;
use super::parcels::Parcels;
use crate::two_port::PlugFlowPipe;
use anergy_core::port::Port;

/// What remains of the difference to the surroundings after a step, and in the mean over it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Decay {
    pub(super) end: f64,
    pub(super) mean: f64,
}

impl Decay {
    pub(super) fn new(time_constants: f64) -> Self {
        Self { end: (-time_constants).exp(), mean: mean_decay(time_constants) }
    }
}

/// Mean outlet temperature of a step of `dt_s` as a function of the inlet temperature.
pub(super) fn relation(
    parcels: &Parcels,
    edge: usize,
    pipe: &PlugFlowPipe,
    m_flow_kg_s: f64,
    surroundings_k: f64,
    dt_s: f64,
) -> Relation {
    let out = Port::upstream(m_flow_kg_s).opposite();
    let passed_kg = m_flow_kg_s.abs() * dt_s;
    let content_kg = pipe.content_kg;
    let decay_kg = m_flow_kg_s.abs() * pipe.loss_time_constant_s(m_flow_kg_s);
    let leaving_kg = passed_kg.min(content_kg);
    let leaving_k = parcels.mean_leaving(edge, out, leaving_kg, surroundings_k, decay_kg);
    if passed_kg <= content_kg {
        return Relation::constant(leaving_k);
    }
    // All that was inside leaves during the transit time; the surplus passes through.
    let surplus = (passed_kg - content_kg) / passed_kg;
    let decay = (-content_kg / decay_kg).exp();
    Relation {
        constant_k: (1.0 - surplus) * leaving_k + surplus * surroundings_k * (1.0 - decay),
        of_inlet: surplus * decay,
        ..Relation::PASS
    }
}

/// What a step does to the parcels of a pipe.
pub(super) struct Step {
    pub(super) m_flow_kg_s: f64,
    pub(super) t_in_k: f64,
    pub(super) surroundings_k: f64,
    pub(super) dt_s: f64,
    /// Of the whole step.
    pub(super) decay: Decay,
    /// What [`relation`] found.
    pub(super) outlet: Relation,
}

/// Moves the water of a pipe by one step; returns the heat lost over the heat capacity, kg K.
pub(super) fn advance(parcels: &mut Parcels, edge: usize, pipe: &PlugFlowPipe, step: &Step) -> f64 {
    let &Step { m_flow_kg_s, t_in_k, surroundings_k, dt_s, .. } = step;
    let into = Port::upstream(m_flow_kg_s);
    let out = into.opposite();
    let passed_kg = m_flow_kg_s.abs() * dt_s;
    let content_kg = pipe.content_kg;
    let loss_time_constant_s = pipe.loss_time_constant_s(m_flow_kg_s);
    let lossy = loss_time_constant_s.is_finite();
    if passed_kg == 0.0 {
        return if lossy { parcels.relax(edge, surroundings_k, step.decay.end) } else { 0.0 };
    }
    let decay_kg = m_flow_kg_s.abs() * loss_time_constant_s;
    let overrun = passed_kg >= content_kg;
    let (stayed_kg, stayed) = if overrun {
        (content_kg, Decay::new(content_kg / m_flow_kg_s.abs() / loss_time_constant_s))
    } else {
        (passed_kg, step.decay)
    };
    let leaving_k = if overrun {
        parcels.mean_leaving(edge, out, stayed_kg, surroundings_k, decay_kg)
    } else {
        step.outlet.constant_k
    };
    // What left: its heat as it was, less its heat as it left.
    let mut lost = stayed_kg * (parcels.mean_near(edge, out, stayed_kg) - leaving_k);
    if overrun {
        lost += (passed_kg - content_kg) * (t_in_k - surroundings_k) * (1.0 - stayed.end);
    } else {
        parcels.remove(edge, out, passed_kg);
        if lossy {
            lost += parcels.relax(edge, surroundings_k, stayed.end);
        }
    }
    // What entered first has been inside for the whole time, what entered last for none: a straight
    // line with the exact mean of the exponential.
    let excess_k = t_in_k - surroundings_k;
    let inner_k = surroundings_k + excess_k * stayed.end;
    let mean_k = surroundings_k + excess_k * stayed.mean;
    let shift = mean_k - 0.5 * (t_in_k + inner_k);
    lost += stayed_kg * (t_in_k - mean_k);
    if overrun {
        let (t_a_k, t_b_k) = match into {
            Port::A => (t_in_k + shift, inner_k + shift),
            Port::B => (inner_k + shift, t_in_k + shift),
        };
        parcels.replace(edge, content_kg, t_a_k, t_b_k);
    } else {
        parcels.add(edge, into, (stayed_kg, content_kg), t_in_k + shift, inner_k + shift);
    }
    lost
}

/// Mean of `e^(-r s)` over 0..1.
pub(super) fn mean_decay(r: f64) -> f64 {
    if r < 1e-6 { 1.0 - 0.5 * r } else { -(-r).exp_m1() / r }
}
