use super::*;
use crate::performance_map::Performance;

fn point(time_s: f64, heat: f64, power: f64) -> StartPoint {
    StartPoint { time_s, heat, power }
}

fn compressor() -> Compressor {
    Compressor {
        modulation_min: 0.2,
        slew_per_s: 0.025,
        start: vec![
            point(0.0, 0.0, 0.02),
            point(30.0, -0.25, 0.05),
            point(60.0, 0.0, 0.3),
            point(120.0, 0.35, 0.8),
            point(240.0, 0.7, 1.1),
            point(420.0, 0.95, 1.05),
            point(600.0, 1.0, 1.0),
        ],
        flow_rise_s: 10.0,
        warm_within_s: 600.0,
        warm_scale: 0.4,
        stop_s: 10.0,
        overrun_s: 60.0,
        run_min_s: 300.0,
        off_min_s: 300.0,
        defrost: Some(Defrost {
            after_s: 2700.0,
            duration_s: 300.0,
            heat_w: 5000.0,
            least_modulation: 0.6,
            electric_w: 1200.0,
            recovery_s: 120.0,
        }),
        dynamics: true,
    }
}

fn on(modulation: f64) -> Command {
    Command { on: true, modulation, cooling: false, tripped: false, frost_rate: 0.0 }
}

const OFF: Command =
    Command { on: false, modulation: 0.0, cooling: false, tripped: false, frost_rate: 0.0 };

/// 10 kW and 2.5 kW at full speed, both a cubic of the speed.
fn map(m: f64, _cooling: bool) -> Performance {
    Performance { useful_w: 10_000.0 * m * m * m, electric_w: 2_500.0 * m * m }
}

fn after(compressor: &Compressor, steps: &[(f64, Command)]) -> (CompressorState, Vec<Means>) {
    let mut state = CompressorState::new();
    let means = steps.iter().map(|(dt_s, command)| compressor.run(*dt_s, command, &mut state, map));
    let means = means.collect();
    (state, means)
}

fn energy(steps: &[(f64, Command)], means: &[Means]) -> (f64, f64) {
    let sum = |of: fn(&Means) -> f64| steps.iter().zip(means).map(|(s, m)| s.0 * of(m)).sum();
    (sum(|m| m.water_w), sum(|m| m.electric_w))
}

#[test]
fn a_start_integrates_to_its_table_whatever_the_step() {
    // One speed. Heat in s of the steady heat: -3.75 - 3.75 + 10.5 + 63 + 148.5 + 175.5 = 390;
    // electricity: 1.05 + 5.25 + 33 + 114 + 193.5 + 184.5 = 531.3
    let one_speed = Compressor { modulation_min: 1.0, ..compressor() };
    for dt_s in [1.0, 7.5, 60.0, 300.0, 600.0] {
        let steps = vec![(dt_s, on(1.0)); (600.0 / dt_s) as usize];
        let (state, means) = after(&one_speed, &steps);
        let (heat_j, electric_j) = energy(&steps, &means);
        assert!((heat_j / 10_000.0 - 390.0).abs() < 1e-9, "{dt_s}: {heat_j}");
        assert!((electric_j / 2_500.0 - 531.3).abs() < 1e-9, "{dt_s}: {electric_j}");
        assert_eq!((state.phase, state.starts), (Phase::Running, 1.0));
        assert!((state.operating_s - 600.0).abs() < 1e-6);
        // Flow: half of 10 s are missing.
        let flow_s: f64 = means.iter().map(|m| m.flow * dt_s).sum();
        assert!((flow_s - 595.0).abs() < 1e-9);
    }
    // The shape: heat is drawn first, and the last minute is nearly steady.
    let steps = vec![(30.0, on(1.0)); 40];
    let (_, means) = after(&one_speed, &steps);
    assert!(means[0].water_w < 0.0 && means[1].water_w < 0.0 && means[2].water_w > 0.0);
    assert!((means[0].water_w + 1250.0).abs() < 1e-9);
    assert!(means[2..].windows(2).all(|pair| pair[1].water_w >= pair[0].water_w));
    assert!(means[20..].iter().all(|m| (m.water_w - 10_000.0).abs() < 1e-9));
}

