//! How much of its power a heat pump gives, by the temperature of a layer of the storage it charges.
//!
//! **Equation** `mf = clamp(1 - (T - T_start)/(T_stop - T_start), 0, 1)`: full power at the start temperature, none
//! at the stop temperature, whichever of the two is higher (heating: start below stop; cooling: above). The unit
//! starts when `mf` reaches [`STARTS_AT`] and stops when it is zero; what it cannot do below its smallest modulation is
//! its own matter. On-off control starts at `mf = 1` and stops at `mf = 0`. **Sources** `angelidis2023`.

/// Modulation factor at which a unit that is off starts.
pub const STARTS_AT: f64 = 0.3;

/// A band of temperatures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Full power here and beyond, K.
    pub start_k: f64,
    /// No power here and beyond, K.
    pub stop_k: f64,
}

impl Band {
    /// The modulation factor.
    pub fn factor(&self, t_k: f64) -> f64 {
        (1.0 - (t_k - self.start_k) / (self.stop_k - self.start_k)).clamp(0.0, 1.0)
    }

    /// Modulation, given whether the unit was running.
    pub fn modulation(&self, t_k: f64, running: bool, modulating: bool) -> f64 {
        let factor = self.factor(t_k);
        match (modulating, running) {
            (true, true) => factor,
            (true, false) => {
                if factor >= STARTS_AT {
                    factor
                } else {
                    0.0
                }
            }
            (false, true) => f64::from(factor > 0.0),
            (false, false) => f64::from(factor >= 1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factor_between_start_and_stop() {
        // T_start 52, T_stop 58 degC: at 53.5 degC 1 - 1.5/6 = 0.75
        let heating = Band { start_k: 325.15, stop_k: 331.15 };
        assert!((heating.factor(326.65) - 0.75).abs() < 1e-12);
        assert_eq!((heating.factor(320.0), heating.factor(335.0)), (1.0, 0.0));
        // Cooling, published without "1 -": (T - T_min)/(T_max - T_min) between 15 and 18 degC, at 16 degC 1/3
        let cooling = Band { start_k: 291.15, stop_k: 288.15 };
        assert!((cooling.factor(289.15) - 1.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn starts_late_and_stops_at_the_end() {
        let band = Band { start_k: 325.15, stop_k: 331.15 };
        // 56.5 degC: 0.25 keeps running, does not start
        assert!((band.modulation(329.65, true, true) - 0.25).abs() < 1e-12);
        assert_eq!(band.modulation(329.65, false, true), 0.0);
        assert_eq!(
            (band.modulation(329.65, true, false), band.modulation(329.65, false, false)),
            (1.0, 0.0)
        );
        assert_eq!(
            (band.modulation(332.0, true, true), band.modulation(324.0, false, false)),
            (0.0, 1.0)
        );
    }
}
