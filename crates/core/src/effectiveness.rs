//! Effectiveness of a counter-flow heat exchanger.
//!
//! **Equation** `eps = (1 - e^(-NTU(1-Z)))/(1 - Z e^(-NTU(1-Z)))` with `NTU = UA/Cmin`, `Z = Cmin/Cmax`, and
//! `NTU/(1+NTU)` for `1-Z` inside the band. **Numerics** no cancellation near `Z = 1`.
//! **Sources** `incropera2007`.

/// Share of the largest possible heat that a counter-flow exchanger passes on.
pub fn counter_flow(ntu: f64, z: f64, band: f64) -> f64 {
    let one_minus_z = 1.0 - z;
    if one_minus_z < band.max(1e-12) {
        return ntu / (1.0 + ntu);
    }
    // (1 - e)/(1 - Z e) with e = exp(-x): 1 - Z e = (1 - Z) + Z (1 - e)
    let loss = -(-ntu * one_minus_z).exp_m1();
    loss / (one_minus_z + z * loss)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_the_book() {
        // NTU = 1, Z = 0.5: (1 - e^-0.5)/(1 - 0.5 e^-0.5) = 0.393469/0.696735 = 0.56473
        assert!((counter_flow(1.0, 0.5, 1e-6) - 0.564_73).abs() < 1e-5);
        assert_eq!(counter_flow(1.0, 1.0, 1e-6), 0.5);
        assert!((counter_flow(2.0, 0.0, 1e-6) - (1.0 - (-2.0_f64).exp())).abs() < 1e-15);
    }
}
