"""Tables and figures of the study."""

import statistics
from collections.abc import Sequence

import numpy as np

from seatrial.core.results import CandidateModel, Curve, Figure, Prediction, Table
from seatrial.core.values import NOTATION, Record, display_unit
from seatrial.estimation.identify import HOLDOUT_WINDOW_SHIP_LENGTHS
from seatrial_studies.alexandersson2022.reproduction import (
    MEASURED_TURNS,
    OTHER_TURNS,
    PREDICTED_TURNS,
    RERUN_ADVANCE,
    RERUN_DIAMETER,
    RERUN_HEADING,
    RERUN_POSITION,
    RERUN_SECONDS,
    SIDES,
    WINDOW_S,
    BenchmarkReproduction,
    LeftOutRun,
    PredictionCoverage,
    jackknife_error,
    percent_deviation,
)

# What the intervals are worth: the turns' beside MARIN's circles, the bands of 30 s windows beside the records.


def coverage_tables(coverage: PredictionCoverage) -> tuple[Table, ...]:
    """The intervals of the turns, the shares of samples inside their bands, and the family where it was fitted."""
    turned = tuple(
        (
            f"{m.measure}, {m.side}",
            how,
            m.lower,
            m.upper,
            m.half_width,
            m.measured,
            "inside" if m.contains_measured else "outside",
        )
        for how, turns in (
            ("one-step jackknife", coverage.turn_intervals),
            ("jackknife, tied models", coverage.tied_turn_intervals),
        )
        for m in turns
    )
    rows: list[tuple[str | float | None, ...]] = [
        (c.run, c.windows, *(100.0 * c.shares[s] for s in ("psi", "x0", "y0")))
        for c in (*coverage.left_out_coverage, *coverage.held_out_coverage)
    ]
    rows.insert(
        len(coverage.left_out_coverage), ("mean of the runs left out", None, 100.0 * coverage.heading_share, None, None)
    )
    return (
        Table(
            "Intervals of the 35 deg turns",
            ("measure", "interval by", "from [L]", "to [L]", "half width [%]", "MARIN [L]", "MARIN's value"),
            turned,
            "95 % intervals: scatter of runs left out times the factor by which their errors exceed it (the default of "
            "seatrial identify); with full refits and the spread of tied models (--intervals jackknife) unless quick.",
        ),
        Table(
            f"Samples inside their 95 % bands, windows of {WINDOW_S:g} s",
            ("run", "windows", "heading [%]", "x0 [%]", "y0 [%]"),
            tuple(rows),
            "Each training run is predicted by the model without it (one-step jackknife), and its model discrepancy is "
            "that of the others; the last row is the run held out from everything.",
        ),
        *((family_table(coverage.family),) if coverage.family else ()),
    )


def family_table(members: Sequence[CandidateModel]) -> Table:
    """What each model of the family misses of runs left out."""
    rows = tuple(
        (
            m.name,
            m.free_count,
            m.heading_deg,
            m.position_m,
            "the trial's" if m.is_chosen else "tied" if m.is_tied else m.note,
        )
        for m in members
    )
    return Table(
        "The family of models on runs left out",
        ("model", "free coefficients", "heading rms [deg]", "position rms [m]", "standing"),
        rows,
        f"Windows of {HOLDOUT_WINDOW_SHIP_LENGTHS:g} ship lengths, one-step jackknife. Tied models are not "
        "worse than the best "
        "one beyond the scatter over runs; the trial's own model need not be among them, and none is chosen here.",
    )


def tables(reproduction: BenchmarkReproduction) -> tuple[Table, ...]:
    """Return all tables; those of leave-one-run-out only where it was done."""
    always = (
        comparison_table(reproduction),
        turn_table(reproduction),
        *coverage_tables(reproduction.coverage),
        offset_table(reproduction),
        noise_table(reproduction),
    )
    return (
        (*always, left_out_table(reproduction.left_out_runs), left_out_turn_table(reproduction.left_out_runs))
        if reproduction.left_out_runs
        else always
    )


def validation_prediction(reproduction: BenchmarkReproduction) -> Prediction:
    """Return the prediction of the validation run."""
    return reproduction.fit.validation[0]


def comparison_table(reproduction: BenchmarkReproduction) -> Table:
    """Return the paper's numbers, those of its code run again, and ours."""
    rms, again = validation_prediction(reproduction).rms, "{:.1f} to {:.1f}"
    rows: list[tuple[str | float | None, ...]] = [
        ("Z_35_05 open loop, heading rms [deg]", None, again.format(*RERUN_HEADING), rms["psi_deg"]),
        ("Z_35_05 open loop, position rms [m]", None, again.format(*RERUN_POSITION), rms["position_m"]),
    ]
    for side in SIDES:
        truth, paper, ours = MEASURED_TURNS[side], PREDICTED_TURNS[side], reproduction.turns[side]
        rows += [
            (
                f"35 deg turn to {side}, advance against MARIN [%]",
                percent_deviation(paper.advance, truth.advance),
                f"{RERUN_ADVANCE[side]:+.1f}",
                percent_deviation(ours.advance, truth.advance),
            ),
            (
                f"35 deg turn to {side}, tactical diameter against MARIN [%]",
                percent_deviation(paper.diameter, truth.diameter),
                f"{RERUN_DIAMETER[side]:+.1f}",
                percent_deviation(ours.diameter, truth.diameter),
            ),
        ]
    rows.append(("computing time [s]", None, f"{RERUN_SECONDS:g}", reproduction.fit.elapsed_s))
    note = (
        "The published code was run again on the same records and trained without Z_35_05; its time is that of one "
        "machine. Ours is the whole of reading, checking, identifying and predicting 13 runs, compilation included."
    )
    return Table("The published numbers and ours", ("quantity", "paper", "its code again", "here"), tuple(rows), note)


