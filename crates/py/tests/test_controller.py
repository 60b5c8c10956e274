"""Controllers written in Python, called inside of a run."""

import gc
import pickle
import threading
import traceback
import weakref

import anergy
import numpy as np
import pytest

FLOW = "sf1.feed_in_pump.m_flow_kg_s"
SPEED = "sf1.feed_in_pump.speed"
OTHER = "sf2.feed_in_pump.speed"
COMMAND = f"{OTHER}_command"


class Pi(anergy.Controller):
    """The law of the controller `pi` of the model file."""

    interval_s = 0.7
    measures = [FLOW]
    acts_on = [SPEED]

    def start(self):
        self.integral, self.last_s, self.calls = 0.5, None, []

    def update(self, time_s, measured):
        self.calls.append(time_s)
        dt_s = 0.0 if self.last_s is None else round(time_s - self.last_s, 9)
        self.last_s = time_s
        push, share = 0.6 * (0.03 - measured[0]), dt_s / 8.0
        self.integral += push * share
        unlimited = self.integral + push
        low, high = self.limits[0]
        limited = min(max(unlimited, low), high)
        self.integral += (limited - unlimited) * min(share, 1.0)
        return limited


class Remembering(Pi):
    def get_state(self):
        return {"integral": self.integral, "last_s": self.last_s}

    def set_state(self, state):
        self.integral, self.last_s = state["integral"], state["last_s"]


class Fixed(anergy.Controller):
    """Returns what it is told."""

    interval_s = 10.0

    def __init__(self, value, acts_on=(OTHER,), **more):
        self.value, self.acts_on = value, acts_on
        for name, one in more.items():
            setattr(self, name, one)

    def update(self, time_s, measured):
        return self.value


@pytest.fixture(scope="module")
def controlled(model):
    data = model.to_dict()
    data["controller"] = [
        {
            "id": "flow",
            "kind": "pi",
            "measures": FLOW,
            "acts_on": SPEED,
            "set_point": 0.03,
            "gain": 0.6,
            "integral_time_s": 8,
            "interval_s": 0.7,
            "initial_output": 0.5,
        }
    ]
    return anergy.Model.from_dict(data)


def same(one, other):
    return all(np.array_equal(one[name], other[name], equal_nan=True) for name in other)


@pytest.mark.parametrize("step_s", [1, 0.35, "auto"])
def test_a_controller_in_python_is_one_of_the_model(model, controlled, step_s):
    """Bit for bit: same order, steps that end at its updates."""
    theirs = controlled.simulate(until_s=300, step_s=step_s, record_s=10)
    pi = Pi()
    mine = model.simulate(until_s=300, step_s=step_s, record_s=10, controllers=[pi])
    names = [name for name in mine if not name.startswith("flow.")]
    assert len(names) > 100
    for name in names:
        assert np.array_equal(mine[name], theirs[name], equal_nan=True), name
    assert np.allclose(pi.calls, 0.7 * np.arange(429), rtol=0, atol=1e-9) and len(pi.calls) == 429
    # Again with the same object: it starts anew.
    assert same(model.simulate(until_s=300, step_s=step_s, record_s=10, controllers=[pi]), mine)


def test_stepping_with_controllers(model):
    run = model.simulate(until_s=60, step_s=1, record_s=60, controllers=[Pi()])
    sim = model.simulation(step_s=1.0, controllers=[Pi()])
    for _ in range(60):
        sim.step()
    assert sim.get(FLOW) == run[FLOW][-1]
    sim.reset()
    sim.advance(60)
    assert sim.get(FLOW) == run[FLOW][-1]


def test_they_take_their_signals_over(model):
    """The schedule of the model drives this signal too."""
    sim = model.simulation(step_s=1.0, controllers=[Fixed(0.8, offset_s=5)])
    sim.advance(5)
    assert sim.get(COMMAND) == 1.0
    sim.step()
    assert sim.get(COMMAND) == 0.8
    sim.set(OTHER, 0.9)
    sim.step(30)
    assert sim.get(COMMAND) == 0.9
    sim.release(OTHER)
    sim.step(10)
    assert sim.get(COMMAND) == 0.8


