//! `anergy stability`: who blocks whom, which loops will hunt, how far it is to the limit.

use super::run::read_model;
use crate::failure::Failure;
use crate::output::line;
use crate::tables::print_table;
use anergy_core::units::l_min;
use anergy_simulation::error::RunError;
use anergy_simulation::model::Model;
use anergy_simulation::stability::advise::{self, Advice, Outcome};
use anergy_simulation::stability::{self, Stability};
use serde_json::json;
use std::path::Path;

/// Analyses a model file.
pub fn stability(path: &Path, json: Option<&Path>, advise: bool) -> Result<(), Failure> {
    let (text, model) = read_model(path)?;
    let found = stability::analyse(&model).map_err(|error| match error {
        RunError::Model(problems) => {
            Failure::Model { problems, file: path.display().to_string(), text }
        }
        other => Failure::Run(other),
    })?;
    let tried = advise.then(|| advise::advise(&model, &found)).transpose().map_err(Failure::Run)?;
    let mut value = serde_json::to_value(&found).map_err(|e| Failure::File(e.to_string()))?;
    if let Some((before, advice)) = &tried {
        value["before"] = json!(before);
        value["advice"] = json!(advice);
    }
    let table = || serde_json::to_string_pretty(&value).map_err(|e| Failure::File(e.to_string()));
    let print = || {
        print_feeders(&model, &found);
        line!("");
        print_loops(&found);
        if let Some((before, advice)) = &tried {
            print_advice(before, advice);
        }
    };
    match json {
        Some(json) if json == Path::new("-") => line!("{}", table()?),
        Some(json) => {
            std::fs::write(json, table()? + "\n")
                .map_err(|error| Failure::file("cannot write", json, &error))?;
            print();
        }
        None => print(),
    }
    Ok(())
}

fn print_feeders(model: &Model, found: &Stability) {
    if found.feeders.is_empty() {
        line!("no feeders: no pump stands in series with a check valve");
        return;
    }
    let density = model.medium.density_kg_m3;
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let rows: Vec<Vec<String>> = found
        .feeders
        .iter()
        .map(|f| {
            let by = f.blocked_by.as_deref().map_or(String::new(), |by| format!(" by {by}"));
            let verdict = match (f.blocked, f.held_back) {
                (true, _) => format!("blocked{by}"),
                (false, true) => format!("held back{by}"),
                _ => "free".to_owned(),
            };
            vec![
                f.id.clone(),
                format!("{:.3}", l_min(f.m_flow_kg_s, density)),
                format!("{:.3}", f.speed),
                number(f.threshold_speed),
                number(f.margin_speed),
                verdict,
            ]
        })
        .collect();
    print_table(&["feeder", "flow l/min", "speed", "blocked below", "margin", "verdict"], &rows);
}

fn print_advice(before: &Outcome, advice: &[Advice]) {
    let names = |set: &std::collections::BTreeSet<String>| {
        if set.is_empty() {
            "none".to_owned()
        } else {
            set.iter().cloned().collect::<Vec<_>>().join(", ")
        }
    };
    line!("");
    line!(
        "a run with a push of 15 %: swinging {}; blocked {}",
        names(&before.swinging),
        names(&before.blocked)
    );
    for (station, cold_s) in &before.cold_s {
        line!("a feeder starts: cold water at {station} for {cold_s:.0} s");
    }
    if advice.is_empty() {
        line!("nothing to advise");
    }
    for one in advice {
        line!("");
        line!("{}: {}", one.remedy.replace('_', " "), one.verdict);
        for change in &one.changes {
            line!("    {change}");
        }
    }
}

fn print_loops(found: &Stability) {
    if found.controllers.is_empty() {
        line!("no controllers: nothing can hunt");
        return;
    }
    // Gains per Pa are small numbers.
    let gain = |value: f64| {
        if value.abs() < 1e-2 && value != 0.0 {
            format!("{value:.3e}")
        } else {
            format!("{value:.4}")
        }
    };
    let number = |value: Option<f64>| value.map_or("-".to_owned(), gain);
    let rows: Vec<Vec<String>> = found
        .controllers
        .iter()
        .map(|c| {
            let verdict = match (c.open, c.stable, c.critical_gain) {
                (Some(open), ..) => open.to_owned(),
                (None, false, Some(0.0)) => {
                    "runs away at any gain: check sign and pairing".to_owned()
                }
                (None, false, _) => "hunts".to_owned(),
                (None, true, Some(critical)) => {
                    format!("stable, {:.1} times its gain to the limit", critical / c.gain)
                }
                (None, true, None) => "stable at any gain".to_owned(),
            };
            vec![
                c.id.clone(),
                gain(c.gain),
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
