import json
import threading

import anergy
import numpy as np
import pytest
from anergy import _export

FIRST, SECOND = "sf1.feed_in_pump", "sf2.feed_in_pump"


@pytest.fixture(scope="module")
def hunting():
    return anergy.examples.load("pump-hunting")


@pytest.fixture(scope="module")
def plt():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    pyplot = pytest.importorskip("matplotlib.pyplot")
    yield pyplot
    pyplot.close("all")


def test_feeders(model):
    found = model.stability()
    row = found.feeders.row(FIRST)
    # As in docs/src/stability.md.
    assert row["margin_speed"] == pytest.approx(0.0166, abs=5e-5)
    assert row["threshold_speed"] == pytest.approx(0.9334, abs=5e-5)
    assert row["held_back"] and not row["blocked"] and row["blocked_by"] == SECOND
    assert found.feeders.row(SECOND)["blocked_by"] == ""
    assert found.controllers.ids == [] and found.modes == [] and found.stable
    slower = model.set(f"{FIRST}.speed", 0.9).set(f"{FIRST}.initial_speed", 0.9).stability()
    assert slower.feeders.row(FIRST)["blocked"]


def test_controllers_and_modes(hunting):
    found = hunting.stability()
    assert found.controllers.ids == ["pi1", "pi2"] and not found.stable
    # 0.0271 per l/min by hand (tests/pumps/hunting.rs).
    assert found.controllers["critical_gain"] / 60 == pytest.approx([0.0271] * 2, rel=0.02)
    first = found.modes[0]
    assert first.grows and not found.modes[-1].grows
    assert sum(first.participation.values()) == pytest.approx(1)
    assert sorted(abs(phase) for phase in first.phase_deg.values()) == pytest.approx([0, 180], abs=0.1)


def test_dict_has_all_and_makes_the_same(model):
    found = model.stability()
    data = json.loads(json.dumps(found.to_dict()))
    assert list(data) == ["feeders", "modes", "controllers"]
    assert data["feeders"][0]["opponents"][0]["id"] == SECOND
    assert anergy.Stability.from_dict(data).to_dict() == data
    data["feeders"].clear()
    assert found.to_dict()["feeders"]
    assert found.before is None and found.advice is None


def test_advice(model):
    found = model.stability(advise=True)
    cap, limit = found.advice
    assert cap["remedy"] == "speed_cap" and cap["helps"]
    # The head that the capped pump has, held whatever its valve does.
    assert limit["remedy"] == "dp_limit" and limit["helps"]
    assert limit["changes"][0].startswith(f'{SECOND}: mode = "head", head_pa = ')
    assert found.before["blocked"] == ["sf1.station"]
    assert "speed cap" in found._repr_html_()


def test_html_and_text(hunting):
    found = hunting.stability()
    assert repr(found) == (
        "<anergy.Stability: 2 feeders (0 blocked or held back), 2 controllers, 1 growing modes>"
    )
    assert found._repr_html_().count("<table") == 3


def test_errors(model):
    with pytest.raises(anergy.UnknownNameError):
        model.plot_pump("nobody")
    with pytest.raises(anergy.UnknownNameError):
        model.blocking_map(FIRST, "nobody")
    with pytest.raises(ValueError, match="is no pump"):
        model.plot_pump("sf1-sf2.hot")
    with pytest.raises(ValueError, match="different"):
        model.blocking_map(FIRST, FIRST)
    with pytest.raises(ValueError, match="2 to 400"):
        model.blocking_map(FIRST, SECOND, n=1)
    with pytest.raises(ValueError, match="no mode 0"):
        model.stability().plot_modes()


