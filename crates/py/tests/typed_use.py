"""What type checkers know of the package: checked by mypy in `make test-python`, never run.

Each `type: ignore` marks a mistake that has to be found: one that is not is an error too.
"""

import anergy
import numpy as np
import numpy.typing as npt


class Slow(anergy.Controller):
    interval_s = 60.0
    measures = ("a.t_k",)
    acts_on = ("pump.speed",)

    def update(self, time_s: float, measured: npt.NDArray[np.float64]) -> float:
        return float(measured[0])


grid = anergy.Grid("street", thermosiphon=True)
trench: str = grid.trench("a", "b", length_km=0.2, pipe="dn20")
grid.trench("a", "b", length_inch=3)  # type: ignore[call-arg]
grid.unit.heat_load("a", load_bar=3)  # type: ignore[call-arg]
grid.station.producer("a", feed_in_pump={"speed": 0.9})
grid.station.producer("a", feed_in_pump={"sped": 0.9})  # type: ignore[arg-type]
grid.edge.pump("p", "a", "b", mode="flwo")  # type: ignore[arg-type]
grid.site(3)  # type: ignore[arg-type]
model: anergy.Model = grid.model()

result = model.simulate(until_s=3600, step_s="auto", controllers=[Slow()])
model.simulate(controllers=[object()])  # type: ignore[list-item]
sim = model.simulation(step_s=1.0, controllers=[Slow()])
flows, flow = sim.handles(["a.m_flow_kg_s"]), sim.handle("a.m_flow_kg_s")
values: npt.NDArray[np.float64] = sim.get(flows, out=np.empty(1))
value: float = sim.get(flow)
sim.set(flows, values)
sim.set(flow, "fast")  # type: ignore[call-overload]
column: npt.NDArray[np.float64] = result["a.m_flow_kg_s"]
