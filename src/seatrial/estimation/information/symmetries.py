"""Changes of parameters that no record of the compared outputs can show, found in the equations before any fit."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from llvmlite.binding import get_host_cpu_name

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import stored
from seatrial.core.results import Symmetry
from seatrial.core.values import Array, InputError, Parameter
from seatrial.data.trial.model_table import COMMON_PARTICULARS, has_held_added_masses
from seatrial.estimation.information.generator import (
    EXACT,
    Generator,
    NoInfluence,
    affine_law,
    centred_term,
    combine_generators,
    no_influence_text,
    symmetry_text,
)
from seatrial.estimation.information.invariance import (
    InvarianceConditions,
    invariance_conditions,
    null_space,
    sparse_basis,
)

# Exact changes of parameters that leave the compared outputs as they are: found, reduced to few members, named.

_POINTS = 5  # random parameter points that a law is fitted to; chosen
_ROUNDING_LEVELS = (1e-5, 1e-8, 1e-10)  # of the largest component, below which one counts as rounding; tried in turn


@dataclass(frozen=True, eq=False)
class SymmetrySearch:
    """The point about which is asked: free parameters at random near their values, the others where they are.

    Attributes:
        values: SI; sizes: the unit of each change.
    """

    conditions: InvarianceConditions
    values: Array
    sizes: Array

    @property
    def model(self) -> Model:
        """The model in question."""
        return self.conditions.model

    @cached_property
    def effects(self) -> Array:
        """Conditions by parameter at `values`."""
        return self.conditions.effects(self.values, self.sizes)

    @cached_property
    def unset_parameters(self) -> tuple[int, ...]:
        """Free parameters whose value is zero, as they are before any fit: no law may rest on that."""
        return tuple(i for i, p in enumerate(self.model.parameters) if p.free and not p.value)

    def null_vectors(self, members: Sequence[int]) -> Array:
        """Null vectors over all parameters with these members only, (parameters, nullity)."""
        inner = null_space(self.effects[:, list(members)])
        whole = np.zeros((len(self.values), inner.shape[1]))
        whole[list(members)] = inner
        return whole

    def perturbed_values(self, reference_values: Array, members: Sequence[int], rng: np.random.Generator) -> Array:
        """The `reference_values` with these parameters elsewhere."""
        values = reference_values.copy()
        for i in members:
            values[i] = _perturbed_value(self.model.parameters.items[i], values[i], rng)
        return values

    def independent_generators(self, stages: Sequence[Sequence[int]]) -> list[list[Generator]]:
        """For each stage the generators among its members (indices) that the stages before do not imply."""
        given: list[Array] = []
        found = []
        for members in stages:
            inside = [g for g in given if np.abs(np.delete(g, list(members))).max(initial=0.0) < EXACT]
            vectors = sparse_basis(self.null_vectors(members), inside)
            given += vectors
            found.append([self.simplest_generator(self.minimal_members(v)) for v in vectors])
        return found

    def minimal_members(self, vector: Array) -> list[int]:
        """The members of a null vector without those that only rounding put there."""
        for small in _ROUNDING_LEVELS:
            members = [int(i) for i in np.flatnonzero(np.abs(vector) > small * np.abs(vector).max())]
            if self.null_vectors(members).shape[1] > 0:
                return members
        return [int(i) for i in np.flatnonzero(vector)]

    def simplest_generator(self, members: list[int]) -> Generator:
        """The change of these members in the simplest form that holds wherever they are, the others at their values."""
        names = [self.model.parameters.names[i] for i in members]
        law = self._find_affine_law(members, self.model.parameters.values)
        if law is None:
            elsewhere = self._find_affine_law(members, self.values)
            law = elsewhere if elsewhere is not None and not any(elsewhere[1]) else None
        if law is None:
            return self._local_generator(members, names)
        power, shift = dict(zip(names, law[0], strict=True)), dict(zip(names, law[1], strict=True))
        made = Generator(power, shift, True, (), {})
        made = replace(made, hidden_states=self._worst_residual(made)[1])
        return replace(made, centred_terms=self._centred_terms(made, members))

    def _local_generator(self, members: list[int], names: Sequence[str]) -> Generator:
        """The direction at the model's own values where there is just one, else near them; as large as the values."""
        values = self.model.parameters.values
        vector = self.conditions.null_vector(values, self.sizes, members)
        if vector is None:
            values, vector = self.values, self.conditions.least_visible_change(self.values, self.sizes, members)[0]
        largest = int(np.argmax(np.abs(vector) / self.sizes[members]))
        slopes = vector / vector[largest] * (values[members[largest]] or self.sizes[members[largest]])
        made = Generator(
            dict.fromkeys(names, 0), {n: float(x) for n, x in zip(names, slopes, strict=True)}, False, (), {}
        )
        return replace(made, hidden_states=self.conditions.residual(values, self._parameter_step(made, values))[1])

    def _parameter_step(self, generator: Generator, values: Array) -> Array:
        """d theta / d s over all parameters, SI."""
        step = np.zeros(len(values))
        for name in generator.parameters:
            i = self.model.parameters.index(name)
            step[i] = generator.power[name] * values[i] + generator.shift[name]
        return step

    def _worst_residual(self, generator: Generator) -> tuple[float, tuple[str, ...]]:
        """Worst residual of the law at several points, and the hidden states that have to help it."""
        rng = np.random.default_rng(5)  # any seed: the law holds at every point
        members = [self.model.parameters.index(n) for n in generator.parameters]
        points = [
            self.perturbed_values(self.model.parameters.values, [*members, *self.unset_parameters], rng)
            for _ in range(_POINTS)
        ]
        residuals = [self.conditions.residual(p, self._parameter_step(generator, p)) for p in points]
        return max(r for r, _ in residuals), max((helping for _, helping in residuals), key=len)

    def _find_affine_law(self, members: list[int], reference_values: Array) -> tuple[list[int], list[float]] | None:
        """Powers and shifts that give the null vector at several points; None where no such law holds."""
        rng = np.random.default_rng(2)
        points = [
            self.perturbed_values(reference_values, [*members, *self.unset_parameters], rng) for _ in range(_POINTS)
        ]
        vectors = [v for p in points if (v := self.conditions.null_vector(p, self.sizes, members)) is not None]
        theta = np.array(points)[:, members]
        if len(vectors) < _POINTS or not np.abs(vectors).min() > 0.0:
            return None
        delta = np.array(vectors)
        laws = []
        for r in range(len(members)):
            scaling, shift = theta[:, r] / delta[:, r], 1.0 / delta[:, r]
            laws += [law for unit in (scaling, shift) if (law := affine_law(theta, delta * unit[:, None])) is not None]
        return min(laws, key=lambda law: (sum(1 for s in law[1] if s), len({*law[0]})), default=None)

    def _centred_terms(self, generator: Generator, members: list[int]) -> dict[str, str]:
        """Terms like ``m + m_x``: the centre is the value of a parameter that does not move, and follows it."""
        words = {}
        for name in (n for n in generator.parameters if generator.power[n] and generator.shift[n]):
            own = self.model.parameters[name]
            words[name] = centred_term(generator.centre(name), name, own.value)
            for i, p in enumerate(self.model.parameters):
                sign = self._centre_sign(i, generator, name, members) if i not in members and p.unit == own.unit else 0
                if sign:
                    words[name] = f"{name} - {p.name}" if sign > 0 else f"{p.name} + {name}"
        return words

    def _centre_sign(self, fixed_index: int, generator: Generator, name: str, members: list[int]) -> int:
        """Sign with which the centre of a parameter is the value of a held one; 0 where it is not."""
        other = self.model.parameters.values
        sign = int(np.sign(generator.centre(name) * other[fixed_index]))
        if not sign or abs(generator.centre(name) / (sign * other[fixed_index]) - 1.0) > EXACT:
            return 0
        other[fixed_index] *= 1.17  # any other value; chosen
        law, k = self._find_affine_law(members, other), generator.parameters.index(name)
        if law is None or not law[0][k]:
            return 0
        return sign if abs(law[1][k] / law[0][k] / (-sign * other[fixed_index]) - 1.0) < EXACT else 0

    def simplified(self, basis: Sequence[Generator]) -> list[Generator]:
        """The same span, said in fewer words: a generator gives way to its sum or difference with another."""
        made = list(basis)
        for k in range(len(made)):
            for j, other in enumerate(made):
                if j != k and made[k].is_finite and other.is_finite:
                    sums = [combine_generators(made[k], other, sign, self.model.parameters.names) for sign in (1, -1)]
                    shorter = [s for s in sums if s.parameters and s.description_length < made[k].description_length]
                    shown = [(s, *self._worst_residual(s)) for s in shorter]
                    true = [replace(s, hidden_states=helping) for s, residual, helping in shown if residual < EXACT]
                    made[k] = min((made[k], *true), key=lambda g: g.description_length)
        return made


