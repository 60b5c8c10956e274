//! Flushing against the cold plug: before a feeder starts, hot water of the others replaces what has cooled in its pipe.
//!
//! **Method** the model is run as it is, over the first start of a feeder that its schedules make: pipes that stood and flow
//! a minute later are its dead leg. A consumer has cold water while what arrives is more than 5 K colder than just
//! before the start. Then the same run with a bypass at the end of the dead leg, open for as long before the start as its
//! content takes: with no more than half of what the consumers had, and where a feeder beside it delivers a given
//! flow, with that flow raised by what the bypass takes. Time with cold water and heat of the consumers decide.
//! **Assumptions** the bypass passes its flow whatever the pressures are; the valve that does so is named where they let one.
//! **Validity** starts within [`LONGEST_S`], in schedules of flows and speeds; sites with a hot and a cold node.
//! **Sources** specification 4.3 (c), SC-02, `zinsmeister2023`.

use super::advise::{Advice, Outcome};
use crate::build::build;
use crate::error::RunError;
use crate::model::{DriverSpec, Model, Place};
use crate::model_file::Interpolation;
use crate::overlay::Change;
use crate::plan::Plan;
use crate::simulation::Simulation;
use anergy_core::clock::Time;
use anergy_network::elements::ElementParams;
use anergy_network::elements::flow_source::FlowSourceParams;
use anergy_network::graph::Network;
use anergy_network::state::NetworkState;
use anergy_network::two_port::EdgeThermal;
use anergy_prosumer::equipment::EquipmentParams;
use std::collections::BTreeMap;

/// Starts later than this are not looked at, s, nor after more steps.
const LONGEST_S: f64 = 12.0 * 3600.0;
const MOST_STEPS: f64 = 50_000.0;
/// Water is cold when it is this much below that before the start, K, for longer than this, s.
const COLD_K: f64 = 5.0;
const SHORT_S: f64 = 60.0;
/// After this the flows of a start are there, s; what had less than this share of them before stood still.
const AWAKE_S: f64 = 60.0;
const STOOD: f64 = 0.02;
/// Share of the consumers' flow that a flush takes, and by how much more than its content a pipe is flushed.
const TAKEN: f64 = 0.5;
const MORE: f64 = 1.05;
/// A run goes on for this time after the start, s, and for this many times what the dead leg takes to pass.
const AFTER_S: f64 = 900.0;
const PASSES: f64 = 3.0;
/// What is left of the time with cold water where a flush helps, and where it helps in part.
const HELPS: f64 = 0.25;
const IN_PART: f64 = 0.75;
/// Heat of the consumers that counts as less.
const LESS: f64 = 1e-3;

/// A feeder that starts into pipes that stood still.
struct Start {
    time_s: f64,
    /// Its site, and the nodes of the site between which it feeds.
    site: String,
    hot: String,
    cold: String,
    m_flow_kg_s: f64,
    /// Water of its dead leg.
    content_kg: f64,
    /// What the consumers had before.
    consumers_kg_s: f64,
    /// Temperature of what arrived at each station that took heat, K.
    arriving_k: Vec<(usize, f64)>,
}

/// What a run over a start showed.
struct Followed {
    outcome: Outcome,
    /// Heat that the consumers took, J.
    heat_j: f64,
    /// Pressure difference over the bypass while it is open, Pa.
    bypass_pa: Option<f64>,
}

/// A flush that is tried.
struct Flush {
    remedy: &'static str,
    changes: Vec<Change>,
    said: Vec<String>,
    bypass: String,
    m_flow_kg_s: f64,
}

/// How long consumers have cold water, s, by station; and what was tried against it.
type ColdAndAdvice = (BTreeMap<String, f64>, Vec<Advice>);

/// Tries to flush the pipe of the first feeder whose start sends cold water to consumers: how long they have it, and the
/// remedies; `None` where no start does.
pub(super) fn advise(model: &Model) -> Result<Option<ColdAndAdvice>, RunError> {
    for time_s in starts_s(model) {
        let Some(start) = start(model, time_s)? else { continue };
        let before = follow(model, &start, None)?;
        if longest_s(&before.outcome.cold_s) <= SHORT_S {
            continue;
        }
        let flushes = [flush(model, &start), fed_flush(model, &start)?];
        let advice =
            flushes.into_iter().flatten().map(|flush| tried(model, &start, flush, &before));
        let advice = advice.collect();
        return Ok(Some((before.outcome.cold_s, advice)));
    }
    Ok(None)
}

