"""Several speeds and headings fitted together: six coefficients at rest, tied by strip theory."""

import math
from pathlib import Path

import numpy as np

from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.published import QI2025_SHIP
from seatrial.physics.sea.realise import realise, wave_record
from seatrial.physics.sea.spectrum import ittc
from seatrial.physics.simulate.linear import LinearBatch
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, box_hull

AT_REST = {"a33": 6e5, "b33": 8e5, "a35_0": 5e6, "b35_0": 3e6, "a55_0": 1.2e8, "b55_0": 1.6e8}
DT = 0.05
CHANNELS = {"F3": "N", "M5": "N m", "u": "m/s", "omega_e": "rad/s", "z": "m", "theta": "rad"}


def at_speed(U: float, omega_e: float) -> dict[str, float]:
    """The eight coefficients at speed (Salvesen, Tuck & Faltinsen 1970)."""
    r, lever = AT_REST, U / omega_e**2
    return {
        "a33": r["a33"], "b33": r["b33"],
        "a35": r["a35_0"] - lever * r["b33"], "a53": r["a35_0"] + lever * r["b33"],
        "b35": r["b35_0"] + U * r["a33"], "b53": r["b35_0"] - U * r["a33"],
        "a55": r["a55_0"] + U * lever * r["a33"], "b55": r["b55_0"] + U * lever * r["b33"],
    }  # fmt: skip


def write_run(path: Path, U: float, heading: int, seed: int) -> None:
    rng, omega_e, time = np.random.default_rng(seed), 1.8, np.arange(1801) * DT
    lines = realise(ittc(2.27), U, math.radians(heading), rng)
    forces = wave_record(lines, time, box_hull())
    model = heave_pitch().with_values(at_speed(U, omega_e)).with_ship(QI2025_SHIP)
    inputs = np.zeros((len(time), 4))
    inputs[:, 0], inputs[:, 1] = -forces["F3"], -forces["M5"]
    y, _ = LinearBatch(model, inputs, np.array([0, len(time)]), DT, ("z", "theta")).simulate(
        0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0))
    )
    y = y + rng.standard_normal(y.shape) * [HEAVE_NOISE, PITCH_NOISE]
    table = np.column_stack([time, forces["F3"], forces["M5"], np.full(len(time), U), np.full(len(time), omega_e), y])
    np.savetxt(path, table, delimiter=",", header=",".join(["time", *CHANNELS]), comments="", fmt="%.9g")


def test_two_speeds_and_headings_give_one_ship(tmp_path: Path) -> None:
    for number, (U, heading) in enumerate([(5.0, 135), (9.26, 180), (9.26, 110)]):
        write_run(tmp_path / f"run{number}.csv", U, heading, number)
    particulars = "\n".join(f"{k} = {v!r}" for k, v in QI2025_SHIP.particulars.items())
    columns = "\n".join(f'{c} = {{ column = "{c}", unit = "{unit}" }}' for c, unit in CHANNELS.items())
    truth = "\n".join(f"{k} = {v!r}" for k, v in AT_REST.items())
    (tmp_path / "trial.toml").write_text(
        f'[ship]\nname = "ship"\n{particulars}\n[[records]]\nfiles = "run*.csv"\nheader_lines = 1\n'
        f'time = {{ column = "time", unit = "s" }}\n[records.channels]\n{columns}\n'
        f'[model]\nname = "heave_pitch_strip"\n[truth]\n{truth}\n'
    )
    fit = identify(load_trial(tmp_path / "trial.toml"))
    free = [c for c in fit.coefficients if not c.fixed]
    assert [c.name for c in free] == list(AT_REST)
    for c in free:
        assert c.standard_error is not None and c.truth is not None
        assert abs(c.estimate - c.truth) < 4.0 * c.standard_error
        assert c.standard_error < 0.03 * abs(c.truth)
