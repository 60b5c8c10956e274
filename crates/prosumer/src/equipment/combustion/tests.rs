use super::boiler::CondensingBoilerParams;
use super::chp::{ChpParams, ChpSize};
use super::stirling::StirlingChpParams;
use super::*;

mod content;

const CP: f64 = 4180.0;

fn water() -> Medium {
    Medium::default()
}

/// A unit with water that always arrives at one temperature.
struct Bench {
    unit: Combustion,
    state: Vec<f64>,
    out: Vec<f64>,
    signals: Vec<f64>,
    return_k: f64,
    /// What others send through it while it wants nothing, kg/s; backward where negative.
    creeping_kg_s: f64,
    port: PortFlow,
    exchange: Exchange,
}

impl Bench {
    fn new(unit: Result<Combustion, UnitError>, return_degc: f64) -> Self {
        let unit = unit.unwrap();
        let return_k = return_degc + 273.15;
        Self {
            state: unit.initial_state(return_k),
            out: vec![0.0; unit.outputs().len()],
            signals: unit.inputs().iter().map(|input| input.initial).collect(),
            return_k,
            creeping_kg_s: 0.0,
            port: PortFlow { m_flow_kg_s: 0.0, t_in_k: return_k, t_out_k: return_k },
            exchange: Exchange::default(),
            unit,
        }
    }

    fn step(&mut self, dt_s: f64) {
        let signals = Signals(&self.signals);
        let before_j = self.unit.stored_j(&self.state);
        self.unit.begin(dt_s, &mut self.state);
        let mut wanted = [PortRequest::default()];
        self.unit.request(&signals, &[self.port], &mut self.state, &mut wanted);
        let PortRequest { m_flow_kg_s, outlet } = wanted[0];
        let m_flow_kg_s = if m_flow_kg_s > 0.0 { m_flow_kg_s } else { self.creeping_kg_s };
        let warmed_k = match outlet {
            _ if m_flow_kg_s == 0.0 => 0.0,
            Outlet::Exchange { w_k, other_k } => {
                let (constant_k, of_inlet) =
                    Outlet::of_exchange(w_k, other_k, m_flow_kg_s.abs() * CP);
                constant_k + (of_inlet - 1.0) * self.return_k
            }
            outlet => outlet.heat_flow_w().unwrap() / (m_flow_kg_s * CP),
        };
        self.port =
            PortFlow { m_flow_kg_s, t_in_k: self.return_k, t_out_k: self.return_k + warmed_k };
        self.exchange =
            self.unit.advance(dt_s, &signals, &[self.port], &mut self.state, &mut self.out);
        let left_w = self.exchange.electric_w + self.exchange.external_w - self.out("q_flow_w");
        let kept_w = (self.unit.stored_j(&self.state) - before_j) / dt_s;
        assert!((left_w - kept_w).abs() < 1e-6, "{left_w} W, {kept_w} W");
    }

    fn steps(&mut self, dt_s: f64, span_s: f64) {
        (0..(span_s / dt_s).round() as usize).for_each(|_| self.step(dt_s));
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }
}

use crate::thermal_unit::UnitError;

fn steady_boiler(modulation: f64, return_degc: f64) -> Bench {
    let params =
        CondensingBoilerParams { modulation, dynamics: false, ..CondensingBoilerParams::default() };
    let mut bench = Bench::new(params.build(&water()), return_degc);
    bench.step(60.0);
    bench
}

