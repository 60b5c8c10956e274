"""Draws blocking margins, modes and maps with matplotlib, which is imported when it is asked for."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from anergy._export import new_axes
from anergy._units import shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from anergy.stability import BlockingMap, Mode
    from anergy.steady import Table

BLUE, RED, GREY, GREEN = "#0068ac", "#cf5500", "#6b7480", "#008f69"
LOOK = {"present": (BLUE, "-", 2.0), "threshold": (RED, "--", 1.5), "full": (GREY, ":", 1.5)}
AREAS = ("#f2f4f6", "#f4a582", "#92c5de", "#c2a5cf", "#a6dba0", "#fee08b", "#bababa", "#e9a3c9")


def mode(mode: Mode, ax: Axes | None) -> Axes:
    """Share of each controller, with the sign of the cosine of its phase."""
    axes = ax or new_axes()
    ids = list(mode.participation)
    against = [np.cos(np.radians(mode.phase_deg.get(id, 0.0))) < 0 for id in ids]
    percents = [
        100 * mode.participation[id] * (-1 if down else 1)
        for id, down in zip(ids, against, strict=True)
    ]
    bars = axes.bar(ids, percents, color=[RED if down else BLUE for down in against], width=0.6)
    labels = [f"{abs(p):.0f} %\n{mode.phase_deg.get(id, 0.0):.0f}°" for id, p in zip(ids, percents)]
    axes.bar_label(bars, labels, padding=3, fontsize=9)
    axes.axhline(0, color="black", linewidth=0.8)
    largest = max(map(abs, percents), default=1.0)
    axes.set_ylim(-1.35 * largest, 1.35 * largest)
    axes.set_ylabel("share of the mode in %\n(up swings against down)")
    if len(ids) > 6:
        axes.tick_params(axis="x", labelrotation=60)
    how = "grows" if mode.grows else "decays"
    twins = f", {mode.multiplicity} equal ones" if mode.multiplicity > 1 else ""
    title = f"period {mode.period_s:.1f} s, {how} by {abs(mode.growth_per_s):.3f}/s{twins}"
    axes.set_title(title, fontsize=10)
    return axes


def feeders(table: Table, ax: Axes | None) -> Axes:
    """Present speed and threshold of every feeder."""
    axes = ax or new_axes(height=1.4 + 0.45 * len(table.ids))
    y = np.arange(len(table.ids))
    speed, threshold = table["speed"], table["threshold_speed"]
    stuck = table["blocked"] | table["held_back"]
    axes.barh(y, table["speed_max"], height=0.5, color="#eceff2", label="up to full speed")
    axes.hlines(y, threshold, speed, color=[RED if s else GREEN for s in stuck], linewidth=5)
    axes.scatter(threshold, y, marker="|", s=260, linewidth=2.5, color="black", label="blocked below")
    axes.scatter(speed, y, s=55, color=[RED if s else GREEN for s in stuck], zorder=3, label="present speed")
    end = float(np.nanmax([*table["speed_max"], *speed, *threshold]))
    for i, id in enumerate(table.ids):
        by = f" by {table['blocked_by'][i]}" if table["blocked_by"][i] else ""
        word = "blocked" if table["blocked"][i] else "held back" if table["held_back"][i] else "free"
        margin = table["margin_speed"][i]
        number = f", margin {margin:+.3f}" if np.isfinite(margin) else ""
        axes.text(0.015 * end, i + 0.3, f"{id}: {word}{by}{number}", fontsize=9, va="bottom")
    axes.set_yticks([])
    axes.set_ylim(-0.5, len(table.ids) - 0.1)
    axes.invert_yaxis()
    for text in axes.texts:
        text.set_y(text.get_position()[1] - 0.6)
    axes.set_ylim(len(table.ids) - 0.6, -0.75)
    axes.set_xlim(0, 1.04 * end)
    axes.set_xlabel("relative speed")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 1.14 if len(y) > 3 else 1.25), ncols=3, frameon=False, fontsize=9)
    return axes


def pump(found: Mapping[str, Any], density_kg_m3: float, ax: Axes | None) -> Axes:
    """Head of a pump and what the network opposes over its flow."""
    axes = ax or new_axes()
    margin, opposing = found["margin"], found["opposing"]
    look = shown("kg s-1", density_kg_m3)
    for curve in found["curves"]:
        colour, style, width = LOOK[curve["at"]]
        flow, head = np.array(curve["m_flow_kg_s"]), np.array(curve["head_pa"]) / 1e5
        label = {
            "present": "pump at its speed",
            "threshold": "at the threshold",
            "full": "at full speed",
        }[curve["at"]]
        keep = head >= 0
        axes.plot(
            look.of(flow[keep]), head[keep], style, color=colour, linewidth=width,
            label=f"{label}, {curve['speed']:.3f}",
        )
    if opposing["dp_pa"]:
        axes.plot(
            look.of(opposing["m_flow_kg_s"]), np.array(opposing["dp_pa"]) / 1e5,
            color="black", linewidth=1.8, label="what the network opposes",
        )
        axes.plot(0, margin["opposing_dp_pa"] / 1e5, "s", color=RED, markersize=6, clip_on=False, zorder=4)
    axes.plot(
        float(look.of(max(0.0, margin["m_flow_kg_s"]))), found["head_pa"] / 1e5, "o", color=BLUE,
        markersize=8, clip_on=False, zorder=5, label="operating point",
    )
    wanted = margin.get("requested_m_flow_kg_s")
    if wanted:
        axes.axvline(float(look.of(wanted)), color=GREEN, linewidth=1, linestyle="-.", label="requested flow")
    axes.set_xlim(left=0)
    low, high = axes.get_ylim()
    # Flat curves far above zero need a closer look.
    axes.set_ylim(bottom=low if low > 0.5 * high else 0)
    axes.set_xlabel(look.label("flow"))
    axes.set_ylabel("head in bar")
    by = f" by {margin['blocked_by']}" if margin["blocked_by"] else ""
    word = "blocked" if margin["blocked"] else "held back" if margin["held_back"] else "free"
    axes.set_title(f"{margin['id']}: {word}{by}", fontsize=10)
    axes.legend(fontsize=9)
    return axes


def blocking_map(grid: BlockingMap, ax: Axes | None) -> Axes:
    """Who is blocked over two speeds."""
    axes = ax or new_axes()
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    n = len(grid.speeds)
    codes = np.zeros((n, n), int)
    for k, blocked in enumerate(grid.blocked.values()):
        codes |= blocked.astype(int) << k
    found = sorted(set(codes.ravel().tolist()))
    places = np.searchsorted(found, codes)
    colours = [AREAS[0] if code == 0 else AREAS[1 + (i - (found[0] == 0)) % (len(AREAS) - 1)]
               for i, code in enumerate(found)]
    axes.pcolormesh(
        grid.speeds, grid.speeds, places.T, cmap=ListedColormap(colours), vmin=-0.5,
        vmax=len(found) - 0.5, shading="nearest",
    )
    ids = list(grid.blocked)

    def name(code: int) -> str:
        who = [id for k, id in enumerate(ids) if code >> k & 1]
        return f"blocked: {', '.join(who)}" if who else "nobody blocked"

    handles: list[Any] = [
        Patch(facecolor=colour, edgecolor=GREY, label=name(code))
        for colour, code in zip(colours, found, strict=True)
    ]
    handles += axes.plot(*grid.present, "o", color="black", markersize=8, label="present speeds", clip_on=False)
    axes.set_xlabel(f"speed of {grid.first}")
    axes.set_ylabel(f"speed of {grid.second}")
    axes.set_aspect("equal")
    axes.set_xlim(0, grid.speeds[-1])
    axes.set_ylim(0, grid.speeds[-1])
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(0, -0.14), fontsize=9, frameon=False)
    return axes
