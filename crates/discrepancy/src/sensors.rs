//! The sensor file: which column of the data is which signal of the model, and how good the sensor is.
//!
//! **Accuracy** a class states two things: a constant bias, the same for all samples of a sensor, of which only
//! the size is known beforehand, and noise that is new in every sample. A largest permissible error `e` is taken
//! as a rectangular distribution, `e/sqrt(3)`. To white noise that a data sheet states, 1/f noise of half its size is
//! added, and `lsb/sqrt(12)` of the resolution.
//!
//! **Sources** EN 60751 (Pt100 classes), EN 1434 (heat meters).

use crate::error::ExplainError;
use crate::unknown::Target;
use anergy_core::units::Unit;
use serde::{Deserialize, Serialize};

/// 1/f noise, which data sheets leave out, over the white noise that they state.
const ONE_OVER_F: f64 = 0.5;

/// What a column is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// It is compared with the simulation.
    Compare,
    /// It drives a signal of the model.
    Input,
}

/// Accuracy class of a sensor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Class {
    /// Platinum resistance, class A: 0.15 K + 0.2 % of the temperature in degC.
    Pt100A,
    /// Platinum resistance, class B: 0.3 K + 0.5 % of the temperature in degC.
    Pt100B,
    /// Paired temperature sensors of a heat meter: 0.1 K.
    HeatMeterPair,
    /// Magnetic-inductive flow meter: 0.5 %, and 1 mm/s of zero offset (taken as 0.2 % of the largest flow).
    Mid,
    /// Flow sensor of a heat meter, class 2: 2 %.
    #[serde(rename = "flow_class_2", alias = "flow_class2")]
    FlowClass2,
    /// Contact sensor on a wall: 1 K.
    Surface,
    /// Electric power meter: 0.2 %.
    #[serde(rename = "electric_0_2")]
    Electric02,
    /// Differential pressure: 0.25 % of the largest value.
    #[serde(rename = "dp_0_25")]
    Dp025,
    /// Nothing is known: 1 K, 5 %, 2 kPa.
    #[default]
    Unknown,
}

/// A `[[sensor]]` of the sensor file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Column of the data.
    pub column: String,
    /// Channel of the model to compare with, or signal to drive.
    pub signal: String,
    /// Unit of the column, such as `degC` or `l_h`.
    pub unit: String,
    /// What it is for.
    pub role: Role,
    /// Accuracy class.
    #[serde(default)]
    pub class: Class,
    /// Time constant, s.
    #[serde(default)]
    pub lag_s: f64,
    /// Resolution, in the unit of the column.
    #[serde(default)]
    pub quantisation: f64,
    /// Sensors of one clock share its offset.
    #[serde(default)]
    pub clock: String,
}

/// An `[[effect]]` of the sensor file: what is wrong with a sensor.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SensorEffect {
    /// Word of the catalogue.
    pub id: String,
    /// Its column.
    pub component: String,
    /// Offset of a temperature, K.
    pub bias_k: Option<f64>,
    /// Offset of a mass flow, kg/s.
    pub offset_kg_s: Option<f64>,
    /// Offset of a volume flow, m3/s.
    pub offset_m3_s: Option<f64>,
    /// Gain.
    pub gain: Option<f64>,
    /// Time constant beyond the known one, s.
    pub lag_s: Option<f64>,
    /// Its clock is late by this, s.
    pub clock_s: Option<f64>,
    /// Drift from the beginning of a run to its end, K.
    pub drift_k: Option<f64>,
    /// Jump within a run, K.
    pub step_k: Option<f64>,
    /// Share of a run that is over when it jumps.
    pub step_share: Option<f64>,
    /// Where it comes from; changes nothing.
    pub because: String,
    /// Interval of its value; changes nothing.
    pub ci95: Vec<f64>,
}

impl SensorEffect {
    /// What it does to the sensor at a place.
    pub fn flaws(&self, sensor: usize) -> impl Iterator<Item = (Target, f64)> {
        let offset = self.bias_k.or(self.offset_kg_s).or(self.offset_m3_s);
        let all = [
            (Target::Bias(sensor), offset),
            (Target::Gain(sensor), self.gain),
            (Target::Lag(sensor), self.lag_s),
            (Target::Clock(sensor), self.clock_s),
            (Target::Drift(sensor), self.drift_k),
            (Target::Step(sensor), self.step_k),
            (Target::StepShare(sensor), self.step_share),
        ];
        all.into_iter().filter_map(|(flaw, value)| Some((flaw, value?)))
    }
}

/// The whole sensor file.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SensorFile {
    /// Its sensors.
    #[serde(default)]
    pub sensor: Vec<Sensor>,
    /// What is wrong with them.
    #[serde(default)]
    pub effect: Vec<SensorEffect>,
}

