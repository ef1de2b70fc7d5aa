"""What is fuzzed: for each kind of input, well-formed samples and what the program does with one."""

import asyncio
import contextlib
import hashlib
import io
import json
import re
from collections.abc import Callable, MutableMapping
from dataclasses import dataclass, replace
from functools import cache
from http import HTTPStatus
from pathlib import Path
from urllib.parse import unquote

import h11
import numpy as np
from fuzz_streams import (
    bus_lines,
    infinities,
    mavlink_packets,
    nmea_sentences,
    read_bus,
    read_columns,
    read_mavlink,
    read_nmea,
)

import seatrial as st
from seatrial.core.results.online import Sample
from seatrial.core.values import Record
from seatrial.core.values.files import parse_json
from seatrial.data.folder.gains_file import read_gains
from seatrial.data.folder.model_file import parse_model
from seatrial.data.folder.result_folder import KINDS, load_result
from seatrial.data.read.record_file import read_record_csv
from seatrial.onboard.journal import Journal
from seatrial.onboard.sources import open_source
from seatrial.physics.hydro.tabulated import read_transfer
from seatrial.physics.manoeuvres import programme
from seatrial.reporting.pages import report_page
from seatrial.workspace.guard import Guard
from seatrial.workspace.server import application
from seatrial.workspace.workspace import Workspace

EXAMPLES = Path(__file__).parents[1] / "examples"
_SHORT = 1000  # bytes of a sample log: chosen, enough for every branch of a parser
_PORT, _TOKEN = 8000, "token"  # of a workspace that no socket reaches
_TINY_ROWS = 60  # of a record that is identified whole: chosen, some tenths of a second each


@dataclass(frozen=True)
class Target:
    """One kind of input.

    Attributes:
        samples: well-formed inputs.
        run: what the program does with an input, in an empty folder; returns what must hold no hidden NaN or infinity.
        cost: about how many times as long an input takes as a line of text; inputs are shared out by its inverse.
    """

    samples: Callable[[], list[bytes]]
    run: Callable[[bytes, Path], object]
    cost: float


def _examples(*patterns: str) -> list[bytes]:
    return [path.read_bytes() for pattern in patterns for path in sorted(EXAMPLES.glob(pattern))]


def _logs() -> list[bytes]:
    """The head of every example's record."""
    return [path.read_bytes()[:_SHORT].rpartition(b"\n")[0] for path in sorted(EXAMPLES.glob("*/*.csv"))]


def _tiny_trials() -> list[bytes]:
    """Trial files of a roll decay and of a zigzag whose records stand in `_records_beside`."""
    roll = (EXAMPLES / "fin_decay.toml").read_bytes().replace(b'"fin_decay"', b'"."').replace(b"decay_*", b"decay_1")
    roll = re.sub(rb"validate = .*\n", b"", roll)
    jet = (EXAMPLES / "waterjet.toml").read_bytes().replace(b'folder = "waterjet"', b'folder = "."')
    jet = re.sub(rb"train = .*\nvalidate = .*\n", b"", jet.split(b"# The published")[0]).replace(
        b"*.csv", b"zigzag.csv"
    )
    return [roll, jet]


@cache
def _records_beside() -> dict[str, bytes]:
    def head(path: Path, every: int) -> bytes:
        header, *rows = path.read_bytes().splitlines()
        return b"\n".join([header, *rows[::every][:_TINY_ROWS]])

    zigzag = next(path for path in sorted((EXAMPLES / "waterjet").glob("*.csv")) if "zigzag_25" in path.name)
    return {"decay_1.csv": head(EXAMPLES / "fin_decay" / "decay_1.csv", 5), "zigzag.csv": head(zigzag, 10)}


def _with_records(place: Path, contents: dict[str, bytes]) -> None:
    for name, content in contents.items():
        (place / name).write_bytes(content)


def _log(data: bytes, place: Path) -> Record:
    path = place / "log.csv"
    path.write_bytes(data)
    columns = (st.ColumnSpec("u", 2, "m/s"), st.ColumnSpec("psi", 3, "deg"))
    return st.read_record(path, st.Layout("text", st.ColumnSpec("time", 1, "s"), columns, header_lines=1))


def _record(data: bytes, place: Path) -> Record:
    path = place / "record.csv"
    path.write_bytes(data)
    return read_record_csv(path)


def _checked(data: bytes, place: Path) -> object:
    return [str(finding) for finding in st.check(_tiny_trial(data, place))]


