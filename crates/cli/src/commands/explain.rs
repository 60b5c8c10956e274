//! `anergy explain`: where a model and measurements disagree, which effect is missing, and what adding it brings.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::line;
use anergy_discrepancy::addition::{added, added_to_sensors, reverted};
use anergy_discrepancy::data;
use anergy_discrepancy::error::ExplainError;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::{compare, explain as explained};
use anergy_discrepancy::gap::Gap;
use anergy_discrepancy::sensors::SensorFile;
use anergy_discrepancy::show;
use anergy_discrepancy::split::{SplitFile, Use};
use anergy_simulation::model::Model;
use std::path::{Path, PathBuf};

/// What is compared, and where the result goes.
#[derive(Debug, clap::Args)]
pub struct ExplainArguments {
    /// Table of measurements: time_s, run (optional), a column per sensor
    #[arg(long, value_name = "CSV", required_unless_present = "revert")]
    data: Option<PathBuf>,
    /// What the columns are, and how good the sensors
    #[arg(long, value_name = "TOML", required_unless_present = "revert")]
    sensors: Option<PathBuf>,
    /// Which blocks of time are fitted, which choose, which are shown (default: in turns)
    #[arg(long, value_name = "TOML")]
    split: Option<PathBuf>,
    /// Folder for report.html, report.md, report.json and the explained model
    #[arg(long, value_name = "DIR", default_value = "results/explain")]
    out: PathBuf,
    /// Only say how far the model is from the data; nothing is fitted
    #[arg(long, conflicts_with = "revert")]
    compare: bool,
    /// Take an effect that was added out of the model file, or the sensor file, again
    #[arg(long, value_name = "ID", conflicts_with_all = ["data", "sensors", "split"])]
    revert: Option<String>,
}

/// Explains, or takes an explanation back.
pub fn explain(path: &Path, wanted: &ExplainArguments) -> Result<(), Failure> {
    match (&wanted.revert, &wanted.data, &wanted.sensors) {
        (Some(id), ..) => revert(path, id),
        (None, Some(data), Some(sensors)) => find(path, data, sensors, wanted),
        _ => Err(Failure::Usage("--data and --sensors are needed".into())),
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| Failure::file("cannot read", path, &error))
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text).map_err(|error| Failure::file("cannot write", path, &error))
}

fn revert(path: &Path, id: &str) -> Result<(), Failure> {
    let text = reverted(&read(path)?, id).map_err(failed)?;
    write(path, &text)?;
    line!("[[effect]] {id} is taken out of {}", path.display());
    Ok(())
}

fn find(
    path: &Path,
    data: &Path,
    sensors: &Path,
    wanted: &ExplainArguments,
) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let stem = path.file_stem().map_or_else(|| "model".into(), |stem| stem.to_string_lossy());
    let case = Case {
        text: &text,
        file: &path.display().to_string(),
        stem: &stem,
        data: &read(data)?,
        sensors: &read(sensors)?,
        split: wanted.split.as_deref().map(read).transpose()?,
    };
    if wanted.compare { compare_in(model, &case) } else { find_in(model, &case, &wanted.out) }
}

/// Texts of a comparison.
pub struct Case<'a> {
    /// The model file.
    pub text: &'a str,
    /// Its name.
    pub file: &'a str,
    /// Its name without folder and ending.
    pub stem: &'a str,
    /// The table of measurements.
    pub data: &'a str,
    /// The sensor file.
    pub sensors: &'a str,
    /// The split file.
    pub split: Option<String>,
}

/// Model, measurements and the split.
fn experiment(model: Model, case: &Case<'_>) -> Result<(Experiment, Option<SplitFile>), Failure> {
    let sensors = SensorFile::from_toml(case.sensors).map_err(failed)?;
    let runs = data::read(case.data, &sensors).map_err(failed)?;
    let split = case.split.as_deref().map(SplitFile::from_toml).transpose().map_err(failed)?;
    let model_failed = |error: ExplainError| match error {
        ExplainError::Model(problems) => {
            Failure::Model { problems, file: case.file.to_owned(), text: case.text.to_owned() }
        }
        other => failed(other),
    };
    Ok((Experiment::new(model, sensors, runs).map_err(model_failed)?, split))
}

/// How far the model is from the data, a line per sensor: root mean square over the samples to show.
fn compare_in(model: Model, case: &Case<'_>) -> Result<(), Failure> {
    let (experiment, split) = experiment(model, case)?;
    let found = compare(&experiment, split.as_ref()).map_err(failed)?;
    for gap in found.iter().filter(|gap| of_show(gap)) {
        let (column, unit, z) = (&gap.column, &gap.unit, gap.z_before);
        line!("{column}: {:.6} {unit}, {z:.2} standard deviations", gap.rmse_before);
    }
    Ok(())
}

fn of_show(gap: &Gap) -> bool {
    gap.part == Use::Show && gap.regime == "all"
}

/// Explains, prints what was found and writes it into a folder.
pub fn find_in(model: Model, case: &Case<'_>, out: &Path) -> Result<(), Failure> {
    let name = model.name.clone();
    let (experiment, split) = experiment(model, case)?;
    let found = explained(&experiment, split.as_ref()).map_err(failed)?;
    std::fs::create_dir_all(out).map_err(|error| Failure::file("cannot create", out, &error))?;
    let title = format!("{name}: simulation and measurement");
    let json = serde_json::to_string_pretty(&show::json(&found));
    write(&out.join("report.json"), &(json.map_err(|e| Failure::File(e.to_string()))? + "\n"))?;
    write(&out.join("report.md"), &show::markdown(&title, &found))?;
    write(&out.join("report.html"), &show::html(&title, &experiment, &found))?;
    line!("{} {}.", found.verdict.sentence(), show::upper(&found.because));
    for problem in &found.problems {
        line!("  {problem}");
    }
    for effect in &found.effects {
        let (id, component, words) = (effect.id, &effect.component, effect.words);
        line!("  {id} at {component}: {words}, {} = {}", effect.parameter, show::value(effect));
    }
    if found.class.len() > 1 {
        line!("  not told apart by these data:");
        for effect in &found.class {
            let (id, component, words) = (effect.id, &effect.component, effect.words);
            line!("    {id} at {component}: {words}; to tell: {}", effect.separates);
        }
    }
    for gap in found.gaps.iter().filter(|gap| of_show(gap)) {
        let (column, unit) = (&gap.column, &gap.unit);
        line!(
            "  {column}: {:.3} -> {:.3} {unit} (root mean square, not fitted)",
            gap.rmse_before,
            gap.rmse_after
        );
    }
    if found.effects.iter().any(|effect| !effect.of_sensor()) {
        let explained = out.join(format!("{}.explained.toml", case.stem));
        write(&explained, &added(case.text, &found.effects, &found.because))?;
        line!("\nthe model with what was missing: {}", explained.display());
    }
    if found.effects.iter().any(anergy_discrepancy::explain::Finding::of_sensor) {
        let explained = out.join("sensors.explained.toml");
        write(&explained, &added_to_sensors(case.sensors, &found.effects, &found.because))?;
        line!("\nthe sensor file with what was wrong: {}", explained.display());
    }
    line!("\nresults in {}: report.html, report.md, report.json", out.display());
    Ok(())
}

fn failed(error: ExplainError) -> Failure {
    match error {
        ExplainError::Run(error) => Failure::Run(error),
        other => Failure::File(other.to_string()),
    }
}
