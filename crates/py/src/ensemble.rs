//! `anergy.Variations`, and the members of an ensemble in threads.

use crate::convert;
use crate::errors::{self, Origin};
use crate::model::Model;
use anergy_core::clock::Time;
use anergy_ensemble::definition::{Definition, schema};
use anergy_ensemble::ensemble::{Ensemble, EnsembleError, all_threads};
use anergy_ensemble::lock::FolderLock;
use anergy_ensemble::member::Outcome;
use anergy_ensemble::members::Members;
use anergy_ensemble::store::StoreError;
use anergy_simulation::diagnostic::Diagnostics;
use anergy_simulation::model_file::StepEntry;
use anergy_simulation::overlay::Change;
use numpy::PyArray1;
use pyo3::exceptions::{PyIndexError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};
use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;

/// What varies over the members of an ensemble, how they are chosen, how they run, what is kept.
///
/// Made by `Variations.from_file`, `Variations.from_toml` or `Variations.from_dict`; `anergy.ensemble` takes the
/// dict and the path too. Can be pickled.
///
/// Examples
/// --------
/// >>> import anergy
/// >>> variations = anergy.Variations.from_dict({
/// ...     "ensemble": {"design": "latin_hypercube", "members": 100, "seed": 1},
/// ...     "variation": [{"parameter": "sf1.feed_in_pump.speed", "low": 0.9, "high": 1.0}],
/// ... })
/// >>> variations
/// <anergy.Variations of sf1.feed_in_pump.speed: 100 members>
/// >>> 0.9 < variations.values(7)[0] < 1.0
/// True
#[pyclass(module = "anergy", frozen)]
pub struct Variations {
    definition: Definition,
    members: Members,
    origin: Origin,
}

impl Variations {
    fn read(
        py: Python<'_>,
        definition: Result<Definition, Diagnostics>,
        text: &str,
        origin: Origin,
    ) -> PyResult<Self> {
        let definition =
            definition.map_err(|problems| errors::model_error(py, &problems, text, &origin))?;
        Ok(Self { members: Members::of(&definition), definition, origin })
    }

    fn check(&self, member: usize) -> PyResult<()> {
        let count = self.members.len();
        let message = || format!("there is no member {member}: the ensemble has {count}");
        if member < count { Ok(()) } else { Err(PyIndexError::new_err(message())) }
    }
}

