"""Wheelhouse poster and pilot card on a sheet of A4 (IMO A.601(15), appendices 1 and 2); nothing is computed.

Values of model tests are given at full scale by Froude's law: lengths times the scale, times and speeds times its root.
"""

import math
from dataclasses import dataclass, replace

from markupsafe import Markup

from seatrial.core.figures.chart import ACCENT, SECOND, Chart, LegendEntry, Region, Stroke
from seatrial.core.figures.run import track_panel
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.poster import Basis, Poster, PosterManoeuvre, PosterQuantity
from seatrial.core.text.numbers import DASH, exact, exponent, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values.record_chart import has_track, record_track
from seatrial.reporting.document import page_text
from seatrial.reporting.measures import bare_measure_label, current_words

RESOLUTION = "IMO resolution A.601(15)"
TO_BE_FILLED_IN = (
    "call sign and year built", "displacement, deadweight, draughts of the day", "engine orders, rpm and speeds",
    "stopping distances and times, crash stop", "man overboard manoeuvre", "squat and air draught",
    "effect of thrusters", "anchor chain", "hard-over to hard-over time",
)  # fmt: skip
"""What the resolution asks for and no fit of steered runs knows."""
_PARTICULARS = {"L": ("length between perpendiculars", "m"), "B": ("breadth", "m"), "d": ("draught", "m")}
_KNOT = 1852.0 / 3600.0  # m/s of a nautical mile an hour
_BOX = Region(56.0, 8.0, 400.0, 235.0)  # px, chosen
_STROKES = (Stroke(SECOND, 1.8), Stroke(ACCENT, 1.8))  # port, starboard; px, chosen
_CHART_WIDTH = 470.0  # px, chosen
_MORE_DECIMALS = 2  # than usual, for an interval narrower than these show; chosen: finer than instruments read


@dataclass(frozen=True)
class PosterHeading:
    """A manoeuvre, and what the distances that were measured of it refer to; empty: none was."""

    title: str
    measured: str = ""


@dataclass(frozen=True)
class PosterCell:
    """Value with interval, what it rests on, and the range of the runs of which it is the largest value."""

    text: str
    basis: str = ""
    repeats: str = ""


@dataclass(frozen=True)
class PosterRow:
    """A quantity in each of several manoeuvres."""

    name: str
    cells: tuple[PosterCell, ...]


@dataclass(frozen=True)
class PosterTable:
    """Quantities in rows, manoeuvres in columns."""

    header: tuple[PosterHeading, ...]
    rows: tuple[PosterRow, ...]
    notes: tuple[str, ...]


def html(poster: Poster) -> str:
    """Return the page as text."""
    circles = [m for m in poster.manoeuvres if m.manoeuvre.startswith("turning-circle")]
    others = [m for m in poster.manoeuvres if m not in circles]
    runs = [run for m in poster.manoeuvres for run in m.runs]
    context = {
        "poster": poster,
        "resolution": RESOLUTION,
        "rudder": f"{poster.rudder_deg:g}",
        "circles": poster_table(circles, poster),
        "zigzags": poster_table(others, poster),
        "chart": Markup(svg(turning_chart(circles, poster))),
        "particulars": particulars(poster),
        "missing": TO_BE_FILLED_IN,
        "measured_runs": ", ".join(dict.fromkeys(run.name for run in runs)),
        "is_corrected": any(run.current is not None for run in runs),
        "rudder_rate": rudder_rate_text(poster),
        "is_extrapolated": any(q.basis is Basis.EXTRAPOLATED for m in poster.manoeuvres for q in m.quantities),
    }
    return page_text("poster.html", context)


def particulars(poster: Poster) -> list[tuple[str, str]]:
    """Return name and value of what the fit knows of the ship, at full scale."""
    known = [(name, f"{significant(poster.particulars[key] * poster.scale, 4)} {unit}")
             for key, (name, unit) in _PARTICULARS.items() if key in poster.particulars]  # fmt: skip
    if "C_b" in poster.particulars:
        known.append(("block coefficient", fixed(poster.particulars["C_b"], 3)))
    speed = poster.approach_speed * math.sqrt(poster.scale)
    if speed > 0.0:
        known.append(("approach speed", f"{fixed(speed / _KNOT, 1)} kn ({fixed(speed, 2)} m/s)"))
    known.append(("rudder in turning circles", f"{poster.rudder_deg:g}°"))
    if poster.scale != 1.0:
        known.append(("scale of the trials", f"1:{exact(poster.scale)}"))
    return known


def poster_table(manoeuvres: list[PosterManoeuvre], poster: Poster) -> PosterTable:
    """Return the quantities of manoeuvres as text, each name once."""
    names = list(dict.fromkeys(q.name for m in manoeuvres for q in m.quantities))
    by_name = [{q.name: q for q in m.quantities} for m in manoeuvres]
    rows = tuple(PosterRow(_label(name), tuple(_cell(one.get(name), poster) for one in by_name)) for name in names)
    notes = tuple(f"{manoeuvre_title(m)}: {m.note}" for m in manoeuvres if m.note)
    header = tuple(PosterHeading(manoeuvre_title(m), measured_words(m, poster.scale)) for m in manoeuvres)
    return PosterTable(header, rows, notes)


