use super::*;

fn burner(start_s: f64) -> Burner {
    Burner {
        modulation_min: 0.2,
        slew_per_s: 0.025,
        starts_full: false,
        start: vec![
            TablePoint::new([0.0, 0.0, 0.0, -0.1, 0.0]),
            TablePoint::new([0.4 * start_s, 0.5, 1.2, 0.0, 1.0]),
            TablePoint::new([start_s, 1.0, 1.0, 1.0, 1.0]),
        ],
        stop: vec![
            TablePoint::new([0.0, 1.0, 0.0, 1.0, 1.0]),
            TablePoint::new([20.0, 0.5, 0.0, 0.0, 1.0]),
            TablePoint::new([60.0, 0.0, 0.0, 0.0, 1.0]),
        ],
        warm_within_s: 600.0,
        warm_scale: 0.5,
        warm_up: WarmUp { heat_w: 1000.0, lasts_s: 500.0, cold_after_s: 1000.0 },
        run_min_s: 0.0,
        off_min_s: 0.0,
        dynamics: true,
    }
}

/// A cubic map: Gauss' rule must meet it exactly while the load changes.
fn steady(m: f64) -> Steady {
    Steady { heat_w: 5000.0 * (1.0 + m * m * m), fuel_w: 10_000.0 * m, power_w: 1000.0 * m }
}

const ON: Command = Command { modulation: 0.9, tripped: false };
const OFF: Command = Command { modulation: 0.0, tripped: false };

/// Heat, fuel, electricity and flow-weighted heat of a run of some time and a stop, J, in steps of `dt_s`.
fn sums(burner: &Burner, dt_s: f64) -> [f64; 4] {
    let (mut state, mut sums) = (BurnerState::new(), [0.0; 4]);
    for (command, span_s) in
        [(ON, 1800.0), (Command { modulation: 0.3, ..ON }, 900.0), (OFF, 900.0)]
    {
        for _ in 0..(span_s / dt_s).round() as usize {
            let means = burner.run(dt_s, &command, &mut state, steady);
            let of_step = [means.heat_w, means.fuel_w, means.power_w, means.flow_heat_w];
            sums.iter_mut().zip(of_step).for_each(|(sum, mean)| *sum += dt_s * mean);
        }
    }
    assert_eq!((state.phase, state.starts), (Phase::Off, 1.0));
    assert!((state.operating_s - 2700.0).abs() < 1e-6);
    sums
}

#[test]
fn means_do_not_depend_on_the_steps() {
    let burner = burner(300.0);
    let once = sums(&burner, 900.0);
    for dt_s in [1.0, 7.5, 60.0, 450.0] {
        let often = sums(&burner, dt_s);
        for (once, often) in once.iter().zip(&often) {
            assert!((once - often).abs() < 1e-9 * once.abs(), "{dt_s} s: {once} {often}");
        }
    }
}

#[test]
fn a_start_by_hand() {
    let mut burner = burner(100.0);
    burner.warm_up = WarmUp::default();
    let mut state = BurnerState::new();
    let command = Command { modulation: 0.9, ..ON };
    let means = burner.run(100.0, &command, &mut state, steady);
    // At once at load 0.9: 40 s up to 0.5, 60 s from 0.5 to 1: (10 + 45) s of 5000 * 1.729 = 8645 W.
    assert!((means.heat_w * 100.0 - 55.0 * 8645.0).abs() < 1e-6, "{means:?}");
    // Fuel: 0.6 * 40 + 1.1 * 60 = 90 s of 9000 W; electricity: -0.05 * 40 + 0.5 * 60 = 28 s of 900 W.
    assert!((means.fuel_w * 100.0 - 90.0 * 9000.0).abs() < 1e-6);
    assert!((means.power_w * 100.0 - 28.0 * 900.0).abs() < 1e-6);
    assert_eq!(state.phase, Phase::Running);
    // The stop: 15 s + 10 s of 8645 W.
    let means = burner.run(60.0, &OFF, &mut state, steady);
    assert!((means.heat_w * 60.0 - 25.0 * 8645.0).abs() < 1e-6, "{means:?}");
    assert!(means.fuel_w == 0.0 && state.phase == Phase::Off);
    // Within 600 s the start takes half of the time.
    burner.run(50.0, &command, &mut state, steady);
    assert_eq!((state.phase, state.starts), (Phase::Running, 2.0));
}

#[test]
fn a_cold_engine_keeps_heat_for_itself() {
    let mut burner = burner(100.0);
    burner.start.truncate(0);
    // Never on: cold. 1000 W falling to nothing in 500 s: 250 kJ are missing.
    let mut state = BurnerState::new();
    let means = burner.run(1000.0, &ON, &mut state, steady);
    assert!((means.heat_w * 1000.0 - (8645.0e3 - 250.0e3)).abs() < 1e-3, "{means:?}");
    // 500 s off are half: 500 W falling in 250 s, 62.5 kJ.
    burner.run(500.0, &OFF, &mut state, steady);
    let means = burner.run(1000.0, &ON, &mut state, steady);
    assert!((means.heat_w * 1000.0 - (8645.0e3 - 62.5e3)).abs() < 1e-3, "{means:?}");
}

#[test]
fn limits_and_least_times() {
    let mut burner = burner(100.0);
    (burner.run_min_s, burner.off_min_s) = (300.0, 600.0);
    let mut state = BurnerState::new();
    burner.run(60.0, &ON, &mut state, steady);
    // It runs on to its least time...
    let means = burner.run(300.0, &OFF, &mut state, steady);
    assert!((means.on - 240.0 / 300.0).abs() < 1e-12, "{means:?}");
    // ... and rests: 60 s so far, 540 s more.
    let means = burner.run(600.0, &ON, &mut state, steady);
    assert!((means.on - 60.0 / 600.0).abs() < 1e-12, "{means:?}");
    // A limit does not wait.
    let tripped = Command { tripped: true, ..ON };
    assert!(burner.run(60.0, &tripped, &mut state, steady).on == 0.0);
    // The smallest load.
    let mut state = BurnerState::new();
    burner.run(900.0, &Command { modulation: 0.01, ..ON }, &mut state, steady);
    assert_eq!(state.modulation, 0.2);
}