@pytest.mark.parametrize(
    "value", [[0.8, 0.9], (0.8, 0.9), np.array([0.8, 0.9]), np.array([0.8, 5, 0.9])[::2], [np.float64(0.8), 0.9]]
)
def test_what_update_can_return(model, value):
    sim = model.simulation(controllers=[Fixed(value, acts_on=[SPEED, OTHER])])
    sim.step()
    assert [sim.get(f"{name}_command") for name in (SPEED, OTHER)] == [0.8, 0.9]


@pytest.mark.parametrize("value, expected", [(1, 1.0), (np.float32(0.5), 0.5), (np.array([0.5]), 0.5), (None, 1.0)])
def test_one_value(model, value, expected):
    sim = model.simulation(controllers=[Fixed(value)])
    sim.step()
    assert sim.get(COMMAND) == expected


def test_set_points_and_boundaries_are_signals_too(controlled):
    """A supervisory layer: it moves the set point of a controller of the model, and the ground."""
    above = Fixed([0.02, 278.15], acts_on=["flow.set_point", "ground.temperature_k"], interval_s=60.0)
    sim = controlled.simulation(step_s=1.0, controllers=[above])
    sim.advance(600)
    assert sim.get(FLOW) == pytest.approx(0.02, rel=1e-3)
    assert sim.get("ground.temperature_k") == 278.15


def test_limits_and_the_array_of_measured_values(model):
    seen = []

    class Look(Fixed):
        measures = [FLOW, "sf1.station.t_a_k", SPEED]

        def update(self, time_s, measured):
            seen.append((measured, measured.tolist()))
            measured[:] = 0.0  # Its own, and filled again.
            return 0.9

    look = Look(0.9)
    look.measures = [FLOW, "sf1.hot.t_k", SPEED]
    sim = model.simulation(step_s=10, controllers=[look])
    assert look.limits.tolist() == [list(sim.limits(OTHER))]
    expected = [sim.get(name) for name in look.measures]
    sim.step()
    assert seen[0][1] == expected and seen[0][0].dtype == float
    expected = [sim.get(name) for name in look.measures]
    sim.step()
    assert seen[1][1] == expected and seen[1][0] is seen[0][0]


def test_wrong_names(model):
    with pytest.raises(anergy.UnknownNameError, match=r'controller "Fixed\(.*\)": there is no signal .* did you mean `sf2.feed_in_pump.speed`'):
        model.simulate(controllers=[Fixed(1, acts_on=["sf2.feed_in_pump.sped"])])
    with pytest.raises(anergy.UnknownNameError, match=f'"mine": there is no channel or signal .* did you mean `{FLOW}`'):
        model.simulation(controllers=[Fixed(1, measures=["sf1.feed_in_pump.m_flow"], name="mine")])
    with pytest.raises(ValueError, match=r'"two": acts_on|"sf2.feed_in_pump.speed" is driven by controller "one" already'):
        model.simulation(controllers=[Fixed(1, name="one"), Fixed(1, name="two")])


def test_wrong_controllers(model):
    with pytest.raises(TypeError, match="must be an anergy.Controller, not"):
        model.simulate(controllers=[object()])
    with pytest.raises(AttributeError, match="interval_s"):
        model.simulate(controllers=[type("No", (Pi,), {"interval_s": property()})()])
    for interval_s in (0, -1, float("nan")):
        with pytest.raises(ValueError, match=f'controller "c": interval_s = {interval_s} must be positive'.replace("nan", "NaN")):
            model.simulate(controllers=[Fixed(1, interval_s=interval_s, name="c")])
    with pytest.raises(ValueError, match="acts on no signal"):
        model.simulate(controllers=[Fixed(1, acts_on=[])])
    with pytest.raises(TypeError, match="measures of .*Fixed.* must be a sequence of names"):
        model.simulate(controllers=[Fixed(1, measures=[1])])
    # Said where it is made, not in the middle of a run.
    with pytest.raises(TypeError, match="class No .*abstract method '?update"):
        type("No", (anergy.Controller,), {"interval_s": 1, "acts_on": SPEED})()


