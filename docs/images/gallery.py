"""Pictures of the gallery (docs/src/houses.md): three days of the cold week of each house.

Needs matplotlib and the program: python docs/images/gallery.py target/release/anergy
"""

from __future__ import annotations

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ROOT = Path(__file__).resolve().parents[2]
# House: generators with the channel of their heat, in kW.
HOUSES = {
    "sf1": {"engine": "chp.q_flow_w", "boiler": "boiler.q_flow_w", "sun": "collector.q_flow_w"},
    "sf2": {"heat pump": "heat_pump.q_flow_w", "boiler": "boiler.q_flow_w", "sun": "collector.q_flow_w"},
    "sf3": {"heat pump": "heat_pump.q_flow_w", "sun": "collector.q_flow_w"},
    "sf4": {"Stirling engine": "stirling.q_flow_w", "rod": "storage.rod_w"},
    "mf5": {"small engine": "small_chp.q_flow_w", "large engine": "large_chp.q_flow_w", "boiler": "boiler.q_flow_w"},
}
FROM_D, UNTIL_D = 1.0, 4.0


def table(program: str, house: str, folder: Path) -> dict[str, list[float]]:
    """The columns of a run."""
    model = ROOT / f"examples/laboratory-{house}/model.toml"
    subprocess.run([program, "run", model, "--until", "4d", "--out", folder], check=True, capture_output=True)
    out = folder / "results.csv"
    subprocess.run([program, "export", folder / "results.mcap", "--out", out], check=True, capture_output=True)
    with out.open() as file:
        rows = list(csv.reader(file))
    return {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0]) if name != "time"}


def draw(house: str, of: dict[str, list[float]], out: Path) -> None:
    """Storage, generators, room and taps."""
    time_d = [t / 86400 for t in of["time_s"]]
    degc = lambda name: [t - 273.15 for t in of[f"{house}.{name}"]]
    figure, (storage, heat, room) = plt.subplots(3, 1, figsize=(7, 5), sharex=True, height_ratios=(3, 3, 2))
    for layer in range(1, 11):
        storage.plot(time_d, degc(f"storage.t_{layer}_k"), color=plt.cm.coolwarm(layer / 10), lw=0.8)
    storage.set_ylabel("layers, degC")
    for name, channel in HOUSES[house].items():
        heat.plot(time_d, [w / 1000 for w in of[f"{house}.{channel}"]], lw=0.8, label=name)
    heat.set_ylabel("heat, kW")
    heat.legend(loc="upper right", fontsize=7, ncols=3)
    room.plot(time_d, degc("building.t_room_k"), lw=0.8, label="room", color="tab:green")
    room.set_ylabel("room, degC")
    room.set_xlabel("days since Monday, 13 February")
    room.set_xlim(FROM_D, UNTIL_D)
    figure.align_ylabels()
    figure.tight_layout()
    figure.savefig(out, dpi=75)
    plt.close(figure)


def main() -> None:
    for house in HOUSES:
        with tempfile.TemporaryDirectory() as folder:
            of = table(sys.argv[1], house, Path(folder))
        draw(house, of, ROOT / f"docs/images/house-{house}.png")


if __name__ == "__main__":
    main()
