"""Runs are cut, named and held out by edits that the trial file's own reader understands."""

import tomllib
from itertools import pairwise
from pathlib import Path

import pytest
from tests.workspace.logs import write_trial

from seatrial.core.values import InputError
from seatrial.data.trial import Role, Run
from seatrial.workspace.logs_view import runs_by_block
from seatrial.workspace.run_edits import part_of, with_part, with_role, with_run_name, without_part

DURATION = 240.0


@pytest.fixture(scope="module")
def trial(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_trial(tmp_path_factory.mktemp("runs"))


@pytest.fixture
def text(trial: Path) -> str:
    return trial.read_text(encoding="utf-8")


def runs_of(text: str, trial: Path) -> dict[str, Run]:
    return {run.name: run for run in runs_by_block(text, trial)[0]}


def ends(text: str) -> dict[str, tuple[float, float] | None]:
    block = tomllib.loads(text)["records"][0]
    return {part["name"]: part_of(block, part["name"], DURATION) for part in block["parts"]}


def test_a_stretch_becomes_a_run_and_what_lies_beside_it_stays_one(text: str, trial: Path) -> None:
    cut = with_part(text, 0, "log_2", (50.0, 120.0), "middle", DURATION)
    assert set(runs_of(cut, trial)) == {"log_1", "log_3", "log_2_1", "log_2_2", "middle"}
    assert ends(cut) == {"log_2_1": (0.0, 50.0), "log_2_2": (120.0, 240.0), "middle": (50.0, 120.0)}
    again = with_part(cut, 0, "log_2", (100.0, 140.0), "later", DURATION)
    assert ends(again)["middle"] == (50.0, 100.0) and ends(again)["log_2_2"] == (140.0, 240.0)
    assert all(line in again for line in text.splitlines() if line.startswith("#"))


def test_no_sample_is_in_two_runs(text: str) -> None:
    cut = text
    for k, stretch in enumerate([(10.0, 60.0), (40.0, 200.0), (0.0, 15.0), (55.0, 58.0)]):
        cut = with_part(cut, 0, "log_1", stretch, f"cut_{k}", DURATION)
    pieces = sorted(piece for name, piece in ends(cut).items() if piece is not None)
    assert all(first[1] <= second[0] for first, second in pairwise(pieces))
    assert pieces[0][0] == 0.0 and pieces[-1][1] == DURATION


def test_a_part_is_removed_and_its_role_with_it(text: str, trial: Path) -> None:
    cut = with_part(text, 0, "log_1", (50.0, 120.0), "middle", DURATION)
    cut = with_role(cut, 0, tuple(runs_of(cut.replace('"log_1"    #', '"middle"    #'), trial).values()), "middle",
                    Role.VALIDATE)  # fmt: skip
    without = without_part(cut, 0, "middle")
    assert "middle" not in ends(without) and "validate" not in tomllib.loads(without)["records"][0]
    with pytest.raises(InputError, match="a whole log"):
        without_part(text, 0, "log_1")


def test_a_run_is_renamed_where_it_is_named(text: str, trial: Path) -> None:
    renamed = with_run_name(text, 0, "log_1", "zigzag", list(runs_of(text, trial)))
    assert runs_of(renamed, trial)["zigzag"].role is Role.VALIDATE
    with pytest.raises(InputError, match="already"):
        with_run_name(text, 0, "log_1", "log_2", list(runs_of(text, trial)))


@pytest.mark.parametrize("role", list(Role))
def test_a_run_has_the_role_that_it_is_given_and_the_others_keep_theirs(text: str, trial: Path, role: Role) -> None:
    before = runs_of(text, trial)
    after = runs_of(with_role(text, 0, tuple(before.values()), "log_3", role), trial)
    assert {name: run.role for name, run in after.items()} == {
        name: role if name == "log_3" else run.role for name, run in before.items()
    }


def test_what_is_no_run_is_refused(text: str) -> None:
    for stretch, name, reason in (((5.0, 5.2), "a", "shorter"), ((5.0, 50.0), " ", "needs a name")):
        with pytest.raises(InputError, match=reason):
            with_part(text, 0, "log_1", stretch, name, DURATION)
    with pytest.raises(InputError, match="number 5"):
        with_part(text, 4, "log_1", (5.0, 50.0), "a", DURATION)
