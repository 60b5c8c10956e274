"""The model of all tests: two feeders, of which the near one starves the far one."""

import anergy
import pytest


@pytest.fixture(scope="session")
def model() -> anergy.Model:
    return anergy.examples.load("three-houses")


@pytest.fixture(scope="session")
def result(model: anergy.Model) -> anergy.Result:
    return model.simulate(until_s=600, step_s=1, record_s=10)


@pytest.fixture
def series_model(tmp_path):
    """A model file whose pump follows a column of a CSV file next to it."""
    directory = tmp_path / "series"
    directory.mkdir()
    (directory / "run.csv").write_text("time_s,speed_pct\n0,100\n300,100\n301,85\n600,85\n")
    data = anergy.examples.load("three-houses").to_dict()
    del data["schedule"]
    data["series"] = [
        {
            "file": "run.csv",
            "column": "speed_pct",
            "signal": "sf2.feed_in_pump.speed",
            "unit": "percent",
            "interpolation": "hold",
        }
    ]
    anergy.Model.from_dict(data, directory=directory).to_file(directory / "model.toml")
    return directory / "model.toml"
