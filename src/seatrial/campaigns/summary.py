"""What the rows of a campaign say together: errors against bounds, coverage, failures, scores of a benchmark."""

import csv
import io
import json
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.special import bdtr, betaincinv

from seatrial.campaigns.benchmark_work import ANSWER, METHOD, NOT_DETERMINISTIC, PROBLEM, SEED, TARGET, TARGETS
from seatrial.campaigns.store import Store, body_of
from seatrial.campaigns.work import COEFFICIENT, SCORE, DecodedBody, Scalar, decoded
from seatrial.core.results.campaign import (
    ERROR_BINS,
    ERROR_RANGE,
    Benchmark,
    BenchmarkMethod,
    CampaignStatus,
    CampaignSummary,
    CheckedClaim,
    FailureReason,
    KeyMap,
    MethodScore,
    PairedTest,
    ProblemScore,
    RepeatedCoefficient,
    RepeatedScore,
    TargetCurve,
)
from seatrial.core.values import Array, Finding, InputError, Severity
from seatrial.core.values.files import write_atomically
from seatrial.problems import BenchmarkProblem, EnteredMethod, Placement

# The table of a campaign: a row for each row of each task, in the order of the plan, whoever did the tasks and when.

TASK, FAILURE, PROCESSOR, ALGEBRA = "task", "failure", "processor", "linear_algebra"
_TASK_DIGITS = 16  # hexadecimal digits of an identity in the table: chosen, no two of a million alike


@dataclass(frozen=True, eq=False)
class CampaignTable:
    """Columns of equal length; `keys` names those that distinguish tasks."""

    columns: Mapping[str, Sequence[Scalar]]
    keys: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.columns[TASK])


def campaign_table(store: Store) -> CampaignTable:
    """Return the table of what a store holds: rows of tasks that are done, one row with a sentence of a failed one.

    Raises:
        InputError: a journal cannot be read, or no task has ended yet.
    """
    keys, names = dict[str, None](), dict[str, None]()
    bodies: list[tuple[str, DecodedBody]] = []
    for identity, body in _bodies(store):
        keys |= dict.fromkeys(body.keys)
        names |= dict.fromkeys(body.columns)
        bodies.append((identity, body))
    if not bodies:
        raise InputError(f"the campaign in '{store.folder}' has no result yet; run it first")
    names = {name: None for name in names if name not in keys}
    columns: dict[str, list[Scalar]] = {name: [] for name in (TASK, *keys, *names, FAILURE, PROCESSOR, ALGEBRA)}
    for identity, body in bodies:
        _append(columns, identity, body, tuple(keys), tuple(names))
    return CampaignTable(columns, tuple(keys))


def _bodies(store: Store) -> Iterator[tuple[str, DecodedBody]]:
    stored = store.outcomes()
    for identity in store.identities:
        entry = stored.done.get(identity) or stored.failed.get(identity)
        if entry is not None:
            yield identity.hex()[:_TASK_DIGITS], decoded(body_of(entry))


def _append(
    columns: dict[str, list[Scalar]], task: str, body: DecodedBody, keys: tuple[str, ...], names: tuple[str, ...]
) -> None:
    count = max((len(values) for values in body.columns.values()), default=0)
    if body.failure:
        count = 1
    for name in keys:
        columns[name] += [_scalar(body.keys.get(name))] * count
    for name in names:
        columns[name] += body.columns.get(name, [None] * count)
    facts = {TASK: task, FAILURE: body.failure or None, PROCESSOR: body.processor, ALGEBRA: body.linear_algebra}
    for name, value in facts.items():
        columns[name] += [value] * count


def _scalar(value: Any) -> Scalar:
    """Return the value of an override as a cell: a list or table as its JSON text."""
    return json.dumps(value, sort_keys=True) if isinstance(value, list | tuple | dict) else value


def write_table(table: CampaignTable, path: Path) -> None:
    """Write the table as CSV or Parquet, by the ending of its name; whole or not at all.

    Raises:
        InputError: another ending, Parquet without pyarrow, or the file cannot be written.
    """
    if path.suffix == ".csv":
        write_atomically(path, _csv(table))
    elif path.suffix == ".parquet":
        write_atomically(path, _parquet(table))
    else:
        raise InputError(f"'{path}' is neither a .csv nor a .parquet file; name one that is")


def _csv(table: CampaignTable) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table.columns)
    writer.writerows(zip(*table.columns.values(), strict=True))
    return text.getvalue().encode()


def _parquet(table: CampaignTable) -> bytes:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise InputError(
            "a .parquet file needs pyarrow; run: pip install 'seatrial[formats]', or name a .csv"
        ) from None
    columns = {name: pyarrow.array(_of_one_type(values)) for name, values in table.columns.items()}
    buffer = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), buffer)
    return buffer.getvalue()


