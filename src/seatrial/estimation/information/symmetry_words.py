"""Sentences about changes that nothing shows, made from their numbers: names, powers, shifts."""

from collections.abc import Sequence
from dataclasses import dataclass

from seatrial.core.values import Parameters
from seatrial.estimation.information.generator import Generator

_MOST_NAMED, _MOST_LISTED = 8, 24


@dataclass(frozen=True)
class Silence:
    """Why a parameter has no influence of its own.

    Attributes:
        enters: whether it stands in any equation that reaches a compared output.
        hidden: states nobody measures that can make up for it.
        switches: fixed values that switch it off, ``A_T is 0``.
    """

    enters: bool = True
    hidden: tuple[str, ...] = ()
    switches: tuple[str, ...] = ()


def listed(items: Sequence[str], last: str = "and") -> str:
    """a, b and c."""
    return f" {last} ".join([", ".join(items[:-1]), items[-1]]) if len(items) > 1 else "".join(items)


def silence(names: Sequence[str], why: Silence, outputs: Sequence[str]) -> str:
    """Parameters without influence on the compared outputs, why, and what to do."""
    who, seen, them = listed(names), listed(outputs, "or"), "them" if len(names) > 1 else "it"
    has, enters = ("have", "enter") if len(names) > 1 else ("has", "enters")
    if not why.enters:
        return f"{who} {enters} no equation that reaches {seen}: fix {them}"
    if why.hidden:
        return (
            f"{who} can be changed at will if {listed(why.hidden)}, not measured, {_be(why.hidden)} changed to fit, "
            f"without any change of {seen}: fix {them} or give a prior"
        )
    if why.switches:
        return f"{who} {has} no influence on {seen} while {listed(why.switches)}: fix {them}, or change that value"
    return f"{who} {has} no influence on {seen}: fix {them}"


def sentence(g: Generator, parameters: Parameters, decisive: Sequence[str], outputs: Sequence[str]) -> str:
    """What can change together without any change of the outputs, and which parameters settle it."""
    follow = f", with {listed(g.hidden)}, not measured, changed to fit," if g.hidden else ""
    same = f"without any change of {listed(outputs, 'or')}"
    return f"{_change(g, parameters)}{follow} {same}: {_advice(g, parameters, decisive)}"


def _change(g: Generator, parameters: Parameters) -> str:
    scaled = [n for n in _free_first(g, parameters) if g.power[n]]
    shifted = [n for n in _free_first(g, parameters) if not g.power[n]]
    if not g.is_finite:
        return _near(g, parameters)
    if not scaled:
        return _shifting(g, shifted)
    if not shifted:
        return _scaling(g, scaled)
    steps = listed([f"{n} by {g.shift[n]:+.4g} s" for n in shifted])
    return f"{_powers(g, scaled, 'e^s')} and, for any s, {steps} shifted"


def _free_first(g: Generator, parameters: Parameters) -> list[str]:
    return sorted(g.parameters, key=lambda n: not parameters[n].free)


def _written(g: Generator, names: Sequence[str]) -> str:
    """Names with their centres; sums and differences last."""
    plain = [n for n in names if n not in g.names]
    return listed([*plain, *(g.names[n] for n in names if n in g.names)])


def _groups(g: Generator, names: Sequence[str]) -> list[tuple[int, list[str]]]:
    groups: dict[int, list[str]] = {}
    for n in names:
        groups.setdefault(g.power[n], []).append(n)
    return sorted(groups.items(), key=lambda item: (-len(item[1]), -item[0]))


def _scaling(g: Generator, names: Sequence[str]) -> str:
    groups = _groups(g, names)
    if len(groups) == 1:
        return f"{_written(g, names)} can {'all' if len(names) > 2 else 'both'} be scaled together by one common factor"
    if len(groups) == 2 and groups[0][0] == -groups[1][0]:
        up, down = groups[0][1], groups[1][1]
        return f"{_written(g, up)} can be multiplied by any factor if {_written(g, down)} {_be(down)} divided by it"
    return _powers(g, names, "k")


def _powers(g: Generator, names: Sequence[str], factor: str) -> str:
    (power, lead), *others = sorted(_groups(g, names), key=lambda item: (item[0] != 1, -len(item[1])))
    rest = listed([f"{_written(g, members)} by {_power(factor, p)}" for p, members in others])
    by = f"{_written(g, lead)} can be multiplied by any factor {_power(factor, power)}"
    return f"{by} together with {rest}" if others else by


def _power(factor: str, power: int) -> str:
    return factor if power == 1 else f"{factor}^{power}"


def _be(names: Sequence[str]) -> str:
    return "are" if len(names) > 1 else "is"


def _shifting(g: Generator, names: Sequence[str]) -> str:
    sizes = [abs(g.shift[n]) for n in names]
    if max(sizes) - min(sizes) > 1e-9 * max(sizes):
        unit = g.shift[names[0]]
        steps = listed([f"{n} by {g.shift[n] / unit:+.4g}" for n in names])
        return f"{listed(names)} are felt in combination only and can be shifted together ({steps})"
    first, *rest = names
    against = [n for n in rest if g.shift[n] * g.shift[first] < 0.0]
    along = [first, *(n for n in rest if n not in against)]
    if not against:
        return f"{listed(along)} can {'all' if len(along) > 2 else 'both'} be raised by one common amount"
    return f"{listed(along)} can be raised by any amount if {listed(against)} {_be(against)} lowered by as much"


def _near(g: Generator, parameters: Parameters) -> str:
    """A change without a simple law: relative to the values, where these are there and few."""
    count = len(g.parameters) - 1
    text = f"{_some(_free_first(g, parameters))} are felt in {count} combination{'' if count == 1 else 's'} only"
    values = [parameters[n].value for n in g.parameters]
    if len(values) > _MOST_NAMED or not all(values):
        return f"{text} and can change together"
    steps = [f"{n} {g.shift[n] / value:+.2g} %" for n, value in zip(g.parameters, values, strict=True)]
    return f"{text} and can change together (near their values in proportion {listed(steps)})"


def _some(names: Sequence[str], most: int = _MOST_LISTED) -> str:
    return listed(names) if len(names) <= most else f"{', '.join(names[: most - 1])} and {len(names) - most + 1} more"


def _advice(g: Generator, parameters: Parameters, decisive: Sequence[str]) -> str:
    fixed = [n for n in g.parameters if not parameters[n].free]
    known = [n for n in g.parameters if parameters[n].free and parameters[n].prior is not None]
    dimensional = [n for n in decisive if parameters[n].unit != "1"]
    offered = [n for n in decisive if n in fixed] or dimensional or list(decisive)
    more = "" if len(offered) <= _MOST_NAMED else f" or {len(offered) - _MOST_NAMED} others"
    one = "one of " if len(offered) > 1 else ""
    text = f"fix or give a prior for {one}{', '.join(offered[:_MOST_NAMED])}{more}"
    if fixed == offered and len(fixed) == 1:
        text += "; it is fixed here, and its error spreads to all"
    elif fixed:
        text += f"; fixed here: {_some(fixed, _MOST_NAMED)}, whose errors spread to all"
    return f"{text}; prior here for {_some(known, _MOST_NAMED)}" if known else text
