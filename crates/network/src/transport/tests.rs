//! Pipes between two open ends, side by side where told, with prescribed flows.

use super::*;
use crate::elements::ElementParams;
use crate::elements::pipe::PipeParams;
use crate::elements::pipe::thermal::WallModel;
use crate::graph::{Coupling, Edge, GRAVITY_M_S2, Node, NodeKind};
use crate::two_port::{EdgeThermal, PlugFlowPipe, Wall};
use anergy_core::ids::{EdgeId, NodeId};
use anergy_core::medium::Medium;
use anergy_core::port::Port;

const CP: f64 = 4180.0;

/// 100 m, 100 mm, content 785.4 kg; steel wall 108/100 mm: 785.4 * (7850 * 460 * 1.3069e-3)/(4180 * 7.854)
/// = 112.9 kg of water, F = 1.1438; loss 0.5 W/(m K).
fn pipe(wall: WallModel) -> PipeParams {
    PipeParams {
        wall,
        outer_diameter_m: Some(0.108),
        insulation_resistance_k_m_w: Some(2.0),
        ..PipeParams::default()
    }
}

struct Rig {
    network: Network,
    transport: Transport,
    state: NetworkState,
}

impl Rig {
    fn new(pipes: &[PipeParams], couplings: &[Coupling], initial_k: f64) -> Self {
        let medium = Medium::default();
        let node = Node {
            kind: NodeKind::PressureBoundary,
            elevation_m: 0.0,
            volume_m3: 0.0,
            ua_w_k: 0.0,
        };
        let edge = |(i, params): (usize, &PipeParams)| Edge {
            from: NodeId::from_index(2 * i),
            to: NodeId::from_index(2 * i + 1),
            element: ElementParams::Pipe(params.clone()).build(&medium).unwrap(),
            loss_factor: 1.0,
            partner: None,
            leads_partner: false,
        };
        let network = Network {
            medium,
            gravity_m_s2: GRAVITY_M_S2,
            nodes: vec![node; 2 * pipes.len()],
            edges: pipes.iter().enumerate().map(edge).collect(),
            ports: vec![],
            prescriptions: vec![],
            couplings: couplings.to_vec(),
            soil: vec![],
            regulators: vec![],
        };
        let mut state = NetworkState::new(&network, initial_k);
        state.surroundings_k.fill(280.0);
        Self { transport: Transport::new(&network).unwrap(), network, state }
    }

    fn pipe(&self, i: usize) -> PlugFlowPipe {
        match self.network.edges[i].element.thermal() {
            EdgeThermal::PlugFlow(pipe) => pipe,
            other => panic!("{other:?}"),
        }
    }

    fn flow(&mut self, i: usize, m: f64, t_in_k: f64) {
        self.state.m_flow_kg_s[i] = m;
        (self.state.exchange_kg_s[2 * i], self.state.exchange_kg_s[2 * i + 1]) = (m, -m);
        (self.state.given_t_k[2 * i], self.state.given_t_k[2 * i + 1]) = (t_in_k, t_in_k);
    }

    /// Mean outlet temperature of pipe i in a step, K; checks its energy balance, relative to the heat that
    /// warms its content by 1 K.
    fn step(&mut self, dt_s: f64) -> Vec<f64> {
        let before: Vec<f64> = self.stored();
        self.transport.advance(&self.network, &mut self.state, dt_s).unwrap();
        let (after, mut outlets) = (self.stored(), vec![]);
        for (i, edge) in self.network.edges.iter().enumerate() {
            let m = self.state.m_flow_kg_s[i];
            let t_in_k = self.transport.t_mean_k[edge.upstream(m).index()];
            let t_out_k = self.transport.outlet_k(&self.network, &self.state, i);
            let passed_j = m.abs() * dt_s * CP;
            let gained_j = if m == 0.0 { 0.0 } else { passed_j * (t_in_k - t_out_k) };
            let booked_j = (self.state.q_flow_w[i] - self.state.q_loss_w[i]) * dt_s;
            let error_j = after[i] - before[i] - gained_j - booked_j;
            let scale_j = self.pipe(i).capacity_kg() * CP + passed_j;
            assert!(error_j.abs() < 1e-9 * scale_j, "pipe {i}: {error_j} of {scale_j} J");
            outlets.push(t_out_k);
        }
        outlets
    }

    fn stored(&self) -> Vec<f64> {
        (0..self.network.edges.len())
            .map(|i| self.state.pipe_stored_j(i, &self.pipe(i), &self.network.medium))
            .collect()
    }

    fn settle(&mut self) {
        for _ in 0..60 {
            self.transport.settle(&self.network, &mut self.state).unwrap();
        }
    }
}

