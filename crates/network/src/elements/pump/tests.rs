//! Curves, modes and power of pumps, by hand.

use super::*;

fn state(speed: f64) -> EdgeState {
    EdgeState { position: speed, density_kg_m3: 1000.0, viscosity_pa_s: 1e-3 }
}

fn head(pump: &Pump, m: f64, speed: f64) -> f64 {
    -pump.curve.loss(m, speed, 1000.0).value
}

#[test]
fn published_quadratic_curve() {
    // a = 402.21/55.33^2 = 0.131381 hPa/(l/min)^2; at 10 l/min, u = 0.7:
    // 0.49 * 402.21 - 0.131381 * 100 = 183.9448 hPa
    let pump = PumpParams::default().build(&Medium::default()).unwrap();
    assert!((head(&pump, 10.0 / 60.0, 0.7) - 18_394.48).abs() < 0.02);
    assert!(head(&pump, 55.33 / 60.0, 1.0).abs() < 1e-9);
    // Reverse flow is resisted more than standing water.
    assert!(head(&pump, -0.1, 1.0) > head(&pump, 0.0, 1.0));
}

#[test]
fn affinity_laws() {
    let table = PumpParams {
        head_max_pa: None,
        free_flow_m3_s: None,
        curve_v_flow_m3_s: vec![0.0, 0.4 / 3600.0, 2.0 / 3600.0, 4.0 / 3600.0],
        curve_head_pa: vec![3.2536e5, 3.1654e5, 2.8224e5, 1.6856e5],
        ..PumpParams::default()
    };
    for params in [PumpParams::default(), table] {
        let pump = params.build(&Medium::default()).unwrap();
        let full = head(&pump, 0.3, 1.0);
        assert!((head(&pump, 0.15, 0.5) / (0.25 * full) - 1.0).abs() < 1e-12);
        let power = |m, u| pump.electric_power_w(m, &state(u)).unwrap();
        assert!((power(0.15, 0.5) / (0.125 * power(0.3, 1.0)) - 1.0).abs() < 1e-12);
        // P = V dp/0.49
        assert!((power(0.3, 1.0) / (3e-4 * full / 0.49) - 1.0).abs() < 1e-12);
        assert_eq!(power(0.1, 0.0), 0.0);
    }
}

#[test]
fn efficiency_follows_the_flow_and_the_losses_heat_the_water() {
    let params = PumpParams {
        efficiency_v_flow_m3_s: vec![0.0, 4e-4, 9e-4],
        efficiency: vec![0.0, 0.4, 0.2],
        standby_w: 3.0,
        heat_to_water: Some(1.0),
        ..PumpParams::default()
    };
    let pump = params.build(&Medium::default()).unwrap();
    // 0.4 l/s at full speed: H = 40221 - 4.72972e4 * 0.16 = 32653.4 Pa, V H = 13.06138 W,
    // P = 32.65344 W + 3 W; the water gets 32.65344 - 13.06138 = 19.59206 W.
    assert!((pump.electric_power_w(0.4, &state(1.0)).unwrap() - 35.65344).abs() < 1e-3);
    assert!((pump.heat_to_water_w(0.4, &state(1.0)) - 19.59206).abs() < 1e-3);
    // Half speed at half the flow has the same efficiency and an eighth of the power.
    let running = pump.electric_power_w(0.2, &state(0.5)).unwrap() - 3.0;
    assert!((running - 32.65344 / 8.0).abs() < 1e-3);
    // Off, or driven backwards, nothing but the standby power, and no heat.
    assert_eq!(pump.electric_power_w(0.2, &state(0.0)), Some(3.0));
    assert_eq!(pump.heat_to_water_w(-0.2, &state(1.0)), 0.0);
    // A dry motor, eta_m = 0.7 of 0.49: 0.7 P - V H = V H (0.7/0.49 - 1)
    let dry = PumpParams { heat_to_water: Some(0.7), ..PumpParams::default() };
    let dry = dry.build(&Medium::default()).unwrap();
    assert!((dry.heat_to_water_w(0.4, &state(1.0)) - 13.06138 * 0.428_571).abs() < 1e-3);
    let silent = PumpParams::default().build(&Medium::default()).unwrap();
    assert_eq!(silent.heat_to_water_w(0.4, &state(1.0)), 0.0);
    let params = PumpParams { efficiency: vec![70.0, 60.0, 50.0], ..params };
    assert_eq!(params.build(&Medium::default()).unwrap_err().field(), Some("efficiency"));
}

