"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Curve, Prediction
from seatrial.core.values import Array, Record
from seatrial.data.example_series import SENSOR_NOISE
from seatrial.physics.models import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.controller_cost import ControllerCost, controller_rows
from seatrial_studies.song2025.audit import SupportVectorAudit
from seatrial_studies.song2025.generalisation import (
    CHANNELS,
    Discrimination,
    IndirectSensitivity,
    RunComparison,
    SpeedPrediction,
    UniqueSensitivity,
    hull_and_jet_forces,
)
from seatrial_studies.song2025.published import (
    CALLED_INSENSITIVE,
    CALLED_SENSITIVE,
    CORRECTED,
    DROPPED_COEFFICIENTS,
    TABLE_2,
    TABLE_3,
    TABLE_4,
    TRUTH,
    MotionEquation,
    PublishedManoeuvre,
    Table2Column,
    printed_coefficients,
)
from seatrial_studies.song2025.reproduction import (
    CleaningAblation,
    EstimatorResult,
    SupportVectorReproduction,
    true_coefficients,
)
from seatrial_studies.study_page import Facts, FactTable

ORIGINAL, IMPROVED = Table2Column.ORIGINAL, Table2Column.IMPROVED
EQUATION_NAMES = dict(zip(MotionEquation, ("surge", "sway", "yaw"), strict=True))
EQUATION_COEFFICIENTS = dict(zip(MotionEquation, (COEFFICIENTS[:3], COEFFICIENTS[3:8], COEFFICIENTS[8:]), strict=True))
FIGURE_NUMBERS = {
    PublishedManoeuvre.ZIGZAG_20: "4, 5",
    PublishedManoeuvre.ZIGZAG_35: "7, 8",
    PublishedManoeuvre.TURN_35: "9, 10",
}
UNITS = {"u": "m/s", "v": "m/s", "r": "rad/s", "X": "N", "Y": "N", "N": "N m"}
_POINTS = 500
_FAR = 0.1  # relative error of coefficients that a setting names; our choice
# what the runs compare: nothing in this study is measured
_PREDICTED = "the paper's improved column, both signs corrected, against the simulated truth on its nozzle history"
_TRUE, _PAPER, _OWN = "truth (simulated)", "improved column, signs corrected", "our pipeline"


@dataclass(frozen=True, eq=False)
class SupportVectorEvidence:
    """Numbers of one run of the study.

    Attributes:
        own_comparisons: runs of our own improved pipeline, noise-free series.
        speeds: predictions at other speeds; controllers: autopilots tuned on each method's coefficients.
        turn_drift: deg in the steady 35 deg turn, truth and improved column corrected.
    """

    reproduction: SupportVectorReproduction
    audit: SupportVectorAudit
    comparisons: tuple[RunComparison, ...]
    discrimination: Discrimination
    indirect_sensitivity: IndirectSensitivity
    unique_sensitivity: UniqueSensitivity
    turn_drift: tuple[float, float]
    own_comparisons: tuple[RunComparison, ...]
    ablation: CleaningAblation
    speeds: tuple[SpeedPrediction, ...]
    controllers: tuple[ControllerCost, ...]

    def comparison(self, column: Table2Column, run: PublishedManoeuvre) -> RunComparison:
        """Return the run of a corrected column."""
        title = next(candidate.title for candidate in CORRECTED if candidate.column is column)
        return next(o for o in self.comparisons if o.title == title and o.run is run)

    def own_comparison(self, run: PublishedManoeuvre) -> RunComparison:
        """Return the run of our own pipeline's coefficients."""
        return next(o for o in self.own_comparisons if o.run is run)

    def best_regression(self) -> EstimatorResult:
        """Return the regression with the smallest median error in sensor noise."""
        return min((r for r in self.reproduction.noisy_results if not r.note), key=lambda r: r.median_error)


FACTS = FactTable[SupportVectorEvidence]()


def predictions(evidence: SupportVectorEvidence) -> tuple[Prediction, ...]:
    """Return the runs of the improved column, signs corrected, on the truth's nozzle history, with the truth."""
    outcomes = [(run, evidence.comparison(IMPROVED, run)) for run in FIGURE_NUMBERS]
    return tuple(
        Prediction(f"{run}, {_PREDICTED}", "validation", o.reference, o.replayed, o.replayed_accuracy.rmse, {}, 0.0)
        for run, o in outcomes
        if o.replayed_accuracy is not None
    )


