"""What no estimate of a craft should be: masses or damping of the wrong sign, values far off their priors."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.ship_motions import RollCharacteristics
from seatrial.core.values import Finding, Record, Severity
from seatrial.estimation.estimate.time_scale import is_pure_roll
from seatrial.estimation.identify.roll_characteristics import DAMPING_NAMES, RESTORING_NAMES
from seatrial.physics.hydro.free_roll import equivalent_damping
from seatrial.physics.models.candidate_structures import PHYSICAL_SIGNS

MOST_PRIOR_DEVIATIONS = 4.0
"""Standard deviations of its prior that a value may be away from the mean: beyond, prior and records contradict."""

_AMPLITUDES = 20
"""Amplitudes up to the largest measured at which the damping of roll is looked at; chosen."""


def objections(
    model: Model, records: Sequence[Record], errors: Mapping[str, float] = MappingProxyType({})
) -> tuple[str, ...]:
    """Return why the values of a model cannot be a craft's, in phrases; empty where nothing speaks against them.

    records: those that were fitted; the damping of roll is judged over the amplitudes that they show. errors: standard
    deviation that estimated values of the craft put into a coefficient; 0 where it is not named.
    """
    signs, parameters = PHYSICAL_SIGNS.get(model.name, {}), model.parameters
    turned = [
        f"{name} {parameters[name].value:.2g} is {'negative' if sign > 0 else 'positive'}"
        for name, sign in signs.items()
        if name in parameters and parameters[name].free and sign * parameters[name].value < 0.0
    ]
    far = _far_off_priors(model, errors).values()
    return (*turned, *far, *(_roll_objections(model, records) if is_pure_roll(model) else ()))


def _far_off_priors(model: Model, errors: Mapping[str, float]) -> dict[str, str]:
    """The free coefficients that are far off their priors, with how far."""
    far = dict[str, str]()
    for p in model.parameters.free:
        if p.prior is not None and np.isfinite(p.prior.standard_deviation):
            away = abs(p.value - p.prior.mean) / math.hypot(p.prior.standard_deviation, errors.get(p.name, 0.0))
            if away > MOST_PRIOR_DEVIATIONS:
                far[p.name] = f"{p.name} is {away:.1f} standard deviations off its prior"
    return far


def unphysical_finding(
    model: Model,
    records: Sequence[Record],
    errors: Mapping[str, float] = MappingProxyType({}),
    roll: RollCharacteristics | None = None,
) -> tuple[Finding, ...]:
    """Return a warning where an estimated model has values that no craft has; `records`, `errors`: as in `objections`.

    A note where a value is only far off a prior of which nobody knows how far it may be wrong. roll: of the estimate;
    where a ship's damping lies within its intervals, chance alone may have made it implausible, and nothing is said.
    """
    against = objections(model, records, errors)
    if roll is not None and _has_plausible_damping(roll):
        against = tuple(one for one in against if one not in _roll_objections(model, records))
    priors = {p.name: p.prior for p in model.parameters.free if p.prior is not None}
    doubtful = [text for n, text in _far_off_priors(model, errors).items() if priors[n].is_spread_assumed]
    if not against:
        return ()
    if set(against) == set(doubtful):
        advice = "how far the prior may be wrong is assumed (prior_sd_percent): read these values with care"
        return (Finding(Severity.INFO, "unphysical-values", f"unusual: {', '.join(against)}", "", advice),)
    advice = "record a decay from a larger angle, or fix b_2 and b_3 at 0 under [model.fixed]; --choose tries that"
    if "phi" not in model.states or not is_pure_roll(model):
        advice = "fix these under [model.fixed], or look for what the model lacks; --choose takes no such model"
    what = f"the estimate is implausible: {', '.join(against)}"
    return (Finding(Severity.WARNING, "unphysical-values", what, "", advice),)


def _has_plausible_damping(roll: RollCharacteristics) -> bool:
    """Whether damping that is nowhere negative and never decreases lies within the intervals at all amplitudes."""
    if not roll.amplitude:
        return False
    least = np.maximum.accumulate(np.maximum(roll.damping_lower, 0.0))
    return bool(np.all(least <= np.asarray(roll.damping_upper)))


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
