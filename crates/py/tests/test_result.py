import gc
import json
import multiprocessing
import pickle
import re
import threading
from concurrent.futures import ProcessPoolExecutor
from operator import methodcaller

import anergy
import numpy as np
import pytest

FLOW = "sf1.feed_in_pump.m_flow_kg_s"


def test_columns(model, result):
    assert result.time_s.tolist() == list(range(0, 601, 10))
    assert result[FLOW].shape == result.time_s.shape and result[FLOW].dtype == np.float64
    assert 60 * result[FLOW][-1] == pytest.approx(0.781, abs=1e-3)
    assert len(result) == len(result.channels) == len(list(result))
    assert FLOW in result and "sf1" not in result and 1 not in result
    assert set(dict(result)) == set(result.channels)
    assert result.unit(FLOW) == "kg s-1" and result.unit("sf1.hot.t_k") == "K"
    assert result.damage is None
    assert result.model_name == model.name and result.model_toml == model.to_toml()


def test_columns_are_shared_not_copied(model):
    result = model.simulate(until_s=10, record_s=1)
    first, second = result[FLOW], result[FLOW]
    assert first.ctypes.data == second.ctypes.data
    assert first.base is result
    assert not first.flags.owndata
    assert result.time_s.ctypes.data == result.time_s.ctypes.data
    kept = first.tolist()
    del result, second
    gc.collect()
    # Memory that was given back would be used again by now.
    for _ in range(20):
        model.simulate(until_s=10, record_s=1)
    assert first.tolist() == kept


def test_columns_are_read_only(result):
    for array in (result[FLOW], result.time_s):
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True


def test_unknown_channel(result):
    with pytest.raises(KeyError) as raised:
        result["sf1.feed_in_pump.m_flow_kgs"]
    assert f"did you mean `{FLOW}`?" in str(raised.value)
    assert raised.value.name == "sf1.feed_in_pump.m_flow_kgs"
    with pytest.raises(KeyError, match="nothing like it"):
        result.unit("nothing like it")


def test_events_and_key_results(result):
    (event,) = result.events
    assert event["component"] == "sf1.station" and event["kind"] == "blocked"
    assert event["severity"] == "warning" and 0 < event["time_s"] <= 600
    assert "l/min" in event["message"]
    summary = result.summary
    assert summary["interrupted"] is False and summary["end_s"] == 600
    kpis = result.kpis()
    assert len(kpis) > len(summary["key_results"])
    taken = summary["kpis"]["stations"]["sf4.station"]["heat_taken_kwh"]
    assert kpis["sf4.station.heat_taken_kwh"] == taken > 0
    assert kpis["network.heat_taken_kwh"] == kpis["sf4.heat_taken_kwh"] == taken
    # What was asked of the feeder, 3.5 l/min for ten minutes.
    assert kpis["sf1.station.water_requested_m3"] == pytest.approx(0.035)
    assert kpis["sf1.station.flow_at_the_end_l_min"] == pytest.approx(0.781, abs=1e-3)
    assert all(isinstance(value, float) for value in kpis.values())
    assert kpis["network.heat_lost_kwh"] > 0


def test_same_run_same_bits(model, result):
    again = model.simulate(until_s=600, step_s=1, record_s=10)
    assert all(np.array_equal(again[name], result[name], equal_nan=True) for name in result)


def test_files(model, tmp_path):
    out = tmp_path / "new" / "run"
    result = model.simulate(until_s=60, out=out)
    assert json.loads((out / "summary.json").read_text()) == result.summary
    again = anergy.Result.from_file(out / "results.mcap")
    assert again.channels == result.channels and again.events == result.events
    assert all(np.array_equal(again[name], result[name], equal_nan=True) for name in result)
    assert again.summary == result.summary and again.damage is None


