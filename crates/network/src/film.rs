//! Heat transfer between the water in a pipe and its wall.
//!
//! **Equation** `h = Nu lambda/d`. Laminar, `Re <= 2300`: `Nu = 3.66` (developed, constant wall temperature).
//! Turbulent, `Re >= 4000`: Gnielinski `Nu = (f/8)(Re - 1000) Pr/(1 + 12.7 sqrt(f/8) (Pr^(2/3) - 1))` with
//! `f = (0.79 ln Re - 1.64)^-2` of a smooth pipe. Between them linear in Re.
//!
//! **Assumptions** developed flow; properties of the water at its mean temperature (no wall correction); no
//! free convection. **Validity** Re to 5e6, Pr 0.5 to 2000. **Sources** `gnielinski1976`, `gnielinski2013`
//! (passage), `incropera2007` (laminar, friction factor).

/// Flow is laminar up to this Reynolds number.
const RE_LAMINAR: f64 = 2300.0;
/// Flow is turbulent from this Reynolds number on.
const RE_TURBULENT: f64 = 4000.0;
/// Nusselt number of developed laminar flow.
const NU_LAMINAR: f64 = 3.66;

/// Nusselt number of the flow in a pipe.
pub fn nusselt(re: f64, prandtl: f64) -> f64 {
    if re <= RE_LAMINAR {
        return NU_LAMINAR;
    }
    if re >= RE_TURBULENT {
        return gnielinski(re, prandtl);
    }
    let share = (re - RE_LAMINAR) / (RE_TURBULENT - RE_LAMINAR);
    NU_LAMINAR + share * (gnielinski(RE_TURBULENT, prandtl) - NU_LAMINAR)
}

fn gnielinski(re: f64, prandtl: f64) -> f64 {
    let eighth = (0.79 * re.ln() - 1.64).powi(-2) / 8.0;
    eighth * (re - 1000.0) * prandtl
        / (1.0 + 12.7 * eighth.sqrt() * (prandtl.powf(2.0 / 3.0) - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turbulent_flow_by_hand() {
        // Re 14 267, Pr 6.978: f = (0.79 * 9.5657 - 1.64)^-2 = 5.9169^-2 = 0.028564, f/8 = 0.0035705;
        // Nu = 0.0035705 * 13 267 * 6.978/(1 + 12.7 * 0.059754 * (3.6516 - 1)) = 330.55/3.0122 = 109.74
        assert!((nusselt(14_267.0, 6.978) - 109.74).abs() < 0.05);
    }

    #[test]
    fn the_passage_is_continuous() {
        assert_eq!(nusselt(0.0, 7.0), 3.66);
        assert!((nusselt(2300.001, 7.0) - 3.66).abs() < 1e-3);
        assert!((nusselt(3999.999, 7.0) / nusselt(4000.0, 7.0) - 1.0).abs() < 1e-6);
    }
}
