"""The JavaScript of a model takes the steps of the package's own simulation, and stays with it over a run."""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from benchmarks.export_c99 import STEP, complete_model, own_steps, random_states
from tests.reporting.fabricated import zigzag

import seatrial as st
from seatrial.core.equations import Model
from seatrial.core.values import Array
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.replay import inputs_of, trajectory
from seatrial.reporting.resimulation import replay_script

# relative, of a step: rounding, and sines of another library; of the range, over a run: what they grow to
STEP_TOLERANCE, RUN_TOLERANCE = 1e-12, 1e-9


@pytest.fixture(scope="session")
def node() -> str:
    """The machine's JavaScript."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("no node on this machine; install Node.js to run the script of a page")
    return found


def replayed(node: str, folder: Path, model: Model, starts: Array, inputs: Array, dt: float = STEP) -> Array:
    """States of every run, (runs, samples, states), from starts (runs, states) and inputs (runs, samples, nu)."""
    runs = [
        {"dt": dt, "count": len(columns), "start": start.tolist(), "inputs": columns.T.tolist(),
         "held": [i.is_held for i in model.inputs], "limits": [1e9] * len(start)}
        for start, columns in zip(starts, inputs, strict=True)
    ]  # fmt: skip
    (folder / "runs.json").write_text(json.dumps({"runs": runs, "p": model.parameters.values.tolist()}))
    end = 'const { runs, p } = JSON.parse(require("fs").readFileSync("runs.json"));\n'
    end += "console.log(JSON.stringify(runs.map(run => replay(rates, run, p).states.map(one => [...one]))));"
    (folder / "run.js").write_text(replay_script(model) + end)
    done = subprocess.run([node, "run.js"], cwd=folder, capture_output=True, text=True, check=True)
    return np.array(json.loads(done.stdout), dtype=float).transpose(0, 2, 1)


@pytest.mark.parametrize("name", ["waterjet", "thrusters", "abkowitz", "roll", "mmg"])
def test_a_step_is_that_of_the_simulation(name: str, node: str, tmp_path: Path, rng: np.random.Generator) -> None:
    model = complete_model(name, rng)
    draw = random_states(model, 200, rng)
    there = replayed(node, tmp_path, model, draw.states, draw.inputs)[:, 1]
    here = own_steps(model, draw)
    size = np.maximum(np.maximum(np.abs(here), np.abs(draw.states)), draw.scale)
    fine = np.isfinite(here).all(axis=1)
    assert fine.mean() > 0.9  # nearly all draws must count
    assert np.max(np.abs(there - here)[fine] / size[fine]) <= STEP_TOLERANCE


@pytest.mark.parametrize("held", [(), ("delta",)])
def test_a_run_stays_with_the_simulation(held: tuple[str, ...], node: str, tmp_path: Path) -> None:
    model, record = waterjet().with_held(held), zigzag("zigzag_20_20", 20.0)
    inputs = inputs_of(model, record)
    start = np.array([record[s][0] for s in model.states])
    here, _ = trajectory(model, inputs, record.dt, start)
    (there,) = replayed(node, tmp_path, model, start[None], inputs[None], record.dt)
    assert len(here) > 1000
    assert np.max(np.abs(there - here) / np.ptp(here, axis=0)) <= RUN_TOLERANCE


def test_a_run_that_diverges_ends_where_it_leaves_its_limits(node: str, tmp_path: Path) -> None:
    sheet = st.Sheet("runaway", "a text book")
    (x,) = sheet.states("x")
    sheet.rate(x, x**3 * sheet.parameter("k", 1.0, free=True))
    (states,) = replayed(node, tmp_path, sheet.model(), np.array([[1.0]]), np.empty((1, 50, 0)))
    assert np.isfinite(states[:3]).all() and np.isnan(states[-1]).all()
