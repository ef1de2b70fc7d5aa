"""Campaigns: overhead of a task, speed-up of processes, `status` of many tasks, and what kills cost.

`python benchmarks/campaign.py overhead` measures tasks that do nothing; `speedup` Monte Carlo fits; `status` a store of
100 000 tasks; `kills --kills 200 --schedulers 20` kills processes of a campaign, and its Dask scheduler, at random
moments and compares the table with an undisturbed one. Without a name all, with few kills.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from measure import Line, at_least, at_most, machine

from seatrial.campaigns import Row, Work, open_store
from seatrial.campaigns.engines import WorkerKind
from seatrial.campaigns.run_campaign import CampaignOptions, Shard, run_campaign, work_of_plan
from seatrial.campaigns.store import store_for
from seatrial.campaigns.summary import campaign_table, write_table
from seatrial.campaigns.work import Outcome, attempted

EXAMPLE = Path(__file__).parents[1] / "examples" / "coverage.toml"
ROOT = Path(__file__).parents[1]


_MOMENT_S = 0.02  # s between looks at a store, and the longest wait before a kill: chosen, four tasks


def nothing(keys: Mapping[str, Any]) -> Sequence[Row]:
    """One row at no cost."""
    return [{"name": "seed", "estimate": float(keys["seed"])}]


def a_moment(keys: Mapping[str, Any]) -> Sequence[Row]:
    """The same after 5 ms."""
    time.sleep(0.005)
    return nothing(keys)


def work(count: int, function: Any = nothing) -> Work:
    """A campaign of so many seeds."""
    return Work({"kind": "benchmark"}, [{"seed": seed} for seed in range(count)], function)


def seconds_of(one: Work, options: CampaignOptions) -> float:
    """Wall time [s] of a campaign in a store of its own."""
    with tempfile.TemporaryDirectory() as folder:
        began = time.perf_counter()
        run_campaign(one, Path(folder) / "store", options)
        return time.perf_counter() - began


def overhead(count: int = 2000, few: int = 200) -> list[Line]:
    """Time of a task that does nothing: difference of a long and a short campaign over the tasks between."""
    lines = []
    for name, options, limit in (
        ("threads", CampaignOptions(workers=2, kind=WorkerKind.THREADS), 2.0),
        ("processes", CampaignOptions(workers=2), None),
        ("Dask, two workers", CampaignOptions(workers=2, dask="local"), 8.0),
    ):
        long, short = seconds_of(work(count), options), seconds_of(work(few), options)
        value = 1000.0 * (long - short) / (count - few)
        quantity = f"overhead of a task, {name}"
        lines.append(Line(quantity, value, "ms") if limit is None else at_most(quantity, value, "ms", limit))
    return lines


def speedup(fits: int = 24) -> list[Line]:
    """Two processes against one over fits of the example, both with processes started and code loaded beforehand."""
    whole = work_of_plan(EXAMPLE)

    def first(count: int) -> Work:
        return Work(whole.description, whole.keys[:count], whole.function)

    times = {}
    for workers, options in ((1, CampaignOptions(workers=1)), (2, CampaignOptions(workers=2))):
        times[workers] = seconds_of(first(fits), options) - seconds_of(first(workers), options)
    share = (fits - 1) / (fits - 2)  # fits that were timed: one was taken off with the start of each process
    return [at_least("speed-up of two processes", times[1] / times[2] / share, "", 1.7)]


def status(count: int = 100_000) -> list[Line]:
    """Wall time of the status of a store in which all tasks are done."""
    with tempfile.TemporaryDirectory() as folder:
        one = work(count)
        tasks = one.tasks()
        store = store_for(one, tasks, Path(folder) / "store")
        journal = store.new_journal(1e9)
        body = attempted(nothing, tasks[0]).body * 8  # as long as that of a fit
        for task in tasks:
            journal.append(Outcome(task.identity, False, 1.0, body))
        journal.close()
        began, spent = time.perf_counter(), time.process_time()
        counts = open_store(store.folder).status()
        assert counts.done == count
        wall, spent = time.perf_counter() - began, time.process_time() - spent
        return [at_most(f"status of {count} tasks", wall, "s", 1.0), Line("of that processor time", spent, "s")]


def table_bytes(folder: Path) -> bytes:
    """The gathered table of a store."""
    path = folder.with_suffix(".csv")
    write_table(campaign_table(open_store(folder)), path)
    return path.read_bytes()


def shards(count: int = 2000) -> list[Line]:
    """Whether 16 shards give the bits of one."""
    with tempfile.TemporaryDirectory() as place:
        one, sixteen = Path(place) / "one", Path(place) / "sixteen"
        run_campaign(work(count), one, CampaignOptions(workers=1))
        for index in range(16, 0, -1):
            run_campaign(work(count), sixteen, CampaignOptions(workers=1, shard=Shard(index, 16)))
        return [at_most("bytes that differ, 16 shards", _differing(table_bytes(one), table_bytes(sixteen)), "", 0)]


def _differing(first: bytes, second: bytes) -> int:
    return abs(len(first) - len(second)) + sum(a != b for a, b in zip(first, second, strict=False))


def _campaign_process(folder: Path, count: int, dask: str) -> None:
    run_campaign(work(count, a_moment), folder, CampaignOptions(workers=2, dask=dask))


def kills(count: int = 2000, kill_count: int = 20, seed: int = 1) -> list[Line]:
    """Kill workers, and every fifth time the whole campaign, each after a random number of further tasks.

    Kills are paced by tasks, not by the clock, so that on a busy machine too they fall within the campaign.
    """
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        folder, undisturbed = Path(place) / "store", Path(place) / "undisturbed"
        run_campaign(work(count), undisturbed, CampaignOptions(workers=1))
        killed = starts = 0
        while _remaining(folder, count):
            starts += 1
            process = _started(folder, count, "")
            while process.poll() is None and killed < kill_count:
                _wait_for_tasks(process, folder, count, rng.randrange(max(count // kill_count, 1) + 1))
                time.sleep(rng.uniform(0.0, _MOMENT_S))
                if process.poll() is None and _kill_something(process, whole=killed % 5 == 4, rng=rng):
                    killed += 1
            process.wait()
        names = [Line("kills of workers and campaigns", killed, ""), Line("starts of the campaign", starts, "")]
        return [*names, *_compared(folder, undisturbed, count)]


def scheduler_kills(count: int = 2000, kill_count: int = 2, seed: int = 1) -> list[Line]:
    """Kill the Dask scheduler so many times, then let the campaign end."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as place:
        folder, undisturbed = Path(place) / "store", Path(place) / "undisturbed"
        run_campaign(work(count), undisturbed, CampaignOptions(workers=1))
        for _ in range(kill_count):
            file = Path(place) / "scheduler.json"
            file.unlink(missing_ok=True)
            scheduler = _dask("scheduler", "--port", "0", "--scheduler-file", str(file))
            while not file.exists():
                time.sleep(0.1)
            workers = [_dask("worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny") for _ in "ab"]
            process = _started(folder, count, _address(file))
            _wait_for_tasks(process, folder, count, rng.randrange(1, max(count // (2 * kill_count), 2)))
            for one in (scheduler, *workers):
                one.kill()
                one.wait()
            process.wait()
        left = _remaining(folder, count)
        run_campaign(work(count), folder, CampaignOptions(workers=1))
        names = [Line("kills of the scheduler", kill_count, ""), Line("tasks left after them", left, "")]
        return [*names, *_compared(folder, undisturbed, count)]


def _compared(folder: Path, undisturbed: Path, count: int) -> list[Line]:
    table = campaign_table(open_store(folder)).columns["task"]
    return [
        at_most("tasks lost", count - len(set(table)), "", 0),
        at_most("tasks counted twice", len(table) - len(set(table)), "", 0),
        at_most("bytes that differ from the undisturbed table", _differing(table_bytes(folder),
                table_bytes(undisturbed)), "", 0),
    ]  # fmt: skip


def _wait_for_tasks(process: subprocess.Popen[bytes], folder: Path, count: int, wanted: int) -> None:
    """Wait until so many further tasks are done, or the process has ended."""
    before = _remaining(folder, count)
    while process.poll() is None and before - _remaining(folder, count) < wanted:
        time.sleep(_MOMENT_S)


def _remaining(folder: Path, count: int) -> int:
    return open_store(folder).status().remaining if (folder / "campaign.json").exists() else count


def _started(folder: Path, count: int, dask: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, __file__, "--one", str(folder), "--tasks", str(count), "--dask", dask]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL, env=_environment())


def _dask(kind: str, *arguments: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *arguments, "--no-dashboard"]
    return subprocess.Popen(command, stderr=subprocess.DEVNULL, env=_environment())


def _environment() -> dict[str, str]:
    path = os.pathsep.join([str(ROOT / "benchmarks"), os.environ.get("PYTHONPATH", "")])
    return {**os.environ, "PYTHONPATH": path, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "20"}


def _address(file: Path) -> str:
    import json

    return json.loads(file.read_text())["address"]


def _kill_something(process: subprocess.Popen[bytes], *, whole: bool, rng: random.Random) -> bool:
    """Kill the campaign, or one of its workers; whether there was one."""
    if whole:
        process.send_signal(signal.SIGKILL)
        return True
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    pids = [int(pid) for pid in children.read_text().split()] if children.exists() else []
    workers = [pid for pid in pids if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()]
    if not workers:
        return False
    os.kill(rng.choice(workers), signal.SIGKILL)
    return True


def run() -> list[Line]:
    """All, with few kills."""
    return [*overhead(), *speedup(), *status(), *shards(), *kills(400, 10), *scheduler_kills(200, 2)]


def main(arguments: list[str]) -> int:
    """Print the table; 1 if a target is missed."""
    parser = argparse.ArgumentParser(description="campaigns: overhead, speed-up, status, kills")
    parser.add_argument("what", nargs="?", choices=("overhead", "speedup", "status", "shards", "kills"))
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--schedulers", type=int, default=2)
    parser.add_argument("--tasks", type=int, default=2000)
    parser.add_argument("--one", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--dask", default="", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.one is not None:
        import campaign  # under its name, so that functions of tasks are found by other processes

        campaign._campaign_process(options.one, options.tasks, options.dask)
        return 0
    print(machine())
    parts = {
        "overhead": overhead, "speedup": speedup, "status": status, "shards": shards,
        "kills": lambda: [*kills(options.tasks, options.kills), *scheduler_kills(options.tasks, options.schedulers)],
    }  # fmt: skip
    table = parts[options.what]() if options.what else run()
    for line in table:
        print(f"  {line.quantity:<50} {line.value:>10.4g} {line.unit:<4} {line.verdict}", flush=True)
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
