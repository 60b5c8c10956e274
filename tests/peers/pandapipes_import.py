"""`anergy import pandapipes` against pandapipes: the water nets that it brings and some built here.

pandapipes solves each net (Colebrook, then its heat); anergy imports the file that pandapipes.to_json wrote and solves it.
Writes a table of the differences; ends with 1 when fewer than 15 nets agree or one fails without saying so.

    .venv-peers/bin/python tests/peers/pandapipes_import.py --anergy target/release/anergy
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import math
import subprocess
import sys
import tempfile
import tomllib
import warnings
from pathlib import Path

import pandapipes as pp
import pandapipes.networks as networks

# Pressures agree to this share of their span, flows to this share of the largest.
AGREES = 1e-2
# Temperatures of junctions that are passed by water, K.
AGREES_K = 0.1
WANTED = 15


def heat_net() -> pp.pandapipesNet:
    """Two lines, a circulation pump, consumers of all three kinds."""
    net = pp.create_empty_network("heat consumers", fluid="water")
    hot = [pp.create_junction(net, pn_bar=6, tfluid_k=340, height_m=2 * i) for i in range(4)]
    cold = [pp.create_junction(net, pn_bar=6, tfluid_k=340, height_m=2 * i) for i in range(4)]
    pp.create_circ_pump_const_pressure(net, cold[0], hot[0], 6, 2, t_flow_k=350)
    for i in range(3):
        for line, ends in ((hot, (i, i + 1)), (cold, (i + 1, i))):
            pp.create_pipe_from_parameters(
                net, line[ends[0]], line[ends[1]], 0.2, inner_diameter_mm=60, k_mm=0.1, loss_coefficient=1,
                u_w_per_m2k=2, text_k=283,
            )
    pp.create_heat_consumer(net, hot[1], cold[1], qext_w=50e3, controlled_mdot_kg_per_s=0.6)
    pp.create_heat_consumer(net, hot[2], cold[2], controlled_mdot_kg_per_s=0.4, deltat_k=20)
    pp.create_flow_control(net, hot[3], cold[3], 0.5)
    return net


def exchanger_net() -> pp.pandapipesNet:
    """Heat exchangers: at controlled flows as consumers, and one that warms the return of all."""
    net = pp.create_empty_network("heat exchangers", fluid="water")
    hot = [pp.create_junction(net, pn_bar=6, tfluid_k=340) for _ in range(3)]
    cold = [pp.create_junction(net, pn_bar=6, tfluid_k=340) for _ in range(3)]
    end = pp.create_junction(net, pn_bar=6, tfluid_k=340)
    pp.create_circ_pump_const_pressure(net, end, hot[0], 6, 2, t_flow_k=345)
    lines = [(hot[0], hot[1]), (hot[1], hot[2]), (cold[2], cold[1]), (cold[1], cold[0])]
    for a, b in lines:
        pp.create_pipe_from_parameters(
            net, a, b, 0.3, inner_diameter_mm=70, k_mm=0.1, u_w_per_m2k=2, text_k=283
        )
    for i, (m_flow, heat) in enumerate(((0.8, 60e3), (0.5, 30e3)), start=1):
        middle = pp.create_junction(net, pn_bar=6, tfluid_k=340)
        pp.create_flow_control(net, hot[i], middle, m_flow)
        pp.create_heat_exchanger(net, middle, cold[i], qext_w=heat, loss_coefficient=50, inner_diameter_mm=50)
    last = pp.create_junction(net, pn_bar=6, tfluid_k=340)
    pp.create_heat_exchanger(net, cold[0], last, qext_w=-25e3, loss_coefficient=80, inner_diameter_mm=50)
    pp.create_pipe_from_parameters(net, last, end, 0.1, inner_diameter_mm=70, k_mm=0.1)
    return net


def parts_net() -> pp.pandapipesNet:
    """A valve, a pump, a heat exchanger, sinks and sources, a closed valve."""
    net = pp.create_empty_network("all parts", fluid="water")
    j = [pp.create_junction(net, pn_bar=5, tfluid_k=300, height_m=h) for h in (0, 5, 3, 2, 1, 0)]
    pp.create_ext_grid(net, j[0], 5, 300)
    pipes = [(0, 1, 300), (1, 2, 200), (1, 5, 500)]
    for a, b, length in pipes:
        pp.create_pipe_from_parameters(
            net, j[a], j[b], length / 1e3, inner_diameter_mm=80, k_mm=0.1, loss_coefficient=2
        )
    pp.create_valve(net, j[2], j[3], et="ju", inner_diameter_mm=80, opened=True, loss_coefficient=15)
    pp.create_valve(net, j[0], j[4], et="ju", inner_diameter_mm=80, opened=False)
    pp.create_valve(net, j[1], 2, et="pi", inner_diameter_mm=80, opened=True, loss_coefficient=5)
    pp.create_pump(net, j[3], j[4], std_type="P1")
    pp.create_heat_exchanger(net, j[4], j[5], qext_w=0, loss_coefficient=300, inner_diameter_mm=60)
    pp.create_sink(net, j[5], 4.0, scaling=0.5)
    pp.create_source(net, j[2], 0.3)
    return net


def nets() -> dict:
    """Constructors by name."""
    found = {"built here: " + build.__name__: build for build in (heat_net, exchanger_net, parts_net)}
    for name in sorted(vars(networks)):
        if name.startswith(("water_", "heat_transfer_")) and callable(getattr(networks, name)):
            found[name] = getattr(networks, name)
    found["schutterwald_heat"] = networks.schutterwald_heat
    return found


def run(program: str, *arguments: str) -> str | None:
    """What a command that failed said."""
    done = subprocess.run(
        [program, *arguments], capture_output=True, text=True, check=False, timeout=900
    )
    return (done.stderr.strip() or "(silent)") if done.returncode else None


def temperatures(net: pp.pandapipesNet) -> dict[str, float]:
    """Those of pandapipes at junctions that are passed by water; none where its heat does not converge."""
    try:
        pp.pipeflow(net, friction_model="colebrook", mode="sequential", max_iter_hyd=200, max_iter_therm=100)
    except Exception:
        return {}
    passed = net.pipe[net.res_pipe.mdot_from_kg_per_s.abs() > 1e-3]
    junctions = set(passed.from_junction) | set(passed.to_junction)
    found = {f"junction{i}": t_k for i, t_k in net.res_junction.t_k.items() if i in junctions}
    # Where all water has one temperature there is nothing to compare.
    return found if found and max(found.values()) - min(found.values()) > 0.1 else {}


def hydraulics(net: pp.pandapipesNet) -> None:
    options = {"friction_model": "colebrook", "mode": "hydraulics", "max_iter_hyd": 200, "tol_p": 1e-9}
    pp.pipeflow(net, tol_m=1e-9, tol_res=1e-6, max_iter_colebrook=200, tolerance_colebrook=1e-10, **options)


def compare(name: str, build, program: str, folder: str) -> dict:
    row = {"name": name}
    try:
        net = build()
    except Exception as error:
        return row | {"status": f"pandapipes cannot make it: {' '.join(str(error).split())}"}
    # Hydraulics alone are compared: standing water must not freeze in a ground of -12 degC (schutterwald_heat).
    net.pipe["text_k"] = net.pipe["text_k"].clip(lower=278.15)
    file, model, result = (str(Path(folder, part)) for part in ("net.json", "model.toml", "steady.json"))
    pp.to_json(net, file)
    try:
        warm = temperatures(net)
        hydraulics(net)
    except Exception as error:
        return row | {"status": f"pandapipes does not solve it: {' '.join(str(error).split())}"}
    row.update(nodes=len(net.junction), branches=len(net.pipe))
    message = run(program, "import", "pandapipes", file, "--out", model)
    message = message or run(program, "solve", model, "--json", result)
    if message:
        return row | {"status": "fails: " + message.splitlines()[0], "silent": message == "(silent)"}
    text = Path(model).read_text()
    notes = [line[2:] for line in text.splitlines() if line.startswith("# ")][1:]
    row["problems"] = sum(note.startswith("problem") for note in notes)
    row["untranslated"] = sum(note.startswith(("problem", "not translated")) for note in notes)
    density = tomllib.loads(text)["fluid"]["density_kg_m3"]
    steady = json.loads(Path(result).read_text())
    ours = {node["id"]: node["p_pa"] / 1e5 for node in steady["nodes"]}
    flows = {edge["id"]: edge["m_flow_kg_s"] for edge in steady["edges"]}
    theirs = {f"junction{i}": p for i, p in net.res_junction.p_bar.items() if not math.isnan(p)}
    span = max(theirs.values()) - min(theirs.values())
    row["pressure"] = max(abs(ours.get(i, math.inf) - p) for i, p in theirs.items()) / max(span, 1e-3)
    mass = {f"pipe{i}": m for i, m in net.res_pipe.mdot_from_kg_per_s.items() if not math.isnan(m)}
    largest = max(map(abs, mass.values()), default=0) or 1e-6
    row["flow"] = max(abs(flows.get(i, math.inf) - m) for i, m in mass.items()) / largest
    row["density"] = density
    if warm:
        t_k = {node["id"]: node["t_k"] for node in steady["nodes"]}
        row["temperature"] = max(abs(t_k[i] - t) for i, t in warm.items())
        if row["temperature"] > AGREES_K:
            row["why"] = "hotter than 99 degC" if row["problems"] else "water of a source"
    agrees = row["pressure"] <= AGREES and row["flow"] <= AGREES
    row["status"] = "agrees" if agrees else "differs"
    # Its Colebrook law goes on below Re = 4000, where flow is laminar or about to be.
    slowest = net.res_pipe.reynolds.where(net.res_pipe.mdot_from_kg_per_s.abs() > 1e-9).min()
    if not agrees and slowest < 4000:
        row["status"] += f": pandapipes applies Colebrook's law at Re = {slowest:.0f}"
    row["silent"] = row["status"] == "differs" and not row["problems"]
    if "why" in row and (row["problems"] or len(net.get("source", []))):
        row["status"] += f"; heat differs: {row['why']}"
    elif "why" in row:
        row["status"], row["silent"] = "differs in its temperatures", True
    return row


def table(rows: list[dict]) -> str:
    agreeing = sum(row["status"].startswith("agrees") for row in rows)
    version = importlib.metadata.version("pandapipes")
    out = [
        "# pandapipes nets, imported and solved",
        "",
        f"Water nets of pandapipes {version}, written with `to_json`, read with `anergy import pandapipes` and"
        ' solved with `anergy solve`, against `pipeflow(friction_model="colebrook", mode="hydraulics")`.'
        " Pressures: largest difference over their span; flows: over the largest flow of a pipe. The ground has"
        " 5 degC at least (`schutterwald_heat`: -12 degC, at which the water of its standing pipes would freeze)."
        f" Temperatures: the largest difference at junctions that water passes, against `mode=\"sequential\"`, {AGREES_K:g} K asked. Two"
        " kinds of nets differ there with a reason: the water of a `source` comes at the start temperature here and at the"
        " temperature of its junction, whatever that is, in pandapipes; water above 99 degC is refused and said so.",
        "",
        f"{datetime.date.today()}, `make peers`: {agreeing} of {len(rows)} agree to {AGREES:g}.",
        "",
        "| net | junctions | pipes | pressures | flows | temperatures, K | not translated | of these wrong | result |",
        "|---|--:|--:|--:|--:|--:|--:|--:|---|",
    ]
    for row in rows:
        cells = [row["name"], *(str(row.get(key, "")) for key in ("nodes", "branches"))]
        cells += [f"{row[key]:.1e}" if key in row else "" for key in ("pressure", "flow")]
        cells.append(f"{row['temperature']:.3f}" if "temperature" in row else "")
        cells += [str(row.get(key, "")) for key in ("untranslated", "problems")]
        out.append("| " + " | ".join([*cells, row["status"].replace("|", "/")]) + " |")
    return "\n".join(out) + "\n"


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--anergy", default="target/release/anergy")
    arguments.add_argument("--out", help="where the table goes")
    options = arguments.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name, build in nets().items():
            rows.append(row := compare(name, build, options.anergy, folder))
            differences = f"{row.get('pressure', math.nan):.1e} {row.get('flow', math.nan):.1e}"
            print(f"{name}: {differences} {row['status']}", flush=True)
    if options.out:
        Path(options.out).write_text(table(rows))
    agreeing = sum(row["status"].startswith("agrees") for row in rows)
    silent = [row["name"] for row in rows if row.get("silent")]
    print(f"{agreeing} of {len(rows)} agree to {AGREES:g}; silent failures: {silent or 'none'}")
    return 0 if agreeing >= WANTED and not silent else 1


if __name__ == "__main__":
    sys.exit(main())
