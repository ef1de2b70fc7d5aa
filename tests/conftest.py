"""What every test may use: real records, a seeded generator, the command line, the machine's browser."""

import gc
import os
import shutil
import sys
import zlib
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import settings

from seatrial import cli
from seatrial.numerics.workers import limited_workers

if TYPE_CHECKING:
    from playwright.sync_api import Browser

REPOSITORY = Path(__file__).parents[1]

# the first example may import pandas or compile a kernel; times are for benchmarks
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

# texts are as in a pipe, uncut, though workers of a parallel run are given a terminal's width
os.environ.pop("COLUMNS", None)

# commands that tests start would each parse the whole source again where a container forbids bytecode
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

# as the command line, for the same reason
gc.set_threshold(cli.COLLECTION_THRESHOLD)

# folders whose files take longest, run first, so that no worker of a parallel run waits for one of them at the end
LONGEST_FIRST = {"studies", "cli", "reporting"}

# of files with tests marked long one in so many runs with the others, the next ones with SEATRIAL_SAMPLE=1 to 9; chosen
LONG_SHARE = 10

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
QUIET = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync"]  # fmt: skip


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the longest files first; of long tests keep a sample, unless `-m long` or their names ask for them."""
    items.sort(key=lambda item: LONGEST_FIRST.isdisjoint(item.path.relative_to(REPOSITORY).parts))
    if config.option.markexpr or any("::" in argument for argument in config.args):
        return
    sample, cases = int(os.environ.get("SEATRIAL_SAMPLE", "0")), Counter[str]()
    kept, left_out = [], []
    for item in items:
        function = item.nodeid.partition("[")[0]
        (kept if _is_in_sample(item, cases[function], sample) else left_out).append(item)
        cases[function] += 1
    config.hook.pytest_deselected(items=left_out)
    items[:] = kept


def _is_in_sample(item: pytest.Item, case: int, sample: int) -> bool:
    """Whether a test runs with the suite; long ones of a file do so together: what they share is made once."""
    long = item.get_closest_marker("long")
    if long is None or "every" not in long.kwargs:
        return long is None or (zlib.crc32(item.path.stem.encode()) - sample) % LONG_SHARE == 0
    return (case - sample) % long.kwargs["every"] == 0


@pytest.fixture(scope="session", autouse=True)
def one_thread_a_worker() -> Iterator[None]:
    """Workers of a parallel run share the cores: a map takes one thread where its number is not stated."""
    with limited_workers(1) if "PYTEST_XDIST_WORKER" in os.environ else nullcontext():
        yield


@pytest.fixture(scope="session")
def repository() -> Path:
    """The root of the checkout."""
    return REPOSITORY


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder of real records: SEATRIAL_DATA, or ../shared/data beside the checkout."""
    named = os.environ.get("SEATRIAL_DATA")
    folder = Path(named) if named else REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("real records are not here; set SEATRIAL_DATA to their folder")
    return folder


@pytest.fixture(scope="module")
def browser() -> "Iterator[Browser]":
    """The machine's Chromium, for tests that look at a page."""
    playwright = pytest.importorskip("playwright.sync_api", reason="needs playwright: pip install playwright")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip("no Chromium on this machine; install the package 'chromium' to run browser tests")
    with playwright.sync_playwright() as started:
        opened = started.chromium.launch(executable_path=path, args=QUIET)
        yield opened
        opened.close()


@pytest.fixture
def run_command(monkeypatch: pytest.MonkeyPatch) -> Callable[..., int]:
    """The command line in this process: takes the arguments after `seatrial`, returns the exit code."""

    def run(*arguments: str | Path) -> int:
        monkeypatch.setattr(sys, "argv", ["seatrial", *map(str, arguments)])
        with pytest.raises(SystemExit) as ending:
            cli.main()
        return int(ending.value.code or 0)

    return run


@pytest.fixture
def rng() -> np.random.Generator:
    """A seeded generator: the same draws in every run."""
    return np.random.default_rng(20261)
