"""What a new user reads works: the code of the pages is run as it stands, and prints what they show."""

import ast
import contextlib
import io
import json
import re
from pathlib import Path

import anergy
import pytest

ROOT = Path(__file__).parents[3]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(page):
    """Code of a page, and what is shown right after it."""
    text = page.read_text()
    found = list(FENCE.finditer(text))
    for block, after in zip(found, [*found[1:], None], strict=True):
        if block[1] == "python":
            shown = after and after[1] == "text" and text[block.end() : after.start()].strip() == ""
            line = text[: block.start()].count("\n") + 2
            yield line, block[2], after[2] if shown else None


def run(page, names):
    for line, code, shown in blocks(page):
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            exec(compile("\n" * (line - 1) + code, str(page), "exec"), names)
        if shown is not None:
            assert out.getvalue() == shown, f"{page}:{line}"
    return names


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("agg")
    monkeypatch.chdir(tmp_path)
    yield
    pytest.importorskip("matplotlib.pyplot").close("all")


def test_tutorial(tmp_path):
    page = ROOT / "docs/src/tutorial-python.md"
    assert sum(shown is not None for _, _, shown in blocks(page)) >= 7
    run(page, {})
    assert {path.name for path in tmp_path.iterdir()} >= {"pressures.png", "flows.png", "temperatures.png", "heat.png"}


def test_ambient_tutorial(tmp_path):
    page = ROOT / "docs/src/tutorial-5gdhc.md"
    assert sum(shown is not None for _, _, shown in blocks(page)) == 4
    run(page, {})
    assert {path.name for path in tmp_path.iterdir()} == {"flows.png", "storage.png"}


def test_readme(tmp_path):
    run(ROOT / "README.md", {})
    assert (tmp_path / "report.html").exists() and (tmp_path / "two-houses.toml").exists()


def test_notebooks(monkeypatch):
    """Every cell, and how its last value looks."""
    monkeypatch.chdir(ROOT / "examples/notebooks")
    notebooks = sorted((ROOT / "examples/notebooks").glob("*.ipynb"))
    assert len(notebooks) == 2
    for path in notebooks:
        names = {}
        for cell in json.loads(path.read_text())["cells"]:
            if cell["cell_type"] != "code":
                continue
            assert cell["outputs"] == [] and cell["execution_count"] is None
            body = ast.parse("".join(cell["source"]))
            last = body.body.pop() if isinstance(body.body[-1], ast.Expr) else None
            exec(compile(body, str(path), "exec"), names)
            if last is not None:
                value = eval(compile(ast.Expression(last.value), str(path), "eval"), names)
                if hasattr(value, "_repr_html_"):
                    assert "<table" in value._repr_html_()


def test_controllers_page():
    names = {"anergy": anergy, "model": anergy.examples.load("three-houses")}
    result = run(ROOT / "docs/src/controllers.md", names)["result"]
    for site in ("sf1", "sf2"):
        assert result[f"{site}.feed_in_pump.m_flow_kg_s"][-1] == pytest.approx(0.05, abs=1e-4)


@pytest.mark.parametrize("page", ["ensembles", "learning"])
def test_pages_begin_with_what_works(page, tmp_path):
    """Their later blocks need a cluster, or go on from what is in the text."""
    if page == "learning":
        pytest.importorskip("gymnasium")
    path = ROOT / f"docs/src/{page}.md"
    _, code, _ = next(iter(blocks(path)))
    exec(compile(code, str(path), "exec"), {})
    assert page == "learning" or (tmp_path / "flow.png").exists()
