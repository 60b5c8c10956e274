"""A town of 500 houses: solve the model beside this file, then run a cold hour."""

from pathlib import Path

import anergy

model = anergy.Model.from_file(Path(__file__).with_name("model.toml"))
houses = [name for name in model.stations if name != "plant.station"]

steady = model.solve()
p_pa = dict(zip(steady.nodes.ids, steady.nodes["p_pa"]))
dp_pa = {h: p_pa[h.replace("station", "hot")] - p_pa[h.replace("station", "cold")] for h in houses}
worst = min(dp_pa, key=dp_pa.__getitem__)
plant = steady.edges.row("plant.generator")
print(f"{len(houses)} houses, {len(model.edges)} edges, {plant['m_flow_kg_s']:.1f} kg/s from the plant")
print(f"the plant gives {(p_pa['plant.hot'] - p_pa['plant.cold']) / 1e5:.2f} bar")
print(f"the worst house is {worst.removesuffix('.station')} with {dp_pa[worst] / 1e5:.3f} bar")

result = model.simulate()
supply_degc = result["plant.unit.t_out_k"] - 273.15
dp_bar = result["plant.worst_consumer.dp_pa"] / 1e5
heat_mw = result["plant.station.q_flow_w"] / 1e6
print(f"supply {supply_degc[1]:.1f} degC after two minutes, {supply_degc[-1]:.1f} degC after an hour")
print(f"worst house {dp_bar[1]:.2f} bar after two minutes, {dp_bar[-1]:.3f} bar after an hour")
print(f"heat {heat_mw[-1]:.2f} MW")