def _printed_errors(column: Table2Column) -> Array:
    """Return the errors of a printed column in magnitude, its signs being misprinted, (11,)."""
    return np.abs([*printed_coefficients(column).values()]) / np.abs(true_coefficients()) - 1.0


def _named(results: Sequence[EstimatorResult], name: str) -> EstimatorResult:
    return next(r for r in results if r.name == name)


@FACTS.declare
def results(evidence: SupportVectorEvidence) -> Facts:
    """Both pipelines, the regressions they are compared with, output error, and the printed improved column."""
    reproduction = evidence.reproduction
    original, improved, noisy_original, noisy_improved = reproduction.published
    printed = np.abs(_printed_errors(IMPROVED))
    exact, ours = reproduction.output_error_noise_free, reproduction.output_error_noisy
    at_Y_vr = COEFFICIENTS.index("Y_vr")
    return {
        "original": original,
        "improved": improved,
        "noisy_original": noisy_original,
        "noisy_improved": noisy_improved,
        "euler": _named(reproduction.noise_free_results, "Euler differences, least squares"),
        "differenced": _named(reproduction.noise_free_results, "Euler, differenced and centred"),
        "uncentred": _named(reproduction.noise_free_results, "Euler, differenced"),
        "central": _named(reproduction.noise_free_results, "central differences, least squares"),
        "machine": _named(reproduction.noise_free_results, "central differences, support vectors"),
        "best": evidence.best_regression(),
        "near_original": reproduction.nearest(ORIGINAL),
        "near_improved": reproduction.nearest(IMPROVED),
        "setting_count": len(reproduction.settings) // 2,
        "printed_median": float(np.median(printed)),
        "printed_worst": float(printed.max()),
        "worst": COEFFICIENTS[int(np.argmax(printed))],
        "far": [name for name, error in zip(COEFFICIENTS, printed, strict=True) if error > _FAR],
        "noise": SENSOR_NOISE,
        "yaw_noise": float(np.degrees(SENSOR_NOISE["r"])),
        "Y_vr_exact": abs(float(exact.errors[at_Y_vr])),
        "Y_vr_noisy": abs(float(ours.errors[at_Y_vr])),
    }


@FACTS.declare
def lasso(evidence: SupportVectorEvidence) -> Facts:
    """What Lasso takes out in each setting."""
    selections = evidence.reproduction.selections
    right = [set(s.dropped) == set(DROPPED_COEFFICIENTS) for s in selections]
    return {
        "selections": [{"setting": s.setting, "dropped": s.dropped} for s in selections],
        "right": sum(right),
        "tried": len(selections),
        "is_first_right": right[0],
        "rows": [
            (s.setting, _listed(s.dropped), " / ".join(f"{s.penalties[e]:.2g}" for e in MotionEquation))
            for s in selections
        ],
    }


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) or "none"


@FACTS.declare
def sensitivity(evidence: SupportVectorEvidence) -> Facts:
    """Sensitivity of each coefficient alone, and what others can undo of it."""
    alone, unique = evidence.indirect_sensitivity, evidence.unique_sensitivity
    total = dict(zip(alone.names, alone.total.tolist(), strict=True))
    inflation = ((unique.total / unique.unique) ** 2).tolist()
    return {
        "total": total,
        "largest": max(total.values()),
        "called_insensitive": CALLED_INSENSITIVE,
        "kept": [name for name in CALLED_INSENSITIVE if name in total],
        "least_called": min(total[name] for name in CALLED_SENSITIVE) / max(total.values()),
        "Y_vr_over_X_vv": total["Y_vr"] / total["X_vv"],
        "states": alone.states,
        "rows": [
            (name, *of_states, total[name], factor)
            for name, of_states, factor in zip(alone.names, alone.matrix.tolist(), inflation, strict=True)
        ],
    }


@FACTS.declare
def discriminated(evidence: SupportVectorEvidence) -> Facts:
    """What motions show of coefficients that are 100 % off, and the correlations of predicted motions."""
    cells = {run: evidence.comparison(IMPROVED, run).replayed_accuracy for run in PublishedManoeuvre}
    least = {run: min(accuracy.cc.values()) for run, accuracy in cells.items() if accuracy is not None}
    return {
        "cc_loss": max(evidence.discrimination.cc_loss.values()),
        "least_by_run": [{"run": run, "cc": cc} for run, cc in least.items()],
        "lowest_cc": min(least.values()),
    }


