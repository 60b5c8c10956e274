"""Does the truth without any effect, tolerance or error of a sensor agree with anergy? Prints the differences, sensor by sensor;
fails where the median is above what the rig says (0.05 K; in the house 0.25 K), or 1 % of the range of a flow or pressure loss.

    python twin.py OUT --rig R1 --seed 7 --anergy target/release/anergy
    python twin.py OUT --rig R2 --seed 7 --effect H1 small_branch 0.35     # the same effect in both
"""

import argparse
import csv
import importlib
import json
import subprocess
from pathlib import Path

import numpy as np

from cases import RIGS, still

parser = argparse.ArgumentParser()
parser.add_argument("out", type=Path)
parser.add_argument("--rig", choices=RIGS, default="R1")
parser.add_argument("--seed", type=int, default=7)
parser.add_argument("--poor", action="store_true")
parser.add_argument("--every-s", type=float, default=2.0)
parser.add_argument("--effect", nargs=3, metavar=("ID", "COMPONENT", "VALUE"), help="put it into the truth and into the model")
parser.add_argument("--kind", type=json.loads, default={}, help="what the rig is beside what is drawn, as JSON")
parser.add_argument("--anergy", type=Path, default=Path("target/release/anergy"))
wanted = parser.parse_args()
module = importlib.import_module(RIGS[wanted.rig])
rig = module.draw(np.random.default_rng(wanted.seed), not wanted.poor) | wanted.kind
base = module.neutral(rig) | {"drift_k": 0.0}
entry = ""
if wanted.effect:
    id_, component, value = wanted.effect[0], wanted.effect[1], float(wanted.effect[2])
    _, _, parameter, variant, *_ = next(e for e in module.effects(rig) if e[:2] == (id_, component))
    base |= variant(value)
    entry = f'[[effect]]\nid = "{id_}"\ncomponent = "{component}"\n{parameter} = {value}\n'
channels = module.simulate(rig, [base])
sensors = module.sensors(rig)
for s in sensors:
    s.lag_s, s.quantisation = 0.0, 0.0
at_s = np.arange(0, module.duration_s(rig), wanted.every_s)
folder = wanted.out / f"twin-{wanted.rig}-{wanted.seed}"
folder.mkdir(parents=True, exist_ok=True)
readings = {s.column: s.perfect(channels[s.truth][0], at_s) for s in sensors}
with (folder / "data.csv").open("w") as file:
    print("time_s", *readings, sep=",", file=file)
    for k, t in enumerate(at_s):
        print(f"{t:.0f}", *(f"{x[k]:.6f}" for x in readings.values()), sep=",", file=file)
series = [f'[[series]]\nfile = "data.csv"\ncolumn = "{s.column}"\nsignal = "{s.signal}"\nunit = "{s.unit.lower()}"\ntime_column = "time_s"\n'
          'interpolation = "linear"\n' for s in sensors if s.role == "input"]
(folder / "model.toml").write_text(module.model(rig) + "".join(series) + entry)
anergy = str(wanted.anergy.resolve())
subprocess.run([anergy, "run", "model.toml", "--out", "out"], cwd=folder, check=True, capture_output=True)
subprocess.run([anergy, "export", "out/results.mcap", "--out", "rows.csv"], cwd=folder, check=True, capture_output=True)
with (folder / "rows.csv").open() as file:
    rows = list(csv.DictReader(file))
time = np.array([float(next(iter(row.values()))) for row in rows])
agree = True
for s in sensors:
    if s.role != "compare":
        continue
    name = next(n for n in rows[0] if n == s.signal)
    there = np.array([float(row[name]) for row in rows])
    step = float(module.model(rig).split('step = "')[1].split("s")[0]) if s.kind == "k" else 0.0
    here = np.interp(time - step / 2, np.arange(channels[s.truth].shape[1]), channels[s.truth][0])
    difference = there - here
    if s.blank:
        difference = difference[~still(channels[s.blank][0], time)]
    middle = np.median(np.abs(difference))
    agree &= bool(middle < (module.AGREES_K if s.kind == "k" else 0.01 * np.ptp(here)))
    print(f"{s.column:10} range {np.ptp(here):9.3f}  rms {np.sqrt(np.mean(difference**2)):.4f}  median |.| {middle:.4f}"
          f"  mean {difference.mean():+.4f} SI")
if not agree:
    raise SystemExit("truth and anergy differ where nothing is hidden")
