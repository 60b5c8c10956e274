//! Random parameters of every hydraulic element, within the range of real plants.
//!
//! A newly registered kind needs a line in [`params`] (or the tests that loop over all kinds fail) and
//! in [`nature`] (or nothing compiles).

use anergy_network::elements::ElementParams;
use anergy_network::elements::ball_valve::BallValveParams;
use anergy_network::elements::check_valve::CheckValveParams;
use anergy_network::elements::dp_controller::DpControllerParams;
use anergy_network::elements::flow_limiter::FlowLimiterParams;
use anergy_network::elements::flow_source::FlowSourceParams;
use anergy_network::elements::heat_exchanger::{Arrangement, HeatExchangerParams};
use anergy_network::elements::heat_meter::HeatMeterParams;
use anergy_network::elements::overflow_valve::OverflowValveParams;
use anergy_network::elements::pipe::PipeParams;
use anergy_network::elements::pressure_reducing_valve::PressureReducingValveParams;
use anergy_network::elements::pressure_source::PressureSourceParams;
use anergy_network::elements::pressure_sustaining_valve::PressureSustainingValveParams;
use anergy_network::elements::pump::{PumpMode, PumpParams};
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::elements::valve::{ValveCharacteristic, ValveCommand, ValveParams};
use anergy_network::friction::{Correlation, Transition};
use proptest::option;
use proptest::prelude::*;

/// What becomes of an element when its ends are exchanged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Nature {
    /// The same law: the flow from port a to port b changes its sign.
    Symmetric,
    /// Another law, or a cause of flow.
    Directed,
}

/// What becomes of an element when its ends are exchanged.
pub fn nature(params: &ElementParams) -> Nature {
    match params {
        ElementParams::Pipe(_)
        | ElementParams::Valve(_)
        | ElementParams::BallValve(_)
        | ElementParams::DpController(_)
        | ElementParams::PressureReducingValve(_)
        | ElementParams::PressureSustainingValve(_)
        | ElementParams::Resistance(_)
        | ElementParams::HeatMeter(_)
        | ElementParams::HeatExchanger(_) => Nature::Symmetric,
        ElementParams::Pump(_)
        | ElementParams::CheckValve(_)
        | ElementParams::FlowLimiter(_)
        | ElementParams::OverflowValve(_)
        | ElementParams::FlowSource(_)
        | ElementParams::PressureSource(_) => Nature::Directed,
    }
}

/// Random parameters of a kind.
///
/// # Panics
/// For a kind that has no line here.
pub fn params(kind: &str) -> BoxedStrategy<ElementParams> {
    match kind {
        "pipe" => pipe().prop_map(ElementParams::Pipe).boxed(),
        "pump" => pump().prop_map(ElementParams::Pump).boxed(),
        "valve" => valve().prop_map(ElementParams::Valve).boxed(),
        "ball_valve" => ball_valve().prop_map(ElementParams::BallValve).boxed(),
        "overflow_valve" => overflow_valve().prop_map(ElementParams::OverflowValve).boxed(),
        "flow_limiter" => flow_limiter().prop_map(ElementParams::FlowLimiter).boxed(),
        "dp_controller" => dp_controller().prop_map(ElementParams::DpController).boxed(),
        "pressure_reducing_valve" => {
            pressure_reducing_valve().prop_map(ElementParams::PressureReducingValve).boxed()
        }
        "pressure_sustaining_valve" => pressure_reducing_valve()
            .prop_map(|valve| {
                ElementParams::PressureSustainingValve(PressureSustainingValveParams {
                    kvs_m3_h: valve.kvs_m3_h,
                    pressure_set_pa: valve.pressure_set_pa,
                    sensed_node: valve.sensed_node,
                    band_pressure_pa: valve.band_pressure_pa,
                    lag_s: valve.lag_s,
                    leakage: valve.leakage,
                    delta_m: valve.delta_m,
                })
            })
            .boxed(),
        "check_valve" => check_valve().prop_map(ElementParams::CheckValve).boxed(),
        "heat_meter" => heat_meter().prop_map(ElementParams::HeatMeter).boxed(),
        "resistance" => resistance().prop_map(ElementParams::Resistance).boxed(),
        "heat_exchanger" => heat_exchanger().prop_map(ElementParams::HeatExchanger).boxed(),
        "flow_source" => flow_source().prop_map(ElementParams::FlowSource).boxed(),
        "pressure_source" => (-5e5..5e5)
            .prop_map(|head_pa| ElementParams::PressureSource(PressureSourceParams { head_pa }))
            .boxed(),
        other => panic!("tests/src/samples.rs has no sample of the element \"{other}\""),
    }
}

