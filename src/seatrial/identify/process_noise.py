"""Is there process noise in the records, how much, and what the coefficients are when it is counted.

Prediction error with the intensities estimated, begun from an output-error estimate; a gate decides whether it is
needed (likelihood against the same filter without process noise) and whether it suffices (white innovations).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import comb

import numpy as np
from scipy import optimize, stats

from seatrial.check.signal import sample_noise
from seatrial.equations import Model
from seatrial.identify.estimate import Estimate, rounding_level
from seatrial.identify.settings import WHITE_INFLATION
from seatrial.information.autocorrelation import autocorrelation, variance_inflation, whiteness_p
from seatrial.information.covariance import Interval, from_information, left_out_steps
from seatrial.optimise import Normal, Optimum, levenberg_marquardt
from seatrial.problem.output_error import OutputError, SegmentNormals
from seatrial.problem.prediction_error import PredictionError, whole_runs
from seatrial.problem.segments import Segments
from seatrial.simulate.channels import inputs_of
from seatrial.simulate.filtering import Filter, Noisy
from seatrial.values import Array, Index, Progress, Record

KINEMATIC = ("psi", "phi", "theta", "x0", "y0", "z0")
LEVEL = 0.999
_DIFFUSE = 10.0
_SCANNED = 10.0 ** np.arange(-3.0, 0.5, 0.5)
_NOTHING = 3e-5
_ROUGH, _NEGLIGIBLE, _EXACT = 1.0, 1e-3, 1e-4
_NO_LOCAL = np.zeros((0, 0))
_LAGS = 400
_QUIET = 24


@dataclass(frozen=True, eq=False)
class Gate:
    """Whether process noise is needed to explain the records, and whether white noise in the states suffices.

    Attributes:
        ratio: 2 (log-likelihood with process noise - without), both at their own optimum; infinite where the model
            without it diverges or fits no run.
        limit: what chance alone exceeds once in a thousand cases.
        inflation_without, inflation: variance inflation of each channel's normalised innovations without and with
            process noise, (ny,); NaN where the model without it diverges.
        whiteness_p: smallest p-value over the channels that the innovations are white (Ljung & Box 1978), times ny.
        text: the verdict in words.
    """

    ratio: float
    limit: float
    inflation_without: Array
    inflation: Array
    whiteness_p: float

    @property
    def is_needed(self) -> bool:
        """The records are explained better than chance allows."""
        return self.ratio > self.limit

    @property
    def is_white(self) -> bool:
        """Innovations are white: nothing is left to explain."""
        return bool(np.max(self.inflation) <= WHITE_INFLATION)

    @property
    def holds(self) -> bool:
        """Prediction error is the criterion to use."""
        return self.is_needed and self.is_white

    @property
    def text(self) -> str:
        """The verdict in words."""
        before, after = float(np.max(self.inflation_without)), float(np.max(self.inflation))
        if not self.is_needed:
            return (
                f"no process noise: it raises twice the log-likelihood by {self.ratio:.3g} only, "
                f"chance alone by {self.limit:.3g}"
            )
        seen = f"residuals of whole runs inflate variances by {before:.3g}" if np.isfinite(before) else "no run fits"
        why = f"without process noise {seen}, and twice the log-likelihood is {self.ratio:.3g} lower"
        if self.is_white:
            return f"process noise: {why}; with it innovations are white (inflation {after:.3g})"
        return f"{why}; with it innovations stay coloured (inflation {after:.3g}): model error or coloured disturbances"


@dataclass(frozen=True, eq=False)
class ProcessNoise:
    """An optimum of the prediction-error criterion, with its gate.

    Attributes:
        problem: gives exact gradients; optimum: point, normal equations with expected information, history.
        slope: Newton decrement of the exact gradient at the point: how far above the minimum the cost still is.
    """

    problem: PredictionError
    optimum: Optimum
    slope: float
    gate: Gate

    @property
    def shared(self) -> Array:
        """Coefficients and what the sessions have of their own, as in the output-error problem."""
        return self.problem.split(self.optimum.solution.point)[0]

    @property
    def process(self) -> dict[str, float]:
        """Intensity of each state's process noise, SI over the root of a second; 0 on the lower bound."""
        q = self.problem.split(self.optimum.solution.point)[1]
        present = q > 1.001 * self.problem.least
        return {s: float(v) if p else 0.0 for s, v, p in zip(self.problem.process, q, present, strict=True)}

    @property
    def measurement(self) -> dict[str, float]:
        """Standard deviation of each channel's noise, SI."""
        r = self.problem.split(self.optimum.solution.point)[2]
        return dict(zip(self.problem.runs.data.outputs, map(float, r), strict=True))

    @cached_property
    def information(self) -> Array:
        """Information of `shared`, priors counted, the noise unknowns eliminated where they are not on a bound."""
        return self._reduced(self.optimum.normal)[1]

    @property
    def interval(self) -> Interval:
        """Of `shared`, from the information matrix of the prediction-error criterion."""
        return replace(from_information(self.information), meaning="information matrix of the innovations")

    @property
    def left_out(self) -> Array:
        """`shared` with each run left out by one Newton step from stored normal equations, (runs, k)."""
        blocks, point, runs = self._blocks, self.optimum.solution.point, self.problem.runs.data
        parts = [
            self.problem.assembled(blocks, point, runs.of_run(int(r)), with_prior=False) for r in np.unique(runs.run)
        ]
        free = self._free
        gradients = np.array([p.gradient[free] for p in parts])
        hessians = np.array([p.hessian[np.ix_(free, free)] for p in parts])
        steps = left_out_steps(self.optimum.normal.hessian[np.ix_(free, free)], gradients, hessians)
        moved = np.tile(point, (len(parts), 1))
        moved[:, free] += steps
        return moved[:, : self.problem.runs.size]

    def as_estimate(self) -> Estimate:
        """The same point as an estimate over whole runs: noise levels, initial states, and the reduced information."""
        runs = replace(self.problem.runs, noise=np.array(list(self.measurement.values())))
        states = [runs.model.states.index(s) for s in runs.starts]
        gradient, hessian = self._reduced(self.optimum.normal)
        normal = Normal(self.optimum.normal.cost, gradient, hessian, _NO_LOCAL, np.zeros((0, 0, 0)),
                        np.zeros((0, len(gradient), 0)))  # fmt: skip
        solution = replace(self.optimum.solution, point=self.shared)
        return Estimate(runs, Optimum(solution, self.problem.start[:, states], normal))

    @cached_property
    def _blocks(self) -> SegmentNormals:
        return replace(self.problem, steps=None).blocks(self.optimum.solution.point)

    @cached_property
    def _free(self) -> Index:
        point, low, high = self.optimum.solution.point, self.problem.lower, self.problem.upper
        inside = (point > low) & (point < high)
        inside[: self.problem.runs.size] = True
        return np.flatnonzero(inside)

    def _reduced(self, normal: Normal) -> tuple[Array, Array]:
        k = self.problem.runs.size
        noise = self._free[k:]
        cross = normal.hessian[:k, noise]
        solved = np.linalg.solve(normal.hessian[np.ix_(noise, noise)], cross.T)
        return normal.gradient[:k], normal.hessian[:k, :k] - cross @ solved


