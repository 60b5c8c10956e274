//! What people want of a room: set points, the thermostats that open the water, the season, and how much of it
//! they did not get.
//!
//! **Equation**
//! ```text
//! T_set = T_min + (T_ref - T_min) presence,  at night not above T_night
//! opening = clamp(e/band + I, 0, 1),  e = T_set - T (heating), T - T_set (cooling)
//! I = 1/2, or with a reset time dI/dt = e/(band T_reset), 0 <= I <= 1
//! season: running mean of the outdoor temperature, dM/dt = (T_out - M)/24 h, below the heating limit
//! dc_heat = int max(T_comfort - T, 0) dt, T_comfort = 20 degC from 6 to 23 h, 17 degC else
//! dc_cool = int max(T - 24 degC, 0) dt
//! ```
//! **Assumptions** a thermostat moves at once; without a reset time it stands half open at its set point. Cooling
//! opens only while heating is shut. **Validity** steps in which the room changes less than the band.
//! **Numerics** the running mean is exact for a constant outdoor temperature; the discomfort counts the mean of a
//! step. **Sources** set points and limits as the houses of `prohmo`, `en15251` for the running mean.

/// A day, s.
pub const DAY_S: f64 = 86_400.0;
/// Time constant of the running mean of the outdoor temperature, s.
const SEASON_S: f64 = DAY_S;
/// Comfort for the indicators: heating by day and by night, cooling, K; the day, s.
const DAY_COMFORT_K: f64 = 293.15;
const NIGHT_COMFORT_K: f64 = 290.15;
const COOL_COMFORT_K: f64 = 297.15;
const COMFORT_DAY_S: (f64, f64) = (21_600.0, 82_800.0);

/// Rules of a room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Comfort {
    /// Set point that holds at night at most, K.
    pub night_k: Option<f64>,
    /// When the night begins and ends, s after midnight: on workdays, on days off.
    pub nights_s: [(f64, f64); 2],
    /// Set point while nobody is there, K.
    pub absent_k: Option<f64>,
    /// Between shut and open, K.
    pub band_k: f64,
    /// Reset time, s; 0: proportional only.
    pub reset_s: f64,
    /// Heating season below this running mean of the outdoor temperature, K.
    pub heating_limit_k: f64,
}

/// Whether a time of day is within a span that may go over midnight.
pub fn within_day(time_s: f64, (from_s, until_s): (f64, f64)) -> bool {
    if from_s <= until_s {
        (from_s..until_s).contains(&time_s)
    } else {
        time_s >= from_s || time_s < until_s
    }
}

impl Comfort {
    /// Set point of heating, K, from the reference, the presence (0 to 1), the time of day and whether it is a day off.
    pub fn set_k(&self, reference_k: f64, presence: f64, time_s: f64, off: bool) -> f64 {
        let night_s = self.nights_s[usize::from(off)];
        let by_presence = self.absent_k.map_or(reference_k, |absent_k| {
            absent_k + (reference_k - absent_k) * presence.clamp(0.0, 1.0)
        });
        match self.night_k {
            Some(night_k) if within_day(time_s, night_s) => by_presence.min(night_k),
            _ => by_presence,
        }
    }

    /// Opening of a thermostat, 0 to 1, at an error in the direction of its action, K.
    pub fn opening(&self, error_k: f64, integral: f64) -> f64 {
        (error_k / self.band_k + integral).clamp(0.0, 1.0)
    }

    /// The integral part after a step.
    pub fn integral(&self, dt_s: f64, error_k: f64, integral: f64) -> f64 {
        if self.reset_s > 0.0 {
            (integral + dt_s * error_k / (self.band_k * self.reset_s)).clamp(0.0, 1.0)
        } else {
            integral
        }
    }

    /// Whether it is the heating season.
    pub fn heats(&self, mean_outdoor_k: f64) -> bool {
        mean_outdoor_k < self.heating_limit_k
    }
}

/// Running mean of the outdoor temperature after a step.
pub fn running_mean_k(dt_s: f64, outdoor_k: f64, mean_k: f64) -> f64 {
    outdoor_k + (mean_k - outdoor_k) * (-dt_s / SEASON_S).exp()
}

/// Discomfort at a room temperature and a time of day, K: of heating and of cooling.
pub fn discomfort_k(t_room_k: f64, time_s: f64) -> (f64, f64) {
    let by_day = within_day(time_s, COMFORT_DAY_S);
    let wanted_k = if by_day { DAY_COMFORT_K } else { NIGHT_COMFORT_K };
    ((wanted_k - t_room_k).max(0.0), (t_room_k - COOL_COMFORT_K).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMFORT: Comfort = Comfort {
        night_k: Some(291.15),
        nights_s: [(82_800.0, 21_600.0), (1800.0, 28_800.0)],
        absent_k: Some(292.15),
        band_k: 1.0,
        reset_s: 0.0,
        heating_limit_k: 287.15,
    };

    #[test]
    fn set_points() {
        // 19 + (21 - 19)/2 = 20 degC half present by day; 18 at night; a reference of 17 stays.
        for (reference_k, presence, hour, wanted_k) in [
            (294.15, 0.5, 12.0, 293.15),
            (294.15, 1.0, 22.99, 294.15),
            (294.15, 1.0, 23.0, 291.15),
            (294.15, 1.0, 5.99, 291.15),
            (294.15, 1.0, 6.0, 294.15),
            (290.15, 1.0, 3.0, 290.15),
            (294.15, 7.0, 12.0, 294.15),
        ] {
            let set_k = COMFORT.set_k(reference_k, presence, hour * 3600.0, false);
            assert!((set_k - wanted_k).abs() < 1e-12, "{hour}: {set_k}");
        }
    }

    #[test]
    fn thermostats() {
        assert_eq!(COMFORT.opening(0.0, 0.5), 0.5);
        assert_eq!(COMFORT.opening(0.5, 0.5), 1.0);
        assert_eq!(COMFORT.opening(-0.7, 0.5), 0.0);
        assert_eq!(COMFORT.integral(600.0, 0.3, 0.5), 0.5);
        // 0.3 K over 600 s with a band of 1 K and 1800 s: + 0.1.
        let pi = Comfort { reset_s: 1800.0, ..COMFORT };
        assert!((pi.integral(600.0, 0.3, 0.5) - 0.6).abs() < 1e-12);
        assert_eq!(pi.integral(1e6, 0.3, 0.5), 1.0);
    }

    #[test]
    fn season_and_discomfort() {
        // A day of 4 degC after 14: 4 + 10/e = 7.679 degC, in one step or in many.
        let day = running_mean_k(DAY_S, 277.15, 287.15);
        assert!((day - 277.15 - 10.0 * (-1.0_f64).exp()).abs() < 1e-12);
        let hours = (0..24).fold(287.15, |mean, _| running_mean_k(3600.0, 277.15, mean));
        assert!((day - hours).abs() < 1e-9);
        assert!(COMFORT.heats(287.0) && !COMFORT.heats(287.15));
        let (heat, cool) = discomfort_k(292.15, 12.0 * 3600.0);
        assert!((heat - 1.0).abs() < 1e-12 && cool == 0.0);
        assert_eq!(discomfort_k(292.15, 2.0 * 3600.0), (0.0, 0.0));
        assert!((discomfort_k(298.15, 0.0).1 - 1.0).abs() < 1e-12);
    }
}
