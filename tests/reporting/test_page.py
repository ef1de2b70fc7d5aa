"""The page is one file, small, self-contained, escaped, the same every time; edge cases render."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import Fit
from seatrial.core.values import InputError, Ship
from seatrial.reporting import identifiability_chapter
from seatrial.reporting.page import html

LARGEST = 1_000_000
HOSTILE = "<script>alert(1)</script>"


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.scripts = 0
        self.ids: list[str] = []
        self.links: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        known = dict(attrs)
        self.scripts += tag == "script"
        self.ids += [known["id"] or ""] if "id" in known else []
        self.links += [v or "" for k, v in attrs if k in ("href", "xlink:href", "src")]


def parsed(text: str) -> _Tags:
    tags = _Tags()
    tags.feed(text)
    return tags


def test_it_is_small_and_asks_for_nothing(page: Path) -> None:
    text = page.read_text()
    assert len(text.encode()) < LARGEST
    assert not re.search(r"@import|url\((?!#)", text)
    outside = [link for link in parsed(text).links if not link.startswith(("#", "data:,", "https://doi.org/"))]
    assert outside == []


def test_every_identifier_is_unique_and_every_inner_link_leads_somewhere(page: Path) -> None:
    tags = parsed(page.read_text())
    shapes = [i for i in tags.ids if "-" not in i]
    assert len(shapes) == len(set(shapes))
    assert {link[1:] for link in tags.links if link.startswith("#")} <= set(tags.ids)


def test_every_section_has_what_the_fit_holds(page: Path, fit: Fit) -> None:
    text = page.read_text()
    for name in [*(c.name for c in fit.coefficients), *(r.name for r in fit.records), *(f.code for f in fit.findings)]:
        assert name in text
    assert fit.question in text and fit.method.criterion in text and "<math" in text
    assert text.count("<svg") >= 4 + len(fit.predictions)
    assert text.count('class="series"') == 2 + len(fit.predictions)


def test_the_same_fit_gives_the_same_bytes(page: Path) -> None:
    assert html(complete_fit(fabricated_fit())).encode() == page.read_bytes()


def test_text_from_files_is_escaped_everywhere() -> None:
    fit = fabricated_fit(names=(HOSTILE, '"><script>d'))
    fit = replace(fit, question=HOSTILE, ship=replace(fit.ship, name=HOSTILE, source=HOSTILE))
    text = html(fit)
    assert HOSTILE not in text and "><script>d" not in text
    assert text.count("<script>") == html(fabricated_fit(names=("a", "b"))).count("<script>")


def test_a_fit_with_next_to_nothing_renders(fit: Fit) -> None:
    bare = replace(
        fit, predictions=(), offsets=(), channel_noise=(), residuals=(), findings=(), ship=Ship("nameless"),
        covariance=np.zeros((0, 0)), records=tuple(r.without("x0", "y0", "psi") for r in fit.records),
    )  # fmt: skip
    text = html(bare)
    assert "no run was held out" in text and "uPlot" not in text


def test_gaps_and_absent_channels_render(fit: Fit) -> None:
    record = fit.records[0]
    holes = record["v"].copy()
    holes[100:400] = np.nan
    changed = record.with_channel("v", record.channel("v").with_values(holes)).without("u")
    with_holes = replace(fit, records=(changed,), predictions=(replace(fit.predictions[0], measured=changed),))
    assert not re.search(r"\bnan\b", html(with_holes))


def test_a_chapter_that_cannot_be_written_is_a_sentence(fit: Fit, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise InputError("the curve needs 2.31 rad/s")

    whole = complete_fit(fit)
    monkeypatch.setattr(identifiability_chapter, "identifiability_section", refuse)
    text = html(whole)
    assert "without the chapter" in text and "the curve needs 2.31 rad/s" in text
    assert 'id="coefficients"' in text
