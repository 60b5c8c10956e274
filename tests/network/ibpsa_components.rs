//! Single components against the reference results that Dymola computed with the IBPSA library.
//!
//! The laws are the same where they are turbulent. They differ near zero flow, where both are regularised
//! in their own way (the library over the pressure, `m(dp)`, here over the flow, `dp(m)`), and beyond the
//! data of pump curves. Each difference is stated where it is tested.

#![allow(clippy::unwrap_used)]

use anergy_core::medium::Medium;
use anergy_network::elements::ElementParams;
use anergy_network::elements::check_valve::CheckValveParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::elements::pump::PumpParams;
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::valve::{ValveCharacteristic, ValveParams};
use anergy_network::friction::Correlation;
use anergy_network::two_port::{Characteristic, EdgeState};
use anergy_tests::reference_data;

/// Density of the water of the library, kg/m3.
const DENSITY: f64 = 995.586;
/// Largest relative difference where the laws are the same.
const SAME: f64 = 0.01;

/// Largest difference of a pump curve at its knee relative to the head at zero flow: the slopes at the
/// points are harmonic means of the secants here, those of a monotone spline in the library.
const KNEE: f64 = 0.02;

/// A table of results, by the names of its columns; `None` without the data.
struct Results {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Results {
    fn read(name: &str) -> Option<Self> {
        let file = reference_data("ibpsa_component_ref")?.join(format!("Fluid_{name}.csv"));
        let text = std::fs::read_to_string(file).unwrap();
        let mut lines = text.lines();
        let names = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let rows: Vec<Vec<f64>> = lines.map(row).collect();
        assert_eq!(rows.len(), 101);
        Some(Self { names, rows })
    }

    /// The values of some columns, row by row.
    fn columns<const N: usize>(&self, names: [&str; N]) -> impl Iterator<Item = [f64; N]> {
        let places = names.map(|name| self.names.iter().position(|known| known == name).unwrap());
        self.rows.iter().map(move |row| places.map(|place| row[place]))
    }
}

fn medium() -> Medium {
    Medium { density_kg_m3: DENSITY, ..Medium::default() }
}

/// `p_a - p_b` at a flow and a position.
fn loss(params: &ElementParams, m_flow_kg_s: f64, position: f64) -> f64 {
    let element = params.build(&medium()).unwrap();
    let viscosity_pa_s = medium().viscosity_pa_s;
    let state = EdgeState { position, density_kg_m3: DENSITY, viscosity_pa_s };
    match element.characteristic(m_flow_kg_s, &state) {
        Characteristic::PressureLoss(loss) => loss.value,
        other => panic!("{other:?}"),
    }
}

/// Kv in m3/h of a flow at a pressure difference.
fn kv_m3_h(m_flow_kg_s: f64, dp_pa: f64) -> f64 {
    m_flow_kg_s / dp_pa.sqrt() * 3600.0 * 1e5_f64.sqrt() / (DENSITY * 1000.0).sqrt()
}

fn assert_same(what: &str, found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < SAME, "{what}: {found}, the library has {expected}");
}

#[test]
fn valve_characteristics() {
    let Some(results) = Results::read("Actuators_Valves_Examples_TwoWayValves") else { return };
    let of = |characteristic| {
        ElementParams::Valve(ValveParams {
            kvs_m3_h: kv_m3_h(2.0, 6e3),
            characteristic,
            rangeability: 10.0,
            leakage: 0.05,
            delta_m: 1e-6,
            ..ValveParams::default()
        })
    };
    // The coefficient from the loss at 2 kg/s: phi = sqrt(6 kPa/dp).
    let phi = |valve: &ElementParams, y: f64| (6e3 / loss(valve, 2.0, y)).sqrt();
    let linear = of(ValveCharacteristic::Linear);
    let quick = of(ValveCharacteristic::QuickOpening);
    let equal = of(ValveCharacteristic::EqualPercentage);
    let columns = ["time_s", "valLin.phi", "valQui.phi", "valEqu.phi"];
    for [y, in_linear, in_quick, in_equal] in results.columns(columns) {
        assert_same("linear", phi(&linear, y), in_linear);
        assert_same("quick opening", phi(&quick, y), in_quick);
        // The library's example has a foot of 0.1, blended up to 0.15; the foot here is 0.01.
        if y >= 0.15 {
            assert_same("equal percentage", phi(&equal, y), in_equal);
        }
    }
}

