"""The published steps on our own series: cleaning, Lasso, support vectors; where their errors come from; ours."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import RowScore
from seatrial.core.values import Array, Finding, InputError, Record
from seatrial.data.example_series import JET_VELOCITY, SENSOR_NOISE, SLEW_RATE, with_sensor_noise
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate import Runs, estimate_model
from seatrial.estimation.regress import (
    Central,
    Centred,
    Cleaning,
    Differenced,
    Euler,
    Lasso,
    LinearRegression,
    OrdinaryLeastSquares,
    Pipeline,
    RegressionEstimate,
    RegressionEstimator,
    RegressionMotion,
    RegressionSystem,
    SupportVectors,
    Weak,
    ablations,
    blocks,
    build_systems,
    shuffled_split,
    standard_estimators,
)
from seatrial.physics.manoeuvres import programme
from seatrial.physics.models import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import waterjet, with_candidate_terms
from seatrial.physics.simulate import forces, manoeuvre
from seatrial_studies.song2025.published import (
    TRUTH,
    MotionEquation,
    PublishedManoeuvre,
    Table2Column,
    printed_coefficients,
    reference_record,
)
from seatrial_studies.study_file import study_setting

# Lasso on the regressors as section 1.3.1 prints them: raw products of u, v, r on the forces X_H, Y_H, N_H.

_TERMS = {
    MotionEquation.SURGE: ("X_uu", "X_vv", "X_rr"),
    MotionEquation.SWAY: ("Y_v", "Y_r", "Y_vv", "Y_vr", "Y_rr"),
    MotionEquation.YAW: ("N_v", "N_r", "N_rr", "N_vvr", "N_vrr"),
}
_FORCES = {MotionEquation.SURGE: "X_H", MotionEquation.SWAY: "Y_H", MotionEquation.YAW: "N_H"}


def printed_systems(record: Record) -> tuple[RegressionSystem, ...]:
    """Return X_H, Y_H, N_H against [u², v², r²], [v, r, v|v|, |v|r, r|r|] and [v, r, r|r|, v²r, vr²].

    None of the products has the speed U of eq. (14) beside it.
    """
    u, v, r = (record[c] for c in "uvr")
    columns: dict[MotionEquation, tuple[Array, ...]] = {
        MotionEquation.SURGE: (u**2, v**2, r**2),
        MotionEquation.SWAY: (v, r, v * np.abs(v), np.abs(v) * r, r * np.abs(r)),
        MotionEquation.YAW: (v, r, r * np.abs(r), v**2 * r, v * r**2),
    }
    hull = forces(with_candidate_terms(TRUTH.craft()), record)
    return tuple(
        RegressionSystem((equation,), _TERMS[equation], np.stack(columns[equation], axis=1), hull[_FORCES[equation]])
        for equation in MotionEquation
    )


def lasso_choice(record: Record, *, is_scaled: bool) -> tuple[tuple[str, ...], tuple[str, ...], dict[str, float]]:
    """Return the terms kept, those taken out, and the penalty by equation."""
    kept, dropped, penalties = list[str](), list[str](), dict[str, float]()
    for system in printed_systems(record):
        solved = Lasso(is_scaled=is_scaled).solve(system)
        penalties[system.title] = solved.settings["penalty"]
        for name, value in zip(system.names, solved.coefficients, strict=True):
            (kept if value != 0.0 else dropped).append(name)
    return tuple(kept), tuple(dropped), penalties


WINDOW_S = study_setting("song2025", "window_s", float).value
NOISE_SERIES = study_setting("song2025", "noise_series", int).value
TUBE_WIDTHS, SVR_PENALTIES = (study_setting("song2025", name, list) for name in ("tube_widths", "penalties"))
VELOCITY_NOISE = study_setting("song2025", "velocity_noise", list)
QUASI_DIFFERENCES = study_setting("song2025", "quasi_differences", list).value
YAW_LENGTH = 9.8  # m: noise in r is that in u and v over one ship length


@dataclass(frozen=True, eq=False)
class EstimatorResult:
    """What one way of doing it finds; errors relative to the truth, shape (11,); NaN and a note where it fails.

    Attributes:
        candidates: coefficients kept beyond the eleven; test: equation -> score on the rows kept for testing.
    """

    name: str
    values: Array
    errors: Array
    bias: dict[str, float]
    findings: tuple[Finding, ...] = ()
    note: str = ""
    candidates: dict[str, float] = field(default_factory=dict)
    test: dict[str, RowScore] = field(default_factory=dict)

    @property
    def craft(self) -> Model:
        """Return the craft with these coefficients, those kept beyond the eleven included."""
        return RegressionEstimate(self.values, candidates=self.candidates).in_model(craft_without_coefficients())

    @property
    def median_error(self) -> float:
        """Return the median of the relative errors' magnitudes."""
        return float(np.median(np.abs(self.errors)))

    @property
    def largest_error(self) -> float:
        """Return the largest of the relative errors' magnitudes."""
        return float(np.max(np.abs(self.errors)))

    @property
    def wrong_signs(self) -> int:
        """Return how many coefficients have the other sign than the truth."""
        return int(np.sum(self.values * true_coefficients() < 0.0))


