"""Waves that the motions contradict: what the trial states of probe and speed is wrong, the motions are right."""

from pathlib import Path

import numpy as np
import pytest
from tests.estimation.identify.test_box_forces_effect import TRIAL, motions

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.estimation.identify.identify import identify

ZETA = '"zeta", unit = "m"'


def findings(folder: Path, old: str, new: str, lacking: float = 0.0) -> str:
    """What the fit, or its refusal, says of the instruments where the trial says `new` for what is right."""
    assert old in TRIAL
    np.savetxt(folder / "run.csv", motions(lacking), delimiter=",", header="t,zeta,z,theta", comments="")
    (folder / "trial.toml").write_text(TRIAL.replace(old, new))
    try:
        return " ".join(
            f.text for f in identify(load_trial(folder / "trial.toml")).findings if f.code == "sensor-error"
        )
    except InputError as error:
        return str(error)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (ZETA, f'{ZETA}, positive = "down"', "the elevation zeta is positive down"),
        (ZETA, f"{ZETA}, reference_point = 0.5", "the probe stands 0.52 m aft"),
        (ZETA, f"{ZETA}, reference_point = -0.26", "the probe stands 0.26 m forward"),
        ("speed = 1.6", "speed = 2.0", "at 0.80 of the speed"),
    ],
)
def test_what_is_stated_wrongly_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    text = findings(tmp_path, old, new)
    assert "contradict the waves as they are stated" in text
    assert said in text


@pytest.mark.parametrize("lacking", [0.0, 0.12])
def test_nothing_is_said_of_waves_stated_rightly(tmp_path: Path, lacking: float) -> None:
    """Also where the forces are not the hull's: the box's are named for that."""
    assert not findings(tmp_path, "speed = 1.6", "speed = 1.6", lacking)
