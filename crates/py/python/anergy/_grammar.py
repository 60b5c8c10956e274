"""The entries of the model file as methods: from `anergy.schema`, for `anergy.grid` and its stub."""

from __future__ import annotations

import difflib
import keyword
import numbers
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from anergy._core import schema

Json = dict[str, Any]

LEADING: dict[str, tuple[str, ...]] = {
    "pipe_type": ("id",),
    "heat_pump_map": ("id",),
    "station_type": ("id",),
    "house_type": ("id",),
    "house": ("site", "type"),
    "site": ("id",),
    "trench": ("from", "to"),
    "station": ("site",),
    "node": ("id",),
    "edge": ("id", "from", "to"),
    "three_way_valve": ("id", "a", "b", "ab"),
    "four_way_mixer": ("id", "source_supply", "source_return", "load_supply", "load_return"),
    "interface": ("id", "edge"),
    "unit": ("site",),
    "circuit": ("id", "through"),
    "sensor": ("id", "measures"),
    "worst_point": ("id", "between"),
    "prescribed": ("quantity", "value", "free"),
    "schedule": ("signal", "points"),
    "series": ("signal", "file", "column"),
    "pressure_reference": ("node",),
    "effect": ("component",),
}
"""Arguments that need no keyword."""
OPTIONAL = {("unit", "site"), ("house", "type")}
"""Those of them that may be left out."""
GROUPS = ("station_type", "station", "edge", "unit", "controller", "effect")
"""Sections with a method for each kind."""
WORDS: dict[str, str] = {"effect": "id"}
"""The field that says the kind, where it is not `kind`."""


@dataclass(frozen=True)
class Entry:
    """An entry of the model file and the method that adds it."""

    section: str
    method: str
    shape: str
    """`table`, `named` (`[section.NAME]`) or `list` (`[[section]]`)."""
    fixed: Json
    """Fields that the method stands for, as `kind`."""
    leading: tuple[str, ...]
    fields: Json
    """JSON Schema of every name that a field can have."""
    about: str

    @property
    def path(self) -> str:
        """How it is called."""
        return f"{self.section}.{self.method}" if self.section in GROUPS else self.method

    def others(self) -> list[str]:
        """Fields whose arguments need their keyword."""
        return [name for name in self.fields if name not in self.leading and name not in self.fixed]

    def must(self, field: str) -> bool:
        """Whether a leading argument has to be given."""
        return (self.section, field) not in OPTIONAL


_sections: Json = {}


def properties() -> Json:
    """The sections of the model file."""
    if not _sections:
        _sections.update(schema()["properties"])
    return _sections


def entries() -> list[Entry]:
    """All entries that a grid can have."""
    return [
        entry
        for section, whole in properties().items()
        if section not in ("format", "model")
        for entry in _of_section(section, whole)
    ]


def _of_section(section: str, whole: Json) -> Iterator[Entry]:
    if whole.get("type") == "array":
        shape, each = "list", whole["items"]
    elif isinstance(whole.get("additionalProperties"), dict):
        shape, each = "named", whole["additionalProperties"]
    elif "oneOf" in whole:
        # One table or several.
        shape, each = "list", whole["oneOf"][0]
    else:
        shape, each = "table", whole
    leading = LEADING.get(section, ())
    variants = each.get("oneOf", [each])
    for variant in variants:
        fields, about = variant["properties"], variant.get("description", "")
        if section not in GROUPS:
            yield Entry(section, section, shape, {}, leading, fields, about)
            continue
        word = WORDS.get(section, "kind")
        for kind in fields[word].get("enum") or [fields[word]["const"]]:
            yield Entry(section, kind.lower(), shape, {word: kind}, leading, fields, about)
    if section == "station":
        every = {name: field for variant in variants for name, field in variant["properties"].items()}
        about = "A station of a `station_type`, which says what it is."
        yield Entry(section, "of_type", shape, {}, ("site", "type"), every, about)


def argument(field: str) -> str:
    """A field as the name of an argument: `from` is a word of Python."""
    return f"{field}_" if keyword.iskeyword(field) else field


def si(name: str, fields: Json) -> str:
    """The field that a name is another unit of; other names are their own."""
    found = re.fullmatch(r"(\w+) in [\w/]+", fields[name].get("description", ""))
    return found[1] if found and found[1] in fields else name


def units(field: str, fields: Json) -> list[str]:
    """All names of a field, the SI one first."""
    return [field, *(name for name in fields if name != field and si(name, fields) == field)]


def tables(field: Json) -> list[Json]:
    """The tables that a field can hold, each as its fields."""
    options = [field, *field.get("anyOf", []), *field.get("oneOf", [])]
    return [option["properties"] for option in options if "properties" in option]


