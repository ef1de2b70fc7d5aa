"""Errors of instruments that nobody stated: places, lags, scales and biases, and delays of inputs."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise

import numpy as np

from seatrial.core.equations.augment import biased_name
from seatrial.core.results import Prediction
from seatrial.core.text.numbers import percent, significant
from seatrial.core.text.words import NAMES_SHOWN, enumeration
from seatrial.core.values import Array, Finding, Record, Severity
from seatrial.core.values.arrays import early_turns
from seatrial.estimation.estimate.assemble import UNIFORM, is_course_open
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.estimate.point_estimate import (
    NEGLIGIBLE_IN_ROUND,
    PointEstimate,
    effective_inflation,
    residual_correlation,
    residual_spread,
)
from seatrial.estimation.estimate.process_noise import ProcessNoise, third_difference_noise
from seatrial.estimation.identify.score_test import Candidate, OutputSlopes, ScoreTest, added_input, score_test
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.prediction_error import join_segments
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.sensors import Sensors, VelocityReference
from seatrial.physics.sensors.measured_outputs import lag_name
from seatrial.physics.sensors.settings import LAG_START, TIMED_CHANNELS, Antenna, Late

# A warning where the sway velocity is missed in step with the yaw rate, as if it were measured at another place.

# share of the difference's square that a place explains, its distance over the length, and the difference over the
# motion, from which on it is named; chosen: less is what a model of sway misses
_LEAST_SHARE, _LEAST_DISTANCE, _LEAST_ERROR = 0.6, 0.05, 0.25


def antenna_findings(predictions: Sequence[Prediction], length: float) -> tuple[Finding, ...]:
    """Return a warning `antenna-place` with the place at which the recorded sway would be that of the model.

    Held-out runs decide where there are any: a fit takes the place for sway in the runs that it is fitted to. A
    receiver x forward of the origin moves sideways with v + x r (Fossen 2021, section 2.2). length: of the craft [m].
    """
    held = [p for p in predictions if p.role == "validation"]
    runs = [p for p in held or predictions if p.divergence is None and all("v" in r for r in (p.measured, p.simulated))]
    runs = [p for p in runs if "r" in p.measured]
    if not runs or not length > 0.0:
        return ()
    samples = np.concatenate([(p.measured["v"] - p.simulated["v"], p.measured["r"], p.measured["v"]) for p in runs], 1)
    difference, rate, sway = samples[:, np.isfinite(samples).all(axis=0)]
    power = float(difference @ difference)
    if not power > (_LEAST_ERROR**2) * float(sway @ sway) or not float(rate @ rate) > 0.0:
        return ()
    place = float(difference @ rate) / float(rate @ rate)
    share = 1.0 - float(np.sum((difference - place * rate) ** 2)) / power
    if share < _LEAST_SHARE or abs(place) < _LEAST_DISTANCE * length:
        return ()
    side = "forward" if place > 0.0 else "aft"
    return (Finding(
        Severity.WARNING, "antenna-place", f"the recorded sway velocity differs from the model's in step with the yaw "
        f"rate, as if it were measured {significant(abs(place), 2)} m {side} of where the file says",
        f"this would explain {percent(share)} % of the difference",
    ),)  # fmt: skip


# Delays of inputs that are longer than what their sample interval leaves open: the recorder's, or the model's.

_CERTAIN = 2.0  # standard errors by which a delay exceeds a sample, an error differs from none: 95 %
_LAGS = np.geomspace(0.5, 4.0, 12)  # times of a lag that are tried, over the delay; chosen
_EVALUATIONS = 40  # of each search with a lag; chosen
_MOST_LEFT = 0.95  # of the residuals' standard deviation that a lag leaves where it is named; chosen


def delay_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning `input-delay` for each input whose estimated delay exceeds its sample interval in a session."""
    problem, error = estimation.estimate.problem, estimation.interval.standard_error
    first, width = len(problem.session_parameters), problem.unknowns_per_session
    found = []
    for j, nuisance in enumerate(problem.nuisances, start=first):
        if nuisance.correction.kind != "delay":
            continue
        sample = UNIFORM * nuisance.prior.standard_deviation if nuisance.is_spread_fixed else problem.data.dt
        delays = estimation.estimate.session_offsets[:, j]
        errors = error[len(problem.free) :].reshape(-1, width)[:, j]
        late = {
            s: float(d)
            for s, d, e in zip(problem.data.sessions, delays, errors, strict=True)
            if abs(d) - _CERTAIN * e > sample
        }
        if late:
            name = nuisance.correction.input
            remedy = _lag_remedy(estimation, name, max(late.values(), key=abs))
            found.append(_finding(name, late, sample, remedy))
    return tuple(found)