#[test]
fn check_valve() {
    let Some(results) = Results::read("FixedResistances_Examples_CheckValve") else { return };
    let valve = ElementParams::CheckValve(CheckValveParams {
        kvs_m3_h: kv_m3_h(2.0, 3600.0),
        leakage: 1e-3,
        m_flow_nominal_kg_s: 2.0,
        delta_m: 0.02,
    });
    for [dp, m, dp_driven, m_driven] in results.columns([
        "checkValve.dp",
        "checkValve.m_flow",
        "checkValve_m_flow.dp",
        "checkValve_m_flow.m_flow",
    ]) {
        for (dp, m) in [(dp, m), (dp_driven, m_driven)] {
            // Open, above the closing pressure of 1800 Pa.
            if dp >= 1800.0 {
                assert_same("open", loss(&valve, m, 0.0), dp);
            } else if dp > 1.0 {
                // Closing: the flap of the library needs a higher pressure for the same flow.
                assert!(loss(&valve, m, 0.0) < dp, "{m} kg/s");
            }
        }
        // Shut: at m_t = 0.04 kg/s the library's leak would become turbulent, at 14 bar; below it is laminar
        // and up to half of l k sqrt(dp), which is the leak here.
        if dp < -1e5 {
            let turbulent = 1e-3 * (2.0 / 60.0) * (-dp).sqrt();
            assert_same("shut", loss(&valve, -turbulent, 0.0), dp);
            assert!((0.3..0.6).contains(&(-m / turbulent)), "{m} of {turbulent} kg/s");
        }
    }
}

#[test]
fn resistance_with_a_nominal_point() {
    let Some(results) = Results::read("FixedResistances_Validation_PressureDropsParallel") else {
        return;
    };
    let resistance = ElementParams::Resistance(ResistanceParams {
        dp_nominal_pa: Some(10.0),
        m_flow_nominal_kg_s: Some(5.0),
        delta_m: 0.3,
        ..ResistanceParams::default()
    });
    for [time, m] in results.columns(["time_s", "res1.m_flow"]) {
        let dp = 20.0 * time - 10.0;
        let found = loss(&resistance, m, 0.0);
        // Regularised below 1.5 kg/s, 0.9 Pa, where the two polynomials are no inverses of each other.
        if m.abs() > 1.5 {
            assert_same("turbulent", found, dp);
        } else {
            assert!((found - dp).abs() < 0.1, "{found} Pa instead of {dp} Pa at {m} kg/s");
        }
    }
}

#[test]
fn pipe_with_a_friction_factor_of_its_nominal_velocity() {
    let Some(results) = Results::read("FixedResistances_Examples_HydraulicDiameter") else {
        return;
    };
    let columns = ["time_s", "res.m_flow", "res.dh", "resLarPip.m_flow", "resLarPip.dh"];
    for [time, m_small, d_small, m_large, d_large] in results.columns(columns) {
        let dp = 4000.0 * time - 2000.0;
        for (m, inner_diameter_m, length_m, velocity) in
            [(m_small, d_small, 1.0, 1.0), (m_large, d_large, 100.0, 0.15)]
        {
            let pipe = ElementParams::Pipe(PipeParams {
                // The library doubles the loss of the straight pipe for its fittings.
                length_m: 2.0 * length_m,
                inner_diameter_m,
                roughness_m: 2.5e-5,
                friction: Correlation::SwameeJain,
                fixed_velocity_m_s: Some(velocity),
                ..PipeParams::default()
            });
            // The flow is regularised at 0.05 and 0.9 kg/s there, at 30 % of the nominal one here.
            if dp.abs() > 200.0 {
                assert_same("pipe", loss(&pipe, m, 0.0), dp);
            }
        }
    }
}

