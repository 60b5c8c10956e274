//! Names of a simulation, and names that were looked up once.

use crate::errors;
use anergy_core::ids::{ChannelId, SignalId};
use anergy_simulation::plan::Plan;
use anergy_simulation::simulation::Simulation;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use std::collections::HashMap;
use std::sync::Arc;

/// A channel, or a signal by the channel of its command.
pub fn find_channel(simulation: &Simulation, name: &str) -> Option<(String, ChannelId)> {
    let command = || format!("{name}_command");
    let found = simulation.channel(name).map(|id| (name.to_owned(), id));
    found.or_else(|_| simulation.channel(&command()).map(|id| (command(), id))).ok()
}

/// Names of all channels and signals.
pub fn names(plan: &Plan) -> impl Iterator<Item = &str> {
    let channels = plan.channels().iter().map(|channel| channel.name.as_str());
    channels.chain(signal_names(plan))
}

/// Names of all signals.
pub fn signal_names(plan: &Plan) -> impl Iterator<Item = &str> {
    plan.signals().specs().iter().map(|spec| spec.name.as_str())
}

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

impl Handle {
    /// Looks a name up.
    pub fn find(simulation: &Simulation, name: String) -> PyResult<Self> {
        let plan = simulation.plan();
        let Some((channel_name, channel)) = find_channel(simulation, &name) else {
            return Err(errors::unknown("channel or signal", &name, names(plan)));
        };
        let signal = plan.signals().find(&name);
        Ok(Self { name, channel_name, channel, signal })
    }
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

/// Several names of a simulation, looked up once: `get` and `set` with them move a whole array.
///
/// Made by `Simulation.handles`.
#[pyclass(module = "anergy", frozen)]
pub struct Handles {
    handles: Vec<Handle>,
    plan: Arc<Plan>,
}

impl Handles {
    /// Looks names up.
    pub fn find(simulation: &Simulation, names: Vec<String>) -> PyResult<Self> {
        let plan = simulation.plan();
        let channels = plan.channels().iter().enumerate().rev();
        // Many names of many channels: each is looked up in no time.
        let known: HashMap<&str, usize> =
            channels.map(|(i, channel)| (channel.name.as_str(), i)).collect();
        let find = |name: String| match known.get(name.as_str()) {
            Some(channel) => Ok(Handle {
                channel_name: name.clone(),
                channel: ChannelId::from_index(*channel),
                signal: plan.signals().find(&name),
                name,
            }),
            None => Handle::find(simulation, name),
        };
        let handles = names.into_iter().map(find).collect::<PyResult<_>>()?;
        Ok(Self { handles, plan: plan.clone() })
    }

    /// Writes the present values into a slice of the same length.
    fn read(&self, simulation: &Simulation, values: &mut [f64]) -> PyResult<()> {
        if Arc::ptr_eq(&self.plan, simulation.plan()) {
            for (value, handle) in values.iter_mut().zip(&self.handles) {
                *value = simulation.get(handle.channel);
            }
            return Ok(());
        }
        for (value, handle) in values.iter_mut().zip(&self.handles) {
            *value = simulation.get(Handle::find(simulation, handle.name.clone())?.channel);
        }
        Ok(())
    }

    /// The present values, in an array that is given or made.
    pub fn get<'py>(
        &self,
        py: Python<'py>,
        simulation: &Simulation,
        out: Option<Bound<'py, PyArray1<f64>>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let n = self.handles.len();
        let array = out.unwrap_or_else(|| PyArray1::zeros(py, n, false));
        {
            let wrong = |problem: String| PyValueError::new_err(format!("out: {problem}"));
            let mut values =
                array.try_readwrite().map_err(|_| wrong("the array cannot be written".into()))?;
            let values =
                values.as_slice_mut().map_err(|_| wrong("the array must be contiguous".into()))?;
            if values.len() != n {
                return Err(wrong(format!("{} places for {n} names", values.len())));
            }
            self.read(simulation, values)?;
        }
        Ok(array)
    }

