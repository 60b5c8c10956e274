//! The generated networks as tables: a model file with `nodes.csv` and `pipes.csv`.

use super::{LOOPS, Random, grown_tree, loops, pipe_types, trenches};
use std::fmt::Write;
use std::path::Path;

/// Writes the network of [`super::two_pipe_network_of_a_year`] with constant loads into a folder: a row per
/// site and per trench, `model.toml` with what they have in common.
///
/// # Errors
/// When a file cannot be written.
pub fn write_two_pipe_tables(consumers: usize, seed: u64, folder: &Path) -> std::io::Result<()> {
    let mut random = Random(seed);
    let (sites, order) = grown_tree(consumers.max(1), &mut random);
    let loops = loops(&sites, (LOOPS * consumers as f64).round() as usize, &mut random);
    let name = |i: usize| if i == 0 { "plant".to_owned() } else { format!("c{i}") };
    // Writing to a String does not fail.
    let mut nodes = String::from("id,x_m,y_m,station,unit.load_kw\n");
    for (i, site) in sites.iter().enumerate() {
        let _ = write!(nodes, "{},{:.0},{:.0},", name(i), site.x_m, site.y_m);
        let _ = match i {
            0 => writeln!(nodes, ","),
            _ => writeln!(nodes, "house,{:.2}", 0.5 * site.own_kg_s * 4.18 * 30.0),
        };
    }
    let mut pipes = String::from("from,to,length_m,pipe\n");
    for (from, to, length_m, pipe) in trenches(&sites, &order, &loops) {
        let _ = writeln!(pipes, "{},{},{length_m:.1},{pipe}", name(from), name(to));
    }
    let mut model = String::from(
        "format = 1\n[model]\nname = \"generated two-pipe network\"\n[run]\nuntil = \"1d\"\nstep = \"15min\"\n\
         record = \"1h\"\ninitial_degc = 60\n[ground]\ntemperature_degc = 10\n\
         [pressure_reference]\nnode = \"plant.cold\"\n\
         [network]\nnodes = \"nodes.csv\"\npipes = \"pipes.csv\"\n\
         [station_type.house]\nkind = \"prescribed_flow\"\n\
         unit = { kind = \"heat_load\", temperature_difference_k = 30, v_flow_min_l_min = 0.3, \
         coldest_return_degc = 20 }\n",
    );
    pipe_types(&mut model);
    let _ = writeln!(
        model,
        "[[edge]]\nid = \"source\"\nkind = \"resistance\"\nfrom = \"plant.cold\"\nto = \"plant.hot\"\n\
         dp_nominal_pa = 10000\nm_flow_nominal_kg_s = {:.3}\n[[unit]]\nid = \"source.unit\"\n\
         port = \"source\"\nkind = \"heat_source\"\nsupply_degc = 80",
        sites[0].total_kg_s
    );
    let files = [("model.toml", model), ("nodes.csv", nodes), ("pipes.csv", pipes)];
    files.iter().try_for_each(|(file, text)| std::fs::write(folder.join(file), text))
}
