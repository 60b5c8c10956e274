//! The invariants of the architecture that can be checked by reading files: who may depend on whom,
//! where foreign crates may appear, no IO in the core, names that say something, files that stay short,
//! units in public names.

#![allow(clippy::unwrap_used)]

use anergy_core::units::SI_SUFFIXES;
use anergy_tests::workspace;
use std::path::{Path, PathBuf};

/// Which crates of the workspace a crate may depend on, also in its tests. `network` and `prosumer`
/// never know each other.
const ALLOWED: &[(&str, &[&str])] = &[
    ("core", &[]),
    ("network", &["core"]),
    ("prosumer", &["core"]),
    ("control", &["core"]),
    ("recording", &["core"]),
    ("report", &["core"]),
    ("import", &["core"]),
    ("ems", &["core", "prosumer", "control"]),
    ("simulation", &["core", "network", "prosumer", "control", "ems"]),
    ("discrepancy", &["core", "network", "prosumer", "simulation", "recording", "report"]),
    ("ensemble", &["core", "simulation", "recording"]),
    ("cli", &EVERYTHING),
    ("py", &EVERYTHING),
];

/// For what stands on top.
const EVERYTHING: [&str; 11] = [
    "import",
    "core",
    "network",
    "prosumer",
    "control",
    "recording",
    "report",
    "ems",
    "simulation",
    "discrepancy",
    "ensemble",
];

/// Foreign crates that one crate of ours wraps.
const WRAPPED: &[(&str, &str)] = &[
    ("faer", "core"),
    ("clarabel", "ems"),
    ("mcap", "recording"),
    ("arrow-array", "py"),
    ("arrow-schema", "py"),
    ("pyo3", "py"),
    ("numpy", "py"),
];

/// The one file that knows the linear algebra.
const LINEAR_ALGEBRA: &str = "crates/core/src/numerics/sparse.rs";

/// The crates without input and output: everything they know they are given.
const PURE: &[&str] = &["core", "network", "prosumer", "control"];

/// Words of input, output and clocks. The type of an error that a recorder hands on is none of them.
const IMPURE: &[&str] = &[
    "std::fs",
    "std::io",
    "std::env",
    "std::net",
    "std::process",
    "File::",
    "println!",
    "eprintln!",
    "print!",
    "eprint!",
    "dbg!",
    "stdout",
    "stderr",
    "Instant",
    "SystemTime",
];
const ERROR_TYPE: &str = "std::io::Error";

/// Names that do not say what is inside.
const EMPTY_NAMES: &[&str] = &["util", "utils", "helper", "helpers", "common", "misc"];

/// Lines of a source file without its tests.
const LONGEST_FILE: usize = 400;

/// Suffixes of SI units besides those that a model file converts.
const MORE_SUFFIXES: &[&str] = &["m_s2"];

