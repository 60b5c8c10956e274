"""Controllers of your own, called inside of a run.

>>> import anergy
>>> class PumpPi(anergy.Controller):
...     '''Holds the flow of a feeder by the speed of its pump.'''
...
...     interval_s = 5.0
...
...     def __init__(self, site, set_point_kg_s):
...         self.measures = [f"{site}.feed_in_pump.m_flow_kg_s"]
...         self.acts_on = [f"{site}.feed_in_pump.speed"]
...         self.set_point_kg_s = set_point_kg_s
...
...     def start(self):
...         self.integral = 0.5
...
...     def update(self, time_s, measured):
...         error = self.set_point_kg_s - measured[0]
...         low, high = self.limits[0]
...         self.integral = min(max(self.integral + 0.2 * error, low), high)
...         return min(max(self.integral + 0.6 * error, low), high)
>>> model = anergy.examples.load("three-houses")
>>> result = model.simulate(until_s=600, controllers=[PumpPi("sf2", 0.05)])
>>> round(float(result["sf2.feed_in_pump.m_flow_kg_s"][-1]), 3)
0.05
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import SupportsFloat, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = ["Controller", "Outputs"]

Outputs: TypeAlias = SupportsFloat | Sequence[float] | npt.NDArray[np.float64] | None
"""What `Controller.update` returns."""


class Controller(ABC):
    """A controller of your own: subclass it, and hand instances to `Model.simulate` or `Model.simulation`.

    It runs after the controllers of the model, at its own interval; steps end at its updates. Its
    signals are its own: schedules and controllers of the model leave them alone, `Simulation.set`
    overrules it and `Simulation.release` gives a signal back to it. The steady state (`Model.solve`,
    `initial = "steady"`) and `Model.stability` know nothing of it.

    For `Simulation.snapshot` add two methods: `get_state()` returns all that it remembers (anything that
    can be pickled), `set_state(state)` takes it back.
    """

    interval_s: float
    """Time between two updates, s; positive."""
    offset_s: float = 0.0
    """Time of the first update, s."""
    measures: Sequence[str] = ()
    """Names of the channels that it sees."""
    acts_on: Sequence[str]
    """Names of the signals that it drives."""
    name: str = ""
    """What messages call it; absent: its class and signals."""
    limits: npt.NDArray[np.float64]
    """Smallest and largest value of each signal, shape (len(acts_on), 2); set when it is attached."""

    def start(self) -> None:
        """Called at the start of each simulation and by `Simulation.reset`: forget what was."""

    @abstractmethod
    def update(self, time_s: float, measured: npt.NDArray[np.float64]) -> Outputs:
        """The values of the signals from now on.

        Parameters
        ----------
        time_s : float
            Simulated time, s since the start.
        measured : numpy.ndarray
            Values of `measures` in SI, shape (len(measures),). The array is used again for the next
            update: copy what you keep.

        Returns
        -------
        float, sequence of float, numpy.ndarray or None
            A value for each of `acts_on`, in SI and within `limits`; None leaves them as they are.
        """
