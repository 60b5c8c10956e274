"""Pumps that hunt: one, two and three feeders, without and with simulating, and what helps.

With matplotlib and a directory as argument also the pictures: `python run.py DIR`.
"""

import sys
from pathlib import Path

import anergy

here = Path(__file__).parent
models = {n: anergy.Model.from_file(here / f"n{n}.toml") for n in (1, 2, 3)}
for n, model in models.items():
    stability = model.stability()
    pi = stability.controllers.row("pi1")
    result = model.simulate(until_s=900, record_s=0.5)
    flow_l_min = 60 * result["plant.feeder1.feed_in_pump.m_flow_kg_s"][result.time_s > 840]
    swing_l_min = flow_l_min.max() - flow_l_min.min()
    hunts = sorted({event["component"] for event in result.events if event["kind"] == "hunting"})
    print(
        f"{n} feeder(s): gain {pi['gain'] / 60:.3f} of at most {pi['critical_gain'] / 60:.3f} per l/min, "
        f"{'stable' if pi['stable'] else 'hunts'}; in the run {swing_l_min:.2f} l/min peak to peak, "
        f"{len(hunts)} pump(s) hunt"
    )
    if n == 2 and len(sys.argv) > 1:
        out = Path(sys.argv[1])
        out.mkdir(parents=True, exist_ok=True)
        flows = [f"plant.feeder{i}.feed_in_pump.m_flow_kg_s" for i in (1, 2)]
        for name, axes in {
            "flows": result.plot(*flows),
            "mode": stability.plot_modes(),
            "feeders": stability.plot_feeders(),
            "pump": model.plot_pump("plant.feeder1.feed_in_pump"),
            "map": model.blocking_map(
                "plant.feeder1.feed_in_pump", "plant.feeder2.feed_in_pump"
            ).plot(),
        }.items():
            axes.figure.savefig(out / f"{name}.png", dpi=110)
        result.report(out / "report.html")

for one in models[2].stability(advise=True).advice:
    print(f"{one['remedy'].replace('_', ' ')}: {one['verdict']}")
