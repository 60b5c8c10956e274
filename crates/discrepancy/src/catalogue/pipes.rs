//! Effects of pipes.

use super::seen::Seen;
use super::tolerance::Known;
use super::{Candidate, effect_target, has, longest_s, sensed};
use crate::experiment::Experiment;
use crate::unknown::Unknown;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::thermal::WallModel;
use anergy_network::elements::pipe::{Laying, PipeParams};
use anergy_simulation::model::Model;
use std::f64::consts::PI;

/// Heat capacity of water, J/(m3 K).
const WATER_J_M3_K: f64 = 4.1e6;
/// Wall of a pipe whose outer diameter is not known, m.
const WALL_M: f64 = 0.003;

/// Heat loss at rest over that in flow, standard deviation of its logarithm: within 12 %, over the root of 3. One conductance stands for a
/// film, a wall and insulation that differ between rest and flow, and for how exactly a pause is known; runs in which nothing was hidden asked for 1.1 to 1.15.
const STANDSTILL: f64 = 0.0654;
/// The ground answers in hours: a shorter run shows nothing of it, s.
const LONG_S: f64 = 6.0 * 3600.0;
/// A missing piece over the content of the pipe: middle and standard deviation.
const PIECE: (f64, f64) = (0.2, 0.15);

fn pipes(model: &Model) -> impl Iterator<Item = (&str, &PipeParams)> {
    model.edges.iter().filter_map(|edge| match &edge.params {
        ElementParams::Pipe(pipe) => Some((edge.id.as_str(), pipe)),
        _ => None,
    })
}

pub(super) fn tolerances(experiment: &Experiment, all: &mut Vec<Unknown>) {
    let (seen, pressure) = (Seen::new(experiment), shows_friction(experiment));
    let known = Known::of(experiment);
    for (component, pipe) in pipes(&experiment.model) {
        let free = |id| !has(experiment, id, component);
        let moves = |delay, loss| seen.tolerance(component, content_m3(pipe), delay, loss);
        if free("P10") && (pressure || moves(known.length, known.length)) {
            all.push(
                Unknown::plain(effect_target("P10", component, "factor"), 1.0, known.length)
                    .limited(true),
            );
        }
        if free("P2") && moves(0.0, known.loss) {
            let factor = Unknown::plain(effect_target("P2", component, "factor"), 0.0, known.loss)
                .limited(true);
            all.push(Unknown { logarithmic: true, ..factor });
        }
        if free("P5") && sensed(experiment, "k") && seen.rests(component) {
            let factor = Unknown::plain(effect_target("P5", component, "factor"), 0.0, STANDSTILL);
            all.push(Unknown { logarithmic: true, ..factor });
        }
        if pipe.wall == WallModel::Film && free("P1") && moves(known.length, 0.0) {
            let film =
                Unknown::plain(effect_target("P1", component, "film_factor"), 0.0, known.film);
            all.push(Unknown { logarithmic: true, ..film });
        }
        if pressure && free("P8") {
            let factor =
                Unknown::plain(effect_target("P8", component, "factor"), 0.0, known.friction)
                    .limited(true);
            all.push(Unknown { logarithmic: true, ..factor });
        }
        if free("P3") && moves(0.0, Seen::surroundings(known.surroundings_k)) {
            let target = effect_target("P3", component, "difference_k");
            all.push(Unknown::plain(target, 0.0, known.surroundings_k).limited(true));
        }
    }
}

pub(super) fn candidates(experiment: &Experiment, all: &mut Vec<Candidate>) {
    let (heat, pressure) = (sensed(experiment, "k"), shows_friction(experiment));
    let longest_s = longest_s(experiment);
    let (seen, known) = (Seen::new(experiment), Known::of(experiment));
    for (component, pipe) in pipes(&experiment.model) {
        if heat {
            of_heat(&seen, &known, component, pipe, pressure, all);
            if longest_s > LONG_S && lies_alone(&experiment.model, component, pipe) {
                all.push(Candidate::effect(
                    "P4",
                    component,
                    "heat capacity of the ground around the pipe",
                    ("capacity_j_m_k", "J/(m K)"),
                    |target| Unknown::between(target, 1e4, 5e5),
                    "hours at one temperature after a step",
                ));
            }
            if pauses(experiment) && seen.effect(component, content_m3(pipe), 0.5, 0.0) {
                of_missing_piece(&known, component, pipe, all);
            }
        }
        if pressure {
            let friction = Candidate::effect(
                "P8",
                component,
                "pressure loss of the pipe",
                ("factor", "1"),
                |target| Unknown::between(target, 0.5, 5.0).starting_at(1.0),
                "pressure losses at two flow rates",
            );
            all.push(friction.tolerated(0.0, known.friction));
        }
    }
}

/// Whether friction shows: in a pressure difference, or in a flow that is not given.
fn shows_friction(experiment: &Experiment) -> bool {
    ["pa", "kg_s", "m3_s"].iter().any(|si| sensed(experiment, si))
}

