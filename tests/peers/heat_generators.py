"""Seasonal figures of heat pumps and a boiler beside public codes, at the same temperatures and heats.

A year of the laboratory houses SF2 (air), SF3 (brine) and SF1 (boiler) is run in steps of 5 min. What arrived in every
step - source, return of the water, heat - is given to hplib (generic units) and oemof.thermal (share of Carnot), and for the boiler to
the least efficiencies of the directive 92/42/EEC. Each says what electricity or gas it would have taken for the same heat.
Writes a table; ends with 1 when a figure is far from all others.

    .venv-heat/bin/python tests/peers/heat_generators.py --anergy target/release/anergy
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import hplib.hplib as hplib
import numpy as np
import pandas as pd
from oemof.thermal.compression_heatpumps_and_chillers import calc_cops

ROOT = Path(__file__).parents[2]
STEP_S = 300
# A seasonal figure within this share of the range of the others is no news.
APART = 0.25
# oemof.thermal's documentation: quality grades of its examples.
GRADES = {"air": 0.4, "brine": 0.55}


def year(program: str, house: str, folder: Path, changes: str, *channels: str) -> pd.DataFrame:
    """A year of a house of the library, with channels as columns; temperatures in degC."""
    model = (ROOT / f"examples/laboratory-{house}/model.toml").read_text().rstrip() + f"\n{changes}\n"
    (folder / "model.toml").write_text(model)
    step = f"{STEP_S}s"
    run = [program, "run", folder / "model.toml", "--out", folder, "--until", "365d", "--step", step, "--record", step]
    subprocess.run(run, check=True, capture_output=True)
    names = [channel if channel.startswith("weather") else f"{house}.{channel}" for channel in channels]
    table = folder / "table.csv"
    export = [program, "export", folder / "results.mcap", "--out", table, "--units", "degc", "--channels", *names]
    subprocess.run(export, check=True, capture_output=True)
    return pd.read_csv(table, index_col="time_s").iloc[1:].rename(columns=lambda name: name.removeprefix(f"{house}."))


def generic(group: int, size_kw: float) -> pd.DataFrame:
    """The generic unit of a group of hplib, of the size of ours at its reference point."""
    t_in = -7 if group in (1, 4) else 0
    return hplib.get_parameters("Generic", group_id=group, t_in=t_in, t_out=52, p_th=size_kw * 1000)


def of_hplib(group: int, rows: pd.DataFrame, size_kw: float) -> float:
    """Heat over the electricity that hplib's unit takes for it."""
    source, back, air = (rows[name].to_numpy() for name in ("source", "return", "air"))
    done = hplib.simulate(source, back, generic(group, size_kw), air)
    # One row that holds the whole series.
    return seasonal(rows, pd.Series(np.asarray(done["COP"].iloc[0], float), index=rows.index))


def of_carnot(grade: float, rows: pd.DataFrame, icing: bool) -> float:
    """The same with a constant share of Carnot between source and supply."""
    icy = {"temp_threshold_icing": 2, "factor_icing": 0.8} if icing else {}
    cops = calc_cops("heat_pump", list(rows["supply"]), list(rows["source"]), quality_grade=grade, **icy)
    return seasonal(rows, pd.Series(cops, index=rows.index))


def seasonal(rows: pd.DataFrame, cop: pd.Series) -> float:
    return float(rows["heat"].sum() / (rows["heat"] / cop).sum())


def least_of_directive(rows: pd.DataFrame, nominal_kw: float) -> float:
    """Heat over gas of a condensing boiler that is as good as the directive 92/42/EEC asks at least.

    91 + log P at full load and water of 70 degC on average, 97 + log P at 30 % load and a return of 30 degC, percent of the
    lower heating value; straight in the mean temperature of the water in between, its load follows that.
    """
    more = math.log10(nominal_kw)
    mean = 0.5 * (rows["return"] + rows["supply"])
    cool = ((70 - mean) / (70 - 30)).clip(0, 1)
    return seasonal(rows, ((91 + more) + 6 * cool) / 100)


def heat_pump(program: str, house: str, folder: Path, dynamic: bool, source: str) -> tuple[pd.DataFrame, float]:
    """What happened in every step in which the compressor gave heat; heat over electricity of the year without heater."""
    changes = "" if dynamic else 'set = { "heat_pump.dynamics" = false }'
    table = year(program, house, folder, changes, "heat_pump.*", "weather.*")
    heat = table["heat_pump.q_flow_w"] - table["heat_pump.aux_w"]
    electric = table["heat_pump.electric_w"] - table["heat_pump.aux_w"]
    air = table["weather.t_outdoor_degc"]
    rows = pd.DataFrame(
        {
            "source": air if source == "air" else table["heat_pump.t_brine_degc"],
            "air": air,
            "return": table["heat_pump.water.t_in_degc"],
            "supply": table["heat_pump.water.t_in_degc"] + 5,
            "heat": heat,
        }
    )
    return rows[heat > 100], float(heat.sum() / electric.sum())


