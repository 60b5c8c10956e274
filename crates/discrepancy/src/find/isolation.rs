//! Parts of the model driven by their own measured boundaries: what differs there has its cause there.
//!
//! **Equation** a part is testable where all flows through its boundary and the temperatures of what enters are measured or
//! follow from balances, and a sensor is left over. Flows follow from `sum m = 0` at the nodes: with unknown flows `x` and
//! balances `A x = b`, `x_e` is determined where `(A^+ A)_ee = 1` (the well-determined part of the Dulmage-Mendelsohn
//! decomposition, which for flows of a graph is: the edge lies in no loop of unknown flows), and is `(A^+ b)_e`. Parts are
//! what is left when the graph is cut at every node with a measured temperature, so no smaller ones can be tested.
//!
//! A temperature behind the part tests it while all water that enters its node comes out of the part.
//!
//! **Assumptions** pressures at the cuts are constant: only flows and temperatures are tested.
//!
//! **Sources** Krysander, Aslund, Nyberg 2008 (key `krysander2008`).

mod balance;

use super::flux::{Flux, missing};
use crate::data::{Run, Track};
use crate::experiment::Experiment;
use crate::sensors::{Role, Sensor, SensorFile};
use anergy_core::cores::on_all_cores;
use anergy_simulation::isolate::{Cut, CutKind};
use anergy_simulation::model_file::NodeEntryKind;
use balance::{Measured, Sum};
use serde::Serialize;
use std::collections::BTreeSet;

/// Pressure at a cut, Pa: it moves no water.
const CUT_PA: f64 = 2e5;
/// Flows below this share of the largest of an edge are none.
const SMALL: f64 = 0.01;

/// A part that could be tested.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Part {
    /// Its edges.
    pub components: Vec<String>,
    /// The sensors that test it.
    pub sensors: Vec<String>,
    /// Root mean square of residuals over sigma when it is driven by its own measured boundaries.
    pub isolated_z: f64,
    /// The same sensors and samples in the whole system.
    pub whole_z: f64,
    /// Share of what the parts leave unexplained that is its own.
    pub probability: f64,
    /// The heat that it would have to take up beside.
    pub flux: Option<Flux>,
}

/// The testable parts, the most suspicious first.
pub fn parts(experiment: &Experiment, sigma: &[f64], before: &[f64], seen: &[usize]) -> Vec<Part> {
    let measured = Measured::new(experiment);
    let cut_out = measured.parts();
    let tested = on_all_cores(cut_out.len(), |k| measured.test(&cut_out[k], sigma, before, seen));
    let mut parts: Vec<Part> = tested.into_iter().flatten().collect();
    let excess = |part: &Part| (part.isolated_z.powi(2) - 1.0).max(0.0) * part.probability;
    // Until here the number of samples.
    let total: f64 = parts.iter().map(excess).sum();
    for part in &mut parts {
        part.probability = if total > 0.0 { excess(part) / total } else { 0.0 };
    }
    parts.sort_by(|a, b| {
        b.probability.total_cmp(&a.probability).then(b.isolated_z.total_cmp(&a.isolated_z))
    });
    parts
}

