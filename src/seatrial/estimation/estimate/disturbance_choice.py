"""Which disturbance explains the records: none, white, with a memory, waves. Likelihood decides, whiteness confirms.

Candidates are compared in the order of their unknowns; one is preferred to the best before it where twice the gain of
log-likelihood exceeds what chance gives once in a thousand cases (Wilks 1938; 10.8 for one unknown). Tests of whiteness
see weak disturbances far too rarely to decide (benchmarks/gusts.py).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.special import gammaincinv

from seatrial.core.results import DisturbanceCandidate
from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.estimate.disturbance_models import DisturbanceModel, gusts, sensor_models, waves
from seatrial.estimation.estimate.likelihood_ratio import CONFIDENCE_LEVEL, likelihood_ratio_test
from seatrial.estimation.estimate.newton_refinement import newton_optimum, newton_step, refine_by_newton
from seatrial.estimation.estimate.process_noise import ProcessNoise, search_with_frozen_gain
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import Optimum, levenberg_marquardt

_NO_INITIAL_STATES = np.zeros((0, 0))
# most evaluations of each search; chosen
_EVALUATIONS = 60
# promised decrease of the cost at which the search without a disturbance ends; its gradient is exact
_NEGLIGIBLE = 1e-3
# promises of one Newton step within which the end of a search lies; chosen: 1.45 at most in nine searches of two craft
_REACH = 3.0
# variance inflation of innovations near an optimum, beyond which its last steps do not make them white; chosen
_HOPELESS_INFLATION = 3.0
HELD_OUT_SHARE = 0.25
"""Share of each run, at its end, on which candidates are scored; chosen."""

# samples over which the innovations' spectrum is averaged when its peak is looked for; chosen
_SPECTRUM_SEGMENT = 1024


@dataclass(frozen=True, eq=False)
class FittedDisturbance:
    """A candidate at its optimum, or near it where it cannot be the likeliest.

    Attributes:
        unknown_count: unknowns that describe the disturbance.
        promise: what a Newton step would add to its log-likelihood; 0 where it was searched to the end.
    """

    noise: ProcessNoise
    unknown_count: int
    promise: float = 0.0

    @property
    def log_likelihood(self) -> float:
        """As far as it was searched, up to a constant that all candidates share."""
        return -self.noise.optimum.normal.cost

    @property
    def reachable(self) -> float:
        """The log-likelihood that a search to the end may find at most."""
        return self.log_likelihood + _REACH * self.promise


@dataclass(frozen=True, eq=False)
class DisturbanceChoice:
    """The disturbance that is used, and all that were fitted, in the order of their unknowns."""

    chosen: FittedDisturbance
    fitted: tuple[FittedDisturbance, ...]

    @property
    def summary(self) -> str:
        """Which disturbance is used and why, and whether it suffices, in words."""
        return f"{self.choice_text}; {self.chosen.noise.test.innovations_text}"

    @property
    def choice_text(self) -> str:
        """Which disturbance is used and why, in words."""
        if not self.chosen.unknown_count:
            return "no disturbance is likelier than noise of the sensors alone"
        best = max(
            (f for f in self.fitted if f.unknown_count < self.chosen.unknown_count), key=lambda f: f.log_likelihood
        )
        text = "the likeliest disturbance is" if self.is_detected else "none is detected, the one estimated is"
        gain = max(2.0 * (self.chosen.log_likelihood - best.log_likelihood), 0.0)
        other = best.noise.disturbance_model
        margin = f"twice its log-likelihood is {gain:.3g} above that of {other}" if np.isfinite(gain) else (
            f"with {other} the records are impossible"
        )  # fmt: skip
        return f"{text} {self.chosen.noise.disturbance_model} ({margin})"

    @property
    def is_detected(self) -> bool:
        """Whether the disturbance explains more than chance would."""
        none = self.fitted[0]
        limit = critical_gain(self.chosen.unknown_count - none.unknown_count)
        return 2.0 * (self.chosen.log_likelihood - none.log_likelihood) > limit

    def rows(self, *, is_used: bool) -> tuple[DisturbanceCandidate, ...]:
        """The table of candidates; is_used: whether the chosen one is behind the estimate."""
        simplest = self.fitted[0]
        return tuple(
            DisturbanceCandidate(
                name=f.noise.disturbance_model,
                log_likelihood=f.log_likelihood,
                degrees_of_freedom=f.unknown_count,
                likelihood_ratio=2.0 * (f.log_likelihood - simplest.log_likelihood),
                critical_ratio=critical_gain(f.unknown_count - simplest.unknown_count),
                whiteness_p=f.noise.test.whiteness.smallest,
                is_white=f.noise.test.is_white,
                parameters=f.noise.added_parameters,
                held_out_score=held_out_score(f.noise),
                is_chosen=is_used and f is self.chosen,
            )
            for f in self.fitted
        )

    def spread(self, coefficients: Array) -> Array:
        """Mean square distance of the disturbed candidates' coefficients from these, (k, k).

        Of those that were searched to the end: the others are far less likely, their coefficients at no optimum.
        """
        k, searched = len(coefficients), (f for f in self.fitted if f.unknown_count and f.promise == 0.0)
        away = [f.noise.common_parameters[:k] - coefficients for f in searched]
        away = np.array([a for a in away if np.any(a)]).reshape(-1, k)
        return away.T @ away / max(len(away), 1)


def choose_disturbance(
    white: ProcessNoise,
    *,
    needs_disturbance: bool = False,
    evaluations: int = _EVALUATIONS,
    report_progress: ProgressReporter | None = None,
) -> DisturbanceChoice:
    """Fit every candidate, to the end those that may be the likeliest, and choose one.

    Args:
        white: the optimum with white noise on the states.
        needs_disturbance: whether a disturbance is used even where none is likelier (inputs follow outputs); what the
            likelihood would be without one is still in the table.
    """
    report = report_progress or (lambda _: None)
    count = len(white.problem.process)
    fitted = [FittedDisturbance(without_disturbance(white, evaluations, report), 0), FittedDisturbance(white, count)]
    has_room = not white.output_error.extra_terms  # force points know the caller's parameters only
    if has_room:
        fitted += _begun([gusts(white)], white, evaluations, report)
    eligible = int(needs_disturbance)  # the first to choose from
    best = likeliest(fitted[eligible:])
    if not best.noise.test.is_white:
        more = list(sensor_models(white))
        gusty = next((f for f in fitted if f.noise.disturbance_model.startswith("first-order Markov")), None)
        if gusty is not None:
            more.append(waves(white, gusty.noise, _peak_frequency(gusty.noise)))
        fitted += _begun(more, white, evaluations, report)
    fitted = _searched(fitted, report, needs_disturbance=needs_disturbance)
    return DisturbanceChoice(likeliest(fitted[eligible:]), tuple(fitted))


def likeliest(fitted: Sequence[FittedDisturbance]) -> FittedDisturbance:
    """The candidate that likelihood prefers; `fitted` begins with the simplest."""
    ordered = sorted(fitted, key=lambda f: f.unknown_count)
    best = ordered[0]
    for one in ordered[1:]:
        extra = max(one.unknown_count - best.unknown_count, 1)
        if 2.0 * (one.log_likelihood - best.log_likelihood) > critical_gain(extra):
            best = one
    return best


def critical_gain(unknown_count: int) -> float:
    """What `unknown_count` unknowns without effect add to twice the log-likelihood once in a thousand cases."""
    return float(2.0 * gammaincinv(0.5 * unknown_count, CONFIDENCE_LEVEL)) if unknown_count > 0 else 0.0


def without_disturbance(white: ProcessNoise, evaluations: int, report: ProgressReporter) -> ProcessNoise:
    """The optimum of the same likelihood with noise of the sensors only."""
    problem = replace(white.problem, process=(), steps=None)
    point, size = white.optimum.solution.point, white.problem.runs.size
    begin = np.concatenate([point[:size], point[size + len(white.problem.process) :]])
    report("disturbances compared: none")
    optimum = levenberg_marquardt(problem, begin, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE, evaluations=evaluations)
    verdict = likelihood_ratio_test(problem, optimum.solution.point, optimum.normal.cost, optimum.normal.cost, None)
    return ProcessNoise(problem, optimum, 0.0, verdict, white.output_error, "none")


def held_out_score(noise: ProcessNoise) -> float | None:
    """Mean log-likelihood of a sample in the last quarter of each run, by a fit to the rest (one Newton step).

    None where that fit diverges on the last quarter, or nothing is measured there.
    """
    problem, data = noise.problem, noise.problem.runs.data
    measured = data.measured.copy()
    for a, b in pairwise(data.offsets):
        measured[a + round((1.0 - HELD_OUT_SHARE) * (b - a)) : b] = np.nan
    count = int(np.isfinite(data.measured).sum() - np.isfinite(measured).sum())
    fitted = replace(problem, runs=replace(problem.runs, data=replace(data, measured=measured)))
    point = newton_step(fitted, noise.optimum.solution.point)
    score = fitted.cost(point, _NO_INITIAL_STATES) - problem.cost(point, _NO_INITIAL_STATES)
    return score / count if count and np.isfinite(score) else None


def _begun(
    models: Sequence[DisturbanceModel], white: ProcessNoise, evaluations: int, report: ProgressReporter
) -> Iterator[FittedDisturbance]:
    """Yield candidates near their optima, where the search with the gain as given ends."""
    for one in models:
        report(f"disturbances compared: {one.name}")
        if not np.isfinite(one.problem.cost(one.point, _NO_INITIAL_STATES)):
            continue
        near = search_with_frozen_gain(one.problem, one.point, evaluations, report)
        exact = replace(one.problem, steps=one.problem.difference_steps(near.solution.point, near.normal.hessian))
        promise = newton_optimum(one.problem, near, 1.0).decrement
        yield _candidate(white, one.name, one.unknown_count, exact, near, promise, promise)


def _searched(
    begun: Sequence[FittedDisturbance], report: ProgressReporter, *, needs_disturbance: bool
) -> list[FittedDisturbance]:
    """Return candidates, searched to the end where they may be the likeliest there, the most promising first.

    Not where innovations stay so coloured that none would be used, unless one is needed.
    """
    ends, white = list(begun), begun[1].noise
    for k in sorted(range(len(begun)), key=lambda k: -begun[k].reachable):
        one, best = begun[k], max(f.log_likelihood for f in ends)
        is_hopeless = not needs_disturbance and np.max(one.noise.test.inflation) > _HOPELESS_INFLATION
        if one.promise > 0.0 and not is_hopeless and one.reachable > best - critical_gain(one.unknown_count):
            report(f"disturbances compared: {one.noise.disturbance_model}")
            exact, optimum, decrement = refine_by_newton(one.noise.problem, one.noise.optimum)
            ends[k] = _candidate(white, one.noise.disturbance_model, one.unknown_count, exact, optimum, decrement)
    return ends


def _candidate(
    white: ProcessNoise,
    name: str,
    unknown_count: int,
    problem: PredictionError,
    optimum: Optimum,
    decrement: float,
    promise: float = 0.0,
) -> FittedDisturbance:
    """The candidate at this optimum of its problem, tested against none as `white` is."""
    without = white.optimum.normal.cost + 0.5 * white.test.likelihood_ratio
    verdict = likelihood_ratio_test(problem, optimum.solution.point, optimum.normal.cost, without, None)
    verdict = replace(verdict, inflation_without=white.test.inflation_without)
    noise = ProcessNoise(problem, optimum, decrement, verdict, white.output_error, name)
    return FittedDisturbance(noise, unknown_count, promise)


def _peak_frequency(noise: ProcessNoise) -> float:
    """Frequency [rad/s] at which the innovations of any channel exceed their mean power most, (Welch 1967)."""
    data = noise.problem.runs.data
    values = np.nan_to_num(noise.problem.innovations(noise.optimum.solution.point).normalised)
    length = min(_SPECTRUM_SEGMENT, int(np.max(np.diff(data.offsets))))
    window = np.hanning(length)[:, None]
    pieces = [values[a : a + length] for a in range(0, len(values) - length + 1, length // 2)]
    power = np.mean([np.abs(np.fft.rfft(window * p, axis=0)) ** 2 for p in pieces], axis=0)[2:]
    peak = np.argmax(np.max(power / power.mean(axis=0), axis=1))
    return float(2.0 * np.pi * (peak + 2) / (length * data.dt))