def measured_words(m: PosterManoeuvre, scale: float) -> str:
    """Return how the runs that show a manoeuvre were measured, at full scale; empty where none does."""
    if not m.runs:
        return ""
    words = (current_words(None if run.current is None else run.current * math.sqrt(scale)) for run in m.runs)
    return f"measured, {enumeration(list(dict.fromkeys(words)))}"


def rudder_rate_text(poster: Poster) -> str:
    """Return the rate of the rudder at full scale, a rate falling with the root of the scale, and where it is from."""
    if not poster.rudder_rate:
        return ""
    rate = math.degrees(poster.rudder_rate) / math.sqrt(poster.scale)
    return f"rudder rate {significant(rate, 3)} deg/s, {poster.rudder_rate_origin}"


def manoeuvre_title(m: PosterManoeuvre) -> str:
    """Return the manoeuvre in words: ``turning-circle:35:port`` -> Turning circle 35° to port."""
    kind, *fields = m.manoeuvre.split(":")
    if kind == "zigzag":
        return f"Zigzag {fields[0]}"
    return f"Turning circle {fields[0]}° to {fields[1] if fields[1:] else 'starboard'}"


def _label(name: str) -> str:
    label, unit = bare_measure_label(name)  # the heads of the columns and the note say what each cell refers to
    if name == "speed_loss":
        return "speed lost in the turn, %"
    return f"{label}, {'m' if unit == 'L' else unit}"


def _cell(q: PosterQuantity | None, poster: Poster) -> PosterCell:
    """Value with interval at full scale, the basis, and the range of several runs."""
    if q is None:
        return PosterCell(DASH)
    if not q.is_determined:
        return PosterCell("not determined", q.basis.value)
    factor, decimals = _display(q.name, poster)
    if q.lower is None or q.upper is None:
        return PosterCell(fixed(factor * q.value, decimals), q.basis.value, _repeats(q, factor, decimals))
    value, lower, upper = factor * q.value, factor * q.lower, factor * q.upper
    decimals = _decimals_of(0.5 * (upper - lower), decimals)
    ends = (fixed(lower, decimals), fixed(upper, decimals))
    within = f"within {10.0**-decimals:g}" if ends[0] == ends[1] else "{}, {}".format(*ends)
    return PosterCell(f"{fixed(value, decimals)} [{within}]", q.basis.value, _repeats(q, factor, decimals))


def _repeats(q: PosterQuantity, factor: float, decimals: int) -> str:
    """``largest of 2 runs, 18.4 to 21.0``; empty for a single run."""
    if len(q.repeats) < 2:
        return ""
    ends = (fixed(factor * end, decimals) for end in (min(q.repeats), max(q.repeats)))
    return f"largest of {counted(len(q.repeats), 'run')}, {' to '.join(ends)}"


def _decimals_of(half_width: float, usual: int) -> int:
    """Decimals that show an interval: the usual ones, or as many more as its first digit needs, up to a limit."""
    if half_width <= 0.0:
        return usual
    return min(max(usual, -exponent(half_width, 1)), usual + _MORE_DECIMALS)


def _display(name: str, poster: Poster) -> tuple[float, int]:
    """Factor to the unit of the poster at full scale, and decimals."""
    length = poster.particulars.get("L", 1.0) * poster.scale
    if name.endswith("_L"):
        return length, 0 if length >= 20.0 else 1  # m, from which on a metre is fine enough; chosen
    if name.endswith("_deg_s"):
        return 1.0 / math.sqrt(poster.scale), 2
    if name.endswith("_s"):
        return math.sqrt(poster.scale), 0 if length >= 20.0 else 1  # m, as above
    return (100.0, 0) if name == "speed_loss" else (1.0, 1)


def turning_chart(circles: list[PosterManoeuvre], poster: Poster) -> Chart | None:
    """Return the tracks of the turning circles at equal scales [m]; None where no track was simulated."""
    tracks = []
    for m, stroke in zip(circles, _STROKES, strict=False):
        for one in (record_track(record, stroke) for record in m.simulated if has_track(record)):
            tracks.append(replace(one, north=poster.scale * one.north, east=poster.scale * one.east))
    if not tracks:
        return None
    length = poster.particulars.get("L", 0.0) * poster.scale
    panel = track_panel(tracks, length, _BOX, title="")
    legend = tuple(LegendEntry(manoeuvre_title(m), s) for m, s in zip(circles, _STROKES, strict=False) if m.simulated)
    return Chart("turning circles", (panel,), legend, _CHART_WIDTH)
