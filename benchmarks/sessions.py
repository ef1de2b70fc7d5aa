"""What a session that was not fitted is given of its own, compared on whole sessions left out, each in turn.

`SEATRIAL_DATA=folder python benchmarks/sessions.py kvlcc2_hsva` (runs left out) or `esso_osaka` (days left out; with
`--runs`, runs). Six rules: the model is fitted without offsets; with them, and a new session has none; the plain mean
of the training sessions; the mean of their population; that mean, moved by what the first seconds of the run show; the
population with a mean that follows the helm. Beside them stand
the published coefficients, unfitted; where whole runs are predicted, each with the offset that suits it best; and, with
the population, the share of samples in the 95 % bands of windows, its interval binomial with a window as one draw
(Clopper & Pearson 1934, Biometrika 26, 404).
"""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from measure import machine
from scipy.optimize import minimize_scalar

from seatrial.campaigns.summary import coverage_interval
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateMethod, Role, Trial, TrialRecord, load_records, load_trial
from seatrial.estimation.estimate import Estimation, EstimatorOptions, Runs
from seatrial.estimation.predict import HoldoutProtocol, session_offsets, simulate_open_loop
from seatrial.estimation.predict.open_loop import rms_errors
from seatrial.estimation.predict.session_offsets import updated_by_start
from seatrial_studies.alexandersson2022.reproduction import band_coverage, holdout_windows
from seatrial_studies.cross_validation import (
    CrossValidation,
    Fold,
    OffsetRule,
    cross_validate,
    cross_validate_unfitted,
    fit_sessions,
    population_offsets,
)

EXAMPLES = Path(__file__).parents[1] / "examples"
WINDOW_S = {"kvlcc2_hsva": 30.0, "esso_osaka": 50.0}
"""Windows in which runs are predicted [s]: those of the anchors in docs/estimation.md."""
WHOLE_RUNS = ("kvlcc2_hsva",)
"""Trials whose runs are predicted as a whole, too; no model follows a run of the pond through minutes of gusts."""
SEARCHED, GRID = 4.0, 25
"""Standard deviations between sessions to each side in which a run's own offset is sought, and values tried first."""
INITIAL_S = 6.0
"""First seconds of a run that give its initial state where the trial states none: one ship length at 1.18 m/s."""


def nothing(estimation: Estimation, _session: str, _record: Record) -> Array:
    """Return the declared mean, which is zero for offsets."""
    return np.array([p.mean for p in estimation.estimate.population.declared])


def training_mean(estimation: Estimation, _session: str, _record: Record) -> Array:
    """Return the plain mean over the training sessions."""
    return estimation.estimate.session_offsets.mean(axis=0)


def from_start(seconds: float) -> OffsetRule:
    """Return the rule by which the first seconds of a run move what its population expects."""

    def rule(estimation: Estimation, session: str, record: Record) -> Array:
        expected = session_offsets(estimation, session, record)
        return updated_by_start(estimation.estimate.problem, estimation.model, expected, record, seconds).expected

    return rule


def best_of_run(seconds: float) -> OffsetRule:
    """Return the rule of the one offset with which a whole run is predicted best, which nobody knows before it."""

    def rule(estimation: Estimation, session: str, record: Record) -> Array:
        expected = population_offsets(estimation, session, record)
        spread = float(estimation.estimate.population.deviation[0])

        def error(away: float) -> float:
            try:
                run = simulate_open_loop(
                    estimation.estimate.problem, estimation.model, record, expected + away, seconds
                )
            except InputError:
                return math.inf
            return rms_errors(record, run.record)["psi_deg"]

        grid = spread * np.linspace(-SEARCHED, SEARCHED, GRID)
        near = grid[int(np.argmin([error(away) for away in grid]))]
        step = grid[1] - grid[0]
        return expected + float(minimize_scalar(error, bounds=(near - step, near + step), method="bounded").x)

    return rule


