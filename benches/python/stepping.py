"""What stepping and controllers in Python cost, on the three houses.

Build the package with optimisation first: maturin develop --release -m crates/py/Cargo.toml
Then: python benches/python/stepping.py
"""

import subprocess
import sys
import time

import anergy
import numpy as np

FEEDERS = ("sf1", "sf2")
FLOWS = [f"{site}.feed_in_pump.m_flow_kg_s" for site in FEEDERS]
SPEEDS = [f"{site}.feed_in_pump.speed" for site in FEEDERS]
REPEATS = 7


class PumpPi(anergy.Controller):
    """Holds the flow of a feeder, every second."""

    interval_s = 1.0

    def __init__(self, site):
        self.measures = [f"{site}.feed_in_pump.m_flow_kg_s"]
        self.acts_on = [f"{site}.feed_in_pump.speed"]

    def start(self):
        self.low, self.high = self.limits[0].tolist()
        self.integral = 0.5

    def update(self, time_s, measured):
        error = 0.03 - measured.item(0)
        self.integral = min(max(self.integral + 0.05 * error, self.low), self.high)
        return min(max(self.integral + 0.6 * error, self.low), self.high)


class Nothing(anergy.Controller):
    """Leaves everything as it is: the cost of the call."""

    interval_s = 1.0
    measures = FLOWS
    acts_on = SPEEDS

    def update(self, time_s, measured):
        return None


def least_us(work, count):
    """Microseconds per repetition: the least of several times."""
    best = float("inf")
    for _ in range(REPEATS):
        before = time.perf_counter()
        work(count)
        best = min(best, time.perf_counter() - before)
    return 1e6 * best / count


def row(what, us, more=""):
    print(f"| {what} | {us:.2f} | {more} |")


def stepping(**arguments):
    """One call of step() for each step of 1 s."""
    sim = anergy.examples.load("three-houses").simulation(step_s=1.0, **arguments)

    def work(count):
        for _ in range(count):
            sim.step()

    work(300)
    return least_us(work, 3000)


def advancing(**arguments):
    """Steps of 1 s within one call."""
    sim = anergy.examples.load("three-houses").simulation(step_s=1.0, **arguments)
    sim.step(300)
    return least_us(sim.step, 5000)


def outside():
    """The same PI on each pump outside of the run: get, compute, set, step."""
    sim = anergy.examples.load("three-houses").simulation(step_s=1.0)
    flows, speeds = sim.handles(FLOWS), sim.handles(SPEEDS)
    measured, values = np.empty(2), np.empty(2)
    integral = [0.5, 0.5]

    def work(count):
        for _ in range(count):
            sim.get(flows, measured)
            for i in range(2):
                error = 0.03 - measured.item(i)
                integral[i] = min(max(integral[i] + 0.05 * error, 0.0), 1.0)
                values[i] = min(max(integral[i] + 0.6 * error, 0.0), 1.0)
            sim.set(speeds, values)
            sim.step()

    work(300)
    return least_us(work, 3000)


def access():
    """Reading and writing by handle."""
    sim = anergy.examples.load("three-houses").simulation(step_s=1.0)
    sim.step()
    flow, speed = sim.handle(FLOWS[0]), sim.handle(SPEEDS[0])
    flows, speeds = sim.handles(FLOWS), sim.handles(SPEEDS)
    out, values = np.empty(2), np.array([0.9, 0.9])
    calls = {
        "get of a handle": lambda: sim.get(flow),
        "set of a handle": lambda: sim.set(speed, 0.9),
        "get of 2 handles into an array": lambda: sim.get(flows, out),
        "get of 2 handles, new array": lambda: sim.get(flows),
        "set of 2 handles from an array": lambda: sim.set(speeds, values),
    }
    for what, call in calls.items():

        def work(count, call=call):
            for _ in range(count):
                call()

        row(what, least_us(work, 20_000))


def first_result():
    """A new process: import and a run of the three houses."""
    code = (
        "import time; a = time.perf_counter(); import anergy; b = time.perf_counter();"
        "anergy.examples.load('three-houses').simulate(); print(b - a, time.perf_counter() - b)"
    )
    runs = [
        [float(word) for word in subprocess.check_output([sys.executable, "-c", code]).split()]
        for _ in range(5)
    ]
    imported, ran = min(runs, key=sum)
    row("import anergy (with numpy)", 1e6 * imported)
    row("run of 1 h in 3600 steps, 361 rows", 1e6 * ran)


print("| What | us | |\n|---|---|---|")
access()
alone, called = advancing(), stepping()
row("step of 1 s, many in one call", alone)
row("step of 1 s, one call each", called, f"{called - alone:.2f} per call of step()")
idle = advancing(controllers=[Nothing()])
row("the same with an idle controller", idle, f"{idle - alone:.2f} per update")
inside = advancing(controllers=[PumpPi(site) for site in FEEDERS])
row("PI in Python on both pumps, in the run", inside, f"{1e6 / inside:.0f} steps per second")
handled = outside()
row("PI in Python on both pumps, around step()", handled, f"{1e6 / handled:.0f} steps per second")
first_result()
