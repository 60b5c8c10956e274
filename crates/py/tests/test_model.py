import pickle
import sys
from pathlib import Path

import anergy
import numpy as np
import pytest


def test_examples():
    assert anergy.examples.names() == ["three-houses", "pump-hunting"]
    source = Path(__file__).parents[3] / "examples" / "three-houses" / "model.toml"
    assert anergy.examples.text("three-houses") == source.read_text()
    with pytest.raises(KeyError, match="did you mean `three-houses`"):
        anergy.examples.load("three-house")


def test_steady_flows_are_the_published_ones(model):
    steady = model.solve()
    l_min = {id: 60 * steady[id]["m_flow_kg_s"] for id in ("sf1.feed_in_pump", "sf2.feed_in_pump")}
    assert l_min["sf1.feed_in_pump"] == pytest.approx(0.781, abs=1e-3)
    assert l_min["sf2.feed_in_pump"] == pytest.approx(7.920, abs=1e-3)
    assert steady.iterations > 0
    assert 0 <= steady.residual_pa < 1e-3


def test_steady_tables(model):
    steady = model.solve()
    assert list(steady.nodes) == ["id", "p_pa", "t_k", "elevation_m"]
    assert list(steady.edges) == ["id", "kind", "m_flow_kg_s", "dp_pa"]
    assert steady.nodes.ids == model.nodes and steady.edges.ids == model.edges
    n = len(model.edges)
    assert all(column.shape == (n,) for column in steady.edges.values())
    assert steady.edges["m_flow_kg_s"].dtype == np.float64
    assert steady["sf4.cold"]["p_pa"] == pytest.approx(1.5e5)
    row = steady["sf1.feed_in_pump"]
    assert row["kind"] == "pump" and type(row["dp_pa"]) is float
    with pytest.raises(KeyError, match="did you mean `sf1.feed_in_pump`"):
        steady["sf1.feedin_pump"]
    assert "sf1.feed_in_pump" in repr(steady.edges)
    assert steady.edges._repr_html_().count("<tr>") == n + 1
    again = pickle.loads(pickle.dumps(steady))
    assert repr(again) == repr(steady) and np.array_equal(again.edges["dp_pa"], steady.edges["dp_pa"])


def test_table_to_pandas(model):
    pytest.importorskip("pandas", reason="pandas is not installed")
    edges = model.solve().edges.to_pandas()
    assert edges.index.name == "id"
    assert edges.loc["sf2.feed_in_pump", "m_flow_kg_s"] == pytest.approx(0.132, abs=1e-3)


def test_set_and_scale_give_new_models(model):
    longer = model.set("sf1-sf2.hot.length_m", np.float64(400))
    assert longer.parameters()["sf1-sf2.hot.length_m"] == 400
    assert model.parameters()["sf1-sf2.hot.length_m"] == 200
    assert model.scale("sf1-sf2.hot.length_m", 2).expand() == longer.expand()
    assert longer.to_toml() == longer.expand() != model.to_toml()
    # A longer pipe lets less through.
    flow = [m.solve()["sf1.feed_in_pump"]["m_flow_kg_s"] for m in (model, longer)]
    assert flow[1] < flow[0]
    assert model.set("ground.temperature_k", 280).solve()["sf1.hot"]["t_k"] > 280


def test_set_of_what_does_not_exist(model):
    with pytest.raises(anergy.UnknownNameError, match="did you mean `sf1-sf2.hot.length_m`") as error:
        model.set("sf1-sf2.hot.lenght_m", 1)
    assert error.value.name == "sf1-sf2.hot.lenght_m"
    with pytest.raises(ValueError, match="sf1-sf2.hot.length_m"):
        model.set("sf1-sf2.hot.length_m", "long")
    with pytest.raises(ValueError, match="finite"):
        model.scale("sf1-sf2.hot.length_m", float("nan"))
    with pytest.raises(anergy.ModelError, match="length_m") as error:
        model.set("sf1-sf2.hot.length_m", -1).check()
    # The place is that of the trench in the text that was read.
    line = model.to_toml().splitlines()[error.value.problems[0]["line"] - 1]
    assert line in ("[[trench]]", "length_m = 200")


