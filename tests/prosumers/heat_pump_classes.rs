//! SC-08: an air-source heat pump that charges a storage, on a cold and on a mild day, by three classes of model.
//!
//! The measurements are not published, so the "truth" is the most detailed model: all of the internal control, a
//! storage of 100 layers that draws from 10 cm around its ports, and sensors with noise. The classes beside it: all of
//! the internal control with ten layers; the steady map alone (no start, frost, pump overrun, least times, limits);
//! and a map over the return temperature alone, full speed or nothing, with a first-order lag.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::{NS_PER_S, Time};
use anergy_prosumer::performance_map::Operation;
use anergy_prosumer::performance_map::reference::ReferenceHeating;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::pages::{write_page, writes_pages};
use std::fmt::Write as _;
use std::path::Path;

const STEP_S: i64 = 10;
const COLD: std::ops::Range<usize> = 0..1080;
const MILD: std::ops::Range<usize> = 1080..2880;

/// Set points: cold 0 to 3 h, mild 3 to 8 h with eight times on and off; top of the storage around 5 h.
const PROFILE: &str = r#"
[[schedule]]
signal = "hp.modulation"
points = [[0, 1], [2100, 0], [3600, 0.5], [7200, 0], [10800, 0.3], [12000, 0], [12900, 1], [14100, 0], [15000, 0.6],
  [16200, 0], [17100, 0.8], [18900, 0], [19800, 0.4], [21000, 0], [21900, 1], [22800, 0], [23700, 0.5], [25200, 0],
  [26100, 0.7], [27300, 0]]
[[schedule]]
signal = "hp.aux_modulation"
points = [[0, 0], [1200, 0.333], [1800, 0], [2100, 1], [2700, 0]]
[[schedule]]
signal = "hp.t_outdoor_k"
unit = "degc"
interpolation = "linear"
points = [[0, -7], [10800, -3], [10801, 7], [28800, 10]]
[[schedule]]
signal = "store.charge_position"
points = [[0, 0], [900, 1], [1800, 0], [5400, 1], [7200, 0], [17100, 1], [18900, 0]]
[[schedule]]
signal = "load.load_w"
points = [[0, 3000], [7200, 7000], [10800, 4000], [21600, 6000]]
"#;

fn model(heat_pump: &str, storage: &str) -> Model {
    let text = format!(
        r#"format = 1
[run]
initial_degc = 35
[[node]]
id = "in"
kind = "source"
m_flow_kg_s = 0.01
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1
[[edge]]
id = "beside"
kind = "pipe"
from = "in"
to = "out"
length_m = 1
inner_diameter_mm = 20
[[unit]]
id = "hp"
kind = "air_source_heat_pump"
relative_humidity = 0.82
{heat_pump}
[[unit]]
id = "store"
kind = "storage"
volume_l = 785
height_m = 1.755
initial_bottom_degc = 30
initial_top_degc = 45
{storage}
[unit.ports.charge]
positions = [{{ inlet_m = 0.63, outlet_m = 0.26 }}, {{ inlet_m = 1.43, outlet_m = 1.03 }}]
[unit.ports.use]
inlet_m = 0.1
outlet_m = 1.7
[[unit]]
id = "load"
kind = "heat_load"
temperature_difference_k = 10
coldest_return_degc = 20
[[circuit]]
id = "charge"
through = ["hp.water", "store.charge"]
[[circuit]]
id = "use"
through = ["store.use", "load"]
{PROFILE}"#
    );
    Model::from_toml(&text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
}

/// Electricity, W, heat, W, outlet, degC, and state of charge, %, over time.
type Curves = [Vec<f64>; 4];
const CHANNELS: [&str; 4] = ["hp.electric_w", "hp.q_flow_w", "hp.water.t_out_k", "store.soc"];
const NAMES: [&str; 4] = ["P_el", "P_heat", "T_out", "SOC"];

fn run(model: &Model) -> Curves {
    let mut simulation = Simulation::new(build(model).unwrap()).unwrap();
    let channels = CHANNELS.map(|name| simulation.channel(name).unwrap());
    let mut curves = Curves::default();
    for step in 1..=MILD.end as i64 {
        simulation.advance_to(Time(step * STEP_S * NS_PER_S), Time(STEP_S * NS_PER_S)).unwrap();
        for (curve, channel) in curves.iter_mut().zip(channels) {
            curve.push(simulation.get(channel));
        }
    }
    curves[2].iter_mut().for_each(|t| *t -= 273.15);
    curves[3].iter_mut().for_each(|soc| *soc *= 100.0);
    curves
}

/// Sensors: 0.2 % of the electricity, 0.5 % of the heat, 0.15 K + 0.2 % of the temperatures, as equal chances within.
fn measured(mut truth: Curves) -> Curves {
    let mut seed = 11_u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        2.0 * (seed >> 40) as f64 / (1_u64 << 24) as f64 - 1.0
    };
    truth[0].iter_mut().for_each(|p| *p *= 1.0 + 0.002 * noise());
    truth[1].iter_mut().for_each(|q| *q *= 1.0 + 0.005 * noise());
    truth[2].iter_mut().for_each(|t| *t += (0.15 + 0.002 * *t) * noise());
    truth
}

/// cv(RMSE) and NMBE, %, of a model beside measurements: errors relative to the mean of what was measured.
fn metrics(model: &[f64], measured: &[f64]) -> (f64, f64) {
    let n = model.len() as f64;
    let mean = measured.iter().sum::<f64>() / n;
    let differences = model.iter().zip(measured).map(|(model, measured)| model - measured);
    let square: f64 = differences.clone().map(|difference| difference * difference).sum();
    (100.0 * (square / n).sqrt() / mean, 100.0 * differences.sum::<f64>() / n / mean)
}

