"""Draws networks as maps with matplotlib, which is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anergy._core import _unknown_name
from anergy._export import new_axes
from anergy._units import Shown, quantity, shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from anergy._core import Result
    from anergy.steady import Steady

SIDES = {"hot": ("#d9534f", "hot line"), "cold": ("#3b7dd8", "cold line"), "plain": ("#8a8f98", "other line")}
"""Colour of the border of a line, and what it means."""
NODES = {"t_k": "K", "p_pa": "Pa"}
"""Quantities of nodes: an edge shows them from end to end."""
REST_KG_S = 1e-6
"""Below this flow an edge has no arrow."""
MANY = 60
"""More places have no names."""
PIECES = 24
"""Pieces of a line between the values at its ends."""
Values = Callable[[str], "float | None"]


def of_result(result: Result, wanted: str, time_s: float | None, ax: Axes | None) -> Axes:
    """The map of a recorded row: the last one at or before a time."""
    times = result.time_s
    if len(times) == 0:
        raise ValueError("the results have no rows")
    if time_s is not None and not times[0] <= time_s <= times[-1]:
        raise ValueError(f"time_s = {time_s:g} is outside of the results: {times[0]:g} to {times[-1]:g} s")
    row = len(times) - 1 if time_s is None else int(np.searchsorted(times, time_s, "right")) - 1

    def value(name: str) -> float | None:
        return float(result[name][row]) if name in result else None

    names = [name for name in result if name.rpartition(".")[2] == wanted]
    quantities = {name.rpartition(".")[2] for name in result}
    unit = result.unit(names[0]) if names else ""
    drawing = result._map()
    axes = draw(drawing, value, wanted, unit, quantities, ax)
    title = f"{result.model_name}, {clock(float(times[row]))}"
    axes.set_title(title, fontsize=10)
    return axes


def of_steady(steady: Steady, wanted: str, ax: Axes | None) -> Axes:
    """The map of a steady state."""
    rows: dict[str, float] = {}
    for table in (steady.nodes, steady.edges):
        for column in table:
            if table[column].dtype.kind == "f":
                rows |= {f"{id}.{column}": float(v) for id, v in zip(table.ids, table[column], strict=True)}
    unit = {"t_k": "K", "p_pa": "Pa", "dp_pa": "Pa", "m_flow_kg_s": "kg s-1"}.get(wanted, "m")
    known = {name.rpartition(".")[2] for name in rows}
    axes = draw(steady.model._map(), rows.get, wanted, unit, known, ax)
    axes.set_title(f"{steady.model.name}, steady", fontsize=10)
    return axes


def clock(time_s: float) -> str:
    """A time in words: `37 min 10 s`."""
    left = round(time_s)
    parts: list[str] = []
    for seconds, name in ((86_400, "d"), (3600, "h"), (60, "min"), (1, "s")):
        count, left = divmod(left, seconds)
        if count or (name == "s" and not parts):
            parts.append(f"{count} {name}")
    return "at " + " ".join(parts)


def draw(
    drawing: Mapping[str, Any], value: Values, wanted: str, unit: str, known: set[str], ax: Axes | None
) -> Axes:
    """Lines coloured by a quantity, arrows with the flow, names of the places."""
    places, lines = drawing["places"], drawing["lines"]
    ends = [at_ends(line, value, wanted) for line in lines]
    drawn = [(line, end) for line, end in zip(lines, ends, strict=True) if end is not None]
    if not drawn:
        mapped = {name for line in lines for name in known if at_ends(line, value, name)}
        if wanted in mapped or not mapped:
            raise ValueError(f"no line of the map has a value of {wanted}")
        raise _unknown_name("quantity of the lines of the map", wanted, sorted(mapped))
    look = shown(unit, drawing["density_kg_m3"])
    points = np.array([(place["x_m"], place["y_m"]) for place in places])
    width, height = np.ptp(points, axis=0) if len(points) else (1.0, 1.0)
    axes = ax or new_axes(9.0, float(np.clip(9.0 * height / max(width, 1e-9), 3.2, 7.0)) + 0.6)
    # Many places need thin lines.
    scale = 1.0 if len(places) <= MANY else 0.45
    apart = 0.012 * scale * max(width, height, 1e-9)
    borders: dict[str, Any] = {}
    mappable = _lines(axes, points, drawn, look, (apart, scale), borders)
    for line, _ in drawn:
        flow = value(f"{line['edge']}.m_flow_kg_s")
        if flow is not None and abs(flow) > REST_KG_S:
            _arrow(axes, *_shifted(points, line, apart), flow < 0, (apart, scale))
    axes.scatter(points[:, 0], points[:, 1], s=70 * scale**3, color="white", edgecolor="black", linewidth=scale, zorder=6)
    if len(places) <= MANY:
        _names(axes, places, lines, points)
    for line in lines:
        side = line["side"]
        if side not in borders:
            (borders[side],) = axes.plot([], [], color=SIDES[side][0], linewidth=3, label=SIDES[side][1])
    axes.legend(
        handles=[borders[side] for side in SIDES if side in borders], loc="upper center",
        bbox_to_anchor=(0.5, -0.02), ncols=3, frameon=False, fontsize=9,
    )
    axes.figure.colorbar(mappable, ax=axes, label=look.label(quantity(wanted)), fraction=0.04, pad=0.02)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.13)
    axes.set_axis_off()
    return axes


def at_ends(line: Mapping[str, Any], value: Values, wanted: str) -> tuple[float, float] | None:
    """What a line shows at its ports: its own value, that of its water there, or those of its nodes."""
    own = value(f"{line['edge']}.{wanted}")
    if own is not None:
        # Which way water flows is for the arrows.
        own = abs(own) if "_flow_" in wanted and not wanted.startswith("q_") else own
        return own, own
    if wanted == "t_k":
        inside = [value(f"{line['edge']}.t_{port}_k") for port in "ab"]
        if inside[0] is not None and inside[1] is not None:
            return inside[0], inside[1]
    a, b = (value(f"{node}.{wanted}") for node in line["nodes"])
    return None if a is None or b is None else (a, b)


def _shifted(
    points: npt.NDArray[np.float64], line: Mapping[str, Any], apart: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Ends of a line: hot beside cold, the same sides whichever way they are written."""
    a, b = points[line["from"]], points[line["to"]]
    along = b - a if line["from"] < line["to"] else a - b
    length = float(np.hypot(*along)) or 1.0
    across = np.array([-along[1], along[0]]) / length
    shift = {"hot": 1.0, "cold": -1.0, "plain": 0.0}[line["side"]] * apart
    return a + shift * across, b + shift * across


