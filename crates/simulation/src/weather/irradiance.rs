//! Global, diffuse and beam irradiance of the records: what is not given follows from the rest.

use super::records::Records;
use anergy_core::clock::NS_PER_S;
use anergy_core::solar::{SOLAR_CONSTANT_W_M2, diffuse_share, extraterrestrial_w_m2};

/// Irradiances of the records, means of their intervals, W/m2.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Irradiance {
    /// Global on the horizontal, W/m2.
    pub global_w_m2: Box<[f64]>,
    /// Diffuse on the horizontal, W/m2.
    pub diffuse_w_m2: Box<[f64]>,
    /// Of the sun on a plane that faces it, W/m2.
    pub beam_normal_w_m2: Box<[f64]>,
}

impl Irradiance {
    /// Global, diffuse and beam of a record.
    pub(crate) fn at(&self, record: usize) -> [f64; 3] {
        [self.global_w_m2[record], self.diffuse_w_m2[record], self.beam_normal_w_m2[record]]
    }
}

/// What a file gives of the irradiance, W/m2.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Given {
    /// Global on the horizontal.
    pub global_w_m2: Option<Vec<f64>>,
    /// Diffuse on the horizontal.
    pub diffuse_w_m2: Option<Vec<f64>>,
    /// Beam on a plane that faces the sun.
    pub beam_normal_w_m2: Option<Vec<f64>>,
}

impl Given {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.global_w_m2.is_none() && self.diffuse_w_m2.is_none() && self.beam_normal_w_m2.is_none()
    }
}

/// Global, diffuse and beam of every record: two of them give the third, global alone is split by its clearness
/// (Erbs). `begins_ns` are the intervals of the records. A beam stays below what is outside the atmosphere: where
/// the sun touches the horizon the difference of global and diffuse says nothing of it.
///
/// # Errors
/// What is missing, in words.
pub(crate) fn complete(
    records: &Records,
    begins_ns: impl Iterator<Item = i64>,
    given: Given,
) -> Result<Irradiance, &'static str> {
    let Some(location) = records.location else { return Err("the place of the sun") };
    let length_s = records.interval_ns() as f64 / NS_PER_S as f64;
    let suns = begins_ns.map(|begin_ns| {
        let middle_s = begin_ns as f64 / NS_PER_S as f64 + 0.5 * length_s;
        let path = location.path(middle_s);
        let (from_s, to_s) = (-0.5 * length_s, 0.5 * length_s);
        let day = (middle_s / 86_400.0).rem_euclid(365.2425);
        let share = path.sunshine_s(from_s, to_s) / length_s;
        (path.sine_s(from_s, to_s) / length_s, share, extraterrestrial_w_m2(day))
    });
    let (global, diffuse, beam): (Vec<f64>, Vec<f64>, Vec<f64>);
    match (given.global_w_m2, given.diffuse_w_m2, given.beam_normal_w_m2) {
        (Some(all), Some(sky), Some(sun)) => (global, diffuse, beam) = (all, sky, sun),
        (None, Some(sky), Some(sun)) => {
            // The beam shines while the sun is up: its mean then is sun/share, and so is what falls down of it.
            let sums = suns.zip(sky.iter().zip(&sun)).map(|((sine, share, _), (sky, sun))| {
                sky + if share > 0.0 { sun * sine / share } else { 0.0 }
            });
            global = sums.collect();
            (diffuse, beam) = (sky, sun);
        }
        (Some(all), sky, sun) => {
            let splits = suns.enumerate().map(|(i, (sine, share, outside_w_m2))| {
                let (all, horizontal_w_m2) = (all[i], outside_w_m2 * sine);
                let sky = match (&sky, &sun) {
                    (Some(sky), _) => sky[i].min(all),
                    (None, Some(sun)) if share > 0.0 => (all - sun[i] * sine / share).max(0.0),
                    _ if horizontal_w_m2 > 0.0 => all * diffuse_share(all / horizontal_w_m2),
                    _ => all,
                };
                let while_up = if sine > 0.0 { (all - sky) / sine * share } else { 0.0 };
                let sun = match &sun {
                    Some(sun) => sun[i],
                    None => while_up.min(SOLAR_CONSTANT_W_M2 * share),
                };
                (sky, sun)
            });
            (diffuse, beam) = splits.unzip();
            global = all;
        }
        _ => {
            return Err(
                "global_horizontal_w_m2, or both diffuse_horizontal_w_m2 and beam_normal_w_m2",
            );
        }
    }
    Ok(Irradiance {
        global_w_m2: global.into(),
        diffuse_w_m2: diffuse.into(),
        beam_normal_w_m2: beam.into(),
    })
}
