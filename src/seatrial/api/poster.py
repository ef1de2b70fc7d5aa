"""Wheelhouse poster and pilot card from a fit."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.api.measured_runs import Reading
    from seatrial.core.results import Fit
    from seatrial.core.results.poster import Poster, PosterManoeuvre
    from seatrial.core.values import ProgressReporter

RUDDER_DEG = 35.0
"""Rudder angle of the turning circles: the maximum rudder angle of most ships (MSC.137(76), 4.2.2)."""
_RUDDER_TOLERANCE_DEG, _HEADING_TOLERANCE_DEG = 1.0, 2.0
"""How far rudder angle and switching heading of a measured run may be from those of the poster, degrees; chosen."""
_SPEED_TOLERANCE = 0.1
"""How far its approach speed may be, as a share: a test speed is at least 90 % of the ship's (MSC.137(76), 4.2.1)."""
_ZIGZAG_DEG = (10, 20)
"""Rudder angle and switching heading of the zigzags, degrees (MSC.137(76), 4.2.6)."""
_TURNING = ("advance_L", "transfer_L", "tactical_diameter_L", "steady_diameter_L", "time_90_s", "speed_loss")
_ZIGZAG = ("overshoot_1_deg", "overshoot_2_deg", "initial_turning_L", "initial_turning_time_s")


@dataclass(frozen=True)
class _Order:
    """A manoeuvre of the poster.

    Attributes:
        side: +1 to starboard, -1 to port; switching_deg: heading of a zigzag, None for a turning circle.
    """

    manoeuvre: str
    rudder_deg: float
    side: int
    names: tuple[str, ...]
    switching_deg: float | None = None


def poster(
    fit: "Fit",
    *,
    rudder_deg: float = RUDDER_DEG,
    speed: float | None = None,
    report_progress: "ProgressReporter | None" = None,
) -> "Poster":
    """Return the manoeuvring characteristics of a fit for the wheelhouse (IMO A.601(15)): circles and zigzags.

    Each number is measured (a run of the trials is that manoeuvre at that speed), predicted, or extrapolated (the model
    leaves what its training runs cover), and has its 95 % interval. What runs measured is corrected for the current
    where the fit estimated one for their session; of several runs the largest value is given.

    Args:
        rudder_deg: of the turning circles; speed: approach speed, m/s; without it that of the trials.

    Raises:
        InputError: the model has no rudder or heading, the ship no length, or no manoeuvre can be steered.
    """
    from seatrial.api.measured_runs import readings_of
    from seatrial.api.simulation import rudder_rate_of
    from seatrial.core.results.poster import Poster
    from seatrial.core.values.versions import versions
    from seatrial.estimation.predict.draws import models_at_scale
    from seatrial.physics.simulate.thrust import is_steered_by_angle

    if not is_steered_by_angle(fit.model):
        raise InputError(
            f"model '{fit.model.name}' has no rudder or no heading: a wheelhouse poster shows turning circles and "
            "zigzags; take a fit of a steered ship"
        )
    if not 0.0 < rudder_deg <= 90.0:
        raise InputError(f"a rudder angle of {rudder_deg:g} deg turns no ship; give one such as 35")
    report = report_progress or (lambda _: None)
    orders, readings = _orders(rudder_deg), readings_of(fit)
    manoeuvres, measured_at = [], _speed_of_trials(readings) if speed is None else speed
    for number, order in enumerate(orders, 1):
        report(f"manoeuvres: {number} of {len(orders)}, {order.manoeuvre}")
        manoeuvres.append(
            _manoeuvre(fit, order, speed, [reading for reading in readings if _shows(reading, order, measured_at)])
        )
    if not any(m.quantities for m in manoeuvres):
        raise InputError(f"no manoeuvre of the poster can be steered with this fit: {manoeuvres[0].note}")
    held_out, rate = {p.record for p in fit.validation}, rudder_rate_of(fit)
    simulated = [record for m in manoeuvres for record in m.simulated]
    has_scale_effects = any(models_at_scale(fit.model, run, fit.ship.length, fit.ship.scale) for run in simulated)
    return Poster(
        fit.ship.name, dict(fit.ship.particulars), fit.ship.scale, fit.model.name,
        _approach_speed(fit, speed, manoeuvres), rudder_deg, tuple(manoeuvres), rate.value, rate.origin,
        tuple(r.name for r in fit.records if r.name not in held_out), fit.intervals,
        has_scale_effects, versions(),
    )  # fmt: skip


def write_poster(poster: "Poster", path: str | Path) -> Path:
    """Write a poster as one HTML page that prints on a sheet of A4. Returns its path.

    Raises:
        InputError: the file cannot be written.
    """
    from seatrial.core.values.files import write_atomically
    from seatrial.reporting.poster import html

    write_atomically(Path(path), html(poster).encode())
    return Path(path)