fn table_pump(v_flow_m3_s: &[f64], head_pa: &[f64]) -> ElementParams {
    ElementParams::Pump(PumpParams {
        head_max_pa: None,
        free_flow_m3_s: None,
        curve_v_flow_m3_s: v_flow_m3_s.to_vec(),
        curve_head_pa: head_pa.to_vec(),
        ..PumpParams::default()
    })
}

#[test]
fn pump_with_a_catalogue_curve_slows_down() {
    let Some(results) = Results::read("Movers_Validation_Pump_stratos") else { return };
    // The first point of the catalogue, at 0.0085 l/s, is taken for that at zero flow.
    let v_flow = [0.0, 0.27449, 0.55583, 0.83708, 1.10292, 1.38657, 1.66762, 1.87198];
    let head = [34808.0, 34739.0, 34508.0, 32431.0, 29084.0, 24006.0, 18004.0, 13042.0];
    let pump = table_pump(&v_flow.map(|v| v * 1e-3), &head);
    let columns = ["gain.u", "floMacSta.dpMachine", "floMacSta.VMachine_flow"];
    for [speed, dp, v] in results.columns(columns) {
        // Below 5 % speed the curve becomes that of the impeller at rest.
        if speed >= 0.05 {
            assert_same("head", -loss(&pump, v * DENSITY, speed), dp);
        }
    }
}

#[test]
fn pump_curve_at_several_speeds() {
    let Some(results) = Results::read("Movers_Examples_SpeedControlled_y_pumpCurves") else {
        return;
    };
    // The library continues its points linearly to zero flow: 9500 Pa.
    let v_flow = [0.0, 0.2e-3, 0.4e-3, 0.6e-3, 0.8e-3];
    let pump = table_pump(&v_flow, &[9500.0, 9000.0, 8500.0, 6000.0, 2000.0]);
    let columns = ["time_s", "pum.dpMachine", "pum1.dpMachine", "pum2.dpMachine"];
    let mut compared = 0;
    for [time, heads @ ..] in results.columns(columns) {
        // The valve in series takes the whole head: m = 0.5 phi sqrt(dp/100).
        let opening = (1.0 - (time - 0.25) / 0.5 * 0.999).clamp(1e-3, 1.0);
        let phi = 1e-4 + (1.0 - 1e-4) * opening;
        for (speed, dp) in [1.0, 0.5, 0.05].into_iter().zip(heads) {
            let m = 0.5 * phi * (dp / 100.0).sqrt();
            // Beyond its last point the library goes on with the last secant, here with the end slope of
            // the curve, which is steeper.
            if m / DENSITY / speed > v_flow[4] {
                continue;
            }
            let difference = -loss(&pump, m, speed) - dp;
            let limit = KNEE * speed * speed * 9500.0;
            assert!(difference.abs() < limit, "{difference} Pa at {m} kg/s, speed {speed}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn pump_beside_one_that_stops() {
    let Some(results) = Results::read("Movers_Examples_PumpsParallel") else { return };
    let pump = table_pump(&[0.0, 1e-3], &[8000.0, 0.0]);
    let columns = ["time_s", "floMac1.m_flow", "floMac1.dp", "floMac2.m_flow", "floMac2.dp"];
    for [time, m_stopped, dp_stopped, m, dp] in results.columns(columns) {
        // After the start, which the library filters.
        if time > 100.0 {
            assert_same("running", loss(&pump, m, 1.0), dp);
        }
        // At rest the library's pump lets water back without loss; here it is an orifice of the curvature
        // of its curve, 8000 Pa (0.2/0.9956)^2 = 323 Pa.
        if time > 250.0 {
            assert!(dp_stopped.abs() < 1.0);
            assert!((loss(&pump, m_stopped, 0.0) + 321.0).abs() < 3.0);
        }
    }
}