/// Times at which a scheduled flow or speed rises from zero, s.
fn starts_s(model: &Model) -> Vec<f64> {
    let drives = |driver: &&DriverSpec| {
        [".v_flow_m3_s", ".m_flow_set_kg_s", ".speed"].iter().any(|of| driver.signal.ends_with(of))
    };
    let mut starts: Vec<f64> = Vec::new();
    for driver in model.drivers.iter().filter(drives) {
        let rises = (1..driver.values.len())
            .find(|&k| driver.values[k - 1] <= 0.0 && driver.values[k] > 0.0);
        starts.extend(rises.map(|k| match driver.interpolation {
            Interpolation::Linear => driver.times_s[k - 1],
            _ => driver.times_s[k],
        }));
    }
    starts.retain(|time_s| (0.0..=LONGEST_S).contains(time_s));
    starts.sort_by(f64::total_cmp);
    starts.dedup();
    starts
}

fn time(time_s: f64) -> Time {
    Time::from_s(time_s).unwrap_or(Time::ZERO)
}

/// The feeder that starts at a time, with its dead leg.
fn start(model: &Model, time_s: f64) -> Result<Option<Start>, RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    let plan = simulation.plan().clone();
    let step = plan.stepping();
    if time_s > MOST_STEPS * plan.step().as_s() {
        return Ok(None);
    }
    simulation.advance_to(time(time_s), step)?;
    let stood = simulation.state().network.clone();
    simulation.advance_to(time(time_s + AWAKE_S), step)?;
    let awake = &simulation.state().network;
    let woke = |edge: usize| {
        let (before, now) = (stood.m_flow_kg_s[edge].abs(), awake.m_flow_kg_s[edge].abs());
        now > 0.0 && before < STOOD * now
    };
    let feeds = |edge: usize| woke(edge) && awake.m_flow_kg_s[edge] > 0.0;
    let Some(station) = plan.stations.iter().find(|station| feeds(station.edge.index())) else {
        return Ok(None);
    };
    let edge = station.edge.index();
    let network = plan.network();
    let (out, content_kg) = dead_leg(&plan, awake, &woke, edge, true);
    let (back, _) = dead_leg(&plan, awake, &woke, edge, false);
    let site_node = |nodes: &[usize]| nodes.iter().find_map(|&node| site_of(&plan, node));
    let Some(((site, hot), (other, cold))) = site_node(&out).zip(site_node(&back)) else {
        return Ok(None);
    };
    let takes = |station: &&(usize, usize)| stood.q_flow_w[station.1] < 0.0;
    let stations: Vec<(usize, usize)> =
        plan.stations.iter().enumerate().map(|(i, s)| (i, s.edge.index())).collect();
    let consumers: Vec<&(usize, usize)> = stations.iter().filter(takes).collect();
    let found = Start {
        time_s,
        site,
        hot,
        cold,
        m_flow_kg_s: awake.m_flow_kg_s[edge],
        content_kg,
        consumers_kg_s: consumers.iter().map(|(_, edge)| stood.m_flow_kg_s[*edge].abs()).sum(),
        arriving_k: consumers
            .iter()
            .map(|(i, edge)| (*i, arriving_k(network, &stood, *edge)))
            .collect(),
    };
    let fits = found.site == other && content_kg > 0.0 && !found.arriving_k.is_empty();
    Ok(fits.then_some(found))
}

/// Nodes from the end of an edge along what stood still, with or against the flow, and the water of the pipes between the
/// first that is one of a site and the last.
fn dead_leg(
    plan: &Plan,
    awake: &NetworkState,
    woke: &dyn Fn(usize) -> bool,
    edge: usize,
    with_flow: bool,
) -> (Vec<usize>, f64) {
    let network = plan.network();
    let end = |edge: usize| {
        let m = if with_flow { awake.m_flow_kg_s[edge] } else { -awake.m_flow_kg_s[edge] };
        (network.edges[edge].upstream(m).index(), network.edges[edge].upstream(-m).index())
    };
    let (mut nodes, mut content_kg, mut last) = (vec![end(edge).1], 0.0, edge);
    let mut counts = false;
    loop {
        let here = nodes[nodes.len() - 1];
        counts |= site_of(plan, here).is_some();
        let onward = (0..network.edges.len())
            .filter(|&next| next != last && woke(next) && end(next).0 == here)
            .max_by(|a, b| awake.m_flow_kg_s[*a].abs().total_cmp(&awake.m_flow_kg_s[*b].abs()));
        let Some(next) = onward.filter(|&next| !nodes.contains(&end(next).1)) else { break };
        if counts && let EdgeThermal::PlugFlow(pipe) = network.edges[next].element.thermal() {
            content_kg += pipe.content_kg;
        }
        nodes.push(end(next).1);
        last = next;
    }
    (nodes, content_kg)
}

