"""The identified roll model in the field's terms, with what was assumed of her inertia."""

from collections.abc import Sequence

import numpy as np
from scipy import stats

from seatrial.core.equations import Model
from seatrial.core.results.rolling import Estimated, Rolling
from seatrial.core.values import Array, Record, Ship
from seatrial.estimation.information.covariance import Interval
from seatrial.physics.hydro.rolling import equivalent_damping, metacentric_height, observed_swings, swing_period

DAMPING, RESTORING = ("b_1", "b_2", "b_3"), ("c_1", "c_3", "c_5")
WITH_ADDED, DRY = "k_xx_prime", "k_xx"

# share of the moment of inertia that the water adds in roll, and the radius of gyration with it over the breadth
ADDED_INERTIA, OVER_BREADTH = (0.05, 0.18, 0.30), (0.35, 0.40, 0.45)
_POINTS, _ABOVE_NOISE = 40, 0.05


def rolling(
    model: Model, interval: Interval, free: Sequence[str], records: Sequence[Record], ship: Ship
) -> Rolling | None:
    """Of a model with these coefficients whose records hold the roll angle; None for any other.

    interval: of the `free` parameters first. Where a swing of some amplitude would not come back, amplitudes end.
    """
    if not {*DAMPING, *RESTORING, "phi_0"} <= set(model.parameters.names) or not all("phi" in r for r in records):
        return None
    b, c = (np.array([model.parameters[n].value for n in names]) for names in (DAMPING, RESTORING))
    rest = model.parameters["phi_0"].value
    spread = _Spread(interval, tuple(free))
    root = float(np.sqrt(c[0]))
    ratio = 0.5 * b[0] / root
    gyradius, assumed = assumed_gyradius(ship)
    reach = max(float(np.nanmax(np.abs(r["phi"] - rest))) for r in records)
    amplitude = reach * np.arange(1, _POINTS + 1) / _POINTS
    periods, by_c = swing_period(c, amplitude)
    amplitude = amplitude[: int(np.argmin(np.isfinite(periods))) if np.any(np.isnan(periods)) else None]
    periods, by_c = periods[: len(amplitude)], by_c[: len(amplitude)]
    damping, by_all = equivalent_damping(b, c, amplitude)
    wide, wider = spread.half(by_c, RESTORING), spread.half(by_all, (*DAMPING, *RESTORING))
    return Rolling(
        natural_period=_about(2.0 * np.pi / root, spread.half(np.array([[-np.pi / root**3]]), ("c_1",))[0]),
        damping_ratio=_about(ratio, spread.half(np.array([[0.5 / root, -0.5 * ratio / c[0]]]), ("b_1", "c_1"))[0]),
        gyradius=gyradius,
        assumed=assumed,
        metacentric_height=_height(float(c[0]), float(spread.half(np.ones((1, 1)), ("c_1",))[0]), gyradius),
        amplitude=_tuple(amplitude),
        damping=_tuple(damping), damping_lower=_tuple(damping - wider), damping_upper=_tuple(damping + wider),
        period=_tuple(periods), period_lower=_tuple(periods - wide), period_upper=_tuple(periods + wide),
        swings=() if _is_driven(model, records) else _swings(records, rest, reach),
    )  # fmt: skip


def assumed_gyradius(ship: Ship) -> tuple[Estimated | None, str]:
    """Radius of gyration in roll with added inertia [m]: the ship's `k_xx_prime`, else by `k_xx`, else by breadth."""
    known = ship.particulars
    if WITH_ADDED in known:
        k = known[WITH_ADDED]
        return Estimated(k, k, k), f"{WITH_ADDED} of the ship, {k:.4g} m, taken as exact"
    if DRY in known:
        low, middle, high = (known[DRY] * float(np.sqrt(1.0 + share)) for share in ADDED_INERTIA)
        said = f"{DRY} of the ship, {known[DRY]:.4g} m, and an added inertia of {_range(ADDED_INERTIA, 100.0)} % of it"
        return Estimated(middle, low, high), f"{said}, chosen; {WITH_ADDED} under [ship] would replace this"
    if "B" in known:
        low, middle, high = (share * known["B"] for share in OVER_BREADTH)
        said = f"a radius of gyration with added inertia of {_range(OVER_BREADTH, 1.0)} of the breadth"
        return Estimated(middle, low, high), f"{said}, chosen; {WITH_ADDED} or {DRY} under [ship] would replace this"
    return None, f"not known; give {WITH_ADDED}, {DRY} or B under [ship]"


class _Spread:
    """Half widths of 95 % intervals of functions of the coefficients, by their derivatives."""

    def __init__(self, interval: Interval, free: tuple[str, ...]) -> None:
        self._free, self._covariance = free, interval.covariance
        self._factor = float(stats.t.ppf(0.975, interval.degrees_of_freedom))

    def half(self, slopes: Array, names: Sequence[str]) -> Array:
        """slopes (n, len(names)); a fixed coefficient counts as exact."""
        kept = [i for i, name in enumerate(names) if name in self._free]
        places = [self._free.index(names[i]) for i in kept]
        own = self._covariance[np.ix_(places, places)]
        variance = np.einsum("ni,ij,nj->n", slopes[:, kept], own, slopes[:, kept])
        return self._factor * np.sqrt(np.maximum(variance, 0.0))


def _about(value: float, half: float) -> Estimated:
    return Estimated(float(value), float(value - half), float(value + half))


def _height(c_1: float, half: float, gyradius: Estimated | None) -> Estimated | None:
    if gyradius is None:
        return None
    return Estimated(
        metacentric_height(c_1, gyradius.value),
        metacentric_height(c_1 - half, gyradius.lower),
        metacentric_height(c_1 + half, gyradius.upper),
    )


def _is_driven(model: Model, records: Sequence[Record]) -> bool:
    return any(n in r and np.ptp(r[n]) > 0.0 for n in model.input_names for r in records)


def _swings(records: Sequence[Record], rest: float, reach: float) -> tuple[tuple[float, float, float], ...]:
    """Of all decays, without those of less than a twentieth of the largest, which the sensor's noise blurs."""
    found = []
    for record in records:
        phi = record["phi"] - rest
        found += [s for s in zip(*map(_tuple, observed_swings(phi, record.dt)), strict=True)
                  if s[0] > _ABOVE_NOISE * reach]  # fmt: skip
    return tuple(found)


def _range(three: tuple[float, float, float], factor: float) -> str:
    low, middle, high = (f"{factor * value:.3g}" for value in three)
    return f"{middle} ({low} to {high})"


def _tuple(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)