impl Measured<'_> {
    /// The flow into a part at a node, where it is known.
    fn into(&self, part: &[&str], node: &str) -> Option<Sum> {
        let mut sum = Sum::default();
        for edge in
            self.experiment.model.edges.iter().filter(|edge| part.contains(&edge.id.as_str()))
        {
            for (end, sign) in [(edge.from.as_str(), 1.0), (edge.to.as_str(), -1.0)] {
                if end == node {
                    sum.add(self.flow.get(edge.id.as_str())?, sign);
                }
            }
        }
        Some(sum)
    }

    /// Drives a part by its measured boundaries; none where it cannot be tested.
    fn test(&self, part: &[&str], sigma: &[f64], before: &[f64], seen: &[usize]) -> Option<Part> {
        let experiment = self.experiment;
        let model = &experiment.model;
        let edges = || model.edges.iter().filter(|edge| part.contains(&edge.id.as_str()));
        let nodes: BTreeSet<&str> =
            edges().flat_map(|e| [e.from.as_str(), e.to.as_str()]).collect();
        let kind =
            |node: &str| model.nodes.iter().find(|n| n.entry.id == node).map(|n| n.entry.kind);
        let outside = |node: &str| {
            let mut others = model.edges.iter().filter(|edge| !part.contains(&edge.id.as_str()));
            others.any(|edge| edge.from == node || edge.to == node)
        };
        let cuts: Vec<&str> = nodes
            .iter()
            .copied()
            .filter(|node| outside(node) || kind(node) != Some(NodeEntryKind::Junction))
            .collect();
        if cuts.len() < 2 || cuts.iter().any(|node| !self.t.contains_key(node)) {
            return None;
        }
        let flows: Vec<Option<Sum>> = cuts.iter().map(|node| self.into(part, node)).collect();
        let open = flows.iter().filter(|flow| flow.is_none()).count();
        if open > 1 {
            return None;
        }
        // The pressure is given where the flow is not known, else where water mostly leaves.
        let mean = |flow: &Option<Sum>| {
            flow.as_ref().map_or(f64::NEG_INFINITY, |flow| {
                experiment
                    .runs
                    .iter()
                    .map(|run| times(run).iter().map(|t| flow.at(run, *t)).sum::<f64>())
                    .sum()
            })
        };
        let held = (0..cuts.len()).min_by(|&a, &b| mean(&flows[a]).total_cmp(&mean(&flows[b])))?;
        let mut compared = Vec::new();
        for (run, measured) in self.ahead.iter().enumerate() {
            let boundary = cuts.iter().zip(&flows).enumerate().map(|(i, (node, flow))| {
                let times_s = times(measured);
                let water = &measured.tracks[self.t[node]];
                let usually = water.usual_bend();
                let t_k = times_s.iter().map(|t| water.smooth_at(*t, usually)).collect();
                let values = match flow {
                    Some(flow) if i != held => {
                        times_s.iter().map(|t| flow.at(measured, *t)).collect()
                    }
                    _ => vec![CUT_PA; times_s.len()],
                };
                let kind = if i == held { CutKind::Pressure } else { CutKind::Flow };
                // A step takes its signals as they are at its end; of what is measured its middle counts.
                let later_s = 0.5 * experiment.step.as_s() - measured.span_s.0;
                let times_s = times_s.iter().map(|t| t + later_s).collect();
                Cut { node: (*node).to_owned(), kind, times_s, values, t_k }
            });
            let isolated = model.isolate(part, &boundary.collect::<Vec<_>>()).ok()?;
            compared.extend(self.readings(part, &cuts, isolated, run)?);
        }
        self.told(part, &cuts, &compared, sigma, before, seen)
    }

    /// Sensors that test a part.
    fn own_sensors(&self, part: &[&str], cuts: &[&str]) -> Vec<usize> {
        let model = &self.experiment.model;
        let units: Vec<&str> = model
            .units
            .iter()
            .filter(|unit| part.contains(&unit.port.as_str()))
            .map(|unit| unit.id.as_str())
            .collect();
        let inside = |sensor: &Sensor| {
            let Some((of, quantity)) = sensor.signal.rsplit_once('.') else { return false };
            let own = part.contains(&of) || units.contains(&of);
            (own && !["m_flow_kg_s", "dp_pa"].contains(&quantity))
                || (cuts.contains(&of) && quantity == "t_k")
        };
        let all = self.experiment.sensors.sensor.iter().enumerate();
        let reads = |k: usize| reads_everywhere(self.experiment, k);
        let tests = |(k, s): &(usize, &Sensor)| s.role == Role::Compare && reads(*k) && inside(s);
        all.filter(tests).map(|(k, _)| k).collect()
    }

    /// Readings of a part in a run: place of the sample and reading.
    fn readings(
        &self,
        part: &[&str],
        cuts: &[&str],
        isolated: anergy_simulation::model::Model,
        run: usize,
    ) -> Option<Vec<(usize, f64)>> {
        let experiment = self.experiment;
        let own = self.own_sensors(part, cuts);
        let names = |name: &str| {
            isolated.nodes.iter().any(|n| n.entry.id == name)
                || isolated.edge(name).is_some()
                || isolated.units.iter().any(|u| u.id == name)
                || ["ground", "weather"].contains(&name)
        };
        let kept: Vec<usize> = (0..experiment.sensors.sensor.len())
            .filter(|k| {
                let sensor = &experiment.sensors.sensor[*k];
                let of = sensor.signal.rsplit_once('.').map_or("", |(of, _)| of);
                match sensor.role {
                    Role::Compare => own.contains(k),
                    Role::Input => names(of) && !cuts.contains(&of),
                }
            })
            .collect();
        let sensors = kept.iter().map(|&k| experiment.sensors.sensor[k].clone()).collect();
        let file = SensorFile { sensor: sensors, effect: experiment.sensors.effect.clone() };
        let whole = &experiment.runs[run];
        let tracks: Vec<Track> = kept.iter().map(|&k| whole.tracks[k].clone()).collect();
        if !kept.iter().any(|k| own.contains(k)) {
            return None;
        }
        let runs = vec![Run { name: whole.name.clone(), tracks, span_s: whole.span_s }];
        let part = Experiment::new(isolated, file, runs).ok()?;
        let readings = part.readings(&[], &[]).ok()?;
        let samples = (0..experiment.samples.len()).filter(|&i| {
            let sample = &experiment.samples[i];
            sample.run == run && own.contains(&sample.sensor)
        });
        Some(samples.zip(readings).collect())
    }

    /// What the comparison says.
    fn told(
        &self,
        part: &[&str],
        cuts: &[&str],
        compared: &[(usize, f64)],
        sigma: &[f64],
        before: &[f64],
        seen: &[usize],
    ) -> Option<Part> {
        let experiment = self.experiment;
        let mut tests = Vec::new();
        for &(i, reading) in compared {
            let sample = &experiment.samples[i];
            let (of, _) = experiment.sensors.sensor[sample.sensor].signal.rsplit_once('.')?;
            if seen.binary_search(&i).is_ok()
                && (!cuts.contains(&of) || self.leaves(part, of, sample.run, sample.time_s))
            {
                tests.push((i, reading));
            }
        }
        if tests.is_empty() {
            return None;
        }
        let rms = |of: &dyn Fn(usize, f64) -> f64| {
            let square = |&(i, reading): &(usize, f64)| {
                ((of(i, reading) - experiment.samples[i].value) / sigma[i]).powi(2)
            };
            (tests.iter().map(square).sum::<f64>() / tests.len() as f64).sqrt()
        };
        let (isolated_z, whole_z) = (rms(&|_, reading| reading), rms(&|i, _| before[i]));
        let sensors: BTreeSet<usize> =
            tests.iter().map(|(i, _)| experiment.samples[*i].sensor).collect();
        let column = |k: usize| experiment.sensors.sensor[k].column.clone();
        let flux = sensors.iter().copied().find_map(|k| {
            let (of, quantity) = experiment.sensors.sensor[k].signal.rsplit_once('.')?;
            if quantity != "t_k" || !cuts.contains(&of) {
                return None;
            }
            let flow = self.into(part, of)?;
            let points: Vec<_> =
                tests.iter().filter(|(i, _)| experiment.samples[*i].sensor == k).collect();
            let of_point = |&&(i, reading): &&(usize, f64)| {
                let sample = &experiment.samples[i];
                let m = -flow.at(&self.ahead[sample.run], sample.time_s);
                (sample.run, sample.time_s, sample.value - reading, sigma[i], m, sample.value)
            };
            missing(&points.iter().map(of_point).collect::<Vec<_>>())
        });
        Some(Part {
            components: part.iter().map(|id| (*id).to_owned()).collect(),
            sensors: sensors.into_iter().map(column).collect(),
            isolated_z,
            whole_z,
            probability: tests.len() as f64,
            flux,
        })
    }

    /// Whether all water that enters a node comes out of the part.
    fn leaves(&self, part: &[&str], node: &str, run: usize, time_s: f64) -> bool {
        let run = &self.ahead[run];
        let model = &self.experiment.model;
        let out = self.into(part, node).map(|flow| -flow.at(run, time_s));
        let least = |flow: &Sum| {
            SMALL
                * flow
                    .of
                    .keys()
                    .map(|k| run.tracks[*k].value.iter().fold(0.0_f64, |m, y| m.max(y.abs())))
                    .fold(0.0, f64::max)
        };
        let from_part = match (&out, self.into(part, node)) {
            (Some(out), Some(flow)) => *out > least(&flow).max(1e-9),
            _ => true,
        };
        let from_others =
            model.edges.iter().filter(|edge| !part.contains(&edge.id.as_str())).any(|edge| {
                let sign = if edge.to == node { 1.0 } else { -1.0 };
                (edge.to == node || edge.from == node)
                    && self
                        .flow
                        .get(edge.id.as_str())
                        .is_none_or(|flow| sign * flow.at(run, time_s) > least(flow))
            });
        from_part && !from_others
    }
}

