//! `anergy.Simulation`: a simulation that Python steps.

use crate::convert;
use crate::errors::{self, Origin};
use crate::result::events;
use crate::run::SignalWatch;
use crate::snapshot::Snapshot;
use anergy_core::clock::Time;
use anergy_core::ids::{ChannelId, SignalId};
use anergy_core::recorder::Event;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::error::RunError;
use anergy_simulation::model_file::StepEntry;
use anergy_simulation::plan::Plan;
use anergy_simulation::simulation;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::sync::Arc;

/// A name of a simulation, looked up once: `get` and `set` with it are faster.
///
/// Made by `Simulation.handle`.
#[pyclass(module = "anergy", frozen)]
pub struct Handle {
    name: String,
    /// The name of the channel: that of a signal has `_command` appended.
    channel_name: String,
    channel: ChannelId,
    signal: Option<SignalId>,
}

#[pymethods]
impl Handle {
    /// What it stands for.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    fn __repr__(&self) -> String {
        format!("<anergy.Handle \"{}\">", self.name)
    }
}

/// A handle or a name.
#[derive(FromPyObject)]
enum Name<'py> {
    Handle(Bound<'py, Handle>),
    Text(String),
}

/// A simulation stepped from outside, made by `Model.simulation`.
///
/// Examples
/// --------
/// >>> import anergy
/// >>> sim = anergy.examples.load("three-houses").simulation(step_s=1.0)
/// >>> before = sim.get("sf1.station.m_flow_kg_s")
/// >>> sim.set("sf2.feed_in_pump.speed", 0.85)
/// >>> sim.step(60)
/// >>> sim.time_s
/// 60.0
/// >>> sim.get("sf1.station.m_flow_kg_s") > 2 * before
/// True
#[pyclass(module = "anergy")]
pub struct Simulation {
    simulation: simulation::Simulation,
    step: Step,
}

impl Simulation {
    pub fn new(py: Python<'_>, plan: Arc<Plan>, step: Option<StepEntry>) -> PyResult<Self> {
        let step = plan.step_of(step);
        match py.detach(|| simulation::Simulation::new(plan)) {
            Ok(simulation) => Ok(Self { simulation, step }),
            Err(error) => Err(failure(py, &error)),
        }
    }

    /// Advances from one multiple of the step to the next, looking for Ctrl-C.
    fn advance_to(&mut self, py: Python<'_>, target: Time) -> PyResult<()> {
        let mut watch = SignalWatch::new();
        let step = self.step;
        let simulation = &mut self.simulation;
        let outcome = py.detach(|| {
            while simulation.time() < target && watch.go_on() {
                match step {
                    Step::Fixed(largest) => {
                        let end = target.min(simulation.time().next_multiple(largest));
                        simulation.advance_to(end, step)?;
                    }
                    Step::Automatic(_) => simulation.advance_once(target, &step)?,
                }
            }
            Ok(())
        });
        match (outcome, watch.into_raised()) {
            (Err(error), _) => Err(failure(py, &error)),
            (Ok(()), Some(raised)) => Err(raised),
            (Ok(()), None) => Ok(()),
        }
    }

    /// Does automatic steps, looking for Ctrl-C.
    fn automatic_steps(&mut self, py: Python<'_>, n: u32) -> PyResult<()> {
        let mut watch = SignalWatch::new();
        let step = self.step;
        let simulation = &mut self.simulation;
        let outcome = py.detach(|| {
            let mut left = n;
            while left > 0 && watch.go_on() {
                simulation.advance_once(Time::NEVER, &step)?;
                left -= 1;
            }
            Ok(())
        });
        match (outcome, watch.into_raised()) {
            (Err(error), _) => Err(failure(py, &error)),
            (Ok(()), Some(raised)) => Err(raised),
            (Ok(()), None) => Ok(()),
        }
    }

    /// A channel, or a signal by the channel of its command.
    fn find_channel(&self, name: &str) -> Option<(String, ChannelId)> {
        let command = || format!("{name}_command");
        let found = self.simulation.channel(name).map(|id| (name.to_owned(), id));
        found.or_else(|_| self.simulation.channel(&command()).map(|id| (command(), id))).ok()
    }

    fn channel(&self, name: &Name<'_>) -> PyResult<ChannelId> {
        let text = match name {
            Name::Text(text) => text.as_str(),
            Name::Handle(handle) => {
                let handle = handle.get();
                let channels = self.simulation.plan().channels();
                let own = channels.get(handle.channel.index());
                if own.is_some_and(|channel| channel.name == handle.channel_name) {
                    return Ok(handle.channel);
                }
                handle.name.as_str()
            }
        };
        let unknown = || errors::unknown("channel or signal", text, self.names());
        self.find_channel(text).map(|(_, id)| id).ok_or_else(unknown)
    }

    fn signal(&self, name: &Name<'_>) -> PyResult<SignalId> {
        let specs = self.simulation.plan().signals().specs();
        let text = match name {
            Name::Text(text) => text.as_str(),
            Name::Handle(handle) => {
                let handle = handle.get();
                if let Some(id) = handle.signal
                    && specs.get(id.index()).is_some_and(|spec| spec.name == handle.name)
                {
                    return Ok(id);
                }
                handle.name.as_str()
            }
        };
        let names = specs.iter().map(|spec| spec.name.as_str());
        let found = self.simulation.plan().signals().find(text);
        found.ok_or_else(|| errors::unknown("signal", text, names))
    }

    fn names(&self) -> impl Iterator<Item = &str> {
        let plan = self.simulation.plan();
        let channels = plan.channels().iter().map(|channel| channel.name.as_str());
        channels.chain(plan.signals().specs().iter().map(|spec| spec.name.as_str()))
    }
}

