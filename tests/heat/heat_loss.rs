//! Heat lost to the ground, from layers and laying in the model file to the balance of a run.
#![allow(clippy::unwrap_used)]

use anergy_core::clock::Time;
use anergy_network::buried_pipe::{PipePair, Soil, neighbour_k_m_w, soil_k_m_w};
use anergy_network::elements::pipe::PipeParams;
use anergy_network::ground::Ground;
use anergy_network::pipe_catalogue;
use anergy_simulation::balance::Balances;
use anergy_simulation::build::build;
use anergy_simulation::model::Model;
use anergy_simulation::overlay::Change;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::steady;
use anergy_tests::workspace;
use serde_json::json;
use std::f64::consts::PI;
use std::path::Path;

fn model(text: &str) -> Model {
    Model::from_toml(text, Path::new("."))
        .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
}

fn simulation(model: &Model) -> Simulation {
    let plan = build(model).unwrap_or_else(|problems| panic!("{}", problems.render(&model.text)));
    Simulation::new(plan).unwrap()
}

fn get(simulation: &Simulation, channel: &str) -> f64 {
    simulation.get(simulation.channel(channel).unwrap_or_else(|error| panic!("{error}")))
}

fn advance(simulation: &mut Simulation, until_s: f64, step_s: f64) {
    let (until, step) = (Time::from_s(until_s).unwrap(), Time::from_s(step_s).unwrap());
    simulation.advance_to(until, step).unwrap();
}

fn refused(text: &str) -> String {
    match Model::from_toml(text, Path::new(".")) {
        Err(problems) => problems.render(text),
        Ok(model) => build(&model).err().map(|p| p.render(text)).unwrap_or_default(),
    }
}

/// A pipe of 100 m from a source of a flow and a temperature to an open end.
fn pipe(head: &str, m_flow_kg_s: f64, t_degc: f64, fields: &str) -> String {
    format!(
        "format = 1\n{head}\n[[node]]\nid = \"in\"\nkind = \"source\"\nm_flow_kg_s = {m_flow_kg_s}\n\
         temperature_degc = {t_degc}\n[[node]]\nid = \"out\"\nkind = \"pressure_boundary\"\n\
         pressure_bar = 1\n[[edge]]\nid = \"pipe\"\nkind = \"pipe\"\nfrom = \"in\"\nto = \"out\"\n\
         length_m = 100\n{fields}\n"
    )
}

/// What leaves a pipe of 100 m in the steady state, degC.
fn outlet_degc(t_in: f64, around: f64, r_k_m_w: f64, m_flow_kg_s: f64) -> f64 {
    around + (t_in - around) * (-100.0 / (r_k_m_w * m_flow_kg_s * 4180.0)).exp()
}

#[test]
fn a_pipe_of_the_catalogue_loses_what_its_layers_let_through() {
    // DN25 series 2, 0.8 m deep, lambda 2: H' = 0.8 + 0.0685 * 2 = 0.937;
    // film 0.003191 + wall 0.000533 + foam 6.405379 + casing 0.022317 + soil arcosh(2 * 0.937/0.11)/(2 pi 2)
    let r = 0.003_191
        + 0.000_533
        + 6.405_379
        + 0.022_317
        + (2.0 * 0.937_f64 / 0.11).acosh() / (4.0 * PI);
    let ground = "[ground]\ntemperature_degc = 8\nconductivity_w_m_k = 2\ndepth_m = 0.8\n";
    let text = pipe(ground, 0.05, 70.0, "pipe = \"pre-insulated DN25 series 2\"");
    let steady = steady::solve(&model(&text)).unwrap();
    let t_out = steady.node("out").unwrap().t_k - 273.15;
    assert!((t_out - outlet_degc(70.0, 8.0, r, 0.05)).abs() < 1e-5, "{t_out}");
    // The depth of the pipe goes before that of the ground, and a type may build on the catalogue.
    let deeper = ground.to_owned()
        + "[pipe_type.main]\npipe = \"pre-insulated DN25 series 2\"\ndepth_m = 1.6\n";
    let text = pipe(&deeper, 0.05, 70.0, "pipe = \"main\"");
    let t_deep = steady::solve(&model(&text)).unwrap().node("out").unwrap().t_k - 273.15;
    let soil = Soil { conductivity_w_m_k: 2.0, ..Soil::default() };
    let r = r - soil_k_m_w(0.11, 0.8, &soil) + soil_k_m_w(0.11, 1.6, &soil);
    assert!((t_deep - outlet_degc(70.0, 8.0, r, 0.05)).abs() < 1e-5, "{t_deep}");
    // A resistance that is given goes before the layers of the type.
    let given = "pipe = \"pre-insulated DN25 series 2\"\ninsulation_resistance_k_m_w = 3";
    let text = pipe(ground, 0.05, 70.0, given);
    let t_given = steady::solve(&model(&text)).unwrap().node("out").unwrap().t_k - 273.15;
    assert!((t_given - outlet_degc(70.0, 8.0, 3.0, 0.05)).abs() < 1e-5, "{t_given}");
}

