//! Controllers in the steady state: "measured = set point, actuator free within its limits, else at the
//! limit", or whatever else is the balance of a controller.
//!
//! **Numerics** Newton on the outputs of all controllers. The Jacobian follows from the gains of the network
//! where only water is in the loops, otherwise from differences of settled states. An actuator behind a closed
//! check valve has no gain, so that a start may fail where another one does not. The first start is that of a
//! network in which pumps hold their own flow, and what else is tracked is prescribed for a free pump. What a step takes to
//! its limit is set there before the others step. A step is at most a share of each output's range, which halves where the
//! balances became worse.

use super::settle_temperatures;
use crate::channels::{self, Source};
use crate::error::RunError;
use crate::gains::{Gains, measured, reach};
use crate::simulation::Simulation;
use anergy_control::controller::{Balance, Inputs};
use anergy_core::ids::{EdgeId, NodeId};
use anergy_network::elements::Element;
use anergy_network::graph::{Prescription, Quantity};
use anergy_network::hydraulics::HydraulicSolver;
use anergy_network::hydraulics::linearize::Valves;
use anergy_network::state::Prescribed;
use nalgebra::{DMatrix, DVector};

const MAX_ROUNDS: u32 = 60;
/// Largest step of an output, relative to its range, and how small that becomes.
const LARGEST_STEP: (f64, f64) = (0.3, 0.01);
/// Actuator change for the difference quotient, relative to its range where that is finite.
const DIFFERENCE: f64 = 1e-5;
/// A balance is reached within this share of its scale.
const REACHED: f64 = 1e-9;
/// Outputs at the start, in shares of their ranges: one after the other is tried.
const STARTS: [f64; 3] = [0.7, 1.0, 0.4];
/// Change of a measured value for the difference quotient of a balance, in scales.
const MEASURED_DIFFERENCE: f64 = 1e-6;

/// An output with its limits.
struct Output {
    controller: usize,
    output: usize,
    min: f64,
    max: f64,
}

fn outputs(simulation: &Simulation) -> Vec<Output> {
    let (plan, state) = (simulation.plan(), simulation.state());
    let (mut all, mut measured) = (Vec::new(), Vec::new());
    for (controller, planned) in plan.controllers.iter().enumerate() {
        let inputs = planned.inputs(plan, state, &mut measured);
        for output in 0..planned.acts_on.len() {
            let (min, max) = planned.controller.limits_now(output, &inputs);
            all.push(Output { controller, output, min, max });
        }
    }
    all
}

/// Sets the outputs and says what they miss.
fn answer(
    simulation: &mut Simulation,
    outputs: &[Output],
    values: &DVector<f64>,
) -> Result<Vec<Balance>, RunError> {
    let plan = simulation.plan().clone();
    for (output, value) in outputs.iter().zip(values) {
        let signal = plan.controllers[output.controller].acts_on[output.output];
        simulation.state_mut().signals[signal.index()] = *value;
    }
    settle_temperatures(simulation)?;
    Ok(misses(simulation))
}

fn misses(simulation: &Simulation) -> Vec<Balance> {
    let (plan, state) = (simulation.plan(), simulation.state());
    plan.controllers.iter().flat_map(|planned| planned.balance(plan, state)).collect()
}

/// Misses of the free outputs over each other, from settled states.
fn by_differences(
    simulation: &mut Simulation,
    outputs: &[Output],
    values: &DVector<f64>,
    missed: &[Balance],
    free: &[usize],
) -> Result<DMatrix<f64>, RunError> {
    let mut jacobian = DMatrix::zeros(free.len(), free.len());
    for (column, &i) in free.iter().enumerate() {
        let range = outputs[i].max - outputs[i].min;
        let step = if range.is_finite() { DIFFERENCE * range } else { DIFFERENCE };
        let step = if values[i] + step > outputs[i].max { -step } else { step };
        let mut moved = values.clone();
        moved[i] += step;
        let answered = answer(simulation, outputs, &moved)?;
        for (row, &j) in free.iter().enumerate() {
            jacobian[(row, column)] = (answered[j].miss - missed[j].miss) / step;
        }
    }
    Ok(jacobian)
}

