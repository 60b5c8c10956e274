use super::*;
use crate::building::envelope::Construction;
use anergy_core::medium::Medium;

const CP: f64 = 4180.0;
const HOUR_S: f64 = 3600.0;

fn built(params: &BuildingParams) -> Building {
    params.build(&Medium::default()).unwrap()
}

/// A house on supplies of fixed temperature, stepped.
struct Run {
    unit: Building,
    inputs: Vec<f64>,
    state: Vec<f64>,
    out: Vec<f64>,
    got: Vec<PortFlow>,
    /// Largest error of the energy contract: in 1e-9 of the heat that moved and in the rounding of what is stored
    /// (5e9 J in temperatures of 300 K, which is a few uJ per step).
    error: f64,
}

impl Run {
    fn new(params: &BuildingParams) -> Self {
        let unit = built(params);
        let inputs = unit.inputs().iter().map(|input| input.initial).collect();
        let state = unit.initial_state(300.0);
        let out = vec![f64::NAN; unit.outputs().len()];
        let got =
            vec![PortFlow { m_flow_kg_s: 0.0, t_in_k: 300.0, t_out_k: 300.0 }; unit.ports().len()];
        Self { unit, inputs, state, out, got, error: 0.0 }
    }

    fn set(&mut self, name: &str, value: f64) {
        let at = self.unit.inputs().iter().position(|input| input.name == name).unwrap();
        self.inputs[at] = value;
    }

    fn out(&self, name: &str) -> f64 {
        self.out[self.unit.outputs().iter().position(|output| output.name == name).unwrap()]
    }

    /// A step with water of these temperatures at the ports.
    fn step(&mut self, dt_s: f64, supplies_k: &[f64]) {
        let mut wanted = vec![PortRequest::default(); self.got.len()];
        self.unit.request(&Signals(&self.inputs), &self.got, &mut self.state, &mut wanted);
        for ((got, wanted), t_in_k) in self.got.iter_mut().zip(&wanted).zip(supplies_k) {
            let Outlet::Linear { constant_k, of_inlet } = wanted.outlet else { panic!() };
            assert!((0.0..=1.0).contains(&of_inlet), "{of_inlet}");
            *got = PortFlow {
                m_flow_kg_s: wanted.m_flow_kg_s,
                t_in_k: *t_in_k,
                t_out_k: constant_k + of_inlet * t_in_k,
            };
        }
        self.book(dt_s);
    }

    /// Advances with what the ports got and checks the energy.
    fn book(&mut self, dt_s: f64) {
        let before = self.unit.stored_j(&self.state);
        let signals = Signals(&self.inputs);
        let exchange = self.unit.advance(dt_s, &signals, &self.got, &mut self.state, &mut self.out);
        let water_w: f64 = self
            .got
            .iter()
            .map(|port| port.m_flow_kg_s.abs() * CP * (port.t_out_k - port.t_in_k))
            .sum();
        let moved_j = dt_s * (exchange.external_w + exchange.electric_w - water_w);
        let size_j = dt_s * (water_w.abs() + exchange.external_w.abs() + 1000.0);
        if dt_s > 0.0 {
            let error_j = (self.unit.stored_j(&self.state) - before - moved_j).abs();
            self.error = self.error.max(error_j / (1e-9 * size_j + 1e-14 * before));
        }
    }

    fn hours(&mut self, hours: f64, dt_s: f64, supplies_k: &[f64]) {
        for _ in 0..(hours * HOUR_S / dt_s).round() as usize {
            self.step(dt_s, supplies_k);
        }
    }
}

fn radiators() -> BuildingParams {
    BuildingParams {
        emitter: EmitterKind::Radiator,
        construction: Construction::Until2001,
        heating_w_m2: 22.0,
        ..BuildingParams::default()
    }
}

