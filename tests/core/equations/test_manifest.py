"""A model from its manifest is the model that was written: expressions, parameters, LaTeX and generated code."""

import json
from pathlib import Path

import pytest

from seatrial.core.equations.bindings import entry_key, stored
from seatrial.core.equations.generate import bindings_text, source_text
from seatrial.core.equations.latex import latex_equations
from seatrial.core.equations.model import stored_equations, stored_model
from seatrial.numerics.kernels.cache import read_entry, write_entry
from seatrial.physics.models import MODELS


def unwritten() -> None:
    raise AssertionError("worked out again")


@pytest.mark.parametrize("name", MODELS)
def test_a_built_in_model_comes_back_whole(name: str) -> None:
    written = MODELS[name]()
    key = ("test", name, written.equations.digest)  # so that no manifest of an earlier version is met
    stored_model(key, lambda: written, ())
    read = stored_model(key, unwritten, ())  # pyright: ignore[reportArgumentType]
    assert read.equations.digest == written.equations.digest
    assert read.is_affine == written.is_affine
    assert repr(read.parameters) == repr(written.parameters)
    assert (read.inputs, read.bindings) == (written.inputs, written.bindings)
    assert latex_equations(read) == latex_equations(written)
    assert source_text(read.equations) == source_text(written.equations)
    assert bindings_text(read.equations) == bindings_text(written.equations)


def test_equations_come_back_whole() -> None:
    written = MODELS["roll"]().equations
    stored_equations(("test", "roll"), lambda: written)
    read = stored_equations(("test", "roll"), unwritten)  # pyright: ignore[reportArgumentType]
    assert (read.rates, read.outputs, read.parameters) == (written.rates, written.outputs, written.parameters)


def test_other_keys_and_other_sources_are_other_entries(tmp_path: Path) -> None:
    (tmp_path / "source.py").write_text("a = 1")
    assert len({entry_key(("a",)), entry_key(("b",)), entry_key(("a",), (tmp_path,))}) == 3


def test_a_value_is_worked_out_once() -> None:
    key = ("a value",)
    assert stored("test", key, lambda: {"a": [1.5, float("inf")]}) == {"a": [1.5, float("inf")]}
    assert stored("test", key, unwritten) == {"a": [1.5, float("inf")]}


def test_an_entry_that_is_no_json_is_made_again() -> None:
    name = f"test-{entry_key(('no JSON',))}.json"
    write_entry(name, b"{")
    assert stored("test", ("no JSON",), lambda: 1) == 1
    content = read_entry(name)
    assert content is not None and json.loads(content) == 1