/// Whether a measured flow rests at times.
fn pauses(experiment: &Experiment) -> bool {
    let flows = experiment.sensors.sensor.iter().enumerate();
    let mut flows = flows.filter(|(_, sensor)| ["kg_s", "m3_s"].contains(&sensor.si().as_str()));
    flows.any(|(k, _)| experiment.runs.iter().any(|run| run.tracks[k].value.contains(&0.0)))
}

/// Whether the ground around a pipe can be one node: no rings, no companion, a heat loss.
fn lies_alone(model: &Model, component: &str, pipe: &PipeParams) -> bool {
    let beside = |other: &PipeParams| other.companion.as_deref() == Some(component);
    let warms = pipe.insulation_resistance_k_m_w.is_some() || pipe.laying.is_some();
    let alone = pipe.soil_rings.is_none() && pipe.ground_capacity_j_m_k.is_none();
    warms
        && alone
        && pipe.companion.is_none()
        && pipe.spacing_m.is_none()
        && pipe.laying != Some(Laying::Twin)
        && !pipes(model).any(|(_, other)| beside(other))
}

fn content_m3(pipe: &PipeParams) -> f64 {
    0.25 * PI * pipe.inner_diameter_m.powi(2) * pipe.length_m
}

fn of_missing_piece(known: &Known, component: &str, pipe: &PipeParams, all: &mut Vec<Candidate>) {
    let content_m3 = content_m3(pipe);
    let piece = Candidate::effect(
        "P6",
        component,
        "a piece that the plan does not show",
        ("volume_m3", "m3"),
        |target| Unknown::plain(target, PIECE.0 * content_m3, PIECE.1 * content_m3),
        "two flow rates and the pressure loss, or the volume until warm water arrives",
    );
    // Water that is not in the plan is a wrong length.
    all.push(piece.tolerated(0.0, known.length * content_m3));
}

fn of_heat(
    seen: &Seen<'_>,
    known: &Known,
    component: &str,
    pipe: &PipeParams,
    pressure: bool,
    all: &mut Vec<Candidate>,
) {
    let moves = |delay, loss| seen.effect(component, content_m3(pipe), delay, loss);
    let inner_m = pipe.inner_diameter_m;
    let outer_m = pipe.outer_diameter_m.unwrap_or(inner_m + 2.0 * WALL_M);
    let steel = pipe.wall_density_kg_m3 * pipe.wall_heat_capacity_j_kg_k;
    let geometry = steel * 0.25 * PI * (outer_m * outer_m - inner_m * inner_m);
    let of_water = WATER_J_M3_K * 0.25 * PI * inner_m * inner_m;
    if pipe.wall == WallModel::None && moves(1.5 * geometry / of_water, 0.0) {
        let wall = Candidate::effect(
            "P1",
            component,
            "heat stored in the wall of the pipe",
            ("wall_capacity_j_m_k", "J/(m K)"),
            |target| Unknown::between(target, 0.5 * geometry, 1.5 * geometry),
            "several flow rates, or a sensor on the wall of the pipe",
        );
        // Laws of the film differ: 0.5 to 2 of what this one says.
        let film = |target| Unknown::between(target, 0.5, 2.0).starting_at(1.0);
        all.push(wall.with("film_factor", film));
    }
    if moves(0.0, 5.0) {
        of_loss(known, component, all);
    }
    if seen.rests(component) {
        let standstill = Candidate::effect(
            "P5",
            component,
            "heat loss at standstill",
            ("factor", "1"),
            |target| Unknown::between(target, 0.2, 5.0).starting_at(1.0),
            "pauses of several lengths",
        );
        all.push(standstill.tolerated(0.0, STANDSTILL));
    }
    if moves(0.5, 0.0) {
        all.push(Candidate::effect(
            "P7",
            component,
            "axial dispersion",
            ("dispersion_m2_s", "m2/s"),
            |target| Unknown::between(target, 0.01, 2.0),
            "two flow rates",
        ));
    }
    if pressure || moves(0.3, 0.3) {
        let length = Candidate::effect(
            "P10",
            component,
            "length of the pipe",
            ("factor", "1"),
            |target| Unknown::plain(target, 1.0, 0.3 / 1.96),
            "a second flow meter, or the pressure loss",
        );
        all.push(length.tolerated(1.0, known.length));
    }
}

fn of_loss(known: &Known, component: &str, all: &mut Vec<Candidate>) {
    let insulation = Candidate::effect(
        "P2",
        component,
        "insulation",
        ("factor", "1"),
        |target| Unknown::between(target, 0.3, 6.0).starting_at(1.0),
        "two flow rates at two temperatures",
    );
    all.push(insulation.tolerated(0.0, known.loss));
    let surroundings = Candidate::effect(
        "P3",
        component,
        "temperature around the pipe",
        ("difference_k", "K"),
        |target| Unknown::plain(target, 0.0, 10.0 / 1.96),
        "a probe in the ground, or a run of cold and one of hot water",
    );
    all.push(surroundings.tolerated(0.0, known.surroundings_k));
}