#[test]
fn energy_closes_over_any_step_and_any_input() {
    let mut seed = 7_u64;
    let mut random = |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for emitter in [EmitterKind::Radiator, EmitterKind::Floor] {
        let mut run =
            Run::new(&BuildingParams { emitter, cooling: true, ..BuildingParams::default() });
        for _ in 0..3000 {
            for (name, low, high) in [
                ("room_set_k", 285.0, 300.0),
                ("cooling_set_k", 290.0, 303.0),
                ("presence", 0.0, 1.0),
                ("appliances_w", 0.0, 5000.0),
                ("cellar_gain_w", -200.0, 500.0),
                ("outdoor_k", 255.0, 310.0),
                ("ground_k", 275.0, 288.0),
                ("global_w_m2", 0.0, 900.0),
                ("beam_w_m2", 0.0, 900.0),
                ("diffuse_w_m2", 0.0, 300.0),
                ("sun_elevation_rad", -0.5, 1.2),
                ("sun_azimuth_rad", -3.1, 3.1),
            ] {
                let value = random(low, high);
                run.set(name, value);
            }
            let dt_s = 3600.0_f64.powf(random(0.0, 1.0));
            let supplies = [random(290.0, 345.0), random(280.0, 295.0)];
            if random(0.0, 1.0) < 0.7 {
                run.step(dt_s, &supplies);
            } else {
                // Something else than it wanted: the flows are facts all the same.
                for (got, t_in_k) in run.got.iter_mut().zip(supplies) {
                    let t_out_k = t_in_k + random(-5.0, 5.0);
                    *got = PortFlow { m_flow_kg_s: random(-0.3, 0.3), t_in_k, t_out_k };
                }
                run.book(dt_s);
            }
            assert!(run.out.iter().all(|value| value.is_finite()), "{:?}", run.out);
        }
        assert!(run.error < 1.0, "{}", run.error);
        let room_k = run.out("t_room_k");
        assert!((270.0..330.0).contains(&room_k), "{room_k}");
    }
}

#[test]
fn rooms_are_held_within_half_a_kelvin() {
    // 5 degC outdoors needs 16 K of 311 W/K less the people's 660 W: about 4.4 of 6.6 kW. The band is 1 K, so the
    // proportional thermostat rests within 0.5 K of 21 degC.
    for params in [radiators(), BuildingParams::default()] {
        let supply_k = if params.emitter == EmitterKind::Radiator { 333.15 } else { 313.15 };
        for dt_s in [60.0, 900.0] {
            let mut run = Run::new(&params);
            run.hours(240.0, dt_s, &[supply_k]);
            let room_k = run.out("t_room_k");
            assert!((room_k - 294.15).abs() < 0.5, "{room_k}");
            let (heat_w, emitted_w) = (run.out("heating_w"), run.out("emitted_w"));
            assert!(
                heat_w > 1500.0 && (heat_w - emitted_w).abs() < 0.02 * heat_w,
                "{heat_w} {emitted_w}"
            );
            assert!(run.out("heating_out_k") < supply_k - 5.0 && run.error < 1.0);
        }
        // With a reset time nothing is left of the error.
        let mut run = Run::new(&BuildingParams { thermostat_reset_s: 7200.0, ..params });
        run.hours(480.0, 300.0, &[supply_k]);
        let room_k = run.out("t_room_k");
        assert!((room_k - 294.15).abs() < 0.02, "{room_k}");
    }
}

#[test]
fn steady_heat_is_the_loss_by_hand() {
    // At rest the emitter and the people give what walls, windows, air, roof and cellar take; the loss of the living
    // area to outdoors and ground of one temperature is UA (T_room - T_out), UA of `house.rs` by hand for this house
    // (273.17 W/K at 0.3 1/h) and 78.39 W/K more for the air that people need.
    let mut run = Run::new(&BuildingParams {
        ground_k: 273.15,
        outdoor_k: 273.15,
        heating_w_m2: 40.0,
        ..BuildingParams::default()
    });
    run.hours(24.0 * 400.0, 3600.0, &[313.15]);
    let by_hand_w = (273.17 + 78.39) * (run.out("t_room_k") - 273.15);
    let (loss_w, gains_w) = (run.out("loss_w"), run.out("emitted_w") + run.out("internal_w"));
    assert!((loss_w - gains_w).abs() < 1e-3 * loss_w, "{loss_w} {gains_w}");
    // Half of the people's heat and half of the floor's are radiation; what falls on the outer walls leaves at once,
    // so the loss is somewhat above that of the air.
    assert!(loss_w > by_hand_w && loss_w < 1.05 * by_hand_w, "{loss_w} {by_hand_w}");
}

