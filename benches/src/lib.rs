//! Generated networks for benches and tests: the same text for the same size and seed.
//!
//! One plant, consumers scattered over plots, trenches that grow from the plant to the consumers with
//! a few loops. Pipes are sized for the design flows, valves take what the farthest consumer needs
//! more pressure than theirs: every consumer gets about its design flow.

pub mod destest;
pub mod tables;
pub mod valves;

use std::collections::HashSet;
use std::f64::consts::PI;
use std::fmt::Write;

/// Inner diameters of steel pipes, mm, and their thermal resistance insulated, K m/W.
const PIPES: &[(&str, f64, f64)] = &[
    ("dn20", 21.7, 3.8),
    ("dn25", 28.5, 3.4),
    ("dn32", 37.2, 3.3),
    ("dn40", 43.1, 3.0),
    ("dn50", 54.5, 2.7),
    ("dn65", 70.3, 2.5),
    ("dn80", 82.5, 2.5),
    ("dn100", 107.1, 2.4),
    ("dn125", 132.5, 2.2),
    ("dn150", 160.3, 1.9),
    ("dn200", 210.1, 1.8),
    ("dn250", 263.0, 1.9),
    ("dn300", 312.7, 1.8),
    ("dn350", 344.4, 1.8),
    ("dn400", 393.8, 1.7),
    ("dn500", 495.4, 1.7),
];
/// Largest design velocity, m/s.
const VELOCITY_M_S: f64 = 1.0;
const DENSITY_KG_M3: f64 = 1000.0;
/// A friction factor for sizing only.
const FRICTION: f64 = 0.022;
/// Length of the sides of a plot, m; one consumer on each on average.
const PLOT_M: f64 = 40.0;
/// Trenches that close a loop, for each consumer.
const LOOPS: f64 = 0.03;
/// How much a short way to the plant counts against a short trench.
const STRAIGHT: f64 = 0.3;
/// Pressure that a consumer's valve takes at least, and its heat exchanger and stubs together, Pa.
const VALVE_PA: f64 = 30_000.0;
const STATION_PA: f64 = 20_000.0;
/// Design flows of consumers are between these, kg/s.
const LEAST_KG_S: f64 = 0.06;
const MOST_KG_S: f64 = 0.2;
/// Load profiles of a year, for as many sizes of houses.
const PROFILES: usize = 8;
/// Edges of a consumer's station with its trench, and of the plant.
const EDGES_PER_CONSUMER: f64 = 6.0 + 2.0 * LOOPS;
const EDGES_OF_PLANT: usize = 5;

/// A place: site 0 is the plant.
struct Site {
    x_m: f64,
    y_m: f64,
    /// The site towards the plant.
    parent: usize,
    /// Trench to it, m.
    length_m: f64,
    /// Way to the plant, m.
    way_m: f64,
    /// Design flow of the consumer here, kg/s.
    own_kg_s: f64,
    /// Design flow of the trench, kg/s.
    total_kg_s: f64,
    /// Pressure loss of one line to here from the plant, Pa.
    loss_pa: f64,
}

/// The model file of a two-pipe network with one plant and `consumers` (at least 1) consumers.
pub fn two_pipe_network(consumers: usize, seed: u64) -> String {
    let mut random = Random(seed);
    let (sites, order) = grown_tree(consumers.max(1), &mut random);
    let loops = loops(&sites, (LOOPS * consumers as f64).round() as usize, &mut random);
    text(&sites, &order, &loops, &mut random)
}