/// Numbers of all magnitudes between two positive ones.
pub fn logarithmic(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.ln()..high.ln()).prop_map(f64::exp)
}

fn pipe() -> impl Strategy<Value = PipeParams> {
    let law = (
        prop_oneof![
            Just((Correlation::Haaland, Transition::Cubic)),
            Just((Correlation::Haaland, Transition::Linear)),
            Just((Correlation::Colebrook, Transition::Cubic)),
            Just((Correlation::SwameeJain, Transition::Cubic)),
            Just((Correlation::SwameeJain, Transition::Dunlop)),
            Just((Correlation::HazenWilliams, Transition::Cubic)),
            Just((Correlation::ChezyManning, Transition::Cubic)),
        ],
        option::of(0.05..3.0),
        0.005..0.5,
        60.0..150.0,
        0.008..0.03,
        option::of(0.005..0.1),
    );
    let heat = (option::of(0.5..10.0), option::of(263.0..303.0), option::of(275.0..370.0));
    let wall = prop_oneof![Just(0.0), logarithmic(1e-6, 0.05)];
    let zeta = prop_oneof![Just(0.0), 0.1..50.0];
    (logarithmic(0.1, 5000.0), logarithmic(0.005, 1.2), wall, zeta, law, heat).prop_map(
        |(length_m, inner_diameter_m, wall, zeta, law, heat)| {
            let ((friction, transition), velocity, delta_m, c, n, factor) = law;
            let factor = factor.filter(|_| friction == Correlation::default());
            let hazen_williams = friction == Correlation::HazenWilliams;
            let chezy_manning = friction == Correlation::ChezyManning;
            PipeParams {
                length_m,
                inner_diameter_m,
                roughness_m: wall * inner_diameter_m,
                zeta,
                friction,
                transition,
                hazen_williams_c: hazen_williams.then_some(c),
                manning_n: chezy_manning.then_some(n),
                fixed_velocity_m_s: velocity
                    .filter(|_| !hazen_williams && !chezy_manning && factor.is_none()),
                friction_factor: factor,
                delta_m,
                insulation_resistance_k_m_w: heat.0,
                surroundings_k: heat.1,
                initial_k: heat.2,
                ..PipeParams::default()
            }
        },
    )
}

/// A pump with any curve in any mode.
fn pump() -> impl Strategy<Value = PumpParams> {
    let curve = prop_oneof![formula_pump(), table_pump(), polynomial_pump()];
    let mode = prop_oneof![
        2 => Just(PumpMode::Speed),
        1 => Just(PumpMode::Flow),
        1 => Just(PumpMode::Head)
    ];
    (curve, mode, 0.0..0.9).prop_map(|(pump, mode, share): (_, _, f64)| {
        if mode == PumpMode::Speed {
            // A third of them turn both ways.
            return PumpParams { reversible: share < 0.3, ..pump };
        }
        let still = PumpParams { mode, speed: 0.0, initial_speed: 0.0, speed_min: 0.0, ..pump };
        match mode {
            PumpMode::Head => {
                let head_pa = still.head_max_pa.map(|head| share * head);
                // Some of them follow the flow.
                let mode = if share > 0.6 { PumpMode::ProportionalHead } else { mode };
                PumpParams { head_pa, mode, ..still }
            }
            _ => {
                // Whatever the density of the medium.
                let flow = still.free_flow_m3_s.map(|flow| share * 965.0 * flow);
                PumpParams { m_flow_set_kg_s: flow, ..still }
            }
        }
    })
}

