use super::*;
use crate::ground_source::CELLS;
use anergy_core::medium::Medium;

const CP: f64 = 4180.0;

/// Output by name after steps of `dt_s`, with water that arrives at one temperature.
struct Bench {
    unit: BrineHeatPump,
    state: Vec<f64>,
    out: Vec<f64>,
    signals: Vec<f64>,
    return_k: f64,
    port: PortFlow,
}

impl Bench {
    fn new(params: &BrineHeatPumpParams, return_degc: f64) -> Self {
        let unit = params.build(&Medium::default()).unwrap();
        let return_k = return_degc + 273.15;
        Self {
            state: unit.initial_state(return_k),
            out: vec![0.0; unit.outputs().len()],
            signals: unit.inputs().iter().map(|input| input.initial).collect(),
            port: PortFlow { m_flow_kg_s: 0.0, t_in_k: return_k, t_out_k: return_k },
            return_k,
            unit,
        }
    }

    fn step(&mut self, dt_s: f64) -> Exchange {
        let signals = Signals(&self.signals);
        self.unit.begin(dt_s, &mut self.state);
        let mut wanted = [PortRequest::default()];
        self.unit.request(&signals, &[self.port], &mut self.state, &mut wanted);
        let PortRequest { m_flow_kg_s, outlet } = wanted[0];
        let t_out_k = match outlet {
            anergy_core::port::Outlet::HeatFlow(q_w) if m_flow_kg_s > 0.0 => {
                self.return_k + q_w / (m_flow_kg_s * CP)
            }
            anergy_core::port::Outlet::Linear { constant_k, of_inlet } => {
                constant_k + of_inlet * self.return_k
            }
            _ => self.return_k,
        };
        self.port = PortFlow { m_flow_kg_s, t_in_k: self.return_k, t_out_k };
        self.unit.advance(dt_s, &signals, &[self.port], &mut self.state, &mut self.out)
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }
}

/// B0/W35: f_Q = 0.9636, f_P = 1.0029: 10 407 W (3.6 % below 10.8 kW) of 2304.5 W, COP 4.516.
#[test]
fn the_reference_point() {
    let params = BrineHeatPumpParams {
        modulation: 1.0,
        source: BrineSource::Given,
        ground_k: 273.15,
        dynamics: false,
        ..BrineHeatPumpParams::default()
    };
    let mut bench = Bench::new(&params, 30.0);
    bench.step(60.0);
    let heat_w = bench.out("q_flow_w");
    assert!((heat_w / 10_800.0 - 1.0).abs() < 0.04, "{heat_w}");
    assert!((heat_w - 10_406.9).abs() < 0.1 && (bench.out("cop") - 4.516).abs() < 1e-3);
    assert!((bench.port.t_out_k - 308.15).abs() < 1e-9);
    // What it takes from the brine: 10 406.9 - 0.95 * 2304.5 = 8217.6 W
    assert!((bench.out("ground_w") - 8217.6).abs() < 0.2, "{}", bench.out("ground_w"));
    // A unit of twice the size.
    let large = BrineHeatPumpParams { heat_nominal_w: 21_600.0, ..params };
    let mut bench = Bench::new(&large, 30.0);
    bench.step(60.0);
    assert!((bench.out("q_flow_w") / heat_w - 2.0).abs() < 1e-9);
}

#[test]
fn the_brine_gets_colder_while_heat_is_taken_and_recovers() {
    for dt_s in [60.0, 900.0, 3600.0] {
        let params = BrineHeatPumpParams { modulation: 1.0, ..BrineHeatPumpParams::default() };
        let mut bench = Bench::new(&params, 30.0);
        let mut brine_k = Vec::new();
        for hour in 0..24 * 20 {
            for _ in 0..(3600.0 / dt_s) as usize {
                bench.step(dt_s);
            }
            if hour % 24 == 23 {
                brine_k.push(bench.out("t_brine_k"));
            }
        }
        assert!(brine_k.windows(2).all(|days| days[1] < days[0]), "{brine_k:?}");
        // 7.8 kW (at -1.4 degC) of 200 m, 39 W/m: wall by E1 of 20 days, 39 * 6.44/(8 pi) = 10.0 K, 3.9 K to the
        // brine, +2.5 K: 10 - 10.0 - 3.9 + 2.5 = -1.4 degC
        let last = brine_k.last().unwrap() - 273.15;
        assert!((last + 1.4).abs() < 0.3, "{dt_s} s: {last}");
        let taken_j = bench.out("taken_j");
        assert!(taken_j > 0.0);
        bench.signals[MODULATION] = 0.0;
        (0..24 * 10).for_each(|_| {
            bench.step(3600.0);
        });
        let wall_k = bench.state[air_source_heat_pump::STATE_LEN..][..CELLS][0];
        assert!(wall_k > 280.15, "{wall_k}");
    }
}

#[test]
fn starts_in_300_s_and_counts() {
    let params = BrineHeatPumpParams { modulation: 1.0, ..BrineHeatPumpParams::default() };
    let mut bench = Bench::new(&params, 30.0);
    (0..299).for_each(|_| {
        bench.step(1.0);
    });
    assert_eq!(bench.out("phase"), 2.0);
    bench.step(1.0);
    bench.step(1.0);
    assert_eq!((bench.out("phase"), bench.out("starts")), (3.0, 1.0));
    bench.signals[MODULATION] = 0.0;
    (0..79).for_each(|_| {
        bench.step(1.0);
    });
    assert!(bench.port.m_flow_kg_s > 0.0);
    (0..3).for_each(|_| {
        bench.step(1.0);
    });
    assert_eq!(bench.port.m_flow_kg_s, 0.0);
}

#[test]
fn numbers_that_cannot_be() {
    let field = |params: BrineHeatPumpParams| params.build(&Medium::default()).unwrap_err().field();
    let ok = BrineHeatPumpParams::default;
    assert_eq!(field(BrineHeatPumpParams { ground_k: 10.0, ..ok() }), Some("ground_k"));
    assert_eq!(field(BrineHeatPumpParams { return_max_k: 70.0, ..ok() }), Some("return_max_k"));
    assert_eq!(field(BrineHeatPumpParams { length_m: 0.0, ..ok() }), Some("length_m"));
}
