//! Flows of the branches of a coupling.
//!
//! **Equation** a branch without a pump, and one whose pump is off and that nothing closes: `p_from - p_to = R m |m|`, with
//! `R/opening^2` while the pump is off. A pump that runs holds `m = m_wanted`, or, where it cannot throttle, the greater of this
//! and what the others push through it. With `suction` it draws `m = m_wanted + s max(0, m_other - m_wanted)` of the strongest other
//! pump between the same points. Two branches that share a flow divide it as `1 : sqrt(R_2/R_1)`.
//!
//! **Numerics** Newton in flows and pressures (the gradient method): the mass balance is linear and holds in every
//! iteration; quadratic laws converge from any start. Check valves and pumps that do not throttle are held by
//! trying. Always from the same start, so that flows depend on nothing but what is wanted.
//!
//! **Sources** `todini1988`.

use super::{BranchFlows, Coupling, MOST_BRANCHES, MOST_POINTS};

/// The slope of a quadratic law is at least that at this flow, kg/s.
const LEAST_KG_S: f64 = 1e-7;
/// Newton ends when flows change by less, relative to the largest.
const CHANGE: f64 = 1e-12;
/// Flows that still change by more after the last iteration have not settled, relative to the largest.
const SETTLED: f64 = 1e-6;
const ITERATIONS: usize = 60;

/// What a branch does.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    /// A flow that is held, kg/s.
    Held(f64),
    /// A pressure loss over the square of the flow.
    Passive(f64),
}

impl Coupling {
    /// The flows, kg/s, with those that the pumps want, and whether they settled; `wanted_kg_s` of a branch without pump
    /// does not count.
    pub fn flows(&self, wanted_kg_s: &BranchFlows) -> (BranchFlows, bool) {
        let mut laws = [Law::Held(0.0); MOST_BRANCHES];
        for (i, branch) in self.branches.iter().enumerate() {
            laws[i] = match wanted_kg_s[i] {
                _ if !branch.pumped => Law::Passive(branch.resistance),
                wanted if wanted > 0.0 => Law::Held(self.drawn_kg_s(i, wanted_kg_s)),
                _ if branch.idle_opening > 0.0 => self.idle(i),
                _ => Law::Held(0.0),
            };
        }
        let mut flows = [0.0; MOST_BRANCHES];
        for _ in 0..2 * self.branches.len() + 2 {
            let (p_pa, balanced) = self.balance(&laws, &mut flows);
            if !self.try_again(wanted_kg_s, &p_pa, &flows, &mut laws) {
                return (flows, balanced);
            }
        }
        (flows, false)
    }

    /// What a pump that runs delivers, with what it draws along, kg/s.
    fn drawn_kg_s(&self, i: usize, wanted_kg_s: &BranchFlows) -> f64 {
        let (branch, own) = (&self.branches[i], wanted_kg_s[i]);
        let parallel = self.branches.iter().enumerate().filter(|(k, other)| {
            *k != i && other.pumped && (other.from, other.to) == (branch.from, branch.to)
        });
        let strongest = parallel.map(|(k, _)| wanted_kg_s[k]).fold(own, f64::max);
        own + branch.suction * (strongest - own)
    }

    fn idle(&self, i: usize) -> Law {
        let Self { branches, .. } = self;
        Law::Passive(branches[i].resistance / branches[i].idle_opening.powi(2))
    }

