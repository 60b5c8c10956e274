//! Controllers that a user adds to a simulation: same order, same ticks and same numbers as those of the model.
#![allow(clippy::unwrap_used)]

use anergy_control::controller::{ControlError, Timing};
use anergy_control::user_controller::UserController;
use anergy_core::clock::Time;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::build::build;
use anergy_simulation::error::RunError;
use anergy_simulation::model::Model;
use anergy_simulation::model_file::StepEntry;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;
use std::sync::{Arc, Mutex};

const FLOW: &str = "sf1.feed_in_pump.m_flow_kg_s";
const SPEED: &str = "sf1.feed_in_pump.speed";
const OTHER: &str = "sf2.feed_in_pump.speed";

/// The example, with its own PI controller on the flow of SF1 when wanted.
fn model(with_pi: bool) -> Model {
    let dir = workspace().join("examples/three-houses");
    let mut text = std::fs::read_to_string(dir.join("model.toml")).unwrap();
    if with_pi {
        text += &format!(
            "\n[[controller]]\nid = \"flow\"\nkind = \"pi\"\nmeasures = \"{FLOW}\"\nacts_on = \"{SPEED}\"\n\
             set_point = 0.03\ngain = 0.6\nintegral_time_s = 8\ninterval_s = 0.7\ninitial_output = 0.5\n"
        );
    }
    Model::from_toml(&text, &dir).unwrap()
}

fn simulation(with_pi: bool) -> Simulation {
    Simulation::new(build(&model(with_pi)).unwrap()).unwrap()
}

/// The PI law of the model file, written again; notes when it was called.
struct Pi {
    interval_s: f64,
    integral: f64,
    last_s: Option<f64>,
    calls: Arc<Mutex<Vec<f64>>>,
}

impl UserController for Pi {
    fn timing(&self) -> Timing {
        Timing { interval_s: self.interval_s, offset_s: 0.0 }
    }

    fn start(&mut self) -> Result<(), ControlError> {
        (self.integral, self.last_s) = (0.5, None);
        self.calls.lock().unwrap().clear();
        Ok(())
    }

    fn update(
        &mut self,
        time_s: f64,
        measured: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        self.calls.lock().unwrap().push(time_s);
        // As the clock of the simulation rounds.
        let dt_s = self.last_s.map_or(0.0, |last| ((time_s - last) * 1e9).round() / 1e9);
        self.last_s = Some(time_s);
        let push = 0.6 * (0.03 - measured[0]);
        let share = dt_s / 8.0;
        self.integral += push * share;
        let unlimited = self.integral + push;
        let limited = unlimited.clamp(0.0, 1.0);
        self.integral += (limited - unlimited) * share.min(1.0);
        outputs[0] = limited;
        Ok(())
    }
}

fn pi(interval_s: f64) -> (Box<Pi>, Arc<Mutex<Vec<f64>>>) {
    let calls = Arc::default();
    (Box::new(Pi { interval_s, integral: 0.0, last_s: None, calls: Arc::clone(&calls) }), calls)
}

fn add(simulation: &mut Simulation, controller: Box<dyn UserController>) -> Result<(), RunError> {
    let (measures, acts_on) = (simulation.channel(FLOW)?, simulation.signal(SPEED)?);
    simulation.add_controller("mine", controller, &[measures], &[acts_on])
}

fn seconds(s: f64) -> Time {
    Time::from_s(s).unwrap()
}

fn bits(simulation: &Simulation) -> Vec<u64> {
    let state = simulation.network_state();
    state.m_flow_kg_s.iter().chain(&state.p_pa).map(|value| value.to_bits()).collect()
}

#[test]
fn an_added_controller_runs_as_one_of_the_model() {
    for automatic in [false, true] {
        let (mut theirs, mut mine) = (simulation(true), simulation(false));
        let (controller, calls) = pi(0.7);
        add(&mut mine, controller).unwrap();
        let plan = mine.plan().clone();
        let step: Step = if automatic {
            plan.step_of(Some(StepEntry::Automatic))
        } else {
            Step::Fixed(seconds(1.0))
        };
        for minute in 1..=5 {
            for simulation in [&mut theirs, &mut mine] {
                simulation.advance_to(seconds(60.0 * f64::from(minute)), step).unwrap();
            }
            assert_eq!(bits(&theirs), bits(&mine), "automatic: {automatic}, minute {minute}");
        }
        // Steps end at its updates: it is called exactly there. 300 s / 0.7 s = 428.57.
        let calls = calls.lock().unwrap();
        assert_eq!(calls.len(), 429);
        for (k, time_s) in calls.iter().enumerate() {
            assert_eq!(*time_s, Time(700_000_000 * k as i64).as_s());
        }
    }
}

