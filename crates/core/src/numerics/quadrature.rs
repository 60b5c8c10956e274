//! Integrals of smooth laws over a step.

/// Points and weights of Gauss' rule of three points on 0 to 1: exact for polynomials up to the fifth power.
pub const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 4.0 / 9.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_up_to_the_fifth_power() {
        for n in 0..=5 {
            let integral: f64 = GAUSS.iter().map(|(x, weight)| weight * x.powi(n)).sum();
            assert!((integral - 1.0 / f64::from(n + 1)).abs() < 1e-15, "x^{n}: {integral}");
        }
    }
}
