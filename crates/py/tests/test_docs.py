"""Docstrings say what is true: their examples run, and everything public has one. Pages lead where they say."""

import doctest
import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import anergy
import pytest

ROOT = Path(__file__).parents[3]
BOOK = ROOT / "docs/src"
PAGES = [
    *ROOT.glob("*.md"),
    *BOOK.rglob("*.md"),
    *ROOT.glob("examples/*/README.md"),
]
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


def anchors(page):
    """Headings as the fragments that mdBook and GitHub make of them."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    for heading in re.findall(r"^#+ (.*)$", text, re.MULTILINE):
        plain = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).strip().lower()
        yield re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    text = re.sub(r"^```.*?^```$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        assert there.exists(), target
        if anchor and there.suffix == ".md":
            assert anchor in anchors(there), target


def test_every_page_is_in_the_book():
    summary = (BOOK / "SUMMARY.md").read_text()
    listed = {(BOOK / path).resolve() for path in re.findall(r"\]\(([^)#]+)\)", summary)}
    assert listed == {page.resolve() for page in BOOK.rglob("*.md") if page.name != "SUMMARY.md"}
