"""The runs that judge the model of a draft, and roll decays that do not belong with the others."""

import math
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from seatrial.core.text.numbers import duration
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Record
from seatrial.data.check.phases import half_swing_angles, half_swings
from seatrial.data.draft.starting_model import StartingModel
from seatrial.data.draft.stretches import STRAIGHT
from seatrial.physics.manoeuvres import ManoeuvreKind, SteeredOrders, steered_orders

# Roll decays that differ: in how they die out, of another speed or loading, or in the heel about which they roll.

_UNLIKE = (
    1.5  # of the decrement of the next decay, from which on two groups of decays differ; chosen: scatter is a tenth
)
_SMALLEST_SHARE = 0.25  # of the first swing, down to which swings count: below, wind and noise swing along; chosen
_FEWEST = 4  # swings that give a decrement; chosen
_NAMES_SHOWN = 4  # ours
_CERTAIN = 4.0  # standard errors by which heels differ; chosen: they are correlated from swing to swing
_LEAST_HEEL = math.radians(0.2)  # rad, difference of heels from which on it matters; chosen: 2 % of a release of 10 deg


def unlike_decays_text(decays: Mapping[str, Record]) -> str:
    """Return which decays die out faster than the others, and what to do; empty where all are alike.

    decays: records of roll decays from their releases, by name.
    """
    decrements = {name: found for name, record in decays.items() if (found := _decrement(record["phi"])) is not None}
    ordered = sorted(decrements, key=decrements.__getitem__)
    ratios = [decrements[b] / max(decrements[a], 1e-9) for a, b in pairwise(ordered)]  # never a division by zero
    if not ratios or max(ratios) < _UNLIKE:
        return ""
    cut = int(np.argmax(ratios)) + 1
    slow, fast = ordered[:cut], ordered[cut:]
    low, high = (float(np.median([decrements[name] for name in group])) for group in (slow, fast))
    names = enumeration(sorted(fast), _NAMES_SHOWN)
    verb = "dies" if len(fast) == 1 else "die"
    return (
        f"{names} {verb} out {high / low:.2g} times as fast as the others: if they were run at another speed or "
        "loading, draft each condition by itself, from its logs alone"
    )


def heels_apart(decays: Mapping[str, Record]) -> tuple[float, float] | None:
    """Return least and largest heel about which decays roll [rad], where they differ; None: one angle serves all.

    decays: as above.
    """
    rests = [found for record in decays.values() if (found := _rest(record["phi"])) is not None]
    if len(rests) < 2:
        return None
    (low, low_error), (high, high_error) = min(rests), max(rests)
    limit = max(_CERTAIN * math.hypot(low_error, high_error), _LEAST_HEEL)
    return (low, high) if high - low > limit else None


def _rest(phi: Array) -> tuple[float, float] | None:
    """The heel between the swings' extremes [rad], and its standard error; None of too few swings.

    A quarter of two extremes to one side and half of the one between lie at the rest but for (1 - rho)^2 / 4 of the
    swing, rho the share that is left from one to the next.
    """
    rest = float(np.median(phi))
    tops = np.array([_extreme(phi[half_swing.first : half_swing.stop], rest) for half_swing in half_swings(phi - rest)])
    if len(tops) < _FEWEST + 2:
        return None
    middles = 0.25 * (tops[:-2] + 2.0 * tops[1:-1] + tops[2:])
    return float(np.median(middles)), float(np.std(middles)) / math.sqrt(len(middles))


def _extreme(swing: Array, rest: float) -> float:
    return float(swing[np.argmax(np.abs(swing - rest))])


def _decrement(phi: Array) -> float | None:
    """The mean decrease of the logarithm of the angle from swing to swing; None of too few swings."""
    angles = half_swing_angles(phi - float(np.median(phi)))
    large = angles[angles > _SMALLEST_SHARE * angles.max(initial=0.0)]
    if len(large) < _FEWEST:
        return None
    return -float(np.polyfit(np.arange(len(large)), np.log(large), 1)[0])


# The runs of several kinds of manoeuvre that judge a model, where two of each kind are left to train it.

_KEPT = 2  # runs of a kind that train at least where others of it are held out: one alone sets no interval; chosen
_LARGEST_SHARE = 1.0 / 3.0  # of the time of all runs that is held out at most; chosen
_AS_LARGE = 0.9  # of a rudder angle, from which on another is as large: what helmsmen repeat, as in orders
ZIGZAG, CIRCLE = "zigzag", "circle"
"""Kinds of manoeuvre that a rudder orders."""


