//! Puts the page together: text and tables, drawing, data, style and script in one file.

use crate::display::{self, Display};
use crate::escape::{self, html};
use crate::indicators::{self, Indicators};
use crate::lookup::Lookup;
use crate::map::{self, Map, MapData};
use crate::series::{self, Flagged, Plot, Plots};
use crate::sites::SiteGraph;
use crate::tables;
use anergy_core::recorder::{Event, Recording, Severity};
use serde::Serialize;

const UPLOT_JS: &str = include_str!("../vendor/uplot-1.6.32/uPlot.iife.min.js");
const UPLOT_CSS: &str = include_str!("../vendor/uplot-1.6.32/uPlot.min.css");
const CSS: &str = include_str!("../assets/report.css");
const SCRIPTS: [&str; 4] = [
    include_str!("../assets/map.js"),
    include_str!("../assets/plots.js"),
    include_str!("../assets/indicators.js"),
    include_str!("../assets/report.js"),
];
/// Settings that stand at the top; all of them are among the details.
const RUN_SETTINGS: usize = 8;
/// The browser refuses every load: the report is complete without a network.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      img-src data:; base-uri 'none'; form-action 'none'";

/// What the script reads.
#[derive(Serialize)]
struct Data<'a> {
    start_unix_ms: Option<f64>,
    end_s: f64,
    density_kg_m3: f64,
    units: Units,
    /// Times of the points of the plots, s, base64 of 64-bit floats.
    times: String,
    plots: &'a [Plot],
    flagged: &'a [Flagged],
    map: &'a MapData,
    indicators: Vec<Indicators>,
}

/// Display units of the map.
#[derive(Serialize)]
struct Units {
    flow: Display,
    pressure: Display,
    temperature: Display,
    heat: Display,
    velocity: Display,
}

/// The whole document.
pub fn page(recording: &Recording) -> String {
    let parts = Parts::new(recording);
    let name = match recording.header.model_name.trim() {
        "" => "Unnamed model",
        name => name,
    };
    let mut out = format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title} · anergy report</title>
<style>{UPLOT_CSS}
{CSS}</style>
</head>
<body data-anergy-report="1" data-rows="{rows}" data-sites="{sites}" data-summary="{summary}">
{head}<main>
<div class="columns">
{key_numbers}{run}</div>
"#,
        title = html(name),
        rows = recording.time_s.len(),
        sites = parts.sites.vertices.len(),
        summary = if recording.summary.is_null() { "missing" } else { "present" },
        head = parts.head(name),
        key_numbers = section("key", "Key numbers", &tables::key_numbers(&recording.summary)),
        run = section("run", "Run", &parts.run()),
    );
    out += &parts.timed();
    out += &section("indicators", "Indicators", &indicators::section(&recording.summary));
    out += &section(
        "balances",
        "Balances",
        &(tables::balances(&recording.summary) + &tables::pipes(&recording.summary)),
    );
    out += &section("events", "Events", &tables::events(recording));
    out += &section("more", "Details", &details(recording));
    out += &format!(
        r#"</main>
<noscript><p class="notice">Map, plots and indicators need JavaScript; the other tables do not.</p></noscript>
<footer>Made by anergy. This file is complete: it loads nothing from a network. Plots by uPlot 1.6.32 (MIT).</footer>
<script type="application/json" id="anergy-data">{data}</script>
<script>{UPLOT_JS}</script>
"#,
        data = escape::json(&parts.data()),
    );
    for script in SCRIPTS {
        out += &format!("<script>\n{script}</script>\n");
    }
    out + "</body>\n</html>\n"
}

fn section(id: &str, title: &str, body: &str) -> String {
    format!(
        r#"<section aria-labelledby="h-{id}"><h2 id="h-{id}">{title}</h2>
{body}</section>
"#
    )
}

/// The recording as the page shows it.
struct Parts<'a> {
    recording: &'a Recording,
    lookup: Lookup<'a>,
    sites: SiteGraph,
    flagged: Vec<Flagged>,
    density_kg_m3: f64,
    plots: Plots,
    map: Map,
}

impl<'a> Parts<'a> {
    fn new(recording: &'a Recording) -> Self {
        let lookup = Lookup::new(recording);
        let sites = SiteGraph::new(&lookup);
        let flagged = series::flagged(&lookup, &sites);
        let density_kg_m3 = display::density_kg_m3(&recording.header.settings);
        let plots = series::plots(&lookup, &sites, &flagged, density_kg_m3);
        let map = map::map(&lookup, &sites);
        Self { recording, lookup, sites, flagged, density_kg_m3, plots, map }
    }

    fn data(&self) -> Data<'_> {
        let start = self.recording.header.start_unix_ns;
        Data {
            start_unix_ms: (start != 0).then_some(start as f64 / 1e6),
            end_s: self.lookup.times().last().copied().unwrap_or(0.0),
            density_kg_m3: self.density_kg_m3,
            units: Units {
                flow: Display::flow(self.density_kg_m3),
                pressure: Display::pressure(),
                temperature: Display::temperature(),
                heat: Display::heat(),
                velocity: Display::velocity(),
            },
            times: escape::base64_f64(&self.plots.times),
            plots: &self.plots.plots,
            flagged: &self.flagged,
            map: &self.map.data,
            indicators: indicators::tables(&self.recording.summary),
        }
    }

    fn head(&self, name: &str) -> String {
        let header = &self.recording.header;
        let mut line = Vec::new();
        if let Some(end) = self.lookup.times().last() {
            line.push(format!("{} simulated", display::seconds(*end)));
        }
        if header.start_unix_ns != 0 {
            line.push(format!("from {}", display::calendar(header.start_unix_ns)));
        }
        let warning = |event: &&Event| event.severity == Severity::Warning;
        match self.recording.events.iter().filter(warning).count() {
            0 => {}
            1 => line.push("1 warning".to_owned()),
            many => line.push(format!("{many} warnings")),
        }
        let mut out = format!(
            r#"<header><p class="kicker">anergy · simulation report</p><h1>{}</h1><p class="sub">{}</p>"#,
            html(name),
            line.join(" · ")
        );
        let mut notice = |id: &str, text: &str| {
            out += &format!(r#"<p class="notice" data-notice="{id}">{text}</p>"#);
        };
        if self.recording.time_s.is_empty() {
            notice("empty", "The recording has no rows: there is nothing to plot.");
        }
        if self.recording.summary.is_null() {
            notice(
                "interrupted",
                "<strong>The run did not reach its end.</strong> Key numbers and balances are missing; \
                 everything up to the last recorded row is shown.",
            );
        }
        let rows = self.lookup.rows;
        if rows < self.recording.time_s.len() {
            notice(
                "time",
                &format!("Time does not go on after row {rows}: later rows are not shown."),
            );
        }
        out + "</header>\n"
    }

    fn run(&self) -> String {
        let header = &self.recording.header;
        let stations: usize = self.sites.vertices.iter().map(|vertex| vertex.stations.len()).sum();
        let mut own = vec![("recorded rows", self.recording.time_s.len().to_string())];
        if stations > 0 {
            own.push(("stations", stations.to_string()));
        }
        own.push(("nodes", header.map.nodes.len().to_string()));
        own.push(("edges", header.map.edges.len().to_string()));
        let first = header.settings.iter().take(RUN_SETTINGS);
        let settings = first.map(|(name, value)| (name.as_str(), value.clone()));
        tables::pairs("run", own.into_iter().chain(settings))
    }

    /// Slider, map and plots: what shows the same moment.
    fn timed(&self) -> String {
        let mut out = format!(
            r#"<div class="timed">
<div class="clock" role="group" aria-label="Time">
<button type="button" id="play" aria-label="Play"{off}><svg viewBox="0 0 16 16" aria-hidden="true">
<path class="go" d="M4 2.5v11l9.5-5.5z"/><path class="hold" d="M3.5 2.5h3.2v11H3.5zM9.3 2.5h3.2v11H9.3z"/></svg></button>
<input type="range" id="time" min="0" max="{last}" step="1" value="0" autocomplete="off" aria-label="Time of the map"{off}>
<output id="now" for="time">–</output>
</div>
"#,
            off = if self.map.frames < 2 { " disabled" } else { "" },
            last = self.map.frames.saturating_sub(1),
        );
        out += &section("map", "Network", &self.figure());
        for plot in &self.plots.plots {
            out += &plot_section(plot);
        }
        out += &format!(
            "<p class=\"note\" data-notes>{}</p>\n</div>\n",
            html(&self.notes().join(" "))
        );
        out
    }

    fn figure(&self) -> String {
        let none = if self.sites.vertices.is_empty() {
            r#"<p class="none">The recording has no network map.</p>"#
        } else {
            ""
        };
        let stations = if self.sites.vertices.iter().any(|vertex| !vertex.stations.is_empty()) {
            r#"<span><b>↑</b> feeds in, <b>↓</b> extracts</span>
<span class="blocked-key"><i aria-hidden="true"></i> blocked</span>"#
        } else {
            ""
        };
        let placed = if self.sites.surveyed {
            "Positions of the model"
        } else {
            "Schematic, placed by pipe lengths"
        };
        format!(
            r#"{none}<div class="choose"><label>Colour <select id="quantity" autocomplete="off"><option value="temperature">Temperature</option><option value="flow">Flow</option><option value="pressure">Pressure</option><option value="velocity">Velocity</option></select></label>
<label class="find">Find <input id="find" type="search" list="places" placeholder="a site or pipe" autocomplete="off"><datalist id="places"></datalist></label><span id="found" role="status"></span></div>
<figure class="map"><div class="tools">
<button type="button" id="zoom-in" aria-label="Zoom in">+</button>
<button type="button" id="zoom-out" aria-label="Zoom out">−</button>
<button type="button" id="zoom-all" aria-label="Show all">⤢</button></div>
<div class="canvas">{svg}</div>
<figcaption><span id="map-time"></span>
<span class="scale" aria-label="Colours"><span id="c-name"></span><span id="c-min">–</span><span class="bar" id="c-bar" aria-hidden="true"></span><span id="c-max">–</span></span>
<span>Width of a line: flow, at most <span id="flow-max">–</span></span>
{stations}
<span>{placed}</span></figcaption></figure><div id="tip" role="tooltip" hidden></div>"#,
            svg = self.map.svg,
        )
    }

    /// How to read and use map and plots.
    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let mut note = |text: &str| notes.push(text.to_owned());
        let is = |blocked: bool| self.flagged.iter().any(|f| (f.kind == "blocked") == blocked);
        if is(true) {
            note(
                "Shaded in orange: a station that is drawn is blocked; the bar on top has its colour.",
            );
        }
        if is(false) {
            note(
                "Shaded in violet: a pump of a place that is drawn hunts against others, with a full bar on \
                 top, or oscillates alone, with a broken bar.",
            );
        }
        note(
            "Drag in a plot to zoom all of them, double-click to show all. A click sets the time of the map.",
        );
        if self.sites.vertices.len() > 1 {
            note("A click on a site of the map adds its curves to the plots.");
        }
        note(&format!(
            "Volume flows are mass flows at {} kg/m³.",
            display::number(self.density_kg_m3)
        ));
        if self.plots.decimated {
            note("Curves show the least and greatest value of each interval of rows.");
        }
        if self.map.frames < self.lookup.rows {
            note(&format!("The map has {} of {} rows.", self.map.frames, self.lookup.rows));
        }
        let panels = self.plots.plots.iter().flat_map(|plot| &plot.panels);
        let left_out: usize = panels.map(|panel| panel.left_out).sum();
        if left_out > 0 {
            note(&format!(
                "{left_out} series with little change are left out to keep the file small."
            ));
        }
        notes
    }
}

