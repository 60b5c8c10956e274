//! Whole houses of the laboratory: generators, storages, hot water and electricity in circuits, through winter days.

#![allow(clippy::unwrap_used)]

use allocation_counter::measure;
use anergy_core::clock::Time;
use anergy_core::error::RecordError;
use anergy_core::recorder::{Channel, Event, Recorder, RunHeader};
use anergy_simulation::balance::{Balances, summary};
use anergy_simulation::run::{RunOptions, run};
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::{advance, get, simulation};

/// Water that goes round beside the house, and a cold sunny day in February.
const AROUND: &str = r#"format = 1
[run]
until = "24h"
step = "60s"
initial_degc = 45
start = "2023-02-14T23:00:00Z"
[weather]
kind = "synthetic"
seed = 5
latitude_deg = 48.1
longitude_deg = 11.6
[[site]]
id = "h"
[[edge]]
id = "pump"
kind = "pump"
from = "h.cold"
to = "h.hot"
head_max_bar = 0.4
free_flow_l_min = 55
[[edge]]
id = "pipe"
kind = "pipe"
from = "h.hot"
to = "h.cold"
length_m = 100
inner_diameter_mm = 22
[pressure_reference]
node = "h.cold"
"#;

/// Boiler and solar collector, storage, radiators behind a mixing station, fresh-water station, roof with battery.
const HOUSE: &str = r#"
[[unit]]
site = "h"
name = "boiler"
kind = "condensing_boiler"
flow_control = "constant_supply"
supply_set_degc = 65
[[unit]]
site = "h"
name = "storage"
kind = "storage"
volume_l = 785
height_m = 1.755
ua_w_k = 7
initial_bottom_degc = 30
initial_top_degc = 60
ports = { boiler = { inlet_m = 1.6, outlet_m = 0.26 }, heating = { inlet_m = 0.3, outlet_m = 1.1 }, tap = { inlet_m = 0.05, outlet_m = 1.7 } }
coils = { solar = { area_m2 = 2.5, volume_l = 16.5, inlet_layer = 5, outlet_layer = 1 } }
rod = { power_kw = 6, layer = 7 }
[[unit]]
site = "h"
name = "mixer"
kind = "mixing_station"
[[unit]]
site = "h"
name = "building"
kind = "building"
heating = true
cooling = false
emitter = "radiator"
heating_w_m2 = 40
[[unit]]
site = "h"
name = "water"
kind = "domestic_hot_water"
daily_l = 300
circulation_loss_w = 150
[[unit]]
site = "h"
name = "collector"
kind = "solar_collector"
[[unit]]
site = "h"
name = "roof"
kind = "pv"
[[unit]]
site = "h"
name = "battery"
kind = "battery"
[[unit]]
site = "h"
name = "household"
kind = "household"
[[unit]]
site = "h"
name = "car"
kind = "electric_vehicle"
[[unit]]
site = "h"
name = "grid"
kind = "grid_connection"
power_factor = { roof = -0.8, household = 0.8 }

[[circuit]]
site = "h"
id = "charging"
through = ["boiler", "storage.boiler"]
[[circuit]]
site = "h"
id = "mixing"
through = ["mixer.storage", "storage.heating"]
[[circuit]]
site = "h"
id = "heating"
through = ["mixer.heating", "building"]
[[circuit]]
site = "h"
id = "tapping"
through = ["water", "storage.tap"]
[[circuit]]
site = "h"
id = "solar"
through = ["collector", "storage.solar"]

[[controller]]
id = "h.boiler_control"
kind = "two_sensors"
measures_on = "h.storage.t_8_k"
measures_off = "h.storage.t_3_k"
acts_on = "h.boiler.modulation"
on_below_degc = 60
off_above_degc = 55
on_output = 0.8
"#;

const UNITS: [&str; 9] = [
    "boiler",
    "storage",
    "mixer",
    "building",
    "water",
    "collector",
    "roof",
    "battery",
    "household",
];

