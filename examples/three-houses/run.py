"""Pump blocking in three houses: run the model beside this file and print the flows of the feeders."""

from pathlib import Path

import anergy

model = anergy.Model.from_file(Path(__file__).with_name("model.toml"))
result = model.simulate()
for name in ("sf1.station", "sf2.station"):
    flow_l_min = result[f"{name}.m_flow_kg_s"] * 60.0
    before = flow_l_min[result.time_s <= 2230][-1]
    print(f"{name}: {before:.2f} l/min before the relief, {flow_l_min[-1]:.2f} l/min after it")
for event in result.events:
    print(event["message"])
