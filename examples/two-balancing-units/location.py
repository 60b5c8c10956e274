"""Where along a street should the second balancing unit stand? Eight houses draw heat on winter days; a balancing unit
with storage and heat pump stands at the head of the street, a second one behind each of the houses in turn.

    python location.py [UNTIL]          # two days for each of the places: 15 s
"""

import sys
from pathlib import Path

import anergy

HOUSES = 8
until = sys.argv[1] if len(sys.argv) > 1 else "2d"
day = Path(__file__).parent.with_name("5gdhc-day").joinpath("model.toml").read_text()
mark = '[[house]]\nsite = "bu"\n'
unit = day[day.index(mark) + len(mark) : day.index("[[house.schedule]]", day.index(mark))]
unit = unit.replace("[[house.", "[[house_type.balancing.").replace("[house.unit", "[house_type.balancing.unit")
loads = [1 + 0.5 * (i % 3) for i in range(HOUSES)]  # kW
sites = ["head", *(f"h{i}" for i in range(HOUSES))]
street = "".join(
    [
        f'format = 1\n[run]\nuntil = "{until}"\nstep = "60s"\nrecord = "5min"\ninitial_degc = 16\n[ground]\ntemperature_degc = 10\n'
        '[pressure_reference]\nnode = "head.cold"\npressure_bar = 1.5\n[house_type.balancing]\n' + unit,
        *(f'[[site]]\nid = "{site}"\n' for site in [*sites, "second"]),
        *(
            f'[[trench]]\nfrom = "{a}"\nto = "{b}"\nlength_m = 60\npipe = "PE100 SDR11 50"\ndepth_m = 1\n'
            for a, b in zip(sites, sites[1:])
        ),
        *(
            f'[[station]]\nsite = "h{i}"\nkind = "prosumer"\ndirections = "extraction"\n'
            f'[[unit]]\nsite = "h{i}"\nname = "load"\nkind = "heat_load"\nload_kw = {load}\ntemperature_difference_k = 4\n'
            for i, load in enumerate(loads)
        ),
        *(
            f'[[house]]\nsite = "{site}"\ntype = "balancing"\n[[schedule]]\nsignal = "{site}.heat_pump.t_outdoor_k"\nunit = "degc"\npoints = [[0, 2]]\n'
            for site in ("head", "second")
        ),
    ]
)

print(f"{sum(loads)} kW in {HOUSES} houses, 60 m apart; a second balancing unit behind house ...")
print("place  from the second  pumps  heat pumps  lost to ground  coldest house")
best = None
for place in range(HOUSES):
    behind = f'[[trench]]\nfrom = "h{place}"\nto = "second"\nlength_m = 5\npipe = "PE100 SDR11 50"\ndepth_m = 1\n'
    found = anergy.Model.from_toml(street + behind).simulate().kpis()
    given = [found[f"{site}.station.heat_given_kwh"] for site in ("head", "second")]
    pumps = sum(found[f"h{i}.station.pump_electricity_kwh"] for i in range(HOUSES))
    heat_pumps = sum(found[f"{site}.heat_pump.electricity_kwh"] for site in ("head", "second"))
    coldest = min(found[f"h{i}.station.extracted_arriving_min_degc"] for i in range(HOUSES))
    print(
        f"h{place:<5} {given[1] / sum(given):13.0%} {pumps:8.2f} kWh {heat_pumps:6.1f} kWh {found['network.heat_lost_kwh']:10.1f} kWh"
        f" {coldest:10.1f} degC"
    )
    if best is None or pumps < best[0]:
        best = pumps, place
print(f"least electricity of pumps: behind h{best[1]}")
