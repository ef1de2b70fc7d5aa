"""Which disturbance explains the records: none, white, with a memory; waves. Likelihood decides, whiteness confirms.

Candidates are compared in the order of their unknowns; one is preferred to the best before it where twice the gain of
log-likelihood exceeds what chance gives once in a thousand cases (Wilks 1938; 10.8 for one unknown). Tests of whiteness
see weak disturbances far too rarely to decide (benchmarks/gusts.py).
"""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.special import gammaincinv

from seatrial.core.equations.augment import force_peaks, gust_name
from seatrial.core.results import DisturbanceCandidate
from seatrial.core.values import Array, ProgressReporter
from seatrial.estimation.estimate.disturbance_models import (
    MOST_PEAKS,
    DisturbanceModel,
    gusts,
    sensor_models,
    wave_forces,
    wave_motion,
    white_intensities,
    with_waves_only,
)
from seatrial.estimation.estimate.disturbance_tests import CONFIDENCE_LEVEL, likelihood_ratio_test
from seatrial.estimation.estimate.newton_refinement import refine_by_newton
from seatrial.estimation.estimate.plausibility import is_lost
from seatrial.estimation.estimate.point_estimate import PointEstimate
from seatrial.estimation.estimate.process_noise import ProcessNoise, approach_optimum
from seatrial.estimation.information.frequency_response import SpectralPeak, spectral_peaks
from seatrial.estimation.problem.prediction_error import PredictionError
from seatrial.numerics.optimise import Optimum, levenberg_marquardt

_NO_INITIAL_STATES = np.zeros((0, 0))
# most evaluations of the search without a disturbance; chosen
_EVALUATIONS = 60
# starts of a candidate from which it is searched, at most, and relative difference of the coefficients of starts that
# count as one; chosen
_MOST_STARTS, _SAME_POINT = 4, 0.05
# promised decrease of the cost at which the search without a disturbance ends; its gradient is exact
_NEGLIGIBLE = 1e-3
# promises of one Newton step within which the end of a search lies; chosen: 1.45 at most in nine searches of two craft
_REACH = 3.0
# promise of a Newton step up to which the end is near enough for the last steps, nats; chosen
_NEAR = 1.0
# variance inflation of innovations near an optimum, beyond which its last steps do not make them white; chosen
_HOPELESS_INFLATION = 3.0
ALIKE = 0.3
"""Relative difference of errors on left-out parts up to which criteria predict alike; chosen on simulated records:
above what chance leaves between true disturbances, below what lags and orders do (benchmarks/criteria.py judges it)."""
_FAR_LESS_LIKELY = 12.0  # nats below the likeliest from which on a candidate says nothing of its spread; chosen
_LARGEST = float(np.finfo(float).max) ** 0.25  # of innovations whose spectra do not overflow
_PEAKS = 3  # of the residuals' spectra at which waves are sought, the likeliest is searched from; chosen
_ADDITIONS = 2  # parts that are added in turn to the likeliest where that leaves coloured innovations; chosen
# frequencies of another peak that is not seen, and its variance, over those of the first, where it is sought; chosen
_SIDES, _SIDE_SHARE = (1.0 / 1.5, 1.5), 0.3
# intensities of gusts beside waves, over those of white noise, which had to explain the waves too; chosen
_BESIDE_WAVES = 0.1