#[test]
fn in_the_air_the_wind_counts() {
    let fields = |wind: f64| {
        format!(
            "inner_diameter_mm = 82.5\nouter_diameter_mm = 88.9\ninsulation_thickness_mm = 40\n\
             insulation_conductivity_w_m_k = 0.04\nlaying = \"above_ground\"\nsurroundings_degc = -5\n\
             wind_m_s = {wind}"
        )
    };
    let loss = |wind: f64| {
        let mut simulation = simulation(&model(&pipe("", 2.0, 80.0, &fields(wind))));
        steady::settle(&mut simulation).unwrap();
        get(&simulation, "pipe.q_loss_w")
    };
    // ln(168.9/88.9)/(2 pi 0.04) = 2.5537, film 4.634 + 8.9 * 3^0.9/0.1689^0.1 = 33.198 W/(m2 K):
    // 1/(pi 0.1689 33.198) = 0.0568; 100 m at 85 K over 2.6113 K m/W: 3.25 kW
    let r = 1.0 / (PI * 0.0825 * 3500.0)
        + (88.9_f64 / 82.5).ln() / (2.0 * PI * 50.0)
        + (168.9_f64 / 88.9).ln() / (2.0 * PI * 0.04)
        + 1.0 / (PI * 0.1689 * (4.634_08 + 8.9 * 3_f64.powf(0.9) / 0.1689_f64.powf(0.1)));
    let expected = 2.0 * 4180.0 * (80.0 - outlet_degc(80.0, -5.0, r, 2.0));
    assert!((loss(3.0) / expected - 1.0).abs() < 1e-5, "{} {expected}", loss(3.0));
    assert!(loss(0.0) < loss(1.0) && loss(1.0) < loss(8.0));
}

#[test]
fn the_ground_follows_the_year_at_every_depth() {
    let ground = |start: &str| {
        format!(
            "[run]\nstart = \"{start}\"\ninitial_degc = 10\n[ground]\nkind = \"kusuda\"\nmean_degc = 9.5\n\
             amplitude_k = 10\ncoldest_day = 35\ndiffusivity_m2_s = 6.2e-7\n"
        )
    };
    let shallow = "pipe = \"PE100 SDR11 63\"\ndepth_m = 2";
    let at = |start: &str| {
        let simulation = simulation(&model(&pipe(&ground(start), 0.1, 10.0, shallow)));
        let of = |name: &str| get(&simulation, name) - 273.15;
        (of("ground.temperature_k_command"), of("ground.at_2000_mm.temperature_k_command"))
    };
    // 23.286 d after day 35 it is coldest 1 m deep: 9.5 - 6.69754; day 58.286 is 28 February, 06:51:29.
    let (one, _) = at("2023-02-28T06:51:29Z");
    assert!((one - (9.5 - 6.697_54)).abs() < 1e-4, "{one}");
    // 46.571 d after day 35, 2 m deep: 9.5 - 4.48571; day 81.571 is 23 March, 13:42:44.
    let (_, two) = at("2023-03-23T13:42:44Z");
    assert!((two - (9.5 - 4.485_71)).abs() < 1e-4, "{two}");
    // Half a year later it is warmest, also where the run gets there by itself.
    let text = pipe(&ground("2023-03-23T13:42:44Z"), 0.0, 10.0, shallow);
    let mut run = simulation(&model(&text));
    advance(&mut run, 182.5 * 86_400.0, 86_400.0);
    let warmest = get(&run, "ground.at_2000_mm.temperature_k_command") - 273.15;
    assert!((warmest - (9.5 + 4.485_71)).abs() < 1e-4, "{warmest}");
    // Standing water follows the ground at its depth; the balance closes.
    let water = get(&run, "pipe.t_a_k") - 273.15;
    assert!((water - warmest).abs() < 0.1, "{water} {warmest}");
    assert!(Balances::of(&run).heat_error() < 1e-9);
}

