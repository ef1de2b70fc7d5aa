"""What no estimate of a craft should be: masses or damping of the wrong sign, values far off their priors."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Finding, Record, Severity
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.roll_characteristics import DAMPING_NAMES, RESTORING_NAMES
from seatrial.physics.hydro.free_roll import equivalent_damping
from seatrial.physics.models.candidate_structures import PHYSICAL_SIGNS

MOST_PRIOR_DEVIATIONS = 4.0
"""Standard deviations of its prior that a value may be away from the mean: beyond, prior and records contradict."""

_AMPLITUDES = 20
"""Amplitudes up to the largest measured at which the damping of roll is looked at; chosen."""


def objections(model: Model, records: Sequence[Record]) -> tuple[str, ...]:
    """Return why the values of a model cannot be a craft's, in phrases; empty where nothing speaks against them.

    records: those that were fitted; the damping of roll is judged over the amplitudes that they show.
    """
    signs, parameters = PHYSICAL_SIGNS.get(model.name, {}), model.parameters
    turned = [
        f"{name} {parameters[name].value:.2g} is {'negative' if sign > 0 else 'positive'}"
        for name, sign in signs.items()
        if name in parameters and parameters[name].free and sign * parameters[name].value < 0.0
    ]
    far = []
    for p in parameters.free:
        if p.prior is not None and np.isfinite(p.prior.standard_deviation):
            away = abs(p.value - p.prior.mean) / p.prior.standard_deviation
            if away > MOST_PRIOR_DEVIATIONS:
                far.append(f"{p.name} is {away:.1f} standard deviations off its prior")
    return (*turned, *far, *(_roll_objections(model, records) if is_pure_roll(model) else ()))


def unphysical_finding(model: Model, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning where an estimated model has values that no craft has; `records`: as in `objections`."""
    against = objections(model, records)
    if not against:
        return ()
    advice = "record a decay from a larger angle, or fix b_2 and b_3 at 0 under [model.fixed]; --choose tries that"
    if "phi" not in model.states or not is_pure_roll(model):
        advice = "fix these under [model.fixed], or look for what the model lacks; --choose takes no such model"
    what = f"the estimate is implausible: {', '.join(against)}"
    return (Finding(Severity.WARNING, "unphysical-values", what, "", advice),)


def _roll_objections(model: Model, records: Sequence[Record]) -> tuple[str, ...]:
    """Damping that is negative, or that decreases with amplitude, between rest and the largest angle measured."""
    names, known = (*DAMPING_NAMES, *RESTORING_NAMES, "phi_0"), model.parameters
    if not set(names) <= set(known.names) or not all("phi" in r for r in records):
        return ()
    b, c = (np.array([known[n].value for n in group]) for group in (DAMPING_NAMES, RESTORING_NAMES))
    largest = max(float(np.nanmax(np.abs(r["phi"] - known["phi_0"].value))) for r in records)
    damping = equivalent_damping(b, c, largest * np.arange(1, _AMPLITUDES + 1) / _AMPLITUDES)[0]
    damping = np.concatenate([b[:1], damping[np.isfinite(damping)]])
    if np.any(damping < 0.0):
        return ("its damping is negative at amplitudes that were measured",)
    slack = 1e-9 * float(np.max(damping))  # rounding of constant damping; chosen
    return ("its damping decreases with amplitude",) if np.any(np.diff(damping) < -slack) else ()
