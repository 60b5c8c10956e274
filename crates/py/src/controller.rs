//! Controllers written in Python: `anergy.Controller` as a [`UserController`].
//!
//! Between two updates no lock of the interpreter is held.

use crate::errors;
use crate::handle;
use anergy_control::controller::{ControlError, Timing};
use anergy_control::user_controller::UserController;
use anergy_core::ids::{ChannelId, SignalId};
use anergy_simulation::error::RunError;
use anergy_simulation::simulation::Simulation;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyList, PyString};
use std::sync::{Arc, Mutex};

/// What Python raised in a controller; the error of the simulation says only that it failed.
#[derive(Clone, Default)]
pub struct Raised(Arc<Mutex<Option<PyErr>>>);

impl Raised {
    fn keep(&self, error: PyErr) -> ControlError {
        let problem = "raised an exception".to_owned();
        if let Ok(mut kept) = self.0.lock() {
            *kept = Some(error);
        }
        ControlError::User { problem }
    }

    /// The exception of the user, with a note of where it came from; `None` where none was raised.
    pub fn take(&self, py: Python<'_>, error: &RunError) -> Option<PyErr> {
        let raised = self.0.lock().ok()?.take()?;
        if let RunError::Control { time, controller, .. } = error {
            let mut note = format!("raised by the controller \"{controller}\" at {time}");
            if raised.value(py).to_string() == "Already mutably borrowed" {
                note += "; within a step it cannot ask its simulation: what it needs belongs into `measures`";
            }
            // From Python 3.11 on.
            let _ = raised.value(py).call_method1("add_note", (note,));
        }
        Some(raised)
    }
}

/// What a controller is in Python; its simulation and the simulation's owner share it, so that the collector
/// of cycles sees every reference once.
struct Parts {
    object: Py<PyAny>,
    update: Py<PyAny>,
    /// Filled again for each update.
    measured: Py<PyArray1<f64>>,
}

/// The controllers of a simulation, and what one of them raised.
#[derive(Default)]
pub struct Controllers {
    attached: Vec<(String, Arc<Parts>)>,
    /// What was raised in a step.
    pub raised: Raised,
}

/// A Python object as a controller.
struct PyController {
    name: String,
    parts: Arc<Parts>,
    timing: Timing,
    raised: Raised,
}

impl PyController {
    fn call(
        &self,
        py: Python<'_>,
        time_s: f64,
        measured: &[f64],
        outputs: &mut [f64],
    ) -> PyResult<()> {
        let buffer = self.parts.measured.bind(py);
        {
            let mut values = buffer.try_readwrite().map_err(|_| {
                self.wrong("must leave the array of measured values writeable".into())
            })?;
            values.as_slice_mut()?.copy_from_slice(measured);
        }
        let given = self.parts.update.bind(py).call1((time_s, buffer))?;
        self.read(&given, outputs)
    }

    /// What `update` returned, into the outputs.
    fn read(&self, given: &Bound<'_, PyAny>, outputs: &mut [f64]) -> PyResult<()> {
        let n = outputs.len();
        let count = |found: usize| {
            let message = format!("update returned {found} values for {n} signals of acts_on");
            if found == n { Ok(()) } else { Err(self.wrong(message)) }
        };
        if let Ok(value) = given.cast::<PyFloat>() {
            count(1)?;
            outputs[0] = value.value();
        } else if given.is_none() {
            // The values stay.
        } else if let Ok(array) = given.cast::<PyArray1<f64>>()
            && let Ok(values) = array.try_readonly()
        {
            count(values.as_array().len())?;
            outputs.iter_mut().zip(values.as_array()).for_each(|(output, value)| *output = *value);
        } else if let Ok(value) = given.extract::<f64>() {
            count(1)?;
            outputs[0] = value;
        } else {
            let values: Vec<f64> = given.extract().map_err(|_| {
                let kind = given.get_type();
                let message = format!("update returned {kind}, not a number or a sequence of them");
                PyTypeError::new_err(format!("controller \"{}\": {message}", self.name))
            })?;
            count(values.len())?;
            outputs.copy_from_slice(&values);
        }
        Ok(())
    }

    fn wrong(&self, problem: String) -> PyErr {
        PyValueError::new_err(format!("controller \"{}\": {problem}", self.name))
    }
}

impl UserController for PyController {
    fn timing(&self) -> Timing {
        self.timing
    }

    fn start(&mut self) -> Result<(), ControlError> {
        Python::attach(|py| {
            let started = self.parts.object.bind(py).call_method0("start");
            started.map(drop).map_err(|error| self.raised.keep(error))
        })
    }

    fn update(
        &mut self,
        time_s: f64,
        measured: &[f64],
        outputs: &mut [f64],
    ) -> Result<(), ControlError> {
        Python::attach(|py| {
            let done = self.call(py, time_s, measured, outputs);
            done.map_err(|error| self.raised.keep(error))
        })
    }
}

