"""Decays of heave and pitch in calm water, simulated by their own equations: drafted from logs, and fitted."""

from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.core.values import InputError
from seatrial.data.draft.draft import draft_trial
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify

STEP, HELD, ROWS = 0.02, 100, 600  # s, rows before the release, rows of the decay
MASS = {"m": 90.0, "I5": 40.0}
STIFFNESS = {"c33": 7700.0, "c35": -60.0, "c53": -60.0, "c55": 2600.0}
TRUTH = {"a33": 85.0, "a35": -4.0, "a55": 35.0, "a53": -4.0, "b33": 220.0, "b35": 10.0, "b55": 95.0, "b53": -8.0}
NOISE = (1.5e-4, np.radians(0.02))  # m, rad
RELEASES = ((0.04, 0.0), (-0.03, 0.01), (0.0, 0.05))  # m, rad


def matrix(values: dict[str, float], letter: str) -> np.ndarray:
    """The coefficients of a letter as a matrix of heave and pitch."""
    return np.array([[values[f"{letter}{i}{j}"] for j in "35"] for i in "35"])


def write_decay(path: Path, release: tuple[float, float], seed: int) -> None:
    """Two seconds held, then free: (M + A) x'' + B x' + C x = 0 (Salvesen, Tuck & Faltinsen 1970, eq. (1))."""
    inertia = np.diag([*MASS.values()]) + matrix(TRUTH, "a")
    damping, stiffness = matrix(TRUTH, "b"), matrix(STIFFNESS, "c")
    lower = -np.linalg.solve(inertia, np.hstack([stiffness, damping]))
    step = expm(STEP * np.vstack([np.hstack([np.zeros((2, 2)), np.eye(2)]), lower]))
    states = [np.array([*release, 0.0, 0.0])]
    for row in range(HELD + ROWS):
        states.append(states[-1] if row < HELD else step @ states[-1])
    motion = np.array(states)[:, :2] + NOISE * np.random.default_rng(seed).standard_normal((len(states), 2))
    table = np.column_stack([STEP * np.arange(len(states)), 1000.0 * motion[:, 0], np.degrees(motion[:, 1])])
    np.savetxt(path, table, "%.4f", ",", header="time [s],heave [mm],pitch [deg]", comments="")


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("decays")
    paths = [folder / f"decay_{number}.csv" for number in (1, 2, 3)]
    for seed, (path, release) in enumerate(zip(paths, RELEASES, strict=True)):
        write_decay(path, release, seed)
    return paths


def stated(text: str, **values: float) -> str:
    """The draft with particulars as they are, and heave positive down, its open question answered."""
    keys = [(line.partition(" =")[0], line.replace("# channels.z", "channels.z")) for line in text.splitlines()]
    return "\n".join(f"{key} = {values[key]}" if key in values else line for key, line in keys)


def test_decays_are_drafted_and_give_added_masses_and_damping_back(logs: list[Path]) -> None:
    folder = logs[0].parent
    draft = draft_trial(*logs, folder=folder, size=StatedSize(length=2.5, mass=90.0))
    assert 'name = "heave_pitch"' in draft.text
    assert "from_release = true" in draft.text
    path = folder / "trial.toml"
    path.write_text(stated(draft.text, **MASS, **STIFFNESS))
    fit = identify(load_trial(path))
    free = {c.name: c for c in fit.coefficients if not c.fixed}
    assert free.keys() == TRUTH.keys()
    errors = [(c.estimate - TRUTH[n]) / c.standard_error for n, c in free.items() if c.standard_error]
    assert np.max(np.abs(errors)) < 4.0
    assert free["a33"].standard_error == pytest.approx(0.0, abs=0.01 * TRUTH["a33"])


def test_a_ship_that_lies_still_is_no_decay(logs: list[Path], tmp_path: Path) -> None:
    still = tmp_path / "still.csv"
    rows = logs[0].read_text().splitlines()[: HELD + 1]
    still.write_text("\n".join(rows))
    particulars = "\n".join(f"{n} = {v}" for n, v in {**MASS, **STIFFNESS}.items())
    path = tmp_path / "trial.toml"
    path.write_text(
        f'[ship]\nname = "model"\nL = 2.5\n{particulars}\n[model]\nname = "heave_pitch"\n[[records]]\n'
        'files = ["still.csv"]\ntime = { column = "time [s]" }\n'
        'channels.theta = { column = "pitch [deg]", unit = "deg" }\n'
        'channels.z = { column = "heave [mm]", unit = "mm", positive = "down" }\n'
    )
    with pytest.raises(InputError, match="or decays from a release"):
        identify(load_trial(path))
