//! Why a run cannot go on, with the names of the model.

use crate::diagnostic::Diagnostics;
use anergy_core::error::{FactorError, Legible, RecordError};
use thiserror::Error;

/// Why a run or a solve failed.
#[derive(Debug, Error)]
pub enum RunError {
    /// The model is wrong.
    #[error(transparent)]
    Model(#[from] Diagnostics),
    /// The hydraulics did not converge.
    #[error(
        "at {time}: the hydraulics did not converge in {iterations} iterations; worst are edge \
         \"{edge}\", which misses its law by {residual_pa:.3e} Pa, and node \"{node}\", which misses its \
         mass balance by {mass_residual_kg_s:.3e} kg/s"
    )]
    NotConverged {
        /// Simulated time.
        time: String,
        /// Iterations done.
        iterations: u32,
        /// Edge with the largest residual.
        edge: String,
        /// Its residual, Pa.
        residual_pa: f64,
        /// Node with the largest mass residual.
        node: String,
        /// Its residual, kg/s.
        mass_residual_kg_s: f64,
    },
    /// The given flows would need pressures that nothing holds.
    #[error(
        "at {time}: edge \"{edge}\" would need {:.3e} bar to pass {} kg/s; is it closed while flows are \
         imposed behind it?", .dp_pa / 1e5, Legible(*.m_flow_kg_s)
    )]
    Absurd {
        /// Simulated time.
        time: String,
        /// The edge.
        edge: String,
        /// Pressure difference, Pa.
        dp_pa: f64,
        /// Flow, kg/s.
        m_flow_kg_s: f64,
    },
    /// Imposed flows leave a part of the network with more water than can leave.
    #[error(
        "at {time}: {} kg/s more enter than can leave the part of the network around node \"{node}\": flows \
         are imposed on all its ends, or its circuit only has a pressure reference, which exchanges no water",
        Legible(*.m_flow_kg_s)
    )]
    Unbalanced {
        /// Simulated time.
        time: String,
        /// A node of the part.
        node: String,
        /// Surplus, kg/s.
        m_flow_kg_s: f64,
    },
    /// What is prescribed cannot be found by the actuator that is free for it.
    #[error("at {time}: edge \"{free}\", left free: {problem}")]
    Prescribed {
        /// Simulated time.
        time: String,
        /// The edge whose actuator is free.
        free: String,
        /// What is the matter.
        problem: &'static str,
    },
    /// A self-acting valve does not come to rest within a step.
    #[error(
        "at {time}: the self-acting valve \"{valve}\" finds no opening that fits the pressure it senses (it \
         misses one by {miss:.3e}); do several valves work against each other? A wider band calms them"
    )]
    Hunting {
        /// Simulated time.
        time: String,
        /// The valve.
        valve: String,
        /// Largest miss of an opening.
        miss: f64,
    },
    /// A component got or gave a number that is not finite.
    #[error("at {time}: {component} has a value that is not a finite number")]
    NotFinite {
        /// Simulated time.
        time: String,
        /// The component.
        component: String,
    },
    /// Temperatures left the validity of the medium.
    #[error(
        "at {time}: the water at \"{component}\" has {t_degc:.2} degC; {what} is valid from {min_degc} to {max_degc} degC"
    )]
    Temperature {
        /// Simulated time.
        time: String,
        /// Node, edge or unit concerned.
        component: String,
        /// Temperature, degC.
        t_degc: f64,
        /// The medium.
        what: &'static str,
        /// Its lowest temperature, degC.
        min_degc: f64,
        /// Its highest temperature, degC.
        max_degc: f64,
    },
    /// The run goes on after its weather.
    #[error("at {time}: the file of [weather] ends here")]
    WeatherEnds {
        /// Simulated time.
        time: String,
    },
    /// A linear system is singular.
    #[error("at {time}: {source}")]
    Singular {
        /// Simulated time.
        time: String,
        /// The reason.
        #[source]
        source: FactorError,
    },
    /// A circuit of a house in which nothing holds the temperature.
    #[error("at {time}: circuit \"{circuit}\": its units add heat, but none holds the temperature")]
    UndefinedCircuit {
        /// Simulated time.
        time: String,
        /// The circuit.
        circuit: String,
    },
    /// A controller failed.
    #[error("at {time}: controller \"{controller}\": {source}")]
    Control {
        /// Simulated time.
        time: String,
        /// The controller.
        controller: String,
        /// The reason.
        #[source]
        source: anergy_control::controller::ControlError,
    },
    /// A controller of the user gave a value that its signal cannot have.
    #[error(
        "at {time}: controller \"{controller}\" gives {signal} = {value}, which is outside {min} to {max}"
    )]
    UserOutput {
        /// Simulated time.
        time: String,
        /// The controller.
        controller: String,
        /// The signal.
        signal: String,
        /// What it gave.
        value: f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// The steady state was not found.
    #[error("the steady state was not found after {iterations} rounds: {culprit}")]
    NotSettled {
        /// Rounds done.
        iterations: u32,
        /// What still moves.
        culprit: String,
    },
    /// A name that the simulation does not know.
    #[error("there is no {what} \"{name}\"{hint}")]
    UnknownName {
        /// Signal or channel.
        what: &'static str,
        /// What was asked for.
        name: String,
        /// Similar names.
        hint: String,
    },
    /// A value that a signal cannot have.
    #[error("{signal} = {value} is outside {min} to {max}")]
    OutOfRange {
        /// The signal.
        signal: String,
        /// What was asked for.
        value: f64,
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
    },
    /// A snapshot of another model, or torn.
    #[error("this snapshot does not fit the model: {problem}")]
    Snapshot {
        /// What does not fit.
        problem: String,
    },
    /// The results could not be kept.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl RunError {
    /// Whether the numerics failed (and not the model or the disk).
    pub fn is_numerical(&self) -> bool {
        matches!(
            self,
            Self::NotConverged { .. }
                | Self::Singular { .. }
                | Self::NotSettled { .. }
                | Self::Hunting { .. }
        )
    }
}
