"""Plug-ins of other packages, a group each: found by name, refused in one sentence."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from tests.installed_package import install

from seatrial.api import list_models, reproduce
from seatrial.core.results import Verdict
from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, format_of, read_record
from seatrial.estimation.regress.pipeline import available_estimators, estimator_named
from seatrial.numerics.optimise import Box, SearchError
from seatrial.numerics.optimise.named import optimiser_named
from seatrial.physics.models import model_named
from seatrial.problems import problem_named
from seatrial.testing import check_estimator, check_model, check_optimiser, check_reader

MODEL = """
from seatrial.core.equations import Sheet

def model():
    sheet = Sheet("{name}", source="test")
    (r,) = sheet.states("r")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 10.0, "s", free=True)
    sheet.rate(r, (delta - r) / T)
    return sheet.model()
"""
READER = """
from seatrial.core.results import Verdict
from seatrial.core.values import InputError
from seatrial.data.read import Log, RawTable

def read(path, layout):
    rows = [line.split("|") for line in path.read_text(errors="replace").split()]
    if not rows or len({len(row) for row in rows}) != 1 or rows[0][0] != "t":
        raise InputError(f"{path.name} is damaged; replace it")
    return Log.of_table(RawTable(path.name, tuple(rows[0]), tuple(zip(*rows[1:])), 2))
"""
ESTIMATOR = """
from seatrial.estimation.regress.estimators import LinearRegression
from seatrial.estimation.regress.operators import Weak
from seatrial.estimation.regress.estimators import OrdinaryLeastSquares

def estimator(half_width):
    return LinearRegression("addon", Weak(2.0 * half_width), OrdinaryLeastSquares())
"""
PROBLEMS = """
from seatrial.problems import BenchmarkProblem

def problems():
    return tuple(BenchmarkProblem(f"toy-{k}", 1, "", "", "", 10, None) for k in (2, 3))
"""
OPTIMISER = """
from seatrial.numerics.optimise import DifferentialEvolution as optimiser
"""


def test_an_installed_model_is_found_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.models", "addon_yaw", MODEL.format(name="addon_yaw"), "model")
    model = model_named("addon_yaw")
    check_model(model)
    entry = {summary.name: summary for summary in list_models()}["addon_yaw"]
    assert (entry.states, entry.inputs, entry.package, entry.problem) == (("r",), ("delta",), "addon_addon_yaw", "")
    with pytest.raises(InputError, match="did you mean 'addon_yaw'"):
        model_named("addon_jaw")


@pytest.mark.parametrize(
    ("code", "sentence"),
    [
        ("import no_such_module", "installed by addon_ship.* fails: ModuleNotFoundError: No module named"),
        ("x = 1", "fails: AttributeError"),
        ("def model():\n    return 1 / 0", "fails: ZeroDivisionError"),
        ("def model():\n    return 3", "gave a int, not a Model"),
    ],
)
def test_a_broken_model_is_one_sentence(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, code: str, sentence: str
) -> None:
    install(monkeypatch, tmp_path, "seatrial.models", "ship", code, "model")
    with pytest.raises(InputError, match=sentence):
        model_named("ship")
    assert next(summary.problem for summary in list_models() if summary.name == "ship")


def test_an_installed_reader_opens_its_format(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.readers", "pipes", READER, "read")
    sample = tmp_path / "run.pipes"
    sample.write_text("t|u\n" + "\n".join(f"{0.1 * k:.1f}|{1.0 + 0.01 * k:.2f}" for k in range(20)))
    assert format_of(sample) == "pipes"
    layout = Layout("pipes", ColumnSpec("time", "t", "s"), (ColumnSpec("u", "u", "m/s"),))
    np.testing.assert_allclose(read_record(sample, layout)["u"], 1.0 + 0.01 * np.arange(20))
    from addon_pipes import read  # type: ignore[import-not-found]

    check_reader(read, sample, layout)


def test_a_broken_reader_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.readers", "tubes", "import no_such_module", "read")
    layout = Layout("tubes", ColumnSpec("time", "t", "s"), (ColumnSpec("u", "u", "m/s"),))
    with pytest.raises(InputError, match=r"'tubes' .* fails: ModuleNotFoundError"):
        read_record(tmp_path / "run.tubes", layout)


def test_an_installed_estimator_joins_the_comparison(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.estimators", "wide", ESTIMATOR, "estimator")
    assert available_estimators(5.0)[-1].name == "addon"
    check_estimator(estimator_named("addon", 2.0))
    with pytest.raises(InputError, match="unknown estimator 'adon'; did you mean 'addon'"):
        estimator_named("adon", 2.0)


def test_a_broken_estimator_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.estimators", "none", "def estimator(): ...", "estimator")
    with pytest.raises(InputError, match=r"'none' .* fails: TypeError"):
        available_estimators(5.0)


def test_an_installed_optimiser_is_found_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.optimisers", "evolution", OPTIMISER, "optimiser")
    check_optimiser(optimiser_named("evolution"))
    with pytest.raises(SearchError, match=r"no optimiser 'evolutoin'; known are .*evolution"):
        optimiser_named("evolutoin")
    assert optimiser_named("particle_swarm")(Box(np.zeros(2), np.ones(2)), np.random.default_rng(1)).ask().shape[1] == 2


def test_a_broken_optimiser_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.optimisers", "stuck", "raise RuntimeError('no\\nluck')", "optimiser")
    with pytest.raises(SearchError, match=r"'stuck' .* fails: RuntimeError: no luck; update or uninstall"):
        optimiser_named("stuck")


def test_an_installed_study_is_reproduced(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, repository: Path) -> None:
    code = (repository / "examples" / "contributions" / "turning_study.py").read_text(encoding="utf-8")
    install(monkeypatch, tmp_path, "seatrial.studies", "turning", code, "study")
    result = reproduce("turning", quick=True)
    assert result.quick and [claim.verdict for claim in result.claims] == [Verdict.CONFIRMED]


def test_installed_problems_are_found_by_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.problems", "toy", PROBLEMS, "problems")
    assert problem_named("toy-3").label == "toy-3@1"


def test_a_plug_in_of_each_group_is_tried_here(repository: Path) -> None:
    groups = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]
    source = Path(__file__).read_text(encoding="utf-8")
    assert [group for group in groups if f'tmp_path, "{group}"' not in source] == []


def test_a_broken_study_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    install(monkeypatch, tmp_path, "seatrial.studies", "paper", "import no_such_module", "study")
    lines: list[str] = []
    with pytest.raises(InputError, match=r"'paper' .* fails: ModuleNotFoundError"):
        reproduce("paper", report_progress=lines.append)
    assert lines == ["study paper, loading and compiling"]
    with pytest.raises(InputError, match="unknown study 'papre'; did you mean 'paper'"):
        reproduce("papre")
