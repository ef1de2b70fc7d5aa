"""The chapter on waves: operators, spectra and statistics of the ship in her sea, as tables and figures."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.curves import curves
from seatrial.core.results import Curve, Figure, Seakeeping, Table
from seatrial.reporting.sheets import Sheet, sheet


def sheets(known: Seakeeping) -> list[Sheet]:
    """Motions of the ship, and vertical motions along her."""
    whole = Table(
        "Motions in this sea",
        ("Motion", "significant amplitude", "mean zero-crossing period, s"),
        (("heave, m", known.heave_significant, known.periods[0]),
         ("pitch, deg", known.pitch_significant, known.periods[1])),
        f"{known.sea}; {known.speed:.3g} m/s, {known.heading:.0f}\u00b0 to the waves (180\u00b0: head).",
    )  # fmt: skip
    rows = tuple((p.place, p.x, p.significant, p.acceleration, 100.0 * p.sickness) for p in known.points)
    header = ("Place", "forward, m", "significant, m", "acceleration rms, m/s\u00b2", "sick in two hours, %")
    note = "Vertical motion; sickness by O'Hanlon & McCauley 1974."
    return [sheet(whole), sheet(Table("Vertical motion along the ship", header, rows, note))]


def figures(known: Seakeeping) -> list[tuple[Markup, Figure]]:
    """Response amplitude operators, their phases, and spectra."""
    omega = np.array(known.omega)
    across = "wave frequency, rad/s"

    def drawn(title: str, label: str, note: str, lines: dict[str, tuple[float, ...]]) -> tuple[Markup, Figure]:
        made = Figure(title, across, label, tuple(Curve(n, omega, np.array(y)) for n, y in lines.items()), note)
        return Markup(curves(made)), made

    pitch, sea = np.array(known.pitch_density), np.array(known.sea_density)
    share = float(np.max(sea) / max(np.max(pitch), 1e-300))
    return [
        drawn("Response amplitude operators", "per wave", "Heave per wave amplitude, pitch per wave slope. A hull "
              "that the wave carries has 1, in pitch the heading's cosine; constant damping keeps pitch from it.",
              {"heave": known.heave, "pitch / slope": known.pitch}),
        drawn("Phases", "degrees ahead of the crest", "At the ship's origin; pitch against the slope, bow down.",
              {"heave": known.heave_phase, "pitch": known.pitch_phase}),
        drawn("Spectra", "m\u00b2 s/rad", f"Over the wave frequency; pitch in deg\u00b2 s/rad times {share:.2g}.",
              {"sea": known.sea_density, "heave": known.heave_density, "pitch": tuple(share * pitch)}),
    ]  # fmt: skip
