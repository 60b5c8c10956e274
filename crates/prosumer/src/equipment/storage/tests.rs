//! The storage as a whole: heat of every step, promises, fronts, ports, entrainment.

use super::*;
use crate::thermal_unit::ThermalUnit;
use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;

const CP: f64 = 4180.0;

fn port(inlet_m: f64, outlet_m: f64) -> StoragePort {
    StoragePort { inlet_m: Some(inlet_m), outlet_m: Some(outlet_m), ..StoragePort::default() }
}

/// Nothing but advection, unless it is added.
fn insulated(layers: usize, scheme: Scheme) -> StorageParams {
    StorageParams {
        layers,
        scheme,
        u_w_m2_k: Some(0.0),
        conductivity_w_m_k: 0.0,
        buoyancy_w_k: 0.0,
        initial_k: Some(303.15),
        ..StorageParams::default()
    }
}

/// A storage that runs, with flows that take what it promises.
struct Run {
    unit: Storage,
    state: Vec<f64>,
    got: Vec<PortFlow>,
    out: Vec<f64>,
    inputs: Vec<f64>,
    /// What a step left open of its balance of heat, relative to its largest part.
    open: f64,
}

impl Run {
    fn new(params: &StorageParams) -> Self {
        let unit = params.build(&Medium::default()).unwrap();
        let state = unit.initial_state(293.15);
        let got = vec![PortFlow::default(); unit.ports().len()];
        let out = vec![0.0; unit.outputs().len()];
        let inputs = unit.inputs().iter().map(|input| input.initial).collect();
        Self { unit, state, got, out, inputs, open: 0.0 }
    }

    fn step(&mut self, dt_s: f64, streams: &[(f64, f64)]) {
        let signals = Signals(&self.inputs);
        let mut wanted = vec![PortRequest::default(); streams.len()];
        self.unit.request(&signals, &self.got, &mut self.state, &mut wanted);
        for ((got, wanted), (m_flow_kg_s, t_in_k)) in
            self.got.iter_mut().zip(&wanted).zip(streams.iter().copied())
        {
            let t_out_k = match wanted.outlet {
                Outlet::Ends { a_k, .. } if m_flow_kg_s < 0.0 => a_k,
                Outlet::Ends { b_k, .. } => b_k,
                Outlet::Linear { constant_k, of_inlet } => constant_k + of_inlet * t_in_k,
                other => panic!("{other:?}"),
            };
            *got = PortFlow { m_flow_kg_s, t_in_k, t_out_k };
        }
        let before = self.unit.stored_j(&self.state);
        let exchange = self.unit.advance(dt_s, &signals, &self.got, &mut self.state, &mut self.out);
        let stored = self.unit.stored_j(&self.state) - before;
        let streams =
            self.got.iter().map(|got| got.m_flow_kg_s.abs() * CP * (got.t_in_k - got.t_out_k));
        let parts: Vec<f64> = streams
            .chain([exchange.electric_w, exchange.external_w])
            .map(|power_w| power_w * dt_s)
            .collect();
        // A content of 1e8 J is known to 1e-8 J per layer.
        let largest = parts.iter().fold(before * 1e-6, |largest, part| largest.max(part.abs()));
        self.open = self.open.max((stored - parts.iter().sum::<f64>()).abs() / largest);
    }

    fn channel(&self, name: &str) -> f64 {
        let place = self.unit.outputs().iter().position(|output| output.name == name);
        self.out[place.unwrap_or_else(|| panic!("no channel {name}"))]
    }

    fn layer_degc(&self, layer: usize) -> f64 {
        self.channel(&format!("t_{layer}_k")) - 273.15
    }
}

/// The same random numbers on every platform.
struct Random(u64);

