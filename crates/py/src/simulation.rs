//! `anergy.Simulation`: a simulation that Python steps.

use crate::controller::Controllers;
use crate::convert;
use crate::errors::{self, Origin};
use crate::handle::{Handle, Handles, Name};
use crate::result::events;
use crate::run::SignalWatch;
use crate::snapshot::Snapshot;
use anergy_core::clock::Time;
use anergy_core::recorder::Event;
use anergy_simulation::automatic_step::Step;
use anergy_simulation::error::RunError;
use anergy_simulation::model_file::StepEntry;
use anergy_simulation::plan::Plan;
use anergy_simulation::simulation;
use numpy::PyArray1;
use pyo3::exceptions::{PyTypeError, PyUserWarning, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList, PyTuple};
use std::ffi::CString;
use std::sync::Arc;

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
    controllers: Controllers,
}

impl Simulation {
    pub fn new(
        py: Python<'_>,
        plan: Arc<Plan>,
        step: Option<StepEntry>,
        controllers: Option<Vec<Bound<'_, PyAny>>>,
    ) -> PyResult<Self> {
        let step = plan.step_of(step);
        let mut simulation = py
            .detach(|| simulation::Simulation::new(plan))
            .map_err(|error| errors::run_error(py, &error, "", &Origin::Dict))?;
        let controllers = Controllers::attach(py, &mut simulation, controllers)?;
        // A run records it; here nobody would see it before the results swing.
        for event in simulation.coarse_steps(step) {
            let message = CString::new(event.message)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
        }
        Ok(Self { simulation, step, controllers })
    }

    /// A failed step, or what a controller raised; the model was found right when the simulation was made.
    fn failure(&self, py: Python<'_>, error: &RunError) -> PyErr {
        let raised = self.controllers.raised.take(py, error);
        raised.unwrap_or_else(|| errors::run_error(py, error, "", &Origin::Dict))
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
            (Err(error), _) => Err(self.failure(py, &error)),
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
            (Err(error), _) => Err(self.failure(py, &error)),
            (Ok(()), Some(raised)) => Err(raised),
            (Ok(()), None) => Ok(()),
        }
    }
}