/// The same from the gains of the network; `None` where more than water is in the loops.
fn by_gains(simulation: &Simulation, outputs: &[Output], free: &[usize]) -> Option<DMatrix<f64>> {
    let (plan, state) = (&**simulation.plan(), simulation.state());
    let signal = |i: usize| {
        let output = &outputs[i];
        plan.controllers[output.controller].acts_on[output.output]
    };
    let reaches: Option<Vec<_>> = free.iter().map(|&i| reach(plan, state, signal(i))).collect();
    let reaches = reaches?;
    // What each free output misses over each value that its controller measures.
    let mut sources = Vec::new();
    let mut slopes = Vec::new();
    for (row, &i) in free.iter().enumerate() {
        let planned = &plan.controllers[outputs[i].controller];
        let mut values: Vec<f64> =
            planned.measures.iter().map(|of| channels::value(plan, state, *of)).collect();
        let now: Vec<f64> = planned.acts_on.iter().map(|id| state.signals[id.index()]).collect();
        let miss = |values: &[f64]| {
            let inputs = Inputs {
                measured: values,
                set_points: &state.signals[planned.set_points.clone()],
                limits: &planned.limits,
            };
            let mut balance = vec![Balance::default(); now.len()];
            planned.controller.balance(&inputs, &now, &mut balance);
            balance[outputs[i].output]
        };
        let scale = miss(&values).scale;
        for k in 0..values.len() {
            let (value, step) = (values[k], MEASURED_DIFFERENCE * scale);
            values[k] = value + step;
            let above = miss(&values).miss;
            values[k] = value - step;
            let slope = (above - miss(&values).miss) / (2.0 * step);
            values[k] = value;
            let (of, minus) = measured(plan, planned.measures[k]);
            sources.extend([Some(of), minus].into_iter().flatten());
            slopes.push((row, slope));
            slopes.extend(minus.map(|_| (row, -slope)));
        }
    }
    let mut gains = Gains::new(plan, state, Valves::Follow).ok()?;
    let mut jacobian = DMatrix::zeros(free.len(), free.len());
    for (column, reach) in reaches.iter().enumerate() {
        let all = gains.column(plan, state, reach, &sources);
        for ((row, slope), gain) in slopes.iter().zip(all) {
            jacobian[(*row, column)] += slope * gain?;
        }
    }
    Some(jacobian)
}

/// Newton on the outputs of all controllers, within their limits.
pub(super) fn settle_controllers(simulation: &mut Simulation) -> Result<(), RunError> {
    let outputs = outputs(simulation);
    let share = |o: &Output, share: f64| {
        if o.min.is_finite() && o.max.is_finite() { o.min + share * (o.max - o.min) } else { 0.0 }
    };
    let known = prescribed(simulation, &outputs);
    let mut failure = None;
    for start in STARTS {
        let at = |(o, known): (&Output, &Option<f64>)| match known {
            Some(known) if start == STARTS[0] => known.clamp(o.min, o.max),
            _ => share(o, start),
        };
        let values = outputs.iter().zip(&known).map(at);
        let values = DVector::from_iterator(outputs.len(), values);
        match settle_from(simulation, &outputs, values) {
            Err(error @ RunError::NotSettled { .. }) => failure = failure.or(Some(error)),
            done => return done,
        }
    }
    failure.map_or(Ok(()), Err)
}

