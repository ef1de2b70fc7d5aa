"""Two fits compared, from Python and from the command line."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.test_fit_result import other_day
from tests.reporting.fabricated import fabricated_fit
from typer.testing import CliRunner

import seatrial as st
from seatrial.cli import app
from seatrial.core.results import Comparison, IntervalBasis


def day(moved: bool) -> st.Fit:
    fit = fabricated_fit()
    fit = other_day(fit) if moved else fit
    return replace(fit, interval_basis=IntervalBasis(fit.covariance, np.inf))


def test_manoeuvres_are_compared_with_their_intervals() -> None:
    first = day(moved=False)
    assert st.compare(first, first, manoeuvres=("zigzag:20/20",)).significant == ()
    turned = first.model.with_values({"N_r": 1.5 * first.model.parameters["N_r"].value})
    comparison = st.compare(first, replace(day(moved=True), model=turned), manoeuvres=("zigzag:20/20", "slalom"))
    zigzag, slalom = comparison.manoeuvres
    rows = {d.name: d for d in zigzag.measures}
    assert "rudder_deg" not in rows
    overshoot = rows["overshoot_1_deg"]
    assert overshoot.first is not None and overshoot.second is not None
    assert overshoot.difference == pytest.approx(overshoot.second - overshoot.first)
    assert overshoot.second < overshoot.first  # more yaw damping
    assert slalom.measures == ()
    assert "slalom" in slalom.note


def test_fits_without_anything_in_common_are_refused() -> None:
    first = day(moved=False)
    other = replace(first, model=st.models.roll())
    with pytest.raises(st.InputError, match="neither free coefficients nor manoeuvres in common"):
        st.compare(first, other, names=("a", "b"))


def test_the_command_prints_writes_and_renders_again(tmp_path: Path) -> None:
    for name, moved in (("laden", False), ("ballast", True)):
        st.save(day(moved), tmp_path / name)
    folders = [str(tmp_path / name) for name in ("laden", "ballast")]
    command = ["compare", *folders, "--out", str(tmp_path / "out"), "--manoeuvre", "zigzag:20/20"]
    done = CliRunner().invoke(app, [*command, "--json", str(tmp_path / "c.json")])
    assert done.exit_code == 0, done.output
    assert "particulars: d 0.71 -> 0.6" in done.output
    (marked,) = [line.split()[0] for line in done.output.splitlines() if line.endswith("differs")]
    assert marked == "N_r"
    table = json.loads((tmp_path / "c.json").read_text(encoding="utf-8"))
    assert "N_r" in table["significant"]
    again = st.load(tmp_path / "out")
    assert isinstance(again, Comparison)
    assert again.coefficients[0].name == table["coefficients"][0]["name"]
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert CliRunner().invoke(app, ["report", str(tmp_path / "out")]).exit_code == 0
    assert (tmp_path / "out" / "report.html").read_text(encoding="utf-8") == page