/// The map over the return temperature alone, at air of 2 degC and full speed, with a lag of 120 s.
fn return_temperature_only() -> String {
    let unit = ReferenceHeating {
        nominal_w: 5750.0,
        cop: 4.65,
        cop_max: f64::INFINITY,
        return_counts_twice: true,
    };
    let (mut heat, mut electric) = (Vec::new(), Vec::new());
    let returns: Vec<f64> = (0..9).map(|i| 20.0 + 5.0 * f64::from(i)).collect();
    for t in &returns {
        let at = unit.at(&Operation {
            modulation: 1.0,
            source_in_k: 275.15,
            source_out_k: 275.15,
            return_k: t + 273.15,
            supply_k: t + 278.15,
            ambient_k: 275.15,
        });
        heat.push(at.useful_w / 1000.0);
        electric.push(at.electric_w / 1000.0);
    }
    let times: Vec<f64> = (0..=12).map(|i| 60.0 * f64::from(i)).collect();
    let lag: Vec<f64> =
        times.iter().map(|t| if *t < 720.0 { 1.0 - (-t / 120.0).exp() } else { 1.0 }).collect();
    format!(
        "map = {{ source_degc = [2], return_degc = {returns:?}, heat_kw = [{heat:?}], electric_kw = [{electric:?}] }}\n\
         modulation_min = 1\ndefrost = false\ncontent_l = 0\nrun_min_s = 0\noff_min_s = 0\nwarm_within_s = 0\n\
         stop_s = 120\npump_overrun_s = 120\nstart_times_s = {times:?}\nstart_heat = {lag:?}\nstart_power = {lag:?}\n"
    )
}

const TRUE_STORAGE: &str = "layers = 100\nentrainment_cm = 10\n";
const NO_LIMITS: &str = "dynamics = false\nheating_return_min_degc = 1\nheating_return_max_degc = 95\n\
                         restart_difference_k = 0\nsupply_max_degc = 98\n";

#[test]
fn metrics_are_exact_on_vectors() {
    // Mean 2; differences 1, 0, -1, 2: squares 6/4, root 1.2247; mean difference 0.5
    let (cv, nmbe) = metrics(&[2.0, 2.0, 1.0, 5.0], &[1.0, 2.0, 2.0, 3.0]);
    assert!((cv - 100.0 * 1.5_f64.sqrt() / 2.0).abs() < 1e-12 && (nmbe - 25.0).abs() < 1e-12);
}

#[test]
fn the_detailed_model_is_nearest_to_the_truth() {
    let truth = measured(run(&model("", TRUE_STORAGE)));
    let classes = [
        ("full", run(&model("", "layers = 10\n"))),
        ("steady map", run(&model(NO_LIMITS, "layers = 10\n"))),
        ("return temperature and lag", run(&model(&return_temperature_only(), "layers = 10\n"))),
    ];
    let mut page = String::from(
        "# Heat pump and storage: classes of model\n\nSC-08: an air-source heat pump charges a storage of 785 l, \
         three hours at -7 to -3 degC and five at 7 to 10 degC, steps of 10 s. The \"truth\" is synthetic: all of \
         the internal control, 100 layers that draw from 10 cm around their ports, noise of the sensors.\n\n\
         | model | metric, % | P_el cold/mild | P_heat cold/mild | T_out cold/mild | SOC cold/mild |\n\
         |---|---|---|---|---|---|\n",
    );
    let of = |curves: &Curves, quantity: usize, hours: std::ops::Range<usize>| {
        metrics(&curves[quantity][hours.clone()], &truth[quantity][hours])
    };
    for (name, curves) in &classes {
        for (metric, which) in [("cv(RMSE)", 0), ("NMBE", 1)] {
            write!(page, "| {name} | {metric} |").unwrap();
            for quantity in 0..NAMES.len() {
                let [cold, mild] = [COLD, MILD].map(|hours| {
                    let (cv, nmbe) = of(curves, quantity, hours);
                    [cv, nmbe][which]
                });
                write!(page, " {cold:.1}/{mild:.1} |").unwrap();
            }
            page.push('\n');
        }
    }
    page.push_str(
        "\nThe truth shares the internal control with the full model, so only storage and sensors part them. Asked: the \
         full model nearest in P_heat and T_out in both spans, its cv(RMSE) below 5 % (SOC) and 10 % (T_out), its NMBE \
         within 10 %; it is also within the 30 % and 10 % of ASHRAE. Set points are given, not controlled, so what \
         the other classes bring too much stays in the storage; its state counts from 30 degC, near which it is.\n",
    );
    println!("{page}");
    for hours in [COLD, MILD] {
        let cv = |class: usize, quantity: usize| of(&classes[class].1, quantity, hours.clone()).0;
        for (quantity, name) in [(1, "P_heat"), (2, "T_out")] {
            for class in [1, 2] {
                assert!(
                    cv(0, quantity) < cv(class, quantity),
                    "{name}: {} {}",
                    cv(0, quantity),
                    cv(class, quantity)
                );
            }
        }
        assert!(cv(0, 3) < 5.0 && cv(0, 2) < 10.0, "SOC {} T_out {}", cv(0, 3), cv(0, 2));
        for (quantity, name) in NAMES.iter().enumerate() {
            let nmbe = of(&classes[0].1, quantity, hours.clone()).1;
            assert!(nmbe.abs() <= 10.0, "{name}: {nmbe}");
        }
    }
    if writes_pages() {
        write_page(
            "heat-pump-classes",
            "cargo test --workspace --test prosumers heat_pump_classes::",
            &page,
        );
    }
}
