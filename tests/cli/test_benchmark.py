"""`seatrial benchmark`."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

METHOD = """
class Start:
    def estimate(self, problem, rng):
        return problem.start
"""


def test_a_method_of_one_s_own_is_compared(
    tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "start.py").write_text(METHOD)
    out = tmp_path / "out"
    arguments = ["benchmark", "qi2025-135-whole", "--method", str(tmp_path / "start.py"), "--against", "output-error"]
    assert (
        run_command(*arguments, "--runs", "2", "--out", str(out), "--workers", "1", "--json", str(tmp_path / "j")) == 0
    )
    text = capsys.readouterr().out
    assert "output-error" in text and "start.py (entered)" in text and "to cite: seatrial" in text
    assert json.loads((tmp_path / "j").read_text()) == json.loads((out / "benchmark.json").read_text())
    assert (out / "benchmark.html").exists()


def test_problems_and_methods_are_listed(run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]) -> None:
    assert run_command("benchmark", "--list") == 0
    text = capsys.readouterr().out
    assert "qi2025-90-paper" in text and "yu2014-5-washout" in text and "iwho" in text


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([], "name at least one problem"),
        (["qi2025-35-whole", "--out", "x"], "did you mean 'qi2025-135-whole'"),
        (["qi2025-135-whole", "--out", "x", "--method", "absent.py"], "absent.py does not exist"),
    ],
)
def test_bad_input_is_one_sentence(
    arguments: list[str], sentence: str, run_command: Callable[..., int], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_command("benchmark", *arguments) == 2
    assert sentence in capsys.readouterr().err