    /// Flows with these laws, and the pressures of the points; whether they follow the laws.
    fn balance(
        &self,
        laws: &[Law; MOST_BRANCHES],
        flows: &mut BranchFlows,
    ) -> ([f64; MOST_POINTS], bool) {
        let laws = &laws[..self.branches.len()];
        let mut largest = 0.0_f64;
        for (flow, law) in flows.iter_mut().zip(laws) {
            *flow = if let Law::Held(m) = *law { m } else { 0.0 };
            largest = largest.max(flow.abs());
        }
        let mut p = [0.0; MOST_POINTS];
        if largest == 0.0 {
            return (p, true);
        }
        // Every branch that takes what comes starts as if all of it came.
        for (flow, law) in flows.iter_mut().zip(laws) {
            if let Law::Passive(_) = law {
                *flow = largest;
            }
        }
        let mut settled = false;
        for _ in 0..ITERATIONS {
            let mut matrix = [[0.0; MOST_POINTS]; MOST_POINTS];
            let mut inflow = [0.0; MOST_POINTS];
            for ((branch, law), m) in self.branches.iter().zip(laws).zip(flows.iter()) {
                let (from, to) = (branch.from, branch.to);
                let constant = match *law {
                    Law::Held(held) => held,
                    Law::Passive(r) => {
                        let g = 0.5 / (r * m.abs().max(LEAST_KG_S));
                        matrix[from][from] += g;
                        matrix[to][to] += g;
                        matrix[from][to] -= g;
                        matrix[to][from] -= g;
                        m - g * r * m * m.abs()
                    }
                };
                inflow[from] -= constant;
                inflow[to] += constant;
            }
            p = self.pressures(&mut matrix, inflow);
            let mut change = 0.0_f64;
            for ((branch, law), m) in self.branches.iter().zip(laws).zip(flows.iter_mut()) {
                if let Law::Passive(r) = *law {
                    let g = 0.5 / (r * m.abs().max(LEAST_KG_S));
                    let next = *m + g * (p[branch.from] - p[branch.to] - r * *m * m.abs());
                    change = change.max((next - *m).abs());
                    *m = next;
                }
            }
            settled = change <= (SETTLED * largest).max(LEAST_KG_S);
            if change <= CHANGE * largest {
                break;
            }
        }
        (p, settled)
    }

    /// Pressures that let the inflows go through the conductances; that of the first point is 0.
    fn pressures(
        &self,
        matrix: &mut [[f64; MOST_POINTS]; MOST_POINTS],
        mut inflow: [f64; MOST_POINTS],
    ) -> [f64; MOST_POINTS] {
        for pivot in (1..self.points).rev() {
            let eliminated = matrix[pivot];
            for row in 1..pivot {
                let factor = matrix[row][pivot] / eliminated[pivot];
                for (value, other) in matrix[row][1..pivot].iter_mut().zip(&eliminated[1..]) {
                    *value -= factor * other;
                }
                inflow[row] -= factor * inflow[pivot];
            }
        }
        let mut p = [0.0; MOST_POINTS];
        for row in 1..self.points {
            let known: f64 = (1..row).map(|column| matrix[row][column] * p[column]).sum();
            p[row] = (inflow[row] - known) / matrix[row][row];
        }
        p
    }

    /// Whether a check valve or a pump does something else than was assumed; the laws are corrected.
    fn try_again(
        &self,
        wanted_kg_s: &BranchFlows,
        p: &[f64; MOST_POINTS],
        flows: &BranchFlows,
        laws: &mut [Law; MOST_BRANCHES],
    ) -> bool {
        let mut changed = false;
        for (i, branch) in self.branches.iter().enumerate() {
            let dp = p[branch.from] - p[branch.to];
            let runs = branch.pumped && wanted_kg_s[i] > 0.0;
            let open = if runs { Law::Passive(branch.resistance) } else { self.idle(i) };
            let law = match laws[i] {
                _ if !branch.pumped => continue,
                Law::Held(held) if runs && !branch.throttled => {
                    let pushed = dp > branch.resistance * held * held;
                    if pushed { open } else { continue }
                }
                Law::Passive(_) if runs => {
                    let held = self.drawn_kg_s(i, wanted_kg_s);
                    if flows[i] < held { Law::Held(held) } else { continue }
                }
                Law::Passive(_) if branch.check_valve && flows[i] < 0.0 => Law::Held(0.0),
                Law::Held(_) if !runs && branch.idle_opening > 0.0 && dp > 0.0 => open,
                _ => continue,
            };
            laws[i] = law;
            changed = true;
        }
        changed
    }
}
