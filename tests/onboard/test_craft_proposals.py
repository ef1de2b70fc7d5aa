"""Gains proposed from the coefficients of the moment while a ship in waves is followed."""

import tomllib
from pathlib import Path

import pytest
from benchmarks.changed_ships import Cell, Change, follower, voyage
from benchmarks.follow import samples
from tests.control.loop_files import RIDE_CONTROL, heave_pitch_file, write_loop_file

from seatrial.core.results.online import Proposal
from seatrial.core.values import InputError
from seatrial.data.trial.settings import ProposalSettings
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.onboard.proposer import CraftGainProposer, gain_proposer


def ride_files(folder: Path) -> ProposalSettings:
    """A ride control, its gains and the model they were tuned on."""
    heave_pitch_file(folder)
    loop = write_loop_file(folder, RIDE_CONTROL)
    (folder / "gains.toml").write_text("[gains]\nKP = 4.0\nKD = 6.0\n", encoding="utf-8")
    return ProposalSettings(loop=loop, gains=folder / "gains.toml", every_s=60.0)


def test_a_followed_ship_in_waves_has_gains_once_its_coefficients_are_known(tmp_path: Path) -> None:
    settings = ride_files(tmp_path)
    _, trial, stream = follower()
    record = voyage(Cell(Change({})), 200.0, 3).record
    estimator = OnlineEstimator(trial)
    proposer = gain_proposer(trial, settings, estimator, tmp_path / "proposal.toml")
    assert isinstance(proposer, CraftGainProposer)
    proposals = list[Proposal]()
    for sample in samples(record, stream):
        estimator.update(sample)
        proposer.add(sample)
        if not proposals or proposer.proposal is not proposals[-1]:
            proposals.append(proposer.proposal)
    assert len(proposals) == 4  # before any, and at 60, 120 and 180 s
    assert proposals[-1].has_gains and proposals[-1].stop == pytest.approx(180.0)
    table = tomllib.loads((tmp_path / "proposal.toml").read_text(encoding="utf-8"))
    assert table["gains"]["KP"] == pytest.approx(proposals[-1].gains["KP"], rel=1e-5)


def test_gains_of_another_loop_are_refused(tmp_path: Path) -> None:
    settings = ride_files(tmp_path)
    (tmp_path / "gains.toml").write_text("[gains]\nKI = 4.0\n", encoding="utf-8")
    _, trial, _ = follower()
    with pytest.raises(InputError, match=r"has gains KI, the loop has KP, KD: they are of two loops"):
        gain_proposer(trial, settings, OnlineEstimator(trial))
    with pytest.raises(InputError, match=r"gives no intervals, on which gains could rest"):
        gain_proposer(trial, settings, object())