@pytest.mark.parametrize("value", [1.5, -0.5, float("nan"), float("inf")])
def test_wrong_values(model, value):
    controller = Fixed([0.9, value], acts_on=[SPEED, OTHER], offset_s=30, name="bad")
    with pytest.raises(anergy.OutOfRangeError, match=f'controller "bad" gives {OTHER} = ') as raised:
        model.simulate(until_s=100, record_s=10, controllers=[controller])
    error = raised.value
    assert (error.signal, error.min, error.max, error.time, error.component) == (OTHER, 0, 1, "30s", "bad")
    assert error.result.time_s.tolist() == [0, 10, 20, 30]


@pytest.mark.parametrize("value", ["fast", [1.0, 1.0], {}, [None]])
def test_values_of_a_wrong_kind(model, value):
    with pytest.raises((TypeError, ValueError), match='controller "bad": update returned'):
        model.simulate(until_s=1, controllers=[Fixed(value, name="bad")])


def test_exceptions_keep_their_traceback_and_the_rows(model):
    class Fails(Fixed):
        def update(self, time_s, measured):
            if time_s >= 40:
                return self.look(time_s)
            return 0.9

        def look(self, time_s):
            return {}["missing"]

    with pytest.raises(KeyError, match="missing") as raised:
        model.simulate(until_s=100, record_s=20, controllers=[Fails(1, name="faulty")])
    functions = [frame.name for frame in traceback.extract_tb(raised.value.__traceback__)]
    assert functions[-2:] == ["update", "look"]
    assert raised.value.result.time_s.tolist() == [0, 20, 40]
    if hasattr(raised.value, "add_note"):
        assert raised.value.__notes__ == ['raised by the controller "faulty" at 40s']
    # A step that failed is done again, and the controller is asked again.
    fails = Fails(1)
    sim = model.simulation(step_s=10, controllers=[fails])
    with pytest.raises(KeyError):
        sim.step(10)
    assert sim.time_s == 40
    fails.look = lambda time_s: 0.8
    sim.step()
    assert sim.time_s == 50 and sim.get(COMMAND) == 0.8


def test_the_simulation_cannot_be_asked_within_a_step(model):
    class Asks(Fixed):
        def update(self, time_s, measured):
            return self.sim.get(FLOW)

    asks = Asks(1)
    asks.sim = model.simulation(controllers=[asks])
    with pytest.raises(RuntimeError) as raised:
        asks.sim.step()
    if hasattr(raised.value, "add_note"):
        assert "what it needs belongs into `measures`" in raised.value.__notes__[0]
    del asks.sim


def test_ctrl_c_in_update(model):
    class Interrupts(Fixed):
        def update(self, time_s, measured):
            if time_s == 20:
                raise KeyboardInterrupt
            return 0.9

    with pytest.raises(anergy.Interrupted) as raised:
        model.simulate(until_s=100, record_s=10, controllers=[Interrupts(1)])
    assert raised.value.result.time_s.tolist() == [0, 10, 20]


def test_snapshots_with_controllers(model):
    sim = model.simulation(step_s=1.0, controllers=[Remembering()])
    sim.advance(100)
    snapshot = sim.snapshot()
    sim.advance(200)
    expected = [sim.get(name) for name in sim.channels]
    sim.restore(snapshot)
    assert sim.snapshot() == snapshot
    sim.advance(200)
    assert repr([sim.get(name) for name in sim.channels]) == repr(expected)
    other = model.simulation(step_s=1.0, controllers=[Remembering()])
    other.restore(pickle.loads(pickle.dumps(snapshot)))
    other.advance(200)
    assert repr([other.get(name) for name in other.channels]) == repr(expected)
    with pytest.raises(anergy.SnapshotError, match="1 controllers of the user, the simulation 0"):
        model.simulation().restore(snapshot)


