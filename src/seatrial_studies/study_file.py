"""A study as a file: `study.toml` declares the page of a study row by row; this reads and validates it.

A row names the evidence that a function of the study computes, and words its facts. Verdicts follow from the cases of a
claim's rule: facts held against limits. Facts, formats and joints of wordings: `seatrial_studies.study_page`.
"""

import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Any, Generic, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from seatrial.core.results import Verdict
from seatrial.core.values import InputError

Relation = Literal["at most", "at least", "below", "above"]
Conditions = tuple[str | tuple[str, Relation, float | str], ...]
"""Names of facts that are true, or a fact, a relation and a limit, a number or another fact; all have to hold."""


class Declared(BaseModel):
    """What a study file declares; unknown keys are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


ValueT = TypeVar("ValueT")


class Setting(Declared, Generic[ValueT]):
    """A number of the study, or several, with its source; `quick`: in the quick version, where that has another."""

    value: ValueT
    source: str
    quick: ValueT | None = None

    def in_version(self, *, quick: bool) -> ValueT:
        """Return the value of a version."""
        return self.quick if quick and self.quick is not None else self.value


class Choice(Declared):
    """Words that hang on facts."""

    when: Conditions
    then: str
    otherwise: str = ""


class Listing(Declared):
    """The same words for each of several groups of facts."""

    each: str
    wording: str
    join: str = "; "


class PageRow(Declared):
    """A row of the page.

    Attributes:
        evidence: keys of the functions whose facts its wordings name; it is repeated for each group of facts they give.
        phrases: parts of wordings by name, each made of the facts and of the phrases before it.
        when: it is left out where this does not hold.
    """

    evidence: str | tuple[str, ...] = ()
    phrases: dict[str, Choice | Listing | str] = {}
    when: Conditions = ()


class Case(Declared):
    """A verdict and when it is given; `setting`: where a claim holds that holds in its own setting."""

    verdict: Verdict
    when: Conditions = ()
    setting: str = ""


class ClaimRow(PageRow):
    """A statement of the paper with its section, what the numbers say to it, and its rule: the first case that holds.

    comment: why the rule is what it is; not on the page.
    """

    claim: str
    section: str = ""
    wording: str
    rule: tuple[Case, ...]
    comment: str = ""

    @model_validator(mode="after")
    def _ends_with_a_case_that_always_holds(self) -> "ClaimRow":
        if not self.rule or self.rule[-1].when:
            raise ValueError(f"the last case of the rule of '{self.claim}' has to hold always")
        return self


class CheckRow(PageRow):
    """A number of ours with its limit: `at_most`, `at_least`, `between`, or a fact that `holds`, its limit in words."""

    name: str
    value: str
    at_most: float | str | None = None
    at_least: float | str | None = None
    between: tuple[float | str, float | str] | None = None
    holds: str = ""
    limit: str = ""
    reason: str = ""
    withdrawal: str = ""

    @model_validator(mode="after")
    def _has_one_limit(self) -> "CheckRow":
        if sum(bound is not None for bound in (self.at_most, self.at_least, self.between, self.holds or None)) != 1:
            raise ValueError("a check has one limit: at_most, at_least, between or holds")
        return self


class AnswerRow(PageRow):
    """A sentence of the answer."""

    wording: str


class TableRow(PageRow):
    """A table: `rows` are wordings, before those that its evidence computes; `declarations`: the four stand here."""

    title: str = ""
    header: tuple[str, ...] = ()
    rows: tuple[tuple[str | float, ...], ...] = ()
    note: str = ""
    digits: int = 3
    declarations: bool = False


class FigureRow(PageRow):
    """A figure: curves over axes with labels, bars with their unit, or a matrix, as its evidence computes it."""

    title: str
    x_label: str = ""
    y_label: str = ""
    unit: str = ""
    note: str = ""
    is_map: bool = False
    is_logarithmic: bool = False


class StudyFile(Declared):
    """Everything that a study declares.

    Attributes:
        evidence: keys of the functions whose facts every row may name.
        limits: numbers of verdicts, which every row may name.
        symbols: of the paper: meaning, unit, value or where it is printed.
        assumptions: what the paper does not print, or our copy has lost: quantity, print, what stands in its place.
        deviations: what is done otherwise than printed: place, print, what is done, why.
        paper_figures: figures of the paper: content, titles of what shows the same here, or why nothing does.
        settings: numbers of the study, each with its source, which every row may name.
        published: numbers of the paper; the study's own functions give them their types.
    """

    name: str
    source: str
    title: str
    question: str
    kind: str = "A published study repeated"
    evidence: tuple[str, ...] = ()
    limits: dict[str, float] = {}
    phrases: dict[str, Choice | Listing | str] = {}
    settings: dict[str, Setting[Any]] = {}
    published: dict[str, Any] = {}
    symbols: tuple[tuple[str, str, str, str], ...] = ()
    assumptions: tuple[tuple[str, str, str], ...] = ()
    deviations: tuple[tuple[str, str, str, str], ...] = ()
    paper_figures: tuple[tuple[str, str, Annotated[str | tuple[str, ...], Field(min_length=1)]], ...] = ()
    claims: tuple[ClaimRow, ...]
    checks: tuple[CheckRow, ...]
    answers: tuple[AnswerRow, ...] = ()
    tables: tuple[TableRow, ...]
    figures: tuple[FigureRow, ...] = ()

    def missing_counterparts(self, titles: list[str]) -> tuple[str, ...]:
        """Return the counterparts that are not among the titles of a page's tables and figures."""
        counterparts = (title for *_, here in self.paper_figures if isinstance(here, tuple) for title in here)
        return tuple(title for title in counterparts if title not in titles)


def parse_study(text: str, place: str) -> StudyFile:
    """Return the study that a text declares; `place` names the file in errors.

    Raises:
        InputError: no TOML, an unknown or missing key, or a value that its row does not allow.
    """
    try:
        return StudyFile.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{place} is no TOML: {error}") from None
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise InputError(f"{place}: '{where}': {first['msg']}; correct this key") from None


@cache
def read_study(name: str) -> StudyFile:
    """Return what the study of this name declares, from the file beside its functions.

    Raises:
        InputError: as `parse_study`.
    """
    place = files(f"seatrial_studies.{name}").joinpath("study.toml")
    return parse_study(place.read_text(encoding="utf-8"), f"study.toml of {name}")


@cache
def shared_phrases() -> dict[str, str]:
    """Return the phrases that every study may name."""
    return tomllib.loads(files("seatrial_studies").joinpath("shared.toml").read_text(encoding="utf-8"))["phrases"]


def study_setting(study: str, name: str, kind: type[ValueT]) -> Setting[ValueT]:
    """Return a setting of a study with a value of this type.

    Raises:
        InputError: the study has none of this name, or its value is of another type.
    """
    declared = read_study(study).settings
    if name not in declared or not isinstance(declared[name].value, kind):
        raise InputError(f"study.toml of {study} has no setting '{name}' of type {kind.__name__}; state it there")
    return declared[name]
