//! P11, leak: water leaves a node into the open.
//!
//! **Equation** `m = m_1 sqrt(p/1 bar)`, with the pressure `p` of the node above the atmosphere. What holds the pressure makes up for it.
//!
//! **Neutral** `m_flow = 0`. **Looks like** more water in than out, the more the higher the pressure, also at night; a zero offset of a
//! meter (S8) does not follow the pressure. **Validity** pressures above the atmosphere.

use crate::effect::{EffectError, ModelChange, wanted};
use crate::model::Model;
use crate::model_file::{NodeEntry, NodeEntryKind};
use crate::overlay::Change;
use anergy_network::elements::ElementParams;
use anergy_network::elements::resistance::ResistanceParams;
use anergy_network::two_port::not_negative;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use smol_str::format_smolstr;

/// The pressure at which the leak is given, Pa.
const ONE_BAR_PA: f64 = 1e5;

/// The effect as written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NodeLeak {
    /// Water that leaves at 1 bar above the atmosphere, kg/s; 0 changes nothing.
    pub m_flow_kg_s: f64,
}

impl NodeLeak {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the field.
    pub fn build(&self, _: &()) -> Result<Self, EffectError> {
        not_negative("m_flow_kg_s", self.m_flow_kg_s)?;
        Ok(self.clone())
    }
}

impl ModelChange for NodeLeak {
    fn changes(&self, component: &str, model: &Model) -> Result<Vec<Change>, EffectError> {
        let node = model.nodes.iter().find(|node| node.entry.id == component);
        let node = node.ok_or_else(|| wanted("node", component))?;
        if self.m_flow_kg_s == 0.0 {
            return Ok(Vec::new());
        }
        let outside = NodeEntry {
            id: format_smolstr!("{component}.outside"),
            kind: NodeEntryKind::PressureBoundary,
            volume_m3: 0.0,
            ua_w_k: 0.0,
            pressure_pa: Some(0.0),
            m_flow_kg_s: None,
            temperature_k: None,
            min_pressure_pa: None,
            max_pressure_pa: None,
            ..node.entry.clone()
        };
        let hole = ResistanceParams {
            dp_nominal_pa: Some(ONE_BAR_PA),
            m_flow_nominal_kg_s: Some(self.m_flow_kg_s),
            ..ResistanceParams::default()
        };
        let to = outside.id.to_string();
        Ok(vec![
            Change::InsertNode { entry: Box::new(outside) },
            Change::InsertEdge {
                id: format!("{component}.leak"),
                from: component.to_owned(),
                to,
                params: ElementParams::Resistance(hole),
            },
        ])
    }
}