def _lines(
    axes: Axes, points: npt.NDArray[np.float64], drawn: list[Any], look: Shown, size: tuple[float, float], borders: dict[str, Any]
) -> Any:
    from matplotlib.collections import LineCollection

    apart, scale = size
    count = PIECES if scale == 1.0 else 4

    pieces, values = [], []
    for line, (at_a, at_b) in drawn:
        a, b = _shifted(points, line, apart)
        colour, label = SIDES[line["side"]]
        (border,) = axes.plot(
            *zip(a, b, strict=True), color=colour, linewidth=7 * scale, alpha=0.45, solid_capstyle="round", zorder=1
        )
        if line["side"] not in borders:
            border.set_label(label)
            borders[line["side"]] = border
        shares = np.linspace(0.0, 1.0, count + 1)[:, None]
        way = a + shares * (b - a)
        pieces += list(np.stack([way[:-1], way[1:]], axis=1))
        values += list(np.linspace(at_a, at_b, count))
    shown_values = look.of(values)
    lines = LineCollection(pieces, cmap="viridis", linewidths=4 * scale, capstyle="butt", zorder=2)
    lines.set_array(shown_values)
    low, high = float(np.nanmin(shown_values)), float(np.nanmax(shown_values))
    if high - low < 1e-9 * max(abs(low), abs(high), 1.0):
        low, high = low - 0.5, high + 0.5
    lines.set_clim(low, high)
    axes.add_collection(lines)
    return lines


def _arrow(
    axes: Axes, a: npt.NDArray[np.float64], b: npt.NDArray[np.float64], backwards: bool, size: tuple[float, float]
) -> None:
    """An arrow in the middle of a line, with the flow."""
    apart, scale = size
    if backwards:
        a, b = b, a
    length = float(np.hypot(*(b - a)))
    if length < 4 * apart:
        return
    middle, along = (a + b) / 2, (b - a) / length
    axes.annotate(
        "", xy=tuple(middle + 1.2 * apart * along), xytext=tuple(middle - 1.2 * apart * along), zorder=5,
        arrowprops={"arrowstyle": "-|>", "facecolor": "white", "edgecolor": "black", "linewidth": 1.2 * scale, "mutation_scale": 13 * scale},
    )


def _names(axes: Axes, places: list[Any], lines: list[Any], points: npt.NDArray[np.float64]) -> None:
    """Names beside their places, away from the lines."""
    from matplotlib.patheffects import withStroke

    away = np.zeros_like(points)
    for line in lines:
        ends = points[line["from"]], points[line["to"]]
        along = (ends[1] - ends[0]) / (float(np.hypot(*(ends[1] - ends[0]))) or 1.0)
        away[line["from"]] -= along
        away[line["to"]] += along
    for place, (x, y), way in zip(places, points, away, strict=True):
        length = float(np.hypot(*way))
        # Where lines come from all sides, above.
        dx, dy = way / length if length > 0.5 else (0.0, 1.0)
        axes.annotate(
            place["name"], (x, y), xytext=(12 * dx, 12 * dy), textcoords="offset points",
            ha="left" if dx > 0.4 else "right" if dx < -0.4 else "center",
            va="bottom" if dy > 0.4 else "top" if dy < -0.4 else "center",
            fontsize=9, zorder=7, path_effects=[withStroke(linewidth=3, foreground="white")],
        )