    /// The signals, and who reads them.
    pub fn signals(&self, simulation: &Simulation) -> PyResult<Vec<SignalId>> {
        let find = |handle: &Handle| {
            let id = match handle.signal {
                Some(id) if Arc::ptr_eq(&self.plan, simulation.plan()) => Some(id),
                _ => simulation.plan().signals().find(&handle.name),
            };
            id.ok_or_else(|| {
                errors::unknown("signal", &handle.name, signal_names(simulation.plan()))
            })
        };
        self.handles.iter().map(find).collect()
    }

    /// Sets all signals, or none when one value cannot be.
    pub fn set(&self, simulation: &mut Simulation, value: &Bound<'_, PyAny>) -> PyResult<SetAll> {
        let signals = self.signals(simulation)?;
        with_numbers(value, signals.len(), |values| {
            let specs = simulation.plan().signals();
            let fits = |(id, value): (&SignalId, &f64)| {
                let spec = specs.spec(*id);
                (spec.min..=spec.max).contains(value)
            };
            let all = signals.iter().zip(values);
            // The first that does not fit is refused by the simulation, with its limits.
            let refused = all.clone().find(|pair| !fits(*pair));
            match refused {
                Some((id, value)) => simulation.set(*id, *value),
                None => all.into_iter().try_for_each(|(id, value)| simulation.set(*id, *value)),
            }
        })
    }
}

/// What the simulation says to values.
pub type SetAll = Result<(), anergy_simulation::error::RunError>;

/// Numbers of an array without a copy, or of a sequence.
fn with_numbers<R>(
    value: &Bound<'_, PyAny>,
    count: usize,
    mut take: impl FnMut(&[f64]) -> R,
) -> PyResult<R> {
    let check = |found: usize| {
        let message = || format!("{found} values for {count} names");
        if found == count { Ok(()) } else { Err(PyValueError::new_err(message())) }
    };
    if let Ok(array) = value.cast::<PyArray1<f64>>()
        && let Ok(array) = array.try_readonly()
        && let Ok(values) = array.as_slice()
    {
        check(values.len())?;
        return Ok(take(values));
    }
    let values: Vec<f64> = value.extract()?;
    check(values.len())?;
    Ok(take(&values))
}

#[pymethods]
impl Handles {
    /// What they stand for, in the order of the values (list of str).
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.handles.iter().map(|handle| handle.name.as_str()).collect()
    }

    /// Number of names.
    fn __len__(&self) -> usize {
        self.handles.len()
    }

    fn __repr__(&self) -> String {
        format!("<anergy.Handles of {} names>", self.handles.len())
    }
}

/// A handle or a name.
pub enum Name<'py> {
    /// Looked up.
    Handle(Bound<'py, Handle>),
    /// As text.
    Text(String),
}

impl<'py> Name<'py> {
    /// From an argument.
    pub fn of(argument: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(handle) = argument.cast::<Handle>() {
            return Ok(Self::Handle(handle.clone()));
        }
        if let Ok(text) = argument.cast::<PyString>() {
            return Ok(Self::Text(text.to_string()));
        }
        let kind = argument.get_type();
        Err(PyTypeError::new_err(format!("a name is a str or a Handle, not {kind}")))
    }

    /// The channel of a simulation.
    pub fn channel(&self, simulation: &Simulation) -> PyResult<ChannelId> {
        let plan = simulation.plan();
        let text = match self {
            Self::Text(text) => text.as_str(),
            Self::Handle(handle) => {
                let handle = handle.get();
                let own = plan.channels().get(handle.channel.index());
                if own.is_some_and(|channel| channel.name == handle.channel_name) {
                    return Ok(handle.channel);
                }
                handle.name.as_str()
            }
        };
        let unknown = || errors::unknown("channel or signal", text, names(plan));
        find_channel(simulation, text).map(|(_, id)| id).ok_or_else(unknown)
    }

    /// The signal of a simulation.
    pub fn signal(&self, simulation: &Simulation) -> PyResult<SignalId> {
        let plan = simulation.plan();
        let text = match self {
            Self::Text(text) => text.as_str(),
            Self::Handle(handle) => {
                let handle = handle.get();
                if let Some(id) = handle.signal
                    && plan.signals().specs().get(id.index()).is_some_and(|s| s.name == handle.name)
                {
                    return Ok(id);
                }
                handle.name.as_str()
            }
        };
        let found = plan.signals().find(text);
        found.ok_or_else(|| errors::unknown("signal", text, signal_names(plan)))
    }
}
