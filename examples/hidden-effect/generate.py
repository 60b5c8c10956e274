"""The measurements of this study: a pipe with a wall that stores heat, computed apart from anergy.

    python generate.py          # writes data.csv; needs numpy only

400 cells of water, each moved on by one cell per step (no numerical smear), each with its own piece of wall behind the film
of the water, which loses heat to the surroundings. Then the sensors: constant offsets within their class, noise,
a resolution of 0.1 K, a reading every ten seconds with its own small delay.
"""

from pathlib import Path

import numpy as np

LENGTH_M, INNER_M, OUTER_M, CELLS = 60.0, 0.0431, 0.0483, 400
RHO, CP, CONDUCTIVITY, VISCOSITY = 988.0, 4180.0, 0.64, 0.55e-3  # water of 50 degC
STEEL_J_M3_K = 7850.0 * 470.0
LOSS_W_M_K, AROUND_DEGC = 0.21, 12.6  # the model says 0.20 and 12
PRANDTL = CP * VISCOSITY / CONDUCTIVITY

random = np.random.default_rng(20261126)


def inlet_degc(t: float) -> float:
    """Hot water in steps, with the ripple of a boiler."""
    level = np.interp(t, [0, 120, 150, 900, 930, 1700, 1740, 2600, 2630, 3600], [35, 35, 65, 65, 50, 50, 70, 70, 42, 42])
    return level + 0.4 * np.sin(2 * np.pi * t / 170)


def m_flow_kg_s(t: float) -> float:
    return 0.35 if t < 1300 else 0.62 if t < 2300 else 0.24


area = np.pi * INNER_M**2 / 4
dx = LENGTH_M / CELLS
water_j_k = RHO * CP * area * dx
wall_j_k = STEEL_J_M3_K * np.pi / 4 * (OUTER_M**2 - INNER_M**2) * dx
water = np.full(CELLS, 34.0)
wall = np.full(CELLS, 34.0)
t, times, outlets = 0.0, [0.0], [34.0]
while t < 3650:
    m_flow = m_flow_kg_s(t)
    velocity = m_flow / (RHO * area)
    dt = dx / velocity
    outlets.append(water[-1])
    water[1:] = water[:-1].copy()
    water[0] = inlet_degc(t + dt / 2)
    reynolds = RHO * velocity * INNER_M / VISCOSITY
    nusselt = 0.023 * reynolds**0.8 * PRANDTL**0.4  # Dittus-Boelter: not the law that anergy uses
    film_w_k = nusselt * CONDUCTIVITY / INNER_M * np.pi * INNER_M * dx
    mean = (water * water_j_k + wall * wall_j_k) / (water_j_k + wall_j_k)
    decay = np.exp(-film_w_k * (1 / water_j_k + 1 / wall_j_k) * dt)
    water, wall = mean + (water - mean) * decay, mean + (wall - mean) * decay
    wall += (AROUND_DEGC - wall) * (1 - np.exp(-LOSS_W_M_K * dx * dt / wall_j_k))
    t += dt
    times.append(t)


def reading(true: np.ndarray, offset: float) -> np.ndarray:
    return np.round(true + offset + random.normal(0, 0.02, true.shape), 1)


at = np.arange(0, 3600, 10.0)
late = at + random.uniform(-0.3, 0.3, at.shape)
rows = np.column_stack(
    [
        at,
        reading(np.array([inlet_degc(x) for x in late]), 0.08),
        np.round(np.array([m_flow_kg_s(x) for x in late]) * 3600 * 1.002 + random.normal(0, 1.5, at.shape), 1),
        reading(np.interp(late, times, outlets), -0.11),
    ]
)
with Path(__file__).with_name("data.csv").open("w") as file:
    file.write("time_s,T_in_degC,flow_kg_h,T_out_degC\n")
    for row in rows:
        file.write(f"{row[0]:.0f},{row[1]:.1f},{row[2]:.1f},{row[3]:.1f}\n")
