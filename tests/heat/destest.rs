//! The network of the DESTEST common exercise 1 beside the three tools that agree.
//!
//! The definition and the results of the tools are not part of the repository; what is chosen where
//! the definition is silent is said in `anergy_benches::destest`. `make validate` runs the 256 days of
//! the load profile and the halved steps, and writes the page of the documentation.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_benches::destest::{self, BYPASS_KG_S, HOUSES};
use anergy_core::clock::Time;
use anergy_core::recorder::{MemoryRecorder, Recording};
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::run::{RunOptions, run};
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::{write_page, writes_pages};
use anergy_tests::reference_data;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The tools that agree, and the column of each quantity.
const TOOLS: [&str; 3] =
    ["IBPSA_Library_Plug_Flow", "AixLib_Plug_Flow", "Buildings_Library_Dynamic_Pipe"];
const HEAT: &str = "Qheat_injection_W";
const LOSS: &str = "Qheat_losses_W";
const CRITICAL: &str = "Critical_temp_K";
/// The tools start differently: these samples of 900 s do not count.
const START_ROWS: usize = 5;
const ROWS: usize = 673;
const WEEK_S: f64 = 604_800.0;

fn folder() -> Option<PathBuf> {
    reference_data("destest")
}

fn model(text: &str) -> Model {
    Model::from_toml(text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

fn recorded(simulation: &mut Simulation, options: RunOptions) -> Recording {
    let mut recorder = MemoryRecorder::default();
    run(simulation, options, Box::new(Borrowed(&mut recorder)), &mut |_, _| true).unwrap();
    recorder.recording
}

/// A recorder that is still there after the run.
struct Borrowed<'a>(&'a mut MemoryRecorder);

impl anergy_core::recorder::Recorder for Borrowed<'_> {
    fn start(
        &mut self,
        header: &anergy_core::recorder::RunHeader,
        channels: &[anergy_core::recorder::Channel],
    ) -> Result<(), anergy_core::error::RecordError> {
        self.0.start(header, channels)
    }

    fn row(&mut self, time: Time, values: &[f64]) -> Result<(), anergy_core::error::RecordError> {
        self.0.row(time, values)
    }

    fn event(
        &mut self,
        event: &anergy_core::recorder::Event,
    ) -> Result<(), anergy_core::error::RecordError> {
        self.0.event(event)
    }

    fn finish(
        self: Box<Self>,
        _summary: &serde_json::Value,
    ) -> Result<(), anergy_core::error::RecordError> {
        Ok(())
    }
}

fn column<'a>(recording: &'a Recording, name: &str) -> &'a [f64] {
    let at = recording.channels.iter().position(|channel| channel.name == name);
    &recording.columns[at.unwrap_or_else(|| panic!("no channel {name}"))]
}

/// Heat of the source, loss of the network and the coldest water that arrives at a house, at each row.
fn quantities(recording: &Recording) -> [Vec<f64>; 3] {
    let heat = column(recording, "source.unit.q_flow_w").to_vec();
    let loss = column(recording, "network.loss_w").to_vec();
    let arriving: Vec<&[f64]> = (1..=HOUSES)
        .map(|house| column(recording, &format!("SimpleDistrict_{house}.unit.t_in_k")))
        .collect();
    let coldest = (0..heat.len())
        .map(|row| arriving.iter().map(|column| column[row]).fold(f64::INFINITY, f64::min))
        .collect();
    [heat, loss, coldest]
}

