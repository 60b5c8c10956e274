"""Hydraulic solve of anergy beside EPANET and pandapipes, on one core in one run.

    make bench-peers

EPANET (owa-epanet, ACCURACY 1e-8): *cold* is openH (ordering, storage), initH and runH; *warm* is runH
after a 5 % change of the demands, flows kept. pandapipes: pipeflow of a heat grid, numba, hydraulics
alone, warm start from the last result. anergy: `solve_timing` (see there). Times are the minimum of the
repeats; ratios are EPANET's or pandapipes' time over anergy's.
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import math
import platform
import random
import subprocess
import sysconfig
import tempfile
import time
import warnings
from pathlib import Path

from epanet import toolkit as en

NETWORKS = ["wntr/library/networks/Net3.inp", "wntr/library/networks/ky4.inp",
            "wntr/library/networks/ky10.inp", "epyt/networks/L-TOWN.inp",
            "wntr/library/networks/Net6.inp"]

# The first words of what the tables are followed by.
BY_HAND = "Against the aims:"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--anergy", default="target/release/anergy")
    parser.add_argument("--timing", default="target/release/solve_timing")
    parser.add_argument("--out", default="benches/peers/README.md")
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--largest", type=int, default=100_000, help="pipes of the largest grid")
    arguments = parser.parse_args()
    packages = Path(sysconfig.get_paths()["purelib"])
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        files = [(Path(name).stem, packages / name) for name in NETWORKS]
        for pipes in (10_000, 100_000):
            if pipes <= arguments.largest:
                files.append((f"grid of {pipes} pipes", grid(pipes, Path(folder))))
        for name, file in files:
            model = Path(folder) / "model.toml"
            run([arguments.anergy, "import", "epanet", str(file), "--out", str(model)])
            ours = json.loads(run([arguments.timing, str(model), str(arguments.seconds)]))
            peer = epanet(file, folder, arguments.seconds)
            print(name, ours, peer, flush=True)
            rows.append((name, ours, peer))
        heat = [heat_grid(consumers, folder, arguments) for consumers in (50, 500)]
    out = Path(arguments.out)
    written = out.read_text() if out.exists() else ""
    out.write_text(report(rows, heat) + by_hand(written))


def run(command: list[str]) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def grid(pipes: int, folder: Path) -> Path:
    """A square grid with one reservoir, random lengths, diameters and demands; Darcy-Weisbach."""
    chance = random.Random(1)
    side = round(math.sqrt(pipes / 2))
    lines = ["[JUNCTIONS]"]
    lines += [f"J{i}_{j} 0 {chance.uniform(0, 0.05):.4f}" for i in range(side) for j in range(side)]
    lines += ["[RESERVOIRS]", "R 100", "[PIPES]", "P0 R J0_0 10 2000 0.1 0 Open"]
    for i in range(side):
        for j in range(side):
            for k, (a, b) in enumerate(((i + 1, j), (i, j + 1))):
                if a < side and b < side:
                    lines.append(f"P{i}_{j}_{k} J{i}_{j} J{a}_{b} {chance.uniform(20, 200):.1f} "
                                 f"{chance.choice([200, 300, 400, 600])} 0.1 0 Open")
    lines += ["[OPTIONS]", "UNITS LPS", "HEADLOSS D-W", "ACCURACY 1e-8", "TRIALS 1000", "[END]"]
    file = folder / f"grid{pipes}.inp"
    file.write_text("\n".join(lines))
    return file


def epanet(file: Path, folder: str, seconds: float) -> dict[str, float]:
    """Times of EPANET, us of CPU."""
    project = en.createproject()
    en.open(project, str(file), f"{folder}/x.rpt", f"{folder}/x.out")
    for option, value in ((en.ACCURACY, 1e-8), (en.TRIALS, 1000)):
        en.setoption(project, option, value)
    cold, warm = [], []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = time.process_time()
        while not cold or time.process_time() - begin < seconds:
            start = time.process_time()
            en.openH(project)
            en.initH(project, en.INITFLOW)
            en.runH(project)
            cold.append(time.process_time() - start)
            en.closeH(project)
        en.openH(project)
        en.initH(project, en.INITFLOW)
        en.runH(project)
        multiplier = en.getoption(project, en.DEMANDMULT)
        begin = time.process_time()
        low = False
        while not warm or (time.process_time() - begin < seconds and len(warm) < 10_000):
            low = not low
            en.setoption(project, en.DEMANDMULT, multiplier * (0.95 if low else 1.0))
            start = time.process_time()
            en.initH(project, en.NOSAVE)
            en.runH(project)
            warm.append(time.process_time() - start)
    iterations = en.getstatistic(project, en.ITERATIONS)
    en.closeH(project)
    en.close(project)
    en.deleteproject(project)
    return {"cold_us": min(cold) * 1e6, "warm_us": min(warm) * 1e6, "iterations": iterations}


def heat_grid(consumers: int, folder: str, arguments: argparse.Namespace) -> dict:
    """A two-pipe heat grid in pandapipes, and the same imported into anergy."""
    import pandapipes as pp

    chance = random.Random(2)
    net = pp.create_empty_network(fluid="water")
    plant = [pp.create_junction(net, pn_bar=5, tfluid_k=353.15, name=f"plant {s}") for s in "sr"]
    pp.create_circ_pump_const_pressure(net, plant[1], plant[0], p_flow_bar=8, plift_bar=4, t_flow_k=353.15)
    ends = [plant]
    for i in range(consumers):
        parent = ends[max(0, len(ends) - 1 - chance.randrange(min(len(ends), 6)))]
        here = [pp.create_junction(net, pn_bar=5, tfluid_k=353.15, name=f"{i} {s}") for s in "sr"]
        length = chance.uniform(0.02, 0.08)
        for a, b in ((parent[0], here[0]), (here[1], parent[1])):
            pp.create_pipe_from_parameters(net, a, b, length_km=length, inner_diameter_mm=250, k_mm=0.05)
        # One flow-controlled consumer.
        middle = pp.create_junction(net, pn_bar=5, tfluid_k=353.15, name=f"{i} m")
        pp.create_flow_control(net, here[0], middle, controlled_mdot_kg_per_s=chance.uniform(0.05, 0.2))
        pp.create_heat_exchanger(net, middle, here[1], qext_w=5000.0, inner_diameter_mm=50)
        ends.append(here)
    pp.pipeflow(net, mode="hydraulics", friction_model="swamee-jain", use_numba=True)
    times = []
    begin = time.process_time()
    low = False
    while len(times) < 3 or time.process_time() - begin < 3 * arguments.seconds:
        low = not low
        net.flow_control["controlled_mdot_kg_per_s"] *= 0.95 if low else 1 / 0.95
        start = time.process_time()
        pp.pipeflow(net, mode="hydraulics", friction_model="swamee-jain", use_numba=True)
        times.append(time.process_time() - start)
    file, model = Path(folder) / "heat.json", Path(folder) / "heat.toml"
    pp.to_json(net, str(file))
    run([arguments.anergy, "import", "pandapipes", str(file), "--out", str(model)])
    ours = json.loads(run([arguments.timing, str(model), str(arguments.seconds)]))
    result = {"consumers": consumers, "pandapipes_us": min(times) * 1e6, "ours": ours}
    print(result, flush=True)
    return result


def by_hand(written: str) -> str:
    """What is written below the tables: all from the line that begins with BY_HAND on."""
    lines = written.splitlines(keepends=True)
    first = next((i for i, line in enumerate(lines) if line.startswith(BY_HAND)), len(lines))
    return "\n" + "".join(lines[first:]) if lines[first:] else ""


def report(rows: list, heat: list) -> str:
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}"
                         for name in ("owa-epanet", "wntr", "epyt", "pandapipes", "numba"))
    lines = [
        "# Beside EPANET and pandapipes",
        "",
        f"`make bench-peers`, {datetime.date.today()}, {platform.machine()}, {versions}. Both with relative",
        "accuracy 1e-8; minimum of the repeats. *Iteration* is one evaluation, factorisation and solution.",
        "",
        "| Network | Edges | EPANET cold, µs | anergy cold, µs | ratio | EPANET warm, µs | anergy warm, µs"
        " | ratio | warm / iteration | peak memory, MB |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for name, ours, peer in rows:
        cold, warm = ours["cold_us"]["min"], ours["warm_us"]["min"]
        lines.append(
            f"| {name} | {ours['edges']} | {peer['cold_us']:.0f} | {cold:.0f} | {peer['cold_us'] / cold:.1f} "
            f"| {peer['warm_us']:.0f} | {warm:.0f} | {peer['warm_us'] / warm:.1f} "
            f"| {ours['warm_over_iteration']:.1f} | {ours['peak_memory_mb']:.0f} |"
        )
    lines += ["", "Heat grids of two pipes, warm, hydraulics alone:", "",
              "| Consumers | Edges | pandapipes, µs | anergy, µs | ratio |", "|---|---|---|---|---|"]
    for case in heat:
        ours, peer = case["ours"], case["pandapipes_us"]
        warm = ours["warm_us"]["min"]
        lines.append(f"| {case['consumers']} | {ours['edges']} | {peer:.0f} | {warm:.0f} | {peer / warm:.0f} |")
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