/// Site and name of a node that is one of the lines of a site.
fn site_of(plan: &Plan, node: usize) -> Option<(String, String)> {
    let (site, name) = (&plan.nodes_on_map[node].site, &plan.node_names[node]);
    let line = name.strip_prefix(site.as_str())?.strip_prefix('.')?;
    (!site.is_empty() && !line.contains('.')).then(|| (site.to_string(), name.to_string()))
}

fn arriving_k(network: &Network, state: &NetworkState, edge: usize) -> f64 {
    state.t_node_k[network.edges[edge].upstream(state.m_flow_kg_s[edge]).index()]
}

/// Runs a model over a start.
fn follow(model: &Model, start: &Start, bypass: Option<&str>) -> Result<Followed, RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    let plan = simulation.plan().clone();
    let passed_s = PASSES * start.content_kg / start.m_flow_kg_s;
    let (begin, end) = (time(start.time_s), time(start.time_s + passed_s + AFTER_S));
    let bypass = bypass.and_then(|id| plan.edge_names.iter().position(|name| name == id));
    let mut found = Followed { outcome: Outcome::default(), heat_j: 0.0, bypass_pa: None };
    let mut cold_s = vec![0.0; start.arriving_k.len()];
    while simulation.time() < end {
        let now = simulation.time();
        let target = if now < begin { begin } else { end };
        simulation.advance_once(target, &plan.stepping())?;
        let dt_s = (simulation.time() - now).as_s();
        let network = &simulation.state().network;
        for (cold_s, (station, before_k)) in cold_s.iter_mut().zip(&start.arriving_k) {
            let edge = plan.stations[*station].edge.index();
            found.heat_j -= network.q_flow_w[edge] * dt_s;
            let cold = arriving_k(plan.network(), network, edge) < before_k - COLD_K;
            if cold && now >= begin {
                *cold_s += dt_s;
            }
        }
        if let Some(edge) = bypass.filter(|edge| network.m_flow_kg_s[*edge] > 0.0) {
            found.bypass_pa = Some(network.dp_pa(plan.network(), edge));
        }
        simulation.take_events().for_each(|event| found.outcome.hear(event));
    }
    let named = start.arriving_k.iter().map(|(i, _)| plan.station_names[*i].clone());
    found.outcome.cold_s = named.zip(cold_s).filter(|(_, cold_s)| *cold_s > 0.0).collect();
    Ok(found)
}

fn longest_s(cold_s: &BTreeMap<String, f64>) -> f64 {
    cold_s.values().fold(0.0, |longest, cold_s| longest.max(*cold_s))
}

/// A bypass at the site of the start that passes a flow until then.
fn bypass(model: &Model, start: &Start, remedy: &'static str, m_flow_kg_s: f64) -> Flush {
    let begin_s = begin_s(start, m_flow_kg_s);
    let id = format!("{}.flush", start.site);
    let driver =
        window(&format!("{id}.m_flow_set_kg_s"), (begin_s, start.time_s), 0.0, m_flow_kg_s);
    let density = model.medium.density_kg_m3;
    let litres = 1e3 * m_flow_kg_s / density;
    let said = vec![
        format!(
            "[[edge]] id = \"{id}\", kind = \"flow_source\", from = \"{}\", to = \"{}\"",
            start.hot, start.cold
        ),
        format!(
            "{}  # {:.1} l/min from {begin_s:.0} to {:.0} s: {:.1} of {:.1} l",
            schedule(&driver),
            60.0 * litres,
            start.time_s,
            litres * (start.time_s - begin_s),
            1e3 * start.content_kg / density
        ),
    ];
    let edge = Change::InsertEdge {
        id: id.clone(),
        from: start.hot.clone(),
        to: start.cold.clone(),
        params: ElementParams::FlowSource(FlowSourceParams::default()),
    };
    Flush { remedy, changes: vec![edge, Change::Drive { driver }], said, bypass: id, m_flow_kg_s }
}

fn begin_s(start: &Start, m_flow_kg_s: f64) -> f64 {
    (start.time_s - MORE * start.content_kg / m_flow_kg_s).max(0.0).round()
}

/// A value within a span of time, and another one before and after.
fn window(signal: &str, (from_s, to_s): (f64, f64), outside: f64, within: f64) -> DriverSpec {
    let mut points = vec![(from_s, within), (to_s, outside)];
    if from_s > 0.0 {
        points.insert(0, (0.0, outside));
    }
    DriverSpec {
        signal: signal.into(),
        unit: None,
        interpolation: Interpolation::Hold,
        times_s: points.iter().map(|(time_s, _)| *time_s).collect(),
        values: points.iter().map(|(_, value)| *value).collect(),
        source: "flush".into(),
        place: Place::default(),
    }
}

