//! The map of `report.html`: the network with its houses, where simulation and measurement agree, and what was added.
//!
//! Lines have the colour of the residuals, over sigma, of the part that measured boundaries cut out; dots are sensors with theirs,
//! in the whole system; grey is what nothing tests. Positions are those of the model, else laid out by the lengths of the pipes.

use super::html::escape;
use crate::experiment::Experiment;
use crate::explain::Explanation;
use crate::find::Found;
use anergy_core::recorder::{MapEdge, MapNode, NetworkMap};
use anergy_network::elements::ElementParams;
use anergy_report::places::{DrawnLine, drawn};
use std::collections::BTreeMap;
use std::fmt::Write;

const WIDTH: f64 = 900.0;
const SIDE: f64 = 90.0;
const TOP: f64 = 46.0;
const HEIGHTS: (f64, f64) = (60.0, 420.0);
/// Above so many lines names stand in the tooltips only.
const NAMED_LINES: usize = 40;
/// Residuals over sigma up to which a place agrees, and above which it differs much.
const AGREES: f64 = 1.3;
const MUCH: f64 = 3.0;

/// A point of the drawing, pixels.
type Pixel = (f64, f64);

/// Nodes, units and points where circuits meet, and what connects them.
fn network(experiment: &Experiment) -> NetworkMap {
    let model = &experiment.model;
    let plain = |id: &str| MapNode { id: id.to_owned(), site: String::new(), x_m: None, y_m: None };
    let mut map = NetworkMap::default();
    map.nodes.extend(model.nodes.iter().map(|node| MapNode {
        site: node.site.to_string(),
        x_m: node.entry.x_m,
        y_m: node.entry.y_m,
        ..plain(&node.entry.id)
    }));
    map.nodes.extend(model.units.iter().map(|unit| plain(&unit.id)));
    let line = |id: &str, kind: &str, from: &str, to: &str, length_m| MapEdge {
        id: id.to_owned(),
        kind: kind.to_owned(),
        from: from.to_owned(),
        to: to.to_owned(),
        length_m,
        inner_diameter_m: 0.0,
        station: String::new(),
    };
    for edge in &model.edges {
        let (kind, length_m) = match &edge.params {
            ElementParams::Pipe(pipe) => ("pipe", pipe.length_m),
            other => (other.kind(), 0.0),
        };
        map.edges.push(line(&edge.id, kind, &edge.from, &edge.to, length_m));
    }
    for unit in &model.units {
        if let Some(edge) = model.edges.iter().find(|edge| edge.id == unit.port) {
            map.edges.push(line(&unit.id, "unit", &edge.from, &unit.id, 0.0));
        }
    }
    let unit = |port: &str| {
        let mut units = model.units.iter().map(|unit| unit.id.as_str());
        units.find(|id| {
            port.strip_prefix(id).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        })
    };
    for circuit in &model.circuits {
        let mut stops: Vec<&str> = circuit.through.iter().filter_map(|port| unit(port)).collect();
        match &circuit.branch {
            Some(branch) => {
                stops.insert(0, &branch.from);
                stops.push(&branch.to);
                for point in [&branch.from, &branch.to] {
                    if map.nodes.iter().all(|node| node.id != **point) {
                        map.nodes.push(plain(point));
                    }
                }
            }
            None if stops.len() > 2 => stops.push(stops[0]),
            None => {}
        }
        let pairs = stops.windows(2).filter(|pair| pair[0] != pair[1]);
        map.edges.extend(pairs.map(|pair| line(&circuit.id, "circuit", pair[0], pair[1], 0.0)));
    }
    map
}

/// Residuals over sigma as a word of the style.
fn word(z: Option<f64>) -> &'static str {
    match z {
        None => "open",
        Some(z) if z <= AGREES => "agrees",
        Some(z) if z <= MUCH => "some",
        Some(_) => "much",
    }
}

/// What a place says when one points at it.
fn said(found: &Found, component: &str) -> (Option<f64>, String) {
    let of = found.parts.iter().find(|part| part.components.iter().any(|c| c == component));
    match of {
        Some(part) => (
            Some(part.isolated_z),
            format!(
                "{component}: {:.1} sigma cut out with its measured boundaries, {:.1} in the whole system",
                part.isolated_z, part.whole_z
            ),
        ),
        None => (None, format!("{component}: not tested by itself")),
    }
}

/// Where lines and places are drawn.
struct Sheet {
    of_place: BTreeMap<String, Pixel>,
    places: Vec<(String, Pixel, bool)>,
    lines: Vec<(DrawnLine, Pixel, Pixel)>,
    height: f64,
}

