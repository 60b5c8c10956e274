"""Hands results to pandas, xarray and matplotlib; each is imported when it is asked for."""

from __future__ import annotations

import importlib
import os
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from anergy._units import hours, quantity, shown

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes

    from anergy._core import Result
    from anergy.steady import Table

SHADES = {"blocked": "#e08a00", "oscillating": "#6b5aa8", "hunting": "#b4508c"}
"""Colours of what events begin."""
ENDS = {"unblocked": "blocked", "oscillating_ended": "oscillating", "hunting_ended": "hunting"}
"""What events end."""


def _optional(module: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        message = f"this needs {package}: pip install 'anergy[{extra}]'"
        raise ImportError(message, name=package) from error


def table_to_pandas(table: Table) -> pandas.DataFrame:
    """A DataFrame with the names of the rows as index."""
    pd = _optional("pandas", "pandas")
    frame: pandas.DataFrame = pd.DataFrame(dict(table)).set_index(table._key)
    return frame


def result_to_pandas(result: Result, channels: Sequence[str] | None) -> pandas.DataFrame:
    """A DataFrame with time_s as index."""
    pd = _optional("pandas", "pandas")
    names = result.channels if channels is None else _names(channels)
    index = pd.Index(result.time_s, name="time_s")
    frame: pandas.DataFrame = pd.DataFrame({name: result[name] for name in names}, index=index)
    frame.attrs = {"model": result.model_name, "units": {name: result.unit(name) for name in names}}
    return frame


def result_to_xarray(result: Result, channels: Sequence[str] | None) -> xarray.Dataset:
    """A Dataset with dimension time_s."""
    xr = _optional("xarray", "xarray")
    names = result.channels if channels is None else _names(channels)
    variables = {name: ("time_s", result[name], {"units": result.unit(name)}) for name in names}
    time = ("time_s", result.time_s, {"units": "s"})
    attrs = {"model": result.model_name}
    dataset: xarray.Dataset = xr.Dataset(variables, coords={"time_s": time}, attrs=attrs)
    return dataset


def result_to_parquet(result: Result, path: os.PathLike[str], channels: Sequence[str] | None) -> None:
    """A Parquet file with time_s and a column per channel."""
    pa = _optional("pyarrow", "parquet")
    parquet = _optional("pyarrow.parquet", "parquet")
    table = pa.table(result)
    if channels is not None:
        names = _names(channels)
        for name in names:
            result.unit(name)
        table = table.select(["time_s", *names])
    parquet.write_table(table, path)


def new_axes(width: float = 7.0, height: float = 4.5) -> Axes:
    """Axes of a new figure, width and height in inches."""
    pyplot = _optional("matplotlib.pyplot", "plot")
    axes: Axes = pyplot.figure(figsize=(width, height), layout="constrained").add_subplot()
    return axes


def plot(result: Result, channels: Sequence[str], ax: Axes | None) -> Axes:
    """Draws channels of one unit into axes, and shades what is blocked or swings of their components."""
    units = {result.unit(name) for name in channels}
    if len(units) != 1:
        found = ", ".join(sorted(units)) or "no channel"
        raise ValueError(f"plot needs one or more channels of one unit, not: {found}")
    axes = ax or new_axes()
    look = shown(units.pop(), result._density_kg_m3())
    seconds, unit_of_time = hours(float(result.time_s[-1])) if len(result.time_s) else (1.0, "s")
    for name in channels:
        axes.plot(result.time_s / seconds, look.of(result[name]), label=name)
    seen = set()
    for kind, component, start_s, end_s in flagged(result):
        if any(_concerns(component, name) for name in channels):
            label = kind if kind not in seen else None
            seen.add(kind)
            axes.axvspan(start_s / seconds, end_s / seconds, color=SHADES[kind], alpha=0.15, linewidth=0, label=label)
    words = {quantity(name) for name in channels}
    axes.set_xlabel(f"time in {unit_of_time}")
    axes.set_ylabel(look.label(words.pop() if len(words) == 1 else "value"))
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, frameon=False, fontsize=9)
    return axes


def flagged(result: Result) -> list[tuple[str, str, float, float]]:
    """Spans of events: kind, component, start and end, s. What is not over ends with the run."""
    if len(result.time_s) == 0:
        return []
    running: dict[tuple[str, str], float] = {}
    spans = []
    for event in result.events:
        component, kind, time_s = event["component"], event["kind"], event["time_s"]
        if kind in SHADES:
            # What hunts has oscillated before, and no event says that this is over.
            before = running.pop((component, "oscillating"), None) if kind == "hunting" else None
            if before is not None:
                spans.append(("oscillating", component, before, time_s))
            running.setdefault((component, kind), time_s)
        elif kind in ENDS and (start := running.pop((component, ENDS[kind]), None)) is not None:
            spans.append((ENDS[kind], component, start, time_s))
    end_s = float(result.time_s[-1])
    spans += [(kind, component, start, end_s) for (component, kind), start in running.items()]
    return sorted(spans, key=lambda span: span[2])


def _concerns(component: str, channel: str) -> bool:
    """Whether a channel belongs to a component, a part of it, or the whole that it is a part of."""
    one, other = component.removesuffix(".station"), channel.rpartition(".")[0].removesuffix(".station")
    return one == other or one.startswith(f"{other}.") or other.startswith(f"{one}.")


def _names(channels: Sequence[str]) -> list[str]:
    return [channels] if isinstance(channels, str) else list(channels)
