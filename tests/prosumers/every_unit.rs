//! What every registered thermal unit keeps: heat closes over every step, whatever its ports get, and its answers are
//! numbers.
#![allow(clippy::unwrap_used)]

use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use anergy_prosumer::equipment::{Equipment, EquipmentParams, WITHOUT_PORTS};
use serde_json::{Value, json};

/// What must be said of a kind; a new kind needs a line.
fn least(kind: &str) -> Value {
    match kind {
        "prescribed_source" => json!({ "supply_k": 333.15, "v_flow_m3_s": 1e-4 }),
        "heat_load" => json!({ "load_w": 8000.0, "temperature_difference_k": 20.0 }),
        "cooling_load" => json!({ "load_w": 4000.0, "temperature_difference_k": 5.0 }),
        "heat_source" => json!({ "supply_k": 343.15 }),
        "ideal_house" => json!({ "sent_k": 328.15, "v_flow_m3_s": 1e-4 }),
        "building" => json!({ "heating": true, "cooling": true }),
        "storage" => json!({
            "volume_m3": 0.8,
            "height_m": 1.7,
            "ports": {
                "charge": { "inlet_m": 1.6, "outlet_m": 0.3 },
                "discharge": { "inlet_m": 0.1, "outlet_m": 1.0 }
            },
            "coils": { "solar": { "area_m2": 2.0, "inlet_m": 0.8, "outlet_m": 0.1 } },
            "rod": { "power_w": 6000.0, "bottom_m": 0.9, "top_m": 1.2 }
        }),
        // Warm air, so that its pump runs at night.
        "solar_collector" => json!({ "t_outdoor_k": 350.0 }),
        "domestic_hot_water" => json!({ "daily_m3": 0.3, "circulation_loss_w": 100.0 }),
        "air_source_heat_pump"
        | "booster_heat_pump"
        | "booster_transfer_station"
        | "direct_exchanger"
        | "balancing_exchanger"
        | "brine_heat_pump"
        | "mixing_station"
        | "condensing_boiler"
        | "chp"
        | "stirling_chp"
        | "pv"
        | "battery"
        | "household"
        | "electric_load"
        | "electric_vehicle"
        | "grid_connection" => json!({}),
        _ => panic!("say in tests/prosumers/every_unit.rs what a {kind} needs"),
    }
}

/// A reproducible stream of numbers from 0 to 1.
struct Stream(u64);

