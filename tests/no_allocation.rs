//! A step allocates nothing: neither when flows change, nor when they are kept, nor when the
//! temperatures of closed loops are solved together. (The message of an event is a text and does; the
//! windows measured here have no events, which is checked.)
#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use anergy_benches::two_pipe_network;
use anergy_control::controller::{ControlError, Timing};
use anergy_control::user_controller::UserController;
use anergy_core::clock::{NS_PER_S, Time};
use anergy_core::ids::SignalId;
use anergy_network::elements::ElementParams;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_tests::workspace;

const SPEEDS: [f64; 7] = [1.0, 0.997, 1.002, 0.995, 0.999, 0.993, 0.998];

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn demo() -> Model {
    model(&std::fs::read_to_string(workspace().join("examples/three-houses/model.toml")).unwrap())
}

fn simulation(model: &Model) -> Simulation {
    Simulation::new(build(model).unwrap()).unwrap()
}

/// Steps with another command for each pump before each of them.
fn steps(simulation: &mut Simulation, pumps: &[(SignalId, f64)], count: usize, step_s: i64) {
    let step = Time(step_s * NS_PER_S);
    for k in 0..count {
        for (i, &(pump, speed)) in pumps.iter().enumerate() {
            simulation.set(pump, speed * SPEEDS[(k + i) % SPEEDS.len()]).unwrap();
        }
        let end = simulation.time() + step;
        simulation.advance_to(end, step).unwrap();
    }
}

/// Nothing is allocated in `count` steps after `warm_up` steps.
#[track_caller]
fn assert_no_allocation(
    simulation: &mut Simulation,
    pumps: &[(&str, f64)],
    (warm_up, count): (usize, usize),
    step_s: i64,
) {
    let pumps: Vec<(SignalId, f64)> = pumps
        .iter()
        .map(|(pump, speed)| (simulation.signal(&format!("{pump}.speed")).unwrap(), *speed))
        .collect();
    steps(simulation, &pumps, warm_up, step_s);
    simulation.take_events();
    let found = measure(|| steps(simulation, &pumps, count, step_s));
    let events: Vec<String> = simulation.take_events().map(|event| event.message).collect();
    assert!(events.is_empty(), "the window has events: {events:?}");
    assert_eq!((found.count_total, found.bytes_total), (0, 0), "in {count} steps of {step_s} s");
}

#[test]
fn the_counter_counts() {
    assert_eq!(measure(|| drop(std::hint::black_box(vec![1_u8; 100]))).count_total, 1);
}

#[test]
fn heat_pumps_that_start_stop_and_defrost() {
    let folder = workspace().join("examples/heat-pumps");
    let text = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let model = Model::from_toml(&text, &folder).unwrap();
    // Pipes have held as many parcels as they will by then; stops, starts, a defrost and a change of mode follow.
    assert_no_allocation(&mut simulation(&model), &[], (190, 160), 60);
}

#[test]
fn demo_with_changing_pumps() {
    // SF2 at 85 %, as after its schedule, so that SF1 is not blocked.
    let pumps = [("sf1.feed_in_pump", 0.95), ("sf2.feed_in_pump", 0.85)];
    assert_no_allocation(&mut simulation(&demo()), &pumps, (100, 900), 1);
}

#[test]
fn water_with_inertia_and_changing_pumps() {
    let text =
        std::fs::read_to_string(workspace().join("examples/three-houses/model.toml")).unwrap();
    let text = text.replacen("[model]\n", "[model]\nfluid_inertia = true\n", 1);
    assert!(text.contains("fluid_inertia"));
    let pumps = [("sf1.feed_in_pump", 0.95), ("sf2.feed_in_pump", 0.85)];
    assert_no_allocation(&mut simulation(&model(&text)), &pumps, (100, 300), 1);
}

/// A controller of the user that moves its pump a little at every update.
struct Sways;

impl UserController for Sways {
    fn timing(&self) -> Timing {
        Timing { interval_s: 0.7, offset_s: 0.0 }
    }

    fn update(
        &mut self,
        _: f64,
        measured: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        outputs[0] = 0.9 + measured[0].clamp(0.0, 0.1) * 0.1;
        Ok(())
    }
}

#[test]
fn demo_with_a_controller_of_the_user() {
    let mut simulation = simulation(&demo());
    let flow = simulation.channel("sf1.feed_in_pump.m_flow_kg_s").unwrap();
    let speed = simulation.signal("sf1.feed_in_pump.speed").unwrap();
    simulation.add_controller("sways", Box::new(Sways), &[flow], &[speed]).unwrap();
    assert_no_allocation(&mut simulation, &[("sf2.feed_in_pump", 0.85)], (100, 500), 1);
}

#[test]
fn demo_with_its_schedule() {
    // From 1000 s, when SF1 has long been blocked, into the ramp of SF2 that begins at 2230 s; SF1 is
    // free again after it.
    assert_no_allocation(&mut simulation(&demo()), &[], (1000, 1232), 1);
}

#[test]
fn generated_network_with_changing_pump() {
    let mut simulation = simulation(&model(&two_pipe_network(100, 1)));
    assert_no_allocation(&mut simulation, &[("plant.feed_in_pump", 0.99)], (100, 500), 1);
}

