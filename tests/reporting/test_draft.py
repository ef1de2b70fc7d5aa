"""The page beside a drafted trial: columns with both readings, runs with their parts in colour, nothing unescaped."""

from html.parser import HTMLParser
from pathlib import Path

import numpy as np
from tests.data.draft.test_draft import BASE, TRUTH, write

from seatrial.api import draft_trial
from seatrial.reporting.draft import html, verdict
from seatrial.reporting.figures.record_charts import log_view


def test_the_page_shows_columns_runs_and_parts(tmp_path: Path) -> None:
    columns = BASE | {"<b>n</b>": TRUTH["u"], "n": 2.0 + 0.0 * TRUTH["u"], "rudder": np.degrees(TRUTH["delta"])}
    draft = draft_trial(write(tmp_path / "run.csv", columns), folder=tmp_path)
    page = html(draft, "<trial>.toml")
    assert "&lt;trial&gt;.toml" in page and "<b>n</b>" not in page
    for part in (
        "1 column to decide",
        "unit = &#34;rpm&#34;",
        "1 zigzag1",
        "circle_starboard_1",
        "positive to starboard by",
    ):
        assert part in page
    assert verdict(draft) == f"1 run with {len(draft.stretches[0])} manoeuvres found; 1 column to decide."
    assert "Parts that stand behind a #" in page
    HTMLParser().feed(page)


def test_a_run_without_manoeuvres_has_no_parts_to_choose(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", {name: BASE[name][:50] for name in BASE}), folder=tmp_path)
    assert "1 run with no manoeuvres found" in html(draft, "t") and "behind a #" not in html(draft, "t")


def test_parts_are_coloured_on_the_track_and_behind_each_channel(tmp_path: Path) -> None:
    draft = draft_trial(write(tmp_path / "run.csv", BASE), folder=tmp_path)
    (record,), (parts,) = draft.records, draft.stretches
    assert record is not None
    (with_parts, spans), (plain, _) = log_view(record, parts), log_view(record, ())
    assert len(with_parts.legend) == len(spans) == len(parts) and not plain.legend
    assert len(with_parts.tracks) == 1 + len(parts)
    assert [(s.start, s.stop, s.words) for s in spans] == [
        (one.start, one.stop, str(k)) for k, one in enumerate(parts, start=1)
    ]
    assert with_parts.channels[0].curves[0].time[0] == 0.0
    for track, part in zip(with_parts.tracks[1:], parts, strict=True):  # its own points only: all can be drawn
        assert np.isfinite(track.north).all() and len(track.north) <= 1.01 * (part.stop - part.start) / record.dt + 1
