"""What experts found in the laboratory, as fixed cases: does `explain` find it too, and does it leave alone what is not there?

    python stories.py OUT --anergy target/release/anergy --out docs/src/validation/explain-stories.md

Fails where a story that was once told right is told wrong.
"""

import argparse
import json
import time
from pathlib import Path

import numpy as np

import rig1
import rig2
import rig3
from cases import Draw, make
from score import run
from table import head, named, pairs_of

# Name, rig, more of the rig, effect and its place, its value, what must be found; None: the model has it right.
STORIES = [
    ("water through the idle boiler", rig2, {"pump": False}, "H1", "small_branch", 0.35),
    ("the large boiler draws water through the small one", rig2, {"pump": False}, "H2", "small_branch", 0.15),
    ("water below the port mixed by what leaves", rig2, {"pump": True}, "T3", "storage", 0.3),
    ("a model that conducts too much along the storage", rig2, {"pump": True, "conductivity": 10.0}, "T2", "storage", 0.0644),
    ("a start twice as long", rig2, {"pump": True}, "G3", "heat_pump", 2.0),
    ("efficiency at part load", rig2, {"pump": False}, "G2", "small", 0.85),
    ("auxiliary heater of 9 % less", rig2, {"pump": True}, "G6", "heat_pump", 0.91),
    ("de-icing", rig2, {"pump": True}, "G4", "heat_pump", 5000.0),
    ("a pump that is nearly dead-headed", rig3, {"heads": True}, "H3", "pump1", 0.8),
    ("a cold plug: water cools while it stands", rig1, {"pauses": [0, 1, 2, 3, 5, 7, 10]}, "P5", "far", 4.5),
    ("conduction along the storage that does not matter", rig2, {"pump": True}, None, "conductivity", 2.0),
]


def told(place, story, number):
    """Writes the case; what has to be known of it."""
    name, rig, kind, id_, component, value = story
    for seed in range(500 + 20 * number, 520 + 20 * number):
        if rig is not rig2 or bool(np.random.default_rng(seed).random() < 0.5) == kind["pump"]:
            break
    d = Draw(rig, seed, True, **kind)
    rng = np.random.default_rng([seed, number])
    if id_ is None:
        make(d, place, rng, unknown={component: value})
        signature = d.look.of(rig.simulate(d.rig, [d.neutral, d.neutral | {component: value}]), 1)
        return {"story": name, "truth": None, "gain": d.look.gain(signature)}
    effect = next(e for e in d.effects if e[:2] == (id_, component))
    make(d, place, rng, effects=[(effect, value)])
    signature = d.seen(effect, value)
    return {"story": name, "truth": [id_, component], "parameter": effect[2], "value": value, "gain": d.gain(effect, value), "class": d.together(effect, signature)}


def judged(a, r):
    """Right, partly, or wrong, and what was said."""
    said = ", ".join(f"{i} {c}" for i, c in ([tuple(x) for x in r.get("class") or []] or pairs_of(r.get("effects")))) or "-"
    if a["truth"] is None:
        return "right" if r["verdict"] == "nothing" else "wrong", said
    if not named(r):
        return "wrong", said
    if head(r) in [tuple(x) for x in a["class"]]:
        return "right", said
    return ("partly" if tuple(a["truth"]) in [tuple(x) for x in r.get("class") or []] + pairs_of(r["effects"]) else "wrong"), said


def row(a, r):
    how, said = judged(a, r)
    value = "-"
    e = next((e for e in r.get("effects") or [] if a["truth"] == [e["id"], e["component"]]), None)
    if e and a["parameter"] in e["params"]:
        p = e["params"][a["parameter"]]
        value = f"{a['value']:.4g}: {p['value']:.3g} ({p['lo']:.3g} to {p['hi']:.3g})"
    before, after = r.get("show_rmse_before") or {}, r.get("show_rmse_after") or {}
    most = max(before, key=lambda c: before[c] / max(after[c], 1e-12), default=None) if after else None
    gap = f"{most}: {before[most]:.3g} to {after[most]:.3g}" if most and before[most] > after[most] else "-"
    truth = " ".join(a["truth"]) if a["truth"] else "nothing"
    return f"| {a['story']} | {truth} | {r['verdict'] or 'no answer'} | {said} | {value} | {gap} | {how} | {r['seconds']:.0f} |"


HEAD = """# Stories of the laboratory

What experts found when they compared measurements of the laboratory with simulations, hidden in data of the
[independent program](explain.md) with errors of sensors and tolerances, rich sensors. "Right": the verdict names an effect of the true class (for the
last one: nothing). "Partly": the true one is in the set, not first. The largest gap that was closed is that of samples nobody fitted.

"""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("--anergy", type=Path, default=Path("target/release/anergy"))
    parser.add_argument("--out", dest="page", type=Path)
    parser.add_argument("--must", default="", help="stories that must be right or partly right, numbers from 1")
    parser.add_argument("--only", default="")
    parser.add_argument("--write-only", action="store_true", help="write the cases, run nothing")
    wanted = parser.parse_args()
    results = wanted.out / "results"
    results.mkdir(parents=True, exist_ok=True)
    rows, wrong = [], []
    chosen = {int(x) for x in wanted.only.split(",") if x}
    for number, story in enumerate(STORIES, 1):
        if chosen and number not in chosen:
            continue
        place = wanted.out / f"story-{number:02d}"
        answer = told(place, story, number)
        (wanted.out / f"story-{number:02d}.json").write_text(json.dumps(answer))
        print(place.name, answer, flush=True)
        if wanted.write_only:
            continue
        (results / f"{place.name}.json").unlink(missing_ok=True)
        run(place, wanted.anergy.resolve(), results, 600, {"kind": "story"})
        result = json.loads((results / f"{place.name}.json").read_text())
        rows.append(row(answer, result))
        print(rows[-1], flush=True)
        if str(number) in wanted.must.split(",") and judged(answer, result)[0] == "wrong":
            wrong.append(story[0])
    table = ["| story | hidden | verdict | said | value, fitted (95 %) | largest gap closed | | s |", "|---|---|---|---|---|---|---|--:|", *rows]
    if wanted.page:
        wanted.page.write_text(HEAD + "\n".join(table) + f"\n\nWritten by `make explain-stories`, {time.strftime('%Y-%m-%d')}.\n")
    if wrong:
        raise SystemExit(f"told wrong: {'; '.join(wrong)}")


if __name__ == "__main__":
    main()