const TRENCH: &str = r#"
format = 1
[run]
initial_degc = 40
[ground]
temperature_degc = 10
depth_m = 0.8
[[site]]
id = "a"
[[site]]
id = "b"
[[trench]]
from = "a"
to = "b"
length_m = 100
PIPE
[[edge]]
id = "turn"
kind = "resistance"
from = "b.hot"
to = "b.cold"
dp_nominal_bar = 0.1
m_flow_nominal_kg_s = 0.4
[[edge]]
id = "source"
kind = "flow_source"
from = "a.cold"
to = "a.hot"
m_flow_kg_s = 0.4
[[unit]]
id = "heat"
port = "source"
kind = "prescribed_source"
supply_degc = 70
v_flow_l_min = 24
[pressure_reference]
node = "a.cold"
"#;

#[test]
fn the_lines_of_a_trench_know_each_other_where_they_say_how_far() {
    let edge = |pipe: &str, id: &str| {
        let model = model(&TRENCH.replace("PIPE", pipe));
        let spec = model.edge(id).unwrap_or_else(|| panic!("{id}")).clone();
        let params: PipeParams = serde_json::from_value(spec.params.to_value()).unwrap();
        (params, build(&model).unwrap())
    };
    let (params, plan) = edge("pipe = \"pre-insulated DN40 series 1\"", "a-b.hot");
    assert_eq!(params.companion, None);
    assert!(plan.network().couplings.is_empty());
    let spaced = "pipe = \"pre-insulated DN40 series 1\"\nspacing_mm = 250";
    let (params, plan) = edge(spaced, "a-b.hot");
    assert_eq!(params.companion.as_deref(), Some("a-b.cold"));
    let ground = Ground { depth_m: 0.8, ..Ground::default() };
    let alone = params.resistance(&ground).unwrap().unwrap().total_k_m_w();
    let m = neighbour_k_m_w([0.8, 0.8], 0.25, &ground.soil);
    let pair = PipePair::of([alone, alone], m).unwrap();
    let [coupling] = plan.network().couplings.as_slice() else { panic!("one pair") };
    assert!((coupling.conductance_w_k - 100.0 * pair.between_w_m_k).abs() < 1e-12);
    assert!(!coupling.reversed);
    let (params, plan) = edge("pipe = \"twin DN40 series 2\"", "a-b.hot");
    let pair = params.pair(&params, &ground).unwrap();
    assert_eq!(plan.network().couplings[0].conductance_w_k, 100.0 * pair.between_w_m_k);
    // Expanded to plain edges it is the same model.
    let text = TRENCH.replace("PIPE", spaced);
    let composite = model(&text);
    let plain = composite.to_plain_toml().unwrap();
    assert!(plain.contains("companion = \"a-b.cold\""));
    assert_eq!(
        build(&model(&plain)).unwrap().network().couplings,
        build(&composite).unwrap().network().couplings
    );
    // Three lines have no one beside them.
    let three = text.replace("id = \"a\"", "id = \"a\"\nlines = [\"hot\", \"cold\", \"warm\"]");
    let three = three.replace("id = \"b\"", "id = \"b\"\nlines = [\"hot\", \"cold\", \"warm\"]");
    assert!(refused(&three).contains("there is no second one"), "{}", refused(&three));
}