def is_worthwhile(made: Estimate) -> bool:
    """Whether the records have noise at all: rounding errors have no likelihood."""
    return bool(np.all(made.problem.noise > 2.0 * rounding_level(made.problem)))


def prediction_error(
    made: Estimate,
    known: Mapping[str, float] | None = None,
    driven: tuple[str, ...] = (),
    *,
    evaluations: int = 60,
    progress: Progress | None = None,
) -> ProcessNoise:
    """Coefficients, process and measurement noise together by maximum likelihood, from an output-error estimate.

    The intensities alone come first (coefficients held), then everything with the gain frozen in the gradient, then
    the gradient of the likelihood itself by central differences of the innovations, until it vanishes.

    Args:
        made: over segments or whole runs; its robust loss is not kept, outliers must be gone.
        known: standard deviations of channels that are not estimated, SI.
        driven: states with process noise; empty: all that are no kinematics.

    Returns:
        The optimum with its gate, however that decides.
    """
    tell = progress or (lambda _: None)
    problem, begin = _begun(made, known or {}, driven)
    tell("process noise: intensities")
    point = np.concatenate([begin, _intensities(problem, begin, evaluations)])

    def counted(count: int, cost: float) -> None:
        tell(f"prediction error, evaluation {count}: {cost:.6g}")

    found = levenberg_marquardt(
        problem, point, _NO_LOCAL, negligible=_NEGLIGIBLE, evaluations=evaluations, progress=counted
    )
    tell("prediction error: exact gradient")
    exact, found, slope = _polished(problem, found, evaluations)
    without = _without(problem, made, found.solution.point, evaluations)
    return ProcessNoise(exact, found, slope, _gate(exact, found, without))


