"""From a model to a record: simulate a manoeuvre, or replay the inputs of a record."""

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from seatrial.core.values import InputError

if TYPE_CHECKING:
    from seatrial.core.equations import Model
    from seatrial.core.results import Fit
    from seatrial.core.values import Finding, Record
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.physics.simulate.steer import RudderRate

Steering = Callable[["Model"], "Record"]


def steering(
    model: "Fit | ModelFile | Model",
    manoeuvre: str,
    *,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    duration: float | None = None,
    rudder_rate: float | None = None,
    seed: int = 0,
) -> Steering:
    """Return a function that steers the manoeuvre with any model of these equations, under the file's conditions.

    Args:
        model: a model; or a fit or model file, with their ship and approach condition.
        manoeuvre: e.g. ``zigzag:20/20`` (see `seatrial.manoeuvres`), of a craft with thrusters that turn by their
            angle; of any craft with thrusters ``straight:50``, ``spin:50``, ``stop:50`` (per cent of full command),
            where all are fixed ``zigzag:30/20`` (the same; switching heading in degrees); of a model that only rolls
            ``release:15`` (degrees).
        speed: approach speed, m/s; without it the speed at which surge balances.
        inputs: constant inputs besides the rudder, SI; without them those of the trials. ``ahead``: order ahead of a
            manoeuvre that thrusters steer, share of full command; by default 0.5, or that of the speed.
        duration: s at most.
        rudder_rate: rad/s; without it that of `rudder_rate_of`.
        seed: of a random binary sequence.

    Raises:
        InputError: unknown manoeuvre, or a rudder that cannot move.
    """
    file = as_model_file(model)
    _refuse_no_number(speed)
    if file.model.has_thrusters:
        return _by_thrusters(file, _with_seed(manoeuvre, seed), speed, inputs, duration, rudder_rate)
    if file.model.is_roll:
        return _by_release(file.model, manoeuvre, speed, inputs, duration, rudder_rate)
    from seatrial.physics.manoeuvres.programme import programme
    from seatrial.physics.simulate.steer import manoeuvre as steered

    rate = rudder_rate_of(file, rudder_rate).value
    constant = {name: value for name, value in file.approach.items() if name in file.model.input_names}
    approach_speed = file.approach.get("u") if not file.model.has_speed else None
    orders = programme(_with_seed(manoeuvre, seed))

    def steer(ship: "Model") -> "Record":
        return steered(
            ship,
            orders,
            duration=duration,
            speed=approach_speed if speed is None else speed,
            inputs={**constant, **(inputs or {})},
            slew_rate=rate,
        )

    return steer


def rudder_rate_of(model: "Fit | ModelFile | Model", given: float | None = None) -> "RudderRate":
    """Return the rate at which a manoeuvre moves the rudder, and where it is from.

    The given one, rad/s; without it the fastest sustained move of the training runs, where it is clearly faster than
    SOLAS requires at the ship's scale (chapter II-1, regulation 29.3.2), or else SOLAS's.

    Raises:
        InputError: the given rate is not positive.
    """
    from seatrial.physics.simulate.steer import RudderRate

    if given is None:
        return as_model_file(model).rudder_rate
    if not 0.0 < given < math.inf:
        raise InputError(
            f"the rudder rate {math.degrees(given):g} deg/s is not positive; leave it out for that of the training "
            "runs or SOLAS's"
        )
    return RudderRate(given, "as given")


def _by_thrusters(
    file: "ModelFile",
    manoeuvre: str,
    speed: float | None,
    inputs: Mapping[str, float] | None,
    duration: float | None,
    rudder_rate: float | None,
) -> Steering:
    from seatrial.physics.manoeuvres.thrust_programme import ThrustProgramme
    from seatrial.physics.models.thruster_layout import layout_of
    from seatrial.physics.simulate.thrust import craft_manoeuvre, craft_programme, refuse_rudder_options

    orders = craft_programme(layout_of(file.model), manoeuvre)
    if isinstance(orders, ThrustProgramme):
        refuse_rudder_options(orders, speed, rudder_rate)
    rate = rudder_rate_of(file, rudder_rate).value
    return lambda craft: craft_manoeuvre(craft, orders, duration=duration, speed=speed, inputs=inputs, slew_rate=rate)


