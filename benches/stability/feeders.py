"""A grid of 50 unlike feeders for `anergy stability`: `python benches/stability/feeders.py FOLDER`.

25 sites in a tree, 50 producers whose flow controllers differ in lag, dead time, integral time and gain: all loops
closed, many of their modes growing. `continuous.toml` and `sampled.toml` (every 0.1 s) differ in the interval only.
"""

from __future__ import annotations

import random
import sys
from pathlib import Path

FEEDERS, SITES, SEED, GAIN = 50, 25, 1, 0.7


def model(interval_s: float) -> str:
    chance = random.Random(SEED)
    text = ['format = 1\n[run]\nuntil = "1h"\nstep = "0.1s"\nrecord = "10s"\ninitial = "steady"\n'
            '[fluid]\nkind = "constant_water"\ndensity_kg_m3 = 1000\n'
            "[pipe_type.p]\ninner_diameter_mm = 80\nroughness_mm = 0.05\ndelta_m = 0.01\n"]
    text += [f'[[site]]\nid = "s{site}"\n' for site in range(SITES)]
    for site in range(1, SITES):
        text.append(f'[[trench]]\nfrom = "s{site}"\nto = "s{chance.randrange(site)}"\n'
                    f'length_m = {chance.uniform(20, 200):.3f}\npipe = "p"\n')
    for site in range(SITES):
        if site % 2 == 0:
            text.append(f'[[station]]\nsite = "s{site}"\nname = "use"\nkind = "consumer"\n'
                        'stub = { pipe = "p", length_m = 5 }\n'
                        f'extraction_valve = {{ kvs_m3_h = {6.0 if site == 0 else 1.5}, command = "kappa", '
                        f'kappa = {chance.uniform(0.3, 1):.4f}, delta_m = 0.01 }}\n')
    for i in range(FEEDERS):
        site = i % SITES
        rise_s, integral_s = chance.uniform(4, 20), chance.uniform(5, 30)
        lag_s, dead_s = chance.uniform(0.3, 3), chance.uniform(0, 2)
        flow_kg_s = chance.uniform(1.5, 4) / 60
        text.append(
            f'[[station]]\nsite = "s{site}"\nname = "f{i}"\nkind = "producer"\nstub = {{ pipe = "p", length_m = 5 }}\n'
            "heat_exchanger = { delta_m = 0.01 }\n"
            f"feed_in_pump = {{ head_max_hpa = {chance.uniform(300, 600):.2f}, "
            f"free_flow_l_min = {chance.uniform(30, 90):.2f}, rise_time_s = {rise_s:.3f}, delta_m = 0.001 }}\n"
            "feed_in_check_valve = { kvs_m3_h = 20, leakage = 1e-3, delta_m = 0.01 }\n"
            f'[[sensor]]\nid = "m{i}"\nmeasures = "s{site}.f{i}.feed_in_pump.m_flow_kg_s"\n'
            f"time_constant_s = {lag_s:.3f}\ndead_time_s = {dead_s:.3f}\n"
            f'[[controller]]\nid = "c{i}"\nkind = "pi"\nmeasures = "m{i}.value"\n'
            f'acts_on = "s{site}.f{i}.feed_in_pump.speed"\nset_point = {flow_kg_s:.5f}\n'
            f"gain = {GAIN * chance.uniform(0.3, 1.5):.3f}\nintegral_time_s = {integral_s:.3f}\ninterval_s = {interval_s}\n")
    text.append('[pressure_reference]\nnode = "s0.cold"\n')
    return "".join(text)


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, interval_s in (("continuous", 0.0), ("sampled", 0.1)):
        (folder / f"{name}.toml").write_text(model(interval_s))
