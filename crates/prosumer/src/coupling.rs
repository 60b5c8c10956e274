//! A coupling of circuits: branches of a house that meet in points, as generators, storage and heating do in a two-pipe
//! connection.
//!
//! **Equation** mass at every point, `sum m = 0`; pressure along every branch that no pump holds, `dp = R m |m|`
//! (`flows`); heat at every point, `T sum m_in = sum m_in T_in`, with `T_in = c + f T_up` of what the units of a branch do to the
//! water of the point upstream. Points are at most eight: one linear system.
//!
//! **Assumptions** thermal only as the circuits are: a pump that runs delivers what is asked for, so only the
//! ratios of the resistances count; the water in points and pipes has no volume. **Validity** branches
//! without a pump connect all points: they take the differences. **Numerics** mass to rounding, heat exact: the
//! matrix has no positive entry beside its diagonal and is eliminated without pivots; limits of temperatures are held by
//! trying, and where that does not settle by following them (`limits`). Where no water comes to a point, it shows what would leave first.
//!
//! **Sources** `zinsmeister2022` (flow through generators that are off, and between those that are on).

mod flows;
mod limits;

use crate::circuit::{LEAST_HOLD, Limit, Limits, Undefined, limit_at, relation};
use anergy_core::port::{Outlet, PortFlow, PortRequest};

/// Most points of a coupling.
pub const MOST_POINTS: usize = 8;
/// Most branches of a coupling.
pub const MOST_BRANCHES: usize = 16;

/// Flows of the branches, kg/s, in their order.
pub type BranchFlows = [f64; MOST_BRANCHES];

/// Ports between two points.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Point at which positive flow enters.
    pub from: usize,
    /// Point at which positive flow leaves.
    pub to: usize,
    /// Slots of the ports, in the order of positive flow.
    pub members: Vec<usize>,
    /// Whether it has a pump: that of one of its units, or its own.
    pub pumped: bool,
    /// Pressure loss over the square of the flow; only the ratios count.
    pub resistance: f64,
    /// How far it is open while its pump is off: its conductance then over that in operation.
    pub idle_opening: f64,
    /// Share of what the strongest parallel pump delivers more that this one draws with it while it runs.
    pub suction: f64,
    /// Whether the pump holds its flow also where the other pumps would push more through it.
    pub throttled: bool,
    /// Whether a check valve keeps water from flowing back.
    pub check_valve: bool,
}

/// Branches that meet in points.
#[derive(Debug, Clone, PartialEq)]
pub struct Coupling {
    /// Number of points.
    pub points: usize,
    /// Branches.
    pub branches: Vec<Branch>,
}

impl Branch {
    /// The point that its water comes from.
    fn upstream(&self, m_flow_kg_s: f64) -> usize {
        if m_flow_kg_s < 0.0 { self.to } else { self.from }
    }

    /// The point that its water goes to.
    fn downstream(&self, m_flow_kg_s: f64) -> usize {
        if m_flow_kg_s < 0.0 { self.from } else { self.to }
    }

    /// Slots in the order of the flow.
    fn along(&self, m_flow_kg_s: f64) -> impl Iterator<Item = usize> + '_ {
        let last = self.members.len() - 1;
        let back = m_flow_kg_s < 0.0;
        (0..=last).map(move |i| self.members[if back { last - i } else { i }])
    }
}

/// `c` and `f` of a member that is passed with a flow.
fn passed(outlet: &Outlet, limit: Limit, m_flow_kg_s: f64, capacity_w_k: f64) -> (f64, f64) {
    match *outlet {
        Outlet::Ends { a_k, .. } if m_flow_kg_s < 0.0 => (a_k, 0.0),
        _ => relation(outlet, limit, capacity_w_k),
    }
}

impl Coupling {
    /// The temperatures of the points and around the branches with their flows; whether the limits of temperatures settled.
    ///
    /// # Errors
    /// [`Undefined`] when nothing holds the temperature.
    pub fn solve(
        &self,
        flows: &BranchFlows,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        got: &mut [PortFlow],
    ) -> Result<bool, Undefined> {
        let mut limits = Limits::default();
        let members: usize = self.branches.iter().map(|branch| branch.members.len()).sum();
        let before_k = self.arriving_k(flows, got);
        for _ in 0..=3 * members {
            let points = self.points_k(flows, heat_capacity_j_kg_k, wanted, got, limits);
            let Ok(points_k) = points else { break };
            let next = self.along(flows, heat_capacity_j_kg_k, wanted, &points_k, limits, got);
            if next == limits {
                return Ok(true);
            }
            limits = next;
        }
        let (limits, settled) = self.follow(flows, heat_capacity_j_kg_k, wanted, got, before_k)?;
        let points_k = self.points_k(flows, heat_capacity_j_kg_k, wanted, got, limits)?;
        self.along(flows, heat_capacity_j_kg_k, wanted, &points_k, limits, got);
        Ok(settled)
    }

