"""Live checks: the findings on the trial file as it is now, run by run, those of unchanged runs kept."""

import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from seatrial import api
from seatrial.core.text.words import printable
from seatrial.core.values import Finding, InputError, TrialEdit, worst_first
from seatrial.core.values.files import is_file
from seatrial.data.read import ColumnSpec, Layout, Log, read_log
from seatrial.data.trial import Role, Run, RunFiles
from seatrial.data.trial.load import edited_text
from seatrial.data.trial.records import TrialRecord, load_parts

_MOST_KEPT = 200  # runs whose checks are kept; chosen: twice the largest trial known
_LOGS_KEPT = 4  # chosen: those of one afternoon
_LONGEST = 1500  # letters of a text of a finding; chosen


class _Superseded(Exception):
    """The check is of a text that is no longer the file's."""


class KeptLogs:
    """Reads logs, and keeps the last as they stand in their files: another unit or side needs no second reading."""

    def __init__(self) -> None:
        self._logs: dict[tuple, Log] = {}

    def read(self, path: Path, layout: Layout) -> Log:
        """Return a log as `read_log` does.

        Raises:
            InputError: it cannot be read.
        """
        columns = tuple(ColumnSpec(c.symbol, c.source, "1", twin=c.twin) for c in layout.columns)
        key = (path, path.stat().st_mtime_ns, replace(layout, columns=columns))
        if key not in self._logs:
            self._logs[key] = read_log(path, layout)
            while len(self._logs) > _LOGS_KEPT:
                del self._logs[next(iter(self._logs))]
        return self._logs[key]


class LiveCheck:
    """Checks a trial file in the background and reports after each run.

    path: of the file; report: takes the findings after each run.
    """

    def __init__(self, path: Path, report: Callable[[dict[str, Any]], None]) -> None:
        self.path = path
        self._report = report
        self._kept: dict[tuple, tuple[TrialRecord, ...]] = {}
        self.logs = KeptLogs()
        self._lock = threading.Lock()
        self._wanted = ""
        self._last: dict[str, Any] = {}
        self.findings: tuple[Finding, ...] = ()

    def request(self, version: str) -> None:
        """Check the file in the background; a check of an earlier version ends after the run that it is at."""
        if self._wanted == version:
            return
        self._wanted = version
        threading.Thread(target=self._run, args=(version,), daemon=True).start()

    @property
    def last(self) -> dict[str, Any]:
        """The last report: of which version, the findings, and whether all runs are done."""
        return self._last

    def finding(self, number: int) -> Finding:
        """Return a finding by its place in the last report.

        Raises:
            InputError: there is none.
        """
        if not 0 <= number < len(self.findings):
            raise InputError("that finding is gone; wait for the check")
        return self.findings[number]

    def _run(self, version: str) -> None:
        with self._lock:
            if self._wanted != version:
                return
            findings_so_far: list[Finding] = []

            def load(run: Run, reference_point: float) -> tuple[TrialRecord, ...]:
                if self._wanted != version:
                    raise _Superseded
                parts = self._loaded(run, reference_point)
                findings_so_far.extend(finding for part in parts for finding in part.findings)
                self._publish(version, findings_so_far, is_complete=False)
                return parts

            try:
                findings = api.check(self.path, load)
            except _Superseded:
                return
            except InputError as error:
                self._publish(version, findings_so_far, is_complete=True, problem=str(error))
                return
            self._publish(version, findings, is_complete=True)

    def _loaded(self, run: Run, reference_point: float) -> tuple[TrialRecord, ...]:
        """The run as `load_parts` reads it; role and session change nothing of it."""
        states = tuple(file.path.stat().st_mtime_ns for file in run.files if is_file(file.path))
        key = (replace(run, role=Role.TRAIN, session="-"), reference_point, states)
        if key not in self._kept:
            data = run.data.read(self.logs.read) if isinstance(run.data, RunFiles) else run.data
            self._kept[key] = load_parts(replace(run, data=data), reference_point)
            while len(self._kept) > _MOST_KEPT:
                del self._kept[next(iter(self._kept))]
        return tuple(replace(part, role=run.role, session=run.session) for part in self._kept[key])

    def _publish(
        self, version: str, findings: "tuple[Finding, ...] | list[Finding]", *, is_complete: bool, problem: str = ""
    ) -> None:
        if self._wanted != version:
            return
        self.findings = tuple(worst_first(dict.fromkeys(findings)))
        self._last = {
            "version": version,
            "complete": is_complete,
            "problem": printable(problem, _LONGEST) if problem else "",
            "findings": [_finding_row(k, finding, self.path) for k, finding in enumerate(self.findings)],
        }
        self._report(self._last)


def _finding_row(place: int, finding: Finding, path: Path) -> dict[str, Any]:
    return {
        "place": place,
        "severity": finding.severity.value,
        "code": finding.code,
        "text": printable(finding.text, _LONGEST),
        "consequence": finding.consequence,
        "advice": printable(finding.advice.removeprefix(f"{path}: "), _LONGEST),  # the page has one file
        "edits": [str(edit) for edit in finding.edits],
    }


def with_edits(text: str, path: Path, edits: tuple[TrialEdit, ...], blocks: int) -> str:
    """Return the text with the edits of a finding in every block whose channels they name.

    blocks: how many the text has.

    Raises:
        InputError: no block has the channel.
    """
    reason: InputError | None = None
    edited = text
    for place in range(blocks):
        try:
            edited = edited_text(edited, path, place, edits)
        except InputError as error:
            reason = reason or error
    if edited == text and reason is not None:
        raise reason
    return edited
