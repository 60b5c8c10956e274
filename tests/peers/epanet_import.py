"""`anergy import epanet` against EPANET: every input file that the PyPI packages wntr and epyt bring.

EPANET (owa-epanet) solves each network at t = 0 with the tightest accuracy; anergy imports and solves the
same file. Writes a table of the differences; ends with 1 when fewer than 30 networks agree or one fails
without saying so.

    .venv-peers/bin/python tests/peers/epanet_import.py --anergy target/release/anergy
"""

from __future__ import annotations

import argparse
import datetime
import importlib.metadata
import json
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import warnings
from pathlib import Path

from epanet import toolkit as en

# Networks that agree to this share of the head span and of the largest flow are counted.
AGREES = 1e-3
# What EPANET lets through a closed link.
CLOSED_LINK_M3_S = 2e-7
WANTED = 30
TRIALS = 1000
LARGEST = 16_000
FLOW_M3_S = {
    en.CFS: 0.028316846592,
    en.GPM: 3.785411784e-3 / 60,
    en.MGD: 3785.411784 / 86400,
    en.IMGD: 4546.09 / 86400,
    en.AFD: 43560 * 0.028316846592 / 86400,
    en.LPS: 1e-3,
    en.LPM: 1e-3 / 60,
    en.MLD: 1e3 / 86400,
    en.CMH: 1 / 3600,
    en.CMD: 1 / 86400,
}
LAWS = {0: "H-W", 1: "D-W", 2: "C-M"}


def epanet(file: Path, folder: str) -> dict:
    """Heads in m and flows in m3/s of EPANET at t = 0."""
    project = en.createproject()
    try:
        en.open(project, str(file), f"{folder}/x.rpt", f"{folder}/x.out")
        units = en.getflowunits(project)
        law = LAWS[int(en.getoption(project, en.HEADLOSSFORM))]
        for option, value in ((en.ACCURACY, 1e-8), (en.TRIALS, TRIALS), (en.HEADERROR, 1e-6)):
            en.setoption(project, option, value)
        en.openH(project)
        en.initH(project, 0)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            en.runH(project)
        length = 0.3048 if units <= en.AFD else 1.0
        heads = {
            en.getnodeid(project, i): en.getnodevalue(project, i, en.HEAD) * length
            for i in range(1, en.getcount(project, en.NODECOUNT) + 1)
        }
        flows, closed = {}, 0
        for i in range(1, en.getcount(project, en.LINKCOUNT) + 1):
            flow = en.getlinkvalue(project, i, en.FLOW) * FLOW_M3_S[units]
            flows[en.getlinkid(project, i)] = flow
        error = en.getstatistic(project, en.RELATIVEERROR)
        iterations = en.getstatistic(project, en.ITERATIONS)
        en.closeH(project)
    finally:
        en.deleteproject(project)
    return {
        "heads": heads,
        "flows": flows,
        "law": law,
        "error": error,
        "iterations": iterations,
        "warnings": [" ".join(str(warning.message).split()) for warning in caught],
    }


def anergy(program: str, file: Path, folder: str, *options: str) -> dict:
    """Heads, flows and notes of anergy; `failed` where it says that it cannot."""
    model, result = Path(folder, "model.toml"), Path(folder, "steady.json")
    for path in (model, result):
        path.unlink(missing_ok=True)
    command = [program, "import", "epanet", str(file), "--steady", "--out", str(model), *options]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=900)
    if run.returncode:
        return {"failed": "import", "message": run.stderr.strip()}
    text = model.read_text()
    notes = [line[2:] for line in text.splitlines() if line.startswith("# ")][1:]
    command = [program, "solve", str(model), "--json", str(result)]
    run = subprocess.run(command, capture_output=True, text=True, check=False, timeout=900)
    if run.returncode:
        return {"failed": "solve", "message": run.stderr.strip(), "notes": notes}
    parsed = tomllib.loads(text)
    density, gravity = parsed["fluid"]["density_kg_m3"], parsed["model"]["gravity"]
    steady = json.loads(result.read_text())
    return {
        "heads": {n["id"]: n["elevation_m"] + n["p_pa"] / density / gravity for n in steady["nodes"]},
        "flows": {e["id"]: e["m_flow_kg_s"] / density for e in steady["edges"]},
        "notes": notes,
    }


