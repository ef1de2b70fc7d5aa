"""The chapter on waves: operators, spectra and statistics of the ship in its sea, as tables and figures."""

import numpy as np

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Curve, Figure, Seakeeping
from seatrial.core.text.numbers import significant
from seatrial.reporting.figures.study_figures import study_chart
from seatrial.reporting.section import Level, Picture, Section, number, table_of, words

# m; a shorter ship carries nobody who could be sick; chosen, below the smallest boats with a crew
LEAST_CREWED_LENGTH = 6.0
_DIGITS = 3  # significant; chosen


def seakeeping_section(seakeeping: Seakeeping | None, length: float) -> Section:
    """Return the chapter on the ship in its sea; empty where there is none.

    length: of the ship [m], 0 where it is unknown.
    """
    if seakeeping is None:
        return Section("")
    motions = (
        ("heave, m", seakeeping.heave_significant, seakeeping.zero_crossing_periods[0]),
        ("pitch, deg", seakeeping.pitch_significant, seakeeping.zero_crossing_periods[1]),
    )
    table = table_of(
        motions,
        words("Motion", lambda row: row[0]),
        number("significant amplitude", lambda row: significant(row[1], _DIGITS)),
        number("mean zero-crossing period", lambda row: significant(row[2], _DIGITS), "s"),
    )
    note = (
        f"{seakeeping.sea}; {seakeeping.speed:.3g} m/s, {seakeeping.heading:.0f}\u00b0 to the waves (180\u00b0: head)."
    )
    return Section(
        "Motions in waves",
        "waves",
        table=table,
        note=note,
        parts=(_along_ship(seakeeping, length), *_spectra(seakeeping)),
        level=Level.PAGE,
    )


def _along_ship(seakeeping: Seakeeping, length: float) -> Section:
    """Vertical motion along the ship, and who is sick of it."""
    is_crewed = not 0.0 < length < LEAST_CREWED_LENGTH
    table = table_of(
        seakeeping.points,
        words("Place", lambda p: p.place),
        number("forward", lambda p: significant(p.x, _DIGITS), "m"),
        number("significant", lambda p: significant(p.significant_amplitude, _DIGITS), "m"),
        number("acceleration rms", lambda p: significant(p.rms_acceleration, _DIGITS), "m/s\u00b2"),
        number("sick in two hours", lambda p: _percent(p.sickness_incidence) if is_crewed else "", "%"),
    )
    note = "Sickness by O'Hanlon & McCauley 1974." if is_crewed else ""
    return Section("Vertical motion along the ship", table=table, note=note)


def _percent(share: float) -> str:
    return significant(100.0 * share, _DIGITS)


def _spectra(seakeeping: Seakeeping) -> list[Section]:
    """Response amplitude operators, their phases, and spectra."""
    omega = np.array(seakeeping.omega)
    across = "wave frequency, rad/s"

    def section(title: str, label: str, caption: str, lines: dict[str, tuple[float, ...]]) -> Section:
        curves = tuple(Curve(name, omega, np.array(y)) for name, y in lines.items())
        figure = Figure(title, across, label, curves, caption)
        return Section(title, pictures=(Picture(lambda: svg(study_chart(figure)), caption),))

    pitch, sea = np.array(seakeeping.pitch_density), np.array(seakeeping.sea_density)
    share = float(np.max(sea) / max(np.max(pitch), 1e-300))  # above zero
    return [
        section(
            "Response amplitude operators",
            "per wave",
            "Heave per wave amplitude, pitch per wave slope. A hull "
            "that the wave carries has 1, in pitch the heading's cosine; constant damping keeps pitch from it.",
            {"heave": seakeeping.heave, "pitch / slope": seakeeping.pitch},
        ),
        section(
            "Phases",
            "degrees ahead of the crest",
            "At the ship's origin; pitch against the slope, bow down.",
            {"heave": seakeeping.heave_phase, "pitch": seakeeping.pitch_phase},
        ),
        section(
            "Spectra",
            "m\u00b2 s/rad",
            f"Over the wave frequency; pitch in deg\u00b2 s/rad times {share:.2g}.",
            {"sea": seakeeping.sea_density, "heave": seakeeping.heave_density, "pitch": tuple(share * pitch)},
        ),
    ]
