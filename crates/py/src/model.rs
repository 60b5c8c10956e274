//! `anergy.Model`: a model file, loaded.

mod explain;
mod parameters;
mod runs;
mod stability;
mod text;

pub use text::load_model;

use crate::errors::{self, ModelError, Origin};
use crate::{convert, steady};
use anergy_simulation::document;
use anergy_simulation::model;
use anergy_simulation::overlay::Change;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::{Path, PathBuf};

/// A network with its prosumers, controllers and inputs.
///
/// Made by `Model.from_file`, `Model.from_toml`, `Model.from_dict` or `anergy.examples.load`; never
/// changed afterwards: `set` and `scale` give new models. Can be pickled and used from many threads.
///
/// Examples
/// --------
/// >>> import anergy
/// >>> model = anergy.examples.load("three-houses")
/// >>> model
/// <anergy.Model "three houses: pump blocking": 17 nodes, 18 edges>
#[pyclass(module = "anergy", frozen)]
pub struct Model {
    pub(crate) model: model::Model,
    origin: Origin,
    /// Where the files it names are looked up.
    directory: PathBuf,
    /// What was changed since it was read.
    changes: Vec<Change>,
}

#[pymethods]
impl Model {
    /// Refuses: a model is read or built.
    #[new]
    #[pyo3(signature = (*_args, **_fields))]
    fn refuse(_args: &Bound<'_, PyTuple>, _fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Err(PyTypeError::new_err(
            "a Model comes from Model.from_file(path), Model.from_toml(text), Model.from_dict(dict) or Grid(...).model()",
        ))
    }

    /// Reads a model file (TOML).
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file. Files that it names are looked up next to it.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     With all problems of the file, their lines and hints.
    /// OSError
    ///     FileNotFoundError and its like.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let bytes = std::fs::read(&path).map_err(|error| errors::os_error(py, &error, &path))?;
        let Ok(text) = String::from_utf8(bytes) else {
            let message = format!("{}: the file is not UTF-8 text", path.display());
            return Err(ModelError::new_err(message));
        };
        let directory = path.parent().map(Path::to_owned).unwrap_or_default();
        Self::read(py, &text, directory, Origin::File(path))
    }

    /// Reads a model from TOML text.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     What a model file contains.
    /// directory : str or os.PathLike
    ///     Where files that it names are looked up.
    ///
    /// Raises ModelError with all problems of the text, their lines and hints.
    #[staticmethod]
    #[pyo3(signature = (text, directory = PathBuf::from(".")), text_signature = "(text, directory='.')")]
    fn from_toml(py: Python<'_>, text: &str, directory: PathBuf) -> PyResult<Self> {
        Self::read(py, text, directory, Origin::Text)
    }

    /// Makes a model from a dict with the grammar of the model file.
    ///
    /// Parameters
    /// ----------
    /// dict : mapping
    ///     As from `to_dict`, `tomllib.load` or `json.load`; see `anergy.schema`. numpy numbers and
    ///     arrays are welcome, None is not: leave the key out.
    /// directory : str or os.PathLike
    ///     Where files that it names are looked up.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     With all problems and hints.
    /// TypeError, ValueError
    ///     For what a model file cannot hold, naming its place.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> data = anergy.examples.load("three-houses").to_dict()
    /// >>> data["ground"]["temperature_degc"] = 5
    /// >>> anergy.Model.from_dict(data).parameters()["ground.temperature_k"]
    /// 278.15
    #[staticmethod]
    #[pyo3(signature = (dict, directory = PathBuf::from(".")), text_signature = "(dict, directory='.')")]
    fn from_dict(py: Python<'_>, dict: &Bound<'_, PyAny>, directory: PathBuf) -> PyResult<Self> {
        let object = convert::object_from_python(dict, "model")?;
        let text = document::to_toml(&object)
            .map_err(|error| errors::model_error(py, &error, "", &Origin::Dict))?;
        Self::read(py, &text, directory, Origin::Dict)
    }

    /// The model as a dict that `from_dict` takes.
    ///
    /// As it was written (names of series files included); after `set` or `scale` as plain nodes
    /// and edges, as `expand` gives.
    ///
    /// Returns dicts, lists, str, float, int, bool.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        convert::to_python(py, &self.document(py)?)
    }

    /// The model as the text of a model file.
    ///
    /// As it was written; after `set` or `scale` as plain nodes and edges, as `expand` gives.
    fn to_toml(&self, py: Python<'_>) -> PyResult<String> {
        if self.changes.is_empty() { Ok(self.model.text.to_string()) } else { self.plain(py) }
    }

    /// Writes the model file; `from_file` reads the same model back.
    ///
    /// As it was written, comments included; after `set` or `scale` as plain nodes and edges.
    /// Written into another directory, a model with series of CSV files gets their points into the
    /// file.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file; an existing one is replaced.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When it cannot be written.
    fn to_file(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let mut text = self.to_toml(py)?;
        if self.changes.is_empty() && !text::same_directory(&self.directory, &path) {
            text = self.text_with_series(py)?.unwrap_or(text);
        }
        std::fs::write(&path, text).map_err(|error| errors::os_error(py, &error, &path))
    }

    /// The model as TOML text of plain nodes and edges in SI, composites written out.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> 'id = "sf1.feed_in_pump"' in anergy.examples.load("three-houses").expand()
    /// True
    fn expand(&self, py: Python<'_>) -> PyResult<String> {
        self.plain(py)
    }

    /// Title of the model.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// Names of the nodes (list of str).
    #[getter]
    fn nodes(&self) -> Vec<&str> {
        self.model.nodes.iter().map(|node| node.entry.id.as_str()).collect()
    }

    /// Names of the edges (list of str).
    #[getter]
    fn edges(&self) -> Vec<&str> {
        self.model.edges.iter().map(|edge| edge.id.as_str()).collect()
    }

    /// Names of the stations: where prosumers meet the network (list of str).
    #[getter]
    fn stations(&self) -> Vec<&str> {
        self.model.interfaces.iter().map(|station| station.entry.id.as_str()).collect()
    }

    /// Names of the thermal units (list of str).
    #[getter]
    fn units(&self) -> Vec<&str> {
        self.model.units.iter().map(|unit| unit.id.as_str()).collect()
    }

    /// Names of the controllers (list of str).
    #[getter]
    fn controllers(&self) -> Vec<&str> {
        self.model.controllers.iter().map(|controller| controller.id.as_str()).collect()
    }

    /// Checks the whole model: names, values, signals, pressure references.
    ///
    /// Raises ModelError with all problems, their lines and hints.
    fn check(&self, py: Python<'_>) -> PyResult<()> {
        self.plan(py).map(|_| ())
    }

    /// All parameters that `set` and `scale` take, and their values in SI.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `component.field` to value; None where it follows from others.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> anergy.examples.load("three-houses").parameters()["sf1-sf2.hot.length_m"]
    /// 200.0
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, value) in self.known_parameters() {
            dict.set_item(name, convert::to_python(py, &value)?)?;
        }
        Ok(dict)
    }

    /// A new model with one parameter set; this one stays as it is.
    ///
    /// Parameters
    /// ----------
    /// parameter : str
    ///     `component.field`, one of `parameters`.
    /// value : float, str, ...
    ///     In SI, as the unit in the name says.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For a parameter that does not exist.
    /// ValueError, TypeError
    ///     For a value that it cannot have. What only the whole model shows is found by `check`.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> model = anergy.examples.load("three-houses").set("sf1-sf2.hot.length_m", 400)
    /// >>> model.parameters()["sf1-sf2.hot.length_m"]
    /// 400.0
    fn set(&self, parameter: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let value = convert::from_python(value, parameter)?;
        self.with(Change::Set { parameter: parameter.to_owned(), value })
    }

    /// A new model with one parameter multiplied; this one stays as it is.
    ///
    /// Parameters
    /// ----------
    /// parameter : str
    ///     `component.field`, one of `parameters` that has a number.
    /// factor : float
    ///     1 changes nothing.
    ///
    /// Raises what `set` raises.
    fn scale(&self, parameter: &str, factor: f64) -> PyResult<Self> {
        if !factor.is_finite() {
            let message = format!("{parameter}: the factor {factor} is not a finite number");
            return Err(pyo3::exceptions::PyValueError::new_err(message));
        }
        self.with(Change::Scale { parameter: parameter.to_owned(), factor })
    }

    /// The steady state: inputs as at t = 0, actuators arrived, temperatures settled.
    ///
    /// Returns
    /// -------
    /// Steady
    ///     Tables `nodes` (p_pa, t_k, elevation_m) and `edges` (kind, m_flow_kg_s, dp_pa).
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     When the model is wrong.
    /// ConvergenceError
    ///     When no steady state was found; names the culprit.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> steady = anergy.examples.load("three-houses").solve()
    /// >>> round(60 * steady["sf2.feed_in_pump"]["m_flow_kg_s"], 2)  # l/min
    /// 7.92
    fn solve<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let solved = py.detach(|| anergy_simulation::steady::solve(&this.model));
        let solved = solved
            .map_err(|error| errors::run_error(py, &error, &this.model.text, &this.origin))?;
        steady::to_python(py, &solved, slf)
    }

    fn __repr__(&self) -> String {
        let (nodes, edges) = (self.model.nodes.len(), self.model.edges.len());
        format!("<anergy.Model \"{}\": {nodes} nodes, {edges} edges>", self.model.name)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("anergy._display")?.call_method1("model_html", (slf,))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        text::pickle(self, py)
    }
}