#[test]
fn a_winter_day_closes_and_is_comfortable() {
    let mut simulation = simulation(&(AROUND.to_owned() + HOUSE));
    let (mut grid_j, mut sum_j, mut coldest_k, mut fewest_w) = (0.0, 0.0, f64::MAX, f64::MAX);
    for _ in 0..24 * 60 {
        advance(&mut simulation, 60.0, 60.0);
        // What the connection sees is what the units and pumps of the same step draw.
        let electric =
            ["boiler", "mixer", "water", "collector", "roof", "battery", "household", "car"]
                .map(|unit| get(&simulation, &format!("h.{unit}.electric_w")));
        sum_j += 60.0 * (electric.iter().sum::<f64>() + get(&simulation, "h.storage.rod_w"));
        grid_j += 60.0 * get(&simulation, "h.grid.grid_w");
        // The people of the building are those of the household.
        let people_w = 6.0 * 110.0 * get(&simulation, "h.household.presence");
        assert!((get(&simulation, "h.building.internal_w") - people_w).abs() < 1e-9);
        fewest_w = people_w.min(fewest_w);
        coldest_k = get(&simulation, "h.building.t_room_k").min(coldest_k);
    }
    assert!((grid_j - sum_j).abs() < 1e-6 * sum_j.abs(), "{grid_j} {sum_j}");
    let balances = Balances::of(&simulation);
    assert!(balances.units_error() < 1e-9, "{balances:?}");
    assert!(balances.heat_error() < 1e-6);
    // Heat of the boiler within its efficiency; one or a few starts.
    let (heat, fuel) = (get(&simulation, "h.boiler.heat_j"), get(&simulation, "h.boiler.fuel_j"));
    assert!((0.85..1.06).contains(&(heat / fuel)), "{heat} {fuel}");
    assert!(heat > 30.0 * 3.6e6, "{}", heat / 3.6e6);
    assert!(get(&simulation, "h.boiler.starts") < 20.0);
    // Warm rooms and warm water.
    assert!(coldest_k > 292.15, "{coldest_k}");
    assert_eq!(get(&simulation, "h.water.dc_water_k_m3"), 0.0);
    let drawn_m3 = get(&simulation, "h.water.drawn_m3");
    assert!((0.1..0.7).contains(&drawn_m3), "{drawn_m3}");
    assert!(get(&simulation, "h.collector.heat_j") > 0.0);
    assert!(fewest_w < 400.0, "some leave the house: {fewest_w}");
    // The battery takes the sun: nothing is drawn while it can give, nothing fed in while it can take.
    assert!(get(&simulation, "h.grid.self_consumption") > 0.3);
    assert!(get(&simulation, "h.battery.full_cycles") > 0.1);
    let kpis = summary(&simulation, false)["kpis"].clone();
    let of = |unit: &str, name: &str| kpis["units"][format!("h.{unit}")][name].as_f64();
    assert!((of("boiler", "fuel_kwh").unwrap() - fuel / 3.6e6).abs() < 1e-9);
    assert!(of("boiler", "seasonal_cop").is_none() && of("grid", "imported_kwh").is_some());
    for unit in UNITS {
        assert!(kpis["units"].get(format!("h.{unit}")).is_some(), "{unit}");
    }
}

#[test]
fn the_building_of_two_households_sees_the_mean_of_their_presence() {
    let second = "[[unit]]\nsite = \"h\"\nname = \"flat\"\nkind = \"household\"\nseed = 77\n";
    let mut simulation = simulation(&(AROUND.to_owned() + HOUSE + second));
    let mut apart = 0.0_f64;
    for _ in 0..24 {
        advance(&mut simulation, 3600.0, 3600.0);
        let at = |unit: &str| get(&simulation, &format!("h.{unit}.presence"));
        let mean_w = 6.0 * 110.0 * 0.5 * (at("household") + at("flat"));
        assert!((get(&simulation, "h.building.internal_w") - mean_w).abs() < 1e-9);
        apart = apart.max((at("household") - at("flat")).abs());
    }
    assert!(apart > 0.01, "the two are not the same");
}

