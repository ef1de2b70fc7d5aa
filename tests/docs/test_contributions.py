"""The files to copy work as they stand, and CONTRIBUTING.md leads to each."""

import importlib.util
import json
import re
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from tests.estimation.regress.linear import zigzags
from tests.installed_package import install

from seatrial import testing
from seatrial.core.figures.chart import Rule
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Verdict
from seatrial.core.values import InputError, Record
from seatrial.data.example_series import true_model
from seatrial.data.read import ColumnSpec, Layout, read_record
from seatrial.numerics.optimise import Box, optimiser_named, search
from seatrial.physics.models import model_from_file
from seatrial.reporting.study import html

FOLDER = Path(__file__).parents[2] / "examples" / "contributions"


def loaded(name: str) -> ModuleType:
    """Return a file of the examples as a module."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_each_file_has_a_page_and_contributing_leads_to_both(repository: Path) -> None:
    lines = (repository / "CONTRIBUTING.md").read_text(encoding="utf-8").splitlines()
    for path in FOLDER.glob("*.py"):
        (line,) = (line for line in lines if path.name in line)
        (page,) = re.findall(r"\((docs/contributing/\w+\.md)\)", line)
        assert path.name in (repository / page).read_text(encoding="utf-8")
    assert len(lines) <= 50, "one screen"


def test_the_model_turns_to_the_side_of_its_rudder_and_loses_speed() -> None:
    model = model_from_file(FOLDER / "yaw_model.py")
    rates = np.empty(3)
    jacobian = np.zeros((3, 3 + 1 + len(model.parameters)))
    turning = np.array([0.02, 0.0, 1.2])
    model.compiled.rates_tangent(0.0, turning, np.array([0.3]), model.parameters.values, rates, jacobian)
    yaw_acceleration, yaw_rate, surge_acceleration = rates
    assert yaw_acceleration > 0.0 and yaw_rate == 0.02 and surge_acceleration < 0.0
    assert jacobian[0, 3 + 1 + model.parameters.index("K")] == pytest.approx(0.3 / 10.0)


def test_the_check_finds_a_ship_that_leans_to_one_side() -> None:
    heel_findings = loaded("heel_check").heel_findings
    time = np.arange(100) * 0.1
    rolling = np.radians(5.0) * np.sin(2.0 * np.pi * time / 5.0)
    upright, leaning = (Record.from_arrays("run", time, {"phi": rolling + heel}) for heel in (0.0, -0.1))
    assert heel_findings(upright) == () and heel_findings(upright.without("phi")) == ()
    (finding,) = heel_findings(leaning)
    assert finding.code == "heel" and "5.7 deg to port" in finding.text


@pytest.fixture
def layout(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Layout:
    """The layout of a JSON lines file, the reader installed for the time of a test."""
    code = (FOLDER / "json_lines_reader.py").read_text(encoding="utf-8")
    install(monkeypatch, tmp_path, "seatrial.readers", "jsonl", code, "read_json_lines")
    return Layout("jsonl", ColumnSpec("time", "t", "s"), (ColumnSpec("u", "speed", "kn"),))  # type: ignore[arg-type]


def test_the_reader_gives_what_the_file_holds(layout: Layout, tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    rows = [{"t": 0.0, "speed": 3600.0}, {"t": 0.5, "speed": None}, {"t": 1.0, "speed": 1800.0}]
    path.write_text("\n".join(map(json.dumps, rows)), encoding="utf-8")
    record = read_record(path, layout)
    np.testing.assert_allclose(record["u"], [1852.0, np.nan, 926.0])
    np.testing.assert_array_equal(record.time, [0.0, 0.5, 1.0])


@pytest.mark.parametrize(
    ("line", "sentence"),
    [("{", "line 2 is no JSON"), ("[1, 2]", "line 2 is no JSON object"), ('{"t": 1}', "line 2 has no 'speed'")],
)
def test_the_reader_refuses_in_one_sentence(line: str, sentence: str, layout: Layout, tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    path.write_text('{"t": 0, "speed": 1}\n' + line, encoding="utf-8")
    with pytest.raises(InputError, match=sentence):
        read_record(path, layout)


def test_the_figure_shows_residuals_limits_and_names_and_leaves_gaps() -> None:
    time = np.linspace(0.0, 60.0, 400)
    residuals = np.sin(time)
    residuals[100:150] = np.nan
    chart = loaded("residuals_figure").residual_chart(time, residuals, 0.4, "r [deg/s]")
    page = svg(chart)
    for words in ("t [s]", "r [deg/s]", "95 % if the model is right"):
        assert words in page
    assert "nan" not in page
    (panel,) = chart.panels
    assert panel.y.ends[1] > 1.0 and sorted(m.value for m in panel.marks if isinstance(m, Rule)) == [-0.784, 0.784]


def test_the_estimator_gives_the_true_coefficients_back() -> None:
    model, record = true_model(), zigzags()
    estimator = loaded("least_deviations_estimator").LeastDeviations(half_width=20.0)
    truth = np.array([model.parameters[name].value for name in model.parameters.free_names])
    clean = estimator.estimate(model, [record]).values
    np.testing.assert_allclose(clean, truth, rtol=0.02, atol=1e-3)


def test_the_optimiser_finds_the_minimum_and_is_found_by_its_name(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    code = (FOLDER / "shrinking_search_optimiser.py").read_text(encoding="utf-8")
    install(monkeypatch, tmp_path, "seatrial.optimisers", "shrinking_search", code, "ShrinkingSearch")
    create = optimiser_named("shrinking_search")
    testing.check_optimiser(create)
    middle = np.array([0.3, -1.2])
    herd = create(Box(np.full(2, -2.0), np.full(2, 2.0)), np.random.default_rng(1))
    solution = search(herd, lambda points: np.sum((points - middle) ** 2, axis=1))
    np.testing.assert_allclose(solution.point, middle, atol=1e-4)


def test_the_study_confirms_its_claim_and_has_a_page() -> None:
    lines: list[str] = []
    study = loaded("turning_study").study(quick=True, seed=3, report_progress=lines.append)
    assert [claim.verdict for claim in study.claims] == [Verdict.CONFIRMED]
    assert all(check.holds for check in study.checks) and study.seed == 3 and len(lines) == 1
    assert study.claims[0].claim in html(study)


def test_the_files_to_copy_conform(layout: Layout, tmp_path: Path) -> None:
    sample = tmp_path / "log.jsonl"
    rows = [{"t": 0.5 * k, "speed": 10.0 + 0.1 * k} for k in range(20)]
    sample.write_text("\n".join(map(json.dumps, rows)), encoding="utf-8")
    testing.check_reader(loaded("json_lines_reader").read_json_lines, sample, layout)
    testing.check_model(model_from_file(FOLDER / "yaw_model.py"))
    testing.check_estimator(loaded("least_deviations_estimator").LeastDeviations(5.0))
