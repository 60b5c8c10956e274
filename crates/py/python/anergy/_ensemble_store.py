"""Keeps what became of members: in memory, or in a folder of Parquet files from which an ensemble goes on.

| file | content |
|---|---|
| `ensemble.json` | whose results these are |
| `ensemble.lock` | locked while one writes |
| `members.parquet` | a row per member in their order: written at the end and when stopped |
| `parts/members-N.parquet` | rows that have finished since |
| `channels/part-N.parquet` | chosen channels: `member`, `time_s`, a column per channel |

A part is there as a whole or not at all. Members whose part was not written when an ensemble was killed run again.
"""

from __future__ import annotations

import csv
import json
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from anergy._core import Variations, _FolderLock, _Members
from anergy._export import _optional

Outcome = tuple[int, list[Any], "str | None", dict[str, float], npt.NDArray[np.float64], list[npt.NDArray[np.float64]]]
"""Member, values, error, indicators, times and columns of the channels."""

LARGEST_PART = 512
"""Members that wait for being written at most."""


class Kept(Protocol):
    """Outcomes that are there."""

    channels: list[str]

    def columns(self) -> dict[str, npt.NDArray[Any]]: ...
    def channel(self, name: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...


class Keeping(Kept, Protocol):
    """Where outcomes go."""

    failed: int

    @property
    def finished(self) -> int: ...
    def pending(self, size: int) -> list[int]: ...
    def add(self, outcome: Outcome) -> None: ...
    def flush(self, every_s: float) -> None: ...
    def finish(self) -> None: ...
    def release(self) -> None: ...


class Memory:
    """Keeps everything in memory."""

    def __init__(self, variations: Variations, channels: Sequence[str]) -> None:
        self.names, self.numeric = variations.names, variations._numeric()
        self.channels = list(channels)
        self.outcomes: dict[int, Outcome] = {}
        self.failed = 0

    @property
    def finished(self) -> int:
        return len(self.outcomes)

    def pending(self, size: int) -> list[int]:
        return list(range(size))

    def add(self, outcome: Outcome) -> None:
        self.outcomes[outcome[0]] = outcome
        self.failed += outcome[2] is not None

    def flush(self, every_s: float) -> None:
        pass

    def finish(self) -> None:
        pass

    def release(self) -> None:
        pass

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        outcomes = [self.outcomes[member] for member in sorted(self.outcomes)]
        return _columns(outcomes, self.names, self.numeric)

    def channel(self, name: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        at = self.channels.index(name)
        good = [self.outcomes[m] for m in sorted(self.outcomes) if self.outcomes[m][2] is None]
        return _stacked([(outcome[4], outcome[5][at]) for outcome in good])


def _columns(outcomes: Sequence[Outcome], names: Sequence[str], numeric: Sequence[bool]) -> dict[str, npt.NDArray[Any]]:
    columns: dict[str, npt.NDArray[Any]] = {"member": np.array([outcome[0] for outcome in outcomes], dtype=np.int64)}
    for i, name in enumerate(names):
        values = [outcome[1][i] for outcome in outcomes]
        columns[name] = np.array(values, dtype=float) if numeric[i] else np.array([str(v) for v in values], dtype=str)
    columns["error"] = np.array([outcome[2] or "" for outcome in outcomes], dtype=str)
    for kpi in _ordered({kpi for outcome in outcomes for kpi in outcome[3]}):
        columns[kpi] = np.array([outcome[3].get(kpi, np.nan) for outcome in outcomes], dtype=float)
    return columns


def _ordered(kpis: set[str]) -> list[str]:
    """Indicators of the whole grid first."""
    return sorted(kpis, key=lambda name: (not name.startswith("network."), name))


def _stacked(
    series: Sequence[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]],
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    if not series:
        return np.array([]), np.empty((0, 0))
    time_s = series[0][0]
    if any(not np.array_equal(time_s, other) for other, _ in series):
        raise ValueError("the members have rows at different times")
    return time_s, np.array([values for _, values in series])


class Folder:
    """Keeps everything in Parquet files; in memory only which members have finished."""

    def __init__(self, folder: Path, variations: Variations, members: _Members, controllers: str | None) -> None:
        self._parquet = _optional("pyarrow.parquet", "parquet")
        self._lock = _FolderLock(folder)
        try:
            self._begin(folder, variations, members, controllers)
        except BaseException:
            self._lock.release()
            raise

    def _begin(self, folder: Path, variations: Variations, members: _Members, controllers: str | None) -> None:
        self.folder = folder
        self.names, self.numeric = variations.names, variations._numeric()
        self.channels = members.channels
        self._waiting: list[Outcome] = []
        self._written = time.monotonic()
        (folder / "parts").mkdir(parents=True, exist_ok=True)
        about = folder / "ensemble.json"
        if about.exists():
            differs = members.differs(about.read_text(encoding="utf-8"), controllers)
            if differs is not None:
                message = f"{folder} has the results of another ensemble (other {differs}): name another folder, or delete it"
                raise ValueError(message)
        else:
            _replace(about, members.identity(controllers).encode())
        if self.channels:
            (folder / "channels").mkdir(exist_ok=True)
        self._open()

    def _open(self) -> None:
        table = self._table(["member", "error"])
        self._finished = set(table.column("member").to_pylist()) if table is not None else set()
        self.failed = sum(1 for error in table.column("error").to_pylist() if error) if table is not None else 0
        channel_parts = sorted((self.folder / "channels").glob("part-*.parquet"))
        parts = [*sorted((self.folder / "parts").glob("members-*.parquet")), *channel_parts]
        self._next = 1 + max((_number(part) for part in parts), default=-1)
        if channel_parts:
            # Written before their members, who then were not.
            last = self._parquet.read_table(channel_parts[-1], columns=["member"])
            if self._finished.isdisjoint(last.column("member").to_pylist()):
                channel_parts[-1].unlink()

    def _table(self, columns: list[str] | None = None) -> Any:
        """All rows, in the order of the members."""
        pa = _optional("pyarrow", "parquet")
        files = [self.folder / "members.parquet", *sorted((self.folder / "parts").glob("members-*.parquet"))]
        tables = [self._parquet.read_table(file, columns=columns) for file in files if file.exists()]
        if not tables:
            return None
        table = pa.concat_tables(tables, promote_options="default").sort_by("member")
        ids = table.column("member").to_numpy()
        # Killed between the table and the parts that it took over.
        return table.filter(np.append(True, ids[1:] != ids[:-1])) if len(ids) else table

    @property
    def finished(self) -> int:
        return len(self._finished)

    def pending(self, size: int) -> list[int]:
        return [member for member in range(size) if member not in self._finished]

    def add(self, outcome: Outcome) -> None:
        self._waiting.append(outcome)
        self._finished.add(outcome[0])
        self.failed += outcome[2] is not None

    def flush(self, every_s: float) -> None:
        late = time.monotonic() - self._written >= every_s
        if not self._waiting or not (late or len(self._waiting) >= LARGEST_PART):
            return
        pa = _optional("pyarrow", "parquet")
        if self.channels:
            rows = [(o, len(o[4])) for o in self._waiting if o[2] is None]
            columns = {"member": np.repeat([o[0] for o, _ in rows], [n for _, n in rows])}
            columns["time_s"] = np.concatenate([o[4] for o, _ in rows]) if rows else np.array([])
            for i, name in enumerate(self.channels):
                columns[name] = np.concatenate([o[5][i] for o, _ in rows]) if rows else np.array([])
            self._write(pa.table(columns), self.folder / "channels" / f"part-{self._next:06}.parquet")
        outcomes = sorted(self._waiting, key=lambda outcome: outcome[0])
        named = _columns(outcomes, self.names, self.numeric)
        table = pa.table({n: c.tolist() if c.dtype.kind == "U" else c for n, c in named.items()})
        self._write(table, self.folder / "parts" / f"members-{self._next:06}.parquet")
        self._next += 1
        self._waiting.clear()
        self._written = time.monotonic()

    def _write(self, table: Any, path: Path) -> None:
        part = path.with_name(f"{path.name}.part")
        self._parquet.write_table(table, part)
        os.replace(part, path)

    def finish(self) -> None:
        table = self._table()
        if table is None:
            return
        first = ["member", *self.names, "error"]
        names = [*first, *_ordered(set(table.column_names) - set(first))]
        self._write(table.select(names), self.folder / "members.parquet")
        for part in (self.folder / "parts").glob("members-*.parquet"):
            part.unlink()

    def release(self) -> None:
        self._lock.release()

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        table = self._table()
        if table is None:
            return _columns([], self.names, self.numeric)
        return {name: _array(table.column(name)) for name in table.column_names}

    def channel(self, name: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        found: dict[int, tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]] = {}
        for part in sorted((self.folder / "channels").glob("part-*.parquet")):
            table = self._parquet.read_table(part, columns=["member", "time_s", name])
            members, time_s, values = (column.to_numpy() for column in table.columns)
            starts = [i for i in range(len(members)) if i == 0 or members[i] != members[i - 1]]
            for start, end in zip(starts, [*starts[1:], len(members)]):
                found[int(members[start])] = (time_s[start:end], values[start:end])
        return _stacked([found[member] for member in sorted(found)])


def _array(column: Any) -> npt.NDArray[Any]:
    if str(column.type) == "string":
        return np.array([value or "" for value in column.to_pylist()], dtype=str)
    array: npt.NDArray[Any] = column.to_numpy()
    return array


def _number(part: Path) -> int:
    return int(part.stem.rpartition("-")[2])


def _replace(path: Path, content: bytes) -> None:
    part = path.with_name(f"{path.name}.part")
    part.write_bytes(content)
    os.replace(part, path)


class Journal:
    """The folder of `anergy sweep`, also of one that was killed or still runs: its journal has every finished member."""

    def __init__(self, folder: Path, names: Sequence[str]) -> None:
        self.folder, self.names = folder, names
        self._outcomes: dict[int, Outcome] = {}
        with (folder / "journal.jsonl").open(encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                if not line.endswith("\n"):
                    # Torn, or being written.
                    break
                try:
                    told = json.loads(line)
                    member, values = int(told["member"]), told["values"]
                except (ValueError, KeyError, TypeError) as error:
                    raise ValueError(f"{folder / 'journal.jsonl'}:{number}: is no line of a journal: {error}") from error
                empty: list[npt.NDArray[np.float64]] = []
                self._outcomes[member] = (member, values, told.get("error"), told.get("kpis", {}), np.array([]), empty)
        good = [member for member in sorted(self._outcomes) if self._outcomes[member][2] is None]
        files = [folder / "channels" / f"member-{member:06}.csv" for member in good]
        self._files = [file for file in files if file.exists()]
        self.channels = _head(self._files[0])[1:] if self._files else []

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        outcomes = [self._outcomes[member] for member in sorted(self._outcomes)]
        values = zip(*(outcome[1] for outcome in outcomes))
        numeric = [all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in v) for v in values]
        return _columns(outcomes, self.names, numeric or [True] * len(self.names))

    def channel(self, name: str) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        series = []
        for file in self._files:
            data = np.genfromtxt(file, delimiter=",", skip_header=1, ndmin=2)
            series.append((data[:, 0], data[:, 1 + self.channels.index(name)]))
        return _stacked(series)


def _head(file: Path) -> list[str]:
    with file.open(newline="", encoding="utf-8") as opened:
        return next(csv.reader(opened))


def read(folder: Path) -> tuple[Kept, list[str], int]:
    """What is in a folder, what varied, and the number of members."""
    about = json.loads((folder / "ensemble.json").read_text(encoding="utf-8"))
    entries = about["variations"]["variation"]
    names = [e.get("name") or e.get("parameter") or e["parameters"][0] for e in entries]
    if (folder / "journal.jsonl").exists():
        return Journal(folder, names), names, about["members"]
    kept = Folder.__new__(Folder)
    kept._parquet = _optional("pyarrow.parquet", "parquet")
    kept.folder, kept.names, kept.numeric = folder, names, [True] * len(names)
    parts = sorted((folder / "channels").glob("part-*.parquet"))
    kept.channels = kept._parquet.read_schema(parts[0]).names[2:] if parts else []
    return kept, names, about["members"]
