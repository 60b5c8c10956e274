//! What the pipes lose heat to: the resistance of each, pairs that lie beside each other, and the
//! temperature of the ground at their depth.

use super::Builder;
use super::signals::{Writer, temperature_signal};
use crate::document::Span;
use crate::model::{EdgeSpec, Place};
use crate::plan::SeasonalGround;
use crate::temperatures::SURROUNDINGS;
use crate::wording::refused;
use anergy_core::ids::{EdgeId, SignalId};
use anergy_core::signal::SignalTable;
use anergy_network::elements::ElementParams;
use anergy_network::elements::pipe::{Laying, PipeParams};
use anergy_network::graph::Coupling;
use anergy_network::soil::SoilRings;
use anergy_network::two_port::ElementError;
use std::collections::{BTreeMap, HashMap};

impl Builder<'_> {
    /// Thermal resistance from water to surroundings of each edge, K m/W (`None` loses no heat), and the
    /// pairs that exchange heat.
    pub(super) fn resistances(
        &mut self,
        edge_ids: &HashMap<&str, usize>,
    ) -> (Vec<Option<f64>>, Vec<Coupling>) {
        let ground = self.model.ground.ground();
        let mut couplings = Vec::new();
        let mut resistances = vec![None; self.model.edges.len()];
        for (i, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::Pipe(pipe) = &spec.params else { continue };
            match pipe.resistance(&ground) {
                Ok(alone) => resistances[i] = alone.map(|alone| alone.total_k_m_w()),
                Err(error) => self.refuse_pipe(spec, &error),
            }
            let outdoors = self.model.weather.is_some();
            if pipe.laying == Some(Laying::AboveGround)
                && pipe.surroundings_k.is_none()
                && !outdoors
            {
                let what = format!("edge \"{}\" (pipe)", spec.id);
                let message = "a pipe above the ground needs surroundings_k, the air around it";
                let problem = refused(&what, &spec.place, Some("laying"), message);
                let hint =
                    "the signal has the same name; with a [weather] it is that of the air outdoors";
                self.problems.push(problem.with_hint(hint));
            }
        }
        for (i, j, reversed) in self.companions(edge_ids) {
            let (spec, other) = (&self.model.edges[i], &self.model.edges[j]);
            let (ElementParams::Pipe(a), ElementParams::Pipe(b)) = (&spec.params, &other.params)
            else {
                continue;
            };
            match a.pair(b, &ground) {
                // What is wrong with one of them has been reported.
                Err(_) if resistances[i].is_none() || resistances[j].is_none() => {}
                Err(error) => self.refuse_pipe(spec, &error),
                Ok(pair) => {
                    resistances[i] = Some(pair.ground_k_m_w[0]);
                    resistances[j] = Some(pair.ground_k_m_w[1]);
                    couplings.push(Coupling {
                        edges: [EdgeId::from_index(i), EdgeId::from_index(j)],
                        reversed,
                        conductance_w_k: pair.between_w_m_k * a.length_m,
                    });
                }
            }
        }
        (resistances, couplings)
    }

    /// The soil that stores heat; its pipes reach from the water to the innermost ring.
    pub(super) fn soil(&mut self, resistances: &mut [Option<f64>]) -> Vec<SoilRings> {
        let ground = self.model.ground.ground();
        let (mut soil, mut first) = (Vec::new(), 0);
        for (i, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::Pipe(pipe) = &spec.params else { continue };
            // What is wrong with its resistance has been reported.
            if let Ok(Some(rings)) = pipe.soil(EdgeId::from_index(i), first, &ground) {
                first += rings.count();
                resistances[i] = Some(rings.inwards_k_m_w(pipe.length_m));
                soil.push(rings);
            }
        }
        soil
    }

    fn refuse_pipe(&mut self, spec: &EdgeSpec, error: &ElementError) {
        let what = format!("edge \"{}\" (pipe)", spec.id);
        self.problems.push(refused(&what, &spec.place, error.field(), &error.to_string()));
    }

    /// The pairs of pipes beside each other, and whether they run in opposite directions.
    fn companions(&mut self, edge_ids: &HashMap<&str, usize>) -> Vec<(usize, usize, bool)> {
        let mut pairs = Vec::new();
        let mut with: Vec<Option<usize>> = vec![None; self.model.edges.len()];
        for (i, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::Pipe(PipeParams {
                companion: Some(name), companion_reversed, ..
            }) = &spec.params
            else {
                continue;
            };
            let other = edge_ids.get(name.as_str()).copied();
            let pipe = |j: &usize| matches!(self.model.edges[*j].params, ElementParams::Pipe(_));
            let Some(j) = other.filter(pipe).filter(|j| *j != i) else {
                let message = format!("companion names no other pipe: \"{name}\"");
                let what = format!("edge \"{}\" (pipe)", spec.id);
                self.problems.push(refused(&what, &spec.place, Some("companion"), &message));
                continue;
            };
            if let Some(k) = [i, j].into_iter().find(|k| with[*k].is_some()) {
                let id = &self.model.edges[k].id;
                let message = format!("companion: \"{id}\" has a companion already");
                let what = format!("edge \"{}\" (pipe)", spec.id);
                let problem = refused(&what, &spec.place, Some("companion"), &message);
                self.problems.push(problem.with_hint("name it on one of the two pipes"));
                continue;
            }
            (with[i], with[j]) = (Some(j), Some(i));
            pairs.push((i, j, companion_reversed.unwrap_or(false)));
        }
        for (i, spec) in self.model.edges.iter().enumerate() {
            let ElementParams::Pipe(pipe) = &spec.params else { continue };
            let beside = pipe.spacing_m.is_some() || pipe.laying == Some(Laying::Twin);
            let alone = pipe.companion.is_none() && with[i].is_none();
            if pipe.laying.is_some() && beside && alone {
                let what = format!("edge \"{}\" (pipe)", spec.id);
                let message = "spacing_m is that of two pipes, and there is no second one";
                let problem = refused(&what, &spec.place, Some("spacing_m"), message);
                let hint =
                    "the two lines of a trench are such pipes; else name it with `companion`";
                self.problems.push(problem.with_hint(hint));
            }
        }
        pairs
    }

    /// The signals of the ground: at the depth of the ground, and with seasons at every other depth at
    /// which a pipe lies, by millimetre.
    pub(super) fn ground_signals(
        &mut self,
        signals: &mut SignalTable,
        writers: &mut HashMap<SignalId, Writer>,
    ) -> (SignalId, BTreeMap<u64, SignalId>, Option<SeasonalGround>) {
        let entry = &self.model.ground;
        let seasons = entry.seasons();
        let start_s = self.since_new_year_s();
        let at_start = |depth_m: f64| match seasons {
            Some(seasons) => seasons.temperature_k(depth_m, start_s),
            None => entry.temperature_k,
        };
        let name = "ground.temperature_k";
        let signal = temperature_signal(name, at_start(entry.depth_m), &SURROUNDINGS);
        let ground = self.add_signal(signals, signal, &Place::default());
        let Some(seasons) = seasons else { return (ground, BTreeMap::new(), None) };
        let mut by_depth = BTreeMap::from([(millimetres(entry.depth_m), ground)]);
        let mut at_depths = vec![(ground, entry.depth_m)];
        for spec in &self.model.edges {
            let ElementParams::Pipe(PipeParams {
                depth_m: Some(depth_m),
                surroundings_k: None,
                ..
            }) = spec.params
            else {
                continue;
            };
            if depth_m <= 0.0 || by_depth.contains_key(&millimetres(depth_m)) {
                continue;
            }
            let name = format!("ground.at_{}_mm.temperature_k", millimetres(depth_m));
            let signal = temperature_signal(&name, at_start(depth_m), &SURROUNDINGS);
            let signal = self.add_signal(signals, signal, &spec.place);
            by_depth.insert(millimetres(depth_m), signal);
            at_depths.push((signal, depth_m));
        }
        for (signal, _) in &at_depths {
            let (what, span) = ("the seasons of [ground]".into(), Span::NONE);
            writers.insert(*signal, Writer { what, span });
        }
        (ground, by_depth, Some(SeasonalGround { seasons, start_s, at_depths }))
    }

    /// Time from New Year to the start of the run, s (UTC).
    fn since_new_year_s(&self) -> f64 {
        let start = self.model.run.start.as_ref();
        let start = start.and_then(|text| text.parse::<jiff::Timestamp>().ok());
        let Some(start) = start else { return 0.0 };
        let local = start.to_zoned(jiff::tz::TimeZone::UTC);
        let midnight = f64::from(local.day_of_year() - 1) * 86_400.0;
        let clock = local.time();
        midnight
            + f64::from(clock.hour()) * 3600.0
            + f64::from(clock.minute()) * 60.0
            + f64::from(clock.second())
    }

    /// What is around each edge: a signal, and how much warmer than it, K.
    pub(super) fn surroundings(
        &mut self,
        signals: &mut SignalTable,
        ground: SignalId,
        by_depth: &BTreeMap<u64, SignalId>,
    ) -> Vec<(SignalId, f64)> {
        let outdoors = signals.find("weather.t_outdoor_k");
        self.model
            .edges
            .iter()
            .map(|spec| {
                let ElementParams::Pipe(pipe) = &spec.params else { return (ground, 0.0) };
                if let (Some(Laying::AboveGround), None) = (pipe.laying, pipe.surroundings_k) {
                    return (outdoors.unwrap_or(ground), pipe.surroundings_difference_k);
                }
                let around = match (pipe.surroundings_k, pipe.depth_m) {
                    (Some(t_k), _) => {
                        let name = format!("{}.surroundings_k", spec.id);
                        let signal = temperature_signal(&name, t_k, &SURROUNDINGS);
                        self.add_signal(signals, signal, &spec.place)
                    }
                    (None, Some(depth_m)) => {
                        by_depth.get(&millimetres(depth_m)).copied().unwrap_or(ground)
                    }
                    (None, None) => ground,
                };
                (around, pipe.surroundings_difference_k)
            })
            .collect()
    }
}

/// A depth as the key of its signal.
fn millimetres(depth_m: f64) -> u64 {
    (depth_m * 1000.0).round() as u64
}