impl Sheet {
    fn new(experiment: &Experiment) -> Self {
        let map = network(experiment);
        let (places, lines) = drawn(&map);
        let range = |of: &dyn Fn(usize) -> f64| {
            (0..places.len())
                .map(of)
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (x, y) = (range(&|i| places[i].x_m), range(&|i| places[i].y_m));
        let scale = (WIDTH - 2.0 * SIDE) / (x.1 - x.0).max(1e-9);
        let flat = y.1 - y.0 < 1e-9;
        let inner = if flat { 0.0 } else { (scale * (y.1 - y.0)).clamp(HEIGHTS.0, HEIGHTS.1) };
        let stretch = inner / (y.1 - y.0).max(1e-9);
        let at = |i: usize| {
            (SIDE + scale * (places[i].x_m - x.0), TOP + stretch * (y.1 - places[i].y_m))
        };
        let is_unit = |name: &str| experiment.model.units.iter().any(|unit| unit.id == name);
        let mut of_place = BTreeMap::new();
        for (i, place) in places.iter().enumerate() {
            for name in [&place.name, &place.hot, &place.cold] {
                of_place.insert(name.clone(), at(i));
            }
        }
        // Lines between the same places lie beside each other.
        let mut count: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let pair = |line: &DrawnLine| (line.from.min(line.to), line.from.max(line.to));
        for line in &lines {
            *count.entry(pair(line)).or_default() += 1;
        }
        let mut used: BTreeMap<(usize, usize), usize> = BTreeMap::new();
        let mut all = Vec::with_capacity(lines.len());
        for line in lines {
            let key = pair(&line);
            let k = used.entry(key).or_default();
            let aside = 12.0 * (*k as f64 - 0.5 * (count[&key] - 1) as f64);
            *k += 1;
            let ((ax, ay), (bx, by)) = (at(key.0), at(key.1));
            let length = (bx - ax).hypot(by - ay).max(1e-9);
            let (nx, ny) = (-(by - ay) / length * aside, (bx - ax) / length * aside);
            all.push((line, (ax + nx, ay + ny), (bx + nx, by + ny)));
        }
        let named = places.iter().enumerate();
        let named = named.map(|(i, place)| (place.name.clone(), at(i), is_unit(&place.name)));
        Self { of_place, places: named.collect(), lines: all, height: inner + 2.0 * TOP }
    }

    /// Where a component, or what a signal belongs to, is drawn.
    fn at(&self, name: &str) -> Option<Pixel> {
        let middle = |(_, a, b): &(DrawnLine, Pixel, Pixel)| (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
        let mut name = name;
        loop {
            let place = self.of_place.get(name).copied();
            let line = self.lines.iter().find(|(line, ..)| line.edge == name).map(middle);
            match place.or(line) {
                Some(at) => return Some(at),
                None => name = name.rsplit_once('.')?.0,
            }
        }
    }
}

/// The map and what it says; nothing where nothing was compared.
pub(super) fn map(out: &mut String, experiment: &Experiment, explanation: &Explanation) {
    let Some(found) = &explanation.found else { return };
    let sheet = Sheet::new(experiment);
    if sheet.places.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "<h2>Where</h2>\n<p class=\"legend\"><span class=\"agrees\">agrees</span> <span class=\"some\">differs</span> <span class=\"much\">differs much</span> <span class=\"open\">nothing tests it alone</span> lines: cut out with measured boundaries; dots: sensors; rings: effects</p>\n<svg class=\"map\" viewBox=\"0 0 {WIDTH} {:.0}\" role=\"img\" aria-label=\"map of the network\">",
        sheet.height
    );
    for (line, a, b) in &sheet.lines {
        let (z, says) = said(found, &line.edge);
        let _ = writeln!(
            out,
            "<line class=\"{} {}\" x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\"><title>{}</title></line>",
            if line.kind == "circuit" { "thin" } else { "thick" },
            word(z),
            a.0,
            a.1,
            b.0,
            b.1,
            escape(&says)
        );
    }
    for (name, (x, y), is_unit) in &sheet.places {
        let title = format!("<title>{}</title>", escape(name));
        let _ = if *is_unit {
            writeln!(
                out,
                "<rect class=\"place\" x=\"{:.1}\" y=\"{:.1}\" width=\"14\" height=\"14\">{title}</rect>",
                x - 7.0,
                y - 7.0
            )
        } else {
            writeln!(
                out,
                "<circle class=\"place\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\">{title}</circle>"
            )
        };
    }
    if sheet.lines.len() <= NAMED_LINES {
        names(out, &sheet, explanation);
    }
    sensors(out, experiment, found, &sheet);
    for effect in &explanation.effects {
        let sensor = experiment.sensors.sensor.iter().find(|s| s.column == effect.component);
        let Some((x, y)) = sheet.at(sensor.map_or(&effect.component, |s| &s.signal)) else {
            continue;
        };
        let _ = writeln!(
            out,
            "<circle class=\"ring\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"15\"/><text class=\"effect\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            x + 14.0,
            y + 22.0,
            escape(&format!("{} {}", effect.id, effect.component))
        );
    }
    out.push_str("</svg>\n");
    parts(out, found);
}

/// Names of places above them, of lines at their middle; each line once.
fn names(out: &mut String, sheet: &Sheet, explanation: &Explanation) {
    for (name, (x, y), _) in &sheet.places {
        let _ = writeln!(
            out,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            y - 12.0,
            escape(name)
        );
    }
    // What has an effect has its name there.
    let mut written: Vec<&str> =
        explanation.effects.iter().map(|effect| effect.component.as_str()).collect();
    for (line, a, b) in &sheet.lines {
        if written.contains(&line.edge.as_str()) || (b.0 - a.0).hypot(b.1 - a.1) < 40.0 {
            continue;
        }
        written.push(&line.edge);
        let (x, y) = (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1));
        // Beside lines that stand, above those that lie.
        let stands = (b.1 - a.1).abs() > 2.0 * (b.0 - a.0).abs();
        let (dx, dy, anchor) = if stands { (7.0, 4.0, "start") } else { (0.0, -6.0, "middle") };
        let _ = writeln!(
            out,
            "<text class=\"of-line\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"{anchor}\">{}</text>",
            x + dx,
            y + dy,
            escape(&line.edge)
        );
    }
}

