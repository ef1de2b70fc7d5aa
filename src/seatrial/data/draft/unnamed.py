"""Columns without names, by what they do: derivatives of one another, the heading of the track, what turns the ship."""

import math
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from seatrial.core.values import Array
from seatrial.data.check.signal import jackknife_least_squares, smoothed, smoothed_derivative, window_length

# correlation of a column with the derivative of another that makes them a pair, and share by which their ratio may
# differ from one unit to the other; chosen
_PAIR_CORRELATION, _PAIR_RATIO = 0.98, 0.05
_COURSE_ANGLE = math.radians(25.0)  # rad rms between course and heading, up to which ships drift in turns; chosen
_SURE_T = 5.0  # effect over standard error that proves a rudder; as in the checks
_ANGLE_UNITS = {"deg": math.pi / 180.0, "rad": 1.0}  # rad


@dataclass(frozen=True)
class UnnamedColumn:
    """What a column without a name is, and why."""

    index: int
    symbol: str
    unit: str
    frame: str
    positive: str
    evidence: str


def recognised_columns(columns: dict[int, Array], dt: float) -> list[UnnamedColumn]:
    """Return what columns (numbered from 1, each (n,) without gaps) are; empty where no motion is recognised.

    Two pairs of a position and its rate whose course a third, an angle with its rate, follows are x0, y0, u, v
    (earth-fixed), psi and r; of the rest what leads the yaw acceleration is the rudder.
    """
    length = window_length(len(next(iter(columns.values()), ())))
    if length < 3 or len(columns) < 6:  # columns of a motion; samples of a window
        return []
    rates = {k: smoothed_derivative(values, dt, length) for k, values in columns.items()}
    smooth = {k: smoothed(values, length) for k, values in columns.items()}
    pairs = _derivative_pairs(smooth, rates)
    best: tuple[float, list[UnnamedColumn]] = (_COURSE_ANGLE, [])
    for (x, u), (y, v), (psi, r) in permutations(pairs, 3):
        for unit, size in _ANGLE_UNITS.items():
            misfit = _course_misfit(smooth[u], smooth[v], size * smooth[psi])
            if misfit < best[0]:
                best = (misfit, _motion(x, y, psi, u, v, r, unit, misfit))
    if not best[1]:
        return []
    taken = {one.index for one in best[1]}
    psi = next(one for one in best[1] if one.symbol == "psi")
    yaw = smooth[next(one.index for one in best[1] if one.symbol == "r")]
    rest = {k: values for k, values in smooth.items() if k not in taken}
    return [*best[1], *_rudder(rest, yaw, rates[_index(best[1], "r")], psi.unit)]


def _index(columns: list[UnnamedColumn], symbol: str) -> int:
    return next(column.index for column in columns if column.symbol == symbol)


def _derivative_pairs(smooth: dict[int, Array], rates: dict[int, Array]) -> list[tuple[int, int]]:
    """Column and the column that is its derivative, in the same unit."""
    pairs = []
    for i, rate in rates.items():
        power = float(rate @ rate)
        for j, values in smooth.items():
            if i == j or power == 0.0 or not np.any(values):
                continue
            factor = float(values @ rate) / power
            match = factor * math.sqrt(power / float(values @ values))
            if match > _PAIR_CORRELATION and abs(factor - 1.0) < _PAIR_RATIO:
                pairs.append((i, j))
    return pairs


def _course_misfit(north: Array, east: Array, psi: Array) -> float:
    """The rms angle [rad] between course and heading where the craft moves."""
    speed = np.hypot(north, east)
    moving = speed > 0.3 * float(np.max(speed))  # of the largest speed: a course is well defined
    angle = np.angle(np.exp(1j * (np.arctan2(east, north) - psi)))[moving]
    return float(np.sqrt(np.mean(angle**2))) if angle.size else math.inf


def _motion(x: int, y: int, psi: int, u: int, v: int, r: int, unit: str, misfit: float) -> list[UnnamedColumn]:
    text = f"the track leads where column {psi} points, within {math.degrees(misfit):.0f} deg"
    return [
        UnnamedColumn(x, "x0", "m", "", "", f"column {u} is its derivative; {text}"),
        UnnamedColumn(y, "y0", "m", "", "", f"column {v} is its derivative; {text}"),
        UnnamedColumn(psi, "psi", unit, "", "", f"column {r} is its derivative; {text}"),
        UnnamedColumn(u, "u", "m/s", "earth", "", f"the derivative of column {x}"),
        UnnamedColumn(v, "v", "m/s", "earth", "", f"the derivative of column {y}"),
        UnnamedColumn(r, "r", f"{unit}/s", "", "", f"the derivative of column {psi}"),
    ]


def _rudder(rest: dict[int, Array], yaw: Array, acceleration: Array, unit: str) -> list[UnnamedColumn]:
    """The column that the yaw acceleration follows best: dr/dt = a r + b delta + c (Nomoto 1957, eq. 1)."""
    best = (0.0, 0)
    for k, values in rest.items():
        if np.ptp(values) > 0.0:
            features = np.column_stack([yaw, values, np.ones_like(values)])
            answer, errors = jackknife_least_squares(features, acceleration)
            t = float(answer[1] / errors[1]) if errors[1] > 0 else 0.0
            best = max(best, (t, k), key=lambda one: abs(one[0]))
    t, k = best
    if abs(t) < _SURE_T:
        return []
    side = "starboard" if t > 0 else "port"
    text = f"the yaw acceleration follows it, a positive one turns to {side} (effect over standard error {abs(t):.0f})"
    return [UnnamedColumn(k, "delta", unit, "", "" if t > 0 else "port", text)]