def with_priors(trial: Trial, factor: float) -> Trial:
    """Return the trial with the priors of its coefficients wider by a factor."""
    wider = {
        p.name: replace(p.prior, standard_deviation=factor * p.prior.standard_deviation)
        for p in trial.model.parameters.free
        if p.prior is not None
    }
    return replace(trial, model=trial.model.with_parameters(trial.model.parameters.with_priors(wider)))


@dataclass(frozen=True, eq=False)
class Candidate:
    """One way of giving a new session what it has of its own: a rule, and the fits it is applied to."""

    name: str
    rule: OffsetRule
    folds: Sequence[Fold]


def whole_run_errors(candidate: Candidate, runs: Runs, seconds: float) -> Array:
    """Heading [deg] and position [m] rms over each run left out, (runs, 2); NaN where the simulation diverges."""
    errors = np.full((len(runs), 2), math.nan)
    for fold in candidate.folds:
        for i in fold.held_out:
            record, fit = runs.records[i], fold.estimation
            own = candidate.rule(fit, runs.sessions[i], record)
            try:
                run = simulate_open_loop(fit.estimate.problem, fit.model, record, own, seconds)
            except InputError:
                continue
            rms = rms_errors(record, run.record)
            errors[i] = rms["psi_deg"], rms["position_m"]
    return errors


def unfitted(trial: Trial, runs: Runs, labels: Sequence[str], protocol: HoldoutProtocol, fold: Fold) -> CrossValidation:
    """The same windows by the coefficients of the trial file; noise, which weighs initial states, is a fit's."""
    problem = fold.estimation.estimate.problem
    noise = dict(zip(problem.data.outputs, problem.noise.tolist(), strict=True))
    return cross_validate_unfitted(
        trial.model, replace(runs, noise=noise), labels, protocol, tuple(problem.data.outputs)
    )


def band_lines(folds: Sequence[Fold], runs: Runs, labels: Sequence[str], protocol: HoldoutProtocol) -> Iterator[str]:
    """Share of samples inside the bands of windows of runs left out, and its interval, by label and channel."""
    inside: dict[tuple[str, str], list[tuple[float, int]]] = {}
    for fold in folds:
        chosen = [TrialRecord(r, Role.TRAIN, s) for r, s in zip(runs.records, runs.sessions, strict=True)]
        held = [chosen[i] for i in fold.held_out]
        train = [item for i, item in enumerate(chosen) if i not in fold.held_out]
        shares = band_coverage(holdout_windows(fold.estimation, train, held, protocol))[1]
        for i, of_run in zip(fold.held_out, shares, strict=True):
            for channel, share in of_run.shares.items():
                inside.setdefault((labels[i], channel), []).append((share, of_run.windows))
    for (label, channel), pairs in sorted(inside.items()):
        windows = sum(n for _, n in pairs)
        covered = sum(share * n for share, n in pairs)
        low, high = coverage_interval(round(covered), windows)
        yield f"{label} {channel} {covered / windows:.3f} [{low:.3f}, {high:.3f}] of {windows} windows"


def population_text(folds: Sequence[Fold]) -> str:
    """Mean, slope and deviation of each kind of offset, averages over the folds, angles in degrees."""
    problem = folds[0].estimation.estimate.problem
    populations = [f.estimation.estimate.population for f in folds]
    table = np.array([(p.mean, p.slope, p.deviation) for p in populations]).mean(axis=0)
    units = ["m/s"] * len(problem.session_parameters) + [n.unit for n in problem.nuisances]
    parts = []
    for name, unit, (mean, slope, deviation) in zip(problem.session_unknowns, units, table.T, strict=True):
        factor, word = (math.degrees(1.0), "deg") if unit == "rad" else (1.0, unit)
        follows = f" {slope * factor:+.3g} for each standard deviation of the helm" if slope else ""
        parts.append(f"{name} {mean * factor:.3g}{follows}, between sessions {deviation * factor:.3g} {word}")
    return "; ".join(parts)


