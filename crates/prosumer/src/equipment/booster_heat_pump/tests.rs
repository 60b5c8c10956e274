use super::*;
use crate::heat_pump::FlowControl;

const DEGC: f64 = 273.15;
const CP: f64 = 4180.0;

type Booster = BoosterHeatPumpParams;

/// A unit between a grid and a house that send water of one temperature each.
struct Bench {
    unit: BoosterHeatPump,
    state: Vec<f64>,
    signals: [f64; 5],
    grid_k: f64,
    house_k: f64,
    /// Flow of the grid as a share of what is wanted.
    flow: f64,
    out: [f64; 15],
    ports: [PortFlow; 2],
}

fn left_k(request: &PortRequest, m_flow_kg_s: f64, t_in_k: f64) -> f64 {
    let warmed = |q_w: f64| {
        if m_flow_kg_s == 0.0 { t_in_k } else { t_in_k + q_w / (m_flow_kg_s.abs() * CP) }
    };
    match request.outlet {
        Outlet::HeatFlow(q_w) => warmed(q_w),
        Outlet::Cooled { wanted_w, coldest_k } => warmed(-wanted_w).max(coldest_k).min(t_in_k),
        Outlet::Exchange { w_k, other_k } => {
            let (constant_k, of_inlet) = Outlet::of_exchange(w_k, other_k, m_flow_kg_s.abs() * CP);
            constant_k + of_inlet * t_in_k
        }
        other => panic!("{other:?}"),
    }
}

impl Bench {
    fn new(params: &Booster, grid: f64, house: f64) -> Self {
        Self::of_unit(params.build(&Medium::default()).unwrap(), grid, house)
    }

    fn station(params: &Booster, grid: f64, house: f64) -> Self {
        let station = BoosterTransferStationParams(params.clone());
        Self::of_unit(station.build(&Medium::default()).unwrap(), grid, house)
    }

    fn of_unit(unit: BoosterHeatPump, grid: f64, house: f64) -> Self {
        let state = unit.initial_state(290.0);
        Self {
            unit,
            state,
            signals: [1.0, 0.0, 0.0, 1.0, 275.15],
            grid_k: grid + DEGC,
            house_k: house + DEGC,
            flow: 1.0,
            out: [0.0; 15],
            ports: [
                PortFlow { t_in_k: grid + DEGC, ..PortFlow::default() },
                PortFlow { t_in_k: house + DEGC, ..PortFlow::default() },
            ],
        }
    }

    fn step(&mut self, dt_s: f64) {
        let signals = Signals(&self.signals);
        let mut wanted = [PortRequest::default(); 2];
        self.unit.begin(dt_s, &mut self.state);
        self.unit.request(&signals, &self.ports, &mut self.state, &mut wanted);
        let m = wanted[GRID].m_flow_kg_s * self.flow;
        let t_out_k = left_k(&wanted[GRID], m, self.grid_k);
        self.ports[GRID] = PortFlow { m_flow_kg_s: m, t_in_k: self.grid_k, t_out_k };
        self.unit.respond(GRID, &signals, &self.ports, &mut self.state, &mut wanted);
        let m = wanted[HOUSE].m_flow_kg_s;
        let t_out_k = left_k(&wanted[HOUSE], m, self.house_k);
        self.ports[HOUSE] = PortFlow { m_flow_kg_s: m, t_in_k: self.house_k, t_out_k };
        let exchange =
            self.unit.advance(dt_s, &signals, &self.ports, &mut self.state, &mut self.out);
        let heat_w = |port: &PortFlow| port.m_flow_kg_s.abs() * CP * (port.t_out_k - port.t_in_k);
        let (grid_w, house_w) = (heat_w(&self.ports[0]), heat_w(&self.ports[1]));
        let left_w = exchange.electric_w + exchange.external_w - grid_w - house_w;
        assert!(left_w.abs() <= 1e-9 * (grid_w.abs() + house_w.abs() + 1.0), "{left_w}");
        // What is neither electricity nor of the grid: losses to the room of 5 % of the compressor and idle power.
        let compressor_w = exchange.electric_w - self.of("aux_w");
        assert!(exchange.external_w < 1e-6, "heat from nowhere: {exchange:?}");
        assert!(exchange.external_w > -0.05 * compressor_w - 15.0 - 1e-6, "{exchange:?}");
    }

    fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step(60.0);
        }
    }

    fn of(&self, name: &str) -> f64 {
        let at = self.unit.outputs().iter().position(|output| output.name == name);
        self.out[at.unwrap()]
    }

    fn change_k(&self, port: usize) -> f64 {
        self.ports[port].t_out_k - self.ports[port].t_in_k
    }
}

#[test]
fn cop_of_five_point_one_with_a_grid_of_twenty_degrees() {
    // Grid 20 to 15, house 35 to 40 degC: COP 5.099; 0.4 of the speed: eta 0.5 (1 + 0.12 * 0.6), COP 5.466,
    // heat 0.4 * 19 * 1.25 = 9.5 kW, from the grid 9500 - 0.95 * 1738 = 7849 W: 0.3755 kg/s
    let mut bench = Bench::new(&Booster::default(), 20.0, 35.0);
    bench.signals[MODULATION] = 0.4;
    bench.steps(10);
    assert!((bench.of("cop") - 5.099 * 1.072).abs() < 0.01, "{}", bench.of("cop"));
    assert!((bench.of("q_flow_w") - 9500.0).abs() < 1e-6);
    assert!(
        (bench.change_k(GRID) + 5.0).abs() < 1e-6 && (bench.change_k(HOUSE) - 5.0).abs() < 1e-9
    );
    assert!((bench.ports[GRID].m_flow_kg_s + 0.3755).abs() < 2e-4, "{:?}", bench.ports);
    // Full speed wants more than 25 l/min: the flow is at its limit, the water is cooled further, the COP falls.
    bench.signals[MODULATION] = 1.0;
    bench.steps(10);
    assert!((bench.ports[GRID].m_flow_kg_s + 25.0 / 60.0).abs() < 1e-9);
    assert!(bench.change_k(GRID) < -10.0 && bench.of("cop") < 4.7, "{}", bench.of("cop"));
    let wide = Booster { grid_v_flow_max_m3_s: 1e-3, ..Booster::default() };
    let mut bench = Bench::new(&wide, 20.0, 35.0);
    bench.steps(10);
    assert!((bench.of("cop") - 5.099).abs() < 0.002, "{}", bench.of("cop"));
}

#[test]
fn constant_grid_flow_lets_the_return_float() {
    let constant = Booster {
        grid_flow_control: FlowControl::ConstantFlow,
        house_flow_control: FlowControl::ConstantFlow,
        ..Booster::default()
    };
    let mut bench = Bench::new(&constant, 20.0, 35.0);
    bench.signals[MODULATION] = 0.25;
    bench.steps(10);
    let small_k = bench.change_k(GRID);
    assert!((bench.ports[GRID].m_flow_kg_s + 0.2).abs() < 1e-12);
    assert!((bench.ports[HOUSE].m_flow_kg_s - 0.5).abs() < 1e-12);
    assert!((bench.change_k(HOUSE) - 0.25 * 23_750.0 / (0.5 * CP)).abs() < 1e-9);
    bench.signals[MODULATION] = 0.6;
    bench.steps(10);
    assert!(bench.change_k(GRID) < small_k - 1.0);
    // Cooling: the grid takes cold and electricity, and flows to the hot line.
    bench.signals[MODE] = 1.0;
    bench.house_k = 20.0 + DEGC;
    bench.steps(12);
    assert!((bench.ports[GRID].m_flow_kg_s - 0.2).abs() < 1e-12);
    assert!((bench.of("q_flow_w") + 0.6 * 14_000.0).abs() < 1e-6);
    let taken_w = 0.2 * CP * bench.change_k(GRID);
    let expected_w = 8400.0 + 0.95 * bench.of("electric_w");
    assert!((taken_w - expected_w).abs() < 1e-6, "{taken_w} {expected_w}");
}

