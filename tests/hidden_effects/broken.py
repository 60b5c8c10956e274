"""Data that are not what they claim to be. Each changes the table in place and says what it did."""

import numpy as np


def _compared(sensors):
    return [s for s in sensors if s.role == "compare"]


def unit(table, sensors, at_s, rng):
    candidates = [s for s in sensors if s.kind in ("kg_s", "pa", "w")]
    s = candidates[rng.integers(len(candidates))]
    factor = {"kg_s": [1 / 3.6, 1 / 60, 1000.0], "pa": [0.01, 100.0], "w": [1000.0, 1 / 3.6]}[s.kind]
    factor = factor[rng.integers(len(factor))]
    table[s.column] *= factor
    return f"unit of {s.column}: times {factor:.4g}"


def kelvin(table, sensors, at_s, rng):
    candidates = [s for s in sensors if s.kind == "k"]
    s = candidates[rng.integers(len(candidates))]
    table[s.column] += 273.15
    return f"{s.column} in K"


def swapped(table, sensors, at_s, rng):
    temperatures = [s.column for s in sensors if s.kind == "k"]
    a, b = rng.choice(temperatures, 2, replace=False)
    table[a], table[b] = table[b].copy(), table[a].copy()
    return f"{a} and {b} exchanged"


def hour_shift(table, sensors, at_s, rng):
    s = _compared(sensors)[rng.integers(len(_compared(sensors)))]
    k = int(min(3600.0, 0.4 * at_s[-1]) / (at_s[1] - at_s[0]))
    table[s.column] = np.roll(table[s.column], k)
    return f"{s.column} shifted by {k * (at_s[1] - at_s[0]):.0f} s"


def constant(table, sensors, at_s, rng):
    s = _compared(sensors)[rng.integers(len(_compared(sensors)))]
    x = table[s.column]
    x[np.isfinite(x)] = np.nanmedian(x)
    return f"{s.column} stuck"


def doubled(table, sensors, at_s, rng):
    temperatures = [s.column for s in sensors if s.kind == "k"]
    a, b = rng.choice(temperatures, 2, replace=False)
    table[b] = table[a].copy()
    return f"{b} is a copy of {a}"


def clock_jump(table, sensors, at_s, rng):
    s = _compared(sensors)[rng.integers(len(_compared(sensors)))]
    x, k = table[s.column], int(rng.uniform(150, 300) / (at_s[1] - at_s[0]))
    half = x.size // 2
    x[half + k :] = x[half:-k].copy()
    return f"clock of {s.column} jumps by {k * (at_s[1] - at_s[0]):.0f} s in the middle"


def missing(table, sensors, at_s, rng):
    s = _compared(sensors)[rng.integers(len(_compared(sensors)))]
    x = table[s.column]
    x[1:][rng.random(x.size - 1) < 0.93] = np.nan
    return f"{s.column}: 93 % missing"


ALL = [unit, kelvin, swapped, hour_shift, constant, doubled, clock_jump, missing]


def any_of(rng):
    return ALL[rng.integers(len(ALL))]
