"""Projections onto Gazebo's plugins: exact where these have the model's terms, better than truncation elsewhere."""

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import sympy as sp

import seatrial as st
from seatrial.core.values import InputError, Record
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting import ExportSource
from seatrial.exporting.gazebo import GZ_SIM, VRX, training_motions, training_runs, unsuitable_craft
from seatrial.exporting.projection import project

MASS, INERTIA, ADDED = 20.0, 3.0, (2.0, 12.0, 1.0)  # kg, kg m^2, of a craft of a metre
DRAG = {"xU": 2.0, "xUU": 12.0, "yV": 20.0, "yVV": 60.0, "nR": 4.0, "nRR": 3.0}
"""Coefficients in VRX's signs: N s/m, N s^2/m^2 and so on."""


def craft(side_force: float = 0.0, moment: float = 0.0) -> st.Model:
    """A craft with VRX's equations, and with a side force by u r and a moment by u v, which VRX lacks."""
    sheet = st.Sheet("barge")
    u, v, r, psi, x0, y0 = sheet.states("u v r psi x0 y0")
    delta = sheet.input("delta")
    m = sheet.parameter("m", MASS, "kg")
    inertia = sheet.parameter("I_z", INERTIA, "kg m^2")
    m_x, m_y, J_z = (sheet.parameter(n, a) for n, a in zip(("m_x", "m_y", "J_z"), ADDED, strict=True))
    sheet.parameter("L", 1.0, "m")
    Y_ur, N_uv = sheet.parameter("Y_ur", side_force), sheet.parameter("N_uv", moment)
    c = {n: sheet.parameter(f"c_{n}", value) for n, value in DRAG.items()}
    X_H = sheet.bind("X_H", -c["xU"] * u - c["xUU"] * u * sp.Abs(u))
    Y_H = sheet.bind("Y_H", -c["yV"] * v - c["yVV"] * v * sp.Abs(v) + Y_ur * u * r)
    N_H = sheet.bind("N_H", -c["nR"] * r - c["nRR"] * r * sp.Abs(r) + N_uv * u * v)
    X = sheet.bind("X_sum", X_H + 20.0)
    Y = sheet.bind("Y_sum", Y_H - 8.0 * delta)
    N = sheet.bind("N_sum", N_H + 4.0 * delta)
    sheet.rate(u, X / (m + m_x) + v * r)
    sheet.rate(v, Y / (m + m_y) - u * r)
    sheet.rate(r, N / (inertia + J_z))
    sheet.rate(psi, r)
    sheet.rate(x0, u * sp.cos(psi) - v * sp.sin(psi))
    sheet.rate(y0, u * sp.sin(psi) + v * sp.cos(psi))
    return sheet.model()


@pytest.fixture(scope="module")
def with_more_terms() -> ModelFile:
    """A craft with two terms that VRX lacks."""
    return ModelFile(craft(6.0, -3.0), ship=st.Ship("barge", {"L": 1.0}, "made", 30.0))


@pytest.fixture(scope="module")
def motions(with_more_terms: ModelFile) -> list[Record]:
    """Its zigzag and circle."""
    return training_motions(ExportSource(with_more_terms, "model.toml", "2026-01-01"))


def test_what_the_target_has_is_taken_over_unchanged() -> None:
    file = ModelFile(craft(), ship=st.Ship("barge", {"L": 1.0}, "made", 30.0))
    records = training_motions(ExportSource(file, "model.toml", "2026-01-01"))
    found = project(file, VRX, records, records[:1])
    assert found.run_errors[0].refitted == found.errors[0].refitted
    wanted = dict(zip(("xDotU", "yDotV", "nDotR"), ADDED, strict=True)) | DRAG
    # of surge little is determined: the speed hardly changes
    for name in ("yDotV", "nDotR", "yV", "nR", "nRR"):
        assert found.coefficients[name] == pytest.approx(wanted[name], rel=0.05), name
    assert all(error.refitted < math.radians(0.2) for error in found.errors)


def test_refitting_costs_at_most_half_of_truncating(with_more_terms: ModelFile, motions: list[Record]) -> None:
    found = project(with_more_terms, VRX, motions)
    for error in found.errors:
        assert error.refitted <= 0.5 * error.truncated, error.manoeuvre
    for tag in ("xUU", "yVV", "nRR"):  # drag that grows fastest never drives
        assert found.coefficients[tag] >= 0.0


