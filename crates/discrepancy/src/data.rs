//! The table of measurements: a time in s, an optional `run`, a column per sensor; an empty cell is missing.

use crate::error::ExplainError;
use crate::sensors::SensorFile;

/// Readings of one column of one run, in SI, where there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Times, s, rising.
    pub time_s: Vec<f64>,
    /// Readings in SI.
    pub value: Vec<f64>,
}

impl Track {
    /// Linear between the readings, constant beyond them.
    pub fn at(&self, time_s: f64) -> f64 {
        let (t, y) = (&self.time_s, &self.value);
        let i = t.partition_point(|x| *x <= time_s);
        if i == 0 {
            return y[0];
        }
        if i == t.len() {
            return y[i - 1];
        }
        let share = (time_s - t[i - 1]) / (t[i] - t[i - 1]);
        y[i - 1] + share * (y[i] - y[i - 1])
    }
}

/// One run: an uninterrupted measurement.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its name; empty where the table has no column `run`.
    pub name: String,
    /// Readings of every sensor, in the order of the sensor file.
    pub tracks: Vec<Track>,
    /// First and last time, s.
    pub span_s: (f64, f64),
}

/// Reads a table.
///
/// # Errors
/// Missing columns, cells that are no numbers and times that do not rise, with their lines.
pub fn read(text: &str, sensors: &SensorFile) -> Result<Vec<Run>, ExplainError> {
    let wrong = |problem: String| ExplainError::Data { problem };
    let lines = text.lines().take_while(|line| line.starts_with('#')).count() as u64;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let headers = reader.headers().map_err(|error| wrong(error.to_string()))?.clone();
    let place = |name: &str| headers.iter().position(|header| header == name);
    let column = |name: &str| {
        place(name).ok_or_else(|| {
            let all: Vec<&str> = headers.iter().collect();
            wrong(format!("there is no column \"{name}\"; its columns: {}", all.join(", ")))
        })
    };
    let time = column("time_s")?;
    let run = place("run");
    let columns: Vec<usize> =
        sensors.sensor.iter().map(|sensor| column(&sensor.column)).collect::<Result<_, _>>()?;
    let mut runs: Vec<Run> = Vec::new();
    for (row, record) in reader.records().enumerate() {
        let record = record.map_err(|error| wrong(error.to_string()))?;
        let line = record.position().map_or(row as u64 + 2 + lines, csv::Position::line);
        let number = |i: usize| -> Result<Option<f64>, ExplainError> {
            let cell = record.get(i).unwrap_or("");
            if cell.is_empty() || cell.eq_ignore_ascii_case("nan") {
                return Ok(None);
            }
            let value: Option<f64> = cell.parse().ok().filter(|value: &f64| value.is_finite());
            value.map(Some).ok_or_else(|| {
                let name = headers.get(i).unwrap_or("");
                wrong(format!("line {line}, column \"{name}\": \"{cell}\" is no number"))
            })
        };
        let time_s =
            number(time)?.ok_or_else(|| wrong(format!("line {line}: the time is missing")))?;
        let name = run.and_then(|i| record.get(i)).unwrap_or("").to_owned();
        let index = runs.iter().position(|run| run.name == name).unwrap_or_else(|| {
            let none = Track { time_s: Vec::new(), value: Vec::new() };
            let tracks = vec![none; sensors.sensor.len()];
            runs.push(Run { name, tracks, span_s: (time_s, f64::NEG_INFINITY) });
            runs.len() - 1
        });
        let run = &mut runs[index];
        if time_s <= run.span_s.1 {
            let before = run.span_s.1;
            return Err(wrong(format!(
                "line {line}: the time {time_s} s does not come after {before} s"
            )));
        }
        run.span_s.1 = time_s;
        for ((track, sensor), i) in run.tracks.iter_mut().zip(&sensors.sensor).zip(&columns) {
            if let Some(value) = number(*i)? {
                track.time_s.push(time_s);
                track.value.push(sensor.to_si(value));
            }
        }
    }
    if runs.is_empty() {
        return Err(wrong("it has no rows".into()));
    }
    for run in &runs {
        for (track, sensor) in run.tracks.iter().zip(&sensors.sensor) {
            if track.value.is_empty() {
                let name = &run.name;
                return Err(wrong(format!(
                    "column \"{}\" of run \"{name}\" is empty",
                    sensor.column
                )));
            }
        }
    }
    Ok(runs)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENSORS: &str =
        "[[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";

    fn rows(text: &str) -> Result<Vec<Run>, ExplainError> {
        read(text, &SensorFile::from_toml(SENSORS).unwrap())
    }

    #[test]
    fn runs_gaps_and_units() {
        let runs = rows("time_s,run,T\n0,a,20\n10,a,\n20,a,22\n0,b,30\n").unwrap();
        assert_eq!(runs.len(), 2);
        assert_eq!(runs[0].tracks[0].time_s, [0.0, 20.0]);
        assert_eq!(runs[0].tracks[0].at(10.0), 294.15);
        assert_eq!(runs[1].tracks[0].at(99.0), 303.15);
    }

    #[test]
    fn what_is_wrong_has_a_place() {
        let wrong = |text: &str| rows(text).unwrap_err().to_string();
        assert!(wrong("time_s,X\n0,1\n").contains("no column \"T\""));
        assert!(wrong("time_s,T\n0,1\n1,warm\n").contains("line 3, column \"T\": \"warm\""));
        assert!(wrong("time_s,T\n5,1\n5,2\n").contains("line 3: the time 5 s"));
        assert!(wrong("time_s,T\n").contains("no rows"));
        assert!(wrong("time_s,T\n0,\n").contains("empty"));
    }
}
