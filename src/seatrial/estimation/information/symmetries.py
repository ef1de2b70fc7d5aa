"""What no record of the compared outputs can tell about the parameters, found in the equations before any fit.

Structural identifiability: Pohjanpalo 1978, Math. Biosciences 41, 21-33; Walter & Pronzato 1997, Identification of
Parametric Models, chapter 2. The changes come from `generators`; here they are put in order and in words.
"""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Symmetry
from seatrial.core.values import InputError
from seatrial.data.trial.model_choice import COMMON_PARTICULARS
from seatrial.estimation.information.conditions import conditions
from seatrial.estimation.information.generator import Generator
from seatrial.estimation.information.generators import Search, search
from seatrial.estimation.information.symmetry_words import Silence, sentence, silence

_ALIVE = 1e-7


def structural(model: Model, outputs: Sequence[str], forces: Sequence[str] = ()) -> tuple[Symmetry, ...]:
    """What no record of these outputs can tell about the free parameters, whatever the manoeuvre, in words.

    Beside the free parameters those count as unknown that are fixed at an assumed value other than zero; particulars
    of the ship (length, mass, ...) are known, and a term that is fixed at zero is not there. First come parameters
    without any influence and changes of free parameters alone, which a fit needs priors for; then those changes in
    which an assumed value decides.
    forces: bindings that captive tests or CFD give at known motions, ``X_sum``; what they tell is not hidden.

    Raises:
        InputError: an output the model does not have, or a parameter without a value.
    """
    where = search(model, outputs, forces)
    free = [i for i, p in enumerate(model.parameters) if p.free]
    assumed = [i for i, p in enumerate(model.parameters) if not p.free and p.value and p.name not in COMMON_PARTICULARS]
    alone, _, together = where.independent([free, assumed, sorted((*free, *assumed))])
    return (*_told(where, alone), *_told(where, together))


def refuse_structural(model: Model, outputs: Sequence[str], forces: Sequence[str] = ()) -> None:
    """Refuse free parameters without a prior that can change together without changing any compared output or force.

    Raises:
        InputError: which, and what to do.
    """
    loose = [i for i, p in enumerate(model.parameters) if p.free and p.prior is None]
    where = search(model, outputs, forces)
    (found,) = where.independent([loose])
    if found:
        told = "; and ".join(s.text for s in _told(where, found))
        raise InputError(f"no record can tell the free parameters apart: {told} (under [model.fixed], [model.priors])")


def _told(where: Search, found: Sequence[Generator]) -> tuple[Symmetry, ...]:
    """With their sentences; parameters that are silent for the same reason share one."""
    parameters, outputs = where.model.parameters, where.conditions.shown
    silent: dict[Silence, list[str]] = {}
    for g in (g for g in found if len(g.parameters) == 1):
        silent.setdefault(_reason(where, g), []).append(g.parameters[0])
    told = [Symmetry(tuple(s), silence(s, reason, outputs), dict.fromkeys(s, 1.0)) for reason, s in silent.items()]
    for g, decisive in _in_order(where.shortened([g for g in found if len(g.parameters) > 1])):
        told.append(Symmetry(g.parameters, sentence(g, parameters, decisive, outputs), g.change(where.model)))
    return tuple(told)


def _in_order(found: Sequence[Generator]) -> list[tuple[Generator, tuple[str, ...]]]:
    """Each with the parameters of which one settles it: whoever fixes one for each has settled all (triangular)."""
    left, made = list(found), []
    while left:
        own = [_own(g, left) for g in left]
        best = max(range(len(left)), key=lambda k: (bool(own[k]), len(left[k].parameters)))
        decisive = tuple(own[best]) or left[best].parameters
        made.append((left.pop(best), decisive))
    return made


def _own(generator: Generator, others: Sequence[Generator]) -> list[str]:
    """Parameters that no other generator changes."""
    shared = {n for g in others if g is not generator for n in g.parameters}
    return [n for n in generator.parameters if n not in shared]


def _reason(where: Search, silent: Generator) -> Silence:
    """Why a parameter has no influence of its own."""
    i = where.model.parameters.names.index(silent.parameters[0])
    if i not in where.conditions.entering:
        return Silence(enters=False)
    if silent.hidden:
        return Silence(hidden=silent.hidden)
    held = [k for k, p in enumerate(where.model.parameters) if k != i and not p.free]
    off = _switches(where, i, [k for k in held if not where.at[k]])
    return Silence(switches=off or _switches(where, i, [k for k in held if where.at[k]]))


def _switches(where: Search, silent: int, held: Sequence[int]) -> tuple[str, ...]:
    """Those held parameters which give the silent one an influence when they alone are changed."""
    rng = np.random.default_rng(4)
    found = []
    for k in held:
        values = where.drawn(where.at, [k], rng)
        now = conditions(where.model, where.conditions.outputs, values, where.conditions.forces)
        if np.linalg.norm(now.effects(values, where.sizes)[:, silent]) > _ALIVE:
            p = where.model.parameters.items[k]
            found.append(f"{p.name} is {p.value:.4g}")
    return tuple(found)
