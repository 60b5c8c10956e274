//! The reference air-source unit of the 10 kW class ("CHA 10"): heating and cooling.
//!
//! **Equation** heating `Q = Q_nom f_Qm(m, t) f_Qa(a, t)`, `P = Q_nom/COP_nom f_Pm(m, t) f_Pa(a, t)` with
//! `a = (T_air - 2 degC)/10`, `t = (T_return - 35 degC)/10`: polynomials fitted to the published look-up tables.
//! Cooling `Q = Q_nom 1.5 m (1 - 0.012 (T_air - 35)) (1 + 0.02 (T_return - 23))`, `EER = EER_nom (1.15 - 0.25 (m -
//! 0.2)/0.8) (1 - 0.022 (T_air - 35)) (1 + 0.025 (T_return - 23))`, EER within 1.5 to 9 (assumed: the published
//! cooling tables are 1 everywhere).
//!
//! **Assumptions** the published model multiplies two tables that both know the return temperature, so its effect
//! counts twice; it can be left to the modulation factors alone. The argument is the return temperature.
//! **Validity** modulation 0.2 to 1; modulation factors return 30 to 70 degC, air factors return 15 to 60 degC, air
//! -20 to 20 degC. Each factor is clamped to its own range: beyond, the product gives a COP above 20. `P` is at
//! least a quarter of its nominal value. **Sources** `zinsmeister2024`; its table lists a COP of 5.92 at A2/W35,
//! which is the cooling EER, the library of the unit has 4.65.

use super::{Operation, Performance, degc};

/// Smallest share of the full speed.
pub const MODULATION_MIN: f64 = 0.2;
/// Least electric power as a share of the nominal one.
const LEAST_ELECTRIC: f64 = 0.25;
/// Least and largest cooling EER.
const EER_RANGE: (f64, f64) = (1.5, 9.0);

/// The reference unit in heating.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceHeating {
    /// Heat at air of 2 degC and water of 35 degC, W.
    pub nominal_w: f64,
    /// COP there.
    pub cop: f64,
    /// Largest COP.
    pub cop_max: f64,
    /// Whether the return temperature counts in both factors, as in the published model.
    pub return_counts_twice: bool,
}

/// The reference unit in cooling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceCooling {
    /// Cold at air of 35 degC and water of 18 degC, W.
    pub nominal_w: f64,
    /// EER there.
    pub eer: f64,
}

/// `c0 + c1 m + c2 m2 + c3 m3 + c4 t + c5 m t + c6 t2 + c7 m t2`
fn of_modulation(c: [f64; 8], m: f64, t: f64) -> f64 {
    c[0] + m * (c[1] + m * (c[2] + m * c[3])) + t * (c[4] + m * c[5] + t * (c[6] + m * c[7]))
}

/// `c0 + c1 a + c2 a2 + c3 t + c4 a t + c5 t2`
fn of_air(c: [f64; 6], a: f64, t: f64) -> f64 {
    c[0] + a * (c[1] + a * c[2]) + t * (c[3] + a * c[4] + t * c[5])
}

const HEAT_OF_MODULATION: [f64; 8] =
    [0.8307, -1.5143, 5.5075, -3.1272, -0.0734, 0.0250, 0.0011, -0.0042];
const POWER_OF_MODULATION: [f64; 8] =
    [1.1167, -5.1073, 12.3177, -6.6834, 0.1044, 0.1289, -0.0114, 0.0755];
const HEAT_OF_AIR: [f64; 6] = [1.0204, 0.2854, 0.0149, -0.0792, -0.0021, -0.0035];
const POWER_OF_AIR: [f64; 6] = [0.9980, 0.1012, 0.0137, 0.0959, 0.0209, -0.0026];

impl ReferenceHeating {
    /// Heat and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let m = operation.modulation.clamp(MODULATION_MIN, 1.0);
        let a = (degc(operation.source_in_k).clamp(-20.0, 20.0) - 2.0) / 10.0;
        let water = degc(operation.return_k);
        let t_m = (water.clamp(30.0, 70.0) - 35.0) / 10.0;
        let t_a =
            if self.return_counts_twice { (water.clamp(15.0, 60.0) - 35.0) / 10.0 } else { 0.0 };
        let heat = of_modulation(HEAT_OF_MODULATION, m, t_m) * of_air(HEAT_OF_AIR, a, t_a);
        let power = of_modulation(POWER_OF_MODULATION, m, t_m) * of_air(POWER_OF_AIR, a, t_a);
        let useful_w = self.nominal_w * heat.max(0.0);
        let electric_w = self.nominal_w / self.cop * power.max(LEAST_ELECTRIC);
        Performance { useful_w, electric_w }.capped(self.cop_max)
    }
}

impl ReferenceCooling {
    /// Cold and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let m = operation.modulation.clamp(MODULATION_MIN, 1.0);
        let (air, water) = (degc(operation.source_in_k) - 35.0, degc(operation.return_k) - 23.0);
        let cold = 1.5 * m * (1.0 - 0.012 * air).max(0.0) * (1.0 + 0.02 * water).max(0.0);
        let efficiency = (1.15 - 0.25 * (m - 0.2) / 0.8)
            * (1.0 - 0.022 * air).max(0.0)
            * (1.0 + 0.025 * water).max(0.0);
        let useful_w = self.nominal_w * cold;
        let eer = (self.eer * efficiency).clamp(EER_RANGE.0, EER_RANGE.1);
        Performance { useful_w, electric_w: useful_w / eer }
    }
}