impl Random {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Everything that a storage can have.
fn full(layers: usize, scheme: Scheme, buoyancy: Buoyancy) -> StorageParams {
    let connection = |inlet_m, outlet_m| StorageConnection {
        inlet_m: Some(inlet_m),
        outlet_m: Some(outlet_m),
        ..StorageConnection::default()
    };
    let switched = StoragePort {
        positions: vec![connection(1.7, 1.0), connection(1.0, 0.1)],
        ..StoragePort::default()
    };
    StorageParams {
        layers,
        scheme,
        buoyancy,
        ports: [("charge", port(1.6, 0.26)), ("load", port(0.05, 1.7)), ("switched", switched)]
            .map(|(name, port)| (name.to_owned(), port))
            .into(),
        coils: BTreeMap::from([(
            "solar".to_owned(),
            StorageCoil {
                inlet_m: Some(0.9),
                outlet_m: Some(0.1),
                volume_m3: 0.0165,
                flow_exponent: 0.5,
                difference_exponent: 0.25,
                ..serde_json::from_str("{\"area_m2\": 2.5}").unwrap()
            },
        )]),
        rod: Some(StorageRod {
            bottom_m: Some(0.9),
            top_m: Some(1.3),
            ..serde_json::from_str("{\"power_w\": 6000}").unwrap()
        }),
        entrainment_m: 0.1,
        bridges_w_k: vec![0.1; layers],
        initial_bottom_k: Some(303.15),
        initial_top_k: Some(343.15),
        ..StorageParams::default()
    }
}

#[test]
fn heat_of_every_step_for_random_flows_and_steps() {
    let mut random = Random(7);
    let schemes = [Scheme::MixedLayers, Scheme::PlugFlow];
    for (layers, scheme) in [3, 10, 100, 200].into_iter().flat_map(|n| schemes.map(|s| (n, s))) {
        for buoyancy in [Buoyancy::Gradual, Buoyancy::AtOnce] {
            let mut run = Run::new(&full(layers, scheme, buoyancy));
            let (mut low, mut high) = (273.15_f64, 0.0_f64);
            for _ in 0..3000 / (layers + 20) {
                let dt_s = 10.0 * 360.0_f64.powf(random.between(0.0, 1.0));
                let largest = 0.15 * 785.0 / dt_s.max(300.0);
                let mut stream = || {
                    let on = random.between(0.0, 1.0) < 0.7;
                    let m = if on { random.between(-largest, largest) } else { 0.0 };
                    (m, random.between(290.0, 360.0))
                };
                let streams = [stream(), stream(), stream(), stream()];
                run.inputs[1] = random.between(-0.5, 1.0).max(0.0);
                run.inputs[3] = random.between(-0.5, 1.5).clamp(0.0, 1.0);
                run.step(dt_s, &streams);
                for layer in 1..=layers {
                    low = low.min(run.layer_degc(layer));
                    high = high.max(run.layer_degc(layer));
                }
            }
            assert!(run.open < 1e-9, "{layers} {scheme:?}: {}", run.open);
            // Flows that jump in every step are the worst for promises; still no water is outside of what
            // enters (17 to 87 degC) and what the rod may reach (95 degC).
            assert!(low > 10.0 && high < 95.0 + 1e-6, "{layers} {scheme:?}: {low} to {high} degC");
        }
    }
}

#[test]
fn in_steady_operation_promises_are_kept() {
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        for dt_s in [10.0, 60.0, 600.0] {
            let mut run = Run::new(&insulated(50, scheme));
            for step in 0..(5400.0 / dt_s) as usize {
                run.step(dt_s, &[(0.15, 343.15)]);
                // The first step finds the flow it did not know of.
                assert!(
                    step == 0 || run.channel("outlet_miss_k") < 1e-6,
                    "{scheme:?} {dt_s} {step}"
                );
            }
        }
    }
}

#[test]
fn only_the_layers_of_the_position_receive_flow() {
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        let layers = |inlet, outlet| StorageConnection {
            inlet_layer: Some(inlet),
            outlet_layer: Some(outlet),
            ..StorageConnection::default()
        };
        let heat_pump =
            StoragePort { positions: vec![layers(5, 1), layers(9, 6)], ..StoragePort::default() };
        let params = StorageParams {
            ports: BTreeMap::from([("heat_pump".to_owned(), heat_pump)]),
            ..insulated(10, scheme)
        };
        for (position, warm) in [(0.0, 2..=5), (1.0, 7..=9)] {
            let mut run = Run::new(&params);
            assert_eq!(run.unit.inputs()[1].name, "heat_pump_position");
            run.inputs[1] = position;
            (0..50).for_each(|_| run.step(60.0, &[(0.08, 333.15)]));
            for layer in 1..=10 {
                let stays = (run.layer_degc(layer) - 30.0).abs() < 1e-9;
                let near_outlet = layer == warm.start() - 1;
                assert!(near_outlet || stays != warm.contains(&layer), "{position} {layer}");
            }
        }
        // Half of the time or half of the flow: each gets half of the heat.
        let mut run = Run::new(&params);
        run.inputs[1] = 0.5;
        run.step(60.0, &[(0.1, 333.15)]);
        let risen = |layers: std::ops::RangeInclusive<usize>| {
            layers.map(|l| run.layer_degc(l) - 30.0).sum::<f64>()
        };
        assert!((risen(1..=5) - risen(6..=10)).abs() < 1e-9, "{scheme:?}");
        assert!((risen(1..=10) - 3.0 / 78.5 * 60.0).abs() < 1.0);
    }
}

