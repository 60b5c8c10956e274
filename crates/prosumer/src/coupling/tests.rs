use super::*;

const CP: f64 = 4200.0;

fn branch(from: usize, to: usize, slot: usize) -> Branch {
    Branch {
        from,
        to,
        members: vec![slot],
        pumped: false,
        resistance: 1.0,
        idle_opening: 0.0,
        suction: 0.0,
        throttled: true,
        check_valve: false,
    }
}

fn pump(from: usize, to: usize, slot: usize) -> Branch {
    Branch { pumped: true, resistance: 25.0, ..branch(from, to, slot) }
}

fn wanted(flows: &[f64]) -> BranchFlows {
    let mut wanted = [0.0; MOST_BRANCHES];
    wanted[..flows.len()].copy_from_slice(flows);
    wanted
}

/// Supply is point 0, return point 1: storage, heating, engine, boiler.
fn house(engine: &dyn Fn(Branch) -> Branch) -> Coupling {
    let branches = vec![branch(0, 1, 0), pump(0, 1, 1), engine(pump(1, 0, 2)), pump(1, 0, 3)];
    Coupling { points: 2, branches }
}

/// Flows of the four branches.
fn flows(engine: &dyn Fn(Branch) -> Branch, pumps: [f64; 3]) -> [f64; 4] {
    let [heating, engine_kg_s, boiler] = pumps;
    let (all, settled) = house(engine).flows(&wanted(&[0.0, heating, engine_kg_s, boiler]));
    assert!(settled);
    [all[0], all[1], all[2], all[3]]
}

#[track_caller]
fn assert_near(got: [f64; 4], expected: [f64; 4]) {
    for (got, expected) in got.iter().zip(expected) {
        assert!((got - expected).abs() < 1e-10, "{got} instead of {expected}");
    }
}

#[test]
fn the_storage_takes_the_difference() {
    // 0.3 kg/s of generators, 0.1 of the heating: 0.2 into the storage; 0.1 and 0.25: 0.15 out of it.
    let closed = |branch| branch;
    assert_near(flows(&closed, [0.1, 0.05, 0.25]), [0.2, 0.1, 0.05, 0.25]);
    assert_near(flows(&closed, [0.25, 0.1, 0.0]), [-0.15, 0.25, 0.1, 0.0]);
}

#[test]
fn water_passes_an_engine_that_is_off_and_open() {
    // R_engine/R_storage = 25: r = 1/(1 + sqrt(25)) = 1/6 of 0.3 kg/s
    let open = |branch| Branch { idle_opening: 1.0, ..branch };
    assert_near(flows(&open, [0.3, 0.0, 0.0]), [-0.25, 0.3, 0.05, 0.0]);
    // Half open: R = 100, r = 1/11
    let half = |branch| Branch { idle_opening: 0.5, ..branch };
    assert_near(flows(&half, [0.33, 0.0, 0.0]), [-0.3, 0.33, 0.03, 0.0]);
    // While the boiler charges, water flows back through it, unless a check valve is there.
    assert_near(flows(&open, [0.0, 0.0, 0.3]), [0.25, 0.0, -0.05, 0.3]);
    let checked = |branch| Branch { idle_opening: 1.0, check_valve: true, ..branch };
    assert_near(flows(&checked, [0.0, 0.0, 0.3]), [0.3, 0.0, 0.0, 0.3]);
    assert_near(flows(&checked, [0.3, 0.0, 0.0]), [-0.25, 0.3, 0.05, 0.0]);
}

#[test]
fn a_strong_pump_draws_water_through_a_weak_one() {
    // 0.03 + 0.15 (0.33 - 0.03) = 0.075 kg/s; a pump that is off is not drawn on.
    let drawn = |branch| Branch { suction: 0.15, ..branch };
    assert_near(flows(&drawn, [0.0, 0.03, 0.33]), [0.405, 0.0, 0.075, 0.33]);
    assert_near(flows(&drawn, [0.0, 0.0, 0.33]), [0.33, 0.0, 0.0, 0.33]);
}

#[test]
fn a_pump_that_cannot_throttle_delivers_what_the_others_push() {
    // The heating draws 0.3: through the engine alone 0.05 would come; it wants 0.02, so 0.05; it wants 0.1, so 0.1.
    let weak = |branch| Branch { throttled: false, ..branch };
    assert_near(flows(&weak, [0.3, 0.02, 0.0]), [-0.25, 0.3, 0.05, 0.0]);
    assert_near(flows(&weak, [0.3, 0.1, 0.0]), [-0.2, 0.3, 0.1, 0.0]);
}

