//! REGISTRY of what may be missing: adding a group of effects is one file, its `mod` line and its line below.
//!
//! Ranges are 95 % ranges of what is physically plausible. A tolerance is the same quantity within what the
//! accuracy class of the sensor or the knowledge of the component allows; where its effect is tried, the wide range
//! takes the place of the tolerance.

mod hydraulics;
mod pipes;
mod seen;
mod sensors;
mod tolerance;
mod units;

pub(crate) use seen::Use;
pub(crate) use sensors::LAG_S;

use crate::experiment::Experiment;
use crate::unknown::{Target, Unknown};

/// What lies within so many standard deviations of a tolerance belongs to it.
const TOLERATED: f64 = 2.0;

/// A group of effects.
struct Group {
    /// Adds the effects that may be missing from the model of an experiment.
    candidates: fn(&Experiment, &mut Vec<Candidate>),
    /// Adds what is always uncertain.
    tolerances: fn(&Experiment, &mut Vec<Unknown>),
}

const GROUPS: &[Group] = &[
    Group { candidates: pipes::candidates, tolerances: pipes::tolerances },
    Group { candidates: hydraulics::candidates, tolerances: hydraulics::tolerances },
    Group { candidates: units::candidates, tolerances: units::tolerances },
    Group { candidates: sensors::candidates, tolerances: sensors::tolerances },
];

/// An effect at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Word of the catalogue.
    pub id: &'static str,
    /// Component of the model, or column of a sensor.
    pub component: String,
    /// What it is, in words.
    pub words: &'static str,
    /// Its parameter, and the unit of it.
    pub parameter: (&'static str, &'static str),
    /// The parameter with its range.
    pub unknown: Unknown,
    /// What else of it is not known.
    pub beside: Vec<Unknown>,
    /// The tolerance of the quantity, standard deviation of the coordinate, and its middle; none where a neutral
    /// value is far from any plausible one.
    pub tolerance: Option<(f64, f64)>,
    /// Coordinate beyond which readings rule it out.
    pub most: f64,
    /// What would tell it from others.
    pub separates: &'static str,
}

impl Candidate {
    /// An `[[effect]]` of the model file with one parameter (name and unit); `range` is its prior.
    pub(crate) fn effect(
        id: &'static str,
        component: &str,
        words: &'static str,
        parameter: (&'static str, &'static str),
        range: impl FnOnce(Target) -> Unknown,
        separates: &'static str,
    ) -> Self {
        let unknown = range(effect_target(id, component, parameter.0));
        let component = component.to_owned();
        let (beside, tolerance) = (Vec::new(), None);
        let most = f64::INFINITY;
        Self { id, component, words, parameter, unknown, beside, tolerance, most, separates }
    }

    /// The quantity is uncertain by so much (middle and standard deviation of the coordinate) without the effect too.
    #[must_use]
    pub(crate) fn tolerated(self, middle: f64, sd: f64) -> Self {
        Self { tolerance: Some((middle, sd)), ..self }
    }

    /// A further parameter of the effect is fitted beside.
    #[must_use]
    pub(crate) fn with(
        mut self,
        field: &'static str,
        range: impl FnOnce(Target) -> Unknown,
    ) -> Self {
        self.beside.push(range(effect_target(self.id, &self.component, field)));
        self
    }

    /// Whether an unknown is one of its parameters.
    pub(crate) fn owns(&self, unknown: &Unknown) -> bool {
        self.beside.iter().chain([&self.unknown]).any(|own| own.target == unknown.target)
    }

    /// Whether its parameter is fitted as a tolerance.
    pub(crate) fn is_fitted(&self, tolerances: &[Unknown]) -> bool {
        tolerances.iter().any(|tolerance| tolerance.target == self.unknown.target)
    }

    /// The value of its parameter at which it is none; nothing where there is no such value, or where further parameters make it one too.
    pub(crate) fn neutral(&self) -> Option<f64> {
        let with_others = |beside: &Unknown| matches!(beside.target, Target::Effect { .. });
        let unknown = &self.unknown;
        let coordinate = match (self.tolerance, unknown.logarithmic) {
            _ if self.beside.iter().any(with_others) => None,
            (Some((middle, _)), _) => Some(middle),
            (None, false) => Some(unknown.mean),
            (None, true) => self.parameter.0.ends_with("factor").then_some(0.0),
        };
        coordinate.map(|at| unknown.value(at))
    }

    /// A coordinate with the strength of the effect times `a`.
    pub(crate) fn scaled(&self, coordinate: f64, a: f64) -> f64 {
        let unknown = &self.unknown;
        let middle = match (self.tolerance, unknown.logarithmic) {
            (Some((middle, _)), _) => middle,
            (None, false) => unknown.mean,
            // A factor is neutral at 1.
            (None, true) if self.parameter.0.ends_with("factor") => 0.0,
            // Any other strength that spans decades at 0.
            (None, true) => {
                return (coordinate + a.max(1e-3).ln()).max(unknown.mean - 3.0 * unknown.sd);
            }
        };
        middle + a * (coordinate - middle)
    }

    /// Whether a fitted coordinate is no more than the tolerance of its quantity.
    pub fn within(&self, coordinate: f64) -> bool {
        self.tolerance.is_some() && self.strain(coordinate) < TOLERATED
    }

    /// Whether a first guess is clearly within it: a fit, in which other tolerances need not stand for it, may find twice as much.
    pub(crate) fn well_within(&self, coordinate: f64) -> bool {
        self.tolerance.is_some() && self.strain(coordinate) < 0.5 * TOLERATED
    }

