//! Who blocks whom and which loops will hunt, from Python.

use super::Model;
use crate::{convert, errors};
use anergy_network::elements::Element;
use anergy_network::two_port::Characteristic;
use anergy_simulation::build::build;
use anergy_simulation::error::RunError;
use anergy_simulation::model;
use anergy_simulation::simulation::Simulation;
use anergy_simulation::stability::blocking::Analysis;
use anergy_simulation::stability::{self, advise};
use anergy_simulation::steady::settle;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};

/// Points of a curve of a pump.
const POINTS: usize = 81;
/// Curves end at this multiple of the flow at full speed.
const BEYOND: f64 = 1.5;
/// The network of a pump that cannot open its check valve is followed to this multiple of the threshold.
const ABOVE_THRESHOLD: f64 = 1.1;
/// Largest map, positions of a pump.
const MAX_MAP: usize = 400;

#[pymethods]
impl Model {
    /// Who blocks whom and which loops will hunt, at the steady state, without simulating.
    ///
    /// As the program `anergy stability`. Other Python threads run meanwhile.
    ///
    /// Parameters
    /// ----------
    /// advise : bool
    ///     Also try remedies, each in a run of at least 960 s simulated: takes much longer.
    ///
    /// Returns
    /// -------
    /// Stability
    ///     Feeders with their margins, controllers with their critical gains, modes.
    ///
    /// Raises
    /// ------
    /// ModelError
    ///     When the model is wrong.
    /// ConvergenceError
    ///     When no steady state was found.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> stability = anergy.examples.load("three-houses").stability()
    /// >>> feeder = stability.feeders.row("sf1.feed_in_pump")
    /// >>> feeder["blocked"], feeder["blocked_by"], round(feeder["margin_speed"], 3)
    /// (False, 'sf2.feed_in_pump', 0.017)
    #[pyo3(signature = (advise=false))]
    fn stability<'py>(&self, py: Python<'py>, advise: bool) -> PyResult<Bound<'py, PyAny>> {
        let found = self.ask(py, |model| analyse(model, advise))?;
        let found = convert::to_python(py, &found)?;
        py.import("anergy.stability")?.getattr("Stability")?.call_method1("from_dict", (found,))
    }

    /// Who is blocked and what flows over the speeds of two pumps; all else as in the steady state.
    ///
    /// Parameters
    /// ----------
    /// first, second : str
    ///     Pumps whose command is their speed.
    /// n : int
    ///     Speeds of each, from 0 to the largest one: n times n states of the network are solved.
    ///
    /// Returns
    /// -------
    /// BlockingMap
    ///     Flows and blocked feeders as grids of shape `(n, n)`; `plot()` draws it.
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For a pump that does not exist.
    /// ValueError
    ///     For what is no pump, or holds something else than its speed; for n below 2 or above 400.
    /// ModelError, ConvergenceError
    ///     As `stability`.
    ///
    /// Examples
    /// --------
    /// >>> import anergy
    /// >>> model = anergy.examples.load("three-houses")
    /// >>> grid = model.blocking_map("sf1.feed_in_pump", "sf2.feed_in_pump", n=11)
    /// >>> bool(grid.blocked["sf1.feed_in_pump"][9, 10])  # speeds 0.9 and 1.0
    /// True
    #[pyo3(signature = (first, second, n=25))]
    fn blocking_map<'py>(
        &self,
        py: Python<'py>,
        first: &str,
        second: &str,
        n: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !(2..=MAX_MAP).contains(&n) {
            let message = format!("n is {n}; a map has 2 to {MAX_MAP} speeds of each pump");
            return Err(PyValueError::new_err(message));
        }
        let map = self.ask(py, |model| blocking_map(model, first, second, n))?;
        let map = convert::to_python(py, &map.map_err(PyValueError::new_err)?)?;
        py.import("anergy.stability")?.getattr("BlockingMap")?.call_method1("from_dict", (map,))
    }

    /// Plots a feeder with matplotlib: the head of its pump and what the network opposes, over its flow.
    ///
    /// Drawn are the curves of the pump at its present speed, at the threshold below which its check
    /// valve is shut and at full speed; the pressure difference that all the others put across the
    /// pump while it delivers; and the operating point.
    ///
    /// Parameters
    /// ----------
    /// pump : str
    ///     A feeder: a pump in series with a check valve, whose command is its speed.
    /// ax : matplotlib.axes.Axes, optional
    ///     Where to draw; absent: a new figure.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///
    /// Raises
    /// ------
    /// UnknownNameError
    ///     For what is no feeder.
    /// ImportError
    ///     Without matplotlib: `pip install anergy[plot]`.
    /// ValueError
    ///     For a pump that holds something else than its speed.
    /// ModelError, ConvergenceError
    ///     As `stability`.
    #[pyo3(signature = (pump, ax=None))]
    fn plot_pump<'py>(
        &self,
        py: Python<'py>,
        pump: &str,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let curves = self.ask(py, |model| pump_curves(model, pump))?;
        let curves = convert::to_python(py, &curves.map_err(PyValueError::new_err)?)?;
        let density_kg_m3 = self.model.medium.density_kg_m3;
        py.import("anergy._stability_plots")?.getattr("pump")?.call1((curves, density_kg_m3, ax))
    }
}

