"""Docstrings say what is true: their examples run, and everything public has one."""

import doctest
import importlib
import inspect
import pkgutil

import anergy
import pytest

MODULES = ["anergy", *(f"anergy.{m.name}" for m in pkgutil.iter_modules(anergy.__path__))]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings(name):
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0
    if name == "anergy":
        assert found.attempted > 20


def test_schema_example():
    # A built-in function is not found by doctest.testmod.
    finder = doctest.DocTestFinder(exclude_empty=False)
    (test,) = finder.find(anergy.schema, "schema", module=False)
    assert doctest.DocTestRunner().run(test) == (0, 2)


@pytest.mark.parametrize("name", anergy.__all__)
def test_everything_public_is_documented(name):
    thing = getattr(anergy, name)
    if name.startswith("_"):
        return
    assert inspect.getdoc(thing), name
    if inspect.isclass(thing):
        for member, value in vars(thing).items():
            described = callable(value) or inspect.isdatadescriptor(value)
            if described and not member.startswith("_"):
                assert inspect.getdoc(value), f"{name}.{member}"
