"""The command for reports of faults says what is installed, and ends with an error where a known craft is not found."""

import pytest
from typer.testing import CliRunner

from seatrial.cli import app, doctor_command


def test_it_names_versions_cache_cores_and_extras_and_finds_the_craft() -> None:
    result = CliRunner().invoke(app, ["doctor"])
    assert result.exit_code == 0, result.output
    for words in ("python", "numba", "compile cache", "cores", "logs", "K 0.1500 1/s"):
        assert words in result.output


def test_an_extra_that_lacks_a_package_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    wanted = ["numpy>=1", "no-such-package>=1; extra == 'logs'", "numpy; extra == 'formats'", "x; extra == 'dev'"]
    monkeypatch.setattr("importlib.metadata.requires", lambda _: wanted)
    assert dict(doctor_command._extras()) == {
        "formats": "installed",
        "logs": "lacks no-such-package: pip install 'seatrial[logs]'",
    }


def test_a_craft_that_is_not_found_is_an_error_of_the_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(doctor_command, "_check", lambda: (False, "K 0.3"))
    result = CliRunner().invoke(app, ["doctor"])
    assert isinstance(result.exception, RuntimeError) and "K 0.3" in result.output