/// Compared sensors, side by side below what they measure.
fn sensors(out: &mut String, experiment: &Experiment, found: &Found, sheet: &Sheet) {
    let mut there: BTreeMap<(i64, i64), usize> = BTreeMap::new();
    for sensor in &found.sensors {
        let mut all = experiment.sensors.sensor.iter();
        let Some(of) = all.find(|s| s.column == sensor.column) else { continue };
        let Some((x, y)) = sheet.at(&of.signal) else { continue };
        let k = there.entry((x as i64, y as i64)).or_default();
        let _ = writeln!(
            out,
            "<circle class=\"sensor {}\" cx=\"{:.1}\" cy=\"{:.1}\" r=\"4.5\"><title>{}: {:.1} sigma</title></circle>",
            word(Some(sensor.z)),
            x - 4.0 + 11.0 * *k as f64,
            y + 14.0,
            escape(&sensor.column),
            sensor.z
        );
        *k += 1;
    }
}

fn parts(out: &mut String, found: &Found) {
    if found.parts.is_empty() {
        return;
    }
    out.push_str("<table><tr><th>part that measured boundaries cut out</th><th>tested by</th><th>sigma, cut out</th><th>in the whole system</th><th>share of the cause</th></tr>\n");
    for part in &found.parts {
        let _ = writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{:.1}</td><td>{:.1}</td><td>{:.2}</td></tr>",
            escape(&part.components.join(", ")),
            escape(&part.sensors.join(", ")),
            part.isolated_z,
            part.whole_z,
            part.probability
        );
    }
    out.push_str("</table>\n");
}

/// The style of the map.
pub(super) const STYLE: &str = "svg.map .thick{stroke-width:4}svg.map .thin{stroke-width:2}svg.map line{stroke-linecap:round}
svg.map line.agrees,.legend .agrees{stroke:#2a9d6f;border-color:#2a9d6f}svg.map line.some,.legend .some{stroke:#e0982b;border-color:#e0982b}
svg.map line.much,.legend .much{stroke:#d1495b;border-color:#d1495b}svg.map line.open,.legend .open{stroke:#9aa3b2;border-color:#9aa3b2}
svg.map .place{fill:var(--paper);stroke:var(--ink);stroke-width:1.5}svg.map .sensor{stroke:var(--paper);stroke-width:1}
svg.map .sensor.agrees{fill:#2a9d6f}svg.map .sensor.some{fill:#e0982b}svg.map .sensor.much{fill:#d1495b}
svg.map .ring{fill:none;stroke:var(--c);stroke-width:2.5;stroke-dasharray:5 3}svg.map .effect{fill:var(--c);font-weight:600}svg.map .of-line{opacity:.7}
";
