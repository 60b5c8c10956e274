//! Properties of mixtures of water with an antifreeze over share and temperature.
//!
//! **Equation** with the share x of the mass and the temperature T, around their means `x_m` and `T_m`:
//! `f = sum C_ij (T - T_m)^i (x - x_m)^j`, i to 3, j to 5, i + j to 5. f is the density, the heat
//! capacity, the conductivity and the natural logarithm of the viscosity in mPa s; freezing point: the
//! powers of x alone.
//!
//! **Validity** share up to 0.6, freezing point to 100 degC. Two published sets of tables (`melinder2010`,
//! ASHRAE) differ by up to 2.5 % in heat capacity, 1 % in density, 3 % in conductivity, 5 % in viscosity.
//!
//! **Sources** `melinder2010` (coefficients), `bell2014` (the same, independently implemented: values of
//! the tests).

use serde::{Deserialize, Serialize};

/// Largest share of the mass that the coefficients cover.
pub const LARGEST_SHARE: f64 = 0.6;

/// An antifreeze.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Glycol {
    /// Ethylene glycol.
    Ethylene,
    /// Propylene glycol.
    Propylene,
}

/// Polynomial in T (rows) and x (columns).
type Polynomial = [&'static [f64]; 4];

struct Coefficients {
    t_mean_k: f64,
    share_mean: f64,
    freezing_k: [f64; 6],
    density: Polynomial,
    heat_capacity: Polynomial,
    conductivity: Polynomial,
    log_viscosity: Polynomial,
}

const ETHYLENE: Coefficients = Coefficients {
    t_mean_k: 304.878,
    share_mean: 0.308_462,
    freezing_k: [257.9, -80.80, -133.4, -72.93, 100.6, 11.40],
    density: [
        &[1034.0, 131.1, 0.7490, -106.2, -96.23, 489.1],
        &[-0.4781, -0.6876, 0.7855, 1.229, -7.211],
        &[-2.692e-3, 4.805e-3, -3.995e-3, -1.153e-2],
        &[4.725e-6, 1.690e-6, 4.982e-5],
    ],
    heat_capacity: [
        &[3737.0, -1799.0, -993.3, 2610.0, 1537.0, -16_180.0],
        &[2.930, 10.46, 3.516, -1.189, -42.72],
        &[-4.675e-3, -4.147e-2, 5.109e-2, -0.1643],
        &[-1.389e-5, 1.847e-5, -7.138e-4],
    ],
    conductivity: [
        &[0.4720, -0.4286, 0.1747, 3.017e-2, -0.1322, 0.2678],
        &[8.903e-4, -1.473e-3, 6.814e-4, -2.412e-3, 2.555e-3],
        &[-1.058e-6, 1.059e-5, -3.612e-5, 4.004e-5],
        &[-2.789e-9, -1.142e-8, 2.365e-8],
    ],
    log_viscosity: [
        &[0.4705, 2.471, 3.328e-2, 1.659, 3.089, -18.65],
        &[-2.550e-2, -1.171e-2, 1.086e-2, 3.157e-3, 1.831e-2],
        &[1.782e-4, 1.052e-4, 1.051e-4, 4.063e-4],
        &[-7.669e-7, -1.634e-6, -6.475e-6],
    ],
};

const PROPYLENE: Coefficients = Coefficients {
    t_mean_k: 305.8583,
    share_mean: 0.307_031,
    freezing_k: [259.9, -66.31, -109.4, -228.3, -340.9, 146.5],
    density: [
        &[1018.0, 76.04, -24.98, -155.0, -113.1, 234.2],
        &[-0.5406, -0.9450, 0.2700, 2.829, -2.221],
        &[-2.666e-3, 5.541e-3, -4.018e-3, -7.175e-3],
        &[1.347e-5, -1.343e-5, 3.376e-5],
    ],
    heat_capacity: [
        &[3882.0, -1304.0, -1598.0, 353.9, 5000.0, -4959.0],
        &[2.699, 5.070, 0.9534, 31.02, -71.35],
        &[-1.659e-3, -4.752e-3, 0.1167, -0.2950],
        &[-1.032e-5, 1.522e-4, -4.870e-4],
    ],
    conductivity: [
        &[0.4513, -0.4795, 0.2076, -9.083e-2, -5.952e-2, 0.2104],
        &[7.955e-4, -1.678e-3, 1.563e-3, -2.518e-3, -3.605e-3],
        &[3.482e-8, 8.941e-6, -4.615e-5, 6.543e-5],
        &[-5.966e-9, 1.493e-8, 9.897e-8],
    ],
    log_viscosity: [
        &[0.6837, 3.328, 0.5453, -3.900, -1.587, 35.64],
        &[-3.045e-2, -3.984e-2, -8.600e-4, 0.1054, 4.475e-2],
        &[2.525e-4, 4.332e-4, -1.593e-4, -1.589e-3],
        &[-1.399e-6, -1.860e-6, -4.465e-7],
    ],
};

fn powers(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

impl Glycol {
    fn coefficients(self) -> &'static Coefficients {
        match self {
            Self::Ethylene => &ETHYLENE,
            Self::Propylene => &PROPYLENE,
        }
    }

    fn at(self, polynomial: &Polynomial, share: f64, t_k: f64) -> f64 {
        let own = self.coefficients();
        let (t, x) = (t_k - own.t_mean_k, share - own.share_mean);
        polynomial.iter().rev().fold(0.0, |sum, row| sum * t + powers(row, x))
    }

    /// Freezing point of a mixture, K.
    pub fn freezing_k(self, share: f64) -> f64 {
        let own = self.coefficients();
        powers(&own.freezing_k, share - own.share_mean)
    }

    /// Density, kg/m3.
    pub fn density_kg_m3(self, share: f64, t_k: f64) -> f64 {
        self.at(&self.coefficients().density, share, t_k)
    }

    /// Specific heat capacity, J/(kg K).
    pub fn heat_capacity_j_kg_k(self, share: f64, t_k: f64) -> f64 {
        self.at(&self.coefficients().heat_capacity, share, t_k)
    }

    /// Dynamic viscosity, Pa s.
    pub fn viscosity_pa_s(self, share: f64, t_k: f64) -> f64 {
        1e-3 * self.at(&self.coefficients().log_viscosity, share, t_k).exp()
    }

    /// Thermal conductivity, W/(m K).
    pub fn conductivity_w_m_k(self, share: f64, t_k: f64) -> f64 {
        self.at(&self.coefficients().conductivity, share, t_k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the mass, degC, kg/m3, J/(kg K), Pa s, W/(m K), freezing point in degC.
    type Case = (Glycol, f64, f64, f64, f64, f64, f64, f64);

    /// `bell2014`, Melinder's mixtures.
    const MELINDER: [Case; 8] = [
        (Glycol::Ethylene, 0.2, 0.0, 1029.065, 3860.837, 3.177595e-03, 0.484142, -7.949),
        (Glycol::Ethylene, 0.3, 20.0, 1038.046, 3718.251, 2.166450e-03, 0.464897, -14.576),
        (Glycol::Ethylene, 0.5, -20.0, 1082.196, 3086.975, 2.217840e-02, 0.364738, -35.994),
        (Glycol::Ethylene, 0.3, 80.0, 1004.257, 3877.674, 6.388400e-04, 0.516237, -14.576),
        (Glycol::Propylene, 0.25, -5.0, 1026.924, 3860.166, 7.047784e-03, 0.444966, -9.785),
        (Glycol::Propylene, 0.3, 20.0, 1023.785, 3857.004, 2.964976e-03, 0.444429, -12.789),
        (Glycol::Propylene, 0.4, 60.0, 1006.314, 3833.866, 1.282680e-03, 0.426510, -20.568),
        (Glycol::Propylene, 0.55, 0.0, 1053.976, 3352.209, 2.373322e-02, 0.331938, -40.158),
    ];

    /// `bell2014`, fitted to the tables of ASHRAE.
    const ASHRAE: [Case; 6] = [
        (Glycol::Ethylene, 0.2, 20.0, 1029.716, 3814.744, 1.666121e-03, 0.496861, -8.976),
        (Glycol::Ethylene, 0.3, 20.0, 1045.250, 3645.399, 2.156435e-03, 0.453506, -15.700),
        (Glycol::Ethylene, 0.5, 40.0, 1063.664, 3357.814, 2.213124e-03, 0.393786, -37.115),
        (Glycol::Propylene, 0.3, 20.0, 1028.349, 3847.895, 3.069419e-03, 0.444777, -13.105),
        (Glycol::Propylene, 0.4, 60.0, 1012.304, 3833.801, 1.323437e-03, 0.424594, -21.509),
        (Glycol::Propylene, 0.5, 10.0, 1048.043, 3493.340, 1.072602e-02, 0.356143, -33.661),
    ];

    fn compare(case: &Case, shares: [f64; 5]) {
        let &(glycol, share, t_degc, density, capacity, viscosity, conductivity, freezing) = case;
        let t_k = t_degc + 273.15;
        let found = [
            glycol.density_kg_m3(share, t_k) / density,
            glycol.heat_capacity_j_kg_k(share, t_k) / capacity,
            glycol.viscosity_pa_s(share, t_k) / viscosity,
            glycol.conductivity_w_m_k(share, t_k) / conductivity,
            glycol.freezing_k(share) / (freezing + 273.15),
        ];
        for (i, (found, limit)) in found.iter().zip(shares).enumerate() {
            assert!((found - 1.0).abs() < limit, "{case:?}, property {i}: {found}");
        }
    }

    #[test]
    fn as_another_implementation_of_the_same_coefficients() {
        MELINDER.iter().for_each(|case| compare(case, [1e-5; 5]));
    }

    #[test]
    fn near_the_tables_of_ashrae() {
        ASHRAE.iter().for_each(|case| compare(case, [0.01, 0.025, 0.08, 0.03, 0.01]));
    }
}
