import pickle

import anergy
import pytest


def test_all_problems_of_a_file(tmp_path):
    path = tmp_path / "model.toml"
    path.write_text("format = 1\n[run]\nuntill = '1h'\n[[site]]\nid = 'a'\n[[trenches]]\n")
    with pytest.raises(anergy.ModelError) as raised:
        anergy.Model.from_file(path)
    text, problems = str(raised.value), raised.value.problems
    assert f"{path}:3:1: [run]: unknown field `untill`\n    hint: did you mean `until`?" in text
    assert f"{path}:6:3: unknown section `trenches`" in text
    assert [problem["line"] for problem in sorted(problems, key=lambda p: p["line"])] == [3, 6]
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == text and again.problems == problems


def test_problems_of_a_dict_have_no_place(model):
    data = model.to_dict()
    data["trench"][0]["lenght_m"] = data["trench"][0].pop("length_m")
    with pytest.raises(anergy.ModelError) as raised:
        anergy.Model.from_dict(data)
    problems = raised.value.problems
    assert "did you mean `length_m`?" in [problem["hint"] for problem in problems]
    assert all(problem["line"] is None for problem in problems)
    assert str(raised.value).startswith('trench "sf1-sf2": unknown field `lenght_m`')
    assert "    hint: did you mean `length_m`?" in str(raised.value)


def test_problems_of_the_network(model):
    text = model.to_toml().replace('node = "sf4.cold"', 'node = "sf4.colt"')
    broken = anergy.Model.from_toml(text)
    line = text.splitlines().index('node = "sf4.colt"') + 1
    for attempt in (broken.check, broken.solve, broken.simulate, broken.simulation):
        with pytest.raises(anergy.ModelError, match=r"sf4\.colt") as raised:
            attempt()
        assert any(p["line"] == line for p in raised.value.problems)


def test_files_that_cannot_be_read(tmp_path):
    for read in (anergy.Model.from_file, anergy.Result.from_file):
        with pytest.raises(FileNotFoundError) as raised:
            read(tmp_path / "nothing")
        assert raised.value.filename == str(tmp_path / "nothing")
        with pytest.raises(IsADirectoryError):
            read(tmp_path)
    (tmp_path / "latin").write_bytes(b"# K\xfcche")
    with pytest.raises(anergy.ModelError, match="UTF-8"):
        anergy.Model.from_file(tmp_path / "latin")
    (tmp_path / "text").write_text("time;flow")
    with pytest.raises(anergy.RecordingError, match="not an MCAP file"):
        anergy.Result.from_file(tmp_path / "text")


def test_files_that_cannot_be_written(model, result, tmp_path):
    nowhere = tmp_path / "missing" / "file"
    with pytest.raises(FileNotFoundError):
        model.to_file(nowhere)
    with pytest.raises(FileNotFoundError):
        result.report(nowhere)
    (tmp_path / "file").touch()
    with pytest.raises(OSError, match="file"):
        model.simulate(until_s=1, out=tmp_path / "file")


@pytest.mark.parametrize("value", [0, -1, float("nan"), float("inf")])
def test_times_that_make_no_sense(model, value):
    with pytest.raises(ValueError, match="step_s"):
        model.simulate(step_s=value)
    with pytest.raises(ValueError, match="record_s"):
        model.simulate(record_s=value)
    with pytest.raises(ValueError, match="step_s"):
        model.simulation(step_s=value)
    if value != 0:
        with pytest.raises(ValueError, match="until_s"):
            model.simulate(until_s=value)


def test_a_failing_run_keeps_its_rows():
    """2 m of pipe at rest in air of 150 degC pass 99 degC after 1229 s."""
    data = {
        "format": 1,
        "node": [{"id": "a"}, {"id": "b"}],
        "edge": [
            {
                "id": "oven",
                "kind": "pipe",
                "from": "a",
                "to": "b",
                "length_m": 2.0,
                "inner_diameter_m": 0.02,
                "insulation_resistance_k_m_w": 1.0,
                "surroundings_k": 423.15,
            }
        ],
        "pressure_reference": [{"node": "a"}],
    }
    with pytest.raises(anergy.RunError, match="valid from 0.5 to 99 degC") as raised:
        anergy.Model.from_dict(data).simulate(until_s=3600, record_s=10)
    error = raised.value
    assert error.time is not None and error.component == "oven"
    assert 1200 <= error.result.time_s[-1] <= 1230
    assert error.result.summary["interrupted"] is True


def test_no_steady_state(model):
    """The pressure that the controller measures is given: its pump cannot change it."""
    data = model.to_dict()
    data["controller"] = [
        {
            "id": "hopeless",
            "kind": "pi",
            "measures": "sf4.cold.p_pa",
            "acts_on": "sf1.feed_in_pump.speed",
            "set_point": 1.0,
            "gain": 0.6,
            "integral_time_s": 8,
        }
    ]
    with pytest.raises(anergy.ConvergenceError, match="hopeless") as raised:
        anergy.Model.from_dict(data).solve()
    again = pickle.loads(pickle.dumps(raised.value))
    assert again.iterations == raised.value.iterations > 0
    assert str(again) == str(raised.value) and again.node is None


def test_hierarchy():
    assert issubclass(anergy.ConvergenceError, anergy.RunError)
    assert issubclass(anergy.UnknownNameError, KeyError)
    assert issubclass(anergy.OutOfRangeError, ValueError)
    assert issubclass(anergy.SnapshotError, ValueError)
    assert issubclass(anergy.Interrupted, KeyboardInterrupt)
    for name in ("ModelError", "RunError", "UnknownNameError", "OutOfRangeError", "RecordingError"):
        assert issubclass(getattr(anergy, name), anergy.AnergyError)


@pytest.mark.parametrize(
    ("call", "hint"),
    [
        (lambda: anergy.Model("street.toml"), r"Model.from_file\(path\)"),
        (lambda: anergy.Simulation(None), r"model.simulation\(\)"),
        (lambda: anergy.Result("results.mcap"), r"Result.from_file\(path\)"),
    ],
)
def test_a_class_says_what_makes_it(call, hint):
    with pytest.raises(TypeError, match=hint):
        call()


def test_names_of_other_packages_lead_to_ours():
    with pytest.raises(AttributeError, match="'run'; Model.simulate runs a model"):
        anergy.run  # noqa: B018
    assert not hasattr(anergy, "load")
    with pytest.raises(AttributeError, match="no attribute 'lod'$"):
        anergy.lod  # noqa: B018