/// Whether a sensor was there in every run: where it was not, others may have taken its place.
fn reads_everywhere(experiment: &Experiment, sensor: usize) -> bool {
    experiment.runs.iter().all(|run| !run.tracks[sensor].value.is_empty())
}

/// Times at which boundaries are given: those of the densest track, s.
fn times(run: &Run) -> Vec<f64> {
    let densest = run.tracks.iter().max_by_key(|track| track.time_s.len());
    densest.map_or_else(Vec::new, |track| track.time_s.clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench;
    use crate::catalogue::effect_target;
    use crate::unknown::Unknown;

    #[test]
    fn a_part_that_loses_more_is_the_one_that_differs() {
        // Insulation of the second pipe three times as bad: U A = 20 m/(2 K m/W) = 10 W/K, 38 K warmer than the ground and
        // 0.2 kg/s: 0.45 K before, 1.4 K with it.
        let loss = Unknown::plain(effect_target("P2", "far", "factor"), 1.0, 1.0);
        let experiment = bench::experiment(&[(loss, 3.0)]);
        let sigma = vec![0.05; experiment.samples.len()];
        let before = experiment.readings(&[], &[]).unwrap();
        let seen: Vec<usize> = (0..sigma.len()).collect();
        let parts = parts(&experiment, &sigma, &before, &seen);
        let of = |name: &str| parts.iter().find(|p| p.components == [name]).unwrap();
        let (near, far) = (of("near"), of("far"));
        assert!(far.probability > 0.95, "{parts:?}");
        assert!(near.isolated_z < 1.0 && far.isolated_z > 10.0, "{parts:?}");
        assert_eq!(far.sensors, ["T_house"]);
        // 2 * 10 W/K * 37 to 52 K are missing: about 0.8 kW.
        let flux = far.flux.as_ref().unwrap();
        assert!((-1050.0..-600.0).contains(&flux.mean_w), "{}", flux.mean_w);
    }
}
