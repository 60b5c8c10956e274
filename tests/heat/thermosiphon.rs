//! Circulation by buoyancy: loops without a pump against the balance of buoyancy and friction by hand.

#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_core::medium::water::density_kg_m3;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady::{self, Steady};
use anergy_tests::workspace;

fn model(text: &str) -> Model {
    Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(text: &str) -> Simulation {
    Simulation::new(build(&model(text)).unwrap()).unwrap()
}

fn solve(text: &str) -> Steady {
    steady::solve(&model(text)).unwrap()
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    simulation.advance_to(Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap()).unwrap();
}

fn value(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap())
}

fn rho(t_degc: f64) -> f64 {
    density_kg_m3(273.15 + t_degc)
}

/// Sections of one model and the nodes a to d at 0, `high`, `high` and 0 m.
fn frame(thermosiphon: bool, high: f64) -> String {
    let option = if thermosiphon { "[model]\nthermosiphon = true\n" } else { "" };
    let mut text = format!(
        "format = 1\n{option}[run]\ninitial_degc = 20.0\n[ground]\ntemperature_degc = 20.0\n\
         [pressure_reference]\nnode = \"d\"\n"
    );
    for (id, z) in [("a", 0.0), ("b", high), ("c", high), ("d", 0.0)] {
        text += &format!("[[node]]\nid = \"{id}\"\nelevation_m = {z:?}\n");
    }
    text
}

fn pipe(id: &str, from: &str, to: &str, fields: &str) -> String {
    format!(
        "[[edge]]\nid = \"{id}\"\nkind = \"pipe\"\nfrom = \"{from}\"\nto = \"{to}\"\n{fields}\n"
    )
}

/// A riser in water of `t_degc` and a downcomer in water of 20 degC, both 10 m and as warm as that within
/// a metre, an adiabatic pipe at the top and a resistance of 2 kPa at 1 kg/s.
fn heated_leg(thermosiphon: bool, t_degc: f64) -> String {
    let leg = "length_m = 10.0\ninner_diameter_mm = 200.0\ninsulation_resistance_k_m_w = 1e-7\n";
    frame(thermosiphon, 10.0)
        + &pipe("riser", "a", "b", &format!("{leg}surroundings_degc = {t_degc:?}"))
        + &pipe("top", "b", "c", "length_m = 1.0\ninner_diameter_mm = 200.0")
        + &pipe("downcomer", "c", "d", leg)
        + "[[edge]]\nid = \"r\"\nkind = \"resistance\"\nfrom = \"d\"\nto = \"a\"\ndp_nominal_bar = 0.02\n\
           m_flow_nominal_kg_s = 1.0\n"
}

#[test]
fn a_heated_leg_rises_as_fast_as_friction_allows() {
    // rho(20) - rho(80) = 998.21 - 971.79 = 26.42 kg/m3: 9.81 * 10 * 26.42 = 2591.6 Pa against
    // 2000 m|m|: 1.1383 kg/s without the friction of the pipes (some Pa).
    let text = heated_leg(true, 80.0);
    let steady = solve(&text);
    let m = steady.edge("r").unwrap().m_flow_kg_s;
    assert!((m - 1.1383).abs() < 5e-3, "{m} kg/s");
    // To the digit: the mean of what comes with 20 degC into 80 degC, and back.
    let transfers = 10.0 / (1e-7 * m * 4180.0);
    let mean = |inlet: f64, around: f64| around + (inlet - around) / transfers;
    let buoyancy_pa = 98.1 * (rho(mean(80.0, 20.0)) - rho(mean(20.0, 80.0)));
    let pipes_pa: f64 =
        ["riser", "top", "downcomer"].iter().map(|id| steady.edge(id).unwrap().dp_pa).sum::<f64>()
            + buoyancy_pa;
    assert!((2000.0 * m * m + pipes_pa - buoyancy_pa).abs() < 0.02, "{pipes_pa} Pa in the pipes");
    assert!((0.0..20.0).contains(&pipes_pa), "{pipes_pa}");
    // A run that starts at rest gets there.
    let mut simulation = simulation(&text);
    assert!(value(&simulation, "r.m_flow_kg_s").abs() < 1e-9);
    advance(&mut simulation, 7200.0, 1.0);
    assert!((value(&simulation, "r.m_flow_kg_s") / m - 1.0).abs() < 2e-4);
    let balances = Balances::of(&simulation);
    assert!(balances.heat_error() < 1e-9 && balances.hydraulic_error() < 1e-6, "{balances:?}");
    // A leg that is cooled to 4 degC sinks: 98.1 (999.97 - 998.21) = 173.3 Pa, -0.294 kg/s.
    let m = solve(&heated_leg(true, 4.0)).edge("r").unwrap().m_flow_kg_s;
    assert!((m + 0.294).abs() < 5e-3, "{m} kg/s");
}

