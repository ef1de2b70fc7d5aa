"""A proposal of gains in words: one text for the terminal and for the page."""

import math

from seatrial.core.results.online import Estimated, Proposal, SeaEstimate
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration, printable

_DIGITS = 3  # of gains and margins; chosen: a regulator's display has as many
_LONGEST = 1000  # letters of the reasons; chosen: longer than any of ours
_MOST_RANGES = 3  # ranges of headings that are named; chosen


def proposal_lines(proposal: Proposal) -> list[tuple[str, str]]:
    """Return label and text of each line: gains, why, margins, sea, craft; none is empty."""
    lines = [
        ("proposed gains", gains_text(proposal)),
        ("why", reasons_text(proposal)),
        ("margins", margins_text(proposal)),
        ("sea", sea_text(proposal.sea)),
        ("craft over model", craft_text(proposal)),
    ]
    return [(label, text) for label, text in lines if text]


def gains_text(proposal: Proposal) -> str:
    """Return the gains with their units, or that there are none."""
    if not proposal.has_gains:
        return "none"
    gains = [
        f"{name} {significant(value, _DIGITS)} {_unit(proposal.gain_units.get(name, ''))}".rstrip()
        for name, value in proposal.gains.items()
    ]
    return ", ".join(map(printable, gains)) + (" (new)" if proposal.is_new else " (as before)")


def reasons_text(proposal: Proposal) -> str:
    """Return the reasons as one text."""
    return printable(" ".join(proposal.reasons), _LONGEST)


def sea_text(sea: SeaEstimate | None) -> str:
    """Return height, peak period and heading with their 95 % intervals; nothing without an estimate."""
    if sea is None:
        return ""
    height, period = _interval(sea.height, "m"), _interval(sea.period, "s")
    ranges = [
        f"{math.degrees(one.lower):.0f} to {math.degrees(one.upper):.0f} deg ({100.0 * one.probability:.0f} %)"
        for one in sea.headings
    ]
    if sea.is_heading_determined:
        heading = _interval(sea.heading, "deg", math.degrees(1.0))
    else:
        heading = f"not determined, {enumeration(ranges, _MOST_RANGES)}"
    return f"height {height}, peak period {period}, heading (0 following) {heading}"


def craft_text(proposal: Proposal) -> str:
    """Return the craft's factors with their 95 % intervals; nothing without an estimate."""
    return ", ".join(f"{one.name} {_interval(one.factor)}" for one in proposal.craft)


def margins_text(proposal: Proposal) -> str:
    """Return the margins with their 95 % intervals over the draws of sea and craft; nothing without gains."""
    m = proposal.margins
    if m is None:
        return ""
    parts = [f"Ms {_interval(m.Ms)}"]
    for name, one, unit, factor in (
        ("gain margin", m.gain_margin, "", 1.0),
        ("phase margin", m.phase_margin, "deg", math.degrees(1.0)),
        ("delay margin", m.delay_margin, "s", 1.0),
        ("reduction", m.reduction, "%", 100.0),
    ):
        parts.append(f"{name} {_interval(one, unit, factor)}")
    return ", ".join(parts) + f"; stable on {m.stable_draws} of {m.draws}"


def _interval(one: Estimated, unit: str = "", factor: float = 1.0) -> str:
    low, middle, high = (_number(factor * value) for value in (one.lower, one.value, one.upper))
    return f"{middle} [{low}, {high}] {unit}".rstrip()


def _number(value: float) -> str:
    return significant(value, _DIGITS) if math.isfinite(value) else "any"


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit
