"""Exact changes of parameters that leave the compared outputs as they are: found, reduced to few members, named."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Parameter
from seatrial.estimation.information.generator import EXACT, Generator, affine_law, centred_term, combine_generators
from seatrial.estimation.information.invariance import InvarianceConditions, invariance_conditions
from seatrial.estimation.information.null_space import null_space, sparse_basis

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
