"""What the runs of a benchmark say together: errors, successes, targets, coverage, paired tests."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import bdtr

from seatrial.campaigns.benchmark_work import ANSWER, METHOD, NOT_DETERMINISTIC, PROBLEM, SEED, TARGET, TARGETS
from seatrial.campaigns.fit_rows import COEFFICIENT
from seatrial.campaigns.journal import body_of
from seatrial.campaigns.outcome import decoded
from seatrial.campaigns.store import Store
from seatrial.campaigns.summary import coverage_interval, store_findings
from seatrial.core.results.campaign import (
    Benchmark,
    BenchmarkMethod,
    CheckedClaim,
    MethodScore,
    PairedTest,
    ProblemScore,
    TargetCurve,
)
from seatrial.problems import BenchmarkProblem, EnteredMethod, Placement

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