@FACTS.declare
def cleaning(evidence: SupportVectorEvidence) -> Facts:
    """The improved pipeline with and without cleaning, on planted bad data and on the series as it is."""
    planted = evidence.ablation.planted
    better = [p.cleaned.median_error < p.uncleaned.median_error for p in planted]
    cleaned, uncleaned = evidence.ablation.steps[:2]
    return {
        "planted": [{"kind": p.kind, "cleaned": p.cleaned, "uncleaned": p.uncleaned} for p in planted],
        "cleaned": cleaned,
        "uncleaned": uncleaned,
        "is_always_better": all(better),
        "is_ever_better": any(better),
    }


@FACTS.declare
def speeds(evidence: SupportVectorEvidence) -> Facts:
    """Errors of predictions at other speeds."""
    names = list(evidence.speeds[0].errors)
    by_name = {name: [s.errors[name] for s in evidence.speeds] for name in names}
    return {
        "names": names,
        "factors": [s.factor for s in evidence.speeds],
        "growth": max(max(errors) / min(errors) for errors in by_name.values()),
        "by_craft": [{"name": name, "least": min(errors), "largest": max(errors)} for name, errors in by_name.items()],
        "rows": [
            (s.factor, s.speed, *(100.0 * s.errors[n] for n in names), *(s.cc[n] for n in names))
            for s in evidence.speeds
        ],
    }


@FACTS.declare
def own_numbers(evidence: SupportVectorEvidence) -> Facts:
    """What the checks look at."""
    reproduction, signs = evidence.reproduction, evidence.audit.sign_checks
    best = min(reproduction.errors_over_bound, key=lambda name: reproduction.errors_over_bound[name])
    confirming = [check.confirms_misprints for check in signs]
    return {
        "central": _named(reproduction.noise_free_results, "central differences, least squares").largest_error,
        "within_one_percent": int(np.sum(np.abs(reproduction.output_error_noisy.errors) <= 0.01)),
        "best": best,
        "gain": reproduction.errors_over_bound[best],
        "pipeline_ratio": reproduction.published[3].median_error / reproduction.output_error_noisy.median_error,
        "confirming": sum(confirming),
        "all_confirm": all(confirming),
        "choices": len(signs),
    }


@FACTS.declare
def coefficients(evidence: SupportVectorEvidence) -> Facts:
    """Table 2: printed columns digit by digit beside ours."""
    reproduction = evidence.reproduction
    true = [f"{value:.5f}" for value in true_coefficients()]
    columns = (row.values.tolist() for row in (*reproduction.published[:2], reproduction.output_error_noisy))
    bias = (" / ".join(f"{row.bias.get(e, 0.0):.1e}" for e in MotionEquation) for row in reproduction.published[:2])
    return {
        "rows": [
            *zip(COEFFICIENTS, true, TABLE_2[ORIGINAL], TABLE_2[IMPROVED], *columns, strict=True),
            ("bias b, u / v / r", "-", "not printed", "not printed", *bias, "-"),
        ],
        "zeros": int(np.sum(reproduction.unscaled.values == 0.0)),
        "count": len(COEFFICIENTS),
    }


@FACTS.declare
def errors(evidence: SupportVectorEvidence) -> Facts:
    """Errors of every column, per cent of the truth."""
    reproduction = evidence.reproduction
    estimates = (*reproduction.published, reproduction.output_error_noise_free, reproduction.output_error_noisy)
    columns = [_printed_errors(ORIGINAL), _printed_errors(IMPROVED), *(result.errors for result in estimates)]
    medians = (100.0 * float(np.median(np.abs(column))) for column in columns)
    rows = zip(COEFFICIENTS, *((100.0 * column).tolist() for column in columns), strict=True)
    return {"rows": [*rows, ("median of magnitudes", *medians)]}


def _median_and_largest(result: EstimatorResult) -> tuple[float, float]:
    return 100.0 * result.median_error, 100.0 * result.largest_error


