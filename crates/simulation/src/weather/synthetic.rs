//! A made-up year that looks like the weather of a place: reproducible from its seed.
//!
//! **Equation** temperature at hour t of the year, with t_d the hour of the day in mean solar time:
//! ```text
//! T = mean - A_year cos(2 pi (t - t_coldest)/year) + A_day(t) cos(2 pi (t_d - 15 h)/24 h) + x(t)
//! A_day = winter at the coldest day, summer half a year later, a cosine between
//! x(t + 1 h) = r x(t) + sigma sqrt(1 - r^2) n,   r = exp(-1 h/tau),  n standard normal
//! ```
//! irradiance: that of a clear sky (Haurwitz) times a clearness of the day, which is Beta-distributed; diffuse by Erbs.
//! Humidity: air whose dew point stays 4 K below the temperature without the swing of the day, saturated at most
//! (Magnus). Wind is constant.
//!
//! **Assumptions** of the spec: mean 9.5 degC, 10 K, 4 and 7 K, sigma 3.5 K, tau 2 d; assumed: the clearness Beta(1.5, 1),
//! mean 0.6 (some 1100 kWh/m2 a year in Munich), days that do not remember the clearness of the day before nor warm up
//! with it, the dew point. **Validity** studies that need plausible weather, not that of a place or year.
//!
//! **Numerics** the noise is run through the year once before, so that it ends where it begins: the year repeats
//! without a jump. **Sources** `haurwitz1945`, `erbs1982`, `magnus`.

use super::Calendar;
use super::calendar::{DAY_NS, DAYS};
use super::irradiance::{Given, complete};
use super::records::{PointAt, Records};
use anergy_core::medium::ZERO_CELSIUS_K;
use anergy_core::solar::{Location, clear_sky_w_m2};
use rand_distr::{Beta, Distribution, StandardNormal};
use rand_pcg::Pcg32;
use std::f64::consts::TAU;

/// What the year looks like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Synthetic {
    pub seed: u64,
    pub mean_k: f64,
    pub amplitude_k: f64,
    /// The coldest day of the mean year, from 0.
    pub coldest_day: f64,
    pub winter_day_amplitude_k: f64,
    pub summer_day_amplitude_k: f64,
    /// Standard deviation of the noise.
    pub noise_difference_k: f64,
    pub noise_time_constant_s: f64,
    /// Of the Beta distribution of the clearness.
    pub clearness_alpha: f64,
    pub clearness_beta: f64,
    pub wind_m_s: f64,
    pub location: Location,
    /// What local standard time is ahead of UTC, ns.
    pub ahead_ns: i64,
}

const HOURS: usize = 24;
/// Dew point below the temperature of the day, K.
const DEW_POINT_BELOW_K: f64 = 4.0;
/// The warmest hour of the day.
const WARMEST_HOUR: f64 = 15.0;
/// A leap year, by which the course of the sun is made: 2024-01-01, ns since 1970.
const LEAP_YEAR_NS: i64 = 1_704_067_200_000_000_000;
const STREAM: u64 = 0x0a02_bdbf_7bb3_c0a7;

impl Synthetic {
    /// The year.
    ///
    /// # Errors
    /// When the numbers make no Beta distribution.
    pub(crate) fn records(&self) -> Result<Records, &'static str> {
        let mut random = Pcg32::new(self.seed, STREAM);
        let count = DAYS * HOURS;
        let clearness = Beta::new(self.clearness_alpha, self.clearness_beta)
            .map_err(|_| "clearness_alpha and clearness_beta must be positive")?;
        let clearness: Vec<f64> = clearness.sample_iter(&mut random).take(DAYS).collect();
        let noise = self.noise(&mut random, count);
        let (mut t_outdoor_k, mut humidity) = (Vec::with_capacity(count), Vec::new());
        for (hour, noise) in noise.iter().enumerate() {
            // The point of a record is the end of its interval.
            let day = (hour + 1) as f64 / HOURS as f64;
            let season = (TAU * (day - self.coldest_day) / DAYS as f64).cos();
            let (winter, summer) = (self.winter_day_amplitude_k, self.summer_day_amplitude_k);
            let swing = 0.5 * (winter + summer) + 0.5 * (winter - summer) * season;
            let without_day = self.mean_k - self.amplitude_k * season + noise;
            let hour = day.fract() * HOURS as f64 - WARMEST_HOUR;
            let t_k = without_day + swing * (TAU * hour / HOURS as f64).cos();
            t_outdoor_k.push(t_k);
            let vapour = saturation_pa(without_day - DEW_POINT_BELOW_K);
            humidity.push((vapour / saturation_pa(t_k)).min(1.0));
        }
        let slots: Vec<usize> = (0..count).collect();
        let mut records = Records {
            interval_ns: DAY_NS / HOURS as i64,
            calendar: Calendar::every_year(self.ahead_ns, &slots, HOURS),
            point_at: PointAt::End,
            location: Some(self.location),
            t_outdoor_k: t_outdoor_k.into(),
            relative_humidity: Some(humidity.into()),
            wind_m_s: Some(vec![self.wind_m_s; count].into()),
            irradiance: None,
        };
        let begins = move |ahead_ns: i64, interval_ns: i64| {
            (0..count).map(move |hour| LEAP_YEAR_NS - ahead_ns + hour as i64 * interval_ns)
        };
        let begins = || begins(self.ahead_ns, records.interval_ns);
        let global = begins().zip(0..).map(|(begin_ns, hour): (i64, usize)| {
            let path = self.location.path(begin_ns as f64 / 1e9 + 1800.0);
            // Means of the hour, over its twelfths: the clear sky is not as the sine.
            let twelfths = (0..12).map(|twelfth| {
                let sun = path.position(300.0 * f64::from(twelfth) - 1650.0);
                clear_sky_w_m2(sun.elevation_rad.sin())
            });
            clearness[hour / HOURS] * twelfths.sum::<f64>() / 12.0
        });
        let given = Given { global_w_m2: Some(global.collect()), ..Given::default() };
        records.irradiance = Some(complete(&records, begins(), given)?);
        Ok(records)
    }

    /// Noise of first order that ends where it begins.
    fn noise(&self, random: &mut Pcg32, count: usize) -> Vec<f64> {
        let keeps = (-3600.0 / self.noise_time_constant_s).exp();
        let fresh = self.noise_difference_k * (1.0 - keeps * keeps).sqrt();
        let drawn: Vec<f64> = StandardNormal.sample_iter(random).take(count).collect();
        let step = |noise: f64, drawn: &f64| keeps * noise + fresh * drawn;
        let mut noise = drawn.iter().fold(0.0, step);
        drawn
            .iter()
            .map(|drawn| {
                noise = step(noise, drawn);
                noise
            })
            .collect()
    }
}

/// Pressure of saturated vapour over water (Magnus), Pa.
fn saturation_pa(t_k: f64) -> f64 {
    let degc = t_k - ZERO_CELSIUS_K;
    611.2 * (17.62 * degc / (243.12 + degc)).exp()
}

#[cfg(test)]
mod tests;
