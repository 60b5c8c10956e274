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


def sweep(model: str, variations: str, members: int, threads: int) -> tuple[float, float, float]:
    """Wall time, time of the processor, s, and peak memory, MB."""
    text = (ROOT / variations).read_text()
    number = next(line for line in text.splitlines() if line.startswith("members"))
    with tempfile.TemporaryDirectory() as folder:
        definition = Path(folder, "variations.toml")
        definition.write_text(text.replace(number, f"members = {members}"))
        command = [arguments.program, "sweep", ROOT / model, definition, "--out", f"{folder}/out", "--threads", str(threads)]
        started = time.perf_counter()
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        wall_s = time.perf_counter() - started
        assert status == 0
        return wall_s, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


cores = os.cpu_count() or 1
print(f"{cores} cores, load average before {os.getloadavg()[0]:.1f}\n")
print("| ensemble | threads | members | wall s | processor s | busy | peak MB |\n|---|---|---|---|---|---|---|")


def row(name: str, model: str, variations: str, members: int, threads: int) -> tuple[float, float]:
    wall_s, used_s, peak_mb = sweep(model, variations, members, threads)
    busy = 100 * used_s / wall_s / threads
    print(f"| {name} | {threads} | {members} | {wall_s:.1f} | {used_s:.1f} | {busy:.0f} % | {peak_mb:.0f} |", flush=True)
    return wall_s, used_s


day = ("three houses, 1 d at 1 s", "examples/three-houses/model.toml", "examples/ensembles/three-houses-day.toml")
one, used = row(*day, arguments.days, 1)
all_, used_all = row(*day, arguments.days, cores)
print(f"\n{cores} threads: {one / all_:.2f} times one thread; {used_all / used:.2f} times the time of the processor")
if arguments.weeks:
    print()
    town = ("town of 500, winter week", "examples/town/model.toml", "examples/ensembles/town-week.toml")
    wall_s, _ = row(*town, arguments.weeks, cores)
    print(f"\n{arguments.weeks} weeks of the town: {wall_s / 60:.1f} min")
