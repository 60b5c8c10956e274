//! The module `anergy._core`: the Python package `anergy` as far as it is written in Rust.
//!
//! Conversions and errors at the edge, no physics and no file format. What needs another Python
//! package (pandas, xarray, matplotlib) is in `python/anergy`.

mod arrow;
mod controller;
mod convert;
mod ensemble;
mod errors;
mod handle;
mod map;
mod model;
mod plots;
mod result;
mod run;
mod simulation;
mod snapshot;
mod steady;
mod tables;

/// The part of the package `anergy` that is written in Rust.
#[pyo3::pymodule]
mod _core {
    use crate::convert;
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::ensemble::{PyFolderLock, PyMembers, Variations};
    #[pymodule_export]
    use crate::errors::unknown_name;
    #[pymodule_export]
    use crate::handle::{Handle, Handles};
    #[pymodule_export]
    use crate::model::{Model, load_model};
    #[pymodule_export]
    use crate::result::{RunResult, load_result};
    #[pymodule_export]
    use crate::simulation::Simulation;
    #[pymodule_export]
    use crate::snapshot::Snapshot;

    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "its name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");

    /// Names and texts of the models that come with the package.
    const EXAMPLES: &[(&str, &str)] = &[
        ("three-houses", include_str!("../../../examples/three-houses/model.toml")),
        ("pump-hunting", include_str!("../../../examples/pump-hunting/n2.toml")),
    ];

    /// schema()
    /// --
    ///
    /// The grammar of the model file as a JSON Schema.
    ///
    /// Returns
    /// -------
    /// dict
    ///     For editors and validators; field names carry their units.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> sorted(anergy.schema()["properties"])[:3]
    /// ['circuit', 'controller', 'edge']
    #[pyfunction]
    fn schema(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        convert::to_python(py, &anergy_simulation::model_file::schema::schema())
    }

    /// Names and texts of the models that come with the package.
    #[pyfunction]
    #[pyo3(name = "_examples")]
    fn examples() -> Vec<(&'static str, &'static str)> {
        EXAMPLES.to_vec()
    }
}
