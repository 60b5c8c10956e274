//! Effects of houses: storages, generators, circuits that meet.

use super::tolerance::Known;
use super::{Candidate, effect_target, has, longest_s, sensed};
use crate::experiment::Experiment;
use crate::sensors::Sensor;
use crate::unknown::{Target, Unknown};
use anergy_prosumer::equipment::EquipmentParams;
use serde_json::Value;

/// Least share of a jet that is looked for: a storage in layers is off by as much where nothing is hidden (0.055 to 0.12 in five nulls).
const JET: f64 = 0.1;
/// What the efficiency at part load may be off without an effect over what each load of it may be.
const PART: f64 = 2.0;

pub(super) fn tolerances(experiment: &Experiment, all: &mut Vec<Unknown>) {
    let (warm, power) = (sensed(experiment, "k"), sensed(experiment, "w"));
    let known = Known::of(experiment);
    for unit in &experiment.model.units {
        let (component, kind) = (unit.id.as_str(), unit.params.kind());
        if kind == BOILER && warm {
            let [capacity, conductance] = metal(&unit.params.to_value(), &known);
            for (field, (middle, sd)) in
                [("capacity_j_k", capacity), ("conductance_w_k", conductance)]
            {
                if !has(experiment, "G7", component) {
                    all.push(around(effect_target("G7", component, field), middle, sd));
                }
            }
        }
        let mut add = |id: &'static str, field: &'static str, sd: f64, declared: Option<f64>| {
            if !has(experiment, id, component) {
                let factor = Unknown::plain(effect_target(id, component, field), 0.0, sd);
                all.push(Unknown { logarithmic: true, ..factor.limited(declared.is_some()) });
            }
        };
        if kind == "storage" && warm {
            let loss = loss_of(experiment, &known, &unit.params);
            add("T1", "factor", loss, known.declared.storage_loss);
            // How layers mix has no limits.
            add("T2", "factor", known.storage_mixing, None);
        }
        if power && is_generator(kind) {
            add("G1", "factor", known.efficiency, known.declared.efficiency);
            add("G3", "time_factor", known.start, known.declared.start);
        }
        if power && kind == AIR_SOURCE {
            for field in ["factor_20", "factor_40", "factor_60"] {
                add("G2", field, known.part_load, known.declared.part_load);
            }
        }
    }
}

/// Heat loss of a storage, relative.
fn loss_of(experiment: &Experiment, known: &Known, params: &EquipmentParams) -> f64 {
    match params {
        EquipmentParams::Storage(storage) => known.loss_of(storage, longest_s(experiment)),
        _ => known.storage_loss,
    }
}

/// A positive quantity around its middle, by its logarithm.
fn around(target: Target, middle: f64, sd: f64) -> Unknown {
    Unknown { logarithmic: true, ..Unknown::plain(target, middle.ln(), sd) }
}

/// Metal of a boiler that its model does not have: capacity, J/K, and conductance to the water, W/K, and the standard deviations of
/// their logarithms. As much as follows the return behind the time that is tolerated at a flow for 20 K.
fn metal(boiler: &Value, known: &Known) -> [(f64, f64); 2] {
    let nominal_w = boiler["nominal_w"].as_f64().unwrap_or(MEASURED_W);
    let conductance_w_k = boiler["metal_conductance_w_k"].as_f64().unwrap_or(100.0);
    let capacity_j_k = known.outlet_lag_s * nominal_w / SPREAD_K;
    [(capacity_j_k, 1.0), (conductance_w_k * nominal_w / MEASURED_W, 0.7)]
}

/// Difference of supply and return for which a flow is made, K.
const SPREAD_K: f64 = 20.0;
/// Nominal heat of the boiler whose data are the default ones, W.
const MEASURED_W: f64 = 14_000.0;

/// Whether a sensor measures the temperature of the water that leaves a generator of whose metal nothing else is known.
pub(super) fn at_outlet(experiment: &Experiment, sensor: &Sensor) -> bool {
    let mut units = experiment.model.units.iter();
    let own = units.find(|unit| {
        let of_unit = sensor.signal.strip_prefix(unit.id.as_str());
        of_unit.is_some_and(|rest| [".t_supply_k", ".water.t_out_k"].contains(&rest))
    });
    own.is_some_and(|unit| is_generator(unit.params.kind()) && unit.params.kind() != BOILER)
}

fn is_generator(kind: &str) -> bool {
    BURNERS.contains(&kind) || kind == AIR_SOURCE
}

