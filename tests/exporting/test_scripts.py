"""Exported MATLAB and CasADi texts: complete, and equal to the model where the language is installed."""

import importlib.util
import shutil
import subprocess
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from benchmarks.export_c99 import complete_model, random_states
from benchmarks.export_scripts import casadi_errors, octave_error
from scipy.io import loadmat

import seatrial as st
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting.scripts import export_matlab
from seatrial.exporting.source import ExportSource

TOLERANCE = 1e-12  # relative, of rates and of their Jacobian


def test_the_mat_file_holds_parameters_and_covariance(kvlcc2_file: ModelFile) -> None:
    files = export_matlab(ExportSource(kvlcc2_file, "model.toml", "2026-01-01"), "ship").files
    content = loadmat(BytesIO(files["ship.mat"]), simplify_cells=True)
    assert content["p"]["Y_v"] == kvlcc2_file.model.parameters["Y_v"].value
    assert list(content["estimated"]) == ["Y_v", "N_v"]
    assert np.array_equal(content["covariance"], kvlcc2_file.covariance)
    assert "|rudder| <= 0.5 rad" in content["provenance"]
    assert files == export_matlab(ExportSource(kvlcc2_file, "model.toml", "2026-01-01"), "ship").files


def test_the_matlab_text_names_every_quantity(kvlcc2_file: ModelFile) -> None:
    text = export_matlab(ExportSource(kvlcc2_file, "model.toml", "2026-01-01"), "ship").files["ship.m"].decode()
    assert "function [xdot, U] = ship(x, ui, p)" in text
    assert "delta [rad] rudder or nozzle angle, body-fixed, positive starboard" in text
    assert all(f"p.{name} = " in text for name in kvlcc2_file.model.parameters.names)


def test_the_casadi_module_is_python(kvlcc2_file: ModelFile, tmp_path: Path) -> None:
    st.export(kvlcc2_file, "casadi", tmp_path / "ship.py")
    text = (tmp_path / "ship.py").read_text()
    compile(text, "ship.py", "exec")
    assert "import casadi as ca" in text and "import seatrial" not in text


@pytest.mark.skipif(importlib.util.find_spec("casadi") is None, reason="CasADi is not installed here")
def test_casadi_gives_the_same_rates_and_jacobian(tmp_path: Path, rng: np.random.Generator) -> None:
    model = complete_model("mmg", rng)
    value, slope = casadi_errors(model, random_states(model, 20, rng), tmp_path)
    assert max(value, slope) < TOLERANCE


@pytest.mark.skipif(shutil.which("octave-cli") is None, reason="GNU Octave is not installed here")
@pytest.mark.parametrize("name", ["mmg", "roll"])
def test_octave_gives_the_same_rates(name: str, tmp_path: Path, rng: np.random.Generator) -> None:
    model = complete_model(name, rng)
    assert octave_error(model, random_states(model, 20, rng), tmp_path) < TOLERANCE
    wrong = subprocess.run(
        ["octave-cli", "--quiet", "--no-init-file", "--eval", f"{name}(1, 2)"],
        cwd=tmp_path / name, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert wrong.returncode != 0 and f"{name}: x needs" in wrong.stderr