#[pymethods]
impl Variations {
    /// Reads a file of variations (TOML).
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file, as `anergy sweep` takes it.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     With all problems of the file, their lines and hints.
    /// OSError
    ///     FileNotFoundError and its like.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let text =
            std::fs::read_to_string(&path).map_err(|error| errors::os_error(py, &error, &path))?;
        Self::read(py, Definition::from_toml(&text), &text, Origin::File(path))
    }

    /// Reads variations from TOML text.
    ///
    /// Raises ModelError with all problems of the text, their lines and hints.
    #[staticmethod]
    fn from_toml(py: Python<'_>, text: &str) -> PyResult<Self> {
        Self::read(py, Definition::from_toml(text), text, Origin::Text)
    }

    /// Makes variations from a dict with the grammar of the file; `format` may be left out.
    ///
    /// Parameters
    /// ----------
    /// dict : mapping
    ///     Sections `ensemble`, `run`, `keep`, and `variation`, a list; see `Variations.schema`. numpy arrays are welcome.
    ///
    /// Raises ModelError with all problems and hints.
    #[staticmethod]
    fn from_dict(py: Python<'_>, dict: &Bound<'_, PyAny>) -> PyResult<Self> {
        let object = convert::object_from_python(dict, "variations")?;
        Self::read(py, Definition::from_json(&object), "", Origin::Dict)
    }

    /// The grammar of the file as a JSON Schema (dict).
    #[staticmethod]
    fn schema(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        convert::to_python(py, &schema())
    }

    /// The variations as a dict that `from_dict` takes.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::to_python(py, &self.definition.document)
    }

    /// The variations as the text of a file.
    fn to_toml(&self) -> &str {
        &self.definition.text
    }

    /// Names of what varies (list of str).
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.definition.variations.iter().map(|variation| variation.name.as_str()).collect()
    }

    /// Values of a member, one per name, as written in the file.
    ///
    /// Parameters
    /// ----------
    /// member : int
    ///     From 0.
    ///
    /// Raises IndexError for a member that does not exist.
    fn values<'py>(&self, py: Python<'py>, member: usize) -> PyResult<Bound<'py, PyList>> {
        self.check(member)?;
        values(py, &self.members.values(&self.definition, member))
    }

    /// The same variations at given points of the unit cube, which the distributions turn into values: those of a
    /// sensitivity analysis, of an optimisation, of a sequence of another library.
    ///
    /// Parameters
    /// ----------
    /// points : array of shape (n, number of names)
    ///     Between 0 and 1: a row per member.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> variations = anergy.Variations.from_dict(
    /// ...     {"ensemble": {"design": "monte_carlo", "members": 1},
    /// ...      "variation": [{"parameter": "ground.temperature_degc", "low": 4, "high": 16}]})
    /// >>> variations.at([[0.25], [0.5]]).values(0)
    /// [7.0]
    fn at(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let points = convert::from_python(points, "points")?;
        let Value::Object(mut document) = self.definition.document.clone() else {
            return Err(PyValueError::new_err("there are no variations"));
        };
        let mut ensemble = serde_json::json!({ "design": "points", "points": points });
        for key in ["seed", "random"] {
            if let Some(value) = document.get("ensemble").and_then(|given| given.get(key)) {
                ensemble[key] = value.clone();
            }
        }
        document.insert("ensemble".into(), ensemble);
        Self::read(py, Definition::from_json(&document), "", Origin::Dict)
    }

    /// Whether the values of each name are numbers.
    fn _numeric(&self) -> Vec<bool> {
        self.definition.variations.iter().map(|variation| variation.spread.is_numeric()).collect()
    }

    /// Number of members.
    fn __len__(&self) -> usize {
        self.members.len()
    }

    fn __repr__(&self) -> String {
        let names = self.names().join(", ");
        format!("<anergy.Variations of {names}: {} members>", self.members.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let load = py.import("anergy")?.getattr("Variations")?.getattr("from_toml")?;
        Ok((load, (&self.definition.text,)).into_pyobject(py)?.into_any())
    }
}

fn values<'py>(py: Python<'py>, values: &[Value]) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for value in values {
        list.append(convert::to_python(py, value)?)?;
    }
    Ok(list)
}

/// A model and variations that fit it: what `anergy.ensemble` runs.
#[pyclass(module = "anergy._core", name = "_Members", frozen)]
pub struct PyMembers {
    ensemble: Ensemble,
    model: Py<Model>,
}

impl PyMembers {
    fn recognised(&self, py: Python<'_>, controllers: Option<&str>) -> PyResult<Value> {
        let identity = py.detach(|| self.ensemble.identity("anergy.ensemble", controllers));
        let base = self.model.get();
        identity
            .map_err(|problems| errors::model_error(py, &problems, &base.model.text, base.origin()))
    }
}

#[pymethods]
impl PyMembers {
    #[new]
    fn new(py: Python<'_>, model: Py<Model>, variations: &Variations) -> PyResult<Self> {
        let base = model.get();
        let definition = variations.definition.clone();
        let ensemble = py.detach(|| Ensemble::new(Arc::new(base.model.clone()), definition));
        let ensemble = ensemble.map_err(|error| match error {
            EnsembleError::Model(problems) => {
                errors::model_error(py, &problems, &base.model.text, base.origin())
            }
            EnsembleError::Variations(problems) => {
                errors::model_error(py, &problems, &variations.definition.text, &variations.origin)
            }
        })?;
        Ok(Self { ensemble, model })
    }

    /// Names of the channels that are kept.
    #[getter]
    fn channels(&self) -> Vec<&str> {
        self.ensemble.channels().iter().map(String::as_str).collect()
    }

    /// What tells the ensemble from others, JSON; `controllers` tells those in Python.
    #[pyo3(signature = (controllers=None))]
    fn identity(&self, py: Python<'_>, controllers: Option<&str>) -> PyResult<String> {
        Ok(format!("{:#}\n", self.recognised(py, controllers)?))
    }