/// The check points of the fit: `1.05 (0.9618 + 0.0247 m - ...)`, for example at m = 0.2 and 25 degC (t = -1):
/// 1.05 (0.9618 + 0.00494 - 0.000292 - 0.0000608 + 0.0305 + 0.0039 - 0.0016) = 1.0492.
#[test]
fn efficiency_of_the_boiler() {
    for (m, points) in [
        (0.2, [(25.0, 1.049), (35.0, 1.015), (50.0, 0.978), (60.0, 0.964)]),
        (1.0, [(25.0, 1.048), (35.0, 1.020), (50.0, 0.994), (60.0, 0.987)]),
    ] {
        for (return_degc, efficiency) in points {
            let bench = steady_boiler(m, return_degc);
            let got = bench.out("efficiency");
            assert!((got - efficiency).abs() < 0.002, "{m} {return_degc}: {got}");
            // What is burnt and not delivered is lost.
            let lost_w = bench.out("fuel_w") + 35.0 - bench.out("q_flow_w");
            let fuel_w = bench.out("fuel_w");
            assert!((bench.exchange.external_w - (fuel_w - lost_w)).abs() < 1e-9);
        }
    }
    // Full load 18.3, 17.9 and 17.1 kW at 25, 35 and 70 degC; 6.1 kW at the smallest load.
    for (m, return_degc, kw) in
        [(1.0, 25.0, 18.3), (1.0, 35.0, 17.9), (1.0, 70.0, 17.1), (0.2, 35.0, 6.1)]
    {
        let got = steady_boiler(m, return_degc).out("q_flow_w");
        assert!((got / 1000.0 - kw).abs() < 0.06, "{m} {return_degc}: {got}");
    }
}

#[test]
fn metal_gives_back_what_the_return_has_left_in_it() {
    let params = |metal_capacity_j_k| CondensingBoilerParams {
        modulation: 1.0,
        dynamics: false,
        metal_capacity_j_k,
        flow_control: GeneratorFlow::ConstantFlow,
        ..CondensingBoilerParams::default()
    };
    let heat_j = |metal_capacity_j_k: f64, return_degc: f64| {
        let mut bench = Bench::new(params(metal_capacity_j_k).build(&water()), 45.0);
        bench.return_k = return_degc + 273.15;
        bench.steps(10.0, 1200.0);
        (bench.out("heat_j"), bench)
    };
    // 5 kJ/K, from 45 to 35 degC and to 50 degC: 50 kJ into the water, 25 kJ out of it; 20 l/min take 59 s for all but 1/e of it.
    for (return_degc, expected_j) in [(35.0, 50e3), (50.0, -25e3), (45.0, 0.0)] {
        let ((with, bench), (without, _)) = (heat_j(5000.0, return_degc), heat_j(0.0, return_degc));
        // The map takes the return of the step before: some joules.
        assert!((with - without - expected_j).abs() < 60.0, "{return_degc}: {}", with - without);
        assert!((bench.out("t_metal_k") - 273.15 - return_degc).abs() < 1e-3);
        // Fuel is that of the burner alone.
        assert!(
            (bench.out("efficiency") - heat_j(0.0, return_degc).1.out("efficiency")).abs() < 1e-6
        );
    }
    // In a pause it keeps its temperature.
    let mut idle = Bench::new(params(5000.0).build(&water()), 45.0);
    idle.signals[MODULATION] = 0.0;
    idle.return_k -= 20.0;
    idle.steps(10.0, 600.0);
    assert!((idle.out("t_metal_k") - 318.15).abs() < 1e-9 && idle.out("heat_j") == 0.0);
    // Water that creeps through it, a hundredth of what its pump had sent, leaves as warm as the metal, and empties it: in 10 min
    // 0.0033 kg/s 4180 J/(kg K) 600 s/(5000 J/K) = 1.655 time constants, of its 20 K (1 - 13.79/500)^60 = 0.187 are left. Backward too.
    for m_flow_kg_s in [0.0033, -0.0033] {
        let mut creeping = Bench::new(params(5000.0).build(&water()), 45.0);
        creeping.steps(10.0, 600.0);
        creeping.signals[MODULATION] = 0.0;
        creeping.creeping_kg_s = m_flow_kg_s;
        creeping.return_k -= 20.0;
        creeping.steps(10.0, 10.0);
        let warmest_k = creeping.port.t_out_k;
        assert!((317.5..318.2).contains(&warmest_k), "{warmest_k}");
        creeping.steps(10.0, 590.0);
        let left_k = creeping.out("t_metal_k") - creeping.return_k;
        assert!((left_k - 0.187 * 20.0).abs() < 0.4, "{left_k}");
    }
}