impl SensorFile {
    /// Reads the file.
    ///
    /// # Errors
    /// What is wrong, with line and column.
    pub fn from_toml(text: &str) -> Result<Self, ExplainError> {
        let file: Self = toml::from_str(text)
            .map_err(|error| ExplainError::Sensors { problem: error.to_string() })?;
        for (i, sensor) in file.sensor.iter().enumerate() {
            let wrong = |problem: String| {
                Err(ExplainError::Sensors {
                    problem: format!("sensor \"{}\": {problem}", sensor.column),
                })
            };
            if !(sensor.lag_s >= 0.0 && sensor.lag_s.is_finite()) {
                return wrong(format!("lag_s = {} must not be negative", sensor.lag_s));
            }
            if !(sensor.quantisation >= 0.0 && sensor.quantisation.is_finite()) {
                return wrong(format!(
                    "quantisation = {} must not be negative",
                    sensor.quantisation
                ));
            }
            if file.sensor[..i]
                .iter()
                .any(|other| other.column == sensor.column && other.role == sensor.role)
            {
                return wrong("it is there twice".into());
            }
        }
        for effect in &file.effect {
            let column = &effect.component;
            let wrong = |problem: &str| {
                let problem = format!("effect {} of \"{column}\": {problem}", effect.id);
                Err(ExplainError::Sensors { problem })
            };
            if !file.sensor.iter().any(|sensor| sensor.column == *column) {
                return wrong("there is no such sensor");
            }
            if effect.flaws(0).any(|(_, value)| !value.is_finite())
                || effect.gain.is_some_and(|gain| gain == 0.0)
                || effect.lag_s.is_some_and(|lag_s| lag_s < 0.0)
            {
                return wrong("a value that no sensor has");
            }
        }
        let compared = file.sensor.iter().filter(|sensor| sensor.role == Role::Compare).count();
        if compared == 0 {
            let problem = "no sensor has role = \"compare\": nothing can be compared".to_owned();
            return Err(ExplainError::Sensors { problem });
        }
        Ok(file)
    }
}

/// Standard deviations of a sensor in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Accuracy {
    /// Of its constant offset.
    pub bias: f64,
    /// Of its constant gain.
    pub gain: f64,
    /// Of the noise of a sample.
    pub noise: f64,
}

impl Sensor {
    /// Suffix of the unit as in names of the model.
    pub fn unit_suffix(&self) -> String {
        self.unit.to_lowercase().replace('/', "_")
    }

    /// SI suffix of the unit; `1` of shares.
    pub fn si(&self) -> String {
        let suffix = self.unit_suffix();
        let si = Unit::find(&suffix).map_or(suffix, |unit| unit.si.to_owned());
        if si.is_empty() { "1".to_owned() } else { si }
    }

    /// A reading in SI.
    pub fn to_si(&self, value: f64) -> f64 {
        Unit::find(&self.unit_suffix()).map_or(value, |unit| unit.to_si(value))
    }

    /// A value in SI as a reading.
    pub fn of_si(&self, value: f64) -> f64 {
        Unit::find(&self.unit_suffix()).map_or(value, |unit| unit.of_si(value))
    }

    /// A difference in SI as one of readings.
    pub fn difference_of_si(&self, difference: f64) -> f64 {
        self.of_si(difference) - self.of_si(0.0)
    }

    /// A difference of readings in SI.
    pub fn difference_to_si(&self, difference: f64) -> f64 {
        self.to_si(difference) - self.to_si(0.0)
    }

    /// Accuracy for readings of a middle and a largest size, SI.
    pub fn accuracy(&self, middle: f64, largest: f64) -> Accuracy {
        let root3 = 3.0_f64.sqrt();
        let degc = (middle - 273.15).abs();
        let (bias, gain, noise) = match (self.class, self.si().as_str()) {
            (Class::Pt100A, _) => ((0.15 + 0.002 * degc) / root3, 0.0, 0.02),
            (Class::Pt100B, _) => ((0.3 + 0.005 * degc) / root3, 0.0, 0.02),
            (Class::HeatMeterPair, _) => (0.1 / root3, 0.0, 0.02),
            (Class::Surface, _) => (1.0 / root3, 0.0, 0.1),
            (Class::Mid, _) => (0.002 * largest / root3, 0.005 / root3, 0.002 * middle),
            (Class::FlowClass2, _) => (0.0, 0.02 / root3, 0.005 * middle),
            (Class::Electric02, _) => (0.0, 0.002 / root3, 0.001 * middle),
            (Class::Dp025, _) => (0.0025 * largest / root3, 0.0, 0.0005 * largest),
            (Class::Unknown, "k") => (1.0, 0.0, 0.1),
            (Class::Unknown, "pa") => (2e3, 0.0, 200.0),
            (Class::Unknown, _) => (0.0, 0.05, 0.01 * middle),
        };
        let lsb = self.difference_to_si(self.quantisation);
        let noise =
            (noise * noise * (1.0 + ONE_OVER_F.powi(2)) + lsb * lsb / 12.0).sqrt().max(1e-12);
        Accuracy { bias, gain, noise }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn classes_by_hand() {
        let text = "[[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n\
                    class = \"pt100_a\"\nquantisation = 0.1\n";
        let sensor = &SensorFile::from_toml(text).unwrap().sensor[0];
        assert_eq!(sensor.si(), "k");
        assert_eq!(Sensor { unit: "percent".into(), ..sensor.clone() }.si(), "1");
        assert_eq!(sensor.to_si(60.0), 333.15);
        // (0.15 + 0.12)/sqrt(3) = 0.1559 K at 60 degC; sqrt(1.25 0.02^2 + 0.01/12) = 0.03651 K.
        let accuracy = sensor.accuracy(333.15, 340.0);
        assert!((accuracy.bias - 0.1559).abs() < 1e-4, "{accuracy:?}");
        assert!((accuracy.noise - 0.036_51).abs() < 1e-5, "{accuracy:?}");
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |text: &str| SensorFile::from_toml(text).unwrap_err().to_string();
        assert!(wrong("").contains("role = \"compare\""));
        assert!(wrong("[[sensor]]\ncolum = \"T\"\n").contains("colum"));
        let sensor =
            "[[sensor]]\ncolumn = \"T\"\nsignal = \"b.t_k\"\nunit = \"degC\"\nrole = \"compare\"\n";
        assert!(wrong(&format!("{sensor}lag_s = -1\n")).contains("lag_s = -1"));
        assert!(wrong(&format!("{sensor}{sensor}")).contains("twice"));
    }
}