fn schedule(driver: &DriverSpec) -> String {
    let points = driver.times_s.iter().zip(&*driver.values);
    let number = |value: f64| if value == 0.0 { "0".to_owned() } else { format!("{value:.5e}") };
    let points = points.map(|(time_s, value)| format!("[{time_s}, {}]", number(*value)));
    let points: Vec<String> = points.collect();
    format!(
        "[[schedule]] signal = \"{}\", interpolation = \"hold\", points = [{}]",
        driver.signal,
        points.join(", ")
    )
}

/// What the others deliver is shared.
fn flush(model: &Model, start: &Start) -> Option<Flush> {
    let m_flow_kg_s = start.m_flow_kg_s.min(TAKEN * start.consumers_kg_s);
    (m_flow_kg_s > 0.0).then(|| bypass(model, start, "flush", m_flow_kg_s))
}

/// A feeder with a given flow delivers as much more: the one that delivers most.
fn fed_flush(model: &Model, start: &Start) -> Result<Option<Flush>, RunError> {
    let free = |signal: &str| {
        model.drivers.iter().all(|driver| driver.signal != signal)
            && model.controllers.iter().all(|c| c.acts_on.iter().all(|acts_on| acts_on != signal))
    };
    let given = model.units.iter().filter_map(|unit| match &unit.params {
        EquipmentParams::PrescribedSource(source) => Some((unit, source.v_flow_m3_s)),
        _ => None,
    });
    let feeds = |port: &str| {
        let edge = model.edges.iter().find(|edge| edge.id == port);
        edge.is_some_and(|edge| matches!(edge.params, ElementParams::FlowSource(_)))
    };
    let given = given
        .map(|(unit, flow)| (format!("{}.v_flow_m3_s", unit.id), unit, flow))
        .filter(|(signal, unit, flow)| *flow > 0.0 && feeds(&unit.port) && free(signal))
        .max_by(|a, b| a.2.total_cmp(&b.2));
    let Some((signal, _, flow)) = given else { return Ok(None) };
    let mut flush = bypass(model, start, "fed_flush", start.m_flow_kg_s);
    let more = flow + start.m_flow_kg_s / model.medium.density_kg_m3;
    let span = (begin_s(start, start.m_flow_kg_s), start.time_s);
    let driver = window(&signal, span, flow, more);
    flush.said.push(schedule(&driver));
    flush.changes.push(Change::Drive { driver });
    Ok(Some(flush))
}

/// Runs a flush and judges it.
fn tried(model: &Model, start: &Start, flush: Flush, before: &Followed) -> Advice {
    let Flush { remedy, changes, said, bypass, m_flow_kg_s } = flush;
    let run = model
        .with(&changes)
        .map_err(|error| error.to_string())
        .and_then(|model| follow(&model, start, Some(&bypass)).map_err(|error| error.to_string()));
    let after = match run {
        Ok(after) => after,
        Err(error) => {
            let verdict = format!("cannot be run: {error}");
            return Advice { remedy, changes: said, outcome: None, helps: false, verdict };
        }
    };
    let (was_s, is_s) = (longest_s(&before.outcome.cold_s), longest_s(&after.outcome.cold_s));
    let cold = format!("cold water for {is_s:.0} s instead of {was_s:.0} s");
    let more_kwh = (after.heat_j - before.heat_j) / 3.6e6;
    let heat =
        format!("{:.2} kWh {} heat", more_kwh.abs(), if more_kwh < 0.0 { "less" } else { "more" });
    let less = after.heat_j < before.heat_j * (1.0 - LESS);
    let helps = is_s <= HELPS * was_s && !less;
    let verdict = match (is_s <= HELPS * was_s, is_s <= IN_PART * was_s, less) {
        (true, _, false) => "helps",
        (_, true, false) => "helps in part",
        (_, true, true) => "does not help, the flush costs the consumers more than the plug",
        (_, false, _) => "does not help",
    };
    let density = model.medium.density_kg_m3;
    let valve = match after.bypass_pa {
        // Kv in m3/h at 1 bar: V sqrt(rho/1000 kg/m3 * 1 bar/dp)
        Some(dp_pa) if dp_pa > 0.0 => {
            let kv = 3600.0 * m_flow_kg_s / density * (density / 1e3 * 1e5 / dp_pa).sqrt();
            format!("a valve of Kv {kv:.2} m3/h passes the flush")
        }
        _ => "the flush needs a pump, the pressures at its site are against it".to_owned(),
    };
    let verdict = format!("{verdict}: {cold}, {heat}; {valve}");
    Advice { remedy, changes: said, outcome: Some(after.outcome), helps, verdict }
}