def _tiny_trial(data: bytes, place: Path) -> Path:
    """A trial of which the input is the record: the decay or, with eight columns and more, the zigzag."""
    is_zigzag = data[:400].count(b",") > 5
    roll, jet = _tiny_trials()
    (place / "trial.toml").write_bytes(jet if is_zigzag else roll)
    _with_records(place, {"zigzag.csv" if is_zigzag else "decay_1.csv": data})
    return place / "trial.toml"


def _trial(data: bytes, place: Path) -> object:
    _with_records(place, {**_records_beside(), "trial.toml": data})
    trial = st.load_trial(place / "trial.toml")
    return dict(zip(trial.model.parameters.names, trial.ship.particulars.values(), strict=False))


def _identified(data: bytes, place: Path) -> object:
    """`identify` as a user has it, of a mutated trial file or of a mutated record."""
    if b"[[records]]" in data or b"[model]" in data:
        _with_records(place, {**_records_beside(), "trial.toml": data})
        trial = place / "trial.toml"
    else:
        trial = _tiny_trial(data, place)
    fit = st.identify(st.load_trial(trial))
    st.save(fit, place / "result")
    return _numbers_of_fit(fit)


def _numbers_of_fit(fit: st.Fit) -> object:
    return [c.estimate for c in fit.coefficients], fit.covariance


def _drafted(data: bytes, place: Path) -> str:
    path = place / "log.csv"
    path.write_bytes(data)
    return st.draft_trial(path, folder=place).text


def _loop(data: bytes, place: Path) -> object:
    path = place / "loop.toml"
    path.write_bytes(data.replace(b'"examples/', f'"{EXAMPLES}/'.encode()))
    return st.load_loop(path).loop.gains


@cache
def _model_text() -> bytes:
    from seatrial.data.folder.model_file import ModelFile, model_text
    from seatrial.physics.models import model_named

    model = model_named("nomoto")
    free = len(model.parameters.free)
    values = dict.fromkeys(model.parameters.missing, 1.0)
    ship = st.Ship("craft", {"L": 9.8}, "paper", 2.0)
    return model_text(
        ModelFile(model.with_values(values), 0.01 * np.eye(free), ship=ship, approach={"u": 3.0})
    ).encode()


def _model(data: bytes, place: Path) -> object:  # noqa: ARG001
    file = parse_model(data.decode(errors="replace"), "model.toml")
    record = st.simulate(file, "zigzag:20/20", duration=30.0)
    return record, file.covariance


def _manoeuvre(data: bytes, place: Path) -> object:  # noqa: ARG001
    return str(programme(data.decode(errors="replace")))


def _simulated(data: bytes, place: Path) -> object:
    """`seatrial simulate` with options out of the input, a line each."""
    (place / "model.toml").write_bytes(_model_text())
    options = [
        line for line in data.decode(errors="replace").splitlines() if not line.startswith(("--help", "--model"))
    ]
    return _command(["simulate", str(place / "model.toml"), "--out", str(place / "run.csv"), *options])


def _command(arguments: list[str]) -> str:
    """What a command prints, with the net for unexpected exceptions taken away."""
    from seatrial.cli.commands import app

    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            app(arguments, standalone_mode=False)
    except Exception as error:
        if getattr(error, "exit_code", None) not in (0, 2):  # those of the option parser have one
            raise
    return printed.getvalue()


@cache
def result_folders() -> tuple[dict[str, bytes], ...]:
    """Return name and content of every file of a fit's, a design's, a tuning's and a study's folder."""
    from tests.reporting.complete_fit import complete_fit
    from tests.reporting.fabricated import fabricated_fit
    from tests.reporting.fabricated_design import fabricated_design
    from tests.reporting.fabricated_study import fabricated_study
    from tests.reporting.fabricated_tuning import fabricated_fin

    from seatrial.data.folder.result_folder import folder_files

    fit = complete_fit(fabricated_fit())
    return tuple(folder_files(r) for r in (fit, fabricated_design(), fabricated_fin(), fabricated_study(fit)))


def _documents() -> list[bytes]:
    return [files[name] for files in result_folders() for name in files if name.endswith(".json")]


def _folder(data: bytes, place: Path) -> object:
    """A folder whose document is the input, with digests that fit; read and rendered."""
    names = [kind.document for kind in KINDS]
    table = _lenient_json(data)
    fields = table.keys() if isinstance(table, dict) else ()
    files = max(result_folders(), key=lambda one: len(_fields(one) & set(fields)))
    _with_records(place, files)
    (place / next(name for name in names if name in files)).write_bytes(data)
    return _rendered(load_result(place), data)