    /// Whether a fitted strength is less than what is looked for: below the 95 % range of one that spans decades and has no tolerance.
    fn weak(&self, coordinate: f64) -> bool {
        let of_strength = self.unknown.logarithmic && !self.parameter.0.ends_with("factor");
        let least = self.unknown.mean - 1.96 * self.unknown.sd;
        self.tolerance.is_none() && of_strength && coordinate < least
    }

    /// Whether a fitted strength, and the lower end of its interval, is one that readings rule out, or less than what is looked for.
    pub fn refuted(&self, coordinate: f64, lo: f64) -> bool {
        lo > self.most || self.weak(coordinate)
    }

    /// How far a fitted coordinate lies outside of what is plausible without the effect or, where there is no
    /// tolerance, of the range of the effect; in standard deviations.
    pub fn strain(&self, coordinate: f64) -> f64 {
        let (middle, sd) = self.tolerance.unwrap_or((self.unknown.mean, self.unknown.sd));
        (coordinate - middle).abs() / sd
    }
}

/// A parameter of an effect of the model file.
pub(crate) fn effect_target(id: &'static str, component: &str, field: &'static str) -> Target {
    Target::Effect { id, component: component.to_owned(), field }
}

/// Whether a compared sensor measures in this SI unit: `k`, `pa`, `kg_s`, ...
pub(crate) fn sensed(experiment: &Experiment, si: &str) -> bool {
    use crate::sensors::Role;
    let mut compared = experiment.sensors.sensor.iter().filter(|s| s.role == Role::Compare);
    compared.any(|sensor| sensor.si() == si)
}

/// Length of the longest run, s.
pub(crate) fn longest_s(experiment: &Experiment) -> f64 {
    experiment.runs.iter().map(|run| run.span_s.1 - run.span_s.0).fold(0.0, f64::max)
}

/// Whether the model has the effect already.
pub(crate) fn has(experiment: &Experiment, id: &str, component: &str) -> bool {
    let mut effects = experiment.model.effects.iter();
    let mut of_sensors = experiment.sensors.effect.iter();
    effects.any(|effect| effect.params.kind() == id && effect.component == component)
        || of_sensors.any(|effect| effect.id == id && effect.component == component)
}

/// Quantities that are always uncertain.
pub fn tolerances(experiment: &Experiment) -> Vec<Unknown> {
    let mut all = Vec::new();
    for group in GROUPS {
        (group.tolerances)(experiment, &mut all);
    }
    all
}

/// The effects that may be missing.
pub fn candidates(experiment: &Experiment) -> Vec<Candidate> {
    let mut all = Vec::new();
    for group in GROUPS {
        (group.candidates)(experiment, &mut all);
    }
    all.retain(|candidate| !has(experiment, candidate.id, &candidate.component));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strength_below_its_range_is_weak() {
        let of = |parameter, range: fn(Target) -> Unknown| {
            Candidate::effect("T3", "storage", "", (parameter, "m"), range, "")
        };
        let depth = of("depth_m", |target| Unknown::between(target, 0.03, 0.4));
        let weak = |candidate: &Candidate| [0.016_f64, 0.031].map(|x| candidate.weak(x.ln()));
        assert_eq!(weak(&depth), [true, false]);
        // A tolerance has its own measure, and a factor is neutral at 1.
        assert_eq!(weak(&depth.tolerated(0.1_f64.ln(), 0.1)), [false, false]);
        assert_eq!(weak(&of("factor", |target| Unknown::between(target, 0.03, 0.4))), [false; 2]);
    }

    #[test]
    fn every_effect_that_can_be_none_says_where() {
        let of = |id| {
            let mut all = candidates(&crate::bench::experiment(&[])).into_iter();
            all.find(|c| c.id == id).unwrap().neutral()
        };
        // A wall, a lag and dispersion are strengths that span decades.
        assert_eq!(["P1", "P7"].map(of), [None; 2]);
        assert_eq!(["P2", "P10", "S2"].map(of), [Some(1.0); 3]);
        assert_eq!(["P3", "P6", "S1", "S3", "S7", "S8"].map(of), [Some(0.0); 6]);
    }

    #[test]
    fn readings_and_class_bound_the_flaws_of_sensors() {
        // The flow of the bench is nothing for two minutes, so that its meter does not read too much at no flow.
        let all = candidates(&crate::bench::experiment(&[]));
        let of = |id, component: &str| {
            let mut own = all.iter().filter(|c| c.id == id && c.component == component);
            own.next().unwrap()
        };
        let offset = of("S8", "flow");
        assert!(offset.refuted(0.005, 0.003) && !offset.refuted(-0.005, -0.007));
        // The largest one that they allow is in the interval.
        assert!(!offset.refuted(0.005, -0.001));
        // A drift of 0.3 K may be one of the model, also of a sensor of 0.1 K.
        let drift = of("S3", "T_house");
        assert!(drift.within(-0.3) && !drift.within(-0.5));
    }

    #[test]
    fn a_lag_of_an_input_that_nobody_knows_is_a_tolerance() {
        let experiment = crate::bench::experiment(&[]);
        let (inlet, flow) = (0, 1);
        let all = tolerances(&experiment);
        let late = |i| all.iter().find(|u| u.target == Target::Clock(i));
        assert_eq!((late(inlet).unwrap().mean, late(inlet).unwrap().sd), (0.0, 1.5));
        assert_eq!(late(flow), None);
        // It is what the plant gets: a front that is read 4 s late enters 4 s before.
        let late = [Unknown::plain(Target::Clock(inlet), 0.0, 1.5)];
        let [now, before] = [0.0, 4.0].map(|x| experiment.readings(&late, &[x]).unwrap());
        let rises = now.iter().zip(&before).map(|(now, before)| (now - before).abs());
        assert!(rises.fold(0.0, f64::max) > 0.3);
    }
}
