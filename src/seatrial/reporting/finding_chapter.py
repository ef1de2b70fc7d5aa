"""The chapter on findings: grouped by code and advice, the most severe first, causes before what they cause."""

from collections.abc import Sequence

from markupsafe import Markup

from seatrial.core.values import Finding, worst_first
from seatrial.reporting.section import Level, Section

# findings of a group that are shown unfolded
MAX_UNFOLDED = 3
_TITLE = Markup('<span class="severity {}">{}</span><code>{}</code>')


def finding_section(findings: Sequence[Finding]) -> Section:
    """Return the chapter on the findings of a result, on the page; empty where there are none."""
    groups: dict[tuple[str, str, str], list[Finding]] = {}
    for f in worst_first(findings):
        groups.setdefault((f.severity, f.code, f.advice), []).append(f)
    parts = tuple(_group(group) for group in groups.values())
    return Section("Findings", "findings", parts=parts, level=Level.PAGE)


def _group(findings: Sequence[Finding]) -> Section:
    """Findings of one code with the same advice: the first few, the others behind a fold."""
    first, texts = findings[0], [f.text for f in findings]
    more = Section(f"{len(texts) - MAX_UNFOLDED} more", points=tuple(texts[MAX_UNFOLDED:]), is_folded=True)
    statements = [("What follows", first.consequence), ("Advice", first.advice)]
    advice = Section("", sentences=tuple(f"{name}: {text}." for name, text in statements if text))
    return Section(
        _TITLE.format(first.severity.value, first.severity.value, first.code),
        points=tuple(texts[:MAX_UNFOLDED]),
        parts=(more, advice),
    )
