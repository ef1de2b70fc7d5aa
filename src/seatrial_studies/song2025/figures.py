"""Figures of the study: sensitivity bars, correlation surfaces, zigzags, turn and forces, errors by estimator."""

import numpy as np

from seatrial.core.results import Bars, Curve, Figure, Matrix, Prediction
from seatrial.physics.models.waterjet import COEFFICIENTS
from seatrial_studies.song2025.crafts import TRUTH
from seatrial_studies.song2025.evidence import Evidence
from seatrial_studies.song2025.generalisation import CHANNELS, Outcome, force_series
from seatrial_studies.song2025.published import SENSITIVE, Column, Equation, Run
from seatrial_studies.song2025.repetition import Row, truth

_SHOWN = (Run.ZIGZAG_20, Run.ZIGZAG_35, Run.TURN_35)
_NUMBER = {Run.ZIGZAG_20: "4, 5", Run.ZIGZAG_35: "7, 8", Run.TURN_35: "9, 10"}
_UNITS = {"u": "m/s", "v": "m/s", "r": "rad/s"}
_POINTS = 500
_NAMES = {Equation.SURGE: COEFFICIENTS[:3], Equation.SWAY: COEFFICIENTS[3:8], Equation.YAW: COEFFICIENTS[8:]}
_WORDS = {Equation.SURGE: "surge", Equation.SWAY: "sway", Equation.YAW: "yaw"}


def figures(seen: Evidence) -> tuple[Figure | Bars | Matrix, ...]:
    """In the order of the page."""
    drawn = [_table_2(seen), _estimators(seen), _noise(seen), *_sensitivity(seen), *_correlations(seen)]
    for run in _SHOWN:
        drawn += _motions(seen, run)
    return tuple(drawn)


def predictions(seen: Evidence) -> tuple[Prediction, ...]:
    """The improved column, signs mended, on the truth's nozzle history, beside the truth."""
    made = []
    for run in _SHOWN:
        outcome = seen.outcome(Column.IMPROVED, run)
        if outcome.replayed_accuracy is not None:
            made.append(
                Prediction(run, "validation", outcome.reference, outcome.replayed, outcome.replayed_accuracy.rmse,
                           {}, 0.0)
            )  # fmt: skip
    return tuple(made)


def _table_2(seen: Evidence) -> Bars:
    made, true = seen.made, truth()
    series = {f"paper, {c}": _printed(c, true) for c in (Column.ORIGINAL, Column.IMPROVED)}
    series |= {
        "ours, original": _shares(made.published[0]),
        "ours, improved": _shares(made.published[1]),
        "output error, sensor noise": _shares(made.ours),
    }
    return Bars(
        "Table 2: errors of the coefficients", COEFFICIENTS, series, "error [% of the truth]",
        "The support vectors have noise-free data, output error has the noise of a craft's sensors.",
        is_logarithmic=True,
    )  # fmt: skip


def _printed(column: Column, true: np.ndarray) -> tuple[float, ...]:
    from seatrial_studies.song2025.published import coefficients

    return tuple(100.0 * abs(abs(v) / abs(t) - 1.0) for v, t in zip(coefficients(column).values(), true, strict=True))


def _shares(row: Row) -> tuple[float, ...]:
    return tuple(100.0 * float(abs(e)) for e in row.errors)


def _estimators(seen: Evidence) -> Bars:
    made = seen.made
    clean, noisy = (*made.clean, made.exact), (*made.noisy, made.ours)
    return Bars(
        "Every estimator on the same series",
        (*(r.name for r in made.clean), "output error"),
        {
            "noise-free": tuple(100.0 * r.median for r in clean),
            "sensor noise": tuple(100.0 * r.median for r in noisy),
        },
        "median error [%]",
        is_logarithmic=True,
    )


def _noise(seen: Evidence) -> Bars:
    sweep = seen.made.noise
    return Bars(
        "Noise of the velocities",
        tuple(f"{level:g} m/s" for level in sweep.levels),
        {name: tuple(100.0 * float(v) for v in values) for name, values in sweep.medians.items()},
        "median error [%]",
        "Least squares; differencing turns ten micrometres a second into errors of hundreds of per cent.",
        is_logarithmic=True,
    )


def _sensitivity(seen: Evidence) -> tuple[Bars, Bars]:
    alone, left = seen.indirect, seen.unique
    by_state = {s: tuple(float(x) for x in alone.matrix[:, j]) for j, s in enumerate(alone.states)}
    return (
        Bars(
            "Figure 2: indirect sensitivity of each coefficient",
            alone.names,
            {**by_state, "total": tuple(float(x) for x in alone.total)},
            "relative change of the motion for that of the coefficient",
            f"The paper calls sensitive: {', '.join(SENSITIVE)}.",
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


def _correlations(seen: Evidence) -> list[Matrix]:
    return [
        Matrix(f"Figure 6: correlation of the features, {_WORDS[e]}", _NAMES[e], _NAMES[e], values)
        for e, values in seen.audited.conditions.correlations.items()
    ]


def _motions(seen: Evidence, run: Run) -> list[Figure]:
    outcome = seen.outcome(Column.IMPROVED, run)
    time, drawn = outcome.reference.time, []
    pairs = [("truth", outcome.reference), ("improved column, signs mended", outcome.replayed)]
    if run is Run.ZIGZAG_20:
        pairs.append(("original column, N_v mended", seen.outcome(Column.ORIGINAL, run).replayed))
    for c in CHANNELS:
        curves = tuple(_curve(name, r.time, r[c]) for name, r in pairs)
        drawn.append(Figure(f"Figures {_NUMBER[run]}: {run}, {c}", "time [s]", f"{c} [{_UNITS[c]}]", curves))
    own, other = force_series(TRUTH, outcome.reference), _forces(outcome)
    for letter, values in own.items():
        curves = (_curve("truth", time, values), _curve("improved column, signs mended", time, other[letter]))
        unit = "N m" if letter == "N" else "N"
        drawn.append(Figure(f"Figures {_NUMBER[run]}: {run}, {letter}", "time [s]", f"{letter} [{unit}]", curves))
    return drawn


def _forces(outcome: Outcome) -> dict[str, np.ndarray]:
    return force_series(outcome.reading, outcome.replayed)


def _curve(name: str, x: np.ndarray, y: np.ndarray) -> Curve:
    step = max(1, len(x) // _POINTS)
    n = min(len(x), len(y))
    return Curve(name, x[:n:step], y[:n:step])