/// A quadratic curve or a power law.
fn formula_pump() -> impl Strategy<Value = PumpParams> {
    let exponent = option::of(prop_oneof![0.5..3.0, 0.1..20.0]);
    (logarithmic(1e3, 2e6), logarithmic(1e-5, 0.3), exponent, drive()).prop_map(
        |(head, flow, curve_exponent, drive)| PumpParams {
            head_max_pa: Some(head),
            free_flow_m3_s: Some(flow),
            curve_exponent,
            ..drive
        },
    )
}

/// A fitted polynomial: `1 + c1 x - c2 x^2 - c3 x^3` over the relative flow, which may rise a little at
/// low flow, with or without its end.
fn polynomial_pump() -> impl Strategy<Value = PumpParams> {
    let shape = (-0.5..0.15, 0.2..1.0, 0.0..1.0, option::of(0.3..1.2));
    (logarithmic(1e3, 2e6), logarithmic(1e-5, 0.3), shape, drive()).prop_map(
        |(head, flow, (c1, c2, c3, end), drive): (f64, f64, (f64, f64, f64, Option<f64>), _)| {
            let powers = [1.0, c1, -c2, -c3].into_iter().zip(0..);
            PumpParams {
                head_max_pa: None,
                free_flow_m3_s: None,
                curve_polynomial: powers.map(|(c, i)| c * head / flow.powi(i)).collect(),
                curve_v_flow_max_m3_s: end.map(|end: f64| end * flow),
                ..drive
            }
        },
    )
}

/// A curve of a catalogue: steeper with the flow, but with points read off by eye.
fn table_pump() -> impl Strategy<Value = PumpParams> {
    // Widths, and how the curve steepens from one piece to the next.
    let steps = prop::collection::vec((0.2..1.0, 0.8..3.0), 1..8);
    let curve = (logarithmic(1e3, 2e6), logarithmic(1e-5, 0.3), steps, 0.0..0.9);
    (curve, drive()).prop_map(|((head_max, flow_max, widths, head_at_end), drive)| {
        let mut steepness = 1.0;
        let steps: Vec<(f64, f64)> = widths
            .into_iter()
            .map(|(width, steepening): (f64, f64)| {
                steepness *= steepening;
                (width, width * steepness)
            })
            .collect();
        let whole = steps.iter().fold((0.0, 0.0), |sum, step| (sum.0 + step.0, sum.1 + step.1));
        let (mut v_flow, mut head) = (vec![0.0], vec![head_max]);
        let (mut v_sum, mut head_sum) = (0.0, 0.0);
        for (v_step, head_step) in steps {
            (v_sum, head_sum) = (v_sum + v_step, head_sum + head_step);
            v_flow.push(flow_max * v_sum / whole.0);
            head.push(head_max * (1.0 - (1.0 - head_at_end) * head_sum / whole.1));
        }
        // Now and then it rises at low flow.
        if head_at_end > 0.7 {
            head[0] *= 0.95;
        }
        PumpParams {
            head_max_pa: None,
            free_flow_m3_s: None,
            curve_v_flow_m3_s: v_flow,
            curve_head_pa: head,
            ..drive
        }
    })
}

