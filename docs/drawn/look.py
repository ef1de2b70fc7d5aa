"""How pictures of the documentation look: colours, lines, and the examples they are drawn from."""

from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.text import Text

import seatrial as st
from seatrial.core.figures.chart import ACCENT, INK, SECOND, Chart
from seatrial.core.figures.matplotlib_axes import matplotlib_figure
from seatrial.core.figures.run import hull_outline
from seatrial.core.results import Fit, Prediction
from seatrial.core.values import Array, Record

mpl.rc_file(Path(__file__).parents[1] / "matplotlibrc")
mpl.rcParams["figure.constrained_layout.use"] = True  # recipes lay out theirs themselves
REPOSITORY = Path(__file__).parents[2]
BLUE, ORANGE, GREEN, YELLOW, VIOLET, GREY = (
    f"#{entry['color'].removeprefix('#')}" for entry in mpl.rcParams["axes.prop_cycle"]
)
MEASURED = {"color": GREY, "linewidth": 3.2, "alpha": 0.6}
SIMULATED = {"color": BLUE}
BAND = {"color": BLUE, "alpha": 0.22, "linewidth": 0}
POINTS = 400
"""Points of a line: what a telephone can show."""


@cache
def example(name: str) -> Fit:
    """Return the fit of an example."""
    return st.identify(st.load_trial(REPOSITORY / "examples" / f"{name}.toml"))


def thinned(*values: Array) -> tuple[Array, ...]:
    """Return every so many-th value, so that a line has as many points as can be seen."""
    step = max(1, values[0].size // POINTS)
    return tuple(v[::step] for v in values)


def heading_with_band(axes: Axes, prediction: Prediction) -> None:
    """Measured and predicted heading, with its 95 % band."""
    time, measured, simulated, half = thinned(
        prediction.measured.time,
        np.degrees(prediction.measured["psi"]),
        np.degrees(prediction.simulated["psi"]),
        np.degrees(prediction.half_width["psi"]),
    )
    axes.plot(time, measured, **MEASURED, label="measured")
    axes.fill_between(time, simulated - half, simulated + half, **BAND, label="95 % band")
    axes.plot(time, simulated, **SIMULATED, label="predicted")
    axes.set(xlabel="time [s]", ylabel="heading [deg]")


def track(axes: Axes, record: Record, length: float, look: dict) -> None:
    """The path with the hull at nine places."""
    axes.plot(*thinned(record["y0"], record["x0"]), **look)
    for i in np.linspace(0, len(record) - 1, 9).astype(int):
        place = float(record["x0"][i]), float(record["y0"][i])
        north, east = hull_outline(*place, float(record["psi"][i]), length).T
        axes.fill(east, north, facecolor="none", edgecolor=look["color"], linewidth=0.9)
    axes.set(xlabel="east [m]", ylabel="north [m]")
    axes.set_aspect("equal", adjustable="datalim")


def reports_figure(chart: Chart, width: float) -> Figure:
    """A chart of the reports so wide [inch], in colours that are read on light and dark pages."""
    figure, grey = matplotlib_figure(chart), mpl.rcParams["text.color"]
    figure.set_layout_engine("none")
    figure.set_size_inches(width, width * figure.get_figheight() / figure.get_figwidth())
    for text in figure.findobj(Text):
        text.set_color(grey)
    for line in figure.findobj(Line2D):
        line.set_color({INK: grey, ACCENT: BLUE, SECOND: ORANGE}.get(line.get_color(), line.get_color()))
    for patch in figure.findobj(Patch):
        if to_hex(patch.get_facecolor()) == INK:
            patch.set_color(grey)
    return figure