/// An ambient grid: bare polyethylene in warmer ground.
fn ambient(extra: &str) -> String {
    let head = format!("[run]\ninitial_degc = 4\n[ground]\ntemperature_degc = 11\n{extra}");
    pipe(&head, 0.0, 4.0, "pipe = \"PE100 SDR11 63\"")
}

#[test]
fn standing_cold_water_warms_up_to_the_ground_and_never_beyond() {
    let mut run = simulation(&model(&ambient("")));
    let mut before = get(&run, "pipe.t_a_k");
    for hour in 1..=48 {
        advance(&mut run, f64::from(hour) * 3600.0, 600.0);
        let now = get(&run, "pipe.t_a_k");
        assert!(now >= before && now <= 284.15, "{hour} h: {now}");
        // A gain is a negative loss.
        assert!(get(&run, "pipe.q_loss_w") <= 0.0);
        before = now;
    }
    assert!((before - 284.15).abs() < 1e-3, "{before}");
    // Its time constant by hand: R = 0.080969 + 0.001769 + arcosh(2 * 1.1096/0.063)/(2 pi 1.6) = 0.505964 K m/W,
    // C' = 1000 * 4180 * pi/4 * 0.0514^2 = 8673.4 J/(m K): tau = 4388 s; after 2 h 4 + 7 (1 - e^-1.6407)
    let mut run = simulation(&model(&ambient("")));
    advance(&mut run, 7200.0, 600.0);
    let r = 0.080_969 + 0.001_769 + (2.0 * 1.1096_f64 / 0.063).acosh() / (2.0 * PI * 1.6);
    let tau = r * 4.18e6 * PI / 4.0 * 0.0514 * 0.0514;
    let expected = 284.15 - 7.0 * (-7200.0 / tau).exp();
    let water = get(&run, "pipe.t_a_k");
    assert!((water - expected).abs() < 1e-4, "{water} {expected}");
}

#[test]
fn flowing_cold_water_gains_heat_and_the_neighbour_does_not_diffuse() {
    // 0.2 kg/s of 4 degC through 100 m in ground of 11 degC: it warms on its way, in the right direction.
    let text = ambient("").replace("m_flow_kg_s = 0", "m_flow_kg_s = 0.2");
    let steady = steady::solve(&model(&text)).unwrap();
    let r = 0.080_969 + 0.001_769 + (2.0 * 1.1096_f64 / 0.063).acosh() / (2.0 * PI * 1.6);
    let t_out = steady.node("out").unwrap().t_k - 273.15;
    assert!((t_out - outlet_degc(4.0, 11.0, r, 0.2)).abs() < 1e-4, "{t_out}");
    assert!(t_out > 4.0 && t_out < 11.0);
    // Two pipes in a row at standstill, one of them without heat exchange: the water of the other one
    // warms up, this one keeps its temperature to the last digit.
    let text = "format = 1\n[run]\ninitial_degc = 4\n[ground]\ntemperature_degc = 11\n\
        [[node]]\nid = \"a\"\nkind = \"pressure_boundary\"\npressure_bar = 1\n[[node]]\nid = \"b\"\n\
        [[node]]\nid = \"c\"\nkind = \"source\"\nm_flow_kg_s = 0\n\
        [[edge]]\nid = \"bare\"\nkind = \"pipe\"\nfrom = \"a\"\nto = \"b\"\nlength_m = 50\n\
        pipe = \"PE100 SDR11 63\"\n[[edge]]\nid = \"tight\"\nkind = \"pipe\"\nfrom = \"b\"\nto = \"c\"\n\
        length_m = 50\ninner_diameter_mm = 51.4\n";
    let mut run = simulation(&model(text));
    advance(&mut run, 86_400.0, 600.0);
    assert!((get(&run, "bare.t_b_k") - 284.15).abs() < 1e-6);
    assert!((get(&run, "tight.t_a_k") - 277.15).abs() < 1e-12);
}