/// The same network for a year: imposed flows of houses with heat loads from the profiles in the file
/// `profiles` (written by [`write_profiles`]), linear between its hours; the plant has 80 degC.
pub fn two_pipe_network_of_a_year(consumers: usize, seed: u64, profiles: &str) -> String {
    let (sites, mut out) = sites_of_a_year(consumers, seed);
    let _ = writeln!(
        out,
        "[[edge]]\nid = \"source\"\nkind = \"resistance\"\nfrom = \"plant.cold\"\nto = \"plant.hot\"\n\
         dp_nominal_pa = 10000\nm_flow_nominal_kg_s = {:.3}\n[[unit]]\nid = \"source.unit\"\n\
         port = \"source\"\nkind = \"heat_source\"\nsupply_degc = 80",
        sites[0].total_kg_s
    );
    for (i, site) in sites.iter().enumerate().skip(1) {
        let _ = writeln!(
            out,
            "[[station]]\nsite = \"c{i}\"\nkind = \"prescribed_flow\"\n[[unit]]\nsite = \"c{i}\"\n\
             kind = \"heat_load\"\ntemperature_difference_k = 30\nv_flow_min_l_min = 0.3\ncoldest_return_degc = 20\n\
             [[series]]\nfile = \"{profiles}\"\ncolumn = \"load_{}_kw\"\nunit = \"kW\"\n\
             signal = \"c{i}.unit.load_w\"\ninterpolation = \"linear\"",
            profile(site)
        );
    }
    out
}

/// The sites of a grown network, and its pipes as a run of a year.
fn sites_of_a_year(consumers: usize, seed: u64) -> (Vec<Site>, String) {
    let mut random = Random(seed);
    let (sites, order) = grown_tree(consumers.max(1), &mut random);
    let loops = loops(&sites, (LOOPS * consumers as f64).round() as usize, &mut random);
    let text = pipes(&sites, &order, &loops)
        .replace("until = \"1h\"", "until = \"365d\"")
        .replace("step = \"1s\"", "step = \"15min\"")
        .replace("record = \"10s\"", "record = \"1h\"")
        .replace("initial_degc = 50", "initial_degc = 60");
    (sites, text)
}

/// The profile of a house of this size.
fn profile(site: &Site) -> usize {
    let size = (site.own_kg_s - LEAST_KG_S) / (MOST_KG_S - LEAST_KG_S) * PROFILES as f64;
    (size as usize).min(PROFILES - 1)
}

/// Hourly loads of a year of houses of different sizes, as the text of a CSV file: heating that follows
/// the season and the hour, and hot water at random hours.
pub fn write_profiles(seed: u64) -> String {
    let mut random = Random(seed);
    let names: Vec<String> = (0..PROFILES).map(|i| format!("load_{i}_kw")).collect();
    let mut out = format!("time_s,{}\n", names.join(","));
    for hour in 0..=8760_u32 {
        let turn =
            |period_h: f64, at_h: f64| (2.0 * PI * (f64::from(hour) - at_h) / period_h).cos();
        let heating = (0.5 + 0.45 * turn(8760.0, 500.0)) * (0.8 + 0.2 * turn(24.0, 7.0));
        let _ = write!(out, "{}", hour * 3600);
        for i in 0..PROFILES {
            let share = (i as f64 + 0.5) / PROFILES as f64;
            let design_kw = (LEAST_KG_S + share * (MOST_KG_S - LEAST_KG_S)) * 4.18 * 30.0;
            let hot_water = if random.below(8) == 0 { random.between(0.1, 0.4) } else { 0.0 };
            let _ = write!(out, ",{:.3}", design_kw * (0.7 * heating + hot_water).max(0.0));
        }
        out.push('\n');
    }
    out
}

/// The model file of a two-pipe network with about `edges` edges.
pub fn two_pipe_network_with_edges(edges: usize, seed: u64) -> String {
    let consumers = edges.saturating_sub(EDGES_OF_PLANT) as f64 / EDGES_PER_CONSUMER;
    two_pipe_network(consumers.round() as usize, seed)
}

