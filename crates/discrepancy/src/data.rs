//! The table of measurements: a time in s, an optional `run`, a column per sensor; an empty cell is missing.

use crate::error::ExplainError;
use crate::sensors::{Role, Sensor, SensorFile};

/// What bends so many times more than readings usually do is beside a corner.
const CORNER: f64 = 2.0;

/// Readings of one column of one run, in SI, where there is one.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Times, s, rising.
    pub time_s: Vec<f64>,
    /// Readings in SI.
    pub value: Vec<f64>,
}

impl Track {
    /// Linear between the readings, constant beyond them; no number of a sensor that a run does not have.
    pub fn at(&self, time_s: f64) -> f64 {
        let (t, y) = (&self.time_s, &self.value);
        let i = t.partition_point(|x| *x <= time_s);
        if i == 0 {
            return y.first().copied().unwrap_or(f64::NAN);
        }
        if i == t.len() {
            return y[i - 1];
        }
        let share = (time_s - t[i - 1]) / (t[i] - t[i - 1]);
        y[i - 1] + share * (y[i] - y[i - 1])
    }

    /// The cubic through the readings with slopes of their neighbours (Catmull and Rom): a straight line cuts the corners of
    /// a front, which looks like a front that the plant has blurred. Linear where readings are missing. Where the readings at both
    /// ends bend the same way, several times more than they do `usually`, there is a corner between them: the straight lines
    /// beside go on until they meet. (So much as all the others bend, readings bend without a corner.)
    pub fn smooth_at(&self, time_s: f64, usually: f64) -> f64 {
        let (t, y) = (&self.time_s, &self.value);
        let i = t.partition_point(|x| *x <= time_s);
        if i < 2 || i + 1 >= t.len() {
            return self.at(time_s);
        }
        let h = t[i] - t[i - 1];
        if t[i + 1] - t[i] > 2.0 * h
            || t[i - 1] - t[i - 2] > 2.0 * h
            || h > 2.0 * (t[i - 1] - t[i - 2])
        {
            return self.at(time_s);
        }
        let slope = |k: usize| (y[k + 1] - y[k - 1]) / (t[k + 1] - t[k - 1]);
        let (a, b, s) = (slope(i - 1) * h, slope(i) * h, (time_s - t[i - 1]) / h);
        let rise = y[i] - y[i - 1];
        let cubic =
            y[i - 1] + s * (a + s * ((3.0 * rise - 2.0 * a - b) + s * (a + b - 2.0 * rise)));
        let (one, other) = (self.bend(i - 1), self.bend(i));
        if one * other <= 0.0 {
            return cubic;
        }
        let line = |k: usize, m: usize| y[k] + (time_s - t[k]) * (y[m] - y[k]) / (t[m] - t[k]);
        let (before, after) = (line(i - 1, i - 2), line(i, i + 1));
        let corner = if one < 0.0 { before.max(after) } else { before.min(after) };
        let share = (1.0 - CORNER * usually / one.abs().min(other.abs())).max(0.0);
        share * corner + (1.0 - share) * cubic
    }

    /// How far a reading lies above the straight line between its neighbours.
    fn bend(&self, i: usize) -> f64 {
        let (t, y) = (&self.time_s, &self.value);
        y[i] - y[i - 1] - (y[i + 1] - y[i - 1]) * (t[i] - t[i - 1]) / (t[i + 1] - t[i - 1])
    }

