"""The batch criterion over everything seen, started where the last search ended: output error over whole runs."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.estimate.assemble import output_error
from seatrial.estimation.estimate.estimate import Estimate, colour, residual_spread
from seatrial.estimation.estimate.fit import unit_of_time
from seatrial.estimation.estimate.settings import WHITE_INFLATION, WINDOW_SHIP_LENGTHS, Settings
from seatrial.estimation.estimate.start import start
from seatrial.estimation.information.autocorrelation import whiteness_p
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import OutputError
from seatrial.numerics.optimise import levenberg_marquardt

# a promised decrease of half the sum of squares: some hundredths of a standard error
_NEGLIGIBLE = 1e-3
_FIRST, _LATER = 40, 12
_WHITE, _TIE = 0.01, 1e-3


@dataclass(frozen=True, eq=False)
class Known:
    """An estimate from everything in the window.

    Attributes:
        made: problem and optimum; left: its residuals, simulated minus measured, (rows, ny), SI.
        covariance: of the free coefficients, (k, k); infinite diagonal where singular.
        inflation: of each channel's residuals, (ny,); one where they are white.
        begins: name and first time of each record.
    """

    made: Estimate
    left: Array
    covariance: Array
    inflation: Array
    begins: tuple[tuple[str, float], ...] = ()

    @property
    def value(self) -> Array:
        """The free coefficients, (k,)."""
        return self.made.shared[: len(self.made.problem.free)]

    @property
    def misfit(self) -> float:
        """Rms residual over the spread of what was measured."""
        spread = np.nanstd(self.made.problem.data.measured, axis=0)
        return float(np.sqrt(np.nanmean((self.left / np.maximum(spread, 1e-12)) ** 2)))

    @property
    def is_coloured(self) -> bool:
        """Whether residuals are correlated in time."""
        return bool(np.any(self.inflation > WHITE_INFLATION))


def begun(model: Model, records: Sequence[Record], sessions: Sequence[str], length: float, settings: Settings) -> Known:
    """A search from nowhere as `identify` makes it, and one from the model's own values: the one that leaves less.

    Raises:
        InputError: the records cannot be fitted at all.
    """
    problem = output_error(model, records, sessions, np.inf, settings)
    unit = unit_of_time(model, records, length, settings.segment_seconds)
    first = start(problem, records, WINDOW_SHIP_LENGTHS * unit)
    own = first.problem.start(), first.problem.measured_starts()
    known = better(*(_searched(first.problem, *at, settings, _FIRST) for at in ((first.shared, first.local), own)))
    again = _searched(_weighted(known), known.made.shared, known.made.optimum.local, settings, _FIRST)
    return replace(again, begins=_begins(records))


def grown(before: Known, model: Model, records: Sequence[Record], sessions: Sequence[str], settings: Settings) -> Known:
    """The search continued on longer records, weights as the last residuals have them.

    Raises:
        InputError: the records cannot be fitted at all.
    """
    last = _weighted(before)
    problem = replace(
        output_error(model, records, sessions, np.inf, settings), noise=last.noise, inflation=last.inflation
    )
    shared = problem.start()
    shared[: len(problem.free)] = before.value
    local = problem.measured_starts()
    begins = _begins(records)
    for row, (now, was) in enumerate(zip(begins, before.begins, strict=False)):
        if now == was:
            local[row] = before.made.optimum.local[row]
    return replace(_searched(problem, shared, local, settings, _LATER), begins=begins)


def refuse_unsailed(made: Estimate, records: Sequence[Record], sessions: Sequence[str], settings: Settings) -> None:
    """Refuse an estimate over segments at which whole runs diverge, as `identify` does.

    Raises:
        InputError: they do.
    """
    problem = output_error(made.problem.model, records, sessions, np.inf, settings)
    with np.errstate(all="ignore"):
        simulated = problem.simulated(made.shared, problem.measured_starts())
    if not np.all(np.isfinite(simulated)):
        raise InputError(
            "what was seen so far leads to no model that can be sailed: too short or too calm yet; go on, or harder"
        )


def better(one: Known, other: Known) -> Known:
    """The one that leaves less, both on the same records; a search that ended nowhere leaves infinitely much."""
    left = [known.misfit if np.isfinite(known.misfit) else np.inf for known in (one, other)]
    return other if left[1] < (1.0 - _TIE) * left[0] else one


def _begins(records: Sequence[Record]) -> tuple[tuple[str, float], ...]:
    return tuple((record.name, float(record.time[0])) for record in records)


def _searched(problem: OutputError, shared: Array, local: Array, settings: Settings, evaluations: int) -> Known:
    given = np.array([settings.noise.get(o, np.nan) for o in problem.data.outputs])
    problem = replace(problem, noise=np.where(np.isfinite(given), given, problem.noise))
    found = levenberg_marquardt(problem, shared, local, negligible=_NEGLIGIBLE, evaluations=evaluations)
    made = Estimate(problem, found)
    left = made.residuals()
    inflation = _inflation(problem, left)
    count = len(problem.free)
    hessian = found.normal.reduced()[1]
    covariance = inverse(hessian)[:count, :count] if np.all(np.isfinite(hessian)) else np.diag(np.full(count, np.inf))
    trust = 1.0 if problem.inflation is not None else float(np.max(inflation))
    return Known(made, left, covariance * max(trust, 1.0), inflation)


def _inflation(problem: OutputError, residuals: Array) -> Array:
    """Variance inflation of each channel's residuals; one where a short record cannot tell them from white."""
    rho, inflation = colour(problem, residuals)
    samples = np.isfinite(residuals).sum(axis=0)
    p = np.array([whiteness_p(r, int(n)) for r, n in zip(rho, samples, strict=True)])
    return np.where(p < _WHITE, inflation, 1.0)


def _weighted(known: Known) -> OutputError:
    """The problem with noise and effective numbers of samples from the residuals it left."""
    problem = known.made.problem
    inflation = np.where(known.inflation > WHITE_INFLATION, known.inflation, 1.0) if known.is_coloured else None
    return replace(problem, noise=residual_spread(problem, known.left), inflation=inflation)
