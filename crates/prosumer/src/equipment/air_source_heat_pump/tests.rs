use super::*;
use crate::heat_pump::FlowControl;
use crate::performance_map::params::{MapChoice, PerformanceMapParams};

const DEGC: f64 = 273.15;

/// A unit that runs against water of one temperature.
struct Bench {
    unit: AirSourceHeatPump,
    state: Vec<f64>,
    signals: [f64; 6],
    return_k: f64,
    /// Flow as a share of what is wanted.
    flow: f64,
    out: [f64; 15],
}

impl Bench {
    fn new(params: &AirSourceHeatPumpParams, return_degc: f64) -> Self {
        let unit = params.build(&Medium::default()).unwrap();
        let return_k = return_degc + DEGC;
        let state = unit.initial_state(return_k);
        Self {
            unit,
            state,
            signals: [1.0, 0.0, 0.0, 1.0, 275.15, 0.8],
            return_k,
            flow: 1.0,
            out: [0.0; 15],
        }
    }

    fn step(&mut self, dt_s: f64) -> PortFlow {
        let signals = Signals(&self.signals);
        let got = PortFlow { t_in_k: self.return_k, ..PortFlow::default() };
        let mut wanted = [PortRequest::default()];
        self.unit.begin(dt_s, &mut self.state);
        self.unit.request(&signals, &[got], &mut self.state, &mut wanted);
        let m = wanted[0].m_flow_kg_s * self.flow;
        let t_out_k = match wanted[0].outlet {
            Outlet::HeatFlow(q_w) if m > 0.0 => self.return_k + q_w / (m * 4180.0),
            Outlet::HeatFlow(_) => self.return_k,
            Outlet::Linear { constant_k, of_inlet } => constant_k + of_inlet * self.return_k,
            other => panic!("{other:?}"),
        };
        let port = PortFlow { m_flow_kg_s: m, t_in_k: self.return_k, t_out_k };
        let before_j = self.unit.stored_j(&self.state);
        let exchange = self.unit.advance(dt_s, &signals, &[port], &mut self.state, &mut self.out);
        let change_j = self.unit.stored_j(&self.state) - before_j;
        let q_w = m * 4180.0 * (t_out_k - self.return_k);
        let balance_j = dt_s * (exchange.electric_w + exchange.external_w - q_w);
        let scale = dt_s * (q_w.abs() + exchange.electric_w) + before_j.abs();
        assert!((change_j - balance_j).abs() <= 1e-9 * scale, "{change_j} {balance_j}");
        port
    }

    fn steps(&mut self, count: usize, dt_s: f64) {
        for _ in 0..count {
            self.step(dt_s);
        }
    }

    fn of(&self, name: &str) -> f64 {
        let at = self.unit.outputs().iter().position(|output| output.name == name);
        self.out[at.unwrap()]
    }
}

fn plain() -> AirSourceHeatPumpParams {
    AirSourceHeatPumpParams { content_m3: 0.0, ..AirSourceHeatPumpParams::default() }
}

#[test]
fn steady_unit_holds_its_difference_and_meets_the_check_table() {
    // A2, return 35: 9.96 kW, COP 4.91; 0.4765 kg/s for 5 K
    for dynamics in [true, false] {
        let mut bench = Bench::new(&AirSourceHeatPumpParams { dynamics, ..plain() }, 35.0);
        bench.steps(20, 60.0);
        let port = bench.step(60.0);
        assert!((bench.of("q_flow_w") / 9960.0 - 1.0).abs() < 3e-3, "{}", bench.of("q_flow_w"));
        assert!((bench.of("cop") / 4.91 - 1.0).abs() < 3e-3);
        assert!((port.t_out_k - port.t_in_k - 5.0).abs() < 1e-9);
        // Air: Q - 0.95 P
        let air_w = bench.of("q_flow_w") - 0.95 * bench.of("electric_w");
        assert!((bench.of("air_w") - air_w).abs() < 1e-9);
    }
    let constant = AirSourceHeatPumpParams { flow_control: FlowControl::ConstantFlow, ..plain() };
    let mut bench = Bench::new(&constant, 35.0);
    bench.steps(20, 60.0);
    bench.signals[MODULATION] = 0.4;
    bench.steps(2, 60.0);
    // 5.32 kW at 0.48 kg/s: 2.65 K
    let port = bench.step(60.0);
    assert!((port.m_flow_kg_s - 0.48).abs() < 1e-12);
    assert!((port.t_out_k - port.t_in_k - 5320.0 / (0.48 * 4180.0)).abs() < 0.01);
}

