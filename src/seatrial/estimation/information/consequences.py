"""What a wrong assumed value does to the estimates, by one Gauss-Newton step from the information matrix.

With H the information on assumed and fitted parameters together, d theta = -H_ff^-1 H_fp dp, and the sum of squares
grows by dp (H_pp - H_pf H_ff^-1 H_fp) dp (implicit function theorem on the normal equations). That is what to expect:
the noise of one record favours one sign of dp and adds a part linear in it.
"""

from collections.abc import Mapping

import numpy as np

from seatrial.core.values import Array, Index

_MOST_NAMED, _LEAST_SHIFT = 4, 0.005  # coefficients named in a text; relative shift worth naming; chosen
_VISIBLE_GROWTH = 0.05  # relative growth of the residuals that is visible; chosen
_ROUNDING = 1e-13  # of a singular information matrix, over its largest singular value; chosen


def estimate_shifts(information: Array, fitted: Index, change: Array) -> tuple[Array, float]:
    """Return changes of the fitted parameters, (len(fitted),), and the growth of chi squared, for an assumed change.

    information: shape (n, n); fitted: positions in it. change: of all parameters, (n,), whose effect on the outputs the
    fitted ones make up for. What the information does not determine stays.
    """
    pull = information @ change
    size = np.sqrt(information[fitted, fitted])
    scale = np.where(size > 0.0, 1.0 / np.where(size > 0.0, size, 1.0), 0.0)
    scaled = information[np.ix_(fitted, fitted)] * scale[:, None] * scale
    solved = np.linalg.lstsq(scaled, scale * pull[fitted], rcond=_ROUNDING)[0]
    moves = np.asarray(-scale * solved, dtype=np.float64)
    return moves, max(float(change @ pull + pull[fitted] @ moves), 0.0)


def consequence_text(
    name: str, change: float, shifts_by_name: Mapping[str, float], chi_squared_growth: float, chi_squared: float
) -> str:
    """A sentence; change and shifts_by_name are relative, the largest first; chi_squared: without the change."""
    shifts = [
        f"{n} by {float(f'{100 * m:.2g}'):+g} %"
        for n, m in list(shifts_by_name.items())[:_MOST_NAMED]
        if abs(m) >= _LEAST_SHIFT
    ]
    first = f"were {name} {100 * change:.0f} % larger, "
    if not shifts:
        return f"{first}no estimate would shift by half a per cent"
    growth = float(np.sqrt(1.0 + chi_squared_growth / chi_squared) - 1.0) if chi_squared > 0 else np.inf
    shown = "show it" if growth >= _VISIBLE_GROWTH else "hardly show it"
    return (
        f"{first}the estimates would shift, {', '.join(shifts)}, and the residuals would {shown} "
        f"(they would grow by {100 * growth:.2g} %, chi squared by {chi_squared_growth:.2g})"
    )