@dataclass(frozen=True, eq=False)
class FittedDisturbance:
    """A candidate at its optimum, or near it where it cannot be the likeliest.

    Attributes:
        unknown_count: unknowns that describe the disturbance.
        is_searched: whether it was searched to the end.
        left_out_error: error on left-out parts of the runs over that of the best criterion; None: not judged.
        predicts_alike: whether that exceeds the best by no more than matters, or than the scatter of parts explains.
    """

    noise: ProcessNoise
    unknown_count: int
    is_searched: bool = True
    left_out_error: float | None = None
    predicts_alike: bool = True

    @property
    def log_likelihood(self) -> float:
        """As far as it was searched, up to a constant that all candidates share."""
        return -self.noise.optimum.normal.cost


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
                left_out_error=f.left_out_error,
                is_chosen=is_used and f is self.chosen,
            )
            for f in self.fitted
        )

    @property
    def rivals(self) -> tuple[FittedDisturbance, ...]:
        """Disturbances that the records do not rule out.

        They were searched to the end, are not far less likely than the best, and predict alike what they did not see.
        """
        likely = max(f.log_likelihood for f in self.fitted) - _FAR_LESS_LIKELY
        return tuple(
            f for f in self.fitted
            if f.unknown_count and f.is_searched and f.log_likelihood >= likely and f.predicts_alike
        )  # fmt: skip

    def spread(self, coefficients: Array) -> Array:
        """Mean square distance of the rivals' coefficients from these, (k, k)."""
        k = len(coefficients)
        away = [f.noise.common_parameters[:k] - coefficients for f in self.rivals]
        away = np.array([a for a in away if np.any(a)]).reshape(-1, k)
        return away.T @ away / max(len(away), 1)


def choose_disturbance(
    white: ProcessNoise,
    plain: Sequence[PointEstimate] = (),
    *,
    needs_disturbance: bool = False,
    evaluations: int = _EVALUATIONS,
    report_progress: ProgressReporter | None = None,
) -> DisturbanceChoice:
    """Fit every candidate, to the end those that may be the likeliest, and choose one.

    Args:
        white: the optimum with white noise on the states.
        plain: estimates by output error, from which noise of the sensors alone may begin, too.
        needs_disturbance: whether a disturbance is used even where none is likelier (inputs follow outputs); what the
            likelihood would be without one is still in the table.
    """
    search = _Search(white, report_progress or (lambda _: None), needs_disturbance)
    none = without_disturbance(white, plain, evaluations, search.report)
    fitted = [FittedDisturbance(none, 0)]
    if np.isfinite(white.newton_decrement):
        fitted.append(FittedDisturbance(white, len(white.problem.process)))
    if not white.output_error.extra_terms:  # force points know the caller's parameters only
        fitted += _with_states_of_their_own(search, fitted, _bases(none, plain))
    if not search.likeliest(fitted).noise.test.is_nearly_white:
        fitted += search.begun(sensor_models(white))
    fitted = search.ended(fitted)
    added_to: list[ProcessNoise] = []
    while len(added_to) < _ADDITIONS and not (best := search.likeliest(fitted).noise).test.is_white:
        if any(best is earlier for earlier in added_to):
            break
        added_to.append(best)
        fitted = search.ended([*fitted, *search.begun(_additions(best, white))])
    return DisturbanceChoice(search.likeliest(fitted), tuple(fitted))


def _bases(none: ProcessNoise, plain: Sequence[PointEstimate]) -> list[ProcessNoise]:
    """No disturbance, by the coefficients of every estimate in hand: where gusts led one astray, it finds no waves."""
    bases, free = [none], len(none.output_error.free)
    for estimate in plain:
        point = none.optimum.solution.point.copy()
        point[none.common_indices] = estimate.common_parameters
        begun = (one.optimum.solution.point[:free] for one in bases)
        if not any(np.allclose(point[:free], coefficients, rtol=_SAME_POINT) for coefficients in begun):
            bases.append(_placed(none, none.problem, point))
    return bases


def _placed(noise: ProcessNoise, problem: PredictionError, point: Array) -> ProcessNoise:
    """What other disturbances begin from: this problem at this point, whose normal equations nobody asks for."""
    solution = replace(noise.optimum.solution, point=point)
    return replace(noise, problem=problem, optimum=replace(noise.optimum, solution=solution))


