//! A bench for tests: two pipes in series, with data from the model itself and an effect that it does not have.

#![allow(clippy::unwrap_used)]

use crate::data::{Run, Track};
use crate::experiment::Experiment;
use crate::sensors::SensorFile;
use crate::unknown::Unknown;
use anergy_simulation::model::Model;
use std::path::Path;

const MODEL: &str = r#"
format = 1
[model]
name = "bench"
[run]
step = "10s"
[ground]
temperature_degc = 10
[[node]]
id = "plant"
kind = "source"
m_flow_kg_s = 0.2
temperature_degc = 47
[[node]]
id = "middle"
kind = "junction"
[[node]]
id = "house"
kind = "pressure_boundary"
pressure_bar = 2
temperature_degc = 47
[[edge]]
id = "near"
kind = "pipe"
from = "plant"
to = "middle"
length_m = 20
inner_diameter_mm = 27.2
insulation_resistance_k_m_w = 2
[[edge]]
id = "far"
kind = "pipe"
from = "middle"
to = "house"
length_m = 20
inner_diameter_mm = 27.2
insulation_resistance_k_m_w = 2
"#;

const SENSORS: &str = r#"
[[sensor]]
column = "T_in"
signal = "plant.temperature_k"
unit = "K"
role = "input"
class = "pt100_a"
[[sensor]]
column = "flow"
signal = "plant.m_flow_kg_s"
unit = "kg_s"
role = "input"
class = "mid"
[[sensor]]
column = "T_middle"
signal = "middle.t_k"
unit = "K"
role = "compare"
class = "pt100_a"
[[sensor]]
column = "T_house"
signal = "house.t_k"
unit = "K"
role = "compare"
class = "pt100_a"
"#;

/// One hour, a reading every 10 s: water at 47 degC, from the middle on within 2 min at 62 degC; 0.2 kg/s, in the third quarter 0.1 kg/s, in
/// the last 2 min nothing.
pub(crate) fn experiment(hidden: &[(Unknown, f64)]) -> Experiment {
    let times: Vec<f64> = (0..=360).map(|k| 10.0 * f64::from(k)).collect();
    let track = |of: &dyn Fn(f64) -> f64| Track {
        time_s: times.clone(),
        value: times.iter().map(|t| of(*t)).collect(),
    };
    let flow = |t: f64| match t {
        t if t > 3480.0 => 0.0,
        t if t > 1800.0 && t <= 2700.0 => 0.1,
        _ => 0.2,
    };
    let blank = track(&|_| 320.15);
    let inlet = track(&|t| 320.15 + 15.0 * ((t - 1800.0) / 120.0).clamp(0.0, 1.0));
    let tracks = vec![inlet, track(&flow), blank.clone(), blank];
    let run = Run { name: String::new(), tracks, span_s: (0.0, 3600.0) };
    let model = Model::from_toml(MODEL, Path::new(".")).unwrap();
    let sensors = SensorFile::from_toml(SENSORS).unwrap();
    let empty = Experiment::new(model.clone(), sensors.clone(), vec![run.clone()]).unwrap();
    let (unknowns, at): (Vec<Unknown>, Vec<f64>) = hidden.iter().cloned().unzip();
    let readings = empty.readings(&unknowns, &at).unwrap();
    let mut run = run;
    for (sample, reading) in empty.samples.iter().zip(readings) {
        let track = &mut run.tracks[sample.sensor];
        let k = track.time_s.partition_point(|t| *t < sample.time_s);
        track.value[k] = reading;
    }
    Experiment::new(model, sensors, vec![run]).unwrap()
}
