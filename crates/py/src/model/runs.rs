//! Runs of a model, and simulations that Python steps.

use super::Model;
use crate::convert::{self, StepArgument};
use crate::result::RunResult;
use crate::run;
use crate::simulation::Simulation;
use anergy_simulation::run::RunOptions;
use pyo3::prelude::*;
use std::path::PathBuf;

#[pymethods]
impl Model {
    /// Simulates from the start; other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// until_s : float, optional
    ///     End, s since the start. Absent: the model's `[run]`, here and below.
    /// step_s : float or "auto", optional
    ///     Largest time step, s, or the automatic one.
    /// record_s : float, optional
    ///     Time between recorded rows, s.
    /// out : str or os.PathLike, optional
    ///     Directory to write results.mcap (while running) and summary.json into.
    /// controllers : list of Controller, optional
    ///     Your own; they take their signals over from schedules and controllers of the model.
    ///
    /// Returns
    /// -------
    /// Result
    ///     One column per channel.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     When the model is wrong.
    /// RunError
    ///     When a step fails (ConvergenceError: its numerics); `.result` has the rows until then,
    ///     as in exceptions of your controllers.
    /// Interrupted
    ///     After Ctrl-C, a KeyboardInterrupt; `.result` has the rows until then.
    /// OSError
    ///     When `out` cannot be written.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> result = anergy.examples.load("three-houses").simulate(until_s=600, record_s=60)
    /// >>> result["sf1.station.m_flow_kg_s"].shape
    /// (11,)
    #[pyo3(signature = (until_s=None, step_s=None, record_s=None, out=None, controllers=None))]
    fn simulate(
        &self,
        py: Python<'_>,
        until_s: Option<f64>,
        step_s: Option<StepArgument>,
        record_s: Option<f64>,
        out: Option<PathBuf>,
        controllers: Option<Vec<Bound<'_, PyAny>>>,
    ) -> PyResult<Py<RunResult>> {
        let options = RunOptions {
            until: until_s.map(|value| convert::time("until_s", value)).transpose()?,
            step: step_s.map(StepArgument::step).transpose()?,
            record: record_s.map(|value| convert::duration("record_s", value)).transpose()?,
        };
        run::run(py, self.plan(py)?, options, out.as_deref(), controllers)
    }

    /// A simulation to be stepped from outside: co-simulation, control, learning.
    ///
    /// Parameters
    /// ----------
    /// step_s : float or "auto", optional
    ///     What one `step()` advances, s; "auto": an automatic step. Absent: the model's `[run]`.
    /// controllers : list of Controller, optional
    ///     Your own; they take their signals over from schedules and controllers of the model.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     When the model is wrong.
    /// RunError
    ///     When its state at the start cannot be solved.
    ///
    /// Warns
    /// -----
    /// UserWarning
    ///     When the step is longer than the control of a station follows.
    #[pyo3(signature = (step_s=None, controllers=None))]
    fn simulation(
        &self,
        py: Python<'_>,
        step_s: Option<StepArgument>,
        controllers: Option<Vec<Bound<'_, PyAny>>>,
    ) -> PyResult<Simulation> {
        let step = step_s.map(StepArgument::step).transpose()?;
        Simulation::new(py, self.plan(py)?, step, controllers)
    }
}
