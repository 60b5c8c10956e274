//! `anergy.Snapshot`: the state of a simulation, in memory and as bytes.

use crate::errors::SnapshotError;
use anergy_core::clock::Time;
use anergy_simulation::state::State;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// What the bytes of a snapshot begin with; those of another version are not read.
const SNAPSHOT_MARK: &str = concat!("anergy snapshot ", env!("CARGO_PKG_VERSION"), "\n");

/// How hard the bytes are pressed: half of a state are numbers that are 0 or there twice.
const LEVEL: i32 = 3;

/// Tells bytes that were changed by accident (FNV-1a).
fn checksum(bytes: &[u8]) -> [u8; 8] {
    let start = 0xcbf2_9ce4_8422_2325_u64;
    let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
    bytes.iter().fold(start, step).to_le_bytes()
}

/// The state of a simulation at one time; can be pickled and compared.
///
/// Made by `Simulation.snapshot`; restoring it continues bit for bit. What added controllers remember is in
/// it as a pickle: as with any pickle, restore only what you trust.
#[pyclass(module = "anergy", frozen, eq)]
#[derive(PartialEq)]
pub struct Snapshot {
    pub time: Time,
    pub state: State,
    /// What added controllers remember, pickled.
    pub controllers: Option<Vec<u8>>,
}

#[pymethods]
impl Snapshot {
    /// A snapshot from the bytes of `to_bytes`.
    ///
    /// Raises
    /// ------
    /// SnapshotError
    ///     When the bytes are torn or of another version.
    #[staticmethod]
    fn from_bytes(data: &[u8]) -> PyResult<Self> {
        let wrong =
            |problem: &str| SnapshotError::new_err(format!("this is no snapshot: {problem}"));
        let Some(rest) = data.strip_prefix(SNAPSHOT_MARK.as_bytes()) else {
            return Err(wrong("it was not made by this version of anergy"));
        };
        let Some((sum, payload)) = rest.split_first_chunk() else {
            return Err(wrong("its end is missing"));
        };
        if *sum != checksum(payload) {
            return Err(wrong("its bytes were changed"));
        }
        let plain = zstd::decode_all(payload).map_err(|error| wrong(&error.to_string()))?;
        let (time, state, controllers) =
            postcard::from_bytes(&plain).map_err(|error| wrong(&error.to_string()))?;
        Ok(Self { time, state, controllers })
    }

    /// The snapshot as bytes, for files and other processes.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let plain = postcard::to_allocvec(&(self.time, &self.state, &self.controllers))
            .map_err(|error| SnapshotError::new_err(error.to_string()))?;
        let payload = zstd::encode_all(&plain[..], LEVEL)
            .map_err(|error| SnapshotError::new_err(error.to_string()))?;
        let bytes = [SNAPSHOT_MARK.as_bytes(), &checksum(&payload), &payload].concat();
        Ok(PyBytes::new(py, &bytes))
    }

    /// Simulated time, s since the start.
    #[getter]
    fn time_s(&self) -> f64 {
        self.time.as_s()
    }

    fn __repr__(&self) -> String {
        format!("<anergy.Snapshot at {} s>", self.time.as_s())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let load = py.get_type::<Self>().getattr("from_bytes")?;
        Ok((load, (self.to_bytes(py)?,)).into_pyobject(py)?.into_any())
    }
}
