//! The electric connection of a house: what its units and pumps draw from the public grid, and feed in.
//!
//! **Equation** `P_grid = sum P` over all units and pumps of its site; import and export are its positive and negative
//! parts. Of what is generated at the site the share that is not exported is consumed there, `1 - E_export/E_generated`;
//! of what is consumed the share that is not imported comes from there, `1 - E_import/(E_grid + E_generated)`.
//!
//! Phases: units that say theirs (`phase_1_w` to `phase_3_w`) are summed up, the rest is a third on each, so that the phases
//! add up to `P_grid`; the asymmetry is the largest difference of two phases.
//!
//! **Assumptions** one connection per site; real power; import and export are those of the sum, as meters count; means over a step: what is drawn and fed in within a step cancels.
//! **Numerics** it has its turn behind all other units of a step. **Sources** definition; limit of the
//! asymmetry `vde4100`.

use crate::thermal_unit::{
    Exchange, Flag, SITE_GRID, ThermalUnit, UnitError, UnitInput, UnitOutput, UnitPort,
    not_negative,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The electric connection of a house as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GridConnectionParams {
    /// Largest difference of two phases that is no event, W.
    pub asymmetry_max_w: f64,
}

impl Default for GridConnectionParams {
    fn default() -> Self {
        Self { asymmetry_max_w: 4600.0 }
    }
}

/// The electric connection of a house. State: imported, exported, generated, J; largest asymmetry so far, W.
#[derive(Debug, Clone, PartialEq)]
pub struct GridConnection {
    asymmetry_max_w: f64,
}

impl GridConnectionParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<GridConnection, UnitError> {
        let asymmetry_max_w = not_negative("asymmetry_max_w", self.asymmetry_max_w)?;
        Ok(GridConnection { asymmetry_max_w })
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
            power("site_phase_1_w", f64::NEG_INFINITY, "site.phase_1_w"),
            power("site_phase_2_w", f64::NEG_INFINITY, "site.phase_2_w"),
            power("site_phase_3_w", f64::NEG_INFINITY, "site.phase_3_w"),
        ]
    }

    fn outputs(&self) -> Vec<UnitOutput> {
        vec![
            UnitOutput::new("grid_w", "W"),
            UnitOutput::new("import_j", "J"),
            UnitOutput::new("export_j", "J"),
            UnitOutput::new("self_consumption", "1"),
            UnitOutput::new("self_sufficiency", "1"),
            UnitOutput::new("phase_1_w", "W"),
            UnitOutput::new("phase_2_w", "W"),
            UnitOutput::new("phase_3_w", "W"),
            UnitOutput::new("asymmetry_w", "W"),
            UnitOutput::new("largest_asymmetry_w", "W"),
            UnitOutput::new("asymmetric", "1"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0; 4]
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
        let said_w = [signals.get(2), signals.get(3), signals.get(4)];
        let rest_w = (grid_w - said_w.iter().sum::<f64>()) / said_w.len() as f64;
        let [a, b, c] = said_w.map(|w| w + rest_w);
        let asymmetry_w = a.max(b).max(c) - a.min(b).min(c);
        if dt_s > 0.0 {
            state[3] = asymmetry_w.max(state[3]);
        }
        let asymmetric = f64::from(u8::from(asymmetry_w > self.asymmetry_max_w));
        out.copy_from_slice(&[
            grid_w,
            import_j,
            export_j,
            shares[0],
            shares[1],
            a,
            b,
            c,
            asymmetry_w,
            state[3],
            asymmetric,
        ]);
        Exchange::default()
    }

    fn flags(&self) -> &'static [Flag] {
        &[Flag {
            output: "asymmetric",
            meaning: "its phases differ by more than asymmetry_max_w: units of one phase stand on the same one",
        }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_by_hand() {
        let (mut state, mut out) = (vec![0.0; 4], [0.0; 11]);
        let unit = GridConnectionParams::default().build(&Medium::default()).unwrap();
        // An hour: 3 kW generated, 1 kW used, 2 kW fed in; an hour: 1 kW drawn.
        let signals = [-2000.0, 3000.0, 0.0, 0.0, 0.0];
        unit.advance(3600.0, &Signals(&signals), &[], &mut state, &mut out);
        assert!((out[3] - 1.0 / 3.0).abs() < 1e-12 && out[4] == 1.0);
        let signals = [1000.0, 0.0, 0.0, 0.0, 0.0];
        unit.advance(3600.0, &Signals(&signals), &[], &mut state, &mut out);
        assert_eq!((out[1], out[2]), (3.6e6, 7.2e6));
        assert!((out[4] - 0.5).abs() < 1e-12, "1 of 2 kWh from the roof: {out:?}");
    }

    #[test]
    fn phases_by_hand() {
        let (mut state, mut out) = (vec![0.0; 4], [0.0; 11]);
        let unit = GridConnectionParams::default().build(&Medium::default()).unwrap();
        // A roof of one phase gives 4.5 kW on the second, a kettle draws 2 kW on the first; 0.9 kW more are of three phases.
        let signals = [-1600.0, 4500.0, 2000.0, -4500.0, 0.0];
        unit.advance(60.0, &Signals(&signals), &[], &mut state, &mut out);
        assert_eq!(out[5..9], [2300.0, -4200.0, 300.0, 6500.0]);
        assert_eq!((out[5..8].iter().sum::<f64>(), out[10]), (out[0], 1.0));
        // The sum is what the meter counts.
        assert_eq!((out[1], out[2]), (0.0, 96_000.0));
        unit.advance(60.0, &Signals(&[900.0, 0.0, 0.0, 0.0, 0.0]), &[], &mut state, &mut out);
        assert_eq!(out[5..], [300.0, 300.0, 300.0, 0.0, 6500.0, 0.0]);
    }
}