#[test]
fn awkward_tables_stay_strictly_monotone() {
    for heads in [[1000.0, 100.0, 90.0], [1000.0, 999.99, 500.0], [1000.0, 10.0, 9.999]] {
        let pump = PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_v_flow_m3_s: vec![0.0, 1e-4, 2e-4],
            curve_head_pa: heads.to_vec(),
            ..PumpParams::default()
        }
        .build(&Medium::default())
        .unwrap();
        let flows: Vec<f64> = (-300..=500).map(|i| f64::from(i) * 1e-3).collect();
        let law = |m| pump.curve.loss(m, 1.0, 1000.0);
        anergy_core::testing::check_monotone(law, &flows).unwrap();
    }
}

/// A pump with a table at 0, 0.1 and 0.2 l/s.
fn of_table(heads: [f64; 3]) -> Result<Pump, ElementError> {
    let params = PumpParams {
        head_max_pa: None,
        free_flow_m3_s: None,
        curve_v_flow_m3_s: vec![0.0, 1e-4, 2e-4],
        curve_head_pa: heads.to_vec(),
        ..PumpParams::default()
    };
    params.build(&Medium::default())
}

#[test]
fn a_curve_that_rises_a_little_is_repaired_and_says_so() {
    // The nearest falling heads to 100, 104: their mean 102 twice, but tilted by 0.1 % of 100 Pa
    // over 0.2 l/s, 0.05 Pa per point: 102.025 and 101.975. Farthest: 104 - 101.975 = 2.025 Pa.
    let pump = of_table([100.0, 104.0, 50.0]).unwrap();
    assert!((head(&pump, 0.0, 1.0) - 102.025).abs() < 1e-9);
    assert!((head(&pump, 0.1, 1.0) - 101.975).abs() < 1e-9);
    assert!((head(&pump, 0.2, 1.0) - 50.0).abs() < 1e-9);
    let note = pump.note().unwrap();
    assert!(note.contains("104 Pa at 1.0000e-4 m3/s follow 100 Pa"), "{note}");
    assert!(note.contains("at most 2 Pa (2.03 % of"), "{note}");
    assert_eq!(of_table([100.0, 90.0, 50.0]).unwrap().note(), None);
    // 100 and 130 become 115: 15 % are too much.
    let error = of_table([100.0, 130.0, 50.0]).unwrap_err().to_string();
    assert!(error.starts_with("curve_head_pa") && error.contains("15 Pa away"), "{error}");
}

fn of_polynomial(coefficients: &[f64], end: Option<f64>) -> Result<Pump, ElementError> {
    let params = PumpParams {
        head_max_pa: None,
        free_flow_m3_s: None,
        curve_polynomial: coefficients.to_vec(),
        curve_v_flow_max_m3_s: end,
        ..PumpParams::default()
    };
    params.build(&Medium::default())
}

#[test]
fn polynomials_end_where_their_head_does() {
    // H = 4e4 (1 - x - x^2 + x^3) with x = V/1 l/s: (1 - x)^2 (1 + x), zero at x = 1 only, twice;
    // with a linear term of -1.2 the zero is a simple one below 1.
    let scaled = |c: [f64; 4]| {
        let powers = c.iter().enumerate().map(|(i, c)| 4e4 * c * 1e3_f64.powi(i as i32));
        powers.collect::<Vec<f64>>()
    };
    let pump = of_polynomial(&scaled([1.0, -1.2, -1.0, 1.0]), None).unwrap();
    // x = 0.5: 1 - 0.6 - 0.25 + 0.125 = 0.275
    assert!((head(&pump, 0.5, 1.0) - 11_000.0).abs() < 1e-6);
    // Half speed, same x at 0.25 l/s: a quarter.
    assert!((head(&pump, 0.25, 0.5) - 2_750.0).abs() < 1e-6);
    let m_free = pump.curve.m_free_kg_s;
    let x = m_free;
    assert!((1.0 - 1.2 * x - x * x + x * x * x).abs() < 1e-12, "{x}");
    // No zero: the end must be given, and the curve goes on straight behind it.
    let open = scaled([1.0, -1.0, 0.5, 0.0]);
    let error = of_polynomial(&open, None).unwrap_err().to_string();
    assert!(error.contains("curve_v_flow_max_m3_s"), "{error}");
    let pump = of_polynomial(&open, Some(0.8e-3)).unwrap();
    // x = 0.8: 1 - 0.8 + 0.32 = 0.52, slope -0.2
    assert!((head(&pump, 0.8, 1.0) - 4e4 * 0.52).abs() < 1e-6);
    assert!((head(&pump, 0.9, 1.0) - 4e4 * 0.50).abs() < 1e-6);
    // Rising by up to 1 % before it falls: 1 + 0.2 x - x^2 has its top at x = 0.1.
    let pump = of_polynomial(&scaled([1.0, 0.2, -1.0, 0.0]), None).unwrap();
    assert!(pump.note().unwrap().contains("% of the head at zero flow"));
    assert!((head(&pump, 0.6, 1.0) - 4e4 * 0.76).abs() < 4e4 * 1e-5);
    let flows: Vec<f64> = (-300..=1500).map(|i| f64::from(i) * 1e-3).collect();
    anergy_core::testing::check_monotone(|m| pump.curve.loss(m, 1.0, 1000.0), &flows).unwrap();
}

