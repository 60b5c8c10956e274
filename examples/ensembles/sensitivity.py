"""What the heat of the far feeder depends on: Sobol indices and Morris screening of the three houses, by SALib.

python examples/ensembles/sensitivity.py [N]        needs pip install anergy[sensitivity]
"""

import sys
from pathlib import Path

import anergy
import numpy as np
from SALib.analyze import morris as morris_analysis
from SALib.analyze import sobol as sobol_analysis
from SALib.sample import morris as morris_sample
from SALib.sample import sobol as sobol_sample

n = int(sys.argv[1]) if len(sys.argv) > 1 else 64
kpi = "sf1.station.heat_given_kwh"
model = anergy.examples.load("three-houses")
definition = anergy.Variations.from_file(Path(__file__).with_name("three-houses-day.toml")).to_dict()
definition["run"] = {"until": "30min", "step": "10s"}
variations = anergy.Variations.from_dict(definition)

# SALib works in the unit cube; the distributions of the file turn its points into values.
names = variations.names
cube = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}

found = anergy.ensemble(model, variations.at(sobol_sample.sample(cube, n, calc_second_order=False, seed=1)))
sobol = sobol_analysis.analyze(cube, found[kpi], calc_second_order=False, seed=1)
print(f"Sobol indices of {kpi}, {len(found)} runs")
print(f"{'':28} {'first':>7} {'total':>7} {'+-':>6}")
for name, first, total, around in zip(names, sobol["S1"], sobol["ST"], sobol["ST_conf"]):
    print(f"{name:28} {first:7.3f} {total:7.3f} {around:6.3f}")

# Normal distributions end nowhere: the ends of the cube are cut off.
points = 0.005 + 0.99 * morris_sample.sample(cube, n // 4, seed=1)
found = anergy.ensemble(model, variations.at(points))
morris = morris_analysis.analyze(cube, points, found[kpi], seed=1)
print(f"\nMorris screening, {len(found)} runs")
print(f"{'':28} {'mean':>7} {'spread':>7}  kWh over the whole range")
for name, effect, spread in zip(names, morris["mu_star"], morris["sigma"]):
    print(f"{name:28} {effect:7.3f} {spread:7.3f}")

assert np.argmax(sobol["ST"]) == np.argmax(morris["mu_star"])