def _with_states_of_their_own(
    search: "_Search", simplest: Sequence[FittedDisturbance], bases: Sequence[ProcessNoise]
) -> list[FittedDisturbance]:
    """Gusts, waves on the sensors, both, and forces by waves, as far as the ones before leave something to explain."""
    white, none = search.white, bases[0]
    driven, peaks = white.problem.process, _peaks(none)
    is_high = any(p.is_high for p in peaks)
    starts = _wave_starts(bases) if is_high else []
    waves = _waves(search, starts, peaks)
    is_sea = bool(waves) and waves[0].noise.test.is_nearly_white and likeliest([*simplest, waves[0]]) is waves[0]
    # waves at one peak leave next to nothing for gusts alone; a second one may stand for gusts
    gusty = [] if is_sea else search.begun([gusts(white, driven, white_intensities(white))])
    if not is_high:
        starts = _wave_starts(bases)
        is_explained = search.likeliest([*simplest, *gusty]).noise.test.is_white
        waves = [] if is_explained else _waves(search, starts, peaks)
    fitted = [*gusty, *waves, *_beside_waves(search, starts, waves, gusty, peaks)]
    if not search.likeliest([*simplest, *fitted]).noise.test.is_white:
        fitted += search.begun(wave_forces(none, driven, peaks))
    return fitted


def _wave_starts(bases: Sequence[ProcessNoise]) -> list[DisturbanceModel]:
    """Waves on the sensors beside each base, at each peak of it that stands out, or at the first."""
    starts: list[DisturbanceModel] = []
    for base in bases:
        peaks = _peaks(base)
        for peak in [p for p in peaks if p.is_high] or peaks[:1]:
            starts += wave_motion(base, [peak])
    return starts


def _waves(
    search: "_Search", starts: Sequence[DisturbanceModel], peaks: Sequence[SpectralPeak]
) -> list[FittedDisturbance]:
    """Waves on the sensors alone: at one peak, and where the spectra show more at two."""
    one = search.most_promising(starts)
    return [*one, *(both for first in one for both in search.begun(wave_motion(first.noise, peaks)))]


def _beside_waves(
    search: "_Search", starts: Sequence[DisturbanceModel], waves: Sequence[FittedDisturbance],
    gusty: Sequence[FittedDisturbance], peaks: Sequence[SpectralPeak],
) -> list[FittedDisturbance]:  # fmt: skip
    """Gusts beside waves at one peak on the sensors.

    Gusts begin beside the waves that the spectra show or that explain most alone, or the waves beside the gusts that
    do; not at all where waves alone leave nearly white innovations that no gust of the grid makes likelier.
    """
    white = search.white
    driven, whites = white.problem.process, _BESIDE_WAVES * white_intensities(white)
    bases = [*(one.noise for one in waves[:1]), *(_placed(white, start.problem, start.point) for start in starts)]
    beside = [gusts(base, driven, whites) for base in bases]
    beside += [start for one in gusty for peak in peaks for start in wave_motion(one.noise, [peak])]
    both = search.most_promising(beside)
    if any(one.noise.test.is_nearly_white and one.log_likelihood >= more.log_likelihood
           for one in [*waves[:1], *gusty] for more in both):  # fmt: skip
        return []
    return both


def _additions(best: ProcessNoise, white: ProcessNoise) -> list[DisturbanceModel]:
    """What may explain the rest beside waves: another peak, or gusts beside their forces."""
    driven, motions, forces = white.problem.process, best.problem.waves.peaks, force_peaks(best.problem.runs.model)
    peaks = _further_peaks(best) if motions or forces else []
    more = wave_motion(best, peaks) if 0 < motions < MOST_PEAKS else []
    if 0 < forces < MOST_PEAKS:
        more += wave_forces(best, driven, peaks)
    if forces and gust_name(driven[0]) not in best.problem.process:
        more.append(gusts(best, driven, white_intensities(white)))
    return more


def _further_peaks(best: ProcessNoise) -> list[SpectralPeak]:
    """Where waves may have another peak: where innovations show one, and beside the first, below the sampling."""
    waves, outputs, sampling = best.waves[0], best.output_error.data.outputs, 2.0 * np.pi / best.output_error.data.dt
    sizes = _SIDE_SHARE * np.array([waves.rms.get(c, 0.0) ** 2 for c in outputs])
    frequencies = [f * waves.frequency for f in _SIDES if f * waves.frequency < sampling]
    sides = [SpectralPeak(frequency, sizes, np.full(len(outputs), np.inf)) for frequency in frequencies]
    return [*(p for p in _peaks(best) if p.is_high or not best.test.is_nearly_white), *sides]


