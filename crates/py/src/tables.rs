//! Results as tables of other libraries and as files.

use crate::errors;
use crate::result::{RunResult, python};
use anergy_recording::selection;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

/// A name, or several.
#[derive(FromPyObject)]
enum Names {
    One(String),
    Many(Vec<String>),
}

impl Names {
    fn list(names: Option<Self>) -> Vec<String> {
        match names {
            None => Vec::new(),
            Some(Self::One(name)) => vec![name],
            Some(Self::Many(names)) => names,
        }
    }
}

#[pymethods]
impl RunResult {
    /// The results as pandas.DataFrame: a column per channel, time_s as index.
    ///
    /// Parameters
    /// ----------
    /// channels : list of str, optional
    ///     Only these.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without pandas: `pip install anergy[pandas]`.
    /// UnknownNameError
    ///     For a channel that does not exist.
    #[pyo3(signature = (channels=None))]
    fn to_pandas<'py>(
        slf: &Bound<'py, Self>,
        channels: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "anergy._export", "result_to_pandas")?.call1((slf, channels))
    }

    /// The results as xarray.Dataset: a variable per channel with its unit, dimension time_s.
    ///
    /// Parameters
    /// ----------
    /// channels : list of str, optional
    ///     Only these.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without xarray: `pip install anergy[xarray]`.
    /// UnknownNameError
    ///     For a channel that does not exist.
    #[pyo3(signature = (channels=None))]
    fn to_xarray<'py>(
        slf: &Bound<'py, Self>,
        channels: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        python(slf.py(), "anergy._export", "result_to_xarray")?.call1((slf, channels))
    }

    /// Writes the results as a Parquet file: `time_s`, then a column per channel with its unit as metadata.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file; an existing one is replaced.
    /// channels : list of str, optional
    ///     Only these.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without pyarrow: `pip install anergy[parquet]`.
    /// UnknownNameError
    ///     For a channel that does not exist.
    #[pyo3(signature = (path, channels=None))]
    fn to_parquet(
        slf: &Bound<'_, Self>,
        path: PathBuf,
        channels: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        python(slf.py(), "anergy._export", "result_to_parquet")?.call1((slf, path, channels))?;
        Ok(())
    }

    /// Writes the results as a CSV file: `time_s`, `time` where the model has a start in the calendar, then a column per channel.
    ///
    /// The same table as `anergy export`. Numbers read back to the same bits; what is not a number is empty.
    ///
    /// Parameters
    /// ----------
    /// path : str or os.PathLike
    ///     The file; an existing one is replaced.
    /// channels : list of str, optional
    ///     Only these: names of channels or components; `*` stands for any text.
    /// every_s : float, optional
    ///     Time between the rows, s: the first at or after each multiple. Absent: all.
    /// units : list of str, optional
    ///     Units besides SI, for example `["degc", "bar", "l_h"]`; the names of columns then end in them.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For what no channel matches, a word that is no unit, or an `every_s` that is not above 0.
    /// OSError
    ///     When it cannot be written.
    #[pyo3(signature = (path, channels=None, *, every_s=None, units=None))]
    fn to_csv(
        &self,
        py: Python<'_>,
        path: PathBuf,
        channels: Option<Names>,
        every_s: Option<f64>,
        units: Option<Names>,
    ) -> PyResult<()> {
        if every_s.is_some_and(|every_s| !(every_s > 0.0 && every_s.is_finite())) {
            return Err(PyValueError::new_err("every_s must be a time above 0 s"));
        }
        let (channels, units) = (Names::list(channels), Names::list(units));
        let chosen = selection::choose(&self.recording.channels, &channels, &units)
            .map_err(|problem| PyValueError::new_err(problem.to_string()))?;
        py.detach(|| {
            let file = BufWriter::new(File::create(&path)?);
            anergy_recording::write_csv(&self.recording, &chosen, every_s, file)
        })
        .map(drop)
        .map_err(|error| errors::os_error(py, &error, &path))
    }
}