#[test]
fn grid_water_is_not_cooled_below_its_limit() {
    let constant = Booster { grid_flow_control: FlowControl::ConstantFlow, ..Booster::default() };
    for grid in [12.0, 9.0, 7.0] {
        let mut bench = Bench::new(&constant, grid, 35.0);
        bench.steps(20);
        assert!(bench.ports[GRID].t_out_k >= 277.15 - 1e-9, "{:?}", bench.ports);
        // 0.2 kg/s cannot give what 19 kW need: the speed is reduced until the water leaves with 4 degC.
        assert!(bench.of("speed") < 0.95 && bench.of("speed") >= 0.25, "{}", bench.of("speed"));
        if grid > 8.0 {
            assert!(bench.ports[GRID].t_out_k < 277.15 + 0.3, "{:?}", bench.ports);
        }
    }
    // Nothing is left to take.
    let mut bench = Bench::new(&constant, 4.5, 35.0);
    bench.steps(5);
    assert_eq!((bench.of("tripped"), bench.of("starts")), (1.0, 0.0));
    // A held drop shrinks to what is there.
    let mut bench = Bench::new(&Booster::default(), 7.0, 35.0);
    bench.signals[MODULATION] = 0.25;
    bench.steps(20);
    assert!((bench.change_k(GRID) + 3.0).abs() < 0.05, "{:?}", bench.ports);
}

#[test]
fn a_blocked_unit_gives_what_the_grid_gave() {
    let mut bench = Bench::new(&Booster::default(), 15.0, 35.0);
    bench.signals[MODULATION] = 0.5;
    bench.steps(10);
    let (free_w, free) = (bench.of("q_flow_w"), bench.of("cop"));
    bench.flow = 0.4;
    bench.steps(10);
    // The water is cooled to 4 degC; heat and electricity shrink together with it.
    assert!(
        bench.of("q_flow_w") < 0.95 * free_w && bench.of("cop") < free,
        "{}",
        bench.of("q_flow_w")
    );
    assert!((bench.ports[GRID].t_out_k - 277.15).abs() < 0.1, "{:?}", bench.ports);
    bench.flow = 0.0;
    bench.steps(2);
    assert_eq!((bench.of("q_flow_w"), bench.of("electric_w")), (0.0, 0.0));
}

#[test]
fn start_is_a_ramp_of_two_minutes() {
    let mut bench = Bench::new(&Booster { speed_rise_s: 0.0, ..Booster::default() }, 20.0, 35.0);
    bench.signals[MODULATION] = 0.4;
    let q: Vec<f64> = (0..8)
        .map(|_| {
            bench.step(30.0);
            bench.of("q_flow_w")
        })
        .collect();
    for (i, share) in [0.125, 0.375, 0.625, 0.875, 1.0].into_iter().enumerate() {
        assert!((q[i] - share * 9500.0).abs() < 1.0, "{q:?}");
    }
    let mut coarse = Bench::new(&Booster { speed_rise_s: 0.0, ..Booster::default() }, 20.0, 35.0);
    coarse.signals[MODULATION] = 0.4;
    coarse.step(240.0);
    let mean: f64 = q.iter().sum::<f64>() / 8.0;
    assert!((coarse.of("q_flow_w") / mean - 1.0).abs() < 1e-9);
}

