//! What a step of a thermal storage costs, by scheme and number of layers: request and advance.
#![allow(clippy::unwrap_used, missing_docs)]

use anergy_core::medium::Medium;
use anergy_core::port::{Outlet, PortFlow, PortRequest};
use anergy_core::signal::Signals;
use anergy_prosumer::equipment::storage::{Scheme, StorageParams};
use anergy_prosumer::thermal_unit::ThermalUnit;
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

/// Charged for 2000 steps with a temperature that changes, then emptied again, and so on: 0.1 kg/s of 785 kg.
fn steps(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("storage step of 10 s");
    group
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1));
    for scheme in [Scheme::MixedLayers, Scheme::PlugFlow] {
        for layers in [10, 50, 200] {
            let params = StorageParams { scheme, layers, ..StorageParams::default() };
            let unit = params.build(&Medium::default()).unwrap();
            let mut state = unit.initial_state(303.15);
            let mut out = vec![0.0; unit.outputs().len()];
            let signals = [291.15];
            let mut got = [PortFlow::default()];
            let mut count = 0_u32;
            group.bench_function(format!("{scheme:?} {layers}"), |bencher| {
                bencher.iter(|| {
                    count += 1;
                    let mut wanted = [PortRequest::default()];
                    unit.request(&Signals(&signals), &got, &mut state, &mut wanted);
                    let Outlet::Ends { a_k, b_k } = wanted[0].outlet else { return };
                    let charges = (count / 2000).is_multiple_of(2);
                    let wave = f64::from(count % 300) / 30.0;
                    got[0] = match charges {
                        true => PortFlow { m_flow_kg_s: 0.1, t_in_k: 338.15 + wave, t_out_k: b_k },
                        false => {
                            PortFlow { m_flow_kg_s: -0.1, t_in_k: 298.15 + wave, t_out_k: a_k }
                        }
                    };
                    black_box(unit.advance(10.0, &Signals(&signals), &got, &mut state, &mut out));
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, steps);
criterion_main!(benches);