/// The names in an attribute: one, or a sequence.
fn names(object: &Bound<'_, PyAny>, attribute: &str) -> PyResult<Vec<String>> {
    let value = object.getattr(attribute)?;
    if let Ok(one) = value.cast::<PyString>() {
        return Ok(vec![one.to_string()]);
    }
    value.extract().map_err(|_| {
        let kind = object.get_type();
        PyTypeError::new_err(format!("{attribute} of {kind} must be a sequence of names (str)"))
    })
}

impl Controllers {
    /// Adds controllers to a simulation, in their order.
    pub fn attach(
        py: Python<'_>,
        simulation: &mut Simulation,
        controllers: Option<Vec<Bound<'_, PyAny>>>,
    ) -> PyResult<Self> {
        let mut all = Self::default();
        for object in controllers.unwrap_or_default() {
            all.add(py, simulation, &object)?;
        }
        Ok(all)
    }

    fn add(
        &mut self,
        py: Python<'_>,
        simulation: &mut Simulation,
        object: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let base = py.import("anergy.controller")?.getattr("Controller")?;
        if !object.is_instance(&base)? {
            let kind = object.get_type();
            let message = format!("a controller must be an anergy.Controller, not {kind}");
            return Err(PyTypeError::new_err(message));
        }
        let (measures, acts_on) = (names(object, "measures")?, names(object, "acts_on")?);
        let mut name: String = object.getattr("name")?.extract()?;
        if name.is_empty() {
            name = format!("{}({})", object.get_type().name()?, acts_on.join(", "));
        }
        let plan = simulation.plan().clone();
        let who = format!("controller \"{name}\": ");
        let channels: Vec<ChannelId> = measures
            .iter()
            .map(|measured| {
                let found = handle::find_channel(simulation, measured).map(|(_, id)| id);
                let known = || handle::names(&plan);
                found
                    .ok_or_else(|| errors::unknown_to(&who, "channel or signal", measured, known()))
            })
            .collect::<PyResult<_>>()?;
        let signals: Vec<SignalId> = acts_on
            .iter()
            .map(|signal| {
                let known = || handle::signal_names(&plan);
                let found = plan.signals().find(signal);
                found.ok_or_else(|| errors::unknown_to(&who, "signal", signal, known()))
            })
            .collect::<PyResult<_>>()?;
        let limits: Vec<Vec<f64>> = signals
            .iter()
            .map(|id| plan.signals().spec(*id))
            .map(|spec| vec![spec.min, spec.max])
            .collect();
        if !limits.is_empty() {
            object.setattr("limits", PyArray2::from_vec2(py, &limits)?)?;
        }
        let seconds = |attribute: &str| object.getattr(attribute)?.extract::<f64>();
        let timing = Timing { interval_s: seconds("interval_s")?, offset_s: seconds("offset_s")? };
        let parts = Arc::new(Parts {
            object: object.clone().unbind(),
            update: object.getattr("update")?.unbind(),
            measured: PyArray1::zeros(py, channels.len(), false).unbind(),
        });
        let raised = self.raised.clone();
        let controller =
            PyController { name: name.clone(), parts: Arc::clone(&parts), timing, raised };
        let added = simulation.add_controller(&name, Box::new(controller), &channels, &signals);
        added.map_err(|error| match (self.raised.take(py, &error), &error) {
            (Some(raised), _) => raised,
            // What is said of its attributes.
            (None, RunError::Control { source, .. }) => {
                PyValueError::new_err(format!("{who}{source}"))
            }
            (None, _) => PyValueError::new_err(error.to_string()),
        })?;
        self.attached.push((name, parts));
        Ok(())
    }

    /// Shows the collector of cycles what they refer to.
    pub fn traverse(&self, visit: &PyVisit<'_>) -> Result<(), PyTraverseError> {
        for (_, parts) in &self.attached {
            visit.call(&parts.object)?;
            visit.call(&parts.update)?;
            visit.call(&parts.measured)?;
        }
        Ok(())
    }

    /// What they remember, pickled; `None` without controllers.
    pub fn state(&self, py: Python<'_>) -> PyResult<Option<Vec<u8>>> {
        if self.attached.is_empty() {
            return Ok(None);
        }
        let states = PyList::empty(py);
        for (name, parts) in &self.attached {
            let object = parts.object.bind(py);
            for method in ["get_state", "set_state"] {
                if !object.hasattr(method)? {
                    return Err(errors::SnapshotError::new_err(format!(
                        "controller \"{name}\" has no {method}: what it remembers would be lost"
                    )));
                }
            }
            states.append(object.call_method0("get_state")?)?;
        }
        let bytes = py.import("pickle")?.call_method1("dumps", (states,))?;
        Ok(Some(bytes.cast_into::<PyBytes>()?.as_bytes().to_vec()))
    }

    /// Gives them back what they remembered.
    pub fn restore(&self, py: Python<'_>, state: Option<&[u8]>) -> PyResult<()> {
        let Some(state) = state else { return Ok(()) };
        let states = py.import("pickle")?.call_method1("loads", (PyBytes::new(py, state),))?;
        for ((_, parts), state) in self.attached.iter().zip(states.try_iter()?) {
            parts.object.bind(py).call_method1("set_state", (state?,))?;
        }
        Ok(())
    }
}
