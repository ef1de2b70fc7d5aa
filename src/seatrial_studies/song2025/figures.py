"""Figures of the study: sensitivity bars, correlation surfaces, zigzags, turn and forces, errors by estimator."""

import numpy as np

from seatrial.core.results import Bars, Curve, Figure, Matrix, Prediction
from seatrial.physics.models import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.song2025.generalisation import CHANNELS, RunComparison, hull_and_jet_forces
from seatrial_studies.song2025.published import (
    CALLED_SENSITIVE,
    DROPPED_COEFFICIENTS,
    TRUTH,
    MotionEquation,
    PublishedManoeuvre,
    Table2Column,
)
from seatrial_studies.song2025.reproduction import EstimatorResult, true_coefficients
from seatrial_studies.song2025.verdicts import SupportVectorEvidence

_FIGURE_RUNS = (PublishedManoeuvre.ZIGZAG_20, PublishedManoeuvre.ZIGZAG_35, PublishedManoeuvre.TURN_35)
_FIGURE_NUMBERS = {
    PublishedManoeuvre.ZIGZAG_20: "4, 5",
    PublishedManoeuvre.ZIGZAG_35: "7, 8",
    PublishedManoeuvre.TURN_35: "9, 10",
}
_UNITS = {"u": "m/s", "v": "m/s", "r": "rad/s"}
_POINTS = 500
# what the runs compare: nothing in this study is measured
_PREDICTED = "the paper's improved column, both signs corrected, against the simulated truth on its nozzle history"
_EQUATION_COEFFICIENTS = {
    MotionEquation.SURGE: COEFFICIENTS[:3],
    MotionEquation.SWAY: COEFFICIENTS[3:8],
    MotionEquation.YAW: COEFFICIENTS[8:],
}
_EQUATION_NAMES = {MotionEquation.SURGE: "surge", MotionEquation.SWAY: "sway", MotionEquation.YAW: "yaw"}


def figures(evidence: SupportVectorEvidence) -> tuple[Figure | Bars | Matrix, ...]:
    """Return the figures in the order of the page."""
    drawn = [
        _table_2(evidence),
        _estimators(evidence),
        _noise(evidence),
        *_sensitivity(evidence),
        *_correlations(evidence),
    ]
    for run in _FIGURE_RUNS:
        drawn += _motions(evidence, run)
    return tuple(drawn)


def predictions(evidence: SupportVectorEvidence) -> tuple[Prediction, ...]:
    """Return the runs of the improved column, signs corrected, on the truth's nozzle history, with the truth."""
    made = []
    for run in _FIGURE_RUNS:
        outcome = evidence.comparison(Table2Column.IMPROVED, run)
        if outcome.replayed_accuracy is not None:
            made.append(
                Prediction(f"{run}, {_PREDICTED}", "validation", outcome.reference, outcome.replayed,
                           outcome.replayed_accuracy.rmse, {}, 0.0)
            )  # fmt: skip
    return tuple(made)


def _table_2(evidence: SupportVectorEvidence) -> Bars:
    made, true = evidence.reproduction, true_coefficients()
    series = {f"paper, {c}": _printed(c, true) for c in (Table2Column.ORIGINAL, Table2Column.IMPROVED)}
    series |= {
        "ours, original": _error_percentages(made.published[0]),
        "ours, improved": _error_percentages(made.published[1]),
        "output error, sensor noise": _error_percentages(made.output_error_noisy),
    }
    return Bars(
        "Table 2: errors of the coefficients", COEFFICIENTS, series, "error [% of the truth]",
        "The support vectors have noise-free data, output error has the noise of a craft's sensors.",
        is_logarithmic=True,
    )  # fmt: skip


def _printed(column: Table2Column, true: np.ndarray) -> tuple[float, ...]:
    from seatrial_studies.song2025.published import printed_coefficients

    return tuple(
        100.0 * abs(abs(v) / abs(t) - 1.0) for v, t in zip(printed_coefficients(column).values(), true, strict=True)
    )


def _error_percentages(row: EstimatorResult) -> tuple[float, ...]:
    return tuple(100.0 * float(abs(e)) for e in row.errors)


def _estimators(evidence: SupportVectorEvidence) -> Bars:
    made = evidence.reproduction
    clean, noisy = (
        (*made.noise_free_results, made.output_error_noise_free),
        (*made.noisy_results, made.output_error_noisy),
    )
    return Bars(
        "Every estimator on the same series",
        (*(r.name for r in made.noise_free_results), "output error"),
        {
            "noise-free": tuple(100.0 * r.median_error for r in clean),
            "sensor noise": tuple(100.0 * r.median_error for r in noisy),
        },
        "median error [%]",
        is_logarithmic=True,
    )


def _noise(evidence: SupportVectorEvidence) -> Bars:
    sweep = evidence.reproduction.noise_sweep
    return Bars(
        "Noise of the velocities",
        tuple(f"{level:g} m/s" for level in sweep.levels),
        {name: tuple(100.0 * float(v) for v in values) for name, values in sweep.medians.items()},
        "median error [%]",
        "Least squares; differencing turns ten micrometres a second into errors of hundreds of per cent.",
        is_logarithmic=True,
    )


