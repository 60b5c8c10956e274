//! The drawing of the network: where symbols and lines are, without any value.

use crate::display;
use crate::escape;
use crate::layout::Point;
use crate::sites::{Side, SiteGraph, Vertex};
use anergy_core::recorder::MapEdge;
use std::collections::BTreeMap;

/// Width of the drawing, its own units.
const WIDTH: f64 = 1000.0;
const MAX_HEIGHT: f64 = 640.0;
const MIN_HEIGHT: f64 = 190.0;
const MARGIN: [f64; 2] = [80.0, 72.0];
/// Up to this number of symbols each has its name written.
const LABELLED: usize = 40;

/// A site with station, 40 units wide: hot above, cold below, in the middle the way of the station's
/// flow, around it the mark of a blocked station.
const STATION: &str = r#"<path class="hot" d="M-20 0V-15a5 5 0 0 1 5-5H15a5 5 0 0 1 5 5V0z"/>
<path class="cold" d="M-20 0V15a5 5 0 0 0 5 5H15a5 5 0 0 0 5-5V0z"/>
<rect class="rim" x="-20" y="-20" width="40" height="40" rx="5"/><circle class="hub" r="12.5"/>
<path class="way" d="M0-8.5 6.5-0.5H2.2V8.5H-2.2V-0.5H-6.5z"/><path class="rest" d="M-5 0H5"/>
<g class="stop"><rect x="-25.5" y="-25.5" width="51" height="51" rx="9"/><circle cx="21" cy="-21" r="9.5"/><path d="M15.5-21H26.5"/></g>"#;
/// A place with hot and cold node but without station.
const JUNCTION: &str = r#"<path class="hot" d="M-10 0a10 10 0 0 1 20 0z"/>
<path class="cold" d="M-10 0a10 10 0 0 0 20 0z"/><circle class="rim" r="10"/>"#;
/// A plain node.
const NODE: &str = r#"<circle class="hot" r="7"/><circle class="rim" r="7"/>"#;

/// Positions in the drawing, its height, and the half size of a symbol.
fn fit(sites: &SiteGraph) -> (Vec<Point>, f64, f64) {
    let bound = |axis: usize, worst: f64, pick: fn(f64, f64) -> f64| {
        sites.positions.iter().map(|point| point[axis]).fold(worst, pick)
    };
    let low = [bound(0, f64::INFINITY, f64::min), bound(1, f64::INFINITY, f64::min)];
    let high = [bound(0, f64::NEG_INFINITY, f64::max), bound(1, f64::NEG_INFINITY, f64::max)];
    let extent = [0, 1].map(|axis| (high[axis] - low[axis]).max(0.0));
    let tallest = (260.0 + 30.0 * sites.vertices.len() as f64).min(MAX_HEIGHT);
    let room = [WIDTH - 2.0 * MARGIN[0], tallest - 2.0 * MARGIN[1]];
    let scale = (room[0] / extent[0]).min(room[1] / extent[1]);
    let scale = if scale.is_finite() { scale } else { 0.0 };
    let height = (extent[1] * scale + 2.0 * MARGIN[1]).max(MIN_HEIGHT);
    let centre = [0, 1].map(|axis| f64::midpoint(low[axis], high[axis]));
    let place = |point: &Point| {
        [
            WIDTH / 2.0 + (point[0] - centre[0]) * scale,
            height / 2.0 - (point[1] - centre[1]) * scale,
        ]
    };
    let points: Vec<Point> = sites.positions.iter().map(place).collect();
    let mut room: Vec<f64> = (0..points.len()).map(|i| nearest(&points, i)).collect();
    room.sort_by(f64::total_cmp);
    let crowded = room.get(room.len() / 6).copied().unwrap_or(WIDTH);
    (points, height, (0.4 * crowded).clamp(2.5, 23.0))
}

/// Distance to the nearest other symbol; of a large network only the symbols next in the list count.
fn nearest(points: &[Point], i: usize) -> f64 {
    const REACH: usize = 1500;
    let near = &points[i.saturating_sub(REACH)..(i + REACH).min(points.len())];
    let distance = |p: &Point| (p[0] - points[i][0]).hypot(p[1] - points[i][1]);
    near.iter().map(distance).filter(|distance| *distance > 0.0).fold(WIDTH, f64::min)
}

