"""A trial in, a fit out: read, check, estimate, predict what was not fitted."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.identify.agreement import agreement
from seatrial.identify.estimate import pieces
from seatrial.identify.fit import Identified, identified, ship_length_seconds
from seatrial.identify.forecast import predictions
from seatrial.identify.settings import SEGMENT_SHIP_LENGTHS, START_SECONDS_LENGTHS, Settings
from seatrial.identify.singular import refuse_singular
from seatrial.information.autocorrelation import whiteness_p
from seatrial.results import Coefficient, Fit, Method, Noise, Offset, Residuals
from seatrial.trial import Role, Trial, TrialRecord, records_of, refuse_errors
from seatrial.values import NOTATION, Array, Finding, InputError, Parameter, Progress, Record, Severity
from seatrial.values.versions import versions

_OFFSET_SPREAD = {"rad": float(np.radians(2.0)), "m/s": 0.1, "rps": 0.1}
_GAIN_SPREAD = 0.1


def settings_of(trial: Trial, records: Sequence[Record]) -> Settings:
    """The trial's wishes as settings; offsets without a stated spread get the house's."""
    wishes = trial.estimate
    seconds = wishes.segment_s
    if wishes.criterion == "output-error":
        seconds = np.inf
    elif seconds is None and (wishes.segment_lengths or wishes.criterion == "multiple-shooting"):
        seconds = (wishes.segment_lengths or SEGMENT_SHIP_LENGTHS) * ship_length_seconds(records, trial.ship.length)
    units = {name: NOTATION[name].unit for name in wishes.offsets}
    zeros = [(name, "zero", spread or _OFFSET_SPREAD.get(units[name], 0.1), units[name])
             for name, spread in wishes.offsets.items()]  # fmt: skip
    gains = [(name, "gain", spread or _GAIN_SPREAD, "1") for name, spread in wishes.gains.items()]
    return Settings(
        segment_seconds=seconds, robust=wishes.robust, noise=dict(trial.noise), channels=wishes.channels,
        corrections=(*zeros, *gains), current=wishes.current, forces=trial.forces,
    )  # fmt: skip


def _by_role(records: Sequence[TrialRecord], role: Role) -> list[TrialRecord]:
    return [r for r in records if r.role is role]


def identify(trial: Trial, seed: int = 0, progress: Progress | None = None) -> Fit:
    """Estimate the trial's model from its training runs and predict its validation runs open loop.

    The method is deterministic; `seed` is kept with the result for commands that draw at random.

    Raises:
        InputError: the records do not pass the checks, show no excitation, or cannot tell the parameters apart.
    """
    began = time.perf_counter()
    records, findings = records_of(trial)
    findings = refuse_errors(findings, trial.accept)
    rate = trial.estimate.rate
    if rate is not None:
        records = tuple(replace(r, record=r.record.resampled(rate)) for r in records)
    train = _by_role(records, Role.TRAIN)
    if not train:
        raise InputError("the trial has no training run; leave at least one file out of 'validate' and 'leave_out'")
    runs = [r.record for r in train]
    found = identified(
        trial.model, runs, [r.session for r in train], trial.ship.length, settings_of(trial, runs), progress
    )
    refuse_singular(*_data_and_prior(found))
    unit = ship_length_seconds(runs, trial.ship.length, trial.estimate.segment_s)
    seconds = trial.estimate.initial_s or START_SECONDS_LENGTHS * unit
    told = predictions(found, records, seconds, trial.ship.length, seed, progress)
    return Fit(
        question=trial.question
        or f"Which {trial.model.name} model explains these records, and how well does it predict?",
        ship=trial.ship,
        model=found.model,
        coefficients=_coefficients(found, trial),
        covariance=found.interval.covariance[: len(found.made.problem.free), : len(found.made.problem.free)],
        solution=found.made.optimum.solution,
        method=_method(found),
        offsets=_offsets(found),
        noise=_noise(found),
        residuals=_residuals(found),
        predictions=told,
        findings=(*findings, *agreement(found.made), *_bounds_hit(found), *_unconverged(found)),
        records=tuple(r.record for r in records),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )


def _data_and_prior(found: Identified) -> tuple[Array, tuple[str, ...], Array]:
    problem = found.made.problem
    count = len(problem.free)
    return found.made.optimum.normal.reduced()[1][:count, :count], problem.free, found.made.shared[:count]


def _coefficients(found: Identified, trial: Trial) -> tuple[Coefficient, ...]:
    problem, interval = found.made.problem, found.interval
    place = {name: i for i, name in enumerate(problem.free)}
    half, error = interval.half_width, interval.standard_error

    def one(p: Parameter) -> Coefficient:
        prior = p.prior if p.free else None
        common = {
            "name": p.name, "unit": p.unit, "truth": trial.truth.get(p.name), "source": p.source, "meaning": p.meaning,
            "latex": p.latex, "prior_mean": prior.mean if prior else None,
            "prior_standard_deviation": prior.standard_deviation if prior else None,
        }  # fmt: skip
        if p.name not in place:
            return Coefficient(estimate=p.value, standard_error=None, lower=None, upper=None, fixed=True, **common)
        i = place[p.name]
        value = float(found.made.shared[i])
        return Coefficient(estimate=value, standard_error=float(error[i]), lower=value - float(half[i]),
                           upper=value + float(half[i]), fixed=False, **common)  # fmt: skip

    return tuple(one(p) for p in trial.model.parameters)


def _offsets(found: Identified) -> tuple[Offset, ...]:
    problem, error = found.made.problem, found.interval.standard_error
    names = [(name, problem.model.parameters[name].unit) for name, _ in problem.session_parameters]
    names += [(n.correction.name, n.unit) for n in problem.nuisances]
    made = []
    for k, session in enumerate(problem.data.sessions):
        for j, (name, unit) in enumerate(names):
            i = len(problem.free) + k * problem.kinds + j
            made.append(Offset(name, session, unit, float(found.made.shared[i]), float(error[i])))
    return tuple(made)


def _noise(found: Identified) -> tuple[Noise, ...]:
    problem = found.made.problem
    samples = np.isfinite(problem.data.measured).sum(axis=0)
    return tuple(
        Noise(channel, NOTATION[channel].unit if channel in NOTATION else "1", float(problem.noise[i]),
              float(0.5 * (found.inflation[i] - 1.0) * problem.data.dt), whiteness_p(found.rho[i], int(samples[i])))
        for i, channel in enumerate(problem.data.outputs)
    )  # fmt: skip


def _residuals(found: Identified) -> tuple[Residuals, ...]:
    problem, values = found.made.problem, found.made.residuals()
    return tuple(
        Residuals(channel, 1.0 / problem.data.dt, np.concatenate(pieces(problem, values[:, i])), found.rho[i])
        for i, channel in enumerate(problem.data.outputs)
    )


def _method(found: Identified) -> Method:
    problem = found.made.problem
    settings: dict[str, float | str] = {
        "samples per second": 1.0 / problem.data.dt,
        "segments": problem.data.count,
        "free coefficients": len(problem.free),
        "Huber limit (standard deviations)": problem.huber if np.isfinite(problem.huber) else "none",
    }
    return Method(found.criterion, found.start, found.interval.meaning, found.reasons, settings)


def _bounds_hit(found: Identified) -> list[Finding]:
    problem, shared = found.made.problem, found.made.shared
    hit = np.flatnonzero((shared <= problem.lower) | (shared >= problem.upper))
    return [
        Finding(Severity.WARNING, "bound-hit", f"coefficient {problem.free[i]} ends on its bound", f"{shared[i]:g}",
                "widen the bound under [model.bounds], or give a prior instead")
        for i in hit
    ]  # fmt: skip


def _unconverged(found: Identified) -> list[Finding]:
    status = found.made.optimum.solution.status
    if status.is_success:
        return []
    return [Finding(Severity.WARNING, "not-converged", "the search did not converge", status.value,
                    "do not use the coefficients before this is understood")]  # fmt: skip
