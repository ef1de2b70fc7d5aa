"""The README's picture: KVLCC2's 35/5 zigzag, never fitted, predicted from rudder and propeller alone.

`python docs/make_pictures.py` identifies `examples/kvlcc2_hsva.toml` (records in SEATRIAL_DATA) and writes
``docs/pictures/kvlcc2_z_35_05.png``.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import seatrial as st
from seatrial.core.figures.run import hull_outline
from seatrial.core.results import Prediction
from seatrial.core.values import Record

REPOSITORY = Path(__file__).parents[1]
MEASURED = {"color": "#b2b2b2", "linewidth": 3.4}
SIMULATED = {"color": "#1b4f72", "linewidth": 1.6, "linestyle": (0, (4, 2))}
STYLE = {
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": "#888888",
    "axes.linewidth": 0.7, "axes.grid": True, "grid.color": "#ececec", "xtick.color": "#444444",
    "ytick.color": "#444444", "axes.titlesize": 9.5, "axes.titlelocation": "left",
}  # fmt: skip


def picture(prediction: Prediction, length: float, title: str) -> Figure:
    """Track above; heading, surge velocity and rudder below."""
    measured, simulated = prediction.measured, prediction.simulated
    figure = Figure(figsize=(9.6, 4.6), layout="constrained", dpi=160)
    grid = figure.add_gridspec(2, 3, height_ratios=[1.0, 1.5])
    top = figure.add_subplot(grid[0, :])
    for record, look in ((measured, MEASURED), (simulated, SIMULATED)):
        _track(top, record, length, look)
    top.set_aspect("equal", adjustable="datalim")
    top.invert_yaxis()
    top.set_xlabel("north [m]")
    top.set_ylabel("east [m]")
    top.set_title(title)
    for k, (name, label, factor) in enumerate(
        (
            ("psi", "heading [deg]", np.degrees(1)),
            ("u", "surge velocity [m/s]", 1.0),
            ("r", "yaw rate [deg/s]", np.degrees(1)),
        )
    ):
        axes = figure.add_subplot(grid[1, k])
        axes.plot(measured.time, measured[name] * factor, **MEASURED, label="measured")
        axes.plot(simulated.time, simulated[name] * factor, **SIMULATED, label="simulated, open loop")
        axes.set_title(label)
        axes.set_xlabel("time [s]")
        if k == 1:
            axes.legend(frameon=False, loc="upper right")
    return figure


def _track(axes: Axes, record: Record, length: float, look: dict) -> None:
    axes.plot(record["x0"], record["y0"], **look)
    for i in np.linspace(0, len(record) - 1, 9).astype(int):
        north, east = hull_outline(float(record["x0"][i]), float(record["y0"][i]), float(record["psi"][i]), length).T
        axes.fill(north, east, facecolor=look["color"] if look is MEASURED else "none", edgecolor=look["color"],
                  linewidth=0.9)  # fmt: skip


def main() -> None:
    """Identify, predict, draw."""
    fit = st.identify(st.load_trial(REPOSITORY / "examples" / "kvlcc2_hsva.toml"))
    held_out = fit.validation[0]
    rms, duration = held_out.rms, held_out.measured.duration
    title = (
        f"KVLCC2, 35/5 zigzag, not fitted: {duration:.0f} s from rudder and propeller alone, "
        f"{rms['psi_deg']:.1f}° in heading and {rms['position_m']:.1f} m in position (rms)"
    )
    path = REPOSITORY / "docs" / "pictures" / "kvlcc2_z_35_05.png"
    path.parent.mkdir(exist_ok=True)
    with mpl.rc_context(STYLE):
        picture(held_out, fit.ship.length, title).savefig(path)
    print(path)


if __name__ == "__main__":
    main()
