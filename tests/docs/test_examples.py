"""Every Python block of README and docs runs, in order, one namespace for each page."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.fits import example_fit

import seatrial as st
from seatrial.api import prepared_run
from seatrial.data.folder.result_folder import save_result
from seatrial.physics.models import model_from_file

REPOSITORY = Path(__file__).parents[2]
PAGES = sorted([REPOSITORY / "README.md", *(REPOSITORY / "docs").rglob("*.md")])
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(REPOSITORY)))
def test_every_python_block_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = page.read_text(encoding="utf-8")
    (tmp_path / "examples").symlink_to(REPOSITORY / "examples")
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, object] = {"__name__": "example"}
    for block in BLOCK.finditer(text):
        lines_before = text[: block.start(1)].count("\n")
        exec(compile("\n" * lines_before + block[1], str(page), "exec"), namespace)


def test_the_readme_s_example_has_ten_lines() -> None:
    first = BLOCK.findall((REPOSITORY / "README.md").read_text(encoding="utf-8"))[0]
    assert sum(1 for line in first.splitlines() if line.strip()) <= 10


@pytest.mark.parametrize("page", ["README.md", "docs/equations.md"])
def test_the_model_of_one_s_own_is_a_file_that_can_be_loaded(page: str, tmp_path: Path) -> None:
    text = (REPOSITORY / page).read_text(encoding="utf-8")
    own = next(block for block in BLOCK.findall(text) if "def model()" in block)
    path = tmp_path / "own.py"
    path.write_text(own, encoding="utf-8")
    model = model_from_file(path)
    out, jacobian = np.empty(len(model.states)), np.zeros((len(model.states), 9))
    states = np.full(len(model.states), 0.1)
    model.compiled.rates_tangent(0.0, states, np.array([0.3]), model.parameters.values, out, jacobian)
    assert np.isfinite(out).all() and jacobian.any()


@pytest.mark.parametrize("name", ["heave_pitch", "heave_pitch_forces", "heave_pitch_spectrum"])
def test_the_examples_in_waves_give_their_coefficients_back(name: str) -> None:
    fit = example_fit(name)
    free = [c for c in fit.coefficients if not c.fixed]
    assert len(free) == 8
    assert all(abs(c.estimate - c.truth) < 3.5 * c.standard_error for c in free)  # type: ignore[operator]


def test_a_voyage_in_waves_is_replayed(tmp_path: Path) -> None:
    trial = REPOSITORY / "examples" / "heave_pitch.toml"
    folder = save_result(example_fit("heave_pitch"), tmp_path)
    record = prepared_run(trial, "voyage_held_out")
    simulated = st.simulate(st.load_model(folder / "model.toml"), record)
    settled = slice(300, None)
    for channel, noise in (("z", 0.01), ("theta", np.radians(0.02))):
        assert np.std((simulated[channel] - record[channel])[settled]) < 1.3 * noise
