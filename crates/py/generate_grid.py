"""Writes `python/anergy/grid.pyi` from `anergy.schema()`: what editors and type checkers know of `anergy.Grid`.

Run it after a change of the model file's grammar: python crates/py/generate_grid.py
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from anergy import _grammar
from anergy._grammar import Entry, Json

HEAD = '''\
# Written by crates/py/generate_grid.py from anergy.schema(): change it there.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Final, Literal, TypedDict

from anergy._core import Model

__all__ = ["Grid"]
'''
STUB = Path(__file__).parent / "python/anergy/grid.pyi"
WIDTH = 110


class Types:
    """Types of fields; tables become a TypedDict each."""

    def __init__(self) -> None:
        self.names: dict[str, str] = {}
        self.texts: list[str] = []

    def of(self, field: Json, name: str) -> str:
        """The type of a field, without None."""
        words = _grammar.words(field)
        if words:
            return f"Literal[{', '.join(json.dumps(word) for word in words)}]"
        if "properties" in field:
            return self.table(field["properties"], name)
        for key in ("anyOf", "oneOf"):
            if key in field:
                options = [self.of(one, name) for one in field[key] if one.get("type") != "null"]
                return " | ".join(dict.fromkeys(options))
        kinds = field.get("type", [])
        kinds = [kinds] if isinstance(kinds, str) else [kind for kind in kinds if kind != "null"]
        return " | ".join(self.simple(kind, field, name) for kind in kinds) or "Any"

    def simple(self, kind: str, field: Json, name: str) -> str:
        """The type of one JSON type."""
        known = {"number": "float", "integer": "int", "string": "str", "boolean": "bool"}
        if kind == "array":
            inner = field.get("items", field.get("prefixItems", [{}])[0])
            inner = inner if isinstance(inner, dict) else {}
            if "prefixItems" in inner:
                return f"Sequence[Sequence[{self.of(inner['prefixItems'][0], name)}]]"
            return f"Sequence[{self.of(inner, name)}]"
        if kind == "object":
            values = field.get("additionalProperties")
            inner = self.of(values, name) if isinstance(values, dict) else "Any"
            return f"Mapping[str, {inner}]"
        return known[kind]

    def table(self, fields: Json, name: str) -> str:
        """The TypedDict of a table; equal tables share one."""
        key = json.dumps(fields, sort_keys=True)
        if key in self.names:
            return self.names[key]
        title = "_" + "".join(part.title() for part in name.split("_"))
        taken = set(self.names.values())
        while title in taken:
            title += "2" if not title[-1].isdigit() else "0"
        self.names[key] = title
        lines = [f"class {title}(TypedDict, total=False):"]
        lines += [f"    {field}: {self.of(one, field)}" for field, one in fields.items()]
        self.texts.append("\n".join(lines) + "\n")
        return title


def method(entry: Entry, types: Types) -> Iterator[str]:
    """The lines of a method."""
    yield f"    def {entry.method}("
    yield "        self,"
    for field in entry.leading:
        kind = types.of(entry.fields.get(field, {"type": "string"}), field)
        must = entry.must(field)
        yield f"        {_grammar.argument(field)}: {kind}{'' if must else ' | None = None'},"
    if entry.others():
        yield "        *,"
    for field in entry.others():
        kind = types.of(entry.fields[field], field)
        more = "" if kind == "Any" else " | None"
        yield f"        {_grammar.argument(field)}: {kind}{more} = None,"
    yield "    ) -> str | None:" if name_is_unsure(entry) else f"    ) -> {'None' if nameless(entry) else 'str'}:"
    yield '        """' + "\n".join(indented(_grammar.docstring(entry))).strip()
    yield '        """'


def nameless(entry: Entry) -> bool:
    """Whether an entry has no name to return."""
    return entry.shape == "table" or not ({"id", "site"} & {*entry.leading, *entry.fields}) or entry.section == "effect"


def name_is_unsure(entry: Entry) -> bool:
    """Whether an entry has a name only when one is given."""
    return entry.section in ("unit", "controller", "prescribed", "house") and not nameless(entry)


def indented(lines: list[str]) -> Iterator[str]:
    """Lines of a docstring; long ones are wrapped."""
    for line in lines:
        start = line[: len(line) - len(line.lstrip())]
        now = ""
        for word in line.split():
            if len(now) + len(word) > WIDTH - len(start) - 8 and now:
                yield f"        {start}{now}"
                now = word
            else:
                now = f"{now} {word}".strip()
        yield f"        {start}{now}".rstrip()


def text() -> str:
    """The whole stub."""
    types = Types()
    groups: dict[str, list[str]] = {}
    own: list[str] = []
    for entry in _grammar.entries():
        lines = list(method(entry, types))
        (groups.setdefault(entry.section, []) if entry.section in _grammar.GROUPS else own).extend(lines)
    parts = [HEAD]
    model = _grammar.properties()["model"]["properties"]
    more = [f"{name}: {types.of(field, name)} | None = None" for name, field in model.items() if name != "name"]
    init = ["self", 'name: str = "untitled"', 'directory: str | PathLike[str] = "."', "*", *more]
    parts += types.texts
    title = {group: f"_{group.title().replace('_', '')}" for group in groups}
    for group, lines in groups.items():
        parts.append("\n".join([f"class {title[group]}:", *lines]) + "\n")
    head = [
        "class Grid:",
        "    def __init__(",
        *(f"        {argument}," for argument in init),
        "    ) -> None: ...",
        *(f"    {group}: Final[{title[group]}]" for group in groups),
        "    def to_dict(self) -> dict[str, Any]: ...",
        "    def model(self) -> Model: ...",
        "    def _repr_html_(self) -> str: ...",
        *own,
    ]
    parts.append("\n".join(head) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    STUB.write_text(text())
