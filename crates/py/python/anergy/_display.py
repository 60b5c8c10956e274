"""How objects look in a terminal and in a notebook, and the names of key results."""

from __future__ import annotations

import html
import re
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from anergy._core import Model, Result

TEXT_ROWS = 20
HTML_ROWS = 100
_TABLE = '<table style="text-align: left">'


def kpis(result: Result) -> dict[str, float]:
    """Key results and indicators by `component.quantity_unit`."""
    found = _key_results(result)
    told = result.summary.get("kpis", {})
    groups = [{"network": told.get("network", {})}]
    groups += [told.get(name, {}) for name in ("nodes", "sites", "stations", "units")]
    for group in groups:
        for component, numbers in group.items():
            for name, value in numbers.items():
                if isinstance(value, float):
                    found[f"{component}.{name}"] = value
    return found


def _key_results(result: Result) -> dict[str, float]:
    """Key results by `component.quantity_unit`."""
    found: dict[str, float] = {}
    for entry in result.summary.get("key_results", []):
        label = re.sub(r"\(.*?\)", "", entry["label"])
        words = re.findall(r"[a-z0-9]+", f"{label} {entry['unit']}".lower())
        found[f"{entry['component']}.{'_'.join(words)}"] = entry["value"]
    return found


def model_html(model: Model) -> str:
    """A model in a notebook."""
    parts = ("stations", "units", "controllers", "nodes", "edges")
    rows = [(part, len(getattr(model, part))) for part in parts]
    return rows_html(model.name, rows)


def result_html(result: Result) -> str:
    """Results in a notebook: size and key results."""
    end_s = float(result.time_s[-1]) if len(result.time_s) else 0.0
    rows: list[tuple[str, Any]] = [
        ("time", f"{end_s:g} s in {len(result.time_s)} rows"),
        ("channels", len(result)),
        ("events", len(result.events)),
    ]
    rows += [(name, f"{value:.4g}") for name, value in _key_results(result).items()]
    return rows_html(result.model_name, rows)


def table_text(table: Mapping[str, npt.NDArray[Any]]) -> str:
    """A table in a terminal."""
    columns = [[name, *map(_cell, column[:TEXT_ROWS])] for name, column in table.items()]
    widths = [max(map(len, column)) for column in columns]
    lines = [
        "  ".join(
            cell.ljust(width) if kind.dtype.kind == "U" else cell.rjust(width)
            for cell, width, kind in zip(row, widths, table.values(), strict=True)
        ).rstrip()
        for row in zip(*columns, strict=True)
    ]
    rows = _rows(table)
    if rows > TEXT_ROWS:
        lines.append(f"... {rows} rows")
    return "\n".join(lines)


def table_html(table: Mapping[str, npt.NDArray[Any]]) -> str:
    """A table in a notebook."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in table)
    rows = zip(*(column[:HTML_ROWS] for column in table.values()), strict=True)
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(_cell(cell))}</td>" for cell in row) + "</tr>"
        for row in rows
    )
    more = f"<p>{_rows(table)} rows</p>" if _rows(table) > HTML_ROWS else ""
    return f"{_TABLE}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def _rows(table: Mapping[str, npt.NDArray[Any]]) -> int:
    return max((len(column) for column in table.values()), default=0)


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, (float, np.floating)) else str(value)


def rows_html(title: str, rows: Iterable[tuple[str, Any]]) -> str:
    """Names and values in a notebook."""
    body = "".join(
        f"<tr><th>{html.escape(name)}</th><td>{html.escape(str(value))}</td></tr>"
        for name, value in rows
    )
    return f"{_TABLE}<caption style=\"white-space: nowrap\">{html.escape(title)}</caption><tbody>{body}</tbody></table>"
