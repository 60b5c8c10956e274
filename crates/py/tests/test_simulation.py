import pickle
from pathlib import Path

import anergy
import pytest

SPEED = "sf2.feed_in_pump.speed"
FLOW = "sf1.station.m_flow_kg_s"


@pytest.fixture
def sim(model):
    return model.simulation(step_s=1.0)


def test_a_step_that_control_does_not_follow_warns_once():
    house = {"kind": "heat_load", "load_kw": 5, "return_degc": 40}
    station = {"directions": "extraction", "extraction": "valve", "flow_control": "pi"}
    model = anergy.Model.from_dict({
        "format": 1,
        "run": {"until": "1h", "step": "1s"},
        "site": [{"id": "plant"}, {"id": "house"}],
        "trench": [{"from": "plant", "to": "house", "length_m": 50, "inner_diameter_mm": 40}],
        "station": [
            {
                "site": "plant", "kind": "plant", "supply_degc": 70, "dp_bar": 0.5, "return_pressure_bar": 2,
                "circulation_pump": {"head_max_bar": 2, "free_flow_m3_h": 5},
            },
            {"site": "house", "kind": "prosumer", "unit": house, **station},
        ],
    })
    assert model.simulation().step_s == 1
    with pytest.warns(UserWarning, match="house.station: the control of its flow follows steps up to") as warned:
        coarse = model.simulation(step_s=60)
        coarse.step(3)
    assert len(warned) == 1


def row(sim):
    return [sim.get(name) for name in sim.channels]


def test_a_slower_near_pump_lets_the_far_one_deliver(sim):
    sim.step()
    blocked = sim.get(FLOW)
    sim.set(SPEED, 0.85)
    sim.step(60)
    assert sim.get(SPEED) == pytest.approx(0.85)
    assert sim.get(FLOW) > 2 * blocked > 0
    assert sim.get("sf2.station.m_flow_kg_s") > 0


def test_stepping_is_the_run(model, sim, result):
    sim.advance(600)
    assert sim.time_s == 600 and sim.step_s == 1
    for name in result.channels:
        value, last = sim.get(name), result[name][-1]
        assert value == last or (value != value and last != last)
    (event,) = sim.take_events()
    assert event == result.events[0] and sim.take_events() == []


def test_release_gives_the_signal_back(sim):
    sim.set(SPEED, 0.5)
    sim.step()
    assert sim.get("sf2.feed_in_pump.speed_command") == 0.5
    sim.release(SPEED)
    sim.step()
    assert sim.get("sf2.feed_in_pump.speed_command") == 1.0


def test_names_and_handles(model, sim):
    assert FLOW in sim.channels and SPEED in sim.signals
    flow, speed = sim.handle(FLOW), sim.handle(SPEED)
    assert flow.name == FLOW and FLOW in repr(flow)
    assert sim.get(flow) == sim.get(FLOW)
    sim.set(speed, 0.9)
    sim.step()
    assert sim.get(speed) == sim.get(SPEED)
    # A signal that is no channel gives its command.
    assert sim.get("ground.temperature_k") == pytest.approx(285.15)
    assert sim.get(sim.handle("ground.temperature_k")) == pytest.approx(285.15)
    assert sim.limits(SPEED)[0] <= 0.9 <= sim.limits(SPEED)[1]
    # A handle of another simulation is only a name.
    other = anergy.Model.from_toml(
        """
        format = 1
        [[site]]
        id = "sf1"
        [[edge]]
        id = "p"
        kind = "pump"
        from = "sf1.cold"
        to = "sf1.hot"
        head_max_hpa = 402.21
        free_flow_l_min = 55.33
        speed = 1.0
        [[edge]]
        id = "r"
        kind = "resistance"
        from = "sf1.hot"
        to = "sf1.cold"
        dp_nominal_hpa = 100.0
        m_flow_nominal_kg_min = 10.0
        [pressure_reference]
        node = "sf1.cold"
        """
    ).simulation()
    hot = sim.handle("sf1.hot.t_k")
    assert other.get(hot) == other.get("sf1.hot.t_k")
    with pytest.raises(anergy.UnknownNameError):
        other.get(flow)
    with pytest.raises(anergy.UnknownNameError):
        other.set(speed, 1)


