"""Hands results to pandas, xarray and matplotlib; each is imported when it is asked for."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.axes import Axes

    from anergy._core import Result
    from anergy.steady import Table


def _optional(module: str, extra: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = module.partition(".")[0]
        message = f"this needs {package}: pip install 'anergy[{extra}]'"
        raise ImportError(message, name=package) from error


def table_to_pandas(table: Table) -> pandas.DataFrame:
    """A DataFrame with `id` as index."""
    pd = _optional("pandas", "pandas")
    frame: pandas.DataFrame = pd.DataFrame(dict(table)).set_index("id")
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


def plot(result: Result, channels: Sequence[str], ax: Axes | None) -> Axes:
    """Draws channels of one unit into axes."""
    units = {result.unit(name) for name in channels}
    if len(units) != 1:
        found = ", ".join(sorted(units)) or "no channel"
        raise ValueError(f"plot needs one or more channels of one unit, not: {found}")
    axes: Axes = ax or _optional("matplotlib.pyplot", "plot").figure().add_subplot()
    for name in channels:
        axes.plot(result.time_s, result[name], label=name)
    axes.set_xlabel("time in s")
    axes.set_ylabel(units.pop())
    axes.legend()
    return axes


def _names(channels: Sequence[str]) -> list[str]:
    return [channels] if isinstance(channels, str) else list(channels)