@dataclass(frozen=True)
class _Lag:
    """What a lag of an input leaves: its time [s], residuals over those without it, the coefficients with it."""

    time: float
    remainder: float
    values: tuple[tuple[str, float], ...]

    @property
    def sentence(self) -> str:
        """Return that in words."""
        values = enumeration([f"{name} {significant(value, 3)}" for name, value in self.values], NAMES_SHOWN)
        return (
            f"tried here: a lag of {significant(self.time, 2)} s between its record and the craft leaves "
            f"{significant(self.remainder, 2)} of the residuals, with {values}"
        )


def _lag_remedy(estimation: Estimation, name: str, delay: float) -> _Lag | None:
    """The lag of an input that leaves least by output error over whole runs; None where none leaves clearly less."""
    problem, first = join_segments(estimation.estimate.problem)
    if delay <= 0.0 or problem.pinned is not None:
        return None
    problem = replace(problem, data=replace(problem.data, run_inputs=None))
    point, local = estimation.estimate.common_parameters, estimation.estimate.optimum.local[first]
    column = problem.model.input_names.index(name)
    fits = []
    for time in (0.0, *(delay * _LAGS).tolist()):
        lagged = _with_lag(problem, column, time)
        found = levenberg_marquardt(lagged, point, local, evaluations=_EVALUATIONS)
        error = lagged.simulated_outputs(found.solution.point, found.local) - problem.data.measured
        fits.append((time, float(np.sqrt(np.nanmean((error / problem.noise) ** 2))), found.solution.point))
    time, left, values = min(fits, key=lambda fit: fit[1])
    if not left <= _MOST_LEFT * fits[0][1]:
        return None
    return _Lag(time, left / fits[0][1], tuple(zip(problem.free, map(float, values), strict=False)))


def _with_lag(problem: OutputError, column: int, time: float) -> OutputError:
    """The problem with an input that follows its record by a lag of first order, at rest where a run begins."""
    if time == 0.0:
        return problem
    model, inputs = problem.model, problem.data.inputs.copy()
    name = model.input_names[column]
    for a, b in pairwise(problem.data.offsets):
        inputs[a:b, column] = lagged_values(inputs[a:b, column], time / problem.data.dt, is_held=name in model.held)
    return replace(
        problem, model=model.with_held(model.held - {name}), data=replace(problem.data, inputs=inputs)
    )  # fmt: skip


def lagged_values(values: Array, samples: float, *, is_held: bool) -> Array:
    """Return values behind a lag of first order, (n,), exact where they are held or run straight between samples.

    samples: the lag's time constant.
    """
    from scipy.signal import lfilter

    keep = np.exp(-1.0 / samples)
    share = samples * (1.0 - keep)
    weights = np.array([0.0, 1.0 - keep] if is_held else [1.0 - share, share - keep])
    return np.asarray(lfilter(weights, [1.0, -keep], values, zi=[(1.0 - weights[0]) * values[0]])[0])


def _finding(name: str, delays: dict[str, float], sample: float, remedy: _Lag | None) -> Finding:
    longest = max(delays.values(), key=abs)
    sizes = enumeration([f"{significant(d, 2)} s in {s}" for s, d in delays.items()], NAMES_SHOWN)
    way = "after" if longest > 0.0 else "before"
    return Finding(
        Severity.WARNING, "input-delay", f"{name} acts more than a sample {way} its record",
        f"{sizes}; a sample every {significant(sample, 2)} s" + (f"; {remedy.sentence}" if remedy else ""),
    )  # fmt: skip


# Errors of instruments that nobody stated: estimated where a pair of channels shows them, else inside the intervals.

