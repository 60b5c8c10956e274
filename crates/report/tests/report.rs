//! What every report must be: self-contained, inert, complete, deterministic.

mod synthetic;

use anergy_core::clock::Time;
use anergy_core::recorder::{Event, Recording, Severity};
use anergy_report::html;
use serde_json::Value;
use sha2::{Digest, Sha256};

const SCRIPTS: usize = 6;

/// The embedded data.
#[allow(clippy::unwrap_used, reason = "a helper of tests")]
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"id="anergy-data">"#).unwrap();
    let (text, _) = rest.split_once("</script>").unwrap();
    serde_json::from_str(text).unwrap()
}

#[test]
fn loads_nothing_from_a_network() {
    let page = html(&synthetic::three_houses());
    for load in
        [" src=", " href=", "@import", "url(\"", "url(h", "fetch(", "XMLHttpRequest", "import("]
    {
        assert!(!page.contains(load), "{load}");
    }
    for (at, _) in page.match_indices("http") {
        let rest = &page[at..];
        let known =
            ["http://www.w3.org/2000/svg", "https://github.com/leeoniya/uPlot", "http-equiv"];
        assert!(known.iter().any(|text| rest.starts_with(text)), "{}", &rest[..60]);
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn map_plots_and_tables_are_there() {
    let page = html(&synthetic::three_houses());
    assert!(page.contains("<body data-anergy-report=\"1\" data-rows=\"361\" data-sites=\"3\" data-summary=\"present\">"));
    assert!(page.contains("<svg data-map=\"network\" data-sites=\"3\" data-lines=\"4\""));
    for plot in ["flows", "pressures", "temperatures", "heat", "speeds"] {
        assert!(page.contains(&format!("data-plot=\"{plot}\"")), "{plot}");
    }
    for table in ["key-numbers", "balances", "pipes", "events", "channels"] {
        assert!(page.contains(&format!("data-table=\"{table}\"")), "{table}");
    }
    assert!(page.contains("uPlot (v1.6.32)"));
    let data = data(&page);
    let flows = &data["plots"][0]["panels"][0]["series"];
    assert_eq!(flows.as_array().unwrap().len(), 6, "three flows and three requests");
    assert_eq!(data["plots"][1]["panels"][1]["series"][0]["name"], "sf1");
    assert_eq!(data["flagged"][0]["from"], 60.0);
    assert_eq!(data["flagged"][0]["to"], 2245.0);
    assert!(!page.contains("data-notice"));
}

#[test]
fn hostile_text_is_inert() {
    let (evil, recording) = (synthetic::EVIL, synthetic::hostile());
    let site = format!("{evil}site");
    let page = html(&recording);
    assert_eq!(page.matches("<script").count(), SCRIPTS);
    assert_eq!(page.matches("</script").count(), SCRIPTS);
    for raw in ["<img", "<b>", "onfocus=\"", "<!--", "-->"] {
        let harmless = html(&synthetic::three_houses());
        assert_eq!(page.matches(raw).count(), harmless.matches(raw).count(), "{raw}");
    }
    let data = data(&page);
    let names: Vec<&str> = data["map"]["vertices"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|v| v["name"].as_str())
        .collect();
    assert!(names.contains(&evil) && names.contains(&site.as_str()), "{names:?}");
}

#[test]
fn unusual_recordings_give_a_report() {
    let empty = html(&Recording::default());
    assert!(empty.contains("data-rows=\"0\"") && empty.contains("data-notice=\"empty\""));
    for plot in ["flows", "pressures", "temperatures", "heat", "speeds"] {
        assert!(empty.contains(&format!("data-plot=\"{plot}\" data-series=\"0\"")), "{plot}");
    }
    let mut interrupted = synthetic::three_houses();
    interrupted.summary = Value::Null;
    let page = html(&interrupted);
    assert!(page.contains("data-summary=\"missing\"") && page.contains("did not reach its end"));

    let mut strange = synthetic::three_houses();
    for column in &mut strange.columns {
        column.truncate(17);
        column[3] = f64::NAN;
        column[4] = f64::INFINITY;
    }
    strange.columns.truncate(20);
    strange.time_s[200] = f64::NAN;
    let page = html(&strange);
    assert!(page.contains("data-notice=\"time\""));
    html(&synthetic::plain(1));
    html(&synthetic::plain(2));
}

#[test]
fn plain_networks_show_pumps() {
    let data = data(&html(&synthetic::plain(3)));
    assert_eq!(data["plots"][0]["panels"][0]["series"][0]["name"], "pump");
    assert_eq!(data["plots"][4]["panels"][0]["series"][0]["name"], "pump");
    assert_eq!(data["map"]["edges"].as_array().unwrap().len(), 4);
}

#[test]
fn junctions_of_two_lines_are_one_symbol() {
    let page = html(&synthetic::ring());
    // 6 sites, 6 junctions, 1 plain node; 24 pipes, a pump and a heat exchanger.
    assert!(page.contains(r#"data-sites="13" data-lines="26""#));
}

#[test]
fn many_sites_stay_small_and_show_a_few() {
    let page = html(&synthetic::district(1000, 3000));
    assert!(page.len() < 20_000_000, "{}", page.len());
    let data = data(&page);
    for plot in data["plots"].as_array().unwrap() {
        for panel in plot["panels"].as_array().unwrap() {
            let series = panel["series"].as_array().unwrap();
            let shown = series.iter().filter(|series| series["shown"] == true).count();
            assert!((1..=12).contains(&shown) && series.len() >= 1000, "{}", plot["id"]);
        }
    }
    // Blocked stations come first.
    let flows = data["plots"][0]["panels"][0]["series"].as_array().unwrap();
    let shown = flows.iter().find(|series| series["shown"] == true).unwrap();
    assert_eq!(shown["key"], "h0007");
}

#[test]
fn same_recording_same_bytes() {
    assert_eq!(html(&synthetic::three_houses()), html(&synthetic::three_houses()));
    assert_eq!(html(&synthetic::district(320, 10)), html(&synthetic::district(320, 10)));
}

#[test]
fn vendored_uplot_is_the_stated_one() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/vendor/uplot-1.6.32");
    let readme = std::fs::read_to_string(format!("{folder}/README.md")).unwrap();
    for (file, sha256) in [
        ("uPlot.iife.min.js", "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f"),
        ("uPlot.min.css", "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04"),
        ("LICENSE", "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd"),
    ] {
        let content = std::fs::read(format!("{folder}/{file}")).unwrap();
        let sum: String =
            Sha256::digest(&content).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(sum, sha256, "{file}");
        assert!(
            readme.contains(&format!("| `{file}` | {} | `{sha256}` |", content.len())),
            "{file}"
        );
    }
}

#[test]
fn indicators_and_heat_are_shown() {
    let mut recording = synthetic::three_houses();
    recording.summary["kpis"] = serde_json::json!({
        "network": {"heat_lost_kwh": 4.25},
        "stations": {"sf1.station": {"blocked_h": 0.6}, "sf2.station": {"heat_given_kwh": 9.4}},
        "units": {synthetic::EVIL: {"starts": 3}},
    });
    let page = html(&recording);
    assert!(page.contains("<dt>heat lost</dt><dd>4.25 kWh</dd>"));
    assert!(page.contains(r#"data-indicators="stations""#) && page.contains("Units (1)"));
    let data = data(&page);
    assert_eq!(data["indicators"][0]["columns"][0]["name"], "blocked");
    assert_eq!(data["indicators"][1]["rows"][0][0], synthetic::EVIL);
    assert_eq!(data["plots"][3]["id"], "heat");
    assert_eq!(data["plots"][3]["panels"][0]["series"][0]["name"], "sf1.station");
}

#[test]
fn spans_of_swinging_pumps_are_flagged() {
    let mut recording = synthetic::three_houses();
    recording.events.clear();
    for (time_s, kind) in [
        (100.0, "oscillating"),
        (130.0, "hunting"),
        (300.0, "hunting_ended"),
        (400.0, "oscillating"),
        (500.0, "oscillating_ended"),
        (600.0, "hunting"),
    ] {
        recording.events.push(Event {
            time: Time::from_s(time_s).unwrap(),
            severity: Severity::Warning,
            component: "sf2.feed_in_pump".to_owned(),
            kind: kind.to_owned(),
            message: String::new(),
        });
    }
    let page = html(&recording);
    assert!(page.contains("Shaded in violet"));
    assert!(!html(&synthetic::three_houses()).contains("Shaded in violet"));
    let spans: Vec<_> = data(&page)["flagged"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|span| span["kind"] != "blocked")
        .map(|span| {
            assert_eq!(span["key"], "sf2");
            (span["kind"].clone(), span["from"].as_f64(), span["to"].as_f64())
        })
        .collect();
    assert_eq!(
        spans,
        [
            ("oscillating".into(), Some(100.0), Some(130.0)),
            ("hunting".into(), Some(130.0), Some(300.0)),
            ("oscillating".into(), Some(400.0), Some(500.0)),
            ("hunting".into(), Some(600.0), None),
        ]
    );
}
