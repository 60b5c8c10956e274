"""Ensembles: the same numbers whatever runs them, nothing lost, and on from where they were stopped."""

import json
import os
import pickle
import signal
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import anergy
import numpy as np
import pytest

VARIATIONS = {
    "ensemble": {"design": "latin_hypercube", "members": 24, "seed": 3},
    "run": {"until": "5min", "step": "5s", "record": "1min"},
    "keep": {"kpis": ["network.*", "sf1.station.*"], "channels": ["sf1.station.m_flow_kg_s", "sf4.hot.t_k"]},
    "variation": [
        {"parameter": "sf1.feed_in_pump.speed", "low": 0.9, "high": 1.0},
        {"name": "street", "parameter": "sf1-sf2.*.length_m", "mean": 200, "standard_deviation": 20},
    ],
}


class Slow(anergy.Controller):
    """Turns the far pump down, and refuses to when it is told."""

    interval_s = 60.0
    acts_on = ("sf1.feed_in_pump.speed",)
    measures = ("sf1.station.m_flow_kg_s",)

    def start(self):
        self.speed = 0.8

    def update(self, time_s, measured):
        self.speed -= 0.05
        if measured[0] > 1:
            raise RuntimeError("never")
        return self.speed


def make_slow():
    return [Slow()]


class Refuses(Slow):
    def update(self, time_s, measured):
        raise RuntimeError("no water today")


class Stateful(anergy.Controller):
    """Remembers how often it was asked since it was made: in a new one, never."""

    interval_s = 60.0
    acts_on = ("sf1.feed_in_pump.speed",)

    def __init__(self):
        self.asked = 0

    def update(self, time_s, measured):
        self.asked += 1
        return 0.9 - 0.05 * min(self.asked, 8)


def make_nothing():
    raise RuntimeError("no controllers today")


class Kills(Slow):
    """Ends its process, as the system does when memory is short."""

    def update(self, time_s, measured):
        os._exit(3)


def same(one: anergy.Ensemble, other: anergy.Ensemble) -> None:
    assert list(one.table) == list(other.table)
    for name in one.table:
        np.testing.assert_array_equal(one[name], other[name], err_msg=name)
    for name in one.channels:
        for a, b in zip(one.channel(name), other.channel(name)):
            np.testing.assert_array_equal(a, b, err_msg=name)


@pytest.fixture(scope="module")
def threads() -> anergy.Ensemble:
    return anergy.ensemble(anergy.examples.load("three-houses"), VARIATIONS)


def test_members_are_runs_of_changed_models(model, threads):
    assert len(threads) == threads.size == 24 and threads.complete and not threads.failed
    variations = anergy.Variations.from_dict(VARIATIONS)
    values = variations.values(17)
    assert [threads[name][17] for name in variations.names] == values
    by_hand = model.set("sf1.feed_in_pump.speed", values[0])
    for side in ("hot", "cold"):
        by_hand = by_hand.set(f"sf1-sf2.{side}.length_m", values[1])
    result = by_hand.simulate(until_s=300, step_s=5, record_s=60)
    again = threads.model(17).simulate(until_s=300, step_s=5, record_s=60)
    for run in (result, again):
        assert threads["network.heat_lost_kwh"][17] == run.summary["kpis"]["network"]["heat_lost_kwh"]
        time_s, flows = threads.channel("sf1.station.m_flow_kg_s")
        np.testing.assert_array_equal(time_s, run.time_s)
        np.testing.assert_array_equal(flows[17], run["sf1.station.m_flow_kg_s"])
    assert set(threads.kpis) == {k for k in threads.kpis if k.startswith(("network.", "sf1.station."))}


def test_executors_do_not_change_a_bit(model, threads):
    same(threads, anergy.ensemble(model, VARIATIONS, threads=1))
    with ThreadPoolExecutor(2) as pool:
        same(threads, anergy.ensemble(model, VARIATIONS, pool))
    with ProcessPoolExecutor(2) as pool:
        same(threads, anergy.ensemble(model, VARIATIONS, pool))


@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_does_not_change_a_bit(model, threads, tmp_path):
    distributed = pytest.importorskip("dask.distributed")
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=str(tmp_path)
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        same(threads, anergy.ensemble(model, VARIATIONS, client))
        same(threads, anergy.ensemble(model, VARIATIONS, client, out=tmp_path / "kept"))
    assert client.status == "closed"


