//! Engines with a content of water: cold starts, idle flow, what passes them.

use super::*;

/// An engine of 60 kJ/K in water that arrives at one temperature, with a flow that others can push through it.
struct Engine {
    unit: Combustion,
    state: Vec<f64>,
    out: Vec<f64>,
    signals: Vec<f64>,
    port: PortFlow,
    heat_j: f64,
}

impl Engine {
    fn new(params: &ChpParams) -> Self {
        let unit = params.build(&water()).unwrap();
        Self {
            state: unit.initial_state(293.15),
            out: vec![0.0; unit.outputs().len()],
            signals: unit.inputs().iter().map(|input| input.initial).collect(),
            port: PortFlow { m_flow_kg_s: 0.0, t_in_k: 313.15, t_out_k: 313.15 },
            heat_j: 0.0,
            unit,
        }
    }

    /// A step in which `pushed_kg_s` passes more than is wanted; heat closes over it.
    fn step(&mut self, dt_s: f64, pushed_kg_s: f64) {
        let signals = Signals(&self.signals);
        self.unit.begin(dt_s, &mut self.state);
        let mut wanted = [PortRequest::default()];
        self.unit.request(&signals, &[self.port], &mut self.state, &mut wanted);
        let m_flow_kg_s = wanted[0].m_flow_kg_s + pushed_kg_s;
        let Outlet::Stirred { t_k, heat_w, heat_capacity_j_k, dt_s } = wanted[0].outlet else {
            panic!("{wanted:?}")
        };
        let (constant_k, of_inlet) =
            Outlet::of_stirred(t_k, heat_w, heat_capacity_j_k, dt_s, m_flow_kg_s * CP);
        self.port =
            PortFlow { m_flow_kg_s, t_in_k: 313.15, t_out_k: constant_k + of_inlet * 313.15 };
        let before_j = self.unit.stored_j(&self.state);
        let exchange =
            self.unit.advance(dt_s, &signals, &[self.port], &mut self.state, &mut self.out);
        let q_w = m_flow_kg_s * CP * (self.port.t_out_k - 313.15);
        self.heat_j += dt_s * q_w;
        let gained_j = self.unit.stored_j(&self.state) - before_j;
        let given_j = dt_s * (exchange.electric_w + exchange.external_w - q_w);
        assert!((gained_j - given_j).abs() < 1e-5, "{gained_j} {given_j}");
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }
}

fn with_content() -> ChpParams {
    ChpParams { content_j_k: 60_000.0, modulation: 1.0, ..ChpParams::default() }
}

#[test]
fn a_stirred_content_leaves_as_its_mean() {
    // x = 100 60/60000 = 0.1, phi = (1 - e^-0.1)/0.1 = 0.951626: 50 phi + (1 - phi) (30 + 2000/100) = 50 degC;
    // without heat 50 phi + 30 (1 - phi) = 49.0325 degC
    let of = |heat_w| Outlet::of_stirred(323.15, heat_w, 60_000.0, 60.0, 100.0);
    let at = |(c, f): (f64, f64)| c + f * 303.15 - 273.15;
    assert!((at(of(2000.0)) - 50.0).abs() < 1e-9);
    assert!((at(of(0.0)) - 49.032_516).abs() < 1e-6);
    // The series meets the formula.
    let share = |capacity_w_k| Outlet::of_stirred(0.0, 0.0, 60_000.0, 60.0, capacity_w_k).1;
    assert!((share(0.1001) / share(0.0999) / (0.1001 / 0.0999) - 1.0).abs() < 1e-6);
}

