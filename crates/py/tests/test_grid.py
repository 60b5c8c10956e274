"""A model built in Python: the whole grammar of the model file, wrong names told at once."""

import runpy
import sys
from pathlib import Path

import anergy
import numpy as np
import pytest
from anergy import _grammar

HERE = Path(__file__).parent


def three_houses() -> anergy.Grid:
    grid = anergy.Grid("three houses: pump blocking")
    grid.run(until="1h", step="1s", record="10s", initial_degc=40)
    grid.fluid(kind="constant_water", density_kg_m3=1000, heat_capacity_j_kg_k=4180)
    grid.ground(temperature_degc=12)
    pipe = grid.pipe_type(
        "dn20", inner_diameter_mm=22, roughness_mm=0.011, zeta=10, friction="swamee_jain", transition="linear",
        fixed_velocity_m_s=0.22, delta_m=0.01, insulation_resistance_k_m_w=3.78,
    )
    sf1, sf2, sf4 = grid.site("sf1"), grid.site("sf2"), grid.site("sf4")
    grid.trench(sf1, sf2, length_m=200, pipe=pipe)
    grid.trench(sf2, sf4, length_km=0.05, pipe=pipe)
    parts = {"stub": {"pipe": pipe, "length_m": 5, "zeta": 1.75}, "heat_exchanger": {"delta_m": 0.01}}
    for site, speed in ((sf1, 0.95), (sf2, 1.0)):
        grid.station.producer(
            site, requested_flow_l_min=3.5, feed_in_pump={"speed": speed},
            feed_in_check_valve={"kvs_m3_h": 11, "leakage": 1e-3, "delta_m": 0.01}, **parts,
        )
        grid.unit.prescribed_source(site, supply_degc=65, v_flow_l_min=8)
    grid.station.consumer(sf4, extraction_valve={"command": "kappa", "kappa": 0.5, "delta_m": 0.01}, **parts)
    grid.unit.prescribed_source(sf4, supply_degc=40, v_flow_l_min=8)
    points = [[0, 1.0], [2230, 1.0], [2250, 0.85]]
    grid.schedule("sf2.feed_in_pump.speed", points, interpolation="linear")
    grid.pressure_reference("sf4.cold", pressure_bar=1.5)
    return grid


def test_the_three_houses_are_the_example(model, tmp_path):
    """Bit for bit, also through the file that is written."""
    built = three_houses().model()
    expected = model.simulate(record_s=60)
    path = tmp_path / "model.toml"
    built.to_file(path)
    for one in (built, anergy.Model.from_file(path), anergy.Model.from_dict(three_houses().to_dict())):
        result = one.simulate(record_s=60)
        assert result.channels == expected.channels
        assert np.array_equal(result.time_s, expected.time_s)
        for name in expected:
            assert np.array_equal(result[name], expected[name], equal_nan=True), name
    text = path.read_text()
    assert "[pipe_type.dn20]\ninner_diameter_mm = 22\n" in text
    assert '[[trench]]\nfrom = "sf1"\nto = "sf2"\n' in text
    assert text.index("[model]") < text.index("[[site]]") < text.index("[[station]]")


def test_the_stub_is_up_to_date():
    found = runpy.run_path(str(HERE.parent / "generate_grid.py"))
    fresh = found["STUB"].read_text() == found["text"]()
    assert fresh, "the model file has changed: run python crates/py/generate_grid.py"


def test_everything_of_the_model_file_can_be_added():
    """Every section and kind of the schema has its method, whose arguments are its fields."""
    kinds = 0
    for section, whole in anergy.schema()["properties"].items():
        if section in ("format", "model"):
            continue
        each = whole.get("items") or whole.get("additionalProperties") or whole
        each = whole if isinstance(each, bool) else each
        if section == "pressure_reference":
            each = whole["oneOf"][0]
        for variant in each.get("oneOf", [each]):
            fields = variant["properties"]
            word = fields.get("id" if section == "effect" else "kind", {})
            names = word.get("enum") or ([word["const"]] if "const" in word else [None])
            for name in names:
                methods = [
                    entry
                    for entry in _grammar.entries()
                    if entry.section == section and (name is None or name in entry.fixed.values())
                ]
                (entry,) = methods
                said = {*entry.leading, *entry.fixed, *entry.others()}
                assert said - {"id"} >= set(fields) - {"id"}
                kinds += 1
    assert kinds > 55
    grid = anergy.Grid()
    for entry in _grammar.entries():
        method = grid
        for part in entry.path.split("."):
            method = getattr(method, part)
        assert callable(method) and method.__doc__.startswith("Adds `["), entry.path


