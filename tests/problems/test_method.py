"""Methods by name, of a file, of a module; what is no method is refused in one sentence."""

from pathlib import Path

import numpy as np
import pytest
from tests.installed_package import install

from seatrial.core.values import Array, InputError
from seatrial.problems import (
    BenchmarkProblem,
    PosedProblem,
    attempt,
    built_in_methods,
    entered_method,
    method_named,
)

OPTIMISER = """
import numpy as np

class Halving:
    '''Random points in a neighbourhood of the best that halves.'''

    def __init__(self, box, rng):
        self.box, self.rng, self.width, self.best = box, rng, box.width, (box.lower, np.inf)

    def ask(self):
        middle = 0.5 * (self.box.lower + self.box.upper) if np.isinf(self.best[1]) else self.best[0]
        self.points = np.clip(middle + self.width * self.rng.uniform(-1, 1, (20, 2)), self.box.lower, self.box.upper)
        return self.points

    def tell(self, fitness):
        least = np.argmin(fitness)
        self.width = 0.7 * self.width
        if fitness[least] < self.best[1]:
            self.best = self.points[least], fitness[least]
"""
ESTIMATOR = """
import numpy as np

class Newton:
    def estimate(self, problem, rng):
        normal = problem.least_squares.normal(problem.start)
        return problem.start - np.linalg.solve(normal.hessian, normal.gradient), np.linalg.inv(normal.hessian)
"""


@pytest.mark.parametrize(("code", "limit"), [(OPTIMISER, 3.0), (ESTIMATOR, 3.0)])
def test_a_file_is_a_method(code: str, limit: float, tmp_path: Path, paraboloid: BenchmarkProblem) -> None:
    path = tmp_path / "mine.py"
    path.write_text(code)
    method = method_named(str(path))
    assert not method.is_built_in and len(method.digest) == 64
    assert paraboloid.draw(1).yardstick.error(attempt(method, paraboloid, 1).values) < limit


def test_one_of_several_methods_is_named(tmp_path: Path) -> None:
    path = tmp_path / "both.py"
    path.write_text(OPTIMISER + ESTIMATOR)
    assert method_named(f"{path}:Newton").name == f"{path}:Newton"
    with pytest.raises(InputError, match=r"several methods \(Halving, Newton\); name one"):
        method_named(str(path))
    with pytest.raises(InputError, match="defines no 'Newten'; give one of Halving, Newton"):
        method_named(f"{path}:Newten")


def test_a_function_is_an_estimator_and_a_module_holds_methods(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paraboloid: BenchmarkProblem
) -> None:
    (tmp_path / "my_methods.py").write_text("def estimate(problem, rng):\n    return problem.start\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    answer = attempt(method_named("my_methods:estimate"), paraboloid, 0)
    np.testing.assert_array_equal(answer.values, 0.0)


def test_an_installed_optimiser_is_a_method(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, paraboloid: BenchmarkProblem
) -> None:
    install(monkeypatch, tmp_path, "seatrial.optimisers", "halving", OPTIMISER, "Halving")
    method = method_named("halving")
    assert method.digest == "addon_halving 1.0"
    assert paraboloid.draw(1).yardstick.error(attempt(method, paraboloid, 1).values) < 3.0


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("psoo", "no method 'psoo'; did you mean 'pso'"),
        ("absent.py", "absent.py does not exist"),
        ("absent_module:Search", "module 'absent_module' of the method cannot be imported"),
    ],
)
def test_no_method_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        method_named(text)


@pytest.mark.parametrize(
    ("code", "sentence"),
    [("import numpyy", "fails: ModuleNotFoundError"), ("x = 1", "defines no class with ask and tell")],
)
def test_a_file_without_a_method_is_refused(code: str, sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "none.py"
    path.write_text(code)
    with pytest.raises(InputError, match=sentence):
        method_named(str(path))


def test_a_class_can_be_tried_before_it_is_entered(paraboloid: BenchmarkProblem) -> None:
    class Start:
        def estimate(self, problem: PosedProblem, rng: np.random.Generator) -> Array:  # noqa: ARG002
            return problem.start

    np.testing.assert_array_equal(attempt(entered_method(Start), paraboloid, 0).values, 0.0)


def test_the_built_in_methods_name_their_sources() -> None:
    methods = built_in_methods()
    assert all(m.source and m.is_built_in for m in methods.values())
    assert {"random", "iwho", "icpso", "scipy-de", "cmaes", "pymoo-de", "output-error", "identify"} <= set(methods)