/// The `<svg>` element; colours, arrows, texts and widths are set by the page's script.
pub fn svg(sites: &SiteGraph, edges: &[MapEdge]) -> String {
    let (points, height, half) = fit(sites);
    let gap = (0.7 * half).clamp(2.4, 12.0);
    let dense = points.len() > LABELLED;
    let font = if dense { 0.42 * half } else { (0.68 * half).clamp(9.0, 13.5) };
    // Two texts side by side need this room.
    let brief = (0..points.len()).any(|i| nearest(&points, i) < 140.0);
    let class = if dense {
        "dense"
    } else if brief {
        "brief"
    } else {
        ""
    };
    let mut defs = String::new();
    let mut body = String::new();
    for (i, route) in routes(sites, edges, &points, gap).iter().enumerate() {
        let (gradient, group) = line(i, &edges[sites.lines[i].edge], route, gap, half);
        defs += &gradient;
        body += &group;
    }
    if !dense {
        body += &lengths(sites, edges, &points, gap);
    }
    let sides = text_sides(sites, &points);
    for (i, (vertex, point)) in sites.vertices.iter().zip(&points).enumerate() {
        body += &symbol(i, vertex, *point, half, font, sides[i]);
    }
    format!(
        r#"<svg data-map="network" data-sites="{}" data-lines="{}" data-gap="{gap:.1}" data-font="{font:.2}"
 class="{}" viewBox="0 0 {WIDTH:.0} {height:.0}" role="group" aria-label="Map of the network">
<defs>{defs}</defs>
{body}</svg>"#,
        points.len(),
        sites.lines.len(),
        class,
    )
}

/// The colour gradient of a line and the line with its arrow and, for what is no pipe, its glyph.
fn line(i: usize, edge: &MapEdge, route: &[Point], gap: f64, half: f64) -> (String, String) {
    let (Some(first), Some(last)) = (route.first(), route.last()) else {
        return Default::default();
    };
    let gradient = format!(
        r#"<linearGradient id="g{i}" gradientUnits="userSpaceOnUse" x1="{:.1}" y1="{:.1}" x2="{:.1}" y2="{:.1}"><stop offset="0"/><stop offset="1"/></linearGradient>
"#,
        first[0], first[1], last[0], last[1],
    );
    let corners = route.iter().map(|[x, y]| format!("{x:.1} {y:.1}"));
    let path = corners.collect::<Vec<_>>().join("L");
    // Arrow and glyph are on the middle part.
    let ([x1, y1], [x2, y2]) = (route[route.len() / 2 - 1], route[route.len() / 2]);
    let angle = (y2 - y1).atan2(x2 - x1).to_degrees();
    let at = |share: f64, size: f64| {
        let (x, y) = (x1 + share * (x2 - x1), y1 + share * (y2 - y1));
        format!("translate({x:.1} {y:.1}) rotate({angle:.1}) scale({size:.2})")
    };
    let glyph = match glyph(&edge.kind) {
        "" => String::new(),
        shape => format!(r#"<g class="glyph" transform="{}">{shape}</g>"#, at(0.5, half / 20.0)),
    };
    let group = format!(
        r#"<g class="line" data-line="{i}" tabindex="-1" role="img" aria-label="{}">
<path class="hit" d="M{path}"/><path class="halo" d="M{path}"/><path class="flow" stroke="url(#g{i})" d="M{path}"/>
<g transform="{}"><path class="arrow" d="M-7-7 9 0-7 7-3.5 0z"/></g>{glyph}</g>
"#,
        escape::html(&edge.id),
        at(if glyph.is_empty() { 0.5 } else { 0.75 }, gap / 12.0),
    );
    (gradient, group)
}

/// The corners of each line: lines between the same two symbols run side by side, hot ones above.
fn routes(sites: &SiteGraph, edges: &[MapEdge], points: &[Point], gap: f64) -> Vec<Vec<Point>> {
    let mut trenches: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for (i, line) in sites.lines.iter().enumerate() {
        trenches.entry((line.from.min(line.to), line.from.max(line.to))).or_default().push(i);
    }
    let mut drawn = vec![Vec::new(); sites.lines.len()];
    for ((a, b), mut members) in trenches {
        members.sort_by_key(|&i| (sites.lines[i].side, i));
        let (a, b) = (points[a], points[b]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy).max(1e-9);
        // The normal that points up; for vertical trenches to the left.
        let sign = if dx.abs() > 1e-3 * length { dx.signum() } else { -dy.signum() };
        let normal = [sign * dy / length, -sign * dx / length];
        let lone = members.len() == 1;
        // Symbols on lines need room between the lines.
        let bulky =
            !lone && members.iter().any(|&i| !glyph(&edges[sites.lines[i].edge].kind).is_empty());
        let gap = if bulky { 2.6 * gap } else { gap };
        for (k, &i) in members.iter().enumerate() {
            let offset = match sites.lines[i].side {
                Side::Hot if lone => 0.5,
                Side::Cold if lone => -0.5,
                _ => (members.len() as f64 - 1.0) / 2.0 - k as f64,
            } * gap;
            let shift = |p: Point| [p[0] + offset * normal[0], p[1] + offset * normal[1]];
            let line = sites.lines[i];
            let (from, to) = (points[line.from], points[line.to]);
            let between = |share: f64| {
                shift([from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])])
            };
            drawn[i] = if bulky {
                vec![from, between(0.2), between(0.8), to]
            } else {
                vec![shift(from), shift(to)]
            };
        }
    }
    drawn
}