    /// What the ports get of these points; the limits that would act on them.
    fn along(
        &self,
        flows: &BranchFlows,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        points_k: &[f64; MOST_POINTS],
        limits: Limits,
        got: &mut [PortFlow],
    ) -> Limits {
        let mut next = limits;
        let mut member = 0;
        for (branch, &m_flow_kg_s) in self.branches.iter().zip(flows) {
            let capacity_w_k = m_flow_kg_s.abs() * heat_capacity_j_kg_k;
            let mut t_k = points_k[branch.upstream(m_flow_kg_s)];
            for slot in branch.along(m_flow_kg_s) {
                let outlet = &wanted[slot].outlet;
                let (c, f) = passed(outlet, limits.of(member), m_flow_kg_s, capacity_w_k);
                if let Some(limit) = limit_at(outlet, t_k, capacity_w_k) {
                    next.set(member, limit);
                }
                let t_out_k = c + f * t_k;
                got[slot] = PortFlow { m_flow_kg_s, t_in_k: t_k, t_out_k };
                t_k = t_out_k;
                member += 1;
            }
        }
        next
    }

    /// Temperatures of the points, K.
    fn points_k(
        &self,
        flows: &BranchFlows,
        heat_capacity_j_kg_k: f64,
        wanted: &[PortRequest],
        got: &[PortFlow],
        limits: Limits,
    ) -> Result<[f64; MOST_POINTS], Undefined> {
        let mut matrix = [[0.0; MOST_POINTS]; MOST_POINTS];
        let mut t_k = [0.0; MOST_POINTS];
        let mut member = 0;
        for (branch, m_flow_kg_s) in self.branches.iter().zip(*flows) {
            let (mut constant_k, mut of_inlet) = (0.0, 1.0);
            let capacity_w_k = m_flow_kg_s.abs() * heat_capacity_j_kg_k;
            for slot in branch.along(m_flow_kg_s) {
                let outlet = &wanted[slot].outlet;
                let (c, f) = passed(outlet, limits.of(member), m_flow_kg_s, capacity_w_k);
                (constant_k, of_inlet) = (c + f * constant_k, f * of_inlet);
                member += 1;
            }
            let to = branch.downstream(m_flow_kg_s);
            matrix[to][to] += m_flow_kg_s.abs();
            matrix[to][branch.upstream(m_flow_kg_s)] -= m_flow_kg_s.abs() * of_inlet;
            t_k[to] += m_flow_kg_s.abs() * constant_k;
        }
        for point in 0..self.points {
            if matrix[point][point] == 0.0 {
                (matrix[point][point], t_k[point]) = (1.0, self.standing_k(point, wanted, got));
            }
        }
        for pivot in 0..self.points {
            let eliminated = matrix[pivot];
            let diagonal = eliminated[pivot];
            let inflow = self.inflow_kg_s(pivot, flows);
            if diagonal <= LEAST_HOLD * inflow {
                return Err(Undefined);
            }
            for row in pivot + 1..self.points {
                let factor = matrix[row][pivot] / diagonal;
                if factor != 0.0 {
                    for (value, other) in matrix[row][pivot..].iter_mut().zip(&eliminated[pivot..])
                    {
                        *value -= factor * other;
                    }
                    t_k[row] -= factor * t_k[pivot];
                }
            }
        }
        for row in (0..self.points).rev() {
            let known: f64 =
                (row + 1..self.points).map(|column| matrix[row][column] * t_k[column]).sum();
            t_k[row] = (t_k[row] - known) / matrix[row][row];
        }
        Ok(t_k)
    }

    fn inflow_kg_s(&self, point: usize, flows: &BranchFlows) -> f64 {
        let branches = self.branches.iter().zip(flows);
        branches.filter(|(b, m)| b.downstream(**m) == point).map(|(_, m)| m.abs()).sum()
    }

    /// What would come to a point that no water reaches: of a branch without pump that holds its end, or what came last.
    fn standing_k(&self, point: usize, wanted: &[PortRequest], got: &[PortFlow]) -> f64 {
        let ends = self.branches.iter().filter(|branch| !branch.pumped).filter_map(|branch| {
            let (slot, sign) = match point {
                _ if branch.to == point => (branch.members.last()?, 1.0),
                _ if branch.from == point => (branch.members.first()?, -1.0),
                _ => return None,
            };
            wanted[*slot].outlet.temperature_k(sign)
        });
        let leaving = self.branches.iter().filter(|branch| branch.from == point);
        let last =
            leaving.filter_map(|branch| branch.members.first()).map(|slot| got[*slot].t_in_k);
        let arriving = self.branches.iter().filter(|branch| branch.to == point);
        let behind =
            arriving.filter_map(|branch| branch.members.last()).map(|slot| got[*slot].t_out_k);
        ends.chain(last).chain(behind).next().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
