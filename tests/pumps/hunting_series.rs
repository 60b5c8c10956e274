//! Controllers in series: the output of one is the set point of another. Against the cascade in one controller, and
//! against simulation.

#![allow(clippy::unwrap_used)]

use crate::hunting::{analysis, peak_to_peak, run_flows, wave};
use anergy_simulation::model::Model;
use anergy_simulation::stability::hunting::Hunting;
use anergy_tests::workspace;

/// What a controller of the example is replaced by.
#[derive(Clone, Copy)]
struct Series {
    outer: f64,
    inner: f64,
    outer_interval_s: f64,
    inner_interval_s: f64,
    /// Whether the outer controller stands, and updates, first.
    outer_first: bool,
}

const SERIES: Series = Series {
    outer: -2e5,
    inner: -4e-6,
    outer_interval_s: 0.1,
    inner_interval_s: 0.1,
    outer_first: true,
};

/// Two feeders whose flow moves the set point of a pressure difference over the pump, and that its speed.
fn two_feeders(controllers: impl Fn(usize) -> String) -> Model {
    let folder = workspace().join("examples/pump-hunting");
    let mut text = std::fs::read_to_string(folder.join("n2.toml")).unwrap();
    for i in [1, 2] {
        let from = text.find(&format!("[[controller]]\nid = \"pi{i}\"")).unwrap();
        let end = "integral_time_s = 8\n";
        let to = from + text[from..].find(end).unwrap() + end.len();
        let sensor = format!(
            "[[sensor]]\nid = \"dp{i}\"\nmeasures = \"plant.feeder{i}.feed_in_pump.dp_pa\"\ntime_constant_s = 0.5\n"
        );
        text.replace_range(from..to, &format!("{sensor}{}", controllers(i)));
    }
    let text = text.replace("[600, 0.055]", "[10, 0.0500001]");
    Model::from_toml(&text, &folder).unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
}

fn in_series(series: Series) -> Model {
    let Series { outer, inner, outer_interval_s, inner_interval_s, outer_first } = series;
    two_feeders(|i| {
        let outer = format!(
            "[[controller]]\nid = \"pi{i}\"\nkind = \"pi\"\nmeasures = \"flow{i}.value\"\nacts_on = \"in{i}.set_point\"\n\
             set_point = 0.05\ngain = {outer:e}\nintegral_time_s = 40\noutput_min = -40000\noutput_max = 0\n\
             initial_output = -8000\ninterval_s = {outer_interval_s}\n"
        );
        let inner = format!(
            "[[controller]]\nid = \"in{i}\"\nkind = \"pi\"\nmeasures = \"dp{i}.value\"\n\
             acts_on = \"plant.feeder{i}.feed_in_pump.speed\"\nset_point = -8000\ngain = {inner:e}\n\
             integral_time_s = 4\ninterval_s = {inner_interval_s}\n"
        );
        if outer_first { format!("{outer}{inner}") } else { format!("{inner}{outer}") }
    })
}

/// The fastest growing mode in a run: period, s, and growth, 1/s.
fn simulated(model: &Model, from_s: f64, to_s: f64) -> (f64, f64) {
    let (flows, _) = run_flows(model, from_s, to_s);
    let difference: Vec<f64> = (0..flows[0].len()).map(|i| flows[0][i] - flows[1][i]).collect();
    wave(&difference, 0.1)
}

fn all_judged(found: &Hunting) {
    for controller in &found.controllers {
        assert!(controller.open.is_none(), "{controller:?}");
        assert_eq!(controller.group.len(), 4);
    }
}

#[test]
fn two_controllers_in_a_row_are_the_cascade_in_one() {
    let cascade = two_feeders(|i| {
        format!(
            "[[controller]]\nid = \"pi{i}\"\nkind = \"cascade\"\nmeasures = \"flow{i}.value\"\n\
             inner_measures = \"dp{i}.value\"\nacts_on = \"plant.feeder{i}.feed_in_pump.speed\"\nset_point = 0.05\n\
             gain = -4e5\nintegral_time_s = 40\ninner_set_min = -40000\ninner_set_max = 0\ninner_gain = -4e-6\n\
             inner_integral_time_s = 4\ninterval_s = 0.1\n"
        )
    });
    let (one, two) = (analysis(&cascade), analysis(&in_series(Series { outer: -4e5, ..SERIES })));
    all_judged(&two);
    let (one, two) = (&one.modes[0], &two.modes[0]);
    assert!((two.period_s / one.period_s - 1.0).abs() < 1e-5, "{one:?} {two:?}");
    assert!((two.growth_per_s - one.growth_per_s).abs() < 1e-6, "{one:?} {two:?}");
    assert!(one.growth_per_s > 0.0 && two.participation.len() == 4);
}

#[test]
fn series_have_the_limit_that_simulation_finds() {
    let found = analysis(&in_series(SERIES));
    all_judged(&found);
    assert!(found.controllers.iter().all(|c| c.stable));
    let critical =
        |id: &str| found.controllers.iter().find(|c| c.id == id).unwrap().critical_gain.unwrap();
    let factor = critical("pi1") / SERIES.outer;
    // All controllers of the group are scaled together.
    assert!((critical("in2") / SERIES.inner / factor - 1.0).abs() < 1e-6);
    let grows = |share: f64| {
        let (outer, inner) = (SERIES.outer * factor * share, SERIES.inner * factor * share);
        let (flows, _) = run_flows(&in_series(Series { outer, inner, ..SERIES }), 100.0, 400.0);
        let difference: Vec<f64> = (0..flows[0].len()).map(|i| flows[0][i] - flows[1][i]).collect();
        peak_to_peak(&difference[2000..]) > peak_to_peak(&difference[..1000])
    };
    assert!(!grows(0.98) && grows(1.02), "limit not within 2 % of {factor}");
}

#[test]
fn slower_outer_controllers_and_later_ones_grow_as_predicted() {
    let slower = Series { outer_interval_s: 1.0, ..SERIES };
    let later =
        Series { outer_interval_s: 0.5, inner_interval_s: 0.5, outer_first: false, ..SERIES };
    for series in [slower, later] {
        let found = analysis(&in_series(series));
        all_judged(&found);
        let pi = found.controllers.iter().find(|c| c.id == "pi1").unwrap();
        let factor = 1.1 * pi.critical_gain.unwrap() / series.outer;
        let (outer, inner) = (series.outer * factor, series.inner * factor);
        let model = in_series(Series { outer, inner, ..series });
        let mode = &analysis(&model).modes[0];
        assert!(mode.growth_per_s > 0.005, "{mode:?}");
        let (period_s, growth) = simulated(&model, 60.0, 200.0);
        assert!((period_s / mode.period_s - 1.0).abs() < 5e-3, "{period_s} {}", mode.period_s);
        assert!((growth - mode.growth_per_s).abs() < 1e-3, "{growth} {}", mode.growth_per_s);
    }
}

#[test]
fn series_at_a_limit_have_open_loops() {
    let text = in_series(SERIES).text;
    let text = text.replace("set_point = 0.05\n", "set_point = 5.0\n");
    let text = text.replace("output_min = -40000", "output_min = -60000");
    let folder = workspace().join("examples/pump-hunting");
    let found = analysis(&Model::from_toml(&text, &folder).unwrap());
    for controller in found.controllers.iter().filter(|c| c.id.ends_with('2')) {
        assert_eq!(controller.open, Some("its output is at a limit"), "{controller:?}");
    }
}