/// Scattered sites, connected one after the other to the nearest one that is connected already, and the
/// order in which they were; flows and losses of the design.
fn grown_tree(consumers: usize, random: &mut Random) -> (Vec<Site>, Vec<usize>) {
    let side_m = PLOT_M * (consumers as f64).sqrt();
    let site = |x_m: f64, y_m: f64, own_kg_s: f64| Site {
        x_m: x_m.round(),
        y_m: y_m.round(),
        parent: 0,
        length_m: f64::INFINITY,
        way_m: 0.0,
        own_kg_s,
        total_kg_s: own_kg_s,
        loss_pa: 0.0,
    };
    let mut sites = vec![site(0.5 * side_m, 0.5 * side_m, 0.0)];
    for _ in 0..consumers {
        let (x_m, y_m) = (random.between(0.0, side_m), random.between(0.0, side_m));
        sites.push(site(x_m, y_m, random.between(LEAST_KG_S, MOST_KG_S)));
    }
    let mut order = vec![0];
    let mut waiting: Vec<usize> = (1..sites.len()).collect();
    let mut last = 0;
    while !waiting.is_empty() {
        for &i in &waiting {
            let length_m = distance_m(&sites[i], &sites[last]);
            let cost = |length_m: f64, parent: usize| length_m + STRAIGHT * sites[parent].way_m;
            if cost(length_m, last) < cost(sites[i].length_m, sites[i].parent) {
                (sites[i].parent, sites[i].length_m) = (last, length_m);
            }
        }
        let cost = |i: usize| sites[i].length_m + STRAIGHT * sites[sites[i].parent].way_m;
        let next = (0..waiting.len())
            .min_by(|&a, &b| cost(waiting[a]).total_cmp(&cost(waiting[b])))
            .unwrap_or(0);
        last = waiting.swap_remove(next);
        sites[last].way_m = sites[sites[last].parent].way_m + sites[last].length_m;
        order.push(last);
    }
    for &i in order.iter().skip(1).rev() {
        let parent = sites[i].parent;
        sites[parent].total_kg_s += sites[i].total_kg_s;
    }
    for &i in order.iter().skip(1) {
        let (_, diameter_mm, _) = pipe(sites[i].total_kg_s);
        let d = diameter_mm * 1e-3;
        let velocity = sites[i].total_kg_s / (DENSITY_KG_M3 * PI / 4.0 * d * d);
        let dynamic_pa = 0.5 * DENSITY_KG_M3 * velocity * velocity;
        sites[i].loss_pa =
            sites[sites[i].parent].loss_pa + FRICTION * sites[i].length_m / d * dynamic_pa;
    }
    (sites, order)
}

/// Trenches between neighbours that are not connected yet.
fn loops(sites: &[Site], count: usize, random: &mut Random) -> Vec<(usize, usize)> {
    let mut taken: HashSet<(usize, usize)> = sites
        .iter()
        .enumerate()
        .map(|(i, site)| (i.min(site.parent), i.max(site.parent)))
        .collect();
    let mut loops = Vec::new();
    for _ in 0..count {
        let a = random.below(sites.len());
        let nearest = (0..sites.len())
            .filter(|&b| a != b && !taken.contains(&(a.min(b), a.max(b))))
            .min_by(|&b, &c| {
                distance_m(&sites[a], &sites[b]).total_cmp(&distance_m(&sites[a], &sites[c]))
            });
        if let Some(b) = nearest {
            taken.insert((a.min(b), a.max(b)));
            loops.push((a, b));
        }
    }
    loops
}

fn text(sites: &[Site], order: &[usize], loops: &[(usize, usize)], random: &mut Random) -> String {
    let mut out = pipes(sites, order, loops);
    let farthest_pa = sites.iter().map(|site| site.loss_pa).fold(0.0, f64::max);
    let head_pa = 2.0 * farthest_pa + STATION_PA + VALVE_PA;
    plant(&mut out, sites[0].total_kg_s, head_pa);
    for (i, site) in sites.iter().enumerate().skip(1) {
        let valve_pa = head_pa - 2.0 * site.loss_pa - STATION_PA;
        consumer(&mut out, &format!("c{i}"), site.own_kg_s, valve_pa, random);
    }
    out
}