/// The fields of a pump besides its curve.
fn drive() -> impl Strategy<Value = PumpParams> {
    let numbers = (0.0..1.0, 0.0..0.2, 0.0..30.0, 0.0..20.0, 0.005..0.1);
    let efficiency = (0.1..0.9, option::of((logarithmic(1e-5, 0.1), 0.0..0.8)), 0.0..1.0);
    (numbers, efficiency).prop_map(|(numbers, (constant, table, heat_to_water))| {
        let (speed, speed_min, rise_time_s, standby_w, delta_m) = numbers;
        PumpParams {
            speed,
            initial_speed: 1.0 - speed,
            speed_min,
            rise_time_s,
            efficiency_hydraulic: constant,
            efficiency_motor: constant,
            efficiency_v_flow_m3_s: table.map_or(vec![], |(v, _)| vec![0.0, v, 2.0 * v]),
            efficiency: table.map_or(vec![], |(_, best)| vec![0.0, best, 0.5 * best]),
            // A fifth of the pumps warms no water.
            heat_to_water: (heat_to_water > 0.2).then_some(heat_to_water),
            standby_w,
            delta_m,
            ..PumpParams::default()
        }
    })
}

fn valve() -> impl Strategy<Value = ValveParams> {
    let of =
        |characteristic, leakage| ValveParams { characteristic, leakage, ..ValveParams::default() };
    let curve = prop_oneof![
        (2.0..100.0, 0.0..0.95).prop_map(move |(rangeability, share): (f64, f64)| ValveParams {
            rangeability,
            ..of(ValveCharacteristic::EqualPercentage, share * rangeability.powf(-0.99))
        }),
        (0.0..0.5).prop_map(move |leakage| of(ValveCharacteristic::Linear, leakage)),
        (0.0..0.5, 1.0..4.0).prop_map(move |(leakage, alpha)| ValveParams {
            alpha,
            ..of(ValveCharacteristic::QuickOpening, leakage)
        }),
        (0.0..0.5, rising_to_1(), rising_to_1()).prop_map(move |(leakage, opening, phi)| {
            let points = opening.len().min(phi.len()) - 1;
            let column = |mut column: Vec<f64>| {
                column.truncate(points);
                column.push(1.0);
                column
            };
            ValveParams {
                table_opening: column(opening),
                table_phi: column(phi),
                ..of(ValveCharacteristic::Table, leakage)
            }
        }),
    ];
    let tight = prop::bool::weighted(0.2);
    let nominal = option::of(logarithmic(0.1, 5.0));
    let numbers = (0.0..1.0, any::<bool>(), 0.0..120.0, nominal, 0.005..0.3);
    (logarithmic(0.1, 1000.0), curve, tight, numbers).prop_map(|(kvs_m3_h, curve, tight, n)| {
        let (command, by_kappa, stroke_time_s, nominal, delta_m) = n;
        ValveParams {
            kvs_m3_h,
            leakage: if tight { 0.0 } else { curve.leakage },
            command: if by_kappa { ValveCommand::Kappa } else { ValveCommand::Opening },
            opening: (!by_kappa).then_some(command),
            kappa: by_kappa.then_some(command),
            initial_opening: None,
            stroke_time_s,
            m_flow_nominal_kg_s: nominal.map(|share| share * at_a_tenth_of_a_bar_kg_s(kvs_m3_h)),
            delta_m,
            ..curve
        }
    })
}

/// A column that rises strictly from 0 to 1.
fn rising_to_1() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.01..1.0, 1..6).prop_map(|steps: Vec<f64>| {
        let whole: f64 = steps.iter().sum();
        let rising = steps.iter().scan(0.0, |sum, step| {
            *sum += step / whole;
            Some(*sum)
        });
        let mut column: Vec<f64> = std::iter::once(0.0).chain(rising).collect();
        column.pop();
        column.push(1.0);
        column
    })
}

/// Flow at 0.1 bar of a valve of a Kv value, kg/s.
fn at_a_tenth_of_a_bar_kg_s(kv_m3_h: f64) -> f64 {
    kv_m3_h / 3.6 * 0.1_f64.sqrt()
}