def test_a_cut_off_file_gives_its_rows(model, tmp_path):
    model.simulate(until_s=3600, record_s=1, out=tmp_path)
    content = (tmp_path / "results.mcap").read_bytes()
    (tmp_path / "cut.mcap").write_bytes(content[: len(content) // 2])
    cut = anergy.Result.from_file(tmp_path / "cut.mcap")
    assert 0 < len(cut.time_s) < 3601
    assert cut.damage and cut.summary == {} and cut.kpis() == {}
    cut._repr_html_()


def test_the_run_model_is_recorded(model):
    changed = model.set("sf1-sf2.hot.length_m", 300)
    recorded = changed.simulate(until_s=10).model_toml
    assert anergy.Model.from_toml(recorded).expand() == changed.expand()


def test_pickle(result):
    again = pickle.loads(pickle.dumps(result))
    assert all(np.array_equal(again[name], result[name], equal_nan=True) for name in result)
    assert again.summary == result.summary and again.events == result.events
    assert again.model_toml == result.model_toml and repr(again) == repr(result)


def test_report(result, tmp_path):
    path = tmp_path / "report.html"
    assert result.report(path) is None
    page = path.read_text(encoding="utf-8")
    assert "<html" in page and result.model_name in page
    # Nothing is loaded from a network: no address in anything that loads.
    loads = re.findall(r"""(?:src|href|srcset|data|action)\s*=\s*["']?\s*(?:https?:)?//[^"'\s>]+""", page)
    loads += re.findall(r"""(?:@import|url\()\s*["']?(?:https?:)?//[^"')]+""", page)
    assert loads == []


def test_looks(result):
    assert "three houses" in repr(result)
    assert "heat_fed_in_kwh" in result._repr_html_()


def test_to_pandas(result):
    pytest.importorskip("pandas", reason="pandas is not installed")
    frame = result.to_pandas()
    assert frame.shape == (61, len(result)) and frame.index.name == "time_s"
    assert np.array_equal(frame[FLOW].to_numpy(), result[FLOW])
    assert frame.attrs["units"][FLOW] == "kg s-1"
    assert list(result.to_pandas([FLOW]).columns) == [FLOW]
    with pytest.raises(anergy.UnknownNameError):
        result.to_pandas(["nothing"])


def test_to_xarray(result):
    pytest.importorskip("xarray", reason="xarray is not installed")
    data = result.to_xarray()
    assert data.sizes == {"time_s": 61} and data[FLOW].attrs["units"] == "kg s-1"
    assert np.array_equal(data[FLOW].sel(time_s=600), result[FLOW][-1])
    assert list(result.to_xarray([FLOW]).data_vars) == [FLOW]


def test_plot(result):
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("agg")
    axes = result.plot(FLOW, "sf2.feed_in_pump.m_flow_kg_s")
    assert len(axes.lines) == 2 and axes.get_ylabel() == "flow in l/min"
    assert result.plot(FLOW, ax=axes) is axes and len(axes.lines) == 3
    for channels in ([], [FLOW, "sf1.hot.t_k"]):
        with pytest.raises(ValueError, match="one unit"):
            result.plot(*channels)


@pytest.mark.parametrize("module", ["pandas", "xarray", "matplotlib"])
def test_what_is_not_installed_is_named(result, monkeypatch, module):
    monkeypatch.setitem(__import__("sys").modules, module, None)
    monkeypatch.setitem(__import__("sys").modules, f"{module}.pyplot", None)
    ask = {"pandas": result.to_pandas, "xarray": result.to_xarray, "matplotlib": lambda: result.plot(FLOW)}
    extra = {"matplotlib": "plot"}.get(module, module)
    with pytest.raises(ImportError, match=rf"pip install 'anergy\[{extra}\]'"):
        ask[module]()


def test_models_and_results_pass_through_processes(model):
    variations = [model.scale("sf1-sf2.hot.length_m", factor) for factor in (1.0, 2.0)]
    work = methodcaller("simulate", until_s=60)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        for result, variation in zip(executor.map(work, variations), variations, strict=True):
            assert np.array_equal(result[FLOW], variation.simulate(until_s=60)[FLOW])


def test_other_threads_run_meanwhile(model):
    """A thread that waits for the GIL gets it while a run is going on."""
    done = threading.Event()
    counts = []

    def count():
        n = 0
        while not done.wait(0.001):
            n += 1
        counts.append(n)

    thread = threading.Thread(target=count)
    thread.start()
    model.simulate(until_s=20_000, record_s=20_000)
    done.set()
    thread.join()
    assert counts[0] > 3


def test_arrow_streams(result):
    """polars, pyarrow and pandas read them, without a copy in between made here."""
    pl, pa = pytest.importorskip("polars"), pytest.importorskip("pyarrow")
    table = pa.table(result)
    assert table.column_names == ["time_s", *result.channels]
    assert table.num_rows == len(result.time_s)
    assert table.schema.metadata == {b"model": result.model_name.encode()}
    for name in result:
        assert table.schema.field(name).metadata == {b"unit": result.unit(name).encode()}
        assert np.array_equal(table[name].to_numpy(), result[name], equal_nan=True)
    frame = pl.DataFrame(result)
    assert frame.columns == table.column_names
    assert np.array_equal(frame["time_s"].to_numpy(), result.time_s)
    # What was read outlives the results, and a stream that nobody reads is freed.
    again = anergy.examples.load("three-houses").simulate(until_s=10, record_s=1)
    expected, read = again[FLOW].tolist(), pa.table(again)
    again.__arrow_c_stream__()
    del again
    gc.collect()
    assert read[FLOW].to_pylist() == expected


def test_csv(result, tmp_path):
    result.to_csv(tmp_path / "all.csv")
    head, *rows = (tmp_path / "all.csv").read_text().splitlines()
    names = head.split(",")
    assert names[0] == "time_s" and names[-len(result) :] == list(result)
    column = [row.split(",")[names.index(FLOW)] for row in rows]
    assert [float(value) for value in column] == result[FLOW].tolist()

    result.to_csv(tmp_path / "some.csv", ["*.t_k", FLOW], every_s=120, units=["degc", "l_min"])
    head, *rows = (tmp_path / "some.csv").read_text().splitlines()
    assert FLOW.replace("kg_s", "l_min") not in head and FLOW in head and ".t_degc" in head
    assert [float(row.split(",")[0]) % 120 for row in rows] == [0.0] * len(rows)

    result.to_csv(tmp_path / "one.csv", FLOW)
    assert (tmp_path / "one.csv").read_text().splitlines()[0] in (f"time_s,{FLOW}", f"time_s,time,{FLOW}")
    with pytest.raises(ValueError, match="no channel matches"):
        result.to_csv(tmp_path / "no.csv", ["sf1.station.nothing"])
    with pytest.raises(ValueError, match="is no unit"):
        result.to_csv(tmp_path / "no.csv", units=["degf"])
    with pytest.raises(ValueError, match="above 0"):
        result.to_csv(tmp_path / "no.csv", every_s=0.0)
    assert not (tmp_path / "no.csv").exists()
    with pytest.raises(FileNotFoundError):
        result.to_csv(tmp_path / "missing" / "no.csv")


def test_parquet(result, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    result.to_parquet(tmp_path / "all.parquet")
    table = parquet.read_table(tmp_path / "all.parquet")
    assert table.num_columns == len(result) + 1
    assert table.schema.field(FLOW).metadata[b"unit"] == b"kg s-1"
    result.to_parquet(tmp_path / "some.parquet", channels=[FLOW])
    assert parquet.read_table(tmp_path / "some.parquet").column_names == ["time_s", FLOW]
    with pytest.raises(anergy.UnknownNameError, match="did you mean"):
        result.to_parquet(tmp_path / "no.parquet", channels=["sf1.station.m_flow"])