_BIAS, _SCALE = 0.02, 0.05  # rad/s and 1: standard deviations of a yaw rate's zero and scale, before records; chosen
_LEAST_BIAS, _LEAST_SCALE = 0.002, 0.01  # rad/s and 1: below, a good rate gyro may be off; chosen
_LEAST_LEVER = 0.05  # of the ship's length, as in `antenna_place`: less is what a model of sway misses; chosen
_LEAST_LAG = 0.2  # s: below, the model of a slow craft that is not its own may well ask for it; chosen
_LEAST_SLOPE = 1e-12  # of a channel that does not move, for a division
_LAG = 1.0  # s, that of a lag where it is sought; chosen: filters of receivers and compasses
_ANY_PLACE = 3.0**-0.5  # standard deviation of a place that is uniform from -1 to 1
_MOST = 4.0  # deviations up to which it is an instrument's error; beyond, it is what the model misses; chosen
_LIKELIER = 25.0  # twice the gain of likelihood from which an error is sought, five standard errors; chosen
_ERROR_STEP = 0.1  # of such an error's deviation, of differences by it: a filter follows what it is shown; chosen
_ERROR_EVALUATIONS = 12  # of a short search beside such errors; chosen


@dataclass(frozen=True, eq=False)
class SensorError:
    """An error of an instrument.

    Attributes:
        name: of the coefficient that a model with sensors has of it; unit: of that.
        deviation: standard deviation where it is sought; undetected: where nothing shows it, 0: it then is none.
        negligible: size up to which it is what a model misses or a sample leaves open, and stays inside the intervals.
        problem_with: the problem of records from which an error of a size is taken; least: smallest that there is.
    """

    name: str
    unit: str
    deviation: float
    undetected: float
    negligible: float
    problem_with: Callable[[OutputError, float], OutputError]
    least: float = -np.inf


def _measured(slopes: Mapping[str, Array]) -> Callable[[OutputError, float], OutputError]:
    """The problem of records without an error; slopes: channel -> what a unit of it adds to what is shown, (rows,)."""

    def problem_with(problem: OutputError, size: float) -> OutputError:
        measured = problem.data.measured.copy()
        channels = [output.removesuffix(biased_name("")) for output in problem.data.outputs]
        for channel, slope in slopes.items():
            measured[:, channels.index(channel)] -= size * slope
        return replace(problem, data=replace(problem.data, measured=measured))

    return problem_with


@dataclass(frozen=True, eq=False)
class Suspect:
    """An instrument with errors that go together, in words and as the setting that has them estimated.

    key: of the setting; reverse: in words where its error is negative.
    """

    description: str
    errors: tuple[SensorError, ...]
    stated: Callable[[Sensors], Sensors]
    key: str
    reverse: str = ""

    def text(self, sizes: Mapping[str, float]) -> str:
        """Return what is wrong with it, by errors of these sizes."""
        is_reverse = bool(self.reverse) and sizes[self.errors[0].name] < 0.0
        return self.reverse if is_reverse else self.description

    def matters(self, sizes: Mapping[str, float], spread: Mapping[str, float]) -> bool:
        """Whether errors of these sizes and standard errors are possible, and one certainly is not negligible."""
        return all(sizes[e.name] >= e.least and abs(sizes[e.name]) <= _MOST * e.deviation for e in self.errors) and any(
            abs(sizes[e.name]) - _CERTAIN * spread[e.name] > e.negligible for e in self.errors
        )


@dataclass(frozen=True, eq=False)
class _Motion:
    """The motion by compared channel, (rows,), and its rates."""

    channels: Mapping[str, Array]
    rates: Mapping[str, Array]

    @classmethod
    def of_estimate(cls, estimate: PointEstimate | ProcessNoise) -> "_Motion":
        """Return the simulated motion, or that which is predicted from samples up to the one before."""
        if isinstance(estimate, ProcessNoise):
            outputs = estimate.output_error.data.outputs
            parts = [_predicted(estimate, run) for run in range(estimate.problem.runs.data.count)]
        else:
            data, outputs = estimate.problem.data, estimate.problem.data.outputs
            simulated = estimate.problem.simulated_outputs(estimate.common_parameters, estimate.optimum.local)
            parts = [(simulated[a:b], np.gradient(simulated[a:b], data.dt, axis=0)) for a, b in pairwise(data.offsets)]
        motion, rates = (np.concatenate(columns).T for columns in zip(*parts, strict=True))
        return cls(dict(zip(outputs, motion, strict=True)), dict(zip(outputs, rates, strict=True)))


