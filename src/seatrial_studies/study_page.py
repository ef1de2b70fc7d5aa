"""The page of a study: rows of its file, worded with the facts that its functions compute, become a `Study`.

Wordings are those of `str.format`. Beside Python's formats `~2` gives significant digits and a `%` at the end a share
in per cent. Several numbers are joined by a slash; after a blank `to` gives the least and the largest, `and` and `,`
join with these.
"""

import itertools
import re
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from string import Formatter
from typing import Any, Generic, TypeVar

import numpy as np

from seatrial.core.results import Bars, Check, Claim, Figure, Matrix, Prediction, Study, Table
from seatrial.core.text import significant
from seatrial.core.values import Finding, InputError, spelling_hint, versions
from seatrial_studies.study_file import (
    Case,
    CheckRow,
    Choice,
    ClaimRow,
    Conditions,
    FigureRow,
    Listing,
    PageRow,
    StudyFile,
    TableRow,
    read_study,
    shared_phrases,
)

EvidenceT = TypeVar("EvidenceT")
Facts = Mapping[str, Any]
"""What a function of a study finds, by name; tables take `rows` from it, figures what they draw."""
FactFunction = Callable[[EvidenceT], Facts | Sequence[Facts]]
FoundT = TypeVar("FoundT", bound=Facts | Sequence[Facts])

_RELATIONS = {"at most": np.less_equal, "at least": np.greater_equal, "below": np.less, "above": np.greater}
_JOINTS = {"": "/", "to": " to ", "and": " and ", ",": ", ", ";": "; "}
# a wording that is one fact, which a cell shows as a number
_BARE_FACT = re.compile(r"\{([\w.\[\]]+)\}")
# from which size on the form `g` writes whole numbers, never a power of ten
_WHOLE_FROM = 1000.0
_DECLARED = {
    "paper_figures": ("Figures of the paper", ("Figure", "it shows", "here")),
    "symbols": ("Symbols", ("Symbol", "meaning", "unit", "value")),
    "assumptions": ("Assumed", ("quantity", "print", "here")),
    "deviations": ("Deviations from the print", ("Place", "print", "here", "because")),
}
_FIGURES_NOTE = "Each figure of the paper with what shows the same thing on this page, or why nothing does."


@dataclass(frozen=True)
class FactTable(Generic[EvidenceT]):
    """The functions that compute a study's facts, each by its name, under which rows name it."""

    functions: dict[str, FactFunction[EvidenceT]] = field(default_factory=dict)

    def declare(self, function: Callable[[EvidenceT], FoundT]) -> Callable[[EvidenceT], FoundT]:
        """Enter a function under its name.

        Raises:
            ValueError: another one has this name.
        """
        name = function.__name__.rstrip("_")
        if name in self.functions:
            raise ValueError(f"two functions compute '{name}'; rename one")
        self.functions[name] = function
        return function

    def function(self, key: str) -> FactFunction[EvidenceT]:
        """Return the function of a key.

        Raises:
            InputError: there is none; the nearest is named.
        """
        if key not in self.functions:
            raise InputError(f"no function computes the evidence '{key}'{spelling_hint(key, list(self.functions))}")
        return self.functions[key]


