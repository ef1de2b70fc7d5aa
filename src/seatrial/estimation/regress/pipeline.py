"""The pipeline of Song et al. 2025 as one estimator, and the standard regressions by name, those of others too."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from seatrial._plugins import failure_text, installed, load_plugin
from seatrial.core.equations import Model
from seatrial.core.results.prediction import RowScore
from seatrial.core.values import Array, Finding, InputError, Record, Severity, spelling_hint
from seatrial.data.trial.settings import EstimateMethod, SupportVectorSettings
from seatrial.estimation.regress.estimators import (
    InstrumentalVariables,
    Lasso,
    LeastSquaresSvm,
    LinearRegression,
    LinearSolver,
    OrdinaryLeastSquares,
    RegressionEstimate,
    RegressionEstimator,
    RegressionSolution,
    RegressionSystem,
    Ridge,
    SupportVectors,
    TruncatedSvd,
    assemble_systems,
    build_systems,
    solve_systems,
)
from seatrial.estimation.regress.operators import (
    Central,
    Centred,
    DerivativeOperator,
    Differenced,
    Euler,
    RegressionMotion,
    Smoothed,
    Weak,
)
from seatrial.estimation.regress.samples import (
    blocks,
    without_duplicates,
    without_missing,
    without_outliers,
    without_small,
)
from seatrial.physics.models.candidate_structures import with_candidate_terms

# The pipeline of Song et al. 2025 as one estimator: clean, split, select among candidates, regress, score the test.

# section 1.4: differenced and centred
DIFFERENCED_AND_CENTRED = Centred(Differenced(Euler()))
PUBLISHED, IMPROVED = "published pipeline (Song et al. 2025)", "published pipeline, improved (Song et al. 2025)"


@dataclass(frozen=True)
class Cleaning:
    """The four steps of section 1.2 over the model's states and inputs as far as the record holds them.

    Attributes:
        max_score: largest standard score that stays, eq. (5); constant channels have none; 0 keeps all.
        min_share: least absolute value that stays, eq. (8), of the states that are velocities, as a share of each one's
            standard deviation; 0 keeps all.
        drop_duplicates: whether repeated samples go, eq. (6).
    """

    max_score: float = 3.0
    min_share: float = 1e-3
    drop_duplicates: bool = True

    def clean(self, model: Model, record: Record) -> Record:
        """What is left of a record; samples without a value go in any case, eq. (7).

        Raises:
            InputError: nothing would be left.
        """
        held = [s for s in (*model.states, *model.input_names) if s in record]
        known = without_missing(record, held)
        moving = [s for s in _velocities(model) if s in known and float(known[s].std()) > 0.0]
        kept = without_outliers(known, self.max_score, moving) if self.max_score else known
        kept = without_duplicates(kept, held) if self.drop_duplicates else kept
        return without_small(kept, {s: self.min_share * float(known[s].std()) for s in moving}) if moving else kept


NO_CLEANING = Cleaning(0.0, 0.0, drop_duplicates=False)


@dataclass(frozen=True)
class Pipeline:
    """Cleaning, `training_share` of each record, Lasso's selection on Euler's rows, then an arithmetic on others.

    Attributes:
        selection: which coefficients stay; None keeps all.
        operator: rows that the coefficients are found from; the published improvement differences and centres them.
    """

    name: str = IMPROVED
    cleaning: Cleaning = field(default_factory=Cleaning)
    training_share: float = 0.8  # 80:20, Song et al. 2025
    selection: Lasso | None = field(default_factory=Lasso)
    operator: DerivativeOperator = DIFFERENCED_AND_CENTRED
    solver: LinearSolver = field(default_factory=SupportVectors)

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients; those that were not selected are zero.

        Raises:
            InputError: cleaning leaves nothing, or a training block is shorter than a manoeuvre.
        """
        wide = with_candidate_terms(model) if self.selection is not None else model
        pieces = [blocks(self.cleaning.clean(wide, record), self.training_share) for record in records]
        train, test = ([RegressionMotion.from_record(wide, p[k]) for p in pieces if len(p[k]) > 2] for k in (0, 1))
        findings: list[Finding] = []
        kept = dict[tuple[str, ...], tuple[str, ...]]()
        for system in build_systems(wide, train, Euler()):
            kept[system.equations], said = self._select_coefficients(system)
            findings += said
        found = solve_systems(wide, _selected(build_systems(wide, train, self.operator), kept), self.solver.solve)
        scores = _test_scores(wide, _selected(assemble_systems(wide, test, self.operator), kept), found)
        return _in_terms_of(model, wide, replace(found, findings=(*findings, *found.findings), test=scores))

    def _select_coefficients(self, system: RegressionSystem) -> tuple[tuple[str, ...], tuple[Finding, ...]]:
        if self.selection is None:
            return system.names, ()
        solved: RegressionSolution = self.selection.solve(system)
        return tuple(n for n, c in zip(system.names, solved.coefficients, strict=True) if c != 0.0), solved.findings


