"""The identified roll model in the field's terms, with what was assumed of its inertia."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.ship_motions import IntervalEstimate, RollCharacteristics
from seatrial.core.values import Array, Finding, Record, Severity, Ship
from seatrial.estimation.identify.roll_inertia import roll_inertia
from seatrial.estimation.information.covariance import Interval
from seatrial.physics.hydro.free_roll import equivalent_damping, observed_swings, swing_period

DAMPING_NAMES, RESTORING_NAMES = ("b_1", "b_2", "b_3"), ("c_1", "c_3", "c_5")

# means of speed that differ by less are one speed: m/s, and share of the largest; ours
_ONE_SPEED, _ONE_SPEED_SHARE = 0.05, 0.05
# amplitudes of the curves; least swing over the largest that is shown, ours
_POINTS, _MIN_SWING_SHARE = 40, 0.05


def one_speed_finding(roll: RollCharacteristics | None, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return the note that decays at one speed, or without a channel of it, show no dependence of damping on speed."""
    if roll is None:
        return ()
    speeds = [float(np.nanmean(r["u"])) for r in records if "u" in r and np.isfinite(r["u"]).any()]
    if len(speeds) == len(records) and np.ptp(speeds) > max(_ONE_SPEED, _ONE_SPEED_SHARE * np.max(np.abs(speeds))):
        return ()
    where = f"at {np.mean(speeds):.3g} m/s alone" if speeds else "without a channel of speed (u)"
    return (
        Finding(
            Severity.INFO,
            "one-speed",
            f"the runs are {where}: they do not identify b(U), how damping depends on speed",
            f"{len(records)} of the training runs",
            "use the damping at this speed only; record decays at three speeds and fit each by itself",
        ),
    )


def roll_characteristics(
    model: Model, interval: Interval, free: Sequence[str], records: Sequence[Record], ship: Ship
) -> RollCharacteristics | None:
    """Of a model with these coefficients whose records hold the roll angle; None for any other.

    interval: of the `free` parameters first. Where a swing of some amplitude would not come back, amplitudes end.
    """
    if not {*DAMPING_NAMES, *RESTORING_NAMES, "phi_0"} <= set(model.parameters.names) or not all(
        "phi" in r for r in records
    ):
        return None
    b, c = (np.array([model.parameters[n].value for n in names]) for names in (DAMPING_NAMES, RESTORING_NAMES))
    rest = model.parameters["phi_0"].value
    spread = _HalfWidths(interval, tuple(free))
    root = float(np.sqrt(c[0]))
    ratio = 0.5 * b[0] / root
    inertia = roll_inertia(
        ship, _symmetric_interval(float(c[0]), float(spread.half_width(np.ones((1, 1)), ("c_1",))[0]))
    )
    reach = max(float(np.nanmax(np.abs(r["phi"] - rest))) for r in records)
    amplitude = reach * np.arange(1, _POINTS + 1) / _POINTS
    periods, by_c = swing_period(c, amplitude)
    amplitude = amplitude[: int(np.argmin(np.isfinite(periods))) if np.any(np.isnan(periods)) else None]
    periods, by_c = periods[: len(amplitude)], by_c[: len(amplitude)]
    damping, by_all = equivalent_damping(b, c, amplitude)
    wide, wider = (
        spread.half_width(by_c, RESTORING_NAMES),
        spread.half_width(by_all, (*DAMPING_NAMES, *RESTORING_NAMES)),
    )
    return RollCharacteristics(
        natural_period=_symmetric_interval(
            2.0 * np.pi / root, spread.half_width(np.array([[-np.pi / root**3]]), ("c_1",))[0]
        ),
        damping_ratio=_symmetric_interval(
            ratio, spread.half_width(np.array([[0.5 / root, -0.5 * ratio / c[0]]]), ("b_1", "c_1"))[0]
        ),
        gyradius=inertia.gyradius,
        gyradius_source=inertia.source,
        metacentric_height=inertia.metacentric_height,
        amplitude=_floats(amplitude),
        damping=_floats(damping),
        damping_lower=_floats(damping - wider),
        damping_upper=_floats(damping + wider),
        period=_floats(periods),
        period_lower=_floats(periods - wide),
        period_upper=_floats(periods + wide),
        swings=() if _is_excited(model, records) else _swings(records, rest, reach),
    )


class _HalfWidths:
    """Half widths of 95 % intervals of functions of the coefficients, by their derivatives."""

    def __init__(self, interval: Interval, free: tuple[str, ...]) -> None:
        self._free, self._covariance = free, interval.covariance
        self._quantile = two_sided_quantile(STORED_LEVEL, interval.degrees_of_freedom)

    def half_width(self, slopes: Array, names: Sequence[str]) -> Array:
        """slopes (n, len(names)); a fixed coefficient counts as exact."""
        kept = [i for i, name in enumerate(names) if name in self._free]
        places = [self._free.index(names[i]) for i in kept]
        own = self._covariance[np.ix_(places, places)]
        variance = np.einsum("ni,ij,nj->n", slopes[:, kept], own, slopes[:, kept])
        return self._quantile * np.sqrt(np.maximum(variance, 0.0))


def _symmetric_interval(value: float, half: float) -> IntervalEstimate:
    return IntervalEstimate(float(value), float(value - half), float(value + half))


def _is_excited(model: Model, records: Sequence[Record]) -> bool:
    return any(n in r and np.ptp(r[n]) > 0.0 for n in model.input_names for r in records)


def _swings(records: Sequence[Record], rest: float, reach: float) -> tuple[tuple[float, float, float], ...]:
    """Of all decays, without those of less than a twentieth of the largest, which the sensor's noise blurs."""
    swings = []
    for record in records:
        phi = record["phi"] - rest
        swings += [s for s in zip(*map(_floats, observed_swings(phi, record.dt)), strict=True)
                  if s[0] > _MIN_SWING_SHARE * reach]  # fmt: skip
    return tuple(swings)


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)
