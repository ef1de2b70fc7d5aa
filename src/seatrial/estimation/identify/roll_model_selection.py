"""Choice of a roll model by runs it was not fitted to: each is predicted open loop from its first seconds on.

Every structure is fitted to the training runs but one and predicts that one; with a single training run the runs kept
out judge, which are then no independent check of the chosen model any more, and a finding says so.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import CandidateModel
from seatrial.core.values import Array, Finding, InputError, ProgressReporter, Record, Severity
from seatrial.data.trial import EstimateSettings, ModelFamily
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import EstimatorOptions, IntervalMethod
from seatrial.estimation.identify.model_selection import SelectedModel
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.models.candidate_structures import OMITTED_PARAMETERS

TIE_TOLERANCE = 0.1
"""A structure of fewer coefficients is taken where its error is larger than the least one by no more than this part."""

# rms error over rms roll beyond which no structure predicts anything, ours
_MAX_RESIDUAL_SHARE = 0.5
_ERROR_KEY = "phi_deg"


def roll_structures(model: Model, family: ModelFamily | None) -> dict[str, Model]:
    """Return name -> model, the trial's own first; default ones have fewer coefficients, a declared family's more.

    Raises:
        InputError: there is but one.
    """
    parameters, structures = model.parameters, {"as in the trial": model}
    if family is not None:
        for name, freed in family.structures.items():
            structures[name] = model.with_parameters(parameters.freed(*freed))
    else:
        house = OMITTED_PARAMETERS.get(model.name, {})
        gone = {n for dropped in house.values() for n in dropped if n not in parameters.free_names}
        absent = {n for n in gone if parameters[n].value == 0.0}
        for name, dropped in house.items():
            known = [n for n in dropped if n not in gone]
            if known and absent <= set(dropped):
                structures[name] = model.with_parameters(
                    parameters.with_values(dict.fromkeys(known, 0.0)).fixed(*known)
                )
    if len(structures) < 2:
        raise InputError(
            f"model '{model.name}' has no family to choose from; free more coefficients, or declare [family]"
        )
    return structures


def select_roll_model(
    estimation: Estimation,
    model: Model,
    train: Runs,
    validation_runs: Sequence[Record],
    seconds: float,
    settings: EstimateSettings,
    options: EstimatorOptions,
    family: ModelFamily | None,
    report_progress: ProgressReporter | None = None,
) -> SelectedModel:
    """The structure that predicts runs best of those it was not fitted to, or a simpler one that does as well (10 %).

    found: the trial's own model fitted to all training runs; seconds: of each run, that give its initial state.

    Raises:
        InputError: no run is left to judge by, there is but one structure, or none predicts anything.
    """
    if len(train) < 2 and not validation_runs:
        raise InputError("a model is chosen by runs it was not fitted to; add a run, or name one under 'validate'")
    members = roll_structures(model, family)
    quiet = replace(options, workers=1, intervals=IntervalMethod.AUTO)
    folds = [[j for j in range(len(train)) if j != i] for i in range(len(train))] if len(train) > 1 else [[0]]

    def error(one: Model, fold: int) -> float:
        kept = folds[fold]
        is_known = one is model and len(kept) == len(train)
        fitted = estimation if is_known else estimate_model(one, train.selected(kept), settings, quiet)
        judged = [train.records[fold]] if len(train) > 1 else validation_runs
        return float(np.mean([_roll_error(fitted, record, seconds) for record in judged]))

    def scored(item: tuple[str, Model]) -> tuple[float, str]:
        if report_progress:
            report_progress(f"family: {item[0]}")
        try:
            return float(np.mean([error(item[1], fold) for fold in range(len(folds))])), ""
        except InputError as failed:
            return np.inf, str(failed)

    scores = map_in_threads(scored, list(members.items()), workers=options.workers)
    errors = np.array([score for score, _ in scores])
    judged = train.records if len(train) > 1 else validation_runs
    _refuse_unpredicted(errors, judged, [note for _, note in scores])
    free = [len(m.parameters.free) for m in members.values()]
    tied = errors <= (1.0 + TIE_TOLERANCE) * errors.min()
    best = min(np.flatnonzero(tied), key=lambda i: (free[i], errors[i]))
    rows = tuple(
        CandidateModel(name, free[i], None, None, bool(tied[i]), bool(i == best), note, _finite_or_none(errors[i]))
        for i, (name, (_, note)) in enumerate(zip(members, scores, strict=True))
    )
    used = (
        estimation
        if best == 0
        else estimate_model(list(members.values())[best], train, settings, options, report_progress)
    )
    return SelectedModel(used, rows, (), () if len(train) > 1 else (_chosen_by_validation_finding(validation_runs),))


def _roll_error(estimation: Estimation, record: Record, seconds: float) -> float:
    """Rms [deg] of roll over the whole run."""
    offsets = new_session_offsets(estimation.estimate, record).expected
    run = simulate_open_loop(estimation.estimate.problem, estimation.model, record, offsets, seconds)
    return rms_errors(record, run.record)[_ERROR_KEY]


def _refuse_unpredicted(errors: Array, runs: Sequence[Record], notes: Sequence[str]) -> None:
    if not np.any(np.isfinite(errors)):
        raise InputError(f"no member of the family can be fitted; the first fails because {notes[0]}")
    moved = float(np.mean([np.degrees(np.nanstd(r["phi"])) for r in runs]))
    if errors.min() > _MAX_RESIDUAL_SHARE * moved:
        raise InputError(
            f"no model predicts the runs left out (rms {errors.min():.2g} deg of {moved:.2g} deg); record the wave "
            "slope alpha_w, or choose by decays in calm water"
        )


def _chosen_by_validation_finding(validation_runs: Sequence[Record]) -> Finding:
    names = ", ".join(r.name for r in validation_runs)
    what = f"the model was chosen by its prediction of {names}, which is no independent check of it any more"
    advice = "keep a further run out, or train on two runs: then each judges what was fitted to the others"
    return Finding(Severity.INFO, "judged-by-validation", what, "one training run only", advice)


def _finite_or_none(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
