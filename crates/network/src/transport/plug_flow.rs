//! A pipe during one step: what leaves, given what enters.
//!
//! **Equation** `A rho cp dT/dt + m cp dT/dx = -(T - T_b)/R`. A parcel cools by
//! `T_b + (T - T_b) exp(-dt/tau_R)`, `tau_R = R rho A cp`, moving or not. In constant flow this is
//! `T_out(t) = T_b + (T_in(t - tau) - T_b) exp(-tau/tau_R)`, `tau = content/|m|`.
//!
//! **Assumptions** T_b constant during a step; no axial conduction. **Numerics** water that leaves has
//! on average been cooled for half the step, water that enters reaches its place with a linear age; a
//! step may be longer than the transit. **Sources** `vanderheijde2017`.

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
    let cooled = |t_k: f64, seconds: f64| {
        surroundings_k + (t_k - surroundings_k) * (-seconds / pipe.loss_time_constant_s).exp()
    };
    if passed_kg <= content_kg {
        let leaving_k = parcels.mean_near(edge, out, passed_kg);
        return Relation::constant(cooled(leaving_k, 0.5 * dt_s));
    }
    // All that was inside leaves during the transit time; the surplus passes through.
    let transit_s = content_kg / m_flow_kg_s.abs();
    let content_k = cooled(parcels.mean_near(edge, out, content_kg), 0.5 * transit_s);
    let surplus = (passed_kg - content_kg) / passed_kg;
    let decay = (-transit_s / pipe.loss_time_constant_s).exp();
    Relation {
        constant_k: (1.0 - surplus) * content_k + surplus * surroundings_k * (1.0 - decay),
        of_inlet: surplus * decay,
        of_partner: 0.0,
    }
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
    let decay = |seconds: f64| (-seconds / pipe.loss_time_constant_s).exp();
    let loss_of = |t_k: f64, seconds: f64| {
        -(t_k - surroundings_k) * (-seconds / pipe.loss_time_constant_s).exp_m1()
    };
    if passed_kg == 0.0 {
        return if pipe.loss_time_constant_s.is_finite() {
            parcels.relax(edge, surroundings_k, decay(dt_s))
        } else {
            0.0
        };
    }
    let (stayed_s, stayed_kg, mut lost);
    if passed_kg < content_kg {
        (stayed_s, stayed_kg) = (dt_s, passed_kg);
        lost = passed_kg * loss_of(parcels.mean_near(edge, out, passed_kg), 0.5 * dt_s);
        parcels.remove(edge, out, passed_kg);
        if pipe.loss_time_constant_s.is_finite() {
            lost += parcels.relax(edge, surroundings_k, decay(dt_s));
        }
    } else {
        let transit_s = content_kg / m_flow_kg_s.abs();
        (stayed_s, stayed_kg) = (transit_s, content_kg);
        lost = content_kg * loss_of(parcels.mean_near(edge, out, content_kg), 0.5 * transit_s)
            + (passed_kg - content_kg) * loss_of(t_in_k, transit_s);
    }
    // What entered first has been inside for the whole time, what entered last for none.
    let inner_k = surroundings_k + (t_in_k - surroundings_k) * decay(stayed_s);
    lost += stayed_kg * (t_in_k - 0.5 * (t_in_k + inner_k));
    if passed_kg < content_kg {
        parcels.add(edge, into, stayed_kg, t_in_k, inner_k);
    } else {
        let (t_a_k, t_b_k) = match into {
            Port::A => (t_in_k, inner_k),
            Port::B => (inner_k, t_in_k),
        };
        parcels.replace(edge, content_kg, t_a_k, t_b_k);
    }
    lost
}