def _predicted(noise: ProcessNoise, run: int) -> tuple[Array, Array]:
    """Outputs of a run and their rates, both (rows, ny): two steps ahead of the sample before, and their difference."""
    problem = noise.problem
    first, end = (int(edge) for edge in problem.runs.data.offsets[run : run + 2])
    origins = np.arange(end - first - 2)
    ahead = problem.predicted_ahead(noise.optimum.solution.point, run, origins, 2)
    rates = (ahead[:, 2] - ahead[:, 0]) / (2.0 * problem.runs.data.dt)
    motion = np.concatenate([ahead[:1, 0], ahead[:, 1], ahead[-1:, 2]])
    return motion, np.concatenate([rates[:1], rates, rates[-1:]])


def _of_yaw(motion: _Motion, timing: "_Timing") -> Iterator[Suspect]:
    """Errors of a compass and a yaw rate that are read together."""
    r, ones = motion.channels["r"], np.ones(len(motion.channels["r"]))
    yield Suspect(
        "the yaw rate has a bias", (SensorError("r_bias", "rad/s", _BIAS, _BIAS, _LEAST_BIAS, _measured({"r": ones})),),
        lambda s: replace(s, yaw_rate_bias=True), "yaw_rate_bias",
    )  # fmt: skip
    yield Suspect(
        "the yaw rate is scaled", (SensorError("r_scale", "1", _SCALE, _SCALE, _LEAST_SCALE, _measured({"r": r})),),
        lambda s: replace(s, yaw_rate_scale=True), "yaw_rate_scale",
    )  # fmt: skip
    for late, channel in ((Late.HEADING, "psi"), (Late.YAW_RATE, "r")):
        yield timing.late(late, {channel: -motion.rates[channel]}, 0.0)


@dataclass(frozen=True, eq=False)
class _Timing:
    """What is known of the timing of measured channels.

    Attributes:
        delays: as `instrument_errors` has them; noise: channel -> standard deviation of its white noise.
        is_known: whether the trial states that its inputs are on time: the clock of the log is right, so that no
            channel has a lag but one that the records show.
    """

    records: Sequence[Record]
    delays: Mapping[str, float | None]
    noise: Mapping[str, float]
    is_known: bool

    def late(self, late: Late, slopes: Mapping[str, Array], least: float) -> Suspect:
        """Return a lag; the sample interval of its source leaves open half of it to either side, as with inputs.

        It is negligible as far as it moves no channel by more than the noise there: of a slow craft that is long.
        """
        channels = TIMED_CHANNELS[late]
        interval = max(r.channel(c).sample_s or r.dt for r in self.records for c in channels if c in r)
        stated = [deviation for c in channels if (deviation := self.delays.get(c)) is not None]
        hidden = min(self.noise[c] / max(float(np.std(slope)), _LEAST_SLOPE) for c, slope in slopes.items())
        deviation, negligible = 0.0 if 0.0 in stated else _LAG, max(0.5 * interval, min(_LEAST_LAG, hidden))
        undetected = min(stated, default=0.0 if self.is_known else interval / UNIFORM)
        error = SensorError(lag_name(late), "s", deviation, undetected, negligible, _measured(slopes), least)
        instrument = f"the {late.replace('_', ' ')}"
        return Suspect(
            f"{instrument} is late", (error,), lambda s: replace(s, late={**s.late, late: LAG_START[late]}), "late",
            f"{instrument} is early, or all else is late",
        )  # fmt: skip


