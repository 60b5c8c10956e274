//! Ambient grids of another shape: a reservoir of one pipe, two balancing units in one grid.
#![allow(clippy::unwrap_used)]

use anergy_simulation::model::Model;
use anergy_simulation::steady::{self, Steady};
use anergy_tests::workspace;

fn example(name: &str) -> String {
    std::fs::read_to_string(workspace().join(format!("examples/{name}/model.toml"))).unwrap()
}

fn solved(text: &str) -> Steady {
    let model = Model::from_toml(text, &workspace())
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)));
    steady::solve(&model).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn the_reservoir_of_one_pipe_cools_from_house_to_house() {
    // Without loss by hand: 4 kW cool 1.5 kg/s by 4000/(1.5 * 4180) = 0.63796 K at every house.
    let insulated =
        example("single-pipe").replace("resistance_k_m_w = 2", "resistance_k_m_w = 1e9").replace(
            "kind = \"prosumer\"",
            "kind = \"prosumer\"\nstub = { insulation_resistance_k_m_w = 1e9 }",
        );
    let steady = solved(&insulated);
    let t_degc = |steady: &Steady, node: &str| steady.node(node).unwrap().t_k - 273.15;
    for house in 1..=3 {
        let by_hand = 16.0 - f64::from(house) * 4000.0 / (1.5 * 4180.0);
        let before = t_degc(&steady, &format!("h{house}.upstream"));
        let behind = t_degc(&steady, &format!("h{house}.downstream"));
        assert!((behind - by_hand).abs() < 2e-3, "{house}: {behind} {by_hand}");
        assert!((before - behind - 4000.0 / 6270.0).abs() < 2e-3, "{house}");
        // The houses draw one after the other: 4 kW by 3 K each.
        let drawn = -steady.edge(&format!("h{house}.interface")).unwrap().m_flow_kg_s;
        assert!((drawn / (4000.0 / (4180.0 * 3.0)) - 1.0).abs() < 2e-3, "{drawn}");
    }
    // With loss to ground of 10 degC the loop is colder still.
    let lossy = solved(&example("single-pipe"));
    assert!(t_degc(&lossy, "source.cold") < t_degc(&steady, "source.cold") - 0.1);
    assert!((t_degc(&lossy, "source.hot") - 16.0).abs() < 1e-6);
}

#[test]
fn the_flow_of_two_balancing_units_is_split_by_the_pipes() {
    let split = |text: &str| {
        let steady = solved(text);
        ["near", "far"].map(|unit| steady.edge(&format!("{unit}.interface")).unwrap().m_flow_kg_s)
    };
    let text = example("two-balancing-units");
    let [near, far] = split(&text);
    let drawn = 5000.0 / (4180.0 * 4.0);
    assert!(((near + far) / drawn - 1.0).abs() < 2e-3, "{near} {far}");
    // dp = L m^n with n between 1.75 (smooth) and 2 (rough): m_near/m_far = (404/204)^(1/n), 1.407 to 1.478, and a little
    // less by the passages through the units.
    let ratio = near / far;
    assert!((1.38..1.478).contains(&ratio), "{ratio}");
    // In the middle both give the same; the place of a unit is one number.
    let [near, far] = split(&text.replace("length_m = 200", "length_m = 100"));
    assert!((near / far - 1.0).abs() < 1e-6, "{near} {far}");
    // Ten times as far away, next to all comes from the near one.
    let [near, far] = split(&text.replace("length_m = 200", "length_m = 5000"));
    assert!(near > 6.0 * far && far > 0.0, "{near} {far}");
}