#[test]
fn start_draws_heat_first_and_is_steady_after_ten_minutes() {
    let mut bench = Bench::new(&plain(), 35.0);
    let q: Vec<f64> = (0..24)
        .map(|_| {
            bench.step(30.0);
            bench.of("q_flow_w")
        })
        .collect();
    assert!(q[0] < -500.0 && q[2] > 0.0, "{q:?}");
    assert!((q[21] - q[23]).abs() < 1e-9 && q[15] < 0.99 * q[23], "{q:?}");
    assert_eq!((bench.of("starts"), bench.of("phase")), (1.0, 3.0));
    // The same heat whatever the step.
    let total = |dt_s: f64| {
        let mut bench = Bench::new(&plain(), 35.0);
        bench.steps((1800.0 / dt_s) as usize, dt_s);
        (bench.of("heat_j"), bench.of("electric_j"))
    };
    let (heat_j, electric_j) = total(900.0);
    for dt_s in [1.0, 60.0, 300.0] {
        let (heat, electric) = total(dt_s);
        assert!((heat / heat_j - 1.0).abs() < 1e-9 && (electric / electric_j - 1.0).abs() < 1e-9);
    }
}

#[test]
fn heater_has_three_steps_drives_the_compressor_and_costs_cop() {
    let heater = AuxHeater { rated_w: 9000.0, steps: 3 };
    for (command, kw) in [
        (0.0, 0.0),
        (0.01, 3.0),
        (0.333_333, 3.0),
        (0.34, 6.0),
        (0.666_667, 6.0),
        (0.7, 9.0),
        (1.0, 9.0),
    ] {
        assert!((heater.power_w(command) - 1000.0 * kw).abs() < 1e-9, "{command}");
    }
    assert!((AuxHeater { rated_w: 6000.0, steps: 0 }.power_w(0.3) - 1800.0).abs() < 1e-9);
    let mut bench = Bench::new(&plain(), 35.0);
    bench.signals[MODULATION] = 0.3;
    bench.steps(30, 60.0);
    let cop = bench.of("cop");
    bench.signals[AUX] = 1.0;
    bench.steps(3, 60.0);
    let port = bench.step(60.0);
    // (9.96 + 9)/(9.96/4.91 + 9) = 1.719; the supply is lifted by 9/9.96 of 5 K beyond the 5 K
    assert_eq!(bench.of("speed"), 1.0);
    assert!((bench.of("cop") - 1.719).abs() < 5e-3 && cop > 6.0, "{} {cop}", bench.of("cop"));
    assert!((port.t_out_k - port.t_in_k - 5.0 * (1.0 + 9.0 / 9.963)).abs() < 0.01, "{port:?}");
}

#[test]
fn slow_commands_are_raised_to_the_smallest_speed_and_zero_is_off() {
    let mut bench = Bench::new(&plain(), 35.0);
    bench.signals[MODULATION] = 0.05;
    bench.steps(20, 60.0);
    assert!((bench.of("speed") - 0.2).abs() < 1e-12);
    bench.signals[MODULATION] = 0.0;
    bench.steps(5, 60.0);
    let port = bench.step(60.0);
    assert_eq!((port.m_flow_kg_s, bench.of("electric_w"), bench.of("phase")), (0.0, 15.0, 0.0));
    bench.signals[MODULATION] = 1.0;
    bench.signals[ENABLE] = 0.0;
    bench.steps(10, 60.0);
    assert_eq!(bench.of("starts"), 1.0);
}