pub(super) fn candidates(experiment: &Experiment, all: &mut Vec<Candidate>) {
    let (warm, power) = (sensed(experiment, "k"), sensed(experiment, "w"));
    let known = Known::of(experiment);
    for unit in &experiment.model.units {
        let id = unit.id.as_str();
        let kind = unit.params.kind();
        if kind == "storage" && warm {
            let written = unit.params.to_value();
            let [height_m, layers] = ["height_m", "layers"].map(|name| written[name].as_f64());
            let layer_m = height_m.zip(layers).map_or(0.0, |(height_m, layers)| height_m / layers);
            let loss = loss_of(experiment, &known, &unit.params);
            of_storage(id, &known, loss, layer_m, all);
        }
        if power && is_generator(kind) {
            of_generator(id, &known, all);
        }
        if kind == BOILER && warm {
            let [(middle, sd), (conductance_w_k, _)] = metal(&unit.params.to_value(), &known);
            let more = Candidate::effect(
                "G7",
                id,
                "metal of the generator",
                ("capacity_j_k", "J/K"),
                |target| Unknown::between(target, 2000.0, 300_000.0),
                "starts after pauses of different length and with another return temperature",
            );
            let conductance = |target| around(target, conductance_w_k, 0.7);
            all.push(more.tolerated(middle.ln(), sd).with("conductance_w_k", conductance));
        }
        if kind == AIR_SOURCE {
            if power {
                all.push(factor("G6", id, "power of the auxiliary heater", (0.7, 1.3), AUX));
            }
            if unit.params.to_value()["defrost"] == false && (warm || power) {
                all.push(Candidate::effect(
                    "G4",
                    id,
                    "de-icing",
                    ("heat_w", "W"),
                    |target| Unknown::between(target, 1000.0, 10_000.0),
                    "the heat over some hours of operation in cold air",
                ));
            }
        }
    }
    for circuit in &experiment.model.circuits {
        let pumped = circuit.v_flow_m3_s.is_some() || feeds(experiment, &circuit.through);
        let Some(branch) = circuit.branch.as_ref().filter(|_| pumped && warm) else { continue };
        if branch.idle_opening == 0.0 {
            all.push(Candidate::effect(
                "H1",
                &circuit.id,
                "flow through the branch while its pump is off",
                ("opening", "1"),
                |target| Unknown::between(target, 0.01, 1.0),
                "the flow of the branch, or temperatures at both of its ends, while another pump runs",
            ));
        }
        all.push(Candidate::effect(
            "H2",
            &circuit.id,
            "flow that a parallel pump draws through the branch",
            ("share", "1"),
            |target| Unknown::between(target, 0.02, 0.5),
            "the flow of the branch with and without the other pump",
        ));
    }
}

/// Kinds whose pump feeds a circuit.
const PUMPED: &[&str] = &[
    "condensing_boiler",
    "chp",
    "stirling_chp",
    AIR_SOURCE,
    "brine_heat_pump",
    "booster_heat_pump",
];
/// Kinds that burn gas.
const BURNERS: &[&str] = &[BOILER, "chp", "stirling_chp"];
const BOILER: &str = "condensing_boiler";
const AIR_SOURCE: &str = "air_source_heat_pump";
const AUX: &str = "electricity and heat in steps of the heater";

/// Whether a generator of a house feeds a circuit.
fn feeds(experiment: &Experiment, through: &[impl AsRef<str>]) -> bool {
    let generator = |name: &str| {
        let mut units = experiment.model.units.iter();
        let unit = units.find(|unit| name.strip_prefix(unit.id.as_str()).is_some_and(no_more));
        unit.is_some_and(|unit| PUMPED.contains(&unit.params.kind()))
    };
    through.iter().any(|name| generator(name.as_ref()))
}

/// Whether a name of a port ends here or goes on with the port.
fn no_more(rest: &str) -> bool {
    rest.is_empty() || rest.starts_with('.')
}

/// A factor on what the data say.
fn factor(
    id: &'static str,
    component: &str,
    words: &'static str,
    (low, high): (f64, f64),
    separates: &'static str,
) -> Candidate {
    let range = |target| Unknown::between(target, low, high).starting_at(1.0);
    Candidate::effect(id, component, words, ("factor", "1"), range, separates)
}

fn of_storage(id: &str, known: &Known, uncertain: f64, layer_m: f64, all: &mut Vec<Candidate>) {
    let standby = "a day without flow, and the temperature of the room";
    let loss = factor("T1", id, "heat loss of the storage", (0.5, 4.0), standby);
    all.push(loss.tolerated(0.0, uncertain));
    let idle = "hours without flow";
    let mixing = factor("T2", id, "conduction along the height of the storage", (0.05, 20.0), idle);
    all.push(mixing.tolerated(0.0, known.storage_mixing));
    // What is drawn from within a layer is drawn from the layer.
    let least_m = layer_m.clamp(0.02, 0.2);
    all.push(Candidate::effect(
        "T3",
        id,
        "water beyond the ports that takes part",
        ("depth_m", "m"),
        |target| Unknown::between(target, least_m, 0.4),
        "a sensor below the lowest port",
    ));
    all.push(Candidate::effect(
        "T4",
        id,
        "mixing by the jet of an inlet",
        ("share", "1"),
        |target| Unknown::between(target, JET, 1.0),
        "steps of the flow",
    ));
}

fn of_generator(id: &str, known: &Known, all: &mut Vec<Candidate>) {
    let both = "meters on both sides of the energy";
    let level = factor("G1", id, "efficiency of the generator", (0.8, 1.2), both);
    all.push(level.tolerated(0.0, known.efficiency));
    let part = |target| Unknown::between(target, 0.7, 1.3).starting_at(1.0);
    let load = Candidate::effect(
        "G2",
        id,
        "efficiency at part load",
        ("factor_40", "1"),
        part,
        "several loads",
    );
    let load = load.tolerated(0.0, PART * known.part_load);
    all.push(load.with("factor_20", part).with("factor_60", part));
    let start = Candidate::effect(
        "G3",
        id,
        "length of a start",
        ("time_factor", "1"),
        |target| Unknown::between(target, 0.3, 3.0).starting_at(1.0),
        "several starts after pauses of different length",
    );
    all.push(start.tolerated(0.0, known.start));
}