def _peaks(noise: ProcessNoise) -> list[SpectralPeak]:
    """The peaks of the innovations' spectra."""
    e, data = noise.problem.innovations(noise.optimum.solution.point).e, noise.problem.runs.data
    if not np.all(np.abs(np.nan_to_num(e, nan=0.0)) < _LARGEST):
        return []
    return spectral_peaks([e[a:b] for a, b in pairwise(data.offsets)], data.dt, _PEAKS)


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


def without_disturbance(
    white: ProcessNoise, plain: Sequence[PointEstimate], evaluations: int, report: ProgressReporter
) -> ProcessNoise:
    """The optimum of the same likelihood with noise of the sensors only; `plain`: where it may begin, too."""
    problem = replace(white.problem, process=(), steps=None)
    point, size = white.optimum.solution.point, white.problem.runs.size
    deviations = point[size + white.problem.waves.size + len(white.problem.process) :]
    starts = [np.concatenate([point[:size], deviations])]
    starts += [np.concatenate([one.common_parameters, one.problem.noise**2]) for one in plain]
    begin = min(starts, key=lambda start: problem.cost(start, _NO_INITIAL_STATES))
    report("disturbances compared: none")
    optimum = levenberg_marquardt(problem, begin, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE, evaluations=evaluations)
    verdict = likelihood_ratio_test(problem, optimum.solution.point, optimum.normal.cost, optimum.normal.cost, None)
    return ProcessNoise(problem, optimum, 0.0, verdict, white.output_error, "none")


@dataclass(frozen=True, eq=False)
class _Search:
    """How candidates are searched.

    Attributes:
        white: the optimum with white noise, against which they are tested.
        needs_disturbance: whether one is used even where none is likelier.
    """

    white: ProcessNoise
    report: ProgressReporter
    needs_disturbance: bool

    def likeliest(self, fitted: Sequence[FittedDisturbance]) -> FittedDisturbance:
        """The candidate to be used by likelihood; the first is none."""
        return likeliest(fitted[int(self.needs_disturbance and len(fitted) > 1) :])

    def most_promising(self, starts: Sequence[DisturbanceModel]) -> list[FittedDisturbance]:
        """The candidate that is the likeliest after the first steps from the best starts; none if all leave physics."""
        best = sorted((s for s in starts if np.isfinite(s.cost)), key=lambda s: s.cost)[:_MOST_STARTS]
        return sorted(self.begun(best), key=lambda f: -f.log_likelihood)[:1]

    def begun(self, models: Iterable[DisturbanceModel]) -> list[FittedDisturbance]:
        """Candidates after the first steps of their search; none that leaves physics."""
        begun = [
            self._approached(one.name, one.problem, one.point, one.unknown_count)
            for one in models if np.isfinite(one.cost)
        ]  # fmt: skip
        return [one for one in begun if one is not None]

    def _approached(
        self, name: str, problem: PredictionError, point: Array, unknown_count: int
    ) -> FittedDisturbance | None:
        self.report(f"disturbances compared: {name}")
        with suppress(np.linalg.LinAlgError):  # sensitivities overflow: the search has left physics
            optimum, decrement = approach_optimum(problem, point, self.report)
            if not is_lost(self.white.output_error, optimum.solution.point):
                noise = _tested(self.white, name, problem, optimum, decrement)
                return FittedDisturbance(noise, unknown_count, is_searched=False)
        return None

    def ended(self, begun: Sequence[FittedDisturbance]) -> list[FittedDisturbance]:
        """Candidates, searched to the end where they may be the likeliest there, the most promising first.

        Not where innovations stay so coloured that none would be used, unless one is needed; without what leaves
        physics.
        """
        ends: list[FittedDisturbance | None] = list(begun)
        for k in sorted(range(len(begun)), key=lambda k: -begun[k].log_likelihood):
            if not begun[k].is_searched:
                searched = [f for f in ends if f is not None and f.is_searched]
                ends[k] = self._ended(begun[k], max((_needed(begun[k], f) for f in searched), default=-np.inf))
        return _likeliest_of_each_name([f for f in ends if f is not None])

    def _ended(self, one: FittedDisturbance, log_likelihood: float) -> FittedDisturbance | None:
        """A candidate at its optimum, or as far as it may still become so likely."""
        while self._may_reach(one, log_likelihood):
            if one.noise.newton_decrement <= _NEAR:
                return self._refined(one)
            noise = one.noise
            further = self._approached(
                noise.disturbance_model, noise.problem, noise.optimum.solution.point, one.unknown_count
            )
            if further is None or further.log_likelihood <= one.log_likelihood:
                return further and self._refined(further)
            one = further
        return one

    def _may_reach(self, one: FittedDisturbance, log_likelihood: float) -> bool:
        """Whether a search to the end may lead so far, by what a Newton step promises."""
        if not self.needs_disturbance and np.max(one.noise.test.inflation) > _HOPELESS_INFLATION:
            return False
        return log_likelihood - one.log_likelihood < _REACH * one.noise.newton_decrement

    def _refined(self, one: FittedDisturbance) -> FittedDisturbance | None:
        """A candidate at its optimum; without a peak that ends slower than waves are: gusts are, or the craft."""
        name = one.noise.disturbance_model
        with suppress(np.linalg.LinAlgError):  # as in `_approached`
            exact, optimum, decrement = refine_by_newton(one.noise.problem, one.noise.optimum)
            if not is_lost(self.white.output_error, optimum.solution.point):
                noise = _tested(self.white, name, exact, optimum, decrement)
                if all(kept := _are_waves(noise)):
                    return FittedDisturbance(noise, one.unknown_count)
                fewer = with_waves_only(noise, kept)
                begun = self.begun([fewer]) if fewer.unknown_count else []
                return self._refined(begun[0]) if begun else None
        return None


