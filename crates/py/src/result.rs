//! `anergy.Result`: the recorded rows as columns.

use crate::{convert, errors};
use anergy_core::recorder::{Channel, Event, Recording, RunHeader, Severity};
use numpy::ndarray::ArrayView1;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyIterator, PyList, PyTuple};
use std::collections::HashMap;
use std::path::PathBuf;

/// The results of a run: a mapping of channel names to columns.
///
/// Columns are numpy arrays of float64 with shape `(len(time_s),)` in the SI unit that the name ends
/// with. They are views: no copy, read-only, valid as long as one of them is held. Can be pickled.
///
/// Examples
/// --------
/// >>> import anergy
/// >>> result = anergy.examples.load("three-houses").simulate(until_s=600, record_s=60)
/// >>> result.time_s[[0, 1, -1]].tolist()
/// [0.0, 60.0, 600.0]
/// >>> result["sf1.feed_in_pump.m_flow_kg_s"].shape, result.unit("sf1.feed_in_pump.m_flow_kg_s")
/// ((11,), 'kg s-1')
/// >>> "sf1.feed_in_pump.m_flow_kg_s" in result
/// True
#[pyclass(module = "anergy", name = "Result", frozen)]
pub struct RunResult {
    pub(crate) recording: Recording,
    damage: Option<String>,
    index: HashMap<String, usize>,
}

/// What is pickled; the summary as text, since its type is only known when read.
type Pickled =
    (RunHeader, Vec<Channel>, Vec<f64>, Vec<Vec<f64>>, Vec<Event>, String, Option<String>);

impl RunResult {
    pub fn new(recording: Recording, damage: Option<String>) -> Self {
        let names = recording.channels.iter().enumerate();
        let index = names.map(|(i, channel)| (channel.name.clone(), i)).collect();
        Self { recording, damage, index }
    }

    fn find(&self, name: &str) -> PyResult<usize> {
        let names = || self.recording.channels.iter().map(|channel| channel.name.as_str());
        self.index.get(name).copied().ok_or_else(|| errors::unknown("channel", name, names()))
    }
}

/// A read-only array on `values`, which keeps `owner` alive; `values` must be those of `owner`.
#[expect(unsafe_code, reason = "the one place where columns are shared with numpy")]
fn view<'py>(owner: &Bound<'py, RunResult>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    // SAFETY: `values` is a column of `owner`. The array holds a reference to `owner`, which is
    // frozen: nothing moves, changes or frees its columns while the array lives. The array is
    // made read-only, and numpy cannot undo that as `owner` offers no writable buffer.
    let array =
        unsafe { PyArray1::borrow_from_array(&ArrayView1::from(values), owner.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    array
}

/// A function of the Python part of the package.
pub(crate) fn python<'py>(
    py: Python<'py>,
    module: &str,
    function: &str,
) -> PyResult<Bound<'py, PyAny>> {
    py.import(module)?.getattr(function)
}