    /// What differs from the identity of another ensemble; None where nothing does.
    #[pyo3(signature = (other, controllers=None))]
    fn differs(
        &self,
        py: Python<'_>,
        other: &str,
        controllers: Option<&str>,
    ) -> PyResult<Option<&'static str>> {
        Ok(anergy_ensemble::store::difference(&self.recognised(py, controllers)?, other))
    }

    /// The model of a member.
    fn model(&self, py: Python<'_>, member: usize) -> PyResult<Model> {
        let changes: Vec<Change> = self.ensemble.changes(member);
        py.detach(|| self.model.get().with_all(&changes))
            .map_err(|error| PyValueError::new_err(error.to_string()))
    }

    /// Values of a member, one per variation.
    fn values<'py>(&self, py: Python<'py>, member: usize) -> PyResult<Bound<'py, PyList>> {
        values(py, &self.ensemble.values(member))
    }

    /// Arguments of `Model.simulate` for each member.
    fn options<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let options = self.ensemble.options();
        let dict = PyDict::new(py);
        dict.set_item("until_s", options.until.map(Time::as_s))?;
        match options.step {
            Some(StepEntry::Fixed(step)) => dict.set_item("step_s", step.0.as_s())?,
            Some(StepEntry::Automatic) => dict.set_item("step_s", "auto")?,
            None => {}
        }
        dict.set_item("record_s", options.record.map(Time::as_s))?;
        Ok(dict)
    }

    /// The indicators that are kept, of those of a summary.
    fn indicators<'py>(
        &self,
        py: Python<'py>,
        told: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let told = convert::from_python(told, "kpis")?;
        convert::to_python(py, &Value::Object(self.ensemble.indicators(&told)))
    }

    /// Patterns of `keep` that none of these indicators has the form of.
    fn unmatched(&self, indicators: Vec<String>) -> Vec<String> {
        self.ensemble.definition().unmatched(&indicators)
    }

    /// Runs members in threads (0: all cores). `each` is called in this thread with a list of what has finished, and with
    /// an empty one now and then.
    fn run(
        &self,
        py: Python<'_>,
        members: Vec<usize>,
        threads: usize,
        each: Py<PyAny>,
    ) -> PyResult<()> {
        let threads = if threads == 0 { all_threads() } else { threads };
        let mut raised = None;
        py.detach(|| {
            self.ensemble.run_all(&members, threads, &mut |outcome| {
                let told = Python::attach(|py| {
                    let batch = PyList::empty(py);
                    if let Some(outcome) = &outcome {
                        batch.append(tuple(py, outcome)?)?;
                    }
                    each.call1(py, (batch,))?;
                    py.check_signals()
                });
                raised = told.err();
                raised.is_none()
            });
        });
        raised.map_or(Ok(()), Err)
    }
}

/// Keeps other writers out of a folder until it is released.
#[pyclass(module = "anergy._core", name = "_FolderLock")]
pub struct PyFolderLock {
    lock: Option<FolderLock>,
}

#[pymethods]
impl PyFolderLock {
    #[new]
    fn new(folder: PathBuf) -> PyResult<Self> {
        match FolderLock::take(&folder) {
            Ok(lock) => Ok(Self { lock: Some(lock) }),
            Err(busy @ StoreError::Busy { .. }) => Err(PyValueError::new_err(busy.to_string())),
            Err(error) => Err(PyOSError::new_err(error.to_string())),
        }
    }

    fn release(&mut self) {
        self.lock = None;
    }
}

/// Member, values, error or None, indicators, times and columns of the channels.
fn tuple<'py>(py: Python<'py>, outcome: &Outcome) -> PyResult<Bound<'py, PyTuple>> {
    let values = values(py, &outcome.values)?;
    let (error, kpis, series) = match &outcome.result {
        Ok(kept) => (None, kept.kpis.clone(), kept.series.clone()),
        Err(message) => (Some(message), serde_json::Map::new(), Default::default()),
    };
    let kpis = convert::to_python(py, &Value::Object(kpis))?;
    let time_s = PyArray1::from_vec(py, series.time_s);
    let columns: Vec<_> =
        series.columns.into_iter().map(|column| PyArray1::from_vec(py, column)).collect();
    (outcome.member, values, error, kpis, time_s, columns).into_pyobject(py)
}
