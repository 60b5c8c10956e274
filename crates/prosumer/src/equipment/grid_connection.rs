//! The electric connection of a house: what its units and pumps draw from the public grid, and feed in.
//!
//! **Equation** `P_grid = sum P` over all units and pumps of its site; import and export are its positive and negative
//! parts. Of what is generated at the site the share that is not exported is consumed there, `1 - E_export/E_generated`;
//! of what is consumed the share that is not imported comes from there, `1 - E_import/(E_grid + E_generated)`.
//!
//! **Assumptions** one connection per site; means over a step: what is drawn and fed in within a step cancels.
//! **Numerics** it has its turn behind all other units of a step. **Sources** definition.

use crate::thermal_unit::{
    Exchange, SITE_GRID, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The electric connection of a house as written in a model file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GridConnectionParams {}

/// The electric connection of a house. State: imported, exported, generated, J.
#[derive(Debug, Clone, PartialEq)]
pub struct GridConnection;

impl GridConnectionParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// None.
    pub fn build(&self, _medium: &Medium) -> Result<GridConnection, UnitError> {
        Ok(GridConnection)
    }
}

impl ThermalUnit for GridConnection {
    fn ports(&self) -> Vec<UnitPort> {
        Vec::new()
    }

    fn inputs(&self) -> Vec<UnitInput> {
        let power = |name, min, follows| UnitInput {
            name,
            unit: "w",
            initial: 0.0,
            min,
            max: f64::INFINITY,
            follows: Some(follows),
        };
        vec![
            power("site_w", f64::NEG_INFINITY, SITE_GRID),
            power("site_generated_w", 0.0, "site.generated_w"),
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("grid_w", "W"),
            UnitOutput::new("import_j", "J"),
            UnitOutput::new("export_j", "J"),
            UnitOutput::new("self_consumption", "1"),
            UnitOutput::new("self_sufficiency", "1"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0; 3]
    }

    fn request(
        &self,
        _signals: &Signals<'_>,
        _got: &[PortFlow],
        _state: &mut [f64],
        _wanted: &mut [PortRequest],
    ) {
    }

    fn advance(
        &self,
        dt_s: f64,
        signals: &Signals<'_>,
        _ports: &[PortFlow],
        state: &mut [f64],
        out: &mut [f64],
    ) -> Exchange {
        let grid_w = signals.get(0);
        state[0] += dt_s * grid_w.max(0.0);
        state[1] += dt_s * (-grid_w).max(0.0);
        state[2] += dt_s * signals.get(1);
        let [import_j, export_j, generated_j] = [state[0], state[1], state[2]];
        let consumed_j = import_j - export_j + generated_j;
        // A battery may export more than is generated.
        let kept = |part_j: f64, of_j: f64| {
            if of_j > 0.0 { (1.0 - part_j / of_j).clamp(0.0, 1.0) } else { 0.0 }
        };
        let shares = [kept(export_j, generated_j), kept(import_j, consumed_j)];
        out.copy_from_slice(&[grid_w, import_j, export_j, shares[0], shares[1]]);
        Exchange::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_by_hand() {
        let (mut state, mut out) = (vec![0.0; 3], [0.0; 5]);
        let unit = GridConnection;
        // An hour: 3 kW generated, 1 kW used, 2 kW fed in; an hour: 1 kW drawn.
        unit.advance(3600.0, &Signals(&[-2000.0, 3000.0]), &[], &mut state, &mut out);
        assert!((out[3] - 1.0 / 3.0).abs() < 1e-12 && out[4] == 1.0);
        unit.advance(3600.0, &Signals(&[1000.0, 0.0]), &[], &mut state, &mut out);
        assert_eq!((out[1], out[2]), (3.6e6, 7.2e6));
        assert!((out[4] - 0.5).abs() < 1e-12, "1 of 2 kWh from the roof: {out:?}");
    }
}
