"""What can go wrong, with the numbers; every error of the package is an `AnergyError`.

Exceptions: files raise `OSError` and its like, Ctrl-C raises `Interrupted` (a `KeyboardInterrupt`),
impossible arguments raise `ValueError` and `TypeError`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypedDict

if TYPE_CHECKING:
    from anergy._core import Result
    from anergy.ensembles import Ensemble


class Problem(TypedDict):
    """One problem of a model."""

    message: str
    """What is wrong, naming the culprit and the numbers."""
    hint: str | None
    """What to do about it."""
    line: int | None
    """Line of the model text, from 1; None for dicts and what has no place."""
    column: int | None
    """Column of the model text, from 1."""


class AnergyError(Exception):
    """Any error of this package."""


class ModelError(AnergyError):
    """The model is wrong; its text lists all problems with file, line and hint.

    >>> import anergy
    >>> try:
    ...     anergy.Model.from_toml("format = 1\\n[run]\\nuntill = '1h'")
    ... except anergy.ModelError as error:
    ...     print(error)
    ...     print(error.problems[0]["line"])
    line 3, column 1: [run]: unknown field `untill`
        hint: did you mean `until`?
    3
    """

    problems: list[Problem]

    def __init__(self, message: str, problems: Sequence[Problem] = ()) -> None:
        super().__init__(message)
        self.problems = list(problems)


class RunError(AnergyError):
    """A run or a solve cannot go on."""

    time: str | None = None
    """Simulated time in words, for example "1h 3m 20s"."""
    component: str | None = None
    """The component that failed."""
    result: Result | None = None
    """What a run recorded until then."""


class ConvergenceError(RunError):
    """The numerics did not converge; fields that do not apply are None."""

    iterations: int | None = None
    """Iterations done."""
    residual_pa: float | None = None
    """How much the edge `component` misses its law, Pa."""
    node: str | None = None
    """The node with the largest mass residual."""
    mass_residual_kg_s: float | None = None
    """How much it misses its mass balance, kg/s."""


class UnknownNameError(AnergyError, KeyError):
    """A channel, signal or parameter that does not exist; the text has the most similar name."""

    name: str
    """What was asked for."""

    def __init__(self, message: str, name: str = "") -> None:
        super().__init__(message)
        self.name = name

    def __str__(self) -> str:
        # A KeyError would show its text in quotes.
        return str(self.args[0])


class OutOfRangeError(AnergyError, ValueError):
    """A value that a signal cannot have."""

    signal: str
    """The signal."""
    value: float
    """What was asked for, SI."""
    min: float
    """Smallest value, SI."""
    max: float
    """Largest value, SI."""

    def __init__(
        self,
        message: str,
        signal: str = "",
        value: float = float("nan"),
        min: float = float("-inf"),
        max: float = float("inf"),
    ) -> None:
        super().__init__(message)
        self.signal = signal
        self.value = value
        self.min = min
        self.max = max


class SnapshotError(AnergyError, ValueError):
    """A snapshot of another model, or torn."""


class RecordingError(AnergyError):
    """A file that is not a recording of this program."""


class WorkersLost(AnergyError):
    """Processes that ran members of `anergy.ensemble` are gone; `result` has what was there until then."""

    result: Ensemble

    def __init__(self, message: str, result: Ensemble) -> None:
        super().__init__(message, result)
        self.result = result

    def __str__(self) -> str:
        return str(self.args[0])


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during `Model.simulate` or `anergy.ensemble`; `result` has what was there until then.

    In an interactive session it is found as `sys.last_value.result`.
    """

    result: Any

    def __init__(self, message: str, result: Result | Ensemble) -> None:
        super().__init__(message, result)
        self.result = result

    def __str__(self) -> str:
        return str(self.args[0])