def _estimators(evidence: SupportVectorEvidence) -> list[tuple[str, EstimatorResult, EstimatorResult]]:
    reproduction = evidence.reproduction
    pairs = zip(reproduction.noise_free_results, reproduction.noisy_results, strict=True)
    output_error = ("output error", reproduction.output_error_noise_free, reproduction.output_error_noisy)
    return [*((clean.name, clean, noisy) for clean, noisy in pairs), output_error]


@FACTS.declare
def estimators(evidence: SupportVectorEvidence) -> Facts:
    """Every estimator on both series."""
    return {
        "rows": [
            (name, *_median_and_largest(clean), *_median_and_largest(noisy), clean.note or noisy.note)
            for name, clean, noisy in _estimators(evidence)
        ]
    }


@FACTS.declare
def tube_and_penalty(evidence: SupportVectorEvidence) -> Facts:
    """Support vectors by penalty and tube beside the columns of table 2."""
    reproduction = evidence.reproduction
    rows: list[tuple[str | float, ...]] = [
        (
            "original, unscaled",
            *_median_and_largest(reproduction.unscaled),
            reproduction.unscaled.wrong_signs,
            "",
            "",
            _codes(reproduction.unscaled),
        )
    ]
    for s in reproduction.settings:
        name = f"{s.column}, {s.result.name}{' (nearest)' if s is reproduction.nearest(s.column) else ''}"
        distances = 100.0 * s.median_distance, 100.0 * s.largest_distance
        rows.append((name, *_median_and_largest(s.result), s.result.wrong_signs, *distances, _codes(s.result)))
    return {"rows": rows}


def _codes(result: EstimatorResult) -> str:
    return "; ".join(finding.code for finding in result.findings)


@FACTS.declare
def quasi_differences(evidence: SupportVectorEvidence) -> Facts:
    """Median errors by rho of eq. (17)."""
    sweep = evidence.reproduction.quasi_difference_sweep
    medians = (100.0 * sweep.medians["least squares"]).tolist()
    return {"rows": list(zip(sweep.levels, medians, strict=True))}


@FACTS.declare
def velocity_noise(evidence: SupportVectorEvidence) -> Facts:
    """Median errors of each derivative by the noise of the velocities."""
    sweep = evidence.reproduction.noise_sweep
    medians = ((100.0 * errors).tolist() for errors in sweep.medians.values())
    return {"rows": list(zip(sweep.levels, *medians, strict=True))}


@FACTS.declare
def condition_numbers(evidence: SupportVectorEvidence) -> Facts:
    """Table 3 under either labelling, beside ours."""
    table = evidence.audit.table_3_conditions
    return {
        "rows": [
            (
                EQUATION_NAMES[e],
                f"{TABLE_3[e]}",
                f"{table.labels_exchanged[e]}",
                table.plain[e],
                table.improved[e],
            )
            for e in MotionEquation
        ]
    }


@FACTS.declare
def accuracy(evidence: SupportVectorEvidence) -> Facts:
    """Table 4: the paper's column and ours on the truth's nozzle history."""
    rows = []
    for run, printed in TABLE_4.items():
        pair = (evidence.comparison(IMPROVED, run).replayed_accuracy, evidence.own_comparison(run).replayed_accuracy)
        for c in CHANNELS:
            rmse, cc = ([getattr(a, key)[c] if a else None for a in pair] for key in ("rmse", "cc"))
            rows.append((f"{run}, {c}", f"{printed.rmse[c]:.4f}", *rmse, f"{printed.cc[c]:.4f}", *cc))
    return {"rows": rows}


@FACTS.declare
def misprints(evidence: SupportVectorEvidence) -> Facts:
    """What the print does where it cannot be meant."""
    audit = evidence.audit
    worst = {fit.variant: max(fit.errors.items(), key=lambda item: abs(item[1])) for fit in audit.equation_14_fits}
    zigzag = PublishedManoeuvre.ZIGZAG_35
    (cell,) = [i for i in audit.table_4_implications if i.run is zigzag and i.channel == "r"]
    fresh, salt = audit.table_1_masses
    return {
        "divergence": [{"run": run, "seconds": s} for run, s in audit.undamped_sway.divergence_times.items()],
        "readings": {variant[0]: error for variant, error in worst.items() if "corrected" not in variant},
        "cell": cell,
        "has_amplitude": not math.isnan(cell.amplitude_ratio),
        "fresh": fresh,
        "salt": salt,
        "confirming": sum(check.confirms_misprints for check in audit.sign_checks),
        "choices": len(audit.sign_checks),
    }