#[test]
fn soil_stores_heat_for_days() {
    let text = ambient("").replace("m_flow_kg_s = 0", "m_flow_kg_s = 0.2");
    let with_rings = text.clone() + "soil_rings = 3\n";
    let (mut plain, mut stored) = (simulation(&model(&text)), simulation(&model(&with_rings)));
    let soil = stored.plan().network().soil.clone();
    let soil_j = |run: &Simulation| run.network_state().soil_stored_j(&soil);
    let before_j = soil_j(&stored);
    let (mut to_ground_j, mut gained_j) = (0.0, 0.0);
    let step_s = 900.0;
    for step in 1..=(5 * 96) {
        for run in [&mut plain, &mut stored] {
            advance(run, f64::from(step) * step_s, step_s);
        }
        to_ground_j += get(&stored, "pipe.q_ground_w") * step_s;
        gained_j -= get(&stored, "pipe.q_loss_w") * step_s;
        if step == 4 {
            // After an hour the cold pipe still draws on the warm soil around it.
            let (fresh, quasi) = (get(&stored, "out.t_k"), get(&plain, "out.t_k"));
            assert!(fresh > quasi + 0.2, "{fresh} {quasi}");
        }
    }
    // What the water gained came from the soil and through it from the ground.
    let from_soil_j = before_j - soil_j(&stored);
    assert!(
        (gained_j - from_soil_j + to_ground_j).abs() < 1e-9 * gained_j,
        "{gained_j} {from_soil_j}"
    );
    assert!(from_soil_j > 0.02 * gained_j && to_ground_j < 0.0);
    assert!(Balances::of(&stored).heat_error() < 1e-9);
    // In the end the soil is in balance, as `solve` says at once.
    advance(&mut stored, 60.0 * 86_400.0, 900.0);
    let outlet_k = |text: &str| steady::solve(&model(text)).unwrap().node("out").unwrap().t_k;
    let (end, solved) = (get(&stored, "out.t_k"), outlet_k(&with_rings));
    // Within what the merging of parcels may change.
    assert!((end - solved).abs() < 1e-3, "{end} {solved}");
    // That is the gain without rings where the soil is warmed alike along the pipe: within 1.2 % at 0.2 kg/s,
    // which warms by a fifth of its distance to the ground, and 0.02 % at 2 kg/s.
    for (m_flow, within) in [("0.2", 0.012), ("2", 2e-4)] {
        let with_flow =
            |text: &str| text.replace("m_flow_kg_s = 0.2", &format!("m_flow_kg_s = {m_flow}"));
        let gain = |text: &str| outlet_k(&with_flow(text)) - 277.15;
        let ratio = gain(&with_rings) / gain(&text);
        assert!((ratio - 1.0).abs() < within, "{m_flow} kg/s: {ratio}");
    }
}

#[test]
fn a_snapshot_holds_the_soil() {
    let text = ambient("").replace("m_flow_kg_s = 0", "m_flow_kg_s = 0.2") + "soil_rings = 3\n";
    let mut run = simulation(&model(&text));
    advance(&mut run, 7200.0, 300.0);
    let here = run.snapshot();
    advance(&mut run, 14_400.0, 300.0);
    let there = run.state().to_bytes().unwrap();
    run.restore(&here).unwrap();
    advance(&mut run, 14_400.0, 300.0);
    assert_eq!(run.state().to_bytes().unwrap(), there);
}

/// F-064: soil and pipe are parameters like others.
#[test]
fn soil_and_insulation_can_be_swept() {
    let ground = "[ground]\ntemperature_degc = 10\n";
    let base = model(&pipe(ground, 0.05, 70.0, "pipe = \"pre-insulated DN25 series 1\""));
    let loss = |changes: &[(&str, f64)]| {
        let changes: Vec<Change> = changes
            .iter()
            .map(|(parameter, value)| Change::Set {
                parameter: (*parameter).to_owned(),
                value: json!(value),
            })
            .collect();
        let mut run = simulation(&base.with(&changes).unwrap());
        steady::settle(&mut run).unwrap();
        get(&run, "pipe.q_loss_w")
    };
    let dry = loss(&[("ground.conductivity_w_m_k", 1.0)]);
    let wet = loss(&[("ground.conductivity_w_m_k", 2.5)]);
    assert!(dry < loss(&[]) && loss(&[]) < wet);
    assert!(loss(&[("pipe.casing_diameter_m", 0.125)]) < loss(&[]));
    assert!(loss(&[("pipe.insulation_conductivity_w_m_k", 0.024)]) < loss(&[]));
    assert!(loss(&[("ground.depth_m", 2.0)]) < loss(&[]));
    // The neutral values change nothing.
    assert_eq!(loss(&[("ground.conductivity_w_m_k", 1.6), ("ground.depth_m", 1.0)]), loss(&[]));
}

