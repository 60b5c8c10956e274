//! Gains between signals and channels at the present state, from the factorised network: what an outer
//! iteration on actuators and the analysis of loops both need.
//!
//! **Assumptions** water only: temperatures stay as they are. Channels that follow temperatures, and
//! signals that reach the network through them, have no gain here ([`None`]).

use crate::channels::Source;
use crate::plan::Plan;
use crate::state::State;
use anergy_core::ids::{EdgeId, NodeId, SignalId};
use anergy_network::elements::Element;
use anergy_network::hydraulics::HydraulicError;
use anergy_network::hydraulics::linearize::{Cause, Linearization, Response, Valves};
use anergy_network::state::RISE_TO_LAG;

/// Change of a command for its difference quotient, relative to what it can be.
const DIFFERENCE: f64 = 1e-6;

/// What one unit of a signal does once actuators have followed.
#[derive(Debug, Clone)]
pub(crate) struct Reach {
    /// Causes with their share, settled.
    causes: Vec<(Cause, f64)>,
    /// Edges whose position it is, with the share.
    positions: Vec<(usize, f64)>,
    /// Time constant of each of the two lags of the actuator, s.
    pub lag_s: f64,
}

/// The signals and channels of some loops on a linearised network.
pub(crate) struct Gains {
    linearization: Linearization,
    response: Response,
}

impl Gains {
    /// Linearises the network at the state.
    ///
    /// # Errors
    /// As [`Linearization::new`].
    pub fn new(plan: &Plan, state: &State, valves: Valves) -> Result<Self, HydraulicError> {
        Ok(Self {
            linearization: Linearization::with_valves(&plan.network, &state.network, valves)?,
            response: Response::new(&plan.network),
        })
    }

    /// Gains of channels over a signal; `None` for each that follows temperatures.
    pub fn column(
        &mut self,
        plan: &Plan,
        state: &State,
        reach: &Reach,
        of: &[Source],
    ) -> Vec<Option<f64>> {
        let mut sums = vec![Some(0.0); of.len()];
        self.each_answer(plan, reach, |share, response| {
            for (sum, source) in sums.iter_mut().zip(of) {
                let gain = channel_gain(plan, state, *source, response);
                *sum = sum.zip(gain).map(|(sum, gain)| sum + share * gain);
            }
        });
        for (sum, source) in sums.iter_mut().zip(of) {
            if let Some(own) = position_gain(plan, *source, &reach.positions) {
                *sum = Some(own);
            }
        }
        sums
    }

    /// The answers to each cause of a signal, with its share.
    pub fn each_answer(
        &mut self,
        plan: &Plan,
        reach: &Reach,
        mut take: impl FnMut(f64, &Response),
    ) {
        for (cause, share) in &reach.causes {
            self.linearization.respond(&plan.network, *cause, &mut self.response);
            take(*share, &self.response);
        }
    }

    /// Whether something in the network follows by itself.
    pub fn follows(&self) -> bool {
        self.linearization.follows()
    }

    /// Asks for the answer to 1 Pa of head in an edge.
    pub fn push(&mut self, plan: &Plan, edge: EdgeId) {
        self.linearization.respond(&plan.network, Cause::Head(edge), &mut self.response);
    }

    /// Change of the flow of an edge in the last answer, kg/s.
    pub fn flow(&self, edge: usize) -> f64 {
        self.response.m_flow_kg_s[edge]
    }

    /// Change of a channel in the last answer, while no actuator moves; `None` where it follows temperatures.
    pub fn value(&self, plan: &Plan, state: &State, of: Source) -> Option<f64> {
        position_gain(plan, of, &[]).or_else(|| channel_gain(plan, state, of, &self.response))
    }
}

/// What a signal does to the network; `None` where it acts through temperatures or another controller.
pub(crate) fn reach(plan: &Plan, state: &State, signal: SignalId) -> Option<Reach> {
    let mut reach = Reach { causes: Vec::new(), positions: Vec::new(), lag_s: 0.0 };
    for (edge, command) in plan.commands.iter().enumerate() {
        if *command != Some(signal) {
            continue;
        }
        let element = &plan.network.edges[edge].element;
        let Some(actuator) = element.actuator() else { continue };
        reach.lag_s = RISE_TO_LAG * actuator.rise_time_s;
        let command = state.signals[signal.index()];
        let step = DIFFERENCE * if actuator.max.is_finite() { actuator.max } else { 1.0 };
        let at = |command| element.target_at_flow(command, state.network.m_flow_kg_s[edge]);
        let share = (at(command + step) - at(command - step)) / (2.0 * step);
        reach.causes.push((Cause::Position(EdgeId::from_index(edge)), share));
        reach.positions.push((edge, share));
    }
    for inputs in &plan.node_inputs {
        let node = NodeId::from_index(inputs.node);
        if inputs.p_pa == Some(signal) {
            reach.causes.push((Cause::NodePressure(node), 1.0));
        }
        if inputs.m_flow_kg_s == Some(signal) {
            reach.causes.push((Cause::NodeInflow(node), 1.0));
        }
    }
    for (k, prescription) in plan.prescriptions.iter().enumerate() {
        if prescription.signal == signal {
            reach.causes.push((Cause::Prescribed(k), 1.0));
        }
    }
    for (k, regulator) in plan.regulators.iter().enumerate() {
        if *regulator == signal {
            reach.causes.push((Cause::Regulator(k), 1.0));
        }
    }
    (!reach.causes.is_empty()).then_some(reach)
}

fn position_gain(plan: &Plan, source: Source, positions: &[(usize, f64)]) -> Option<f64> {
    let speed = |edge: usize| matches!(&plan.network.edges[edge].element, Element::Pump(pump) if !pump.holds());
    let edge = match source {
        Source::PumpSpeed(edge) if speed(edge) => edge,
        Source::EdgePosition(edge) => edge,
        _ => return None,
    };
    Some(positions.iter().filter(|(own, _)| *own == edge).map(|(_, share)| share).sum())
}

fn channel_gain(plan: &Plan, state: &State, source: Source, response: &Response) -> Option<f64> {
    let edge_dp = |edge: usize| response.dp_pa(&plan.network, EdgeId::from_index(edge));
    match source {
        Source::NodePressure(node) => Some(response.p_pa[node]),
        Source::EdgeFlow(edge) => Some(response.m_flow_kg_s[edge]),
        Source::EdgePressure(edge) => Some(edge_dp(edge)),
        Source::StationFlow(i) => Some(response.m_flow_kg_s[plan.stations[i].edge.index()]),
        Source::WorstPoint(i) => {
            let p = &state.network.p_pa;
            let pairs = plan.worst_points[i].between.iter();
            let worst = pairs.min_by(|x, y| (p[x.0] - p[x.1]).total_cmp(&(p[y.0] - p[y.1])))?;
            Some(response.p_pa[worst.0] - response.p_pa[worst.1])
        }
        Source::EdgePosition(_) | Source::StationRequest(_) | Source::Signal(_) => Some(0.0),
        _ => None,
    }
}

/// What a sensor measures, and what it subtracts; any other channel is itself.
pub(crate) fn measured(plan: &Plan, source: Source) -> (Source, Option<Source>) {
    match source {
        Source::Sensor(i) => (plan.sensors[i].measures, plan.sensors[i].minus),
        other => (other, None),
    }
}
