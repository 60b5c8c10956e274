//! The electric connection of a house: what its units and pumps draw from the public grid, and feed in.
//!
//! **Equation** `P_grid = sum P` over all units and pumps of its site; import and export are its positive and negative
//! parts. Of what is generated at the site the share that is not exported is consumed there, `1 - E_export/E_generated`;
//! of what is consumed the share that is not imported comes from there, `1 - E_import/(E_grid + E_generated)`.
//!
//! Phases: units that say theirs (`phase_1_w` to `phase_3_w`) are summed up, the rest is a third on each, so that the phases
//! add up to `P_grid`; the asymmetry is the largest difference of two phases.
//!
//! Costs: electricity drawn and fuel of the site at their prices, what is fed in at its price and a bonus for the share that
//! is generated from fuel, `C = sum (P_import p_import + P_fuel p_fuel - P_export (p_export + s_chp p_bonus)) dt`,
//! `s_chp = P_chp/P_generated` in the same step. Prices are inputs: series drive them.
//!
//! Reactive power: `Q = sum P tan(arccos(cos phi))` over the units and pumps whose power factor is given, `S^2 = P^2 + Q^2`.
//!
//! **Assumptions** one connection per site; power factors that do not change with the load; import and export are those of the sum, as meters count; means over a step: what is drawn and fed in within a step cancels.
//! **Numerics** it has its turn behind all other units of a step. **Sources** definition; costs: specification 11; limit of
//! the asymmetry `vde4100`.

use crate::thermal_unit::{
    Exchange, Flag, SITE_COGENERATED, SITE_GRID, SITE_REACTIVE, ThermalUnit, UnitError, UnitInput,
    UnitOutput, UnitPort, not_negative,
};
use anergy_core::medium::Medium;
use anergy_core::port::{PortFlow, PortRequest};
use anergy_core::signal::Signals;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The electric connection of a house as written in a model file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GridConnectionParams {
    /// Largest difference of two phases that is no event, W.
    pub asymmetry_max_w: f64,
    /// Price of what is drawn while nothing drives it, EUR/J.
    pub import_price_eur_j: f64,
    /// Price of what is fed in while nothing drives it, EUR/J.
    pub export_price_eur_j: f64,
    /// What is paid besides for what is fed in of electricity from fuel, EUR/J.
    pub chp_bonus_eur_j: f64,
    /// Power factor `cos phi` of units of the site by their names, and of its pumps as `pumps`; negative where they lead
    /// (capacitive). Others have 1.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub power_factor: BTreeMap<String, f64>,
    /// Price of the fuel of the site while nothing drives it, EUR/J; by the heating value of the units' efficiencies.
    pub fuel_price_eur_j: f64,
}

impl Default for GridConnectionParams {
    fn default() -> Self {
        Self {
            asymmetry_max_w: 4600.0,
            import_price_eur_j: 0.0,
            export_price_eur_j: 0.0,
            chp_bonus_eur_j: 0.0,
            power_factor: BTreeMap::new(),
            fuel_price_eur_j: 0.0,
        }
    }
}

/// The electric connection of a house. State: imported, exported, generated, J; largest asymmetry so far, W; paid for
/// electricity and fuel, got for what was fed in, EUR.
#[derive(Debug, Clone, PartialEq)]
pub struct GridConnection {
    params: GridConnectionParams,
}

impl GridConnectionParams {
    /// The runtime unit.
    ///
    /// # Errors
    /// Names the field that is out of range.
    pub fn build(&self, _medium: &Medium) -> Result<GridConnection, UnitError> {
        not_negative("asymmetry_max_w", self.asymmetry_max_w)?;
        for (field, value) in [
            ("import_price_eur_j", self.import_price_eur_j),
            ("export_price_eur_j", self.export_price_eur_j),
            ("chp_bonus_eur_j", self.chp_bonus_eur_j),
            ("fuel_price_eur_j", self.fuel_price_eur_j),
        ] {
            let requirement = "must be a number";
            if !value.is_finite() {
                return Err(UnitError::OutOfRange { field, value, requirement });
            }
        }
        for (name, cos_phi) in &self.power_factor {
            if !(cos_phi.abs() > 0.0 && cos_phi.abs() <= 1.0) {
                let problem = format!(
                    "power_factor of {name}: {cos_phi} is not within 0 to 1, or -1 to 0 where it leads"
                );
                return Err(UnitError::Within { field: "power_factor", problem });
            }
        }
        Ok(GridConnection { params: self.clone() })
    }
}

/// The name under which the power factor of all pumps of a site is given.
pub const PUMPS: &str = "pumps";

