"""Changes of parameters that no record of the compared outputs can show, found in the equations before any fit.

Structural identifiability: Pohjanpalo 1978, Math. Biosciences 41, 21-33; Walter & Pronzato 1997, Identification of
Parametric Models, chapter 2. The changes come from `generators`; here they are put in order and in words.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np
from llvmlite.binding import get_host_cpu_name

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import stored
from seatrial.core.results import Symmetry
from seatrial.core.values import InputError
from seatrial.data.trial.model_table import COMMON_PARTICULARS, has_held_added_masses
from seatrial.estimation.information.generator import Generator
from seatrial.estimation.information.generators import SymmetrySearch, search_symmetries
from seatrial.estimation.information.invariance import invariance_conditions
from seatrial.estimation.information.symmetry_text import NoInfluence, no_influence_text, symmetry_text

_LEAST_INFLUENCE = 1e-7  # relative effect below which a coefficient has none: rounding is less
INERTIAS = ("m", "I_z")
"""Particulars that set the scale of all forces where no added mass does: mass and yaw inertia."""
_PACKAGE = Path(__file__).parents[2]
# folders of the texts that decide what is stated
_SOURCES = tuple(_PACKAGE / folder for folder in ("estimation/information", "data/trial", "core/values"))


def structural_symmetries(model: Model, outputs: Sequence[str], forces: Sequence[str] = ()) -> tuple[Symmetry, ...]:
    """Return what no record of these outputs can show of the free parameters, whatever the manoeuvre, in words.

    Beside the free parameters those count as unknown that are fixed at an assumed value other than zero; particulars
    of the ship (length, mass, ...) are known unless they alone set the scale of the forces (`INERTIAS`), and a term
    that is fixed at zero is not there. First come parameters without any influence and changes of free parameters
    alone, which a fit needs priors for; then those changes in which an assumed value decides.
    forces: bindings that captive tests or CFD give at known motions, ``X_sum``; what they show is not hidden.

    Raises:
        InputError: an output the model does not have, or a parameter without a value.
    """
    return _stored("structural", model, outputs, forces, lambda: _structural(model, outputs, forces))


def _structural(model: Model, outputs: Sequence[str], forces: Sequence[str]) -> tuple[Symmetry, ...]:
    where = search_symmetries(model, outputs, forces)
    free = [i for i, p in enumerate(model.parameters) if p.free]
    assumed = [i for i, p in enumerate(model.parameters) if not p.free and p.value and p.name not in COMMON_PARTICULARS]
    alone, _, together = where.independent_generators([free, assumed, sorted((*free, *assumed))])
    if not together and has_held_added_masses(model):
        together = _scaled_with_inertias(where, free, assumed)
    return (*_describe_symmetries(where, alone), *_describe_symmetries(where, together))


def _scaled_with_inertias(where: SymmetrySearch, free: Sequence[int], assumed: Sequence[int]) -> list[Generator]:
    """Changes of free parameters in which the ship's own mass and inertia decide, where no other assumed value does.

    Motions show forces per mass only: where added masses are fixed, errors of mass and inertia are those of all
    coefficients.
    """
    inertias = [i for i, p in enumerate(where.model.parameters) if not p.free and p.value and p.name in INERTIAS]
    held = sorted((*assumed, *inertias))
    return where.independent_generators([free, held, sorted((*free, *held))])[2]


def refuse_unidentifiable(model: Model, outputs: Sequence[str], forces: Sequence[str] = ()) -> None:
    """Refuse free parameters without a prior that can change together without changing any compared output or force.

    Raises:
        InputError: which, and what to do.
    """
    symmetries = _stored("unidentifiable", model, outputs, forces, lambda: _without_prior(model, outputs, forces))
    if symmetries:
        reasons = "; and ".join(s.text for s in symmetries)
        raise InputError(
            f"no record can distinguish the free parameters: {reasons} (under [model.fixed], [model.priors])"
        )


def _without_prior(model: Model, outputs: Sequence[str], forces: Sequence[str]) -> tuple[Symmetry, ...]:
    """Those of the free parameters without a prior."""
    members = [i for i, p in enumerate(model.parameters) if p.free and p.prior is None]
    search = search_symmetries(model, outputs, forces)
    (changes,) = search.independent_generators([members])
    return _describe_symmetries(search, changes)


def _stored(
    kind: str, model: Model, outputs: Sequence[str], forces: Sequence[str], find: Callable[[], Sequence[Symmetry]]
) -> tuple[Symmetry, ...]:
    """From the compile cache, where the same question was answered before on a processor of this kind."""
    values = [(p.name, p.value, p.free, p.lower, p.upper, p.scale, p.prior, p.unit) for p in model.parameters]
    key = (model.equation_hash, values, tuple(outputs), tuple(forces), np.__version__, get_host_cpu_name())
    symmetries = stored(kind, key, lambda: [asdict(s) for s in find()], _SOURCES)
    return tuple(Symmetry(tuple(s["parameters"]), s["text"], s["change"]) for s in symmetries)


def _describe_symmetries(symmetry_search: SymmetrySearch, changes: Sequence[Generator]) -> tuple[Symmetry, ...]:
    """With their sentences; parameters without influence for the same reason share one."""
    parameters, outputs = symmetry_search.model.parameters, symmetry_search.conditions.compared_quantities
    silent: dict[NoInfluence, list[str]] = {}
    for g in (g for g in changes if len(g.parameters) == 1):
        silent.setdefault(_no_influence_reason(symmetry_search, g), []).append(g.parameters[0])
    described = [
        Symmetry(tuple(s), no_influence_text(s, reason, outputs), dict.fromkeys(s, 1.0)) for reason, s in silent.items()
    ]
    for g, decisive in _with_decisive_parameters(
        symmetry_search.simplified([g for g in changes if len(g.parameters) > 1])
    ):
        described.append(
            Symmetry(
                g.parameters, symmetry_text(g, parameters, decisive, outputs), g.relative_change(symmetry_search.model)
            )
        )
    return tuple(described)


def _with_decisive_parameters(changes: Sequence[Generator]) -> list[tuple[Generator, tuple[str, ...]]]:
    """Each with the parameters of which one settles it: whoever fixes one for each has settled all (triangular)."""
    left, made = list(changes), []
    while left:
        own = [_unshared_parameters(g, left) for g in left]
        best = max(range(len(left)), key=lambda k: (bool(own[k]), len(left[k].parameters)))
        decisive = tuple(own[best]) or left[best].parameters
        made.append((left.pop(best), decisive))
    return made


def _unshared_parameters(generator: Generator, other_changes: Sequence[Generator]) -> list[str]:
    """Parameters that no other generator changes."""
    shared = {n for g in other_changes if g is not generator for n in g.parameters}
    return [n for n in generator.parameters if n not in shared]


def _no_influence_reason(symmetry_search: SymmetrySearch, generator: Generator) -> NoInfluence:
    """Why a parameter has no influence of its own."""
    i = symmetry_search.model.parameters.names.index(generator.parameters[0])
    if i not in symmetry_search.conditions.entering_parameters:
        return NoInfluence(is_in_equations=False)
    if generator.hidden_states:
        return NoInfluence(hidden_states=generator.hidden_states)
    held = [k for k, p in enumerate(symmetry_search.model.parameters) if k != i and not p.free]
    off = _disabling_values(symmetry_search, i, [k for k in held if not symmetry_search.values[k]])
    return NoInfluence(
        disabling_values=off or _disabling_values(symmetry_search, i, [k for k in held if symmetry_search.values[k]])
    )


def _disabling_values(
    symmetry_search: SymmetrySearch, parameter: int, fixed_parameters: Sequence[int]
) -> tuple[str, ...]:
    """Those held parameters which give the silent one an influence when they alone are changed."""
    rng = np.random.default_rng(4)
    found = []
    for k in fixed_parameters:
        values = symmetry_search.perturbed_values(symmetry_search.values, [k], rng)
        now = invariance_conditions(
            symmetry_search.model, symmetry_search.conditions.outputs, values, symmetry_search.conditions.forces
        )
        if np.linalg.norm(now.effects(values, symmetry_search.sizes)[:, parameter]) > _LEAST_INFLUENCE:
            p = symmetry_search.model.parameters.items[k]
            found.append(f"{p.name} is {p.value:.4g}")
    return tuple(found)