def _of_receiver(motion: _Motion, timing: _Timing, stated: Sensors, length: float | None) -> Iterator[Suspect]:
    """Errors of a receiver whose track is read beside a compass; length: as of `instrument_errors`."""
    psi, zero = motion.channels["psi"], np.zeros(len(motion.channels["psi"]))
    lag = {c: -motion.rates[c] for c in ("x0", "y0")}
    x = {"x0": np.cos(psi), "y0": np.sin(psi)}
    y = {"x0": -np.sin(psi), "y0": np.cos(psi)}
    if stated.velocity is VelocityReference.GROUND and {"u", "v"} <= motion.channels.keys():
        u, v, r = motion.channels["u"], motion.channels["v"], motion.rates["psi"]
        # over ground: resolved along a heading that has moved on by r lag; at (x, y) it is u - y r, v + x r
        lag |= {"u": r * v - motion.rates["u"], "v": -r * u - motion.rates["v"]}
        x, y = x | {"u": zero, "v": r}, y | {"u": -r, "v": zero}
    yield timing.late(Late.RECEIVER, lag, -np.inf)
    if length is None:
        return
    aboard = float(f"{length / UNIFORM:.2g}")  # m: an antenna stands anywhere along the ship
    yield Suspect(
        "the antenna stands elsewhere",
        tuple(
            SensorError(name, "m", aboard, aboard, _LEAST_LEVER * length, _measured(arm))
            for name, arm in (("x_antenna", x), ("y_antenna", y))
        ),
        lambda s: replace(s, antenna=Antenna(sd=aboard)), "antenna",
    )  # fmt: skip


def _of_courses(
    problem: OutputError, records: Sequence[Record], delays: Mapping[str, float | None]
) -> Iterator[SensorError]:
    """Each input that runs straight for all that is known: where within samples it makes its smaller moves.

    1: at once when the sample begins, as by a controller of the recorder's clock; -1: at its end.
    """
    model, runs = problem.model, problem.data.run_inputs
    if runs is None:
        return
    ends = [(int(first), int(behind)) for first, behind in np.unique(runs.place[:, 1:], axis=0)]
    for column, name in enumerate(model.input_names):
        if name in model.held or delays.get(name) == 0.0 or not is_course_open(name, records):
            continue
        added = [np.zeros_like(runs.values[a:b]) for a, b in ends]
        for missing, (a, b) in zip(added, ends, strict=True):
            missing[:, column] = early_turns(runs.values[a:b, column])
        if any(np.any(missing) for missing in added):
            course = added_input(f"{name} course", added)
            yield SensorError(course.name, "1", 0.0, _ANY_PLACE, np.inf, course.problem_with)


@dataclass(frozen=True, eq=False)
class ErrorInformation:
    """What records say of errors of instruments: `test` has those of all suspects, then those of courses, in order.

    Attributes:
        courses: of inputs within samples, which no setting states.
    """

    suspects: tuple[Suspect, ...]
    courses: tuple[SensorError, ...]
    test: ScoreTest

    @property
    def errors(self) -> tuple[SensorError, ...]:
        """Of all suspects and courses, in order."""
        return (*(e for one in self.suspects for e in one.errors), *self.courses)

    @property
    def open_prior(self) -> Array:
        """Covariance (m, m) of errors that nothing shows, before any record: lags are reckoned from their common one.

        That has the estimate sum(lag / s^2) / sum(1 / s^2) by lags of standard deviations s; given it, the covariance
        is diag(s^2) less 1 / sum(1 / s^2) (Rasmussen & Williams 2006, eq. (A.6)). A lag that is known, s = 0, is it.
        """
        deviations = np.array([e.undetected for e in self.errors])
        prior, lags = np.diag(deviations**2), np.array([e.unit == "s" for e in self.errors])
        if np.any(lags) and np.all(deviations[lags] > 0.0):
            prior[np.ix_(lags, lags)] -= 1.0 / np.sum(deviations[lags] ** -2.0)
        return prior


