"""Changes of parameters that no record of the compared outputs can show, found in the equations before any fit."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from pathlib import Path

import numpy as np
from llvmlite.binding import get_host_cpu_name

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import stored
from seatrial.core.results import Symmetry
from seatrial.core.values import Array, InputError, Parameter, Parameters
from seatrial.data.trial.model_table import COMMON_PARTICULARS, has_held_added_masses
from seatrial.estimation.information.invariance import (
    InvarianceConditions,
    invariance_conditions,
    null_space,
    sparse_basis,
)

# One exact change of parameters, with its law for finite steps: scalings about zero or another centre, and shifts.

EXACT = 1e-7
"""Relative error of a law below which it counts as exact: rounding gives 1e-10."""

_LARGEST_DENOMINATOR = 12  # of a rational exponent in a law; chosen


@dataclass(frozen=True)
class Generator:
    """One exact change: d theta_i / d s = power_i theta_i + shift_i leaves every compared output as it is.

    Attributes:
        power: by parameter, small integers; with a shift of 0 the parameter is multiplied by e^(power s).
        shift: by parameter, SI.
        is_finite: whether that holds for finite steps; if not, `shift` is the direction at the model's values.
        hidden_states: those that nobody measures and that have to change as well.
        centred_terms: parameter -> how it is written where it scales about another centre than 0, ``m + m_x``.
    """

    power: dict[str, int]
    shift: dict[str, float]
    is_finite: bool
    hidden_states: tuple[str, ...]
    centred_terms: dict[str, str]

    @property
    def parameters(self) -> tuple[str, ...]:
        """Those that change, in the order of the model."""
        return tuple(self.power)

    def centre(self, name: str) -> float:
        """The value about which a parameter scales."""
        return -self.shift[name] / self.power[name] if self.shift[name] else 0.0

    def transformed_model(self, model: Model, step: float) -> Model:
        """The model after a finite step s, with the same outputs if the hidden states start where they now belong."""
        values = {}
        for name in self.parameters:
            value, power = model.parameters[name].value, self.power[name]
            centre = self.centre(name) if power else 0.0
            growth = np.exp(power * step)
            values[name] = centre + (value - centre) * growth if power else value + self.shift[name] * step
        return model.with_values(values)

    def relative_change(self, model: Model) -> dict[str, float]:
        """Parameter -> relative change for a unit step; absolute where the value is zero and is not multiplied."""
        made = {}
        for name in self.parameters:
            value, power, shift = model.parameters[name].value, self.power[name], self.shift[name]
            made[name] = float(power + shift / value) if value else float(shift or power)
        return made

    @property
    def description_length(self) -> int:
        """How long it takes to say: factors that differ, shifts, members, centres."""
        factors = {p for p in self.power.values() if p}
        shifts = sum(1 for p in self.power.values() if not p)
        centres = sum(1 for n, p in self.power.items() if p and self.shift[n])
        return 10 * (len(factors) + shifts) + len(self.power) + 3 * centres


def centred_term(centre: float, name: str, value: float) -> str:
    if centre < 0.0:
        return f"{-centre:.4g} + {name}"
    return f"{centre:.4g} - {name}" if value < centre else f"{name} - {centre:.4g}"


def affine_law(theta: Array, delta: Array) -> tuple[list[int], list[float]] | None:
    """delta_i = power_i theta_i + shift_i at all points, with integer powers after multiplication by one number."""
    powers, shifts = [], []
    for x, y in zip(theta.T, delta.T, strict=True):
        about, scale = x - np.mean(x), np.abs(y).max()
        slope = float(about @ y / (about @ about)) if about.any() else 0.0
        power = Fraction(slope).limit_denominator(_LARGEST_DENOMINATOR)
        level = float(np.mean(y - float(power) * x))
        if np.abs(y - float(power) * x - level).max() > EXACT * scale:
            return None
        powers.append(power)
        shifts.append(0.0 if abs(level) < EXACT * scale else level)
    return _integer_powers(powers, shifts)


def _integer_powers(powers: Sequence[Fraction], shifts: Sequence[float]) -> tuple[list[int], list[float]]:
    """Integer powers without a common divisor, the majority positive."""
    many = lcm(*(p.denominator for p in powers))
    numbers = [int(p * many) for p in powers]
    factor = many / (gcd(*numbers) or 1) * (-1.0 if sum(np.sign(numbers)) < 0 else 1.0)
    return [round(float(p) * factor) for p in powers], [s * factor if s else 0.0 for s in shifts]


def combine_generators(one: Generator, other: Generator, sign: int, order: Sequence[str]) -> Generator:
    """Both at once."""
    power = {n: one.power.get(n, 0) + sign * other.power.get(n, 0) for n in order}
    parts = {n: (one.shift.get(n, 0.0), sign * other.shift.get(n, 0.0)) for n in order}
    shift = {n: 0.0 if abs(a + b) < EXACT * max(abs(a), abs(b)) else a + b for n, (a, b) in parts.items()}
    kept = [n for n in order if power[n] or shift[n]]
    names = {n: w for n, w in (other.centred_terms | one.centred_terms).items() if n in kept and power[n] and shift[n]}
    return Generator({n: power[n] for n in kept}, {n: shift[n] for n in kept}, True, (), names)


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


# Sentences about changes that nothing shows, made from their numbers: names, powers, shifts.

_MOST_ADVISED, _MOST_LISTED = 8, 24  # coefficients that a text advises on, and lists; chosen


@dataclass(frozen=True)
class NoInfluence:
    """Why a parameter has no influence of its own.

    Attributes:
        is_in_equations: whether it stands in any equation that reaches a compared output.
        hidden_states: those nobody measures that can make up for it.
        disabling_values: fixed values that switch it off, ``A_T is 0``.
    """

    is_in_equations: bool = True
    hidden_states: tuple[str, ...] = ()
    disabling_values: tuple[str, ...] = ()


def join_names(items: Sequence[str], conjunction: str = "and") -> str:
    """a, b and c."""
    return f" {conjunction} ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def no_influence_text(names: Sequence[str], reason: NoInfluence, outputs: Sequence[str]) -> str:
    """Parameters without influence on the compared outputs, why, and what to do."""
    who, seen, them = join_names(names), join_names(outputs, "or"), "them" if len(names) > 1 else "it"
    has, enters = ("have", "enter") if len(names) > 1 else ("has", "enters")
    if not reason.is_in_equations:
        return f"{who} {enters} no equation that reaches {seen}: fix {them}"
    if reason.hidden_states:
        return (
            f"{who} can be changed at will if {join_names(reason.hidden_states)}, not measured, "
            f"{_be(reason.hidden_states)} changed to fit, "
            f"without any change of {seen}: fix {them} or give a prior"
        )
    if reason.disabling_values:
        return (
            f"{who} {has} no influence on {seen} while {join_names(reason.disabling_values)}: fix "
            f"{them}, or change that value"
        )
    return f"{who} {has} no influence on {seen}: fix {them}"


def symmetry_text(g: Generator, parameters: Parameters, decisive: Sequence[str], outputs: Sequence[str]) -> str:
    """What can change together without any change of the outputs, and which parameters settle it."""
    follow = f", with {join_names(g.hidden_states)}, not measured, changed to fit," if g.hidden_states else ""
    same = f"without any change of {join_names(outputs, 'or')}"
    return f"{_change_text(g, parameters)}{follow} {same}: {_advice_text(g, parameters, decisive)}"


def _change_text(g: Generator, parameters: Parameters) -> str:
    scaled = [n for n in _free_first(g, parameters) if g.power[n]]
    shifted = [n for n in _free_first(g, parameters) if not g.power[n]]
    if not g.is_finite:
        return _local_change_text(g, parameters)
    if not scaled:
        return _shift_text(g, shifted)
    if not shifted:
        return _scaling_text(g, scaled)
    steps = join_names([f"{n} by {g.shift[n]:+.4g} s" for n in shifted])
    return f"{_powers_text(g, scaled, 'e^s')} and, for any s, {steps} shifted"


def _free_first(g: Generator, parameters: Parameters) -> list[str]:
    return sorted(g.parameters, key=lambda n: not parameters[n].free)


def _terms_text(g: Generator, names: Sequence[str]) -> str:
    """Names with their centres; sums and differences last."""
    plain = [n for n in names if n not in g.centred_terms]
    return join_names([*plain, *(g.centred_terms[n] for n in names if n in g.centred_terms)])


def _groups(g: Generator, names: Sequence[str]) -> list[tuple[int, list[str]]]:
    groups: dict[int, list[str]] = {}
    for n in names:
        groups.setdefault(g.power[n], []).append(n)
    return sorted(groups.items(), key=lambda item: (-len(item[1]), -item[0]))


def _scaling_text(g: Generator, names: Sequence[str]) -> str:
    groups = _groups(g, names)
    if len(groups) == 1:
        return (
            f"{_terms_text(g, names)} can {'all' if len(names) > 2 else 'both'} be scaled together by one common factor"
        )
    if len(groups) == 2 and groups[0][0] == -groups[1][0]:
        up, down = groups[0][1], groups[1][1]
        return (
            f"{_terms_text(g, up)} can be multiplied by any factor if {_terms_text(g, down)} {_be(down)} divided by it"
        )
    return _powers_text(g, names, "k")


def _powers_text(g: Generator, names: Sequence[str], factor: str) -> str:
    (power, lead), *others = sorted(_groups(g, names), key=lambda item: (item[0] != 1, -len(item[1])))
    rest = join_names([f"{_terms_text(g, members)} by {_power_text(factor, p)}" for p, members in others])
    by = f"{_terms_text(g, lead)} can be multiplied by any factor {_power_text(factor, power)}"
    return f"{by} together with {rest}" if others else by


def _power_text(factor: str, power: int) -> str:
    return factor if power == 1 else f"{factor}^{power}"


def _be(names: Sequence[str]) -> str:
    return "are" if len(names) > 1 else "is"


def _shift_text(g: Generator, names: Sequence[str]) -> str:
    sizes = [abs(g.shift[n]) for n in names]
    if max(sizes) - min(sizes) > 1e-9 * max(sizes):  # rounding; chosen
        unit = g.shift[names[0]]
        steps = join_names([f"{n} by {g.shift[n] / unit:+.4g}" for n in names])
        return f"{join_names(names)} have an effect in combination only and can be shifted together ({steps})"
    first, *rest = names
    against = [n for n in rest if g.shift[n] * g.shift[first] < 0.0]
    along = [first, *(n for n in rest if n not in against)]
    if not against:
        return f"{join_names(along)} can {'all' if len(along) > 2 else 'both'} be raised by one common amount"
    return f"{join_names(along)} can be raised by any amount if {join_names(against)} {_be(against)} lowered by as much"


def _local_change_text(g: Generator, parameters: Parameters) -> str:
    """A change without a simple law: relative to the values, where these are there and few."""
    count = len(g.parameters) - 1
    combinations = f"{count} combination{'' if count == 1 else 's'}"
    text = f"{_shortened_list(_free_first(g, parameters))} have an effect in {combinations} only"
    values = [parameters[n].value for n in g.parameters]
    if len(values) > _MOST_ADVISED or not all(values):
        return f"{text} and can change together"
    steps = [f"{n} {g.shift[n] / value:+.2g} %" for n, value in zip(g.parameters, values, strict=True)]
    return f"{text} and can change together (near their values in proportion {join_names(steps)})"


def _shortened_list(names: Sequence[str], most: int = _MOST_LISTED) -> str:
    return (
        join_names(names) if len(names) <= most else f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"
    )


def _advice_text(g: Generator, parameters: Parameters, decisive: Sequence[str]) -> str:
    fixed = [n for n in g.parameters if not parameters[n].free]
    known = [n for n in g.parameters if parameters[n].free and parameters[n].prior is not None]
    dimensional = [n for n in decisive if parameters[n].unit != "1"]
    offered = [n for n in decisive if n in fixed] or dimensional or list(decisive)
    more = "" if len(offered) <= _MOST_ADVISED else f" or {len(offered) - _MOST_ADVISED} others"
    one = "one of " if len(offered) > 1 else ""
    text = f"fix or give a prior for {one}{', '.join(offered[:_MOST_ADVISED])}{more}"
    if fixed == offered and len(fixed) == 1:
        text += "; it is fixed here, and its error spreads to all"
    elif fixed:
        text += f"; fixed here: {_shortened_list(fixed, _MOST_ADVISED)}, whose errors spread to all"
    return f"{text}; prior here for {_shortened_list(known, _MOST_ADVISED)}" if known else text


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
