use super::*;

const CP: f64 = 4180.0;

/// A collector that gets an irradiance at a right angle: the sun in the south, 55 deg up, nothing diffuse, no ground.
struct Bench {
    unit: SolarCollector,
    state: Vec<f64>,
    out: [f64; 12],
    back_k: f64,
    port: PortFlow,
}

impl Bench {
    fn new(params: &SolarCollectorParams, back_degc: f64) -> Self {
        let params = SolarCollectorParams {
            albedo: 0.0,
            sky: crate::equipment::pv::SkyModel::Isotropic,
            ..params.clone()
        };
        let unit = params.build(&Medium::default()).unwrap();
        let back_k = back_degc + 273.15;
        Self {
            state: unit.initial_state(back_k),
            out: [0.0; 12],
            port: PortFlow { m_flow_kg_s: 0.0, t_in_k: back_k, t_out_k: back_k },
            unit,
            back_k,
        }
    }

    fn step(&mut self, dt_s: f64, beam_w_m2: f64) {
        let elevation = 55.0_f64.to_radians();
        let signals = [293.15, beam_w_m2 * elevation.sin(), beam_w_m2, 0.0, elevation, 0.0, 1.0];
        let signals = Signals(&signals);
        self.port.t_in_k = self.back_k;
        let before_j = self.unit.stored_j(&self.state);
        self.unit.begin(dt_s, &mut self.state);
        let mut wanted = [PortRequest::default()];
        self.unit.request(&signals, &[self.port], &mut self.state, &mut wanted);
        let t_out_k = match wanted[0].outlet {
            Outlet::Linear { constant_k, of_inlet } => {
                assert!((0.0..=1.0).contains(&of_inlet));
                constant_k + of_inlet * self.back_k
            }
            _ => self.back_k,
        };
        let m_flow_kg_s = wanted[0].m_flow_kg_s;
        self.port = PortFlow { m_flow_kg_s, t_in_k: self.back_k, t_out_k };
        let exchange =
            self.unit.advance(dt_s, &signals, &[self.port], &mut self.state, &mut self.out);
        let water_w = m_flow_kg_s * CP * (t_out_k - self.back_k);
        let left_j = self.unit.stored_j(&self.state)
            - before_j
            - dt_s * (exchange.electric_w + exchange.external_w - water_w);
        assert!(left_j.abs() < 1e-6 * (1.0 + before_j.abs()), "{left_j}");
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }
}

/// `eta = eta0 - (a1 x + a2 x^2)/G` at the mean temperature of collector and water, x above the air.
#[test]
fn points_of_the_efficiency_curve() {
    for (collector, [eta0, a1, a2]) in [
        (CollectorType::FlatPlate, [0.78, 3.6, 0.014]),
        (CollectorType::Cpc, [0.642, 0.885, 0.001]),
    ] {
        for (back_degc, irradiance) in [(20.0, 1000.0), (40.0, 800.0), (60.0, 1000.0)] {
            let params = SolarCollectorParams { collector, ..SolarCollectorParams::default() };
            let mut bench = Bench::new(&params, back_degc);
            // Hot enough that the pump starts.
            bench.state[..CELLS].fill(back_degc + 10.0 + 273.15);
            (0..200).for_each(|_| bench.step(60.0, irradiance));
            let mean_k = 0.5 * (bench.port.t_in_k + bench.port.t_out_k) - 293.15;
            let expected = eta0 - (a1 * mean_k + a2 * mean_k * mean_k) / irradiance;
            let got = bench.out("efficiency");
            // The cells are a little warmer than the mean of inlet and outlet.
            assert!((got - expected).abs() < 0.01, "{collector:?} {back_degc}: {got} {expected}");
            assert_eq!(bench.out("pump"), 1.0);
        }
    }
}

/// At 1000 W/m2: 780 = 3.6 x + 0.014 x^2, x = (-3.6 + sqrt(12.96 + 43.68))/0.028 = 140.2 K above the air.
#[test]
fn it_stagnates_where_the_storage_is_full_and_rests_until_it_is_cooler() {
    for dt_s in [10.0, 60.0, 900.0] {
        let mut bench = Bench::new(&SolarCollectorParams::default(), 86.0);
        (0..(14_400.0 / dt_s) as usize).for_each(|_| bench.step(dt_s, 1000.0));
        assert!((bench.out("t_collector_k") - 293.15 - 140.2).abs() < 0.5, "{:?}", bench.out);
        assert!(bench.out("pump") == 0.0 && bench.out("stagnates") == 1.0);
        // The storage has room again, but the collector is too hot for it.
        bench.back_k = 313.15;
        bench.step(dt_s, 1000.0);
        assert_eq!(bench.out("pump"), 0.0);
        (0..(7200.0 / dt_s) as usize).for_each(|_| bench.step(dt_s, 200.0));
        assert!(bench.out("pump") == 1.0 || bench.out("starts") >= 1.0, "{dt_s}: {:?}", bench.out);
    }
}

#[test]
fn the_pump_by_differences() {
    let mut bench = Bench::new(&SolarCollectorParams::default(), 30.0);
    let set = |bench: &mut Bench, above_k: f64| bench.state[..CELLS].fill(303.15 + above_k);
    for (above_k, share) in [(2.5, 0.0), (3.5, 0.125), (5.0, 0.5), (7.0, 1.0), (20.0, 1.0)] {
        set(&mut bench, above_k);
        bench.step(1.0, 0.0);
        let got = bench.port.m_flow_kg_s / (20.0 / 60.0);
        assert!((got - share).abs() < 0.01, "{above_k} K: {got}");
    }
    // Once it runs it goes on to 2 K, with the least flow.
    set(&mut bench, 2.5);
    bench.step(1.0, 0.0);
    assert!((bench.port.m_flow_kg_s * 60.0 - 2.0).abs() < 0.01, "{:?}", bench.port);
    set(&mut bench, 1.9);
    bench.step(1.0, 0.0);
    assert_eq!(bench.port.m_flow_kg_s, 0.0);
    assert_eq!(bench.out("starts"), 1.0);
}

#[test]
fn a_sunrise_within_a_long_step_does_not_boil() {
    for back_degc in [30.0, 60.0, 80.0] {
        let mut bench = Bench::new(&SolarCollectorParams::default(), back_degc);
        bench.state[..CELLS].fill(back_degc + 3.2 + 273.15);
        bench.step(3600.0, 1000.0);
        assert!(bench.port.m_flow_kg_s > 0.0 && bench.port.t_out_k < 368.15, "{:?}", bench.port);
    }
}

#[test]
fn the_supply_is_held() {
    let params = SolarCollectorParams {
        flow_control: CollectorFlow::Supply,
        ..SolarCollectorParams::default()
    };
    for (back_degc, set_degc) in [(30.0, 60.0), (62.0, 80.0)] {
        let mut bench = Bench::new(&params, back_degc);
        bench.state[..CELLS].fill(set_degc + 273.15);
        (0..300).for_each(|_| bench.step(60.0, 900.0));
        let supply_degc = bench.port.t_out_k - 273.15;
        assert!((supply_degc - set_degc).abs() < 1.5, "{back_degc}: {supply_degc}");
    }
}

#[test]
fn numbers_that_cannot_be() {
    let wrong = SolarCollectorParams { start_difference_k: 1.0, ..SolarCollectorParams::default() };
    assert_eq!(wrong.build(&Medium::default()).unwrap_err().field(), Some("start_difference_k"));
}
