"""Thermo-hydraulic simulation of district heating and cooling networks with prosumers.

A model file, or a `Grid` built in Python, becomes a `Model`; `solve` gives its steady state, `simulate` a run, `simulation` a
simulation to be stepped from outside. All quantities are in SI, their names end with their units.

>>> import anergy
>>> model = anergy.examples.load("three-houses")
>>> result = model.simulate(until_s=3600, record_s=60)
>>> flow = 60 * result["sf1.station.m_flow_kg_s"]  # l/min
>>> flow[[30, -1]].round(2).tolist()
[0.78, 3.34]
>>> result.events[0]["message"].partition(";")[0]
'sf1.station is blocked: it delivers 0.78 of 3.50 l/min wanted'
"""

from typing import TYPE_CHECKING, Any

from anergy import examples
from anergy._core import (
    Handle,
    Handles,
    Model,
    Result,
    Simulation,
    Snapshot,
    Variations,
    __version__,
    schema,
)
from anergy.controller import Controller
from anergy.ensembles import Ensemble, ensemble
from anergy.errors import (
    AnergyError,
    ConvergenceError,
    Interrupted,
    ModelError,
    OutOfRangeError,
    RecordingError,
    RunError,
    SnapshotError,
    UnknownNameError,
    WorkersLost,
)
from anergy.explanation import Explanation, explain
from anergy.stability import BlockingMap, Mode, Stability
from anergy.steady import Steady, Table

if TYPE_CHECKING:
    from anergy.grid import Grid

__all__ = [
    "AnergyError",
    "BlockingMap",
    "Controller",
    "ConvergenceError",
    "Ensemble",
    "Explanation",
    "Grid",
    "Handle",
    "Handles",
    "Interrupted",
    "Mode",
    "Model",
    "ModelError",
    "OutOfRangeError",
    "RecordingError",
    "Result",
    "RunError",
    "Simulation",
    "Snapshot",
    "SnapshotError",
    "Stability",
    "Steady",
    "Table",
    "UnknownNameError",
    "Variations",
    "WorkersLost",
    "__version__",
    "ensemble",
    "examples",
    "explain",
    "schema",
]


# What other packages call it.
_ELSEWHERE = {
    "run": "Model.simulate runs a model",
    "simulate": "Model.simulate runs a model",
    "solve": "Model.solve finds the steady state of a model",
    "load": "Model.from_file reads a model, Result.from_file results",
    "open": "Model.from_file reads a model, Result.from_file results",
    "read": "Model.from_file reads a model, Result.from_file results",
}


def __getattr__(name: str) -> Any:
    # Its methods are made from the schema, which takes longer than the rest of the package.
    if name == "Grid":
        from anergy.grid import Grid

        return Grid
    hint = f"; {_ELSEWHERE[name]}" if name in _ELSEWHERE else ""
    raise AttributeError(f"module 'anergy' has no attribute {name!r}{hint}")
