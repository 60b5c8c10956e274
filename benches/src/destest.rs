//! The network of the DESTEST common exercise 1 (IBPSA Project 1) as a model file.
//!
//! Sixteen houses with one load profile; the source is node `i`, two branches i-d-c-b-a and
//! i-h-g-f-e. The pipes are read from the definition, which is not part of the repository.
//!
//! **As defined** supply of 50 degC at `i`, ground of 12 degC directly outside of the insulation, 20 K
//! between supply and return of a house, flow = load/(cp 20 K), the same supply and return pipes.
//!
//! **Chosen here** a by-pass flow of [`BYPASS_KG_S`] in every house, that of the published
//! AixLib/uesgraphs script; the load is linear between its rows; the water is that of `HEAD`; the
//! wall of the pipes stores nothing. Where the load is less than the by-pass could give, the house
//! returns warmer water; where the water that arrives is too cold to be cooled by 20 K to
//! `coldest_return_degc`, the load is not met.
//!
//! **Sources** `destest2019`.

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::fmt::Write;
use std::path::Path;

/// Smallest flow of a house, kg/s.
pub const BYPASS_KG_S: f64 = 0.0007;
/// Houses of the exercise.
pub const HOUSES: usize = 16;
/// The load profile of a house.
pub const PROFILE: &str = "heat_profile_1_building_SFH_Network_1.csv";
/// The pipes.
pub const PIPES: &str = "Pipe_data.csv";
/// Node of the source.
const SOURCE: &str = "i";
/// Houses have names that begin so.
const HOUSE: &str = "SimpleDistrict";

/// Water at about 40 degC; cp as in the published models.
const HEAD: &str = r#"format = 1
[model]
name = "DESTEST network common exercise 1"
[run]
until = "7d"
step = "1min"
record = "15min"
initial_degc = 50
[fluid]
kind = "constant_water"
density_kg_m3 = 995.586
heat_capacity_j_kg_k = 4184
[ground]
temperature_degc = 12
[pressure_reference]
node = "i.cold"
pressure_bar = 2
[[edge]]
id = "source"
kind = "resistance"
from = "i.cold"
to = "i.hot"
dp_nominal_pa = 1
m_flow_nominal_kg_s = 1
[[unit]]
id = "source.unit"
port = "source"
kind = "heat_source"
supply_degc = 50
"#;

/// A row of the pipes: ends, length m, inner diameter m, resistance to the ground per length K m/W.
struct Row {
    from: String,
    to: String,
    length_m: f64,
    diameter_m: f64,
    resistance_k_m_w: f64,
}

/// The model file of the exercise with the pipes in `folder` and the profile beside them (by its whole
/// path, so that the model can be read from anywhere).
///
/// # Errors
/// What is wrong with the pipes.
pub fn model(folder: &Path) -> Result<String, String> {
    let path = folder.join(PIPES);
    let wrong = |problem: String| format!("{}: {problem}", path.display());
    let table = std::fs::read_to_string(&path).map_err(|error| wrong(error.to_string()))?;
    let rows: Vec<Row> = table
        .lines()
        .skip(1)
        .filter(|line| !line.trim().is_empty())
        .map(|line| row(line).ok_or_else(|| wrong(format!("cannot read \"{line}\""))))
        .collect::<Result<_, _>>()?;
    let profile = folder.join(PROFILE);
    let profile = profile.canonicalize().map_err(|error| wrong(error.to_string()))?;
    let mut text = HEAD.to_owned();
    let sites: BTreeSet<&str> = rows.iter().flat_map(|row| [&*row.from, &*row.to]).collect();
    if !sites.contains(SOURCE) {
        return Err(wrong(format!("no pipe ends at the source \"{SOURCE}\"")));
    }
    // Writing to a String does not fail.
    for site in &sites {
        let _ = writeln!(text, "[[site]]\nid = \"{site}\"");
    }
    for row in &rows {
        let Row { from, to, length_m, diameter_m, resistance_k_m_w } = row;
        let _ = writeln!(
            text,
            "[[trench]]\nfrom = \"{from}\"\nto = \"{to}\"\nlength_m = {length_m}\n\
             inner_diameter_m = {diameter_m}\ninsulation_resistance_k_m_w = {resistance_k_m_w}"
        );
    }
    let v_flow_min_m3_s = BYPASS_KG_S / 995.586;
    for house in sites.iter().filter(|site| site.starts_with(HOUSE)) {
        let _ = writeln!(
            text,
            "[[station]]\nsite = \"{house}\"\nkind = \"prescribed_flow\"\n\
             [[unit]]\nsite = \"{house}\"\nkind = \"heat_load\"\ntemperature_difference_k = 20\n\
             v_flow_min_m3_s = {v_flow_min_m3_s}\n\
             [[series]]\nfile = \"{}\"\ncolumn = \"Building heat demand [W]\"\n\
             signal = \"{house}.unit.load_w\"\ninterpolation = \"linear\"",
            profile.display()
        );
    }
    Ok(text)
}

/// `from,to,length,inner diameter,insulation,peak load,pressure loss,conductivity`.
fn row(line: &str) -> Option<Row> {
    let cells: Vec<&str> = line.split(',').map(str::trim).collect();
    let number = |i: usize| cells.get(i)?.parse::<f64>().ok();
    let (diameter_m, insulation_m, conductivity_w_m_k) = (number(3)?, number(4)?, number(7)?);
    Some(Row {
        from: (*cells.first()?).to_owned(),
        to: (*cells.get(1)?).to_owned(),
        length_m: number(2)?,
        diameter_m,
        // R = ln((d + 2 s)/d)/(2 pi lambda)
        resistance_k_m_w: ((diameter_m + 2.0 * insulation_m) / diameter_m).ln()
            / (2.0 * PI * conductivity_w_m_k),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resistance_of_a_row() {
        // 50 mm bore, 45 mm of 0.035 W/(m K): ln(140/50)/(2 pi 0.035) = 1.02962/0.219911 = 4.68197
        let row = row("h,i,36.0,0.05,0.045,154.778,14391.963,0.035").unwrap();
        assert!((row.resistance_k_m_w - 4.682).abs() < 1e-3, "{}", row.resistance_k_m_w);
        assert!(super::row("h,i,36.0,0.05").is_none());
    }
}