#[test]
fn power_law_with_any_exponent() {
    // H0 40 kPa, free flow 1 l/s, n = 1.5: at 0.25 l/s 40 (1 - 0.125) = 35 kPa; at half speed and
    // 0.125 l/s a quarter of it; beyond the free flow with the slope -1.5 * 40 kPa s/l.
    let of = |exponent| {
        let params = PumpParams {
            head_max_pa: Some(4e4),
            free_flow_m3_s: Some(1e-3),
            curve_exponent: Some(exponent),
            ..PumpParams::default()
        };
        params.build(&Medium::default()).unwrap()
    };
    let pump = of(1.5);
    assert!((head(&pump, 0.25, 1.0) - 35_000.0).abs() < 1e-6);
    assert!((head(&pump, 0.125, 0.5) - 8_750.0).abs() < 1e-6);
    assert!((head(&pump, 1.1, 1.0) + 6_000.0).abs() < 1e-6);
    assert!((head(&pump, -0.25, 1.0) - 45_000.0).abs() < 1e-6);
    let quadratic =
        PumpParams { head_max_pa: Some(4e4), free_flow_m3_s: Some(1e-3), ..PumpParams::default() };
    assert_eq!(of(2.0), quadratic.build(&Medium::default()).unwrap());
}

#[test]
fn a_head_belongs_to_a_speed() {
    let table = of_table([100.0, 90.0, 50.0]).unwrap();
    for pump in [table, PumpParams::default().build(&Medium::default()).unwrap()] {
        for speed in [0.0, 0.02, 0.3, 0.99] {
            let dp = -head(&pump, 0.05, speed);
            let found = pump.speed_at(0.05, dp, 1000.0);
            assert!((found - speed).abs() < 1e-7, "{found} for {speed}");
        }
        assert_eq!(pump.speed_at(0.05, -1e9, 1000.0), 1.0);
        assert_eq!(pump.speed_at(0.05, 1e9, 1000.0), 0.0);
    }
}

/// The published pump in a mode, at full speed 402.21 hPa and 0.9222 kg/s.
fn in_mode(mode: PumpMode) -> Pump {
    PumpParams { mode, ..PumpParams::default() }.build(&Medium::default()).unwrap()
}

#[test]
fn a_flow_is_held_while_the_speed_allows_it() {
    let pump = in_mode(PumpMode::Flow);
    let set = state(0.4);
    let head = |m: f64| -pump.loss(m, &set).value;
    // Any head between rest (-4.72972e4 * 0.16 = -7567.5 Pa) and full speed (32653.5 Pa) belongs to
    // the set flow within 1e-4.
    assert!(head(0.4 * (1.0 - 1e-4)) > 30_000.0 && head(0.4 * (1.0 + 1e-4)) < -7_000.0);
    assert!(head(0.4).abs() < 1.0);
    // Away from it the pump is at full speed or at rest: at 0.3 kg/s 40221 - 4256.7 = 35964.3 Pa,
    // at 0.5 kg/s -11824.3 Pa.
    assert!((head(0.3) - 35_964.3).abs() < 0.1, "{}", head(0.3));
    assert!((head(0.5) + 11_824.3).abs() < 0.1, "{}", head(0.5));
    assert!((pump.speed(0.3, &set) - 1.0).abs() < 1e-6);
    assert!(pump.speed(0.5, &set) < 1e-3);
    // Half way, head 0 at 0.4 kg/s: u^2 H0 = 7567.5 Pa, u = 0.43377.
    assert!((pump.speed(0.4, &set) - 0.43377).abs() < 1e-4);
    // P = V H/0.49 at the head where the pump really is: 20 kPa belongs to 0.39998 kg/s.
    let m = 0.4 * (1.0 - 1e-4 * 20_000.0 / 40_221.0);
    assert!((pump.electric_power_w(m, &set).unwrap() - 4e-4 * 20_000.0 / 0.49).abs() < 0.01);
    // Off, it is at rest.
    assert_eq!(pump.loss(0.0, &state(0.0)).value, 0.0);
    assert_eq!(pump.loss(0.2, &state(0.0)), pump.curve.loss(0.2, 0.0, 1000.0));
}