def _of_one_type(values: Sequence[Scalar]) -> Sequence[Scalar]:
    """Return whole numbers among others as others, and anything else that is mixed as text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {int, float} and len(kinds) > 1:
        return [None if value is None else float(value) for value in values]  # type: ignore[arg-type]
    return values if len(kinds) <= 1 else [None if value is None else str(value) for value in values]


# What the rows of a campaign say together: errors against bounds, coverage, failures, maps over keys.

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
        yield Finding(Severity.WARNING, "incomplete", f"{status.remaining} of {status.total} tasks are not done yet")
    if status.failed:
        yield Finding(Severity.INFO, "failed-tasks", f"{status.failed} of {status.total} tasks failed", "",
                      f"'seatrial campaign retry {store.folder}' does them again")  # fmt: skip
    if len(processors) > 1 or len(algebra) > 1:
        kinds = ", ".join((*processors, *algebra))
        yield Finding(Severity.INFO, "mixed-arithmetic", "tasks ran on different processors or linear algebra: last "
                      "digits may differ from those of a single machine", kinds)  # fmt: skip
    if status.damaged_places:
        yield Finding(Severity.WARNING, "damaged-journal", f"journals are damaged in {status.damaged_places} places")
    different = sum(_differs(body_of(first), body_of(second)) for first, second in store.repeated())
    if different:
        text = f"{different} tasks that were done twice on one kind of processor have different results"
        yield Finding(Severity.WARNING, "not-reproduced", text)


def _differs(first: bytes, second: bytes) -> bool:
    """Whether two results of a task from the same arithmetic are not the same."""
    one, other = decoded(first), decoded(second)
    is_same_arithmetic = (one.processor, one.linear_algebra) == (other.processor, other.linear_algebra)
    return is_same_arithmetic and json.dumps(one.columns) != json.dumps(other.columns)


# What the runs of a benchmark say together: errors, successes, targets, coverage, paired tests.

REFERENCE = "random"
"""The method whose time of a run is the unit of the others'."""
_DIGITS = 12  # of a digest in a citation: chosen


@dataclass(frozen=True, eq=False)
class MethodRun:
    """One run: its rows, or why there are none.

    Attributes:
        rows: as the task gave them; failure: empty where there are rows; seconds: wall time.
    """

    method: str
    seed: int
    rows: Sequence[Mapping[str, Any]]
    failure: str
    seconds: float
    processor: str
    linear_algebra: str

    @property
    def error(self) -> float:
        """Error of the answer, infinite without one."""
        return float(self.rows[0]["error"]) if self.rows else np.inf


def benchmark_result(
    store: Store, problems: Sequence[BenchmarkProblem], methods: Sequence[EnteredMethod], seeds: range,
    placement: Placement,
) -> Benchmark:  # fmt: skip
    """Return what a store says of methods on problems; runs that are not done yet are left out.

    Raises:
        InputError: a journal cannot be read.
    """
    runs: dict[str, list[MethodRun]] = defaultdict(list)
    for problem, run in _runs(store):
        runs[problem].append(run)
    every = [run for some in runs.values() for run in some]
    status, processors = store.status(), tuple(sorted({run.processor for run in every}))
    findings = store_findings(store, status, processors, tuple(sorted({run.linear_algebra for run in every})))
    scores = [_problem_score(p, methods, runs[p.name], placement) for p in problems]
    entered = tuple(BenchmarkMethod(m.name, m.source, m.digest, m.is_built_in) for m in methods)
    return Benchmark(
        placement.text, (seeds.start, seeds[-1]), TARGETS, status, entered, _corrected(scores),
        citation(problems, methods, seeds, placement, store.table["versions"]["seatrial"]),
        tuple(f for f in findings if f.code != "failed-tasks"),  # each has a row of its own
        processors, dict(store.table["versions"]),
    )  # fmt: skip


def citation(
    problems: Sequence[BenchmarkProblem], methods: Sequence[EnteredMethod], seeds: range, placement: Placement,
    version: str,
) -> str:  # fmt: skip
    """Return one line by which the same runs can be made again."""
    labels = ", ".join(problem.label for problem in problems)
    names = ", ".join(f"{m.name} ({m.digest[:_DIGITS]})" if m.digest and not m.is_built_in else m.name for m in methods)
    return (
        f"seatrial {version} benchmark; problems {labels}; truth {placement.value}; "
        f"seeds {seeds.start} to {seeds[-1]}; methods {names}"
    )


def _runs(store: Store) -> Iterator[tuple[str, MethodRun]]:
    """Problem and run of every task that has ended, in the order of the plan."""
    stored = store.outcomes()
    for identity in store.identities:
        entry = stored.done.get(identity) or stored.failed.get(identity)
        if entry is not None:
            body = decoded(body_of(entry))
            rows = [dict(zip(body.columns, row, strict=True)) for row in zip(*body.columns.values(), strict=True)]
            yield body.keys[PROBLEM], MethodRun(
                body.keys[METHOD], body.keys[SEED], rows, body.failure, entry.seconds, body.processor,
                body.linear_algebra,
            )  # fmt: skip


