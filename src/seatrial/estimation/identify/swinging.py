"""Choice of a roll model by runs it was not fitted to: each is predicted open loop from its first seconds on.

Every structure is fitted to the training runs but one and predicts that one; with a single training run the runs kept
out judge, which are then no independent check of the chosen model any more, and a finding says so.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Member
from seatrial.core.values import Array, Finding, InputError, Progress, Record, Severity
from seatrial.data.trial import Family
from seatrial.estimation.estimate.fit import Identified, identified
from seatrial.estimation.estimate.settings import Intervals, Settings
from seatrial.estimation.identify.family import Considered
from seatrial.estimation.predict.open_loop import open_loop, rms, session_means
from seatrial.numerics.workers import mapped
from seatrial.physics.models.families import LEFT_OUT

TIE = 0.1
"""A structure of fewer coefficients is taken where its error is larger than the least one by no more than this part."""

_EXPLAINED = 0.5
_ERROR = "phi_deg"


def structures(model: Model, family: Family | None) -> dict[str, Model]:
    """Name -> model, the trial's own first; the house's leave coefficients out, a declared family's free further ones.

    Raises:
        InputError: there is but one.
    """
    parameters, made = model.parameters, {"as in the trial": model}
    if family is not None:
        for name, freed in family.structures.items():
            made[name] = model.with_parameters(parameters.freed(*freed))
    else:
        house = LEFT_OUT.get(model.name, {})
        gone = {n for dropped in house.values() for n in dropped if n not in parameters.free_names}
        absent = {n for n in gone if parameters[n].value == 0.0}
        for name, dropped in house.items():
            known = [n for n in dropped if n not in gone]
            if known and absent <= set(dropped):
                made[name] = model.with_parameters(parameters.with_values(dict.fromkeys(known, 0.0)).fixed(*known))
    if len(made) < 2:
        raise InputError(
            f"model '{model.name}' has no family to choose from; free more coefficients, or declare [family]"
        )
    return made


def chosen_by_runs(
    found: Identified,
    model: Model,
    train: Sequence[Record],
    sessions: Sequence[str],
    kept_out: Sequence[Record],
    length: float,
    seconds: float,
    settings: Settings,
    family: Family | None,
    progress: Progress | None = None,
) -> Considered:
    """The structure that predicts runs best of those it was not fitted to, or a simpler one that does as well (10 %).

    found: the trial's own model fitted to all training runs; seconds: of each run, that give its initial state.

    Raises:
        InputError: no run is left to judge by, there is but one structure, or none predicts anything.
    """
    if len(train) < 2 and not kept_out:
        raise InputError("a model is chosen by runs it was not fitted to; add a run, or name one under 'validate'")
    members = structures(model, family)
    quiet = replace(settings, workers=1, intervals=Intervals.AUTO)
    folds = [[j for j in range(len(train)) if j != i] for i in range(len(train))] if len(train) > 1 else [[0]]

    def error(one: Model, fold: int) -> float:
        kept = folds[fold]
        runs, places = [train[j] for j in kept], [sessions[j] for j in kept]
        is_known = one is model and len(kept) == len(train)
        own = found if is_known else identified(one, runs, places, length, quiet)
        judged = [train[fold]] if len(train) > 1 else kept_out
        return float(np.mean([_miss(own, record, seconds) for record in judged]))

    def scored(item: tuple[str, Model]) -> tuple[float, str]:
        if progress:
            progress(f"family: {item[0]}")
        try:
            return float(np.mean([error(item[1], fold) for fold in range(len(folds))])), ""
        except InputError as failed:
            return np.inf, str(failed)

    scores = mapped(scored, list(members.items()), workers=settings.workers)
    errors = np.array([score for score, _ in scores])
    judged = train if len(train) > 1 else kept_out
    _refuse_unpredicted(errors, judged, [note for _, note in scores])
    free = [len(m.parameters.free) for m in members.values()]
    tied = errors <= (1.0 + TIE) * errors.min()
    best = min(np.flatnonzero(tied), key=lambda i: (free[i], errors[i]))
    rows = tuple(
        Member(name, free[i], None, None, bool(tied[i]), bool(i == best), note, _finite(errors[i]))
        for i, (name, (_, note)) in enumerate(zip(members, scores, strict=True))
    )
    used = found if best == 0 else identified(list(members.values())[best], train, sessions, length, settings, progress)
    return Considered(used, rows, (), () if len(train) > 1 else (_judged_by(kept_out),))


def _miss(own: Identified, record: Record, seconds: float) -> float:
    """Rms [deg] of roll over the whole run."""
    problem = own.made.problem
    made = open_loop(problem, own.model, record, session_means(problem, own.made.shared), seconds)
    return rms(record, made.record)[_ERROR]


def _refuse_unpredicted(errors: Array, judged: Sequence[Record], notes: Sequence[str]) -> None:
    if not np.any(np.isfinite(errors)):
        raise InputError(f"no member of the family can be fitted; the first fails because {notes[0]}")
    moved = float(np.mean([np.degrees(np.nanstd(r["phi"])) for r in judged]))
    if errors.min() > _EXPLAINED * moved:
        raise InputError(
            f"no model predicts the runs left out (rms {errors.min():.2g} deg of {moved:.2g} deg); record the wave "
            "slope alpha_w, or choose by decays in calm water"
        )


def _judged_by(kept_out: Sequence[Record]) -> Finding:
    names = ", ".join(r.name for r in kept_out)
    what = f"the model was chosen by its prediction of {names}, which is no independent check of it any more"
    advice = "keep a further run out, or train on two runs: then each judges what was fitted to the others"
    return Finding(Severity.INFO, "judged-by-validation", what, "one training run only", advice)


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