#[test]
fn three_points_share_by_their_resistances() {
    // 0.3 kg/s from 2 to 0; back through 0-2 with R = 1 and through 0-1-2 with 1 + 3 = 4: 2 : 1.
    let second = Branch { resistance: 3.0, ..branch(1, 2, 2) };
    let coupling = Coupling {
        points: 3,
        branches: vec![branch(0, 2, 0), branch(0, 1, 1), second, pump(2, 0, 3)],
    };
    let (flows, _) = coupling.flows(&wanted(&[0.0, 0.0, 0.0, 0.3]));
    assert_near([flows[0], flows[1], flows[2], flows[3]], [0.2, 0.1, 0.1, 0.3]);
}

fn solved(coupling: &Coupling, pumps: &[f64], outlets: &[Outlet]) -> Vec<PortFlow> {
    let (flows, settled) = coupling.flows(&wanted(pumps));
    let wanted: Vec<PortRequest> =
        outlets.iter().map(|outlet| PortRequest { m_flow_kg_s: 0.0, outlet: *outlet }).collect();
    let mut got = vec![PortFlow { t_in_k: 290.0, ..PortFlow::default() }; outlets.len()];
    let solved = coupling.solve(&flows, CP, &wanted, &mut got);
    assert!(
        settled && solved == Ok(true),
        "{settled} {solved:?}: {coupling:?} {pumps:?} {outlets:?}"
    );
    let heat: f64 =
        got.iter().map(|got| got.m_flow_kg_s.abs() * CP * (got.t_out_k - got.t_in_k)).sum();
    assert!(heat.abs() < 1e-6, "{heat} W are left: {got:?}");
    got
}

const STORAGE: Outlet = Outlet::Ends { a_k: 343.15, b_k: 313.15 };

#[test]
fn water_of_a_cold_engine_cools_the_supply() {
    // 0.25 kg/s of 70 degC and 0.05 kg/s that pass the engine with the return, 70 degC less 20 K: with T_S the supply,
    // 0.3 T_S = 0.25 70 + 0.05 (T_S - 20): T_S = (17.5 - 1)/0.25 = 66 degC
    let open = |branch| Branch { idle_opening: 1.0, ..branch };
    let nothing = Outlet::HeatFlow(0.0);
    let heating = Outlet::HeatFlow(-0.3 * CP * 20.0);
    let got = solved(&house(&open), &[0.0, 0.3, 0.0, 0.0], &[STORAGE, heating, nothing, nothing]);
    assert!((got[1].t_in_k - 339.15).abs() < 1e-9, "{got:?}");
    assert!((got[2].t_in_k - 319.15).abs() < 1e-9 && got[0].m_flow_kg_s < 0.0, "{got:?}");
    // An engine at 30 degC: 0.3 T_S = 17.5 + 1.5: 63.3333 degC
    let cold = Outlet::Temperature(303.15);
    let got = solved(&house(&open), &[0.0, 0.3, 0.0, 0.0], &[STORAGE, heating, cold, nothing]);
    assert!((got[1].t_in_k - 336.483_333).abs() < 1e-5, "{got:?}");
}

#[test]
fn limits_hold_at_points() {
    // The boiler would lift 0.1 kg/s from 40 to 60 degC, at most to 50: the storage gets 50 degC.
    let closed = |branch| branch;
    let boiler = Outlet::Warmed { wanted_w: 8400.0, hottest_k: 323.15 };
    let nothing = Outlet::HeatFlow(0.0);
    let got = solved(&house(&closed), &[0.0, 0.0, 0.0, 0.1], &[STORAGE, nothing, nothing, boiler]);
    assert!((got[0].t_in_k - 323.15).abs() < 1e-9, "{got:?}");
}

#[test]
fn standing_water_shows_what_would_come() {
    let closed = |branch| branch;
    let nothing = Outlet::HeatFlow(0.0);
    let got = solved(&house(&closed), &[0.0; 4], &[STORAGE, nothing, nothing, nothing]);
    // The heating would get the top, a generator the bottom.
    assert!(got[1].t_in_k == 343.15 && got[3].t_in_k == 313.15, "{got:?}");
}

