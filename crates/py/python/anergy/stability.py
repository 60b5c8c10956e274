"""Who blocks whom, which loops will hunt, and how far it is to the limit."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anergy import _display, _stability_plots
from anergy.steady import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["BlockingMap", "Mode", "Stability"]

_FEEDERS = (
    "id",
    "speed",
    "threshold_speed",
    "margin_speed",
    "speed_max",
    "m_flow_kg_s",
    "requested_m_flow_kg_s",
    "opposing_dp_pa",
    "margin_dp_pa",
    "blocked",
    "held_back",
    "blocked_by",
)
_CONTROLLERS = (
    "id",
    "gain",
    "critical_gain",
    "critical_period_s",
    "critical_gain_alone",
    "relative_gain",
    "stable",
    "open",
)
_TEXTS = ("id", "blocked_by", "open")
_FLAGS = ("blocked", "held_back", "stable")


@dataclass(frozen=True)
class Mode:
    """A mode in which controllers and network swing."""

    period_s: float
    """Period, s."""
    growth_per_s: float
    """Growth of its amplitude, 1/s; negative decays."""
    damping: float
    """Damping ratio; negative grows."""
    participation: dict[str, float]
    """Share of each controller, all together 1."""
    phase_deg: dict[str, float]
    """Phase of the output of each controller against the one that takes part most, degrees."""
    multiplicity: int
    """Modes that are equal to this one, itself included."""

    @property
    def grows(self) -> bool:
        """Whether its amplitude grows: the controllers hunt."""
        return self.growth_per_s > 0


@dataclass(frozen=True)
class Stability:
    """Blocking margins of feeders, limits of controllers and modes, from `Model.stability`.

    >>> import anergy
    >>> stability = anergy.examples.load("pump-hunting").stability()
    >>> controller = stability.controllers.row("pi1")
    >>> controller["stable"], round(controller["critical_gain"] / controller["gain"], 2)
    (False, 0.68)
    >>> round(stability.modes[0].period_s, 1), stability.modes[0].grows
    (9.3, True)
    """

    feeders: Table
    """A row per feeder (a pump in series with a check valve): id, speed, threshold_speed (below it the
    check valve is shut), margin_speed, speed_max (all relative), m_flow_kg_s, requested_m_flow_kg_s,
    opposing_dp_pa, margin_dp_pa, blocked, held_back, blocked_by. NaN and "" where there is none."""
    controllers: Table
    """A row per controller: id, gain, critical_gain, critical_period_s, critical_gain_alone,
    relative_gain, stable, open (why it is not judged). NaN and "" where there is none."""
    modes: list[Mode]
    """Oscillating modes, the fastest growing first."""
    before: dict[str, list[str]] | None
    """With `advise`: what swings and is blocked in a run without remedy."""
    advice: list[dict[str, Any]] | None
    """With `advise`: remedies with remedy, changes, outcome, helps, verdict."""
    _data: dict[str, Any] = field(repr=False, compare=False)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Stability:
        """From what `to_dict` gives, or `anergy stability --json` writes."""
        return cls(
            feeders=_table(data["feeders"], _FEEDERS),
            controllers=_table(data["controllers"], _CONTROLLERS),
            modes=[Mode(**mode) for mode in data["modes"]],
            before=data.get("before"),
            advice=data.get("advice"),
            _data=dict(data),
        )

    def to_dict(self) -> dict[str, Any]:
        """All of it as dicts and lists, equal to what `anergy stability --json` writes.

        Has also what the tables leave out: the opponents of each feeder, the group of each controller.
        """
        return deepcopy(self._data)

    @property
    def stable(self) -> bool:
        """Whether no mode grows."""
        return bool(np.all(self.controllers["stable"]))

    def plot_modes(self, mode: int = 0, ax: Axes | None = None) -> Axes:
        """Draws the shape of a mode: the share of each controller, downwards where it swings against.

        Parameters
        ----------
        mode : int
            Its place in `modes`; 0 is the fastest growing.
        ax : matplotlib.axes.Axes, optional
            Where to draw; absent: a new figure.

        Raises
        ------
        ImportError
            Without matplotlib: `pip install anergy[plot]`.
        ValueError
            When there is no such mode.
        """
        if not 0 <= mode < len(self.modes):
            raise ValueError(f"there is no mode {mode}: there are {len(self.modes)}")
        return _stability_plots.mode(self.modes[mode], ax)

    def plot_feeders(self, ax: Axes | None = None) -> Axes:
        """Draws how far every feeder is from where its check valve shuts, in relative speed.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; absent: a new figure.

        Raises
        ------
        ImportError
            Without matplotlib: `pip install anergy[plot]`.
        ValueError
            When there are no feeders.
        """
        if not self.feeders.ids:
            raise ValueError("there are no feeders: no pump stands in series with a check valve")
        return _stability_plots.feeders(self.feeders, ax)

    def __repr__(self) -> str:
        stuck = int(np.sum(self.feeders["blocked"] | self.feeders["held_back"]))
        growing = sum(mode.multiplicity for mode in self.modes if mode.grows)
        return (
            f"<anergy.Stability: {len(self.feeders.ids)} feeders ({stuck} blocked or held back), "
            f"{len(self.controllers.ids)} controllers, {growing} growing modes>"
        )

    def _repr_html_(self) -> str:
        modes = Table(
            {
                "id": [", ".join(mode.participation) for mode in self.modes],
                "period_s": np.array([mode.period_s for mode in self.modes], float),
                "growth_per_s": np.array([mode.growth_per_s for mode in self.modes], float),
            }
        )
        parts = [self.feeders, self.controllers, modes]
        html = "".join(_display.table_html(part) for part in parts if part.ids)
        if self.advice:
            names = [one["remedy"].replace("_", " ") for one in self.advice]
            verdicts = [one["verdict"] for one in self.advice]
            html += _display.table_html(Table({"id": names, "verdict": verdicts}))
        return html


@dataclass(frozen=True)
class BlockingMap:
    """Who is blocked over the speeds of two pumps, from `Model.blocking_map`.

    >>> import anergy
    >>> model = anergy.examples.load("three-houses")
    >>> grid = model.blocking_map("sf1.feed_in_pump", "sf2.feed_in_pump", n=6)
    >>> grid.speeds.tolist(), grid.blocked["sf1.feed_in_pump"].sum().item()
    ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], 10)
    """

    first: str
    """The pump of the rows."""
    second: str
    """The pump of the columns."""
    speeds: npt.NDArray[np.float64]
    """Relative speeds of both, shape (n,)."""
    present: tuple[float, float]
    """Their speeds in the steady state."""
    m_flow_kg_s: dict[str, npt.NDArray[np.float64]]
    """Flow of each feeder, shape (n, n): [i, j] is at speed i of the first, j of the second."""
    blocked: dict[str, npt.NDArray[np.bool_]]
    """Whether the pump of a feeder runs and delivers nothing, shape (n, n)."""

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> BlockingMap:
        """From lists; rows of the points run over the second pump first."""
        n = len(data["speeds"])
        flows = np.array(data["m_flow_kg_s"], float).reshape(n, n, -1)
        blocked = np.array(data["blocked"], bool).reshape(n, n, -1)
        return cls(
            first=data["first"],
            second=data["second"],
            speeds=np.array(data["speeds"], float),
            present=(data["present"][0], data["present"][1]),
            m_flow_kg_s={id: flows[:, :, k] for k, id in enumerate(data["feeders"])},
            blocked={id: blocked[:, :, k] for k, id in enumerate(data["feeders"])},
        )

    def to_table(self) -> Table:
        """A row per point: id (who is blocked, "" for nobody), speed_1, speed_2, flows in kg/s."""
        first, second = np.meshgrid(self.speeds, self.speeds, indexing="ij")
        who = [
            ", ".join(id for id, grid in self.blocked.items() if grid.flat[k])
            for k in range(first.size)
        ]
        flows = {f"{id}.m_flow_kg_s": grid.ravel() for id, grid in self.m_flow_kg_s.items()}
        columns = {"id": np.array(who, str), "speed_1": first.ravel(), "speed_2": second.ravel()}
        return Table(columns | flows)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws who is blocked over the two speeds, and the present ones.

        Raises ImportError without matplotlib: `pip install anergy[plot]`.
        """
        return _stability_plots.blocking_map(self, ax)

    def __repr__(self) -> str:
        n = len(self.speeds)
        return f"<anergy.BlockingMap: {self.first} and {self.second}, {n} x {n} speeds>"


def _table(rows: list[dict[str, Any]], names: tuple[str, ...]) -> Table:
    def column(name: str) -> npt.NDArray[Any]:
        values = [row.get(name) for row in rows]
        if name in _TEXTS:
            return np.array(["" if value is None else value for value in values], str)
        if name in _FLAGS:
            return np.array(values, bool)
        return np.array([np.nan if value is None else value for value in values], float)

    return Table({name: column(name) for name in names})
