//! Limits of temperatures that do not settle by trying: followed from one to the next.
//!
//! Where generators give as much water as the heating takes, next to nothing passes the storage, and only the limits of the units hold the
//! temperature of the loop: all of them change together.
//!
//! **Equation** the points are `T = F(T)`; `F` is straight between the borders at which limits begin and end, and rises with every
//! `T`. From any `T_0` the path `T - F(T) = (1 - s) (T_0 - F(T_0))`, `s` from 0 to 1, is straight in each region: it goes to the
//! solution of the region, or to the first border on its way, where that limit changes.
//!
//! **Numerics** one linear system per region; the path ends, because every region has the same orientation (no gain is
//! negative). **Sources** `katzenelson1965`.

use super::{BranchFlows, Coupling, MOST_POINTS, passed};
use crate::circuit::{Limit, Limits, Undefined, bounded, limit_at};
use anergy_core::port::{Outlet, PortFlow, PortRequest};

/// Borders that the path crosses, per member.
const BORDERS: usize = 12;
/// Borders count as crossed from here on, K.
const CROSSED_K: f64 = 1e-9;

/// The border that a member crosses on the way from a temperature to another: where, and what acts behind it.
fn border(
    outlet: &Outlet,
    limit: Limit,
    capacity_w_k: f64,
    (from_k, to_k): (f64, f64),
) -> Option<(f64, Limit)> {
    let (q_w, bound_k) = bounded(outlet)?;
    let begins_k = bound_k - q_w / capacity_w_k;
    // Towards the bound, whichever side it is on: no limit, then the bound, then it passes.
    let sign = if q_w > 0.0 { 1.0 } else { -1.0 };
    let beyond = |border_k: f64| sign * (to_k - border_k) > CROSSED_K;
    let before = |border_k: f64| sign * (border_k - to_k) > CROSSED_K;
    let (at_k, next) = match limit {
        Limit::None if beyond(begins_k) => (begins_k, Limit::Bound),
        Limit::Bound if beyond(bound_k) => (bound_k, Limit::Passes),
        Limit::Bound if before(begins_k) => (begins_k, Limit::None),
        Limit::Passes if before(bound_k) => (bound_k, Limit::Bound),
        _ => return None,
    };
    Some((((at_k - from_k) / (to_k - from_k)).clamp(0.0, 1.0), next))
}

impl Coupling {
    /// What came from each point last, K.
    pub(super) fn arriving_k(&self, flows: &BranchFlows, got: &[PortFlow]) -> [f64; MOST_POINTS] {
        let mut points_k = [got.first().map_or(0.0, |port| port.t_in_k); MOST_POINTS];
        for (branch, m_flow_kg_s) in self.branches.iter().zip(flows) {
            if let Some(slot) = branch.along(*m_flow_kg_s).next() {
                points_k[branch.upstream(*m_flow_kg_s)] = got[slot].t_in_k;
            }
        }
        points_k
    }

    /// The limits that hold together, from points on; whether the path ended.
    pub(super) fn follow(
        &self,
        flows: &BranchFlows,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        got: &[PortFlow],
        mut points_k: [f64; MOST_POINTS],
    ) -> Result<(Limits, bool), Undefined> {
        let members: usize = self.branches.iter().map(|branch| branch.members.len()).sum();
        let mut limits = self.limits_at(flows, heat_capacity_j_kg_k, wanted, &points_k);
        for _ in 0..BORDERS * members {
            let end_k = self.points_k(flows, heat_capacity_j_kg_k, wanted, got, limits)?;
            let (mut nearest, mut member) = (None::<(f64, usize, Limit)>, 0);
            for (branch, &m_flow_kg_s) in self.branches.iter().zip(flows) {
                let capacity_w_k = m_flow_kg_s.abs() * heat_capacity_j_kg_k;
                let up = branch.upstream(m_flow_kg_s);
                let (mut from_k, mut to_k) = (points_k[up], end_k[up]);
                for slot in branch.along(m_flow_kg_s) {
                    let (outlet, limit) = (&wanted[slot].outlet, limits.of(member));
                    if capacity_w_k > 0.0
                        && let Some((share, next)) =
                            border(outlet, limit, capacity_w_k, (from_k, to_k))
                        && nearest.is_none_or(|(nearest, ..)| share < nearest)
                    {
                        nearest = Some((share, member, next));
                    }
                    let (c, f) = passed(outlet, limit, m_flow_kg_s, capacity_w_k);
                    (from_k, to_k) = (c + f * from_k, c + f * to_k);
                    member += 1;
                }
            }
            let Some((share, member, next)) = nearest else { return Ok((limits, true)) };
            for (point_k, end_k) in points_k.iter_mut().zip(end_k) {
                *point_k += share * (end_k - *point_k);
            }
            limits.set(member, next);
        }
        Ok((limits, false))
    }

    /// The limits that act with these points.
    fn limits_at(
        &self,
        flows: &BranchFlows,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        points_k: &[f64; MOST_POINTS],
    ) -> Limits {
        let (mut limits, mut member) = (Limits::default(), 0);
        for (branch, &m_flow_kg_s) in self.branches.iter().zip(flows) {
            let capacity_w_k = m_flow_kg_s.abs() * heat_capacity_j_kg_k;
            let mut t_k = points_k[branch.upstream(m_flow_kg_s)];
            for slot in branch.along(m_flow_kg_s) {
                let outlet = &wanted[slot].outlet;
                if let Some(limit) = limit_at(outlet, t_k, capacity_w_k) {
                    limits.set(member, limit);
                }
                let (c, f) = passed(outlet, limits.of(member), m_flow_kg_s, capacity_w_k);
                t_k = c + f * t_k;
                member += 1;
            }
        }
        limits
    }
}
