//! Indicators of a run against numbers calculated on paper, and against the channels that say the same.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_simulation::balance::{Balances, summary};
use anergy_simulation::simulation::Simulation;
use anergy_tests::running::simulation;
use anergy_tests::workspace;
use serde_json::Value;

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    let [until, step] = [until_s, step_s].map(|s| Time::from_s(s).unwrap());
    simulation.advance_to(until, step).unwrap();
}

fn channel(simulation: &Simulation, name: &str) -> f64 {
    simulation.get(simulation.channel(name).unwrap())
}

fn kpis(simulation: &Simulation) -> Value {
    summary(simulation, false)["kpis"].clone()
}

#[track_caller]
fn number(kpis: &Value, place: &[&str]) -> f64 {
    let found = place.iter().fold(kpis, |value, name| &value[*name]);
    found.as_f64().unwrap_or_else(|| panic!("no {place:?} in {kpis:#}"))
}

#[track_caller]
fn assert_is(kpis: &Value, place: &[&str], expected: f64, within: f64) {
    let found = number(kpis, place);
    assert!((found - expected).abs() <= within, "{place:?}: {found}, not {expected}");
}

/// A plant of 40 degC and a house; all water begins with 40 degC and no pipe loses heat. The house takes 1 kW for an
/// hour at its smallest flow of 6 l/min, then 3 kW at a difference of 5 K.
const STREET: &str = r#"
format = 1
[run]
initial_degc = 40
[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4180
[pipe_type.street]
inner_diameter_mm = 20
roughness_mm = 0.01
[[site]]
id = "plant"
[[site]]
id = "house"
[[trench]]
from = "plant"
to = "house"
length_m = 10
pipe = "street"
[[station]]
site = "plant"
kind = "plant"
supply_degc = 40
return_pressure_bar = 1.5
circulation_pump = { head_max_hpa = 402.21, free_flow_l_min = 55.33, efficiency_hydraulic = 0.5, efficiency_motor = 0.8 }
[[station]]
site = "house"
kind = "prescribed_flow"
[[unit]]
site = "house"
name = "load"
kind = "heat_load"
temperature_difference_k = 5
v_flow_min_l_min = 6
supply_needed_degc = 42
[[schedule]]
signal = "house.load.load_w"
points = [[0, 1000], [3600, 3000]]
"#;

#[test]
fn a_street_by_hand() {
    for step_s in [10.0, 60.0, 450.0] {
        let mut run = simulation(STREET);
        advance(&mut run, 3600.0, step_s);
        let hot_over_cold =
            |run: &Simulation| channel(run, "house.hot.p_pa") - channel(run, "house.cold.p_pa");
        let power_w = |run: &Simulation| channel(run, "plant.circulation_pump.power_w");
        let (before_pa, before_w) = (hot_over_cold(&run), power_w(&run));
        let before_hot_pa = channel(&run, "plant.hot.p_pa");
        advance(&mut run, 7200.0, step_s);
        let (after_pa, after_w) = (hot_over_cold(&run), power_w(&run));
        let after_hot_pa = channel(&run, "plant.hot.p_pa");
        let kpis = kpis(&run);
        let house = |name: &str, expected: f64, within: f64| {
            assert_is(&kpis, &["stations", "house.station", name], expected, within);
        };
        let grid = |name: &str, expected: f64, within: f64| {
            assert_is(&kpis, &["network", name], expected, within);
        };
        // 1 kW h + 3 kW h.
        house("heat_taken_kwh", 4.0, 1e-9);
        house("heat_given_kwh", 0.0, 0.0);
        grid("heat_taken_kwh", 4.0, 1e-9);
        assert_is(&kpis, &["sites", "house", "heat_taken_kwh"], 4.0, 1e-9);
        assert_is(&kpis, &["units", "house.load", "heat_from_water_kwh"], 4.0, 1e-9);
        assert_is(&kpis, &["units", "house.load", "unmet_kwh"], 0.0, 0.0);
        // 6 l/min for an hour: 0.36 m3; then 3000/(4180 * 5) = 0.1435407 kg/s: 0.5167464 m3.
        house("water_extracted_m3", 0.876_746_4, 1e-6);
        house("extracted_h", 2.0, 1e-9);
        // 40 degC - 1000/(0.1 * 4180) K = 37.607655 degC, then 35 degC. By flow
        // (0.36 * 37.607655 + 0.5167464 * 35)/0.8767464 = 36.070734 degC, by time 36.303828 degC.
        house("return_mean_by_flow_degc", 36.070_734, 1e-4);
        house("return_mean_by_time_degc", 36.303_828, 1e-4);
        house("extracted_arriving_min_degc", 40.0, 1e-4);
        house("extracted_arriving_max_degc", 40.0, 1e-4);
        // Two flows, two pressure differences; more flow leaves less.
        assert!(after_pa < before_pa);
        house("dp_min_bar", after_pa / 1e5, 1e-9);
        house("dp_max_bar", before_pa / 1e5, 1e-9);
        // The plant takes what comes: it balances, alone. Less than 4 kWh: the cold line began warm.
        let given_kwh = 4.0 + Balances::of(&run).stored_j / 3.6e6;
        assert!(given_kwh < 3.99);
        assert_is(&kpis, &["stations", "plant.station", "heat_given_kwh"], given_kwh, 1e-9);
        assert_is(
            &kpis,
            &["stations", "plant.station", "share_of_heat_given_percent"],
            100.0,
            1e-9,
        );
        grid("balancing_heat_given_kwh", given_kwh, 1e-9);
        grid("balancing_heat_taken_kwh", 0.0, 0.0);
        grid("heat_lost_kwh", 0.0, 1e-12);
        grid("heat_lost_of_taken_percent", 0.0, 1e-12);
        // Only one demand: nothing overlaps.
        grid("demand_overlap", 0.0, 0.0);
        // An hour of each power; 4 kWh are 0.004 MWh. The flow follows the load with its actuator.
        let pump_kwh = (before_w + after_w) / 1000.0;
        grid("pump_electricity_kwh", pump_kwh, 1e-3 * pump_kwh);
        let booked_kwh = number(&kpis, &["network", "pump_electricity_kwh"]);
        grid("pump_kwh_per_mwh_taken", booked_kwh / 0.004, 1e-9);
        let station = ["stations", "plant.station", "pump_electricity_kwh"];
        assert_is(&kpis, &station, booked_kwh, 1e-12);
        // H0 = 402.21 hPa, n = 1: (H0 - a V^2) V/(0.5 * 0.8) with a = H0/55.33^2: at 6 l/min 397.48 hPa, 9.937 W.
        assert!((before_w - 9.937).abs() < 1e-3, "{before_w}");
        grid("hottest_node_degc", 40.0, 1e-4);
        // 40 degC for two hours where 42 are needed; all of the heat came.
        assert_is(&kpis, &["units", "house.load", "shortfall_k_h"], 4.0, 1e-3);
        grid("shortfall_k_h", 4.0, 1e-3);
        grid("unmet_kwh", 0.0, 0.0);
        // The return of the plant stays at its pressure; the hot line is above by what the pump gives, less with more flow.
        let node = |name: &str, number: &str, expected: f64, within: f64| {
            assert_is(&kpis, &["nodes", name, number], expected, within);
        };
        node("plant.cold", "p_min_bar", 1.5, 1e-9);
        node("plant.cold", "p_max_bar", 1.5, 1e-9);
        node("plant.hot", "p_max_bar", before_hot_pa / 1e5, 1e-9);
        node("plant.hot", "p_min_bar", after_hot_pa / 1e5, 1e-9);
        node("house.hot", "t_max_degc", 40.0, 1e-4);
        node("house.cold", "t_min_degc", 35.0, 1e-3);
        assert!(kpis["nodes"].as_object().unwrap().len() == 4, "{}", kpis["nodes"]);
        grid("coldest_node_degc", 35.0, 1e-3);
    }
}

#[test]
fn costs_and_efficiency() {
    // The plant pays for its pump 20, then 40 ct/kWh.
    let meter = r#"
[[unit]]
site = "plant"
name = "meter"
kind = "grid_connection"
fuel_price_eur_mwh = 140
[[schedule]]
signal = "plant.meter.import_price_eur_j"
unit = "ct_kwh"
points = [[0, 20], [3600, 40]]
"#;
    let mut run = simulation(&format!("{STREET}{meter}"));
    let power_w = |run: &Simulation| channel(run, "plant.circulation_pump.power_w");
    advance(&mut run, 3600.0, 60.0);
    let before_w = power_w(&run);
    advance(&mut run, 7200.0, 60.0);
    let (after_w, kpis) = (power_w(&run), kpis(&run));
    let cost_eur = before_w / 1000.0 * 0.20 + after_w / 1000.0 * 0.40;
    assert_is(&kpis, &["units", "plant.meter", "electricity_cost_eur"], cost_eur, 1e-3 * cost_eur);
    let booked_eur = number(&kpis, &["units", "plant.meter", "cost_eur"]);
    assert_is(&kpis, &["units", "plant.meter", "electricity_cost_eur"], booked_eur, 0.0);
    for of in [["sites", "plant"].as_slice(), &["network"]] {
        assert_is(&kpis, &[of, &["cost_eur"]].concat(), booked_eur, 0.0);
    }
    // Who only takes from the grid and has a load gets all of it: 4 of 4 kWh.
    assert_is(&kpis, &["sites", "house", "demand_kwh"], 4.0, 1e-9);
    assert_is(&kpis, &["sites", "house", "efficiency"], 1.0, 1e-9);
}

#[test]
fn exergy_lost_where_streams_meet() {
    let text = r#"
format = 1
[run]
initial = "steady"
[fluid]
kind = "constant_water"
density_kg_m3 = 1000
heat_capacity_j_kg_k = 4180
[ground]
kind = "constant"
temperature_degc = 10
[[node]]
id = "warm"
kind = "source"
m_flow_kg_s = 0.1
temperature_degc = 60
[[node]]
id = "cool"
kind = "source"
m_flow_kg_s = 0.1
temperature_degc = 30
[[node]]
id = "meeting"
[[node]]
id = "out"
kind = "pressure_boundary"
pressure_bar = 1.5
[[edge]]
id = "warm_pipe"
kind = "pipe"
from = "warm"
to = "meeting"
length_m = 1
inner_diameter_mm = 20
[[edge]]
id = "cool_pipe"
kind = "pipe"
from = "cool"
to = "meeting"
length_m = 1
inner_diameter_mm = 20
[[edge]]
id = "out_pipe"
kind = "pipe"
from = "meeting"
to = "out"
length_m = 1
inner_diameter_mm = 20
"#;
    // 0.1 ln(318.15^2/(333.15 * 303.15)) kg/s * 4180 J/(kg K) * 283.15 K = 263.39 W, in either direction of the last pipe.
    for text in [
        text.to_owned(),
        text.replace("from = \"meeting\"\nto = \"out\"", "from = \"out\"\nto = \"meeting\""),
    ] {
        let mut run = simulation(&text);
        advance(&mut run, 3600.0, 60.0);
        assert_is(&kpis(&run), &["network", "exergy_lost_by_mixing_kwh"], 0.263_39, 1e-5);
    }
    // Streams of one temperature lose nothing.
    let mut run = simulation(&text.replace("temperature_degc = 30", "temperature_degc = 60"));
    advance(&mut run, 3600.0, 60.0);
    assert_is(&kpis(&run), &["network", "exergy_lost_by_mixing_kwh"], 0.0, 1e-12);
}

#[test]
fn demands_overlap() {
    // The house takes 3 kW, then 1 kW; a second one gives 1 kW, then 2 kW: 1 kWh of 4 and 1 kWh of 3 coincide,
    // 2 * 2/(4 + 3) = 0.571429. Of the heat given the second house gives 3 kWh.
    let second = r#"
[[site]]
id = "shop"
[[trench]]
from = "house"
to = "shop"
length_m = 10
pipe = "street"
[[station]]
site = "shop"
kind = "prescribed_flow"
[[unit]]
site = "shop"
name = "cooling"
kind = "cooling_load"
temperature_difference_k = 10
warmest_return_degc = 90
[[schedule]]
signal = "shop.cooling.load_w"
points = [[0, 1000], [3600, 2000]]
"#;
    let text = STREET.replace("[[0, 1000], [3600, 3000]]", "[[0, 3000], [3600, 1000]]");
    let mut run = simulation(&format!("{text}{second}"));
    advance(&mut run, 7200.0, 60.0);
    let kpis = kpis(&run);
    assert_is(&kpis, &["network", "demand_overlap"], 4.0 / 7.0, 1e-9);
    assert_is(&kpis, &["stations", "house.station", "heat_taken_kwh"], 4.0, 1e-9);
    // The plant cools what comes back warmer than 40 degC, which is no demand.
    let cooled_kwh = number(&kpis, &["network", "balancing_heat_taken_kwh"]);
    assert!(cooled_kwh > 0.0);
    assert_is(&kpis, &["network", "heat_taken_kwh"], 4.0 + cooled_kwh, 1e-9);
    let shop = |name: &str, expected: f64| {
        assert_is(&kpis, &["stations", "shop.station", name], expected, 1e-6);
    };
    shop("heat_given_kwh", 3.0);
    let given_kwh = number(&kpis, &["network", "heat_given_kwh"]);
    shop("share_of_heat_given_percent", 300.0 / given_kwh);
    // 3 kWh over 10 K: 3 * 3.6e6/(4180 * 10) = 258.3732 kg.
    shop("water_fed_in_m3", 0.258_373_206);
}

#[test]
fn a_blocked_feeder_delivers_less_than_it_is_asked_for() {
    let text =
        std::fs::read_to_string(workspace().join("examples/three-houses/model.toml")).unwrap();
    let mut run = simulation(&text);
    advance(&mut run, 3600.0, 1.0);
    let told = summary(&run, false);
    let kpis = &told["kpis"];
    let feeder = |name: &str| number(kpis, &["stations", "sf1.station", name]);
    // 3.5 l/min for an hour.
    assert!((feeder("water_requested_m3") - 0.21).abs() < 1e-9);
    assert!((feeder("water_delivered_m3") - feeder("water_fed_in_m3")).abs() < 1e-12);
    assert!(feeder("water_delivered_m3") < 0.5 * 0.21);
    // The flag goes up and down once.
    let span = &told["blocked"][0];
    let blocked_h = (span["to_s"].as_f64().unwrap() - span["from_s"].as_f64().unwrap()) / 3600.0;
    assert!((feeder("blocked_h") - blocked_h).abs() < 1e-9 && blocked_h > 0.5);
    assert_is(kpis, &["network", "blocked_h"], blocked_h, 1e-9);
    assert_is(kpis, &["network", "hunting_h"], 0.0, 0.0);
    // Lost heat over what the consumer took.
    let lost = number(kpis, &["network", "heat_lost_kwh"]);
    let taken = number(kpis, &["stations", "sf4.station", "heat_taken_kwh"]);
    assert_is(kpis, &["network", "heat_lost_of_taken_percent"], 100.0 * lost / taken, 1e-9);
    let pumps: f64 = ["sf1", "sf2"]
        .iter()
        .map(|site| number(kpis, &["sites", site, "pump_electricity_kwh"]))
        .sum();
    assert_is(kpis, &["network", "pump_electricity_kwh"], pumps, 1e-12);
}

/// A day in an ambient grid with heat pumps, buildings and a balancing unit.
fn ambient() -> Simulation {
    simulation(&std::fs::read_to_string(workspace().join("examples/5gdhc-day/model.toml")).unwrap())
}

#[test]
fn units_say_what_their_channels_say() {
    let mut run = ambient();
    advance(&mut run, 12.0 * 3600.0, 300.0);
    let kpis = kpis(&run);
    let unit = |unit: &str, name: &str| number(&kpis, &["units", unit, name]);
    for pump in ["heat.heat_pump", "bu.heat_pump"] {
        let channel = |name: &str| channel(&run, &format!("{pump}.{name}"));
        let is = |name: &str, expected: f64| {
            let found = unit(pump, name);
            assert!((found - expected).abs() <= 1e-9 * expected.abs(), "{pump}.{name}: {found}");
        };
        assert!(channel("starts") >= 1.0 && channel("electric_j") > 0.0);
        is("starts", channel("starts"));
        is("operating_h", channel("operating_s") / 3600.0);
        is("heat_kwh", channel("heat_j") / 3.6e6);
        is("electricity_kwh", channel("electric_j") / 3.6e6);
        is("seasonal_cop", (channel("heat_j") + channel("cold_j")) / channel("electric_j"));
        is("seasonal_cop", channel("cop_so_far"));
    }
    let cold_k_s = channel(&run, "heat.rooms.dc_heat_k_s");
    assert_is(&kpis, &["units", "heat.rooms", "discomfort_heating_k_h"], cold_k_s / 3600.0, 1e-12);
    // The site has one of each.
    let site = |name: &str| number(&kpis, &["sites", "heat", name]);
    assert_eq!(site("starts"), unit("heat.heat_pump", "starts"));
    assert_eq!(site("seasonal_cop"), unit("heat.heat_pump", "seasonal_cop"));
    assert_eq!(site("generated_heat_kwh"), unit("heat.heat_pump", "heat_kwh"));
    assert_eq!(site("discomfort_heating_k_h"), unit("heat.rooms", "discomfort_heating_k_h"));
    let drawn_kwh = channel(&run, "network.units_electric_j") / 3.6e6;
    assert_is(&kpis, &["network", "unit_electricity_kwh"], drawn_kwh, 1e-12);
    let pumps_kwh =
        unit("heat.heat_pump", "electricity_kwh") + unit("bu.heat_pump", "electricity_kwh");
    assert_is(&kpis, &["network", "unit_electricity_kwh"], pumps_kwh, 1e-9);
    // The storage between the lines takes what comes; what one gives and takes is the channel of its station.
    let given = number(&kpis, &["network", "balancing_heat_given_kwh"]);
    let taken = number(&kpis, &["network", "balancing_heat_taken_kwh"]);
    let net_kwh = channel(&run, "bu.station.heat_j") / 3.6e6;
    assert!(given > 0.0 && (given - taken - net_kwh).abs() < 1e-9);
}

#[test]
fn indicators_go_on_from_a_snapshot() {
    let mut whole = ambient();
    advance(&mut whole, 3600.0, 300.0);
    let bytes = whole.snapshot().to_bytes().unwrap();
    let mut rest = ambient();
    rest.restore_bytes(&bytes).unwrap();
    advance(&mut whole, 7200.0, 300.0);
    advance(&mut rest, 7200.0, 300.0);
    assert_eq!(kpis(&whole), kpis(&rest));
    whole.reset().unwrap();
    assert_is(&kpis(&whole), &["network", "heat_taken_kwh"], 0.0, 0.0);
}
