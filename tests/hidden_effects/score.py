"""Runs `anergy explain` on the cases of a folder and writes the table of what it got right.

    python score.py CASES --anergy target/release/anergy --out docs/src/validation/explain.md

Cases of seeds from 1 000 000 on are for scores that are reported; how often they were scored is counted in reported.csv.
Restartable: a case with a result of this engine (CASES/results-HASH/NAME.json) is not run again. Only this program reads CASES/answers.json.
"""

import argparse
import hashlib
import json
import random
import subprocess
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from table import table

FOR_REPORTS = 1_000_000


# Fields of an effect beside the one that is hidden: the program bends the whole curve of the part load (house.py).
BESIDE = {"G2": lambda x: {"factor_20": 1 + 1.4 * (x - 1), "factor_60": 1 + 0.6 * (x - 1)}}


def oracle(case, anergy, answer):
    """What is left by the model with what is hidden in it, at its true value, driven by the same readings: RMSE of each sensor on what is shown."""
    texts = {"model.toml": "", "sensors.toml": ""}
    for e in answer["effects"]:
        fields = {e["parameter"]: e["value"]} | BESIDE.get(e["id"], lambda _: {})(e["value"])
        texts["sensors.toml" if e["id"][0] == "S" else "model.toml"] += (
            f'\n[[effect]]\nid = "{e["id"]}"\ncomponent = "{e["component"]}"\n' + "".join(f"{k} = {v!r}\n" for k, v in fields.items()))
    with tempfile.TemporaryDirectory() as folder:
        for name, more in texts.items():
            (Path(folder) / name).write_text((case / name).read_text() + more)
        command = [anergy, "explain", Path(folder) / "model.toml", "--compare", "--data", case / "data.csv",
                   "--sensors", Path(folder) / "sensors.toml", "--split", case / "split.toml"]
        done = subprocess.run([str(x) for x in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{case.name} with its true effect: {done.stderr}")
    return {line.split(":")[0]: float(line.split(":")[1].split()[0]) for line in done.stdout.splitlines()}


def run(case, anergy, results, limit_s, answer):
    file = results / f"{case.name}.json"
    if file.exists():
        return
    out = results / case.name
    command = [anergy, "explain", case / "model.toml", "--data", case / "data.csv", "--sensors", case / "sensors.toml",
               "--split", case / "split.toml", "--out", out]
    start = time.monotonic()
    try:
        done = subprocess.run([str(x) for x in command], capture_output=True, text=True, timeout=limit_s)
        problem = done.stderr.strip()[-400:] if done.returncode not in (0, 1) or not (out / "report.json").exists() else ""
    except subprocess.TimeoutExpired:
        problem = f"no answer within {limit_s:.0f} s"
    seconds = time.monotonic() - start
    report = json.loads((out / "report.json").read_text()) if (out / "report.json").exists() and not problem else {}
    keep = {k: report.get(k) for k in ("verdict", "because", "problems", "effects", "class", "show_rmse_before", "show_rmse_after")}
    keep["tried"] = [{k: t[k] for k in ("id", "component", "probability")} for t in report.get("tried", [])]
    keep["z_fitted"] = report.get("show_z_fitted")
    if answer["kind"] == "single":
        keep["oracle"] = oracle(case, anergy, answer)
    explained = out / "model.explained.toml"
    if explained.exists():
        checked = subprocess.run([str(anergy), "check", str(explained)], capture_output=True, text=True)
        keep["explained_checks"] = checked.returncode == 0
    file.write_text(json.dumps(keep | {"seconds": seconds, "problem": problem}))
    print(f"{case.name} {keep['verdict'] or problem[:80]} {seconds:.0f} s", flush=True)


def count(seeds, cases, engine):
    """Writes down that a set for reports was scored; how often it has been."""
    file = Path(__file__).with_name("reported.csv")
    line = f"{time.strftime('%Y-%m-%d')},{seeds[0]},{seeds[-1]},{cases},{engine}"
    lines = file.read_text().splitlines() if file.exists() else ["date,first_seed,last_seed,cases,engine"]
    if line not in lines:
        lines.append(line)
        file.write_text("\n".join(lines) + "\n")
    earlier = [x for x in lines[1:] if int(x.split(",")[1]) <= seeds[-1] and int(x.split(",")[2]) >= seeds[0]]
    return f"{len(earlier)} time{'s' if len(earlier) > 1 else ''}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cases", type=Path)
    parser.add_argument("--anergy", type=Path, default=Path("target/release/anergy"))
    parser.add_argument("--results", help="name of the folder in CASES; default: after the engine, so that another one answers anew")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--parallel", type=int, default=1, help="cases at once; explain itself uses all cores")
    parser.add_argument("--limit-s", type=float, default=180)
    parser.add_argument("--until", default="", help="HH:MM after which no case is begun")
    parser.add_argument("--lot", type=int, default=1, help="seed of the order in which cases are run, so that a score that is cut off is still that of a sample")
    parser.add_argument("--only", default="", help="cases whose name begins so")
    parser.add_argument("--note", default="", help="a sentence more at the head of the page")
    parser.add_argument("--engine", default="", help="revision of anergy, for the count")
    wanted = parser.parse_args()
    of_engine = f"results-{hashlib.sha256(wanted.anergy.read_bytes()).hexdigest()[:8]}"
    results = wanted.cases / (wanted.results or of_engine)
    results.mkdir(exist_ok=True)
    answers = json.loads((wanted.cases / "answers.json").read_text())
    cases = [wanted.cases / name for name in sorted(answers) if name.startswith(wanted.only)]
    random.Random(wanted.lot).shuffle(cases)

    def one(case):
        if not wanted.until or time.strftime("%H:%M") < wanted.until:
            run(case, wanted.anergy.resolve(), results, wanted.limit_s, answers[case.name])

    with ThreadPoolExecutor(wanted.parallel) as pool:
        list(pool.map(one, cases))
    found = {c.name: json.loads((results / f"{c.name}.json").read_text()) for c in cases if (results / f"{c.name}.json").exists()}
    seeds = sorted({answers[name]["seed"] for name in found})
    note = (f"`make explain-score`, {time.strftime('%Y-%m-%d')}, seeds {', '.join(map(str, seeds))}"
            f" ({'for reports' if seeds[0] >= FOR_REPORTS else 'of development'}).")
    if seeds[0] >= FOR_REPORTS:
        note += f" This set was scored {count(seeds, len(found), wanted.engine)}."
    text = table({name: answers[name] for name in found}, found, f"{note} {wanted.note}".strip())
    if wanted.out:
        wanted.out.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