def _rendered(result: object, data: bytes) -> int:
    """Length of the page of a result; of one in eight, since a page takes as long as reading a hundred folders."""
    return len(report_page(result)) if len(data) % 8 == 0 else 0  # type: ignore[arg-type]


def _fields(files: dict[str, bytes]) -> set[str]:
    return set(next(json.loads(files[name]) for name in files if name.endswith(".json")))


def _lenient_json(data: bytes) -> object:
    try:
        return parse_json(data.decode())
    except ValueError:
        return None


def _model_of_folder(data: bytes, place: Path) -> object:
    """A fit's folder whose model file is the input, with the digest that fits."""
    files = dict(result_folders()[0])
    table = json.loads(files["result.json"])
    table["files"]["model.toml"] = hashlib.sha256(data).hexdigest()
    _with_records(place, {**files, "model.toml": data, "result.json": json.dumps(table).encode()})
    return _rendered(load_result(place), data)


def _arrays_of_folder(data: bytes, place: Path) -> object:
    files = dict(result_folders()[0])
    table = json.loads(files["result.json"])
    table["files"]["arrays.npz"] = hashlib.sha256(data).hexdigest()
    _with_records(place, {**files, "arrays.npz": data, "result.json": json.dumps(table).encode()})
    return _rendered(load_result(place), data)


def _gains(data: bytes, place: Path) -> object:
    path = place / "gains.toml"
    path.write_bytes(data)
    return read_gains(path)


def _journal(data: bytes, place: Path) -> object:
    """A journal read back, and written on."""
    path = place / "journal"
    path.write_bytes(data)
    journal = Journal(path, "a", 2)
    try:
        return len(list(journal.entries()))
    finally:
        journal.close()


def _journals() -> list[bytes]:
    import tempfile

    from seatrial.onboard.journal import RunEntry

    with tempfile.TemporaryDirectory() as place:
        journal = Journal(Path(place) / "journal", "a", 2)
        for k in range(20):
            journal.append(RunEntry("start") if k % 10 == 0 else Sample(0.1 * k, np.array([k, -k], float)))
        journal.close()
        return [(Path(place) / "journal").read_bytes()]


def _request(data: bytes, place: Path) -> object:
    """Statuses of what the workspace of an empty folder answers to the request in these bytes."""
    connection = h11.Connection(h11.SERVER)
    with contextlib.suppress(h11.RemoteProtocolError):
        connection.receive_data(data)
        request = connection.next_event()
        body = connection.next_event()
        if isinstance(request, h11.Request):
            content = bytes(body.data) if isinstance(body, h11.Data) else b""
            guarded = Guard(application(Workspace(place / "trial.toml", [])), _PORT, _TOKEN)
            statuses = asyncio.run(_answered(guarded, request, content))
            if any(status >= HTTPStatus.INTERNAL_SERVER_ERROR for status in statuses):
                raise RuntimeError(f"answers {statuses}")
            return statuses
    return None


async def _answered(guarded: Guard, request: h11.Request, content: bytes) -> list[int]:
    path, _, query = request.target.partition(b"?")
    scope = {
        "type": "http", "method": request.method.decode(), "path": unquote(path.decode()), "query_string": query,
        "headers": list(request.headers), "http_version": "1.1", "root_path": "", "scheme": "http",
    }  # fmt: skip
    parts, statuses = [{"type": "http.request", "body": content}], []

    async def receive() -> dict[str, object]:
        return parts.pop() if parts else {"type": "http.disconnect"}

    async def send(message: MutableMapping[str, object]) -> None:
        if message["type"] == "http.response.start":
            statuses.append(message["status"])

    await guarded(scope, receive, send)
    return statuses


def _requests() -> list[bytes]:
    own = f"Host: 127.0.0.1:{_PORT}\r\nOrigin: http://127.0.0.1:{_PORT}\r\nCookie: seatrial-{_PORT}={_TOKEN}\r\n"
    edits = (
        {"kind": "set", "place": ["ship", "L"], "value": 9.8, "version": ""},
        {"kind": "cut", "block": 0, "log": "a", "name": "b", "start": 0, "stop": 1},
        {"kind": "text", "text": "[records]", "version": ""},
        {"kind": "follow", "block": 0, "file": "today.csv"},
    )
    bodies = [("state", {}), ("onboard", {}), ("difference", {"since": ""}), *(("edit", edit) for edit in edits)]
    asked = [(f"POST /api/{name}", json.dumps(content)) for name, content in bodies]
    asked += [(f"{verb} {path}", "") for verb in ("GET", "HEAD") for path in ("/", f"/?token={_TOKEN}", "/static/x.js")]
    return [f"{line} HTTP/1.1\r\n{own}Content-Length: {len(body)}\r\n\r\n{body}".encode() for line, body in asked]


