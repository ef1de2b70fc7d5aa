"""What `seatrial models NAME` says: what a model needs, what is filled, and tables that work once filled in."""

import re
import tomllib
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.data.trial.model_table import model_guide
from seatrial.physics.models import MODELS

RECORD = "t,u,v,r,delta,n\n" + "".join(f"{k},1.0,0.0,0.0,{k % 3},1.0\n" for k in range(40))
RECORDS = """
[[records]]
files = "run.csv"
time = { column = "t" }
channels.u = { column = "u", unit = "m/s" }
channels.delta = { column = "delta", unit = "deg" }
channels.n = { column = "n", unit = "rps" }
"""
TANKER = {"L": 320.0, "B": 58.0, "d": 20.8, "C_b": 0.81, "H_R": 15.8, "A_R": 112.5, "D_P": 9.86}


def filled_in(tables: str, values: dict[str, float]) -> str:
    """The printed tables with the placeholders of these values replaced."""
    return re.sub(r"^(?:# )?(\w+) = 0\.0", lambda m: f"{m[1]} = {values[m[1]]}", tables, flags=re.MULTILINE)


@pytest.mark.parametrize("name", sorted(MODELS))
def test_every_model_has_a_guide_whose_tables_are_toml(name: str) -> None:
    guide = model_guide(name)
    assert guide.needed["L"] and guide.inputs and guide.source
    assert tomllib.loads(guide.trial)["model"]["name"] == name
    named = {one.name for one in guide.filled}
    assert not named & set(guide.needed)


def test_an_mmg_model_needs_seven_particulars(tmp_path: Path) -> None:
    guide = model_guide("mmg")
    assert set(guide.needed) == set(TANKER)
    (tmp_path / "run.csv").write_text(RECORD, encoding="utf-8")
    (tmp_path / "trial.toml").write_text(filled_in(guide.trial, TANKER) + RECORDS, encoding="utf-8")
    model = load_trial(tmp_path / "trial.toml").model
    assert not model.parameters.missing
    wake, thrust = model.parameters["w_P0"], model.parameters["t_P"]
    assert wake.prior is not None and thrust.prior is not None
    assert (wake.prior.mean, wake.prior.standard_deviation) == (pytest.approx(0.355), 0.18)
    assert (thrust.prior.mean, thrust.prior.standard_deviation) == (pytest.approx(0.223), 0.05)
    assert "Harvald" in thrust.prior.source and "Oosterveld" in model.parameters["k_0"].source
    assert model.parameters["m"].value == pytest.approx(312.6e6 * 1.025, rel=0.01)


def test_tables_that_are_not_filled_in_say_what_is_missing(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(RECORD, encoding="utf-8")
    for values, says in (({}, "key 'ship.L' is missing"), ({"L": 320.0}, "lacks B, d, C_b for empirical")):
        text = re.sub(r"^L = 0\.0", "L = 320.0", model_guide("mmg").trial, flags=re.MULTILINE) if values else ""
        (tmp_path / "trial.toml").write_text((text or model_guide("mmg").trial) + RECORDS, encoding="utf-8")
        with pytest.raises(InputError, match=says):
            load_trial(tmp_path / "trial.toml")
    with pytest.raises(InputError, match="unknown model 'mgm'"):
        model_guide("mgm")
