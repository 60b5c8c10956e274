//! A rule, by hand; the tables of rules are in `tests/prosumers/rules.rs`.

use super::*;
use serde_json::json;

fn rule(fields: serde_json::Value) -> Rule {
    let params: RuleParams = serde_json::from_value(fields).unwrap();
    params.build(&()).unwrap_or_else(|error| panic!("{error}"))
}

/// Outputs over steps of 10 s with what is measured; set points where it is a backup.
fn outputs(rule: &Rule, measured: &[&[f64]], set_points: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut state = rule.initial_state();
    let update = |measured: &&[f64]| {
        let inputs = Inputs { measured, set_points, limits: &[(0.0, 1.0)] };
        let mut output = [f64::NAN];
        rule.update(10.0, &inputs, &mut state, &mut output).unwrap();
        output[0]
    };
    let all = measured.iter().map(update).collect();
    (all, state)
}

#[test]
fn on_until_off() {
    let chp =
        rule(json!({ "on": "soc < 0.6 and t_8 < 65 degC", "off": "soc > 0.95 or t_3 > 70 degC" }));
    let degc = |soc: f64, t_8: f64, t_3: f64| [soc, t_8 + 273.15, t_3 + 273.15];
    let steps = [
        (degc(0.7, 60.0, 50.0), 0.0), // one of both is not enough
        (degc(0.59, 66.0, 50.0), 0.0),
        (degc(0.59, 64.0, 50.0), 1.0), // both
        (degc(0.94, 80.0, 69.0), 1.0), // stays
        (degc(0.94, 80.0, 71.0), 0.0), // one is enough to stop
        (degc(0.94, 60.0, 60.0), 0.0), // stays
        (degc(0.5, 60.0, 71.0), 0.0),  // both hold: off
        (degc(0.5, 60.0, 60.0), 1.0),
        (degc(0.96, 60.0, 60.0), 0.0),
    ];
    let measured: Vec<&[f64]> = steps.iter().map(|(values, _)| &values[..]).collect();
    let expected: Vec<f64> = steps.iter().map(|(_, output)| *output).collect();
    assert_eq!(outputs(&chp, &measured, &[]).0, expected);
    // Without `off` it follows its condition.
    let pump = rule(json!({ "on": "t > 40 degC", "on_output": 3e-4 }));
    let (all, _) = outputs(&pump, &[&[314.0], &[313.0], &[314.0]], &[]);
    assert_eq!(all, [3e-4, 0.0, 3e-4]);
}

#[test]
fn a_lock_comes_first_and_begins_anew() {
    let boiler = rule(json!({
        "on": "t < 60 degC", "off": "t > 70 degC", "lock": "top > 90 degC", "unlock": "top < 80 degC"
    }));
    let degc = |t: f64, top: f64| [t + 273.15, top + 273.15];
    let steps = [
        (degc(59.0, 60.0), 1.0),
        (degc(65.0, 91.0), 0.0),
        (degc(59.0, 85.0), 0.0),
        // Free again, and off is where it begins.
        (degc(65.0, 79.0), 0.0),
        (degc(59.0, 79.0), 1.0),
    ];
    let measured: Vec<&[f64]> = steps.iter().map(|(values, _)| &values[..]).collect();
    let (all, _) = outputs(&boiler, &measured, &[]);
    assert_eq!(all, steps.map(|(_, output)| output));
}

#[test]
fn a_backup_helps_out_and_counts() {
    let backup = rule(json!({
        "role": "backup", "on": "t < 50 degC", "off": "t > 55 degC", "wanted": 0.2, "timeout_s": 25
    }));
    let degc = |t: f64| t + 273.15;
    let temperatures = [60.0, 49.0, 54.0, 56.0, 49.0].map(degc);
    let measured: Vec<&[f64]> = temperatures.iter().map(std::slice::from_ref).collect();
    // What is wanted, whether the backup is active, heartbeat: it never changes, so after 25 s the wanted value is 0.
    let (all, state) = outputs(&backup, &measured, &[0.2, 1.0, 0.0]);
    assert_eq!(all, [0.2, 1.0, 1.0, 0.0, 1.0]);
    // 10 s after each of the first two steps of the first override
    assert_eq!((state[COUNT], state[OVERRIDDEN_S], state[LOST]), (2.0, 20.0, 1.0));
    // Switched off, and with more wanted than the rule gives.
    let patient = rule(json!({ "role": "backup", "on": "t < 50 degC", "on_output": 0.6 }));
    assert_eq!(outputs(&patient, &measured, &[0.2, 0.0, 0.0]).0, [0.2; 5]);
    assert_eq!(outputs(&patient, &measured, &[0.6, 1.0, 0.0]).0, [0.6; 5]);
    // Outside of what may be wanted: the safe output, here off.
    let (all, state) = outputs(&patient, &measured, &[0.7, 1.0, 0.0]);
    assert_eq!((all, state[REFUSES]), (vec![0.0, 0.6, 0.0, 0.0, 0.6], 1.0));
    // A valve whose rule asks for 0.
    let valve =
        rule(json!({ "role": "backup", "on": "t < 50 degC", "on_output": 0, "off_output": 1 }));
    assert_eq!(outputs(&valve, &measured, &[0.4, 1.0, 0.0]).0, [0.4, 0.0, 0.4, 0.4, 0.0]);
}

#[test]
fn what_does_not_fit_is_refused() {
    for (fields, field, words) in [
        (json!({ "on": "t <" }), "on", "missing at its end"),
        (json!({ "on": "t < 1", "off": "t < 1 " }), "off", "never be on"),
        (json!({ "on": "t < 1", "unlock": "t < 0" }), "unlock", "nothing locks it"),
        (json!({ "on": "t < 1", "wanted": 0.5 }), "wanted", "role = \"backup\""),
        (json!({ "on": "t < 1", "role": "backup", "wanted": 2 }), "wanted", "wanted_max"),
        (json!({ "on": "t < 1", "role": "backup", "timeout_s": 0 }), "timeout_s", "positive"),
        (json!({ "on": "t < 1", "off_output": 1 }), "on_output", "differ"),
    ] {
        let params: RuleParams = serde_json::from_value(fields.clone()).unwrap();
        let error = params.build(&()).unwrap_err();
        assert_eq!(error.field(), Some(field), "{fields}");
        assert!(error.to_string().contains(words), "{fields}: {error}");
    }
}