@dataclass(frozen=True, eq=False)
class LassoSelection:
    """Coefficients that Lasso keeps of the thirteen, its penalties by equation, and what setting it is."""

    setting: str
    kept: tuple[str, ...]
    dropped: tuple[str, ...]
    penalties: dict[str, float]


@dataclass(frozen=True, eq=False)
class SupportVectorSetting:
    """Support vectors with a penalty C and a tube, noise-free, beside a column of table 2.

    Attributes:
        distances: magnitudes of ours less the printed ones, over the truth, (11,).
    """

    C: float
    tube: float
    column: Table2Column
    result: EstimatorResult
    distances: Array

    @property
    def distance(self) -> float:
        """Return the root mean square of the distances."""
        return float(np.sqrt(np.mean(self.distances**2)))

    @property
    def median_distance(self) -> float:
        """Return the median of the distances' magnitudes."""
        return float(np.median(np.abs(self.distances)))

    @property
    def largest_distance(self) -> float:
        """Return the largest of the distances' magnitudes."""
        return float(np.max(np.abs(self.distances)))


@dataclass(frozen=True, eq=False)
class SplitLeakage:
    """Error of the yaw rate copied from the nearest training sample, over its standard deviation."""

    shuffled_error: float
    block_error: float


@dataclass(frozen=True, eq=False)
class ErrorSweep:
    """Median error of several regressions, each (levels,), against one setting."""

    levels: tuple[float, ...]
    medians: dict[str, Array]


@dataclass(frozen=True, eq=False)
class SupportVectorReproduction:
    """Everything computed with regressions and fits.

    Attributes:
        series, measured: the consecutive zigzags noise-free and with the sensors' noise.
        cleaning: what its steps report, noise-free and measured.
        unscaled: support vectors on the numbers without scaling.
        noise_free_results, noisy_results: every regression on either series.
        settings: both pipelines by penalty and tube, beside the columns of table 2.
        quasi_difference_sweep: quasi-differences of eq. (17), noise-free.
        noise_sweep: white noise of the velocities.
        output_error_noise_free: output error without noise, same discretisation as the model's.
        output_error_noisy: output error with the sensors' noise.
        output_error_ratio: rms of output error's errors over their standard errors.
        errors_over_bound: the nearer regressions' rms errors over several series of noise, over output error's
            standard errors: medians of the coefficients.
    """

    series: Record
    measured: Record
    cleaning: tuple[tuple[str, ...], tuple[str, ...]]
    selections: tuple[LassoSelection, ...]
    unscaled: EstimatorResult
    noise_free_results: tuple[EstimatorResult, ...]
    noisy_results: tuple[EstimatorResult, ...]
    settings: tuple[SupportVectorSetting, ...]
    quasi_difference_sweep: ErrorSweep
    noise_sweep: ErrorSweep
    split_leakage: SplitLeakage
    output_error_noise_free: EstimatorResult
    output_error_noisy: EstimatorResult
    output_error_ratio: float
    errors_over_bound: dict[str, float]

    def nearest(self, column: Table2Column) -> SupportVectorSetting:
        """Return the setting of the support vectors that comes nearest to a column of table 2."""
        return min((s for s in self.settings if s.column is column), key=lambda s: s.distance)

    @property
    def published(self) -> tuple[EstimatorResult, EstimatorResult, EstimatorResult, EstimatorResult]:
        """Original and improved pipeline, noise-free, then with sensor noise."""
        original, improved, noisy_original, noisy_improved = (
            row
            for rows in (self.noise_free_results, self.noisy_results)
            for row in rows
            if row.name.startswith("published")
        )
        return original, improved, noisy_original, noisy_improved