def main(arguments: list[str]) -> int:
    """Print the table; 2 for bad input."""
    parser = argparse.ArgumentParser(description="offsets of sessions that were not fitted, by six rules")
    parser.add_argument("trial", choices=list(WINDOW_S))
    parser.add_argument("--runs", action="store_true", help="every run is a session")
    parser.add_argument("--method", type=EstimateMethod, help="instead of the trial's own")
    parser.add_argument("--population", action="store_true", help="without the rules that need fits of their own")
    parser.add_argument("--priors", type=float, default=1.0, help="factor on the widths of the coefficients' priors")
    parser.add_argument("--initial", type=float, help="seconds of a run or window that give its initial state")
    given = parser.parse_args(arguments)
    trial = with_priors(load_trial(EXAMPLES / f"{given.trial}.toml"), given.priors)
    items = load_records(trial)[0]
    records = [i.record.resampled(trial.estimate.rate or 1.0 / i.record.dt) for i in items]
    sessions = tuple(r.name if given.runs else i.session for r, i in zip(records, items, strict=True))
    runs = Runs(tuple(records), sessions, trial.ship.length, trial.noise, trial.forces)
    labels = [r.name.split("_")[0] for r in records]
    settings = trial.estimate
    if given.method:
        settings = replace(settings, method=given.method, segment_s=None)
    print(machine())
    print(f"{given.trial}: {len(runs)} runs, {len(set(sessions))} sessions left out in turn", flush=True)
    options = EstimatorOptions(workers=1)
    initial_s = given.initial or trial.estimate.initial_s or INITIAL_S
    protocol = HoldoutProtocol(window_s=WINDOW_S[given.trial], initial_s=initial_s)

    def fits(**changes: object) -> tuple[Fold, ...]:
        return fit_sessions(trial.model, runs, replace(settings, **changes), options,
                            report_progress=lambda text: print(text, file=sys.stderr, flush=True))  # fmt: skip

    def candidates() -> Iterator[Candidate]:
        common = fits()
        print(f"  population: {population_text(common)}")
        yield Candidate("offsets, none for a new session", nothing, common)
        yield Candidate("training mean", training_mean, common)
        yield Candidate("population", population_offsets, common)
        yield Candidate(f"population and first {protocol.initial_s:g} s", from_start(protocol.initial_s), common)
        if given.trial in WHOLE_RUNS:
            yield Candidate("own offset, fitted to the run", best_of_run(protocol.initial_s), common)
        if given.population:
            return
        following = fits(covariates={"delta": "delta"})
        print(f"  population that follows the helm: {population_text(following)}")
        yield Candidate("population that follows the helm", population_offsets, following)
        yield Candidate("no offsets", nothing, fits(offsets={}, current=0.0))

    def show(name: str, scored: CrossValidation) -> None:
        pooled = [scored.pooled(label) for label in scored.labels]
        text = "".join(f"   {p.label} {p.heading_deg:5.2f} deg {p.position_m:6.3f} m" for p in pooled)
        print(f"  {name:<34} windows of {protocol.window_s:g} s{text}", flush=True)

    try:
        for candidate in candidates():
            show(candidate.name, cross_validate(candidate.folds, runs, labels, protocol, candidate.rule))
            if candidate.name == "population":
                show("coefficients of the trial file", unfitted(trial, runs, labels, protocol, candidate.folds[0]))
                for line in band_lines(candidate.folds, runs, labels, protocol):
                    print(f"  {'':<34} inside the bands: {line}", flush=True)
            if given.trial in WHOLE_RUNS:
                errors = whole_run_errors(candidate, runs, protocol.initial_s)
                diverged = int(np.isnan(errors[:, 0]).sum())
                heading, position = np.nanmean(errors, axis=0)
                print(f"  {'':<34} whole runs {heading:.2f} deg {position:.2f} m, {diverged} diverge", flush=True)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