def _sensitivity(evidence: SupportVectorEvidence) -> tuple[Bars, Bars]:
    alone, left = evidence.indirect_sensitivity, evidence.unique_sensitivity
    by_state = {s: tuple(float(x) for x in alone.matrix[:, j]) for j, s in enumerate(alone.states)}
    return (
        Bars(
            "Figure 2: indirect sensitivity of each coefficient",
            alone.names,
            {**by_state, "total": tuple(float(x) for x in alone.total)},
            "relative change of the motion for that of the coefficient",
            f"The paper calls sensitive: {', '.join(CALLED_SENSITIVE)}. {' and '.join(DROPPED_COEFFICIENTS)}, which "
            "Lasso takes out, are zero in our truth: no relative change moves them.",
        ),
        Bars(
            "What other coefficients can undo",
            left.names,
            {"alone": tuple(float(x) for x in left.total), "left": tuple(float(x) for x in left.unique)},
            "rms slope by relative change",
            "Left: what no change of the others can undo; the ratio squared is the variance inflation factor.",
            is_logarithmic=True,
        ),
    )


def _correlations(evidence: SupportVectorEvidence) -> list[Matrix]:
    return [
        Matrix(
            f"Figure 6: correlation of the features, {_EQUATION_NAMES[e]}",
            _EQUATION_COEFFICIENTS[e],
            _EQUATION_COEFFICIENTS[e],
            values,
        )
        for e, values in evidence.audit.table_3_conditions.correlations.items()
    ]


def _motions(evidence: SupportVectorEvidence, run: PublishedManoeuvre) -> list[Figure]:
    outcome, own = evidence.comparison(Table2Column.IMPROVED, run), evidence.own_comparison(run)
    time, drawn = outcome.reference.time, []
    pairs = [
        ("truth (simulated)", outcome.reference),
        ("improved column, signs corrected", outcome.replayed),
        ("our pipeline", own.replayed),
    ]
    if run is PublishedManoeuvre.ZIGZAG_20:
        pairs.append(("original column, N_v corrected", evidence.comparison(Table2Column.ORIGINAL, run).replayed))
    for c in CHANNELS:
        curves = tuple(_curve(name, r.time, r[c]) for name, r in pairs)
        drawn.append(Figure(f"Figures {_FIGURE_NUMBERS[run]}: {run}, {c}", "time [s]", f"{c} [{_UNITS[c]}]", curves))
    columns = [
        ("truth (simulated)", hull_and_jet_forces(TRUTH.craft(), outcome.reference)),
        ("improved column, signs corrected", _forces(outcome)),
        ("our pipeline", _forces(own)),
    ]
    for letter in columns[0][1]:
        curves = tuple(_curve(name, time, of_run[letter]) for name, of_run in columns)
        unit = "N m" if letter == "N" else "N"
        drawn.append(
            Figure(f"Figures {_FIGURE_NUMBERS[run]}: {run}, {letter}", "time [s]", f"{letter} [{unit}]", curves)
        )
    return [*drawn, *_helmsman(evidence, run)]


def _helmsman(evidence: SupportVectorEvidence, run: PublishedManoeuvre) -> list[Figure]:
    """Track, heading and nozzle with the helmsman in the loop, as figures b and c compare them."""
    outcome, own = evidence.comparison(Table2Column.IMPROVED, run), evidence.own_comparison(run)
    number = _FIGURE_NUMBERS[run].split(",")[0]
    records = [("truth (simulated)", outcome.reference), ("improved column, signs corrected", outcome.steered.record),
               ("our pipeline", own.steered.record)]  # fmt: skip
    steered = [(name, record) for name, record in records if record is not None]
    note = (
        "The nozzle goes to its ordered angle and stays: one history for all."
        if run is PublishedManoeuvre.TURN_35
        else "The helmsman steers each craft himself, so that nozzle angles differ."
    )
    track = tuple(_curve(name, r["y0"], r["x0"]) for name, r in steered)
    made = [Figure(f"Figure {number}b: {run}, track", "y0 [m]", "x0 [m]", track, note, is_map=True)]
    for letter, channel, words in (("c", "psi", "heading"), ("c", "delta", "nozzle")):
        curves = tuple(_curve(name, r.time, np.degrees(r[channel])) for name, r in steered)
        made.append(Figure(f"Figure {number}{letter}: {run}, {words}", "time [s]", f"{words} [°]", curves, note))
    return made


def _forces(comparison: RunComparison) -> dict[str, np.ndarray]:
    return hull_and_jet_forces(comparison.craft, comparison.replayed)


def _curve(name: str, x: np.ndarray, y: np.ndarray) -> Curve:
    step = max(1, len(x) // _POINTS)
    n = min(len(x), len(y))
    return Curve(name, x[:n:step], y[:n:step])