def _orders(rudder_deg: float) -> tuple[_Order, ...]:
    """Circles to both sides; 10/10 and 20/20 zigzags, first to starboard (MSC.137(76), section 4.2)."""
    circle = f"turning-circle:{rudder_deg:g}"
    return (
        _Order(f"{circle}:port", rudder_deg, -1, _TURNING),
        _Order(circle, rudder_deg, 1, _TURNING),
        *(_Order(f"zigzag:{angle}/{angle}", float(angle), 1, _ZIGZAG, float(angle)) for angle in _ZIGZAG_DEG),
    )


def _approach_speed(fit: "Fit", speed: float | None, manoeuvres: "Sequence[PosterManoeuvre]") -> float:
    """That of the simulated manoeuvres through the water [m/s]: where none is given, where surge balances.

    Craft with thrusters begin at half command, as their runs do at rest; a model without surge at that of the trials.
    """
    from seatrial.api.prediction import measures
    from seatrial.api.simulation import as_model_file
    from seatrial.physics.simulate.thrust import straight_by_thrusters

    if speed is not None:
        return speed
    file = as_model_file(fit)
    begun = (measures(file, record) for m in manoeuvres for record in m.simulated)
    balanced = next((one["approach_speed"] for one in begun if "approach_speed" in one), None)
    if balanced is not None:
        return balanced
    return straight_by_thrusters(file.model).speed if file.model.has_thrusters else file.approach.get("u", 0.0)


def _speed_of_trials(readings: "Sequence[Reading]") -> float | None:
    """Median approach speed of the measured runs [m/s]: that of their propulsion, which the model may miss."""
    from statistics import median

    speeds = [reading.values["approach_speed"] for reading in readings if "approach_speed" in reading.values]
    return median(speeds) if speeds else None


def _manoeuvre(fit: "Fit", order: _Order, speed: float | None, runs: "Sequence[Reading]") -> "PosterManoeuvre":
    """The model steered through it; what these runs of the trials measured of it takes the predictions' place."""
    from seatrial.api.measured_runs import measured_quantity
    from seatrial.api.prediction import extrapolation, measure_intervals, measures
    from seatrial.api.simulation import as_model_file, steering
    from seatrial.core.results.poster import Basis, PosterManoeuvre, PosterQuantity
    from seatrial.reporting.measures import EDGE_INDEX

    file = as_model_file(fit)
    try:
        steer = steering(file, order.manoeuvre, speed=speed)
        simulated = steer(file.model)
        values, intervals = measures(file, simulated), measure_intervals(file, steer)
    except InputError as error:
        return PosterManoeuvre(order.manoeuvre, (), note=str(error))
    left = extrapolation(file, simulated)
    basis = Basis.EXTRAPOLATED if left is not None and left.index > EDGE_INDEX else Basis.PREDICTED

    def quantity(name: str) -> PosterQuantity:
        measured = measured_quantity(name, runs)
        if measured is not None:
            return measured
        lower, upper = intervals.get(name) or (None, None)
        is_open = name in intervals and intervals[name] is None
        return PosterQuantity(name, values[name], lower, upper, basis, is_determined=not is_open)

    present = [n for n in order.names if n in values]
    quantities = tuple(quantity(n) for n in present)
    shown = tuple(run.run for run in runs) if any(q.basis is Basis.MEASURED for q in quantities) else ()
    return PosterManoeuvre(order.manoeuvre, quantities, (simulated,), shown)


def _shows(run: "Reading", order: _Order, speed: float | None) -> bool:
    """Whether a run is this manoeuvre at this approach speed; a zigzag begins to either side."""
    import numpy as np

    from seatrial.physics.manoeuvres import ManoeuvreKind

    approach = run.values.get("approach_speed")
    if approach is None or not speed or abs(approach / speed - 1.0) > _SPEED_TOLERANCE:
        return False
    observed, is_zigzag = run.manoeuvre, order.switching_deg is not None
    kinds = {ManoeuvreKind.ZIGZAG} if is_zigzag else {ManoeuvreKind.TURNING_CIRCLE, ManoeuvreKind.PULL_OUT}
    if observed.kind not in kinds:
        return False
    angle = np.degrees((observed.holds[0] if is_zigzag else observed.longest_hold[0]).angle)
    if order.switching_deg is None:
        return bool(abs(angle - order.side * order.rudder_deg) <= _RUDDER_TOLERANCE_DEG)
    turned = np.degrees(abs(observed.psi_at(observed.executes[1]) - observed.psi_at(observed.executes[0])))
    is_angle = abs(abs(angle) - order.rudder_deg) <= _RUDDER_TOLERANCE_DEG
    return bool(is_angle and abs(turned - order.switching_deg) <= _HEADING_TOLERANCE_DEG)
