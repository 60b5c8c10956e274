"""The RSE test facility, driven by the commands of one measured test: flows and temperatures beside the meters.

    python run.py                    # the test of 30 January 2024
    python run.py rse_2601_test1     # another one
"""

import os
import sys
from pathlib import Path

import numpy as np

import anergy

HERE = Path(__file__).parent
IN_THE_FILE = "rse_3001_test1"
DENSITY = 980.0
LOADS = ("701", "711", "721", "731")

data = Path(os.environ.get("ANERGY_REFERENCE_DATA", HERE / "../../../shared/data")) / "rse_dhtf"
if not data.is_dir():
    print(f"The measured series are not part of the repository, and there is no folder {data}.")
    print("Set ANERGY_REFERENCE_DATA to the folder that holds rse_dhtf; README.md says where they come from.")
    sys.exit()

test = sys.argv[1] if len(sys.argv) > 1 else IN_THE_FILE
with open(data / f"{test}.csv", encoding="utf-8") as file:
    names = file.readline().strip().split(",")
    measured = dict(zip(names, np.loadtxt(file, delimiter=",", unpack=True)))
until_s = measured["time_s"][-1]

model = anergy.Model.from_toml((HERE / "model.toml").read_text().replace(IN_THE_FILE, test), data)
for parameter in model.parameters():
    pipe, _, field = parameter.rpartition(".")
    if field == "inner_diameter_m":  # all pipes start as warm as the supply or the return was
        warm = pipe.endswith((".hot", ".feed"))
        first_degc = measured["TT902_degC" if warm else "TT901_degC"][0]
        model = model.set(f"{pipe}.initial_k", first_degc + 273.15)

result = model.simulate(until_s=until_s, step_s=2.0, record_s=2.0)
print(f"{test}, {until_s:.0f} s; means from 300 s on")
late = measured["time_s"] >= 300.0


def show(tag: str, found: np.ndarray, unit: str) -> None:
    real = measured[f"{tag}_{unit}"][late]
    error = found[: len(late)][late] - real
    rmse = np.sqrt(np.mean(error**2))
    print(f"{tag:6} measured {real.mean():7.2f}  model {real.mean() + error.mean():7.2f}  RMSE {rmse:6.3f} {unit}")


show("FT901", result["p901.m_flow_kg_s"] / DENSITY * 3600, "m3_h")
for load in LOADS:
    show(f"FT{load}", result[f"ft{load}.m_flow_kg_s"] / DENSITY * 3600, "m3_h")
show("FTA12", result["fta12.m_flow_kg_s"] / DENSITY * 3600, "m3_h")
for load in LOADS:
    show(f"TT{load[:2]}2", result[f"e{load}.hot.t_k"] - 273.15, "degC")
for load in LOADS:
    show(f"TT{load[:2]}1", result[f"e{load}.cold.t_k"] - 273.15, "degC")
show("TT901", result["s900.cold.t_k"] - 273.15, "degC")