def _problem_score(
    problem: BenchmarkProblem, methods: Sequence[EnteredMethod], runs: Sequence[MethodRun], placement: Placement
) -> ProblemScore:
    draw = problem.draw(min((run.seed for run in runs), default=0), placement)
    by_method = {m.name: [run for run in runs if run.method == m.name] for m in methods}
    by_method = {name: _counted(some) for name, some in by_method.items() if some}
    unit = np.median([run.seconds for run in by_method[REFERENCE]]) if REFERENCE in by_method else None
    built_in = {m.name: m.is_built_in for m in methods}
    scores = [_score(name, built_in[name], some, unit) for name, some in by_method.items()]
    scores.sort(key=lambda one: (np.inf if one.median is None else one.median, one.evaluations or 0.0))
    return ProblemScore(
        problem.name, problem.version, problem.title, problem.source, problem.noise, draw.unknowns, problem.budget,
        draw.yardstick.unit, draw.yardstick.success_limit, tuple(scores), tuple(_tests(by_method, built_in, scores)),
        tuple(CheckedClaim(claim.text, sign_test(by_method[claim.better], by_method[claim.worse]))
              for claim in problem.claims if {claim.better, claim.worse} <= by_method.keys()),
    )  # fmt: skip


def _counted(runs: Sequence[MethodRun]) -> list[MethodRun]:
    """The runs of a method; without their answers where one of them could not be repeated."""
    failure = next((run.failure for run in runs if run.failure.startswith(NOT_DETERMINISTIC)), "")
    return [replace(run, rows=(), failure=run.failure or failure) if failure else run for run in runs]


def _score(name: str, is_built_in: bool, runs: Sequence[MethodRun], unit: float | None) -> MethodScore:
    """One method on one problem."""
    answers = [run.rows[0] for run in runs if run.rows]
    errors = sorted(float(answer["error"]) for answer in answers)
    failures = [run.failure for run in runs if not run.rows]
    successes = sum(bool(answer["is_success"]) for answer in answers)
    spent = sum(int(answer["evaluations"]) for answer in answers)
    met = sorted(int(r["evaluations"]) for run in runs for r in run.rows if r["row"] == TARGET)
    rows = [r for run in runs for r in run.rows if r["row"] == COEFFICIENT and r["lower"] is not None]
    covered = sum(r["lower"] <= r["truth"] <= r["upper"] for r in rows)
    assert all(answer["row"] == ANSWER for answer in answers)
    return MethodScore(
        name, is_built_in, len(answers), len(failures), failures[0] if failures else "", tuple(errors),
        float(np.sqrt(np.mean(np.square(errors)))) if errors else None, successes,
        float(np.median([answer["evaluations"] for answer in answers])) if answers else None,
        spent / successes if successes else None, TargetCurve(tuple(met), len(runs) * len(TARGETS)), len(rows), covered,
        coverage_interval(covered, len(rows)) if rows else None, sum(bool(answer["is_outside"]) for answer in answers),
        sum(bool(answer["is_budget_spent"]) for answer in answers),
        None if unit is None else float(np.median([run.seconds for run in runs]) / unit),
    )  # fmt: skip


def _tests(
    runs: Mapping[str, Sequence[MethodRun]], built_in: Mapping[str, bool], scores: Sequence[MethodScore]
) -> Iterator[PairedTest]:
    """Every entered method against every built-in one; where none was entered the best one against the others."""
    entered = [name for name in runs if not built_in[name]]
    for name in entered or [scores[0].method] if scores else []:
        for against in runs:
            if against != name and built_in[against]:
                yield sign_test(runs[name], runs[against])


def sign_test(first: Sequence[MethodRun], second: Sequence[MethodRun]) -> PairedTest:
    """Return the two-sided sign test of which method has the smaller error on the draws that both met.

    No law of the errors is assumed, and a run without an answer is worse than any with one (Conover 1999, Practical
    Nonparametric Statistics, section 3.4). The p-value is not corrected yet.
    """
    others = {run.seed: run.error for run in second}
    pairs = [(run.error, others[run.seed]) for run in first if run.seed in others]
    smaller, larger = sum(a < b for a, b in pairs), sum(a > b for a, b in pairs)
    p = min(2.0 * float(bdtr(min(smaller, larger), smaller + larger, 0.5)), 1.0) if smaller + larger else 1.0
    return PairedTest(first[0].method, second[0].method, smaller, larger, p, p)


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p-values corrected for their number (Holm 1979, Scandinavian Journal of Statistics 6, 65)."""
    corrected, largest = [0.0] * len(p_values), 0.0
    for rank, k in enumerate(sorted(range(len(p_values)), key=lambda k: p_values[k])):
        largest = max(largest, min((len(p_values) - rank) * p_values[k], 1.0))
        corrected[k] = largest
    return corrected


def _corrected(scores: Sequence[ProblemScore]) -> tuple[ProblemScore, ...]:
    """The scores with the p-values of all comparisons corrected together, and those of all claims."""
    tests = iter(holm([test.p for score in scores for test in score.tests]))
    claims = iter(holm([claim.test.p for score in scores for claim in score.claims]))
    return tuple(
        replace(
            score,
            tests=tuple(replace(test, p_adjusted=next(tests)) for test in score.tests),
            claims=tuple(replace(c, test=replace(c.test, p_adjusted=next(claims))) for c in score.claims),
        )
        for score in scores
    )