def words(field: Json) -> list[str]:
    """The words that a field can be; none where it can be something else."""
    options = [one for one in (field, *field.get("anyOf", [])) if one.get("type") != "null"]
    found: list[str] = []
    for option in options:
        if "enum" in option:
            found += [word for word in option["enum"] if isinstance(word, str)]
        elif "const" in option.get("oneOf", [{}])[0]:
            found += [one["const"] for one in option["oneOf"] if "const" in one]
        elif len(options) > 1 or "type" in option or "anyOf" not in option:
            return []
    return found


def check(given: Mapping[str, Any], fields: Json, where: str, word: str = "argument") -> None:
    """Raises for a name, a word or a type that a field cannot have, and for a quantity in two units."""
    seen: dict[str, str] = {}
    for name, value in given.items():
        if name not in fields:
            raise TypeError(f"{where} has no {word} `{name}`{suggestion(name, fields)}")
        field = si(name, fields)
        if field in seen:
            raise TypeError(f"{where} got `{seen[field]}` and `{name}`: give one of them")
        seen[field] = name
        _check_value(name, value, fields[name], where)


def _check_value(name: str, value: Any, field: Json, where: str) -> None:
    possible = words(field)
    if possible and isinstance(value, str) and value not in possible:
        close = difflib.get_close_matches(value, possible, 1)
        hint = f"did you mean \"{close[0]}\"? " if close else ""
        known = ", ".join(f'"{one}"' for one in possible)
        raise ValueError(f'{where}: {name} = "{value}" is unknown; {hint}Possible: {known}')
    kind = field.get("type", [])
    kinds = [kind] if isinstance(kind, str) else kind
    if "number" in kinds and "string" not in kinds and not isinstance(value, numbers.Real):
        shape = getattr(value, "shape", None)
        if shape != ():
            raise TypeError(f"{where}: {name} must be a number, not {value!r}")
    inner = tables(field)
    if inner and isinstance(value, Mapping):
        every = {key: one for table in inner for key, one in table.items()}
        check(value, every, f"{where}: {name}", "field")


def suggestion(name: str, fields: Json) -> str:
    """What was probably meant by a name that does not exist."""
    by_quantity = [field for field in fields if si(field, fields) == field and _quantity(field, fields) in _stems(name)]
    meant = max(by_quantity, key=len, default=None)
    if meant is None:
        close = difflib.get_close_matches(name, fields, 1, 0.7)
        return f"; did you mean `{argument(close[0])}`?" if close else ""
    names = units(meant, fields)
    more = f" Its units: {', '.join(f'`{one}`' for one in names)}" if len(names) > 1 else ""
    return f"; did you mean `{meant}`?{more}"


def _quantity(field: str, fields: Json) -> str | None:
    """`length` of `length_m`, where the field has other units."""
    names = units(field, fields)
    if len(names) < 2:
        return None
    parts = [name.split("_") for name in names]
    same = 0
    while all(len(part) > same and part[same] == parts[0][same] for part in parts):
        same += 1
    return "_".join(parts[0][:same])


def _stems(name: str) -> list[str]:
    """Beginnings of a name: `a_b_c`, `a_b`, `a`."""
    parts = name.split("_")
    return ["_".join(parts[:n]) for n in range(len(parts), 0, -1)]


def described(fields: Json, names: list[str]) -> list[str]:
    """Lines about fields, for a docstring: each quantity once."""
    lines = []
    for name in names:
        if si(name, fields) != name:
            continue
        text = " ".join(fields[name].get("description", "").split())
        possible = words(fields[name])
        if possible:
            text += f" One of {', '.join(possible)}."
        if "default" in fields[name] and fields[name]["default"] not in ("", None, [], {}):
            text += f" Default: {fields[name]['default']}."
        others = units(name, fields)[1:]
        if others:
            text += f" Also {', '.join(others)}."
        lines += [argument(name), f"    {text}" if text else "    As the model file says."]
    return lines


def docstring(entry: Entry) -> list[str]:
    """What the method of an entry says of itself."""
    of = {"table": f"`[{entry.section}]`", "named": f"`[{entry.section}.ID]`", "list": f"`[[{entry.section}]]`"}
    kind = "".join(f" with {field} = \"{value}\"" for field, value in entry.fixed.items())
    about = " ".join(entry.about.split())
    first = [f"Adds {of[entry.shape]}{kind}.", "", *([about, ""] if about else [])]
    names = [*(name for name in entry.leading if name in entry.fields), *entry.others()]
    lines = [*first, "Parameters", "----------"]
    if entry.shape == "named":
        lines += ["id", "    Its name."]
    return lines + described(entry.fields, names)
