//! Writes reports of made-up recordings: `cargo run -p anergy-report --example synthetic -- DIR`.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use anergy_core::recorder::Recording;
use std::path::PathBuf;

fn main() -> std::io::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let mut gaps = synthetic::three_houses();
    for (i, column) in gaps.columns.iter_mut().enumerate() {
        for (row, value) in column.iter_mut().enumerate() {
            if i % 3 == 0 && row % 60 < 20 || i % 7 == 0 {
                *value = f64::NAN;
            }
        }
    }
    let mut interrupted = synthetic::three_houses();
    interrupted.summary = serde_json::Value::Null;
    let mut no_rows = interrupted.clone();
    no_rows.time_s.clear();
    no_rows.columns.iter_mut().for_each(Vec::clear);
    let mut one_row = synthetic::three_houses();
    one_row.time_s.truncate(1);
    let reports = [
        ("houses", synthetic::three_houses()),
        ("district", synthetic::district(500, 100)),
        ("town", synthetic::district(60, 500)),
        ("large", synthetic::district(1000, 5000)),
        ("plain", synthetic::plain(3)),
        ("node", synthetic::plain(1)),
        ("gaps", gaps),
        ("hostile", synthetic::hostile()),
        ("ring", synthetic::ring()),
        ("one-row", one_row),
        ("interrupted", interrupted),
        ("no-rows", no_rows),
        ("empty", Recording::default()),
    ];
    for (name, recording) in reports {
        std::fs::write(folder.join(format!("{name}.html")), anergy_report::html(&recording))?;
    }
    Ok(())
}