def reproduce_regressions(
    *, quick: bool, seed: int, report_progress: Callable[[str], None] | None
) -> SupportVectorReproduction:
    """Run all regressions; `quick` leaves out the slow settings of the support vectors and most noise levels."""
    report = report_progress or (lambda _: None)
    report("the series")
    clean = reference_record(PublishedManoeuvre.CONSECUTIVE)
    measured = with_sensor_noise(clean, np.random.default_rng(seed), seed)
    report("regressions")
    improved = Pipeline()
    unscaled = Pipeline(name="unscaled", operator=Euler(), solver=SupportVectors(is_standardised=False))
    of_clean = tuple(estimator_result(e, clean) for e in standard_estimators(WINDOW_S))
    of_noisy = tuple(estimator_result(e, measured) for e in standard_estimators(WINDOW_S))
    report("where the errors come from")
    settings = tuple(
        _beside_print(pipeline, column, c, t, clean)
        for pipeline, column in (
            (replace(improved, operator=Euler()), Table2Column.ORIGINAL), (improved, Table2Column.IMPROVED)
        )
        for c in SVR_PENALTIES.in_version(quick=quick)
        for t in TUBE_WIDTHS.in_version(quick=quick)
    )  # fmt: skip
    differences = _sweep(QUASI_DIFFERENCES, lambda rho: (clean, _least_squares(Differenced(Euler(), rho))))
    report("noise")
    noise = _noise_sweep(clean, VELOCITY_NOISE.in_version(quick=quick), seed)
    report("output error")
    exact, ours, errors = _output_error(measured)
    ratio = float(np.sqrt(np.mean((ours.errors / errors) ** 2)))
    return SupportVectorReproduction(
        clean,
        measured,
        (_cleaning_steps(clean), _cleaning_steps(measured)),
        _lasso_selections(clean, measured),
        estimator_result(unscaled, clean),
        of_clean,
        of_noisy,
        settings,
        differences,
        noise,
        _split_leakage(clean, seed),
        exact,
        ours,
        ratio,
        _errors_over_bound(clean, errors, seed),
    )


def _beside_print(
    pipeline: Pipeline, column: Table2Column, C: float, tube: float, clean: Record
) -> SupportVectorSetting:
    """One setting of the support vectors, compared with the print in magnitude: its signs are misprinted."""
    result = estimator_result(
        replace(pipeline, name=f"C = {C:g}, tube {tube:g}", solver=SupportVectors(C, tube)), clean
    )
    printed = np.abs(list(printed_coefficients(column).values()))
    return SupportVectorSetting(
        C, tube, column, result, (np.abs(result.values) - printed) / np.abs(true_coefficients())
    )


def true_coefficients() -> Array:
    """Return the eleven true coefficients."""
    return np.array([p.value for p in TRUTH.craft().parameters.free])


def craft_without_coefficients() -> Model:
    """Return the craft whose coefficients are not known."""
    return TRUTH.craft().with_values(dict.fromkeys(COEFFICIENTS, 0.0))


def estimator_result(estimator: RegressionEstimator, record: Record) -> EstimatorResult:
    """Run one estimator on one record."""
    try:
        found = estimator.estimate(craft_without_coefficients(), [record])
    except InputError as error:
        none = np.full(len(COEFFICIENTS), np.nan)
        return EstimatorResult(estimator.name, none, none, {}, (), str(error))
    return _relative_result(estimator.name, found)


def _relative_result(name: str, regressed: RegressionEstimate) -> EstimatorResult:
    return EstimatorResult(
        name, regressed.values, regressed.values / true_coefficients() - 1.0, regressed.bias, regressed.findings,
        candidates=regressed.candidates, test=regressed.test,
    )  # fmt: skip


def _least_squares(operator: Euler | Central | Weak | Differenced | Centred) -> LinearRegression:
    return LinearRegression("least squares", operator, OrdinaryLeastSquares())


