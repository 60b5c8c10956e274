"""Ctrl-C in a process of its own."""

import json
import signal
import subprocess
import sys

import pytest

SIMULATE = """
import anergy, json, sys
model = anergy.examples.load("three-houses")
print("started", flush=True)
try:
    model.simulate(until_s=1e9, record_s=1000, out=sys.argv[1])
except KeyboardInterrupt as interrupt:
    result = interrupt.result
    rows = len(result.time_s)
    print(json.dumps([type(interrupt).__name__, rows, result.summary["interrupted"]]))
"""

STEP = """
import anergy, json
sim = anergy.examples.load("three-houses").simulation(step_s=1)
print("started", flush=True)
try:
    sim.step(1_000_000_000)
except KeyboardInterrupt as interrupt:
    reached = sim.time_s
    sim.step()
    print(json.dumps([type(interrupt).__name__, reached, sim.time_s - reached]))
"""


def interrupt(script: str, *arguments: str) -> list:
    process = subprocess.Popen(
        [sys.executable, "-c", script, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout.readline() == "started\n"
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(0.7)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=30)
    assert err == "" and process.returncode == 0
    return json.loads(out)


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_simulate_keeps_what_it_has(tmp_path):
    import anergy

    name, rows, interrupted = interrupt(SIMULATE, str(tmp_path))
    assert name == "Interrupted" and rows > 1 and interrupted is True
    recorded = anergy.Result.from_file(tmp_path / "results.mcap")
    assert len(recorded.time_s) == rows and recorded.damage is None
    assert json.loads((tmp_path / "summary.json").read_text())["interrupted"] is True


@pytest.mark.skipif(sys.platform == "win32", reason="sends SIGINT")
def test_step_stops_between_steps():
    name, reached_s, stepped_s = interrupt(STEP)
    assert name == "KeyboardInterrupt" and reached_s > 0 and stepped_s == 1
