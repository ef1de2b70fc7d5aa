"""Forest plot: estimate, 95 % interval, truth and prior of every free coefficient, relative to the estimate."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from seatrial.report.figures.canvas import ACCENT, SECOND, canvas, styled, svg
from seatrial.results import Coefficient

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NARROWEST, WIDEST = 5.0, 120.0


def forest(coefficients: Sequence[Coefficient], prefix: str) -> str:
    """One line for each free coefficient, deviations from the estimate in per cent of it; empty where none is free."""
    free = [c for c in coefficients if not c.fixed and c.estimate != 0 and c.lower is not None and c.upper is not None]
    if not free:
        return ""
    reach = _reach(free)
    with styled():
        figure = canvas(0.19 * len(free) + 0.75)
        axes = figure.add_subplot()
        for k, c in enumerate(free):
            _line(axes, c, len(free) - 1 - k, reach)
        axes.axvline(0, color="#999999", linewidth=0.6)
        axes.set_xlim(-reach, reach)
        axes.set_ylim(-0.7, len(free) - 0.3)
        axes.set_yticks(range(len(free)), [c.name for c in reversed(free)])
        axes.tick_params(axis="y", length=0)
        axes.set_xlabel("deviation from the estimate, per cent of the estimate")
        _legend(axes, free)
        return svg(figure, "forest plot of the free coefficients", prefix)


def _reach(free: Sequence[Coefficient]) -> float:
    ends = [abs(_deviation(c, x)) for c in free for x in (c.lower, c.upper, c.truth) if x is not None]
    return float(np.clip(1.12 * max(ends), NARROWEST, WIDEST))


def _deviation(c: Coefficient, value: float) -> float:
    return 100.0 * (value - c.estimate) / abs(c.estimate)


def _line(axes: "Axes", c: Coefficient, place: float, reach: float) -> None:
    assert c.lower is not None and c.upper is not None
    low, high = _deviation(c, c.lower), _deviation(c, c.upper)
    if c.prior_mean is not None and c.prior_standard_deviation is not None:
        spread = 1.96 * c.prior_standard_deviation
        ends = np.clip([_deviation(c, c.prior_mean - spread), _deviation(c, c.prior_mean + spread)], -reach, reach)
        axes.plot(ends, [place, place], color="#d5dbe0", linewidth=6, solid_capstyle="butt", zorder=1)
    axes.plot(np.clip([low, high], -reach, reach), [place, place], color=ACCENT, linewidth=1.6, zorder=2)
    for end, marker in ((low, "<"), (high, ">")):
        if abs(end) > reach:
            axes.plot([np.sign(end) * reach * 0.99], [place], marker, color=ACCENT, markersize=3.5, clip_on=False)
    axes.plot([0], [place], "o", color=ACCENT, markersize=3.6, zorder=3)
    if c.truth is not None and abs(_deviation(c, c.truth)) <= reach:
        axes.plot([_deviation(c, c.truth)], [place], "D", markersize=3.6, zorder=4, markerfacecolor="white",
                  markeredgecolor=SECOND, markeredgewidth=1.0)  # fmt: skip


def _legend(axes: "Axes", free: Sequence[Coefficient]) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=ACCENT, marker="o", markersize=3.6, linewidth=1.6, label="estimate, 95 % interval")]
    if any(c.truth is not None for c in free):
        handles.append(Line2D([], [], color=SECOND, marker="D", markersize=3.6, linewidth=0, markerfacecolor="white",
                              label="known value"))  # fmt: skip
    if any(c.prior_mean is not None for c in free):
        handles.append(Line2D([], [], color="#d5dbe0", linewidth=6, label="prior, 95 %"))
    axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1, 1), ncols=3, borderaxespad=0.2)
