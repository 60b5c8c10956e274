//! Progress of long work: a bar on a terminal, plain lines elsewhere.

use anergy_core::clock::Time;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Time between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(2);

/// Shows how far a run is.
pub struct Progress {
    bar: Option<ProgressBar>,
    started: Instant,
    last_line: Instant,
}

impl Progress {
    /// Starts to show.
    pub fn new() -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(1000);
            if let Ok(style) =
                ProgressStyle::with_template("{bar:40.cyan/blue} {percent:>3} % {msg}")
            {
                bar.set_style(style);
            }
            bar
        });
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
