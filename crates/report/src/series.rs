//! Which series the plots offer, which of them are shown first, and the intervals that are shaded.

use crate::collect::{Collector, Source};
use crate::decimate::Buckets;
use crate::display::Display;
use crate::escape;
use crate::lookup::{Lookup, value};
use crate::sites::SiteGraph;
use anergy_core::recorder::ChannelGroup::Interfaces;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// Points of a series at most.
pub const MAX_POINTS: usize = 2000;
/// Points of a series at least, as long as series are not left out.
const MIN_POINTS: usize = 100;
/// Values embedded for plots at most: 4 bytes each, 5.3 in base64.
const VALUE_BUDGET: usize = 1_800_000;
/// Series of one panel at most.
const MAX_SERIES: usize = 3000;
/// Series of one panel that are shown first.
const SHOWN_SERIES: usize = 12;

/// One plot of the report: one or more panels of one subject.
#[derive(Debug, Serialize)]
pub struct Plot {
    /// `flows`, `pressures`, `temperatures`, `heat`, `speeds`.
    pub id: &'static str,
    /// Heading.
    pub title: &'static str,
    /// What the sign means, or which components are drawn.
    pub note: &'static str,
    /// Sets of axes.
    pub panels: Vec<Panel>,
}

/// One set of axes.
#[derive(Debug, Serialize)]
pub struct Panel {
    /// Heading and vertical axis.
    pub title: &'static str,
    /// Unit of the vertical axis.
    pub display: Display,
    /// Curves.
    pub series: Vec<Series>,
    /// Series that were recorded but are not embedded.
    pub left_out: usize,
}

/// One curve.
#[derive(Debug, Serialize)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Place: curves of one place have one colour.
    pub key: String,
    /// Whether it is drawn before anyone chooses.
    pub shown: bool,
    /// Points, SI, base64 of 32-bit floats.
    pub data: String,
}

/// A time during which an interface could not do what was asked of it, or a pump swung.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Flagged {
    /// `blocked`, `oscillating`, `hunting`.
    pub kind: &'static str,
    /// Interface or pump.
    pub component: String,
    /// Place of it.
    pub key: String,
    /// Start, s.
    pub from: f64,
    /// End, s; `None` when it lasts until the end of the run.
    pub to: Option<f64>,
}

/// All that the plots draw.
pub struct Plots {
    /// The plots.
    pub plots: Vec<Plot>,
    /// Times of the points, s.
    pub times: Vec<f64>,
    /// Whether points stand for several rows.
    pub decimated: bool,
}

struct Draft<'a> {
    title: &'static str,
    display: Display,
    sources: Vec<Source<'a>>,
}

/// Chooses, ranks and decimates.
pub fn plots(lookup: &Lookup, sites: &SiteGraph, flagged: &[Flagged], density_kg_m3: f64) -> Plots {
    let collector = Collector { lookup, sites };
    let flow = Display::flow(density_kg_m3);
    let (flows, note) = collector.flows();
    let drafts = [
        ("flows", "Flows", note, vec![draft("Flow", flow, flows)]),
        (
            "pressures",
            "Pressures",
            "",
            vec![
                draft("Pressure", Display::pressure(), collector.outer_nodes("p_pa")),
                draft("Difference hot − cold", Display::pressure(), collector.differences()),
            ],
        ),
        (
            "temperatures",
            "Temperatures",
            "",
            vec![
                draft("Temperature", Display::temperature(), collector.outer_nodes("t_k")),
                draft("Rooms and storages", Display::temperature(), collector.houses()),
            ],
        ),
        (
            "heat",
            "Heat and electricity",
            "Heat of stations: positive into the water of the grid. Heat of units: as each counts it.",
            vec![
                draft("Heat of stations", Display::heat(), collector.stations("q_flow_w")),
                draft("Heat of units", Display::heat(), collector.unit_heat()),
                draft("Electricity", Display::heat(), collector.electricity()),
                draft("State of charge", Display::ratio(), collector.units("soc")),
            ],
        ),
        (
            "speeds",
            "Pump speeds",
            "Speed relative to nominal speed.",
            vec![
                draft("Pump speed", Display::ratio(), collector.edges("speed")),
                draft("Valve opening", Display::ratio(), collector.edges("opening")),
            ],
        ),
    ];
    let offered = |draft: &Draft| draft.sources.len().min(MAX_SERIES);
    let count: usize = drafts.iter().flat_map(|plot| &plot.3).map(offered).sum();
    let points = (VALUE_BUDGET / count.max(1)).clamp(MIN_POINTS, MAX_POINTS);
    let buckets = Buckets::new(lookup.rows, points);
    let stuck: BTreeSet<&str> = flagged.iter().map(|interval| interval.key.as_str()).collect();
    let finish = |(id, title, note, drafts): (_, _, &'static str, Vec<Draft>)| Plot {
        id,
        title,
        note,
        panels: drafts
            .into_iter()
            .filter(|draft| !draft.sources.is_empty())
            .map(|draft| panel(draft, lookup.rows, &buckets, &stuck))
            .collect(),
    };
    Plots {
        plots: drafts.into_iter().map(finish).collect(),
        times: buckets.times(lookup.times()),
        decimated: buckets.is_decimated(),
    }
}

