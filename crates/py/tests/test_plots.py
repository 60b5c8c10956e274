"""Pictures of results: what is drawn, with the units of the field."""

import re
from pathlib import Path

import anergy
import numpy as np
import pytest

matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
matplotlib.use("agg")
pyplot = pytest.importorskip("matplotlib.pyplot")

EXAMPLES = Path(__file__).parents[3] / "examples"
FLOW = "sf1.feed_in_pump.m_flow_kg_s"


@pytest.fixture(autouse=True)
def close():
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def day():
    """An ambient grid with storages for a bit more than a day."""
    model = anergy.Model.from_file(EXAMPLES / "5gdhc-day/model.toml")
    return model.simulate(until_s=30 * 3600, step_s=60, record_s=900)


def labels(axes):
    """Labels of the axes and of the colour bars beside them."""
    return {text for one in axes.figure.axes for text in (one.get_xlabel(), one.get_ylabel()) if text}


def legend(axes):
    return [text.get_text() for text in axes.get_legend().get_texts()]


def texts_overlap(axes):
    """Pairs of texts whose boxes overlap."""
    axes.figure.canvas.draw()
    boxes = [(text.get_text(), text.get_window_extent()) for text in axes.texts if text.get_text()]
    return [
        (one, other)
        for i, (one, box) in enumerate(boxes)
        for other, its in boxes[i + 1 :]
        if box.overlaps(its)
    ]


def test_lines_over_time(result):
    axes = result.plot(FLOW, "sf2.feed_in_pump.m_flow_kg_s")
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time in min", "flow in l/min")
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(0.781, abs=1e-3)
    assert axes.lines[0].get_xdata()[-1] == 10
    axes = result.plot("sf1.hot.t_k")
    assert axes.get_ylabel() == "temperature in °C" and 12 < axes.lines[0].get_ydata()[-1] < 66
    assert result.plot("sf1.hot.p_pa").get_ylabel() == "pressure in bar"
    assert result.plot("sf1.station.q_flow_w").get_ylabel() == "heat flow in kW"


def test_map(result):
    axes = result.plot_map("t_k", time_s=600)
    assert labels(axes) == {"temperature in °C"} and legend(axes) == ["hot line", "cold line"]
    assert axes.get_title() == "three houses: pump blocking, at 10 min"
    (lines,) = axes.collections[:1]
    # Four pipes in 24 pieces; the first one from the temperature of its water at port a to that at port b.
    values = lines.get_array()
    assert len(values) == 4 * 24
    ends = [result[f"sf1-sf2.hot.t_{port}_k"][-1] - 273.15 for port in "ab"]
    assert values[[0, 23]].tolist() == pytest.approx(ends)
    names = {text.get_text() for text in axes.texts} - {""}
    assert names == {"sf1", "sf2", "sf4"} and texts_overlap(axes) == []
    # Places are where the model says.
    assert axes.collections[-1].get_offsets().tolist() == [[0, 0], [200, 0], [250, 0]]


def test_arrows_follow_the_flow(result):
    def directions(axes):
        arrows = [text for text in axes.texts if text.get_text() == ""]
        return [np.sign(arrow.xy[0] - arrow.xyann[0]) for arrow in arrows]

    # Hot water goes from the feeders to sf4, cold water comes back.
    row = result["sf1-sf2.hot.m_flow_kg_s"][-1], result["sf1-sf2.cold.m_flow_kg_s"][-1]
    assert row[0] > 0 > row[1]
    assert directions(result.plot_map("p_pa")) == [1, -1, 1, -1]
    # At the start nothing flows yet.
    assert directions(result.plot_map("p_pa", time_s=0.0)) == []


@pytest.mark.parametrize(
    "quantity, label",
    [("p_pa", "pressure in bar"), ("m_flow_kg_s", "flow in l/min"), ("dp_pa", "pressure difference in bar"),
     ("q_loss_w", "heat loss in kW")],
)
def test_quantities_of_the_map(result, quantity, label):
    assert labels(result.plot_map(quantity)) == {label}


def test_wrong_maps(result):
    with pytest.raises(anergy.UnknownNameError, match="did you mean `q_loss_w`"):
        result.plot_map("q_los_w")
    with pytest.raises(ValueError, match="time_s = 601 is outside of the results: 0 to 600 s"):
        result.plot_map(time_s=601)