const WALLS: [WallModel; 4] =
    [WallModel::None, WallModel::EndVolume, WallModel::Equilibrium, WallModel::Film];

/// A number without pattern in 0..1.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 53) as f64
}

/// Any history: stops, reversals, steps of many transits.
fn random_history(rig: &mut Rig, seed: u64, steps: usize) {
    let mut seed = seed;
    for _ in 0..steps {
        for i in 0..rig.network.edges.len() {
            let m = match (4.0 * random(&mut seed)) as u32 {
                0 => 0.0,
                1 => 1e-7 * (random(&mut seed) - 0.5),
                2 => 20.0 * (random(&mut seed) - 0.5),
                _ => 2.0 * (random(&mut seed) - 0.3),
            };
            let t_in_k = 283.0 + 80.0 * random(&mut seed);
            rig.flow(i, m, t_in_k);
        }
        let dt_s = 10.0_f64.powf(4.0 * random(&mut seed) - 0.5);
        for t_k in rig.step(dt_s) {
            assert!((279.9..363.5).contains(&t_k), "{t_k} K");
        }
        for i in 0..rig.network.edges.len() {
            assert!(rig.state.parcels.count(i) <= parcels::PARCELS_PER_PIPE);
        }
    }
}

#[test]
fn energy_closes_in_any_history_with_every_wall_dispersion_and_neighbour() {
    for wall in WALLS {
        for dispersion_m2_s in [0.0, 0.3] {
            let one = PipeParams { dispersion_m2_s, standstill_loss_factor: 3.0, ..pipe(wall) };
            let other =
                PipeParams { length_m: 70.0, inner_diameter_m: 0.05, ..pipe(WallModel::None) };
            let coupling = Coupling {
                edges: [EdgeId::from_index(0), EdgeId::from_index(1)],
                reversed: true,
                conductance_w_k: 80.0,
            };
            random_history(&mut Rig::new(std::slice::from_ref(&one), &[], 300.0), 1, 150);
            random_history(&mut Rig::new(&[one, other], &[coupling], 300.0), 7, 150);
        }
    }
}

#[test]
fn a_wall_in_equilibrium_delays_a_sharp_front() {
    // Without loss the front arrives after F content/m = 898.3 kg / 1 kg/s = 898 s, in one step of 2 s.
    let params = PipeParams { insulation_resistance_k_m_w: None, ..pipe(WallModel::Equilibrium) };
    let mut rig = Rig::new(&[params], &[], 300.0);
    let content = rig.pipe(0).content_kg;
    assert!((content - 898.3).abs() < 0.2, "{content}");
    rig.flow(0, 1.0, 350.0);
    for k in 1..=460 {
        let t_k = rig.step(2.0)[0];
        let (from, to) = (2.0 * f64::from(k) - 2.0, 2.0 * f64::from(k));
        let share = ((to - content) / (to - from)).clamp(0.0, 1.0);
        // The node before the pipe holds 1 mg.
        assert!((t_k - (300.0 + 50.0 * share)).abs() < 1e-4, "{k}: {t_k}");
    }
}

#[test]
fn an_end_volume_rounds_a_front_with_its_time_constant() {
    // M = 112.9 kg at 1 kg/s: 63.2 % of the step 112.9 s after the water has arrived; reversed, the
    // volume comes first and the same happens one transit later.
    for m in [1.0, -1.0] {
        let params = PipeParams { insulation_resistance_k_m_w: None, ..pipe(WallModel::EndVolume) };
        let mut rig = Rig::new(&[params], &[], 300.0);
        let pipe = rig.pipe(0);
        rig.flow(0, m, 350.0);
        let mut t_k = 300.0;
        for _ in 0..(pipe.water_kg + pipe.wall_kg) as i64 {
            t_k = rig.step(1.0)[0];
        }
        let expected = 350.0 - 50.0 * (-1.0_f64).exp();
        assert!((t_k - expected).abs() < 0.4, "{m}: {t_k} {expected}");
    }
}