/// Positions of the actuators when what their controllers track is prescribed, as far as it can be.
fn prescribed(simulation: &Simulation, outputs: &[Output]) -> Vec<Option<f64>> {
    let (plan, state) = (&**simulation.plan(), simulation.state());
    let mut network = plan.network.clone();
    let mut water = state.network.clone();
    let mut free = vec![None; outputs.len()];
    for (i, output) in outputs.iter().enumerate() {
        let planned = &plan.controllers[output.controller];
        if !planned.controller.tracks() {
            continue;
        }
        let edge = |e: usize| EdgeId::from_index(e);
        let quantity = match measured(plan, planned.measures[0]) {
            (Source::EdgeFlow(e), None) => Quantity::MassFlow(edge(e)),
            (Source::StationFlow(i), None) => Quantity::MassFlow(plan.stations[i].edge),
            (Source::EdgePressure(e), None) => Quantity::PressureDifference(edge(e)),
            (Source::NodePressure(n), None) => Quantity::Pressure(NodeId::from_index(n)),
            _ => continue,
        };
        let signal = planned.acts_on[output.output];
        let mut driven = (0..plan.commands.len()).filter(|&e| plan.commands[e] == Some(signal));
        let (Some(e), None) = (driven.next(), driven.next()) else { continue };
        let Element::Pump(pump) = &plan.network.edges[e].element else { continue };
        let value = state.signals[planned.set_points.start];
        // A pump that holds its own flow has a law of its own, which no solve fails on.
        let flow = |e: usize| state.network.m_flow_kg_s[e];
        if matches!(quantity, Quantity::MassFlow(of) if flow(of.index()) == flow(e))
            && !pump.holds()
        {
            network.edges[e].element = Element::Pump(pump.holding_flow());
            water.position[e] = value;
            free[i] = Some(e);
        } else {
            network.prescriptions.push(Prescription { quantity, free: edge(e) });
            water.prescribed.push(Prescribed { value, ..Prescribed::default() });
            free[i] = Some(e);
        }
    }
    water.invalidate_hydraulics();
    let solved = HydraulicSolver::new(&network)
        .and_then(|mut solver| solver.solve(&network, &mut water))
        .is_ok();
    let position = |edge: usize| match &network.edges[edge].element {
        Element::Pump(pump) => {
            pump.speed(water.m_flow_kg_s[edge], &water.edge_state(&network, edge))
        }
        _ => water.position[edge],
    };
    free.into_iter().map(|edge| edge.filter(|_| solved).map(position)).collect()
}

/// The Newton step of outputs that have so much room below and above: what would pass its limit furthest goes to it, and
/// the others step with it there, until none passes. Without that, an actuator that can hardly do anything, like a pump
/// that is held shut at nearly full speed, throws all others off.
fn within(
    jacobian: &DMatrix<f64>,
    missing: &DVector<f64>,
    room: &[(f64, f64)],
) -> Option<DVector<f64>> {
    let mut change = DVector::zeros(room.len());
    let mut open: Vec<usize> = (0..room.len()).collect();
    let mut left = missing.clone();
    while !open.is_empty() {
        let part = DMatrix::from_fn(open.len(), open.len(), |i, j| jacobian[(open[i], open[j])]);
        let rhs = DVector::from_fn(open.len(), |i, _| left[open[i]]);
        let step = part.lu().solve(&rhs)?;
        let beyond = |k: usize| (room[open[k]].0 - step[k]).max(step[k] - room[open[k]].1);
        let furthest = (0..open.len()).max_by(|&k, &l| beyond(k).total_cmp(&beyond(l)))?;
        if beyond(furthest) <= 0.0 {
            open.iter().zip(step.iter()).for_each(|(&i, step)| change[i] = *step);
            break;
        }
        let i = open.remove(furthest);
        change[i] = step[furthest].clamp(room[i].0, room[i].1);
        left -= jacobian.column(i) * change[i];
    }
    Some(change)
}