#[pymethods]
impl Simulation {
    /// Simulated time, s since the start.
    #[getter]
    fn time_s(&self) -> f64 {
        self.simulation.time().as_s()
    }

    /// What one `step()` advances, s; None where that is an automatic step.
    #[getter]
    fn step_s(&self) -> Option<f64> {
        match self.step {
            Step::Fixed(step) => Some(step.as_s()),
            Step::Automatic(_) => None,
        }
    }

    /// Names of what `get` reads, `component.quantity_unit` (list of str).
    #[getter]
    fn channels(&self) -> Vec<&str> {
        self.simulation.plan().channels().iter().map(|channel| channel.name.as_str()).collect()
    }

    /// Names of what `set` drives: commands, set points, boundary values (list of str).
    #[getter]
    fn signals(&self) -> Vec<&str> {
        self.simulation.plan().signals().specs().iter().map(|spec| spec.name.as_str()).collect()
    }

    /// Smallest and largest value that a signal takes, in its SI unit.
    ///
    /// Parameters
    /// ----------
    /// name : str or Handle
    ///     One of `signals`.
    ///
    /// Returns
    /// -------
    /// tuple of float
    ///     Infinite where there is no limit.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn limits(&self, name: Name<'_>) -> PyResult<(f64, f64)> {
        let spec = self.simulation.plan().signals().spec(self.signal(&name)?);
        Ok((spec.min, spec.max))
    }

    /// Looks up a channel or signal once, for `get` and `set` in a loop.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn handle(&self, name: String) -> PyResult<Handle> {
        let Some((channel_name, channel)) = self.find_channel(&name) else {
            return Err(errors::unknown("channel or signal", &name, self.names()));
        };
        let signal = self.simulation.plan().signals().find(&name);
        Ok(Handle { name, channel_name, channel, signal })
    }

    /// The present value of a channel, in the SI unit that its name ends with.
    ///
    /// Parameters
    /// ----------
    /// name : str or Handle
    ///     One of `channels`; or one of `signals`, which gives its command.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn get(&self, name: Name<'_>) -> PyResult<f64> {
        Ok(self.simulation.get(self.channel(&name)?))
    }

    /// Sets an input signal and takes it over from schedules and controllers.
    ///
    /// It holds until set again or released, and acts in the next step.
    ///
    /// Parameters
    /// ----------
    /// name : str or Handle
    ///     One of `signals`.
    /// value : float
    ///     In SI.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    /// OutOfRangeError
    ///     A ValueError, for a value outside the limits of the signal.
    fn set(&mut self, py: Python<'_>, name: Name<'_>, value: f64) -> PyResult<()> {
        let id = self.signal(&name)?;
        self.simulation.set(id, value).map_err(|error| failure(py, &error))
    }

    /// Gives a signal back to its schedule or controller; without one it keeps its value.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn release(&mut self, name: Name<'_>) -> PyResult<()> {
        let id = self.signal(&name)?;
        self.simulation.release(id);
        Ok(())
    }

    /// Advances by `n` times `step_s`, or `n` automatic steps; other Python threads run meanwhile.
    ///
    /// Raises
    /// ------
    /// RunError
    ///     When a step fails (ConvergenceError: its numerics).
    /// KeyboardInterrupt
    ///     After Ctrl-C; the simulation stays at the last complete step.
    #[pyo3(signature = (n=1))]
    fn step(&mut self, py: Python<'_>, n: u32) -> PyResult<()> {
        match self.step {
            Step::Fixed(step) => {
                let span = Time(step.0.saturating_mul(i64::from(n)));
                self.advance_to(py, self.simulation.time() + span)
            }
            Step::Automatic(_) => self.automatic_steps(py, n),
        }
    }

    /// Advances to a time; other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// until_s : float
    ///     s since the start, not before `time_s`.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a time in the past.
    /// RunError, KeyboardInterrupt
    ///     As `step`.
    fn advance(&mut self, py: Python<'_>, until_s: f64) -> PyResult<()> {
        let target = convert::time("until_s", until_s)?;
        if target < self.simulation.time() {
            let now = self.time_s();
            let message =
                format!("until_s = {until_s} is in the past: the simulation is at {now} s");
            return Err(PyValueError::new_err(message));
        }
        self.advance_to(py, target)
    }

    /// Back to the start of the run.
    ///
    /// Raises
    /// ------
    /// RunError
    ///     When the state at the start cannot be solved.
    fn reset(&mut self, py: Python<'_>) -> PyResult<()> {
        let simulation = &mut self.simulation;
        py.detach(|| simulation.reset()).map_err(|error| failure(py, &error))
    }

    /// Takes what happened since the last call: list of dicts, as `Result.events`.
    fn take_events<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let taken: Vec<Event> = self.simulation.take_events().collect();
        events(py, taken.iter())
    }

    /// The present state, to be restored later.
    fn snapshot(&self) -> Snapshot {
        Snapshot { time: self.simulation.time(), state: self.simulation.snapshot() }
    }

    /// Continues from a snapshot, bit for bit.
    ///
    /// Raises
    /// ------
    /// SnapshotError
    ///     A ValueError, when the snapshot is of another model.
    fn restore(&mut self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        self.simulation.restore(&snapshot.state).map_err(|error| failure(py, &error))
    }

    fn __repr__(&self) -> String {
        format!("<anergy.Simulation at {} s, step {}>", self.time_s(), self.step)
    }
}

/// A failed step; the model was found right when the simulation was made.
fn failure(py: Python<'_>, error: &RunError) -> PyErr {
    errors::run_error(py, error, "", &Origin::Dict)
}