/// Public numbers without a unit suffix, and why they need none.
const WITHOUT_SUFFIX: &[&str] = &[
    // Ratios.
    "a2",
    "albedo",
    "b0",
    "base_share",
    "charge_efficiency",
    "circulation",
    "cold",
    "discharge_efficiency",
    "electric_efficiency",
    "electric_efficiency_min",
    "eta0",
    "fuel",
    "gain_share",
    "initial_soc",
    "k_diffuse",
    "power_factor",
    "power_slope",
    "rod_modulation",
    "season_amplitude",
    "soc_max",
    "soc_min",
    "start_flow",
    "stop_heat",
    "system_efficiency",
    "table_efficiency",
    "total_efficiency",
    "weekend_absence",
    "weekend_factor",
    "workday_absence",
    "alpha",
    "ceiling_insulated_share",
    "delta_m",
    "emitter_radiative",
    "efficiency",
    "efficiency_hydraulic",
    "efficiency_motor",
    "equal_capacity_band",
    "heat_to_water",
    "incidence_cosine",
    "kappa",
    "leakage",
    "long_share",
    "loss_factor",
    "heat_loss_factor",
    "factor",
    "friction_factor",
    "prandtl",
    "standstill_loss_factor",
    "wall_film_factor",
    "of_inlet",
    "open",
    "opening",
    "valve_cooling",
    "valve_heating",
    "valve_middle",
    "valve_top",
    "initial_opening",
    "switch_at",
    "rangeability",
    "speed",
    "initial_speed",
    "speed_max",
    "speed_min",
    "table_opening",
    "threshold_speed",
    "table_phi",
    "wall_insulated_share",
    "window_g",
    "window_shading",
    "window_share",
    "zero_flow_share",
    "zeta",
    // Heat pumps: shares, ratios of heat and electricity, counts.
    "aux_modulation",
    // Branches of a coupling: ratios of pressure losses, shares.
    "idle_opening",
    "resistance",
    "suction",
    // Factors over the map of a generator; share and Richardson number of a jet.
    "efficiency_factor",
    "part_load_factor",
    "jet_share",
    "jet_richardson",
    "carnot_share",
    "cop",
    "cop_max",
    "cop_nominal",
    "defrosting",
    "eer",
    "eer_nominal",
    "enable",
    "flow",
    "flow_on",
    "frost_rate",
    "heat",
    "heat_at_stop",
    "heat_share",
    "ground_share",
    "heat_slope",
    "hplib_power_coefficients",
    "hplib_ratio_coefficients",
    "least_modulation",
    "mode",
    "modulation",
    "flow_ratio",
    "modulation_min",
    "on",
    "part_load_gain",
    "power",
    "power_at_stop",
    "ratio_max",
    "relative_humidity",
    "share",
    "size_factor",
    "start_heat",
    "start_power",
    "starts",
    "stretch",
    "warm_scale",
    "warm_start_share",
    // Exponents, empirical coefficients and those of mixed units.
    "exponent",
    "curve_exponent",
    "emitter_exponent",
    "curve_polynomial",
    "flow_exponent",
    "difference_exponent",
    "coefficient",
    "hazen_williams_c",
    "manning_n",
    // Counts.
    "floors",
    "inhabitants",
    // The unit is that of the signal, the channel, the position or the law they belong to.
    "at_zero",
    "band",
    "columns",
    "dead_band",
    "gain",
    "initial",
    "initial_command",
    "initial_output",
    "initial_position",
    "feed_in_primary_gain",
    "feed_in_primary_alpha",
    "feed_in_secondary_alpha",
    "extraction_primary_gain",
    "extraction_primary_alpha",
    "extraction_secondary_alpha",
    "kappa_min",
    "kappa_max",
    "start_share",
    "inner_gain",
    "inner_set_initial",
    "inner_set_max",
    "inner_set_min",
    "limits",
    "max",
    "measured",
    "min",
    "miss",
    "noise",
    "off_output",
    "offset",
    "on_output",
    "safe_output",
    "wanted",
    "wanted_min",
    "wanted_max",
    "output_max",
    "output_min",
    "position",
    "resolution",
    "scale",
    "schedule_factor",
    "schedule_output",
    "set_point",
    "set_points",
    "slope",
    "value",
    // Kv is defined in m3/h at 1 bar.
    "kv_m3_h",
    "kvs_m3_h",
];

/// A file of the workspace.
struct Source {
    /// Path from the root, with slashes.
    path: String,
    text: String,
}

impl Source {
    /// The text without its `#[cfg(test)]` module at the end.
    fn without_tests(&self) -> &str {
        let start = self.text.find("\n#[cfg(test)]\nmod tests {").or_else(|| {
            // A file that is a test module of another one.
            let name = self.path.rsplit('/').next().unwrap_or_default();
            (name == "tests.rs" || self.path.contains("/src/tests/")).then_some(0)
        });
        &self.text[..start.unwrap_or(self.text.len())]
    }

    /// Lines, counted from 1, in which `wrong` finds something.
    fn places(&self, text: &str, wrong: impl Fn(&str) -> bool) -> Vec<String> {
        let lines = text.lines().enumerate().filter(|(_, line)| wrong(line));
        lines.map(|(i, line)| format!("{}:{}: {}", self.path, i + 1, line.trim())).collect()
    }
}