def compare(program: str, folder: Path) -> tuple[list[list[str]], bool]:
    """A row of text per generator, and whether ours lies among the others."""
    lines, good = [], True
    for house, source, size_kw in (("sf2", "air", 10), ("sf3", "brine", 10.8)):
        rows, ours = heat_pump(program, house, folder, True, source)
        _, steady = heat_pump(program, house, folder, False, source)
        regulated, on_off = (1, 4) if source == "air" else (2, 5)
        theirs = {
            "hplib, regulated": of_hplib(regulated, rows, size_kw),
            "hplib, on/off": of_hplib(on_off, rows, size_kw),
            f"oemof.thermal, {GRADES[source]}": of_carnot(GRADES[source], rows, source == "air"),
        }
        weighted = {key: float((rows[key] * rows["heat"]).sum() / rows["heat"].sum()) for key in ("source", "supply")}
        good &= min(theirs.values()) * (1 - APART) < ours < max(theirs.values()) * (1 + APART)
        lines.append([
            f"{house.upper()}, {source}", f"{rows['heat'].sum() * STEP_S / 3.6e6:.0f}",
            f"{weighted['source']:.1f} / {weighted['supply']:.1f}", f"{ours:.2f}", f"{steady:.2f}",
            *(f"{value:.2f}" for value in theirs.values()),
        ])
    return lines, good


def boilers(program: str, folder: Path) -> tuple[list[list[str]], bool]:
    lines, good = [], True
    for house, nominal_kw in (("sf1", 20), ("mf5", 50)):
        table = year(program, house, folder, "", "boiler.*")
        rows = pd.DataFrame(
            {
                "heat": table["boiler.q_flow_w"], "return": table["boiler.water.t_in_degc"],
                "supply": table["boiler.water.t_out_degc"],
            }
        )[table["boiler.q_flow_w"] > 100]
        ours = float(table["boiler.q_flow_w"].sum() / table["boiler.fuel_w"].sum())
        least = least_of_directive(rows, nominal_kw)
        mean = float((rows["return"] * rows["heat"]).sum() / rows["heat"].sum())
        good &= abs(ours - least) < 0.08
        heat = f"{rows['heat'].sum() * STEP_S / 3.6e6:.0f}"
        starts = f"{table['boiler.starts'].iloc[-1]:.0f}"
        lines.append([f"{house.upper()}, {nominal_kw} kW", heat, starts, f"{mean:.1f}", f"{ours:.3f}", f"{least:.3f}"])
    return lines, good


def table_of(head: list[str], lines: list[list[str]]) -> list[str]:
    return [f"| {' | '.join(cells)} |" for cells in (head, ["---", *["--:"] * (len(head) - 1)], *lines)]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--anergy", default=ROOT / "target/release/anergy")
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    program = str(Path(arguments.anergy).resolve())
    with tempfile.TemporaryDirectory() as name:
        pumps, pumps_good = compare(program, Path(name))
        gas, gas_good = boilers(program, Path(name))
    versions = {part: importlib.metadata.version(part) for part in ("hplib", "oemof.thermal")}
    head = ["house, source", "heat, kWh", "source / supply, degC", "anergy", "its steady map",
            "hplib, regulated", "hplib, on/off", "oemof.thermal"]
    text = "\n".join([
        "<!-- heat pumps -->", *table_of(head, pumps), "",
        "<!-- boilers -->",
        *table_of(["house, boiler", "heat, kWh", "starts", "return, degC", "anergy", "least of 92/42/EEC"], gas),
    ])
    print(text)
    if arguments.out:
        head, _, rest = arguments.out.read_text().partition("<!-- begin -->\n")
        _, _, after = rest.partition("<!-- end -->\n")
        said = f"{datetime.date.today()}, `tests/peers/heat_generators.py` (`make peers`), hplib {versions['hplib']}, oemof.thermal {versions['oemof.thermal']}."
        arguments.out.write_text(f"{head}<!-- begin -->\n{text}\n\n{said}\n<!-- end -->\n{after}")
    return 0 if pumps_good and gas_good else 1


if __name__ == "__main__":
    sys.exit(main())