def _by_release(
    model: "Model",
    manoeuvre: str,
    speed: float | None,
    inputs: Mapping[str, float] | None,
    duration: float | None,
    rudder_rate: float | None,
) -> Steering:
    from seatrial.physics.simulate.steer import natural_period, release

    if speed is not None or rudder_rate is not None or inputs:
        raise InputError("a release needs no speed, no rudder rate and no inputs; leave them out")
    period = natural_period(model)
    release(model, manoeuvre, period, duration)
    return lambda ship: release(ship, manoeuvre, period, duration)


def simulate(
    model: "Fit | ModelFile | Model",
    manoeuvre: "str | Record",
    *,
    speed: float | None = None,
    inputs: Mapping[str, float] | None = None,
    duration: float | None = None,
    rudder_rate: float | None = None,
    seed: int = 0,
    session: str | None = None,
    waves: bool = False,
) -> "Record":
    """Simulate a manoeuvre, or the inputs of a record, with a model and return the record of it.

    Args:
        model: a model; or a fit or model file, with their ship and approach condition.
        manoeuvre: e.g. ``zigzag:20/20``, ``turning-circle:35``, or a record whose inputs drive the model: a measured
            one from the state that its first seconds show, as `identify` predicts it, a simulated one from its first
            sample, a planned one from a straight run.
        speed: approach speed, m/s; without it the speed at which surge balances.
        inputs, duration, rudder_rate, seed: of a manoeuvre, as in `steering`; its angles and commands are true ones.
        session: of a measured record, as in `predict`: what the fit found its inputs to be off by is corrected.
        waves: whether sensors show the waves of the training runs on top of the craft's motion; drawn by `seed`.

    Raises:
        InputError: unknown manoeuvre, a rudder that cannot move, an input or speed that nothing states, a simulation
            that diverges, or waves where the training runs showed none.
    """
    file = as_model_file(model)
    _refuse_no_number(speed)
    if isinstance(manoeuvre, str):
        record = steering(
            file, manoeuvre, speed=speed, inputs=inputs, duration=duration, rudder_rate=rudder_rate, seed=seed
        )(file.model)
    else:
        record = _replayed(file, manoeuvre, speed, session)
    return in_waves(file, record, seed) if waves else record


def in_waves(model: "Fit | ModelFile | Model", record: "Record", seed: int = 0) -> "Record":
    """Return a simulated record as sensors show it in the waves of the training runs.

    seed: of the waves.

    Raises:
        InputError: the training runs showed none.
    """
    import numpy as np

    from seatrial.physics.sensors.wave_motion import realised

    file, rng = as_model_file(model), np.random.default_rng(seed)
    if not file.waves:
        raise InputError("the model's training runs showed no waves that its sensors could show; leave out --waves")
    for peak in file.waves:
        for channel, motion in realised(peak.rms, peak.frequency, peak.damping, record.time, rng).items():
            if channel in record:
                moved = record.channel(channel)
                record = record.with_channel(channel, moved.with_values(moved.values + motion))
    return record


def _refuse_no_number(speed: float | None) -> None:
    """Raises:
    InputError: an approach speed is NaN or infinite, whether or not the model has a speed.
    """
    if speed is not None and not math.isfinite(speed):
        raise InputError(f"the approach speed {speed:g} m/s is no finite number; state it in m/s, or leave it out")


def _replayed(model: "ModelFile", record: "Record", speed: float | None, session: str | None) -> "Record":
    """The run by its inputs; a measured motion is noisy, so that its start is estimated."""
    from seatrial.api.prediction import predict

    if is_measured_motion(model, record):
        return predict(model, record, session).simulated
    return replay(model, record, speed)


def is_measured_motion(model: "ModelFile", record: "Record") -> bool:
    """Return whether a record was measured and shows states of the model, so that it is simulated as a logged run."""
    from seatrial.core.values import RecordKind

    return record.kind is RecordKind.MEASURED and bool(set(model.model.states) & set(record.channels))


