//! Couplings: circuits that are branches between points.

use super::Builder;
use crate::diagnostic::did_you_mean;
use crate::model::{BranchSpec, CircuitSpec};
use crate::plan::{PlannedCircuit, PlannedCoupling};
use crate::wording::refused;
use anergy_prosumer::circuit::MOST_MEMBERS;
use anergy_prosumer::coupling::{Branch, Coupling, MOST_BRANCHES, MOST_POINTS};
use smol_str::SmolStr;

/// Resistance of a branch with a pump over that of one without, where neither is said.
const OF_PUMPED: f64 = 25.0;

/// Branches that hang together, by the least of their points, with the ends of each.
type Group<'m> = (usize, Vec<Planned<'m>>, Vec<(usize, usize)>);
type Planned<'m> = (&'m CircuitSpec, &'m BranchSpec, PlannedCircuit);

/// Points that belong together by some of the branches: the smallest number of each.
fn united(points: usize, branches: &[(usize, usize)]) -> Vec<usize> {
    let mut of: Vec<usize> = (0..points).collect();
    for _ in 0..points {
        for &(from, to) in branches {
            let least = of[from].min(of[to]);
            (of[from], of[to]) = (least, least);
        }
    }
    of
}

impl Builder<'_> {
    /// The couplings that the branches make up.
    pub(super) fn couplings<'m>(&mut self, branches: Vec<Planned<'m>>) -> Vec<PlannedCoupling> {
        let mut names: Vec<&SmolStr> = Vec::new();
        let mut ends = Vec::new();
        for (_, branch, _) in &branches {
            let mut number = |name: &'m SmolStr| {
                names.iter().position(|known| *known == name).unwrap_or_else(|| {
                    names.push(name);
                    names.len() - 1
                })
            };
            ends.push((number(&branch.from), number(&branch.to)));
        }
        // Every problem is told.
        let unsound = branches.iter().filter(|planned| !self.branch_is_sound(planned, &branches));
        if unsound.count() > 0 {
            return Vec::new();
        }
        let coupling_of = united(names.len(), &ends);
        let mut couplings: Vec<Group> = Vec::new();
        for (planned, (from, to)) in branches.into_iter().zip(ends) {
            let of = coupling_of[from];
            match couplings.iter_mut().find(|(known, ..)| *known == of) {
                Some((_, planneds, ends)) => {
                    planneds.push(planned);
                    ends.push((from, to));
                }
                None => couplings.push((of, vec![planned], vec![(from, to)])),
            }
        }
        let couplings = couplings.into_iter();
        couplings.filter_map(|(_, branches, ends)| self.coupling(branches, &ends, &names)).collect()
    }

    /// Whether the numbers of a branch can be, and its points are those of others.
    fn branch_is_sound(&mut self, planned: &Planned, all: &[Planned]) -> bool {
        let (spec, branch, _) = planned;
        let what = format!("circuit \"{}\"", spec.id);
        let before = self.problems.len();
        let mut range = |field: &'static str, value: f64, fits: bool, requirement: &str| {
            if !fits || !value.is_finite() {
                let message = format!("{field} = {value} {requirement}");
                self.problems.push(refused(&what, &spec.place, Some(field), &message));
            }
        };
        if let Some(resistance) = branch.resistance {
            range("resistance", resistance, resistance > 0.0, "must be positive");
        }
        let share = |value: f64| (0.0..=1.0).contains(&value);
        let between = "must lie between 0 and 1";
        range("idle_opening", branch.idle_opening, share(branch.idle_opening), between);
        range("suction", branch.suction, share(branch.suction), between);
        if branch.from == branch.to {
            let message = format!("{what}: begins and ends in \"{}\"", branch.from);
            let hint = "leave from and to out: it is closed in itself";
            self.report(message, spec.place.of("to"), Some(hint.into()));
        }
        for (field, point) in [("from", &branch.from), ("to", &branch.to)] {
            let ends = |other: &BranchSpec| other.from == *point || other.to == *point;
            if !all.iter().any(|(other, branch, _)| other.id != spec.id && ends(branch)) {
                let others = all.iter().filter(|(other, ..)| other.id != spec.id);
                let names = others.flat_map(|(_, b, _)| [b.from.as_str(), b.to.as_str()]);
                let hint = did_you_mean(point, names)
                    .unwrap_or_else(|| "another circuit has to begin or end there".to_owned());
                let message = format!("{what}: no other circuit meets it in \"{point}\"");
                self.report(message, spec.place.of(field), Some(hint));
            }
        }
        self.problems.len() == before
    }

    fn coupling(
        &mut self,
        branches: Vec<Planned>,
        ends: &[(usize, usize)],
        names: &[&SmolStr],
    ) -> Option<PlannedCoupling> {
        // Points of this coupling by their order.
        let mut points: Vec<usize> = ends.iter().flat_map(|(from, to)| [*from, *to]).collect();
        points.sort_unstable();
        points.dedup();
        let of = |point: usize| points.iter().position(|known| *known == point).unwrap_or_default();
        let pumped = |planned: &Planned| {
            planned.2.circuit.driver.is_some() || planned.0.v_flow_m3_s.is_some()
        };
        let first = branches[0].0;
        let place = first.place.clone();
        let what = format!("circuit \"{}\"", first.id);
        let members: usize = branches.iter().map(|(.., c)| c.circuit.members.len()).sum();
        for (count, most, of_what) in [
            (points.len(), MOST_POINTS, "points"),
            (branches.len(), MOST_BRANCHES, "circuits"),
            (members, MOST_MEMBERS, "ports"),
        ] {
            if count > most {
                let message = format!("{what}: meets others with {count} {of_what} in all");
                let hint = format!("at most {most} can meet: leave circuits closed in themselves");
                self.report(message, place.of("from"), Some(hint));
                return None;
            }
        }
        let passive = branches.iter().zip(ends).filter(|(planned, _)| !pumped(planned));
        let passive: Vec<_> = passive.map(|(_, (from, to))| (of(*from), of(*to))).collect();
        let joined = united(points.len(), &passive);
        if let Some(apart) = joined.iter().position(|of| *of != 0) {
            let (a, b) = (names[points[0]], names[points[apart]]);
            let message = format!(
                "{what}: no circuit without a pump takes the difference between \"{a}\" and \"{b}\""
            );
            let hint = format!(
                "add the port of a storage: through = [\"storage.charge\"], from = \"{a}\", to = \"{b}\""
            );
            self.report(message, place.of("from"), Some(hint));
            return None;
        }
        let coupled = branches.iter().zip(ends).map(|(planned, (from, to))| {
            let (_, branch, circuit) = planned;
            let default = if pumped(planned) { OF_PUMPED } else { 1.0 };
            Branch {
                from: of(*from),
                to: of(*to),
                members: circuit.circuit.members.clone(),
                pumped: pumped(planned),
                resistance: branch.resistance.unwrap_or(default),
                idle_opening: branch.idle_opening,
                suction: branch.suction,
                throttled: branch.throttled,
                check_valve: branch.check_valve,
            }
        });
        let coupling = Coupling { points: points.len(), branches: coupled.collect() };
        let circuits = branches.into_iter().map(|(.., circuit)| circuit).collect();
        Some(PlannedCoupling { circuits, coupling })
    }
}
