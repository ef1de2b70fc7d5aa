"""The last line of a command: what to type next."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from seatrial.cli.screen import in_shell

if TYPE_CHECKING:
    from seatrial.core.results import Design, Fit
    from seatrial.core.results.campaign import CampaignStatus
    from seatrial.core.values import Finding

FULL_RUDDER_DEG = 35.0  # deg, of most ships' rudders (SOLAS II-1/29)
RELEASE_DEG = 10.0  # deg, of a release where no run shows one; chosen
NAMES_SHOWN = 3  # coefficients that a line names; chosen


def after_check(findings: "tuple[Finding, ...]", trial: Path) -> str:
    """Return what follows a check: to correct, the advice of the first error, what a model lacks, or to identify."""
    errors = [finding for finding in findings if finding.severity.value == "error"]
    missing = next((finding for finding in findings if finding.code == "model"), None)
    if any(error.edits for error in errors):
        return f"seatrial check {in_shell(trial)} --fix"
    if errors:
        return errors[0].advice
    if missing is not None:
        return f"identify cannot start yet: {missing.advice}"
    return f"seatrial identify {in_shell(trial)} --out results"


def after_fit(fit: "Fit", folder: Path, trial: Path | None = None) -> str:
    """Return what follows a fit: to hold a run out where none was, to correct one that misses, else to simulate.

    trial: the file whose runs are replayed where the model steers no manoeuvre; None: there is none.
    """
    from seatrial.reporting.verdict import is_carried, is_missed

    runs = sum(p.role == "training" for p in fit.predictions)
    if trial is not None and not fit.validation and runs > 1:
        return f'name a run to hold out in {in_shell(trial)}, validate = "...", and identify again'
    if is_missed(fit):
        cause = (
            "the disturbance carries the craft as far, so judge the model over short windows"
            if is_carried(fit)
            else "the held-out run is not predicted, so correct the fit before it is used"
        )
        return f"docs/bad-fit.md, By symptom: {cause}"
    model = in_shell(folder / "model.toml")
    if fit.model.has_thrusters:
        return _craft_step(fit, model)
    if fit.model.has_rudder and fit.model.has_heading:
        circle = f"seatrial simulate {model} --manoeuvre turning-circle:{_recorded_rudder(fit):.0f} --out circle.csv"
        return f"{circle}{_design_step(fit, model, trial)}"
    if {"phi", "c_1"} <= {*fit.model.states, *fit.model.parameters.names} and fit.validation:
        return f"seatrial simulate {model} --manoeuvre release:{_recorded_roll(fit):.0f} --out release.csv"
    predicted = fit.validation or fit.predictions  # none where only spectra were compared
    if trial is None or not predicted:
        return f"seatrial report {in_shell(folder)}"
    return (
        f"seatrial simulate {model} --trial {in_shell(trial)} --inputs {in_shell(predicted[0].record)} --out replay.csv"
    )


def _craft_step(fit: "Fit", model: str) -> str:
    """The command that turns a craft with thrusters: by its steering angle, by difference of thrust, or not at all."""
    from seatrial.physics.models.thruster_layout import layout_of
    from seatrial.physics.simulate.thrust import craft_programmes

    kind = craft_programmes(layout_of(fit.model))[0].partition(":")[0]
    if kind in ("spin", "straight"):
        return f"seatrial simulate {model} --manoeuvre {kind}:50 --out {kind}.csv"
    return f"seatrial simulate {model} --manoeuvre turning-circle:{_recorded_rudder(fit):.0f} --out circle.csv"


def _recorded_rudder(fit: "Fit") -> float:
    """The largest rudder angle [deg] of the runs that were fitted, at most 35: beyond it the model extrapolates.

    Of a craft with thrusters that turn it is the order of their angle.
    """
    import numpy as np

    from seatrial.physics.manoeuvres import REACH_PERCENTILE
    from seatrial.physics.models.thruster_layout import layout_of, with_steering_order

    training = [p.measured for p in fit.predictions if p.role == "training"]
    if fit.model.has_thrusters:
        training = [with_steering_order(run, layout_of(fit.model)) for run in training]
    runs = [run for run in training if "delta" in run]
    reaches = [float(np.degrees(np.nanpercentile(np.abs(run["delta"]), REACH_PERCENTILE))) for run in runs]
    return min(max(reaches, default=FULL_RUDDER_DEG), FULL_RUDDER_DEG)


def _recorded_roll(fit: "Fit") -> float:
    """The largest roll angle [deg] of the runs that were fitted: beyond it the model extrapolates."""
    import numpy as np

    runs = [p.measured["phi"] for p in fit.predictions if p.role == "training" and "phi" in p.measured]
    return math.floor(max((float(np.degrees(np.nanmax(np.abs(phi)))) for phi in runs), default=RELEASE_DEG))


def _design_step(fit: "Fit", model: str, trial: Path | None) -> str:
    """The command that designs a manoeuvre where signs are open; empty where none is, or no trial is given."""
    names = [c.name for c in fit.coefficients if c.is_sign_open and not c.fixed]
    if not names or trial is None:
        return ""
    shown = f"{', '.join(names[:NAMES_SHOWN])}{' ...' if len(names) > NAMES_SHOWN else ''}"
    return f"; for a manoeuvre that determines {shown}: seatrial design {in_shell(trial)} --from {model} --out plan"


def after_design(design: "Design") -> str:
    """Return what follows a design: its orders, a standard manoeuvre, or what none determines."""
    from seatrial.core.results.design import best_baseline, criterion_error, is_within_limits
    from seatrial.reporting.design import LARGEST_SHOWN_ERROR
    from seatrial.reporting.measures import manoeuvre_name

    log = "then seatrial init LOG --out trial.toml with the log of it"
    error, best = criterion_error(design.designed, design.criterion), best_baseline(design)
    theirs = math.inf if best is None else criterion_error(best, design.criterion)
    is_beaten = best is not None and is_within_limits(best, design.limits) and theirs <= error
    if best is not None and is_beaten and theirs < 1.0:  # the standard error is below the coefficient
        return f"carry out the {manoeuvre_name(best.name)}, as the orders designed are no better, {log}"
    if is_beaten or not error < LARGEST_SHOWN_ERROR:
        errors = zip(design.coefficients, design.designed.relative_error, strict=True)
        open_ones = [name for name, relative in errors if not relative < 1.0]
        shown = f"{', '.join(open_ones[:NAMES_SHOWN])}{' ...' if len(open_ones) > NAMES_SHOWN else ''}"
        return (
            f"none of these manoeuvres determines {shown}: fix them under model.fixed or give them priors, or allow "
            "more range, time or room under [design]"
        )
    return f"carry out orders.csv, {log}"


def after_campaign(status: "CampaignStatus", store: Path) -> str:
    """Return what follows work on a campaign: to go on, to try failed tasks again, or to gather."""
    if status.remaining:
        return f"the same 'seatrial campaign run' goes on; {status.remaining} tasks are left"
    if status.failed:
        return f"seatrial campaign retry {in_shell(store)}"
    return f"seatrial campaign gather {in_shell(store)} --to {in_shell(store)}.csv"
