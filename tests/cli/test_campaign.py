"""The command campaign: a plan is run, looked at, gathered; what is wrong is one line."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

FLEET = 'kind = "fleet"\ntrials = ["*.trial"]\n'


@pytest.fixture
def plan(tmp_path: Path) -> Path:
    """Two trials that are none, so that every task fails at once."""
    for name in ("a", "b"):
        (tmp_path / f"{name}.trial").write_text(f'[ship]\nname = "{name}"\nL = 3.0\n[modell]\n')
    (tmp_path / "plan.toml").write_text(FLEET)
    return tmp_path / "plan.toml"


def test_a_plan_is_run_looked_at_and_gathered(
    plan: Path, tmp_path: Path, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    store = tmp_path / "store"
    assert run_command("campaign", "--out", store, plan, "--workers", "1") == 0
    assert "0 of 2 tasks done, 2 failed." in capsys.readouterr().out
    assert run_command("campaign", "status", store, "--json", tmp_path / "s.json") == 0
    assert json.loads((tmp_path / "s.json").read_text())["failed"] == 2
    capsys.readouterr()
    assert run_command("campaign", "gather", store, "--to", tmp_path / "t.csv") == 0
    assert "unknown key 'modell'" in capsys.readouterr().out
    assert (tmp_path / "t.html").stat().st_size > 1000
    assert run_command("campaign", "retry", store, "--workers", "1") == 0
    assert len(list((store / "journals").iterdir())) == 2


@pytest.mark.parametrize(("arguments", "sentence"), [
    (("status", "."), "holds no campaign"),
    (("no.toml", "--out", "store"), "plan 'no.toml' cannot be read"),
    (("plan.toml", "--out", "store", "--shard", "0/3"), "shards count from 1 to 3"),
    (("gather", "store", "--to", "t.xlsx"), "holds no campaign"),
])  # fmt: skip
def test_bad_input_is_one_line(
    arguments: tuple[str, ...], sentence: str, plan: Path, run_command: Callable[..., int],
    capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    monkeypatch.chdir(plan.parent)
    assert run_command("campaign", *arguments) == 2
    error = capsys.readouterr().err.strip()
    assert sentence in error
    assert "\n" not in error


@pytest.mark.parametrize("action", ["", "run", "status", "gather", "retry"])
def test_help_of_every_action_has_an_example(
    action: str, run_command: Callable[..., int], capsys: pytest.CaptureFixture
) -> None:
    assert run_command("campaign", *([action] if action else []), "--help") == 0
    assert "Example: seatrial campaign" in capsys.readouterr().out