fn ball_valve() -> impl Strategy<Value = BallValveParams> {
    let initial = option::of(0.0..1.0);
    let numbers = (logarithmic(1e-5, 0.1), any::<bool>(), initial, 0.0..60.0, 0.005..0.3);
    (logarithmic(0.1, 1000.0), numbers).prop_map(|(kvs_m3_h, n)| {
        let (leakage, open, initial_opening, stroke_time_s, delta_m) = n;
        BallValveParams {
            kvs_m3_h,
            leakage,
            open: f64::from(u8::from(open)),
            initial_opening,
            stroke_time_s,
            m_flow_nominal_kg_s: None,
            delta_m,
        }
    })
}

fn check_valve() -> impl Strategy<Value = CheckValveParams> {
    (logarithmic(0.1, 1000.0), logarithmic(1e-4, 0.5), logarithmic(0.1, 5.0), 0.005..0.3).prop_map(
        |(kvs_m3_h, leakage, nominal, delta_m)| CheckValveParams {
            kvs_m3_h,
            leakage,
            m_flow_nominal_kg_s: nominal * at_a_tenth_of_a_bar_kg_s(kvs_m3_h),
            delta_m,
        },
    )
}

fn overflow_valve() -> impl Strategy<Value = OverflowValveParams> {
    let numbers = (option::of(0.01..1.0), logarithmic(1e-5, 0.4), 0.005..0.1);
    (logarithmic(0.1, 1000.0), logarithmic(1e3, 1e6), numbers).prop_map(
        |(kvs_m3_h, opening_dp_pa, (band, leakage, delta_m))| OverflowValveParams {
            kvs_m3_h,
            opening_dp_pa,
            band_dp_pa: band.map(|share: f64| share * opening_dp_pa),
            leakage,
            delta_m,
        },
    )
}

fn dp_controller() -> impl Strategy<Value = DpControllerParams> {
    let numbers = (option::of(0.01..1.0), 0.0..30.0, logarithmic(1e-5, 0.4), 0.005..0.1);
    (logarithmic(0.1, 1000.0), logarithmic(1e3, 1e6), numbers).prop_map(
        |(kvs_m3_h, dp_set_pa, (band, lag_s, leakage, delta_m))| DpControllerParams {
            kvs_m3_h,
            high_node: "n0".into(),
            low_node: "n1".into(),
            dp_set_pa,
            band_dp_pa: band.map(|share: f64| share * dp_set_pa),
            lag_s,
            leakage,
            delta_m,
        },
    )
}

fn pressure_reducing_valve() -> impl Strategy<Value = PressureReducingValveParams> {
    (dp_controller(), any::<bool>()).prop_map(|(valve, remote)| PressureReducingValveParams {
        kvs_m3_h: valve.kvs_m3_h,
        pressure_set_pa: valve.dp_set_pa,
        sensed_node: remote.then(|| "n0".into()),
        band_pressure_pa: valve.band_dp_pa,
        lag_s: valve.lag_s,
        leakage: valve.leakage,
        delta_m: valve.delta_m,
    })
}

fn flow_limiter() -> impl Strategy<Value = FlowLimiterParams> {
    let set = prop_oneof![Just(0.0), logarithmic(1e-3, 3.0)];
    (logarithmic(0.1, 1000.0), set, 0.0..30.0, 0.005..0.3).prop_map(
        |(kvs_m3_h, share, rise_time_s, delta_m): (_, f64, _, _)| FlowLimiterParams {
            kvs_m3_h,
            m_flow_set_kg_s: share * at_a_tenth_of_a_bar_kg_s(kvs_m3_h),
            rise_time_s,
            delta_m,
        },
    )
}

fn heat_meter() -> impl Strategy<Value = HeatMeterParams> {
    (logarithmic(1.0, 1e6), logarithmic(1e-3, 100.0), logarithmic(1e-3, 1.0)).prop_map(
        |(dp_nominal_pa, m_flow_nominal_kg_s, delta_m)| HeatMeterParams {
            return_node: Some("n0".into()),
            supply_node: None,
            m_flow_nominal_kg_s,
            dp_nominal_pa,
            delta_m,
        },
    )
}

