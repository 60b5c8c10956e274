//! `[weather]`: what the global signals `weather.*` are.

use crate::weather::Synthetic;
use anergy_core::solar::Location;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `[weather]`: outdoor temperature, humidity, wind, irradiance and sun.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WeatherEntry {
    /// Where it comes from.
    #[serde(default)]
    pub kind: WeatherKind,
    /// EPW (`.epw`) or CSV file, relative to the model file; file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Latitude, north positive, rad. An EPW file has its own; synthetic: Munich.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub latitude_rad: Option<f64>,
    /// Longitude, east positive, rad. An EPW file has its own; synthetic: Munich.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longitude_rad: Option<f64>,
    /// What the local standard time is ahead of UTC, s: of times in a CSV file without time zone, of the days of a
    /// synthetic year (1 h). An EPW file has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub utc_offset_s: Option<f64>,
    /// Of which time the irradiance of a row is the mean; CSV.
    #[serde(default)]
    pub means: Means,
    /// The column with the time: RFC 3339, or s since the start of the run. Absent: the first; CSV.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_column: Option<String>,
    /// Field separator; CSV.
    #[serde(default = "comma")]
    pub separator: char,
    /// Start of the random numbers: another seed is another year; synthetic.
    #[serde(default)]
    pub seed: u64,
    /// Mean temperature of the year, K; synthetic.
    #[serde(default = "mean")]
    pub mean_k: f64,
    /// Amplitude of the temperature over the year, K; synthetic.
    #[serde(default = "amplitude")]
    pub amplitude_k: f64,
    /// The coldest day of the mean year, 0 is New Year; synthetic.
    #[serde(default = "coldest")]
    pub coldest_day: f64,
    /// Amplitude over a day in winter, K; synthetic.
    #[serde(default = "winter_day")]
    pub winter_day_amplitude_k: f64,
    /// Amplitude over a day in summer, K; synthetic.
    #[serde(default = "summer_day")]
    pub summer_day_amplitude_k: f64,
    /// Standard deviation of the weather around year and day, K; synthetic.
    #[serde(default = "noise")]
    pub noise_difference_k: f64,
    /// How long the weather remembers, s; synthetic.
    #[serde(default = "two_days")]
    pub noise_time_constant_s: f64,
    /// First parameter of the Beta distribution of the clearness of days; synthetic.
    #[serde(default = "clearness_alpha")]
    pub clearness_alpha: f64,
    /// Second parameter of the Beta distribution of the clearness of days; synthetic.
    #[serde(default = "clearness_beta")]
    pub clearness_beta: f64,
    /// Outdoor temperature, K; constant.
    #[serde(default = "ten_degc")]
    pub t_outdoor_k: f64,
    /// Relative humidity, 0 to 1; constant.
    #[serde(default = "humidity")]
    pub relative_humidity: f64,
    /// Wind, m/s; constant, synthetic.
    #[serde(default = "wind")]
    pub wind_m_s: f64,
    /// Global irradiance on the horizontal, W/m2; constant.
    #[serde(default)]
    pub global_horizontal_w_m2: f64,
    /// Diffuse irradiance on the horizontal, W/m2; constant.
    #[serde(default)]
    pub diffuse_horizontal_w_m2: f64,
    /// Irradiance of the sun on a plane that faces it, W/m2; constant.
    #[serde(default)]
    pub beam_normal_w_m2: f64,
    /// Elevation of the sun, rad; constant.
    #[serde(default)]
    pub sun_elevation_rad: f64,
    /// Azimuth of the sun from south, west positive, rad; constant.
    #[serde(default)]
    pub sun_azimuth_rad: f64,
}

/// Where the weather comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WeatherKind {
    /// An EPW or CSV file.
    #[default]
    File,
    /// A made-up year, reproducible from its seed.
    Synthetic,
    /// The values given here, where no schedule or series drives the signals.
    Constant,
}

/// Of which time the irradiance of a row is the mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Means {
    /// The interval that ends at its time.
    #[default]
    Before,
    /// The interval that begins at its time.
    After,
}

/// What a field belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    Csv,
    NotEpw,
    File,
    Synthetic,
    Constant,
    ConstantOrSynthetic,
}