#[test]
fn sizes_scale_and_say_so() {
    let of = |nominal_w| CondensingBoilerParams {
        nominal_w,
        modulation: 1.0,
        dynamics: false,
        ..CondensingBoilerParams::default()
    };
    let mut large = Bench::new(of(50e3).build(&water()), 35.0);
    large.step(60.0);
    let small = steady_boiler(1.0, 35.0);
    assert!((large.out("q_flow_w") / small.out("q_flow_w") - 50.0 / 14.0).abs() < 1e-12);
    assert!(small.unit.remarks().is_empty() && !large.unit.remarks().is_empty());
    assert!(of(20e3).build(&water()).unwrap().remarks().is_empty());
}

/// The table of the start, by trapezoids: 291.06 s of steady heat within 300 s.
/// (0..9: 0.72, ..21: 3.9, ..33: 6.0, ..45: 5.46, ..57: 4.92, ..69: 5.76, ..93: 15.36, ..117: 20.04, ..141: 24.0,
/// ..165: 27.96, ..189: 29.04, ..213: 27.24, ..237: 25.92, ..273: 36.9, ..300: 27.0; together 260.22 s.)
#[test]
fn the_boiler_starts_in_300_s_and_cools_down_in_70_s() {
    for dt_s in [1.0, 20.0, 300.0] {
        let params =
            CondensingBoilerParams { modulation: 1.0, ..CondensingBoilerParams::default() };
        let mut bench = Bench::new(params.build(&water()), 35.0);
        bench.steps(dt_s, 300.0);
        let steady_w = steady_boiler(1.0, 35.0).out("q_flow_w");
        let heat_s = bench.out("heat_j") / steady_w;
        assert!((heat_s - 260.22).abs() < 0.01, "{dt_s} s: {heat_s} s");
        let fuel_s = bench.out("fuel_j") / steady_boiler(1.0, 35.0).out("fuel_w");
        assert!((fuel_s - 300.0).abs() < 1e-9, "gas burns at the steady rate: {fuel_s} s");
        bench.steps(1.0, 1.0);
        assert!((bench.out("q_flow_w") / steady_w - 1.0).abs() < 1e-12);
        assert_eq!(bench.out("phase"), 3.0);
        // 2 + 0.985 + 1.76 + 1.89 + 0.81 + 1.275 + 0.675 + 0.75 + 1 = 11.145 s of steady heat, no gas.
        let (heat_j, fuel_j) = (bench.out("heat_j"), bench.out("fuel_j"));
        bench.signals[MODULATION] = 0.0;
        bench.steps(1.0, 70.0);
        assert!(((bench.out("heat_j") - heat_j) / steady_w - 11.145).abs() < 1e-6);
        assert!(bench.port.m_flow_kg_s > 0.0 && bench.out("fuel_j") == fuel_j);
        bench.steps(1.0, 1.0);
        assert!(bench.port.m_flow_kg_s == 0.0 && bench.out("phase") == 0.0);
        assert_eq!(bench.out("starts"), 1.0);
    }
}

#[test]
fn ways_to_set_the_flow() {
    let of = |flow_control, modulation| {
        let params = CondensingBoilerParams {
            flow_control,
            modulation,
            dynamics: false,
            ..CondensingBoilerParams::default()
        };
        let mut bench = Bench::new(params.build(&water()), 40.0);
        bench.step(60.0);
        bench.port
    };
    for modulation in [0.2, 0.6, 1.0] {
        let port = of(GeneratorFlow::ConstantTemperatureDifference, modulation);
        assert!((port.t_out_k - port.t_in_k - 20.0).abs() < 1e-9);
        let port = of(GeneratorFlow::ConstantSupply, modulation);
        assert!((port.t_out_k - 333.15).abs() < 1e-9);
        let port = of(GeneratorFlow::ConstantFlow, modulation);
        assert!((port.m_flow_kg_s - 1.0 / 3.0).abs() < 1e-3, "20 l/min: {port:?}");
    }
    // m = 0.2, t = 0.5: 0.6862 + 0.05306 + 0.017136 - 0.0034016 - 0.03405 + 0.00235 - 0.00038 = 0.72091: 14.42 K
    let port = of(GeneratorFlow::MeasuredTemperatureDifference, 0.2);
    assert!((port.t_out_k - port.t_in_k - 14.418).abs() < 1e-2, "{port:?}");
}