#[test]
fn a_front_stays_sharp_in_plug_flow() {
    // 785 kg, 0.1 kg/s from 1.6 to 0.26 m: after 3000 s the front has sunk by 300/785 * 1.755 m = 0.671 m to
    // 0.929 m, that is 0.5295 * 10 = layer 6 (0.295 of it are cold).
    for (dt_s, layers) in [(30.0, 10), (500.0, 10), (30.0, 100)] {
        let mut run = Run::new(&insulated(layers, Scheme::PlugFlow));
        (0..(3000.0 / dt_s) as usize).for_each(|_| run.step(dt_s, &[(0.1, 343.15)]));
        let height = 1.6 - 300.0 / 785.0 * 1.755;
        let between = (1..=layers).filter(|l| {
            let t = run.layer_degc(*l);
            let port = (1.6 / 1.755 * layers as f64) as usize + 1;
            *l < port && t > 30.0 + 1e-6 && t < 70.0 - 1e-6
        });
        let between: Vec<usize> = between.collect();
        let front = (height / 1.755 * layers as f64) as usize + 1;
        assert_eq!(between, [front], "{dt_s} {layers}");
        assert!(run.open < 1e-9);
    }
    // A temperature that changes all the time makes a parcel per part; the bound merges them, and still the
    // profile is that of the inlet, where ten mixed layers have lost it.
    let errors = [Scheme::PlugFlow, Scheme::MixedLayers].map(|scheme| {
        let mut run = Run::new(&insulated(10, scheme));
        let inlet_degc = |t_s: f64| 50.0 + 20.0 * (t_s / 700.0).sin();
        for step in 0..500 {
            let t_s = f64::from(step) * 10.0;
            run.step(10.0, &[(0.1, 273.15 + inlet_degc(t_s + 5.0))]);
        }
        // Water in the middle of layer l entered (1.6 m - z)/1.755 m * 785/0.1 s before the end.
        let error = |layer: usize| {
            let z_m = (layer as f64 - 0.5) * 0.1755;
            let mean = (0..100).map(|k| {
                let z_m = z_m + 0.1755 * ((f64::from(k) + 0.5) / 100.0 - 0.5);
                inlet_degc(5000.0 - (1.6 - z_m) / 1.755 * 7850.0) / 100.0
            });
            (run.layer_degc(layer) - mean.sum::<f64>()).abs()
        };
        (5..=9).map(error).fold(0.0, f64::max)
    });
    assert!(errors[0] < 2.0 && errors[1] > 3.0 * errors[0], "{errors:?}");
}

#[test]
fn reversed_flow_enters_at_the_outlet() {
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        let mut run = Run::new(&StorageParams {
            initial_k: None,
            initial_bottom_k: Some(303.15),
            initial_top_k: Some(348.15),
            ..insulated(10, scheme)
        });
        run.step(60.0, &[(-0.2, 290.15)]);
        // Leaves at 1.6 m: layer 10, 75 degC.
        assert!((run.got[0].t_out_k - 348.15).abs() < 1e-9);
        assert!(run.layer_degc(2) < 35.0 - 1e-3 && (run.layer_degc(1) - 30.0).abs() < 1e-9);
        assert!(run.open < 1e-9);
    }
}

#[test]
fn entrainment_warms_what_lies_below_the_outlet() {
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        let lowest = [0.0, 0.2].map(|entrainment_m| {
            let mut run = Run::new(&StorageParams { entrainment_m, ..insulated(50, scheme) });
            (0..120).for_each(|_| run.step(60.0, &[(0.2, 343.15)]));
            // The lowest two layers of 3.5 cm are deeper than 0.2 m below the port, the fifth is not.
            (run.layer_degc(1), run.layer_degc(5))
        });
        assert!(lowest[1].1 > lowest[0].1 + 20.0 && lowest[0].1 < 30.0 + 1e-9, "{lowest:?}");
        assert!((lowest[1].0 - 30.0).abs() < 1e-9, "{scheme:?} {lowest:?}");
    }
}