def _sweep(levels: Sequence[float], case: Callable[[float], tuple[Record, LinearRegression]]) -> ErrorSweep:
    rows = [estimator_result(estimator, record) for record, estimator in map(case, levels)]
    return ErrorSweep(tuple(levels), {"least squares": np.array([r.median_error for r in rows])})


def _noise_sweep(clean: Record, levels: Sequence[float], seed: int) -> ErrorSweep:
    operators = {
        "Euler": Euler(), "Euler, differenced": Differenced(Euler()), "central": Central(), "weak form": Weak(WINDOW_S)
    }  # fmt: skip
    medians: dict[str, list[float]] = {name: [] for name in operators}
    for level in levels:
        record = _with_noise(clean, level, np.random.default_rng(seed))
        for name, operator in operators.items():
            medians[name].append(estimator_result(_least_squares(operator), record).median_error)
    return ErrorSweep(tuple(levels), {name: np.array(values) for name, values in medians.items()})


def _with_noise(record: Record, level: float, generator: np.random.Generator) -> Record:
    channels = dict(record.channels)
    for symbol, deviation in (("u", level), ("v", level), ("r", level / YAW_LENGTH)):
        channel = record.channel(symbol)
        channels[symbol] = channel.with_values(channel.values + deviation * generator.standard_normal(len(record)))
    return replace(record, channels=channels)


def _lasso_selections(clean: Record, measured: Record) -> tuple[LassoSelection, ...]:
    cases = (
        ("noise-free, Euler (as published)", clean, Euler()),
        ("noise-free, central differences", clean, Central()),
        ("sensor noise, Euler (as published)", measured, Euler()),
        ("sensor noise, weak form", measured, Weak(WINDOW_S)),
    )
    printed = (
        LassoSelection(f"noise-free, printed regressors on forces, {words}", *lasso_choice(clean, is_scaled=is_scaled))
        for words, is_scaled in (("scaled", True), ("as they come", False))
    )
    return (*(_lasso_selection(*case) for case in cases), *printed)


def _lasso_selection(setting: str, record: Record, operator: Euler | Central | Weak) -> LassoSelection:
    craft = with_candidate_terms(waterjet())
    train = blocks(Cleaning().clean(craft, record), 0.8)[0] if not isinstance(operator, Weak) else record
    kept, dropped, penalties = list[str](), list[str](), {}
    for system in build_systems(craft, [RegressionMotion.from_record(craft, train)], operator):
        solved = Lasso().solve(system)
        penalties[system.title] = solved.settings["penalty"]
        for name, value in zip(system.names, solved.coefficients, strict=True):
            (kept if value != 0.0 else dropped).append(name)
    return LassoSelection(setting, tuple(kept), tuple(dropped), penalties)


def _cleaning_steps(record: Record) -> tuple[str, ...]:
    return tuple(s for s in Cleaning().clean(TRUTH.craft(), record).provenance.steps if "left out" in s)


def _split_leakage(record: Record, seed: int) -> SplitLeakage:
    """The last of eq. (9)'s training samples before, or the nearest of those drawn."""
    train, test = blocks(record, 0.8)
    drawn, left = shuffled_split(len(record), 0.8, np.random.default_rng(seed))
    nearest = drawn[np.abs(drawn[:, None] - left[None, ::20]).argmin(axis=0)]
    size = float(np.std(record["r"]))
    copied = float(np.sqrt(np.mean((record["r"][left[::20]] - record["r"][nearest]) ** 2)))
    held = float(np.sqrt(np.mean((test["r"] - train["r"][-1]) ** 2)))
    return SplitLeakage(copied / size, held / size)


def _errors_over_bound(clean: Record, errors: Array, seed: int) -> dict[str, float]:
    near = [e for e in standard_estimators(WINDOW_S) if e.name.startswith(("weak", "smoothed"))]
    streams = np.random.SeedSequence(seed).spawn(NOISE_SERIES)
    records = [with_sensor_noise(clean, np.random.default_rng(stream), seed) for stream in streams]
    rms = {e.name: np.sqrt(np.mean([estimator_result(e, r).errors ** 2 for r in records], axis=0)) for e in near}
    return {name: float(np.median(values / errors)) for name, values in rms.items()}


