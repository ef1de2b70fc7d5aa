"""Run all built-in methods on all problems and write docs/benchmark-table.md.

`python docs/write_benchmark_table.py DIR --runs 30`

DIR keeps the runs: the same command goes on where it stopped, and `--runs` may rise. `--problems` names some of them.
Craft with thrusters and folds of measured trials have runs of their own number, `--dear-runs`: a run of them takes 10
to 40 times as long, and of folds there are only so many sessions to leave out.
"""

import argparse
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

import seatrial as st
from seatrial.core.results.campaign import Benchmark, MethodScore, ProblemScore
from seatrial.core.text.numbers import fixed, p_value, significant
from seatrial.problems import problems_matching
from seatrial.problems.method import IDENTIFY, OUTPUT_ERROR

PAGE = Path(__file__).parent / "benchmark-table.md"
OWN_LIMIT = 1.1
"""Error over the bound, rms over runs and unknowns, up to which the own estimator counts as at the bound."""
DEAR = ("thrusters-*", "*-folds")
"""Patterns of the problems whose runs take long."""
CLAIM_RUNS = 30
"""Draws on which claims are tested: a two-sided sign test sees 24 : 6 of them after a correction for thirty claims."""
HEAD = """---
orphan: true
---

<!-- written by write_benchmark_table.py -->

# All built-in methods on all problems

Written by `{command}`; [what is measured](benchmark.md#what-is-measured).
{outcome}

{citations}

Median error of the answers, and the share of successes. The unit of an error stands at each problem; an error of 1 at
the Cramér-Rao bound is what an efficient estimate has. The truth is scaled, and shifted from the middle of its box, by
every seed.
"""


def main() -> None:
    """Run what is not done yet, and write the page."""
    parser = argparse.ArgumentParser(description="all built-in methods on all problems")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--runs", type=int, default=30)
    parser.add_argument("--dear-runs", type=int, default=6)
    parser.add_argument("--problems", nargs="*")
    parser.add_argument("--workers", type=int)
    options = parser.parse_args()
    listed = tuple(options.problems or [problem.name for problem in st.problems.list_problems()])
    every = [problem.name for problem in problems_matching(listed)]
    dear = [name for name in every if any(fnmatch(name, pattern) for pattern in DEAR)]
    names = [name for name in every if name not in dear]
    claims = [c for problem in problems_matching(tuple(names)) for c in problem.claims]
    rivals = sorted({name for claim in claims for name in (claim.better, claim.worse)})
    claimed = [problem.name for problem in problems_matching(tuple(names)) if problem.claims]
    judged = st.benchmark(
        claimed, options.folder / "known", against=rivals, runs=CLAIM_RUNS, workers=options.workers,
        report_progress=print,
    )  # fmt: skip
    result = st.benchmark(
        names, options.folder / "known", runs=options.runs, workers=options.workers, report_progress=print
    )  # fmt: skip
    rest = None
    if dear:
        rest = st.benchmark(
            dear, options.folder / "dear", runs=options.dear_runs, workers=options.workers, report_progress=print
        )  # fmt: skip
    some = f" --problems {' '.join(options.problems)}" if options.problems else ""
    command = f"python docs/write_benchmark_table.py DIR --runs {options.runs} --dear-runs {options.dear_runs}{some}"
    PAGE.write_text(page(result, rest, judged, command), encoding="utf-8")


def page(result: Benchmark, rest: Benchmark | None, judged: Benchmark, command: str) -> str:
    """Return the page; `judged` has the methods of which papers make claims, `rest` the problems with fewer runs."""
    parts = [result] if rest is None else [result, rest]
    citations = "\n\n".join(f"`{part.citation}`" for part in parts)
    head = HEAD.format(command=command, outcome=_own_text(parts), citations=citations)
    tables = [line for part in parts for score in part.problems for line in _problem(score)]
    return "\n".join([head, *_claims(judged), *tables]) + "\n"


def _own_text(parts: Sequence[Benchmark]) -> str:
    """Where the own estimators are at the bound, and where not."""
    lines = []
    for name in (OUTPUT_ERROR, IDENTIFY):
        problems = [p for part in parts for p in part.problems if _has_bound(p)]
        scores = {p.name: m for p in problems for m in p.methods if m.method == name}
        beyond = {p: m for p, m in scores.items() if not (m.rms is not None and m.rms <= OWN_LIMIT and not m.failures)}
        text = "; ".join(f"{p} ({_error(m)})" for p, m in beyond.items())
        near = f"{len(scores) - len(beyond)} of {len(scores)} problems with noise"
        where = f", not on {text}" if beyond else ""
        lines.append(f"`{name}` is within {OWN_LIMIT:g} of the bound (rms) on {near}{where}.")
    return "\n".join(lines)


def _has_bound(score: ProblemScore) -> bool:
    return "bound" in score.error_unit


def _error(m: MethodScore) -> str:
    missing = f", {m.failures} of {m.runs + m.failures} runs without an answer: {m.failure}" if m.failures else ""
    outside = f", {m.outside} answers outside the box" if m.outside else ""
    return f"rms {significant(m.rms, 3)}, median {significant(m.median, 3)}{outside}{missing}"


def _claims(result: Benchmark) -> list[str]:
    """What the papers say, and what the runs show."""
    rows = [
        f"| {score.name} | {claim.text} | {claim.test.smaller} : {claim.test.larger} | "
        f"{p_value(claim.test.p_adjusted).removeprefix('p ')} | {_marked(claim.verdict)} |"
        for score in result.problems for claim in score.claims
    ]  # fmt: skip
    head = ["| problem | the paper says | draws for : against | p, corrected (Holm) | here |", "|---|---|---|---|---|"]
    words = f"On {result.seeds[1] - result.seeds[0] + 1} draws each; which method has the smaller error is a sign test."
    return ["## Claims of the papers", "", words, "", *head, *rows, ""]


def _marked(verdict: str) -> str:
    return f"**{verdict}**" if verdict == "contradicted" else verdict


def _problem(score: ProblemScore) -> list[str]:
    head = f"| method | median error | rms | success % | evaluations to success | coverage % | |\n{'|---' * 7}|"
    rows = [
        f"| {m.method} | {significant(m.median, 3)} | {significant(m.rms, 3)} | {fixed(100 * m.success_share, 0)} | "
        f"{fixed(m.evaluations_to_success or None, 0)} | "
        f"{'' if m.coverage is None else fixed(100 * m.coverage, 1)} | {_remark(m)} |"
        for m in score.methods
    ]
    facts = f"An error of 1 is {score.error_unit}; {score.budget} evaluations; noise: {score.noise}. {score.source}."
    return [f"## {score.name}", "", f"{score.title[0].upper()}{score.title[1:]}. {facts}", "", head, *rows, ""]


def _remark(m: MethodScore) -> str:
    text = f"{m.failures} without an answer: {m.failure.split(':')[0]}" if m.failures else ""
    return text.replace("|", "\\|")


if __name__ == "__main__":
    main()