def test_names_that_are_returned(model):
    grid = three_houses()
    assert grid.sensor("reading", "sf1.hot.t_k", time_constant_s=5) == "reading"
    assert grid.sensor("other", "sf1.hot.t_k") == "other"
    controller = grid.controller.pi(
        id="flow", measures="sf1.feed_in_pump.m_flow_kg_s", acts_on="sf1.feed_in_pump.speed",
        set_point=0.03, gain=0.6, integral_time_s=8,
    )
    meter = grid.edge.pipe("bypass", "sf1.hot", "sf1.cold", length_m=3, pipe="dn20")
    built = grid.model()
    assert controller in built.controllers and meter in built.edges
    site = grid.site("sf5")
    trench = grid.trench("sf4", site, length_m=10, pipe="dn20")
    station = grid.station.consumer(site)
    unit = grid.unit.heat_load(site, load_kw=2, temperature_difference_k=20)
    built = grid.model()
    assert station in built.stations and unit in built.units and f"{trench}.hot" in built.edges
    assert grid.run(until="2h") is None and grid.to_dict()["run"] == {
        "until": "2h", "step": "1s", "record": "10s", "initial_degc": 40,
    }


@pytest.mark.parametrize(
    "call, kind, message",
    [
        (lambda g: g.trench("a", "b", length_inch=3), TypeError,
         "Grid.trench has no argument `length_inch`; did you mean `length_m`? Its units: `length_m`, `length_mm`, `length_cm`, `length_km`"),
        (lambda g: g.trench("a", "b", length_bar=3), TypeError, "did you mean `length_m`"),
        (lambda g: g.trench("a", "b", length=3), TypeError, "did you mean `length_m`"),
        (lambda g: g.trench("a", "b", lenght_m=3), TypeError, "did you mean `length_m`?"),
        (lambda g: g.trench("a", "b", colour=3), TypeError, "Grid.trench has no argument `colour`"),
        (lambda g: g.trench("a", "b", length_m=3, length_km=1), TypeError, "got `length_m` and `length_km`: give one"),
        (lambda g: g.trench("a", "b", length_m="3"), TypeError, "length_m must be a number, not '3'"),
        (lambda g: g.trench("a"), TypeError, "Grid.trench needs `to`"),
        (lambda g: g.trench("a", "b", "c"), TypeError, "takes 2 arguments without a keyword, not 3"),
        (lambda g: g.trench("a", "b", from_="c"), TypeError, "got `from_` twice"),
        (lambda g: g.unit.heat_load("a", load_bar=3), TypeError, "did you mean `load_w`? Its units: `load_w`, `load_kw`"),
        (lambda g: g.unit.heat_load("a", temperature_difference_degc=3), TypeError, "did you mean `temperature_difference_k`"),
        (lambda g: g.edge.pump("p", "a", "b", mode="flwo"), ValueError, 'mode = "flwo" is unknown; did you mean "flow"? Possible: "speed"'),
        (lambda g: g.station.producer("a", feed_in_pump={"sped": 1}), TypeError,
         "Grid.station.producer: feed_in_pump has no field `sped`; did you mean `speed`?"),
        (lambda g: g.station.producer("a", stub={"length_inch": 1}), TypeError, "did you mean `length_m`? Its units"),
        (lambda g: g.run(untill="1h"), TypeError, "did you mean `until`"),
        (lambda g: anergy.Grid("x", gravty=1), TypeError, "Grid has no argument `gravty`; did you mean `gravity`?"),
    ],
)
def test_wrong_arguments_raise_at_once(call, kind, message):
    grid = anergy.Grid()
    with pytest.raises(kind) as raised:
        call(grid)
    assert message in str(raised.value)
    assert grid.to_dict() == {"format": 1, "model": {"name": "untitled"}}


def test_what_only_the_whole_shows_is_in_the_model():
    grid = three_houses()
    grid.trench("sf4", "sf9", length_m=10, pipe="dn20")
    with pytest.raises(anergy.ModelError, match="sf9"):
        grid.model().check()


def test_values_can_be_of_numpy_and_none(model):
    grid = three_houses()
    grid.site("sf5", x_m=np.float32(1.5), y_m=np.int64(3), elevation_m=None)
    grid.trench("sf4", "sf5", length_m=np.array(10.0), pipe="dn20")
    assert grid.to_dict()["site"][-1].keys() == {"id", "x_m", "y_m"}
    assert "sf4-sf5.hot" in grid.model().edges


def test_a_grid_is_not_changed_by_its_dict():
    grid = three_houses()
    grid.to_dict()["site"].clear()
    stub = {"length_m": 5}
    grid.station.consumer("sf1", name="second", stub=stub)
    stub["length_m"] = 7
    assert len(grid.to_dict()["site"]) == 3 and grid.to_dict()["station"][-1]["stub"] == {"length_m": 5}


def test_how_it_looks():
    assert repr(three_houses()) == (
        '<anergy.Grid "three houses: pump blocking": 1 pipe_type, 3 site, 2 trench, 3 station, '
        "3 unit, 1 schedule, 1 pressure_reference>"
    )
    assert "<th>trench</th><td>2</td>" in three_houses()._repr_html_()


def test_importing_the_package_makes_no_schema():
    import subprocess

    code = "import sys, anergy; print('anergy.grid' in sys.modules, 'matplotlib' in sys.modules, 'pandas' in sys.modules)"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).split() == ["False"] * 3
