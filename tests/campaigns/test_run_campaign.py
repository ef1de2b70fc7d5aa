"""Campaigns end with the same table whatever the workers, shards, order and deaths of processes."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.campaigns.tasks import dies_once, slow_squares, work

from seatrial.campaigns import Store, Work, open_store
from seatrial.campaigns.engines import WorkerKind
from seatrial.campaigns.run_campaign import CampaignOptions, Shard, retry_campaign, run_campaign, shard_named
from seatrial.campaigns.summary import campaign_table, write_table
from seatrial.campaigns.work import Outcome
from seatrial.core.values import InputError

ONE = CampaignOptions(workers=1)


def table_bytes(folder: Path) -> bytes:
    path = folder.with_suffix(".csv")
    write_table(campaign_table(open_store(folder)), path)
    return path.read_bytes()


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("campaign") / "store"
    status = run_campaign(work(), folder, ONE)
    assert (status.total, status.done, status.failed, status.remaining) == (30, 24, 6, 0)
    return table_bytes(folder)


@pytest.mark.parametrize("options", [
    CampaignOptions(workers=3, kind=WorkerKind.THREADS), CampaignOptions(workers=2),
])  # fmt: skip
def test_workers_do_not_matter(options: CampaignOptions, undisturbed: bytes, tmp_path: Path) -> None:
    run_campaign(work(), tmp_path / "store", options)
    assert table_bytes(tmp_path / "store") == undisturbed


def test_shards_in_any_order_give_the_same(undisturbed: bytes, tmp_path: Path) -> None:
    for index in range(16, 0, -1):
        run_campaign(work(), tmp_path / "store", CampaignOptions(workers=1, shard=Shard(index, 16)))
    assert table_bytes(tmp_path / "store") == undisturbed


def test_what_is_done_is_not_done_again(undisturbed: bytes, tmp_path: Path) -> None:
    half = run_campaign(work(), tmp_path / "store", CampaignOptions(workers=1, shard=Shard(1, 2)))
    assert half.remaining == 15
    reports: list[str] = []
    run_campaign(work(), tmp_path / "store", ONE, reports.append)
    assert len(reports) == 15
    assert reports[-1].startswith("campaign: 30 of 30 tasks done")
    run_campaign(work(), tmp_path / "store", ONE, reports.append)
    assert len(reports) == 15
    assert table_bytes(tmp_path / "store") == undisturbed


def test_two_campaigns_in_one_store_count_each_task_once(undisturbed: bytes, tmp_path: Path) -> None:
    """As if both had begun before either had finished anything."""
    run_campaign(work(), tmp_path / "store", ONE)
    journals = tmp_path / "store" / "journals"
    first = {path: path.rename(tmp_path / path.name) for path in journals.iterdir()}
    run_campaign(work(), tmp_path / "store", ONE)
    for path, moved in first.items():
        moved.rename(path)
    assert len(list(journals.iterdir())) == 2
    assert open_store(tmp_path / "store").status().done == 24
    assert table_bytes(tmp_path / "store") == undisturbed


def test_an_interrupt_leaves_a_store_that_goes_on(undisturbed: bytes, tmp_path: Path) -> None:
    def interrupt(text: str) -> None:
        if text.startswith("campaign: 9 of"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_campaign(work(), tmp_path / "store", ONE, interrupt)
    assert open_store(tmp_path / "store").status().remaining == 21
    run_campaign(work(), tmp_path / "store", ONE)
    assert table_bytes(tmp_path / "store") == undisturbed


def test_a_process_that_dies_costs_an_attempt_and_one_that_always_dies_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("seatrial.campaigns.engines.MAX_ATTEMPTS", 2)
    keys = [{"seed": seed, "folder": str(tmp_path)} for seed in range(7)]
    status = run_campaign(Work({}, keys, dies_once), tmp_path / "store", CampaignOptions(workers=2))
    assert (status.done, status.failed) == (6, 1)
    table = campaign_table(open_store(tmp_path / "store"))
    sentences = [text for text in table.columns["failure"] if text]
    assert sentences == ["its process ended without a result, 2 times in a row (killed, out of memory, or a crash)"]


def test_more_seeds_go_on_with_the_store(tmp_path: Path) -> None:
    run_campaign(work(10), tmp_path / "store", ONE)
    reports: list[str] = []
    status = run_campaign(work(12), tmp_path / "store", ONE, reports.append)
    assert status.total == 12
    assert len(reports) == 2


def test_failed_tasks_are_done_again_on_request(tmp_path: Path) -> None:
    run_campaign(work(), tmp_path / "store", ONE)
    reports: list[str] = []
    status = run_campaign(work(), tmp_path / "store", CampaignOptions(workers=1, retry=True), reports.append)
    assert len(reports) == status.failed == 6
    with pytest.raises(InputError, match="begun from Python"):
        retry_campaign(tmp_path / "store", ONE)


def test_other_campaigns_versions_and_folders_are_refused(tmp_path: Path) -> None:
    run_campaign(work(3), tmp_path / "store", ONE)
    with pytest.raises(InputError, match=r"holds another campaign \(it differs in: rate\)"):
        run_campaign(work(3, rate=2), tmp_path / "store", ONE)
    other = Work({"kind": "squares"}, [{"seed": 0}], slow_squares, versions={"seatrial": "99.0"})
    with pytest.raises(InputError, match=r"was begun with seatrial .*, this is 99\.0"):
        run_campaign(other, tmp_path / "store", ONE)
    (tmp_path / "else").mkdir()
    (tmp_path / "else" / "mine.txt").write_text("")
    with pytest.raises(InputError, match="holds no campaign; name another folder"):
        run_campaign(work(3), tmp_path / "else", ONE)
    with pytest.raises(InputError, match=r"holds no campaign \(no campaign.json\)"):
        open_store(tmp_path / "else")


def test_a_store_of_a_newer_version_or_a_damaged_one_is_refused(tmp_path: Path) -> None:
    run_campaign(work(3), tmp_path / "store", ONE)
    path = tmp_path / "store" / "campaign.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"format": 7}))
    with pytest.raises(InputError, match="of format 7"):
        run_campaign(work(3), tmp_path / "store", ONE)
    path.write_text("{")
    with pytest.raises(InputError, match="is damaged"):
        open_store(tmp_path / "store")


def test_a_full_disk_ends_the_campaign_with_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from seatrial.core.values import files

    flushed: list[int] = []

    def full_after_the_plan(descriptor: int) -> None:
        flushed.append(descriptor)
        if len(flushed) > 1:  # the plan
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(files, "flush_to_disk", full_after_the_plan)
    with pytest.raises(InputError, match=r"No space left on device\); what was finished before is kept"):
        run_campaign(work(3), tmp_path / "store", ONE)
    monkeypatch.undo()
    assert run_campaign(work(3), tmp_path / "store", ONE).done == 3


@pytest.mark.parametrize("text", ["0/4", "5/4", "3", "a/b", "1/-2"])
def test_a_shard_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="--shard"):
        shard_named(text)


def test_results_of_other_processors_are_marked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from seatrial.campaigns.summary import campaign_summary

    run_campaign(work(4), tmp_path / "store", CampaignOptions(workers=1, shard=Shard(1, 2)))
    monkeypatch.setattr("seatrial.campaigns.work.processor", lambda: "another")
    run_campaign(work(4), tmp_path / "store", ONE)
    store: Store = open_store(tmp_path / "store")
    summary = campaign_summary(store, campaign_table(store))
    assert "another" in summary.processors
    assert [finding.code for finding in summary.findings] == ["mixed-arithmetic"]


def test_unfinished_outcomes_do_not_leave_processes() -> None:
    import multiprocessing

    from seatrial.campaigns.engines import outcomes_in_processes

    outcomes: Iterator[Outcome] = outcomes_in_processes(slow_squares, work(8).tasks(), 2)
    next(outcomes)
    outcomes.close()  # type: ignore[attr-defined]
    assert multiprocessing.active_children() == []