#[test]
fn a_coil_stays_between_its_limits() {
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        for dt_s in [10.0, 900.0] {
            let mut run = Run::new(&StorageParams {
                u_w_m2_k: Some(0.0),
                ..full(10, scheme, Buoyancy::Gradual)
            });
            let mut before = 0.0;
            for _ in 0..20 {
                run.step(dt_s, &[(0.0, 300.0), (0.0, 300.0), (0.0, 300.0), (0.08, 353.15)]);
                let outlet = run.got[3].t_out_k;
                assert!((303.0..353.15).contains(&outlet), "{outlet}");
                assert!(run.channel("energy_j") > before);
                before = run.channel("energy_j");
            }
            // What the coil warms from below rises: no layer is colder than the one below it by more than
            // buoyancy needs to carry the heat of the coil (some 10 kW through 0.9 kW/K).
            for layer in 2..=10 {
                assert!(run.layer_degc(layer) > run.layer_degc(layer - 1) - 15.0);
            }
        }
    }
}

#[test]
fn ten_layers_approach_a_hundred() {
    // Upwind mixing disperses a front that moved by the share x of the height to a normal distribution of
    // variance x/n. Its mean distance from that of n' layers is 40 K (s - s') sqrt(2/pi); x = 400/785.
    let profile = |layers: usize| -> Vec<f64> {
        let mut run = Run::new(&StorageParams {
            ports: BTreeMap::from([("charge".to_owned(), port(1.755, 0.0))]),
            ..insulated(layers, Scheme::MixedLayers)
        });
        (0..400).for_each(|_| run.step(10.0, &[(0.1, 343.15)]));
        (0..200).map(|i| run.layer_degc(i * layers / 200 + 1)).collect()
    };
    let finest = profile(200);
    let deviation = |layers: usize| (400.0 / 785.0 / layers as f64).sqrt();
    for layers in [10, 20, 40, 100] {
        let differences =
            profile(layers).into_iter().zip(&finest).map(|(t, fine)| (t - fine).abs());
        let found = differences.sum::<f64>() / 200.0;
        let expected = 40.0 * (deviation(layers) - deviation(200)) * 0.797_885;
        assert!((found / expected - 1.0).abs() < 0.15, "{layers}: {found} K, expected {expected}");
    }
}

#[test]
fn a_storage_that_stands_cools_exponentially() {
    // U A = 0.35 * 5.0555 = 1.7694 W/K, C = 785 * 4180 = 3.2813 MJ/K: after two days exp(-0.093182) = 0.91103 of 50 K are left
    // if it stays mixed, which one layer does.
    let mut run = Run::new(&StorageParams {
        layers: 1,
        ports: BTreeMap::new(),
        initial_k: Some(341.15),
        ..StorageParams::default()
    });
    (0..2880).for_each(|_| run.step(60.0, &[]));
    assert!((run.layer_degc(1) - 18.0 - 50.0 * 0.911_03).abs() < 1e-3, "{}", run.layer_degc(1));
    assert!((run.channel("loss_j") - 3.281_3e6 * 50.0 * (1.0 - 0.911_03)).abs() < 2e4);
    // soc: (63.5515 - 30)/60.
    assert!((run.channel("soc") - 0.559_19).abs() < 1e-4, "{}", run.channel("soc"));
}

#[test]
fn the_rod_heats_to_its_set_temperature() {
    // From 0.9 to 1.3 m it is in layers 6 (15 cm of it) to 8 (7 cm); what is above them is heated by buoyancy.
    let mut run = Run::new(&StorageParams {
        initial_bottom_k: None,
        initial_top_k: None,
        initial_k: Some(293.15),
        ..full(10, Scheme::MixedLayers, Buoyancy::Gradual)
    });
    (run.inputs[1], run.inputs[2]) = (1.0, 333.15);
    for _ in 0..600 {
        run.step(60.0, &[(0.0, 300.0); 4]);
        assert!(run.open < 1e-9);
    }
    for layer in 7..=10 {
        let t = run.layer_degc(layer);
        assert!((50.0..60.5).contains(&t), "{layer}: {t}");
    }
    assert!(run.layer_degc(1) < 21.0);
    // At least layers 7 to 10 by 30 K, at most 6 to 10 by 40 K, and losses and conduction (3 MJ each at most).
    let layer_j_k = 78.5 * CP;
    let range = 4.0 * 30.0 * layer_j_k..5.0 * 40.0 * layer_j_k + 6e6;
    assert!(range.contains(&run.channel("rod_j")), "{}", run.channel("rod_j"));
}

