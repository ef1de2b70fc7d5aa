"""Ready trials are found in the checkout, and the wheel carries the same file where an installed package looks."""

import tomllib
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import Role
from seatrial_studies import packaged_trials


def test_the_wheel_carries_the_examples_where_they_are_looked_for(repository: Path) -> None:
    table = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))
    included = table["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"]
    package = Path(packaged_trials.__file__).parents[1]
    for source, target in included.items():
        assert (repository / source).is_file()
        assert package / target == packaged_trials._EXAMPLE_FOLDERS[0] / Path(source).name


def test_kvlcc2_trains_on_twelve_and_validates_on_one(data_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    trial = packaged_trials.packaged_trial("kvlcc2_hsva.toml")
    assert len(trial.runs_with_role(Role.TRAIN)) == 12
    assert [run.name[-7:] for run in trial.runs_with_role(Role.VALIDATE)] == ["Z_35_05"]


def test_a_trial_nobody_shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(tmp_path))
    with pytest.raises(InputError, match=r"nobody\.toml"):
        packaged_trials.packaged_trial("nobody.toml")
