"""One exact change of parameters: its law for finite steps, and sentences about it from its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Parameters

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
    return f"{_change_text(g, parameters)}{follow} {same}. {_advice_text(g, parameters, decisive)}"


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
    text = f"Fix or give a prior for {one}{', '.join(offered[:_MOST_ADVISED])}{more}"
    if fixed == offered and len(fixed) == 1:
        text += "; it is fixed here, and its error spreads to all"
    elif fixed:
        text += f"; fixed here: {_shortened_list(fixed, _MOST_ADVISED)}, whose errors spread to all"
    return f"{text}; prior here for {_shortened_list(known, _MOST_ADVISED)}" if known else text
