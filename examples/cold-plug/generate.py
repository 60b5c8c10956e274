"""Writes feed_in.csv: the temperature at which SF1 feeds in, from its start at 600 s."""

from math import exp, pi, sin
from pathlib import Path

START_S, RISE_S, PERIOD_S, DECAY_S = 600, 60.0, 120.0, 240.0

rows = ["time_s,swinging_degc,smooth_degc,hot_degc"]
for t in range(START_S, 2401, 5):
    since = t - START_S
    smooth = 60.0 - 40.0 * exp(-since / RISE_S)
    swing = 4.0 * exp(-since / DECAY_S) * sin(2.0 * pi * since / PERIOD_S)
    rows.append(f"{t},{smooth + swing:.4f},{smooth:.4f},60")
Path(__file__).with_name("feed_in.csv").write_text("\n".join(rows) + "\n")