def test_steady_map(model):
    steady = model.solve()
    axes = steady.plot_map("p_pa")
    assert labels(axes) == {"pressure in bar"} and axes.get_title().endswith("steady")
    ends = [steady[f"{node}.hot"]["p_pa"] / 1e5 for node in ("sf1", "sf2")]
    assert axes.collections[0].get_array()[[0, 23]].tolist() == pytest.approx(ends)
    assert labels(steady.plot_map("m_flow_kg_s")) == {"flow in l/min"}
    with pytest.raises(anergy.UnknownNameError, match="`t_k`"):
        steady.plot_map("t_kk")


def test_duration(result):
    axes = result.plot_duration(FLOW, "sf2.feed_in_pump.m_flow_kg_s")
    assert labels(axes) == {"time with at least this value in min", "flow in l/min"}
    assert legend(axes) == [FLOW, "sf2.feed_in_pump.m_flow_kg_s"]
    values, edges, _ = axes.patches[0].get_data()
    expected = np.sort(60 * result[FLOW][:-1])[::-1]
    assert values == pytest.approx(expected) and edges == pytest.approx(np.arange(61) / 6)
    with pytest.raises(ValueError, match="plot_duration needs one or more channels of one unit, not: K, kg s-1"):
        result.plot_duration(FLOW, "sf1.hot.t_k")
    with pytest.raises(ValueError, match="no channel"):
        result.plot_duration()


def test_carpet(day, result):
    name = next(name for name in day if re.fullmatch(r".*\.heat_pump\.electric_w", name))
    axes = day.plot_carpet(name)
    assert labels(axes) >= {"power in kW", "hour of the day"} or labels(axes) >= {"power in kW", "hour of the day (UTC)"}
    grid = axes.collections[0].get_array()
    assert grid.shape[0] == 96 and grid.shape[1] in (2, 3)
    start = int(day._map()["start_s"] % 86_400 / 900)
    flat = grid.T.ravel()[start : start + 120]
    assert np.asarray(flat) == pytest.approx(day[name][:-1] / 1000)
    with pytest.raises(ValueError, match="a day or more"):
        result.plot_carpet(FLOW)


def test_storage(day):
    unit = next(name.removesuffix(".t_1_k") for name in day if name.endswith(".t_1_k"))
    axes = day.plot_storage(unit)
    assert labels(axes) == {"time in h", "layer (1 is the bottom)", "temperature in °C"}
    layers = sum(bool(re.fullmatch(rf"{re.escape(unit)}\.t_\d+_k", name)) for name in day)
    grid = axes.collections[0].get_array()
    assert grid.shape == (layers, len(day.time_s))
    assert np.asarray(grid)[0] == pytest.approx(day[f"{unit}.t_1_k"] - 273.15)
    with pytest.raises(anergy.UnknownNameError, match=f"did you mean `{unit}`"):
        day.plot_storage(f"{unit}x")


def test_sankey(result, day):
    from anergy import _plots

    for one in (result, day):
        sources, sinks = _plots.flows(one)
        # What came is what went.
        assert sum(sources.values()) == pytest.approx(sum(sinks.values()), rel=2e-3)
        axes = one.plot_sankey()
        words = " ".join(text.get_text() for text in axes.texts)
        for name in (*sources, *sinks):
            assert name in words
        assert "kWh" in words and texts_overlap(axes) == []
    kpis = result.kpis()
    sources, sinks = _plots.flows(result)
    assert sources["sf2.station"] == kpis["sf2.station.heat_given_kwh"]
    assert sinks["sf4.station"] == kpis["sf4.station.heat_taken_kwh"]
    assert sinks["losses"] == pytest.approx(kpis["network.heat_lost_kwh"])


def test_sankey_of_many():
    from anergy import _plots

    town = anergy.Model.from_file(EXAMPLES / "town/model.toml").simulate(until_s=600, step_s=60, record_s=600)
    sources, sinks = _plots.flows(town)
    assert len(sinks) == 11 and "others" in list(sinks)[-1]
    assert sum(sources.values()) == pytest.approx(sum(sinks.values()), rel=2e-2)
    assert texts_overlap(town.plot_sankey()) == []


def test_without_matplotlib(result, monkeypatch):
    import sys

    for module in ("matplotlib", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, module, None)
    for draw in (result.plot_map, lambda: result.plot_duration(FLOW), result.plot_sankey):
        with pytest.raises(ImportError, match=r"pip install 'anergy\[plot\]'"):
            draw()


def test_own_axes(result):
    axes = pyplot.figure().add_subplot()
    assert result.plot_map(ax=axes) is axes
    assert result.plot_duration(FLOW, ax=axes) is axes
