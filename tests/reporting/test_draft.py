"""The page beside a drafted trial: columns with both readings, runs with their parts in colour, nothing unescaped."""

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
from tests.data.draft.test_draft import BASE, TRUTH, write

from seatrial.api import draft_trial
from seatrial.reporting.draft import html
from seatrial.reporting.figures.log_parts import log_chart


def test_the_page_shows_columns_runs_and_parts(tmp_path: Path) -> None:
    columns = BASE | {"<b>n</b>": TRUTH["u"], "n": 2.0 + 0.0 * TRUTH["u"], "rudder": np.degrees(TRUTH["delta"])}
    draft = draft_trial(write(tmp_path / "run.csv", columns), folder=tmp_path)
    page = html(draft, "<trial>.toml")
    assert "&lt;trial&gt;.toml" in page and "<b>n</b>" not in page
    for part in ("1 column to decide", "unit = &#34;rpm&#34;", "1 zigzag1", "circle_starboard_1", "turns to starboard"):
        assert part in page
    HTMLParser().feed(page)


def test_parts_are_coloured_on_the_track_and_behind_each_channel(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", BASE), folder=tmp_path)
    (record,), (parts,) = draft.records, draft.stretches
    assert record is not None
    with_parts, plain = log_chart(record, parts), log_chart(record, ())
    assert len(with_parts.legend) == len(parts) and not plain.legend
    for marked, bare in zip(with_parts.panels[1:], plain.panels[1:], strict=True):
        assert len(marked.marks) == len(bare.marks) + 2 * len(parts)
    assert with_parts.panels[1].x.ends[0] == 0.0
