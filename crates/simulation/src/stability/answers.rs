//! What measured values do after a change of an output of a controller: gains of the network, parts of them behind
//! the inertia of its water, step responses where temperatures take part; and outputs that are set points of other
//! controllers.

use super::response::{StepResponse, responses};
use super::water::{Late, late};
use crate::channels::{self, Source};
use crate::error::RunError;
use crate::gains::{Gains, Reach, measured, reach};
use crate::plan::Plan;
use crate::simulation::Simulation;
use anergy_core::ids::SignalId;
use anergy_network::hydraulics::linearize::Valves;
use nalgebra::DMatrix;

/// Answers of all measured values (rows) to all outputs (columns) of some controllers.
pub(super) struct Answers {
    /// Of the water, or what is left at last.
    pub gains: DMatrix<f64>,
    /// What of them comes behind a lag of the water.
    pub late: Vec<Late>,
    /// Where temperatures take part: value, output, response.
    pub slow: Vec<(usize, usize, StepResponse)>,
    /// Outputs that are set points.
    pub links: Vec<Link>,
}

/// An output of one controller that is the set point of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Link {
    /// The output, and the controller whose it is.
    pub output: usize,
    pub from: usize,
    /// The controller whose set point it is.
    pub to: usize,
    pub set_point: usize,
}

/// Whether a signal is what another controller is to hold: which, and its place among the set points.
pub(super) fn is_set_point(plan: &Plan, signal: SignalId) -> Option<(usize, usize)> {
    let mut all = plan.controllers.iter().enumerate();
    all.find_map(|(controller, planned)| {
        let first = planned.set_points.start;
        let place = planned.set_points.contains(&signal.index());
        place.then(|| (controller, signal.index() - first))
    })
}

/// Links between some controllers of a plan, in their numbers among those.
fn links(plan: &Plan, closed: &[usize]) -> Vec<Link> {
    let mut links = Vec::new();
    let mut output = 0;
    for (from, &controller) in closed.iter().enumerate() {
        for signal in &plan.controllers[controller].acts_on {
            let set = is_set_point(plan, *signal);
            let of = set.and_then(|(held, place)| {
                Some((closed.iter().position(|other| *other == held)?, place))
            });
            links.extend(of.map(|(to, set_point)| Link { output, from, to, set_point }));
            output += 1;
        }
    }
    links
}

/// Answers of the measured values to the outputs of some controllers of a simulation at rest, or why there are none.
///
/// # Errors
/// When the network cannot be linearised, and what a run can fail of.
pub(super) fn answers(
    simulation: &mut Simulation,
    closed: &[usize],
) -> Result<Result<Answers, &'static str>, RunError> {
    let plan = simulation.plan().clone();
    let planned = || closed.iter().map(|&c| &plan.controllers[c]);
    let sources: Vec<(Source, Option<Source>)> =
        planned().flat_map(|c| &c.measures).map(|source| measured(&plan, *source)).collect();
    let outputs: Vec<_> =
        planned().flat_map(|c| c.acts_on.iter().copied().zip(c.limits.iter().copied())).collect();
    let mut gains = DMatrix::zeros(sources.len(), outputs.len());
    let mut open = Vec::new();
    let state = simulation.state();
    let mut network = Gains::new(&plan, state, Valves::Stay)
        .map_err(|error| crate::simulation::named(&plan, state.time, &error))?;
    let all: Vec<Source> =
        sources.iter().flat_map(|(of, minus)| [*of, minus.unwrap_or(*of)]).collect();
    let reaches: Vec<Option<Reach>> =
        outputs.iter().map(|(signal, _)| reach(&plan, state, *signal)).collect();
    for (j, reach) in reaches.iter().enumerate() {
        let known = match reach {
            Some(reach) => network.column(&plan, state, reach, &all),
            // A set point moves nothing by itself.
            None if is_set_point(&plan, outputs[j].0).is_some() => vec![Some(0.0); all.len()],
            None => vec![None; all.len()],
        };
        for (i, (_, minus)) in sources.iter().enumerate() {
            let less = if minus.is_some() { known[2 * i + 1] } else { Some(0.0) };
            match known[2 * i].zip(less) {
                Some((gain, less)) => gains[(i, j)] = gain - less,
                None => open.push((i, j)),
            }
        }
    }
    let late = if state.network.counts_inertia() {
        match late(&plan, state, &mut network, &sources, &reaches, &gains) {
            Ok(late) => late,
            Err(reason) => return Ok(Err(reason)),
        }
    } else {
        Vec::new()
    };
    let mut slow = Vec::new();
    if !open.is_empty() {
        let read = |simulation: &Simulation| -> Vec<f64> {
            let value = |of| channels::value(simulation.plan(), simulation.state(), of);
            sources.iter().map(|(of, minus)| value(*of) - minus.map_or(0.0, value)).collect()
        };
        let moved: Vec<usize> =
            (0..outputs.len()).filter(|j| open.iter().any(|(_, column)| column == j)).collect();
        let stepped: Vec<_> = moved.iter().map(|&j| outputs[j]).collect();
        let found = responses(simulation, &stepped, &read)?;
        for (i, j) in open {
            let column = moved.iter().position(|other| *other == j).unwrap_or(0);
            let response = found[column][i].clone();
            gains[(i, j)] = response.settled();
            if response.settled() != 0.0 || response.time_s() > 0.0 {
                slow.push((i, j, response));
            }
        }
    }
    Ok(Ok(Answers { gains, late, slow, links: links(&plan, closed) }))
}