def search_symmetries(model: Model, outputs: Sequence[str], forces: Sequence[str] = ()) -> SymmetrySearch:
    """The search about a random point near the model's values; forces: bindings that captive tests measure as well.

    Raises:
        InputError: an output the model does not have, or a parameter without a value.
    """
    rng = np.random.default_rng(3)
    at = np.array([_perturbed_value(p, p.value, rng) if p.free else p.value for p in model.parameters])
    sizes = np.array([p.characteristic_scale for p in model.parameters])
    return SymmetrySearch(invariance_conditions(model, outputs, at, forces), at, sizes)


def _perturbed_value(p: Parameter, value: float, rng: np.random.Generator) -> float:
    """Another value of a parameter, inside its bounds and with its sign."""
    # factors away from the value; chosen
    other = value * rng.uniform(0.6, 1.6) if value else p.characteristic_scale * rng.normal()
    return float(np.clip(other, p.lower, p.upper))


def generators(model: Model, outputs: Sequence[str], among: Sequence[str] = ()) -> tuple[Generator, ...]:
    """A basis of all exact changes of the named parameters (none named: all) that leave the outputs as they are.

    The named parameters may have any value, the others have theirs: what is exactly zero switches its factors off.

    Raises:
        InputError: an output the model does not have, or a parameter without a value.
    """
    model = model.with_parameters(model.parameters.only_free(among or model.parameters.names))
    where = search_symmetries(model, outputs)
    members = [i for i, p in enumerate(model.parameters) if p.free]
    return tuple(where.simplified(where.independent_generators([members])[0]))


# Changes of parameters that no record of the compared outputs can show, found in the equations before any fit.

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
