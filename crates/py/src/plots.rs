//! Pictures of results: drawn by `anergy._plots` and `anergy._maps`, which need matplotlib.

use crate::result::RunResult;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

type Drawn<'py> = PyResult<Bound<'py, PyAny>>;

fn draw<'py>(py: Python<'py>, module: &str, function: &str) -> Drawn<'py> {
    py.import(module)?.getattr(function)
}

#[pymethods]
impl RunResult {
    /// Draws the network, its lines coloured by a quantity, with arrows along the flow.
    ///
    /// Places are where the model says, or laid out by the lengths of the pipes.
    ///
    /// Parameters
    /// ----------
    /// quantity : str
    ///     What channels of edges or nodes end with: `t_k`, `p_pa`, `m_flow_kg_s`, `dp_pa`, `q_loss_w`.
    /// time_s : float, optional
    ///     The last row at or before it; absent: the end.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// UnknownNameError
    ///     For a quantity that no line has.
    /// ValueError
    ///     For a time outside of the results.
    #[pyo3(signature = (quantity="t_k", time_s=None, ax=None))]
    fn plot_map<'py>(
        slf: &Bound<'py, Self>,
        quantity: &str,
        time_s: Option<f64>,
        ax: Option<Bound<'py, PyAny>>,
    ) -> Drawn<'py> {
        draw(slf.py(), "anergy._maps", "of_result")?.call1((slf, quantity, time_s, ax))
    }

    /// Draws values of channels from the largest to the smallest, over the time for which they are exceeded.
    ///
    /// Parameters
    /// ----------
    /// *channels : str
    ///     One or more, of one unit.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// ValueError
    ///     For no channel, channels of different units, or fewer than two rows.
    #[pyo3(signature = (*channels, ax=None))]
    fn plot_duration<'py>(
        slf: &Bound<'py, Self>,
        channels: &Bound<'py, PyTuple>,
        ax: Option<Bound<'py, PyAny>>,
    ) -> Drawn<'py> {
        draw(slf.py(), "anergy._plots", "duration")?.call1((slf, channels, ax))
    }

    /// Draws a channel over the hour of the day and the day: patterns of days and seasons at a glance.
    ///
    /// Parameters
    /// ----------
    /// channel : str
    ///     The channel.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// ValueError
    ///     For results of less than a day.
    #[pyo3(signature = (channel, ax=None))]
    fn plot_carpet<'py>(
        slf: &Bound<'py, Self>,
        channel: &str,
        ax: Option<Bound<'py, PyAny>>,
    ) -> Drawn<'py> {
        draw(slf.py(), "anergy._plots", "carpet")?.call1((slf, channel, ax))
    }

    /// Draws the temperatures of the layers of a storage over time, the top above.
    ///
    /// Parameters
    /// ----------
    /// unit : str
    ///     Name of the storage, for example `h1.storage`.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// UnknownNameError
    ///     When there is no storage of that name.
    #[pyo3(signature = (unit, ax=None))]
    fn plot_storage<'py>(
        slf: &Bound<'py, Self>,
        unit: &str,
        ax: Option<Bound<'py, PyAny>>,
    ) -> Drawn<'py> {
        draw(slf.py(), "anergy._plots", "storage")?.call1((slf, unit, ax))
    }

    /// Draws where the heat of the run came from and where it went (a Sankey diagram).
    ///
    /// Stations with what they gave and took, losses, pumps, boundaries, and what the water holds.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// ValueError
    ///     For a run that moved no heat, or that has no balances because it was killed.
    #[pyo3(signature = (ax=None))]
    fn plot_sankey<'py>(slf: &Bound<'py, Self>, ax: Option<Bound<'py, PyAny>>) -> Drawn<'py> {
        draw(slf.py(), "anergy._plots", "sankey")?.call1((slf, ax))
    }
}
