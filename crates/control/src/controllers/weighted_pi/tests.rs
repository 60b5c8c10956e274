#![allow(clippy::unwrap_used)]
use super::*;
use crate::controller::{Balance, Controller, Inputs};

const LIMITS: [(f64, f64); 3] = [(0.0, 1.0), (0.0, 1.0), (f64::NEG_INFINITY, f64::INFINITY)];
const L_MIN: f64 = 1.0 / 60_000.0;

fn params(variant: &str) -> WeightedPiParams {
    serde_json::from_value(serde_json::json!({ "variant": variant })).unwrap()
}

fn inputs<'a>(set_points: &'a [f64], measured: &'a [f64]) -> Inputs<'a> {
    Inputs { measured, set_points, limits: &LIMITS }
}

fn sets(q_w: f64) -> [f64; 5] {
    [q_w, 326.65, 323.15, 20.0, 20.0]
}

#[test]
fn errors_of_all_variants_by_hand() {
    // Feed-in 4 kW, 3.4 kW reached: 0.6. Hot primary 1.5 K too cold: +0.5; secondary 23 K instead of 20: -1.
    let measured = [3400.0, 325.15, 300.0, 328.0, 305.0];
    let (heat, primary, secondary) = (0.6, 0.5, -1.0);
    let expected = [
        // pump: 2/3 Q + 1/3 difference of the secondary; V: 1/3 Q + 2/3 hot primary
        ("crossover", [2.0 / 3.0 * heat + secondary / 3.0, heat / 3.0 + 2.0 / 3.0 * primary]),
        ("mixed_2", [2.0 / 3.0 * heat + secondary / 3.0, heat / 3.0 + 2.0 / 3.0 * primary]),
        // pump: 1/3 Q - 2/3 hot primary; V: 2/3 Q - 1/3 difference of the secondary
        ("same_side", [heat / 3.0 - 2.0 / 3.0 * primary, 2.0 / 3.0 * heat - secondary / 3.0]),
        ("mixed_1", [heat / 3.0 - 2.0 / 3.0 * primary, 2.0 / 3.0 * heat - secondary / 3.0]),
    ];
    for (variant, expected) in expected {
        let found = params(variant).build(&()).unwrap().errors(&inputs(&sets(4000.0), &measured));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{variant}: {found} {expected}");
        }
    }
    // Extraction 6 kW, 6.3 kW taken: -0.3. Primary 17 K instead of 20: +1; hot secondary 3 K too warm: -1.
    let measured = [-6300.0, 330.0, 313.0, 326.15, 303.15];
    let (heat, primary, secondary) = (-0.3, 1.0, -1.0);
    let expected = [
        ("crossover", [heat / 3.0 + 2.0 / 3.0 * secondary, 2.0 / 3.0 * heat + primary / 3.0]),
        ("mixed_1", [heat / 3.0 + 2.0 / 3.0 * secondary, 2.0 / 3.0 * heat + primary / 3.0]),
        ("same_side", [2.0 / 3.0 * heat - primary / 3.0, heat / 3.0 - 2.0 / 3.0 * secondary]),
        ("mixed_2", [2.0 / 3.0 * heat - primary / 3.0, heat / 3.0 - 2.0 / 3.0 * secondary]),
    ];
    for (variant, expected) in expected {
        let found = params(variant).build(&()).unwrap().errors(&inputs(&sets(-6000.0), &measured));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{variant}: {found} {expected}");
        }
    }
}