impl Model {
    /// Asks without holding the interpreter.
    fn ask<T: Send>(
        &self,
        py: Python<'_>,
        question: impl Fn(&model::Model) -> Result<T, RunError> + Send + Sync,
    ) -> PyResult<T> {
        py.detach(|| question(&self.model))
            .map_err(|error| errors::run_error(py, &error, &self.model.text, &self.origin))
    }
}

/// What `anergy stability --json` writes.
fn analyse(model: &model::Model, advise: bool) -> Result<Value, RunError> {
    let found = stability::analyse(model)?;
    let mut value = json!(found);
    if advise {
        let (before, advice) = advise::advise(model, &found)?;
        value["before"] = json!(before);
        value["advice"] = json!(advice);
    }
    Ok(value)
}

fn settled(model: &model::Model) -> Result<Simulation, RunError> {
    let mut simulation = Simulation::new(build(model)?)?;
    settle(&mut simulation)?;
    Ok(simulation)
}

/// Place of a pump that is commanded by its speed, or why it cannot be asked about.
fn pump_of(simulation: &Simulation, pump: &str) -> Result<Result<usize, String>, RunError> {
    let plan = simulation.plan();
    let Some(edge) = plan.edge_names().iter().position(|name| name == pump) else {
        let (name, hint) = (pump.to_owned(), String::new());
        return Err(RunError::UnknownName { what: "pump", name, hint });
    };
    Ok(match &plan.network().edges[edge].element {
        Element::Pump(pump) if !pump.holds() => Ok(edge),
        Element::Pump(_) => {
            Err(format!("{pump} holds a flow or a head and chooses its speed by itself"))
        }
        _ => Err(format!("{pump} is no pump")),
    })
}

fn largest_speed(simulation: &Simulation, edge: usize) -> f64 {
    match &simulation.plan().network().edges[edge].element {
        Element::Pump(pump) => pump.speed_max(),
        _ => 1.0,
    }
}

/// `n` values from `from` to `to`.
#[expect(clippy::cast_precision_loss, reason = "a few hundred at most")]
fn spread(from: f64, to: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| from + (to - from) * i as f64 / (n - 1) as f64).collect()
}

