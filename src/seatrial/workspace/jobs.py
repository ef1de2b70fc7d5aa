"""Long work in processes of its own, each a command of seatrial: begun, watched phase by phase, stopped."""

import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

from seatrial.core.text.progress import read_report
from seatrial.core.values import InputError
from seatrial.core.values.files import is_file, write_atomically
from seatrial.numerics.platform import start_in_background

NOTE = "job.json"
"""What became of a job, in its folder beside the result."""
REPORT_INTERVAL_S = 0.2
"""s between two reports of one phase that pages are sent; chosen: as fast as figures can be read."""
_PREFIX = "seatrial: "  # before the sentence of a command that ends with an error
_NICENESS = 5  # by which a job gives way to the workspace's own answers; chosen
_NAME = re.compile(r"[A-Za-z0-9][\w .-]{0,60}")
_GRACE_S = 60.0  # s after a job is asked to end until it is made to; chosen: `follow` writes its last estimate


class JobState(StrEnum):
    """What became of a job."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    STOPPED = "stopped"


@dataclass(eq=False)
class Job:
    """One command at work.

    Attributes:
        folder: of the result, with a note of what became of it; None: there is none; name: as pages show it.
        phases: name and begin [s] of each phase, in order; detail, done, total: of the present one.
        message: the sentence of a command that failed.
    """

    kind: str
    name: str
    folder: Path | None
    state: JobState = JobState.RUNNING
    phases: list[tuple[str, float]] = field(default_factory=list)
    detail: str = ""
    done: int = 0
    total: int = 0
    message: str = ""
    started: float = field(default_factory=time.time)
    seconds: float = 0.0
    process: "subprocess.Popen[str] | None" = None

    def view(self) -> dict[str, Any]:
        """Return what a page shows of it."""
        now = time.time() - self.started if self.state is JobState.RUNNING else self.seconds
        start = self.phases[-1][1] if self.phases else 0.0
        rest = (now - start) / self.done * (self.total - self.done) if 0 < self.done <= self.total else None
        return {
            "kind": self.kind, "name": self.name, "state": self.state.value, "detail": self.detail,
            "phases": [{"name": name, "at": round(seconds, 1)} for name, seconds in self.phases],
            "done": self.done, "total": self.total, "left": None if rest is None else round(rest, 1),
            "seconds": round(now, 1), "message": self.message,
        }  # fmt: skip


class JobRunner:
    """Starts commands, one of a name at a time, and reports each step."""

    def __init__(self, report: Callable[[Job], None]) -> None:
        self._report = report
        self._jobs: dict[str, Job] = {}
        self._lock = threading.Lock()

    @property
    def jobs(self) -> list[Job]:
        """All that were started since the workspace was opened, oldest first."""
        with self._lock:
            return list(self._jobs.values())

    @property
    def running(self) -> list[Job]:
        """Those that are at work."""
        return [job for job in self.jobs if job.state is JobState.RUNNING]

    def start(
        self, kind: str, name: str, folder: Path | None, arguments: Sequence[str], snapshot: Path | None = None,
        take_line: Callable[[str], None] = lambda _: None,
    ) -> Job:  # fmt: skip
        """Start ``python -m seatrial ARGUMENTS --verbose`` and return the job.

        snapshot: a file that is removed at its end; take_line: takes each line of its standard output.

        Raises:
            InputError: a job of that name is at work.
        """
        with self._lock:
            if name in self._jobs and self._jobs[name].state is JobState.RUNNING:
                raise InputError(f"'{name}' is being computed already; stop it first, or give another name")
            job = self._jobs[name] = Job(kind, name, folder)
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
        environment = os.environ | {"PYTHONUNBUFFERED": "1", "NO_COLOR": "1"}
        command = [sys.executable, "-m", "seatrial", *arguments, "--verbose"]
        job.process = start_in_background(command, environment, _NICENESS)
        reader = threading.Thread(target=_read_lines, args=(job.process, take_line), daemon=True)
        reader.start()
        threading.Thread(target=self._watch, args=(job, snapshot, reader), daemon=True).start()
        return job

    def stop(self, name: str) -> None:
        """Ask a job to end; its folder keeps what it held before.

        Raises:
            InputError: there is none of that name at work.
        """
        job = next((job for job in self.running if job.name == name), None)
        if job is None or job.process is None:
            raise InputError(f"'{name}' is not at work; reload the page")
        job.state = JobState.STOPPED
        job.process.terminate()
        timer = threading.Timer(_GRACE_S, job.process.kill)
        timer.daemon = True
        timer.start()
        self._report(job)

    def stop_all(self) -> None:
        """End every job that is at work."""
        for job in self.running:
            if job.process is not None:
                job.state = JobState.STOPPED
                job.process.terminate()

    def _watch(self, job: Job, snapshot: Path | None, reader: threading.Thread) -> None:
        assert job.process is not None and job.process.stderr is not None
        last = 0.0
        with job.process.stderr as lines:
            for line in lines:
                is_new = self._read(job, line.rstrip("\n"))
                if is_new or time.monotonic() - last > REPORT_INTERVAL_S:
                    last = time.monotonic()
                    self._report(job)
        code = job.process.wait()
        reader.join()
        job.seconds = time.time() - job.started
        if snapshot is not None:
            snapshot.unlink(missing_ok=True)
        if job.state is JobState.RUNNING or code == 0:
            job.state = JobState.DONE if code == 0 else JobState.FAILED
        if job.state is JobState.FAILED and not job.message:
            job.message = f"the command ended with code {code}"
        note = {key: job.view()[key] for key in ("kind", "state", "seconds", "message")}
        if job.folder is not None and job.folder.is_dir():
            write_atomically(job.folder / NOTE, (json.dumps(note, indent=2) + "\n").encode())
        self._report(job)

    @staticmethod
    def _read(job: Job, line: str) -> bool:
        """Take a line; whether it begins a phase or says why the command failed."""
        if line.startswith(_PREFIX):
            job.message = line.removeprefix(_PREFIX)
            return True
        report = read_report(line)
        job.detail, job.done, job.total = report.detail, report.done, report.total
        if job.phases and job.phases[-1][0] == report.phase:
            return False
        job.phases.append((report.phase, time.time() - job.started))
        return True


def _read_lines(process: "subprocess.Popen[str]", take_line: Callable[[str], None]) -> None:
    """Give each line of a process's standard output to a function, until it ends."""
    assert process.stdout is not None
    with process.stdout as lines:
        for line in lines:
            take_line(line)


def free_name(folder: Path, stem: str, wanted: str = "") -> str:
    """Return the name that is wanted, or the first of ``stem-1``, ``stem-2``, ... that the folder does not have.

    Raises:
        InputError: a name that is none, or that is there already.
    """
    if wanted:
        if not _NAME.fullmatch(wanted):
            raise InputError(f"'{wanted}' is no name; use letters, figures, spaces, dots and dashes")
        if is_file(folder / wanted / "result.json"):
            raise InputError(f"there is a result '{wanted}' already; give another name")
        return wanted
    return next(name for k in range(1, 10**6) if not (folder / (name := f"{stem}-{k}")).exists())


def note_of(folder: Path) -> dict[str, Any]:
    """Return what became of the job whose folder it is; empty where nothing says so."""
    try:
        note = json.loads((folder / NOTE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return note if isinstance(note, dict) else {}
