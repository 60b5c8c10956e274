//! Pump types of a net.

use super::tables::{Tables, inside, numbers};

/// Polynomial of a pump type as pandapipes has it: bar over m3/h, highest power first.
fn polynomial(net: &Tables, name: &str) -> Option<Vec<f64>> {
    let types = net.get("std_types")?;
    let pumps = inside(types.get("pump")?).into_owned();
    let pump = inside(pumps.get(name)?).into_owned();
    numbers(pump.get("reg_par")?)
}

/// Coefficients of increasing powers, Pa over m3/s, with the last power that counts.
pub(super) fn coefficients(net: &Tables, name: &str) -> Option<Vec<f64>> {
    let highest_first = polynomial(net, name)?;
    let scaled = highest_first.iter().rev().enumerate();
    let mut all: Vec<f64> = scaled.map(|(i, c)| c * 1e5 * 3600_f64.powi(i as i32)).collect();
    while all.last() == Some(&0.0) {
        all.pop();
    }
    Some(all)
}
