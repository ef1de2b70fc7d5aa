"""`seatrial identify --compare`: the option reaches the estimator, and the folder shows the comparison again."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from tests.reporting.complete_fit import baselines
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Fit


@pytest.mark.parametrize("option", [(), ("--compare",)])
def test_it_compares_when_asked_and_the_report_shows_it_again(
    option: tuple[str, ...],
    repository: Path,
    tmp_path: Path,
    run_command: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def identified(*_: object, compare: bool, **__: Any) -> Fit:
        plain = fabricated_fit()
        return replace(plain, baselines=baselines(plain)) if compare else plain

    monkeypatch.setattr("seatrial.estimation.identify.identify", identified)
    trial, out = repository / "examples" / "waterjet.toml", tmp_path / "out"
    assert run_command("identify", trial, "--out", out, "--json", tmp_path / "fit.json", *option) == 0
    listed = json.loads((tmp_path / "fit.json").read_text())["baselines"]
    assert [r["name"] for r in listed][1:] == (["weak form", "ridge", "Euler", "pipeline"] if option else [])
    (out / "report.html").unlink()
    assert run_command("report", out) == 0
    assert ("Other estimators on the same records" in (out / "report.html").read_text()) == bool(option)