#[test]
fn heat_that_nothing_takes_is_an_error() {
    let coupling = Coupling { points: 2, branches: vec![branch(0, 1, 0), pump(1, 0, 1)] };
    let outlets = [Outlet::HeatFlow(0.0), Outlet::HeatFlow(1000.0)];
    let (flows, _) = coupling.flows(&wanted(&[0.0, 0.1]));
    let wanted = outlets.map(|outlet| PortRequest { m_flow_kg_s: 0.0, outlet });
    let got = coupling.solve(&flows, CP, &wanted, &mut [PortFlow::default(); 2]);
    assert_eq!(got, Err(Undefined));
}

#[test]
fn limits_hold_where_next_to_nothing_passes_the_storage() {
    // Engine and boiler give 0.1 kg/s, the heating takes 0.1 less 1e-7: 5 kW up to 80 degC against 9 kW down to 40 degC. The
    // heating takes what there is: the loop falls until the heating gives back 40 degC, and the engine warms that by 5 kW.
    let closed = |branch| branch;
    let nothing = Outlet::HeatFlow(0.0);
    let heating = Outlet::Cooled { wanted_w: 9000.0, coldest_k: 313.15 };
    let engine = Outlet::Warmed { wanted_w: 5000.0, hottest_k: 353.15 };
    for rest_kg_s in [1e-7, 1e-10, -1e-7, -1e-10] {
        let got = solved(
            &house(&closed),
            &[0.0, 0.1 - rest_kg_s, 0.1, 0.0],
            &[STORAGE, heating, engine, nothing],
        );
        assert!((got[1].t_out_k - 313.15).abs() < 0.01, "{got:?}");
        assert!((got[2].t_out_k - 313.15 - 5000.0 / 420.0).abs() < 0.02, "{got:?}");
    }
    // 3 kW down to 40 degC: the loop rises to 80 degC.
    let heating = Outlet::Cooled { wanted_w: 3000.0, coldest_k: 313.15 };
    let got =
        solved(&house(&closed), &[0.0, 0.1 - 1e-7, 0.1, 0.0], &[STORAGE, heating, engine, nothing]);
    assert!((got[2].t_out_k - 353.15).abs() < 0.01, "{got:?}");
}

#[test]
fn random_houses_settle_and_keep_their_limits() {
    let mut seed = 1_u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut followed = 0;
    for _ in 0..20_000 {
        let opening = if random() < 0.5 { 0.0 } else { random() };
        let (suction, check_valve) = (0.3 * random(), random() < 0.5);
        let throttled = random() < 0.7;
        let engine =
            |branch| Branch { idle_opening: opening, suction, check_valve, throttled, ..branch };
        let coupling = house(&engine);
        let pump = |x: f64, y: f64| if x < 0.3 { 0.0 } else { 0.3 * y };
        let mut pumps =
            [0.0, pump(random(), random()), pump(random(), random()), pump(random(), random())];
        // Every third one nearly closes in itself.
        if random() < 0.33 {
            pumps[1] = pumps[2] + pumps[3] + 1e-6 * (random() - 0.5);
        }
        let mut hot =
            || Outlet::Warmed { wanted_w: 2e4 * random(), hottest_k: 320.0 + 50.0 * random() };
        let (one, other) = (hot(), hot());
        let heating =
            Outlet::Cooled { wanted_w: 2e4 * random(), coldest_k: 300.0 + 30.0 * random() };
        let outlets = [STORAGE, heating, one, other];
        let got = solved(&coupling, &pumps.map(|m: f64| m.max(0.0)), &outlets);
        for (port, outlet) in got.iter().zip(&outlets) {
            if port.m_flow_kg_s == 0.0 {
                continue;
            }
            let fits = match *outlet {
                Outlet::Warmed { hottest_k, .. } => {
                    port.t_out_k <= hottest_k.max(port.t_in_k) + 1e-6
                }
                Outlet::Cooled { coldest_k, .. } => {
                    port.t_out_k >= coldest_k.min(port.t_in_k) - 1e-6
                }
                _ => true,
            };
            assert!(fits && (290.0..380.0).contains(&port.t_out_k), "{got:?} {outlets:?}");
        }
        followed += usize::from(got[0].m_flow_kg_s.abs() < 1e-5);
    }
    assert!(followed > 500, "{followed}");
}