_PENALTIES = 49  # penalties of Lasso that are tried, evenly in decades: four to a decade of the default; chosen


def pipelines(settings: SupportVectorSettings) -> tuple[Pipeline, ...]:
    """Return the published pipeline, the improved one and, for an ablation, the latter with each step left out."""
    lowest, highest = settings.lambda_
    penalties = np.geomspace(lowest, highest, _PENALTIES)
    improved = Pipeline(
        cleaning=Cleaning(settings.outlier_score, settings.small_share),
        training_share=1.0 - settings.test_share,
        selection=Lasso(tuple(penalties.tolist()), folds=settings.folds),
        solver=SupportVectors(settings.C, settings.epsilon),
    )
    published = replace(improved, name=PUBLISHED, operator=Euler())
    return (published, improved, *(ablations(improved) if settings.ablation else ()))


def ablations(pipeline: Pipeline) -> tuple[Pipeline, ...]:
    """Return the improved pipeline without cleaning, without Lasso, without differences, without centring."""
    return (
        replace(pipeline, name="improved pipeline without cleaning", cleaning=NO_CLEANING),
        replace(pipeline, name="improved pipeline without Lasso", selection=None),
        replace(pipeline, name="improved pipeline without differences", operator=Centred(Euler())),
        replace(pipeline, name="improved pipeline without centring", operator=Differenced(Euler())),
    )


def _selected(
    systems: Sequence[RegressionSystem], kept: Mapping[tuple[str, ...], tuple[str, ...]]
) -> list[RegressionSystem]:
    return [s.restricted_to(kept[s.equations]) for s in systems if kept.get(s.equations)]


def _test_scores(
    model: Model, systems: Sequence[RegressionSystem], regression: RegressionEstimate
) -> dict[str, RowScore]:
    """Target and prediction of every equation on rows that were not fitted."""
    names = model.parameters.free_names
    scores = {}
    for system in systems:
        coefficients = regression.values[[names.index(n) for n in system.names]]
        scores[system.title] = row_score(system.target, system.matrix @ coefficients + regression.bias[system.title])
    return scores


def row_score(target: Array, predicted: Array) -> RowScore:
    """Return root mean square error, correlation and explained variance of predicted rows (n,)."""
    missed, spread = target - predicted, float(np.var(target))
    varies = spread > 0.0 and float(np.var(predicted)) > 0.0
    return RowScore(
        float(np.sqrt(np.mean(missed**2))),
        float(np.corrcoef(target, predicted)[0, 1]) if varies else float("nan"),
        1.0 - float(np.mean(missed**2)) / spread if spread > 0.0 else float("nan"),
        len(target),
    )


def _in_terms_of(model: Model, wide: Model, regression: RegressionEstimate) -> RegressionEstimate:
    """The estimate with the model's own coefficients, and those of kept terms that it does not have apart."""
    values = dict(zip(wide.parameters.free_names, regression.values.tolist(), strict=True))
    own = np.array([values.pop(n) for n in model.parameters.free_names])
    more = {n: v for n, v in values.items() if v != 0.0}
    return replace(regression, values=own, candidates=more, findings=(*regression.findings, *_candidate_findings(more)))


def _candidate_findings(coefficients: Mapping[str, float]) -> tuple[Finding, ...]:
    if not coefficients:
        return ()
    said = ", ".join(f"{name} = {value:.4g}" for name, value in coefficients.items())
    return (
        Finding(Severity.INFO, "candidate-kept", f"Lasso keeps terms that the model does not have: {said}"),
    )  # fmt: skip


def _velocities(model: Model) -> list[str]:
    """The states whose rates hold coefficients."""
    first = len(model.states) + len(model.inputs)
    free = {first + model.parameters.index(n) for n in model.parameters.free_names}
    holding = {int(state) for state, column in model.compiled.rates_pattern if int(column) in free}
    return [model.states[i] for i in sorted(holding)]


# The regressions that a comparison shows, by name.


