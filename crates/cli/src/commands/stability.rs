//! `anergy stability`: who blocks whom, which loops will hunt, how far it is to the limit.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::line;
use crate::tables::print_table;
use anergy_simulation::error::RunError;
use anergy_simulation::stability::{self, Stability};
use std::path::Path;

/// Analyses a model file.
pub fn stability(path: &Path, json: Option<&Path>) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let found = stability::analyse(&model).map_err(|error| match error {
        RunError::Model(problems) => {
            Failure::Model { problems, file: path.display().to_string(), text }
        }
        other => Failure::Run(other),
    })?;
    let table = || serde_json::to_string_pretty(&found).map_err(|e| Failure::File(e.to_string()));
    match json {
        Some(json) if json == Path::new("-") => line!("{}", table()?),
        Some(json) => {
            std::fs::write(json, table()? + "\n")
                .map_err(|error| Failure::file("cannot write", json, &error))?;
            print(&found);
        }
        None => print(&found),
    }
    Ok(())
}

fn print(found: &Stability) {
    print_loops(found);
}

fn print_loops(found: &Stability) {
    if found.controllers.is_empty() {
        line!("no controllers: nothing can hunt");
        return;
    }
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
    let rows: Vec<Vec<String>> = found
        .controllers
        .iter()
        .map(|c| {
            let verdict = match (c.open, c.stable, c.critical_gain) {
                (Some(open), ..) => open.to_owned(),
                (None, false, _) => "hunts".to_owned(),
                (None, true, Some(critical)) => {
                    format!("stable, {:.1} times its gain to the limit", critical / c.gain)
                }
                (None, true, None) => "stable at any gain".to_owned(),
            };
            vec![
                c.id.clone(),
                format!("{:.4}", c.gain),
                number(c.critical_gain),
                number(c.critical_gain_alone),
                number(c.relative_gain),
                verdict,
            ]
        })
        .collect();
    print_table(
        &["controller", "gain", "critical", "critical alone", "relative gain", "verdict"],
        &rows,
    );
    if found.modes.is_empty() {
        return;
    }
    line!("");
    let rows: Vec<Vec<String>> = found
        .modes
        .iter()
        .map(|mode| {
            let mut shares: Vec<_> = mode.participation.iter().collect();
            shares.sort_by(|a, b| b.1.total_cmp(a.1));
            let shares = shares.iter().filter(|(_, share)| **share > 0.005).map(|(id, share)| {
                let against = mode.phase_deg.get(*id).is_some_and(|phase| phase.abs() > 90.0);
                format!("{id} {}{:.0} %", if against { "-" } else { "" }, 100.0 * **share)
            });
            vec![
                format!("{:.2}", mode.period_s),
                format!("{:.4}", mode.growth_per_s),
                if mode.growth_per_s > 0.0 { "grows".into() } else { "decays".to_owned() },
                shares.collect::<Vec<_>>().join(", "),
            ]
        })
        .collect();
    print_table(&["period s", "growth 1/s", "", "taking part (- against the first)"], &rows);
}
