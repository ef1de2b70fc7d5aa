"""Gains proposed while a stream is followed: the file, the words, and streams of which nothing is proposed."""

import math
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomli_w
from benchmarks.proposals import EXAMPLE
from tests.control.proposals.fin_stretches import QUARTERING, fin_stretch, points
from tests.onboard.streams import ListSource

from seatrial.api import load_loop
from seatrial.core.results.online import NO_SAMPLE, Sample, SampleCounts
from seatrial.core.values import Array, InputError
from seatrial.data.trial import Trial, load_trial
from seatrial.data.trial.runs import resolved_proposal
from seatrial.onboard.follow import follow
from seatrial.onboard.live import log_line
from seatrial.onboard.proposer import SeaGainProposer
from seatrial.onboard.stream_report import snapshot_json
from seatrial.onboard.table import gains_text, proposal_lines

STRETCH = fin_stretch(7, QUARTERING)
RATE = 1.0 / STRETCH.dt
FIXED = "{ K_alpha = 0.256, b_1 = 0.265, b_2 = 0.0, b_3 = 0.0, c_1 = 0.698, c_3 = 0.0, c_5 = 0.0, phi_0 = 0.0 }"
TRIAL = f"""
[ship]
name = "ship with fins"
L = 100.0
B = 10.5
d = 3.4
[model]
name = "roll"
fixed = {FIXED}
[follow]
source = "stdin"
rate = {RATE}
time = {{ column = "t" }}
[follow.channels]
phi = {{ column = "phi", unit = "rad", positive = "starboard" }}
alpha_f = {{ column = "alpha_f", unit = "rad", positive = "starboard" }}
u = {{ column = "u", unit = "m/s" }}
psi = {{ column = "psi", unit = "rad" }}
[proposal]
loop = '{EXAMPLE}'
gains = "gains.toml"
every_s = 1100
"""


def fin_trial(folder: Path, text: str = TRIAL) -> Trial:
    """A trial file beside a gains.toml of the test's schedule."""
    entries = [
        {"U": p.U, "heading_deg": math.degrees(p.beta), "height": p.height, "gains": p.gains, "cost": p.cost,
         "Ms": p.Ms, "saturation": p.saturation, "feasible": True}
        for p in points(load_loop(EXAMPLE))
    ]  # fmt: skip
    (folder / "gains.toml").write_text(tomli_w.dumps({"gains": {"KP": 1.0}, "schedule": entries}), encoding="utf-8")
    (folder / "fins.toml").write_text(text, encoding="utf-8")
    return load_trial(folder / "fins.toml")


def samples(values: Array = STRETCH.values, U: float = STRETCH.U, turn: float = 0.0) -> list[Sample]:
    """The stretch as samples; turn: rad, by which the heading changes in it."""
    count = len(values)
    rows = np.column_stack([values, np.full(count, U), np.linspace(0.0, turn, count)])
    return [Sample(k * STRETCH.dt, row) for k, row in enumerate(rows)]


def proposer(folder: Path, text: str = TRIAL) -> SeaGainProposer:
    """One that writes into the folder."""
    trial = fin_trial(folder, text)
    assert trial.proposal is not None
    return SeaGainProposer(trial, trial.proposal, folder / "proposal.toml")


def test_a_followed_stream_ends_with_a_proposal(tmp_path: Path) -> None:
    outcome = follow(
        fin_trial(tmp_path), source=ListSource(samples()), once=True, proposal_file=tmp_path / "proposal.toml"
    )
    assert outcome.fit is None
    assert outcome.snapshot is not None
    proposal = outcome.snapshot.proposal
    assert proposal is not None
    assert proposal.has_gains
    written = tomllib.loads((tmp_path / "proposal.toml").read_text(encoding="utf-8"))
    assert written["gains"] == pytest.approx(proposal.gains)
    assert written["sea"]["height"]["lower"] < math.exp(QUARTERING.height) < written["sea"]["height"]["upper"]
    assert written["margins"]["stable_draws"] == written["margins"]["draws"]
    labels = [label for label, _ in proposal_lines(proposal)]
    assert labels == ["proposed gains", "why", "margins", "sea", "craft over model"]
    assert log_line(outcome.snapshot, SampleCounts()).endswith("(new)")
    assert snapshot_json(outcome.snapshot, SampleCounts())["proposal"] == proposal_lines(proposal)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        (samples(turn=1.0), "the craft turned in the stretch"),
        (samples(0.01 * STRETCH.values), "shows too little"),
        ([s for s in samples() if not 300.0 < s.time < 330.0], "has a gap of 3"),
        ([replace(s, values=s.values * [1, 1, 1 + (s.time > 500), 1]) for s in samples()], "the speed is not steady"),
    ],
)
def test_streams_of_which_nothing_is_proposed(tmp_path: Path, given: list[Sample], reason: str) -> None:
    one = proposer(tmp_path)
    assert "no stretch of the stream" in (tmp_path / "proposal.toml").read_text(encoding="utf-8")
    for sample in given:
        one.add(sample)
    assert gains_text(one.proposal) == "none"
    assert reason in one.proposal.reasons[0]
    assert reason in (tmp_path / "proposal.toml").read_text(encoding="utf-8")


def test_a_break_begins_a_new_stretch(tmp_path: Path) -> None:
    one = proposer(tmp_path)
    for sample in samples()[:1000]:
        one.add(sample)
    one.start_run()
    for sample in samples()[1000:]:
        one.add(sample)
    assert "no stretch" in one.proposal.reasons[0]


def test_a_file_that_cannot_be_written_ends_nothing(tmp_path: Path) -> None:
    trial = fin_trial(tmp_path)
    assert trial.proposal is not None
    (tmp_path / "blocked").write_text("", encoding="utf-8")
    assert "blocked" in SeaGainProposer(trial, trial.proposal, tmp_path / "blocked" / "proposal.toml").write_error


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('alpha_f = { column = "alpha_f", unit = "rad", positive = "starboard" }\n', "", "lacks 'alpha_f'"),
        ("every_s = 1100", "stretch_s = 300", "holds too few swings"),
        (f"rate = {RATE}", "rate = 0.5", "does not resolve swings"),
        (str(EXAMPLE), str(EXAMPLE.with_name("waterjet_autopilot.toml")), "waterjet_autopilot.toml"),
    ],
)
def test_bad_input_is_refused_before_anything_starts(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in TRIAL
    with pytest.raises(InputError, match=sentence):
        proposer(tmp_path, TRIAL.replace(old, new))


def test_a_proposal_needs_a_stream(tmp_path: Path) -> None:
    settings = fin_trial(tmp_path).proposal
    with pytest.raises(InputError, match=r"proposal: gains are proposed while a stream is followed; add \[follow\]"):
        resolved_proposal(settings, None, tmp_path)


def test_nothing_is_shown_without_a_proposal() -> None:
    assert snapshot_json(NO_SAMPLE, SampleCounts())["proposal"] == []