#[test]
fn without_the_option_all_water_weighs_the_same() {
    let steady = solve(&heated_leg(false, 80.0));
    assert!(steady.edge("r").unwrap().m_flow_kg_s.abs() < 1e-8);
    let (top, bottom) = (steady.node("b").unwrap().p_pa, steady.node("a").unwrap().p_pa);
    assert!((bottom - top - 98_100.0).abs() < 0.01);
    // With it, water of one temperature stands as well, and weighs what it does.
    let steady = solve(&heated_leg(true, 20.0));
    assert!(steady.edge("r").unwrap().m_flow_kg_s.abs() < 1e-8);
    let (top, bottom) = (steady.node("b").unwrap().p_pa, steady.node("a").unwrap().p_pa);
    assert!((bottom - top - 98.1 * rho(20.0)).abs() < 0.01);
}

/// A boiler (an exchanger, 1 m high) below a radiator (a pipe in the cold) at 8 m.
fn boiler(ua_w_k: f64, resistance: &str) -> String {
    frame(true, 8.0)
        + "[[node]]\nid = \"e\"\nelevation_m = 1.0\n"
        + &format!(
            "[[edge]]\nid = \"boiler\"\nkind = \"heat_exchanger\"\nfrom = \"a\"\nto = \"e\"\nua_w_k = {ua_w_k:?}\n\
             flow_exponent = 0.0\ndp_nominal_bar = 0.001\nm_flow_nominal_kg_s = 0.3\nvolume_l = 5.0\n\
             [[unit]]\nid = \"burner\"\nkind = \"prescribed_source\"\nport = \"boiler\"\nsupply_degc = 90.0\n\
             v_flow_m3_h = 10.0\n"
        )
        + &pipe("rise", "e", "b", "length_m = 7.0\ninner_diameter_mm = 32.0")
        + &pipe(
            "radiator",
            "b",
            "c",
            "length_m = 20.0\ninner_diameter_mm = 32.0\ninsulation_resistance_k_m_w = 0.05",
        )
        + &pipe("fall", "c", "d", "length_m = 8.0\ninner_diameter_mm = 32.0")
        + resistance
}

#[test]
fn a_boiler_below_a_radiator_starts_from_rest_in_the_right_sense() {
    let laminar = pipe("back", "d", "a", "length_m = 5.0\ninner_diameter_mm = 8.0");
    let turbulent = "[[edge]]\nid = \"back\"\nkind = \"resistance\"\nfrom = \"d\"\nto = \"a\"\n\
                     dp_nominal_bar = 0.01\nm_flow_nominal_kg_s = 0.3\ndelta_m = 0.01\n";
    for (ua_w_k, back) in [(2000.0, turbulent), (2000.0, &laminar), (3.0, &laminar)] {
        let text = boiler(ua_w_k, back);
        let steady = solve(&text);
        let m = steady.edge("back").unwrap().m_flow_kg_s;
        assert!(m > 1e-4, "{m} kg/s");
        // The buoyancy by the temperatures of the nodes: boiler and riser hot, downcomer cold.
        let t = |node: &str| steady.node(node).unwrap().t_k;
        let (hot, cold) = (density_kg_m3(t("e")), density_kg_m3(t("c")));
        let buoyancy_pa = 9.81 * 8.0 * (cold - hot);
        // Friction: pressure differences without the weights.
        let weights = [
            ("boiler", 9.81 * hot),
            ("rise", 9.81 * 7.0 * hot),
            ("radiator", 0.0),
            ("fall", -9.81 * 8.0 * cold),
            ("back", 0.0),
        ];
        let friction_pa: f64 =
            weights.iter().map(|(id, weight)| steady.edge(id).unwrap().dp_pa - weight).sum();
        assert!(
            (friction_pa - buoyancy_pa).abs() < 1e-3 * buoyancy_pa,
            "{friction_pa} {buoyancy_pa}"
        );
        // The losses of the elements at this flow, each by its own law in a model without buoyancy.
        let forced = text.replace("thermosiphon = true", "")
            + "[[node]]\nid = \"x\"\n"
            + &format!(
                "[[edge]]\nid = \"push\"\nkind = \"flow_source\"\nfrom = \"x\"\nto = \"a\"\nm_flow_kg_s = {m:?}\n"
            );
        let forced = forced.replace("from = \"d\"\nto = \"a\"", "from = \"d\"\nto = \"x\"");
        let forced = solve(&forced);
        let by_law_pa: f64 = weights.iter().map(|(id, _)| forced.edge(id).unwrap().dp_pa).sum();
        assert!((by_law_pa - buoyancy_pa).abs() < 2e-3 * buoyancy_pa, "{by_law_pa} {buoyancy_pa}");
        // A run from the steady state stays there.
        let mut simulation = simulation(&text);
        steady::settle(&mut simulation).unwrap();
        advance(&mut simulation, 3600.0, 1.0);
        assert!((value(&simulation, "back.m_flow_kg_s") / m - 1.0).abs() < 1e-2);
    }
}
