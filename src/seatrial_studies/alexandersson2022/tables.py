"""Tables and figures of the study."""

import statistics

import numpy as np

from seatrial.core.results import Curve, Figure, Prediction, Table
from seatrial.core.values import NOTATION, Record, display
from seatrial_studies.alexandersson2022 import margins, published
from seatrial_studies.alexandersson2022.left_out import WINDOW_S, LeftOut, jackknife_error
from seatrial_studies.alexandersson2022.published import MEASURED_TURNS, OTHER_TURNS, PREDICTED_TURNS, SIDES, percent
from seatrial_studies.alexandersson2022.repetition import Repetition


def tables(made: Repetition) -> tuple[Table, ...]:
    """All tables; those of leave-one-run-out only where it was done."""
    always = (beside(made), turns(made), *margins.tables(made.margins), offsets(made), noise(made))
    return (*always, left_out(made.left_out), left_out_turns(made.left_out)) if made.left_out else always


def validated(made: Repetition) -> Prediction:
    """The prediction of the validation run."""
    return made.fit.validation()[0]


def beside(made: Repetition) -> Table:
    """The paper's numbers, those of its code run again, and ours."""
    rms, again = validated(made).rms, "{:.1f} to {:.1f}"
    rows: list[tuple[str | float | None, ...]] = [
        ("Z_35_05 open loop, heading rms [deg]", None, again.format(*published.AGAIN_HEADING), rms["psi_deg"]),
        ("Z_35_05 open loop, position rms [m]", None, again.format(*published.AGAIN_POSITION), rms["position_m"]),
    ]
    for side in SIDES:
        truth, paper, ours = MEASURED_TURNS[side], PREDICTED_TURNS[side], made.turns[side]
        rows += [
            (
                f"35 deg turn to {side}, advance against MARIN [%]",
                percent(paper.advance, truth.advance),
                f"{published.AGAIN_ADVANCE[side]:+.1f}",
                percent(ours.advance, truth.advance),
            ),
            (
                f"35 deg turn to {side}, tactical diameter against MARIN [%]",
                percent(paper.diameter, truth.diameter),
                f"{published.AGAIN_DIAMETER[side]:+.1f}",
                percent(ours.diameter, truth.diameter),
            ),
        ]
    rows.append(("computing time [s]", None, f"{published.AGAIN_SECONDS:g}", made.fit.elapsed_s))
    note = (
        "The published code was run again on the same records and trained without Z_35_05; its time is that of one "
        "machine. Ours is the whole of reading, checking, identifying and predicting 13 runs, compilation included."
    )
    return Table("The published numbers and ours", ("quantity", "paper", "its code again", "here"), tuple(rows), note)


def turns(made: Repetition) -> Table:
    """Simulated turns beside every named measured value."""
    rows: list[tuple[str | float | None, ...]] = []
    for side in SIDES:
        ours, paper = made.turns[side], PREDICTED_TURNS[side]
        rows.append((ours.source, side, ours.advance, ours.diameter, None, None))
        rows.append((paper.source, side, paper.advance, paper.diameter, None, None))
        for truth in (MEASURED_TURNS[side], *OTHER_TURNS):
            rows.append(
                (
                    truth.source,
                    truth.side or "not told",
                    truth.advance,
                    truth.diameter,
                    percent(ours.advance, truth.advance),
                    percent(ours.diameter, truth.diameter),
                )
            )
    header = ("source", "side", "advance [L]", "tactical diameter [L]", "advance, here [%]", "diameter, here [%]")
    note = (
        "Simulated from the speed at which surge balances at the trials' propeller rate, rudder at SOLAS's rate. "
        "The simulated track is that of midship; whether the measured one is, is not told (the centre of gravity, "
        "0.035 L ahead, would have an advance shorter by as much and the same tactical diameter). The paper's table "
        "is that of notebook 06.20 in the authors' repository System-identification-of-Vessel-Manoeuvring-Models."
    )
    return Table("Turning circles with 35 deg of rudder", header, tuple(rows), note)


def offsets(made: Repetition) -> Table:
    """Nuisances of each training run."""
    rows = []
    for offset in made.fit.offsets:
        factor, unit = display(offset.unit)
        error = None if offset.standard_error is None else factor * offset.standard_error
        rows.append((offset.group, f"{offset.name} [{unit}]", factor * offset.estimate, error))
    note = (
        "Added to the measured angle, positive to starboard. The validation run is given the mean of these; nothing "
        "is fitted on it."
    )
    return Table("Offsets by run", ("run", "offset", "estimate", "standard error"), tuple(rows), note)


def noise(made: Repetition) -> Table:
    """Noise from sample to sample beside what the model leaves."""
    rows = []
    for item in made.fit.noise:
        if item.channel in made.noise:
            factor, unit = display(NOTATION[item.channel].unit)
            sample = made.noise[item.channel]
            ratio = item.standard_deviation / sample if sample > 0 else None
            rows.append((f"{item.channel} [{unit}]", factor * sample, factor * item.standard_deviation, ratio))
    note = (
        "Noise from third differences of the records at their own rate, median over runs (Gasser, Sroka & "
        "Jennen-Steinmetz 1986); what the model leaves within segments is the estimated standard deviation."
    )
    return Table("Noise", ("channel", "sample to sample", "left by the model", "ratio"), tuple(rows), note)


def left_out(entries: tuple[LeftOut, ...]) -> Table:
    """Errors of each run when the others trained."""
    rows: list[tuple[str | float | None, ...]] = [
        (e.run, e.whole.rms["psi_deg"], e.whole.rms["position_m"], e.windows, e.heading_deg, e.position_m)
        for e in entries
    ]
    for name, average in (("mean", statistics.fmean), ("median", statistics.median)):
        columns = [[float(row[k] or 0.0) for row in rows[: len(entries)]] for k in (1, 2, 4, 5)]
        heading, position, in_heading, in_position = (average(column) for column in columns)
        rows.append((name, heading, position, None, in_heading, in_position))
    header = ("run left out", "whole run, heading [deg]", "position [m]", f"windows of {WINDOW_S:g} s",
              "in them, heading [deg]", "position [m]")  # fmt: skip
    note = (
        "Open-loop rms errors. The run left out gives nothing but an initial state, from its first ship length or the "
        "first 5 s of a window; its offsets are the mean of those that trained. Whole runs at small rudder angles "
        "are a hard test: the ship is nearly unstable on her course, and a small error of the offset grows."
    )
    return Table("Leave one run out", header, tuple(rows), note)


def left_out_turns(entries: tuple[LeftOut, ...]) -> Table:
    """What the turns owe to single runs."""
    rows: list[tuple[str | float | None, ...]] = [
        (e.run, *(x for side in SIDES for x in (e.turns[side].advance, e.turns[side].diameter))) for e in entries
    ]
    columns = zip(*[[float(x or 0.0) for x in row[1:]] for row in rows], strict=True)
    rows.append(("jackknife standard error", *(jackknife_error(column) for column in columns)))
    header = ("run left out", *(f"{side}, {what} [L]" for side in SIDES for what in ("advance", "tactical diameter")))
    return Table("Turning circles with one run left out", header, tuple(rows))


def figures(made: Repetition) -> tuple[Figure, ...]:
    """Tracks of the simulated turns."""
    length = made.fit.ship.length
    curves = tuple(_track(record, side, length) for side, record in made.tracks.items())
    return (Figure("Simulated 35 deg turns", "y0 / L", "x0 / L", curves, is_map=True),)


def _track(record: Record, side: str, length: float) -> Curve:
    return Curve(side, np.asarray(record["y0"]) / length, np.asarray(record["x0"]) / length)
