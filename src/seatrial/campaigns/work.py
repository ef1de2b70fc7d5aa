"""What a campaign does: tasks with an identity by content, and what came of each, wherever it was computed."""

import base64
import copy
import hashlib
import json
import platform
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from seatrial.core.results import Fit
from seatrial.core.values import InputError, versions
from seatrial.numerics.workers import limited_workers

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController


# Keys of a trial file given other values: `estimate.rate`, `records.1.rate`.


def overridden(table: Mapping[str, Any], overrides: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of the tables of a trial file with other values of some keys, which need not exist yet.

    Args:
        overrides: path with dots -> value; blocks such as `[[records]]` count from 1.

    Raises:
        InputError: a path leads through a value that is no table, or to a block that does not exist.
    """
    result = copy.deepcopy(dict(table))
    for path, value in overrides.items():
        *steps, last = path.split(".")
        place: Any = result
        for step in steps:
            place = _inner(place, step, path)
        if isinstance(place, list):
            place[_block(place, last, path)] = value
        else:
            place[last] = value
    return result


def _inner(place: Any, step: str, path: str) -> Any:
    inner = place[_block(place, step, path)] if isinstance(place, list) else place.setdefault(step, {})
    if not isinstance(inner, dict | list):
        raise InputError(f"grid.'{path}': '{step}' is a value, no table; correct the path")
    return inner


def _block(blocks: list[Any], step: str, path: str) -> int:
    if not step.isdigit() or not 1 <= int(step) <= len(blocks):
        raise InputError(f"grid.'{path}': there is no block '{step}'; they are numbered from 1 to {len(blocks)}")
    return int(step) - 1


# On which arithmetic a result was computed: another processor or linear algebra may round differently.

_PROCESSOR_TABLE = Path("/proc/cpuinfo")


@cache
def processor() -> str:
    """Return the model of this machine's processor."""
    if _PROCESSOR_TABLE.exists():
        lines = _PROCESSOR_TABLE.read_text(encoding="utf-8", errors="replace").splitlines()
        names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
        if names:
            return names[0]
    return platform.processor() or platform.machine()


@cache
def linear_algebra() -> str:
    """Return the linear-algebra library of NumPy and SciPy with its version and the code it chose for the processor."""
    loaded = [one for one in _loaded().info() if one.get("user_api") == "blas"]
    # other packages bring libraries of their own, which depends on what else this process has imported
    libraries = [one for one in loaded if _is_of_numpy_or_scipy(Path(one["filepath"]))] or loaded
    words = {
        f"{library['internal_api']} {library.get('version')} {library.get('architecture', '')}".strip()
        for library in libraries
    }
    return ", ".join(sorted(words)) or "unknown"


def _is_of_numpy_or_scipy(library: Path) -> bool:
    return any(part.startswith(("numpy", "scipy")) for part in library.parts)


@contextmanager
def serial_linear_algebra() -> Iterator[None]:
    """Let the linear algebra of this process use one thread: sums are then rounded alike whatever the cores."""
    with _loaded().limit(limits=1, user_api="blas"):
        yield


def _loaded() -> "ThreadpoolController":
    """The libraries of this process, after loading those of NumPy and SciPy, of which a task may use either."""
    import scipy.linalg  # noqa: F401  # and with it that of NumPy
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


# What a campaign does: tasks, each a table of keys with an identity by content, and the function that does one.

Scalar = str | int | float | bool | None
Row = Mapping[str, Scalar]
TaskFunction = Callable[[Mapping[str, Any]], Sequence[Row]]

DIGEST_SIZE = 32  # bytes of a SHA-256
MAX_TASKS = 1_000_000
"""Most tasks of a campaign: chosen, a year of a core at half a minute each."""


@dataclass(frozen=True)
class Task:
    """One task: its place in the plan, what distinguishes it from the others, and its identity (SHA-256)."""

    number: int
    keys: Mapping[str, Any]
    identity: bytes


@dataclass(frozen=True, eq=False)
class Work:
    """Tasks and the function that does one.

    Attributes:
        description: what all tasks share; with the versions of the packages it is part of every identity.
        keys: one table for each task, from name to scalar (a list or table only as the value of an override).
        function: keys of a task -> rows of its result; it and what it holds must pickle.
        contents: what a task depends on beyond its keys, by the value of its key ``trial``: a digest.
        question: one sentence for the page.
    """

    description: Mapping[str, Any]
    keys: Sequence[Mapping[str, Any]]
    function: TaskFunction
    contents: Mapping[str, str] = field(default_factory=dict)
    question: str = ""
    versions: Mapping[str, str] = field(default_factory=versions)

    @property
    def digest(self) -> str:
        """Return the SHA-256 of what all tasks share, hexadecimal."""
        shared = {"description": self.description, "versions": self.versions}
        return hashlib.sha256(canonical_json(shared)).hexdigest()

    def tasks(self) -> tuple[Task, ...]:
        """Return the tasks in the order of the plan.

        Raises:
            InputError: there is none, more than a campaign takes, or one occurs twice.
        """
        refuse_count(len(self.keys))
        tasks = tuple(self._identified())
        twice = len(tasks) - len({task.identity for task in tasks})
        if twice:
            raise InputError(f"{twice} tasks of the campaign occur twice; remove repeated values of its keys")
        return tasks

    def _identified(self) -> Iterator[Task]:
        shared = self.digest.encode()
        for number, keys in enumerate(self.keys):
            content = self.contents.get(str(keys.get("trial", "")), "").encode()
            yield Task(number, keys, hashlib.sha256(b"\0".join([shared, content, canonical_json(keys)])).digest())


def refuse_count(count: int) -> None:
    """Raises:
    InputError: the campaign has no task, or more than it may have.
    """
    if count < 1:
        raise InputError("the campaign has no task; give at least one seed, value, run and trial file")
    if count > MAX_TASKS:
        raise InputError(
            f"the campaign has {count:,} tasks, more than the {MAX_TASKS:,} that one may have; give fewer values or "
            "seeds, or split it into several plans"
        )


def canonical_json(value: object) -> bytes:
    """Return the one JSON text of a value: keys in order, no spaces, numbers to the last bit."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode()


def packed(identities: Sequence[bytes]) -> str:
    """Return identities as one text."""
    return base64.b64encode(b"".join(identities)).decode()


def unpacked(text: str) -> list[bytes]:
    """Return the inverse of `packed`."""
    data = base64.b64decode(text)
    return [data[k : k + DIGEST_SIZE] for k in range(0, len(data), DIGEST_SIZE)]


# A fit as rows of a campaign's table: free coefficients, and scores of runs held out.

COEFFICIENT, SCORE = "coefficient", "score"
_NO_BOUND: Mapping[str, float] = MappingProxyType({})


def fit_rows(fit: Fit, bound: Mapping[str, float] = _NO_BOUND) -> list[Row]:
    """Return a row for each free coefficient, and one for each error of a run that was not fitted.

    Args:
        bound: coefficient -> Cramer-Rao bound of its standard error, SI.
    """
    return [*_coefficients(fit, bound), *_scores(fit)]


def _coefficients(fit: Fit, bound: Mapping[str, float]) -> list[Row]:
    return [
        {
            "row": COEFFICIENT, "run": None, "name": c.name, "unit": c.unit, "estimate": c.estimate,
            "standard_error": c.standard_error, "lower": c.lower, "upper": c.upper, "truth": c.truth,
            "bound": bound.get(c.name),
        }
        for c in fit.coefficients if not c.fixed
    ]  # fmt: skip


def _scores(fit: Fit) -> list[Row]:
    units = {"psi_deg": "deg", "theta_deg": "deg", "phi_deg": "deg", "position_m": "m", "r": "rad/s", "z": "m"}
    rows: list[Row] = []
    for prediction in fit.validation:
        rows += [
            {"row": SCORE, "run": prediction.record, "name": f"rms {key}", "unit": units.get(key, "m/s"),
             "estimate": value}
            for key, value in prediction.rms.items()
        ]  # fmt: skip
        if prediction.divergence is not None:
            seconds = prediction.divergence.seconds
            rows.append({"row": SCORE, "run": prediction.record, "name": "diverged after", "unit": "s",
                         "estimate": seconds})  # fmt: skip
    return rows


# What came of a task: rows, or a sentence why there are none; encoded where it was computed.


@dataclass(frozen=True)
class Outcome:
    """The result of one task.

    Attributes:
        is_failure: whether `body` holds a sentence in place of rows.
        seconds: wall time of the task [s].
        body: JSON: the task's keys, where it was computed, and columns of the rows, or the sentence.
    """

    identity: bytes
    is_failure: bool
    seconds: float
    body: bytes


Outcomes = Generator[Outcome, None, None]
"""Outcomes as they come; closing it ends the workers."""


@dataclass(frozen=True)
class DecodedBody:
    """The body of an outcome: columns of equal length, or why there are none, and the arithmetic it comes from."""

    keys: Mapping[str, Any]
    columns: Mapping[str, Sequence[Scalar]]
    failure: str
    processor: str
    linear_algebra: str


def attempted(function: TaskFunction, task: Task) -> Outcome:
    """Do a task and return what came of it; an error is a sentence, whatever it is.

    The task works in one thread, so that its result does not depend on the machine's cores, and as many tasks as there
    are cores do not hinder one another.
    """
    began = time.perf_counter()
    try:
        with limited_workers(1):
            rows = function(task.keys)
        body, failed = {"columns": _columns(rows)}, False
    except InputError as error:
        body, failed = {"failure": " ".join(str(error).split())}, True
    except (Exception, SystemExit) as error:  # one task must not end the others
        text = " ".join(str(error).split())
        body, failed = {"failure": f"an error of the program ({type(error).__name__}): {text}"}, True
    return Outcome(task.identity, failed, time.perf_counter() - began, _encoded(task, body))


def lost_outcome(task: Task, reason: str) -> Outcome:
    """Return the failure of a task whose worker ended without a word."""
    return Outcome(task.identity, True, 0.0, _encoded(task, {"failure": reason}))


def decoded(body: bytes) -> DecodedBody:
    """Return what a body says."""
    table: dict[str, Any] = json.loads(body)
    return DecodedBody(
        table["keys"], table.get("columns", {}), table.get("failure", ""), table["processor"], table["linear_algebra"]
    )


def _encoded(task: Task, body: Mapping[str, Any]) -> bytes:
    facts = {"keys": dict(task.keys), "processor": processor(), "linear_algebra": linear_algebra()}
    # NaN and infinities in the spelling of Python's json, which reads them back
    return json.dumps(facts | dict(body), separators=(",", ":"), ensure_ascii=False).encode()


def _columns(rows: Sequence[Row]) -> dict[str, list[Scalar]]:
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: [_plain(row.get(name)) for row in rows] for name in names}


def _plain(value: object) -> Scalar:
    """Return a NumPy scalar as one of Python."""
    return value.item() if hasattr(value, "item") else value  # type: ignore[union-attr, return-value]