#[test]
fn it_has_its_signal_until_it_is_set_by_hand() {
    struct Constant(f64);
    impl UserController for Constant {
        fn timing(&self) -> Timing {
            Timing { interval_s: 10.0, offset_s: 5.0 }
        }
        fn update(&mut self, _: f64, _: &[f64], outputs: &mut [f64]) -> Result<(), ControlError> {
            assert!(outputs[0] <= 1.0, "given as it is now: {}", outputs[0]);
            outputs[0] = self.0;
            Ok(())
        }
    }
    // The model's schedule drives this signal: 1 until 2230 s.
    let mut simulation = simulation(false);
    let speed = simulation.signal(OTHER).unwrap();
    let shown = simulation.channel(&format!("{OTHER}_command")).unwrap();
    simulation.add_controller("fixed", Box::new(Constant(0.8)), &[], &[speed]).unwrap();
    let at = |simulation: &mut Simulation, time_s: f64, expected: f64| {
        simulation.advance_to(seconds(time_s), seconds(1.0)).unwrap();
        assert_eq!(simulation.get(shown), expected, "at {time_s} s");
    };
    at(&mut simulation, 5.0, 1.0);
    at(&mut simulation, 6.0, 0.8);
    simulation.set(speed, 0.9).unwrap();
    at(&mut simulation, 40.0, 0.9);
    simulation.release(speed);
    at(&mut simulation, 45.0, 0.9);
    at(&mut simulation, 46.0, 0.8);
    at(&mut simulation, 2300.0, 0.8);
    simulation.reset().unwrap();
    at(&mut simulation, 5.0, 1.0);
    at(&mut simulation, 6.0, 0.8);
}

#[test]
fn a_snapshot_has_its_ticks() {
    let mut one = simulation(false);
    add(&mut one, pi(0.7).0).unwrap();
    one.advance_to(seconds(10.0), seconds(1.0)).unwrap();
    let snapshot = one.snapshot();
    let mut other = simulation(false);
    let refused = other.restore(&snapshot).unwrap_err().to_string();
    assert_eq!(
        refused,
        "this snapshot does not fit the model: it has 1 controllers of the user, the simulation 0"
    );
    let (controller, calls) = pi(0.7);
    add(&mut other, controller).unwrap();
    other.restore(&snapshot).unwrap();
    other.advance_to(seconds(12.0), seconds(1.0)).unwrap();
    // 15 x 0.7 s is the first after 10 s.
    assert_eq!(*calls.lock().unwrap(), [10.5, 11.2, 11.9]);
}

#[test]
fn wrong_controllers_are_refused() {
    let mut simulation = simulation(false);
    let says = |simulation: &mut Simulation, interval_s: f64| {
        add(simulation, pi(interval_s).0).unwrap_err().to_string()
    };
    let expected = "at 0s: controller \"mine\": interval_s = 0 must be positive";
    assert_eq!(says(&mut simulation, 0.0), expected);
    assert!(says(&mut simulation, f64::NAN).contains("interval_s = NaN must be positive"));
    let nothing = simulation.add_controller("idle", pi(1.0).0, &[], &[]).unwrap_err().to_string();
    assert!(nothing.contains("acts on no signal"), "{nothing}");
    add(&mut simulation, pi(1.0).0).unwrap();
    let twice = says(&mut simulation, 1.0);
    assert!(twice.contains(&format!("\"{SPEED}\" is driven by controller \"mine\"")), "{twice}");
}

#[test]
fn wrong_outputs_stop_the_run_and_the_controller_stays_due() {
    /// Gives what it is told, once at 3 s.
    struct Wrong(f64, bool);
    impl UserController for Wrong {
        fn timing(&self) -> Timing {
            Timing { interval_s: 3.0, offset_s: 3.0 }
        }
        fn update(&mut self, time_s: f64, _: &[f64], out: &mut [f64]) -> Result<(), ControlError> {
            assert_eq!(time_s, 3.0);
            out[0] = if std::mem::replace(&mut self.1, false) { self.0 } else { 0.5 };
            Ok(())
        }
    }
    for value in [1.5, -0.1, f64::NAN, f64::INFINITY] {
        let mut simulation = simulation(false);
        add(&mut simulation, Box::new(Wrong(value, true))).unwrap();
        let error = simulation.advance_to(seconds(5.0), seconds(1.0)).unwrap_err();
        let found = matches!(&error, RunError::UserOutput { controller, signal, max, .. }
            if controller == "mine" && signal == SPEED && *max == 1.0);
        assert!(found, "{error}");
        assert_eq!(simulation.time(), seconds(3.0));
        simulation.advance_to(seconds(5.0), seconds(1.0)).unwrap();
        let speed = simulation.channel(&format!("{SPEED}_command")).unwrap();
        assert_eq!(simulation.get(speed), 0.5);
    }
}
