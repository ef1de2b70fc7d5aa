"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

import math
import statistics
from collections import Counter

import numpy as np

from seatrial.core.results import Curve
from seatrial.core.values import NOTATION, display_unit
from seatrial.estimation.identify import HOLDOUT_WINDOW_SHIP_LENGTHS
from seatrial_studies.alexandersson2022.reproduction import (
    MEASURED_TURNS,
    OTHER_TURNS,
    PREDICTED_TURNS,
    SIDES,
    BenchmarkReproduction,
    Turn,
    TurnInterval,
    percent_deviation,
    published_range,
)
from seatrial_studies.cross_validation import jackknife_error
from seatrial_studies.study_page import Facts, FactTable

FACTS = FactTable[BenchmarkReproduction]()
MEASURES = {"advance": "advance", "diameter": "tactical diameter"}
# the normal 97.5 % point
TWO_SIDED_95 = 1.96
_WRONG_FRAME, _MISLABELLED = "wrong-frame", "mislabelled"


def _deviations(turn: Turn, side: str) -> dict[str, float]:
    """Return the deviations of both measures from MARIN's, per cent."""
    return {m: percent_deviation(getattr(turn, m), getattr(MEASURED_TURNS[side], m)) for m in MEASURES}


@FACTS.declare
def zigzag(reproduction: BenchmarkReproduction) -> Facts:
    """Errors of the run held out."""
    rms = reproduction.fit.validation[0].rms
    return {"heading": rms["psi_deg"], "position": rms["position_m"]}


@FACTS.declare
def turns(reproduction: BenchmarkReproduction) -> Facts:
    """Deviations of the turns from MARIN's, per cent, ours and the paper's."""
    ours = {side: _deviations(reproduction.turns[side], side) for side in SIDES}
    return {
        "ours": ours,
        "paper": {side: _deviations(PREDICTED_TURNS[side], side) for side in SIDES},
        "worst_mean": max(statistics.fmean(abs(ours[side][m]) for side in SIDES) for m in MEASURES),
        "none": None,
    }


@FACTS.declare
def turned(reproduction: BenchmarkReproduction) -> list[Facts]:
    """Each measure of each turn against the published range, widened by the paper's own largest error."""
    groups = []
    for side in SIDES:
        for field, measure in MEASURES.items():
            size, (lower, upper) = float(getattr(reproduction.turns[side], field)), published_range(field)
            inside = math.isfinite(size) and lower <= size <= upper
            groups.append(
                {"side": side, "measure": measure, "size": size, "lower": lower, "upper": upper, "is_inside": inside}
            )
    return groups


@FACTS.declare
def turn_rows(reproduction: BenchmarkReproduction) -> Facts:
    """Simulated turns beside every named measured value."""
    rows: list[tuple[str | float | None, ...]] = []
    for side in SIDES:
        ours, paper = reproduction.turns[side], PREDICTED_TURNS[side]
        rows += [(turn.source, side, turn.advance, turn.diameter, None, None) for turn in (ours, paper)]
        for truth in (MEASURED_TURNS[side], *OTHER_TURNS):
            off = (percent_deviation(getattr(ours, m), getattr(truth, m)) for m in MEASURES)
            rows.append((truth.source, truth.side or "not stated", truth.advance, truth.diameter, *off))
    return {"rows": rows}


@FACTS.declare
def noise(reproduction: BenchmarkReproduction) -> Facts:
    """Noise from sample to sample beside what the model leaves."""
    rows, ratios = [], []
    for residual in reproduction.fit.channel_noise:
        if residual.channel in reproduction.noise_levels:
            factor, unit = display_unit(NOTATION[residual.channel].unit)
            sample = reproduction.noise_levels[residual.channel]
            ratio = residual.standard_deviation / sample if sample > 0 else None
            rows.append((f"{residual.channel} [{unit}]", factor * sample, factor * residual.standard_deviation, ratio))
            ratios += [ratio] if ratio else []
    return {"rows": rows, "least_ratio": min(ratios, default=0.0)}


@FACTS.declare
def left_out(reproduction: BenchmarkReproduction) -> Facts:
    """Errors of each run when the others trained, and the turns' standard errors from runs left out."""
    entries = reproduction.left_out_runs
    if not entries:
        return {"is_full": False, "is_outside": False, "by_side": []}
    rms = [e.prediction.rms for e in entries]
    headings, positions = [r["psi_deg"] for r in rms], [r["position_m"] for r in rms]
    windows = ([e.window_heading_deg for e in entries], [e.window_position_m for e in entries])
    counts = [e.window_count for e in entries]
    averages = (
        (name, average(headings), average(positions), None, *map(average, windows))
        for name, average in (("mean", statistics.fmean), ("median", statistics.median))
    )
    errors = {side: jackknife_error([e.turns[side].diameter for e in entries]) for side in SIDES}
    diameters = {side: reproduction.turns[side].diameter for side in SIDES}
    return {
        "is_full": True,
        "is_outside": not all(
            abs(diameters[side] - MEASURED_TURNS[side].diameter) <= TWO_SIDED_95 * errors[side] for side in SIDES
        ),
        "by_side": [
            {
                "side": side,
                "error": errors[side] / diameters[side],
                "off": percent_deviation(diameters[side], MEASURED_TURNS[side].diameter),
            }
            for side in SIDES
        ],
        "headings": headings,
        "run_count": len(entries),
        "window_heading": statistics.fmean(windows[0]),
        "rows": [*zip([e.run for e in entries], headings, positions, counts, *windows, strict=True), *averages],
    }