#[test]
fn limits_stop_the_unit_and_let_it_start_again_inside() {
    let free =
        AirSourceHeatPumpParams { run_min_s: 0.0, off_min_s: 0.0, supply_max_k: 353.15, ..plain() };
    let mut bench = Bench::new(&free, 60.0);
    let mut at = |return_degc: f64| {
        bench.return_k = return_degc + DEGC;
        bench.steps(3, 60.0);
        bench.of("phase") > 1.0
    };
    // Stops above 68 degC, starts again below 63; stops below 15, starts again above 20.
    let seen = [60.0, 67.9, 68.1, 64.0, 62.9, 14.9, 18.0, 20.1].map(&mut at);
    assert_eq!(seen, [true, true, false, false, true, false, false, true]);
    // High pressure: return 66 and 5 K are above 70 degC.
    let mut bench =
        Bench::new(&AirSourceHeatPumpParams { supply_max_k: 343.15, ..free.clone() }, 66.0);
    bench.steps(8, 60.0);
    assert!(bench.of("starts") >= 1.0);
    let mut seen_off = false;
    for _ in 0..20 {
        bench.step(60.0);
        seen_off |= bench.of("tripped") == 1.0;
    }
    assert!(seen_off);
    // Cold air.
    let mut bench = Bench::new(&free, 40.0);
    bench.signals[T_OUTDOOR] = 240.0;
    bench.step(60.0);
    assert_eq!((bench.of("tripped"), bench.of("starts")), (1.0, 0.0));
}

#[test]
fn frost_is_removed_in_cold_air_only() {
    let minutes = |air_degc: f64, humidity: f64| {
        let mut bench = Bench::new(&plain(), 35.0);
        bench.signals[T_OUTDOOR] = air_degc + DEGC;
        bench.signals[HUMIDITY] = humidity;
        let taken = (0..120).filter(|_| {
            bench.step(60.0);
            bench.of("q_flow_w") < -4000.0
        });
        (taken.count(), bench.of("defrosting_s") / 60.0)
    };
    let (taken, minutes_of_defrost) = minutes(0.0, 0.8);
    assert!(
        taken == 10 && (minutes_of_defrost - 10.0).abs() < 1e-6,
        "{taken} {minutes_of_defrost}"
    );
    assert_eq!(minutes(5.1, 0.8).1, 0.0);
    assert!(minutes(4.9, 0.8).1 > 9.0 && minutes(0.0, 1.0).1 > 10.0);
}

#[test]
fn cooling_cools_and_a_change_of_mode_starts_again() {
    let mut bench = Bench::new(&plain(), 23.0);
    bench.signals[MODE] = 1.0;
    bench.signals[T_OUTDOOR] = 308.15;
    bench.steps(20, 60.0);
    let port = bench.step(60.0);
    // 9.015 kW, EER 5.328, 5 K colder; 9015 + 0.95 * 1692 W into the air
    assert!((bench.of("q_flow_w") + 9015.0).abs() < 1e-6 && (bench.of("cop") - 5.328).abs() < 1e-9);
    assert!((port.t_in_k - port.t_out_k - 5.0).abs() < 1e-9);
    assert!((bench.of("air_w") + 9015.0 + 0.95 * 9015.0 / 5.328).abs() < 1e-6);
    bench.signals[MODE] = 0.0;
    bench.step(60.0);
    assert_eq!(bench.of("phase"), 2.0);
    assert!(bench.of("cold_j") > 0.0);
    // Without a map of cooling it stays off.
    let map = PerformanceMapParams {
        source_k: vec![270.0, 280.0],
        return_k: vec![300.0, 320.0],
        heat_w: vec![vec![5000.0, 4500.0], vec![6000.0, 5500.0]],
        cop: vec![vec![3.0, 2.0], vec![4.0, 3.0]],
        ..PerformanceMapParams::default()
    };
    let of_map = AirSourceHeatPumpParams {
        map: Some(MapChoice::Given(Box::new(map))),
        dynamics: false,
        ..plain()
    };
    let mut bench = Bench::new(&of_map, 26.85);
    bench.signals[T_OUTDOOR] = 275.0;
    bench.step(60.0);
    // Between the rows at 300 K: 5500 W, electricity (1666.7 + 1500)/2
    assert!(
        (bench.of("q_flow_w") - 5500.0).abs() < 1e-6
            && (bench.of("electric_w") - 1583.333).abs() < 1e-2
    );
    bench.signals[MODE] = 1.0;
    bench.step(60.0);
    assert_eq!(bench.of("q_flow_w"), 0.0);
}

