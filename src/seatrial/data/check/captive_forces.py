"""Force points against what every ship does: which column looks turned, and whether forces are of a ship's size."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from seatrial.core.values import Array, Finding, ForceContent, ForcePoints, Severity

# sign of the slope of a force in sway velocity, yaw rate and rudder angle of a ship going ahead with its rudder aft:
# the force opposes the motion, the rudder turns the ship to its own side (Lewis 1989, Principles of Naval
# Architecture III, chapter IX, section 4); N_v is negative for nearly every hull and only helps to
# distinguish the columns
SLOPE_SIGNS = {("Y", "v"): -1, ("N", "r"): -1, ("Y", "delta"): -1, ("N", "delta"): 1}
# sign of a slope that most hulls share; used to choose between columns only
_AUXILIARY_SLOPE_SIGNS = {("N", "v"): -1}
# standard errors beyond which the sign of a slope counts, ours
_SIGNIFICANT_T = 4.0
# slope of Y in v over rho/2 L d U of ships' hulls, dimensionless, ours
_SIDE_FORCE_RANGE = (0.05, 2.5)
_DIRECTIONS = {"X": ("forward", "aft"), "beta": ("bow to starboard", "bow to port")}


@dataclass(frozen=True)
class _Slope:
    value: float
    error: float

    @property
    def sign(self) -> int:
        """-1, 0 where it is lost in the scatter, or 1."""
        return int(np.sign(self.value)) if abs(self.value) > _SIGNIFICANT_T * self.error else 0


def force_findings(points: ForcePoints, reference_force: float | None = None) -> tuple[Finding, ...]:
    """Return errors: `force-sign` where drag drives, a side force follows the drift or a moment its turn; `force-size`.

    reference_force: rho/2 L d of the ship [kg/m^2], with which the size of the side force is judged.
    """
    slopes = {(f, m): s for f in ("Y", "N") if f in points.forces for m, s in _slopes(points, f).items()}
    return (
        *_drag_findings(points),
        *_slope_sign_findings(points, slopes),
        *([] if reference_force is None else _side_force_findings(points, slopes, reference_force)),
    )


def _side_force_findings(
    points: ForcePoints, slopes: dict[tuple[str, str], _Slope], reference_force: float
) -> list[Finding]:
    """Y_v' by slender bodies is -pi d/L - 1.4 C_b B/L (Kijima et al. 1990), -0.2 to -0.7; else another system."""
    slope = slopes.get(("Y", "v"))
    low, high = _SIDE_FORCE_RANGE
    if slope is None or slope.sign == 0 or low <= abs(slope.value) / reference_force <= high:
        return []
    text = f"force points '{points.name}': {points.label('Y')} is not of the size of this ship's side force"
    size = f"|Y_v'| is {abs(slope.value) / reference_force:.2g} over rho/2 L d U^2, ships have {low:g} to {high:g}"
    advice = "check the prime system, the unit and the scale declared under forces"
    return [Finding(Severity.ERROR, "force-size", text, size, advice)]


def _drag_findings(points: ForcePoints) -> list[Finding]:
    """Without a turning propeller the ship going ahead is held back: X < 0 in the median."""
    if "X" not in points.forces:
        return []
    rate = points.motion.get("n", np.full(len(points), np.nan))
    idle = (rate == 0) | (points.includes is ForceContent.HULL)
    chosen = idle & (points.motion["u"] > 0) & np.isfinite(points.forces["X"])
    if not chosen.any() or np.median(points.forces["X"][chosen]) <= 0:
        return []
    level = float(np.median(points.forces["X"][chosen]))
    evidence = f"X is {level:+.3g} N in the median of {int(chosen.sum())} points without propeller"
    return [_force_sign_finding(points, "X", evidence)]


def _slope_sign_findings(points: ForcePoints, slopes: dict[tuple[str, str], _Slope]) -> list[Finding]:
    wrong = [key for key, law in SLOPE_SIGNS.items() if key in slopes and slopes[key].sign == -law]
    if not wrong:
        return []
    evidence = "; ".join(f"d{f}/d{m} = {slopes[f, m].value:.3g} +- {slopes[f, m].error:.2g}" for f, m in wrong)
    return [_force_sign_finding(points, _reversed_column(slopes), evidence)]


def _slopes(points: ForcePoints, force: str) -> dict[str, _Slope]:
    """Slopes of force over speed in v and r, of force over speed squared in the rudder angle, with standard errors."""
    speed = np.hypot(points.motion["u"], points.motion["v"])
    good = np.isfinite(points.forces[force]) & (points.motion["u"] > 0)
    regressors = {"v": points.motion["v"] / speed, "r": points.motion["r"] / speed, "delta": points.motion.get("delta")}
    used = {name: x[good] for name, x in regressors.items() if x is not None and np.any(x[good] != x[good][:1])}
    if not used or good.sum() < len(used) + 3:
        return {}
    table = np.column_stack([*used.values(), np.ones(good.sum())])
    if np.linalg.matrix_rank(table / np.abs(table).max(axis=0)) < table.shape[1]:
        return {}
    return dict(zip(used, _least_squares_slopes(table, points.forces[force][good] / speed[good] ** 2), strict=True))


def _least_squares_slopes(table: Array, values: Array) -> list[_Slope]:
    """Ordinary least squares; the last column is the constant, whose coefficient is left out."""
    slopes, *_ = np.linalg.lstsq(table, values, rcond=None)
    spread = np.sum((values - table @ slopes) ** 2) / (len(values) - table.shape[1])
    errors = np.sqrt(spread * np.diag(np.linalg.inv(table.T @ table)))
    return [_Slope(float(b), float(e)) for b, e in zip(slopes[:-1], errors[:-1], strict=True)]


def _reversed_column(slopes: dict[tuple[str, str], _Slope]) -> str:
    """The one column whose reversal corrects most signs, motions before forces where both do."""
    laws = {**SLOPE_SIGNS, **_AUXILIARY_SLOPE_SIGNS}

    def broken(turned: str) -> int:
        return sum(
            slopes[f, m].sign * laws[f, m] * (-1 if turned in (f, m) else 1) < 0
            for f, m in product(("Y", "N"), ("v", "r", "delta"))
            if (f, m) in slopes and (f, m) in laws
        )

    return min(("v", "r", "delta", "Y", "N"), key=broken)


def _force_sign_finding(points: ForcePoints, symbol: str, evidence: str) -> Finding:
    key = "beta" if symbol == "v" and "beta" in points.columns else symbol
    one, other = _DIRECTIONS.get(key, ("starboard", "port"))
    table = "measured" if key in points.forces else "motion"
    text = f"force points '{points.name}': {points.label(key)} looks turned: the signs are those of no ship"
    advice = f'turn positive of forces.{table}.{key} round, "{one}" or "{other}"'
    return Finding(Severity.ERROR, "force-sign", text, evidence, advice)