#[test]
fn steps_of_a_minute_and_of_a_quarter_of_an_hour_agree() {
    // Without circulation, which takes nothing from water that has become too cold: the taps count as discomfort what
    // they lack, the circulation does not.
    let house = HOUSE.replace("circulation_loss_w = 150", "circulation_loss_w = 0");
    let energies = |step_s: f64| {
        let mut simulation = simulation(&(AROUND.to_owned() + &house));
        advance(&mut simulation, 86_400.0, step_s);
        assert!(Balances::of(&simulation).units_error() < 1e-9);
        let of = |name: &str| get(&simulation, &format!("h.{name}"));
        // What the taps did not get is counted as discomfort: 4.18 MJ/(m3 K).
        let water_j = of("water.taken_j") + 4.18e6 * of("water.dc_water_k_m3");
        [water_j, of("boiler.heat_j"), of("household.used_j"), of("roof.generated_j")]
    };
    let (fine, coarse) = (energies(60.0), energies(900.0));
    // Steps across midnight draw the same water.
    let drawn_m3 = |step_s: f64| {
        let mut simulation = simulation(&(AROUND.to_owned() + HOUSE));
        advance(&mut simulation, 120.0, 120.0);
        advance(&mut simulation, 1.5 * 86_400.0, step_s);
        get(&simulation, "h.water.drawn_m3")
    };
    assert!((drawn_m3(60.0) - drawn_m3(600.0)).abs() < 1e-12);
    for (i, tolerance) in [0.002, 0.15, 1e-9, 0.02].into_iter().enumerate() {
        let apart = (fine[i] - coarse[i]).abs();
        assert!(apart <= tolerance * fine[i], "{i}: {} {}", fine[i], coarse[i]);
    }
}

#[test]
fn a_house_goes_on_from_a_snapshot_and_allocates_nothing() {
    let mut simulation = simulation(&(AROUND.to_owned() + HOUSE));
    advance(&mut simulation, 6.0 * 3600.0, 60.0);
    let here = simulation.snapshot();
    let bits = |simulation: &mut Simulation| {
        advance(simulation, 4.0 * 3600.0, 60.0);
        ["h.storage.t_8_k", "h.boiler.fuel_j", "h.water.drawn_m3", "h.grid.import_j"]
            .map(|channel| get(simulation, channel).to_bits())
    };
    let first = bits(&mut simulation);
    simulation.restore(&here).unwrap();
    assert_eq!(first, bits(&mut simulation));
    simulation.take_events();
    // Over a midnight: the draws and the weights of the next day are made in place.
    let found = measure(|| advance(&mut simulation, 15.0 * 3600.0, 60.0));
    assert_eq!(simulation.take_events().count(), 0, "the window has events");
    assert_eq!((found.count_total, found.bytes_total), (0, 0));
}

#[test]
fn the_phases_of_the_connection_are_those_of_its_units() {
    let house = (AROUND.to_owned() + HOUSE)
        .replace("kind = \"pv\"", "kind = \"pv\"\nphase = 2")
        .replace("kind = \"household\"", "kind = \"household\"\nphases = \"random\"");
    let mut simulation = simulation(&house);
    let mut largest_w = 0.0_f64;
    for _ in 0..24 * 60 {
        advance(&mut simulation, 60.0, 60.0);
        let of = |name: &str| get(&simulation, &format!("h.{name}"));
        let phases = [1, 2, 3].map(|phase| of(&format!("grid.phase_{phase}_w")));
        let grid_w = of("grid.grid_w");
        // Battery, car and pumps are of three phases.
        let rest_w = (grid_w - of("household.electric_w") - of("roof.electric_w")) / 3.0;
        for (i, phase_w) in phases.iter().enumerate() {
            let roof_w = if i == 1 { of("roof.electric_w") } else { 0.0 };
            let own_w = of(&format!("household.phase_{}_w", i + 1)) + roof_w + rest_w;
            assert!(
                (phase_w - own_w).abs() < 1e-9 * (1.0 + grid_w.abs()),
                "{phases:?} {i} {own_w}"
            );
        }
        assert!((phases.iter().sum::<f64>() - grid_w).abs() < 1e-9 * (1.0 + grid_w.abs()));
        let spread_w = phases.iter().fold(f64::MIN, |m, w| m.max(*w))
            - phases.iter().fold(f64::MAX, |m, w| m.min(*w));
        assert!((of("grid.asymmetry_w") - spread_w).abs() < 1e-9);
        // cos phi = 0.8: 0.75 var per W, given where it leads.
        let reactive_var = 0.75 * (of("household.electric_w") - of("roof.electric_w"));
        assert!((of("grid.reactive_var") - reactive_var).abs() < 1e-9 * (1.0 + reactive_var.abs()));
        largest_w = largest_w.max(spread_w);
    }
    // The roof of 10 kW stands on one phase.
    assert!((get(&simulation, "h.grid.largest_asymmetry_w") - largest_w).abs() < 1e-9);
    let too_far = simulation.take_events().filter(|event| event.kind == "asymmetric").count();
    assert!((largest_w > 4600.0) == (too_far > 0), "{largest_w} W, {too_far} events");
}

