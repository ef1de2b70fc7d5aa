"""The model file: exact both ways, refused when its equations have changed, never executed."""

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.equations import Model, Sheet
from seatrial.core.results import IntervalBasis, SessionOffset
from seatrial.core.values import InputError, Prior, Ship
from seatrial.data.folder.model_file import (
    ModelFile,
    ModelProvenance,
    RecordSource,
    model_text,
    parse_model,
    read_model,
    read_model_file,
    write_model,
)
from seatrial.physics.models import model_named

numbers = st.floats(allow_nan=False, allow_infinity=False)


def whole_file() -> ModelFile:
    model = model_named("waterjet")
    parameters = model.parameters.bounded("Y_v", -1.0, math.inf).with_priors({"N_v": Prior(-0.1, 0.02, "guess")})
    count = len(parameters.free)
    rng = np.random.default_rng(1)
    root = rng.normal(size=(count, count))
    return ModelFile(
        model.with_parameters(parameters),
        root @ root.T,
        ModelProvenance(
            (RecordSource("run", "training", "ab12"),),
            "output error",
            7,
            {"seatrial": "0"},
            ("[held-coupling] alpha is held at 0",),
        ),
        Ship("craft", {"L": 9.8}, "paper", 2.0),
        {"u": 0.8, "v_j": 1.866},
        offsets=(SessionOffset("delta zero", "rad", 0.03, {"1 May": 0.1 / 3.0, "2 May": 0.02}),),
    )


def test_everything_reads_back_to_the_last_bit() -> None:
    file = whole_file()
    back = parse_model(model_text(file), "model.toml")
    assert back.model.parameters == file.model.parameters
    assert np.array_equal(back.covariance, file.covariance)
    assert back.provenance == file.provenance
    assert (back.ship, back.approach, back.offsets) == (file.ship, file.approach, file.offsets)


@pytest.mark.parametrize("name", ["rudder zero", "delta bias", "K"])
def test_an_offset_of_nothing_in_the_model_is_refused(name: str) -> None:
    text = model_text(whole_file()).replace('"delta zero"', f'"{name}"')
    with pytest.raises(InputError, match=f"offset '{name}' is of no input or parameter of the model"):
        parse_model(text, "model.toml")


@given(numbers)
def test_any_value_reads_back_to_the_last_bit(value: float) -> None:
    model = model_named("waterjet").with_values({"Y_v": value})
    back = parse_model(model_text(ModelFile(model)), "model.toml").model.parameters["Y_v"].value
    assert np.float64(back).tobytes() == np.float64(value).tobytes()


def test_other_equations_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    text = model_text(whole_file())
    path.write_text(text.replace(model_named("waterjet").equation_hash, "0" * 64))
    with pytest.raises(InputError, match="written for other equations of model 'waterjet'"):
        read_model(path)


@pytest.mark.parametrize("place", [(0, 0), (0, 1)])
def test_an_element_far_beyond_the_variances_is_refused_without_a_warning(place: tuple[int, int]) -> None:
    broken = whole_file().covariance.copy()
    broken[place] = broken[place[::-1]] = -1e308
    text = model_text(replace(whole_file(), covariance=broken))
    with pytest.raises(InputError, match="not positive definite"):
        parse_model(text, "model.toml")


def own() -> Model:
    sheet = Sheet("my yaw")
    r, psi = sheet.states("r psi")
    delta = sheet.input("delta")
    gain = sheet.parameter("K", 0.1, "1/s", free=True)
    sheet.rate(r, gain * delta - r)
    sheet.rate(psi, r)
    return sheet.model()


def test_a_model_of_ones_own_is_handed_in(tmp_path: Path) -> None:
    write_model(ModelFile(own()), tmp_path / "model.toml")
    assert read_model(tmp_path / "model.toml", own()).parameters == own().parameters
    with pytest.raises(InputError, match=r"unknown model 'my yaw'.*--model FILE\.py"):
        read_model(tmp_path / "model.toml")


@pytest.mark.parametrize(
    ("content", "says"),
    [(b"\xff\xfe\x00", "not UTF-8"), (b"a = [", "no valid TOML"), (b"a = 1", "no seatrial model file")],
)
def test_rubbish_is_refused(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "model.toml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=says):
        read_model(path)


def test_a_file_with_other_parameters_is_refused() -> None:
    text = model_text(whole_file()).replace("[parameters.N_rr]", "[parameters.N_rx]")
    with pytest.raises(InputError, match="not those of model 'waterjet'"):
        parse_model(text, "model.toml")


def test_a_damaged_file_is_refused() -> None:
    text = model_text(whole_file()).replace("value = 9.8", "worth = 9.8")
    with pytest.raises(InputError, match="damaged"):
        parse_model(text, "model.toml")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("value = 9.8", "value = inf", r"L\.value = inf is no finite number"),
        ("value = 9.8", "value = true", r"L\.value = True is no finite number"),
        ("value = 9.8", 'value = "1_0"', r"L\.value = 1_0 is no finite number"),
        ("value = 9.8", "value = 9.8\nlower = nan", r"L\.lower = nan is no finite number"),
        ("value = 9.8", f"value = {10**400}", "beyond 64 bits"),
        ("\nL = 9.8", "\nL = nan", "L = nan is no finite number"),
    ],
)
def test_a_number_that_is_not_finite_is_refused(old: str, new: str, says: str) -> None:
    text = model_text(whole_file())
    assert old in text
    with pytest.raises(InputError, match=says):
        parse_model(text.replace(old, new), "model.toml")