#[pymethods]
impl Simulation {
    /// Refuses: a model makes it.
    #[new]
    #[pyo3(signature = (*_args, **_fields))]
    fn refuse(_args: &Bound<'_, PyTuple>, _fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Err(PyTypeError::new_err(
            "a Simulation comes from model.simulation(); model.simulate() runs at once and gives a Result",
        ))
    }

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
    fn limits(&self, name: &Bound<'_, PyAny>) -> PyResult<(f64, f64)> {
        let id = Name::of(name)?.signal(&self.simulation)?;
        let spec = self.simulation.plan().signals().spec(id);
        Ok((spec.min, spec.max))
    }

    /// Looks up a channel or signal once, for `get` and `set` in a loop.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn handle(&self, name: String) -> PyResult<Handle> {
        Handle::find(&self.simulation, name)
    }

    /// Looks up several channels or signals once: `get` and `set` then move an array.
    ///
    /// Parameters
    /// ----------
    /// names : sequence of str
    ///     In the order that the values are to have.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    ///
    /// Examples
    /// --------
    /// >>> import anergy, numpy
    /// >>> sim = anergy.examples.load("three-houses").simulation(step_s=1.0)
    /// >>> speeds = sim.handles(["sf1.feed_in_pump.speed", "sf2.feed_in_pump.speed"])
    /// >>> sim.set(speeds, [0.9, 0.8])
    /// >>> sim.step(60)
    /// >>> values = sim.get(speeds)
    /// >>> values.tolist(), sim.get(speeds, out=values) is values
    /// ([0.9, 0.8], True)
    fn handles(&self, names: Vec<String>) -> PyResult<Handles> {
        Handles::find(&self.simulation, names)
    }

    /// The present value of a channel, in the SI unit that its name ends with.
    ///
    /// Parameters
    /// ----------
    /// name : str, Handle or Handles
    ///     One of `channels`; or one of `signals`, which gives its command.
    /// out : numpy.ndarray, optional
    ///     Where the values of `Handles` are written: float64, contiguous; it is returned.
    ///
    /// Returns
    /// -------
    /// float, or numpy.ndarray for Handles
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    #[pyo3(signature = (name, out=None))]
    fn get<'py>(
        &self,
        py: Python<'py>,
        name: &Bound<'py, PyAny>,
        out: Option<Bound<'py, PyArray1<f64>>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if let Ok(handles) = name.cast::<Handles>() {
            return Ok(handles.get().get(py, &self.simulation, out)?.into_any());
        }
        if out.is_some() {
            return Err(PyTypeError::new_err("out is for Handles: one value is returned"));
        }
        let value = self.simulation.get(Name::of(name)?.channel(&self.simulation)?);
        Ok(PyFloat::new(py, value).into_any())
    }

    /// Sets an input signal and takes it over from schedules and controllers.
    ///
    /// It holds until set again or released, and acts in the next step.
    ///
    /// Parameters
    /// ----------
    /// name : str, Handle or Handles
    ///     One of `signals`, or several.
    /// value : float, or array_like for Handles
    ///     In SI. Of several, all are set or, when one is out of range, none.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    /// OutOfRangeError
    ///     A ValueError, for a value outside the limits of the signal.
    fn set(
        &mut self,
        py: Python<'_>,
        name: &Bound<'_, PyAny>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let done = match name.cast::<Handles>() {
            Ok(handles) => handles.get().set(&mut self.simulation, value)?,
            Err(_) => {
                let id = Name::of(name)?.signal(&self.simulation)?;
                self.simulation.set(id, value.extract()?)
            }
        };
        done.map_err(|error| self.failure(py, &error))
    }

    /// Gives a signal back to its schedule or controller; without one it keeps its value.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn release(&mut self, name: &Bound<'_, PyAny>) -> PyResult<()> {
        let id = Name::of(name)?.signal(&self.simulation)?;
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

    /// Back to the start of the run; `start` of added controllers is called.
    ///
    /// Raises
    /// ------
    /// RunError
    ///     When the state at the start cannot be solved.
    fn reset(&mut self, py: Python<'_>) -> PyResult<()> {
        let simulation = &mut self.simulation;
        let done = py.detach(|| simulation.reset());
        done.map_err(|error| self.failure(py, &error))
    }

    /// Takes what happened since the last call: list of dicts, as `Result.events`.
    fn take_events<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let taken: Vec<Event> = self.simulation.take_events().collect();
        events(py, taken.iter())
    }

    /// The present state, to be restored later, with what added controllers remember.
    ///
    /// Raises
    /// ------
    /// SnapshotError
    ///     When an added controller has no `get_state` and `set_state`.
    fn snapshot(&self, py: Python<'_>) -> PyResult<Snapshot> {
        let (time, state) = (self.simulation.time(), self.simulation.snapshot());
        Ok(Snapshot { time, state, controllers: self.controllers.state(py)? })
    }

    /// Continues from a snapshot, bit for bit.
    ///
    /// Raises
    /// ------
    /// SnapshotError
    ///     A ValueError, when the snapshot is of another model or of other controllers.
    fn restore(&mut self, py: Python<'_>, snapshot: &Snapshot) -> PyResult<()> {
        let done = self.simulation.restore(&snapshot.state);
        done.map_err(|error| self.failure(py, &error))?;
        self.controllers.restore(py, snapshot.controllers.as_deref())
    }

    /// A controller may hold its simulation: such a cycle is collected.
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.controllers.traverse(&visit)
    }

    fn __repr__(&self) -> String {
        format!("<anergy.Simulation at {} s, step {}>", self.time_s(), self.step)
    }
}
