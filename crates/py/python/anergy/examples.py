"""Models that come with the package.

>>> import anergy
>>> anergy.examples.names()
['three-houses', 'pump-hunting']
>>> anergy.examples.load("three-houses").name
'three houses: pump blocking'
"""

from __future__ import annotations

from anergy._core import Model, _examples, _unknown_name

__all__ = ["load", "names", "text"]


def names() -> list[str]:
    """Names of the models that come with the package."""
    return [name for name, _ in _examples()]


def text(name: str) -> str:
    """The model file of an example (TOML), with its comments.

    Raises
    ------
    UnknownNameError
        For an example that does not exist.
    """
    for known, content in _examples():
        if known == name:
            return content
    raise _unknown_name("example", name, names())


def load(name: str) -> Model:
    """One of the models that come with the package.

    Raises
    ------
    UnknownNameError
        For an example that does not exist.
    """
    return Model.from_toml(text(name))
