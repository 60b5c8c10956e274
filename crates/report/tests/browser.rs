//! The report as a browser shows it: what is drawn, what moves, that nothing fails and nothing is loaded.
//!
//! Needs Chromium (`CHROMIUM` names it, else `chromium`, `chromium-browser` or `google-chrome` of the path). Without
//! one the tests say so and pass, unless `ANERGY_REQUIRE_CHROMIUM` is set.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stderr)]

#[allow(dead_code, reason = "shared with the other tests of the report")]
mod synthetic;

use anergy_core::recorder::Recording;
use anergy_report::html;
use serde_json::Value;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Collects what goes wrong, from before the first script of the page on.
const WATCH: &str = r#"<script>
window.problems = [];
window.addEventListener("error", (event) => problems.push(`error: ${event.message}`));
window.addEventListener("unhandledrejection", (event) => problems.push(`rejected: ${event.reason}`));
window.addEventListener("securitypolicyviolation", (event) => problems.push(`load: ${event.blockedURI}`));
for (const word of ["error", "warn"]) console[word] = (...what) => problems.push(`${word}: ${what.join(" ")}`);
HTMLAnchorElement.prototype.click = function () { window.saved = [this.download, this.href.slice(0, 5)]; };
window.alert = (what) => problems.push(`alert: ${what}`);
</script>"#;

/// Uses the page like somebody who reads it, and writes down what it shows.
const USE: &str = r#"<script>
addEventListener("load", async () => {
  const wait = () => new Promise((done) => setTimeout(done, 60));
  const all = (what) => [...document.querySelectorAll(what)];
  const svg = document.querySelector("svg[data-map]");
  const colours = () => all("svg[data-map] stop").map((stop) => stop.getAttribute("stop-color")).join();
  const set = async (id, value, event) => {
    const input = document.getElementById(id);
    input.value = value;
    input.dispatchEvent(new Event(event));
    await wait();
  };
  await wait();
  const slider = document.getElementById("time");
  const seen = { ready: document.body.dataset.ready, frames: Number(slider.max) };
  seen.sites = svg.querySelectorAll("[data-site]").length;
  seen.lines = svg.querySelectorAll("[data-line]").length;
  seen.end = { now: document.getElementById("now").textContent, colours: colours(), frame: svg.dataset.frame };
  await set("time", 0, "input");
  seen.start = { now: document.getElementById("now").textContent, colours: colours(), frame: svg.dataset.frame };
  seen.legend = {};
  for (const word of ["flow", "pressure", "velocity", "temperature"]) {
    await set("quantity", word, "change");
    const text = (id) => document.getElementById(id).textContent;
    seen.legend[word] = { min: text("c-min"), max: text("c-max"), colours: colours(), name: text("c-name") };
  }
  const inked = (canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.some((value) => value > 0);
  };
  seen.panels = all(".panel").length;
  seen.drawn = all(".panel").filter((panel) => Number(panel.dataset.drawn) > 0).length;
  seen.inked = all(".panel canvas").filter(inked).length;
  const { name } = JSON.parse(document.getElementById("anergy-data").textContent).map.vertices[seen.sites - 1];
  const chips = all(".chip").length;
  await set("find", name.toUpperCase(), "change");
  seen.found = { wanted: name, got: svg.dataset.found, chips: all(".chip").length - chips };
  seen.view = svg.getAttribute("viewBox");
  for (const box of all("details")) box.open = true;
  await wait();
  seen.tables = {};
  for (const table of all("table[data-found]")) {
    const filter = table.closest("details").querySelector("input[type=search]");
    if (filter) {
      filter.value = "7";
      filter.dispatchEvent(new Event("input"));
    }
    const last = [...table.tHead.querySelectorAll("button")].pop();
    last.click();
    seen.tables[table.dataset.table] = {
      found: Number(table.dataset.found),
      rows: table.tBodies[0].rows.length,
      sorted: [...table.tBodies[0].rows].map((row) => row.lastElementChild.textContent),
    };
  }
  document.getElementById("save-model").click();
  seen.saved = saved;
  document.getElementById("zoom-all").click();
  window.dispatchEvent(new Event("beforeprint"));
  await wait();
  window.dispatchEvent(new Event("afterprint"));
  seen.model = document.querySelector("pre[data-model]").textContent;
  seen.images = document.images.length;
  seen.requests = performance.getEntriesByType("resource").map((entry) => entry.name);
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.problems = problems;
  const result = document.createElement("script");
  result.type = "application/json";
  result.id = "seen";
  result.textContent = JSON.stringify(seen).replaceAll("<", "\\u003c");
  document.body.append(result);
});
</script>"#;

/// The browser, if there is one.
fn chromium() -> Option<String> {
    let names = std::env::var("CHROMIUM").into_iter();
    let names = names.chain(["chromium", "chromium-browser", "google-chrome"].map(str::to_owned));
    let works = |name: &String| {
        let version = Command::new(name).arg("--version").stderr(Stdio::null()).output();
        version.is_ok_and(|output| output.status.success())
    };
    let found = names.into_iter().find(works);
    if found.is_none() {
        let required = std::env::var_os("ANERGY_REQUIRE_CHROMIUM").is_some();
        assert!(!required, "ANERGY_REQUIRE_CHROMIUM is set, and there is no Chromium");
        eprintln!("skipped: there is no Chromium to show the report in");
    }
    found
}