def floor(
    template: OutputError,
    model: Model,
    record: Record,
    start: Array,
    own: Array,
    intensity: Mapping[str, float],
) -> dict[str, float]:
    """Rms error over time of an open-loop prediction that process noise alone causes, to first order.

    Args:
        template: the problem whose nuisances `own` (k,) are; model: at the estimate.
        record: the run that is predicted, for its inputs; start: its initial state, (nx,).
        intensity: of states, SI over the root of a second.

    Returns:
        psi_deg in degrees, position_m in m, u, v in m/s, r in rad/s, as far as the model has them.
    """
    split, parameters = len(template.session_parameters), model.parameters
    values = parameters.values
    values[[parameters.index(n) for n, _ in template.session_parameters]] = own[:split]
    inputs = inputs_of(model, record)
    run = Filter(
        model, inputs, np.array([0, len(inputs)]), record.dt, template.data.outputs,
        corrections=tuple(n.correction for n in template.nuisances), substeps=template.substeps,
        driven=tuple(intensity),
    )  # fmt: skip
    at = Noisy(start[None], np.zeros((1, len(start))), values[None], own[None, split:],
               np.array(list(intensity.values())), np.ones(len(template.data.outputs)))  # fmt: skip
    mean = dict(zip(model.states, run.variances(0, at).mean(axis=0), strict=True))
    made = {}
    if "psi" in mean:
        made["psi_deg"] = float(np.degrees(np.sqrt(mean["psi"])))
    if {"x0", "y0"} <= set(mean):
        made["position_m"] = float(np.sqrt(mean["x0"] + mean["y0"]))
    return made | {s: float(np.sqrt(mean[s])) for s in ("u", "v", "r") if s in mean}


def _begun(made: Estimate, known: Mapping[str, float], driven: tuple[str, ...]) -> tuple[PredictionError, Array]:
    """The problem with its initial states, and where the search for the runs' unknowns begins."""
    problem, first = whole_runs(made.problem)
    measured, local = problem.measured_starts(), made.optimum.local[first]
    model, outputs = problem.model, problem.data.outputs
    start = np.zeros((problem.data.count, len(model.states)))
    variance = np.zeros_like(start)
    for m, state in enumerate(problem.starts):
        i = model.states.index(state)
        if state in outputs:
            start[:, i] = measured[:, m]
            variance[:, i] = (_DIFFUSE * problem.noise[outputs.index(state)]) ** 2
        else:
            column = made.optimum.local[:, m]
            start[:, i] = local[:, m]
            variance[:, i] = max(np.std(column), 0.1 * np.max(np.abs(column)), 1e-3) ** 2
    chosen = driven or tuple(s for s in problem.starts if s not in KINEMATIC)
    least = _NOTHING * _spread(made, chosen) / np.sqrt(_longest(problem))
    held = np.array([known.get(o, np.nan) for o in outputs])
    return PredictionError(problem, chosen, start, variance, least, held), made.shared


def _longest(problem: OutputError) -> float:
    return float(np.max(np.diff(problem.data.offsets))) * problem.data.dt


def _spread(made: Estimate, states: tuple[str, ...]) -> Array:
    """How far each state moves in the records: measured, or else over the initial states of segments."""
    outputs, starts = made.problem.data.outputs, made.problem.starts
    spread = []
    for state in states:
        if state in outputs:
            spread.append(np.nanstd(made.problem.data.measured[:, outputs.index(state)]))
        else:
            spread.append(np.std(made.optimum.local[:, starts.index(state)]) if state in starts else 0.0)
    return np.maximum(spread, 1e-6)


def _intensities(problem: PredictionError, begin: Array, evaluations: int) -> Array:
    """Logarithms of intensities and deviations that suit the coefficients as they are: a scan, then a search."""
    runs = problem.runs
    held = runs.model.with_values(dict(zip(runs.free, begin[: len(runs.free)], strict=True)))
    held = held.with_parameters(held.parameters.fixed(*held.parameters.names))
    own = begin[len(runs.free) :]
    alone = replace(problem, runs=replace(runs, model=held, pinned=own, others=()))
    quiet = [
        np.median([sample_noise(runs.data.measured[a:b, i]) for a, b in pairwise(runs.data.offsets)])
        for i in range(len(runs.noise))
    ]
    deviation = np.log(np.clip(quiet, 1e-2 * runs.noise, runs.noise))
    scanned = [np.concatenate([own, np.log(share / _NOTHING * problem.least), deviation]) for share in _SCANNED]
    points = [np.clip(p, alone.lower, alone.upper) for p in scanned]
    best = points[int(np.argmin([alone.cost(p, _NO_LOCAL) for p in points]))]
    found = levenberg_marquardt(alone, best, _NO_LOCAL, negligible=_ROUGH, evaluations=evaluations)
    return found.solution.point[len(own) :]