/// The file without stations: how to run it, sites and trenches.
fn pipes(sites: &[Site], order: &[usize], loops: &[(usize, usize)]) -> String {
    let name = |i: usize| if i == 0 { "plant".to_owned() } else { format!("c{i}") };
    let mut out = String::from(
        "format = 1\n[model]\nname = \"generated two-pipe network\"\n[run]\nuntil = \"1h\"\nstep = \"1s\"\n\
         record = \"10s\"\ninitial_degc = 50\n[ground]\ntemperature_degc = 10\n\
         [pressure_reference]\nnode = \"plant.cold\"\n",
    );
    // Writing to a String does not fail.
    pipe_types(&mut out);
    for (i, site) in sites.iter().enumerate() {
        let _ = writeln!(
            out,
            "[[site]]\nid = \"{}\"\nx_m = {:.0}\ny_m = {:.0}",
            name(i),
            site.x_m,
            site.y_m
        );
    }
    for (from, to, length_m, pipe) in trenches(sites, order, loops) {
        let _ = writeln!(
            out,
            "[[trench]]\nfrom = \"{}\"\nto = \"{}\"\nlength_m = {length_m:.1}\npipe = \"{pipe}\"",
            name(from),
            name(to)
        );
    }
    out
}

/// The types of pipes as sections of a model file.
fn pipe_types(out: &mut String) {
    for (id, diameter_mm, resistance) in PIPES {
        let _ = writeln!(
            out,
            "[pipe_type.{id}]\ninner_diameter_mm = {diameter_mm}\n\
             insulation_resistance_k_m_w = {resistance}"
        );
    }
}

/// From, to, length in m and type of pipe of each trench.
fn trenches(
    sites: &[Site],
    order: &[usize],
    loops: &[(usize, usize)],
) -> Vec<(usize, usize, f64, &'static str)> {
    let tree = order.iter().skip(1).map(|&i| {
        let site = &sites[i];
        (site.parent, i, site.length_m, pipe(site.total_kg_s).0)
    });
    let closing = loops.iter().map(|&(a, b)| {
        let flow_kg_s = sites[a].total_kg_s.min(sites[b].total_kg_s);
        (a, b, distance_m(&sites[a], &sites[b]), pipe(flow_kg_s).0)
    });
    tree.chain(closing).collect()
}

/// The plant: a pump that gives `head_pa` at the design flow, and 80 degC behind its exchanger.
fn plant(out: &mut String, m_flow_kg_s: f64, head_pa: f64) {
    // H = H0 (1 - (V/V0)^2) with V0 = 2 V; the exchanger takes 20 kPa more.
    let head_max_pa = (head_pa + 20_000.0) / 0.75;
    let free_flow_l_min = 2.0 * m_flow_kg_s * 60.0;
    let _ = writeln!(
        out,
        "[[station]]\nsite = \"plant\"\nkind = \"producer\"\n\
         stub = {{ pipe = \"{}\", length_m = 5 }}\n\
         heat_exchanger = {{ m_flow_nominal_kg_s = {m_flow_kg_s:.3}, dp_nominal_pa = 15000, \
         ua_w_k = {:.0}, volume_m3 = {:.3} }}\n\
         feed_in_pump = {{ head_max_pa = {head_max_pa:.0}, free_flow_l_min = {free_flow_l_min:.1}, \
         speed = 1.0, initial_speed = 1.0 }}\n\
         feed_in_check_valve = {{ kvs_m3_h = {:.1}, m_flow_nominal_kg_s = {m_flow_kg_s:.3} }}\n\
         [[unit]]\nsite = \"plant\"\nkind = \"prescribed_source\"\nsupply_degc = 80\n\
         v_flow_l_min = {:.1}",
        pipe(m_flow_kg_s).0,
        20_000.0 * m_flow_kg_s,
        0.01 * m_flow_kg_s,
        20.0 * m_flow_kg_s,
        60.0 * m_flow_kg_s
    );
}