fn resistance() -> impl Strategy<Value = ResistanceParams> {
    let point = (logarithmic(10.0, 1e6), logarithmic(1e-3, 1e3), 0.005..0.5).prop_map(
        |(dp_pa, m_flow_kg_s, delta_m)| ResistanceParams {
            dp_nominal_pa: Some(dp_pa),
            m_flow_nominal_kg_s: Some(m_flow_kg_s),
            delta_m,
            ..ResistanceParams::default()
        },
    );
    let power = (point.clone(), 0.5..4.0)
        .prop_map(|(point, exponent)| ResistanceParams { exponent: Some(exponent), ..point });
    let steps = prop::collection::vec((0.1..1.0, 0.1..1.0), 1..6);
    let curve = (logarithmic(1e-6, 1.0), logarithmic(10.0, 1e6), steps).prop_map(
        |(v_step, dp_step, steps): (f64, f64, Vec<(f64, f64)>)| {
            let (mut flows, mut losses) = (vec![0.0], vec![0.0]);
            for (v, dp) in steps {
                flows.push(flows[flows.len() - 1] + v_step * v);
                losses.push(losses[losses.len() - 1] + dp_step * dp);
            }
            ResistanceParams {
                dp_nominal_pa: None,
                m_flow_nominal_kg_s: None,
                curve_v_flow_m3_s: flows,
                curve_dp_pa: losses,
                ..ResistanceParams::default()
            }
        },
    );
    let kv = (logarithmic(0.1, 1000.0), option::of(logarithmic(0.1, 5.0)), 0.005..0.5).prop_map(
        |(kv_m3_h, nominal, delta_m)| ResistanceParams {
            dp_nominal_pa: None,
            m_flow_nominal_kg_s: nominal.map(|share| share * at_a_tenth_of_a_bar_kg_s(kv_m3_h)),
            kv_m3_h: Some(kv_m3_h),
            delta_m,
            ..ResistanceParams::default()
        },
    );
    prop_oneof![2 => point, 2 => kv, 1 => power, 1 => curve]
}

fn heat_exchanger() -> impl Strategy<Value = HeatExchangerParams> {
    let hydraulic = (logarithmic(100.0, 2e5), logarithmic(1e-2, 100.0), 0.005..0.5);
    let thermal = (
        option::of(logarithmic(1e-2, 100.0)),
        logarithmic(10.0, 1e6),
        prop_oneof![Just(0.0), 0.3..1.0],
        any::<bool>(),
        (prop_oneof![Just(0.0), 1e-4..0.1], prop_oneof![Just(0.0), logarithmic(1e2, 1e5)]),
    );
    (hydraulic, thermal).prop_map(|(h, (secondary, ua_w_k, flow_exponent, counter, volume))| {
        HeatExchangerParams {
            dp_nominal_pa: h.0,
            m_flow_nominal_kg_s: h.1,
            m_flow_nominal_secondary_kg_s: secondary,
            ua_w_k,
            flow_exponent,
            arrangement: if counter { Arrangement::CounterFlow } else { Arrangement::ParallelFlow },
            equal_capacity_band: 1e-6,
            volume_m3: volume.0,
            wall_capacity_j_k: volume.1,
            delta_m: h.2,
            partner: None,
        }
    })
}

fn flow_source() -> impl Strategy<Value = FlowSourceParams> {
    prop_oneof![
        (-2.0..2.0).prop_map(|m| FlowSourceParams { m_flow_kg_s: Some(m), v_flow_m3_s: None }),
        (-2e-3..2e-3).prop_map(|v| FlowSourceParams { m_flow_kg_s: None, v_flow_m3_s: Some(v) }),
        Just(FlowSourceParams::default()),
    ]
}