fn settle_from(
    simulation: &mut Simulation,
    outputs: &[Output],
    mut values: DVector<f64>,
) -> Result<(), RunError> {
    let plan = simulation.plan().clone();
    let n = outputs.len();
    let name = |i: usize| &plan.controllers[outputs[i].controller].name;
    let without_effect = |i: usize| RunError::NotSettled {
        iterations: 1,
        culprit: format!(
            "the actuator of controller \"{}\" has no effect on what it measures",
            name(i)
        ),
    };
    let (mut most, mut last) = (LARGEST_STEP.0, f64::INFINITY);
    for _ in 0..MAX_ROUNDS {
        let missed = answer(simulation, outputs, &values)?;
        // At a limit, a miss that pushes beyond it stays.
        let held = |i: usize| {
            let (o, miss) = (&outputs[i], missed[i].miss);
            o.min >= o.max
                || (values[i] >= o.max && miss > 0.0)
                || (values[i] <= o.min && miss < 0.0)
        };
        let free: Vec<usize> = (0..n).filter(|&i| !held(i)).collect();
        if free.iter().all(|&i| missed[i].miss.abs() <= REACHED * missed[i].scale) {
            return Ok(());
        }
        let worst =
            free.iter().map(|&i| missed[i].miss.abs() / missed[i].scale).fold(0.0, f64::max);
        most = if worst > last { most / 2.0 } else { most * 2.0 }
            .clamp(LARGEST_STEP.1, LARGEST_STEP.0);
        last = worst;
        let jacobian = match by_gains(simulation, outputs, &free) {
            Some(jacobian) => jacobian,
            None => by_differences(simulation, outputs, &values, &missed, &free)?,
        };
        // An actuator beyond what its element can do, like a head that the pump does not reach at this
        // flow, has no effect here, but may have one elsewhere.
        let idle = (0..free.len()).find(|&k| jacobian.column(k).iter().all(|slope| *slope == 0.0));
        if let Some(k) = idle {
            let i = free[k];
            let Output { min, max, .. } = outputs[i];
            let mut other = values.clone();
            other[i] = if values[i] > min { min } else { max };
            if !other[i].is_finite() || answer(simulation, outputs, &other)? == missed {
                return Err(without_effect(i));
            }
            values[i] = (values[i] + LARGEST_STEP.0 * (max - min) * missed[i].miss.signum())
                .clamp(min, max);
            continue;
        }
        let room: Vec<(f64, f64)> = free
            .iter()
            .map(|&i| (outputs[i].min - values[i], outputs[i].max - values[i]))
            .collect();
        let missing = DVector::from_iterator(free.len(), free.iter().map(|&i| -missed[i].miss));
        let Some(change) = within(&jacobian, &missing, &room) else {
            return Err(without_effect(free[0]));
        };
        for (k, &i) in free.iter().enumerate() {
            let Output { min, max, .. } = outputs[i];
            let range = if (max - min).is_finite() { max - min } else { f64::INFINITY };
            values[i] = (values[i] + change[k].clamp(-most * range, most * range)).clamp(min, max);
        }
    }
    let missed = misses(simulation);
    let size = |i: &usize| missed[*i].miss.abs() / missed[*i].scale;
    let worst = (0..n).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(0);
    Err(RunError::NotSettled {
        iterations: MAX_ROUNDS,
        culprit: format!(
            "controller \"{}\" misses its balance by {:.3e}",
            name(worst),
            missed[worst].miss
        ),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn outputs_at_a_limit_leave_the_rest_to_the_others() {
        // 0.001 x + y = 1 and y = 0.5 want x = 500, which has room for 1: then y = 0.5 alone.
        let jacobian = DMatrix::from_row_slice(2, 2, &[1e-3, 1.0, 0.0, 1.0]);
        let missing = DVector::from_column_slice(&[1.0, 0.5]);
        let all = within(&jacobian, &missing, &[(-1e3, 1e3); 2]).unwrap();
        assert!((all - DVector::from_column_slice(&[500.0, 0.5])).norm() < 1e-9);
        // 2 x + y = 3, x + 2 y = 0 want x = 2, y = -1; with x at 1 the second has y = -0.5.
        let jacobian = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]);
        let missing = DVector::from_column_slice(&[3.0, 0.0]);
        let some = within(&jacobian, &missing, &[(-1.0, 1.0), (-2.0, 2.0)]).unwrap();
        assert!((some - DVector::from_column_slice(&[1.0, -0.5])).norm() < 1e-12);
    }
}