def test_map_agrees_with_steady_states(model):
    grid = model.blocking_map(FIRST, SECOND, n=11)
    assert grid.speeds == pytest.approx(np.linspace(0, 1, 11))
    assert grid.present == pytest.approx((0.95, 1.0))
    assert grid.blocked[FIRST][9, 10] and not grid.blocked[FIRST][10, 8]
    assert not grid.blocked[FIRST][0].any(), "a pump at rest is not blocked"
    slower = model
    for key in ("speed", "initial_speed"):
        slower = slower.set(f"{FIRST}.{key}", 1.0)
    flow = slower.solve()[FIRST]["m_flow_kg_s"]
    assert grid.m_flow_kg_s[FIRST][10, 10] == pytest.approx(flow, rel=1e-6)
    table = grid.to_table()
    k = 9 * 11 + 10
    assert table["id"][k] == FIRST and (table["speed_1"][k], table["speed_2"][k]) == (0.9, 1.0)


def test_other_threads_run_meanwhile(model):
    seen = []
    stop = threading.Event()
    thread = threading.Thread(target=lambda: [seen.append(1) for _ in iter(lambda: stop.wait(1e-4), True)])
    thread.start()
    model.blocking_map(FIRST, SECOND, n=40)
    stop.set()
    thread.join()
    assert len(seen) > 5


def test_pump_plot(model, plt):
    axes = model.plot_pump(FIRST)
    lines = {line.get_label().partition(",")[0]: line for line in axes.get_lines()}
    steady = model.solve()[FIRST]
    x, y = lines["operating point"].get_data()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("flow in l/min", "head in bar")
    assert x[0] == pytest.approx(60 * steady["m_flow_kg_s"], rel=1e-6)
    assert y[0] == pytest.approx(-steady["dp_pa"] / 1e5, rel=1e-6)
    # Both curves pass through the operating point; that of the threshold begins where the network's does.
    for name in ("pump at its speed", "what the network opposes"):
        flow, head = lines[name].get_data()
        assert np.interp(x[0], flow, head) == pytest.approx(y[0], rel=2e-3)
    opposing = lines["what the network opposes"].get_ydata()[0]
    assert lines["at the threshold"].get_ydata()[0] == pytest.approx(opposing, rel=1e-6)
    assert "held back by sf2.feed_in_pump" in axes.get_title()


def test_other_plots(model, hunting, plt):
    axes = hunting.stability().plot_modes()
    heights = sorted(bar.get_height() for bar in axes.patches)
    assert heights == pytest.approx([-50, 50], abs=0.1)
    axes = model.stability().plot_feeders()
    assert any("held back by sf2" in text.get_text() for text in axes.texts)
    grid = model.blocking_map(FIRST, SECOND, n=5)
    axes = plt.figure().add_subplot()
    assert grid.plot(ax=axes) is axes
    assert "nobody blocked" in [text.get_text() for text in axes.get_legend().get_texts()]


def test_flagged_spans(model, hunting, plt):
    result = hunting.simulate(until_s=900, record_s=1)
    spans = _export.flagged(result)
    swings = result["plant.feeder1.feed_in_pump.swings"]
    for kind, component, start_s, end_s in spans:
        inside = (result.time_s > start_s + 1) & (result.time_s < end_s - 1)
        value = {"oscillating": 1, "hunting": 2}[kind]
        assert (result[f"{component}.swings"][inside] == value).all()
    assert swings.max() == 2 and {"hunting"} <= {span[0] for span in spans}
    axes = result.plot("plant.feeder1.feed_in_pump.m_flow_kg_s")
    assert "hunting" in [text.get_text() for text in axes.get_legend().get_texts()]
    result = model.simulate(until_s=600, record_s=10)
    assert [span[:2] for span in _export.flagged(result)] == [("blocked", "sf1.station")]
    axes = result.plot("sf2.feed_in_pump.m_flow_kg_s")
    assert len(axes.get_legend().get_texts()) == 1, "only sf1 is blocked"


def test_plot_without_matplotlib(model, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match=r"anergy\[plot\]"):
        model.stability().plot_feeders()
    with pytest.raises(ImportError, match=r"anergy\[plot\]"):
        model.plot_pump(FIRST)
