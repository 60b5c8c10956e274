"""Why simulation and measurement disagree: `anergy.explain`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anergy._core import Model
from anergy._display import rows_html

if TYPE_CHECKING:
    import pandas

__all__ = ["Explanation", "explain"]


@dataclass(frozen=True)
class Explanation:
    """What `anergy.explain` found."""

    verdict: str
    """named, class, unexplained, nothing or data_problem."""
    because: str
    """Why, in a sentence."""
    problems: list[str]
    """What is wrong with the data."""
    effects: list[dict[str, Any]]
    """Effects that were added: id, component, what, params with 95 % interval, probability."""
    rivals: list[tuple[str, str]]
    """Id and component of the effects that the data do not tell apart, the first effect included."""
    tried: list[dict[str, Any]]
    """Everything that was compared in the first round, best first."""
    gap: list[dict[str, Any]]
    """Root mean squares before and after, by column, part and regime: rows of a table."""
    model: Model
    """The model with the effects of the plant."""
    markdown: str = field(repr=False)
    """The report as Markdown."""
    _html: str = field(repr=False)

    def report(self, path: str | PathLike[str]) -> None:
        """Writes the report with figures as one HTML file.

        Parameters
        ----------
        path : str or os.PathLike
            The file.
        """
        Path(path).write_text(self._html, encoding="utf-8")

    def _repr_html_(self) -> str:
        rows: list[tuple[str, Any]] = [("verdict", f"{self.verdict}: {self.because}")]
        rows += [("problem", problem) for problem in self.problems]
        rows += [
            (f"{effect['id']} {effect['component']}", f"{effect['what']}, p = {effect['probability']:.2f}")
            for effect in self.effects
        ]
        return rows_html("Why simulation and measurement disagree", rows)


def explain(
    model: Model,
    data: str | PathLike[str] | pandas.DataFrame,
    sensors: str | PathLike[str] | Sequence[Mapping[str, Any]],
    split: str | PathLike[str] | None = None,
) -> Explanation:
    """Compares a model with measurements and names what it lacks.

    Parameters
    ----------
    model : Model
        The model.
    data : str, os.PathLike or pandas.DataFrame
        Table of measurements, or the CSV file of it: `time_s`, optionally `run`, a column per sensor.
    sensors : str, os.PathLike or sequence of mappings
        Sensor file (TOML), or its entries: column, signal, unit, role, class, quantisation, lag_s.
    split : str, os.PathLike or None
        Split file: which blocks of time are fitted, choose, and are shown. Without it they take turns.

    Returns
    -------
    Explanation
        Verdict, effects, rivals, and the model with what was missing.

    Raises
    ------
    ValueError
        A file that is wrong, with the place, or a sensor that does not fit the model.
    ModelError, RunError
        The model does not build or run with the measured inputs.

    Examples
    --------
    >>> import anergy
    >>> found = anergy.explain(model, "data.csv", "sensors.toml")  # doctest: +SKIP
    >>> found.verdict, found.effects[0]["id"]  # doctest: +SKIP
    ('named', 'P1')
    """
    table = _text(data) if isinstance(data, (str, PathLike)) else data.to_csv(index=False)
    entries = _text(sensors) if isinstance(sensors, (str, PathLike)) else _sensor_file(sensors)
    blocks = None if split is None else _text(split)
    told, markdown, html, explained = model._explain(table, entries, blocks)
    return Explanation(
        verdict=told["verdict"],
        because=told["because"],
        problems=told["problems"],
        effects=told["effects"],
        rivals=[(identity, component) for identity, component in told["class"]],
        tried=told["tried"],
        gap=told["gaps"],
        model=explained,
        markdown=markdown,
        _html=html,
    )


def _text(path: str | PathLike[str]) -> str:
    return Path(path).read_text(encoding="utf-8")


def _sensor_file(entries: Sequence[Mapping[str, Any]]) -> str:
    """The entries as a sensor file."""
    lines: list[str] = []
    for entry in entries:
        lines.append("[[sensor]]")
        lines += [f"{key} = {_toml(value)}" for key, value in entry.items()]
    return "\n".join(lines) + "\n"


def _toml(value: Any) -> str:
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    return repr(float(value))
