"""Tiny logs of any content end in a trial or one sentence: no traceback, no warning of a library, exit code 0 or 2."""

import math
import random
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

HEADINGS = (
    "time", "Time UTC", "Heading [°]", "rudder port", "rudder stbd", "ROT", "lat", "Long.", "SOG", "COG", "roll",
    "heave", "wave", "rpm port", "RPM S", "u", "v", "x", "y", "AWA", "wind speed", "Klokke", "ror", "", "#",
    "speed", "thr_l", "q_w",
)  # fmt: skip
CELLS = (
    "0", "-1", "nan", "inf", "1e309", "-999", "511", "65535", "abc", "", "12:00:00", "54°06.5'N", "1,5", "\0", "'", "°",
    "2026-05-14T09:20:00Z", "3e8", "05/14/2026 1:02:03 PM",
)  # fmt: skip
SENTENCES = (
    "$HEHDT,{},T", "$IIRSA,{},A,{},A", "$GPRMC,0920{:02},A,5406.5,N,01037.8,E,5.0,{},140526,,", "$ERRPM,S,1,{},100,A",
    "$IIVHW,{},T,,M,5,N,,K",
)  # fmt: skip
PROSE = ("", "Heave positive up", "probe 1.95 m fwd of midship", "V = 1.62 m/s", "rudder positive = port", "+")


def tiny_log(chance: random.Random) -> str:
    rows = chance.choice((0, 1, 2, 5, 12, 30))
    if chance.random() < 0.15:
        numbers = [(chance.randint(0, 59), chance.randint(0, 59)) for _ in range(2 * rows)]
        return "\n".join(chance.choice(SENTENCES).format(*pair) for pair in numbers)
    headings = [chance.choice(HEADINGS) for _ in range(chance.randint(1, 7))]
    units = [chance.choice(("s", "deg", "[m]", "", "kn")) for _ in headings]
    kinds = [chance.choice(("line", "sine", "constant", "any")) for _ in headings]
    above = [[chance.choice(PROSE)], headings, units][: chance.randint(0, 3)]
    table = [
        [
            f"{0.5 * k}" if not j and chance.random() < 0.85 else
            {"line": f"{0.3 * k + j}", "sine": f"{10.0 * math.sin(0.4 * k + j):.3f}", "constant": "3"}.get(
                kind, chance.choice(CELLS)
            )
            for j, kind in enumerate(kinds)
        ]
        for k in range(rows)
    ]  # fmt: skip
    separator, end = chance.choice(",;\t "), chance.choice(("\n", "\r\n", "\r", "\r\r\n"))
    return end.join(separator.join(row) for row in (*above, *table))


@pytest.mark.parametrize("seed", range(4))
def test_a_tiny_log_ends_in_a_trial_or_a_sentence(
    seed: int, run_command: Callable[..., int], capfd: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    chance, log, trial = random.Random(seed), tmp_path / "a.csv", tmp_path / "t.toml"
    for _ in range(15):
        text = tiny_log(chance)
        log.write_bytes(text.encode())
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            codes = {run_command("check", str(log))}
            codes.add(run_command("init", str(log), "--overwrite", "--length", "8", "--out", str(trial)))
            codes |= {run_command("check", str(trial))} if trial.exists() else set()
        printed = "".join(capfd.readouterr())
        assert codes <= {0, 2} and "Warning" not in printed and "error of the program" not in printed, text