def test_unknown_names(sim):
    with pytest.raises(KeyError, match=f"did you mean `{FLOW}`"):
        sim.get("sf1.station.m_flow")
    for ask in (sim.handle, sim.release, sim.limits, lambda name: sim.set(name, 1.0)):
        with pytest.raises(anergy.UnknownNameError, match=f"did you mean `{SPEED}`"):
            ask("sf2.feedin_pump.speed")
    with pytest.raises(anergy.UnknownNameError, match="signal"):
        sim.set(FLOW, 1.0)
    with pytest.raises(TypeError):
        sim.get(1)


def test_values_out_of_range(sim):
    before = sim.get("sf2.feed_in_pump.speed_command")
    for value in (-0.1, 7, float("nan")):
        with pytest.raises(anergy.OutOfRangeError, match=SPEED) as raised:
            sim.set(SPEED, value)
        assert raised.value.signal == SPEED and raised.value.min == 0
    assert sim.get("sf2.feed_in_pump.speed_command") == before
    sim.advance(10)
    with pytest.raises(ValueError, match="in the past"):
        sim.advance(5)
    with pytest.raises(OverflowError):
        sim.step(-1)
    sim.step(0)
    assert sim.time_s == 10


def test_snapshot_continues_bit_for_bit(model, sim):
    sim.advance(100)
    snapshot = sim.snapshot()
    assert snapshot.time_s == 100
    sim.set(SPEED, 0.85)
    sim.step(200)
    expected = row(sim)
    sim.restore(snapshot)
    assert sim.time_s == 100 and sim.snapshot() == snapshot
    sim.set(SPEED, 0.85)
    sim.step(200)
    assert repr(row(sim)) == repr(expected)
    # In another simulation, through bytes.
    for copy in (pickle.loads(pickle.dumps(snapshot)), anergy.Snapshot.from_bytes(snapshot.to_bytes())):
        assert copy == snapshot and copy.time_s == 100
        other = model.simulation(step_s=1.0)
        other.restore(copy)
        other.set(SPEED, 0.85)
        other.step(200)
        assert repr(row(other)) == repr(expected)


def test_a_snapshot_of_a_house_is_small():
    folder = Path(__file__).parents[3] / "examples/laboratory-sf1"
    sim = anergy.Model.from_file(folder / "model.toml").simulation(step_s=60.0)
    sim.advance(86400)
    assert len(sim.snapshot().to_bytes()) < 2000


def test_snapshots_that_do_not_fit(model, sim):
    content = sim.snapshot().to_bytes()
    changed = bytearray(content)
    changed[len(content) // 2] ^= 1
    for wrong in (content[:-9], content[:25], content[1:], changed, b"", b"anergy"):
        with pytest.raises(anergy.SnapshotError, match="this is no snapshot"):
            anergy.Snapshot.from_bytes(bytes(wrong))
    data = model.to_dict()
    data["site"].append({"id": "sf5"})
    data["trench"].append({"from": "sf4", "to": "sf5", "length_m": 10, "pipe": "dn20"})
    with pytest.raises(anergy.SnapshotError, match="another model"):
        anergy.Model.from_dict(data).simulation().restore(sim.snapshot())


def test_reset(model, sim):
    start = row(sim)
    sim.set(SPEED, 0.85)
    sim.step(50)
    sim.reset()
    assert sim.time_s == 0 and repr(row(sim)) == repr(start)


def test_step_of_the_model(model):
    assert model.simulation().step_s == 1
    sim = model.simulation(step_s=2.5)
    sim.advance(4)
    sim.step()
    assert sim.time_s == 6.5


def test_automatic_step(model):
    sim = model.simulation(step_s="auto")
    assert sim.step_s is None
    sim.step(3)
    assert 0 < sim.time_s < 10
    sim.advance(600)
    assert sim.time_s == 600
    fixed = model.simulate(until_s=600, step_s=1, record_s=600)
    name = "sf1.station.m_flow_kg_s"
    assert abs(sim.get(name) - fixed[name][-1]) < 1e-3
    with pytest.raises(ValueError, match="auto"):
        model.simulation(step_s="soon")