fn blocking_map(
    model: &model::Model,
    first: &str,
    second: &str,
    n: usize,
) -> Result<Result<Value, String>, RunError> {
    let simulation = settled(model)?;
    let (a, b) = match (pump_of(&simulation, first)?, pump_of(&simulation, second)?) {
        (Ok(a), Ok(b)) if a == b => return Ok(Err("a map needs two different pumps".into())),
        (Ok(a), Ok(b)) => (a, b),
        (Err(problem), _) | (_, Err(problem)) => return Ok(Err(problem)),
    };
    let here = &simulation.network_state().position;
    let largest = largest_speed(&simulation, a).max(largest_speed(&simulation, b));
    let speeds = spread(0.0, largest, n);
    let mut analysis = Analysis::new(&simulation)?;
    let feeders: Vec<String> = analysis.margins()?.into_iter().map(|margin| margin.id).collect();
    let points = analysis.map(first, second, &speeds)?;
    let flows: Vec<&[f64]> = points.iter().map(|point| point.m_flow_kg_s.as_slice()).collect();
    let blocked: Vec<Vec<bool>> = points
        .iter()
        .map(|point| feeders.iter().map(|id| point.blocked.contains(id)).collect())
        .collect();
    Ok(Ok(json!({
        "first": first, "second": second, "speeds": speeds, "present": [here[a], here[b]],
        "feeders": feeders, "m_flow_kg_s": flows, "blocked": blocked,
    })))
}

/// Curves of a pump and of what opposes it, and its margin.
fn pump_curves(model: &model::Model, pump: &str) -> Result<Result<Value, String>, RunError> {
    let simulation = settled(model)?;
    let edge = match pump_of(&simulation, pump)? {
        Ok(edge) => edge,
        Err(problem) => return Ok(Err(problem)),
    };
    let (plan, state) = (simulation.plan(), simulation.network_state());
    let mut analysis = Analysis::new(&simulation)?;
    let margins = analysis.margins()?;
    let Some(place) = margins.iter().position(|margin| margin.id == pump) else {
        let hint = "; a feeder is a pump in series with a check valve".into();
        return Err(RunError::UnknownName { what: "feeder", name: pump.to_owned(), hint });
    };
    let margin = &margins[place];
    let element = &plan.network().edges[edge].element;
    let head = |m_flow_kg_s: f64, position: f64| {
        let mut edge_state = state.edge_state(plan.network(), edge);
        edge_state.position = position;
        match element.characteristic(m_flow_kg_s, &edge_state) {
            Characteristic::PressureLoss(loss) => -loss.value,
            _ => f64::NAN,
        }
    };
    let full = margin.speed_max;
    let threshold = margin.threshold_speed;
    let last = threshold.filter(|threshold| *threshold >= full);
    let last = last.map_or(full, |threshold| ABOVE_THRESHOLD * threshold);
    let mut opposing = (Vec::new(), Vec::new());
    if let Some(opposing_pa) = margin.opposing_dp_pa {
        opposing.0.push(0.0);
        opposing.1.push(opposing_pa);
    }
    let mut at_full = 0.0_f64;
    for speed in spread(threshold.unwrap_or(0.0), last, POINTS) {
        let point = analysis.map(pump, pump, &[speed])?;
        let flow = point.first().map_or(0.0, |point| point.m_flow_kg_s[place]);
        if flow > 0.0 {
            opposing.0.push(flow);
            opposing.1.push(head(flow, speed));
            at_full = at_full.max(flow);
        }
    }
    let free = 2.0 * element.m_flow_nominal_kg_s() * full;
    let end = if at_full > 0.0 { free.min(BEYOND * at_full) } else { free };
    let flows = spread(0.0, end, POINTS);
    let curve = |name: &str, speed: f64| {
        let heads: Vec<f64> = flows.iter().map(|m| head(*m, speed)).collect();
        json!({"at": name, "speed": speed, "m_flow_kg_s": flows, "head_pa": heads})
    };
    let mut curves = vec![curve("present", margin.speed)];
    curves.extend(threshold.map(|threshold| curve("threshold", threshold)));
    curves.push(curve("full", full));
    Ok(Ok(json!({
        "margin": margin, "curves": curves, "head_pa": head(margin.m_flow_kg_s, margin.speed),
        "opposing": {"m_flow_kg_s": opposing.0, "dp_pa": opposing.1},
    })))
}