/// Heat, loss and critical temperature of a tool.
fn tool(folder: &Path, name: &str) -> [Vec<f64>; 3] {
    let path = folder.join(format!("results_network1/{name}_Network_1.csv"));
    let mut reader = csv::Reader::from_path(&path).unwrap();
    let headers = reader.headers().unwrap().clone();
    let at = |column: &str| {
        headers
            .iter()
            .position(|header| header == column)
            .unwrap_or_else(|| panic!("{}: no column {column}", path.display()))
    };
    let places = [at(HEAT), at(LOSS), at(CRITICAL)];
    let mut columns = [vec![], vec![], vec![]];
    for row in reader.records() {
        let row = row.unwrap();
        for (column, &place) in columns.iter_mut().zip(&places) {
            column.push(row[place].parse().unwrap());
        }
    }
    columns
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(mut values: [f64; 3]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[1]
}

/// Week of energy MWh and mean loss W of some rows, the start left out.
fn week(columns: &[Vec<f64>; 3]) -> (f64, f64) {
    let heat_w = mean(&columns[0][START_ROWS..]);
    (heat_w * WEEK_S / 3.6e9, mean(&columns[1][START_ROWS..]))
}

/// What a week is beside the tools.
struct Comparison {
    own: [Vec<f64>; 3],
    tools: Vec<[Vec<f64>; 3]>,
    /// Share of the samples with 30 to 150 kW whose critical temperature is within 0.5 K of the median,
    /// their number, and the largest and the median difference, K.
    within: f64,
    samples: usize,
    largest_k: f64,
    middle_k: f64,
    heat_error: f64,
    /// Heat of the source, integrated, MWh.
    energy_mwh: f64,
}

/// Heat of the source since the start: what the houses took, the loss and what is stored now, J.
fn source_j(recording: &Recording, balances: &Balances) -> f64 {
    let last = |name: &str| column(recording, name).last().copied().unwrap();
    let taken: f64 =
        (1..=HOUSES).map(|house| -last(&format!("SimpleDistrict_{house}.station.heat_j"))).sum();
    taken + balances.loss_j + balances.stored_j
}

fn compare(folder: &Path) -> Comparison {
    let text = destest::model(&folder.join("definition")).unwrap();
    let mut simulation = simulation(&text);
    let recording = recorded(&mut simulation, RunOptions::default());
    let own = quantities(&recording);
    let balances = Balances::of(&simulation);
    let tools: Vec<[Vec<f64>; 3]> = TOOLS.iter().map(|name| tool(folder, name)).collect();
    for columns in tools.iter().chain([&own]) {
        assert_eq!(columns[0].len(), ROWS);
    }
    let at = |quantity: usize, row: usize| median([0, 1, 2].map(|i| tools[i][quantity][row]));
    let mut differences: Vec<f64> = (START_ROWS..ROWS)
        .filter(|&row| (30e3..=150e3).contains(&at(0, row)))
        .map(|row| (own[2][row] - at(2, row)).abs())
        .collect();
    differences.sort_by(f64::total_cmp);
    let samples = differences.len();
    let within = differences.iter().filter(|k| **k <= 0.5).count() as f64 / samples as f64;
    Comparison {
        within,
        samples,
        largest_k: differences[samples - 1],
        middle_k: differences[samples / 2],
        own,
        tools,
        heat_error: balances.heat_error(),
        energy_mwh: source_j(&recording, &balances) / 3.6e9,
    }
}

#[test]
fn a_week_beside_the_tools_that_agree() {
    let Some(folder) = folder() else { return };
    let comparison = compare(&folder);
    let (sampled_mwh, loss_w) = week(&comparison.own);
    let energy_mwh = comparison.energy_mwh;
    println!("{energy_mwh:.3} MWh ({sampled_mwh:.3} from samples), {loss_w:.0} W");
    for (name, columns) in TOOLS.iter().zip(&comparison.tools) {
        let (theirs_mwh, theirs_w) = week(columns);
        println!("{name}: {theirs_mwh:.3} MWh, {theirs_w:.0} W");
        for own_mwh in [energy_mwh, sampled_mwh] {
            assert!((own_mwh / theirs_mwh - 1.0).abs() < 0.01, "{name}: {own_mwh} MWh");
        }
        assert!((loss_w / theirs_w - 1.0).abs() < 0.03, "{name}: {loss_w} W");
    }
    let Comparison { within, samples, largest_k, middle_k, heat_error, .. } = comparison;
    println!(
        "critical temperature: {:.1} % of {samples} within 0.5 K, median {middle_k:.3} K, largest \
         {largest_k:.2} K",
        100.0 * within
    );
    assert!(samples > 200, "{samples}");
    assert!(within >= 0.95, "{within}");
    assert!(heat_error < 1e-6, "{heat_error}");
}

/// Steps that are halved, s; the smallest is that of the solution they are compared with.
const STEPS_S: [f64; 4] = [600.0, 300.0, 150.0, 75.0];
const FINE_STEP_S: f64 = 75.0 / 16.0;
const SPLITTING_DAYS: f64 = 2.0;

/// Temperatures of the supply nodes of all houses at full hours, and heat of the source until then, J.
fn hourly(text: &str, step_s: f64) -> (Vec<f64>, f64) {
    let mut simulation = simulation(text);
    let nodes: Vec<_> = (1..=HOUSES)
        .map(|house| simulation.channel(&format!("SimpleDistrict_{house}.hot.t_k")).unwrap())
        .collect();
    let step = Time::from_s(step_s).unwrap();
    let mut found = Vec::new();
    for hour in 1..=(24.0 * SPLITTING_DAYS) as u32 {
        simulation.advance_to(Time::from_s(3600.0 * f64::from(hour)).unwrap(), step).unwrap();
        found.extend(nodes.iter().map(|node| simulation.get(*node)));
    }
    let loss_j = Balances::of(&simulation).loss_j;
    (found, loss_j)
}

/// What is left to the step: houses with a given return temperature take the flow for the temperature
/// that arrived in the step before. Loads are held between their rows, so that no step sees another load.
fn splitting(folder: &Path) -> Vec<(f64, f64, f64)> {
    let text = destest::model(&folder.join("definition"))
        .unwrap()
        .replace("temperature_difference_k = 20", "return_degc = 30")
        .replace("interpolation = \"linear\"", "interpolation = \"hold\"");
    let (fine_k, fine_j) = hourly(&text, FINE_STEP_S);
    STEPS_S
        .iter()
        .map(|&step_s| {
            let (found_k, found_j) = hourly(&text, step_s);
            let squares: f64 = found_k.iter().zip(&fine_k).map(|(a, b)| (a - b).powi(2)).sum();
            let rms_k = (squares / fine_k.len() as f64).sqrt();
            (step_s, rms_k, (found_j / fine_j - 1.0).abs())
        })
        .collect()
}

#[test]
fn the_splitting_error_falls_with_the_step() {
    let Some(folder) = folder() else { return };
    let errors = splitting(&folder);
    for (step_s, rms_k, loss) in &errors {
        println!("{step_s} s: {rms_k:.2e} K, loss {loss:.1e}");
    }
    for pair in errors.windows(2) {
        assert!(pair[1].1 <= 0.5 * pair[0].1 * 1.05, "{pair:?}");
    }
}

/// Written by `make validate`.
#[test]
fn page() {
    let Some(folder) = folder().filter(|_| writes_pages()) else { return };
    let comparison = compare(&folder);
    let mut text = String::from(PAGE);
    text += "\n## One week\n\n| tool | energy, MWh | mean loss, W |\n|---|---|---|\n";
    for (name, columns) in TOOLS.iter().zip(&comparison.tools).chain([(&"anergy", &comparison.own)])
    {
        let (energy_mwh, loss_w) = week(columns);
        let _ = writeln!(text, "| {} | {energy_mwh:.3} | {loss_w:.0} |", name.replace('_', " "));
    }
    let Comparison { within, samples, largest_k, middle_k, heat_error, energy_mwh, .. } =
        comparison;
    let _ = write!(
        text,
        "\nMeans over the 900 s samples from 4500 s on (the tools start differently); integrated over all steps \
         our energy is {energy_mwh:.3} MWh. Critical temperature: \
         {:.1} % of the {samples} samples with a heat injection of 30 to 150 kW are within 0.5 K of the median \
         of the three tools; the median difference is {middle_k:.2} K, the largest {largest_k:.2} K. The \
         balance of heat closes to {heat_error:.0e}.\n",
        100.0 * within
    );
    let definition = destest::model(&folder.join("definition")).unwrap();
    let days = 256.0;
    let mut simulation = simulation(&definition);
    let options = RunOptions {
        until: Time::from_s(days * 86_400.0),
        record: Time::from_s(3600.0),
        step: None,
    };
    let recording = recorded(&mut simulation, options);
    let balances = Balances::of(&simulation);
    let source_mwh = source_j(&recording, &balances) / 3.6e9;
    let loss_mwh = balances.loss_j / 3.6e9;
    let _ = write!(
        text,
        "\n## The 256 days of the load profile\n\nStep 1 min, hourly record: {source_mwh:.2} MWh from the source, of \
         which {loss_mwh:.2} MWh ({:.1} %) are lost; mean loss {:.0} W; the balance of heat closes to \
         {:.0e}.\n",
        100.0 * loss_mwh / source_mwh,
        balances.loss_j / (days * 86_400.0),
        balances.heat_error()
    );
    text += SPLITTING;
    text += "\n| step, s | temperatures at the houses, K RMS | loss, relative | ratio to half the step |\n\
             |---|---|---|---|\n";
    let errors = splitting(&folder);
    for (i, (step_s, rms_k, loss)) in errors.iter().enumerate() {
        let ratio =
            errors.get(i + 1).map_or_else(String::new, |next| format!("{:.2}", rms_k / next.1));
        let _ = writeln!(text, "| {step_s} | {rms_k:.4} | {loss:.1e} | {ratio} |");
    }
    assert!(balances.heat_error() < 1e-6);
    write_page("destest", "make validate", &text);
    println!("by-pass {BYPASS_KG_S} kg/s");
}

const PAGE: &str = r"# DESTEST: the network of the common exercise 1

Sixteen houses on two branches, supply of 50 degC at the source, 20 K at each house, flow = load/(cp 20 K), pipes in
ground of 12 degC that begins at their insulation. `U-value` of the definition is the conductivity of the insulation:
R = ln((d + 2 s)/d)/(2 pi lambda).

**Where the definition is silent:** every house has a by-pass flow of 0.0007 kg/s at least (that of the AixLib script;
other models of the exercise have up to 0.3 kg/s, which is why losses and temperatures without load differ between
the tools); loads are linear between their rows of 600 s; walls of the pipes store nothing; the critical temperature
is that of the coldest water that arrives at a house.

Three of the published tools agree (`IBPSA`, `AixLib`, `Buildings`) and are the reference. DIMOSIM smooths the load,
the model of AAU has another temperature level; they are left out.
";

const SPLITTING: &str = r"
## The error of the step

Flows and temperatures are solved one after the other in each step. To see what that costs, the houses have a return
temperature of 30 degC instead of a difference of 20 K: they take their flow for the temperature that arrived in the step
before. Loads are held between their rows (600 s), so that every step sees the same load. Two days, temperatures at all
houses at full hours beside those of steps of 4.7 s.
";