#[test]
fn what_cannot_be_is_refused() {
    let reason = |change: &dyn Fn(&mut StorageParams)| {
        let mut params = StorageParams::default();
        change(&mut params);
        params.build(&Medium::default()).unwrap_err().to_string()
    };
    let coil = || serde_json::from_str::<StorageCoil>("{\"area_m2\": 2}").unwrap();
    let rod = |text: &str| Some(serde_json::from_str::<StorageRod>(text).unwrap());
    for (found, expected) in [
        (reason(&|p| p.volume_m3 = -1.0), "volume_m3 = -1 must be positive"),
        (reason(&|p| p.height_m = f64::NAN), "height_m = NaN must be positive"),
        (reason(&|p| p.layers = 0), "layers = 0 must be 1 to 200"),
        (
            reason(&|p| p.initial_layers_k = vec![300.0; 3]),
            "initial_layers_k has 3 values for 10 layers",
        ),
        (reason(&|p| p.bridges_w_k = vec![1.0]), "bridges_w_k has 1 values for 10 layers"),
        (
            reason(&|p| p.initial_bottom_k = Some(300.0)),
            "give both initial_bottom_k and initial_top_k",
        ),
        (reason(&|p| (p.u_w_m2_k, p.ua_w_k) = (Some(1.0), Some(1.0))), "not both"),
        (
            reason(&|p| {
                let _ = p.ports.insert("high".to_owned(), port(2.0, 0.1));
            }),
            "ports.high has inlet_m = 2: the storage reaches from 0 to height_m = 1.755",
        ),
        (
            reason(&|p| {
                let _ = p.coils.insert("charge".to_owned(), coil());
            }),
            "ports.charge has the name of a coil",
        ),
        (
            reason(&|p| {
                let _ = p.ports.insert("flat".to_owned(), port(1.0, 1.01));
            }),
            "ports.flat enters and leaves in layer 6",
        ),
        (
            reason(&|p| {
                let _ = p.coils.insert("solar".to_owned(), coil());
            }),
            "coils.solar: give either inlet_m and outlet_m or inlet_layer and outlet_layer",
        ),
        (
            reason(&|p| p.rod = rod("{\"power_w\": 1}")),
            "rod: give either bottom_m and top_m or layer",
        ),
        (
            reason(&|p| p.rod = rod("{\"power_w\": 0, \"layer\": 2}")),
            "rod: power_w = 0 must be positive",
        ),
        (reason(&|p| p.rod = rod("{\"power_w\": 1, \"layer\": 11}")), "rod: layer = 11 must be 1"),
        (reason(&|p| p.soc_full_k = 300.0), "soc_full_k = 300 must be above soc_empty_k"),
    ] {
        assert!(found.contains(expected), "{found}");
    }
}

#[test]
fn no_step_sends_more_through_the_tank_than_it_holds() {
    let unit = insulated(10, Scheme::MixedLayers).build(&Medium::default()).unwrap();
    let longest_s = |m_flow_kg_s: f64| {
        let stream = PortFlow { m_flow_kg_s, t_in_k: 300.0, t_out_k: 300.0 };
        unit.longest_step_s(&[stream], &[])
    };
    // 785 kg at 20 l/min in either direction: 2355 s. Whatever the flow: a minute.
    assert!((longest_s(1.0 / 3.0) - 2355.0).abs() < 1e-6);
    assert!((longest_s(-1.0 / 3.0) - 2355.0).abs() < 1e-6);
    assert_eq!((longest_s(0.0), longest_s(100.0)), (f64::INFINITY, 60.0));
}

#[test]
fn its_loss_is_that_of_all_layers() {
    // 10 m3, 4 m high: cross-section 2.5 m2, side sqrt(4 pi 2.5) 4 = 22.4200 m2, with both ends 27.4200 m2; 0.35 of each 9.5970 W/K.
    let params = StorageParams { volume_m3: 10.0, height_m: 4.0, ..StorageParams::default() };
    assert!((params.loss_w_k() - 9.5970).abs() < 1e-4);
    let given = StorageParams { ua_w_k: Some(12.0), bridges_w_k: vec![0.5; 10], ..params.clone() };
    assert_eq!(given.loss_w_k(), 17.0);
    // From 20 K above what is around.
    for params in [params, given] {
        let params = StorageParams { initial_k: Some(params.ambient_k + 20.0), ..params };
        let mut run = Run::new(&params);
        let before_j = run.unit.stored_j(&run.state);
        run.step(1.0, &[(0.0, params.ambient_k)]);
        let lost_w = before_j - run.unit.stored_j(&run.state);
        assert!((lost_w / (20.0 * params.loss_w_k()) - 1.0).abs() < 1e-3, "{lost_w}");
    }
}