/// All files below a folder, without build output.
fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for path in entries.map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with('.') || name == "target" || name == "__pycache__" {
            continue;
        }
        if path.is_dir() {
            files(&path, found);
        } else {
            found.push(path);
        }
    }
}

fn relative(path: &Path) -> String {
    let path = path.strip_prefix(workspace()).unwrap_or(path);
    path.components().map(|part| part.as_os_str().to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// The Rust files below the folders.
fn sources(folders: &[&str]) -> Vec<Source> {
    let mut found = Vec::new();
    for folder in folders {
        files(&workspace().join(folder), &mut found);
    }
    found.sort();
    let rust = found.into_iter().filter(|path| path.extension().is_some_and(|end| end == "rs"));
    let sources: Vec<Source> = rust
        .map(|path| Source { path: relative(&path), text: std::fs::read_to_string(path).unwrap() })
        .collect();
    assert!(!sources.is_empty(), "no Rust files in {folders:?}");
    sources
}

/// The crates with their manifests.
fn manifests() -> Vec<(String, toml::Table)> {
    let folder = workspace().join("crates");
    let mut manifests: Vec<(String, toml::Table)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.join("Cargo.toml").is_file())
        .map(|path| {
            let text = std::fs::read_to_string(path.join("Cargo.toml")).unwrap();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            (name, text.parse().unwrap())
        })
        .collect();
    manifests.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(manifests.len() >= 9);
    manifests
}

/// The names of all that a crate depends on, in whatever section.
fn dependencies(manifest: &toml::Table) -> Vec<String> {
    let mut names = Vec::new();
    for (section, content) in manifest {
        let Some(content) = content.as_table() else { continue };
        if section.ends_with("dependencies") {
            names.extend(content.keys().cloned());
        } else if section == "target" {
            for platform in content.values().filter_map(toml::Value::as_table) {
                names.extend(dependencies(platform));
            }
        }
    }
    names
}

/// Fails with all findings at once.
fn none(findings: &[String], rule: &str) {
    assert!(findings.is_empty(), "{rule}:\n{}", findings.join("\n"));
}

/// Whether a line contains a word as a whole.
fn has_word(line: &str, word: &str) -> bool {
    let part_of_word = |c: char| c.is_alphanumeric() || c == '_';
    line.match_indices(word).any(|(at, _)| {
        !line[..at].ends_with(part_of_word) && !line[at + word.len()..].starts_with(part_of_word)
    })
}

#[test]
fn dependencies_point_downwards() {
    let mut findings = Vec::new();
    for (name, manifest) in manifests() {
        let Some((_, allowed)) = ALLOWED.iter().find(|(known, _)| *known == name) else {
            findings.push(format!(
                "crates/{name}: say in tests/model/tidy.rs on which crates it stands"
            ));
            continue;
        };
        for dependency in dependencies(&manifest) {
            let ours = dependency.strip_prefix("anergy-");
            if ours.is_some_and(|ours| !allowed.contains(&ours)) {
                findings.push(format!("crates/{name} must not depend on {dependency}"));
            }
        }
    }
    none(
        &findings,
        "core <- network, prosumer, control, recording, report, import <- simulation <- cli, py",
    );
}

#[test]
fn foreign_crates_have_one_home() {
    let mut findings = Vec::new();
    for (name, manifest) in manifests() {
        for dependency in dependencies(&manifest) {
            let home = WRAPPED.iter().find(|(foreign, _)| *foreign == dependency);
            if home.is_some_and(|(_, home)| *home != name) {
                findings.push(format!("crates/{name}/Cargo.toml: {dependency}"));
            }
        }
    }
    for source in sources(&["crates"]) {
        for (foreign, home) in WRAPPED {
            if source.path.starts_with(&format!("crates/{home}/")) {
                continue;
            }
            let used = [format!("{foreign}::"), format!("use {foreign};")];
            findings.extend(
                source.places(&source.text, |line| used.iter().any(|used| line.contains(used))),
            );
        }
        if source.path != LINEAR_ALGEBRA {
            findings.extend(source.places(&source.text, |line| has_word(line, "faer")));
        }
    }
    none(&findings, "a foreign crate is known to the one crate (faer: the one file) that wraps it");
}

#[test]
fn the_core_does_no_io_and_reads_no_clock() {
    let mut findings = Vec::new();
    let folders: Vec<String> = PURE.iter().map(|name| format!("crates/{name}/src")).collect();
    for source in sources(&folders.iter().map(String::as_str).collect::<Vec<_>>()) {
        findings.extend(source.places(source.without_tests(), |line| {
            let code = line.split("//").next().unwrap_or_default().replace(ERROR_TYPE, "");
            IMPURE.iter().any(|word| code.contains(word))
        }));
    }
    none(&findings, "core, network, prosumer and control do no IO and read no clock");
}

#[test]
fn names_say_what_is_inside() {
    let mut found = Vec::new();
    for folder in ["crates", "tests", "benches", "examples", "docs"] {
        files(&workspace().join(folder), &mut found);
    }
    let findings: Vec<String> = found
        .iter()
        .map(|path| relative(path))
        .filter(|path| {
            path.split('/').any(|part| EMPTY_NAMES.contains(&part.split('.').next().unwrap_or("")))
        })
        .collect();
    none(&findings, "a file or folder is named after its idea");
}

#[test]
fn files_stay_short() {
    let findings: Vec<String> = sources(&["crates"])
        .iter()
        .filter(|source| source.path.contains("/src/"))
        .map(|source| (source, source.without_tests().lines().count()))
        .filter(|(_, lines)| *lines > LONGEST_FILE)
        .map(|(source, lines)| format!("{}: {lines} lines", source.path))
        .collect();
    none(&findings, "a file has at most 400 lines without its tests: split it by idea");
}

/// The name of a public field that holds `f64`, where the line declares one.
fn public_number(line: &str) -> Option<&str> {
    let declaration = line.trim().strip_prefix("pub ")?.strip_suffix(',')?;
    let (name, kind) = declaration.split_once(": ")?;
    let is_name = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
    (is_name && has_word(kind, "f64")).then_some(name)
}

#[test]
fn public_numbers_carry_their_unit() {
    let mut findings = Vec::new();
    let mut seen = 0;
    let folders: Vec<String> = PURE.iter().map(|name| format!("crates/{name}/src")).collect();
    for source in sources(&folders.iter().map(String::as_str).collect::<Vec<_>>()) {
        let without_unit = |name: &str| {
            let mut suffixes = SI_SUFFIXES.iter().chain(MORE_SUFFIXES);
            !suffixes.any(|s| name.strip_suffix(s).is_some_and(|stem| stem.ends_with('_')))
                && !WITHOUT_SUFFIX.contains(&name)
        };
        let number = |line| public_number(line).is_some();
        seen += source.without_tests().lines().filter(|line| number(line)).count();
        findings.extend(
            source.places(source.without_tests(), |line| {
                public_number(line).is_some_and(without_unit)
            }),
        );
    }
    assert!(seen > 50, "only {seen} public numbers were found");
    none(
        &findings,
        "a public number ends in its SI unit (or is a ratio listed in tests/model/tidy.rs)",
    );
}

#[test]
fn nothing_is_left_for_later() {
    let markers = [["TO", "DO"], ["FIX", "ME"], ["XX", "X"]].map(|halves| halves.concat());
    let switched_off = ["#[ig", "nore"].concat();
    let mut findings = Vec::new();
    for source in sources(&["crates", "tests", "benches", "examples"]) {
        findings.extend(source.places(&source.text, |line| {
            markers.iter().any(|marker| has_word(line, marker)) || line.contains(&switched_off)
        }));
    }
    none(&findings, "what is open is an issue, not a comment; a test runs or is deleted");
}