@FACTS.declare
def left_out_turns(reproduction: BenchmarkReproduction) -> Facts:
    """What the turns owe to single runs."""
    rows = [
        (e.run, *(getattr(e.turns[side], m) for side in SIDES for m in MEASURES)) for e in reproduction.left_out_runs
    ]
    if rows:
        _, *columns = zip(*rows, strict=True)
        rows.append(("jackknife standard error", *map(jackknife_error, columns)))
    return {"rows": rows}


@FACTS.declare
def intervals(reproduction: BenchmarkReproduction) -> Facts:
    """Intervals of the turns beside MARIN's values, by how they were made."""
    coverage = reproduction.coverage
    plain, tied = coverage.turn_intervals, coverage.tied_turn_intervals
    kinds = (("which count what runs left out missed", plain), ("with the spread of tied models as well", tied))
    return {
        "interval_kinds": [
            {
                "how": kind,
                "inside": sum(m.contains_measured for m in turn_intervals),
                "count": len(turn_intervals),
                "widest": max(m.half_width for m in turn_intervals),
                "farthest": max(m.relative_deviation for m in turn_intervals),
            }
            for kind, turn_intervals in kinds
            if turn_intervals
        ],
        "rows": [
            _interval_row(m, kind)
            for kind, turn_intervals in (("one-step jackknife", plain), ("jackknife, tied models", tied))
            for m in turn_intervals
        ],
    }


def _interval_row(m: TurnInterval, kind: str) -> tuple[str | float, ...]:
    inside = "inside" if m.contains_measured else "outside"
    return f"{m.measure}, {m.side}", kind, m.lower, m.upper, m.half_width, m.measured, inside


@FACTS.declare
def half_widths(reproduction: BenchmarkReproduction) -> list[Facts]:
    """Half widths of the tactical diameters, per cent, by side and by how they were made."""
    coverage = reproduction.coverage
    kinds = (("", coverage.turn_intervals), (", with tied models", coverage.tied_turn_intervals))
    return [
        {"side": f"{m.side}{suffix}", "turn_half_width": m.half_width}
        for suffix, turn_intervals in kinds
        for m in turn_intervals
        if m.measure == MEASURES["diameter"]
    ]


@FACTS.declare
def shares(reproduction: BenchmarkReproduction) -> Facts:
    """Shares of samples inside their bands, runs left out and held out."""
    coverage = reproduction.coverage
    held = statistics.fmean(c.shares["psi"] for c in coverage.held_out_coverage)
    left_out_rows, held_out = (
        [(c.run, c.windows, *(100.0 * c.shares[s] for s in ("psi", "x0", "y0"))) for c in coverages]
        for coverages in (coverage.left_out_coverage, coverage.held_out_coverage)
    )
    mean = ("mean of the runs left out", None, 100.0 * coverage.heading_share, None, None)
    return {
        "Z_35_05_share": held,
        "rows": [*left_out_rows, mean, *held_out],
    }


@FACTS.declare
def family(reproduction: BenchmarkReproduction) -> Facts:
    """What each model of the family misses of runs left out."""
    return {
        "ship_lengths": HOLDOUT_WINDOW_SHIP_LENGTHS,
        "rows": [
            (
                m.name, m.free_count, m.heading_deg, m.position_m,
                "the trial's" if m.is_chosen else "tied" if m.is_tied else m.note,
            )
            for m in reproduction.coverage.family
        ],
    }  # fmt: skip


@FACTS.declare
def offsets(reproduction: BenchmarkReproduction) -> Facts:
    """Nuisances of each training run."""
    rows = []
    for offset in reproduction.fit.offsets:
        factor, unit = display_unit(offset.unit)
        error = None if offset.standard_error is None else factor * offset.standard_error
        rows.append((offset.group, f"{offset.name} [{unit}]", factor * offset.estimate, error))
    return {"rows": rows}


@FACTS.declare
def labels(reproduction: BenchmarkReproduction) -> Facts:
    """What the checks find in the runs when the columns are declared as the headers name them."""
    by_run = reproduction.label_findings.values()
    codes = [{f.code for f in findings} for findings in by_run]
    count = Counter(f.code for findings in by_run for f in findings)
    example = next((findings for findings in by_run if findings), ())
    return {
        "label_runs": len(by_run),
        "in_every_run": bool(codes) and all(run >= {_WRONG_FRAME, _MISLABELLED} for run in codes),
        "wrong_frame": count[_WRONG_FRAME],
        "mislabelled": count[_MISLABELLED],
        "example": [f"{f.message} ({f.evidence})" for f in example if f.code in (_WRONG_FRAME, _MISLABELLED)],
    }


@FACTS.declare
def tracks(reproduction: BenchmarkReproduction) -> Facts:
    """Tracks of the simulated turns, ship lengths."""
    length = reproduction.fit.ship.length
    return {
        "curves": [
            Curve(side, np.asarray(record["y0"]) / length, np.asarray(record["x0"]) / length)
            for side, record in reproduction.tracks.items()
        ]
    }