#[test]
fn the_boiler_holds_its_supply_and_its_limits() {
    let params = CondensingBoilerParams {
        modulation: 1.0,
        command: GeneratorCommand::SupplyTemperature,
        flow_control: GeneratorFlow::ConstantFlow,
        dynamics: false,
        ..CondensingBoilerParams::default()
    };
    // 20 l/min from 52 to 60 degC are 1/3 * 4180 * 8 = 11.1 kW, within 6.1 to 17.9 kW.
    let mut bench = Bench::new(params.build(&water()), 52.0);
    bench.step(60.0);
    assert!((bench.port.t_out_k - 333.15).abs() < 1e-6, "{:?}", bench.port);
    // From 58 degC the smallest load overshoots by 2.4 K while it runs; from 62 degC by 6.3 K: it stops.
    bench.return_k = 331.15;
    bench.steps(60.0, 120.0);
    assert!(bench.out("load") == 0.2 && bench.port.t_out_k < 333.15 + 2.5);
    bench.return_k = 335.15;
    bench.steps(60.0, 120.0);
    assert_eq!(bench.out("load"), 0.0);
    // It starts again where the smallest load does not overshoot.
    bench.return_k = 331.15;
    bench.steps(60.0, 120.0);
    assert_eq!(bench.out("load"), 0.0);
    bench.return_k = 327.15;
    bench.steps(60.0, 120.0);
    assert!(bench.out("load") > 0.2);
    // Water that arrives above 75 degC stops it, and below 70 degC it may start again.
    let mut bench = steady_boiler(1.0, 50.0);
    for (return_degc, tripped) in [(76.0, 1.0), (72.0, 1.0), (60.0, 0.0)] {
        bench.return_k = return_degc + 273.15;
        bench.steps(60.0, 180.0);
        assert_eq!(bench.out("tripped"), tripped, "{return_degc}");
    }
    // The supply: 68 + 20 degC is above 83 degC.
    bench.return_k = 341.15;
    bench.steps(60.0, 120.0);
    assert_eq!(bench.out("tripped"), 1.0);
}

#[test]
fn a_table_replaces_the_map() {
    let degc = |t: f64| t + 273.15;
    let params = CondensingBoilerParams {
        modulation: 1.0,
        dynamics: false,
        table_return_k: [30.0, 40.0, 50.0, 60.0, 70.0].map(degc).into(),
        table_efficiency: vec![1.05, 1.03, 1.00, 0.98, 0.98],
        table_heat_max_w: vec![17_360.0, 16_520.0, 15_890.0, 15_680.0, 14_420.0],
        table_heat_min_w: vec![3080.0, 3000.0, 2800.0, 2660.0, 2660.0],
        ..CondensingBoilerParams::default()
    };
    // Halfway from 40 to 50 degC: 16 205 W of 1.015; at 60 %: (2900 + 0.5 * 13 305) = 9552.5 W
    let mut bench = Bench::new(params.build(&water()), 45.0);
    bench.step(60.0);
    assert!((bench.out("q_flow_w") - 16_205.0).abs() < 1e-6);
    assert!((bench.out("efficiency") - 1.015).abs() < 1e-9);
    bench.signals[MODULATION] = 0.6;
    bench.step(60.0);
    assert!((bench.out("q_flow_w") - 9552.5).abs() < 1e-6);
    // On or off only: full load.
    let on_off = CondensingBoilerParams { modulation_min: 1.0, ..params.clone() };
    let mut bench = Bench::new(on_off.build(&water()), 45.0);
    bench.step(60.0);
    assert!((bench.out("q_flow_w") - 16_205.0).abs() < 1e-6);
    let short = CondensingBoilerParams { table_efficiency: vec![1.0], ..params.clone() };
    assert_eq!(short.build(&water()).unwrap_err().field(), Some("table_efficiency"));
    let percent = CondensingBoilerParams { table_efficiency: vec![97.0; 5], ..params };
    assert_eq!(percent.build(&water()).unwrap_err().field(), Some("table_efficiency"));
    let alone = CondensingBoilerParams {
        table_efficiency: vec![0.97],
        ..CondensingBoilerParams::default()
    };
    assert!(alone.build(&water()).is_err(), "a table without its temperatures is not ignored");
}

