"""The identified craft in its users' terms: roll with limits of physics, thrust curves, measures at full command."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.ship_motions import (
    CommandCurve,
    CompassCurve,
    CraftMeasure,
    FossenMatrix,
    IntervalEstimate,
    QuadrantMap,
    RollCharacteristics,
    ThrusterCraft,
)
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, InputError, Record, Severity, Ship
from seatrial.estimation.information.covariance import Interval
from seatrial.estimation.information.extrapolation import extrapolation, thruster_conditions
from seatrial.estimation.predict.draws import measure_intervals, perturbed_models
from seatrial.physics.hydro.free_roll import (
    equivalent_damping,
    gyradius_of,
    metacentric_height,
    observed_swings,
    swing_period,
)
from seatrial.physics.manoeuvres import measures
from seatrial.physics.models.candidate_structures import PHYSICAL_SIGNS
from seatrial.physics.models.registry import family_of
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout, layout_of
from seatrial.physics.simulate.steer import RUDDER_RATE, rudder_rate

# The identified roll model in the field's terms: inertia, stiffness, damping, and limits of physics.

# Radius of gyration in roll and metacentric height: one is given or assumed, the natural period gives the other.

GYRADIUS_WITH_ADDED_INERTIA, DRY_GYRADIUS, METACENTRIC_HEIGHT = "k_xx_prime", "k_xx", "GM"

# share of the moment of inertia that the water adds in roll, and radius of gyration with it over the breadth; chosen
ADDED_INERTIA_SHARE, GYRADIUS_OVER_BREADTH = (0.05, 0.18, 0.30), (0.35, 0.40, 0.45)


@dataclass(frozen=True)
class RollInertia:
    """Radius of gyration with added inertia [m], metacentric height [m], and what was given or assumed of them."""

    gyradius: IntervalEstimate | None
    metacentric_height: IntervalEstimate | None
    source: str


def roll_inertia(ship: Ship, c_1: IntervalEstimate) -> RollInertia:
    """Return GM by the ship's `k_xx_prime`, else by `k_xx`; the radius by its `GM`; else GM by the breadth.

    c_1: square of the natural frequency [1/s^2] with its 95 % interval.
    """
    particulars = ship.particulars
    if GYRADIUS_WITH_ADDED_INERTIA in particulars:
        k = particulars[GYRADIUS_WITH_ADDED_INERTIA]
        return _by_gyradius(c_1, (k, k, k), f"{GYRADIUS_WITH_ADDED_INERTIA} of the ship, {k:.4g} m, taken as exact")
    if DRY_GYRADIUS in particulars:
        dry = particulars[DRY_GYRADIUS]
        low, middle, high = (dry * math.sqrt(1.0 + share) for share in ADDED_INERTIA_SHARE)
        share = _range_text(ADDED_INERTIA_SHARE, 100.0)
        source = f"{DRY_GYRADIUS} of the ship, {dry:.4g} m, and an added inertia of {share} % of it, chosen"
        return _by_gyradius(c_1, (low, middle, high), f"{source}; {GYRADIUS_WITH_ADDED_INERTIA} would replace this")
    if METACENTRIC_HEIGHT in particulars:
        return _by_height(c_1, particulars[METACENTRIC_HEIGHT])
    if "B" in particulars:
        low, middle, high = (share * particulars["B"] for share in GYRADIUS_OVER_BREADTH)
        source = f"a radius of gyration of {_range_text(GYRADIUS_OVER_BREADTH, 1.0)} of the breadth, chosen"
        keys = f"{METACENTRIC_HEIGHT}, {GYRADIUS_WITH_ADDED_INERTIA} or {DRY_GYRADIUS}"
        return _by_gyradius(c_1, (low, middle, high), f"{source}; {keys} under [ship] would replace this")
    keys = f"{METACENTRIC_HEIGHT}, {GYRADIUS_WITH_ADDED_INERTIA}, {DRY_GYRADIUS} or B"
    return RollInertia(None, None, f"the inertia is not known; give {keys} under [ship]")


def gyradius_findings(ship: Ship, gyradius: IntervalEstimate | None) -> tuple[Finding, ...]:
    """Return a warning `roll-gyradius` where GM and the period give a radius that is unusual for the stated breadth."""
    values = ship.particulars
    if gyradius is None or METACENTRIC_HEIGHT not in values or not values.get("B", 0.0) > 0.0:
        return ()
    low, usual, high = (share * values["B"] for share in GYRADIUS_OVER_BREADTH)
    if low <= gyradius.value <= high:
        return ()
    share, height = gyradius.value / values["B"], values[METACENTRIC_HEIGHT]
    return (Finding(
        Severity.WARNING, "roll-gyradius", f"GM = {height:g} m and the period give a radius of gyration of "
        f"{significant(share, 2)} of the breadth, ships have {_range_text(GYRADIUS_OVER_BREADTH, 1.0)}", "",
        f"check GM, B and the loading of the tests: with {GYRADIUS_OVER_BREADTH[1]:g} of the breadth GM would be "
        f"{significant(height * (usual / gyradius.value) ** 2, 2)} m",
    ),)  # fmt: skip


def _by_gyradius(c_1: IntervalEstimate, radii: tuple[float, float, float], source: str) -> RollInertia:
    """radii: least, most likely and largest [m]; GM has the whole of their range in its own."""
    low, middle, high = radii
    height = IntervalEstimate(
        metacentric_height(c_1.value, middle), metacentric_height(c_1.lower, low), metacentric_height(c_1.upper, high)
    )
    return RollInertia(IntervalEstimate(middle, low, high), height, source)


def _by_height(c_1: IntervalEstimate, height: float) -> RollInertia:
    radius = IntervalEstimate(
        gyradius_of(c_1.value, height), gyradius_of(c_1.upper, height),
        gyradius_of(c_1.lower, height) if c_1.lower > 0.0 else math.inf,
    )  # fmt: skip
    source = (
        f"{METACENTRIC_HEIGHT} of the ship, {height:.4g} m, taken as exact (the radius goes with its root: half its "
        "error in per cent)"
    )
    return RollInertia(radius, IntervalEstimate(height, height, height), source)


def _range_text(values: tuple[float, float, float], factor: float) -> str:
    low, middle, high = (f"{factor * value:.3g}" for value in values)
    return f"{middle} ({low} to {high})"


# The identified roll model in the field's terms, with what was assumed of its inertia.

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


# What no estimate of a craft should be: masses or damping of the wrong sign, values far off their priors.

MOST_PRIOR_DEVIATIONS = 4.0
"""Standard deviations of its prior that a value may be away from the mean: beyond, prior and records contradict."""

_AMPLITUDES = 20
"""Amplitudes up to the largest measured at which the damping of roll is looked at; chosen."""


def objections(
    model: Model, records: Sequence[Record], errors: Mapping[str, float] = MappingProxyType({})
) -> tuple[str, ...]:
    """Return why the values of a model cannot be a craft's, in phrases; empty where nothing speaks against them.

    records: those that were fitted; the damping of roll is judged over the amplitudes that they show. errors: standard
    deviation that estimated values of the craft put into a coefficient; 0 where it is not named.
    """
    signs, parameters = PHYSICAL_SIGNS.get(family_of(model.name), {}), model.parameters
    turned = [
        f"{name} {parameters[name].value:.2g} is {'negative' if sign > 0 else 'positive'}"
        for name, sign in signs.items()
        if name in parameters and parameters[name].free and sign * parameters[name].value < 0.0
    ]
    far = _far_off_priors(model, errors).values()
    return (*turned, *far, *(_roll_objections(model, records) if not model.has_course else ()))


def _far_off_priors(model: Model, errors: Mapping[str, float]) -> dict[str, str]:
    """The free coefficients that are far off their priors, with how far."""
    far = dict[str, str]()
    for p in model.parameters.free:
        if p.prior is not None and np.isfinite(p.prior.standard_deviation):
            away = abs(p.value - p.prior.mean) / math.hypot(p.prior.standard_deviation, errors.get(p.name, 0.0))
            if away > MOST_PRIOR_DEVIATIONS:
                far[p.name] = f"{p.name} is {away:.1f} standard deviations off its prior"
    return far


def unphysical_finding(
    model: Model,
    records: Sequence[Record],
    errors: Mapping[str, float] = MappingProxyType({}),
    roll: RollCharacteristics | None = None,
) -> tuple[Finding, ...]:
    """Return a warning where an estimated model has values that no craft has; `records`, `errors`: as in `objections`.

    A note where a value is only far off a prior of which nobody knows how far it may be wrong. roll: of the estimate;
    where a ship's damping lies within its intervals, chance alone may have made it implausible, and nothing is said.
    """
    against = objections(model, records, errors)
    if roll is not None and _has_plausible_damping(roll):
        against = tuple(one for one in against if one not in _roll_objections(model, records))
    priors = {p.name: p.prior for p in model.parameters.free if p.prior is not None}
    doubtful = [text for n, text in _far_off_priors(model, errors).items() if priors[n].is_spread_assumed]
    if not against:
        return ()
    if set(against) == set(doubtful):
        advice = "how far the prior may be wrong is assumed (prior_sd_percent): read these values with care"
        return (Finding(Severity.INFO, "unphysical-values", f"unusual: {', '.join(against)}", "", advice),)
    advice = "record a decay from a larger angle, or fix b_2 and b_3 at 0 under [model.fixed]; --choose tries that"
    if "phi" not in model.states or model.has_course:
        advice = "fix these under [model.fixed], or look for what the model lacks; --choose takes no such model"
    what = f"the estimate is implausible: {', '.join(against)}"
    return (Finding(Severity.WARNING, "unphysical-values", what, "", advice),)


def _has_plausible_damping(roll: RollCharacteristics) -> bool:
    """Whether damping that is nowhere negative and never decreases lies within the intervals at all amplitudes."""
    if not roll.amplitude:
        return False
    least = np.maximum.accumulate(np.maximum(roll.damping_lower, 0.0))
    return bool(np.all(least <= np.asarray(roll.damping_upper)))


def _roll_objections(model: Model, records: Sequence[Record]) -> tuple[str, ...]:
    """Damping that is negative, or that decreases with amplitude, between rest and the largest angle measured."""
    names, known = (*DAMPING_NAMES, *RESTORING_NAMES, "phi_0"), model.parameters
    if not set(names) <= set(known.names) or not all("phi" in r for r in records):
        return ()
    b, c = (np.array([known[n].value for n in group]) for group in (DAMPING_NAMES, RESTORING_NAMES))
    largest = max(float(np.nanmax(np.abs(r["phi"] - known["phi_0"].value))) for r in records)
    damping = equivalent_damping(b, c, largest * np.arange(1, _AMPLITUDES + 1) / _AMPLITUDES)[0]
    damping = np.concatenate([b[:1], damping[np.isfinite(damping)]])
    if np.any(damping < 0.0):
        return ("its damping is negative at amplitudes that were measured",)
    slack = 1e-9 * float(np.max(damping))  # rounding of constant damping; chosen
    return ("its damping decreases with amplitude",) if np.any(np.diff(damping) < -slack) else ()


# The identified craft with thrusters in its users' terms: thrust curves, what it does at full command, matrices.

CIRCLE = "turning-circle:35"
"""Of a craft that is steered by an angle, with full command ahead; 35 deg as of a rudder (IMO MSC.137(76)); chosen."""
_PROGRAMMES: Mapping[str, Mapping[str, str]] = {
    "straight:100": {"top_speed": "steady_speed", "surge_time_constant_s": "time_constant_s"},
    "spin:100": {
        "yaw_rate_deg_s": "steady_yaw_rate_deg_s", "time_360_s": "time_360_s", "yaw_time_constant_s": "time_constant_s",
    },
    CIRCLE: {
        "circle_yaw_rate_deg_s": "steady_yaw_rate_deg_s", "tactical_diameter_L": "tactical_diameter_L",
        "time_90_s": "time_90_s",
    },
    "stop:100": {"stopping_distance_m": "stopping_distance_m", "stopping_time_s": "stopping_time_s"},
}  # fmt: skip
"""Programmes that are simulated -> name of a measure here -> among those of the programme."""
_SHARES, _BINS, _HEADINGS = 41, 20, 36
"""Points of a thrust curve, bins of commands, points and bins of a compass curve (every 10 deg); chosen."""
_CELLS, _FASTEST_PERCENTILE = 12, 99.5  # of a quadrant map, to each side; per cent of its samples; chosen
_SPEED_PERCENTILE = 95.0  # of the training runs' speeds ahead: that of the second thrust curve; chosen
# coefficient -> matrix, row, column: the terms of docs/thrusters.md as D(nu) has them
_DAMPING: Mapping[str, tuple[str, int, int]] = {
    "X_u": ("D", 0, 0), "Y_v": ("D", 1, 1), "Y_r": ("D", 1, 2), "N_u": ("D", 2, 0), "N_v": ("D", 2, 1),
    "N_r": ("D", 2, 2), "X_uu": ("D_u", 0, 0), "Y_uv": ("D_u", 1, 1), "N_uu": ("D_u", 2, 0), "N_ur": ("D_u", 2, 2),
    "Y_vv": ("D_v", 1, 1), "N_rr": ("D_r", 2, 2),
}  # fmt: skip
_MEANINGS = {
    "D": "linear damping", "D_u": "damping with |u|", "D_v": "damping with |v|", "D_r": "damping with |r|",
}  # fmt: skip
_NO_MATRIX = ("Y_ur", "N_uv", "N_fin", "D_c")  # terms with the sign of u, and the strips of cross-flow


def thruster_craft(
    model: Model, records: Sequence[Record], basis: IntervalBasis, length: float, held_out: Sequence[Record] = ()
) -> ThrusterCraft | None:
    """Return what follows from the coefficients of a craft with thrusters; None for any other model.

    Args:
        model: at the estimate; records: the training runs.
        basis: covariance of the free coefficients, degrees of freedom, envelope of the training runs.
        length: of the craft [m]; held_out: runs that were not fitted.
    """
    if not model.has_thrusters:
        return None
    layout = layout_of(model)
    matrices = (_inertia(model), *_damping(model), _configuration(model, layout))
    return ThrusterCraft(
        "N" if layout.has_bollard else "N/kg",
        craft_measures(model, basis, length),
        tuple(_curve(model, layout, leader, records, basis) for leader in layout.leaders),
        matrices,
        tuple(t.name for t in layout.thrusters),
        _quadrants(model.equations.layout, records, held_out),
        tuple(n for n in _NO_MATRIX if n in model.parameters and model.parameters[n].value != 0.0),
        _compass(model, records, basis),
    )


def craft_measures(model: Model, basis: IntervalBasis, length: float) -> dict[str, CraftMeasure]:
    """Return what the craft does at full command: speed, turn and stop, with 95 % intervals; SI, turn rate in deg/s.

    A programme through which it cannot be simulated, or not by its thrusters, has no measure.
    """
    from seatrial.physics.simulate.thrust import AHEAD, craft_manoeuvre, craft_programme

    found: dict[str, CraftMeasure] = {}
    layout = layout_of(model)
    rate = rudder_rate(1.0, basis.training_envelope.get(RUDDER_RATE)).value
    for text, names in _PROGRAMMES.items():
        try:
            orders = craft_programme(layout, text)
            full = {AHEAD: 1.0} if text == CIRCLE else {}
            steer = partial(craft_manoeuvre, orders=orders, inputs=full, slew_rate=rate)
            run = steer(model)
            values, intervals = measures(run, length), measure_intervals(model, basis, steer, length)
        except InputError:
            continue
        reached = extrapolation(run, basis.training_envelope, model.equations.layout)
        index = None if reached is None else reached.index
        for name, source in names.items():
            if source in values:
                lower, upper = intervals.get(source) or (None, None)
                found[name] = CraftMeasure(values[source], lower, upper, text, index)
    return found


def _curve(
    model: Model, layout: ThrusterLayout, leader: Thruster, records: Sequence[Record], basis: IntervalBasis
) -> CommandCurve:
    alike = [t for t in layout.thrusters if layout.leader(t) is leader]
    share = np.linspace(-1.0, 1.0, _SHARES)
    ahead = np.concatenate([r["u"][r["u"] > 0.0] for r in records if "u" in r] or [np.zeros(0)])
    speed = float(np.percentile(ahead, _SPEED_PERCENTILE)) if len(ahead) else 0.0
    still, half = _with_band(model, basis, lambda m: _thrust(m, leader, share, 0.0))
    orders = [(r[t.command.channel] - t.command.zero) / t.command.span for r in records for t in alike]
    counts, edges = np.histogram(np.clip(np.concatenate(orders), -1.0, 1.0), _BINS, (-1.0, 1.0))
    return CommandCurve(
        tuple(t.name for t in alike), _floats(share), _floats(still), _floats(still - half), _floats(still + half),
        speed, _floats(_thrust(model, leader, share, speed)), _floats(edges), _floats(counts / max(counts.sum(), 1)),
    )  # fmt: skip


def _thrust(model: Model, thruster: Thruster, share: Array, speed: float) -> Array:
    """Thrust at shares of full command, the craft moving along the thruster at `speed` [m/s]."""
    angle = 0.0 if isinstance(thruster.angle, AngleInput) else thruster.angle
    states, inputs = np.zeros((len(share), len(model.states))), np.zeros((len(share), len(model.input_names)))
    states[:, model.states.index("u")] = speed * math.cos(angle)
    states[:, model.states.index("v")] = speed * math.sin(angle)
    lagging = f"c_{thruster.name}"
    if lagging in model.states:
        states[:, model.states.index(lagging)] = share
    inputs[:, model.input_names.index(thruster.command.channel)] = thruster.command.zero + thruster.command.span * share
    if "voltage" in model.input_names:
        inputs[:, model.input_names.index("voltage")] = model.parameters["V_0"].value
    return model.forces(states, inputs)[f"T_{thruster.name}"].copy()


def _with_band(model: Model, basis: IntervalBasis, curve: Callable[[Model], Array]) -> tuple[Array, Array]:
    """A curve of the estimate and the half width of its 95 % band, to first order, (n,) each."""
    steps = [0.5 * (curve(up) - curve(down)) for up, down in perturbed_models(model, basis)]
    variance = np.sum(np.square(steps), axis=0) if steps else 0.0
    centre = curve(model)
    return centre, two_sided_quantile(STORED_LEVEL, basis.degrees_of_freedom) * np.sqrt(variance + 0.0 * centre)


def _quadrants(layout: str, records: Sequence[Record], held_out: Sequence[Record]) -> tuple[QuadrantMap, ...]:
    """Command over speed of each thruster, training runs and runs held out in the same cells."""
    trained, other = thruster_conditions(layout, records), thruster_conditions(layout, held_out)
    maps = []
    for name, conditions in trained.items():
        both = [conditions, *([other[name]] if name in other else [])]
        reach = max(float(np.percentile(np.abs(c.speed), _FASTEST_PERCENTILE)) for c in both) or 1.0
        edges = np.linspace(-1.0, 1.0, _CELLS + 1), np.linspace(-reach, reach, _CELLS + 1)
        shares = [
            np.histogram2d(np.clip(c.order, -1.0, 1.0), np.clip(c.speed, -reach, reach), edges)[0] / len(c.order)
            for c in both
        ]
        rows = [tuple(_floats(row) for row in share) for share in shares]
        maps.append(QuadrantMap(name, _floats(edges[0]), _floats(edges[1]), rows[0], rows[1] if len(rows) > 1 else ()))
    return tuple(maps)


def _compass(model: Model, records: Sequence[Record], basis: IntervalBasis) -> CompassCurve | None:
    if "compass_A" not in model.parameters:
        return None
    heading = np.linspace(0.0, 2.0 * np.pi, _HEADINGS + 1)
    terms = {"compass_A": np.ones_like(heading), "compass_B": np.sin(heading), "compass_C": np.cos(heading)}

    def deviation(craft: Model) -> Array:
        return np.sum([craft.parameters[n].value * x for n, x in terms.items() if n in craft.parameters], axis=0)

    centre, half = _with_band(model, basis, deviation)
    shown = np.concatenate([r["psi"][np.isfinite(r["psi"])] for r in records if "psi" in r] or [np.zeros(0)])
    counts, _ = np.histogram(np.mod(shown, 2.0 * np.pi), _HEADINGS, (0.0, 2.0 * np.pi))
    return CompassCurve(
        _floats(heading), _floats(centre), _floats(centre - half), _floats(centre + half),
        _floats(counts / max(counts.sum(), 1)),
    )  # fmt: skip


def _inertia(model: Model) -> FossenMatrix:
    """Mass and added mass (Fossen 2021, eqs. (6.14) and (6.40), surge, sway and yaw)."""
    from seatrial.physics.models.thrust_orders import inertia_matrix

    units = tuple(tuple(_inertia_unit(i, j) for j in range(3)) for i in range(3))
    values = tuple(_floats(row) for row in inertia_matrix(model))
    return FossenMatrix("M", "mass and added mass", values, units)


def _inertia_unit(row: int, column: int) -> str:
    return ("kg", "kg m", "kg m^2")[(row == 2) + (column == 2)]


def _damping(model: Model) -> list[FossenMatrix]:
    """D and its parts with |u|, |v| and |r|, as far as they are not zero; the forces are minus these times nu."""
    parts = {name: np.zeros((3, 3)) for name in _MEANINGS}
    for coefficient, (name, row, column) in _DAMPING.items():
        parts[name][row, column] = 0.0 - model.parameters.value_of(coefficient, 0.0)  # not -0
    return [
        FossenMatrix(name, _MEANINGS[name], tuple(_floats(row) for row in part), _damping_units(name))
        for name, part in parts.items()
        if name == "D" or np.any(part)
    ]


def _damping_units(name: str) -> tuple[tuple[str, ...], ...]:
    """Force or moment over (u, v, r), for D_u and D_v over m/s once more, for D_r over rad/s."""
    suffix = {"D": ("kg/s", "kg m/s", "kg m^2/s"), "D_u": ("kg/m", "kg", "kg m"), "D_v": ("kg/m", "kg", "kg m"),
              "D_r": ("kg", "kg m", "kg m^2")}[name]  # fmt: skip
    return tuple(tuple(suffix[(i == 2) + (j == 2)] for j in range(3)) for i in range(3))


def _configuration(model: Model, layout: ThrusterLayout) -> FossenMatrix:
    """B: rows of (cos a, sin a, x sin a - y cos a), the side force of the wash with them (Fossen 2021, section 9.2)."""
    from seatrial.physics.models.thrust_orders import thrust_configuration

    angles = [0.0 if isinstance(t.angle, AngleInput) else t.angle for t in layout.thrusters]
    X, Y, N = thrust_configuration(model, layout.thrusters, angles)
    units = tuple(tuple(unit for _ in layout.thrusters) for unit in ("1", "1", "m"))
    azimuth = any(isinstance(t.angle, AngleInput) for t in layout.thrusters)
    meaning = "forces over thrusts" + (", azimuth thrusters ahead" if azimuth else "")
    return FossenMatrix("B", meaning, (_floats(X), _floats(Y), _floats(N)), units)
