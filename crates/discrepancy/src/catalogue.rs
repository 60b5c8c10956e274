//! What may be missing: the effects that are tried, and the tolerances that are always there.
//!
//! Ranges are 95 % ranges of what is physically plausible. A tolerance is the same quantity within what the
//! accuracy class of the sensor or the knowledge of the pipe allows; where its effect is tried, the wide range
//! takes the place of the tolerance.

use crate::experiment::Experiment;
use crate::sensors::Role;
use crate::unknown::{Target, Unknown};
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::elements::pipe::thermal::WallModel;
use anergy_simulation::model::Model;
use std::f64::consts::PI;

/// Tolerance of the length of a pipe, relative.
const LENGTH: f64 = 0.01;
/// Tolerance of a heat loss, relative.
const LOSS: f64 = 0.08;
/// Tolerance of the temperature around a pipe, K.
const SURROUNDINGS_K: f64 = 0.5;
/// What the first readings may say too little of the water at the start, at least, K.
const FIRST_K: f64 = 0.3;
/// Wall of a pipe whose outer diameter is not known, m.
const WALL_M: f64 = 0.003;

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
    /// What would tell it from others.
    pub separates: &'static str,
}

impl Candidate {
    /// How far a fitted coordinate lies outside of what is plausible without the effect or, where there is no
    /// tolerance, of the range of the effect; in standard deviations.
    pub fn strain(&self, coordinate: f64) -> f64 {
        let (middle, sd) = self.tolerance.unwrap_or((self.unknown.mean, self.unknown.sd));
        (coordinate - middle).abs() / sd
    }
}

/// Quantities that are always uncertain.
pub fn tolerances(experiment: &Experiment) -> Vec<Unknown> {
    let mut unknowns = Vec::new();
    for (i, accuracy) in experiment.accuracy.iter().enumerate() {
        if accuracy.bias > 0.0 {
            unknowns.push(Unknown::plain(Target::Bias(i), 0.0, accuracy.bias));
        }
        if accuracy.gain > 0.0 {
            unknowns.push(Unknown::plain(Target::Gain(i), 1.0, accuracy.gain));
        }
    }
    for run in 0..experiment.runs.len() {
        if let Some((_, far_k)) = experiment.first_k(run) {
            unknowns.push(Unknown::plain(Target::Initial(run), 0.0, far_k.max(FIRST_K)));
        }
    }
    for (component, _) in pipes(&experiment.model) {
        let target = |id, field| Target::Effect { id, component: component.to_owned(), field };
        let free = |id| !has(&experiment.model, id, component);
        if free("P10") {
            unknowns.push(Unknown::plain(target("P10", "factor"), 1.0, LENGTH));
        }
        if free("P2") {
            let factor = Unknown::plain(target("P2", "factor"), 0.0, LOSS);
            unknowns.push(Unknown { logarithmic: true, ..factor });
        }
        if free("P3") {
            unknowns.push(Unknown::plain(target("P3", "difference_k"), 0.0, SURROUNDINGS_K));
        }
    }
    unknowns
}

/// The effects that may be missing.
pub fn candidates(experiment: &Experiment) -> Vec<Candidate> {
    let mut all = Vec::new();
    let sensed = |si: &str| {
        let compared = experiment.sensors.sensor.iter().filter(|s| s.role == Role::Compare);
        compared.into_iter().any(|sensor| sensor.si() == si)
    };
    for (component, pipe) in pipes(&experiment.model) {
        of_pipe(component, pipe, sensed("k"), sensed("pa"), &mut all);
    }
    for candidate in all.iter_mut().filter(|candidate: &&mut Candidate| candidate.id == "P1") {
        // Laws of the film differ: 0.5 to 2 of what this one says.
        let (id, component, field) = ("P1", candidate.component.clone(), "film_factor");
        let target = Target::Effect { id, component, field };
        candidate.beside.push(Unknown::between(target, 0.5, 2.0).starting_at(1.0));
    }
    all.retain(|candidate: &Candidate| !has(&experiment.model, candidate.id, &candidate.component));
    for (i, sensor) in experiment.sensors.sensor.iter().enumerate() {
        of_sensor(experiment, i, &sensor.column, &sensor.si(), sensor.role, &mut all);
    }
    all
}