def test_dict_round_trip(model):
    data = model.to_dict()
    assert data["format"] == 1 and data["site"][0]["id"] == "sf1"
    if sys.version_info >= (3, 11):
        import tomllib

        assert data == tomllib.loads(model.to_toml())
    again = anergy.Model.from_dict(data)
    assert again.to_dict() == data
    assert again.expand() == model.expand()
    changed = model.scale("sf1-sf2.hot.length_m", 2)
    assert anergy.Model.from_dict(changed.to_dict()).expand() == changed.expand()


def test_dict_of_numpy_and_in_any_order(model):
    data = model.to_dict()
    data["schedule"][0]["points"] = np.array([[0, 1.0], [2230, 1.0], [2250, 0.85]])
    data["trench"] = tuple(data["trench"])
    data["trench"][0]["length_m"] = np.int64(200)
    backwards = dict(reversed(data.items()))
    again = anergy.Model.from_dict(backwards)
    assert again.solve()["sf1.feed_in_pump"] == model.solve()["sf1.feed_in_pump"]


def test_dict_with_what_a_model_cannot_hold(model):
    for value, error in [(None, TypeError), (object(), TypeError), (float("nan"), ValueError)]:
        data = model.to_dict()
        data["trench"][0]["length_m"] = value
        with pytest.raises(error, match=r'model\["trench"\]\[0\]\["length_m"\]'):
            anergy.Model.from_dict(data)
    data = {}
    data["run"] = data
    with pytest.raises(ValueError, match="nested too deeply"):
        anergy.Model.from_dict(data)
    with pytest.raises(TypeError, match="must be a dict, not list"):
        anergy.Model.from_dict([])
    with pytest.raises(TypeError, match="not a str"):
        anergy.Model.from_dict({1: 2})


def test_files(model, tmp_path):
    model.to_file(tmp_path / "a.toml")
    again = anergy.Model.from_file(tmp_path / "a.toml")
    assert again.to_toml() == model.to_toml()
    changed = model.set("sf1-sf2.hot.length_m", 300)
    changed.to_file(str(tmp_path / "b.toml"))
    assert anergy.Model.from_file(str(tmp_path / "b.toml")).expand() == changed.expand()


def test_pickle(model):
    again = pickle.loads(pickle.dumps(model))
    assert again.to_toml() == model.to_toml()
    changed = model.set("sf1-sf2.hot.length_m", 300).scale("sf1-sf2.cold.length_m", 1.5)
    again = pickle.loads(pickle.dumps(changed))
    assert again.expand() == changed.expand()
    assert again.solve().edges["dp_pa"].tolist() == changed.solve().edges["dp_pa"].tolist()


def test_series(series_model, tmp_path):
    model = anergy.Model.from_file(series_model)
    flow = "sf1.station.m_flow_kg_s"
    expected = model.simulate(until_s=600, record_s=60)[flow]
    assert expected[-1] > 2 * expected[1]
    data = model.to_dict()
    assert anergy.Model.from_dict(data, directory=series_model.parent).to_dict() == data
    # In its own directory the file stays as it is; elsewhere it holds the points itself.
    model.to_file(series_model.with_name("copy.toml"))
    assert series_model.with_name("copy.toml").read_text() == series_model.read_text()
    model.to_file(tmp_path / "alone.toml")
    pickled = pickle.dumps(model)
    series_model.with_name("run.csv").unlink()
    with pytest.raises(anergy.ModelError, match=r"run\.csv"):
        anergy.Model.from_file(series_model)
    for again in (anergy.Model.from_file(tmp_path / "alone.toml"), pickle.loads(pickled)):
        assert again.simulate(until_s=600, record_s=60)[flow].tolist() == expected.tolist()


def test_lists_of_names_and_looks(model):
    assert model.name == "three houses: pump blocking"
    assert model.stations == ["sf1.station", "sf2.station", "sf4.station"]
    assert model.units == ["sf1.unit", "sf2.unit", "sf4.unit"]
    assert model.controllers == []
    assert model.check() is None
    named = model.to_dict()
    named["model"]["name"] = "<b>"
    assert "&lt;b&gt;" in anergy.Model.from_dict(named)._repr_html_()


def test_schema():
    schema = anergy.schema()
    assert schema["type"] == "object"
    assert schema["$schema"].startswith("https://json-schema.org/")
    assert {"format", "model", "site", "station", "edge"} <= set(schema["properties"])