fn draft<'a>(title: &'static str, display: Display, sources: Vec<Source<'a>>) -> Draft<'a> {
    Draft { title, display, sources }
}

fn panel(draft: Draft, rows: usize, buckets: &Buckets, stuck: &BTreeSet<&str>) -> Panel {
    let ranked = rank(&draft.sources, rows, stuck);
    let chosen = |limit: usize| {
        let mut keys = BTreeSet::new();
        let mut count = 0;
        for (key, size) in &ranked {
            if count > 0 && count + size > limit {
                break;
            }
            count += size;
            keys.insert(key.clone());
        }
        keys
    };
    let (shown, kept) = (chosen(SHOWN_SERIES), chosen(MAX_SERIES));
    let total = draft.sources.len();
    let kept = draft.sources.into_iter().filter(|source| kept.contains(&source.key));
    let series: Vec<Series> = kept
        .map(|source| Series {
            shown: shown.contains(&source.key),
            data: escape::base64_f32(&buckets.values(&source.column)),
            name: source.name,
            key: source.key,
        })
        .collect();
    let left_out = total - series.len();
    Panel { title: draft.title, display: draft.display, series, left_out }
}

/// Places with their number of series, the most telling first: flagged ones, then by the largest
/// change of a series in time, then by magnitude.
fn rank(sources: &[Source], rows: usize, stuck: &BTreeSet<&str>) -> Vec<(String, usize)> {
    struct Score {
        key: String,
        size: usize,
        stuck: bool,
        change: f64,
        magnitude: f64,
        order: usize,
    }
    let mut scores: BTreeMap<&str, Score> = BTreeMap::new();
    for (order, source) in sources.iter().enumerate() {
        let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
        for x in (0..rows).map(|row| value(&source.column, row)).filter(|x| x.is_finite()) {
            (least, greatest) = (least.min(x), greatest.max(x));
        }
        let score = scores.entry(&source.key).or_insert_with(|| Score {
            key: source.key.clone(),
            size: 0,
            stuck: stuck.contains(source.key.as_str()),
            change: 0.0,
            magnitude: 0.0,
            order,
        });
        score.size += 1;
        if least <= greatest {
            score.change = score.change.max(greatest - least);
            score.magnitude = score.magnitude.max(greatest.abs().max(least.abs()));
        }
    }
    let mut scores: Vec<Score> = scores.into_values().collect();
    scores.sort_by(|a, b| {
        let stuck = b.stuck.cmp(&a.stuck);
        let change = b.change.total_cmp(&a.change);
        stuck.then(change).then(b.magnitude.total_cmp(&a.magnitude)).then(a.order.cmp(&b.order))
    });
    scores.into_iter().map(|score| (score.key, score.size)).collect()
}

/// Flagged intervals: from the events of a component, which have exact times; blocked ones without
/// events from the flag of the interface.
pub fn flagged(lookup: &Lookup, sites: &SiteGraph) -> Vec<Flagged> {
    let mut intervals: Vec<Flagged> = Vec::new();
    let mut open = |kind, component: &str, from: f64| {
        let (key, component) = (sites.place_of(component).to_owned(), component.to_owned());
        intervals.push(Flagged { kind, component, key, from, to: None });
        intervals.len() - 1
    };
    let mut running: BTreeMap<(&str, &str), Option<usize>> = BTreeMap::new();
    let mut ends: Vec<(usize, f64)> = Vec::new();
    for event in &lookup.recording.events {
        let (time, component) = (event.time.as_s(), event.component.as_str());
        let (begins, ended) = match event.kind.as_str() {
            "blocked" => (Some("blocked"), None),
            "unblocked" => (None, Some("blocked")),
            "oscillating" => (Some("oscillating"), None),
            "oscillating_ended" => (None, Some("oscillating")),
            // What hunts has swung alone before, and no event says that this is over.
            "hunting" => (Some("hunting"), Some("oscillating")),
            "hunting_ended" => (None, Some("hunting")),
            _ => continue,
        };
        if let Some(kind) = ended {
            let interval = running.entry((component, kind)).or_insert(None);
            ends.extend(interval.take().map(|interval| (interval, time)));
        }
        if let Some(kind) = begins {
            let interval = running.entry((component, kind)).or_insert(None);
            if interval.is_none() {
                *interval = Some(open(kind, component, time));
            }
        }
    }
    for component in lookup.components(Interfaces, "blocked") {
        let Some(column) = lookup.column(component, "blocked") else { continue };
        if running.contains_key(&(component, "blocked")) {
            continue;
        }
        let mut since = None;
        for (row, &time) in lookup.times().iter().enumerate() {
            match (value(column, row) > 0.5, since) {
                (true, None) => since = Some(open("blocked", component, time)),
                (false, Some(interval)) => {
                    ends.push((interval, time));
                    since = None;
                }
                _ => {}
            }
        }
    }
    for (interval, time) in ends {
        intervals[interval].to = Some(time);
    }
    intervals
}