impl GridConnection {
    /// Reactive over real power of a unit of the site, or of its [`PUMPS`].
    pub fn reactive_share(&self, name: &str) -> Option<f64> {
        // tan(arccos(c)), with the sign of c.
        self.params.power_factor.get(name).map(|c| (1.0 - c * c).sqrt() / c)
    }

    /// Whose power factors are given.
    pub fn with_power_factor(&self) -> impl Iterator<Item = &str> {
        self.params.power_factor.keys().map(String::as_str)
    }
}

/// Its inputs, in their order.
mod input {
    pub const SITE: usize = 0;
    pub const GENERATED: usize = 1;
    pub const PHASES: [usize; 3] = [2, 3, 4];
    pub const FUEL: usize = 5;
    pub const COGENERATED: usize = 6;
    pub const IMPORT_PRICE: usize = 7;
    pub const EXPORT_PRICE: usize = 8;
    pub const FUEL_PRICE: usize = 9;
    pub const REACTIVE: usize = 10;
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
        let price = |name, initial| UnitInput {
            name,
            unit: "eur_j",
            initial,
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
            follows: None,
        };
        vec![
            power("site_w", f64::NEG_INFINITY, SITE_GRID),
            power("site_generated_w", 0.0, "site.generated_w"),
            power("site_phase_1_w", f64::NEG_INFINITY, "site.phase_1_w"),
            power("site_phase_2_w", f64::NEG_INFINITY, "site.phase_2_w"),
            power("site_phase_3_w", f64::NEG_INFINITY, "site.phase_3_w"),
            power("site_fuel_w", 0.0, "site.fuel_w"),
            power("site_cogenerated_w", 0.0, SITE_COGENERATED),
            price("import_price_eur_j", self.params.import_price_eur_j),
            price("export_price_eur_j", self.params.export_price_eur_j),
            price("fuel_price_eur_j", self.params.fuel_price_eur_j),
            UnitInput {
                unit: "var",
                ..power("site_reactive_var", f64::NEG_INFINITY, SITE_REACTIVE)
            },
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
            UnitOutput::new("reactive_var", "var"),
            UnitOutput::new("apparent_va", "V A"),
            UnitOutput::state("electricity_cost_eur", "EUR"),
            UnitOutput::state("fuel_cost_eur", "EUR"),
            UnitOutput::state("revenue_eur", "EUR"),
        ]
    }

    fn initial_state(&self, _initial_k: f64) -> Vec<f64> {
        vec![0.0; 7]
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
        let grid_w = signals.get(input::SITE);
        state[0] += dt_s * grid_w.max(0.0);
        state[1] += dt_s * (-grid_w).max(0.0);
        state[2] += dt_s * signals.get(input::GENERATED);
        let of_fuel = if signals.get(input::GENERATED) > 0.0 {
            signals.get(input::COGENERATED) / signals.get(input::GENERATED)
        } else {
            0.0
        };
        let export_eur_j =
            signals.get(input::EXPORT_PRICE) + of_fuel.min(1.0) * self.params.chp_bonus_eur_j;
        state[4] += dt_s * grid_w.max(0.0) * signals.get(input::IMPORT_PRICE);
        state[5] += dt_s * signals.get(input::FUEL) * signals.get(input::FUEL_PRICE);
        state[6] += dt_s * (-grid_w).max(0.0) * export_eur_j;
        let [import_j, export_j, generated_j] = [state[0], state[1], state[2]];
        let consumed_j = import_j - export_j + generated_j;
        // A battery may export more than is generated.
        let kept = |part_j: f64, of_j: f64| {
            if of_j > 0.0 { (1.0 - part_j / of_j).clamp(0.0, 1.0) } else { 0.0 }
        };
        let shares = [kept(export_j, generated_j), kept(import_j, consumed_j)];
        let said_w = input::PHASES.map(|phase| signals.get(phase));
        let rest_w = (grid_w - said_w.iter().sum::<f64>()) / said_w.len() as f64;
        let [a, b, c] = said_w.map(|w| w + rest_w);
        let asymmetry_w = a.max(b).max(c) - a.min(b).min(c);
        if dt_s > 0.0 {
            state[3] = asymmetry_w.max(state[3]);
        }
        let asymmetric = f64::from(u8::from(asymmetry_w > self.params.asymmetry_max_w));
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
            signals.get(input::REACTIVE),
            grid_w.hypot(signals.get(input::REACTIVE)),
            state[4],
            state[5],
            state[6],
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

    struct Connection {
        unit: GridConnection,
        state: Vec<f64>,
        out: [f64; 16],
    }

    impl Connection {
        fn new(params: &GridConnectionParams) -> Self {
            let unit = params.build(&Medium::default()).unwrap();
            Self { state: unit.initial_state(293.15), out: [0.0; 16], unit }
        }

        /// A step of these inputs, the rest as nothing drives them.
        fn advance(&mut self, dt_s: f64, inputs: &[f64]) {
            let mut signals: Vec<f64> =
                self.unit.inputs().iter().map(|input| input.initial).collect();
            signals[..inputs.len()].copy_from_slice(inputs);
            self.unit.advance(dt_s, &Signals(&signals), &[], &mut self.state, &mut self.out);
        }
    }

    #[test]
    fn shares_by_hand() {
        let mut connection = Connection::new(&GridConnectionParams::default());
        // An hour: 3 kW generated, 1 kW used, 2 kW fed in; an hour: 1 kW drawn.
        connection.advance(3600.0, &[-2000.0, 3000.0]);
        let out = connection.out;
        assert!((out[3] - 1.0 / 3.0).abs() < 1e-12 && out[4] == 1.0);
        connection.advance(3600.0, &[1000.0]);
        let out = connection.out;
        assert_eq!((out[1], out[2]), (3.6e6, 7.2e6));
        assert!((out[4] - 0.5).abs() < 1e-12, "1 of 2 kWh from the roof: {out:?}");
    }

    #[test]
    fn phases_by_hand() {
        let mut connection = Connection::new(&GridConnectionParams::default());
        // A roof of one phase gives 4.5 kW on the second, a kettle draws 2 kW on the first; 0.9 kW more are of three phases.
        connection.advance(60.0, &[-1600.0, 4500.0, 2000.0, -4500.0]);
        let out = connection.out;
        assert_eq!(out[5..9], [2300.0, -4200.0, 300.0, 6500.0]);
        assert_eq!((out[5..8].iter().sum::<f64>(), out[10]), (out[0], 1.0));
        // The sum is what the meter counts.
        assert_eq!((out[1], out[2]), (0.0, 96_000.0));
        connection.advance(60.0, &[900.0]);
        assert_eq!(connection.out[5..11], [300.0, 300.0, 300.0, 0.0, 6500.0, 0.0]);
    }

    #[test]
    fn costs_by_hand() {
        const EUR_KWH: f64 = 1.0 / 3.6e6;
        let mut connection = Connection::new(&GridConnectionParams {
            import_price_eur_j: 0.32 * EUR_KWH,
            export_price_eur_j: 0.06 * EUR_KWH,
            chp_bonus_eur_j: 0.10 * EUR_KWH,
            fuel_price_eur_j: 0.14 * EUR_KWH,
            ..GridConnectionParams::default()
        });
        // Two hours with 1 kW drawn, 10 kW of gas: 0.64 EUR and 2.80 EUR.
        connection.advance(7200.0, &[1000.0, 0.0, 0.0, 0.0, 0.0, 10_000.0]);
        // An hour with 4 kWh fed in, of what is generated a quarter from gas: 4 (0.06 + 0.10/4) = 0.34 EUR.
        connection.advance(3600.0, &[-4000.0, 8000.0, 0.0, 0.0, 0.0, 0.0, 2000.0]);
        for (got, expected) in connection.out[13..].iter().zip([0.64, 2.80, 0.34]) {
            assert!((got - expected).abs() < 1e-12, "{:?}", connection.out);
        }
        // 3 kW and 4 kvar are 5 kVA; cos phi = 0.8 draws 0.75 var per W, a leading one gives them.
        connection.advance(0.0, &[3000.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4000.0]);
        assert_eq!(connection.out[11..13], [4000.0, 5000.0]);
        // At a price of -5 ct whoever draws 2 kWh is paid 0.10 EUR.
        let mut inputs = [0.0; 8];
        (inputs[0], inputs[7]) = (2000.0, -0.05 * EUR_KWH);
        connection.advance(3600.0, &inputs);
        assert!((connection.out[13] - 0.54).abs() < 1e-12);
    }

    #[test]
    fn reactive_shares() {
        let power_factor = [("heat_pump".to_owned(), 0.8), (PUMPS.to_owned(), -0.8)];
        let params =
            GridConnectionParams { power_factor: power_factor.into(), ..Default::default() };
        let unit = params.build(&Medium::default()).unwrap();
        assert!((unit.reactive_share("heat_pump").unwrap() - 0.75).abs() < 1e-12);
        assert!((unit.reactive_share(PUMPS).unwrap() + 0.75).abs() < 1e-12);
        assert_eq!(unit.reactive_share("oven"), None);
        let params = GridConnectionParams {
            power_factor: [("oven".to_owned(), 0.0)].into(),
            ..Default::default()
        };
        assert!(params.build(&Medium::default()).is_err());
    }
}
