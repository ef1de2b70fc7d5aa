"""Roll in a sea that nobody recorded: natural period and equivalent linear damping by its spectrum's likelihood."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Fit, Method, RollCharacteristics
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.versions import versions
from seatrial.estimation.identify.fit_result import coefficient_table
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.roll_characteristics import roll_characteristics
from seatrial.estimation.identify.situation import WAVE_SLOPE
from seatrial.estimation.information.covariance import Interval, inverse
from seatrial.estimation.problem.spectral_likelihood import hann_transform
from seatrial.estimation.problem.unknown_waves import DAMPING, RESTORING, UnknownWaves
from seatrial.numerics.optimise import Optimum, levenberg_marquardt

FREE_COEFFICIENTS = ("b_1", "c_1")
# lowest and highest frequency over that of the largest roll, ours
_BAND_EDGES = (0.45, 3.0)
# share of the waves' largest density that must be left at the natural frequency, and relative standard errors
_MIN_WAVE_SHARE, _MAX_DAMPING_ERROR, _MAX_RESTORING_ERROR = 0.05, 0.4, 0.15
# excess of power in a band that is tolerated, number of bands, standard errors allowed beyond it, ours
_MAX_MISFIT, _BANDS, _SIGMAS = 0.5, 5, 4.0
# frequencies over which the spectrum is averaged for its peak; fewest swings of a record, ours
_SMOOTHING_BINS, _MIN_CYCLES = 9, 40
_NEGLIGIBLE, _EVALUATIONS = 1e-6, 100  # promised gain of log-likelihood that ends a search, and its length; chosen
# a spectrum has no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))


def identify_in_unknown_waves(task: Identification) -> Fit:
    """Return the fit of one run by the likelihood of its roll's spectrum.

    Raises:
        InputError: more than one training run, gaps, too short a record, or waves that cannot be distinguished from
            the ship.
    """
    trial, record = task.trial, _single_record(task.runs.records)
    problem = spectral_problem(record)
    optimum = maximum_likelihood(problem)
    interval = roll_interval(problem, optimum)
    b_1, c_1 = np.exp(optimum.solution.point[[DAMPING, RESTORING]]).tolist()
    _refuse_unidentifiable(problem, optimum, interval)
    model = _linear_model(trial.model, b_1, c_1, float(np.mean(record["phi"])))
    characteristics = roll_characteristics(model, interval, FREE_COEFFICIENTS, [record], trial.ship)
    return Fit(
        question=trial.question or "What are natural period and damping of this ship's roll in waves?",
        ship=trial.ship,
        model=model,
        coefficients=coefficient_table(
            model.parameters, FREE_COEFFICIENTS, np.array([b_1, c_1]), interval, trial.truth
        ),
        covariance=interval.covariance,
        solution=optimum.solution,
        method=Method(
            "likelihood of the roll's spectrum (Whittle), the sea's own spectrum estimated with it",
            "the largest roll, waves longer and shorter than it",
            interval.meaning,
            ("no input was recorded and no initial state explains the motion: waves that nobody measured",),
            {"frequencies": len(problem.omega)},
        ),
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=(),
        findings=(*task.findings, _linear_equivalent_finding(record), *_unused_prior_findings(trial.model)),
        records=(record,),
        seed=task.options.seed,
        elapsed_s=time.perf_counter() - task.began,
        versions=versions(),
        roll=None if characteristics is None else _with_spectrum(characteristics, problem, optimum.solution.point),
    )


def spectral_problem(record: Record) -> UnknownWaves:
    """The band about the largest roll.

    Raises:
        InputError: gaps, or fewer than forty swings.
    """
    phi = record["phi"]
    if not np.all(np.isfinite(phi)):
        raise InputError(f"record '{record.name}': channel 'phi' has gaps, which a spectrum cannot have; repair it")
    omega, motion = hann_transform(phi[:, None], record.dt)
    power = np.abs(motion[:, 0]) ** 2
    centre = float(omega[np.argmax(_smoothed(power))]) if len(omega) >= _SMOOTHING_BINS else 0.0
    if record.duration * centre < 2.0 * np.pi * _MIN_CYCLES:
        raise InputError(
            f"record '{record.name}': {record.duration * centre / (2.0 * np.pi):.0f} swings in waves that nobody "
            f"measured are too few for a spectrum; record {_MIN_CYCLES} at least, or the wave slope {WAVE_SLOPE}"
        )
    low, high = (edge * centre for edge in _BAND_EDGES)
    return UnknownWaves(omega, power, centre).band_limited(low, high)


def maximum_likelihood(problem: UnknownWaves) -> Optimum:
    """The best of several beginnings."""
    optima = [
        levenberg_marquardt(problem, begin, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE, evaluations=_EVALUATIONS)
        for begin in problem.start_points()
    ]
    return min(optima, key=lambda one: one.solution.value)


def roll_interval(problem: UnknownWaves, optimum: Optimum) -> Interval:
    """Of b_1 and c_1; unknowns of the sea that end on a bound count as known."""
    point = optimum.solution.point
    inside = np.flatnonzero((point > problem.lower) & (point < problem.upper))
    places = [int(np.flatnonzero(inside == k)[0]) for k in (DAMPING, RESTORING) if k in inside]
    if len(places) < len(FREE_COEFFICIENTS):
        raise InputError("the roll's spectrum shows no resonance; record a decay in calm water, or the wave slope")
    covariance = inverse(optimum.normal.hessian[np.ix_(inside, inside)])[np.ix_(places, places)]
    size = np.exp(point[[DAMPING, RESTORING]])
    return Interval(covariance * np.outer(size, size), np.inf, "Fisher information of the spectral likelihood")


def _single_record(records: Sequence[Record]) -> Record:
    if len(records) != 1:
        raise InputError(
            f"roll in waves that nobody measured is fitted one run at a time; the trial trains on {len(records)}; "
            f"leave the others out, or record the wave slope {WAVE_SLOPE}"
        )
    return records[0]


def _linear_model(model: Model, b_1: float, c_1: float, rest: float) -> Model:
    values = dict.fromkeys(("b_2", "b_3", "c_3", "c_5"), 0.0) | {"b_1": b_1, "c_1": c_1, "phi_0": rest}
    made = model.with_values(values)
    parameters = made.parameters.fixed(*(n for n in made.parameters.free_names if n not in FREE_COEFFICIENTS))
    return made.with_parameters(parameters.freed(*FREE_COEFFICIENTS))


def _refuse_unidentifiable(problem: UnknownWaves, optimum: Optimum, interval: Interval) -> None:
    """Raises:
    InputError: waves without energy at the natural frequency, a spectrum that is not met, or vague coefficients.
    """
    point, power = optimum.solution.point, problem.power
    advice = "record the wave slope alpha_w, or a decay in calm water"
    moment, natural = problem.moment_density(point, problem.omega), np.exp(0.5 * point[[RESTORING]])
    share = float(problem.moment_density(point, natural)[0] / np.max(moment))
    if share < _MIN_WAVE_SHARE:
        raise InputError(
            f"the waves have next to no energy at the natural frequency ({100 * share:.1f} % of their peak), so that "
            f"the roll shows their period and not the ship's; {advice}"
        )
    ratio = power / problem.windowed_density(point)
    for piece in np.array_split(np.arange(len(ratio)), _BANDS):
        mean = float(np.mean(ratio[piece]))
        # variance of a periodogram under a Hann window
        if abs(mean - 1.0) > max(_MAX_MISFIT, _SIGMAS * np.sqrt(35.0 / 18.0 / len(piece))):
            low, high = problem.omega[piece[[0, -1]]]
            raise InputError(
                f"no sea of one peak explains the roll between {low:.2g} and {high:.2g} rad/s, which has {mean:.2g} "
                f"times the power expected there; {advice}"
            )
    error = interval.standard_error / np.exp(point[[DAMPING, RESTORING]])
    if error[0] > _MAX_DAMPING_ERROR or error[1] > _MAX_RESTORING_ERROR:
        raise InputError(
            f"the roll's spectrum cannot distinguish ship and waves (standard errors of b_1 {100 * error[0]:.0f} %, "
            f"c_1 {100 * error[1]:.0f} %); record longer, {advice}"
        )


def _linear_equivalent_finding(record: Record) -> Finding:
    rms = float(np.degrees(np.std(record["phi"])))
    what = f"b_1 and c_1 are the linear equivalent of roll in this sea, {rms:.2g} deg rms"
    evidence = "other coefficients held at zero; the sea is taken to have one peak (JONSWAP) and to fall off with depth"
    return Finding(Severity.INFO, "equivalent-linear", what, evidence, "a decay shows damping over amplitude")


def _unused_prior_findings(model: Model) -> list[Finding]:
    names = [p.name for p in model.parameters.free if p.prior is not None]
    what = f"the priors of {', '.join(names)} were not used"
    return [Finding(Severity.WARNING, "prior-not-used", what, "the likelihood of a spectrum has none")] if names else []


def _smoothed(power: Array) -> Array:
    window = np.hanning(_SMOOTHING_BINS + 2)[1:-1]
    return np.asarray(np.convolve(power, window / window.sum(), "same"), dtype=np.float64)


def _with_spectrum(roll: RollCharacteristics, problem: UnknownWaves, point: Array) -> RollCharacteristics:
    """Recorded and expected densities over frequency in place of curves over amplitude, which a line has none of."""
    rows = zip(problem.omega, _smoothed(problem.power), problem.windowed_density(point), strict=True)
    return replace(
        roll, amplitude=(), damping=(), damping_lower=(), damping_upper=(), period=(), period_lower=(),
        period_upper=(), swings=(), spectrum=tuple((float(w), float(s), float(e)) for w, s, e in rows),
    )  # fmt: skip