fn of_pipe(
    component: &str,
    pipe: &PipeParams,
    heat: bool,
    pressure: bool,
    all: &mut Vec<Candidate>,
) {
    let mut add = |id,
                   words,
                   parameter: (&'static str, &'static str),
                   build: &dyn Fn(Target) -> Unknown,
                   tolerance,
                   separates| {
        let target = Target::Effect { id, component: component.to_owned(), field: parameter.0 };
        let unknown = build(target);
        all.push(Candidate {
            id,
            component: component.to_owned(),
            words,
            parameter,
            unknown,
            beside: Vec::new(),
            tolerance,
            separates,
        });
    };
    let inner_m = pipe.inner_diameter_m;
    let outer_m = pipe.outer_diameter_m.unwrap_or(inner_m + 2.0 * WALL_M);
    let steel = pipe.wall_density_kg_m3 * pipe.wall_heat_capacity_j_kg_k;
    let geometry = steel * 0.25 * PI * (outer_m * outer_m - inner_m * inner_m);
    if heat && pipe.wall == WallModel::None {
        add(
            "P1",
            "heat stored in the wall of the pipe",
            ("wall_capacity_j_m_k", "J/(m K)"),
            &|target| Unknown::between(target, 0.5 * geometry, 1.5 * geometry),
            None,
            "several flow rates, or a sensor on the wall of the pipe",
        );
    }
    if heat {
        add(
            "P2",
            "insulation",
            ("factor", "1"),
            &|target| Unknown::between(target, 0.3, 6.0).starting_at(1.0),
            Some((0.0, LOSS)),
            "two flow rates at two temperatures",
        );
        add(
            "P3",
            "temperature around the pipe",
            ("difference_k", "K"),
            &|target| Unknown::plain(target, 0.0, 10.0 / 1.96),
            Some((0.0, SURROUNDINGS_K)),
            "a probe in the ground, or a run of cold and one of hot water",
        );
        add(
            "P5",
            "heat loss at standstill",
            ("factor", "1"),
            &|target| Unknown::between(target, 0.2, 5.0),
            None,
            "pauses of several lengths",
        );
        add(
            "P7",
            "axial dispersion",
            ("dispersion_m2_s", "m2/s"),
            &|target| Unknown::between(target, 0.01, 2.0),
            None,
            "two flow rates",
        );
        add(
            "P10",
            "length of the pipe",
            ("factor", "1"),
            &|target| Unknown::plain(target, 1.0, 0.3 / 1.96),
            Some((1.0, LENGTH)),
            "a second flow meter, or the pressure loss",
        );
    }
    if pressure {
        add(
            "P8",
            "pressure loss of the pipe",
            ("factor", "1"),
            &|target| Unknown::between(target, 0.5, 5.0).starting_at(1.0),
            None,
            "pressure losses at two flow rates",
        );
    }
}

fn of_sensor(
    experiment: &Experiment,
    i: usize,
    column: &str,
    si: &str,
    role: Role,
    all: &mut Vec<Candidate>,
) {
    let accuracy = experiment.accuracy[i];
    let mut add = |id, words, parameter, unknown, tolerance, separates| {
        let component = column.to_owned();
        let beside = Vec::new();
        all.push(Candidate {
            id,
            component,
            words,
            parameter,
            unknown,
            beside,
            tolerance,
            separates,
        });
    };
    if si == "k" {
        add(
            "S1",
            "offset of the sensor",
            ("bias_k", "K"),
            Unknown::plain(Target::Bias(i), 0.0, 5.0 / 1.96),
            Some((0.0, accuracy.bias)),
            "a comparison at standstill, when all sensors have one temperature",
        );
    } else {
        add(
            "S2",
            "gain of the sensor",
            ("gain", "1"),
            Unknown::plain(Target::Gain(i), 1.0, 0.2 / 1.96),
            Some((1.0, accuracy.gain.max(1e-3))),
            "a second meter of the same quantity",
        );
    }
    if role == Role::Compare {
        add(
            "S4",
            "slow sensor",
            ("lag_s", "s"),
            Unknown::between(Target::Lag(i), 2.0, 180.0),
            None,
            "two flow rates: the lag of a sensor is the same in both",
        );
        add(
            "S7",
            "clock of the sensor",
            ("clock_s", "s"),
            Unknown::plain(Target::Clock(i), 0.0, 60.0 / 1.96),
            Some((0.0, 1.0)),
            "two flow rates: the shift of a clock is the same in both",
        );
    }
}

fn pipes(model: &Model) -> impl Iterator<Item = (&str, &PipeParams)> {
    model.edges.iter().filter_map(|edge| match &edge.params {
        ElementParams::Pipe(pipe) => Some((edge.id.as_str(), pipe)),
        _ => None,
    })
}

/// Whether the model has the effect already.
fn has(model: &Model, id: &str, component: &str) -> bool {
    model.effects.iter().any(|effect| effect.params.kind() == id && effect.component == component)
}
