"""Pictures of ensembles; matplotlib is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from anergy._export import new_axes
from anergy._units import hours

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from anergy.ensembles import Ensemble

BANDS = ((0.05, 0.95, 0.2), (0.25, 0.75, 0.35))
"""Lower and upper quantile of the bands, and how dark they are."""
COLOUR = "#2a78b8"


def quantiles(ensemble: Ensemble, channel: str, ax: Axes | None) -> Axes:
    """Median and bands of a channel over time."""
    time_s, values = ensemble.channel(channel)
    axes = ax or new_axes()
    seconds, unit = hours(float(time_s[-1])) if len(time_s) else (1.0, "s")
    for low, high, alpha in BANDS:
        lower, upper = np.nanquantile(values, [low, high], axis=0)
        label = f"{100 * (high - low):.0f} % of the members"
        axes.fill_between(time_s / seconds, lower, upper, color=COLOUR, alpha=alpha, linewidth=0, label=label)
    axes.plot(time_s / seconds, np.nanmedian(values, axis=0), color=COLOUR, label="median")
    axes.set_xlabel(f"time in {unit}")
    axes.set_ylabel(channel)
    axes.legend(frameon=False, fontsize=9)
    return axes


def distribution(ensemble: Ensemble, kpis: Sequence[str], ax: Axes | None) -> Axes:
    """Distribution functions of indicators."""
    axes = ax or new_axes()
    for name in kpis:
        values = np.asarray(ensemble[name], dtype=float)
        values = np.sort(values[np.isfinite(values)])
        axes.step(values, np.arange(1, len(values) + 1) / max(len(values), 1), where="post", label=name)
    axes.set_ylabel("share of the members")
    if len(kpis) == 1:
        axes.set_xlabel(kpis[0])
    else:
        axes.legend(frameon=False, fontsize=9)
    return axes
