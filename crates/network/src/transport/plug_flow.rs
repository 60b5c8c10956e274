//! A pipe during one step: what leaves, given what enters.
//!
//! **Equation** `A rho cp dT/dt + m cp dT/dx = -(T - T_b)/R`. A parcel cools by
//! `T_b + (T - T_b) exp(-dt/tau_R)`, `tau_R = R rho A cp`, moving or not. In constant flow this is
//! `T_out(t) = T_b + (T_in(t - tau) - T_b) exp(-tau/tau_R)`, `tau = content/|m|`.
//!
//! **Assumptions** T_b constant during a step; no axial conduction. **Numerics** every drop is
//! aged exactly by the time it spends inside, whatever the step; a step may be longer than the transit. **Sources** `vanderheijde2017`.

use super::Relation;
use super::parcels::Parcels;
use crate::two_port::PlugFlowPipe;
use anergy_core::port::Port;

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
    let decay_kg = m_flow_kg_s.abs() * pipe.loss_time_constant_s;
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
        of_partner: 0.0,
    }
}

/// Mean temperature of the content in the steady state, K.
pub(super) fn steady_mean_k(
    pipe: &PlugFlowPipe,
    m_flow_kg_s: f64,
    t_in_k: f64,
    surroundings_k: f64,
) -> f64 {
    let transit_s = pipe.content_kg / m_flow_kg_s.abs();
    surroundings_k + (t_in_k - surroundings_k) * mean_decay(transit_s / pipe.loss_time_constant_s)
}

/// Outlet temperature in the steady state as a function of the inlet temperature.
pub(super) fn steady_relation(
    pipe: &PlugFlowPipe,
    m_flow_kg_s: f64,
    surroundings_k: f64,
) -> Relation {
    let transit_s = pipe.content_kg / m_flow_kg_s.abs();
    let decay = (-transit_s / pipe.loss_time_constant_s).exp();
    Relation { constant_k: surroundings_k * (1.0 - decay), of_inlet: decay, of_partner: 0.0 }
}

/// Moves the water of a pipe by one step; returns the heat lost over the heat capacity, kg K.
pub(super) fn advance(
    parcels: &mut Parcels,
    edge: usize,
    pipe: &PlugFlowPipe,
    m_flow_kg_s: f64,
    t_in_k: f64,
    surroundings_k: f64,
    dt_s: f64,
) -> f64 {
    let into = Port::upstream(m_flow_kg_s);
    let out = into.opposite();
    let passed_kg = m_flow_kg_s.abs() * dt_s;
    let content_kg = pipe.content_kg;
    let lossy = pipe.loss_time_constant_s.is_finite();
    let decay = |seconds: f64| (-seconds / pipe.loss_time_constant_s).exp();
    if passed_kg == 0.0 {
        return if lossy { parcels.relax(edge, surroundings_k, decay(dt_s)) } else { 0.0 };
    }
    let decay_kg = m_flow_kg_s.abs() * pipe.loss_time_constant_s;
    let overrun = passed_kg >= content_kg;
    let (stayed_s, stayed_kg) =
        if overrun { (content_kg / m_flow_kg_s.abs(), content_kg) } else { (dt_s, passed_kg) };
    // What left: its heat as it was, less its heat as it left.
    let mut lost = stayed_kg
        * (parcels.mean_near(edge, out, stayed_kg)
            - parcels.mean_leaving(edge, out, stayed_kg, surroundings_k, decay_kg));
    if overrun {
        lost += (passed_kg - content_kg) * (t_in_k - surroundings_k) * (1.0 - decay(stayed_s));
    } else {
        parcels.remove(edge, out, passed_kg);
        if lossy {
            lost += parcels.relax(edge, surroundings_k, decay(dt_s));
        }
    }
    // What entered first has been inside for the whole time, what entered last for none: a straight
    // line with the exact mean of the exponential.
    let excess_k = t_in_k - surroundings_k;
    let inner_k = surroundings_k + excess_k * decay(stayed_s);
    let ratio = stayed_s / pipe.loss_time_constant_s;
    let mean_k = surroundings_k + excess_k * mean_decay(ratio);
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
fn mean_decay(r: f64) -> f64 {
    if r < 1e-6 { 1.0 - 0.5 * r } else { -(-r).exp_m1() / r }
}
