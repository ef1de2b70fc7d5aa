"""No sentence of a draft is longer than 400 letters, however much is open and left out."""

from pathlib import Path

import numpy as np
from tests.data.draft.test_draft import BASE, TRUTH, write

from seatrial.api import draft_trial

LONGEST = 400  # letters of a line that is read as one sentence: required


def test_what_a_draft_says_is_short(tmp_path: Path) -> None:
    pulses = {f"thruster_{k}": 1507.0 + 100.0 * k * TRUTH["delta"] for k in range(1, 9)}
    others = {f"internal_temperature_of_compartment_{k}": np.arange(TRUTH["t"].size) % (k + 3) for k in range(40)}
    path = write(tmp_path / "20260514_zigzag_20_20_starboard_second.csv", BASE | {"rot": TRUTH["r"]} | pulses | others)
    draft = draft_trial(path)
    sentences = [line for line in draft.text.splitlines() if not line.startswith("# not used")]
    sentences += [text for part in draft.guesses for guess in part for text in (*guess.evidence, guess.other_reading)]
    assert max(map(len, sentences)) <= LONGEST, max(sentences, key=len)
    assert sum("OPEN command_" in line for line in sentences) == 8