#[test]
fn night_presence_and_set_points_of_others() {
    let params = BuildingParams {
        night_set_k: Some(291.15),
        absent_set_k: Some(292.15),
        outdoor_k: 263.15,
        heating_w_m2: 50.0,
        ..radiators()
    };
    let mut run = Run::new(&params);
    run.hours(24.0, 60.0, &[333.15]);
    // The run starts at midnight: night until 6, then 21 degC until 23 h.
    let mut sets = Vec::new();
    let mut rooms = Vec::new();
    for _ in 0..24 {
        run.hours(1.0, 60.0, &[333.15]);
        sets.push(run.out("set_k"));
        rooms.push(run.out("t_room_k"));
    }
    assert!(sets[0..6].iter().all(|set| *set == 291.15), "{sets:?}");
    assert!(sets[6..22].iter().all(|set| *set == 294.15) && sets[23] == 291.15, "{sets:?}");
    assert!(rooms[5] < rooms[21] - 0.3, "it cools at night: {rooms:?}");
    // Away by day: 19 degC; somebody who wants 23 degC.
    run.hours(12.0, 60.0, &[333.15]);
    run.set("presence", 0.0);
    run.step(60.0, &[333.15]);
    assert_eq!(run.out("set_k"), 292.15);
    run.set("presence", 1.0);
    run.set("room_set_k", 296.15);
    run.step(60.0, &[333.15]);
    assert_eq!((run.out("set_k"), run.out("heating_kg_s")), (296.15, 0.25));
    run.set("heating_enabled", 0.0);
    run.step(60.0, &[333.15]);
    assert_eq!(run.out("heating_kg_s"), 0.0);
}

#[test]
fn the_season_ends_with_warm_days() {
    let mut run = Run::new(&BuildingParams { room_set_k: 295.15, ..BuildingParams::default() });
    run.hours(1.0, 600.0, &[313.15]);
    assert!(run.out("season") == 1.0 && run.out("heating_kg_s") > 0.0);
    // From a mean of 5 degC towards 20: 14 degC after ln(15/6) = 0.916 days, 22.0 h.
    run.set("outdoor_k", 293.15);
    run.hours(21.0, 600.0, &[313.15]);
    assert_eq!(run.out("season"), 1.0);
    run.hours(2.0, 600.0, &[313.15]);
    assert_eq!((run.out("season"), run.out("heating_kg_s")), (0.0, 0.0));
}

#[test]
fn a_floor_cools() {
    // 4 kW for 13 hours and nothing afterwards, 5 to 15 degC outdoors: the room stays within 23 - 0.5 and + 1.5 K.
    let params = BuildingParams {
        heating: false,
        cooling: true,
        initial_living_k: 296.15,
        construction: Construction::EnEv2016,
        ..BuildingParams::default()
    };
    let mut run = Run::new(&params);
    assert_eq!(
        run.unit.ports().iter().map(|port| port.name.as_str()).collect::<Vec<_>>(),
        ["cooling"]
    );
    run.set("appliances_w", 4000.0);
    let (mut low_k, mut high_k, mut cold_w) = (f64::MAX, 0.0_f64, 0.0_f64);
    for minute in 0..780 {
        let hours = f64::from(minute) / 60.0;
        run.set("outdoor_k", 283.15 - 5.0 * (std::f64::consts::TAU * (hours + 9.0) / 24.0).cos());
        run.step(60.0, &[288.15]);
        low_k = low_k.min(run.out("t_room_k"));
        high_k = high_k.max(run.out("t_room_k"));
        cold_w = cold_w.max(run.out("cooling_w"));
    }
    assert!(low_k > 295.65 && high_k < 297.65, "{low_k} {high_k}");
    assert!(cold_w > 500.0 && run.out("cooling_out_k") > 288.15 && run.error < 1.0, "{cold_w}");
    run.set("appliances_w", 0.0);
    run.hours(6.0, 60.0, &[288.15]);
    assert_eq!(run.out("cooling_kg_s"), 0.0);
}

#[test]
fn a_step_of_the_set_point_is_the_same_in_short_and_long_steps() {
    let room_k = |dt_s: f64| {
        let mut run = Run::new(&BuildingParams { thermostat_difference_k: 4.0, ..radiators() });
        run.set("room_set_k", 296.15);
        run.hours(24.0, dt_s, &[333.15]);
        (run.out("t_room_k"), run.state[at::HEAT_J])
    };
    let (fine_k, fine_j) = room_k(10.0);
    for (dt_s, limit_k, limit) in [(60.0, 0.01, 0.005), (900.0, 0.1, 0.05), (3600.0, 0.3, 0.1)] {
        let (t_k, heat_j) = room_k(dt_s);
        assert!((t_k - fine_k).abs() < limit_k, "{dt_s}: {t_k} {fine_k}");
        assert!((heat_j / fine_j - 1.0).abs() < limit, "{dt_s}: {heat_j} {fine_j}");
    }
}

