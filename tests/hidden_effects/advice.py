"""Does what `anergy explain` recommends tell the members of a class apart? Measures it, and asks again.

    python advice.py CASES --results NAME --anergy target/release/anergy --out PAGE

Of every case with one hidden effect that was answered by a class (CASES/NAME/*/report.json, as score.py leaves it) the plant and its sensors are
made once more, with their errors, the first recommendation is measured beside (a further sensor; another run: otherwise driven, or with another sensor in
the place of one), and `explain` gets both.
"""

import argparse
import importlib
import json
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from cases import RIGS, make

PROGRAMS = {"the same with half of the flow in its second half": "half", "the same with 20 min without flow in its middle": "hold",
            "the same, 15 K warmer or colder in its second half": "warmer"}
# Nats from which effects are told apart: a recommendation that promises less is none.
TOLD_APART = 3.0
# What the rigs can do otherwise: in the house generators would go on while nothing is drawn.
OTHERWISE = {"R1": {"half", "hold", "warmer"}, "R2": {"half", "warmer"}, "R3": {"warmer"}}


class Again:
    """A draw without what a look at all effects takes: as much as making one of its cases once more needs."""

    def __init__(self, answer):
        module = self.module = importlib.import_module(RIGS[answer["rig"]])
        self.rig = module.draw(np.random.default_rng(answer["seed"]), answer["rich"])
        self.sensors, self.neutral = module.sensors(self.rig), module.neutral(self.rig)
        self.at_s = np.arange(0, module.duration_s(self.rig), self.rig["every_s"])
        self.look = SimpleNamespace(channels=module.simulate(self.rig, [self.neutral]))

    def effect(self, hidden):
        """The entry of an effect as in `cases.Draw`, but for its signature."""
        name = (hidden["id"], hidden["component"], hidden["parameter"])
        for id_, component, parameter, variant, first, range_, zero in self.module.effects(self.rig):
            if (id_, component, parameter) == name:
                return id_, component, parameter, zero, first, range_, variant, None
        zero = 1.0 if hidden["parameter"] == "gain" else 0.0
        return *name, zero, zero + 1.0, None, None, None


def addition(d, rig_name, what):
    """What is measured beside; none where the truth cannot do it."""
    if what in PROGRAMS:
        return {"rig": d.rig | {"otherwise": PROGRAMS[what]}} if PROGRAMS[what] in OTHERWISE[rig_name] else None
    place = "the same with another sensor in the place of "
    if what.startswith(place):
        return {"rig": d.rig, "exchanged": what.removeprefix(place)}
    further = getattr(d.module, "further", lambda *_: None)(d.rig, what.removeprefix("a sensor of ")) if what.startswith("a sensor of ") else None
    return further and {"sensor": further}


def ask(name, answer, what, folder, anergy):
    """What is said with the addition; none where it could not be made."""
    d = Again(answer)
    beside = addition(d, answer["rig"], what)
    if beside is None:
        return None
    rng = np.random.default_rng([answer["seed"], int(name.rsplit("-", 1)[1])])
    hidden = answer["effects"][0]
    case = folder / name
    make(d, case, rng, effects=[(d.effect(hidden), hidden["value"])], edge=answer["edge"], addition=beside)
    command = [anergy, "explain", case / "model.toml", "--data", case / "data.csv", "--sensors", case / "sensors.toml", "--split", case / "split.toml",
               "--out", case / "report"]
    done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    file = case / "report" / "report.json"
    if not file.exists():
        return {"verdict": f"no report: {done.stderr.strip()[-200:]}", "effects": [], "class": []}
    return json.loads(file.read_text())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cases", type=Path)
    parser.add_argument("--results", required=True, help="name of the folder in CASES with the answers")
    parser.add_argument("--anergy", type=Path, default=Path("target/release/anergy"))
    parser.add_argument("--out", type=Path, required=True, help="folder of the cases made; the table goes to OUT/page.md")
    parser.add_argument("--parallel", type=int, default=1)
    wanted = parser.parse_args()
    answers = json.loads((wanted.cases / "answers.json").read_text())
    classes = []
    for name, answer in answers.items():
        file = wanted.cases / wanted.results / name / "report.json"
        report = json.loads(file.read_text()) if answer["kind"] == "single" and file.exists() else {}
        if report.get("verdict") == "class" and report["next_measurements"] and report["next_measurements"][0]["nats"] > TOLD_APART:
            classes.append((name, answer, report))
    wanted.out.mkdir(parents=True, exist_ok=True)

    def one(entry):
        name, answer, report = entry
        start = time.monotonic()
        what = report["next_measurements"][0]["what"]
        again = ask(name, answer, what, wanted.out, wanted.anergy.resolve())
        hidden = tuple(answer["effects"][0][k] for k in ("id", "component"))
        said = again and [(e["id"], e["component"]) for e in again["effects"]]
        alone = bool(said) and again["verdict"] == "named" and said == [hidden]
        head = bool(said) and said[0] == hidden
        print(name, hidden, what, again and again["verdict"], said, f"{time.monotonic() - start:.0f} s", flush=True)
        of = lambda pairs: ", ".join(f"`{i}` {c}" for i, c in pairs)
        row = f"| {name} | {of([hidden])} | {of(report['class'])} | {what} | " + ("not made" if again is None else f"{again['verdict']}: {of(said) or '-'}") + " |"
        return again is not None, alone, head, row

    with ThreadPoolExecutor(wanted.parallel) as pool:
        rows = list(pool.map(one, classes))
    made = [r for r in rows if r[0]]
    text = (f"{len(classes)} classes with advice, {len(made)} repeated with what the first recommendation says: named alone and right {sum(r[1] for r in made)},"
            f" first name right {sum(r[2] for r in made)}.\n\n| case | hidden | class | recommended | then |\n|---|---|---|---|---|\n" + "\n".join(r[3] for r in rows) + "\n")
    (wanted.out / "page.md").write_text(text)
    print(text)


if __name__ == "__main__":
    main()
