//! How a run begins: what the temperatures of water say that are read first.
//!
//! **Assumptions** one temperature everywhere, the median of the first readings; what they differ beyond the accuracy of their sensors
//! is uncertain. A meter that reads nothing while nothing flows reads first what came later, and does not count.

use crate::experiment::Experiment;
use crate::sensors::{Role, Sensor};
use crate::uncertainty::interval_s;

/// A reading within so many intervals of the begin of a run tells how it began.
const EARLY: f64 = 2.0;

/// What stands in the names of temperatures that are none of water.
const AIR: [&str; 6] = ["weather.", "ground", "soil", "room", "roof", "cellar"];

/// The water at the beginning of a run, as the temperatures that are read first say, K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct First {
    /// Their median: with which a simulation begins.
    pub middle_k: f64,
    /// How far the furthest one lies from it.
    pub far_k: f64,
    /// Median of how far they lie from it beyond what their classes allow.
    pub uneven_k: f64,
}

/// The middle one, or the mean of the two in the middle.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let n = values.len();
    (n > 0).then(|| 0.5 * (values[(n - 1) / 2] + values[n / 2]))
}

impl Experiment {
    /// What the temperatures of water that a run reads first say of its beginning.
    pub fn first(&self, run: usize) -> Option<First> {
        let (run, begin_s) = (&self.runs[run], self.runs[run].span_s.0);
        let of_water = |k: &usize| {
            !run.tracks[*k].value.is_empty() && self.is_of_water(&self.sensors.sensor[*k])
        };
        let water: Vec<usize> = (0..run.tracks.len()).filter(of_water).collect();
        // A meter that reads nothing while nothing flows reads first what came later.
        let is_early = |k: &usize| {
            let track = &run.tracks[*k];
            track.time_s[0] - begin_s <= EARLY * interval_s(track)
        };
        let early: Vec<usize> = water.iter().copied().filter(is_early).collect();
        let of = if early.is_empty() { water } else { early };
        let middle_k = median(of.iter().map(|&k| run.tracks[k].value[0]))?;
        let away = |k: &usize| (run.tracks[*k].value[0] - middle_k).abs();
        let beyond = |k: &usize| (away(k) - 3.0_f64.sqrt() * self.accuracy[*k].bias).max(0.0);
        let far_k = of.iter().map(away).fold(0.0, f64::max);
        Some(First { middle_k, far_k, uneven_k: median(of.iter().map(beyond))? })
    }

    /// Whether a sensor reads the temperature of water: not of air, rooms or ground.
    fn is_of_water(&self, sensor: &Sensor) -> bool {
        let name = &sensor.signal;
        let of_node = || {
            let node = name.strip_suffix(".temperature_k");
            node.is_some_and(|node| self.model.nodes.iter().any(|n| n.entry.id == node))
        };
        let of_air = || AIR.iter().any(|word| name.contains(word)) || name.ends_with("_command");
        sensor.si() == "k"
            && match sensor.role {
                Role::Input => of_node(),
                Role::Compare => !of_air(),
            }
    }
}

#[cfg(test)]
mod tests {
    use crate::bench;

    #[test]
    fn a_run_begins_as_its_first_readings_say() {
        let mut experiment = bench::experiment(&[]);
        // Inlet, middle and house begin at 47 degC; the house reads nothing until water of 62 degC has come.
        let late = &mut experiment.runs[0].tracks[3];
        late.time_s.drain(..250);
        late.value.drain(..250);
        let first = experiment.first(0).unwrap();
        assert!((first.middle_k - 320.15).abs() < 0.2 && first.far_k < 0.2, "{first:?}");
        // Three readings, one 8 K apart: the median counts. Within (0.15 + 0.002 * 47) K nothing is uneven; the middle one is.
        experiment.runs[0].tracks[3].time_s[0] = 5.0;
        experiment.runs[0].tracks[3].value[0] = 328.15;
        let first = experiment.first(0).unwrap();
        assert!((first.middle_k - 320.15).abs() < 0.2 && (first.far_k - 8.0).abs() < 0.2);
        assert_eq!(first.uneven_k, 0.0, "{first:?}");
    }
}
