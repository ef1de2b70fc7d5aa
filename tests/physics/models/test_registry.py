"""Models by name and by file: what is unknown or broken is refused in one sentence."""

import subprocess
import sys
from pathlib import Path

import pytest

from seatrial.core.equations import Model
from seatrial.core.values import InputError
from seatrial.physics.models import MODELS, model_from_file, model_named
from seatrial.physics.models.abkowitz import STANDARD, TERMS, abkowitz
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.published import PARAMETER_SETS, parameter_set

OWN = """
from seatrial.core.equations import Model, Sheet

def model() -> Model:
    sheet = Sheet("own")
    (r,) = sheet.states("r")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 10.0, "s", free=True)
    sheet.rate(r, (delta - r) / T)
    return sheet.model()
"""


def test_every_name_gives_its_model() -> None:
    for name in MODELS:
        assert model_named(name).name == name


def test_an_unknown_name_gets_the_nearest() -> None:
    with pytest.raises(InputError, match="unknown model 'abkowits'; did you mean 'abkowitz'"):
        model_named("abkowits")


def test_a_model_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "own.py"
    path.write_text(OWN)
    model = model_from_file(path)
    assert isinstance(model, Model)
    assert model.parameters.free_names == ("T",)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("x = 1\n", "defines no function 'model'"),
        ("def model():\n    return 3\n", "gave a int, not a Model"),
        ("def model():\n    return 1 / 0\n", "line 2: ZeroDivisionError"),
        ("def model(:\n", "line 1: SyntaxError"),
    ],
)
def test_a_file_without_a_model_is_refused(tmp_path: Path, text: str, sentence: str) -> None:
    path = tmp_path / "broken.py"
    path.write_text(text)
    with pytest.raises(InputError, match=sentence):
        model_from_file(path)


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="does not exist"):
        model_from_file(tmp_path / "none.py")


def test_importing_the_room_imports_no_model() -> None:
    program = "import sys, seatrial.physics.models; print([m for m in ('sympy', 'numba') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_a_subset_of_terms_is_a_mask() -> None:
    terms = ("X_u", "Y_v", "Y_r", "Y_d", "N_v", "N_r", "N_d")
    full, linear = abkowitz(TERMS), abkowitz(terms)
    assert full.equation_hash == linear.equation_hash == abkowitz().equation_hash
    assert set(linear.parameters.free_names) == set(terms)
    assert set(abkowitz().parameters.free_names) == set(STANDARD)
    with pytest.raises(InputError, match="unknown parameter 'Y_vvw'"):
        abkowitz(["Y_vvw"])


def test_parameter_sets_complete_their_model() -> None:
    for name in PARAMETER_SETS:
        chosen = parameter_set(name)
        assert not chosen.applied_to(model_named(chosen.model)).parameters.missing
        assert chosen.source
        assert chosen.ship.source
    with pytest.raises(InputError, match="did you mean 'kvlcc2'"):
        parameter_set("kvlc2")


def test_a_ship_without_propeller_is_stated_what_is_missing() -> None:
    ship = parameter_set("kvlcc2").ship
    with pytest.raises(InputError, match=r"needs .*k_0.*w_P0"):
        mmg().with_ship(ship)
