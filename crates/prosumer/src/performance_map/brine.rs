//! The reference brine heat pump ("BWS-1-10"): on or off, 10.8 kW.
//!
//! **Equation** `Q = Q_nom f_Q(a, t)`, `P = Q_nom/COP_nom f_P(a, t)` with `a = T_brine/10 degC`, `t = (T_supply - 35 degC)/10`:
//! polynomials fitted to the published table; the argument is the supply temperature. **Validity** brine -5 to 20,
//! supply 25 to 70 degC; clamped beyond. At B0/W35 the fit gives 3.6 % less heat than its nominal value.
//! **Sources** `prohmo`.

use super::{Operation, Performance, degc};

/// The reference unit, scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrineFit {
    /// Heat at brine of 0 and water of 35 degC, W.
    pub nominal_w: f64,
    /// COP there.
    pub cop: f64,
}

impl BrineFit {
    /// Heat and electricity.
    pub fn at(&self, operation: &Operation) -> Performance {
        let a = degc(operation.source_in_k).clamp(-5.0, 20.0) / 10.0;
        let t = (degc(operation.supply_k).clamp(25.0, 70.0) - 35.0) / 10.0;
        let power = 1.0029 - 0.0028 * a - 0.0077 * a * a + t * (0.2094 + 0.0137 * a + 0.0319 * t);
        let heat = 0.9636 + a * (0.2723 + 0.0031 * a) - t * (0.0190 + 0.0119 * a + 0.0069 * t);
        Performance {
            useful_w: self.nominal_w * heat,
            electric_w: self.nominal_w / self.cop * power,
        }
    }
}