#[test]
fn content_flushes_when_the_return_is_switched() {
    // 4 kg at 0.4765 kg/s: 8.39 s; 5 s after the return falls from 45 to 30 degC the water that leaves is between.
    let mut bench = Bench::new(&AirSourceHeatPumpParams::default(), 45.0);
    bench.steps(30, 60.0);
    assert!((bench.step(60.0).t_out_k - DEGC - 50.0).abs() < 1e-3);
    bench.return_k = 30.0 + DEGC;
    let out: Vec<f64> = (0..12).map(|_| bench.step(5.0).t_out_k - DEGC).collect();
    assert!(
        out[0] > 43.0 && out[0] < 49.0 && out.windows(2).all(|pair| pair[1] < pair[0] + 1e-9),
        "{out:?}"
    );
    assert!((out[11] - 35.0).abs() < 0.1, "{out:?}");
}

#[test]
fn energy_closes_under_random_signals_steps_and_flows() {
    // The bench checks the balance of every step.
    let mut seed = 3_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1_u64 << 24) as f64
    };
    for content_m3 in [0.0, 0.004] {
        let params = AirSourceHeatPumpParams { content_m3, ..plain() };
        let mut bench = Bench::new(&params, 40.0);
        for _ in 0..3000 {
            let dt_s = [1.0, 10.0, 60.0, 300.0, 900.0][(5.0 * random()) as usize];
            bench.signals = [
                (1.5 * random() - 0.2).clamp(0.0, 1.0),
                f64::from(u8::from(random() < 0.1)),
                (2.0 * random() - 1.0).max(0.0),
                f64::from(u8::from(random() < 0.9)),
                255.0 + 45.0 * random(),
                random(),
            ];
            bench.return_k = 280.0 + 65.0 * random();
            bench.flow = if random() < 0.2 { random() } else { 1.0 };
            bench.step(dt_s);
            assert!(bench.out.iter().all(|value| value.is_finite()), "{:?}", bench.out);
        }
        assert!(bench.of("starts") > 50.0 && bench.of("defrosting_s") > 0.0);
        assert!(bench.of("cop_so_far") > 0.5 && bench.of("cop_so_far") < 10.0);
    }
}

#[test]
fn numbers_that_cannot_be_are_refused_by_name() {
    let said = |change: fn(&mut AirSourceHeatPumpParams)| {
        let mut params = plain();
        change(&mut params);
        params.build(&Medium::default()).unwrap_err().to_string()
    };
    assert_eq!(said(|it| it.modulation_min = 1.2), "modulation_min = 1.2 must lie between 0 and 1");
    assert!(said(|it| it.cop_max = Some(0.5)).contains("at least 1"));
    assert!(said(|it| it.start_heat.truncate(3)).contains("start_heat has 3 points"));
    assert!(said(|it| it.start_times_s[0] = 5.0).contains("rise from 0"));
    assert!(
        said(|it| it.map = Some(MapChoice::Named("x".into()))).contains("no heat_pump_map \"x\"")
    );
    assert!(said(|it| it.heating_return_max_k = 400.0).contains("heating_return_max_k"));
}
