//! `[tolerance]` of a model: how well its numbers are known decides what is an effect.

#![allow(clippy::unwrap_used)]

use anergy_discrepancy::data;
use anergy_discrepancy::experiment::Experiment;
use anergy_discrepancy::explain::{Explanation, Verdict, explain};
use anergy_discrepancy::sensors::SensorFile;
use anergy_simulation::model::Model;
use std::fmt::Write;
use std::path::Path;

/// A mixed storage that nobody draws from. 0.3 m3 of 1000 kg/m3 and 4180 J/(kg K) hold 1.254 MJ/K; with 6 W/K it cools towards 20 degC
/// with a time constant of 209000 s.
const STANDBY: &str = r#"
format = 1
[run]
step = "300s"
initial_degc = 70
[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4180
[[unit]]
id = "storage"
kind = "storage"
volume_m3 = 0.3
height_m = 1.5
layers = 1
ua_w_k = 6
ambient_degc = 20
ports = { draw = { inlet_layer = 1, outlet_layer = 1 } }
[[unit]]
id = "draw"
kind = "prescribed_source"
supply_degc = 30
v_flow_l_min = 0
[[circuit]]
id = "heating"
through = ["draw", "storage.draw"]
"#;

const SENSORS: &str = r#"
[[sensor]]
column = "flow"
signal = "draw.v_flow_m3_s"
unit = "l_h"
role = "input"
class = "mid"
[[sensor]]
column = "T_1"
signal = "storage.t_1_k"
unit = "degC"
role = "compare"
class = "heat_meter_pair"
[[sensor]]
column = "T_2"
signal = "storage.t_1_k"
unit = "degC"
role = "compare"
class = "heat_meter_pair"
"#;

/// Of a storage that loses 1.12 times as much, for two days: 70 to 37.8 degC instead of 70 to 41.9.
fn explained(tolerance: &str) -> Explanation {
    let mut table = String::from("time_s,flow,T_1,T_2\n");
    for k in 0..=288_u32 {
        let t_s = f64::from(600 * k);
        let t_degc = 20.0 + 50.0 * (-1.12 * t_s / 209_000.0).exp();
        // What a sensor of 0.02 K shows beside: a pattern that repeats no sooner than the run ends.
        let noise = |n: u32| 0.02 * (f64::from((n * k) % 289) / 144.0 - 1.0);
        writeln!(table, "{t_s},0,{},{}", t_degc + noise(97), t_degc + noise(151)).unwrap();
    }
    let sensors = SensorFile::from_toml(SENSORS).unwrap();
    let runs = data::read(&table, &sensors).unwrap();
    let model = Model::from_toml(&format!("{STANDBY}{tolerance}"), Path::new(".")).unwrap();
    explain(&Experiment::new(model, sensors, runs).unwrap(), None).unwrap()
}

#[test]
fn a_loss_within_what_is_known_of_it_is_no_effect_and_beyond_it_is_one() {
    // Usual is a standard deviation of 8 %: ln 1.12 = 0.113 are 1.4 of them. Of a loss known to 3 % they are 0.113/(0.0296/root 3) = 6.6.
    let usual = explained("");
    assert_eq!(usual.verdict, Verdict::Nothing, "{}", usual.because);
    let known = explained("[tolerance]\nstorage_loss = 0.03\n");
    assert_eq!(known.verdict, Verdict::Named, "{}", known.because);
    let [loss] = &known.effects[..] else { panic!("{:?}", known.effects) };
    assert_eq!((loss.id, loss.component.as_str()), ("T1", "storage"));
    assert!(loss.estimate.lo < 1.12 && 1.12 < loss.estimate.hi, "{:?}", loss.estimate);
}