def turn_table(reproduction: BenchmarkReproduction) -> Table:
    """Simulated turns beside every named measured value."""
    rows: list[tuple[str | float | None, ...]] = []
    for side in SIDES:
        ours, paper = reproduction.turns[side], PREDICTED_TURNS[side]
        rows.append((ours.source, side, ours.advance, ours.diameter, None, None))
        rows.append((paper.source, side, paper.advance, paper.diameter, None, None))
        for truth in (MEASURED_TURNS[side], *OTHER_TURNS):
            rows.append(
                (
                    truth.source,
                    truth.side or "not stated",
                    truth.advance,
                    truth.diameter,
                    percent_deviation(ours.advance, truth.advance),
                    percent_deviation(ours.diameter, truth.diameter),
                )
            )
    header = ("source", "side", "advance [L]", "tactical diameter [L]", "advance, here [%]", "diameter, here [%]")
    note = (
        "Simulated from the speed at which surge balances at the trials' propeller rate, rudder at SOLAS's rate. "
        "The simulated track is that of midship; whether the measured one is, is not stated (the centre of gravity, "
        "0.035 L ahead, would have an advance shorter by as much and the same tactical diameter). The paper's table "
        "is that of notebook 06.20 in the authors' repository System-identification-of-Vessel-Manoeuvring-Models."
    )
    return Table("Turning circles with 35 deg of rudder", header, tuple(rows), note)


def offset_table(reproduction: BenchmarkReproduction) -> Table:
    """Nuisances of each training run."""
    rows = []
    for offset in reproduction.fit.offsets:
        factor, unit = display_unit(offset.unit)
        error = None if offset.standard_error is None else factor * offset.standard_error
        rows.append((offset.group, f"{offset.name} [{unit}]", factor * offset.estimate, error))
    note = (
        "Added to the measured angle, positive to starboard. The validation run is given the mean of these; nothing "
        "is fitted on it."
    )
    return Table("Offsets by run", ("run", "offset", "estimate", "standard error"), tuple(rows), note)


def noise_table(reproduction: BenchmarkReproduction) -> Table:
    """Return noise from sample to sample beside what the model leaves."""
    rows = []
    for item in reproduction.fit.channel_noise:
        if item.channel in reproduction.noise_levels:
            factor, unit = display_unit(NOTATION[item.channel].unit)
            sample = reproduction.noise_levels[item.channel]
            ratio = item.standard_deviation / sample if sample > 0 else None
            rows.append((f"{item.channel} [{unit}]", factor * sample, factor * item.standard_deviation, ratio))
    note = (
        "Noise from third differences of the records at their own rate, median over runs (Gasser, Sroka & "
        "Jennen-Steinmetz 1986); what the model leaves within segments is the estimated standard deviation."
    )
    return Table("Noise", ("channel", "sample to sample", "left by the model", "ratio"), tuple(rows), note)


def left_out_table(entries: tuple[LeftOutRun, ...]) -> Table:
    """Return errors of each run when the others trained."""
    rows: list[tuple[str | float | None, ...]] = [
        (
            e.run,
            e.prediction.rms["psi_deg"],
            e.prediction.rms["position_m"],
            e.window_count,
            e.window_heading_deg,
            e.window_position_m,
        )
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
        "are a hard test: the ship is nearly unstable on its course, and a small error of the offset grows."
    )
    return Table("Leave one run out", header, tuple(rows), note)


def left_out_turn_table(entries: tuple[LeftOutRun, ...]) -> Table:
    """What the turns owe to single runs."""
    rows: list[tuple[str | float | None, ...]] = [
        (e.run, *(x for side in SIDES for x in (e.turns[side].advance, e.turns[side].diameter))) for e in entries
    ]
    columns = zip(*[[float(x or 0.0) for x in row[1:]] for row in rows], strict=True)
    rows.append(("jackknife standard error", *(jackknife_error(column) for column in columns)))
    header = ("run left out", *(f"{side}, {what} [L]" for side in SIDES for what in ("advance", "tactical diameter")))
    return Table("Turning circles with one run left out", header, tuple(rows))


def figures(reproduction: BenchmarkReproduction) -> tuple[Figure, ...]:
    """Tracks of the simulated turns."""
    length = reproduction.fit.ship.length
    curves = tuple(_track_curve(record, side, length) for side, record in reproduction.tracks.items())
    return (Figure("Simulated 35 deg turns", "y0 / L", "x0 / L", curves, is_map=True),)


def _track_curve(record: Record, side: str, length: float) -> Curve:
    return Curve(side, np.asarray(record["y0"]) / length, np.asarray(record["x0"]) / length)
