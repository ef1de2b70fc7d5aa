"""Lines as SVG path data: points that a reader cannot see left out, steps in tenths of a px."""

import numpy as np
from numpy.typing import NDArray

from seatrial.core.figures.marks import Array

# distance from the line drawn [px] up to which a point is left out; places of a px after the point
UNSEEN, PLACES = 0.15, 10


def path_data(px: Array, py: Array) -> str:
    """Return the path through positions in px, shape (n,) each; NaN leaves a gap, a point alone is not drawn."""
    finite = np.isfinite(px) & np.isfinite(py)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], finite, [False]]).astype(int)))
    return "".join(_stretch(px[a:b], py[a:b]) for a, b in zip(ends[::2], ends[1::2], strict=True))


def _stretch(px: Array, py: Array) -> str:
    kept = visible_points(px, py)
    x, y = (np.round(PLACES * p[kept]).astype(int) for p in (px, py))
    steps = [(int(dx), int(dy)) for dx, dy in zip(np.diff(x), np.diff(y), strict=True) if dx or dy]
    moves = "".join(_text(dx, is_first=k == 0) + _text(dy) for k, (dx, dy) in enumerate(steps))
    return f"M{_text(int(x[0]), is_first=True)}{_text(int(y[0]))}" + (f"l{moves}" if moves else "")


def _text(tenths: int, *, is_first: bool = False) -> str:
    """Tenths of a px as short as SVG allows, with a blank before it where the minus does not part it."""
    units, rest = divmod(abs(tenths), PLACES)
    digits = (str(units) if units or not rest else "") + (f".{rest}" if rest else "")
    sign = "-" if tenths < 0 else ("" if is_first else " ")
    return sign + digits


def visible_points(px: Array, py: Array) -> NDArray[np.bool_]:
    """Return which points a line needs so that no point is farther from it than can be seen (Douglas & Peucker 1973).

    Cartographica 10, 112-122; the first and the last point are always among them.
    """
    kept = np.zeros(len(px), dtype=bool)
    kept[[0, -1]] = True
    stretches = [(0, len(px) - 1)]
    while stretches:
        a, b = stretches.pop()
        if b - a < 2:
            continue
        x, y = px[a + 1 : b] - px[a], py[a + 1 : b] - py[a]
        across, down = px[b] - px[a], py[b] - py[a]
        length = float(np.hypot(across, down))
        share = np.clip((x * across + y * down) / length**2, 0.0, 1.0) if length > 0.0 else np.zeros_like(x)
        distance = np.hypot(x - share * across, y - share * down)
        k = int(np.argmax(distance))
        if distance[k] > UNSEEN:
            kept[a + 1 + k] = True
            stretches += [(a, a + 1 + k), (a + 1 + k, b)]
    return kept
