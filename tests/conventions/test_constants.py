"""Numeric constants say what they are: unit, meaning and origin stand at their line."""

from tests.conventions.list_constants import bare_constants


def test_every_constant_says_what_it_is() -> None:
    assert [f"{constant.place}: {constant.line}" for constant in bare_constants()] == []
