"""Lazy names: imported when first used, complete, and not hidden by a submodule of the same spelling."""

import subprocess
import sys

import pytest

import seatrial.physics.sea


def _printed_by(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip()


def test_a_package_imports_no_module_until_a_name_is_used() -> None:
    code = "import sys, seatrial.physics.sea as sea; before = 'numpy' in sys.modules; sea.ittc; print(before)"
    assert _printed_by(code) == "False"


@pytest.mark.parametrize("first", ["from seatrial.physics.sea.realise import Spacing", "pass"])
def test_a_function_is_not_hidden_by_its_module(first: str) -> None:
    code = f"{first}\nfrom seatrial.physics.sea import realise; print(callable(realise))"
    assert _printed_by(code) == "True"


def test_names_are_listed_before_they_are_imported() -> None:
    assert set(seatrial.physics.sea.__all__) <= set(dir(seatrial.physics.sea))


def test_an_unknown_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = seatrial.physics.sea.nothing