def compare(name: str, program: str, file: Path, folder: str) -> dict:
    row = {"name": name}
    try:
        theirs = epanet(file, folder)
    except Exception as error:
        row["status"] = "EPANET rejects it: " + " ".join(str(error).split())
        ours = anergy(program, file, folder)
        row["status"] += "; anergy " + ("too" if "failed" in ours else "does not")
        return row
    row.update(law=theirs["law"], nodes=len(theirs["heads"]), links=len(theirs["flows"]))
    row["warnings"] = theirs["warnings"]
    if len(theirs["flows"]) > LARGEST:
        row["status"] = "too large"
        return row
    ours = anergy(program, file, folder)
    if ours.get("failed") == "solve":
        # Ideal valves that work against each other: self-acting ones come to rest.
        again = anergy(program, file, folder, "--self-acting")
        if "failed" not in again:
            ours, row["self_acting"] = again, True
    row["notes"] = ours.get("notes", [])
    row["problems"] = sum(note.startswith("problem") for note in row["notes"])
    row["untranslated"] = sum(note.startswith(("problem", "not translated")) for note in row["notes"])
    if "failed" in ours:
        lines = ours["message"].splitlines()
        row["message"] = ours["message"]
        first = lines[0].replace(str(file), file.name) if lines else ""
        row["status"] = f"{ours['failed']} fails: {first}"
        if not lines:
            row["silent"] = True
        return row
    common = [node for node in theirs["heads"] if node in ours["heads"]]
    span = max(theirs["heads"][n] for n in common) - min(theirs["heads"][n] for n in common)
    largest = max(map(abs, theirs["flows"].values())) or 1e-6
    worst_head = max(common, key=lambda n: abs(theirs["heads"][n] - ours["heads"][n]))
    difference = {k: abs(q - ours["flows"].get(k, 0.0)) for k, q in theirs["flows"].items()}
    worst_flow = max(difference, key=difference.get)
    row["head"] = abs(theirs["heads"][worst_head] - ours["heads"][worst_head]) / max(span, 1e-3)
    row["flow"] = difference[worst_flow] / largest
    row["worst"] = f"{worst_head}, {worst_flow}"
    row["left_out"] = len(theirs["heads"]) - len(common)
    flows = difference[worst_flow] <= max(AGREES * largest, CLOSED_LINK_M3_S)
    agrees = row["head"] <= AGREES and flows
    row["status"] = "agrees" if agrees else "differs"
    if "self_acting" in row:
        row["status"] += " (with --self-acting)"
    if theirs["iterations"] > TRIALS:
        row["status"] = f"EPANET does not converge in {TRIALS} trials; {row['status']}"
    # A difference without a note is a failure that nobody is told of.
    row["silent"] = not agrees and not row["problems"] and not row["warnings"]
    return row


# Why networks fail or differ where the message does not say it.
REASONS = """
Where `solve` fails with ideal pressure valves the import is repeated with `--self-acting`.

- anytown-exeter, Anytown (wntr), gessler1985, hanoi-exeter: templates of design problems. Their pipes to be sized
  have 0.0001 to 0.0025 mm; demands lie behind them, and no pressure that means anything drives them. EPANET gives
  heads below minus 1e24 m.
- ky15: its ideal sustaining valves determine each other. With `--self-acting` all flows agree to 1e-3; behind closed valves
  (J-328, J-394, J-465 and others) nothing determines the heads, and they differ.
- ky9, ky10, ky11, ky12, Richmond_standard, MICROPOLIS: EPANET switches a valve or a pump to and fro for 1000 trials;
  what it leaves there is no solution to compare with.
- prv_closed_no_upstream_sources: valve and pump are closed in EPANET, and the demands beyond them have heads of
  minus 8e6 m.
"""


def table(rows: list[dict], command: str) -> str:
    agreeing = [row for row in rows if row["status"].startswith("agrees")]
    versions = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("wntr", "epyt", "owa-epanet")
    )
    out = [
        "# EPANET networks, imported and solved",
        "",
        f"Every input file in the PyPI packages wntr and epyt ({versions}), read with `anergy import epanet`"
        " and solved with `anergy solve`, against EPANET itself at t = 0. Heads: largest difference over the"
        " span of all heads; flows: largest difference over the largest flow; not translated: entries that"
        " the import lists as such, of them those that change results.",
        "",
        f"{datetime.date.today()}, `{command}`: {len(agreeing)} of {len(rows)} agree to {AGREES:g}.",
        "",
        "| network | nodes | links | law | heads | flows | not translated | of these wrong | result |",
        "|---|--:|--:|---|--:|--:|--:|--:|---|",
    ]
    for row in rows:
        number = lambda key: f"{row[key]:.1e}" if key in row else ""
        cells = [
            row["name"],
            str(row.get("nodes", "")),
            str(row.get("links", "")),
            row.get("law", ""),
            number("head"),
            number("flow"),
            str(row.get("untranslated", "")),
            str(row.get("problems", "")),
            row["status"] + (f"; {row['warnings'][0]}" if row.get("warnings") else ""),
        ]
        out.append("| " + " | ".join(cell.replace("|", "/") for cell in cells) + " |")
    return "\n".join(out) + "\n" + REASONS


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--anergy", default="target/release/anergy")
    arguments.add_argument("--out", help="where the table goes")
    arguments.add_argument("--only", default="", help="part of a name")
    options = arguments.parse_args()
    site = Path(sysconfig.get_paths()["purelib"])
    files = sorted(file for package in ("wntr", "epyt") for file in (site / package).rglob("*.inp"))
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for file in files:
            name = str(file.relative_to(site))
            if options.only not in name:
                continue
            row = compare(name, options.anergy, file, folder)
            rows.append(row)
            differences = f"{row.get('head', float('nan')):.1e} {row.get('flow', float('nan')):.1e}"
            print(f"{name}: {differences} {row['status']} {row.get('worst', '')}", flush=True)
            if options.only and "message" in row:
                print(row["message"])
            if options.only:
                print("\n".join(row.get("notes", [])[:40]), row.get("warnings"))
    if options.out:
        Path(options.out).write_text(table(rows, "make peers"))
    agreeing = sum(row["status"].startswith("agrees") for row in rows)
    silent = [row["name"] for row in rows if row.get("silent")]
    print(f"{agreeing} of {len(rows)} agree to {AGREES:g}; silent failures: {silent or 'none'}")
    return 0 if options.only or (agreeing >= WANTED and not silent) else 1


if __name__ == "__main__":
    sys.exit(main())