    /// How far a reading usually lies from the straight line between its neighbours: the median.
    pub fn usual_bend(&self) -> f64 {
        let inner = 1..self.time_s.len().saturating_sub(1);
        let mut bends: Vec<f64> = inner.map(|i| self.bend(i).abs()).collect();
        bends.sort_by(f64::total_cmp);
        bends.get(bends.len() / 2).copied().unwrap_or(0.0)
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
    for run in &mut runs {
        for (track, sensor) in run.tracks.iter_mut().zip(&sensors.sensor) {
            if sensor.role == Role::Input && sensor.si() == "1" {
                *track = at_once(track, !sensor.signal.ends_with("modulation"));
                continue;
            }
            let resolution = sensor.difference_to_si(sensor.quantisation).abs();
            let (least, most) = match sensor.si().as_str() {
                "k" => (JUMP_K, usize::MAX),
                "pa" | "kg_s" | "m3_s" if sensor.role == Role::Compare && resolution > 0.0 => {
                    let largest = track.value.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
                    (JUMP * largest, STEADY)
                }
                _ => continue,
            };
            *track = without_held(track, resolution, least, most);
        }
    }
    if let Some((sensor, run)) = without_readings(&runs, sensors) {
        let (column, name) = (&sensor.column, &run.name);
        let hint = match sensor.role {
            Role::Input => format!(
                ": what drives {} there is missing; another column of this signal would do",
                sensor.signal
            ),
            Role::Compare => String::new(),
        };
        return Err(wrong(format!("column \"{column}\" of run \"{name}\" is empty{hint}")));
    }
    Ok(runs)
}

/// A sensor without readings in a run, where it has none in any, or drives a signal that no other sensor drives there.
fn without_readings<'a>(runs: &'a [Run], sensors: &'a SensorFile) -> Option<(&'a Sensor, &'a Run)> {
    let sensors = &sensors.sensor;
    let reads = |run: &Run, k: usize| !run.tracks[k].value.is_empty();
    let missing = |(run, k): &(&Run, usize)| {
        let of = &sensors[*k];
        let instead = |(i, other): (usize, &Sensor)| {
            other.role == Role::Input && other.signal == of.signal && reads(run, i)
        };
        let never = !runs.iter().any(|run| reads(run, *k));
        let is_driven = sensors.iter().enumerate().any(instead);
        !reads(run, *k) && (never || (of.role == Role::Input && !is_driven))
    };
    let all = runs.iter().flat_map(|run| (0..sensors.len()).map(move |k| (run, k)));
    all.clone().find(missing).map(|(run, k)| (&sensors[k], run))
}

/// Readings that hold before one isolated jump were held by the logger: all but the first of them are missing.
const HELD: usize = 3;
/// A pressure or a flow that stays for more readings than this is steady.
const STEADY: usize = 12;
/// A jump is this many times the resolution ...
const STEPS: f64 = 10.0;
/// ... and at least so large, K ...
const JUMP_K: f64 = 0.5;
/// ... or, of a pressure or a flow, this share of the largest reading.
const JUMP: f64 = 0.05;

/// A quantity without the readings that a logger has held before a jump of at least `least`, at most `most` of them; nothing may stay nothing for long.
fn without_held(track: &Track, resolution: f64, least: f64, most: usize) -> Track {
    let (t, y) = (&track.time_s, &track.value);
    let least = least.max(STEPS * resolution);
    let mut kept = Track { time_s: Vec::new(), value: Vec::new() };
    let mut from = 0;
    while from < y.len() {
        let end = (from..y.len()).find(|&i| y[i] != y[from]).unwrap_or(y.len());
        let jump = y.get(end).map_or(0.0, |next| (next - y[from]).abs());
        let goes_on = y.get(end + 1).map_or(0.0, |next| (next - y[end]).abs());
        let rests = y[from].abs() <= resolution;
        let few = (HELD..=most).contains(&(end - from));
        let held = !rests && few && jump > least && goes_on < 0.3 * jump;
        let until = if held { from + 1 } else { end };
        kept.time_s.extend(&t[from..until]);
        kept.value.extend(&y[from..until]);
        from = end;
    }
    kept
}

/// A level holds where readings differ by no more than this share of a switch.
const HOLDS: f64 = 0.1;
/// A command below this share of its largest reading is off.
const OFF: f64 = 0.01;
/// A command that was read while it was switched was so within this time around its reading, s.
const WHILE_S: f64 = 1.0;

/// A command goes in ramps where more than this share of its switches was read on their way.
const RAMPS: f64 = 0.25;