/// Full load and 35 degC: fuel 1900/0.24 = 7917 W, total 0.8608 + 0.0057 = 0.8665, heat 7917 * 0.6265 = 4960 W.
#[test]
fn the_engine_in_steady_operation() {
    let of = |params: ChpParams, return_degc| {
        let params = ChpParams { dynamics: false, ..params };
        let mut bench = Bench::new(params.build(&water()), return_degc);
        bench.step(60.0);
        bench
    };
    let full = ChpParams { modulation: 1.0, ..ChpParams::default() };
    let bench = of(full.clone(), 35.0);
    assert!((bench.out("fuel_w") - 7917.0).abs() < 1.0);
    assert!((bench.out("q_flow_w") - 4960.0).abs() < 1.0);
    assert_eq!(bench.out("electric_w"), -1900.0);
    assert!((bench.port.t_out_k - 353.15).abs() < 1e-9, "supply of 80 degC");
    for (m, return_degc, total) in
        [(0.55, 25.0, 0.954), (1.0, 25.0, 0.945), (0.55, 70.0, 0.689), (1.0, 70.0, 0.732)]
    {
        let got = of(ChpParams { modulation: m, ..full.clone() }, return_degc).out("efficiency");
        assert!((got - total).abs() < 0.001, "{m} {return_degc}: {got}");
    }
    // A smaller command is the smallest load: 0.55 * 1900/0.18.
    let least = of(ChpParams { modulation: 0.1, ..full.clone() }, 35.0);
    assert!((least.out("fuel_w") - 0.55 * 1900.0 / 0.18).abs() < 1e-6);
    // Ratings of the larger ones: 11.9 and 34 kW of heat.
    for (size, electric_w, heat_w) in
        [(ChpSize::Kw5, 5000.0, 11_900.0), (ChpSize::Kw18, 18_000.0, 34_000.0)]
    {
        let bench = of(ChpParams { size, ..full.clone() }, 35.0);
        assert_eq!(bench.out("electric_w"), -electric_w);
        assert!((bench.out("q_flow_w") / heat_w - 1.0).abs() < 0.03, "{}", bench.out("q_flow_w"));
    }
}