def standard_estimators(half_width: float, svr: SupportVectorSettings | None = None) -> tuple[RegressionEstimator, ...]:
    """The estimators of a comparison; windows of that half width [s], the published pipeline with its settings."""
    settings = svr or SupportVectorSettings()
    support_vectors = SupportVectors(settings.C, settings.epsilon)
    least_squares = OrdinaryLeastSquares()
    return (
        LinearRegression("Euler differences, least squares", Euler(), least_squares),
        LinearRegression("Euler, differenced", Differenced(Euler()), least_squares),
        LinearRegression("Euler, differenced and centred", Centred(Differenced(Euler())), least_squares),
        LinearRegression("central differences, least squares", Central(), least_squares),
        LinearRegression("central differences, ridge", Central(), Ridge()),
        LinearRegression("central differences, truncated SVD", Central(), TruncatedSvd()),
        LinearRegression("central differences, Lasso", Central(), Lasso()),
        LinearRegression("central differences, least-squares SVM", Central(), LeastSquaresSvm()),
        LinearRegression("central differences, support vectors", Central(), support_vectors),
        LinearRegression("smoothed derivative, least squares", Smoothed(0.5 * half_width), least_squares),
        LinearRegression("weak form, least squares", Weak(half_width), least_squares),
        LinearRegression("weak form, ridge", Weak(half_width), Ridge()),
        *pipelines(settings),
        InstrumentalVariables("weak form, instrumental variables", Weak(half_width)),
    )


# Estimators by name: the standard regressions, and those that other packages install under ``seatrial.estimators``.

ENTRY_POINT_GROUP = "seatrial.estimators"
# what an entry point names: from the half width of a window [s] to an estimator
EstimatorFactory = Callable[[float], RegressionEstimator]
_NAMES: Mapping[EstimateMethod, str] = MappingProxyType({
    EstimateMethod.EULER: "Euler differences, least squares",
    EstimateMethod.EULER_DIFFERENCED: "Euler, differenced",
    EstimateMethod.EULER_CENTRED: "Euler, differenced and centred",
    EstimateMethod.OLS: "central differences, least squares",
    EstimateMethod.RIDGE: "central differences, ridge",
    EstimateMethod.TSVD: "central differences, truncated SVD",
    EstimateMethod.LASSO: "central differences, Lasso",
    EstimateMethod.LS_SVM: "central differences, least-squares SVM",
    EstimateMethod.SVR: "central differences, support vectors",
    EstimateMethod.SMOOTHED: "smoothed derivative, least squares",
    EstimateMethod.WEAK_FORM: "weak form, least squares",
    EstimateMethod.WEAK_FORM_RIDGE: "weak form, ridge",
    EstimateMethod.SONG2025: "published pipeline (Song et al. 2025)",
    EstimateMethod.SONG2025_IMPROVED: "published pipeline, improved (Song et al. 2025)",
    EstimateMethod.INSTRUMENTAL_VARIABLES: "weak form, instrumental variables",
})  # fmt: skip
"""Name in tables of each regression that `[estimate] method` can name."""


def available_estimators(
    half_width: float, svr: SupportVectorSettings | None = None
) -> tuple[RegressionEstimator, ...]:
    """Return the standard estimators, then the installed ones; windows of that half width [s].

    Raises:
        InputError: an installed estimator cannot be made; the sentence says which.
    """
    return (
        *standard_estimators(half_width, svr),
        *(_plugin(name, half_width) for name in installed(ENTRY_POINT_GROUP)),
    )


def estimator_named(name: str, half_width: float, svr: SupportVectorSettings | None = None) -> RegressionEstimator:
    """Return the estimator that tables list under a name; windows of that half width [s].

    Raises:
        InputError: there is no such estimator (the nearest is named), or an installed one cannot be made.
    """
    estimators = {estimator.name: estimator for estimator in available_estimators(half_width, svr)}
    if name not in estimators:
        raise InputError(f"unknown estimator '{name}'{spelling_hint(name, list(estimators))}")
    return estimators[name]


def estimator_of_method(
    method: EstimateMethod, half_width: float, svr: SupportVectorSettings | None = None
) -> RegressionEstimator:
    """Return the regression that `[estimate] method` names; windows of that half width [s].

    Raises:
        InputError: the method is no regression.
    """
    if method not in _NAMES:
        raise InputError(f"method '{method}' is no regression; these are {', '.join(_NAMES)}")
    return estimator_named(_NAMES[method], half_width, svr)


def _plugin(name: str, half_width: float) -> RegressionEstimator:
    create: EstimatorFactory = load_plugin(ENTRY_POINT_GROUP, name, InputError)
    try:
        return create(half_width)
    except Exception as error:
        raise InputError(failure_text(installed(ENTRY_POINT_GROUP)[name], error)) from error