/// A command that goes from a level to nothing or back is switched at once: a single reading between the two was taken meanwhile. What
/// may go in ramps (the speed of a pump, not the modulation of a generator) does where that happens too often for chance, and stays as it is.
/// A single reading of a tenth or less of the one before, in front of nothing, is what a transmitter still shows of what is over.
fn at_once(track: &Track, may_ramp: bool) -> Track {
    let t = &track.time_s;
    let largest = track.value.iter().fold(0.0_f64, |most, y| most.max(*y));
    let nothing = OFF * largest;
    let of = |i: usize| match track.value[i.saturating_sub(1)..track.value.len().min(i + 2)] {
        [before, y, after] if y > nothing && y <= HOLDS * before && after <= nothing => after,
        _ => track.value[i],
    };
    let y: Vec<f64> = (0..t.len()).map(of).collect();
    let is_off = |i: usize| y[i] <= nothing;
    let holds = |i: usize, j: usize| (y[i] - y[j]).abs() <= HOLDS * y[i].abs();
    let between = |i: usize, level: usize| {
        let share = y[i] / y[level];
        !is_off(i) && share < 1.0 - HOLDS
    };
    let passes = |i: usize| {
        let inner =
            i > 0 && i + 1 < y.len() && t[i] - t[i - 1] > WHILE_S && t[i + 1] - t[i] > WHILE_S;
        let off = || i > 1 && is_off(i + 1) && holds(i - 1, i - 2) && between(i, i - 1);
        let on = || i + 2 < y.len() && is_off(i - 1) && holds(i + 1, i + 2) && between(i, i + 1);
        inner && (off() || on())
    };
    let switches = (1..y.len()).filter(|&i| is_off(i) != is_off(i - 1)).count();
    let passing = (0..y.len()).filter(|&i| passes(i)).count();
    if may_ramp && passing as f64 > RAMPS * switches as f64 {
        return track.clone();
    }
    let mut switched = Track { time_s: Vec::new(), value: Vec::new() };
    for i in 0..y.len() {
        let readings: &[(f64, f64)] = match passes(i) {
            true => &[(t[i] - 0.5 * WHILE_S, y[i - 1]), (t[i] + 0.5 * WHILE_S, y[i + 1])],
            false => &[(t[i], y[i])],
        };
        for (time_s, value) in readings {
            switched.time_s.push(*time_s);
            switched.value.push(*value);
        }
    }
    switched
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_read_while_it_was_switched_is_off_from_then_on() {
        let track = |value: &[f64]| Track {
            time_s: (0..value.len()).map(|i| 10.0 * i as f64).collect(),
            value: value.to_vec(),
        };
        // Read at 0.3 at 20 s, once in four times.
        let switched = at_once(&track(&[0.8, 0.8, 0.3, 0.0, 0.6, 0.6, 0.0, 0.4]), true);
        assert_eq!(switched.time_s, [0.0, 10.0, 19.5, 20.5, 30.0, 40.0, 50.0, 60.0, 70.0]);
        assert_eq!(switched.value, [0.8, 0.8, 0.8, 0.0, 0.0, 0.6, 0.6, 0.0, 0.4]);
        // A ramp, a lower level, one that was read at once, and one that was read on its way each time stay.
        for plain in [
            &[0.8, 0.6, 0.4, 0.2, 0.0, 0.0],
            &[0.8, 0.8, 0.4, 0.4, 0.0, 0.0],
            &[0.8, 0.8, 0.8, 0.0, 0.0, 0.8],
            &[0.8, 0.8, 0.1, 0.0, 0.0, 0.0],
        ] {
            assert_eq!(at_once(&track(plain), true), track(plain));
        }
        // What is over by then is off, where it had been read before that too.
        for (over, cleaned) in [
            ([0.8, 0.8, 0.05, 0.0, 0.0], vec![0.8, 0.8, 0.0, 0.0, 0.0]),
            ([0.8, 0.8, 0.5, 0.01, 0.0], vec![0.8, 0.8, 0.8, 0.0, 0.0, 0.0]),
        ] {
            assert_eq!(at_once(&track(&over), false).value, cleaned);
        }
        let of_burner = at_once(&track(&[0.8, 0.8, 0.1, 0.0, 0.0, 0.0]), false);
        assert_eq!(of_burner.value, [0.8, 0.8, 0.8, 0.0, 0.0, 0.0, 0.0]);
    }

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
    fn a_sensor_may_be_absent_from_a_run_where_another_one_drives() {
        let sensors = SENSORS.to_owned() + &SENSORS.replace("\"T\"", "\"U\"");
        let rows = |sensors: &str, text: &str| {
            read(text, &SensorFile::from_toml(sensors).unwrap()).map_err(|e| e.to_string())
        };
        let exchanged = "time_s,run,T,U\n0,a,20,\n10,a,21,\n0,b,,30\n10,b,,31\n";
        let runs = rows(&sensors, exchanged).unwrap();
        assert_eq!(runs[1].tracks[1].value.len(), 2);
        assert!(runs[1].tracks[0].at(5.0).is_nan());
        // The same two as inputs, of one signal or of two; and a column that is never read.
        let inputs =
            sensors.replace("compare", "input") + SENSORS.replace("\"T\"", "\"V\"").as_str();
        let with_v = |text: &str| {
            text.replace(",T,U", ",T,U,V")
                .replace("20,", "20,,1")
                .replace("21,", "21,,2")
                .replace(",30", ",30,3")
                .replace(",31", ",31,4")
        };
        assert!(rows(&inputs, &with_v(exchanged)).is_ok());
        let of_two = inputs.replacen("b.t_k", "c.t_k", 1);
        let refused = rows(&of_two, &with_v(exchanged)).unwrap_err();
        assert!(
            refused.contains("column \"U\" of run \"a\" is empty: what drives b.t_k"),
            "{refused}"
        );
        let never = rows(&sensors, "time_s,T,U\n0,20,\n10,21,\n").unwrap_err();
        assert!(never.contains("\"U\""), "{never}");
    }

    #[test]
    fn held_readings_are_missing_and_steps_are_not() {
        let track = |value: &[f64]| Track {
            time_s: (0..value.len()).map(|i| i as f64).collect(),
            value: value.to_vec(),
        };
        // Rising, held at 22, and back on its way at 27.
        let held = without_held(
            &track(&[20.0, 21.0, 22.0, 22.0, 22.0, 22.0, 27.0, 28.0]),
            0.1,
            JUMP_K,
            usize::MAX,
        );
        assert_eq!(held.value, [20.0, 21.0, 22.0, 27.0, 28.0]);
        assert_eq!(held.time_s, [0.0, 1.0, 2.0, 6.0, 7.0]);
        // A plateau before a front, one of the resolution, and a pause.
        for plain in [
            &[20.0, 20.0, 20.0, 20.0, 25.0, 30.0, 35.0],
            &[20.0, 20.0, 20.0, 20.0, 20.1, 20.1, 20.2],
            &[9.0, 0.0, 0.0, 0.0, 0.0, 9.0, 9.1],
        ] {
            assert_eq!(without_held(&track(plain), 0.1, JUMP_K, usize::MAX), track(plain));
        }
    }

    #[test]
    fn a_corner_between_two_readings_is_where_lines_meet() {
        // Rests until 2.5 s, then rises by 1 a second: the readings at 2 and 3 s lie 0.25 below the lines between their neighbours.
        let t: Vec<f64> = (0..8).map(f64::from).collect();
        let track = Track { value: t.iter().map(|t| (t - 2.5).max(0.0)).collect(), time_s: t };
        assert_eq!(track.usual_bend(), 0.0);
        for time_s in [2.2, 2.5, 2.8] {
            let met = track.smooth_at(time_s, 0.0);
            assert!((met - (time_s - 2.5).max(0.0)).abs() < 1e-12, "{time_s} {met}");
        }
        // Where they usually bend half as much it is none: the cubic with slopes of 0.25 and 0.75 at its ends.
        assert!((track.smooth_at(2.5, 0.125) - 0.1875).abs() < 1e-12);
    }

    #[test]
    fn a_parabola_is_met_between_its_readings() {
        let t: Vec<f64> = [0.0, 1.0, 2.0, 3.0, 4.0, 9.0].to_vec();
        let track = Track { value: t.iter().map(|t| t * t).collect(), time_s: t };
        assert!((track.smooth_at(2.5, 1.0) - 6.25).abs() < 1e-12);
        // At the end and before a gap it is straight.
        assert_eq!(track.smooth_at(0.5, 1.0), 0.5);
        assert_eq!(track.smooth_at(3.5, 1.0), track.at(3.5));
        assert_eq!(track.smooth_at(6.5, 1.0), track.at(6.5));
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
