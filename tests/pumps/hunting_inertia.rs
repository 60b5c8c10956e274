//! SC-07 with water that has inertia: the limits move, in the analysis as in the formula and in simulation.

#![allow(clippy::unwrap_used)]

use crate::hunting::{analysis, model, peak_to_peak, run_flows};
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;
use std::f64::consts::PI;

const INERTIA: (&str, &str) = ("[model]\n", "[model]\nfluid_inertia = true\n");
/// Head of the pump without flow, Pa, and 1/cross-section of 22 mm, 1/m2.
const HEAD_PA: f64 = 40_221.0;
const PER_AREA_1_M2: f64 = 4.0 / (PI * 0.022 * 0.022);

/// Gain of the continuous loop at its limit over a gain of 1: `exp(-s)/((1 + 2 s)^2 (1 + s) (1 + tau s))` and a PI
/// controller of 8 s.
fn limit(tau_s: f64) -> f64 {
    let phase = |w: f64| {
        -w - 2.0 * (2.0 * w).atan() - w.atan() - (tau_s * w).atan() - PI / 2.0 + (8.0 * w).atan()
    };
    let (mut low, mut high) = (1e-3, 3.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if phase(middle) > -PI { low = middle } else { high = middle }
    }
    let size = |t: f64| (1.0 + (t * low).powi(2)).sqrt();
    size(2.0).powi(2) * size(1.0) * size(tau_s) * (8.0 * low) / size(8.0)
}

fn critical(model: &Model) -> f64 {
    let found = analysis(model);
    let first = &found.controllers[0];
    first.critical_gain.unwrap_or_else(|| panic!("{first:?}"))
}

#[test]
fn one_more_lag_moves_the_limits_as_by_hand() {
    assert!((limit(0.0) / 2.887 - 1.0).abs() < 1e-3, "{}", limit(0.0));
    // One feeder: everything in one loop, 2 * 50 m and four stubs of 5 m; two: what swings are their own stubs.
    for (n, length_m) in [(1, 120.0), (2, 10.0)] {
        let still = model(n, &[]);
        let run = Simulation::new(build(&still).unwrap()).unwrap();
        let speed = run.get(run.channel("plant.feeder1.feed_in_pump.speed").unwrap());
        // From the limit without inertia: gain of the water, then its resistance 2 u H0/gain, Pa s/kg.
        let without = critical(&still);
        let gain = limit(0.0) / without;
        let tau_s = length_m * PER_AREA_1_M2 * gain / (2.0 * speed * HEAD_PA);
        let with = critical(&model(n, &[INERTIA]));
        let expected = limit(tau_s) / gain;
        assert!((with / expected - 1.0).abs() < 2e-3, "N = {n}: {with} {expected}, {tau_s} s");
        assert!((with / without - 1.0).abs() > 0.03, "N = {n}: {with} {without}");
    }
}

#[test]
fn sampled_controllers_on_water_with_inertia_have_the_limit_that_simulation_finds() {
    let at = |gain: f64| {
        let gain = format!("gain = {gain}\ninterval_s = 0.1");
        let changes = [
            ("gain = 2.4", gain.as_str()),
            ("[600, 0.055]", "[10, 0.0500001]"),
            ("step = \"0.1s\"", "step = \"0.02s\""),
            INERTIA,
        ];
        model(2, &changes)
    };
    let predicted = critical(&at(1.0));
    let grows = |gain: f64| {
        let (flows, _) = run_flows(&at(gain), 60.0, 260.0);
        let difference: Vec<f64> = (0..flows[0].len()).map(|i| flows[0][i] - flows[1][i]).collect();
        peak_to_peak(&difference[5000..]) > peak_to_peak(&difference[..5000])
    };
    assert!(!grows(0.98 * predicted) && grows(1.02 * predicted), "not near {predicted}");
}

#[test]
fn what_answers_with_a_pulse_is_not_judged_without_a_word() {
    let pipe = |id: &str, from: &str, to: &str| {
        format!(
            "[[edge]]\nid = \"{id}\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = 50\n\
             inner_diameter_mm = 22\n"
        )
    };
    let text = format!(
        "format = 1\n[model]\nfluid_inertia = true\n[[node]]\nid = \"a\"\n[[node]]\nid = \"b\"\n[[node]]\nid = \"c\"\n\
         [[edge]]\nid = \"source\"\nkind = \"flow_source\"\nfrom = \"a\"\nto = \"b\"\nm_flow_kg_s = 0.05\n\
         {}{}[pressure_reference]\nnode = \"a\"\npressure_bar = 1.5\n\
         [[controller]]\nid = \"pi\"\nkind = \"pi\"\nmeasures = \"there.dp_pa\"\nacts_on = \"source.m_flow_set_kg_s\"\n\
         set_point = 2000\ngain = 1e-5\nintegral_time_s = 10\noutput_min = 0.001\noutput_max = 0.2\n",
        pipe("there", "b", "c"),
        pipe("back", "c", "a"),
    );
    let judged = |text: &str| {
        let model = Model::from_toml(text, &workspace())
            .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
        analysis(&model).controllers[0].open
    };
    assert!(judged(&text).unwrap().contains("pulse of pressure"));
    assert_eq!(judged(&text.replace("fluid_inertia = true", "fluid_inertia = false")), None);
}
