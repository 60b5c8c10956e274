"""A street in an ambient grid: HOUSES houses, every fourth cools, and one balancing unit; UNTIL of a made-up year.

    python run.py [HOUSES] [UNTIL]          # 8 houses for a day; 50 and 365d take about two minutes

The houses are those of ../5gdhc-day, stated once as types.
"""

import re
import sys
import time
from pathlib import Path

import anergy

houses = int(sys.argv[1]) if len(sys.argv) > 1 else 8
until = sys.argv[2] if len(sys.argv) > 2 else "1d"
record = "1d" if until.endswith("d") and int(until[:-1]) > 7 else "15min"
day = Path(__file__).parent.with_name("5gdhc-day").joinpath("model.toml").read_text()


def house(site: str) -> str:
    """The entries of a house of the day, without its own schedules."""
    start = day.index(f'[[house]]\nsite = "{site}"\n') + len(f'[[house]]\nsite = "{site}"\n')
    end = day.find("# -----", start)
    text = day[start : end if end > 0 else None]
    return re.sub(r"(# Heat of machines.*\n)?\[\[house\.schedule\]\]\n(?:\w+ = .*\n)+", "", text)


def house_type(site: str, name: str) -> str:
    text = house(site).replace("[[house.", f"[[house_type.{name}.").replace("[house.unit", f"[house_type.{name}.unit")
    # Pumps that hold any flow: a year of many houses needs no curves.
    text = text.replace('kind = "prosumer"', 'kind = "prosumer", flow_control = "ideal"')
    return f"[house_type.{name}]\n{text}"


def pipe(supplied: int) -> str:
    return "PE100 SDR11 140" if supplied > 24 else "PE100 SDR11 110" if supplied > 9 else "PE100 SDR11 63"


sites = ["bu", *(f"h{i}" for i in range(houses))]
parts = [
    f'format = 1\n[model]\nname = "{houses} houses in an ambient grid"\n[run]\nuntil = "{until}"\nstep = "60s"\n'
    f'record = "{record}"\ninitial_degc = 16\nstart = "2021-01-01T00:00:00+01:00"\n[weather]\nkind = "synthetic"\n'
    '[ground]\ntemperature_degc = 12\n[pressure_reference]\nnode = "bu.cold"\npressure_bar = 1.5\n',
    house_type("heat", "heating"),
    house_type("cool", "cooling"),
    # Machines all year round.
    '[[house_type.cooling.schedule]]\nsignal = "rooms.appliances_w"\nunit = "kw"\ninterpolation = "hold"\npoints = [[0, 3]]\n',
    *(f'[[site]]\nid = "{site}"\n' for site in sites),
    *(
        f'[[trench]]\nfrom = "{a}"\nto = "{b}"\nlength_m = 20\npipe = "{pipe(houses - i)}"\ndepth_m = 1\n'
        for i, (a, b) in enumerate(zip(sites, sites[1:]))
    ),
    *(
        f'[[house]]\nsite = "h{i}"\ntype = "{"cooling" if i % 4 == 3 else "heating"}"\n'
        for i in range(houses)
    ),
    '[[house]]\nsite = "bu"\n'
    + house("bu")
    .replace("volume_l = 2000", f"volume_l = {400 * houses}")
    .replace("height_m = 2\n", "height_m = 4\n")
    .replace("PE100 SDR11 50", pipe(houses))
    .replace('kind = "air_source_heat_pump"\n', f'kind = "air_source_heat_pump"\nsize_factor = {0.24 * houses}\n'),
]
model = anergy.Model.from_toml("\n".join(parts))
started = time.process_time()
result = model.simulate()
used_s = time.process_time() - started
kpis = result.kpis()
simulation = model.simulation()
simulation.advance(6 * 3600.0)
state_bytes = len(simulation.snapshot().to_bytes())
print(f"{houses} houses, {until} in steps of a minute: {used_s:.1f} s of one core, {state_bytes / houses:.0f} bytes of state per house")
starts = [kpis[f"h{i}.heat_pump.starts"] for i in range(houses) if i % 4 != 3]
cops = [kpis[f"h{i}.heat_pump.seasonal_cop"] for i in range(houses) if i % 4 != 3]
print(f"boosters: COP {min(cops):.2f} to {max(cops):.2f}, {min(starts):.0f} to {max(starts):.0f} starts")