#[test]
fn the_engine_gives_no_heat_for_twelve_minutes() {
    for dt_s in [1.0, 12.0, 120.0] {
        let params = ChpParams { modulation: 1.0, ..ChpParams::default() };
        let mut bench = Bench::new(params.build(&water()), 35.0);
        bench.steps(dt_s, 720.0);
        assert!(bench.out("heat_j") == 0.0 && bench.port.m_flow_kg_s == 0.0, "{dt_s} s");
        assert!(bench.out("generated_j") > 0.0 && bench.out("electric_j") < 0.0);
    }
    let params = ChpParams { modulation: 1.0, ..ChpParams::default() };
    let mut bench = Bench::new(params.build(&water()), 35.0);
    bench.steps(1.0, 737.0);
    let published_k = bench.port.t_out_k - 273.15;
    assert!((published_k - 63.0).abs() < 1.0, "{published_k}");
    bench.steps(1.0, 88.0);
    assert_eq!(bench.out("phase"), 3.0, "started after 825 s");
    bench.steps(1.0, 1.0);
    // Still warming up: 1000 (1 - 825.5/2400) = 656 W less than 4960 W; 80 degC already.
    assert!((bench.out("q_flow_w") - (4960.0 - 656.0)).abs() < 2.0, "{}", bench.out("q_flow_w"));
    assert!((bench.port.t_out_k - 353.15).abs() < 1e-9);
    bench.steps(60.0, 1620.0);
    assert!((bench.out("q_flow_w") - 4960.0).abs() < 1.0);
    // The stop takes 84 s; the generator stops within 5 s and then draws 95 W.
    let electric_j = bench.out("electric_j");
    bench.signals[MODULATION] = 0.0;
    bench.steps(1.0, 5.0);
    // 5 s of the mean of 1900 and -95 W.
    assert!((bench.out("electric_j") - electric_j + 5.0 * 902.5).abs() < 1e-6 + 5.0 * 35.0);
    bench.steps(1.0, 37.0);
    assert!((bench.port.t_out_k - 353.15).abs() < 1e-9 && bench.out("fuel_w") == 0.0);
    assert!((bench.out("electric_w") - 95.0 - 35.0).abs() < 1e-9);
    bench.steps(1.0, 41.0);
    assert!(bench.port.m_flow_kg_s > 0.0);
    bench.steps(1.0, 2.0);
    assert!(bench.port.m_flow_kg_s == 0.0 && bench.out("phase") == 0.0);
    // Warm: 200 s.
    bench.signals[MODULATION] = 1.0;
    bench.steps(1.0, 199.0);
    assert_eq!(bench.out("phase"), 2.0);
    bench.steps(1.0, 2.0);
    assert_eq!((bench.out("phase"), bench.out("starts")), (3.0, 2.0));
}

/// 1000/0.13 = 7692 W of gas; at 30 degC 0.93: heat 7692 * 0.80 = 6154 W.
#[test]
fn the_stirling_engine_and_its_boiler() {
    let params = StirlingChpParams { modulation: 1.0, ..StirlingChpParams::default() };
    let mut bench = Bench::new(params.build(&water()), 30.0);
    bench.steps(10.0, 60.0);
    assert!(bench.out("heat_j") == 0.0 && bench.out("electric_w") == 100.0);
    bench.steps(10.0, 540.0);
    assert_eq!(bench.out("phase"), 3.0, "slow start of 600 s");
    bench.step(10.0);
    assert!((bench.out("q_flow_w") - 6153.8).abs() < 0.1, "{}", bench.out("q_flow_w"));
    assert_eq!(bench.out("electric_w"), -1000.0);
    bench.signals[AUX] = 1.0;
    bench.signals[ROD] = 0.5;
    bench.steps(60.0, 600.0);
    let aux = CondensingBoilerParams::default();
    let mut boiler = Bench::new(
        CondensingBoilerParams { nominal_w: 20e3, modulation: 1.0, dynamics: false, ..aux }
            .build(&water()),
        30.0,
    );
    boiler.step(60.0);
    let expected_w = 6153.8 + boiler.out("q_flow_w") + 3000.0;
    assert!((bench.out("q_flow_w") - expected_w).abs() < 0.1);
    assert!((bench.out("electric_w") - 2000.0).abs() < 1e-9);
    assert!((bench.port.t_out_k - bench.port.t_in_k - 20.0).abs() < 1e-9);
    assert!((bench.out("aux_w") - boiler.out("q_flow_w")).abs() < 1e-6);
}

#[test]
fn numbers_that_cannot_be() {
    let wrong = CondensingBoilerParams {
        command: GeneratorCommand::SupplyTemperature,
        ..CondensingBoilerParams::default()
    };
    assert!(wrong.build(&water()).unwrap_err().to_string().contains("constant_flow"));
    let wrong = ChpParams { total_efficiency: Some(0.2), ..ChpParams::default() };
    assert_eq!(wrong.build(&water()).unwrap_err().field(), Some("total_efficiency"));
    let wrong =
        CondensingBoilerParams { stop_times_s: vec![1.0], ..CondensingBoilerParams::default() };
    assert!(wrong.build(&water()).is_err());
}
