use super::*;
use crate::thermal_unit::UnitError;

const CP: f64 = 4180.0;

struct Bench {
    unit: DomesticHotWater,
    state: Vec<f64>,
    out: [f64; 12],
    signals: Vec<f64>,
    arrives_k: f64,
    port: PortFlow,
}

impl Bench {
    fn new(params: &DomesticHotWaterParams, arrives_degc: f64) -> Self {
        let unit = params.build(&Medium::default()).unwrap();
        let arrives_k = arrives_degc + 273.15;
        let mut bench = Self {
            state: unit.initial_state(arrives_k),
            out: [0.0; 12],
            signals: unit.inputs().iter().map(|input| input.initial).collect(),
            arrives_k,
            port: PortFlow { m_flow_kg_s: 0.0, t_in_k: arrives_k, t_out_k: arrives_k },
            unit,
        };
        bench.signals[START] = 19_403.0 * DAY_S;
        bench
    }

    fn step(&mut self, dt_s: f64) -> Exchange {
        let signals = Signals(&self.signals);
        self.unit.begin(dt_s, &mut self.state);
        let mut wanted = [PortRequest::default()];
        self.port.t_in_k = self.arrives_k;
        self.unit.request(&signals, &[self.port], &mut self.state, &mut wanted);
        let PortRequest { m_flow_kg_s, outlet } = wanted[0];
        let t_in_k = self.arrives_k;
        let t_out_k = match outlet {
            Outlet::Cooled { wanted_w, coldest_k } if m_flow_kg_s > 0.0 => {
                (t_in_k - wanted_w / (m_flow_kg_s * CP)).max(coldest_k)
            }
            Outlet::Linear { constant_k, of_inlet } => constant_k + of_inlet * t_in_k,
            _ => t_in_k,
        };
        self.port = PortFlow { m_flow_kg_s, t_in_k, t_out_k };
        self.unit.advance(dt_s, &signals, &[self.port], &mut self.state, &mut self.out)
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }
}

fn driven(heated_by: HeatedBy) -> DomesticHotWaterParams {
    DomesticHotWaterParams {
        heated_by,
        cold_amplitude_difference_k: 0.0,
        ..DomesticHotWaterParams::default()
    }
}

#[test]
fn a_fresh_water_station_by_hand() {
    let mut bench = Bench::new(&driven(HeatedBy::Exchanger), 65.0);
    bench.signals[DRIVEN_M3_S] = 8.0 / 60_000.0;
    bench.step(60.0);
    // 8 l/min from 10 to 45 degC: 0.13333 * 4180 * 35 = 19 507 W; LMTD 3.2511 K of 20 K: y = 0.00215, d_2 = 0.043 K:
    // the water goes back with 10.04 degC.
    assert!((bench.out("q_flow_w") + 19_506.7).abs() < 0.1);
    assert!((bench.out("t_tap_k") - 318.15).abs() < 1e-9 && bench.out("too_cold") == 0.0);
    assert!((bench.out("t_return_k") - 283.19).abs() < 0.01, "{}", bench.out("t_return_k"));
    // Water of 40 degC cannot: discomfort of 8 l times what is missing.
    bench.arrives_k = 313.15;
    bench.step(60.0);
    let tap_k = bench.out("t_tap_k");
    assert!(tap_k < 313.15 && tap_k > 312.0 && bench.out("too_cold") == 1.0, "{tap_k}");
    assert!((bench.out("dc_water_k_m3") - 8e-3 * (318.15 - tap_k)).abs() < 1e-9);
    assert_eq!(bench.out("drawn_m3"), 0.016);
}

#[test]
fn water_that_passes_is_mixed() {
    let mut bench = Bench::new(&driven(HeatedBy::Passing), 65.0);
    bench.signals[DRIVEN_M3_S] = 11.0 / 60_000.0;
    let exchange = bench.step(60.0);
    // 35/55 of 11 l/min are 7 l/min of hot water, replaced by cold.
    assert!((bench.port.m_flow_kg_s - 7.0 / 60.0).abs() < 1e-9);
    assert!((bench.port.t_out_k - 283.15).abs() < 1e-9 && exchange.electric_w == 10.0 * 0.0);
    assert!((bench.out("t_tap_k") - 318.15).abs() < 1e-9);
    bench.arrives_k = 308.15;
    bench.step(60.0);
    // All of it hot, and too cold by 10 K.
    assert!((bench.port.m_flow_kg_s - 11.0 / 60.0).abs() < 1e-9);
    assert!((bench.out("t_tap_k") - 308.15).abs() < 1e-9);
    assert!((bench.out("dc_water_k_m3") - 0.11).abs() < 1e-9);
}

