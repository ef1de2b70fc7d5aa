"""The chapter on waves: operators, spectra and statistics of the ship in its sea, as tables and figures."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Curve, Figure, Seakeeping, Table
from seatrial.reporting.figures.study_figures import study_chart
from seatrial.reporting.text_tables import TextTable, text_table

# m; a shorter ship carries nobody who could be sick; chosen, below the smallest boats with a crew
LEAST_CREWED_LENGTH = 6.0


def tables(seakeeping: Seakeeping, length: float) -> list[TextTable]:
    """Return motions of the ship, and vertical motions along it; length: of the ship [m], 0 where it is unknown."""
    motions = Table(
        "Motions in this sea",
        ("Motion", "significant amplitude", "mean zero-crossing period, s"),
        (("heave, m", seakeeping.heave_significant, seakeeping.zero_crossing_periods[0]),
         ("pitch, deg", seakeeping.pitch_significant, seakeeping.zero_crossing_periods[1])),
        f"{seakeeping.sea}; {seakeeping.speed:.3g} m/s, {seakeeping.heading:.0f}\u00b0 to the waves (180\u00b0: head).",
    )  # fmt: skip
    rows = tuple((p.place, p.x, p.significant_amplitude, p.rms_acceleration, 100.0 * p.sickness_incidence)
                 for p in seakeeping.points)  # fmt: skip
    header = ("Place", "forward, m", "significant, m", "acceleration rms, m/s\u00b2", "sick in two hours, %")
    note = "Vertical motion; sickness by O'Hanlon & McCauley 1974."
    if 0.0 < length < LEAST_CREWED_LENGTH:
        rows, header, note = tuple(row[:-1] for row in rows), header[:-1], "Vertical motion."
    return [text_table(motions), text_table(Table("Vertical motion along the ship", header, rows, note))]


def figures(seakeeping: Seakeeping) -> list[tuple[Markup, Figure]]:
    """Return response amplitude operators, their phases, and spectra."""
    omega = np.array(seakeeping.omega)
    across = "wave frequency, rad/s"

    def render(title: str, label: str, note: str, lines: dict[str, tuple[float, ...]]) -> tuple[Markup, Figure]:
        figure = Figure(title, across, label, tuple(Curve(n, omega, np.array(y)) for n, y in lines.items()), note)
        return Markup(svg(study_chart(figure))), figure

    pitch, sea = np.array(seakeeping.pitch_density), np.array(seakeeping.sea_density)
    share = float(np.max(sea) / max(np.max(pitch), 1e-300))  # above zero
    return [
        render("Response amplitude operators", "per wave", "Heave per wave amplitude, pitch per wave slope. A hull "
              "that the wave carries has 1, in pitch the heading's cosine; constant damping keeps pitch from it.",
              {"heave": seakeeping.heave, "pitch / slope": seakeeping.pitch}),
        render("Phases", "degrees ahead of the crest", "At the ship's origin; pitch against the slope, bow down.",
              {"heave": seakeeping.heave_phase, "pitch": seakeeping.pitch_phase}),
        render("Spectra", "m\u00b2 s/rad", f"Over the wave frequency; pitch in deg\u00b2 s/rad times {share:.2g}.",
              {"sea": seakeeping.sea_density, "heave": seakeeping.heave_density, "pitch": tuple(share * pitch)}),
    ]  # fmt: skip
