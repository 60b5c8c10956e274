"""How busy the cores are, what threads bring, and how much memory ensembles take.

python benches/ensemble/run.py [--days N] [--weeks N] [--program FILE]
"""

import argparse
import os
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parents[2]

parser = argparse.ArgumentParser()
parser.add_argument("--days", type=int, default=1000, help="members of the three houses")
parser.add_argument("--weeks", type=int, default=200, help="members of the town; 0: none")
parser.add_argument("--program", default=ROOT / "target/release/anergy")
arguments = parser.parse_args()


def wanted_s(pid: int, before: dict[str, float]) -> dict[str, float]:
    """Time that each thread that runs members calculated or waited for a core that others had, s."""
    for task in Path(f"/proc/{pid}/task").glob("*"):
        if task.name == str(pid):
            continue
        try:
            running_ns, waiting_ns, _ = (task / "schedstat").read_text().split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        before[task.name] = (int(running_ns) + int(waiting_ns)) / 1e9
    return before


def sweep(model: str, variations: str, members: int, threads: int) -> tuple[float, float, float, float]:
    """Wall time, time of the processor, time that a core was used or wanted, s, and peak memory, MB."""
    text = (ROOT / variations).read_text()
    number = next(line for line in text.splitlines() if line.startswith("members"))
    with tempfile.TemporaryDirectory() as folder:
        definition = Path(folder, "variations.toml")
        definition.write_text(text.replace(number, f"members = {members}"))
        command = [arguments.program, "sweep", ROOT / model, definition, "--out", f"{folder}/out", "--threads", str(threads)]
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wanted: dict[str, float] = {}
        ended = 0
        while ended == 0:
            wanted = wanted_s(process.pid, wanted)
            time.sleep(0.05)
            ended, status, used = os.wait4(process.pid, os.WNOHANG)
        wall_s = time.perf_counter() - started
        assert status == 0
        return wall_s, used.ru_utime + used.ru_stime, sum(wanted.values()), used.ru_maxrss / 1024


cores = os.cpu_count() or 1
print(f"{cores} cores, load average before {os.getloadavg()[0]:.1f}\n")
print("| ensemble | threads | members | wall s | processor s | busy | busy or waiting for a core | peak MB |\n|---|---|---|---|---|---|---|---|")


def row(name: str, model: str, variations: str, members: int, threads: int) -> tuple[float, float]:
    wall_s, used_s, wanted_s, peak_mb = sweep(model, variations, members, threads)
    busy, wanted = (f"{100 * share_s / wall_s / threads:.0f} %" for share_s in (used_s, wanted_s))
    print(f"| {name} | {threads} | {members} | {wall_s:.1f} | {used_s:.1f} | {busy} | {wanted} | {peak_mb:.0f} |", flush=True)
    return wall_s, used_s


day = ("three houses, 1 d at 1 s", "examples/three-houses/model.toml", "examples/ensembles/three-houses-day.toml")
town = ("town of 500, winter week", "benches/ensemble/town-week-model.toml", "examples/ensembles/town-week.toml")
for study, members in ((day, arguments.days), (town, arguments.weeks)):
    if members > 0:
        one, used = row(*study, members, 1) if study is day else (0.0, 0.0)
        all_, used_all = row(*study, members, cores)
        if study is day:
            told = f"{one / all_:.2f} times one thread by wall time; {used_all / used:.3f} times the time of the processor"
            print(f"\n{cores} threads: {told}\n\n| | | | | | | | |\n|---|---|---|---|---|---|---|---|")
        else:
            print(f"\n{members} weeks of the town: {all_ / 60:.1f} min; {used_all / members:.2f} s of the processor each")