@FACTS.declare
def cleaning_steps(evidence: SupportVectorEvidence) -> Facts:
    """What each step of the cleaning takes."""
    return {"rows": list(zip(*evidence.reproduction.cleaning, strict=True))}


@FACTS.declare
def chain(evidence: SupportVectorEvidence) -> Facts:
    """The chain as a user runs it: what Lasso takes out, what is kept, scores on the rows kept for testing."""
    labels = ("original, noise-free", "improved, noise-free", "original, sensor noise", "improved, sensor noise")
    rows = []
    for label, result in zip(labels, evidence.reproduction.published, strict=True):
        zero = [n for n, v in zip(evidence.indirect_sensitivity.names, result.values, strict=True) if v == 0.0]
        dropped = [*zero, *(n for n in DROPPED_COEFFICIENTS if n not in result.candidates)]
        kept = [f"{n} {v:.3g}" for n, v in result.candidates.items()]
        scores = " / ".join(f"{result.test[e].explained:.3g}" if e in result.test else "-" for e in "uvr")
        rows.append((label, _listed(dropped), _listed(kept), scores, 100.0 * result.median_error))
    return {"rows": rows}


@FACTS.declare
def steps(evidence: SupportVectorEvidence) -> Facts:
    """The improved pipeline with each step left out."""
    return {"rows": [(r.name, *_median_and_largest(r), r.note) for r in evidence.ablation.steps]}


@FACTS.declare
def planted_rows(evidence: SupportVectorEvidence) -> Facts:
    """Errors with bad data planted, cleaned and not."""
    rows = [(p.kind, p.spoiled, *_planted(p.cleaned), *_planted(p.uncleaned)) for p in evidence.ablation.planted]
    return {"rows": rows}


def _planted(result: EstimatorResult) -> tuple[float | str, float | str]:
    return (result.note, "") if result.note else _median_and_largest(result)


@FACTS.declare
def controllers(evidence: SupportVectorEvidence) -> Facts:
    """What controllers cost that are tuned on each method's coefficients."""
    return {"rows": controller_rows({"30° to starboard": evidence.controllers})}


def _bars(labels: Sequence[str], series: Mapping[str, Array]) -> Facts:
    return {"labels": labels, "series": {name: tuple(map(float, sizes)) for name, sizes in series.items()}}


@FACTS.declare
def error_bars(evidence: SupportVectorEvidence) -> Facts:
    """Errors of the coefficients, printed and ours, per cent."""
    reproduction = evidence.reproduction
    by_name = {
        "paper, original SVR": _printed_errors(ORIGINAL),
        "paper, improved SVR": _printed_errors(IMPROVED),
        "ours, original": reproduction.published[0].errors,
        "ours, improved": reproduction.published[1].errors,
        "output error, sensor noise": reproduction.output_error_noisy.errors,
    }
    return _bars(COEFFICIENTS, {name: 100.0 * np.abs(each) for name, each in by_name.items()})


@FACTS.declare
def estimator_bars(evidence: SupportVectorEvidence) -> Facts:
    """Median error of every estimator on both series, per cent."""
    names, clean, noisy = zip(*_estimators(evidence), strict=True)
    series = {"noise-free": clean, "sensor noise": noisy}
    return _bars(names, {name: 100.0 * np.array([r.median_error for r in group]) for name, group in series.items()})


@FACTS.declare
def noise_bars(evidence: SupportVectorEvidence) -> Facts:
    """Median errors of each derivative by the noise of the velocities, per cent."""
    sweep = evidence.reproduction.noise_sweep
    levels = [f"{level:g} m/s" for level in sweep.levels]
    return _bars(levels, {name: 100.0 * errors for name, errors in sweep.medians.items()})


@FACTS.declare
def sensitivity_bars(evidence: SupportVectorEvidence) -> Facts:
    """Sensitivity of each coefficient by state, and in all."""
    alone = evidence.indirect_sensitivity
    return _bars(alone.names, {**dict(zip(alone.states, alone.matrix.T, strict=True)), "total": alone.total})