def test_python_controllers_run_in_processes(model, threads):
    found = anergy.ensemble(model, VARIATIONS, controllers=[Slow()], threads=2)
    assert not found.failed and len(found) == 24
    result = found.model(5).simulate(until_s=300, step_s=5, record_s=60, controllers=[Slow()])
    np.testing.assert_array_equal(found.channel("sf1.station.m_flow_kg_s")[1][5], result["sf1.station.m_flow_kg_s"])
    assert (found["sf1.station.heat_given_kwh"] != threads["sf1.station.heat_given_kwh"]).all()
    with ThreadPoolExecutor(1) as pool:
        same(found, anergy.ensemble(model, VARIATIONS, pool, controllers=make_slow))
        refused = anergy.ensemble(model, VARIATIONS, pool, controllers=[Refuses()])
    assert len(refused.failed) == 24 and refused.failed[0] == "RuntimeError: no water today"


def test_members_do_not_share_controllers(model):
    """What a controller remembers since it was made is of its member alone, in threads as in a run."""
    with ThreadPoolExecutor(4) as pool:
        found = anergy.ensemble(model, VARIATIONS, pool, controllers=[Stateful()])
    for member in (0, 11, 23):
        result = found.model(member).simulate(until_s=300, step_s=5, record_s=60, controllers=[Stateful()])
        flows = found.channel("sf1.station.m_flow_kg_s")[1][member]
        np.testing.assert_array_equal(flows, result["sf1.station.m_flow_kg_s"])
    with ThreadPoolExecutor(1) as pool:
        same(found, anergy.ensemble(model, VARIATIONS, pool, controllers=[Stateful()]))


def test_controllers_that_cannot_be_made_fail_their_members(model):
    with ThreadPoolExecutor(2) as pool:
        found = anergy.ensemble(model, VARIATIONS, pool, controllers=make_nothing)
    assert len(found.failed) == 24 and found.failed[7] == "RuntimeError: no controllers today"


def test_a_folder_knows_its_controllers(model, tmp_path):
    few = VARIATIONS | {"ensemble": VARIATIONS["ensemble"] | {"members": 2}}
    with ThreadPoolExecutor(1) as pool:
        for _ in range(2):
            anergy.ensemble(model, few, pool, out=tmp_path / "kept", controllers=[Slow()])
        other = Slow()
        other.gain = 2
        for controllers in ([Stateful()], None, make_slow, [other]):
            with pytest.raises(ValueError, match="other controllers"):
                anergy.ensemble(model, few, pool, out=tmp_path / "kept", controllers=controllers)


def test_a_folder_has_one_writer(model, tmp_path):
    from anergy._core import _FolderLock

    few = VARIATIONS | {"ensemble": VARIATIONS["ensemble"] | {"members": 2}}
    lock = _FolderLock(tmp_path / "kept")
    with pytest.raises(ValueError, match="is written by another run"):
        anergy.ensemble(model, few, out=tmp_path / "kept")
    lock.release()
    anergy.ensemble(model, few, out=tmp_path / "kept")
    # It is free again, also after a refusal.
    with pytest.raises(ValueError, match="other variations"):
        anergy.ensemble(model, VARIATIONS, out=tmp_path / "kept")
    _FolderLock(tmp_path / "kept").release()


def test_lost_workers_leave_what_has_finished(model, tmp_path):
    with pytest.raises(anergy.WorkersLost, match="the workers were lost after 0 of 24 members") as lost:
        anergy.ensemble(model, VARIATIONS, controllers=[Kills()], threads=1)
    assert lost.value.result.size == 24 and not lost.value.result.complete


def swept(folder, lines):
    """The folder of an `anergy sweep` that was killed: no members.csv, a torn line."""
    (folder / "channels").mkdir(parents=True)
    about = {"writer": "anergy sweep", "members": 4, "variations": {"variation": [{"parameter": "a.x"}, {"name": "word"}]}}
    (folder / "ensemble.json").write_text(json.dumps(about))
    (folder / "journal.jsonl").write_text("".join(lines))
    (folder / "channels/member-000002.csv").write_text("time_s,flow\n0,1.5\n60,2.5\n")
    return folder