def instrument_errors(
    estimate: PointEstimate | ProcessNoise, records: Sequence[Record], length: float | None,
    delays: Mapping[str, float | None],
) -> ErrorInformation | None:  # fmt: skip
    """Return what the records say of errors that the estimate's model does not have; None: of none.

    Under output error samples count by the noise and colour that are left once all errors are taken out: a bias that is
    left in would pass for a slow disturbance, against which it is nothing.

    Args:
        length: of the ship [m], aboard of which an antenna stands; None: the trial states where.
        delays: channel -> standard deviation of its lag [s], 0: its timing is known; of others by their source.
    """
    runs = estimate.output_error if isinstance(estimate, ProcessNoise) else estimate.problem
    motion = _Motion.of_estimate(estimate)
    if "psi" not in motion.channels or runs.model.is_affine:
        return None
    is_known = any(delays.get(n) == 0.0 for n in runs.model.input_names) and not any(
        nuisance.correction.kind == "delay" for nuisance in runs.nuisances
    )
    noise = dict(zip(runs.data.outputs, third_difference_noise(runs).tolist(), strict=True))
    timing = _Timing(records, delays, noise, is_known)
    among = [*_of_yaw(motion, timing)] if "r" in motion.channels else []
    if {"x0", "y0"} <= motion.channels.keys():
        among += _of_receiver(motion, timing, Sensors.from_text(runs.model.equations.sensors), length)
    among = [one for one in among if all(e.name not in runs.model.parameters for e in one.errors)]
    courses = tuple(_of_courses(runs, records, delays))
    errors = [*(e for one in among for e in one.errors), *courses]
    if not errors:
        return None
    candidates = [Candidate(e.name, e.problem_with, _ERROR_STEP * (e.deviation or 1.0)) for e in errors]
    if not isinstance(estimate, PointEstimate):
        return ErrorInformation(tuple(among), courses, score_test(estimate, candidates))
    slopes = OutputSlopes.of_candidates(estimate, candidates)
    white = replace(estimate, problem=replace(estimate.problem, inflation=None))
    estimate = _with_noise_beside_errors(estimate, errors, score_test(white, candidates, slopes))
    return ErrorInformation(tuple(among), courses, score_test(estimate, candidates, slopes))


def _with_noise_beside_errors(estimate: PointEstimate, errors: Sequence[SensorError], test: ScoreTest) -> PointEstimate:
    """The estimate with the noise that a short search leaves from whose records all errors are taken."""
    sizes = test.joint(np.diag([e.deviation**2 for e in errors]))[0]
    clean = reduce(lambda p, item: item[0].problem_with(p, item[1]), zip(errors, sizes, strict=True), estimate.problem)
    optimum = levenberg_marquardt(
        clean, estimate.common_parameters, estimate.optimum.local, negligible=NEGLIGIBLE_IN_ROUND,
        evaluations=_ERROR_EVALUATIONS,
    )  # fmt: skip
    residuals = PointEstimate(clean, optimum).residuals()
    if not np.all(np.isfinite(np.nan_to_num(residuals))):
        return estimate
    noise, colour = residual_spread(clean, residuals), residual_correlation(clean, residuals)[1]
    return replace(estimate, problem=replace(estimate.problem, noise=noise, inflation=effective_inflation(colour)))


def detected_errors(information: ErrorInformation, widening: float) -> list[Suspect]:
    """Return the instruments whose errors the records show: taken up in turn, that which explains most first.

    widening: standard errors of the fit over those that information alone gives: what model error adds.
    """
    names, variances = information.test.names, np.array([e.deviation**2 for e in information.errors])
    taken: list[Suspect] = []
    before = 0.0
    while len(taken) < len(information.suspects):
        gains = {}
        for k, one in enumerate(information.suspects):
            if one not in taken:
                tried = {e.name for s in (*taken, one) for e in s.errors}
                prior = np.diag(np.where([name in tried for name in names], variances, 0.0))
                values, covariance, gain = information.test.joint(prior)
                sizes = dict(zip(names, values.tolist(), strict=True))
                variance = np.diag(covariance)  # below 0 by rounding where nothing shows an error
                deviations = widening * np.sqrt(np.where(variance > 0.0, variance, np.inf))
                spread = dict(zip(names, deviations.tolist(), strict=True))
                gains[k] = gain - before if one.matters(sizes, spread) else 0.0
        best = max(gains, key=lambda k: gains[k])
        if gains[best] < _LIKELIER * widening**2:
            break
        taken.append(information.suspects[best])
        before += gains[best]
    return taken


def with_undetected_sensor_errors(estimation: Estimation, information: ErrorInformation | None) -> Estimation:
    """Return the estimation whose intervals hold errors of instruments that its model does not have.

    Each may be as large as is plausible before any record and as the records leave it.
    """
    if information is None:
        return estimation
    values, covariance, _ = information.test.joint(information.open_prior)
    moves = information.test.by_candidates[: len(estimation.estimate.problem.free)]
    added = moves @ (covariance + np.outer(values, values)) @ moves.T
    return estimation.widened(added, "errors of instruments and courses of inputs that the records leave open")