/// A consumer: half of them a heat load, half a given return temperature.
fn consumer(out: &mut String, site: &str, m_flow_kg_s: f64, valve_pa: f64, random: &mut Random) {
    // m3/h at 1 bar, open to 0.9 of the equal-percentage stroke: 50^-0.1
    let kvs_m3_h = 3.6 * m_flow_kg_s / (valve_pa / 1e5).sqrt() * 50_f64.powf(0.1);
    let stub = pipe(m_flow_kg_s).0;
    let _ = writeln!(
        out,
        "[[station]]\nsite = \"{site}\"\nkind = \"consumer\"\n\
         stub = {{ pipe = \"{stub}\", length_m = 5 }}\n\
         heat_exchanger = {{ m_flow_nominal_kg_s = {m_flow_kg_s:.4}, dp_nominal_pa = 15000, \
         ua_w_k = {:.0} }}\n\
         extraction_valve = {{ kvs_m3_h = {kvs_m3_h:.4}, opening = 0.9 }}\n\
         [[unit]]\nsite = \"{site}\"",
        20_000.0 * m_flow_kg_s
    );
    let _ = if random.below(2) == 0 {
        writeln!(
            out,
            "kind = \"heat_load\"\nload_kw = {:.2}\ntemperature_difference_k = 30",
            m_flow_kg_s * 4.18 * 30.0
        )
    } else {
        writeln!(
            out,
            "kind = \"prescribed_source\"\nsupply_degc = 40\nv_flow_l_min = {:.2}",
            60.0 * m_flow_kg_s
        )
    };
}

/// The smallest pipe for a flow.
fn pipe(m_flow_kg_s: f64) -> (&'static str, f64, f64) {
    let fits = |(_, diameter_mm, _): &&(&str, f64, f64)| {
        let d = diameter_mm * 1e-3;
        m_flow_kg_s / (DENSITY_KG_M3 * PI / 4.0 * d * d) <= VELOCITY_M_S
    };
    *PIPES.iter().find(fits).unwrap_or(&PIPES[PIPES.len() - 1])
}

fn distance_m(a: &Site, b: &Site) -> f64 {
    ((a.x_m - b.x_m).powi(2) + (a.y_m - b.y_m).powi(2)).sqrt().max(5.0)
}

/// Pseudo-random numbers (splitmix64).
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anergy_network::elements::ElementParams;
    use anergy_simulation::model::Model;
    use anergy_simulation::steady;
    use std::path::Path;

    fn model(text: &str) -> Model {
        Model::from_toml(text, Path::new("."))
            .unwrap_or_else(|problems| panic!("{}", problems.render(text)))
    }

    #[test]
    fn same_seed_same_text() {
        assert_eq!(two_pipe_network(50, 1), two_pipe_network(50, 1));
        assert_ne!(two_pipe_network(50, 1), two_pipe_network(50, 2));
    }

    #[test]
    fn size_by_edges() {
        for edges in [100, 1000] {
            let found = model(&two_pipe_network_with_edges(edges, 3)).edges.len();
            assert!(found.abs_diff(edges) <= 6, "{found} for {edges}");
        }
    }

    #[test]
    fn every_consumer_gets_water_and_heat() {
        for (consumers, seed) in [(1, 1), (100, 1), (100, 2), (300, 3)] {
            let model = model(&two_pipe_network(consumers, seed));
            let steady = steady::solve(&model).unwrap();
            let (mut exchangers, mut fastest) = (0, 0.0_f64);
            for (edge, found) in model.edges.iter().zip(&steady.edges) {
                let (id, m) = (&edge.id, found.m_flow_kg_s);
                match &edge.params {
                    ElementParams::HeatExchanger(x) => {
                        exchangers += 1;
                        let share = m.abs() / x.m_flow_nominal_kg_s;
                        assert!((0.6..1.7).contains(&share), "{id} gets {share} of its flow");
                        assert!((m > 0.0) == id.starts_with("plant"), "{id}: {m} kg/s");
                    }
                    ElementParams::Pipe(pipe) => {
                        let area_m2 = PI / 4.0 * pipe.inner_diameter_m * pipe.inner_diameter_m;
                        let velocity = m.abs() / (DENSITY_KG_M3 * area_m2);
                        fastest = fastest.max(velocity);
                        assert!(velocity < 2.5, "{id}: {velocity} m/s");
                    }
                    _ => {}
                }
            }
            assert_eq!(exchangers, consumers + 1);
            assert!(fastest > 0.3, "{fastest} m/s");
            let supply_k = steady.node("plant.hot").unwrap().t_k;
            assert!((335.0..354.0).contains(&supply_k), "{supply_k} K");
        }
    }
}