/// Length of pipe between the symbols, once for each pair of them.
fn lengths(sites: &SiteGraph, edges: &[MapEdge], points: &[Point], gap: f64) -> String {
    let mut known: BTreeMap<(usize, usize), f64> = BTreeMap::new();
    for line in &sites.lines {
        let ends = (line.from.min(line.to), line.from.max(line.to));
        let longest = known.entry(ends).or_insert(0.0);
        *longest = longest.max(edges[line.edge].length_m);
    }
    let mut out = String::new();
    for ((from, to), length) in known {
        let (a, b) = (points[from], points[to]);
        let span = (a[0] - b[0]).hypot(a[1] - b[1]);
        if length > 0.0 && length.is_finite() && span > 90.0 {
            let steep = (a[1] - b[1]).abs() > 0.5 * span;
            let (x, y) = (f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1]));
            let (x, y, anchor) = if steep {
                (x + gap + 8.0, y + 4.0, "start")
            } else {
                (x, y + gap + 16.0, "middle")
            };
            let text = display::number(length);
            out += &format!(
                r#"<text class="length" x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{text} m</text>
"#
            );
        }
    }
    out
}

/// Where the text of a symbol stands, as a direction.
fn text_sides(sites: &SiteGraph, points: &[Point]) -> Vec<Point> {
    // The first that is free is taken: below is the usual place.
    const SIDES: [Point; 4] = [[0.0, 1.0], [0.0, -1.0], [1.0, 0.0], [-1.0, 0.0]];
    let mut blocked = vec![[0.0_f64; 4]; points.len()];
    for line in &sites.lines {
        for (here, there) in [(line.from, line.to), (line.to, line.from)] {
            let (dx, dy) = (points[there][0] - points[here][0], points[there][1] - points[here][1]);
            let length = dx.hypot(dy).max(1e-9);
            for (cosine, side) in blocked[here].iter_mut().zip(SIDES) {
                *cosine = cosine.max((dx * side[0] + dy * side[1]) / length);
            }
        }
    }
    let side = |cosines: &[f64; 4]| {
        // Within 45 degrees of a line is not free; small differences do not count.
        let free = (0..4).find(|&i| cosines[i] < 0.71);
        let least = (0..4).min_by(|&a, &b| cosines[a].total_cmp(&cosines[b]));
        SIDES[free.or(least).unwrap_or(0)]
    };
    blocked.iter().map(side).collect()
}

/// A place with its name and room for its state.
fn symbol(index: usize, vertex: &Vertex, at: Point, half: f64, size: f64, side: Point) -> String {
    let name = escape::html(&vertex.name);
    let station = !vertex.stations.is_empty();
    let shape = match (station, vertex.cold) {
        (true, _) => STATION,
        (false, Some(_)) => JUNCTION,
        (false, None) => NODE,
    };
    let away = if station { 1.35 * half } else { 0.65 * half } + 0.35 * size;
    // Base lines of the two texts.
    let lines = if station { [0.0, 1.25 * size] } else { [0.0, 0.0] };
    let (x, y, anchor) = match side {
        [0.0, y] if y > 0.0 => (0.0, away + 0.9 * size, "middle"),
        [0.0, _] => (0.0, -away - lines[1], "middle"),
        [x, _] => (away * x, 0.35 * size - lines[1] / 2.0, if x > 0.0 { "start" } else { "end" }),
    };
    format!(
        r#"<g class="site" data-site="{index}" tabindex="{focus}" role="img" aria-label="{name}" transform="translate({left:.1} {top:.1})">
<g transform="scale({scale:.3})">{shape}</g>
<text class="name" x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size:.2}">{short}</text>
<text class="state" x="{x:.1}" y="{second:.1}" text-anchor="{anchor}" font-size="{small:.2}"></text></g>
"#,
        focus = if index == 0 { "0" } else { "-1" },
        left = at[0],
        top = at[1],
        scale = half / 20.0,
        short = escape::html(&shortened(&vertex.name)),
        second = y + lines[1],
        small = 0.9 * size,
    )
}

/// A name that fits below a symbol.
fn shortened(name: &str) -> String {
    const LONGEST: usize = 22;
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    name.chars().take(LONGEST - 1).chain(['…']).collect()
}

/// Symbol of what is no pipe, drawn in the middle of its line; by the registry's word.
fn glyph(kind: &str) -> &'static str {
    if kind.contains("pipe") {
        ""
    } else if kind.contains("pump") {
        r#"<circle r="11"/><path d="M-5-9 11 0-5 9"/>"#
    } else if kind.contains("valve") {
        r#"<path d="M-12-8V8L12-8V8z"/>"#
    } else if kind.contains("exchanger") {
        r#"<rect x="-11" y="-11" width="22" height="22"/><path d="M-11 11 11-11"/>"#
    } else {
        r#"<rect x="-11" y="-6" width="22" height="12"/>"#
    }
}