#[test]
fn behind_a_film_the_mean_delay_is_that_of_equilibrium() {
    // Heat stored at the end: (C + C_w) dT = m cp times the integral of dT - dT_out: F content/m.
    let params = PipeParams { insulation_resistance_k_m_w: None, ..pipe(WallModel::Film) };
    let mut rig = Rig::new(&[params], &[], 300.0);
    rig.flow(0, 1.0, 350.0);
    let (mut delay_s, mut spread) = (0.0, 0.0);
    for k in 0..3000 {
        let missing = 1.0 - (rig.step(1.0)[0] - 300.0) / 50.0;
        delay_s += missing;
        spread += 2.0 * (f64::from(k) + 0.5) * missing;
    }
    let pipe = rig.pipe(0);
    // The node before the pipe holds 1 mg.
    assert!((delay_s / pipe.capacity_kg() - 1.0).abs() < 1e-8, "{delay_s}");
    // Variance of the residence time of this model without dispersion: a drop visits the wall 2 b L/v times
    // and stays 1/k_w: 2 tau a/k_w^2 with a = g/C, k_w = g/C_w; a cell adds (tau/128)^2/12 or so.
    let Wall::Film(film) = pipe.wall else { panic!() };
    let g = film.conductance_kg_s(1.0);
    let expected = 2.0 * pipe.water_kg * (g / pipe.water_kg) / (g / pipe.wall_kg).powi(2);
    let variance = spread - delay_s * delay_s;
    assert!((variance / expected - 1.0).abs() < 0.05, "{variance} {expected}");
}

#[test]
fn dispersion_smears_like_the_error_function() {
    // D = 0.05 m2/s for 2000 s: sqrt(2 D t) = 14.14 m; half hot, half cold, at rest, far from the ends.
    let params = PipeParams {
        insulation_resistance_k_m_w: None,
        dispersion_m2_s: 0.05,
        ..pipe(WallModel::None)
    };
    for dt_s in [10.0, 100.0] {
        let mut rig = Rig::new(std::slice::from_ref(&params), &[], 300.0);
        rig.flow(0, 0.0, 300.0);
        rig.state.cells.fill(0, |x| if x < 0.5 { (340.0, 340.0) } else { (300.0, 300.0) });
        for _ in 0..(2000.0 / dt_s) as usize {
            rig.step(dt_s);
        }
        let mean = |from: f64, to: f64| rig.state.cells.mean_k(0, from, to).unwrap();
        // erf((x - 50)/(sigma sqrt 2)) at 1/2, 1 and 2 sigma: 0.382925, 0.682689, 0.954500
        for (sigmas, erf) in [(0.5, 0.382_925), (1.0, 0.682_689), (2.0, 0.954_500)] {
            let x = sigmas * 0.1414;
            let hot = mean(0.5 - x - 0.01, 0.5 - x + 0.01);
            let cold = mean(0.5 + x - 0.01, 0.5 + x + 0.01);
            assert!((hot - (320.0 + 20.0 * erf)).abs() < 0.15, "{dt_s} {sigmas}: {hot}");
            assert!((hot + cold - 640.0).abs() < 1e-6, "symmetric: {hot} {cold}");
        }
    }
}

#[test]
fn standing_water_cools_with_its_wall() {
    // tau = 2 (C' + C_w') with C' = 32 830 and C_w' = 7850 * 460 * pi/4 (0.108^2 - 0.1^2) = 4719 J/(m K):
    // 75 098 s; after 10 h at 350 K: 280 + 70 e^(-0.47937) = 323.34 K. A film of Nu = 3.66 (0.145 K m/W)
    // makes the water a little slower.
    for (wall, expected_k, tolerance_k) in [
        (WallModel::Equilibrium, 323.34, 0.01),
        (WallModel::EndVolume, 323.34, 0.01),
        (WallModel::Film, 323.34, 2.0),
        // tau = 65 660 s
        (WallModel::None, 320.46, 0.01),
    ] {
        let mut rig = Rig::new(&[pipe(wall)], &[], 350.0);
        rig.flow(0, 0.0, 300.0);
        for _ in 0..10 {
            rig.step(3600.0);
        }
        let t_k = rig.state.pipe_mean_k(0).unwrap();
        assert!((t_k - expected_k).abs() < tolerance_k, "{wall:?}: {t_k}");
        // Three times the loss is three times the time.
        let params = PipeParams { standstill_loss_factor: 3.0, ..pipe(wall) };
        let mut faster = Rig::new(&[params], &[], 350.0);
        faster.flow(0, 0.0, 300.0);
        for _ in 0..10 {
            faster.step(1200.0);
        }
        let faster_k = faster.state.pipe_mean_k(0).unwrap();
        assert!((faster_k - t_k).abs() < 1e-9 || wall == WallModel::Film, "{faster_k} {t_k}");
    }
}

