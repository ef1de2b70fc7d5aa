"""Proposed gains as a file for the person who may set them: gains, sea, craft, margins and reasons as TOML."""

import math
from typing import Any

import tomli_w

from seatrial.core.results.proposal import Estimated, HeadingRange, Proposal

FORMAT = 1
PROPOSAL = "proposal.toml"
_DIGITS = 6  # of what is estimated: finer than any interval, short enough to be read; chosen


def proposal_toml(proposal: Proposal) -> str:
    """Return ``proposal.toml``: angles in degrees where the key says so; what is infinite (any margin) is left out."""
    table: dict[str, Any] = {
        "format": FORMAT,
        "note": "a proposal for a person to judge; nothing sets it",
        "loop": proposal.loop,
        "has_gains": proposal.has_gains,
        "is_new": proposal.is_new,
        "reasons": list(proposal.reasons),
        "stretch": _finite({"start_s": proposal.start, "stop_s": proposal.stop, "U": proposal.U}),
        "gains": proposal.gains,
        "gain_units": proposal.gain_units,
    }
    if proposal.sea is not None:
        sea = proposal.sea
        table["sea"] = {
            "height": _interval(sea.height),
            "peak_period": _interval(sea.period),
            "heading_deg": _interval(sea.heading, math.degrees(1.0)),
            "is_heading_determined": sea.is_heading_determined,
            "headings": [_heading_range(heading) for heading in sea.headings],
        }
    if proposal.craft:
        table["craft"] = {property_change.name: _interval(property_change.factor) for property_change in proposal.craft}
    if proposal.margins is not None:
        m = proposal.margins
        table["margins"] = {
            "Ms": _interval(m.Ms),
            "gain_margin": _interval(m.gain_margin),
            "phase_margin_deg": _interval(m.phase_margin, math.degrees(1.0)),
            "delay_margin_s": _interval(m.delay_margin),
            "reduction": _interval(m.reduction),
            "saturation": _interval(m.saturation),
            "stable_draws": m.stable_draws,
            "draws": m.draws,
        }
    return tomli_w.dumps(table)


def _interval(estimated: Estimated, factor: float = 1.0) -> dict[str, float]:
    ends = {"value": estimated.value, "lower": estimated.lower, "upper": estimated.upper}
    return _finite({name: _rounded(factor * value) for name, value in ends.items()})


def _heading_range(one: HeadingRange) -> dict[str, float]:
    return {
        "from_deg": _rounded(math.degrees(one.lower)),
        "to_deg": _rounded(math.degrees(one.upper)),
        "probability": _rounded(one.probability),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _finite(values: dict[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items() if math.isfinite(value)}
