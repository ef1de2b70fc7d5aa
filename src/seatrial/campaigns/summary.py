"""What the rows of a campaign say together: errors against bounds, coverage, failures, maps over keys."""

import json
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import betaincinv

from seatrial.campaigns.fit_rows import COEFFICIENT, SCORE
from seatrial.campaigns.gather import ALGEBRA, FAILURE, PROCESSOR, TASK, CampaignTable
from seatrial.campaigns.journal import body_of
from seatrial.campaigns.outcome import decoded
from seatrial.campaigns.store import Store
from seatrial.campaigns.work import Scalar
from seatrial.core.results.campaign import (
    ERROR_BINS,
    ERROR_RANGE,
    CampaignStatus,
    CampaignSummary,
    FailureReason,
    KeyMap,
    RepeatedCoefficient,
    RepeatedScore,
)
from seatrial.core.values import Array, Finding, Severity

# of the estimates: median, quartiles, ends of the middle 95 %
QUANTILES = (0.025, 0.25, 0.5, 0.75, 0.975)
_RISK = 0.05  # of an interval of 95 %
_NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_SEED = "seed"
ValueOf = Callable[[np.ndarray], float | None]
"""A mask of rows -> what these rows say together; None: nothing."""


@dataclass(frozen=True, eq=False)
class _Numbers:
    """Columns of a table as arrays, NaN where there is no number, shape (rows,)."""

    columns: Mapping[str, Array]
    name: np.ndarray
    row: np.ndarray
    unit: np.ndarray

    def values(self, mask: np.ndarray, column: str) -> Array:
        return self.columns[column][mask]


def campaign_summary(store: Store, table: CampaignTable) -> CampaignSummary:
    """Return what a campaign's table says.

    Raises:
        InputError: a journal cannot be read.
    """
    status, numbers = store.status(), _numbers(table)
    processors, algebra = (tuple(sorted({str(v) for v in table.columns[name]})) for name in (PROCESSOR, ALGEBRA))
    return CampaignSummary(
        store.table["question"],
        str(store.table["description"].get("kind", "")),
        status,
        tuple(_coefficients(numbers)),
        tuple(_scores(numbers)),
        tuple(failure_reasons(table)),
        tuple(_maps(table, numbers)),
        tuple(store_findings(store, status, processors, algebra)),
        processors,
        algebra,
        dict(store.table["versions"]),
    )


def coverage_interval(covered: int, intervals: int) -> tuple[float, float]:
    """Return the exact 95 % interval of a share (Clopper & Pearson 1934, Biometrika 26, 404)."""
    low = float(betaincinv(covered, intervals - covered + 1, _RISK / 2)) if covered else 0.0
    high = float(betaincinv(covered + 1, intervals - covered, 1 - _RISK / 2)) if covered < intervals else 1.0
    return low, high


def failure_reasons(table: CampaignTable) -> Iterator[FailureReason]:
    """Yield the reasons of failed tasks, the most frequent first; sentences that differ in numbers are one reason."""
    failed = [(str(text), str(task)) for text, task in zip(table.columns[FAILURE], table.columns[TASK], strict=True)
              if text is not None]  # fmt: skip
    first: dict[str, tuple[str, str]] = {}
    for text, task in failed:
        first.setdefault(_NUMBER.sub("…", text), (text, task))
    for reason, count in Counter(_NUMBER.sub("…", text) for text, _ in failed).most_common():
        yield FailureReason(reason, count, *first[reason])


def _numbers(table: CampaignTable) -> _Numbers:
    length = len(table)

    def numeric(name: str) -> Array:
        values = table.columns.get(name, [None] * length)
        return np.array([np.nan if v is None or isinstance(v, str) else float(v) for v in values])

    def text(name: str) -> np.ndarray:
        return np.array([str(v) for v in table.columns.get(name, [""] * length)], dtype=object)

    wanted = ("estimate", "standard_error", "lower", "upper", "truth", "bound")
    return _Numbers({name: numeric(name) for name in wanted}, text("name"), text("row"), text("unit"))


def _groups(numbers: _Numbers, row: str) -> Iterator[tuple[str, str, np.ndarray]]:
    """Name, unit and mask of the rows of each coefficient or score that has an estimate, in order."""
    usable = (numbers.row == row) & np.isfinite(numbers.columns["estimate"])
    for name, unit in dict.fromkeys(zip(numbers.name[usable], numbers.unit[usable], strict=True)):
        yield str(name), str(unit), usable & (numbers.name == name) & (numbers.unit == unit)


def _coefficients(numbers: _Numbers) -> Iterator[RepeatedCoefficient]:
    for name, unit, mask in _groups(numbers, COEFFICIENT):
        estimate, truth, bound = (numbers.values(mask, column) for column in ("estimate", "truth", "bound"))
        lower, upper = numbers.values(mask, "lower"), numbers.values(mask, "upper")
        error = estimate - truth
        is_judged = np.isfinite(lower) & np.isfinite(upper) & np.isfinite(truth)
        covered = int(np.sum((lower <= truth)[is_judged] & (truth <= upper)[is_judged]))
        intervals, deviation = int(is_judged.sum()), float(np.std(estimate, ddof=1)) if len(estimate) > 1 else 0.0
        truths = np.unique(truth[np.isfinite(truth)])
        ratio = error / bound
        yield RepeatedCoefficient(
            name,
            unit,
            len(estimate),
            float(np.mean(estimate)),
            deviation,
            tuple(map(float, np.quantile(estimate, QUANTILES))),
            float(truths[0]) if len(truths) == 1 else None,
            _rms(error),
            _rms(ratio),
            intervals,
            covered,
            coverage_interval(covered, intervals) if intervals else None,
            _error_counts(ratio if np.isfinite(ratio).any() else (estimate - np.mean(estimate)) / (deviation or 1.0)),
        )


def _rms(values: Array) -> float | None:
    finite = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(finite**2))) if len(finite) else None


def _error_counts(errors: Array) -> tuple[int, ...]:
    inside = np.clip(errors[np.isfinite(errors)], -ERROR_RANGE, ERROR_RANGE)
    return tuple(np.histogram(inside, ERROR_BINS, (-ERROR_RANGE, ERROR_RANGE))[0].tolist())


def _scores(numbers: _Numbers) -> Iterator[RepeatedScore]:
    for name, unit, mask in _groups(numbers, SCORE):
        values = numbers.values(mask, "estimate")
        yield RepeatedScore(
            name, unit, len(values), float(np.median(values)), float(np.mean(values)), float(values.max())
        )


def _maps(table: CampaignTable, numbers: _Numbers) -> Iterator[KeyMap]:
    """The first two keys that vary, besides the seed, with what can be said over them."""
    values = {key: list(dict.fromkeys(table.columns[key])) for key in table.keys if key != _SEED}
    varied = [key for key, one in values.items() if len(one) > 1][:2]
    if not varied:
        return
    column_key, row_key = varied[-1], varied[0] if len(varied) > 1 else ""
    rows, columns = values[row_key] if row_key else [None], values[column_key]
    of_rows = _masks(table, row_key, rows) if row_key else [np.ones(len(table), dtype=bool)]
    of_columns = _masks(table, column_key, columns)
    for quantity, value_of in _quantities(numbers):
        cells = tuple(tuple(value_of(row & column) for column in of_columns) for row in of_rows)
        if any(cell is not None for line in cells for cell in line):
            names = tuple(str(row) for row in rows) if row_key else ("",)
            yield KeyMap(quantity, row_key, column_key, names, tuple(map(str, columns)), cells)


def _masks(table: CampaignTable, key: str, values: Sequence[Scalar]) -> list[np.ndarray]:
    """The rows of the table where a key has each of its values."""
    place = {value: k for k, value in enumerate(values)}
    places = np.array([place[value] for value in table.columns[key]])
    return [places == k for k in range(len(values))]


def _quantities(numbers: _Numbers) -> Iterator[tuple[str, ValueOf]]:
    """Name of each quantity of a map, and the function from a mask of rows to it."""
    is_coefficient = numbers.row == COEFFICIENT
    error = numbers.columns["estimate"] - numbers.columns["truth"]
    ratio, relative = error / numbers.columns["bound"], _relative_error(numbers)
    yield "error over bound, root mean square", lambda mask: _rms(ratio[mask & is_coefficient])
    yield "median standard error, % of the estimate", lambda mask: _median(relative[mask & is_coefficient])
    for name, unit, of_score in _groups(numbers, SCORE):
        yield f"median {name}, {unit}", _score_in(numbers, of_score)


def _score_in(numbers: _Numbers, of_score: np.ndarray) -> ValueOf:
    return lambda mask: _median(numbers.values(mask & of_score, "estimate"))


def _relative_error(numbers: _Numbers) -> Array:
    estimate = np.abs(numbers.columns["estimate"])
    return 100.0 * numbers.columns["standard_error"] / np.where(estimate > 0.0, estimate, np.nan)


def _median(values: Array) -> float | None:
    finite = values[np.isfinite(values)]
    return float(np.median(finite)) if len(finite) else None


def store_findings(
    store: Store, status: CampaignStatus, processors: Sequence[str], algebra: Sequence[str]
) -> Iterator[Finding]:
    """Yield what is odd about a store: tasks left or failed, mixed arithmetic, damage, results that differ."""
    if status.remaining:
        yield Finding(Severity.WARNING, "incomplete", f"{status.remaining} of {status.total} tasks are not done yet",
                      "", "run the campaign's command again; it goes on where it stopped")  # fmt: skip
    if status.failed:
        yield Finding(Severity.INFO, "failed-tasks", f"{status.failed} of {status.total} tasks failed", "",
                      f"'seatrial campaign retry {store.folder}' does them again")  # fmt: skip
    if len(processors) > 1 or len(algebra) > 1:
        kinds = ", ".join((*processors, *algebra))
        yield Finding(Severity.INFO, "mixed-arithmetic", "tasks ran on different processors or linear algebra: last "
                      "digits may differ from those of a single machine", kinds,
                      "the columns processor and linear_algebra say which row comes from which")  # fmt: skip
    if status.damaged_places:
        yield Finding(Severity.WARNING, "damaged-journal", f"journals are damaged in {status.damaged_places} places",
                      "", "the tasks that stood there count as not done; check the disk")  # fmt: skip
    different = sum(_differs(body_of(first), body_of(second)) for first, second in store.repeated())
    if different:
        text = f"{different} tasks that were done twice on one kind of processor have different results"
        yield Finding(Severity.WARNING, "not-reproduced", text, "", "report it: results are meant to be reproducible")


def _differs(first: bytes, second: bytes) -> bool:
    """Whether two results of a task from the same arithmetic are not the same."""
    one, other = decoded(first), decoded(second)
    is_same_arithmetic = (one.processor, one.linear_algebra) == (other.processor, other.linear_algebra)
    return is_same_arithmetic and json.dumps(one.columns) != json.dumps(other.columns)