def _polished(problem: PredictionError, found: Optimum, evaluations: int) -> tuple[PredictionError, Optimum, float]:
    """Newton steps by the exact gradient, none where it vanishes already; with the decrement that is left."""
    exact = replace(problem, steps=problem.difference_steps(found.normal.hessian))
    point = found.solution.point
    normal = exact.normal(point, _NO_LOCAL)
    slope = _decrement(exact, point, normal)
    if slope > _EXACT:
        again = levenberg_marquardt(exact, point, _NO_LOCAL, negligible=0.1 * _EXACT, evaluations=evaluations)
        count = found.solution.evaluations + again.solution.evaluations
        found = replace(again, solution=replace(again.solution, evaluations=count))
        return exact, found, _decrement(exact, found.solution.point, found.normal)
    return exact, replace(found, normal=normal), slope


def _decrement(problem: PredictionError, point: Array, normal: Normal) -> float:
    """Half the gradient's square in the metric of the information, over unknowns that no bound holds."""
    inside = (point > problem.lower) & (point < problem.upper)
    gradient, hessian = normal.gradient[inside], normal.hessian[np.ix_(inside, inside)]
    scale = 1.0 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    solved = np.linalg.lstsq(hessian * scale[:, None] * scale, scale * gradient, rcond=1e-12)[0]
    return float(0.5 * (scale * gradient) @ solved)


def _without(problem: PredictionError, made: Estimate, point: Array, evaluations: int) -> tuple[float, Array | None]:
    """Minus the log-likelihood without process noise at its own optimum, and innovations there."""
    quiet = replace(problem, process=(), least=np.zeros(0))
    k = problem.runs.size
    deviation = point[k + len(problem.process) :]
    begins = [np.concatenate([p, deviation]) for p in (point[:k], made.shared)]
    costs = [quiet.cost(p, _NO_LOCAL) for p in begins]
    if not np.any(np.isfinite(costs)):
        return np.inf, None
    begin = begins[int(np.argmin(costs))]
    found = levenberg_marquardt(quiet, begin, _NO_LOCAL, negligible=1e-2, evaluations=min(_QUIET, evaluations))
    return found.normal.cost, quiet.innovations(found.solution.point).normalised


def _gate(problem: PredictionError, found: Optimum, without: tuple[float, Array | None]) -> Gate:
    innovations = problem.innovations(found.solution.point)
    data, ny = problem.runs.data, len(problem.runs.data.outputs)
    rho = _correlations(data, innovations.normalised)
    samples = np.isfinite(innovations.e).sum(axis=0)
    cost, before = without
    blank = np.full(ny, np.nan)
    return Gate(
        ratio=max(2.0 * (cost - found.normal.cost), 0.0),
        limit=boundary_quantile(len(problem.process), LEVEL),
        inflation_without=blank if before is None else _inflation(_correlations(data, before)),
        inflation=_inflation(rho),
        whiteness_p=min(1.0, ny * min(whiteness_p(r, int(n)) for r, n in zip(rho, samples, strict=True))),
    )


def _correlations(data: Segments, normalised: Array) -> list[Array]:
    lags = min(int(np.max(np.diff(data.offsets))) // 2, _LAGS)
    pieces = [normalised[a:b] for a, b in pairwise(data.offsets)]
    return [autocorrelation([p[:, i] for p in pieces], lags) for i in range(normalised.shape[1])]


def _inflation(rho: list[Array]) -> Array:
    return np.array([variance_inflation(r) for r in rho])


def boundary_quantile(count: int, level: float) -> float:
    """Quantile of a likelihood ratio whose `count` unknowns lie on their lower bounds if there is no effect.

    A mixture of chi squared with 0..count degrees of freedom and binomial weights (Self & Liang 1987, case 9, for
    unknowns of uncorrelated estimates).
    """
    weights = np.array([comb(count, j) for j in range(count + 1)]) / 2.0**count

    def excess(value: float) -> float:
        return float(sum(w * stats.chi2.sf(value, j) for j, w in enumerate(weights) if j)) - (1.0 - level)

    return float(np.asarray(optimize.brentq(excess, 0.0, 200.0))) if count else 0.0