def test_an_estimated_value_that_is_no_number_is_refused_with_file_and_key() -> None:
    text, count = re.subn(r"(\[parameters\.N_v\]\nvalue = ).*", r"\1nan", model_text(whole_file()))
    assert count == 1
    with pytest.raises(InputError, match=r"'model\.toml' is damaged: parameters\.N_v\.value = nan is no finite number"):
        parse_model(text, "model.toml")


def margin(count: int) -> IntervalBasis:
    return IntervalBasis(
        np.diag(np.linspace(0.1, 1.0, count)), math.inf, 2.5, {"overshoot_deg": 1.2}, {"delta zero": 0.005},
        {"r": 1e-4}, {"rudder": 0.5}, ({"Y_v": -0.3}, {"Y_v": -0.2, "N_v": -0.1}),
    )  # fmt: skip


def test_what_intervals_are_made_of_reads_back_to_the_last_bit() -> None:
    file = whole_file()
    given = margin(len(file.model.parameters.free))
    back = parse_model(model_text(replace(file, interval_basis=given)), "model.toml").interval_basis
    assert back is not None
    assert np.array_equal(back.covariance, given.covariance)
    assert vars(back) | {"covariance": 0} == vars(given) | {"covariance": 0}


def test_a_covariance_that_is_none_is_refused(tmp_path: Path) -> None:
    file = whole_file()
    broken = file.covariance.copy()
    broken[0, 1] = broken[1, 0] = 3.0 * math.sqrt(broken[0, 0] * broken[1, 1])
    path = tmp_path / "model.toml"
    path.write_text(model_text(replace(file, covariance=broken)))
    with pytest.raises(InputError, match=r"model\.toml': covariance is not positive definite \(smallest eigenvalue -"):
        read_model(path)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (
            lambda m, n: replace(m, covariance=np.eye(n - 1)),
            "interval_basis.covariance has [0-9]+ rows for [0-9]+ free",
        ),
        (
            lambda m, n: replace(m, covariance=np.diag([-1.0, *[1.0] * (n - 1)])),
            "interval_basis.covariance is not positive",
        ),
        (
            lambda m, n: replace(m, covariance=np.eye(n) + np.eye(n, k=1)),
            "interval_basis.covariance is not a symmetric",
        ),
        (lambda m, n: replace(m, covariance=np.full((n, n), math.nan)), "interval_basis.covariance is not a symmetric"),
        (lambda m, _: replace(m, degrees_of_freedom=math.nan), "interval_basis.degrees_of_freedom is nan"),
        (lambda m, _: replace(m, tied=({"Y_w": 1.0},)), "interval_basis.tied names 'Y_w'"),
    ],
)
def test_a_margin_that_cannot_be_is_refused(wrong: Callable[[IntervalBasis, int], IntervalBasis], says: str) -> None:
    file = whole_file()
    count = len(file.model.parameters.free)
    with pytest.raises(InputError, match=rf"model file 'model\.toml'.*{says}"):
        parse_model(model_text(replace(file, interval_basis=wrong(margin(count), count))), "model.toml")


@pytest.mark.parametrize(
    "path", sorted((Path(__file__).parent / "earlier_model_files").iterdir()), ids=lambda p: p.stem
)
def test_model_files_of_version_0_1_are_read_with_all_they_hold(path: Path) -> None:
    file = read_model_file(path)
    count = len(file.model.parameters.free)
    assert np.array_equal(file.covariance, 0.01 * np.eye(count))
    assert (file.ship, file.approach) == (Ship("craft", {"L": 9.8}, "paper", 2.0), {"u": 0.8})
    basis = file.interval_basis
    assert basis is not None
    assert (basis.degrees_of_freedom, basis.factor) == (5.0, 2.5)
    assert (basis.measure_deviation, basis.training_envelope) == ({"overshoot_deg": 1.2}, {"rudder": 0.5})
    assert (basis.offsets, basis.process) == ({"delta zero": 0.005}, {"r": 1e-4})
