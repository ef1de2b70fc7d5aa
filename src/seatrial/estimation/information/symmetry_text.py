"""Sentences about changes that nothing shows, made from their numbers: names, powers, shifts."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.values import Parameters
from seatrial.estimation.information.generator import Generator

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