/// The page of the catalogue says what the program knows; `ANERGY_WRITE_DOCS=1` writes it.
#[test]
fn the_page_of_the_catalogue_is_that_of_the_program() {
    let mut page = String::from(
        "# Pipes of the catalogue\n\nUsed by name, as they are or as the base of a type (the letters may be \
         large or small):\n```toml\n[[trench]]\nfrom = \"a\"\nto = \"b\"\nlength_m = 100\n\
         pipe = \"pre-insulated DN25 series 2\"\n[pipe_type.main]\npipe = \"twin DN80 series 2\"\n\
         depth_m = 1.2\n```\nDiameters in mm; wall of the pipe and, after the casing, of the casing. The sources \
         are keys of `docs/references.bib`.\nNominal dimensions: what is delivered may have thicker walls. \
         Roughness 0.05 mm (steel), 0.007 mm (polyethylene).\nInsulation of 0.028 W/(m K), wall of steel or \
         of polyethylene with 0.4 W/(m K).\n\n\
         | name | inner | outer | wall | casing | casing wall | axes apart | W/(m K) | source |\n\
         |---|---|---|---|---|---|---|---|---|\n",
    );
    let mm = |m: f64| format!("{}", (m * 1e4).round() / 10.0);
    for bought in pipe_catalogue::all() {
        let casing =
            |pick: fn((f64, f64)) -> f64| bought.casing_m.map_or("-".into(), |c| mm(pick(c)));
        let params: PipeParams = serde_json::from_value(without_nulls(json!({
            "length_m": 1.0,
            "inner_diameter_m": bought.inner_diameter_m,
            "outer_diameter_m": bought.outer_diameter_m,
            "wall_conductivity_w_m_k": bought.wall_conductivity_w_m_k,
            "casing_diameter_m": bought.casing_m.map(|(diameter_m, _)| diameter_m),
            "casing_thickness_m": bought.casing_m.map(|(_, thickness_m)| thickness_m),
            "spacing_m": bought.spacing_m,
            "laying": bought.laying,
        })))
        .unwrap();
        let loss = params.resistance(&Ground::default()).unwrap().map_or("-".into(), |alone| {
            let k_m_w = if bought.spacing_m.is_some() {
                params.pair(&params, &Ground::default()).unwrap().ground_k_m_w[0]
            } else {
                alone.total_k_m_w()
            };
            format!("{:.3}", 1.0 / k_m_w)
        });
        page += &format!(
            "| {} | {} | {} | {} | {} | {} | {} | {loss} | {} |\n",
            bought.name,
            mm(bought.inner_diameter_m),
            mm(bought.outer_diameter_m),
            mm(0.5 * (bought.outer_diameter_m - bought.inner_diameter_m)),
            casing(|(diameter_m, _)| diameter_m),
            casing(|(_, thickness_m)| thickness_m),
            bought.spacing_m.map_or("-".into(), mm),
            bought.source,
        );
    }
    page += "\nW/(m K): loss per metre and kelvin above the ground at the defaults (soil 1.6 W/(m K), axis 1 m \
             deep); of a twin pipe that\nof each pipe to the ground when both are equally warm.\n";
    let file = workspace().join("docs/src/pipe-catalogue.md");
    if std::env::var_os("ANERGY_WRITE_DOCS").is_some() {
        std::fs::write(&file, &page).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(written == page, "{} differs: run this test with ANERGY_WRITE_DOCS=1", file.display());
}

fn without_nulls(mut value: serde_json::Value) -> serde_json::Value {
    if let Some(object) = value.as_object_mut() {
        object.retain(|_, value| !value.is_null());
    }
    value
}

/// The street of `examples/grids` as a grid of each generation.
mod generations {
    use super::*;

    fn grid(name: &str) -> Model {
        let dir = workspace().join("examples/grids");
        let text = std::fs::read_to_string(dir.join(format!("{name}.toml"))).unwrap();
        Model::from_toml(&text, &dir)
            .unwrap_or_else(|problems| panic!("{}", problems.render(&text)))
    }

    #[test]
    fn each_keeps_its_temperatures_and_the_insulated_ones_lose_less_and_less() {
        let mut loss_before = f64::INFINITY;
        for (name, supply, back) in [
            ("3gdh", 85.0, 45.0),
            ("4gdh", 65.0, 35.0),
            ("ultdh", 45.0, 25.0),
            ("5gdhc", 20.0, 15.0),
        ] {
            let lines = if name == "5gdhc" { ["warm", "cold"] } else { ["hot", "cold"] };
            let mut run = simulation(&grid(name));
            steady::settle(&mut run).unwrap();
            let t_degc = |node: &str, line: usize| {
                get(&run, &format!("{node}.{}.t_k", lines[line])) - 273.15
            };
            assert!((t_degc("plant", 0) - supply).abs() < 1e-6, "{name}");
            // The houses cool what reaches them by the same difference, so the losses lower the return.
            let difference = t_degc("h3", 0) - t_degc("h3", 1);
            assert!((difference - (supply - back)).abs() < 1e-3, "{name}: {difference}");
            assert!(t_degc("plant", 1) < back && t_degc("plant", 1) > back - 4.0, "{name}");
            let (loss_w, plant_w) =
                (get(&run, "network.loss_w"), get(&run, "plant.station.q_flow_w"));
            let loads_w = if name == "5gdhc" { 72_000.0 } else { 90_000.0 };
            assert!(
                (plant_w - loads_w - loss_w).abs() < 1e-3 * loads_w,
                "{name}: {plant_w} {loss_w}"
            );
            if name != "5gdhc" {
                assert!(loss_w < loss_before, "{name}: {loss_w} {loss_before}");
                loss_before = loss_w;
            }
        }
    }

    /// Bare pipes lose heat in January; in September the ground warms the cold line.
    #[test]
    fn the_ambient_grid_gains_in_late_summer() {
        let mut model = grid("5gdhc");
        let loss_w = |model: &Model, pipe: &str| {
            let mut run = simulation(model);
            steady::settle(&mut run).unwrap();
            get(&run, &format!("{pipe}.q_loss_w"))
        };
        assert!(loss_w(&model, "h2-h3.cold") > 0.0);
        model.run.start = Some("2024-09-02T00:00:00+02:00".into());
        assert!(loss_w(&model, "h2-h3.cold") < 0.0);
        assert!(loss_w(&model, "plant-h1.warm") > 0.0);
    }

    #[test]
    fn they_run_and_their_balances_close() {
        for name in ["3gdh", "5gdhc"] {
            let mut run = simulation(&grid(name));
            advance(&mut run, 4.0 * 3600.0, 60.0);
            let error = Balances::of(&run).heat_error();
            assert!(error < 1e-6, "{name}: {error}");
        }
    }

    /// Steam and water above 100 degC are beyond the model.
    #[test]
    fn hotter_generations_are_refused() {
        let text = grid("3gdh").text;
        for t_degc in [105, 130, 180] {
            let hot = text.replace("supply_degc = 85", &format!("supply_degc = {t_degc}"));
            assert!(!refused(&hot).is_empty(), "{t_degc}");
        }
    }
}

/// Numbers of `examples/soil-study`: what a street of `examples/grids` loses in a year, MWh.
#[test]
fn soil_and_insulation_over_a_year() {
    let dir = workspace().join("examples/grids");
    let year_mwh = |name: &str, soil: (f64, f64), pipe: (&str, &str)| {
        let text = std::fs::read_to_string(dir.join(format!("{name}.toml"))).unwrap();
        let text = text.replace(pipe.0, pipe.1);
        let mut model = Model::from_toml(&text, &dir).unwrap();
        (model.ground.conductivity_w_m_k, model.ground.diffusivity_m2_s) = soil;
        let months = (1..=12).map(|month| {
            model.run.start = Some(format!("2023-{month:02}-15T12:00:00+01:00"));
            let mut run = simulation(&model);
            steady::settle(&mut run).unwrap();
            get(&run, "network.loss_w")
        });
        months.sum::<f64>() / 12.0 * 8760.0 / 1e6
    };
    let (dry, moist, wet) = ((0.5, 3.5e-7), (1.6, 6.2e-7), (2.5, 8.5e-7));
    for (name, soil, pipe, expected_mwh) in [
        ("3gdh", dry, ("", ""), 33.89),
        ("3gdh", moist, ("", ""), 40.89),
        ("3gdh", wet, ("", ""), 42.33),
        ("3gdh", moist, ("series 1", "series 3"), 32.18),
        ("5gdhc", dry, ("depth_m = 1.2", "depth_m = 2"), 19.35),
        ("5gdhc", moist, ("", ""), 63.08),
        ("5gdhc", wet, ("depth_m = 1.2", "depth_m = 0.8"), 97.66),
    ] {
        let found_mwh = year_mwh(name, soil, pipe);
        assert!((found_mwh - expected_mwh).abs() < 0.02, "{name} {soil:?}: {found_mwh}");
    }
}

#[test]
fn what_one_line_loses_to_the_other_stays_in_the_water() {
    for pipe in [
        "pipe = \"pre-insulated DN40 series 1\"\nspacing_mm = 150",
        "pipe = \"twin DN40 series 1\"",
    ] {
        let text = TRENCH.replace("PIPE", pipe).replace("to = \"b.cold\"", "to = \"cooler\"");
        // The water that turns back is cooled to 30 degC.
        let text = text
            + "[[node]]\nid = \"cooler\"\n[[edge]]\nid = \"cool\"\nkind = \"flow_source\"\nfrom = \"cooler\"\n\
               to = \"b.cold\"\nm_flow_kg_s = 0.05\n[[unit]]\nid = \"load\"\nport = \"cool\"\n\
               kind = \"prescribed_source\"\nsupply_degc = 30\nv_flow_l_min = 3\n";
        let text = text.replace("m_flow_kg_s = 0.4\n[[unit]]", "[[unit]]").replace("id = \"source\"\nkind = \"flow_source\"", "id = \"source\"\nkind = \"resistance\"\ndp_nominal_bar = 0.1\nm_flow_nominal_kg_s = 0.05");
        let text = text.replace(
            "kind = \"prescribed_source\"\nsupply_degc = 70\nv_flow_l_min = 24",
            "kind = \"heat_source\"\nsupply_degc = 70",
        );
        let model = model(&text);
        let plan = build(&model).unwrap_or_else(|problems| panic!("{}", problems.render(&text)));
        let conductance_w_k = plan.network().couplings[0].conductance_w_k;
        let mut run = Simulation::new(plan).unwrap();
        advance(&mut run, 12.0 * 3600.0, 60.0);
        let t = |node: &str| get(&run, &format!("{node}.t_k"));
        let m_cp = get(&run, "a-b.hot.m_flow_kg_s") * 4180.0;
        assert!((m_cp / 4180.0 - 0.05).abs() < 1e-6, "{m_cp}");
        // Given to the other line: what the water loses on its way less what goes to the ground.
        let hot_w = m_cp * (t("a.hot") - t("b.hot")) - get(&run, "a-b.hot.q_loss_w");
        let cold_w = m_cp * (t("b.cold") - t("a.cold")) - get(&run, "a-b.cold.q_loss_w");
        assert!(hot_w > 10.0 && (hot_w + cold_w).abs() < 1e-3 * hot_w, "{pipe}: {hot_w} {cold_w}");
        let means = 0.5 * (t("a.hot") + t("b.hot")) - 0.5 * (t("a.cold") + t("b.cold"));
        assert!((hot_w / (conductance_w_k * means) - 1.0).abs() < 0.02, "{pipe}: {hot_w}");
        assert!(Balances::of(&run).heat_error() < 1e-8, "{}", Balances::of(&run).heat_error());
    }
}
