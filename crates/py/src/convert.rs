//! Between Python objects and JSON values, and from seconds to simulated time.

use anergy_core::clock::Time;
use anergy_simulation::model_file::{Duration, StepEntry};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PySequence, PyString};
use serde_json::{Map, Number, Value};

/// Deeper objects are taken for endless ones.
const MAX_DEPTH: usize = 64;

/// A JSON value as Python object: dict, list, str, float, int, bool, None.
pub fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        Value::Number(number) => match number.as_i64() {
            Some(integer) => integer.into_pyobject(py)?.into_any(),
            None => PyFloat::new(py, number.as_f64().unwrap_or(f64::NAN)).into_any(),
        },
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Array(items) => {
            let list = PyList::empty(py);
            for item in items {
                list.append(to_python(py, item)?)?;
            }
            list.into_any()
        }
        Value::Object(map) => {
            let dict = PyDict::new(py);
            for (key, item) in map {
                dict.set_item(key, to_python(py, item)?)?;
            }
            dict.into_any()
        }
    })
}

/// A Python object as JSON value; `what` names it in errors.
///
/// Takes what json takes, and numpy scalars and arrays, paths, dates.
pub fn from_python(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Value> {
    convert(object, what, 0)
}

/// A Python mapping as JSON object.
pub fn object_from_python(object: &Bound<'_, PyAny>, what: &str) -> PyResult<Map<String, Value>> {
    match convert(object, what, 0)? {
        Value::Object(map) => Ok(map),
        _ => Err(PyTypeError::new_err(format!("{what} must be a dict, not {}", kind(object)))),
    }
}

fn convert(object: &Bound<'_, PyAny>, what: &str, depth: usize) -> PyResult<Value> {
    if depth > MAX_DEPTH {
        return Err(PyValueError::new_err(format!("{what} is nested too deeply")));
    }
    if let Ok(flag) = object.cast::<PyBool>() {
        return Ok(Value::Bool(flag.is_true()));
    }
    if object.is_instance_of::<PyInt>() {
        let integer: i64 = object
            .extract()
            .map_err(|_| PyValueError::new_err(format!("{what} = {object} is too large")))?;
        return Ok(Value::from(integer));
    }
    if let Ok(float) = object.cast::<PyFloat>() {
        let number = Number::from_f64(float.value());
        let wrong = || PyValueError::new_err(format!("{what} = {object} is not a finite number"));
        return number.map(Value::Number).ok_or_else(wrong);
    }
    if let Ok(text) = object.cast::<PyString>() {
        return Ok(Value::String(text.extract()?));
    }
    if let Ok(mapping) = object.cast::<PyMapping>() {
        let mut map = Map::new();
        for item in mapping.items()?.iter() {
            let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
            let Ok(key) = key.extract::<String>() else {
                return Err(PyTypeError::new_err(format!("a key of {what} is not a str: {key}")));
            };
            let inner = convert(&value, &format!("{what}[\"{key}\"]"), depth + 1)?;
            map.insert(key, inner);
        }
        return Ok(Value::Object(map));
    }
    if let Ok(sequence) = object.cast::<PySequence>() {
        let mut items = Vec::with_capacity(sequence.len()?);
        for (i, item) in sequence.try_iter()?.enumerate() {
            items.push(convert(&item?, &format!("{what}[{i}]"), depth + 1)?);
        }
        return Ok(Value::Array(items));
    }
    // numpy scalars and arrays; dates; paths.
    for method in ["tolist", "isoformat", "__fspath__"] {
        if object.hasattr(method)? {
            return convert(&object.call_method0(method)?, what, depth + 1);
        }
    }
    let advice = if object.is_none() { "; leave the key out" } else { "" };
    let message = format!("{what} is of type {}, which a model cannot hold{advice}", kind(object));
    Err(PyTypeError::new_err(message))
}

fn kind(object: &Bound<'_, PyAny>) -> String {
    object.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string())
}

/// A point in simulated time, not before the start.
pub fn time(name: &str, seconds: f64) -> PyResult<Time> {
    Time::from_s(seconds).filter(|time| *time >= Time::ZERO).ok_or_else(|| {
        PyValueError::new_err(format!("{name} = {seconds} must be a time, 0 s or later"))
    })
}

/// A duration of at least a nanosecond.
pub fn duration(name: &str, seconds: f64) -> PyResult<Time> {
    Time::from_s(seconds)
        .filter(|time| *time > Time::ZERO)
        .ok_or_else(|| PyValueError::new_err(format!("{name} = {seconds} must be positive")))
}

/// A step as it is given in Python: seconds, or "auto".
#[derive(FromPyObject)]
pub enum StepArgument {
    /// Seconds.
    Seconds(f64),
    /// The word.
    Word(String),
}

impl StepArgument {
    /// The step.
    pub fn step(self) -> PyResult<StepEntry> {
        match self {
            Self::Seconds(seconds) => {
                duration("step_s", seconds).map(|step| StepEntry::Fixed(Duration(step)))
            }
            Self::Word(word) if word == "auto" => Ok(StepEntry::Automatic),
            Self::Word(word) => Err(PyValueError::new_err(format!(
                "step_s = \"{word}\" must be a number of seconds or \"auto\""
            ))),
        }
    }
}