#[test]
fn circulation_loses_heat_and_keeps_the_taps_warm() {
    for heated_by in [HeatedBy::Exchanger, HeatedBy::Passing] {
        let params = DomesticHotWaterParams { circulation_loss_w: 150.0, ..driven(heated_by) };
        let mut bench = Bench::new(&params, 60.0);
        let exchange = bench.step(900.0);
        assert!((bench.out("q_flow_w") + 150.0).abs() < 1e-9, "{heated_by:?}: {:?}", bench.out);
        assert_eq!(exchange.electric_w, 10.0);
        bench.signals[DRIVEN_M3_S] = 5.0 / 60_000.0;
        bench.step(900.0);
        let heat_w = 5.0 / 60.0 * CP * 35.0 + 150.0;
        assert!((bench.out("q_flow_w") + heat_w).abs() < 1e-6, "{heated_by:?}: {:?}", bench.out);
        assert!((bench.out("t_tap_k") - 318.15).abs() < 1e-9);
        bench.signals[CIRCULATION] = 0.0;
        bench.signals[DRIVEN_M3_S] = 0.0;
        assert_eq!(bench.step(900.0).electric_w, 0.0);
        assert_eq!(bench.out("q_flow_w"), 0.0);
    }
}

#[test]
fn random_draws_have_their_volume_and_steps_do_not_change_them() {
    let params =
        DomesticHotWaterParams { daily_m3: Some(0.3), ..DomesticHotWaterParams::default() };
    let mut sums = Vec::new();
    for dt_s in [10.0, 60.0, 900.0, 3600.0] {
        let mut bench = Bench::new(&params, 60.0);
        for _ in 0..(14.0 * DAY_S / dt_s) as usize {
            bench.step(dt_s);
            assert_eq!(bench.out("too_cold"), 0.0);
        }
        sums.push((bench.out("drawn_m3"), bench.out("taken_j")));
    }
    for (drawn_m3, taken_j) in &sums {
        assert!((drawn_m3 - sums[0].0).abs() < 1e-9, "{sums:?}");
        assert!((taken_j - sums[0].1).abs() < 1e-4 * sums[0].1, "{sums:?}");
    }
    // 14 days in February: 300 l, 10 % more.
    assert!((sums[0].0 / 14.0 - 0.33).abs() < 0.04, "{sums:?}");
}

#[test]
fn missing_heat_is_postponed() {
    let params =
        DomesticHotWaterParams { missing: MissingHeat::Postponed, ..driven(HeatedBy::Exchanger) };
    let mut bench = Bench::new(&params, 30.0);
    bench.signals[DRIVEN_M3_S] = 8.0 / 60_000.0;
    (0..5).for_each(|_| {
        bench.step(60.0);
    });
    let wanted_j = 5.0 * 60.0 * 19_506.667;
    let (got_j, postponed_j) = (bench.out("taken_j"), bench.out("postponed_j"));
    assert!((got_j + postponed_j - wanted_j).abs() < 1.0, "{got_j} {postponed_j} {wanted_j}");
    assert!(postponed_j > 0.3 * wanted_j);
    bench.signals[DRIVEN_M3_S] = 0.0;
    bench.arrives_k = 338.15;
    (0..5).for_each(|_| {
        bench.step(60.0);
    });
    assert!(bench.out("postponed_j") < 1.0, "{}", bench.out("postponed_j"));
    assert!((bench.out("taken_j") - wanted_j).abs() < 2.0);
}

#[test]
fn numbers_that_cannot_be() {
    let field = |params: DomesticHotWaterParams| {
        let error: UnitError = params.build(&Medium::default()).unwrap_err();
        error.field()
    };
    let ok = DomesticHotWaterParams::default;
    assert_eq!(field(DomesticHotWaterParams { daily_m3: Some(300.0), ..ok() }), Some("daily_m3"));
    assert_eq!(field(DomesticHotWaterParams { tap_set_k: 280.0, ..ok() }), Some("tap_set_k"));
    assert_eq!(field(DomesticHotWaterParams { tap_set_k: 45.0, ..ok() }), Some("tap_set_k"));
}