#[test]
fn the_rod_takes_the_surplus_of_the_roof() {
    let house = (AROUND.to_owned() + HOUSE)
        .replace("[[unit]]\nsite = \"h\"\nname = \"battery\"\nkind = \"battery\"\n", "");
    let control = r#"
[[controller]]
id = "h.surplus"
kind = "pi"
measures = "h.grid.grid_w"
acts_on = "h.storage.rod"
set_point = 0
gain = 5e-5
integral_time_s = 60
"#;
    let run = |text: &str| {
        let mut simulation = simulation(text);
        advance(&mut simulation, 86_400.0, 60.0);
        assert!(Balances::of(&simulation).units_error() < 1e-9);
        ["grid.export_j", "grid.import_j", "storage.rod_j", "boiler.fuel_j"]
            .map(|name| get(&simulation, &format!("h.{name}")))
    };
    let (without, with) = (run(&house), run(&(house.clone() + control)));
    assert!(with[0] < 0.3 * without[0], "most of the surplus: {with:?} {without:?}");
    // What is not fed in is in the rod, but for what it takes too long after a cloud.
    let (kept_j, more_j) = (without[0] - with[0], with[1] - without[1]);
    assert!((with[2] - kept_j - more_j).abs() < 1e-3 * with[2], "{with:?} {without:?}");
    assert!(more_j < 0.2 * kept_j, "{with:?} {without:?}");
    assert!(with[3] < without[3], "and saves gas");
}

#[test]
fn houses_of_one_type_do_not_draw_at_the_same_time() {
    let water = |site: &str| {
        let source = "[[unit]]\nsite = \"SITE\"\nname = \"source\"\nkind = \"heat_source\"\nsupply_degc = 60\n\
                      [[unit]]\nsite = \"SITE\"\nname = \"water\"\nkind = \"domestic_hot_water\"\ndaily_l = 300\n\
                      [[circuit]]\nsite = \"SITE\"\nid = \"tap\"\nthrough = [\"water\", \"source\"]\n";
        source.replace("SITE", site)
    };
    let street = "[[site]]\nid = \"h2\"\n[[edge]]\nid = \"on\"\nkind = \"pipe\"\nfrom = \"h.hot\"\nto = \"h2.hot\"\n\
                  length_m = 10\ninner_diameter_mm = 22\n[[edge]]\nid = \"back\"\nkind = \"pipe\"\nfrom = \"h2.hot\"\n\
                  to = \"h2.cold\"\nlength_m = 10\ninner_diameter_mm = 22\n[[edge]]\nid = \"home\"\nkind = \"pipe\"\n\
                  from = \"h2.cold\"\nto = \"h.cold\"\nlength_m = 10\ninner_diameter_mm = 22\n";
    let mut simulation = simulation(&(AROUND.to_owned() + street + &water("h") + &water("h2")));
    let (mut apart_m3, mut sum_m3) = (0.0, 0.0);
    for _ in 0..24 * 60 {
        advance(&mut simulation, 60.0, 60.0);
        let tap = |site: &str| 60.0 * get(&simulation, &format!("{site}.water.tap_m3_s"));
        apart_m3 += (tap("h") - tap("h2")).abs();
        sum_m3 += tap("h") + tap("h2");
    }
    assert!(apart_m3 > 0.7 * sum_m3, "{apart_m3} of {sum_m3} m3");
}

/// The events of a run.
struct Events<'a>(&'a mut Vec<Event>);

