"""What `reproduce` prints: the question, its answer, claims with their verdicts, checks with their limits."""

from typing import TYPE_CHECKING

from seatrial.cli.screen import print_heading, print_lines, print_table

if TYPE_CHECKING:
    from seatrial.core.results import Study


def print_study(study: "Study") -> None:
    """Print the question with its answer, claims with their verdicts, checks with their limits, and their numbers."""
    from seatrial.core.results import CheckStatus
    from seatrial.core.text.numbers import exact

    print_heading(study.question or study.title or study.name)
    print_lines(study.answer)
    print_lines([f"claims: {study.claim_counts or 'none'}", f"checks: {study.check_counts}"])
    rows = []
    for claim in study.claims:
        setting = f". Setting: {claim.setting}" if claim.setting else ""
        rows.append([claim.verdict, f"{claim.claim}: {claim.evidence}{setting}"])
    for check in study.checks:
        limit = check.limit if isinstance(check.limit, str) else exact(check.limit, 4)
        status = check.status.upper() if check.status is CheckStatus.FAILS else check.status
        remark = f": {check.remark}" if check.remark else ""
        rows.append([status, f"{check.name}: {exact(check.value, 4)} (limit {limit}){remark}"])
    print_heading("Claims and checks")
    print_table(rows, flush_left=(0, 1), indent="  ")