#[test]
fn speed_has_a_least_value_and_rises_at_its_rate() {
    let (state, means) = after(&compressor(), &[(1000.0, on(0.05))]);
    assert_eq!(state.modulation, 0.2);
    assert!((means[0].modulation - 0.2).abs() < 1e-12);
    // 0.2 to 1 takes 32 s.
    let steps = [(1000.0, on(0.2)), (16.0, on(1.0)), (16.0, on(1.0)), (1.0, on(0.3))];
    let (state, means) = after(&compressor(), &steps);
    assert!((means[1].modulation - 0.4).abs() < 1e-12 && (means[2].modulation - 0.8).abs() < 1e-12);
    // Mean of m^3 from 0.2 to 0.6: (0.6^4 - 0.2^4)/(4 * 0.4) = 0.08
    assert!((means[1].water_w - 800.0).abs() < 1e-9, "{means:?}");
    assert_eq!(state.modulation, 0.3);
}

#[test]
fn a_stop_takes_seconds_and_the_pump_runs_on() {
    let steps = [(1000.0, on(1.0)), (10.0, OFF), (40.0, OFF), (20.0, OFF), (5.0, OFF)];
    let (state, means) = after(&compressor(), &steps);
    assert!(
        (means[1].water_w - 5000.0).abs() < 1e-9 && (means[1].electric_w - 1250.0).abs() < 1e-9
    );
    assert_eq!((means[2].water_w, means[2].flow), (0.0, 1.0));
    // The pump stops 60 s after the command: half of the third stretch.
    assert!((means[3].flow - 0.5).abs() < 1e-9 && means[4].flow == 0.0, "{means:?}");
    assert_eq!((state.phase, state.off_s), (Phase::Off, 75.0));
}

#[test]
fn runs_and_pauses_have_least_times() {
    // 5 min on, although 10 s were asked; then 5 min off, although on was asked.
    let steps = [(10.0, on(1.0)), (280.0, OFF), (20.0, OFF), (280.0, on(1.0)), (20.0, on(1.0))];
    let (state, means) = after(&compressor(), &steps);
    assert!((means[1].on - 1.0).abs() < 1e-12, "{means:?}");
    assert!((means[2].on - 0.5).abs() < 1e-9);
    assert_eq!(means[3].on, 0.0);
    assert!((means[4].on - 0.5).abs() < 1e-9);
    assert_eq!(state.starts, 2.0);
    // The second start is warm: 0.4 of the time. So is it steady after 240 s.
    assert_eq!(state.stretch, 0.4);
    let none = Compressor { run_min_s: 0.0, off_min_s: 0.0, ..compressor() };
    let (state, means) = after(&none, &[(10.0, on(1.0)), (5.0, OFF), (1000.0, on(1.0))]);
    assert!(state.starts == 2.0 && means[1].on == 0.0 && means[2].on == 1.0);
}

#[test]
fn a_trip_stops_at_once_and_a_change_of_mode_starts_again() {
    let trip = Command { tripped: true, ..on(1.0) };
    let (state, means) = after(&compressor(), &[(10.0, on(1.0)), (20.0, trip), (900.0, trip)]);
    assert_eq!((state.phase, means[1].on), (Phase::Off, 0.0));
    let cool = Command { cooling: true, ..on(1.0) };
    let (state, means) = after(&compressor(), &[(1000.0, on(1.0)), (30.0, cool)]);
    assert_eq!((state.phase, state.starts), (Phase::Starting, 1.0));
    // Cooling begins with heat for the water that should be cooled.
    assert!(means[1].water_w > 0.0);
    let (_, means) = after(&compressor(), &[(1000.0, cool), (1.0, cool)]);
    assert!((means[1].water_w + 10_000.0).abs() < 1e-9);
}

