"""Logs of a craft with known coefficients, with headings that say nothing; and a workspace opened on them."""

import http.client
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import seatrial
from seatrial.physics.models import model_named
from seatrial.workspace import workspace_beside

K, T = 0.06, 12.0  # 1/s, s: of the simulated craft
NOISE_DEG = 0.1
MANOEUVRES = ("zigzag:10/10", "zigzag:20/20", "turning-circle:20")
STATED = ("A1=time", "B7=psi", "C3=delta")


def write_logs(folder: Path) -> list[Path]:
    """Write three logs of heading and rudder [deg] every half second and return their paths."""
    craft, generator = model_named("nomoto").with_values({"K": K, "T": T}), np.random.default_rng(3)
    paths = []
    for number, manoeuvre in enumerate(MANOEUVRES, start=1):
        record = seatrial.simulate(craft, manoeuvre, duration=240.0, rudder_rate=np.radians(5.0))
        every = round(0.5 / float(record.time[1] - record.time[0]))
        columns = [np.degrees(record[name][::every]) for name in ("psi", "delta")]
        psi, delta = (column + generator.normal(0.0, NOISE_DEG, len(column)) for column in columns)
        rows = zip(record.time[::every], psi % 360.0, delta, strict=True)
        path = folder / f"log_{number}.csv"
        path.write_text("A1,B7,C3\n" + "".join(f"{t:.2f},{a:.2f},{d:.2f}\n" for t, a, d in rows), encoding="utf-8")
        paths.append(path)
    return paths


def write_trial(folder: Path) -> Path:
    """Write the logs and the trial file that is drafted of them, and return its path."""
    logs = write_logs(folder)
    draft = seatrial.draft_trial(*logs, folder=folder, length=20.0, columns=STATED)
    path = folder / "trial.toml"
    path.write_text(draft.text, encoding="utf-8")
    return path


@dataclass(frozen=True)
class Opened:
    """A workspace that is served: its address with the token, without it, and the cookie that the token gives."""

    address: str
    port: int
    cookie: str

    @property
    def origin(self) -> str:
        """Its address as a page names it."""
        return f"http://127.0.0.1:{self.port}"

    def request(
        self, method: str, path: str, body: bytes = b"", headers: dict[str, str] | None = None
    ) -> tuple[int, bytes, dict[str, str]]:
        """Send a request as its page does, with other headers where they are given."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        sent = {"Cookie": self.cookie, "Origin": self.origin, **(headers or {})}
        connection.request(method, path, body, {name: value for name, value in sent.items() if value})
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        return answer.status, content, {name.lower(): value for name, value in answer.getheaders()}

    def ask(self, name: str, content: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Ask for a view or an act."""
        status, body, _ = self.request("POST", f"/api/{name}", json.dumps(content or {}).encode())
        return status, json.loads(body)


@contextmanager
def opened(path: Path) -> Iterator[Opened]:
    """Serve a folder in a thread of this process until the body ends."""
    with workspace_beside(path) as (_, address):
        yield at_address(address)


def at_address(address: str) -> Opened:
    """What a page at that address, with its token, holds."""
    port, token = int(address.split(":")[2].partition("/")[0]), address.rpartition("=")[2]
    return Opened(address, port, f"seatrial-{port}={token}")