#[test]
fn sun_and_people_warm() {
    let free = BuildingParams { heating: true, outdoor_k: 288.15, ..BuildingParams::default() };
    let room_k = |change: &[(&str, f64)]| {
        let mut run = Run::new(&free);
        run.set("heating_enabled", 0.0);
        for (name, value) in change {
            run.set(name, *value);
        }
        run.hours(48.0, 600.0, &[300.0]);
        run.out("t_room_k")
    };
    let plain = room_k(&[]);
    let sun = room_k(&[
        ("global_w_m2", 300.0),
        ("beam_w_m2", 300.0),
        ("diffuse_w_m2", 100.0),
        ("sun_elevation_rad", 0.7),
    ]);
    assert!(sun > plain + 1.0 && room_k(&[("presence", 0.0)]) < plain, "{plain} {sun}");
}

#[test]
fn settling_changes_nothing() {
    let mut run = Run::new(&radiators());
    run.hours(2.0, 60.0, &[333.15]);
    let before = run.state.clone();
    let signals = Signals(&run.inputs);
    run.unit.advance(0.0, &signals, &run.got, &mut run.state, &mut run.out);
    let changed = before.iter().zip(&run.state).any(|(a, b)| a.to_bits() != b.to_bits());
    assert!(!changed && (run.out("t_room_k") - before[0]).abs() < 1e-9);
}

#[test]
fn what_cannot_be_names_its_field() {
    let good = BuildingParams::default();
    for (field, params) in [
        ("living_area_m2", BuildingParams { living_area_m2: -1.0, ..good.clone() }),
        ("floors", BuildingParams { floors: f64::NAN, ..good.clone() }),
        ("window_share", BuildingParams { window_share: 0.9, ..good.clone() }),
        ("window_g", BuildingParams { window_g: 1.2, ..good.clone() }),
        ("attached_buildings", BuildingParams { attached_buildings: 3, ..good.clone() }),
        ("cooling_set_k", BuildingParams { cooling_set_k: 293.15, ..good.clone() }),
        ("room_set_k", BuildingParams { room_set_k: 21.0, ..good.clone() }),
        ("wall_w_m2_k", BuildingParams { wall_w_m2_k: Some(12.0), ..good.clone() }),
        ("nominal_return_k", BuildingParams { nominal_return_k: Some(290.0), ..good.clone() }),
        ("night_from_s", BuildingParams { night_from_s: 90_000.0, ..good.clone() }),
        ("air_change_present_1_s", BuildingParams { air_change_present_1_s: 0.0, ..good.clone() }),
    ] {
        let problem = params.build(&Medium::default()).unwrap_err();
        assert_eq!(problem.field(), Some(field), "{problem}");
    }
    let nothing = BuildingParams { heating: false, ..good };
    assert!(nothing.build(&Medium::default()).is_err());
}

#[test]
fn nights_follow_the_calendar() {
    // Friday 2024-02-02, 19:00 UTC is 20:00 of the local clock. Night from 23 to 6, on days off from 0:30 to 8 h; the Monday
    // after is a holiday.
    let params = BuildingParams {
        night_set_k: Some(291.15),
        night_off_from_s: Some(1800.0),
        night_off_until_s: Some(8.0 * HOUR_S),
        holidays: vec!["2024-02-05".into()],
        ..radiators()
    };
    let mut run = Run::new(&params);
    run.set("start_unix_s", 19_755.0 * 24.0 * HOUR_S + 19.0 * HOUR_S);
    // Hours after Friday 20:00 and whether it is night.
    let expected = [
        (2, false),  // Fri 22
        (3, true),   // Fri 23
        (4, false),  // Sat 0
        (5, true),   // Sat 1
        (11, true),  // Sat 7
        (12, false), // Sat 8
        (27, false), // Sat 23
        (59, true),  // Mon 7, a holiday
        (60, false), // Mon 8
        (75, false), // Mon 23
        (76, true),  // Tue 0
        (81, true),  // Tue 5
        (82, false), // Tue 6
    ];
    let mut night = Vec::new();
    for _ in 0..=82 {
        run.step(HOUR_S, &[330.0]);
        night.push(run.out("set_k") < 293.0);
    }
    for (hour, is_night) in expected {
        assert_eq!(night[hour], is_night, "{hour} h after Friday 20:00");
    }
    for holidays in [vec!["25.12.2024".to_owned()], vec!["2023-02-29".to_owned()]] {
        assert!(BuildingParams { holidays, ..params.clone() }.build(&Medium::default()).is_err());
    }
    let alone = BuildingParams { night_off_from_s: None, night_off_until_s: None, ..params };
    assert!(alone.build(&Medium::default()).is_err());
}