/// One browser at a time: several that start together now and then wait for each other for ever.
static ALONE: Mutex<()> = Mutex::new(());
/// Longest time until a page was used to its end.
const PATIENCE: Duration = Duration::from_secs(60);

/// What the browser shows of a report; `None` without a browser.
fn seen(recording: &Recording, window: &str) -> Option<Value> {
    let browser = chromium()?;
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    let page = html(recording)
        .replacen("<head>", &format!("<head>{WATCH}"), 1)
        .replace("</body>\n</html>", &format!("{USE}</body>\n</html>"));
    let path = folder.path().join("report.html");
    std::fs::write(&path, page).unwrap();
    let dom = folder.path().join("dom.html");
    let mut child = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"])
        .args(["--virtual-time-budget=20000", "--dump-dom", &format!("--window-size={window}")])
        .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
        .arg(format!("file://{}", path.display()))
        .stdout(std::fs::File::create(&dom).unwrap())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("the browser does not finish within {PATIENCE:?}");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let dom = std::fs::read_to_string(dom).unwrap();
    let (_, rest) = dom.rsplit_once(r#"id="seen">"#).expect("the page was used to its end");
    let (text, _) = rest.split_once("</script>").unwrap();
    Some(serde_json::from_str(text).unwrap())
}

/// What holds for every report.
fn is_sound(seen: &Value) {
    assert_eq!(seen["problems"], serde_json::json!([]));
    assert_eq!(seen["requests"], serde_json::json!([]), "nothing is loaded");
    assert_eq!(seen["saved"], serde_json::json!(["model.toml", "blob:"]));
    assert_eq!(seen["images"], 0);
    assert_eq!(seen["ready"], "1");
    assert_eq!(seen["wide"], 0, "nothing stands out at the right");
    assert_eq!(seen["panels"], seen["drawn"]);
    assert_eq!(seen["panels"], seen["inked"]);
    assert!(seen["panels"].as_u64().unwrap() >= 4, "{}", seen["panels"]);
    assert_ne!(seen["start"]["now"], seen["end"]["now"]);
    assert_ne!(seen["start"]["colours"], seen["end"]["colours"], "the slider moves the map");
    assert_eq!(seen["start"]["frame"], "0");
    let legend = &seen["legend"];
    assert_eq!(legend["velocity"]["name"], "Velocity");
    for word in ["flow", "pressure", "velocity"] {
        assert_ne!(legend[word]["colours"], legend["temperature"]["colours"], "{word}");
        assert_ne!(legend[word]["max"], legend["temperature"]["max"], "{word}");
    }
    assert!(legend["velocity"]["max"].as_str().unwrap().ends_with(" m/s"));
    assert_eq!(seen["found"]["wanted"], seen["found"]["got"]);
}

#[test]
fn three_houses_in_a_browser() {
    for window in ["1280,1000", "390,800"] {
        let Some(seen) = seen(&synthetic::three_houses(), window) else { return };
        is_sound(&seen);
        assert_eq!((seen["sites"].as_u64(), seen["lines"].as_u64()), (Some(3), Some(4)));
        assert_eq!((&seen["end"]["frame"], seen["frames"].as_u64()), (&"360".into(), Some(360)));
        assert_eq!(seen["end"]["now"], "1 h");
        assert_eq!(seen["model"], synthetic::three_houses().header.model_text);
    }
}

#[test]
fn hostile_names_in_a_browser() {
    let Some(seen) = seen(&synthetic::hostile(), "1280,1000") else { return };
    is_sound(&seen);
    let model = synthetic::hostile().header.model_text;
    assert_eq!(seen["model"].as_str().unwrap(), model.replace('\0', "\u{fffd}"));
}

#[test]
fn a_thousand_consumers_and_a_million_points_in_a_browser() {
    let mut recording = synthetic::district(1000, 150);
    let kpis = (0..1000).map(|i| {
        (format!("h{i:04}.station"), serde_json::json!({"heat_taken_kwh": (i * 7) % 1000}))
    });
    recording.summary["kpis"] =
        serde_json::json!({ "stations": kpis.collect::<serde_json::Map<_, _>>() });
    let points = recording.columns.len() * recording.time_s.len();
    assert!(points > 1_000_000, "{points}");
    let page = html(&recording);
    assert!(page.len() < 25_000_000, "{}", page.len());
    let Some(seen) = seen(&recording, "1280,1000") else { return };
    is_sound(&seen);
    assert!(seen["sites"].as_u64().unwrap() >= 1000 && seen["frames"].as_u64().unwrap() >= 23);
    assert!(seen["found"]["chips"].as_u64().unwrap() > 0, "a name that is found has its curves");
    assert_ne!(seen["view"], "0 0 1000 640", "the map goes to what is found");
    let table = &seen["tables"]["stations"];
    // Names with a 7: 1000 - 9^3 = 271; the largest first.
    assert_eq!((table["found"].as_u64(), table["rows"].as_u64()), (Some(271), Some(50)));
    let sorted: Vec<f64> = table["sorted"]
        .as_array()
        .unwrap()
        .iter()
        .map(|n| n.as_str().unwrap().parse().unwrap())
        .collect();
    assert!(sorted.is_sorted_by(|a, b| a >= b) && sorted[0] > sorted[49], "{sorted:?}");
}
