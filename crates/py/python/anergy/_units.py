"""Units of the field for pictures: l/min, bar, degC, kW, kWh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

QUANTITIES = {
    "m_flow": "flow",
    "v_flow": "flow",
    "q_flow": "heat flow",
    "q_loss": "heat loss",
    "dp": "pressure difference",
    "p": "pressure",
    "t": "temperature",
}
"""Words for the quantities in the names of channels."""


@dataclass(frozen=True)
class Shown:
    """How numbers of one SI unit are shown."""

    unit: str
    factor: float = 1.0
    offset: float = 0.0

    def of(self, si: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Numbers in SI, in the unit that is shown."""
        return np.asarray(si, float) * self.factor + self.offset

    def label(self, quantity: str) -> str:
        """What stands at an axis: `flow in l/min`."""
        return f"{quantity} in {self.unit}" if self.unit else quantity


def shown(unit: str, density_kg_m3: float) -> Shown:
    """How a unit of channels is shown."""
    known = {
        "kg s-1": Shown("l/min", 60_000.0 / density_kg_m3),
        "m3 s-1": Shown("l/min", 60_000.0),
        "Pa": Shown("bar", 1e-5),
        "K": Shown("°C", 1.0, -273.15),
        "delta K": Shown("K"),
        "W": Shown("kW", 1e-3),
        "J": Shown("kWh", 1 / 3.6e6),
        "m3": Shown("m³"),
        "1": Shown(""),
    }
    return known.get(unit, Shown(unit.replace("-1", "⁻¹")))


def quantity(channel: str) -> str:
    """What a channel is about: `flow` for `pump.m_flow_kg_s`."""
    name = channel.rpartition(".")[2]
    for beginning, word in QUANTITIES.items():
        if name.startswith(f"{beginning}_"):
            return word
    for unit, word in (("_k", "temperature"), ("_pa", "pressure"), ("_w", "power"), ("_j", "energy")):
        if name.endswith(unit):
            return word
    return name.replace("_", " ")


def hours(end_s: float) -> tuple[float, str]:
    """Seconds of a unit of time that suits a span, and its name."""
    for seconds, name, least in ((86_400.0, "d", 3.0), (3600.0, "h", 3.0), (60.0, "min", 3.0)):
        if end_s >= least * seconds:
            return seconds, name
    return 1.0, "s"
