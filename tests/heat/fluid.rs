//! What flows: water and glycol mixtures with their properties, and the temperatures at which a model holds.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::medium::glycol::Glycol;
use anergy_core::medium::{Liquid, Medium, water};
use anergy_core::recorder::{Channel, Event, Recorder, RunHeader};
use anergy_simulation::build::build;
use anergy_simulation::error::RunError;
use anergy_simulation::model::Model;
use anergy_simulation::run::{self, RunOptions};
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

/// Water of `t_degc` through 100 m of a wide pipe, 0.01 kg/s: laminar.
fn pipe(fluid: &str, t_degc: f64, initial_degc: f64) -> String {
    format!(
        "format = 1\n[fluid]\n{fluid}\n[run]\ninitial_degc = {initial_degc:?}\n\
         [[node]]\nid = \"in\"\nkind = \"pressure_boundary\"\npressure_bar = 1.0\ntemperature_degc = {t_degc:?}\n\
         [[node]]\nid = \"out\"\nkind = \"source\"\nm_flow_kg_s = -0.01\n\
         [[edge]]\nid = \"pipe\"\nkind = \"pipe\"\nfrom = \"in\"\nto = \"out\"\nlength_m = 100.0\n\
         inner_diameter_mm = 20.0\n"
    )
}

/// Hagen-Poiseuille: `128 mu L m/(pi rho d^4)`.
fn laminar_pa(density_kg_m3: f64, viscosity_pa_s: f64) -> f64 {
    128.0 * viscosity_pa_s * 100.0 * 0.01
        / (std::f64::consts::PI * density_kg_m3 * 0.02_f64.powi(4))
}

fn dp_pa(text: &str) -> f64 {
    steady::solve(&model(text)).unwrap().edge("pipe").unwrap().dp_pa
}

fn near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found} instead of {expected}");
}

#[test]
fn a_liquid_has_its_properties_at_the_reference_temperature() {
    let text = pipe("kind = \"water\"\nreference_temperature_degc = 15.0", 80.0, 20.0);
    let (rho, mu) = (water::density_kg_m3(288.15), water::viscosity_pa_s(288.15));
    // IAPWS: 999.103 kg/m3, 1.1375 mPa s at 15 degC
    near(rho, 999.103, 1e-5);
    near(mu, 1.1375e-3, 1e-3);
    near(dp_pa(&text), laminar_pa(rho, mu), 1e-9);
    // At 50 degC unless given.
    near(dp_pa(&pipe("kind = \"water\"", 80.0, 20.0)), laminar_pa(988.035, 0.54652e-3), 1e-3);
    let glycol = pipe("kind = \"propylene_glycol\"\nshare = 0.3", -5.0, 0.0);
    let medium = Medium::glycol(Glycol::Propylene, 0.3, 323.15);
    assert_eq!(model(&glycol).medium, medium);
    near(dp_pa(&glycol), laminar_pa(medium.density_kg_m3, medium.viscosity_pa_s), 1e-9);
}

#[test]
fn the_viscosity_of_a_pipe_follows_its_temperature_where_that_is_asked_for() {
    let text = pipe("kind = \"water\"\nfollow_temperature = true", 80.0, 10.0);
    // IAPWS at 80 degC: 971.790 kg/m3, 0.35405 mPa s
    near(dp_pa(&text), laminar_pa(971.790, 0.354_05e-3), 1e-4);
    // In a run from 10 degC: first the cold water (999.702 kg/m3, 1.3059 mPa s), in the end the hot one. The
    // content, 31.4 kg, is exchanged in 3142 s; in between the mean temperature rises in a straight line.
    let mut simulation = Simulation::new(build(&model(&text)).unwrap()).unwrap();
    let dp = simulation.channel("pipe.dp_pa").unwrap();
    near(simulation.get(dp), laminar_pa(999.702, 1.305_9e-3), 1e-4);
    let mut advance = |seconds: f64| {
        let step = Time::from_s(10.0).unwrap();
        simulation.advance_to(Time::from_s(seconds).unwrap(), step).unwrap();
        simulation.get(dp)
    };
    let content_s = std::f64::consts::PI / 4.0 * 0.02_f64.powi(2) * 100.0 * 988.035 / 0.01;
    let half_k = 273.15 + 45.0;
    let half = laminar_pa(water::density_kg_m3(half_k), water::viscosity_pa_s(half_k));
    // One step late (10 s: 0.2 K, 0.4 %), and 0.1 % that is not followed.
    near(advance((content_s / 2.0 / 10.0).round() * 10.0), half, 6e-3);
    near(advance(3200.0), laminar_pa(971.790, 0.354_05e-3), 2e-3);
    // Constants do not follow anything.
    let plain = dp_pa(&pipe("", 80.0, 10.0));
    near(plain, laminar_pa(1000.0, 1.0016e-3), 1e-9);
}

#[test]
fn a_model_with_any_fluid_is_written_as_it_is() {
    for fluid in [
        "kind = \"water\"\nreference_temperature_degc = 15.0\nfollow_temperature = true",
        "kind = \"ethylene_glycol\"\nshare = 0.25",
        "kind = \"brine\"\ndensity_kg_m3 = 980.0\nheat_capacity_j_kg_k = 4300.0\nviscosity_pa_s = 4e-3\n\
         conductivity_w_m_k = 0.45\nmin_temperature_degc = -15.0\nmax_temperature_degc = 40.0",
    ] {
        let first = model(&pipe(fluid, 5.0, 20.0));
        let again = model(&first.to_plain_toml().unwrap());
        assert_eq!(
            (first.medium, first.follow_temperature),
            (again.medium, again.follow_temperature)
        );
    }
}

#[test]
fn a_glycol_may_be_colder_than_water() {
    let below = pipe("kind = \"ethylene_glycol\"\nshare = 0.3", -10.0, -5.0);
    let steady = steady::solve(&model(&below)).unwrap();
    assert!((steady.node("out").unwrap().t_k - 263.15).abs() < 1e-3);
    // Freezes at -14.6 degC; water at 0.
    for (fluid, t_degc, limits) in [
        (
            "kind = \"ethylene_glycol\"\nshare = 0.3",
            -16.0,
            "this glycol mixture (-14.07 to 99 degC)",
        ),
        ("kind = \"water\"", 0.2, "liquid water (0.5 to 99 degC)"),
        ("", 99.5, "liquid water (0.5 to 99 degC)"),
    ] {
        let problems = build(&model(&pipe(fluid, t_degc, 20.0))).unwrap_err();
        assert!(problems.0[0].message.contains(limits), "{}", problems.0[0].message);
    }
}

/// 2 m of pipe in air of 150 degC, without flow: `T = 150 - 130 e^(-t/tau)`,
/// `tau = R rho cp A = 1 * 1000 * 4180 * 3.14159e-4 = 1313.2 s`; 99 degC after `tau ln(130/51) = 1228.8 s`.
const OVEN: &str = "format = 1
[run]
until = \"1h\"
step = \"10s\"
record = \"100s\"
[[node]]
id = \"a\"
[[node]]
id = \"b\"
[[edge]]
id = \"oven\"
kind = \"pipe\"
from = \"a\"
to = \"b\"
length_m = 2.0
inner_diameter_mm = 20.0
insulation_resistance_k_m_w = 1.0
surroundings_degc = 150.0
[pressure_reference]
node = \"a\"
";

/// The times of the recorded rows.
struct Times<'a>(&'a mut Vec<f64>);

impl Recorder for Times<'_> {
    fn start(&mut self, _header: &RunHeader, _channels: &[Channel]) -> Result<(), RecordError> {
        Ok(())
    }

    fn row(&mut self, time: Time, _values: &[f64]) -> Result<(), RecordError> {
        self.0.push(time.as_s());
        Ok(())
    }

    fn event(&mut self, _event: &Event) -> Result<(), RecordError> {
        Ok(())
    }

    fn finish(self: Box<Self>, summary: &serde_json::Value) -> Result<(), RecordError> {
        assert_eq!(summary["interrupted"], true);
        Ok(())
    }
}

#[test]
fn a_run_whose_water_boils_stops_and_keeps_its_rows() {
    let mut simulation = Simulation::new(build(&model(OVEN)).unwrap()).unwrap();
    let mut times = Vec::new();
    let (options, recorder) = (RunOptions::default(), Box::new(Times(&mut times)));
    let stopped = run::run(&mut simulation, options, recorder, &mut |_, _| true).unwrap_err();
    match &stopped {
        RunError::Temperature { component, t_degc, .. } => {
            assert_eq!(component, "oven");
            assert!((99.0..99.6).contains(t_degc), "{t_degc}");
        }
        other => panic!("{other}"),
    }
    let message = stopped.to_string();
    assert!(message.contains("at 20m 30s: "), "{message}");
    assert!(message.contains("from 0.5 to 99 degC"), "{message}");
    assert_eq!(times.last(), Some(&1200.0));
}

#[test]
fn steady_states_and_brines_have_limits_too() {
    assert!(matches!(
        steady::solve(&model(OVEN)).unwrap_err(),
        RunError::Temperature { component, .. } if component == "oven"
    ));
    let brine = "kind = \"brine\"\ndensity_kg_m3 = 980.0\nheat_capacity_j_kg_k = 4300.0\nviscosity_pa_s = 4e-3\n\
                 conductivity_w_m_k = 0.45\nmin_temperature_degc = -15.0\nmax_temperature_degc = 40.0";
    let model = model(&pipe(brine, 5.0, 20.0));
    assert!(matches!(model.medium.liquid, Liquid::Brine { .. }));
    near(dp_pa(&pipe(brine, 5.0, 20.0)), laminar_pa(980.0, 4e-3), 1e-9);
}
