"""Members of an ensemble in executors: processes, threads of Python, clusters."""

from __future__ import annotations

import hashlib
import inspect
import os
import pickle
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from typing import Any

import numpy as np

from anergy._core import Model, Variations, _Members
from anergy.controller import Controller
from anergy.errors import AnergyError

Controllers = Sequence[Controller] | Callable[[], Sequence[Controller]] | None

TASKS_PER_WORKER = 8
"""Members are sent in parts; a worker that is late holds the others up by one of about so many."""
LARGEST_PART = 32
"""Members in one task at most: their results travel together."""


def run(
    model: Model,
    variations: Variations,
    members: Sequence[int],
    executor: Executor | Any | None,
    workers: int | None,
    controllers: Controllers,
    each: Callable[[list[Any]], None],
) -> None:
    """Hands parts of the members to an executor, and what comes back to `each`."""
    if executor is None:
        with ProcessPoolExecutor(workers) as own:
            run(model, variations, members, own, workers, controllers, each)
        return
    count = workers or _workers(executor)
    # A client of Dask makes an executor itself; the same function and arguments are no reason not to run again.
    pool: Executor = executor.get_executor(pure=False) if hasattr(executor, "get_executor") else executor
    # Controllers apart: each member has its own, as they were when the ensemble was started.
    own_controllers = None if controllers is None else pickle.dumps(controllers)
    ensemble = pickle.dumps((model, variations))
    size = max(1, min(LARGEST_PART, len(members) // (TASKS_PER_WORKER * count)))
    parts = [list(members[i : i + size]) for i in range(0, len(members), size)]
    parts.reverse()
    running: set[Future[list[Any]]] = set()
    try:
        while parts or running:
            # So many wait that no worker is idle, and not so many that their results fill the memory.
            while parts and len(running) < 3 * count:
                running.add(pool.submit(run_part, ensemble, own_controllers, parts.pop()))
            done, running = wait(running, timeout=0.2, return_when=FIRST_COMPLETED)
            # What has finished is kept before the first one that broke is raised.
            broken = [error for error in (future.exception() for future in done) if error is not None]
            each([outcome for future in done if future.exception() is None for outcome in future.result()])
            if broken:
                raise broken[0]
    finally:
        for future in running:
            future.cancel()


def _workers(executor: Any) -> int:
    if hasattr(executor, "nthreads"):
        return max(1, sum(int(count) for count in executor.nthreads().values()))
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)


_lock = threading.Lock()
_last: tuple[bytes, _Members] | None = None
"""What this worker has loaded last: it is the same for all parts of an ensemble. Threads of a pool share it."""


def _loaded(ensemble: bytes) -> _Members:
    global _last
    with _lock:
        if _last is None or _last[0] != ensemble:
            _last = (ensemble, _Members(*pickle.loads(ensemble)))
        return _last[1]


def run_part(ensemble: bytes, controllers: bytes | None, members: list[int]) -> list[Any]:
    """Runs members one after the other; called in the workers."""
    loaded = _loaded(ensemble)
    outcomes: list[Any] = []
    if controllers is None:
        loaded.run(members, 1, outcomes.extend)
        return outcomes
    return [_with_controllers(loaded, member, controllers) for member in members]


def _with_controllers(loaded: _Members, member: int, controllers: bytes) -> Any:
    """A member with controllers in Python: as `_Members.run` gives it."""
    values = loaded.values(member)
    nothing: list[Any] = []
    try:
        given: Any = pickle.loads(controllers)
        own = given() if callable(given) else given
        result = loaded.model(member).simulate(**loaded.options(), controllers=own)
    except AnergyError as error:
        return member, values, str(error), {}, np.array([]), nothing
    except Exception as error:
        return member, values, f"{type(error).__name__}: {error}", {}, np.array([]), nothing
    kpis = loaded.indicators(result.summary["kpis"])
    if not loaded.channels:
        return member, values, None, kpis, np.array([]), nothing
    # Copies: views would keep all channels of the run.
    columns = [result[name].copy() for name in loaded.channels]
    return member, values, None, kpis, result.time_s.copy(), columns


def told(controllers: Controllers) -> str | None:
    """Names of controllers with a hash of their state and code: other ones give other results."""
    if controllers is None:
        return None
    kinds: list[Any] = [controllers] if callable(controllers) else [type(own) for own in controllers]
    # Twice: the first time, texts that are equal but not the same are written out again.
    state = hashlib.sha256(pickle.dumps(pickle.loads(pickle.dumps(controllers))))
    for kind in kinds:
        state.update(_source(kind))
    names = [f"{kind.__module__}.{kind.__qualname__}" if hasattr(kind, "__qualname__") else repr(type(kind)) for kind in kinds]
    return f"{', '.join(names)} {state.hexdigest()}"


def _source(kind: Any) -> bytes:
    try:
        return inspect.getsource(kind).encode()
    except (OSError, TypeError):
        # Written at a prompt.
        return b""
