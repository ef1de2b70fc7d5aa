"""The readings of a run that explain it best, and for each the nearest other one with its distance in nats."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

from seatrial.core.values import Array
from seatrial.data.readings.candidates import (
    ColumnGroup,
    ColumnReading,
    JointReading,
    NamedColumn,
    quantity_frame,
    reversed_reading,
    variable,
)
from seatrial.data.readings.grids import grids
from seatrial.data.readings.terms import Relation, Relations

OPEN_NATS = 5.0
"""Distance of the nearest other reading below which a person decides; chosen: 0.3 % silent errors on 300 logs."""
ASSUMED_NATS, _NO_EVIDENCE = 1.5, 1.0
"""Distance from which on a side or a zero is taken by convention, where nothing measured speaks for either; chosen."""
_FAMILY = 2.5  # nats for each further column of a table in one system of units; chosen
_LIKELY = 14.0  # nats behind the best by itself, within which a candidate is tried; chosen: one relation's worth
_ROUNDING = 1e-6  # nats by which a better choice must be better: beyond the rounding of sums
_SWEEPS = 6  # of the ascent at most; chosen: two or three are enough


@dataclass(frozen=True, eq=False)
class ReadingVerdict:
    """How the columns of a variable are read.

    Attributes:
        columns: the columns.
        best, rival: the best candidate and the nearest other one; None: there is no other.
        gap: nats between them, everything else read as goes best with each.
        measured: nats of them that records show, beyond names, units and sides that are usual.
        reasons: unit, frame or positive -> the relation by which readings that differ in nothing else are worse.
        alternatives: every other candidate that was tried and the nats by which it is worse, the nearest first.
    """

    columns: tuple[NamedColumn, ...]
    best: JointReading
    rival: JointReading | None
    gap: float
    measured: float
    reasons: Mapping[str, str]
    alternatives: tuple[tuple[JointReading, float], ...] = ()

    @property
    def is_open(self) -> bool:
        """Whether a person must choose: two readings are near each other, or the heading is contradicted."""
        if self.best.contradicts:
            return True
        return self.rival is not None and self.gap < OPEN_NATS and not self.is_assumed

    @property
    def is_assumed(self) -> bool:
        """Whether nothing measured shows its side or zero, and the usual one is taken."""
        if self.rival is None or self.gap >= OPEN_NATS:
            return False
        return self.differs_by_convention and self.measured < _NO_EVIDENCE and self.gap >= ASSUMED_NATS

    @property
    def differs_by_convention(self) -> bool:
        """Whether the nearest other reading has but another side, zero or order of axes."""
        if self.rival is None:
            return False
        pairs = zip(self.best.readings, self.rival.readings, strict=True)
        return all((a.unit, a.factor) == (b.unit, b.factor) and _axes(a) == _axes(b) for a, b in pairs)


def _axes(reading: ColumnReading) -> str:
    """What is more than a convention in a frame: body or earth; axes that a pose or twist states count as stated."""
    return "" if reading.frame == "enu" or reading.symbol in ("x0", "y0", "psi") else reading.frame


def judge(groups: Sequence[Sequence[NamedColumn]]) -> list[ReadingVerdict]:
    """Return how columns are read, those of a group together, by what all of them show of one motion."""
    on = grids([column.samples for group in groups for column in group])
    variables = [variable(group, on) for group in groups]
    search = _Search(variables, Relations(tuple(grid.step for grid in on)))
    best = search.ascended(
        [max(entry, key=lambda k: v.candidates[k].own_nats) for entry, v in zip(search.likely, variables, strict=True)]
    )
    rivals = [search.rivals(best, k) for k in range(len(variables))]
    for _ in range(_SWEEPS):
        better = max((r for entry in rivals for r in entry), key=lambda r: r[0], default=None)
        if better is None or better[0] <= search.total(best) + _ROUNDING:
            break
        best = search.ascended(better[1])
        rivals = [search.rivals(best, k) for k in range(len(variables))]
    return [search.verdict(best, k, rivals[k]) for k in range(len(variables))]


@dataclass(frozen=True, eq=False)
class RefutedStatement:
    """What a trial file states of the columns of a variable, where another reading explains the records better.

    Attributes:
        columns: the columns.
        best: how they are read.
        gain, gap: nats by which it is better, everything else as it is best, and read as goes best with what is stated.
        instead: variables that are read otherwise in that case, as (columns, reading).
        reason: the relation that speaks most for it; empty: the sizes of the numbers.
    """

    columns: tuple[NamedColumn, ...]
    best: JointReading
    gain: float
    gap: float
    instead: tuple[tuple[tuple[NamedColumn, ...], JointReading], ...]
    reason: str

    @property
    def is_only(self) -> bool:
        """Whether no other reading of other columns explains the records nearly as well."""
        return self.gap >= OPEN_NATS


@dataclass(frozen=True)
class JudgedStatements:
    """What is stated of columns and refuted, and the nats of all.

    relations: relation -> nats; is_unexplained: whether one shows something that no reading explains.
    """

    refuted: tuple[RefutedStatement, ...]
    nats: float
    relations: Mapping[str, float]
    is_unexplained: bool


def judge_statements(groups: Sequence[Sequence[NamedColumn]]) -> JudgedStatements:
    """Return which readings that a trial file states, of columns that are read together, records refute."""
    on = grids([column.samples for group in groups for column in group])
    search = _Search([variable(group, on) for group in groups], Relations(tuple(grid.step for grid in on)))
    stated = [0] * len(groups)
    best = search.ascended(stated, by_pairs=False)
    if best != stated or search.is_unexplained(best):
        images = ([entry[k] for entry, k in zip(of_all, best, strict=True)] for of_all in search.images)
        singly = (search.ascended(start, by_pairs=False) for start in (best, *images))
        best = search.ascended(max(singly, key=search.total))
    for _ in range(_SWEEPS):
        rivals = [search.ascended(_as_stated(best, k), k) for k, number in enumerate(best) if number]
        better = max([*rivals, best], key=search.total)
        if search.total(better) <= search.total(best) + _ROUNDING:
            break
        best = better
    refuted = tuple(search.refuted(best, k) for k, number in enumerate(best) if number)
    return JudgedStatements(refuted, search.total(best), search.relations(best), search.is_unexplained(best))


def _as_stated(choice: Sequence[int], place: int) -> list[int]:
    """The choice with what is stated of one variable."""
    return [*choice[:place], 0, *choice[place + 1 :]]


class _Search:
    """The nats of choices of candidates, each relation computed once for the readings it depends on."""

    def __init__(self, variables: Sequence[ColumnGroup], relations: Relations) -> None:
        self.variables = variables
        self.likely = [_likely(entry) for entry in variables]
        self.images = [[_images(entry, image) for entry in variables] for image in (_exchanged, _mirrored)]
        roles = [entry.role for entry in variables]
        self.terms: list[tuple[Relation, tuple[int, ...]]] = []
        for term in relations.terms if relations.steps else ():
            members = [next((roles.index(r) for r in group if r in roles), None) for group in term.roles]
            if ("no heading",) in term.roles and "heading" not in roles:
                members[term.roles.index(("no heading",))] = members[0]
            if None not in members:
                used = {k for k in members if k is not None}
                used |= {k for k, role in enumerate(roles) if role in _BESIDE.get(term.text, ())}
                self.terms.append((term, tuple(sorted(used))))
        self._memo: dict[tuple[int, tuple[int, ...]], float] = {}

    def total(self, choice: Sequence[int]) -> float:
        """Return the nats of a choice: shares, sizes, relations, units alike."""
        own_nats = sum(entry.candidates[k].own_nats for entry, k in zip(self.variables, choice, strict=True))
        return own_nats + self._family(choice) + sum(self.term_nats(t, choice) for t in range(len(self.terms)))

    def term_nats(self, number: int, choice: Sequence[int]) -> float:
        """Return the nats of one relation."""
        term, places = self.terms[number]
        key = (number, tuple(choice[k] for k in places))
        if key not in self._memo:
            slots: dict[str, tuple[Array, ...]] = {}
            for k in places:
                slots_of_variable = self.variables[k].candidates[choice[k]].slots
                is_pose = self.variables[k].role == "place" and term.text == "the fixes"
                slots |= {"place track": slots_of_variable["track"]} if is_pose else slots_of_variable
            self._memo[key] = term.nats(slots)
        return self._memo[key]

    def relations(self, choice: Sequence[int]) -> dict[str, float]:
        """Return relation -> nats of a choice."""
        return {term.text: self.term_nats(number, choice) for number, (term, _) in enumerate(self.terms)}

    def is_unexplained(self, choice: Sequence[int]) -> bool:
        """Return whether a relation shows something that a choice does not explain."""
        return any(0.0 != nats < _NO_EVIDENCE for nats in self.relations(choice).values())

    def refuted(self, best: Sequence[int], place: int) -> RefutedStatement:
        """Return what is found of a variable whose best reading is not the stated one, its first."""
        changed = _as_stated(best, place)
        rival = self.ascended(changed, place)
        instead = tuple(
            (self.variables[k].columns, self.variables[k].candidates[number])
            for k, number in enumerate(rival) if number not in (best[k], 0)
        )  # fmt: skip
        nats = self._differences(best, changed)
        reason = max(nats, key=lambda text: nats[text], default="")
        entry, total = self.variables[place], self.total(best)
        return RefutedStatement(
            entry.columns, entry.candidates[best[place]], total - self.total(changed), total - self.total(rival),
            instead, reason if reason and nats[reason] > _NO_EVIDENCE else "",
        )  # fmt: skip

    def _family(self, choice: Sequence[int]) -> float:
        systems = [entry.candidates[k].system for entry, k in zip(self.variables, choice, strict=True)]
        return _FAMILY * sum(max(systems.count(system) - 1, 0) for system in ("deg", "rad"))

    def ascended(self, start: Sequence[int], fixed: int = -1, *, by_pairs: bool = True) -> list[int]:
        """Return the choice that no change of one variable, or of two that share a relation, betters."""
        choice = list(start)
        free = [k for k in range(len(choice)) if k != fixed and len(self.variables[k].candidates) > 1]
        pairs = [
            (a, b) for a, b in combinations(free, 2) if any(a in places and b in places for _, places in self.terms)
        ]
        score = self.total(choice)
        for _ in range(_SWEEPS):
            before = score
            for block in [(k,) for k in free] + (pairs if by_pairs else []):
                score = self._improved(choice, block, score)
            if score <= before + _ROUNDING:
                break
        return choice

    def _improved(self, choice: list[int], block: tuple[int, ...], score: float) -> float:
        """Return the score with the best options of a block of variables, which are set in the choice."""
        touched = [t for t, (_, places) in enumerate(self.terms) if set(block) & set(places)]
        kept = tuple(choice[k] for k in block)
        elsewhere = score - self._share_of_block(choice, block, touched)
        for option in product(*(self.likely[k] for k in block)):
            for k, entry in zip(block, option, strict=True):
                choice[k] = entry
            if (total := elsewhere + self._share_of_block(choice, block, touched)) > score + _ROUNDING:
                score, kept = total, option
        for k, entry in zip(block, kept, strict=True):
            choice[k] = entry
        return score

    def _share_of_block(self, choice: Sequence[int], block: Sequence[int], touched: Sequence[int]) -> float:
        """The nats that a block of variables has a part in."""
        own_nats = sum(self.variables[k].candidates[choice[k]].own_nats for k in block)
        return own_nats + self._family(choice) + sum(self.term_nats(t, choice) for t in touched)

    def rivals(self, best: Sequence[int], place: int) -> list[tuple[float, list[int]]]:
        """Return the choices with each other reading of one variable, the others as goes best with it."""
        results = []
        for other in self.likely[place]:
            if other != best[place]:
                starts = [best, *([entry[k] for entry, k in zip(of_all, best, strict=True)] for of_all in self.images)]
                choices = [
                    self.ascended([*start[:place], other, *start[place + 1 :]], place, by_pairs=False)
                    for start in starts
                ]
                results.append(max((self.total(choice), choice) for choice in choices))
        return results

    def verdict(self, best: Sequence[int], place: int, rivals: Sequence[tuple[float, list[int]]]) -> ReadingVerdict:
        """Return the verdict on one variable: against the nearest other reading that leaves it open, or the nearest."""
        entry, reasons = self.variables[place], self._reasons(best, place)
        ordered = sorted(rivals, key=lambda rival: -rival[0])
        verdicts = [self._against(best, place, choice, reasons) for _, choice in ordered]
        alone = ReadingVerdict(entry.columns, entry.candidates[best[place]], None, 0.0, 0.0, reasons)
        nearest = next((v for v in verdicts if v.is_open), next(iter(verdicts), alone))
        score = self.total(best)
        alternatives = tuple((entry.candidates[choice[place]], score - total) for total, choice in ordered)
        return replace(nearest, alternatives=alternatives)

    def _against(
        self, best: Sequence[int], place: int, other: Sequence[int], reasons: Mapping[str, str]
    ) -> ReadingVerdict:
        entry = self.variables[place]
        candidate, rival = entry.candidates[best[place]], entry.candidates[other[place]]
        measured = sum(self._differences(best, other).values())
        measured += sum(candidate.parts[why] - rival.parts[why] for why in ("size", "turn", "step"))
        gap = self.total(best) - self.total(other)
        return ReadingVerdict(entry.columns, candidate, rival, gap, measured, reasons)

    def _differences(self, best: Sequence[int], other: Sequence[int]) -> dict[str, float]:
        """Relation -> nats by which one choice has it better than another."""
        return {term.text: self.term_nats(t, best) - self.term_nats(t, other) for t, (term, _) in enumerate(self.terms)}

    def _reasons(self, best: Sequence[int], place: int) -> dict[str, str]:
        """Unit, frame or positive -> the relation that speaks most against the nearest reading that differs in it."""
        candidates, reasons = self.variables[place].candidates, dict[str, str]()
        for key in ("unit", "frame", "positive"):
            differing = [k for k in self.likely[place] if _differs_in(candidates[best[place]], candidates[k], key)]
            choices = [[*best[:place], k, *best[place + 1 :]] for k in differing]
            if choices:
                nats = self._differences(best, max(choices, key=self.total))
                reason = max(nats, key=lambda text: nats[text], default="")
                reasons |= {key: reason} if reason and nats[reason] > _NO_EVIDENCE else {}
        return reasons


def _differs_in(best: JointReading, other: JointReading, key: str) -> bool:
    """Whether two readings differ in one key and in nothing else."""
    pairs = list(zip(best.readings, other.readings, strict=True))
    return best is not other and all(replace(a, **{key: getattr(b, key)}) == b for a, b in pairs)


def _likely(variable: ColumnGroup) -> list[int]:
    """The candidates that relations may still bring to the front."""
    best = max(entry.own_nats for entry in variable.candidates)
    return [k for k, entry in enumerate(variable.candidates) if entry.own_nats > best - _LIKELY]


def _images(variable: ColumnGroup, image: Callable[[ColumnReading], ColumnReading]) -> list[int]:
    """The candidate that each becomes in an image of the world; itself where that is none."""
    numbers = {_key(entry.readings): k for k, entry in enumerate(variable.candidates)}
    return [numbers.get(_key(map(image, entry.readings)), k) for k, entry in enumerate(variable.candidates)]


def _key(readings: Iterable[ColumnReading]) -> tuple[ColumnReading, ...]:
    return tuple(replace(entry, frame=entry.frame or quantity_frame(entry.symbol)) for entry in readings)


def _exchanged(reading: ColumnReading) -> ColumnReading:
    """The reading with north and east exchanged: angles from east, and the other side of the craft."""
    if reading.symbol in ("x0", "y0", "psi") or reading.symbol.startswith("q_"):
        return replace(reading, frame="enu" if reading.frame != "enu" else "earth")
    return _mirrored(reading)


def _mirrored(reading: ColumnReading) -> ColumnReading:
    """The reading with the other side of the craft and of the world."""
    return reversed_reading(reading) if reading.symbol in ("y0", "v", "psi", "r", "delta") else reading


_BESIDE = {"the course over ground": ("cog", "velocity")}
"""Relation -> roles that it also takes where they are there."""
