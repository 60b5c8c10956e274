"""Many variants of a model: `anergy.ensemble`.

>>> import anergy
>>> model = anergy.examples.load("three-houses")
>>> found = anergy.ensemble(model, {
...     "run": {"until": "5min"},
...     "variation": [{"parameter": "sf1.feed_in_pump.speed", "values": [0.95, 1.0]}],
... })
>>> found["sf1.feed_in_pump.speed"].tolist()
[0.95, 1.0]
>>> found["sf1.station.heat_given_kwh"].round(2).tolist()
[0.12, 0.3]
"""

from __future__ import annotations

import os
import sys
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from anergy import _ensemble_plots, _executors
from anergy._core import Model, Variations, _Members, _unknown_name
from anergy._ensemble_store import Folder, Keeping, Kept, Memory, read
from anergy.controller import Controller
from anergy.errors import Interrupted, WorkersLost
from anergy.steady import Table

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes

__all__ = ["Ensemble", "ensemble"]


class _OfMembers(Table):
    """A row per member."""

    _key = "member"


class Ensemble:
    """What became of the members of an ensemble: a mapping of names to columns, one value per finished member.

    Made by `anergy.ensemble`, or read from a folder by `Ensemble.from_folder`.
    """

    table: Table
    """`member` (its number), what varied, `error`, and the indicators; members that failed have nan."""
    names: list[str]
    """What varied."""
    size: int
    """Number of members, also of those that have not run."""

    def __init__(self, kept: Kept, names: Sequence[str], size: int, members: _Members | None) -> None:
        self.table = _OfMembers(kept.columns())
        self.names = list(names)
        self.size = size
        self._kept = kept
        self._members = members

    @staticmethod
    def from_folder(folder: str | os.PathLike[str]) -> Ensemble:
        """What is in the folder of an ensemble, also of one that was stopped, or of `anergy sweep`.

        Parameters
        ----------
        folder : str or os.PathLike
            `out` of `anergy.ensemble`, `--out` of the program.

        Raises
        ------
        OSError
            When it is not such a folder.
        ImportError
            Without pyarrow for folders of `anergy.ensemble`: `pip install anergy[parquet]`.
        """
        kept, names, size = read(Path(folder))
        return Ensemble(kept, names, size, None)

    @property
    def kpis(self) -> list[str]:
        """Names of the indicators."""
        others = {"member", "error", *self.names}
        return [name for name in self.table if name not in others]

    @property
    def failed(self) -> dict[int, str]:
        """Members that failed, and why."""
        errors = zip(self.table["member"], self.table["error"])
        return {int(member): str(error) for member, error in errors if error}

    @property
    def complete(self) -> bool:
        """Whether all members have finished."""
        return len(self.table["member"]) == self.size

    @property
    def channels(self) -> list[str]:
        """Names of the channels that were kept."""
        return self._kept.channels

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        """A column of `table`.

        Raises UnknownNameError, a KeyError, with the most similar name.
        """
        if name not in self.table:
            raise _unknown_name("column", name, list(self.table))
        return self.table[name]

    def __contains__(self, name: object) -> bool:
        return name in self.table

    def __len__(self) -> int:
        """Number of members that have finished."""
        return len(self.table["member"])

    def model(self, member: int) -> Model:
        """The model of a member: to simulate it again with everything, or to change it further.

        Raises
        ------
        ValueError
            For an ensemble read from a folder, which does not know its model.
        """
        if self._members is None:
            raise ValueError("an ensemble from a folder does not know its model: anergy.ensemble(..., out=folder) reads it too")
        return self._members.model(member)

    def channel(self, name: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """A channel of all members that did not fail, in the order of their numbers.

        Parameters
        ----------
        name : str
            One of `channels`.

        Returns
        -------
        tuple of numpy.ndarray
            Times, s, of shape `(n,)`, and values of shape `(members, n)`.

        Raises
        ------
        UnknownNameError
            For a channel that was not kept.
        ValueError
            When members have rows at different times.
        """
        if name not in self.channels:
            raise _unknown_name("channel", name, self.channels)
        return self._kept.channel(name)

    def quantiles(self, q: npt.ArrayLike = (0.05, 0.5, 0.95), names: Sequence[str] | None = None) -> Table:
        """Quantiles of indicators over the members that did not fail.

        Parameters
        ----------
        q : array of float
            Between 0 and 1.
        names : sequence of str, optional
            Absent: all indicators.

        Returns
        -------
        Table
            `id` (name of the indicator) and a column per quantile.
        """
        chosen = self.kpis if names is None else list(names)
        levels = np.atleast_1d(np.asarray(q, dtype=float))
        rows = [_quantiles(self[name], levels) for name in chosen]
        columns: dict[str, Any] = {"id": np.array(chosen, dtype=str)}
        columns |= {f"{level:g}": np.array([row[i] for row in rows]) for i, level in enumerate(levels)}
        return Table(columns)

    def plot_quantiles(self, channel: str, ax: Axes | None = None) -> Axes:
        """Draws the median of a channel over time, with bands of 50 and 90 % of the members.

        Raises
        ------
        ImportError
            Without matplotlib: `pip install anergy[plot]`.
        UnknownNameError
            For a channel that was not kept.
        """
        return _ensemble_plots.quantiles(self, channel, ax)

    def plot_distribution(self, *kpis: str, ax: Axes | None = None) -> Axes:
        """Draws how many members stay below which value of indicators (their distribution functions).

        Raises
        ------
        ImportError
            Without matplotlib: `pip install anergy[plot]`.
        UnknownNameError
            For a name that is not there.
        """
        return _ensemble_plots.distribution(self, kpis, ax)

    def to_pandas(self) -> pandas.DataFrame:
        """`table` as pandas.DataFrame with the number of the member as index.

        Raises ImportError without pandas: `pip install anergy[pandas]`.
        """
        return self.table.to_pandas()

    def __repr__(self) -> str:
        failed = f", {len(self.failed)} failed" if self.failed else ""
        return f"<anergy.Ensemble: {len(self)} of {self.size} members{failed}, {len(self.kpis)} indicators>"


def _quantiles(column: npt.NDArray[Any], levels: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    values = np.asarray(column, dtype=float)
    values = values[np.isfinite(values)]
    return np.quantile(values, levels) if values.size else np.full(levels.shape, np.nan)


def ensemble(
    model: Model,
    variations: Variations | Mapping[str, Any] | str | os.PathLike[str],
    executor: Executor | Any | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    threads: int | None = None,
    controllers: Sequence[Controller] | Callable[[], Sequence[Controller]] | None = None,
    progress: bool | None = None,
) -> Ensemble:
    """Runs many variants of a model.

    The numbers are the same, bit for bit, whatever runs the members.

    Parameters
    ----------
    model : Model
        What is varied.
    variations : Variations, dict, str or os.PathLike
        What varies; a dict with the grammar of the file, or the file.
    executor : concurrent.futures.Executor or dask.distributed.Client, optional
        Who runs the members. Absent: threads of this process, within one call and without a lock of the interpreter; with
        `controllers`: processes.
    out : str or os.PathLike, optional
        Folder: results go into Parquet files as they finish, and an ensemble that was stopped or killed goes on from there.
        Absent: results are kept in memory.
    threads : int, optional
        Absent: all cores.
    controllers : sequence of Controller, or callable that makes them, optional
        Your own; each member starts them anew. They (or the callable) must be picklable for processes.
    progress : bool, optional
        Whether progress is shown; absent: on a terminal.

    Returns
    -------
    Ensemble
        Also of members that failed, with their messages.

    Raises
    ------
    ModelError
        When the model or the variations are wrong.
    Interrupted
        After Ctrl-C, a KeyboardInterrupt; `.result` is the ensemble until then.
    WorkersLost
        When processes of an executor were killed, for example for lack of memory; `.result` is the ensemble until then.
    ValueError
        When `out` has the results of another ensemble, or another run writes into it.
    ImportError
        Without pyarrow for `out`: `pip install anergy[parquet]`.
    """
    chosen = _variations(variations)
    members = _Members(model, chosen)
    kept: Keeping
    if out is None:
        kept = Memory(chosen, members.channels)
    else:
        kept = Folder(Path(out), chosen, members, _executors.told(controllers))
    pending = kept.pending(len(chosen))
    shown = _Progress(len(chosen) - len(pending), len(chosen), progress)

    def each(batch: list[Any]) -> None:
        for outcome in batch:
            kept.add(outcome)
        kept.flush(every_s=2.0)
        shown.update(kept.finished, kept.failed)

    stopped: KeyboardInterrupt | BrokenExecutor | None = None
    try:
        try:
            if executor is None and controllers is None:
                members.run(pending, threads or 0, each)
            else:
                _executors.run(model, chosen, pending, executor, threads, controllers, each)
        except (KeyboardInterrupt, BrokenExecutor) as why:
            stopped = why
        finally:
            kept.flush(every_s=0.0)
            shown.finish()
        kept.finish()
    finally:
        kept.release()
    found = Ensemble(kept, chosen.names, len(chosen), members)
    unmatched = members.unmatched(found.kpis) if len(found) > len(found.failed) else []
    for pattern in unmatched:
        warnings.warn(f"keep: no indicator matches {pattern!r}", stacklevel=2)
    if isinstance(stopped, BrokenExecutor):
        message = f"the workers were lost after {len(found)} of {found.size} members, `.result` has them: {stopped}"
        raise WorkersLost(message, found) from stopped
    if stopped is not None:
        message = f"the ensemble was interrupted after {len(found)} of {found.size} members; `.result` has them"
        raise Interrupted(message, found) from stopped
    return found


def _variations(given: Variations | Mapping[str, Any] | str | os.PathLike[str]) -> Variations:
    if isinstance(given, Variations):
        return given
    if isinstance(given, (str, os.PathLike)):
        return Variations.from_file(given)
    return Variations.from_dict(given)


class _Progress:
    """A line on a terminal that is written again."""

    def __init__(self, first: int, total: int, wanted: bool | None) -> None:
        self.wanted = sys.stderr.isatty() if wanted is None else wanted
        self.first, self.total = first, total
        self.started = self.last = time.monotonic()
        self.written = False

    def update(self, finished: int, failed: int) -> None:
        now = time.monotonic()
        if not self.wanted or (now - self.last < 0.25 and finished < self.total):
            return
        self.last = now
        each_s = (now - self.started) / max(finished - self.first, 1)
        bar = "#" * (40 * finished // max(self.total, 1))
        told = f", {failed} failed" if failed else ""
        left = f", {each_s * (self.total - finished):.0f} s left" if finished > self.first else ""
        sys.stderr.write(f"\r[{bar:<40}] {finished} of {self.total} members{told}{left}\x1b[K")
        sys.stderr.flush()
        self.written = True

    def finish(self) -> None:
        if self.written:
            sys.stderr.write("\n")