#[test]
fn modes_start_anew_and_leave_the_other_outputs_alone() {
    let controller = params("crossover").build(&()).unwrap();
    let mut state = controller.initial_state();
    let mut outputs = [0.3, 0.3, 0.3];
    // At its objectives: everything stays where it starts, at the smallest outputs.
    let fed = [4000.0, 326.65, 300.0, 328.15, 308.15];
    controller.update(0.0, &inputs(&sets(4000.0), &fed), &mut state, &mut outputs).unwrap();
    assert_eq!(outputs, [0.25, 0.0, 2.0 * L_MIN]);
    // 1.5 kW too little: e = 1 for the pump, 0.5 for the flow. After 4 s of 8: K e (1 + 1/2), 1.5 of speed
    // is beyond 1; 2 + 1.5 0.5 1.5 = 3.125 l/min.
    let low = [2500.0, 326.65, 300.0, 328.15, 308.15];
    controller.update(4.0, &inputs(&sets(4000.0), &low), &mut state, &mut outputs).unwrap();
    assert!((outputs[0] - 1.0).abs() < 1e-12 && (outputs[2] / L_MIN - 3.125).abs() < 1e-9);
    // Extraction: the valve and the flow of the other direction.
    let drawn = [-4000.0, 330.0, 310.0, 323.15, 303.15];
    controller.update(1.0, &inputs(&sets(-4000.0), &drawn), &mut state, &mut outputs).unwrap();
    assert_eq!(outputs, [0.0, 0.25, -2.0 * L_MIN]);
    // 90 W are idleness.
    controller.update(1.0, &inputs(&sets(90.0), &drawn), &mut state, &mut outputs).unwrap();
    assert_eq!(outputs, [0.0, 0.0, 0.0]);
}

#[test]
fn it_does_not_wind_up_and_its_balance_knows_the_limits() {
    let controller = params("crossover").build(&()).unwrap();
    let mut state = controller.initial_state();
    let mut outputs = [0.0; 3];
    let low = [0.0, 320.0, 300.0, 328.15, 320.0];
    for _ in 0..1000 {
        controller.update(1.0, &inputs(&sets(10_000.0), &low), &mut state, &mut outputs).unwrap();
    }
    assert_eq!(outputs[0], 1.0);
    assert!(state[0] <= 1.0 + 1e-9 && state[1] <= 8.5 * L_MIN * (1.0 + 1e-9), "{state:?}");
    // Enough again: it comes down at once.
    let high = [10_500.0, 327.0, 300.0, 328.15, 308.15];
    controller.update(1.0, &inputs(&sets(10_000.0), &high), &mut state, &mut outputs).unwrap();
    assert!(outputs[0] < 1.0, "{outputs:?}");
    // The miss is the error, negative for a flow of the other direction: e = 2/3 0.6; outputs that are not in
    // use are zero.
    let mut balance = [Balance::default(); 3];
    let (sets, drawn) = (sets(-4000.0), [-3400.0, 330.0, 310.0, 323.15, 303.15]);
    let inputs = inputs(&sets, &drawn);
    controller.balance(&inputs, &outputs, &mut balance);
    let misses = balance.map(|balance| balance.miss);
    assert!(misses[0] == 0.0 && (misses[1] - 0.2).abs() < 1e-12, "{misses:?}");
    assert!((misses[2] + 0.4).abs() < 1e-12, "{misses:?}");
    let limits = [0, 1, 2].map(|output| controller.limits_now(output, &inputs));
    assert_eq!(limits, [(0.0, 0.0), (0.25, 1.0), (-8.5 * L_MIN, -2.0 * L_MIN)]);
}

#[test]
fn heat_in_the_wrong_direction_is_not_taken_for_the_wanted_one() {
    let controller = params("crossover").build(&()).unwrap();
    let at = |q_w: f64| {
        controller.errors(&inputs(&sets(4000.0), &[q_w, 326.65, 300.0, 328.15, 308.15]))[0]
    };
    assert!((at(-4000.0) - 2.0 / 3.0 * 8.0).abs() < 1e-12, "{}", at(-4000.0));
}

#[test]
fn wrong_fields_are_named() {
    let field = |change: fn(&mut WeightedPiParams)| {
        let mut params = params("same_side");
        change(&mut params);
        params.build(&()).unwrap_err().field().unwrap()
    };
    assert_eq!(field(|p| p.feed_in_primary_alpha = Some(1.2)), "feed_in_primary_alpha");
    assert_eq!(field(|p| p.extraction_primary_gain = 0.0), "extraction_primary_gain");
    assert_eq!(field(|p| p.v_flow_min_m3_s = 1.0), "v_flow_min_m3_s");
    assert_eq!(field(|p| p.start_share = -0.1), "start_share");
}