#[pymethods]
impl RunResult {
    /// Refuses: a run makes it.
    #[new]
    #[pyo3(signature = (*_args, **_fields))]
    fn refuse(_args: &Bound<'_, PyTuple>, _fields: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        Err(PyTypeError::new_err(
            "a Result comes from model.simulate() or, recorded, from Result.from_file(path)",
        ))
    }

    /// Reads a recorded file (results.mcap), also of a run that was killed.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file, written by `simulate(out=...)` or by the program `anergy run`.
    ///
    /// Raises
    /// ------
    /// OSError
    ///     When it cannot be read.
    /// RecordingError
    ///     When it is not a recording of anergy.
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = py.detach(|| anergy_recording::read(&path));
        let read = read.map_err(|error| errors::record_error(py, &error))?;
        Ok(Self::new(read.recording, read.damage))
    }

    /// The column of a channel, float64 with shape `(len(time_s),)`, read-only, no copy.
    ///
    /// Raises UnknownNameError, a KeyError, with the most similar name.
    fn __getitem__<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let this = slf.get();
        Ok(view(slf, &this.recording.columns[this.find(name)?]))
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.index.contains_key(&name))
    }

    /// Number of channels.
    fn __len__(&self) -> usize {
        self.recording.channels.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        PyList::new(py, self.channels())?.try_iter()
    }

    /// Names of the channels, as `channels`: `dict(result)` works.
    fn keys(&self) -> Vec<&str> {
        self.channels()
    }

    /// Simulated time of each row, s since the start: float64, read-only, no copy.
    #[getter]
    fn time_s<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        view(slf, &slf.get().recording.time_s)
    }

    /// Names of the channels, `component.quantity_unit` (list of str).
    #[getter]
    fn channels(&self) -> Vec<&str> {
        self.recording.channels.iter().map(|channel| channel.name.as_str()).collect()
    }

    /// Title of the model.
    #[getter]
    fn model_name(&self) -> &str {
        &self.recording.header.model_name
    }

    /// The model file that was run (str).
    #[getter]
    fn model_toml(&self) -> &str {
        &self.recording.header.model_text
    }

    /// What happened: a list of dicts with time_s, severity, component, kind, message.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        events(py, self.recording.events.iter())
    }

    /// Key results, balances and statistics of the run (dict), as in summary.json; empty for a
    /// file of a run that was killed.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        if self.recording.summary.is_null() {
            return Ok(PyDict::new(py).into_any());
        }
        convert::to_python(py, &self.recording.summary)
    }

    /// Why the end of the file is missing (str); None for complete results.
    #[getter]
    fn damage(&self) -> Option<&str> {
        self.damage.as_deref()
    }

    /// The SI unit of a channel as in UDUNITS: `kg s-1`, `Pa`, `K`, `W`, `J`, `1`.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     A KeyError, with the most similar name.
    fn unit(&self, name: &str) -> PyResult<&str> {
        Ok(&self.recording.channels[self.find(name)?].unit)
    }

    /// Key results and indicators as `{"component.quantity_unit": value}`.
    ///
    /// In the units of a plant (l/min, kW, kWh), as the names say: of the network, of sites, stations
    /// and units, summed up in every step of the run.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> result = anergy.examples.load("three-houses").simulate(until_s=600)
    /// >>> kpis = result.kpis()
    /// >>> "sf4.station.heat_taken_kwh" in kpis, "network.pump_kwh_per_mwh_taken" in kpis
    /// (True, True)
    fn kpis<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "anergy._display", "kpis")?.call1((slf,))
    }

    /// Plots channels over time with matplotlib, shaded where their components are blocked or swing.
    ///
    /// From the events `blocked`, `oscillating` and `hunting` of the component of a channel, and of
    /// what stands at the same place.
    ///
    /// Parameters
    /// ----------
    /// *channels : str
    ///     One or more, of one unit.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// ValueError
    ///     For no channel, or channels of different units.
    #[pyo3(signature = (*channels, ax=None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        channels: &Bound<'py, PyTuple>,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "anergy._export", "plot")?.call1((slf, channels, ax))
    }

    /// Writes the report: one HTML file with map, plots, balances and events that needs no network.
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
    fn report(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| std::fs::write(&path, anergy_report::html(&self.recording)))
            .map_err(|error| errors::os_error(py, &error, &path))
    }

    fn __repr__(&self) -> String {
        format!(
            "<anergy.Result of \"{}\": {} channels, {} rows, {} s>",
            self.recording.header.model_name,
            self.recording.channels.len(),
            self.recording.time_s.len(),
            self.recording.time_s.last().unwrap_or(&0.0),
        )
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "anergy._display", "result_html")?.call1((slf,))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let from = &self.recording;
        let pickled = (
            &from.header,
            &from.channels,
            &from.time_s,
            &from.columns,
            &from.events,
            from.summary.to_string(),
            &self.damage,
        );
        let bytes = py.detach(|| postcard::to_allocvec(&pickled));
        let bytes = bytes.map_err(|error| PyValueError::new_err(error.to_string()))?;
        let load = py.import("anergy._core")?.getattr("_load_result")?;
        Ok((load, (PyBytes::new(py, &bytes),)).into_pyobject(py)?.into_any())
    }
}

/// Results from their pickle.
#[pyfunction]
#[pyo3(name = "_load_result")]
pub fn load_result(py: Python<'_>, data: &[u8]) -> PyResult<RunResult> {
    let wrong = |problem: String| PyValueError::new_err(format!("no pickled Result: {problem}"));
    let (header, channels, time_s, columns, events, summary, damage): Pickled =
        py.detach(|| postcard::from_bytes(data)).map_err(|error| wrong(error.to_string()))?;
    let summary = serde_json::from_str(&summary).map_err(|error| wrong(error.to_string()))?;
    if columns.len() != channels.len() || columns.iter().any(|c| c.len() != time_s.len()) {
        return Err(wrong("its columns have different lengths".into()));
    }
    let recording = Recording { header, channels, time_s, columns, events, summary };
    Ok(RunResult::new(recording, damage))
}

/// Events as list of dicts.
pub fn events<'py, 'a>(
    py: Python<'py>,
    events: impl Iterator<Item = &'a Event>,
) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for event in events {
        let dict = PyDict::new(py);
        dict.set_item("time_s", event.time.as_s())?;
        let severity = match event.severity {
            Severity::Info => "info",
            Severity::Warning => "warning",
        };
        dict.set_item("severity", severity)?;
        dict.set_item("component", &event.component)?;
        dict.set_item("kind", &event.kind)?;
        dict.set_item("message", &event.message)?;
        list.append(dict)?;
    }
    Ok(list)
}