/// The place of a plot; the script draws it.
fn plot_section(plot: &Plot) -> String {
    let count: usize = plot.panels.iter().map(|panel| panel.series.len()).sum();
    let text = match (count, plot.note) {
        (0, _) => r#"<p class="none">Not recorded in this run.</p>"#.to_owned(),
        (_, "") => String::new(),
        (_, note) => format!(r#"<p class="note">{}</p>"#, html(note)),
    };
    format!(
        r#"<section class="plot" data-plot="{id}" data-series="{count}" aria-labelledby="h-{id}"><h2 id="h-{id}">{title}</h2>{text}</section>
"#,
        id = plot.id,
        title = plot.title,
    )
}

fn details(recording: &Recording) -> String {
    let settings = &recording.header.settings;
    let settings = settings.iter().map(|(name, value)| (name.as_str(), value.clone()));
    format!(
        r#"<details data-print="open"><summary>Settings, versions and statistics</summary>{}{}</details>
<details id="model-file"><summary>Model file</summary><p class="actions"><button type="button" id="copy-model">Copy</button><button type="button" id="save-model">Save as model.toml</button><span id="model-done" role="status"></span></p><pre data-model tabindex="0">{}</pre></details>
<details><summary>Recorded channels ({})</summary>{}</details>"#,
        tables::pairs("settings", settings),
        tables::statistics(&recording.summary),
        html(&recording.header.model_text),
        recording.channels.len(),
        tables::channels(recording),
    )
}
