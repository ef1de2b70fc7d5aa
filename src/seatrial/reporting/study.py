"""The page of a study: claims with verdicts, checks with limits, tables, figures, runs; nothing is computed."""

from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Check, CheckStatus, Study
from seatrial.core.text.numbers import exact
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Severity
from seatrial.reporting import runs, tables
from seatrial.reporting.document import page_text
from seatrial.reporting.figures.study_figures import study_chart
from seatrial.reporting.first_screen import FirstScreen, KeyFact
from seatrial.reporting.text_tables import text_table

# channels a run is given rather than predicted
INPUT_CHANNELS = ("delta", "n", "v_j", "wind_speed", "wind_direction")
TITLES = {
    "answer": "The answer in full", "claims": "Claims", "checks": "Checks", "tables": "Tables", "figures": "Figures",
    "runs": "Runs", "findings": "Findings", "versions": "Versions",
}  # fmt: skip
# significant digits of a check's value and limit; chosen
_CHECK_DIGITS = 3
# how the page colours a check
_CSS_CLASS = {CheckStatus.HOLDS: "good", CheckStatus.FAILS: "bad", CheckStatus.WITHDRAWN: "u"}


@dataclass(frozen=True)
class CheckRow:
    """A check as text."""

    name: str
    value: str
    limit: str
    status: str
    css_class: str
    remark: str


def html(study: Study) -> str:
    """Return the page as text; sections without content are left out."""
    content: dict[str, object] = {
        "answer": study.answer[1:],
        "claims": study.claims,
        "checks": [_check_row(c) for c in study.checks],
        "tables": [text_table(t) for t in study.tables],
        "figures": [(Markup(svg(study_chart(f))), f) for f in study.figures[1:]],
        "runs": runs.run_sections(study.predictions, 0.0, INPUT_CHANNELS),
        "findings": tables.finding_groups(study.findings),
    }
    titles = {key: title for key, title in TITLES.items() if content.get(key, True)}
    context = {
        **content,
        "titles": titles,
        "study": study,
        "screen": first_screen(study),
        "has_remarks": any(c.remark for c in study.checks),
        "scores": runs.score_table(study.predictions, 0.0),
        "reading_note": runs.reading_note(study.predictions),
    }
    return page_text("study.html", context)


def first_screen(study: Study) -> FirstScreen:
    """Return the answer, claims and checks, and the first figure."""
    first = (outcome(study) or [study.title or study.name])[0]
    failed = [c.name for c in study.checks if c.status is CheckStatus.FAILS]
    warned = [f.code for f in study.findings if f.severity is not Severity.INFO]
    facts: list[KeyFact] = []
    if study.claims:
        facts.append(KeyFact("Claims", f"{len(study.claims)} judged: {study.claim_counts}", "claims"))
    if study.checks:
        tail = f"; failing: {enumeration(failed)}" if failed else ""
        facts.append(KeyFact("Checks", f"{len(study.checks)}: {study.check_counts}{tail}", "checks", not failed))
    facts.append(KeyFact("Warnings", enumeration(warned) or "none", "findings" if study.findings else "", not warned))
    again = f"seatrial reproduce {study.name}{' --quick' if study.quick else ''} --seed {study.seed}"
    facts += [KeyFact("Source", study.source), KeyFact("Again with", again)]
    figure = Markup(svg(study_chart(study.figures[0]))) if study.figures else Markup()
    caption = f"{study.figures[0].title}. {study.figures[0].note}" if study.figures else ""
    return FirstScreen(first, tuple(facts), figure, caption)


def outcome(study: Study) -> list[str]:
    """Return the answer to the question, then how many claims have which verdict, and how many checks hold or fail."""
    sentences = list(study.answer)
    if study.claims:
        sentences.append(f"{counted(len(study.claims), 'claim').capitalize()} judged: {study.claim_counts}.")
    if study.checks:
        failed = [c.name for c in study.checks if c.status is CheckStatus.FAILS]
        tail = f" Failing: {'; '.join(failed)}." if failed else ""
        sentences.append(f"{counted(len(study.checks), 'check').capitalize()}: {study.check_counts}.{tail}")
    return sentences


def _check_row(c: Check) -> CheckRow:
    limit = c.limit if isinstance(c.limit, str) else exact(c.limit, _CHECK_DIGITS)
    return CheckRow(c.name, exact(c.value, _CHECK_DIGITS), limit, c.status.value, _CSS_CLASS[c.status], c.remark)
