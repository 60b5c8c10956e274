"""`anergy.explain`: a hidden effect, from files and from tables."""

from pathlib import Path

import anergy
import pytest

FOLDER = Path(__file__).parents[3] / "examples" / "hidden-effect"
SENSORS = [
    {"column": "T_in_degC", "signal": "plant.temperature_k", "unit": "degC", "role": "input", "class": "pt100_a"},
    {"column": "flow_kg_h", "signal": "plant.m_flow_kg_s", "unit": "kg_h", "role": "input", "class": "mid"},
    {"column": "T_out_degC", "signal": "house.t_k", "unit": "degC", "role": "compare", "class": "pt100_a", "quantisation": 0.1},
]


def test_the_missing_effect_is_named_and_added(tmp_path):
    model = anergy.Model.from_file(FOLDER / "model.toml")
    found = anergy.explain(model, FOLDER / "data.csv", FOLDER / "sensors.toml")
    assert found.verdict == "named"
    (effect,) = found.effects
    assert (effect["id"], effect["component"]) == ("P1", "street")
    value = effect["params"]["wall_capacity_j_m_k"]
    assert value["lo"] < 1377 < value["hi"] and value["unit"] == "J/(m K)"
    assert found.rivals == [("P1", "street")]
    assert found.model.to_dict()["effect"][0]["id"] == "P1"
    assert found.model.to_toml().startswith(model.to_toml())
    found.report(tmp_path / "report.html")
    assert "<svg" in (tmp_path / "report.html").read_text()
    assert "P1 street" in found._repr_html_()
    assert "| P1 | street |" in found.markdown


def test_tables_and_entries_and_what_is_wrong_with_them():
    pandas = pytest.importorskip("pandas")
    model = anergy.Model.from_file(FOLDER / "model.toml")
    table = pandas.read_csv(FOLDER / "data.csv")
    stuck = table.assign(T_out_degC=50.0)
    found = anergy.explain(model, stuck, SENSORS)
    assert found.verdict == "data_problem" and "never changes" in found.problems[0]
    assert found.effects == [] and found.model.to_toml() == model.to_toml()
    with pytest.raises(ValueError, match='no column "T_out_degC"'):
        anergy.explain(model, table.drop(columns="T_out_degC"), SENSORS)
    with pytest.raises(ValueError, match='no channel "house.t_kk"; did you mean "house.t_k"'):
        anergy.explain(model, table, [*SENSORS[:2], SENSORS[2] | {"signal": "house.t_kk"}])