def test_a_killed_sweep_is_read_from_its_journal(tmp_path):
    lines = [
        '{"member": 2, "values": [0.1, "b"], "kpis": {"network.heat_kwh": 0.30000000000000004}}\n',
        '{"member": 0, "values": [3, "a"], "error": "length_m = -1"}\n',
    ]
    found = anergy.Ensemble.from_folder(swept(tmp_path / "one", [*lines, '{"member": 1, "val']))
    assert len(found) == 2 and found.size == 4 and not found.complete
    assert found["member"].tolist() == [0, 2] and found.failed == {0: "length_m = -1"}
    assert found["a.x"].tolist() == [3.0, 0.1] and found["word"].tolist() == ["a", "b"]
    assert found["network.heat_kwh"][1] == 0.30000000000000004 and found.kpis == ["network.heat_kwh"]
    time_s, flows = found.channel("flow")
    assert time_s.tolist() == [0.0, 60.0] and flows.tolist() == [[1.5, 2.5]]
    with pytest.raises(ValueError, match=r"journal.jsonl:1: is no line"):
        anergy.Ensemble.from_folder(swept(tmp_path / "two", ["{\n", *lines]))


def test_failed_members_are_told(model, tmp_path):
    variations = {
        "run": {"until": "1min"},
        "variation": [{"parameter": "sf1-sf2.hot.length_m", "values": [100, -1, 200]}],
    }
    for out in (None, tmp_path / "kept"):
        found = anergy.ensemble(model, variations, out=out)
        assert list(found.failed) == [1] and "length_m = -1" in found.failed[1]
        lost = found["network.heat_lost_kwh"]
        assert np.isnan(lost[1]) and np.isfinite(lost[[0, 2]]).all()
        assert "1 failed" in repr(found)


def test_a_folder_goes_on_and_equals_memory(model, threads, tmp_path):
    out = tmp_path / "kept"
    found = anergy.ensemble(model, VARIATIONS, out=out)
    assert sorted(found.kpis) == sorted(threads.kpis)
    for name in threads.table:
        np.testing.assert_array_equal(found[name], threads[name], err_msg=name)
    # As if it had been killed after a part: the others run again.
    import pyarrow.parquet as parquet

    table = parquet.read_table(out / "members.parquet")
    parquet.write_table(table.slice(0, 9), out / "parts" / "members-000007.parquet")
    (out / "members.parquet").unlink()
    again = anergy.ensemble(model, VARIATIONS, out=out)
    same(found, again)
    assert parquet.read_table(out / "members.parquet").schema == table.schema
    same(found, anergy.Ensemble.from_folder(out))
    with pytest.raises(ValueError, match="other model"):
        anergy.ensemble(model.set("ground.temperature_k", 280), VARIATIONS, out=out)
    with pytest.raises(ValueError, match="other variations"):
        anergy.ensemble(model, VARIATIONS | {"run": {"until": "4min"}}, out=out)


