"""A real Dask cluster: lost workers cost nothing, a lost scheduler leaves a store that goes on."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.campaigns.tasks import slow_squares, work

from seatrial.campaigns import open_store
from seatrial.campaigns.engines import outcomes_by_dask
from seatrial.campaigns.run_campaign import CampaignOptions, run_campaign
from seatrial.campaigns.summary import campaign_table
from seatrial.campaigns.work import Work
from seatrial.core.values import InputError

pytest.importorskip("distributed", reason="needs the extra 'cluster'")
COUNT = 40
LONGEST_START = 120.0  # s that a scheduler may take on a busy machine
Start = Callable[..., subprocess.Popen[bytes]]


@pytest.fixture
def start(tmp_path: Path, repository: Path) -> Iterator[Start]:
    """Starts a module of Dask with arguments; ends all that were started."""
    path = os.pathsep.join([str(repository), str(repository / "src")])
    environment = {**os.environ, "PYTHONPATH": path, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "9"}
    begun: list[subprocess.Popen[bytes]] = []

    def run(module: str, *arguments: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments, "--no-dashboard"]
        begun.append(subprocess.Popen(command, env=environment, cwd=tmp_path, stderr=subprocess.DEVNULL))
        return begun[-1]

    yield run
    for process in reversed(begun):
        process.kill()
        process.wait()


@pytest.fixture
def scheduler(start: Start, tmp_path: Path) -> subprocess.Popen[bytes]:
    file = tmp_path / "scheduler.json"
    process = start("dask_scheduler", "--port", "0", "--host", "127.0.0.1", "--scheduler-file", str(file))
    stop = time.monotonic() + LONGEST_START
    while not file.exists() and time.monotonic() < stop:
        time.sleep(0.05)
    return process


def address(folder: Path) -> str:
    return json.loads((folder / "scheduler.json").read_text())["address"]


def started_worker(start: Start, folder: Path) -> subprocess.Popen[bytes]:
    return start("dask_worker", address(folder), "--nthreads", "1", "--no-nanny")


def columns(folder: Path) -> dict:
    return dict(campaign_table(open_store(folder)).columns)


@pytest.mark.usefixtures("scheduler")
def test_a_killed_worker_and_then_a_killed_scheduler_change_nothing(
    start: Start, scheduler: subprocess.Popen[bytes], tmp_path: Path
) -> None:
    campaign = work(COUNT, slow_squares)
    run_campaign(campaign, tmp_path / "here", CampaignOptions(workers=1))
    first, _ = started_worker(start, tmp_path), started_worker(start, tmp_path)
    options, done = CampaignOptions(dask=address(tmp_path)), 0

    def kill_first(text: str) -> None:
        if text.startswith("10 of"):
            first.kill()

    run_campaign(campaign, tmp_path / "there", options, kill_first)
    assert columns(tmp_path / "there") == columns(tmp_path / "here")

    def kill_scheduler(_text: str) -> None:
        nonlocal done
        done += 1
        if done == 5:
            scheduler.kill()

    with pytest.raises(InputError, match="was lost; what was finished is kept"):
        run_campaign(campaign, tmp_path / "again", options, kill_scheduler)
    kept = open_store(tmp_path / "again").status()
    assert 5 <= kept.done + kept.failed < COUNT
    run_campaign(campaign, tmp_path / "again", CampaignOptions(workers=1))
    assert columns(tmp_path / "again") == columns(tmp_path / "here")


def test_workers_of_other_versions_are_refused_by_name(
    start: Start, scheduler: subprocess.Popen[bytes], tmp_path: Path
) -> None:
    assert scheduler.poll() is None
    started_worker(start, tmp_path)
    other = Work({}, [{"seed": 1}], slow_squares, versions={"seatrial": "99.0"})
    with pytest.raises(InputError, match=r"Dask worker.* has seatrial .*, the campaign was begun with 99\.0"):
        list(outcomes_by_dask(other, other.tasks(), address(tmp_path), None))


def test_no_scheduler_is_one_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("seatrial.campaigns.engines._CONNECT_S", 0.5)
    with pytest.raises(InputError, match=r"no Dask scheduler answers at 'tcp://127\.0\.0\.1:9'"):
        list(outcomes_by_dask(work(2), work(2).tasks(), "tcp://127.0.0.1:9", None))