impl Stream {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

fn outlet_k(outlet: &Outlet, m_flow_kg_s: f64, t_in_k: f64, cp: f64) -> f64 {
    let capacity_w_k = m_flow_kg_s.abs() * cp;
    let warmed = |q_w: f64| if capacity_w_k > 0.0 { t_in_k + q_w / capacity_w_k } else { t_in_k };
    match *outlet {
        Outlet::HeatFlow(q_w) => warmed(q_w),
        Outlet::Warmed { wanted_w, hottest_k } => warmed(wanted_w).min(hottest_k.max(t_in_k)),
        Outlet::Cooled { wanted_w, coldest_k } => warmed(-wanted_w).max(coldest_k.min(t_in_k)),
        Outlet::Linear { constant_k, of_inlet } => constant_k + of_inlet * t_in_k,
        Outlet::Exchange { w_k, other_k } => {
            let (constant_k, of_inlet) = Outlet::of_exchange(w_k, other_k, capacity_w_k);
            constant_k + of_inlet * t_in_k
        }
        Outlet::Stirred { t_k, heat_w, heat_capacity_j_k, dt_s } => {
            let (constant_k, of_inlet) =
                Outlet::of_stirred(t_k, heat_w, heat_capacity_j_k, dt_s, capacity_w_k);
            constant_k + of_inlet * t_in_k
        }
        Outlet::Temperature(_) | Outlet::Ends { .. } => outlet.temperature_k(m_flow_kg_s).unwrap(),
    }
}

/// One step with random signals and flows; returns what is left over, J, and its scale.
fn step(
    unit: &Equipment,
    ports: &mut [PortFlow],
    state: &mut [f64],
    out: &mut [f64],
    random: &mut Stream,
) -> (f64, f64) {
    let cp = Medium::default().heat_capacity_j_kg_k;
    let dt_s = [1.0, 10.0, 60.0, 300.0, 900.0, 3600.0][(random.next() * 6.0) as usize];
    let signals: Vec<f64> = unit
        .inputs()
        .iter()
        .map(|input| {
            let ratio = input.min == 0.0 && input.max == 1.0;
            if ratio && random.next() < 0.5 { random.next().round() } else { input.initial }
        })
        .collect();
    let signals = Signals(&signals);
    let mut wanted = vec![PortRequest::default(); ports.len()];
    let before_j = unit.stored_j(state);
    unit.begin(dt_s, state);
    let places = unit.ports();
    let given: Vec<f64> = places.iter().map(|_| random.between(0.0, 0.4)).collect();
    for (port, (place, given)) in ports.iter_mut().zip(places.iter().zip(&given)) {
        if !place.sets_flow {
            port.m_flow_kg_s = *given;
        }
    }
    unit.request(&signals, ports, state, &mut wanted);
    for leads in [true, false] {
        for (i, place) in places.iter().enumerate().filter(|(_, place)| place.leads == leads) {
            let share = if leads { random.between(0.2, 1.0) } else { 1.0 };
            let m_flow_kg_s =
                if place.sets_flow { share * wanted[i].m_flow_kg_s } else { given[i] };
            let t_in_k = random.between(284.0, 320.0);
            let t_out_k = outlet_k(&wanted[i].outlet, m_flow_kg_s, t_in_k, cp);
            ports[i] = PortFlow { m_flow_kg_s, t_in_k, t_out_k };
            if leads {
                unit.respond(i, &signals, ports, state, &mut wanted);
            }
        }
    }
    let exchange = unit.advance(dt_s, &signals, ports, state, out);
    let water_w: f64 =
        ports.iter().map(|port| port.m_flow_kg_s.abs() * cp * (port.t_out_k - port.t_in_k)).sum();
    let stored_j = unit.stored_j(state) - before_j;
    let moved: f64 = ports
        .iter()
        .map(|port| (port.m_flow_kg_s * cp * (port.t_out_k - port.t_in_k)).abs())
        .chain([exchange.electric_w.abs(), exchange.external_w.abs()])
        .sum();
    let left_j = stored_j - dt_s * (exchange.electric_w + exchange.external_w - water_w);
    // What is held is a large number in doubles.
    (left_j, dt_s * moved + 1e-5 * before_j.abs() + 1.0)
}

#[test]
fn heat_closes_over_every_step() {
    let plain = EquipmentParams::KINDS.iter().map(|kind| (*kind, least(kind)));
    for (kind, fields) in plain.chain([("chp", json!({ "content_j_k": 60_000.0 }))]) {
        let params = EquipmentParams::deserialize(kind, fields).unwrap().unwrap();
        let unit = params.build(&Medium::default()).unwrap();
        assert_eq!(unit.ports().is_empty(), WITHOUT_PORTS.contains(&kind), "{kind}");
        let mut random = Stream(42);
        let mut state = unit.initial_state(300.0);
        let mut out = vec![0.0; unit.outputs().len()];
        let at_rest = PortFlow { m_flow_kg_s: 0.0, t_in_k: 300.0, t_out_k: 300.0 };
        let mut ports = vec![at_rest; unit.ports().len()];
        for i in 0..2000 {
            let (left_j, scale_j) = step(&unit, &mut ports, &mut state, &mut out, &mut random);
            assert!(left_j.abs() < 1e-9 * scale_j, "{kind}, step {i}: {left_j} J of {scale_j} J");
            let numbers = state.iter().chain(&out);
            assert!(numbers.clone().all(|x| !x.is_nan()), "{kind}, step {i}: {state:?} {out:?}");
        }
    }
}