def replay(model: "ModelFile", record: "Record", speed: float | None = None) -> "Record":
    """Simulate the inputs of a record from its first sample; those of one without a motion from a straight run.

    Args:
        speed: approach speed of a record without a motion, m/s; without it the speed at which surge balances, or rest
            of a craft with thrusters.

    Raises:
        InputError: an input channel is missing, a command lies beyond its span, or the simulation diverges.
    """
    from seatrial.core.values import RecordKind
    from seatrial.data.check import refuse_impossible_commands
    from seatrial.physics.simulate import replay
    from seatrial.physics.simulate.states import straight_run

    refuse_impossible_commands(model.model, record)
    is_planned = record.kind is RecordKind.PLANNED or not set(model.model.states) & set(record.channels)
    return replay(model.model, record, straight_run(model.model, record, speed) if is_planned else None)


def as_model_file(model: "Fit | ModelFile | Model") -> "ModelFile":
    """Return the model file as it is, that of a fit, or one that holds the bare model."""
    from seatrial.core.results import Fit
    from seatrial.data.folder.model_file import ModelFile
    from seatrial.data.folder.result_folder import model_of_fit

    if isinstance(model, Fit):
        return model_of_fit(model)
    return model if isinstance(model, ModelFile) else ModelFile(model)


def _with_seed(manoeuvre: str, seed: int) -> str:
    """Return the programme's text; a random binary sequence without a seed of its own gets this one."""
    kind, *fields = manoeuvre.strip().split(":")
    if kind != "prbs" or len(fields) > 2:
        return manoeuvre
    return ":".join(["prbs", *fields, *["20", ""][len(fields) :], str(seed)])


_HELD = 0.98  # of a rate of the propeller, below which its fall in the training runs is said; chosen: beyond noise


def propeller_rate_text(model: "ModelFile", simulated: "Record") -> str:
    """Return that a simulated run holds the propeller's rate although it fell in the training runs; empty: it did not.

    An engine slows down as a turn loads its propeller: held at its rate, a ship turns and runs faster than it does.
    """
    from seatrial.estimation.information.extrapolation import PROPELLER_RATE

    slowest = None if model.interval_basis is None else model.interval_basis.training_envelope.get(PROPELLER_RATE)
    if slowest is None or "n" not in simulated:
        return ""
    held = float(abs(simulated["n"]).min())
    if not 0.0 < slowest < _HELD * held:
        return ""
    return (
        f"the propeller turns at {held:.3g} rps ({60.0 * held:.0f} rpm) throughout; in the training runs it fell to "
        f"{slowest:.3g} rps ({60.0 * slowest:.0f} rpm): for a turn with that rate --set n={slowest:.3g}"
    )


def course_findings(
    model: "ModelFile", manoeuvre: str, inputs: Mapping[str, float] | None = None
) -> "tuple[Finding, ...]":
    """Return a note `course-unstable` where a straight run of a craft with thrusters is not one that it holds.

    Empty for other manoeuvres, for ships with a rudder, and where the craft holds its course or may do so.

    Args:
        manoeuvre: as `simulate` takes it, ``straight:50``; inputs: other inputs held constant, by name, SI.
    """
    import numpy as np

    from seatrial.estimation.identify.identifiability import course_finding, course_stability
    from seatrial.physics.manoeuvres.thrust_programme import thrust_programme

    if not model.model.has_thrusters or not manoeuvre.startswith("straight:"):
        return ()
    ahead, basis = thrust_programme(manoeuvre).ahead or 0.0, model.interval_basis
    approach = {**model.approach, **(inputs or {})}
    count = len(model.model.parameters.free)
    course = course_stability(
        model.model,
        np.zeros((count, count)) if basis is None else basis.covariance,
        math.inf if basis is None else basis.degrees_of_freedom,
        approach,
        1.0 if model.ship is None else model.ship.particulars.get("L", 1.0),
        ahead,
    )
    return course_finding(model.model, course, approach)
