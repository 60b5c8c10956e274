//! Clocks that jump within a run, and columns that are off by whole half hours.
//!
//! **Equation** for each quarter of a run the shift of the simulation that fits the column best ([`super::misfit`]). A jump: one quarter
//! fits with a large shift and far worse without, another one without and far worse with it, or with one of the other sign.
//!
//! A shift must be sharp: as much more or less fits far worse. What changes slowly, such as a layer of a storage, looks shifted wherever
//! it is too warm; and beside a quarter without a shift a jump is at most a tenth of the run.
//!
//! **Assumptions** no effect of a plant delays by a minute (and five readings) in one quarter and not at all in another one, or makes
//! something arrive too late here and too early there. Longer pipes and wrong meters delay everywhere.

use super::misfit::{Column, columns};
use crate::experiment::Experiment;

/// Parts of a run.
const PARTS: usize = 4;
/// A shift is large from here, s, and from so many readings.
const LARGE: (f64, f64) = (60.0, 5.0);
/// None is within so many readings.
const NONE: f64 = 2.0;
/// Longest shift that is looked for, s, and over the run.
const FAR: (f64, f64) = (8000.0, 0.7);
/// Most shifts that are looked at first.
const MOST: f64 = 1500.0;
/// Misfit from which on a clock is suspected; by which a shift must be better, and that it may leave, as it is or over that without it.
const SUSPECT: f64 = 0.8;
const BETTER: f64 = 0.6;
const FITS: (f64, f64) = (1.0, 0.25);
/// Longest jump over the run.
const JUMP: f64 = 0.1;
/// Clocks of other zones differ by multiples of this, s.
const ZONE_S: f64 = 1800.0;

/// Shift that fits a part best: time by which its readings are late, s.
struct Part {
    until_s: f64,
    /// Where a large shift fits, and none does not.
    moved_s: Option<f64>,
    span_s: (f64, f64),
}

/// Columns whose clock cannot be right.
pub(super) fn jumps(experiment: &Experiment, readings: &[f64]) -> Vec<String> {
    let mut problems = Vec::new();
    for column in columns(experiment, readings) {
        if column.misfit().is_none_or(|misfit| misfit < SUSPECT) {
            continue;
        }
        let (run, name) =
            (&experiment.runs[column.run], &experiment.sensors.sensor[column.sensor].column);
        let of = super::of_run(run);
        let parts = parts(&column, run.span_s);
        if let Some((at_s, by_s)) = jump(&column, &parts) {
            problems.push(format!(
                "the clock of column \"{name}\"{of} seems to jump by {by_s:.0} s at about {at_s:.0} s"
            ));
        } else if let Some(late_s) = zone(&column, &parts) {
            let word = if late_s > 0.0 { "late" } else { "early" };
            problems.push(format!(
                "column \"{name}\"{of} seems to be {:.0} s {word}: summer time, or another time zone?",
                late_s.abs()
            ));
        }
    }
    problems
}

fn parts(column: &Column, span_s: (f64, f64)) -> Vec<Part> {
    let length_s = (span_s.1 - span_s.0) / PARTS as f64;
    let far_s = FAR.0.min(FAR.1 * (span_s.1 - span_s.0));
    let one = |k: usize| {
        let from_s = span_s.0 + length_s * k as f64;
        let until_s = from_s + length_s;
        let span_s = (from_s, until_s + if k + 1 == PARTS { 1.0 } else { 0.0 });
        // The simulation that runs ahead by a negative time is that of a column that is late.
        let misfit = |late_s: f64| column.beside(&column.simulated, span_s, -late_s);
        let large_s = large_s(column);
        let moved_s = misfit(0.0).and_then(|as_is| {
            let stride_s = column.interval_s.max(2.0 * far_s / MOST);
            let steps = (far_s / stride_s) as i32;
            let best = |shifts: &mut dyn Iterator<Item = f64>| {
                let fits = shifts.filter_map(|s| Some((s, misfit(s)?)));
                fits.min_by(|a, b| a.1.total_cmp(&b.1))
            };
            let coarse = best(&mut (-steps..=steps).map(|i| f64::from(i) * stride_s))?;
            let fine = (-8..=8).map(|i| coarse.0 + f64::from(i) * stride_s / 8.0);
            let (late_s, left) = best(&mut fine.chain([coarse.0]))?;
            let near = (-2..=2).map(|i| f64::from(i) * column.interval_s);
            let unmoved = near.filter_map(misfit).fold(as_is, f64::min);
            let beside = [late_s - large_s, late_s + large_s];
            let is_sharp = beside.into_iter().filter_map(misfit).all(|other| other > left + BETTER);
            (is_sharp && late_s.abs() > large_s && fits(left, unmoved)).then_some(late_s)
        });
        Part { until_s, moved_s, span_s }
    };
    (0..PARTS).map(one).collect()
}

/// Whether a misfit is small, and far smaller than another one.
fn fits(left: f64, other: f64) -> bool {
    left < FITS.0.max(FITS.1 * other) && other > left + BETTER
}

fn large_s(column: &Column) -> f64 {
    LARGE.0.max(LARGE.1 * column.interval_s)
}

/// Where a clock jumps, and by how much, s.
fn jump(column: &Column, parts: &[Part]) -> Option<(f64, f64)> {
    let whole_s = parts[PARTS - 1].until_s - parts[0].span_s.0;
    let longest_s = JUMP * whole_s;
    let other = |part: &Part, late_s: f64| -> Option<f64> {
        if let Some(here_s) = part.moved_s {
            return (here_s * late_s < 0.0).then_some(here_s);
        }
        if late_s.abs() > longest_s {
            return None;
        }
        let misfit = |s: f64| column.beside(&column.simulated, part.span_s, -s);
        let near = (-2..=2).map(|i| f64::from(i) * 0.5 * NONE * column.interval_s);
        let unmoved = near.filter_map(misfit).fold(f64::INFINITY, f64::min);
        fits(unmoved, misfit(late_s)?).then_some(0.0)
    };
    let mut found: Option<(usize, f64, f64)> = None;
    for (i, moved) in parts.iter().enumerate() {
        let Some(late_s) = moved.moved_s else { continue };
        for (j, part) in parts.iter().enumerate() {
            let Some(here_s) = other(part, late_s) else { continue };
            let by_s = if i > j { late_s - here_s } else { here_s - late_s };
            let apart = i.abs_diff(j);
            if found.is_none_or(|(least, ..)| apart < least) {
                // Between the two.
                let (first, second) = (i.min(j), i.max(j));
                let at_s = 0.5 * (parts[first].until_s + parts[second - 1].until_s);
                found = Some((apart, at_s, by_s));
            }
        }
    }
    found.map(|(_, at_s, by_s)| (at_s, by_s))
}

/// By how much a column is late, s, where that is a matter of time zones.
fn zone(column: &Column, parts: &[Part]) -> Option<f64> {
    let late: Vec<f64> = parts.iter().filter_map(|part| part.moved_s).collect();
    let late_s = *late.first()?;
    let zones = (late_s / ZONE_S).round();
    let off_s = (late_s - zones * ZONE_S).abs();
    let same = late.iter().all(|s| (s - late_s).abs() < large_s(column));
    (zones != 0.0 && same && late.len() > 1 && off_s < NONE * column.interval_s.max(30.0))
        .then_some(late_s)
}
