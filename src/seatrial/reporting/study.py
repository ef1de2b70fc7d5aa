"""The page of a study: claims with verdicts, checks with limits, tables, figures, runs; nothing is computed."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Bars, Check, CheckStatus, Figure, Matrix, Study, Verdict
from seatrial.core.text.numbers import duration, exact
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Severity
from seatrial.reporting.document import chapters_page
from seatrial.reporting.figures.response_charts import study_chart
from seatrial.reporting.model_chapter import version_section
from seatrial.reporting.prediction_chapter import run_section, score_table
from seatrial.reporting.runs import reading_note
from seatrial.reporting.section import (
    Cell,
    FirstScreen,
    KeyFact,
    Level,
    Picture,
    Section,
    TextTable,
    finding_section,
    number,
    result_section,
    table_of,
    words,
)

# channels a run is given rather than predicted
INPUT_CHANNELS = ("delta", "n", "v_j", "wind_speed", "wind_direction")
# significant digits of a check's value and limit; chosen
_CHECK_DIGITS = 3
# how a check is coloured
_TONES = {CheckStatus.HOLDS: "good", CheckStatus.FAILS: "bad"}
_QUICK = "Quick version, of fewer cases: the whole one may decide what is unknowable here"
_VERDICT_TONES = {Verdict.REFUTED: "bad"}


def sections(study: Study) -> tuple[Section, ...]:
    """Return the chapters of a study that have content, in order."""
    run_parts = [run_section(p, study.predictions, 0.0, INPUT_CHANNELS, {}) for p in study.predictions]
    figures = [Section(f.title, pictures=(Picture(partial(_drawing, f), f.note),)) for f in study.figures[1:]]
    facts = {"Seed": str(study.seed), "Elapsed": duration(study.elapsed_s)}
    chapters = (
        Section("The answer in full", "answer", study.answer[1:], level=Level.PAGE),
        Section("Claims", "claims", table=_claims(study)),
        _checks(study),
        Section("Tables", "tables", parts=tuple(map(result_section, study.tables)), level=Level.DETAIL, is_folded=True),
        Section("Figures", "figures", parts=tuple(figures), level=Level.PAGE, is_folded=True),
        Section(
            "Runs",
            "runs",
            table=score_table(study.predictions, 0.0) if run_parts else None,
            note=reading_note(study.predictions),
            parts=tuple(replace(part, is_folded=True) for part in run_parts),
            level=Level.DETAIL,
        ),
        finding_section(study.findings),
        version_section(study.versions, facts),
    )
    return tuple(chapter for chapter in chapters if chapter)


def html(study: Study) -> str:
    """Return the page as text; chapters without content are left out."""
    return chapters_page(
        study.kind, study.title or study.name, first_screen(study), sections(study), question=study.question
    )


def _drawing(figure: Figure | Bars | Matrix) -> str:
    return svg(study_chart(figure))


def _claims(study: Study) -> TextTable:
    return table_of(
        study.claims,
        words("Claim", lambda c: c.claim),
        words("Verdict", lambda c: Cell(c.verdict.value, c.setting, _VERDICT_TONES.get(c.verdict, ""))),
        words("Evidence", lambda c: c.evidence),
    )


def _checks(study: Study) -> Section:
    """Return the checks that fail, and folded those that hold or are withdrawn."""
    failures = [check for check in study.checks if check.status is CheckStatus.FAILS]
    table = _check_table([check for check in study.checks if check.status is not CheckStatus.FAILS])
    if not failures:
        return Section("Checks", "checks", table=table, is_folded=True)
    folded = Section("Checks that hold or are withdrawn", table=table, is_folded=True)
    return Section("Checks", "checks", table=_check_table(failures), parts=(folded,))


def _check_table(checks: Sequence[Check]) -> TextTable:
    return table_of(
        checks,
        words("Check", lambda c: c.name),
        number("Value", lambda c: exact(c.value, _CHECK_DIGITS)),
        number("Limit", lambda c: c.limit if isinstance(c.limit, str) else exact(c.limit, _CHECK_DIGITS)),
        words("Verdict", lambda c: Cell(c.status.value, tone=_TONES.get(c.status, ""))),
        words("Reason", lambda c: c.remark),
    )


def first_screen(study: Study) -> FirstScreen:
    """Return the answer, claims and checks, and the first figure."""
    first = (outcome(study) or [study.title or study.name])[0]
    failed = [c.name for c in study.checks if c.status is CheckStatus.FAILS]
    warned = [f.code for f in study.findings if f.severity is not Severity.INFO]
    holds = any(c.status is CheckStatus.HOLDS for c in study.checks)
    facts: list[KeyFact] = []
    if study.claims:
        facts.append(KeyFact("Claims", f"{len(study.claims)} judged: {study.claim_counts}", "claims"))
    if study.checks:
        facts.append(
            KeyFact(
                "Checks",
                f"{len(study.checks)}: {study.check_counts}",
                "checks",
                False if failed else holds or None,
            )
        )
    facts.append(KeyFact("Warnings", enumeration(warned) or "none", "findings" if study.findings else "", not warned))
    if study.quick:
        facts.append(KeyFact("Version", _QUICK))
    again = f"seatrial reproduce {study.name}{' --quick' if study.quick else ''} --seed {study.seed}"
    facts += [KeyFact("Source", study.source), KeyFact("Again with", again)]
    figure = Markup(svg(study_chart(study.figures[0]))) if study.figures else Markup()
    caption = f"{study.figures[0].title}. {study.figures[0].note}" if study.figures else ""
    return FirstScreen(first, tuple(facts), figure, caption)


def outcome(study: Study) -> list[str]:
    """Return the answer to the question, then how many claims have which verdict, and how many checks hold or fail."""
    sentences = list(study.answer)
    if study.quick:
        sentences.append(f"Verdicts are those of the {_QUICK[0].lower()}{_QUICK[1:]}.")
    if study.claims:
        sentences.append(f"{counted(len(study.claims), 'claim').capitalize()} judged: {study.claim_counts}.")
    if study.checks:
        failed = [c.name for c in study.checks if c.status is CheckStatus.FAILS]
        tail = f" Failing: {'; '.join(failed)}." if failed else ""
        sentences.append(f"{counted(len(study.checks), 'check').capitalize()}: {study.check_counts}.{tail}")
    return sentences
