//! Given pressures and flows at the junctions of a net.

use super::tables::Tables;
use crate::model_text::ModelText;
use crate::{ImportError, NoteKind};
use std::collections::HashMap;

/// Temperatures of liquid water.
const LIQUID_K: std::ops::RangeInclusive<f64> = 273.65..=372.15;

/// A given pressure at a junction.
pub(super) struct Fixed {
    pub pressure_pa: f64,
    pub temperature_k: Option<f64>,
}

/// Pressures of external grids and circulation pumps.
pub(super) fn fixed(
    net: &Tables,
    text: &mut ModelText,
) -> Result<HashMap<i64, Fixed>, ImportError> {
    let mut fixed = HashMap::new();
    let mut hot = Vec::new();
    let mut add = |junction, bar: f64, t_k: Option<f64>| {
        let temperature_k = t_k.filter(|t_k| LIQUID_K.contains(t_k));
        if temperature_k != t_k {
            hot.push(format!("{} K at junction {junction}", t_k.unwrap_or_default()));
        }
        fixed.insert(junction, Fixed { pressure_pa: 1e5 * bar, temperature_k });
    };
    let grids = net.table("ext_grid")?;
    for row in grids.in_service() {
        if grids.text(row, "type").is_some_and(|kind| !kind.contains('p')) {
            let what = format!("ext_grid {} gives a temperature without a pressure", row.index);
            text.note(NoteKind::Problem, None, what);
            continue;
        }
        let junction = grids.integer(row, "junction")?;
        add(junction, grids.number(row, "p_bar")?, grids.maybe(row, "t_k"));
    }
    for name in ["circ_pump_mass", "circ_pump_pressure"] {
        let pumps = net.table(name)?;
        for row in pumps.in_service() {
            let (flow_bar, t_k) = (pumps.number(row, "p_flow_bar")?, pumps.maybe(row, "t_flow_k"));
            add(pumps.integer(row, "flow_junction")?, flow_bar, t_k);
            let what = if name == "circ_pump_pressure" {
                let lift = pumps.number(row, "plift_bar")?;
                add(pumps.integer(row, "return_junction")?, flow_bar - lift, t_k);
                "two boundaries with its pressures"
            } else {
                "a boundary with its pressure and a source with its flow"
            };
            text.note(NoteKind::Changed, None, format!("{name} {} is {what}", row.index));
        }
    }
    for what in hot {
        let what =
            format!("{what}: no temperature of liquid water, the start temperature is taken");
        text.note(NoteKind::Problem, None, what);
    }
    Ok(fixed)
}

/// What pumps with a given flow take out.
pub(super) fn circulation(net: &Tables, m_flow: &mut HashMap<i64, f64>) -> Result<(), ImportError> {
    let pumps = net.table("circ_pump_mass")?;
    for row in pumps.in_service() {
        let flow = pumps.number(row, "mdot_flow_kg_per_s")?;
        *m_flow.entry(pumps.integer(row, "return_junction")?).or_insert(0.0) -= flow;
    }
    Ok(())
}