#[test]
fn station_prefers_its_exchanger() {
    // Grid 45, house 35 degC: the exchanger; 0.5 kg/s on both sides would have NTU 1.435, eps 0.589.
    let constant = Booster {
        grid_flow_control: FlowControl::ConstantFlow,
        grid_v_flow_m3_s: 5e-4,
        ..Booster::default()
    };
    let mut bench = Bench::station(&constant, 45.0, 35.0);
    bench.steps(3);
    let eps = 1.435_407 / 2.435_407;
    assert_eq!((bench.of("exchanger"), bench.of("starts")), (1.0, 0.0));
    assert!((bench.of("q_flow_w") - eps * 0.5 * CP * 10.0).abs() < 1.0, "{}", bench.of("q_flow_w"));
    assert!(bench.ports[GRID].m_flow_kg_s < 0.0);
    // The rod adds its 6 kW behind it.
    bench.signals[AUX] = 1.0;
    bench.steps(1);
    assert!((bench.of("q_flow_w") - eps * 0.5 * CP * 10.0 - 6000.0).abs() < 1.0);
    bench.signals[AUX] = 0.0;
    // The approach is missed: the heat pump takes over; the exchanger again when the pump has stopped.
    bench.grid_k = 35.5 + DEGC;
    bench.steps(6);
    assert_eq!((bench.of("exchanger"), bench.of("starts")), (0.0, 1.0));
    bench.grid_k = 45.0 + DEGC;
    bench.steps(1);
    assert_eq!(bench.of("exchanger"), 0.0);
    bench.steps(10);
    assert_eq!((bench.of("exchanger"), bench.of("phase")), (1.0, 0.0));
    // Cold: directly where the grid is 2 K colder than what comes from the rooms; from warm to cold.
    bench.signals[MODE] = 1.0;
    bench.grid_k = 12.0 + DEGC;
    bench.house_k = 18.0 + DEGC;
    bench.steps(3);
    assert!(bench.of("exchanger") == 1.0 && bench.ports[GRID].m_flow_kg_s < 0.0);
    assert!((bench.of("q_flow_w") + eps * 0.5 * CP * 6.0).abs() < 1.0, "{}", bench.of("q_flow_w"));
    bench.grid_k = 17.5 + DEGC;
    bench.steps(8);
    assert!(bench.of("exchanger") == 0.0 && bench.of("q_flow_w") < -13_000.0);
    assert!(bench.ports[GRID].m_flow_kg_s < 0.0 && bench.change_k(GRID) > 0.0);
    let reversed = Booster { reversed_for_cold: Some(true), mode: 1.0, ..constant };
    let mut bench = Bench::station(&reversed, 12.0, 18.0);
    bench.signals[MODE] = 1.0;
    bench.steps(3);
    assert!(bench.ports[GRID].m_flow_kg_s > 0.0 && bench.of("exchanger") == 1.0);
}

#[test]
fn energy_closes_under_random_signals_steps_and_flows() {
    // The bench checks every step.
    let mut seed = 5_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1_u64 << 24) as f64
    };
    for (grid, house) in [
        (FlowControl::ConstantFlow, FlowControl::ConstantTemperatureDifference),
        (FlowControl::ConstantTemperatureDifference, FlowControl::ConstantFlow),
    ] {
        let params =
            Booster { grid_flow_control: grid, house_flow_control: house, ..Booster::default() };
        let mut bench = Bench::station(&params, 15.0, 35.0);
        let mut exchanger_s = 0.0;
        for _ in 0..3000 {
            bench.signals = [
                (1.5 * random() - 0.2).clamp(0.0, 1.0),
                f64::from(u8::from(random() < 0.3)),
                (2.0 * random() - 1.0).max(0.0),
                f64::from(u8::from(random() < 0.95)),
                260.0 + 40.0 * random(),
            ];
            bench.grid_k = 275.0 + 30.0 * random();
            bench.house_k = 280.0 + 55.0 * random();
            bench.flow = if random() < 0.3 { random() } else { 1.0 };
            bench.step([1.0, 10.0, 60.0, 300.0, 900.0][(5.0 * random()) as usize]);
            assert!(bench.out.iter().all(|value| value.is_finite()), "{:?}", bench.out);
            exchanger_s = bench.of("exchanger_s");
        }
        assert!(bench.of("starts") > 30.0 && exchanger_s > 0.0);
    }
}

#[test]
fn numbers_that_cannot_be_are_refused_by_name() {
    let said = |change: fn(&mut Booster)| {
        let mut params = Booster::default();
        change(&mut params);
        params.build(&Medium::default()).unwrap_err().to_string()
    };
    assert!(said(|it| it.rated_heat_w = 0.0).contains("rated_heat_w = 0 must be positive"));
    assert!(said(|it| it.grid_v_flow_min_m3_s = 1.0).contains("grid_v_flow_max_m3_s"));
    assert!(said(|it| it.carnot_share = 1.5).contains("between 0 and 1"));
}