def _plugin_heading(coefficients: dict[str, float], record: Record) -> np.ndarray:
    """Heading of a link under gz-sim's plugin, written from its source in Gazebo's axes (forward, port, up)."""
    nu, psi, headings = np.array([record["u"][0], 0.0, 0.0]), 0.0, []
    mass, steps = np.diag([MASS, MASS, INERTIA]), 10
    added = np.diag([coefficients[tag] for tag in ("xDotU", "yDotV", "nDotR")])
    for rudder in record["delta"]:
        headings.append(-psi)
        for _ in range(steps):
            speed = dict(zip("UVR", nu, strict=True))
            force = np.array([20.0, 8.0 * rudder, -4.0 * rudder])
            for tag, value in coefficients.items():
                if "Dot" not in tag:
                    first, second = tag[1], tag[2:]
                    by = abs(speed[second[3:]]) if second.startswith("abs") else speed[second] if second else 1.0
                    force["xyn".index(tag[0])] += value * speed[first] * by
            turning = MASS * nu[2] * np.array([nu[1], -nu[0], 0.0])
            nu = nu + record.dt / steps * np.linalg.solve(mass - added, force + turning)
            psi += record.dt / steps * nu[2]
    return np.array(headings)


def test_the_plugin_of_gz_sim_turns_as_the_projection_says(with_more_terms: ModelFile, motions: list[Record]) -> None:
    found = project(with_more_terms, GZ_SIM, motions[:1])
    assert found.errors[0].refitted < math.radians(1.0)
    error = _plugin_heading(dict(found.coefficients), motions[0]) - motions[0]["psi"]
    assert np.sqrt(np.mean(error**2)) < math.radians(2.0)  # of Euler's steps of 10 ms


def test_the_file_holds_the_plugin_and_its_price(with_more_terms: ModelFile, tmp_path: Path) -> None:
    result = st.export(with_more_terms, "vrx", tmp_path / "barge.xml")
    root = ElementTree.parse(tmp_path / "barge.xml").getroot()
    assert root.get("name") == "vrx::SimpleHydrodynamics"
    assert [e.tag for e in root] == ["link_name", "xDotU", "yDotV", "nDotR", *DRAG]
    text = (tmp_path / "barge.xml").read_text()
    assert result.notes[0].startswith("zigzag:20/20: rms heading error of the projection")
    assert result.notes[0] in text and "mass 20 kg, izz 3 kg m^2" in text


@pytest.mark.parametrize(
    ("model", "sentence"),
    [
        (st.models.nomoto(), "it has no state 'u'"),
        (st.models.heave_pitch(), "it has no state 'u'"),
        (st.models.abkowitz(), "it has no binding 'X_H'"),
        (st.models.model_named("thrusters"), "states the mass m and the inertia I_z"),
    ],
)
def test_a_model_without_a_place_is_refused(model: st.Model, sentence: str) -> None:
    assert sentence in unsuitable_craft(ExportSource(ModelFile(model), "model.toml", "2026-01-01"))


def test_training_runs_are_those_of_the_model_that_turn_most(with_more_terms: ModelFile, motions: list[Record]) -> None:
    source = ExportSource(with_more_terms, "model.toml", "2026-01-01", runs=tuple(motions))
    runs = training_runs(source)
    assert [run.name for run in runs] == ["turning-circle:20", "zigzag:20/20"]
    assert runs[0]["psi"] == pytest.approx(motions[1]["psi"], abs=1e-9)


def test_a_craft_whose_forces_are_not_newtons_is_refused() -> None:
    file = ModelFile(st.models.model_named("thrusters"), ship=st.Ship("boat", {"m": 20.0, "I_z": 3.0}, "made", 1.0))
    reason = unsuitable_craft(ExportSource(file, "model.toml", "2026-01-01"))
    assert "M_u of 1 kg is less than the mass m of 20 kg" in reason


def test_the_refusal_is_one_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="model 'nomoto' has no place in target 'vrx': it has no state 'u'"):
        st.export(st.models.nomoto(), "vrx", tmp_path / "ship.xml")
    assert list(tmp_path.iterdir()) == []