impl WeatherEntry {
    /// The fields that mean something for some kinds only.
    pub(crate) const OF_KIND: &'static [(&'static str, Of)] = &[
        ("file", Of::File),
        ("latitude_rad", Of::NotEpw),
        ("longitude_rad", Of::NotEpw),
        ("utc_offset_s", Of::NotEpw),
        ("means", Of::Csv),
        ("time_column", Of::Csv),
        ("separator", Of::Csv),
        ("seed", Of::Synthetic),
        ("mean_k", Of::Synthetic),
        ("amplitude_k", Of::Synthetic),
        ("coldest_day", Of::Synthetic),
        ("winter_day_amplitude_k", Of::Synthetic),
        ("summer_day_amplitude_k", Of::Synthetic),
        ("noise_difference_k", Of::Synthetic),
        ("noise_time_constant_s", Of::Synthetic),
        ("clearness_alpha", Of::Synthetic),
        ("clearness_beta", Of::Synthetic),
        ("t_outdoor_k", Of::Constant),
        ("relative_humidity", Of::Constant),
        ("wind_m_s", Of::ConstantOrSynthetic),
        ("global_horizontal_w_m2", Of::Constant),
        ("diffuse_horizontal_w_m2", Of::Constant),
        ("beam_normal_w_m2", Of::Constant),
        ("sun_elevation_rad", Of::Constant),
        ("sun_azimuth_rad", Of::Constant),
    ];

    /// Whether the file is one of EnergyPlus.
    pub(crate) fn is_epw(&self) -> bool {
        let name = self.file.as_deref().unwrap_or_default();
        name.to_ascii_lowercase().ends_with(".epw")
    }

    /// Whether a field means something for its kind.
    pub(crate) fn has(&self, field: &str) -> bool {
        let (kind, epw) = (self.kind, self.is_epw());
        Self::OF_KIND.iter().filter(|(of_kind, _)| *of_kind == field).all(|(_, of)| match of {
            Of::File => kind == WeatherKind::File,
            Of::Csv => kind == WeatherKind::File && !epw,
            Of::NotEpw => kind == WeatherKind::Synthetic || (kind == WeatherKind::File && !epw),
            Of::Synthetic => kind == WeatherKind::Synthetic,
            Of::Constant => kind == WeatherKind::Constant,
            Of::ConstantOrSynthetic => kind != WeatherKind::File,
        })
    }

    /// Constant values in the order of the signals.
    pub(crate) fn constants(&self) -> [f64; 8] {
        [
            self.t_outdoor_k,
            self.relative_humidity,
            self.wind_m_s,
            self.global_horizontal_w_m2,
            self.diffuse_horizontal_w_m2,
            self.beam_normal_w_m2,
            self.sun_elevation_rad,
            self.sun_azimuth_rad,
        ]
    }

    /// The place, where it is given.
    pub(crate) fn location(&self) -> Option<Location> {
        let (latitude_rad, longitude_rad) = (self.latitude_rad?, self.longitude_rad?);
        Some(Location { latitude_rad, longitude_rad })
    }

    /// The made-up year.
    pub(crate) fn synthetic(&self) -> Synthetic {
        let munich = Location {
            latitude_rad: MUNICH_DEG[0].to_radians(),
            longitude_rad: MUNICH_DEG[1].to_radians(),
        };
        Synthetic {
            seed: self.seed,
            mean_k: self.mean_k,
            amplitude_k: self.amplitude_k,
            coldest_day: self.coldest_day,
            winter_day_amplitude_k: self.winter_day_amplitude_k,
            summer_day_amplitude_k: self.summer_day_amplitude_k,
            noise_difference_k: self.noise_difference_k,
            noise_time_constant_s: self.noise_time_constant_s,
            clearness_alpha: self.clearness_alpha,
            clearness_beta: self.clearness_beta,
            wind_m_s: self.wind_m_s,
            location: self.location().unwrap_or(munich),
            ahead_ns: (self.utc_offset_s.unwrap_or(3600.0) * 1e9).round() as i64,
        }
    }

    /// The problems of its numbers: field, and what is wrong.
    pub(crate) fn problems(&self) -> Vec<(&'static str, String)> {
        let mut problems = Vec::new();
        let half = std::f64::consts::FRAC_PI_2;
        let within = |value: f64, least: f64, most: f64| (least..=most).contains(&value);
        for (field, value, most) in [
            ("latitude_rad", self.latitude_rad.unwrap_or(0.0), half),
            ("longitude_rad", self.longitude_rad.unwrap_or(0.0), 2.0 * half),
            ("sun_elevation_rad", self.sun_elevation_rad, half),
            ("sun_azimuth_rad", self.sun_azimuth_rad, 2.0 * half),
        ] {
            if !within(value, -most, most) {
                problems.push((field, format!("{field} = {value} is no angle of this kind")));
            }
        }
        let offset_s = self.utc_offset_s.unwrap_or(0.0);
        if !within(offset_s, -50_400.0, 50_400.0) {
            let message = format!("utc_offset_s = {offset_s} is no time zone");
            problems.push(("utc_offset_s", message));
        }
        for (field, value) in [
            ("noise_time_constant_s", self.noise_time_constant_s),
            ("clearness_alpha", self.clearness_alpha),
            ("clearness_beta", self.clearness_beta),
        ] {
            if value <= 0.0 {
                problems.push((field, format!("{field} = {value} must be positive")));
            }
        }
        for (field, value) in [
            ("amplitude_k", self.amplitude_k),
            ("winter_day_amplitude_k", self.winter_day_amplitude_k),
            ("summer_day_amplitude_k", self.summer_day_amplitude_k),
            ("noise_difference_k", self.noise_difference_k),
            ("wind_m_s", self.wind_m_s),
            ("global_horizontal_w_m2", self.global_horizontal_w_m2),
            ("diffuse_horizontal_w_m2", self.diffuse_horizontal_w_m2),
            ("beam_normal_w_m2", self.beam_normal_w_m2),
        ] {
            if value < 0.0 {
                problems.push((field, format!("{field} = {value} must not be negative")));
            }
        }
        let humidity = self.relative_humidity;
        if !within(humidity, 0.0, 1.0) {
            let message = format!("relative_humidity = {humidity} must lie between 0 and 1");
            problems.push(("relative_humidity", message));
        }
        if !within(self.coldest_day, 0.0, 366.0) {
            let message = format!("coldest_day = {} is no day of the year", self.coldest_day);
            problems.push(("coldest_day", message));
        }
        problems
    }
}

/// Latitude and longitude of Munich.
const MUNICH_DEG: [f64; 2] = [48.14, 11.58];

fn comma() -> char {
    ','
}

fn mean() -> f64 {
    282.65
}

fn amplitude() -> f64 {
    10.0
}

fn coldest() -> f64 {
    20.0
}

fn winter_day() -> f64 {
    4.0
}

fn summer_day() -> f64 {
    7.0
}

fn noise() -> f64 {
    3.5
}

fn two_days() -> f64 {
    172_800.0
}

fn clearness_alpha() -> f64 {
    1.5
}

fn clearness_beta() -> f64 {
    1.0
}

fn ten_degc() -> f64 {
    283.15
}

fn humidity() -> f64 {
    0.75
}

fn wind() -> f64 {
    2.5
}
