"""What a page asks of the workspace, as functions of values: each act an edit of the trial file, or a command begun."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from seatrial.core.text.words import printable
from seatrial.core.values import InputError
from seatrial.core.values.files import parse_toml, write_atomically
from seatrial.data.trial import Role, RunFiles
from seatrial.workspace import checks, drafting, logs_view, run_edits
from seatrial.workspace.events import EventStream
from seatrial.workspace.folder import OpenedFolder
from seatrial.workspace.jobs import Job, JobRunner, JobState, free_name
from seatrial.workspace.onboard_view import FollowedStream, with_follow_table
from seatrial.workspace.trial_document import FileChange, TrialDocument, with_comment, with_value

RESULTS = "results"
"""Folder of fits and tunings, beside the trial file."""
_PATH_KEYS = frozenset({"file", "files", "folder", "journal", "table", "loop", "gains", "priors_from", "source_file"})
_SHOWN_CHANGES = 30  # of the history, newest first; chosen

Request = Mapping[str, Any]


class Workspace:
    """A trial file, the folder around it, and what is at work.

    Attributes:
        document, folder, events, jobs, check: of the trial file that is open.
        followed: what is or was followed; None: nothing.
        logs: that were named when it was opened, of which a first draft is made.
    """

    def __init__(self, trial: Path, logs: list[Path]) -> None:
        self.document = TrialDocument(trial)
        self.folder = OpenedFolder(trial.parent)
        self.logs = logs
        self.events = EventStream()
        self.jobs = JobRunner(self._note_job)
        self.check = checks.LiveCheck(trial, lambda content: self.events.publish("check", content))
        self.followed: FollowedStream | None = None
        self._allowed_paths = _paths_in(self.document.text)

    # What a page shows.

    def state(self) -> dict[str, Any]:
        """Return the trial file, its changes, the folder, and what is at work."""
        text, history = self.document.text, self.document.history
        changes = [{"summary": c.summary, "diff": c.diff} for c in reversed(history[-_SHOWN_CHANGES:])]
        return {
            "name": self.document.path.name, "folder": self.folder.root.name, "text": text,
            "version": self.document.version, "exists": bool(text), "changes": changes, "undoable": len(history),
            "logs": [path.relative_to(self.folder.root).as_posix() for path in self.folder.logs],
            "named": [path.relative_to(self.folder.root).as_posix() for path in self.logs],
            "jobs": [job.view() for job in self.jobs.jobs], "check": self.check.last,
        }  # fmt: skip

    def begin_check(self) -> dict[str, Any]:
        """Check the file as it is now in the background; what is known already is returned."""
        version = self.document.version
        if self.document.text:
            self.check.request(version)
        return self.check.last

    # Edits: each returns the change, and starts a check.

    def edit(self, request: Request) -> dict[str, Any]:
        """Edit the trial file as a page asks: `kind` and its values, `version` of the text that was shown.

        Raises:
            EditConflictError: the file has changed since. InputError: what is wrong with the edit.
        """
        kind = str(request.get("kind", ""))
        edits: dict[str, Callable[[Request], tuple[Callable[[str], str], str]]] = {
            "set": self._set, "channel": self._channel, "cut": self._cut, "remove": self._remove,
            "rename": self._rename, "role": self._role, "text": self._text, "draft": self._draft,
            "finding": self._finding, "restore": self._restore, "follow": self._follow,
        }  # fmt: skip
        if kind not in edits:
            raise InputError("the page asks for an edit that this version does not know; reload it")
        edit, summary = edits[kind](request)

        def guarded(text: str) -> str:
            edited = edit(text)
            self._refuse_paths_outside(edited)
            return edited

        return self._changed(self.document.apply(guarded, str(request.get("version", "")), summary))

    def undo(self, request: Request) -> dict[str, Any]:
        """Take the last change back.

        Raises:
            EditConflictError: the file has changed since. InputError: there is nothing to undo.
        """
        return self._changed(self.document.undo(str(request.get("version", ""))))

    def _changed(self, change: FileChange) -> dict[str, Any]:
        version = self.document.version
        self.events.publish("changed", {"version": version, "summary": change.summary})
        self.begin_check()
        return {"version": version, "summary": change.summary, "diff": change.diff}

    def _refuse_paths_outside(self, text: str) -> None:
        """Refuse a file that names places outside the folder which it did not name when it was opened.

        Raises:
            InputError: there is one.
        """
        for path in _paths_in(text) - self._allowed_paths:
            if "$" in path:
                raise InputError(f"'{printable(path)}' has a variable in it; write such a path in an editor")
            self.folder.place(path)

    @staticmethod
    def _set(request: Request) -> tuple[Callable[[str], str], str]:
        place, value = request["place"], request.get("value")
        name = ".".join(str(key) for key in place if not isinstance(key, int))
        return lambda text: with_value(text, place, value), f"{name} = {value}" if value is not None else f"no {name}"

    @staticmethod
    def _channel(request: Request) -> tuple[Callable[[str], str], str]:
        """A channel from a column, or none; what the draft left open of it is decided by that."""
        block, source, symbol = int(request["block"]), int(request.get("source", -1)), str(request["symbol"])
        table = request.get("table")
        head: tuple[str | int, ...] = ("records", block) if source < 0 else ("records", block, "sources", source)
        place = (*head, "channels", symbol)

        def edit(text: str) -> str:
            rows = [row for where, row in logs_view.open_rows(text) if (where, row["symbol"]) == (block, symbol)]
            text = with_value(logs_view.without_open_lines(text, block, symbol), place, table)
            return text if table is None else with_comment(text, place, rows[0]["reason"] if rows else "")

        return edit, f"no {symbol}" if table is None else f"{symbol} is column '{table['column']}'"

    def _cut(self, request: Request) -> tuple[Callable[[str], str], str]:
        block, log, name = int(request["block"]), str(request["log"]), str(request["name"])
        ends = float(request["start"]), float(request["stop"])
        duration, role = self._duration(block, log), str(request.get("role", ""))

        def edit(text: str) -> str:
            text = run_edits.with_part(text, block, log, ends, name, duration)
            return self._with_role(text, block, name, Role(role)) if role else text

        return edit, f"{name}: {ends[0]:.4g} to {ends[1]:.4g} s of {log}{' held out' if role == 'validate' else ''}"

    def _duration(self, block: int, log: str) -> float:
        runs = logs_view.runs_by_block(self.document.text, self.document.path).get(block, ())
        for run in runs:
            if isinstance(run.data, RunFiles) and logs_view.is_of_log(run, log):
                record = RunFiles(log, run.files).read()
                return float(record.time[-1] - record.time[0])
        raise InputError(f"there is no log '{printable(log)}' in that block; reload the page")

    @staticmethod
    def _remove(request: Request) -> tuple[Callable[[str], str], str]:
        block, name = int(request["block"]), str(request["name"])
        return lambda text: run_edits.without_part(text, block, name), f"{name} is no run"

    def _rename(self, request: Request) -> tuple[Callable[[str], str], str]:
        block, name, new_name = int(request["block"]), str(request["name"]), str(request["new_name"])
        every = logs_view.runs_by_block(self.document.text, self.document.path)
        names = [run.name for runs in every.values() for run in runs]
        return lambda text: run_edits.with_run_name(text, block, name, new_name, names), f"{name} is called {new_name}"

    def _role(self, request: Request) -> tuple[Callable[[str], str], str]:
        block, name, role = int(request["block"]), str(request["name"]), Role(str(request["role"]))
        words = {Role.TRAIN: "is fitted", Role.VALIDATE: "is held out", Role.LEAVE_OUT: "is left out"}
        return lambda text: self._with_role(text, block, name, role), f"{name} {words[role]}"

    def _with_role(self, text: str, block: int, name: str, role: Role) -> str:
        runs = logs_view.runs_by_block(text, self.document.path).get(block, ())
        return run_edits.with_role(text, block, runs, name, role)

    @staticmethod
    def _text(request: Request) -> tuple[Callable[[str], str], str]:
        text = str(request["text"])
        return lambda _: text, str(request.get("summary", "edited as text"))

    def _draft(self, request: Request) -> tuple[Callable[[str], str], str]:
        """A first draft of the named logs, or ship and model again with what is known of the craft."""
        names = [str(name) for name in request.get("logs", ())]
        logs = [self.folder.file(name) for name in names] or self.own_logs() or self.folder.logs
        text, is_new = self.document.text, bool(request.get("anew"))
        stated = request.get("sizes", {} if is_new or not text else drafting.stated_sizes(text))
        sizes = {str(key): float(value) for key, value in stated.items()}
        columns, name = [str(text) for text in request.get("columns", ())], str(request.get("name", ""))
        home = self.folder.root
        if not logs:
            raise InputError("there is no log in the folder; drop one on the page")
        summary = "drafted from the logs" if is_new or not text else "craft and model drafted again"
        # before the file is locked, as it takes its time; the version says whether it still holds
        drafted = drafting.drafted_text("" if is_new else text, home, logs, sizes, columns, name)
        return lambda _: drafted, summary

    def own_logs(self) -> list[Path]:
        """Return the logs that the trial file names; empty where it cannot be read."""
        try:
            every = logs_view.runs_by_block(self.document.text, self.document.path)
        except InputError:
            return []
        return list(dict.fromkeys(file.path for runs in every.values() for run in runs for file in run.files))

    def _finding(self, request: Request) -> tuple[Callable[[str], str], str]:
        """What a finding advises, or that it is accepted: what a person says overrules what is guessed."""
        finding, is_accepted = self.check.finding(int(request["place"])), bool(request.get("accept"))
        if is_accepted:
            return lambda text: _with_accepted(text, finding.code), f"{finding.code} is accepted"
        if not finding.edits:
            raise InputError("this finding has no edit that is certain; correct the file by what it advises")
        path, blocks = self.document.path, len(parse_toml(self.document.text).get("records", ()))
        return (
            lambda text: checks.with_edits(text, path, finding.edits, blocks),
            "; ".join(str(edit) for edit in finding.edits),
        )

    def _restore(self, request: Request) -> tuple[Callable[[str], str], str]:
        name = str(request["name"])
        text = self.folder.file(f"{name}/trial.toml").read_text(encoding="utf-8")
        return lambda _: text, f"trial file of {name} restored"

    def _follow(self, request: Request) -> tuple[Callable[[str], str], str]:
        block = int(request["block"])
        runs = logs_view.runs_by_block(self.document.text, self.document.path).get(block, ())
        if not runs:
            raise InputError("there is no run in that block; reload the page")
        time = runs[-1].raw_record().time
        rate = float(f"{(len(time) - 1) / float(time[-1] - time[0]):.4g}")
        file = str(request.get("file", "")).strip()
        return lambda text: with_follow_table(text, block, file, rate), f"{file} is followed as it grows"

    # Commands that take their time.

    def start_fit(self, request: Request) -> dict[str, Any]:
        """Start `identify` on the trial file as it is now; later edits do not touch it.

        Raises:
            InputError: a name that is taken, or options that `identify` does not have.
        """
        results = self.folder.root / RESULTS
        name = free_name(results, "fit", str(request.get("name", "")))
        folder, text = results / name, self.document.text
        snapshot = self.document.path.with_name(f".{name}.{self.document.path.name}")
        write_atomically(snapshot, text.encode())
        write_atomically(folder / "trial.toml", text.encode())
        arguments = ["identify", str(snapshot), "--out", str(folder), "--seed", str(int(request.get("seed", 0)))]
        if intervals := str(request.get("intervals", "")):
            arguments += ["--intervals", intervals]
        arguments += [f"--{option}" for option in ("choose", "compare") if request.get(option)]
        return self.jobs.start("fit", f"{RESULTS}/{name}", folder, arguments, snapshot).view()

    def start_tuning(self, request: Request) -> dict[str, Any]:
        """Start `tune` of a loop file, on the model of a fit where one is named."""
        loop = self.folder.file(str(request["loop"]))
        results = self.folder.root / RESULTS
        name = free_name(results, "tuning", str(request.get("name", "")))
        arguments = ["tune", str(loop), "--out", str(results / name), "--seed", str(int(request.get("seed", 0)))]
        if fit := str(request.get("fit", "")):
            arguments += ["--from", str(self.folder.file(f"{fit}/model.toml"))]
        return self.jobs.start("tuning", f"{RESULTS}/{name}", results / name, arguments).view()

    def start_follow(self, request: Request) -> dict[str, Any]:
        """Start `follow` of the source that the trial file names; `once`: it ends with the input, with a fit.

        Raises:
            InputError: it is followed already, or a name that is taken.
        """
        if self.followed is not None and not self.followed.is_over:
            raise InputError("the stream is followed already; stop that first")
        results = self.folder.root / RESULTS
        name = free_name(results, "onboard", str(request.get("name", "")))
        write_atomically(results / name / "trial.toml", self.document.text.encode())
        arguments = ["follow", str(self.document.path), "--out", str(results / name), "--reports"]
        arguments += ["--once"] if request.get("once") else []
        followed = self.follow(f"{RESULTS}/{name}")
        return self.jobs.start(
            "follow", followed.name, results / name, arguments, take_line=lambda line: _take_report(followed, line)
        ).view()

    def follow(self, name: str = "") -> FollowedStream:
        """Return what takes the reports of a follower from now on; name: of its job, empty: it has none."""
        self.followed = FollowedStream(lambda content: self.events.publish("onboard", content), name)
        return self.followed

    def _note_job(self, job: Job) -> None:
        if self.followed is not None and job.name == self.followed.name and job.state is not JobState.RUNNING:
            self.followed.end(job.message)
        self.events.publish("job", job.view())

    def start_poster(self, request: Request) -> dict[str, Any]:
        """Start `poster` of a fit; its page lies in the fit's folder."""
        fit = str(request["fit"])
        folder = self.folder.file(f"{fit}/result.json").parent
        arguments = ["poster", str(folder), "--out", str(folder / "poster.html")]
        if request.get("speed") is not None:
            arguments += ["--speed", str(float(request["speed"]))]
        return self.jobs.start("poster", f"poster of {fit}", None, arguments).view()

    def close(self) -> None:
        """End what is at work."""
        self.jobs.stop_all()
        self.events.close()


def _take_report(followed: FollowedStream, line: str) -> None:
    """Take a line of a follower's output that is a report; others are for people."""
    if line.startswith("{"):
        followed.take(json.loads(line))


def _with_accepted(text: str, code: str) -> str:
    accepted = parse_toml(text).get("accept", [])
    codes = [accepted] if isinstance(accepted, str) else list(accepted)
    return with_value(text, ("accept",), [*codes, code] if code not in codes else codes)


def _paths_in(text: str) -> set[str]:
    """The paths that a trial file names, as they stand there; none of a text that is no TOML."""
    try:
        tables = parse_toml(text)
    except ValueError:
        return set()
    return set(_named(tables))


def _named(value: object, key: str = "") -> list[str]:
    if isinstance(value, Mapping):
        return [path for name, inner in value.items() for path in _named(inner, str(name))]
    if isinstance(value, list):
        return [path for inner in value for path in _named(inner, key)]
    return [value] if key in _PATH_KEYS and isinstance(value, str) and value else []