KILLED = """
import anergy, anergy._ensemble_store, json, sys
anergy._ensemble_store.LARGEST_PART = 4  # a part is there soon, on a fast machine too
print("started", flush=True)
variations = json.loads(sys.argv[1])
try:
    anergy.ensemble(anergy.examples.load("three-houses"), variations, out=sys.argv[2])
except KeyboardInterrupt as interrupt:
    print(type(interrupt).__name__, len(interrupt.result))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="sends signals")
@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGKILL])
def test_stopped_and_killed_ensembles_go_on(model, tmp_path, sent):
    many = VARIATIONS | {"ensemble": VARIATIONS["ensemble"] | {"members": 150}, "run": {"until": "1h", "step": "2s"}}
    out = tmp_path / "kept"
    script = [sys.executable, "-c", KILLED, json.dumps(many), str(out)]
    process = subprocess.Popen(script, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "started\n"
    # Until the first part is there.
    for _ in range(150):
        if list((out / "parts").glob("members-*.parquet")):
            break
        with pytest.raises(subprocess.TimeoutExpired):
            process.wait(0.1)
    os.kill(process.pid, sent)
    told, errors = process.communicate(timeout=60)
    if sent == signal.SIGINT:
        assert errors == "" and told.startswith("Interrupted "), (told, errors)
        assert 0 < int(told.split()[1]) < 150
    before = anergy.Ensemble.from_folder(out)
    assert 0 < len(before) < 150 and not before.complete
    found = anergy.ensemble(model, many, out=out)
    whole = anergy.ensemble(model, many)
    assert found.complete
    for name in whole.table:
        np.testing.assert_array_equal(found[name], whole[name], err_msg=name)
    for name in whole.channels:
        np.testing.assert_array_equal(found.channel(name)[1], whole.channel(name)[1])


def test_the_program_gives_the_same_members(model, threads, tmp_path):
    program = os.environ.get("ANERGY_PROGRAM")
    if not program:
        pytest.skip("ANERGY_PROGRAM does not name the program")
    model.to_file(tmp_path / "model.toml")
    (tmp_path / "variations.toml").write_text(anergy.Variations.from_dict(VARIATIONS).to_toml())
    arguments = [program, "sweep", "model.toml", "variations.toml", "--out", "swept"]
    subprocess.run(arguments, cwd=tmp_path, check=True, capture_output=True)
    found = anergy.Ensemble.from_folder(tmp_path / "swept")
    assert sorted(found.table) == sorted(threads.table)
    for name in threads.table:
        np.testing.assert_array_equal(found[name], threads[name], err_msg=name)
    for name in threads.channels:
        np.testing.assert_array_equal(found.channel(name)[1], threads.channel(name)[1])


def test_variations_are_read_shown_and_refused(model, tmp_path):
    variations = anergy.Variations.from_dict(VARIATIONS)
    assert variations.names == ["sf1.feed_in_pump.speed", "street"] and len(variations) == 24
    again = pickle.loads(pickle.dumps(variations))
    assert [again.values(i) for i in range(24)] == [variations.values(i) for i in range(24)]
    (tmp_path / "v.toml").write_text(variations.to_toml())
    assert anergy.Variations.from_file(tmp_path / "v.toml").values(3) == variations.values(3)
    assert anergy.Variations.from_dict(variations.to_dict()).values(3) == variations.values(3)
    assert "standard_deviation" in str(anergy.Variations.schema())
    with pytest.raises(IndexError, match="no member 24"):
        variations.values(24)
    with pytest.raises(anergy.ModelError, match="did you mean `members`"):
        anergy.Variations.from_dict({"ensemble": {"member": 3}, "variation": []})
    (tmp_path / "v.toml").write_text("format = 1\n[[variation]]\nparameter = 'sf1.feed_in_pump.sped'\nvalues = [1]\n")
    with pytest.raises(anergy.ModelError, match=r"(?s)v.toml:3:13: .*did you mean"):
        anergy.ensemble(model, tmp_path / "v.toml")
    points = variations.at(np.array([[0.0, 0.5], [1.0, 0.5]]))
    assert len(points) == 2 and points.values(0) == [0.9, 200.0] and points.values(1)[0] == 1.0
    with pytest.warns(UserWarning, match=r"no indicator matches 'sf9\.\*'"):
        anergy.ensemble(model, VARIATIONS | {"keep": {"kpis": ["sf9.*", "network.*"]}})
    with pytest.raises(anergy.ModelError, match="which is not between 0 and 1"):
        variations.at([[2.0, 0.5]])


def test_quantiles_and_plots(threads, tmp_path):
    table = threads.quantiles([0.0, 0.5, 1.0], ["network.heat_lost_kwh"])
    lost = threads["network.heat_lost_kwh"]
    row = table.row("network.heat_lost_kwh")
    assert row["0"] == lost.min() and row["1"] == lost.max()
    assert row["0.5"] == pytest.approx(np.median(lost))
    axes = threads.plot_quantiles("sf1.station.m_flow_kg_s")
    (median,) = axes.get_lines()
    np.testing.assert_array_equal(median.get_ydata(), np.median(threads.channel("sf1.station.m_flow_kg_s")[1], axis=0))
    axes = threads.plot_distribution("network.heat_lost_kwh")
    assert axes.get_lines()[0].get_xdata()[-1] == lost.max()
    with pytest.raises(KeyError, match="did you mean"):
        threads.plot_quantiles("sf1.station.m_flow_kg")
    import pandas

    assert isinstance(threads.to_pandas(), pandas.DataFrame)