#[test]
fn a_cold_engine_with_a_content_heats_itself_first() {
    // 60 kJ/K from 20 to 82 degC are 3.72 MJ; the engine gives about 4.7 kW from 56 s on and
    // loses up to 0.3 kW: some 870 s. The measured start: no heat before 724 s.
    let mut engine = Engine::new(&with_content());
    let mut first_s = 0.0;
    while engine.heat_j <= 0.0 {
        engine.step(5.0, 0.0);
        first_s += 5.0;
        assert!(first_s < 2000.0);
    }
    assert!((724.0..1100.0).contains(&first_s), "{first_s}");
    assert!(engine.out("t_engine_k") > 353.15);
    // In the end it gives what the map says less the loss of 5 W/K over 62 K, at 80 degC.
    (0..2000).for_each(|_| engine.step(5.0, 0.0));
    let steady_w = engine.out("q_flow_w") + engine.out("loss_w");
    let plain = ChpParams { content_j_k: 0.0, dynamics: false, ..with_content() };
    let mut bench = Bench::new(plain.build(&water()), 40.0);
    bench.step(60.0);
    assert!((steady_w / bench.out("q_flow_w") - 1.0).abs() < 1e-3, "{steady_w}");
    assert!((engine.out("t_engine_k") - 353.15).abs() < 4.0, "{}", engine.out("t_engine_k"));
}

#[test]
fn an_engine_that_is_sucked_empty_stops_its_pump_until_it_is_hot() {
    let mut engine = Engine::new(&with_content());
    (0..600).for_each(|_| engine.step(5.0, 0.0));
    let (mut stops, mut coldest_k) = (0, f64::MAX);
    let mut ran = true;
    for _ in 0..720 {
        // Twice as much water passes while the pump runs.
        let pushed = if ran { 0.08 } else { 0.0 };
        engine.step(5.0, pushed);
        let runs = engine.state[engine.unit.engine_at() + 1] != 0.0;
        stops += u32::from(ran && !runs);
        ran = runs;
        coldest_k = coldest_k.min(engine.out("t_engine_k"));
    }
    // Heating by 7 K takes 7 60/4.8 = 88 s, emptying at (0.03 + 0.08) 4180 40 - 4800 = 13.6 kW 31 s: every two minutes.
    assert!((20..40).contains(&stops), "{stops} in an hour");
    assert!(coldest_k > 343.15, "{coldest_k}");
}

#[test]
fn an_idle_engine_gives_its_heat_to_water_that_passes() {
    // 60 kJ/K from 80 to 40 degC are 2.4 MJ, less what it loses meanwhile.
    let params = ChpParams {
        modulation: 0.0,
        initial_content_k: Some(353.15),
        content_loss_w_k: 0.0,
        ..with_content()
    };
    let mut engine = Engine::new(&params);
    (0..200).for_each(|_| engine.step(60.0, 0.05));
    assert!((engine.heat_j / 2.4e6 - 1.0).abs() < 1e-6, "{}", engine.heat_j);
    assert!(engine.out("t_engine_k") - 313.15 < 1e-6);
}

#[test]
fn the_cold_start_of_an_engine_with_a_content_is_counted_once() {
    assert_eq!(ChpParams::default().warm_up_w(), 1000.0);
    assert_eq!(with_content().warm_up_w(), 0.0);
    // What is given besides counts: 1 kW that falls to nothing in 2400 s, from ignition (56 s) on, are
    // 1.2 MJ - 1000 (56 - 56^2/4800) = 1.1447 MJ less for water, content and surroundings.
    let given_j = |warm_up_w| {
        let mut engine = Engine::new(&ChpParams { warm_up_w, ..with_content() });
        (0..720).for_each(|_| engine.step(5.0, 0.0));
        engine.heat_j + engine.unit.stored_j(&engine.state) + engine.out("loss_j")
    };
    // Who gives both is told: 1000 W * 2400 s/2 = 0.33 kWh.
    let remarks = |warm_up_w| {
        let params = ChpParams { warm_up_w, ..with_content() };
        params.build(&water()).unwrap().remarks()
    };
    assert!(remarks(None).is_empty());
    let told = remarks(Some(1000.0));
    assert!(told[0].contains("warm_up_kw another 0.33 kWh"), "{told:?}");
    let less_j = given_j(None) - given_j(Some(1000.0));
    assert!((less_j / 1.1447e6 - 1.0).abs() < 0.01, "{less_j}");
}