def _likeliest_of_each_name(fitted: Sequence[FittedDisturbance]) -> list[FittedDisturbance]:
    """Candidates without those of the same disturbance that end at a lower optimum."""
    best: dict[str, FittedDisturbance] = {}
    for one in fitted:
        other = best.setdefault(one.noise.disturbance_model, one)
        if one.log_likelihood > other.log_likelihood:
            best[one.noise.disturbance_model] = one
    return list(best.values())


def _needed(one: FittedDisturbance, other: FittedDisturbance) -> float:
    """The log-likelihood at which a candidate may be preferred to another: with more unknowns beyond chance.

    With fewer as much below, at which its coefficients still count as spread.
    """
    extra = one.unknown_count - other.unknown_count
    return other.log_likelihood + (0.5 * critical_gain(extra) if extra > 0 else -critical_gain(one.unknown_count))


def _are_waves(noise: ProcessNoise) -> list[bool]:
    """Whether motion at each peak on the sensors is as fast as waves may be."""
    problem, frequencies = noise.problem, slice(0, 2 * noise.problem.waves.peaks, 2)
    slowest = problem.wave_bounds[0][frequencies]
    return (problem.wave_unknowns(noise.optimum.solution.point)[frequencies] > slowest).tolist()


def _tested(
    white: ProcessNoise, name: str, problem: PredictionError, optimum: Optimum, decrement: float
) -> ProcessNoise:
    """The candidate at this optimum of its problem, tested against none as `white` is."""
    without = white.optimum.normal.cost + 0.5 * white.test.likelihood_ratio
    verdict = likelihood_ratio_test(problem, optimum.solution.point, optimum.normal.cost, without, None)
    verdict = replace(verdict, inflation_without=white.test.inflation_without)
    return ProcessNoise(problem, optimum, decrement, verdict, white.output_error, name)