#[test]
fn frost_is_removed_after_three_quarters_of_an_hour_in_cold_air() {
    let cold = Command { frost_rate: 1.0, ..on(1.0) };
    let steps = vec![(30.0, cold); 120];
    let (state, means) = after(&compressor(), &steps);
    // 45:00 to 50:00: -5 kW and 1.2 kW, flow as before; then a ramp of 2 min.
    assert!(means[..90].iter().all(|m| m.defrosting == 0.0));
    for m in &means[90..100] {
        assert!((m.water_w + 5000.0).abs() < 1e-9 && (m.electric_w - 1200.0).abs() < 1e-9);
        assert!((m.flow - 1.0).abs() < 1e-12);
    }
    assert!((means[100].water_w - 1250.0).abs() < 1e-9, "{:?}", means[100]);
    assert!((means[104].water_w - 10_000.0).abs() < 1e-9);
    assert!((state.defrosting_s - 300.0).abs() < 1e-6);
    // Slow: at least 0.6 counts. Damp air: twice as often. Warm air: never; cooling: never.
    let count = |command: Command| after(&compressor(), &vec![(60.0, command); 240]).0.defrosting_s;
    let damp = Command { frost_rate: 2.0, ..cold };
    assert!(count(damp) > 1.9 * count(cold), "{} {}", count(damp), count(cold));
    assert_eq!(count(Command { frost_rate: -1.0, ..cold }), 0.0);
    assert_eq!(count(Command { cooling: true, ..cold }), 0.0);
    let slow = Command { frost_rate: 1.0, ..on(0.3) };
    let (_, means) = after(&compressor(), &[(2700.0, slow), (300.0, slow)]);
    assert!((means[1].water_w + 3000.0).abs() < 1e-9);
    // A defrost that has begun is finished.
    let (state, means) = after(&compressor(), &[(2701.0, cold), (299.0, OFF), (10.0, OFF)]);
    assert!((means[1].defrosting - 1.0).abs() < 1e-9 && state.phase == Phase::Stopping);
}

#[test]
fn means_do_not_depend_on_how_time_is_cut() {
    // A day of commands that change every quarter of an hour, with frost.
    let mut seed = 7_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 40) as f64 / (1_u64 << 24) as f64
    };
    let commands: Vec<Command> = (0..96)
        .map(|_| Command {
            on: random() < 0.7,
            cooling: random() < 0.05,
            tripped: random() < 0.05,
            frost_rate: 3.0 * random() - 1.0,
            ..on(random())
        })
        .collect();
    let with = |dt_s: f64| {
        let per = (900.0 / dt_s) as usize;
        let steps: Vec<_> =
            commands.iter().flat_map(|command| vec![(dt_s, *command); per]).collect();
        let (state, means) = after(&compressor(), &steps);
        let (heat_j, electric_j) = energy(&steps, &means);
        let on_s: f64 = means.iter().map(|m| m.on * dt_s).sum();
        assert!((on_s - state.operating_s).abs() < 1e-4);
        (heat_j, electric_j, state)
    };
    let (heat_j, electric_j, state) = with(900.0);
    assert!(state.starts > 5.0 && state.defrosting_s > 0.0, "{state:?}");
    for dt_s in [300.0, 60.0, 5.0, 1.0] {
        let (heat, electric, finer) = with(dt_s);
        assert!((heat / heat_j - 1.0).abs() < 1e-8, "{dt_s}: {heat} {heat_j}");
        assert!((electric / electric_j - 1.0).abs() < 1e-8, "{dt_s}: {electric} {electric_j}");
        assert_eq!(finer.starts, state.starts);
        assert!((finer.operating_s - state.operating_s).abs() < 1e-4, "{dt_s}");
    }
}

#[test]
fn without_dynamics_the_steady_map_holds_at_once() {
    let steady = Compressor { dynamics: false, ..compressor() };
    let (state, means) = after(&steady, &[(60.0, on(0.5)), (60.0, OFF), (60.0, on(0.1))]);
    assert_eq!((means[0].water_w, means[0].electric_w, means[0].flow), (1250.0, 625.0, 1.0));
    assert_eq!(means[1], Means::default());
    assert!((means[2].water_w - 80.0).abs() < 1e-9);
    assert_eq!((state.starts, state.operating_s), (2.0, 120.0));
    // A step of no length is the steady state of the unit with dynamics.
    let mut state = CompressorState::new();
    let means = compressor().run(0.0, &on(0.5), &mut state, map);
    assert_eq!((means.water_w, state.phase, state.starts), (1250.0, Phase::Running, 0.0));
}

#[test]
fn state_survives_its_numbers() {
    let (state, _) = after(&compressor(), &[(400.0, on(0.7)), (3.0, OFF)]);
    let mut numbers = [0.0; CompressorState::LEN];
    state.write(&mut numbers);
    assert_eq!(CompressorState::read(&numbers), state);
}
