//! Progress of long work: a bar on a terminal, plain lines elsewhere.

use anergy_core::clock::Time;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(2);

/// A bar of a length, on a terminal.
fn bar(length: u64) -> Option<ProgressBar> {
    std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(length);
        if let Ok(style) = ProgressStyle::with_template("{bar:40.cyan/blue} {percent:>3} % {msg}") {
            bar.set_style(style);
        }
        bar
    })
}

/// Shows how far a run is.
pub struct Progress {
    bar: Option<ProgressBar>,
    started: Instant,
    last_line: Instant,
}

impl Progress {
    /// Starts to show.
    pub fn new() -> Self {
        let bar = bar(1000);
        Self { bar, started: Instant::now(), last_line: Instant::now() }
    }

    /// Shows that the run has reached `now` on its way to `end`.
    pub fn update(&mut self, now: Time, end: Time) {
        let share = now.0 as f64 / end.0.max(1) as f64;
        let speed = now.as_s() / self.started.elapsed().as_secs_f64().max(1e-9);
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{now} of {end} simulated, {speed:.0} times real time"));
            bar.set_position((share * 1000.0) as u64);
        } else if self.last_line.elapsed() > LINE_EVERY {
            self.last_line = Instant::now();
            let percent = (share * 100.0) as i64;
            eprintln!("{percent:>3} %  {now} of {end} simulated, {speed:.0} times real time");
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Shows how many members of an ensemble have finished.
pub struct MemberProgress {
    bar: Option<ProgressBar>,
    started: Instant,
    last_line: Instant,
    first: usize,
    total: usize,
}

impl MemberProgress {
    /// Starts to show, with members that were there before.
    pub fn new(first: usize, total: usize) -> Self {
        let now = Instant::now();
        Self { bar: bar(total as u64), started: now, last_line: now, first, total }
    }

    /// Shows how many have finished, and how many of them have failed.
    pub fn update(&mut self, finished: usize, failed: usize) {
        let each_s = self.started.elapsed().as_secs_f64() / (finished - self.first).max(1) as f64;
        let left_s = each_s * (self.total - finished) as f64;
        let failed = if failed > 0 { format!(", {failed} failed") } else { String::new() };
        let told = format!("{finished} of {} members{failed}, {left_s:.0} s left", self.total);
        if let Some(bar) = &self.bar {
            bar.set_message(told);
            bar.set_position(finished as u64);
        } else if self.last_line.elapsed() > LINE_EVERY {
            self.last_line = Instant::now();
            eprintln!("{told}");
        }
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