#[test]
fn a_head_is_held_while_the_speed_allows_it() {
    let pump = in_mode(PumpMode::Head);
    let set = state(20_000.0);
    let head = |m: f64| -pump.loss(m, &set).value;
    // Droop 1e-3 * 20 kPa at 0.46108 kg/s: 20000 - 0.3/0.46108 * 20 = 19986.99 Pa
    assert!((head(0.3) - 19_986.99).abs() < 0.1, "{}", head(0.3));
    // u^2 H0 = 19986.99 + 4256.7 Pa: u = 0.77638
    assert!((pump.speed(0.3, &set) - 0.77638).abs() < 1e-4);
    // Full speed has 40221 - 4.72972e4 * 0.49 = 17045.4 Pa at 0.7 kg/s.
    assert!((head(0.7) - 17_045.4).abs() < 0.2, "{}", head(0.7));
    // Reverse flow: at rest it is resisted by 20 kPa at -0.65028 kg/s, so at -0.8 kg/s the pump
    // stands still, 30270.2 Pa.
    assert!((head(-0.8) - 30_270.2).abs() < 0.2, "{}", head(-0.8));
    assert!(pump.speed(-0.8, &set) < 1e-3);
    assert_eq!(pump.target_position(1e6), 40_221.0);
}

#[test]
fn set_values_of_another_mode_are_refused() {
    let params = PumpParams { mode: PumpMode::Flow, head_pa: Some(1e4), ..PumpParams::default() };
    let error = params.build(&Medium::default()).unwrap_err().to_string();
    assert_eq!(error, "head_pa given, but by its mode this pump holds m_flow_set_kg_s");
    let params =
        PumpParams { mode: PumpMode::Flow, m_flow_set_kg_s: Some(5.0), ..PumpParams::default() };
    assert_eq!(params.build(&Medium::default()).unwrap_err().field(), Some("m_flow_set_kg_s"));
}

#[test]
fn a_reversible_pump_is_its_own_mirror_image() {
    let pump = PumpParams { reversible: true, heat_to_water: Some(1.0), ..PumpParams::default() }
        .build(&Medium::default())
        .unwrap();
    // Forwards at half speed 10 055.25 Pa less 4.72972e4 * 0.09 = 4 256.7 Pa at 0.3 kg/s.
    assert!((pump.loss(0.3, &state(0.5)).value + 5_798.5).abs() < 0.1);
    for (m, speed) in [(0.3, 0.5), (0.0, 0.8), (-0.2, 0.6), (0.4, 0.02)] {
        let (ahead, back) = (state(speed), state(-speed));
        assert_eq!(pump.loss(-m, &back).value, -pump.loss(m, &ahead).value);
        assert_eq!(pump.loss(-m, &back).slope, pump.loss(m, &ahead).slope);
        assert_eq!(pump.electric_power_w(-m, &back), pump.electric_power_w(m, &ahead));
        assert_eq!(pump.heat_to_water_w(-m, &back), pump.heat_to_water_w(m, &ahead));
        // Against its sense of turning it is braked: no work.
        assert_eq!(pump.electric_power_w(m.abs(), &back), Some(0.0));
    }
    // The head is continuous through standstill.
    let near = |speed| pump.loss(0.1, &state(speed)).value;
    assert!((near(1e-6) - near(-1e-6)).abs() < 1e-6);
    assert_eq!(pump.target_position(-3.0), -1.0);
    let wrong = PumpParams { reversible: true, mode: PumpMode::Head, ..PumpParams::default() };
    assert!(
        wrong.build(&Medium::default()).unwrap_err().to_string().starts_with("reversible given")
    );
    let ahead_only = PumpParams { speed: -0.5, ..PumpParams::default() };
    assert_eq!(ahead_only.build(&Medium::default()).unwrap_err().field(), Some("speed"));
}
