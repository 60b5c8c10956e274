//! A town for a year in which nobody imposes a flow: a thermostatic valve at every consumer reacts to its own return.

use super::{STATION_PA, VALVE_PA, pipe, profile, sites_of_a_year};
use std::fmt::Write;

/// Temperature of the return at which a valve is half open, degC, and change from closed to open, K; with 10 K the valves swing
/// with the delay of their stations, in a period of 2 min.
const HALF_OPEN_DEGC: f64 = 45.0;
const BAND_K: f64 = 20.0;
/// What a shut valve lets through for its sensor to feel: share of its flow coefficient.
const BY_PASS: f64 = 0.02;

/// The network of [`super::two_pipe_network_of_a_year`] with a plant that holds a pressure difference, an exchanger and a
/// thermostatic valve at every consumer, and the loads of the file `profiles` behind them.
pub fn two_pipe_network_with_valves(consumers: usize, seed: u64, profiles: &str) -> String {
    let (sites, mut out) = sites_of_a_year(consumers, seed);
    let farthest_pa = sites.iter().map(|site| site.loss_pa).fold(0.0, f64::max);
    let head_pa = 2.0 * farthest_pa + STATION_PA + VALVE_PA;
    let _ = writeln!(
        out,
        "[[station]]\nsite = \"plant\"\nkind = \"plant\"\nsupply_degc = 80\ndp_pa = {head_pa:.0}\n\
         circulation_pump = {{ head_max_pa = {:.0}, free_flow_l_min = {:.1} }}",
        2.0 * head_pa,
        240.0 * sites[0].total_kg_s
    );
    for (i, site) in sites.iter().enumerate().skip(1) {
        let m = site.own_kg_s;
        // m3/h at 1 bar: the design flow at half its stroke.
        let valve_pa = head_pa - 2.0 * site.loss_pa - STATION_PA;
        let kvs_m3_h = 2.0 * 3.6 * m / (valve_pa / 1e5).sqrt();
        let _ = writeln!(
            out,
            "[[station]]\nsite = \"c{i}\"\nkind = \"consumer\"\nstub = {{ pipe = \"{}\", length_m = 5 }}\n\
             heat_exchanger = {{ m_flow_nominal_kg_s = {m:.4}, dp_nominal_pa = 15000, ua_w_k = {:.0}, \
             volume_l = {:.2} }}\n\
             extraction_valve = {{ kvs_m3_h = {kvs_m3_h:.4}, characteristic = \"linear\", opening = 0.5 }}\n\
             [[unit]]\nsite = \"c{i}\"\nkind = \"heat_load\"\ntemperature_difference_k = 25\n\
             v_flow_min_l_min = 0.3\ncoldest_return_degc = 20\n\
             [[controller]]\nid = \"c{i}.thermostat\"\nkind = \"thermostatic_valve\"\n\
             measures = \"c{i}.branch_cold.t_k\"\nacts_on = \"c{i}.extraction_valve.opening\"\n\
             set_point_degc = {HALF_OPEN_DEGC}\nproportional_band_difference_k = {BAND_K}\noutput_min = {BY_PASS}\n\
             [[series]]\nfile = \"{profiles}\"\ncolumn = \"load_{}_kw\"\nunit = \"kW\"\n\
             signal = \"c{i}.unit.load_w\"\ninterpolation = \"linear\"",
            pipe(m).0,
            20_000.0 * m,
            10.0 * m,
            profile(site)
        );
    }
    out
}
