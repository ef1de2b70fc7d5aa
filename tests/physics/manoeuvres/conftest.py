"""Records whose measures are known."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Array, Channel, Record, frozen

Reader = Callable[[str], Record]


@pytest.fixture
def circle() -> Callable[..., Record]:
    """circle(side): a straight run of 10 s, then at once a circle of radius 20 m at 1 m/s, drift 0.1 rad, 540 deg."""

    def make_circle(side: int = 1, positive: str = "starboard") -> Record:
        time = np.arange(0.0, 210.0, 0.1)
        rate, drift, radius = 0.05, 0.1, 20.0
        turned = rate * np.clip(time - 10.0, 0.0, None)
        over = time > 10.0 + 1e-9
        # the bow points inwards by the drift angle; the track itself is tangent to the approach
        along = np.where(over, radius * np.sin(turned), time - 10.0)
        across = np.where(over, radius * (1.0 - np.cos(turned)), 0.0)
        slip = np.where(over, drift, 0.0)
        values = {
            "x0": along,
            "y0": side * across,
            "psi": side * turned,
            "u": np.cos(slip),
            "v": -side * np.sin(slip),
            "r": side * np.where(over, rate, 0.0),
        }
        sign = side if positive == "starboard" else -side
        delta = Channel(frozen(sign * np.where(over, np.radians(35.0), 0.0)), "rad", "body", positive)
        return Record.from_arrays("circle", time, values).with_channel("delta", delta)

    return make_circle


def _angles(values: Array) -> Array:
    return np.radians(values)


@pytest.fixture(scope="session")
def hsva(data_folder: Path) -> Reader:
    """hsva("Z_20_05"): a zigzag of the KVLCC2 model, rudder positive to port as in the file."""

    def read(name: str) -> Record:
        table = np.loadtxt(data_folder / "kvlcc2_hsva" / f"HSVA_CPMC_KVLCC2_{name}.dat", skiprows=5, encoding="cp1252")
        psi, north, east = _angles(table[:, 3]), table[:, 4], table[:, 5]
        values = {
            "x0": table[:, 1],
            "y0": table[:, 2],
            "psi": psi,
            "u": north * np.cos(psi) + east * np.sin(psi),
            "v": -north * np.sin(psi) + east * np.cos(psi),
            "r": _angles(table[:, 6]),
        }
        delta = Channel(frozen(_angles(table[:, 8])), "rad", "body", "port")
        return Record.from_arrays(name, table[:, 0], values).with_channel("delta", delta)

    return read


@pytest.fixture(scope="session")
def esso(data_folder: Path) -> Reader:
    """esso("turning/turn_..."): a run of the Esso Osaka model."""
    symbols = ("x0", "u", "y0", "v", "psi", "r", "n", "delta")

    def read(name: str) -> Record:
        table = np.genfromtxt(
            data_folder / "esso_osaka" / f"{name}.csv", delimiter=",", skip_header=1, encoding="cp1252"
        )
        table = table[np.isfinite(table[:, 0])]
        return Record.from_arrays(name, table[:, 0], {s: table[:, i + 1] for i, s in enumerate(symbols)})

    return read
