"""What soil and insulation do to the heat that a street loses in a year, and to what an ambient grid gains.

The streets are those of examples/grids. Every month is settled once, on its 15th: pipes and soil at rest with the ground of
that day; a year is the mean of the twelve.
"""

import pathlib

import anergy

GRIDS = pathlib.Path(__file__).parent.parent / "grids"
HOURS = 8760
# Conductivity in W/(m K) and diffusivity in m2/s: with water in it soil conducts better.
SOILS = {"dry sand": (0.5, 3.5e-7), "moist loam": (1.6, 6.2e-7), "wet clay": (2.5, 8.5e-7)}


def year(name, soil, pipe=lambda pipe: pipe, depth_m=None):
    """Heat lost by the lines in a year, MWh: hot (warm) and cold."""
    data = anergy.Model.from_file(GRIDS / f"{name}.toml").to_dict()
    conductivity, diffusivity = SOILS[soil]
    data["ground"] |= {"conductivity_w_m_k": conductivity, "diffusivity_m2_s": diffusivity}
    data["run"] |= {"initial": "steady"}
    for trench in data["trench"]:
        trench["pipe"] = pipe(trench["pipe"])
        if depth_m is not None:
            trench["depth_m"] = depth_m
    lost_mwh = {}
    for month in range(1, 13):
        data["run"]["start"] = f"2023-{month:02}-15T12:00:00+01:00"
        model = anergy.Model.from_dict(data, GRIDS)
        sim = model.simulation()
        for channel in sim.channels:
            if channel.endswith(".q_loss_w"):
                line = channel.split(".")[1]
                lost_mwh[line] = lost_mwh.get(line, 0.0) + sim.get(channel) * HOURS / 12 / 1e6
    return list(lost_mwh.values())


print("third generation, 85/45 degC, pre-insulated pipes side by side: lost in a year, MWh")
print(f"{'':12}" + "".join(f"{f'series {series}':>10}" for series in (1, 2, 3)))
for soil in SOILS:
    losses = [
        sum(year("3gdh", soil, lambda pipe, series=series: pipe.replace("series 1", f"series {series}")))
        for series in (1, 2, 3)
    ]
    print(f"{soil:12}" + "".join(f"{loss:10.2f}" for loss in losses))

print("\nambient grid, 20/15 degC, bare polyethylene: lost in a year, MWh (negative: gained)")
print(f"{'':12}{'depth m':>8}{'warm line':>11}{'cold line':>11}{'together':>10}")
for soil in SOILS:
    for depth_m in (0.8, 1.2, 2.0):
        warm, cold = year("5gdhc", soil, depth_m=depth_m)
        print(f"{soil:12}{depth_m:8.1f}{warm:11.2f}{cold:11.2f}{warm + cold:10.2f}")