def _output_error(measured: Record) -> tuple[EstimatorResult, EstimatorResult, Array]:
    """Output error without noise and with it, and its relative standard errors (11,)."""
    length = TRUTH.craft().parameters["L"].value
    own = manoeuvre(
        TRUTH.craft(), programme(PublishedManoeuvre.CONSECUTIVE), inputs={"v_j": JET_VELOCITY}, slew_rate=SLEW_RATE
    )
    blank = craft_without_coefficients()
    known = EstimateSettings().with_known_timing(blank.input_names)  # simulated records, inputs as they ran
    exact = estimate_model(blank, Runs.one_session_each([own], length), known)
    noisy = replace(Runs.one_session_each([measured], length), noise=dict(SENSOR_NOISE))
    found = estimate_model(blank, noisy, known)
    count = len(COEFFICIENTS)
    errors = found.interval.standard_error[:count] / np.abs(true_coefficients())
    rows = [RegressionEstimate(f.estimate.common_parameters[:count]) for f in (exact, found)]
    return (
        _relative_result("output error, noise-free", rows[0]),
        _relative_result("output error, sensor noise", rows[1]),
        errors,
    )


# Conclusion 2: what each step of the pipeline is worth, on the simulated series and on one with planted bad data.

BAD_SHARE, SPIKE = study_setting("song2025", "bad_share", float).value, study_setting("song2025", "spike", float).value
VELOCITIES = ("u", "v", "r")


@dataclass(frozen=True, eq=False)
class PlantedResult:
    """The improved pipeline on a series with one kind of bad data: with all its steps, and without cleaning."""

    kind: str
    spoiled: int
    cleaned: EstimatorResult
    uncleaned: EstimatorResult


@dataclass(frozen=True, eq=False)
class CleaningAblation:
    """Attributes:
    steps: the improved pipeline and each step left out, on the series as it is.
    planted: with bad data planted, one kind at a time and all together.
    """

    steps: tuple[EstimatorResult, ...]
    planted: tuple[PlantedResult, ...]


def cleaning_ablation(series: Record, *, quick: bool, seed: int) -> CleaningAblation:
    """Run the pipeline without each step, then on planted outliers, dropouts and duplicates."""
    improved = Pipeline()
    without_cleaning = ablations(improved)[0]
    spoiled = {
        "outliers": with_outliers(series, np.random.default_rng([seed, 1])),
        "dropouts": with_dropouts(series, np.random.default_rng([seed, 2])),
        "duplicates": with_duplicates(series, np.random.default_rng([seed, 3])),
    }
    planted = tuple(
        PlantedResult(
            kind, round(BAD_SHARE * len(series)), estimator_result(improved, record),
            estimator_result(without_cleaning, record),
        )
        for kind, record in list(spoiled.items())[: 1 if quick else None]
    )  # fmt: skip
    steps = (improved, *ablations(improved))
    return CleaningAblation(tuple(estimator_result(step, series) for step in steps[: 2 if quick else None]), planted)


def with_outliers(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with spikes of ten standard deviations in u, v and r, at the same samples."""
    rows, signs = _rows(record, generator), generator.choice([-1.0, 1.0], len(VELOCITIES))

    def spiked(values: Array, sign: float) -> Array:
        out = values.copy()
        out[rows] += sign * SPIKE * float(np.std(values))
        return out

    changed = {c: spiked(record[c], sign) for c, sign in zip(VELOCITIES, signs, strict=True)}
    return _with_values(record, changed)


def with_dropouts(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with samples in which u, v and r read zero, as a sensor that drops out does."""
    rows = _rows(record, generator)
    changed = {c: np.where(np.isin(np.arange(len(record)), rows), 0.0, record[c]) for c in VELOCITIES}
    return _with_values(record, changed)


def with_duplicates(record: Record, generator: np.random.Generator) -> Record:
    """Return the record with samples that repeat the one before in every channel, as a frozen logger does."""
    source = np.arange(len(record))
    rows = np.sort(_rows(record, generator))
    source[rows] = rows - 1
    return _with_values(record, {c: channel.values[source] for c, channel in record.channels.items()})


def _rows(record: Record, generator: np.random.Generator) -> np.ndarray:
    return 1 + generator.choice(len(record) - 2, round(BAD_SHARE * len(record)), replace=False)


def _with_values(record: Record, values: dict[str, Array]) -> Record:
    channels = {c: record.channel(c).with_values(v) for c, v in values.items()}
    return replace(record, channels={**record.channels, **channels})