#[test]
fn the_steady_state_stays_with_every_wall() {
    // NTU = 100/(2 * 4180 * 0.5) = 0.023923: outlet 280 + 60 e^-NTU = 338.582 K.
    for wall in WALLS {
        for m in [0.5, -0.5] {
            let mut rig = Rig::new(&[pipe(wall)], &[], 300.0);
            rig.flow(0, m, 340.0);
            rig.settle();
            let settled_w = rig.state.q_loss_w[0];
            for _ in 0..40 {
                let t_k = rig.step(60.0)[0];
                assert!((t_k - 338.582).abs() < 0.01, "{wall:?} {m}: {t_k}");
                let loss_w = rig.state.q_loss_w[0];
                assert!((loss_w / settled_w - 1.0).abs() < 1e-3, "{wall:?}: {loss_w} {settled_w}");
            }
        }
    }
}

#[test]
fn the_steady_profile_of_a_pipe_that_cools_down_stays() {
    // At 0.005 kg/s NTU = 2.3923: outlet 280 + 60 e^-2.3923 = 285.485 K. A straight line from end to end holds 312.74 K in the
    // middle, the exponential 298.14: what leaves after half of the content would be 14.6 e^-1.196 = 4.4 K too warm.
    for m in [0.005, -0.005] {
        let mut rig = Rig::new(&[pipe(WallModel::None)], &[], 300.0);
        rig.flow(0, m, 340.0);
        rig.settle();
        let settled_w = rig.state.q_loss_w[0];
        // 785.4 kg pass in 43.6 h.
        for _ in 0..100 {
            let t_k = rig.step(1800.0)[0];
            assert!((t_k - 285.485).abs() < 1e-3, "{m}: {t_k}");
            let loss_w = rig.state.q_loss_w[0];
            assert!((loss_w / settled_w - 1.0).abs() < 1e-4, "{m}: {loss_w} {settled_w}");
        }
    }
}

fn pair(reversed: bool, conductance_w_k: f64) -> Rig {
    let params = PipeParams { insulation_resistance_k_m_w: None, ..pipe(WallModel::None) };
    let coupling = Coupling {
        edges: [EdgeId::from_index(0), EdgeId::from_index(1)],
        reversed,
        conductance_w_k,
    };
    Rig::new(&[params.clone(), params], &[coupling], 300.0)
}

#[test]
fn standing_neighbours_approach_each_other() {
    // C = 785.4 * 4180 = 3.283e6 J/K each, G = 50 W/K: the difference of 40 K falls with
    // C/(2 G) = 32 830 s: after 10 h 40 e^(-1.09656) = 13.361 K, around a mean of 320 K.
    let mut rig = pair(false, 50.0);
    rig.state.fill_pipe(0, 340.0);
    rig.flow(0, 0.0, 300.0);
    rig.flow(1, 0.0, 300.0);
    for _ in 0..60 {
        rig.step(600.0);
    }
    let (one, two) = (rig.state.pipe_mean_k(0).unwrap(), rig.state.pipe_mean_k(1).unwrap());
    assert!((one - two - 13.361).abs() < 1e-3 && (one + two - 640.0).abs() < 1e-9, "{one} {two}");
}

#[test]
fn neighbours_are_a_heat_exchanger_in_the_steady_state() {
    // Equal flows of 0.05 kg/s, G = 50 W/K: NTU = 50/209 = 0.23923. Counter-flow: NTU/(1 + NTU) =
    // 0.19305 of 40 K; parallel (1 - e^(-2 NTU))/2 = 0.19014.
    for (reversed, flow, effectiveness) in
        [(false, -0.05, 0.193_05), (true, 0.05, 0.193_05), (false, 0.05, 0.190_14)]
    {
        let mut rig = pair(reversed, 50.0);
        rig.flow(0, 0.05, 340.0);
        rig.flow(1, flow, 300.0);
        rig.settle();
        let given = rig.state.q_flow_w;
        assert!((given[0] + given[1]).abs() < 1e-6, "{given:?}");
        assert!((given[1] / (209.0 * 40.0 * effectiveness) - 1.0).abs() < 2e-3, "{given:?}");
        // The profile stays when it is stepped.
        rig.state.q_flow_w = given;
        for _ in 0..50 {
            let out = rig.step(300.0);
            let expected = 340.0 - 40.0 * effectiveness;
            assert!((out[0] - expected).abs() < 0.01, "{reversed} {flow}: {} {expected}", out[0]);
        }
    }
}

#[test]
fn an_end_of_a_pipe_is_what_is_there() {
    for wall in WALLS {
        let mut rig = Rig::new(&[pipe(wall)], &[], 300.0);
        rig.flow(0, 0.5, 340.0);
        rig.step(60.0);
        let end = |port: Port| rig.state.pipe_end_k(&rig.network, 0, port).unwrap();
        assert!(end(Port::A) > 330.0 && end(Port::B) < 300.1, "{wall:?}");
    }
}