def _followed(data: bytes, place: Path) -> object:
    """`follow --once` of a log that is the input, without the estimate over the whole record."""
    trial = (EXAMPLES / "heave_pitch_follow.toml").read_text()
    log = place / "voyage.csv"
    log.write_bytes(data)
    trial = re.sub(r'file = ".*"', f'file = "{log}"', trial)
    (place / "trial.toml").write_text(re.sub(r'folder = ".*"', f'folder = "{EXAMPLES}/heave_pitch"', trial))
    loaded = st.load_trial(place / "trial.toml")
    stream = loaded.stream
    assert stream is not None
    source = open_source(replace(stream, file=log), once=True)
    samples = source.poll(0.0)
    source.close()
    return infinities(samples)


def _transfer(data: bytes, place: Path) -> object:
    path = place / "transfer.csv"
    path.write_bytes(data)
    return read_transfer(path)


def _binary(data: bytes, place: Path) -> object:
    """A log of a binary format, known by its first bytes, surveyed in the process that such readers have."""
    from seatrial.data.read import format_of

    path = place / "log.bin"
    path.write_bytes(data)
    return len(st.survey_log(path).topics) if format_of(path) else 0


def _binary_logs() -> list[bytes]:
    import tempfile

    from tests.data.read.samples import SAMPLES

    contents = []
    with tempfile.TemporaryDirectory() as place:
        for sample in SAMPLES.values():
            path = Path(place) / sample.file
            sample.write(path)
            contents += [path.read_bytes()] if path.is_file() else []
    return contents


MANOEUVRES = [b"zigzag:20/10:port", b"consecutive-zigzags:5", b"turning-circle:35", b"pull-out:20", b"spiral:25:port",
              b"prbs:10:3.5:7", b"zigzag:10/10"]  # fmt: skip
OPTIONS = [
    b"--manoeuvre\nzigzag:20/20\n--duration\n30\n--speed\n3", b"--manoeuvre\nturning-circle:35\n--rudder-rate\n5",
    b"--manoeuvre\nprbs:10:1:3\n--set\nu=3\n--duration\n60\n--seed\n4", b"--manoeuvre\nspiral\n--duration\n100",
]  # fmt: skip

TRANSFER = b"""omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag # N, N m
0.4,180,1e6,2e5,-3e7,1e6
0.8,180,5e5,1e5,-2e7,3e6
0.4,150,9e5,2e5,-2e7,1e6
0.8,150,4e5,1e5,-1e7,3e6
"""

TARGETS: dict[str, Target] = {
    "manoeuvre": Target(lambda: MANOEUVRES, _manoeuvre, 1),
    "nmea": Target(nmea_sentences, read_nmea, 1),
    "columns": Target(_logs, read_columns, 25),
    "bus": Target(bus_lines, read_bus, 1),
    "mavlink": Target(mavlink_packets, read_mavlink, 1),
    "page": Target(_requests, _request, 2),
    "journal": Target(_journals, _journal, 100),
    "trial": Target(lambda: [*_tiny_trials(), *_examples("*.toml")], _trial, 100),
    "loop": Target(lambda: _examples("*autopilot.toml", "fin_stabiliser.toml"), _loop, 10000),
    "model": Target(lambda: [_model_text()], _model, 150),
    "gains": Target(lambda: [result_folders()[2]["gains.toml"]], _gains, 8),
    "log": Target(_logs, _log, 90),
    "record": Target(lambda: [result_folders()[1]["plan.csv"][:_SHORT], *_logs()[:2]], _record, 50),
    "transfer": Target(lambda: [TRANSFER], _transfer, 12),
    "simulate": Target(lambda: OPTIONS, _simulated, 1000),
    "folder": Target(_documents, _folder, 1000),
    "folder model": Target(lambda: [result_folders()[0]["model.toml"]], _model_of_folder, 1000),
    "folder arrays": Target(lambda: [result_folders()[0]["arrays.npz"]], _arrays_of_folder, 1000),
    "check": Target(lambda: list(_records_beside().values()), _checked, 700),
    "init": Target(_logs, _drafted, 400),
    "follow": Target(_logs, _followed, 300),
    "identify": Target(lambda: [*_tiny_trials(), *_records_beside().values()], _identified, 30000),
    "binary": Target(_binary_logs, _binary, 20000),
}
"""Kinds of inputs by name."""