@FACTS.declare
def unique_bars(evidence: SupportVectorEvidence) -> Facts:
    """What is left of each sensitivity when the other coefficients may change."""
    unique = evidence.unique_sensitivity
    return _bars(unique.names, {"alone": unique.total, "left": unique.unique})


@FACTS.declare
def correlations(evidence: SupportVectorEvidence) -> list[Facts]:
    """Correlation of the features of each equation."""
    return [
        {"equation": EQUATION_NAMES[e], "names": EQUATION_COEFFICIENTS[e], "values": matrix}
        for e, matrix in evidence.audit.table_3_conditions.correlations.items()
    ]


@FACTS.declare
def runs(evidence: SupportVectorEvidence) -> list[Facts]:
    """Motions, forces, tracks, headings and nozzle angles of the three runs."""
    return [
        group
        for run in FIGURE_NUMBERS
        for group in (*_motions(evidence, run), *_forces(evidence, run), *_steered(evidence, run))
    ]


def _motions(evidence: SupportVectorEvidence, run: PublishedManoeuvre) -> list[Facts]:
    outcome = evidence.comparison(IMPROVED, run)
    records = {_TRUE: outcome.reference, _PAPER: outcome.replayed, _OWN: evidence.own_comparison(run).replayed}
    if run is PublishedManoeuvre.ZIGZAG_20:
        records["original column, N_v corrected"] = evidence.comparison(ORIGINAL, run).replayed
    return [_over_time(run, c, {name: (r.time, r[c]) for name, r in records.items()}) for c in CHANNELS]


def _forces(evidence: SupportVectorEvidence, run: PublishedManoeuvre) -> list[Facts]:
    outcome, own_run = evidence.comparison(IMPROVED, run), evidence.own_comparison(run)
    time = outcome.reference.time
    by_craft = {
        _TRUE: hull_and_jet_forces(TRUTH.craft(), outcome.reference),
        _PAPER: hull_and_jet_forces(outcome.craft, outcome.replayed),
        _OWN: hull_and_jet_forces(own_run.craft, own_run.replayed),
    }
    return [
        _over_time(run, letter, {n: (time, forces[letter]) for n, forces in by_craft.items()})
        for letter in by_craft[_TRUE]
    ]


def _over_time(run: PublishedManoeuvre, letter: str, curves: Mapping[str, tuple[Array, Array]]) -> Facts:
    return {
        "title": f"Figures {FIGURE_NUMBERS[run]}: {run}, {letter}",
        "x_label": "time [s]",
        "y_label": f"{letter} [{UNITS[letter]}]",
        "curves": [_curve(name, *points) for name, points in curves.items()],
        "is_steered": False,
        "is_turn": False,
    }


def _steered(evidence: SupportVectorEvidence, run: PublishedManoeuvre) -> list[Facts]:
    """Track, heading and nozzle with the helmsman in the loop, as figures b and c compare them."""
    outcome, number = evidence.comparison(IMPROVED, run), FIGURE_NUMBERS[run].split(",")[0]
    steered = {_PAPER: outcome.steered.record, _OWN: evidence.own_comparison(run).steered.record}
    records = {_TRUE: outcome.reference, **{name: r for name, r in steered.items() if r is not None}}
    labels = {
        f"Figure {number}b: {run}, track": ("y0 [m]", "x0 [m]", _track),
        f"Figure {number}c: {run}, heading": ("time [s]", "heading [°]", lambda r: (r.time, np.degrees(r["psi"]))),
        f"Figure {number}c: {run}, nozzle": ("time [s]", "nozzle [°]", lambda r: (r.time, np.degrees(r["delta"]))),
    }
    return [
        {
            "title": title,
            "x_label": x_label,
            "y_label": y_label,
            "curves": [_curve(name, *points(record)) for name, record in records.items()],
            "is_map": points is _track,
            "is_steered": True,
            "is_turn": run is PublishedManoeuvre.TURN_35,
        }
        for title, (x_label, y_label, points) in labels.items()
    ]


def _track(record: Record) -> tuple[Array, Array]:
    return record["y0"], record["x0"]


def _curve(name: str, x: Array, y: Array) -> Curve:
    count = min(len(x), len(y))
    step = max(1, len(x) // _POINTS)
    return Curve(name, x[:count:step], y[:count:step])