def test_snapshots_need_the_state_of_controllers(model):
    sim = model.simulation(controllers=[Pi()])
    with pytest.raises(anergy.SnapshotError, match=r'controller "Pi\(sf1.feed_in_pump.speed\)" has no get_state'):
        sim.snapshot()


def test_other_threads_run_between_updates(model):
    """With the lock held during the run, the other thread would have to wait for its end."""
    done, counts = threading.Event(), []

    def count():
        n = 0
        while not done.wait(0.001):
            n += 1
        counts.append(n)

    thread = threading.Thread(target=count)
    thread.start()
    model.simulate(until_s=20_000, record_s=20_000, controllers=[Fixed(0.9, interval_s=15_000)])
    done.set()
    thread.join()
    assert counts[0] > 3


def test_nothing_is_kept_alive(model):
    pi = Pi()
    there = weakref.ref(pi)
    sim = model.simulation(controllers=[pi])
    del pi
    gc.collect()
    sim.step()
    assert there() is not None
    del sim
    gc.collect()
    assert there() is None


def test_cycles_are_collected(model):
    """A controller that holds its simulation, which holds the controller."""
    pi = Pi()
    pi.sim = model.simulation(controllers=[pi])
    pi.sim.step()
    there = weakref.ref(pi)
    del pi
    gc.collect()
    assert there() is None


def test_many_names_at_once(model):
    sim = model.simulation(step_s=1.0)
    speeds, flows = sim.handles([SPEED, OTHER]), sim.handles([FLOW, OTHER, "sf1.hot.t_k"])
    assert speeds.names == [SPEED, OTHER] and len(flows) == 3 and "3" in repr(flows)
    sim.set(speeds, np.array([0.7, 0.8]))
    sim.step(60)
    assert sim.get(speeds).tolist() == [0.7, 0.8]
    out = np.empty(3)
    assert sim.get(flows, out) is out
    assert out.tolist() == [sim.get(name) for name in flows.names]
    sim.set(speeds, [0.6, 1])
    sim.set(speeds, np.array([0.6, 9, 1])[::2])
    # All or none.
    with pytest.raises(anergy.OutOfRangeError, match=OTHER):
        sim.set(speeds, [0.1, 3.0])
    sim.step(60)
    assert sim.get(speeds).tolist() == [0.6, 1.0]
    with pytest.raises(ValueError, match="3 values for 2 names"):
        sim.set(speeds, [0.1, 0.2, 0.3])
    with pytest.raises(ValueError, match="out: 2 places for 3 names"):
        sim.get(flows, out=np.empty(2))
    with pytest.raises(ValueError, match="out: the array must be contiguous"):
        sim.get(flows, out=np.empty(6)[::2])
    fixed = np.empty(3)
    fixed.flags.writeable = False
    with pytest.raises(ValueError, match="out: the array cannot be written"):
        sim.get(flows, out=fixed)
    with pytest.raises(TypeError, match="out is for Handles"):
        sim.get(FLOW, out=out)
    with pytest.raises(anergy.UnknownNameError, match="there is no signal"):
        sim.set(flows, [0, 0, 0])
    with pytest.raises(anergy.UnknownNameError, match="did you mean"):
        sim.handles([SPEED, "sf1.feed_in_pump.m_flow"])
    # Of another simulation they are names.
    other = model.set("sf1-sf2.hot.length_m", 100).simulation()
    assert other.get(flows).tolist() == [other.get(name) for name in flows.names]
    other.set(speeds, [0.5, 0.5])
    other.step(60)
    assert other.get(SPEED) == 0.5
