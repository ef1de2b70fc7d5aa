"""A benchmark as a campaign: the same bits over workers and after a restart; bad methods are rows, the others go on."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.installed_package import install

from seatrial.api import benchmark
from seatrial.campaigns.benchmark_work import benchmark_work
from seatrial.campaigns.summary import MethodRun, citation, holm, sign_test
from seatrial.core.results.campaign import Benchmark
from seatrial.core.values import InputError
from seatrial.problems import Placement, built_in_methods, method_named, problems_matching

PROBLEM = """
import numpy as np
from seatrial.numerics.optimise import Box
from seatrial.problems import BenchmarkProblem, KnownTruth, Placement, ProblemDraw

def drawn(rng, placement):
    truth = rng.uniform(-3.0, 3.0, 2) if placement is Placement.SHIFTED else np.zeros(2)
    least = truth + rng.standard_normal(2)
    box = Box(np.full(2, -10.0), np.full(2, 10.0))
    return ProblemDraw(("a", "b"), ("1", "m"), box, lambda points, _: np.sum((points - least) ** 2, axis=1),
                       KnownTruth(truth, np.ones(2)))

def problems():
    return (BenchmarkProblem("bowl-2", 1, "a paraboloid", "none", "variance 1", 400, drawn),)
"""
METHODS = """
import numpy as np

class Middle:
    def estimate(self, problem, rng):
        return problem.start, np.eye(2)

class Raises:
    def estimate(self, problem, rng):
        raise RuntimeError("no way")

class Unseeded:
    def estimate(self, problem, rng):
        return problem.box.random_points(np.random.default_rng(), 1)[0]

class Endless:
    def __init__(self, box, rng):
        self.points = np.zeros((1, 2))
        self.best = self.points[0], np.inf

    def ask(self):
        return self.points

    def tell(self, fitness):
        pass
"""
AGAINST = ("random", "de")


@pytest.fixture(autouse=True)
def toy(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """An installed problem and a file of methods in the working directory."""
    install(monkeypatch, tmp_path, "seatrial.problems", "bowl", PROBLEM, "problems")
    (tmp_path / "mine.py").write_text(METHODS)
    monkeypatch.chdir(tmp_path)


def comparable(result: Benchmark) -> str:
    """What must be the same to the bit: everything but times."""
    from seatrial.data.folder.document import document

    table = document(result)
    table["status"].pop("mean_seconds")
    for problem in table["problems"]:
        for method in problem["methods"]:
            method.pop("time_ratio")
    return json.dumps(table)


def test_workers_and_restarts_change_no_bit(tmp_path: Path) -> None:
    mine = "mine.py:Middle"
    one = benchmark("bowl", tmp_path / "one", methods=mine, against=AGAINST, runs=6, workers=1)
    two = benchmark("bowl", tmp_path / "two", methods=mine, against=AGAINST, runs=6, workers=2)
    benchmark("bowl", tmp_path / "three", methods=mine, against=AGAINST, runs=2, workers=1)
    resumed = benchmark("bowl", tmp_path / "three", methods=mine, against=AGAINST, runs=6, workers=1)
    assert comparable(one) == comparable(two) == comparable(resumed)
    assert one.status.done == 18 and one.status.failed == 0
    (problem,) = one.problems
    middle = next(m for m in problem.methods if m.method == mine)
    assert middle.intervals == 12 and middle.coverage is not None and middle.coverage < 1.0
    assert middle.targets.total == 36 and middle.evaluations == 0
    assert {t.against for t in problem.tests} == set(AGAINST)
    written = json.loads((tmp_path / "one" / "benchmark.json").read_text())
    assert written["citation"] == one.citation and "mine.py:Middle" in one.citation and "bowl-2@1" in one.citation


def test_a_bad_method_is_a_row_that_says_so_and_the_others_go_on(tmp_path: Path) -> None:
    bad = ("mine.py:Raises", "mine.py:Unseeded", "mine.py:Endless")
    result = benchmark("bowl", tmp_path / "out", methods=bad, against=("de",), runs=3, workers=1)
    scores = {m.method: m for m in result.problems[0].methods}
    assert (
        scores["mine.py:Raises"].failures == 3 and scores["mine.py:Raises"].failure == "it raises RuntimeError: no way"
    )
    last = {m.method for m in result.problems[0].methods[-2:]}
    assert scores["mine.py:Raises"].median is None and last == {"mine.py:Raises", "mine.py:Unseeded"}
    assert scores["mine.py:Unseeded"].failures == 3 and "not deterministic" in scores["mine.py:Unseeded"].failure
    assert scores["mine.py:Endless"].budget_spent == 3 and scores["mine.py:Endless"].evaluations == 400
    assert scores["de"].successes == 3 and scores["de"].failures == 0
    assert all(t.larger == 3 for t in result.problems[0].tests if t.method == "mine.py:Raises")


def test_a_changed_method_is_run_anew_and_its_earlier_runs_do_not_count(tmp_path: Path) -> None:
    first = benchmark("bowl", tmp_path / "out", methods="mine.py:Middle", against=(), runs=2, workers=1)
    (tmp_path / "mine.py").write_text(METHODS.replace("problem.start, np.eye(2)", "problem.start + 1.0"))
    method_named.cache_clear()
    second = benchmark("bowl", tmp_path / "out", methods="mine.py:Middle", against=(), runs=2, workers=1)
    assert second.status.total == 2 and first.problems[0].methods[0].errors != second.problems[0].methods[0].errors
    assert second.problems[0].methods[0].intervals == 0


def test_an_unknown_method_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no method 'dee'"):
        benchmark("bowl", tmp_path / "out", against=("dee",))


def test_work_has_a_task_for_each_suitable_method_problem_and_seed() -> None:
    methods = list(built_in_methods().values())
    work = benchmark_work(problems_matching(("bowl",)), methods, range(2), Placement.SHIFTED)
    used = {keys["method"] for keys in work.keys}
    assert "identify" not in used and "output-error" not in used and len(work.keys) == 2 * len(used)
    assert "seeds 0 to 1" in citation(problems_matching(("bowl",)), methods, range(2), Placement.SHIFTED, "1")


def run(method: str, seed: int, error: float) -> MethodRun:
    rows = [] if np.isinf(error) else [{"row": "answer", "error": error}]
    return MethodRun(method, seed, rows, "", 1.0, "", "")


def test_the_sign_test_is_that_of_the_tables_and_counts_missing_answers_as_worse() -> None:
    # Conover 1999, table A3: 8 of 8 in one direction have a two-sided p of 2 / 2^8
    first = [run("a", k, 1.0) for k in range(8)]
    second = [run("b", k, np.inf if k == 3 else 2.0) for k in range(8)]
    test = sign_test(first, second)
    assert (test.smaller, test.larger) == (8, 0)
    assert test.p == pytest.approx(2.0 / 2**8)
    assert sign_test(first, first).p == 1.0


def test_holm_corrects_as_in_his_paper() -> None:
    # Holm 1979: the smallest p times the number, the next times one less, never decreasing
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([]) == [] and holm([0.9, 0.8]) == [1.0, 1.0]
