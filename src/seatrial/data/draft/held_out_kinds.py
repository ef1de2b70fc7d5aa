"""The runs of several kinds of manoeuvre that judge a model, where two of each kind are left to train it."""

import math
from collections import Counter
from collections.abc import Callable, Collection, Mapping, Sequence, Set
from dataclasses import dataclass

from seatrial.core.values import Record
from seatrial.data.draft.motion_stretches import STRAIGHT
from seatrial.physics.manoeuvres import ManoeuvreKind, SteeredOrders

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
