"""Thermo-hydraulic simulation of district heating and cooling networks with prosumers.

A model file becomes a `Model`; `solve` gives its steady state, `simulate` a run, `simulation` a
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

from anergy import examples
from anergy._core import (
    Handle,
    Handles,
    Model,
    Result,
    Simulation,
    Snapshot,
    __version__,
    schema,
)
from anergy.controller import Controller
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
)
from anergy.stability import BlockingMap, Mode, Stability
from anergy.steady import Steady, Table

__all__ = [
    "AnergyError",
    "BlockingMap",
    "Controller",
    "ConvergenceError",
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
    "__version__",
    "examples",
    "schema",
]