class _WordingFormatter(Formatter):
    def get_field(self, field_name: str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        try:
            return super().get_field(field_name, args, kwargs)
        except (LookupError, AttributeError, TypeError):
            raise InputError(
                f"there is no fact '{field_name}'; name it otherwise, or the evidence that has it"
            ) from None

    def format_field(self, value: Any, format_spec: str) -> str:
        return fact_text(value, format_spec)


_FORMATTER = _WordingFormatter()


def fact_text(fact: Any, form: str) -> str:
    """Return a fact in words; several, joined as the form says, `none` where there are none."""
    number, _, joint = form.partition(" ")
    unit = " %" if number.endswith("%") else ""
    if isinstance(fact, str) or np.ndim(fact) == 0:
        return _number_text(fact, number) + unit
    kept = [min(fact), max(fact)] if joint == "to" else fact
    repeated = unit if joint in ("and", ",") else ""
    return (repeated + _JOINTS[joint]).join(_number_text(each, number) for each in kept) + unit or "none"


def _number_text(fact: Any, form: str) -> str:
    if form.endswith("%"):
        kept = form.removesuffix("%")
        return _number_text(100.0 * fact, kept if kept.startswith("~") or kept.endswith("g") else f"{kept}f")
    if form.startswith("~"):
        return significant(fact, int(form[1:]))
    return format(fact, ".0f" if form.endswith("g") and abs(fact) >= _WHOLE_FROM else form)


def fact_at(path: str, facts: Facts) -> Any:
    """Return the fact at a path such as ``errors[IWHO]`` or ``weight.mean``.

    Raises:
        InputError: there is none.
    """
    return _FORMATTER.get_field(path, (), facts)[0]


def worded(wording: str, facts: Facts) -> str:
    """Return the wording with the facts in place of their names.

    Raises:
        InputError: it names a fact that is not there.
    """
    return _FORMATTER.vformat(wording, (), facts)


def all_hold(conditions: Conditions, facts: Facts) -> bool:
    """Return whether all conditions hold; a fact of several numbers keeps a limit with each of them."""
    return all(_holds(condition, facts) for condition in conditions)


def _holds(condition: str | tuple[str, str, float | str], facts: Facts) -> bool:
    if isinstance(condition, str):
        return bool(fact_at(condition, facts))
    name, relation, limit = condition
    return bool(np.all(_RELATIONS[relation](fact_at(name, facts), _limit(limit, facts))))


def _limit(limit: float | str, facts: Facts) -> float:
    return float(fact_at(limit, facts)) if isinstance(limit, str) else limit


def _with_phrases(phrases: Mapping[str, Choice | Listing | str], facts: dict[str, Any]) -> dict[str, Any]:
    """Return the facts and the phrases made of them, each of those before it."""
    extended = dict(facts)
    for name, phrase in phrases.items():
        extended = _merged((extended, {name: _phrase(phrase, extended)}))
    return extended


def _phrase(phrase: Choice | Listing | str, facts: Facts) -> str:
    if isinstance(phrase, Choice):
        return worded(phrase.then if all_hold(phrase.when, facts) else phrase.otherwise, facts)
    if isinstance(phrase, Listing):
        return phrase.join.join(worded(phrase.wording, {**facts, **each}) for each in fact_at(phrase.each, facts))
    return worded(phrase, facts)


@dataclass(frozen=True, eq=False)
class StudyPage(Generic[EvidenceT]):
    """A study's file, its functions, and the evidence from which they compute facts."""

    file: StudyFile
    fact_table: FactTable[EvidenceT]
    evidence: EvidenceT

    @cached_property
    def common_facts(self) -> Facts:
        """Return what every row may name: evidence, settings, limits, phrases, and facts of the file's own evidence."""
        (facts,) = self._computed(self.file.evidence)
        named = {"evidence": self.evidence, "settings": self.file.settings}
        common = _merged((named, self.file.limits, facts))
        return _with_phrases(shared_phrases() | self.file.phrases, common)

    def facts_of(self, row: PageRow) -> Iterator[Facts]:
        """Return the facts for each time that the row stands on the page."""
        keys = (row.evidence,) if isinstance(row.evidence, str) else row.evidence
        for computed in self._computed(keys):
            facts = _merged((self.common_facts, computed))
            if all_hold(row.when, facts):
                yield _with_phrases(row.phrases, facts)

    def _computed(self, keys: Sequence[str]) -> Iterator[dict[str, Any]]:
        """Return each combination of the groups of facts that the functions of these keys give."""
        results = [self.fact_table.function(key)(self.evidence) for key in keys]
        groups = [[facts] if isinstance(facts, Mapping) else facts for facts in results]
        return (_merged(group) for group in itertools.product(*groups))

    def claims(self) -> tuple[Claim, ...]:
        """Return the claims with the verdicts of their rules."""
        return tuple(_claim(row, facts) for row in self.file.claims for facts in self.facts_of(row))

    def checks(self) -> tuple[Check, ...]:
        """Return the checks of our own numbers."""
        return tuple(_check(row, facts) for row in self.file.checks for facts in self.facts_of(row))

    def answer(self) -> tuple[str, ...]:
        """Return the sentences of the answer."""
        return tuple(worded(row.wording, facts) for row in self.file.answers for facts in self.facts_of(row))

    def tables(self) -> tuple[Table, ...]:
        """Return the tables in the order of the file, the four of the declarations at their place."""
        return tuple(
            table for row in self.file.tables for facts in self.facts_of(row) for table in self._tables_of(row, facts)
        )

    def _tables_of(self, row: TableRow, facts: Facts) -> list[Table]:
        return declaration_tables(self.file, worded(row.note, facts)) if row.declarations else [_table(row, facts)]

    def figures(self) -> tuple[Figure | Bars | Matrix, ...]:
        """Return the figures in the order of the file."""
        return tuple(_drawing(row, facts) for row in self.file.figures for facts in self.facts_of(row))


def _merged(groups: Iterable[Facts]) -> dict[str, Any]:
    """Return the facts of several functions together; rows of a table are those of the last.

    Raises:
        InputError: two give a fact of the same name.
    """
    merged: dict[str, Any] = {}
    for facts in groups:
        if twice := sorted(merged.keys() & facts.keys() - {"rows"}):
            raise InputError(f"two functions give the fact '{twice[0]}' to one row; rename it in one of them")
        merged |= facts
    return merged


def declaration_tables(file: StudyFile, note: str) -> list[Table]:
    """Return the four tables of the declarations; the note stands below the assumptions."""
    notes = {"paper_figures": _FIGURES_NOTE, "assumptions": note}
    return [
        Table(title, header, tuple(map(_declared_cells, getattr(file, key))), notes.get(key, ""))
        for key, (title, header) in _DECLARED.items()
    ]


def _declared_cells(declared: tuple[str | tuple[str, ...], ...]) -> tuple[str, ...]:
    return tuple(", ".join(cell) if isinstance(cell, tuple) else cell for cell in declared)


def judged(rule: Sequence[Case], facts: Facts) -> Case:
    """Return the first case of a rule that holds."""
    return next(case for case in rule if all_hold(case.when, facts))


def _claim(row: ClaimRow, facts: Facts) -> Claim:
    case = judged(row.rule, facts)
    section = f" ({row.section})" if row.section else ""
    return Claim(
        worded(row.claim, facts) + section, case.verdict, worded(row.wording, facts), worded(case.setting, facts)
    )


def _check(row: CheckRow, facts: Facts) -> Check:
    name, value, reason = worded(row.name, facts), fact_at(row.value, facts), worded(row.reason, facts)
    if row.at_most is not None:
        check = Check.at_most(name, value, _limit(row.at_most, facts), reason)
    elif row.at_least is not None:
        check = Check.at_least(name, value, _limit(row.at_least, facts), reason)
    elif row.between is not None:
        lower, upper = (_limit(limit, facts) for limit in row.between)
        check = Check.between(name, value, lower, upper, reason)
    else:
        check = Check(name, value, worded(row.limit, facts), bool(fact_at(row.holds, facts)), reason)
    return check.withdrawn(worded(row.withdrawal, facts)) if row.withdrawal else check


def _table(row: TableRow, facts: Facts) -> Table:
    declared = tuple(tuple(_cell(cell, facts) for cell in cells) for cells in row.rows)
    header = tuple(worded(name, facts) for name in row.header)
    rows = (*declared, *map(tuple, facts.get("rows", ())))
    return Table(worded(row.title, facts), header, rows, worded(row.note, facts), row.digits)


def _cell(wording: str | float, facts: Facts) -> Any:
    if not isinstance(wording, str):
        return wording
    bare = _BARE_FACT.fullmatch(wording)
    return fact_at(bare[1], facts) if bare else worded(wording, facts)


def _drawing(row: FigureRow, facts: Facts) -> Figure | Bars | Matrix:
    title, note = worded(row.title, facts), worded(row.note, facts)
    if "curves" in facts:
        labels = (worded(row.x_label, facts), worded(row.y_label, facts))
        return Figure(title, *labels, tuple(facts["curves"]), note, facts.get("is_map", row.is_map))
    if "series" in facts:
        return Bars(title, tuple(facts["labels"]), facts["series"], row.unit, note, row.is_logarithmic)
    return Matrix(title, facts["names"], facts["names"], facts["values"], note)


def study_from(
    name: str,
    fact_table: FactTable[EvidenceT],
    evidence: EvidenceT,
    *,
    seed: int,
    began: float,
    predictions: tuple[Prediction, ...] = (),
    findings: tuple[Finding, ...] = (),
) -> Study:
    """Return the study that the file of this name declares, worded from the evidence.

    Args:
        began: `time.perf_counter` when its computing began.

    Raises:
        InputError: the file, or a wording of it, is not as it should be.
    """
    file = read_study(name)
    page = StudyPage(file, fact_table, evidence)
    return Study(
        name=name,
        source=file.source,
        title=file.title,
        question=file.question,
        kind=file.kind,
        answer=page.answer(),
        claims=page.claims(),
        checks=page.checks(),
        tables=page.tables(),
        figures=page.figures(),
        predictions=predictions,
        findings=findings,
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )
