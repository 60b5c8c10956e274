"""1 000 days of the three houses in threads, processes and on two workers of Dask: the same numbers bit for bit.

python benches/ensemble/same.py        needs pip install anergy[parallel]
"""

from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import anergy
import numpy as np
from dask.distributed import Client, LocalCluster

ROOT = Path(__file__).parents[2]


def main() -> None:
    model = anergy.Model.from_file(ROOT / "examples/three-houses/model.toml")
    definition = anergy.Variations.from_file(ROOT / "examples/ensembles/three-houses-day.toml").to_dict()
    definition["run"] |= {"step": "60s"}
    threads = anergy.ensemble(model, definition)
    with ProcessPoolExecutor() as pool:
        others = {"processes": anergy.ensemble(model, definition, pool)}
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        Client(cluster) as client,
    ):
        others["Dask"] = anergy.ensemble(model, definition, client)
    for name, other in others.items():
        assert list(threads.table) == list(other.table)
        for column in threads.table:
            np.testing.assert_array_equal(threads[column], other[column], err_msg=f"{name}: {column}")
    print(f"{len(threads)} members, {len(threads.kpis)} indicators: the same bits in threads, {' and '.join(others)}")


if __name__ == "__main__":
    main()