impl Recorder for Events<'_> {
    fn start(&mut self, _header: &RunHeader, _channels: &[Channel]) -> Result<(), RecordError> {
        Ok(())
    }

    fn row(&mut self, _time: Time, _values: &[f64]) -> Result<(), RecordError> {
        Ok(())
    }

    fn event(&mut self, event: &Event) -> Result<(), RecordError> {
        self.0.push(event.clone());
        Ok(())
    }

    fn finish(self: Box<Self>, _summary: &serde_json::Value) -> Result<(), RecordError> {
        Ok(())
    }
}

#[test]
fn what_is_wrong_is_an_event() {
    // Without heat the water gets cold; the event comes with the first draw of each cold time, not with every draw.
    let text = (AROUND.to_owned() + HOUSE)
        .replace(
            "kind = \"condensing_boiler\"",
            "kind = \"condensing_boiler\"\nenable = 0\nnominal_kw = 50",
        )
        .replace("initial_top_degc = 60", "initial_top_degc = 35");
    let mut simulation = simulation(&text);
    advance(&mut simulation, 86_400.0, 60.0);
    let events: Vec<(String, String)> =
        simulation.take_events().map(|event| (event.kind, event.component)).collect();
    let cold = events.iter().filter(|(kind, _)| kind == "too_cold");
    assert_eq!(cold.clone().count(), 1, "{events:?}");
    assert!(cold.map(|(_, component)| component).all(|component| component == "h.water"));
    assert!(get(&simulation, "h.water.dc_water_k_m3") > 0.0);
    // A size far from the data is said at the start of a run.
    let mut recording = Vec::new();
    let recorder = Events(&mut recording);
    let options = RunOptions { until: Some(Time::from_s(60.0).unwrap()), ..RunOptions::default() };
    simulation.reset().unwrap();
    run(&mut simulation, options, Box::new(recorder), &mut |_, _| true).unwrap();
    let remark = recording.iter().find(|event| event.kind == "remark").unwrap();
    assert!(remark.message.starts_with("h.boiler: its size is 3.571 times"), "{}", remark.message);
}

#[test]
fn the_house_of_the_laboratory_heats_for_itself() {
    let folder = anergy_tests::workspace().join("examples/laboratory-sf1");
    let text = std::fs::read_to_string(folder.join("model.toml")).unwrap();
    let mut simulation = simulation(&text);
    advance(&mut simulation, 2.0 * 86_400.0, 60.0);
    assert!(Balances::of(&simulation).units_error() < 1e-9);
    let of = |name: &str| get(&simulation, &format!("sf1.{name}"));
    // The engine hardly ever stops, the boiler helps.
    assert!(
        (1.0..=3.0).contains(&of("chp.starts")) && of("chp.operating_s") > 0.8 * 2.0 * 86_400.0
    );
    assert!(of("chp.heat_j") > of("boiler.heat_j") && of("boiler.starts") > 1.0);
    let efficiency = (of("chp.heat_j") + of("chp.generated_j")) / of("chp.fuel_j");
    assert!((0.75..0.95).contains(&efficiency), "{efficiency}");
    // Warm rooms and warm water, from a tank that is charged by its own rule and the sun.
    assert_eq!((of("building.dc_heat_k_s"), of("water.dc_water_k_m3")), (0.0, 0.0));
    assert!(of("tank.t_10_k") > 320.0 && of("collector.heat_j") > 0.0);
    // More electricity than the house needs.
    assert!(of("grid.export_j") > of("grid.import_j"));
    // Half hours: everything that changes within a step stays within the water, and the same heat arrives.
    let mut coarse = self::simulation(&text);
    advance(&mut coarse, 2.0 * 86_400.0, 1800.0);
    assert!(Balances::of(&coarse).units_error() < 1e-9);
    for name in ["sf1.building.heat_j", "sf1.water.taken_j"] {
        let (coarse, fine) = (get(&coarse, name), get(&simulation, name));
        assert!((coarse - fine).abs() < 0.02 * fine, "{name}: {coarse} {fine}");
    }
    let kpis = summary(&simulation, false)["kpis"].clone();
    let exported_kwh = kpis["units"]["sf1.grid"]["exported_kwh"].as_f64().unwrap();
    assert!((exported_kwh * 3.6e6 - of("grid.export_j")).abs() < 1.0);
}
