"""Another process compiles a model that is not in the cache; whatever it does, the body runs."""

import subprocess
from pathlib import Path
from typing import Any, ClassVar

import pytest

from seatrial.core.equations.bindings import compile_equations, is_cached
from seatrial.numerics.kernels import cache
from seatrial.physics.models import model_named
from seatrial.physics.models import registry as precompile


class Process:
    """Stands in for the other process: remembers how it was started and that it was ended."""

    started: ClassVar[list[list[str]]] = []

    def __init__(self, command: list[str], **_: Any) -> None:
        self.started.append(command)

    def wait(self, timeout: float = 0.0) -> None:
        if timeout:
            raise subprocess.TimeoutExpired("compilation", timeout)

    def kill(self) -> None:
        self.started.append(["killed"])


@pytest.fixture
def started(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[list[str]]:
    monkeypatch.setenv("SEATRIAL_CACHE", str(tmp_path))
    monkeypatch.setattr(cache, "_folders", cache._folders.__wrapped__)
    monkeypatch.setattr(subprocess, "Popen", Process)
    monkeypatch.setattr(precompile, "usable_cores", lambda: 2)
    monkeypatch.setattr(precompile, "_load_integrators", lambda **_: None)
    Process.started.clear()
    return Process.started


def test_a_compilation_that_takes_too_long_is_ended(started: list[list[str]]) -> None:
    with precompile.precompile("nomoto"):
        assert started[0][-1] == "nomoto"
    assert started[1] == ["killed"]


@pytest.mark.parametrize("name", ["no such model", "a user's"])
def test_other_models_are_left_alone(started: list[list[str]], name: str) -> None:
    with precompile.precompile(name):
        pass
    assert not started


def test_a_model_in_the_cache_is_left_alone(started: list[list[str]]) -> None:
    equations = model_named("roll").equations
    compile_equations.cache_clear()  # this process may have compiled them
    assert not is_cached(equations)
    compile_equations(equations)
    assert is_cached(equations)
    with precompile.precompile("roll"):
        pass
    assert not started
