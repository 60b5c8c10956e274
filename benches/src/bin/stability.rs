//! Time of the stability analysis of a model: `stability MODEL [REPEATS]`; steady state and analysis, without reading.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use anergy_simulation::model::Model;
use anergy_simulation::stability::analyse;
use std::path::Path;
use std::time::{Duration, Instant};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().unwrap_or_default();
    let repeats = arguments.next().and_then(|text| text.parse().ok()).unwrap_or(20_u32);
    let path = Path::new(&path);
    let text = std::fs::read_to_string(path).unwrap();
    let model = Model::from_toml(&text, path.parent().unwrap())
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
    let mut least = Duration::MAX;
    let mut growing = 0;
    for _ in 0..repeats {
        let start = Instant::now();
        let found = analyse(&model).unwrap();
        least = least.min(start.elapsed());
        growing = found.modes.iter().filter(|mode| mode.growth_per_s > 0.0).count();
    }
    println!("{:.1} ms, least of {repeats}; {growing} modes grow", least.as_secs_f64() * 1e3);
}