#[test]
fn closed_loops_in_long_steps() {
    let model = model(&two_pipe_network(100, 1));
    let mut simulation = simulation(&model);
    let step_s = 600;
    assert_no_allocation(&mut simulation, &[("plant.feed_in_pump", 0.99)], (20, 300), step_s);
    // The water passes the plant, the consumer nearest to it and all pipes between within a step: their
    // temperatures depend on each other, so that they were solved as one linear system.
    let overrun = |id: &str| {
        let ElementParams::Pipe(pipe) = &model.edge(id).unwrap().params else { return true };
        let m = simulation.get(simulation.channel(&format!("{id}.m_flow_kg_s")).unwrap());
        let area_m2 = std::f64::consts::PI / 4.0 * pipe.inner_diameter_m * pipe.inner_diameter_m;
        m.abs() * step_s as f64 > area_m2 * pipe.length_m * model.medium.density_kg_m3
    };
    let site =
        model.edges.iter().find_map(|edge| edge.id.strip_prefix("plant-")?.strip_suffix(".hot"));
    let site = site.unwrap();
    for id in [
        "plant.stub_hot".to_owned(),
        "plant.stub_cold".to_owned(),
        format!("plant-{site}.hot"),
        format!("plant-{site}.cold"),
        format!("{site}.stub_hot"),
        format!("{site}.stub_cold"),
    ] {
        assert!(overrun(&id), "{id} holds more than passes in a step");
    }
}

#[test]
fn ground_that_follows_the_year_and_soil_that_stores() {
    let text = "format = 1\n[run]\nstart = \"2024-01-17T00:00:00Z\"\n[ground]\nkind = \"kusuda\"\n\
        [[node]]\nid = \"in\"\nkind = \"source\"\nm_flow_kg_s = 0.2\n[[node]]\nid = \"out\"\n\
        kind = \"pressure_boundary\"\npressure_bar = 1\n[[edge]]\nid = \"pipe\"\nkind = \"pipe\"\n\
        from = \"in\"\nto = \"out\"\nlength_m = 100\npipe = \"PE100 SDR11 63\"\ndepth_m = 1.5\n\
        soil_rings = 3\n";
    assert_no_allocation(&mut simulation(&model(text)), &[], (50, 200), 600);
}

#[test]
fn weather_that_a_plant_follows() {
    let text = std::fs::read_to_string(workspace().join("examples/weather/model.toml")).unwrap();
    let folder = workspace().join("examples/weather");
    let model = Model::from_toml(&text, &folder).unwrap();
    // Across hours, days and the boundaries of its steps.
    for (step_s, warm_up) in [(60, 100), (300, 30), (3600, 3)] {
        let mut simulation = simulation(&model);
        assert_no_allocation(&mut simulation, &[], (warm_up, 40), step_s);
    }
}

/// A pump, and between supply and return: a branch with a load and a self-acting controller over it, a valve
/// left free for the flow of that branch's neighbour, and a pulsing three-way valve.
const ACTING: &str = r#"
format = 1
[[node]]
id = "r"
[[node]]
id = "s0"
[[node]]
id = "s"
[[node]]
id = "between"
[[node]]
id = "way"
[pressure_reference]
node = "r"
pressure_bar = 2
[[edge]]
id = "pump"
kind = "pump"
from = "r"
to = "s0"
head_max_bar = 1.5
free_flow_m3_h = 10
speed = 1
initial_speed = 1
[[edge]]
id = "line"
kind = "valve"
from = "s0"
to = "s"
kvs_m3_h = 20
characteristic = "linear"
opening = 0.5
[[edge]]
id = "load"
kind = "resistance"
from = "s"
to = "between"
kv_m3_h = 1.6
[[edge]]
id = "controller"
kind = "dp_controller"
from = "between"
to = "r"
kvs_m3_h = 2.5
high_node = "s"
low_node = "between"
dp_set_bar = 0.2
[[edge]]
id = "neighbour"
kind = "resistance"
from = "s"
to = "r"
kv_m3_h = 2
[[edge]]
id = "away"
kind = "resistance"
from = "way"
to = "r"
kv_m3_h = 1
[[three_way_valve]]
id = "mixer"
a = "s"
b = "s0"
ab = "way"
kvs_m3_h = 1
pulse_period_s = 20
stroke_time_s = 0
opening = 0.3
[[prescribed]]
quantity = "neighbour.dp_pa"
value = 0.7
unit = "bar"
free = "line.opening"
"#;

#[test]
fn prescriptions_self_acting_and_pulsing_valves() {
    let mut simulation = simulation(&model(ACTING));
    assert_no_allocation(&mut simulation, &[("pump", 0.99)], (50, 200), 3);
    // They did act.
    let get = |name: &str| simulation.get(simulation.channel(name).unwrap());
    assert!((get("neighbour.dp_pa") / 7e4 - 1.0).abs() < 1e-6, "{}", get("neighbour.dp_pa"));
    assert!((2e4..2.2e4).contains(&get("load.dp_pa")), "{}", get("load.dp_pa"));
}

#[test]
fn automatic_steps() {
    let model = model(&two_pipe_network(100, 1));
    let mut simulation = simulation(&model);
    let step = Step::Automatic(simulation.plan().automatic_step());
    let pump = simulation.signal("plant.feed_in_pump.speed").unwrap();
    simulation.advance_to(Time(3600 * NS_PER_S), step).unwrap();
    simulation.take_events();
    simulation.set(pump, 0.99).unwrap();
    let done = simulation.state().clone();
    let counted = measure(|| {
        simulation.advance_to(Time(5400 * NS_PER_S), step).unwrap();
    });
    assert!(*simulation.state() != done);
    assert_eq!((counted.count_total, simulation.take_events().len()), (0, 0));
}
