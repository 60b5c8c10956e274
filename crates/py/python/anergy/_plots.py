"""Draws results over time with matplotlib, which is imported when it is asked for."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anergy._core import _unknown_name
from anergy._export import new_axes
from anergy._units import hours, quantity, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from anergy._core import Result

DAY_S = 86_400.0
BANDS = 10
"""Bands of a side, besides one for all others."""
IN, OUT, CORE = "#cf5500", "#0068ac", "#4a525c"


def duration(result: Result, channels: Sequence[str], ax: Axes | None) -> Axes:
    """Values of channels from the largest to the smallest, over the time for which they are exceeded."""
    unit, label = _one_unit(result, channels, "plot_duration")
    spans = _spans(result.time_s)
    total_s = float(spans.sum())
    seconds, name = hours(total_s)
    axes = ax or new_axes()
    for channel in channels:
        values = result[channel][:-1]
        order = np.argsort(values, kind="stable")[::-1]
        ends = np.concatenate([[0.0], np.cumsum(spans[order])]) / seconds
        axes.stairs(unit.of(values[order]), ends, baseline=None, label=channel, linewidth=1.8)
    axes.set_xlim(0, total_s / seconds)
    axes.set_xlabel(f"time with at least this value in {name}")
    axes.set_ylabel(label)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=9)
    return axes


def carpet(result: Result, channel: str, ax: Axes | None) -> Axes:
    """A channel over the hour of the day and the day."""
    unit = shown(result.unit(channel), result._density_kg_m3())
    times, values = result.time_s, unit.of(result[channel])
    if len(times) < 3 or times[-1] - times[0] < DAY_S:
        raise ValueError("a carpet plot needs results of a day or more")
    rows = max(1, round(DAY_S / float(np.median(np.diff(times)))))
    # The calendar's day where the model has one, otherwise the day of the run.
    start_s = result._map()["start_s"] % DAY_S
    since = times[:-1] + start_s
    day, slot = np.divmod(since, DAY_S)
    days, slots = day.astype(int), np.minimum((slot / DAY_S * rows).astype(int), rows - 1)
    grid = np.full((rows, int(days[-1]) + 1), np.nan)
    grid[slots, days] = values[:-1]
    axes = ax or new_axes(8.0, 4.2)
    mesh = axes.pcolormesh(
        np.arange(grid.shape[1] + 1) + 0.5, np.linspace(0, 24, rows + 1), grid, cmap="inferno", shading="flat"
    )
    axes.set_xlabel("day, from that of the start" if start_s else "day of the run")
    axes.set_ylabel("hour of the day (UTC)" if start_s else "hour of the day")
    axes.set_yticks(range(0, 25, 6))
    axes.locator_params(axis="x", integer=True)
    axes.figure.colorbar(mesh, ax=axes, label=unit.label(quantity(channel)), pad=0.02)
    axes.set_title(channel, fontsize=10)
    return axes


def storage(result: Result, unit: str, ax: Axes | None) -> Axes:
    """Temperatures of the layers of a storage over time, the top above."""
    found = {}
    for name in result:
        layer = re.fullmatch(rf"{re.escape(unit)}\.t_(\d+)_k", name)
        if layer:
            found[int(layer[1])] = name
    if len(found) < 2:
        storages = sorted({name.rpartition(".")[0] for name in result if re.search(r"\.t_2_k$", name)})
        raise _unknown_name("storage", unit, storages)
    look = shown("K", 1.0)
    layers = look.of([result[found[number]] for number in sorted(found)])
    seconds, name = hours(float(result.time_s[-1]))
    axes = ax or new_axes(8.0, 4.2)
    times = result.time_s / seconds
    mesh = axes.pcolormesh(times, np.arange(1, len(found) + 1), layers, cmap="inferno", shading="nearest", rasterized=True)
    axes.set_xlabel(f"time in {name}")
    axes.set_ylabel("layer (1 is the bottom)")
    axes.locator_params(axis="y", integer=True)
    axes.figure.colorbar(mesh, ax=axes, label="temperature in °C", pad=0.02)
    axes.set_title(unit, fontsize=10)
    return axes


def sankey(result: Result, ax: Axes | None) -> Axes:
    """Where the heat of a run came from and where it went, from its indicators and balances."""
    sources, sinks = flows(result)
    total = max(sum(sources.values()), sum(sinks.values()))
    if total <= 0:
        raise ValueError("the run moved no heat: there is nothing to draw")
    height = 0.6 * max(len(sources), len(sinks), 4) + 2.2
    axes = ax or new_axes(9.0, height)
    gap = 0.05 * total
    # Two lines of text need this much.
    least = 0.55 * total / height
    _side(axes, sources, total, gap, least, left=True)
    _side(axes, sinks, total, gap, least, left=False)
    axes.fill_between([-0.04, 0.04], 0, total, color=CORE, linewidth=0)
    axes.text(0, total + 0.4 * gap, f"network\n{_number(total)} kWh", ha="center", va="bottom", fontsize=10)
    axes.set_xlim(-1.75, 1.75)
    axes.margins(y=0.08)
    axes.set_axis_off()
    axes.set_title(f"{result.model_name}: heat in kWh", fontsize=10)
    return axes


def flows(result: Result) -> tuple[dict[str, float], dict[str, float]]:
    """Heat in kWh that came and that went, by name; each station with what it gave and took."""
    summary = result.summary
    stations = summary.get("kpis", {}).get("stations", {})
    sources = {name: one.get("heat_given_kwh", 0.0) for name, one in stations.items()}
    sinks = {name: one.get("heat_taken_kwh", 0.0) for name, one in stations.items()}
    balance = {one["label"]: one["value"] for one in summary.get("balances", []) if one["unit"] == "kWh"}
    if not balance:
        raise ValueError("the results have no balances: the run was not finished")
    # What units do that stand behind no station, and what the pipes between a station and its unit do.
    net = balance["heat from units"] - sum(sources.values()) + sum(sinks.values())
    others = {
        "beside the stations": net if abs(net) > 1e-6 * abs(sum(sources.values()) + sum(sinks.values())) else 0.0,
        "pumps": balance.get("heat from pumps", 0.0),
        "boundaries": balance.get("heat through boundaries", 0.0),
        "friction": balance.get("heat of friction", 0.0),
        "losses": -balance.get("heat lost", 0.0),
        "water in the pipes": -balance.get("heat stored", 0.0),
    }
    sources |= {name: value for name, value in others.items() if value > 0}
    sinks |= {name: -value for name, value in others.items() if value < 0}
    if "losses" in sources:
        sources["gains from the ground"] = sources.pop("losses")
    least = 5e-4 * max(sum(sources.values()), sum(sinks.values()))

    def kept(found: dict[str, float]) -> dict[str, float]:
        large = sorted(((name, value) for name, value in found.items() if value > least), key=lambda one: -one[1])
        bands, rest = dict(large[:BANDS]), large[BANDS:]
        if rest:
            bands[f"{len(rest)} others"] = sum(value for _, value in rest)
        return bands

    return kept(sources), kept(sinks)


def _side(axes: Axes, flows: dict[str, float], total: float, gap: float, least: float, left: bool) -> None:
    """Bands from the names of one side to the core."""
    slots = [max(value, least) + gap for value in flows.values()]
    outside = sum(slots) - gap
    at_core, at_name = total, total / 2 + outside / 2
    sign = -1.0 if left else 1.0
    for (name, value), slot in zip(flows.items(), slots, strict=True):
        middle = at_name - (slot - gap) / 2
        x = np.linspace(0.04, 1.0, 60)
        smooth = 0.5 - 0.5 * np.cos(np.pi * (x - x[0]) / (x[-1] - x[0]))
        top = at_core + (middle + value / 2 - at_core) * smooth
        colour = IN if left else OUT
        axes.fill_between(sign * x, top - value, top, color=colour, alpha=0.55, linewidth=0, label=name)
        axes.text(
            sign * 1.04, middle, f"{name}\n{_number(value)}", va="center",
            ha="right" if left else "left", fontsize=9,
        )
        at_core -= value
        at_name -= slot


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 1000 else f"{value:.3g}"


def _one_unit(result: Result, channels: Sequence[str], what: str) -> tuple[Any, str]:
    """How the one unit of channels is shown, and the label of its axis."""
    units = {result.unit(name) for name in channels}
    if len(units) != 1:
        found = ", ".join(sorted(units)) or "no channel"
        raise ValueError(f"{what} needs one or more channels of one unit, not: {found}")
    look = shown(units.pop(), result._density_kg_m3())
    words = {quantity(name) for name in channels}
    return look, look.label(words.pop() if len(words) == 1 else "value")


def _spans(times: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """For how long each row stands: until the next one; the last one has no time."""
    if len(times) < 2:
        raise ValueError("a duration curve needs two rows or more")
    return np.diff(times)
