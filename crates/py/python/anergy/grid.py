"""A model built in Python: a method for every entry of the model file, its fields as arguments.

>>> import anergy
>>> grid = anergy.Grid("a pump and a load")
>>> site = grid.site("plant", lines=["supply", "return"])
>>> pump = grid.edge.pump("pump", "plant.return", "plant.supply",
...                       head_max_hpa=402.21, free_flow_l_min=55.33, speed=1.0)
>>> load = grid.edge.resistance("load", "plant.supply", "plant.return",
...                             dp_nominal_hpa=100.0, m_flow_nominal_kg_min=10.0)
>>> grid.pressure_reference("plant.return", pressure_bar=1.5)
>>> round(60 * grid.model().solve()[pump]["m_flow_kg_s"], 3)
18.855

What does not exist raises at once:

>>> grid.trench("plant", "house", length_inch=200)
Traceback (most recent call last):
    ...
TypeError: Grid.trench has no argument `length_inch`; did you mean `length_m`? Its units: `length_m`, \
`length_mm`, `length_cm`, `length_km`

The methods are made from `anergy.schema`; `grid.pyi` shows them to editors and type checkers.
"""

from __future__ import annotations

import copy
import inspect
import os
from collections.abc import Callable
from typing import Any

from anergy import _display, _grammar
from anergy._core import Model
from anergy._grammar import Entry, Json

__all__ = ["Grid"]


class Grid:
    """A model that is being built: `model()` makes it.

    One method for each section of the model file (`site`, `trench`, `pipe_type`, `sensor`, ...), and one
    for each kind of those that have kinds (`station.producer`, `unit.heat_load`, `edge.pump`,
    `controller.pi`, ...). Fields are arguments, in any unit of the model file (`length_m`, `length_km`,
    `supply_degc`); None is as if it were not given. Entries that have a name return it.

    Parameters
    ----------
    name : str
        Title of the study.
    directory : str or os.PathLike
        Where files of series, tables and weather are looked up.
    **fields
        More of `[model]`.
    """

    def __init__(self, name: str = "untitled", directory: str | os.PathLike[str] = ".", **fields: Any) -> None:
        given = _given({"name": name, **fields})
        _grammar.check(given, _grammar.properties()["model"]["properties"], "Grid")
        self._directory = directory
        self._sections: Json = {"format": 1, "model": given}
        for group, kind in _GROUPS.items():
            setattr(self, group, kind(self))

    def to_dict(self) -> dict[str, Any]:
        """What was built, with the grammar of the model file: for `Model.from_dict`."""
        order = ["format", *_grammar.properties()]
        return {name: copy.deepcopy(self._sections[name]) for name in order if name in self._sections}

    def model(self) -> Model:
        """The model.

        Raises
        ------
        ModelError
            With all problems and hints.
        """
        return Model.from_dict(self.to_dict(), directory=self._directory)

    def __repr__(self) -> str:
        counts = [f"{len(entries)} {name}" for name, entries in self._sizes()]
        return f"<anergy.Grid \"{self._sections['model']['name']}\": {', '.join(counts) or 'empty'}>"

    def _repr_html_(self) -> str:
        rows = [(name, len(entries)) for name, entries in self._sizes()]
        return _display.rows_html(self._sections["model"]["name"], rows)

    def _sizes(self) -> list[tuple[str, Any]]:
        return [
            (name, entries)
            for name, entries in self._sections.items()
            if isinstance(entries, list) or name.endswith("_type")
        ]

    def _add(self, entry: Entry, given: Json) -> str | None:
        fields = _given(given)
        id = fields.pop("id") if entry.shape == "named" else None
        _grammar.check(fields, entry.fields, f"Grid.{entry.path}")
        fields = copy.deepcopy(fields)
        if entry.shape == "table":
            self._sections.setdefault(entry.section, {}).update(fields)
            return None
        if id is not None:
            self._sections.setdefault(entry.section, {})[id] = fields
            return str(id)
        self._sections.setdefault(entry.section, []).append(fields)
        return _name(entry.section, fields)


def _given(fields: Json) -> Json:
    return {name.removesuffix("_"): value for name, value in fields.items() if value is not None}


def _name(section: str, fields: Json) -> str | None:
    """How the model calls an entry."""
    if section in ("station", "unit") and "site" in fields:
        return f"{fields['site']}.{fields.get('name', section)}"
    if section == "circuit" and "site" in fields:
        return f"{fields['site']}.{fields['id']}"
    if section == "trench" and "id" not in fields:
        return f"{fields['from']}-{fields['to']}"
    if section == "effect":
        return None
    return fields.get("id")


def _method(entry: Entry, owner: str) -> Callable[..., str | None]:
    """The method that adds an entry; unknown arguments are told with a suggestion."""
    leading = [_grammar.argument(field) for field in entry.leading]

    def method(self: Any, *values: Any, **fields: Any) -> str | None:
        if len(values) > len(leading):
            raise TypeError(f"Grid.{entry.path} takes {len(leading)} arguments without a keyword, not {len(values)}")
        given = dict(zip(leading, values, strict=False))
        for field, name in zip(entry.leading, leading, strict=True):
            if name in given and name in fields:
                raise TypeError(f"Grid.{entry.path} got `{name}` twice")
            value = given.setdefault(name, fields.pop(name, None))
            if entry.must(field) and value is None:
                raise TypeError(f"Grid.{entry.path} needs `{name}`")
        grid: Grid = self if owner == "Grid" else self._grid
        return grid._add(entry, {**given, **entry.fixed, **fields})

    method.__name__ = entry.method
    method.__qualname__ = f"{owner}.{entry.method}"
    method.__doc__ = "\n".join(_grammar.docstring(entry))
    parameter, kinds = inspect.Parameter, inspect._ParameterKind
    parameters = [parameter("self", kinds.POSITIONAL_OR_KEYWORD)]
    for field in entry.leading:
        default = parameter.empty if entry.must(field) else None
        name = _grammar.argument(field)
        parameters.append(parameter(name, kinds.POSITIONAL_OR_KEYWORD, default=default))
    others = map(_grammar.argument, entry.others())
    parameters += [parameter(name, kinds.KEYWORD_ONLY, default=None) for name in others]
    method.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return method


class _Group:
    """The kinds of one section."""

    def __init__(self, grid: Grid) -> None:
        self._grid = grid


_GROUPS: dict[str, type[_Group]] = {}


def _build() -> None:
    for entry in _grammar.entries():
        if entry.section not in _grammar.GROUPS:
            setattr(Grid, entry.method, _method(entry, "Grid"))
            continue
        name = f"_{entry.section.title().replace('_', '')}"
        if entry.section not in _GROUPS:
            _GROUPS[entry.section] = type(name, (_Group,), {"__doc__": f"Methods that add a `{entry.section}`."})
        setattr(_GROUPS[entry.section], entry.method, _method(entry, name))


_build()