@dataclass(frozen=True)
class JudgingRuns:
    """Runs, those with the same orders together, among which the ones that judge a model are chosen.

    Attributes:
        records: of each run.
        groups: names of the runs with the same orders.
        kinds: of the manoeuvre of each run; one whose kind is empty is not held out.
        sizes: of the inputs of each run.
        orders: rudder orders; None of runs that have none.
        lies_within: whether the inputs of some runs stay in the range of those of the others.
    """

    records: Mapping[str, Record]
    groups: Sequence[tuple[str, ...]]
    kinds: Mapping[str, str]
    sizes: Mapping[str, float]
    orders: Mapping[str, SteeredOrders | None]
    lies_within: Callable[[Set[str]], bool]

    def of_several_kinds(self, least_share: float) -> tuple[str, ...]:
        """Return of each kind the middle group by size; more of them in turn until they last a share of all time.

        Straight runs only where the others do not last that long: on a course that a helmsman holds, what he corrects
        is all that could be predicted.
        """
        counts = Counter(kind for name in self.records if (kind := self.kinds[name]))
        kinds, held = sorted(counts, key=lambda kind: -counts[kind]), ()
        for chosen in ([kind for kind in kinds if kind != STRAIGHT], kinds):
            before = None
            while held != before and (before is None or share_of_time(held, self.records) < least_share):
                before = held
                for kind in chosen:
                    held = (*held, *self._next_of(kind, held))
            if held and share_of_time(held, self.records) >= least_share:
                break
        return held

    def _next_of(self, kind: str, held: tuple[str, ...]) -> tuple[str, ...]:
        """The upper middle one by size of the groups of a kind that may be held out as well; empty where none may."""
        able = [group for group in self.groups if group[0] not in held and self._may_judge(kind, group, held)]
        able.sort(key=lambda group: self.sizes[group[0]])
        return able[len(able) // 2] if able else ()

    def _may_judge(self, kind: str, group: tuple[str, ...], held: tuple[str, ...]) -> bool:
        """Whether enough is left to train where a group is held out beside what is held out already."""
        if any(self.kinds[name] != kind for name in group):
            return False
        out = {*held, *group}
        rest = [name for name in self.records if name not in out]
        return (
            sum(self.kinds[name] == kind for name in rest) >= _KEPT
            and share_of_time(out, self.records) <= _LARGEST_SHARE
            and self._keeps_circles(group[0], rest)
            and self.lies_within(out)
        )

    def _keeps_circles(self, name: str, rest: Sequence[str]) -> bool:
        """Whether circles of no smaller rudder angle train on both sides, where the run is one."""
        circle = self.orders[name]
        if circle is None or not circle.is_turn:
            return True
        turns = [one.rudder for other in rest if (one := self.orders[other]) is not None and one.is_turn]
        as_large = [rudder for rudder in turns if abs(rudder) >= _AS_LARGE * abs(circle.rudder)]
        return min(as_large, default=0.0) < 0.0 < max(as_large, default=0.0)


def share_of_time(names: Collection[str], records: Mapping[str, Record]) -> float:
    """Return the share of the time of all runs that some take."""
    total = math.fsum(record.duration for record in records.values())
    return math.fsum(records[name].duration for name in names) / total


def kind_of_orders(orders: SteeredOrders | None) -> str:
    """Return the kind of manoeuvre that is ordered by a rudder; empty of others."""
    if orders is None:
        return ""
    return CIRCLE if orders.is_turn else ZIGZAG if orders.kind is ManoeuvreKind.ZIGZAG else ""


# The runs that judge the model of a draft: what tests it most, and no repeat of what trains where there is another.

_NO_KINDS: Mapping[str, str] = MappingProxyType({})
_LEAST_SHARE = 0.2  # of the time of all runs of a craft with thrusters that judges its model, if it can be; chosen
_CHOICE = 3  # manoeuvres from which on the middle one by size is held out
_HARDLY_STEERED = 0.3  # of the largest size of the inputs of a run, below which a run judges nothing; chosen
# of the range of an input in the other runs, by which a run may leave it and still lie within; by which one may where
# no other run lies within; chosen
_BEYOND, _FARTHER_BEYOND = 0.05, 0.25


@dataclass(frozen=True)
class HeldOutRuns:
    """The runs that are kept out of the estimation, and why these; empty: none can judge the model.

    has_several: whether they are of several kinds, or as many of one as the others allow. seconds: that they last.
    seconds_in_all: that all runs last.
    """

    names: tuple[str, ...] = ()
    why: str = ""
    has_several: bool = False
    seconds: float = 0.0
    seconds_in_all: float = 0.0

    @property
    def share(self) -> str:
        """How much judges the model, for people."""
        return f"{duration(self.seconds)} of {duration(self.seconds_in_all)}"

    def timed(self, records: Mapping[str, Record]) -> "HeldOutRuns":
        """Return them with how long they and all runs last."""
        seconds = {name: record.duration for name, record in records.items()}
        held = math.fsum(seconds[name] for name in self.names)
        return replace(self, seconds=held, seconds_in_all=math.fsum(seconds.values()))


NOTHING_HELD_OUT = HeldOutRuns()
"""No run can judge the model."""


def held_out_runs(
    model: StartingModel, records: Mapping[str, Record], kinds: Mapping[str, str] = _NO_KINDS
) -> HeldOutRuns:
    """Return the runs to judge the model by.

    A model of a ship's propeller and rudder, or of thrusters, is judged by manoeuvres of several kinds of which two at
    least train it; of a ship without so many by the turning circles to one side where those to the other and a zigzag
    train it, or by one zigzag where there are as many of these. Else it is the upper middle one by size of the
    manoeuvres whose inputs lie within the others', with its repeats: of zigzags and circles beside which another of the
    kind trains it, where there are any, as a change of course tests little. Of two it is the smaller one, since the
    larger one shows more to the estimate. Where nothing but a repeat can be held out, that is said.

    Empty where there is none: a model is not judged beyond the runs that it is fitted to, nor by one that hardly
    steers.

    Args:
        model: decides which rule holds.
        records: of the runs.
        kinds: of the manoeuvres of the runs; empty: by what the rudder orders.
    """
    return _chosen(model, records, kinds).timed(records)


def _chosen(model: StartingModel, records: Mapping[str, Record], kinds: Mapping[str, str]) -> HeldOutRuns:
    if not model.inputs:
        return NOTHING_HELD_OUT
    orders = {name: steered_orders(one) if "delta" in model.inputs else None for name, one in records.items()}
    groups, by_orders = _repeats(orders), {name: kind_of_orders(one) for name, one in orders.items()}
    full = {name: kinds[name] for name in records} if kinds else by_orders
    kinds = by_orders if model.has_propeller else kinds or dict.fromkeys(records, "")
    several = _of_several_kinds(model, records, orders, kinds)
    if several is not None:
        return several
    if model.has_propeller and (circles := _circles_to_one_side(orders)):
        if zigzags := _zigzags_instead(model, records, groups, kinds):
            return HeldOutRuns(zigzags, "circles to either side are fitted, of which there are no others")
        return HeldOutRuns(circles, "circles to one side; those to the other are fitted")
    if middle := _middle(model, records, groups, full):
        return HeldOutRuns(middle)
    single = _middle(model, records, [(name,) for name in records], full)
    repeated = [name for group in groups if set(single) & set(group) for name in group if name not in single]
    if not repeated:
        return HeldOutRuns(single)
    return HeldOutRuns(single, f"a repeat of {enumeration(repeated)}: it tests no other manoeuvre, record one")


def _of_several_kinds(
    model: StartingModel,
    records: Mapping[str, Record],
    orders: Mapping[str, SteeredOrders | None],
    kinds: Mapping[str, str],
) -> HeldOutRuns | None:
    """The runs of several kinds, or of the one of which there are enough; None where there are not enough of any."""
    if not (model.has_propeller or model.has_thrusters):
        return None
    sizes = {name: _size(model, record) for name, record in records.items()}
    steered = [repeat for repeat in _repeats(orders) if sizes[repeat[0]] > _HARDLY_STEERED * max(sizes.values())]
    least = _LEAST_SHARE if model.has_thrusters else 0.0
    within = (partial(_lie_within, model, records=records, beyond=share) for share in (_BEYOND, _FARTHER_BEYOND))
    choices = [JudgingRuns(records, steered, kinds, sizes, orders, one).of_several_kinds(least) for one in within]
    able = [choice for choice in choices if choice]
    if not able:
        return None
    enough = [one for one in able if share_of_time(one, records) >= least]
    in_order = tuple(sorted((enough or able)[0], key=list(records).index))
    return HeldOutRuns(in_order, "at least two of each of their kinds are fitted", has_several=True)


def can_judge(model: StartingModel, name: str, records: Mapping[str, Record]) -> bool:
    """Return whether a run can judge the model: what is ordered in it the other runs hold, too."""
    return bool(model.inputs) and _lie_within(model, {name}, records=records, beyond=_FARTHER_BEYOND)


def _zigzags_instead(
    model: StartingModel, records: Mapping[str, Record], groups: Sequence[tuple[str, ...]], kinds: Mapping[str, str]
) -> tuple[str, ...]:
    """The middle group of zigzags, where there are as many as circles and others are left; else nothing."""
    counts = Counter(kinds.values())
    zigzags = [group for group in groups if kinds[group[0]] == ZIGZAG and len(group) < counts[ZIGZAG]]
    return _middle(model, records, zigzags, kinds) if counts[ZIGZAG] >= counts[CIRCLE] else ()


def _circles_to_one_side(orders: Mapping[str, SteeredOrders | None]) -> tuple[str, ...]:
    """The turning circles to the side of fewer, else to port, where there are others and a zigzag; else nothing."""
    port = tuple(name for name, one in orders.items() if one is not None and one.is_turn and one.rudder < 0.0)
    starboard = tuple(name for name, one in orders.items() if one is not None and one.is_turn and one.rudder > 0.0)
    has_zigzag = any(kind_of_orders(order) == ZIGZAG for order in orders.values())
    if not has_zigzag or not port or not starboard:
        return ()
    return port if len(port) <= len(starboard) else starboard


def _repeats(orders: Mapping[str, SteeredOrders | None]) -> list[tuple[str, ...]]:
    """The runs, those with the same orders together."""
    groups = list[tuple[str, ...]]()
    for name, one in orders.items():
        first = (orders[group[0]] for group in groups)
        same = next((k for k, other in enumerate(first) if one and other and other.is_repeated_by(one)), None)
        if same is None:
            groups.append((name,))
        else:
            groups[same] = (*groups[same], name)
    return groups


def _middle(
    model: StartingModel, records: Mapping[str, Record], groups: Sequence[tuple[str, ...]], kinds: Mapping[str, str]
) -> tuple[str, ...]:
    """The upper middle one by size of the groups of runs that the others include; empty where none is.

    Of the full manoeuvres of which others are left, where there is one.
    """
    sizes = {name: _size(model, record) for name, record in records.items()}
    steered = [group for group in groups if sizes[group[0]] > _HARDLY_STEERED * max(sizes.values())]
    within = (
        [g for g in able if _lie_within(model, set(g), records=records, beyond=share)]
        for able in ([g for g in steered if _is_full(g, kinds)], steered)
        for share in (_BEYOND, _FARTHER_BEYOND)
    )
    inside = next((found for found in within if found), [])
    ordered = sorted(inside, key=lambda group: sizes[group[0]])
    return ordered[len(ordered) // 2 if len(ordered) >= _CHOICE else 0] if ordered else ()


def _is_full(group: tuple[str, ...], kinds: Mapping[str, str]) -> bool:
    """Whether runs are zigzags or circles beside which others of the kind are left to train."""
    kind = kinds[group[0]]
    return kind in (ZIGZAG, CIRCLE) and any(other == kind for name, other in kinds.items() if name not in group)


def _lie_within(model: StartingModel, names: Set[str], *, records: Mapping[str, Record], beyond: float) -> bool:
    """Whether the inputs of runs stay in the range of those of the other runs, of which there are as many at least."""
    rest = [record for name, record in records.items() if name not in names]
    for symbol in model.inputs:
        ranges = [_range(model, one[symbol]) for one in rest if symbol in one]
        own = [_range(model, records[name][symbol]) for name in names if symbol in records[name]]
        if not own:
            continue
        if not ranges:
            return False
        low, high = min(a for a, _ in ranges), max(b for _, b in ranges)
        slack = beyond * (high - low)
        if min(a for a, _ in own) < low - slack or max(b for _, b in own) > high + slack:
            return False
    return len(rest) >= len(names)


def _range(model: StartingModel, values: np.ndarray) -> tuple[float, float]:
    """Of a roll decay the size of its angles: it swings to both sides, whichever it starts from."""
    used = np.abs(values - np.median(values)) if model.swings else values
    return float(np.min(used)), float(np.max(used))


def _size(model: StartingModel, record: Record) -> float:
    """The rms of the inputs; of a roll decay about its rest."""
    parts = (record[one] for one in model.inputs if one in record)
    return float(np.sqrt(sum(np.var(part) if model.swings else np.mean(part**2) for part in parts)))
