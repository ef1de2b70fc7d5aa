"""How far a fit bends: nothing where it is linear, much where a filter would go astray."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from tests.estimation.estimate.online.streams import NOISE, SeaStream

from seatrial.core.equations import Sheet
from seatrial.estimation.estimate.online.window import LINEAR_ENOUGH, curvature
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import Segments
from seatrial.numerics.optimise import levenberg_marquardt

Array = np.ndarray


def bend(problem: OutputError) -> float:
    found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states(), negligible=1e-9)
    return curvature(problem, found.solution.point, found.local, found.normal)


def growing(scale: float) -> OutputError:
    """y = q t: the state's rate is the coefficient, or its exponential where `scale` is not zero."""
    sheet = Sheet(f"growing{scale:g}".replace(".", "_"))
    (x,) = sheet.states("x0")
    u = sheet.input("delta")
    q = sheet.parameter("q", 0.5, free=True)
    sheet.rate(x, (sp.exp(scale * q) if scale else q) + 0 * x + u)
    rng, rows = np.random.default_rng(4), 50
    one = np.zeros(1, dtype=np.int64)
    slope = np.exp(0.5 * scale) if scale else 0.5
    measured = (slope * 0.1 * np.arange(rows) + 0.05 * rng.standard_normal(rows))[:, None]
    data = Segments(np.zeros((rows, 1)), measured, np.array([0, rows]), one, one, ("a",), ("a",), ("x0",), 0.1)
    return OutputError(sheet.model(), data, np.array([0.05]))


def test_a_linear_problem_does_not_bend() -> None:
    assert bend(growing(0.0)) < 1e-9


def test_an_exponential_bends_as_it_should() -> None:
    """y = exp(a q) t: the second difference over one standard error e is exp(a q) t (cosh(a e) - 1)."""
    problem = growing(0.5)
    found = levenberg_marquardt(problem, problem.start(), problem.measured_initial_states(), negligible=1e-12)
    step = 0.5 / np.sqrt(found.normal.without_local()[1][0, 0])
    y = np.exp(0.5 * found.solution.point[0]) * 0.1 * np.arange(50) / 0.05
    expected = (np.cosh(step) - 1.0) * np.linalg.norm(y)
    assert curvature(problem, found.solution.point, found.local, found.normal) == pytest.approx(expected, rel=1e-6)


def test_ten_seconds_of_a_beam_sea_are_straight_enough_and_two_are_not() -> None:
    stream = SeaStream.from_heading(45, 60.0, 1)
    measured = stream.measured(1)

    def of(rows: int) -> float:
        data = replace(stream.clean, inputs=np.ascontiguousarray(stream.clean.inputs[:rows]), measured=measured[:rows],
                       offsets=np.array([0, rows]))  # fmt: skip
        return bend(OutputError(stream.ship, data, NOISE))

    assert of(101) < LINEAR_ENOUGH
    assert of(601) < of(101)
    assert of(21) > LINEAR_ENOUGH
