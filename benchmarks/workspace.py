"""The workspace in the browser: from an edit to its check, clicks during a fit, the first picture, the page's size.

`python benchmarks/workspace.py`. Wall-clock times, as a person waits for them; the machine's load is part of them. The
first picture needs Chromium and playwright, and its line is left out without them.
"""

import http.client
import json
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import checking
import numpy as np
from measure import Line, at_most, machine

from seatrial import api
from seatrial.workspace import workspace_beside

SAMPLES = {100_000: 1.0, 1_000_000: 3.0}  # samples of a log -> s from an edit to its check: required
CLICK_LIMIT_S, PICTURE_LIMIT_S, PAGE_LIMIT_KB = 0.15, 2.0, 400.0  # required
CLICKS, EDITS = 200, 4
SHIP = Path(__file__).parents[1] / "examples" / "ship"
LENGTH = 62.0  # m, of the ship of the examples, as the README has it
PAGE = ("", *(f"static/{name}" for name in (
    "style.css", "dark.css", "uPlot.css", "uPlot.js", "workspace.css", "app.js", "api.js", "dom.js", "charts.js",
    "logs.js", "craft.js", "fits.js", "whatif.js", "gains.js", "onboard.js", "file.js",
)))  # fmt: skip
FLAGS = ("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking")


class Client:
    """A page without a browser: asks, and times the answers."""

    def __init__(self, address: str) -> None:
        base, _, token = address.partition("/?token=")
        self.address, self.port = address, int(base.rpartition(":")[2])
        self._headers = {"Origin": base, "Cookie": f"seatrial-{self.port}={token}"}

    def get(self, path: str) -> bytes:
        """Return a file of the page."""
        return self._answer("GET", f"/{path}", b"")

    def ask(self, name: str, **content: Any) -> dict[str, Any]:
        """Return the answer to a question or an act."""
        return json.loads(self._answer("POST", f"/api/{name}", json.dumps(content).encode()))

    def _answer(self, method: str, path: str, body: bytes) -> bytes:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=600)
        connection.request(method, path, body, self._headers)
        answer = connection.getresponse()
        content = answer.read()
        connection.close()
        if answer.status != 200:
            raise RuntimeError(f"{path}: {content.decode()}")
        return content


@contextmanager
def opened(path: Path) -> Iterator[Client]:
    """Serve a folder in a thread of this process."""
    with workspace_beside(path) as (_, address):
        yield Client(address)


def check_times(client: Client) -> list[float]:
    """Seconds from each edit of the rudder's side until the check of it is complete."""

    def until_checked(version: str) -> None:
        while not ((check := client.ask("check")).get("version") == version and check["complete"]):
            time.sleep(0.01)

    until_checked(client.ask("state")["version"])
    times = []
    for k in range(EDITS):
        # a number that no earlier check has seen, beside the side: each check is of a new reading
        place = ["records", 0, "channels", "delta", "scale"]
        start = time.perf_counter()
        version = client.ask("state")["version"]
        change = client.ask("edit", kind="set", place=place, value=-1.0 - 1e-3 * k, version=version)
        until_checked(change["version"])
        times.append(time.perf_counter() - start)
    return times


def click_times(client: Client) -> list[float]:
    """Seconds of what a hand asks for while a fit is computed: views, curves, findings, an edit and its undo."""
    client.ask("start-fit")
    times = []
    while len(times) < CLICKS:
        for name, content in (
            ("state", {}), ("logs", {}), ("craft", {}), ("series", {"block": 0, "log": "zigzag_10_10"}), ("fits", {}),
        ):  # fmt: skip
            start = time.perf_counter()
            client.ask(name, **content)
            times.append(time.perf_counter() - start)
            time.sleep(0.05)  # s, as a hand pauses
        if client.ask("state")["jobs"][0]["state"] != "running":
            break
    return times


def first_picture(client: Client) -> float | None:
    """Seconds from the address to the first curve in a browser that has its files from nowhere; None without one."""
    path = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    try:
        from playwright.sync_api import sync_playwright
    except ModuleNotFoundError:
        return None
    if path is None:
        return None
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=path, args=list(FLAGS))
        times = []
        for _ in range(3):
            window = browser.new_context().new_page()
            start = time.perf_counter()
            window.goto(client.address)
            window.locator(".plot canvas").first.wait_for()
            times.append(time.perf_counter() - start)
        browser.close()
    return float(np.median(times))


def run() -> list[Line]:
    """Checks after edits, clicks during a fit, the first picture, and the size of the page."""
    lines = []
    with tempfile.TemporaryDirectory() as name:
        root = Path(name)
        for samples, limit in SAMPLES.items():
            folder = root / str(samples)
            folder.mkdir()
            checking.write_files(folder, samples)
            (folder / "iso.toml").unlink()
            with opened(folder / "seconds.toml") as client:
                value = float(np.median(check_times(client)))
            lines.append(at_most(f"workspace: edit to check, {samples:.0e} samples", value, "s", limit))
        ship = root / "ship"
        shutil.copytree(SHIP, ship)
        draft = api.draft_trial(*sorted(ship.glob("*.csv")), folder=ship, length=LENGTH)
        (ship / "trial.toml").write_text(draft.text, encoding="utf-8")
        with opened(ship) as client:
            size = sum(len(client.get(path)) for path in PAGE) / 1e3
            lines.append(at_most("workspace: page without data", size, "kB", PAGE_LIMIT_KB))
            client.ask("series", block=0, log="zigzag_10_10")
            picture = first_picture(client)
            if picture is not None:
                lines.append(at_most("workspace: opening to first picture, warm", picture, "s", PICTURE_LIMIT_S))
            times = click_times(client)
            lines.append(
                at_most("workspace: click during a fit, p95", float(np.quantile(times, 0.95)), "s", CLICK_LIMIT_S)
            )
    return lines


if __name__ == "__main__":
    print(machine())
    for line in run():
        print(f"{line.quantity:<52} {line.value:>8.3g} {line.unit:<4} {line.verdict}", flush=True)
    sys.exit()
