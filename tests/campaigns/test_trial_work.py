"""Campaigns over trial files: grids, folds and fleets give what `identify` gives, and know what they depend on."""

import shutil
from pathlib import Path

import pytest

import seatrial as st
from seatrial.campaigns import open_store
from seatrial.campaigns.plan import trial_source
from seatrial.campaigns.run_campaign import CampaignOptions, run_campaign, work_of_plan
from seatrial.campaigns.summary import campaign_summary, campaign_table
from seatrial.campaigns.trial_work import TrialTask
from seatrial.campaigns.work import overridden
from seatrial.core.values import InputError

ONE = CampaignOptions(workers=1)


def plan(folder: Path, text: str) -> Path:
    path = folder / "plan.toml"
    path.write_text(text)
    return path


def test_a_fold_predicts_the_run_that_it_leaves_out(trial_folder: Path, tmp_path: Path) -> None:
    work = work_of_plan(plan(trial_folder, 'kind = "folds"\ntrial = "trial.toml"\nquestion = "how well?"'))
    assert [keys["fold"] for keys in work.keys] == ["zigzag_10_10", "zigzag_20_20"]
    assert run_campaign(work, tmp_path / "store", ONE).done == 2
    store = open_store(tmp_path / "store")
    table = campaign_table(store)
    runs = {(fold, run) for fold, run in zip(table.columns["fold"], table.columns["run"], strict=True) if run}
    assert runs == {("zigzag_10_10", "zigzag_10_10"), ("zigzag_20_20", "zigzag_20_20")}
    summary = campaign_summary(store, table)
    assert summary.question == "how well?"
    assert {score.name for score in summary.scores} >= {"rms psi_deg", "rms position_m"}
    assert [c.name for c in summary.coefficients] == ["Y_v", "Y_r", "N_v", "N_r"]


def test_a_grid_gives_what_identify_gives(trial_folder: Path, tmp_path: Path) -> None:
    path = plan(trial_folder, 'kind = "grid"\ntrial = "trial.toml"\n[grid]\n"records.1.rate" = [1.0]\nnoise = [{}]\n')
    run_campaign(work_of_plan(path), tmp_path / "store", ONE)
    columns = campaign_table(open_store(tmp_path / "store")).columns
    text = (trial_folder / "trial.toml").read_text().replace("header_lines = 1", "header_lines = 1\nrate = 1.0")
    (trial_folder / "slow.toml").write_text(text)
    fit = st.identify(st.load_trial(trial_folder / "slow.toml"))
    estimates = {name: value for name, value, row in zip(
        columns["name"], columns["estimate"], columns["row"], strict=True) if row == "coefficient"}  # fmt: skip
    assert estimates == fit.params


def test_a_fleet_has_a_row_for_the_trial_that_is_none(trial_folder: Path, tmp_path: Path) -> None:
    (trial_folder / "broken.toml").write_text('[ship]\nname = "x"\nL = 3.0\n[modell]\n')
    work = work_of_plan(plan(trial_folder, 'kind = "fleet"\ntrials = ["trial.toml", "broken.*"]'))
    status = run_campaign(work, tmp_path / "store", ONE)
    assert (status.done, status.failed) == (1, 1)
    columns = campaign_table(open_store(tmp_path / "store")).columns
    (sentence,) = [text for text in columns["failure"] if text]
    assert "unknown key 'modell'; did you mean 'model'?" in str(sentence)
    assert set(columns["trial"]) == {"trial.toml", "broken.toml"}


def test_identities_follow_content_not_place(trial_folder: Path, tmp_path: Path) -> None:
    text = 'kind = "grid"\ntrial = "trial.toml"\n[grid]\n"estimate.robust" = [true, false]\n'
    moved = tmp_path / "elsewhere"
    shutil.copytree(trial_folder, moved)
    here, there = (work_of_plan(plan(folder, text)).tasks() for folder in (trial_folder, moved))
    assert [task.identity for task in here] == [task.identity for task in there]
    record = moved / "runs" / "zigzag_10_10.csv"
    record.write_text(record.read_text() + "\n")
    changed = work_of_plan(plan(moved, text)).tasks()
    assert all(a.identity != b.identity for a, b in zip(here, changed, strict=True))


def test_absolute_paths_become_relative_ones(trial_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CAMPAIGN_RUNS", str(trial_folder / "runs"))
    text = (trial_folder / "trial.toml").read_text()
    (trial_folder / "absolute.toml").write_text(text.replace('"runs"', '"${CAMPAIGN_RUNS}"'))
    source = trial_source(trial_folder / "absolute.toml")
    assert source.table["data"]["folder"] == "runs"
    assert [path.name for path in source.files] == ["zigzag_10_10.csv", "zigzag_20_20.csv", "zigzag_30_30.csv"]
    assert source.content() == trial_source(trial_folder / "trial.toml").content()


def test_the_files_of_a_task_can_be_carried(trial_folder: Path) -> None:
    task = work_of_plan(plan(trial_folder, 'kind = "fleet"\ntrials = ["trial.toml"]')).function
    assert isinstance(task, TrialTask)
    root = task.carried().unpack()
    there = trial_source(task.moved(root).root / "trial.toml")
    assert there.content() == trial_source(trial_folder / "trial.toml").content()
    shutil.rmtree(root)


def test_overrides_reach_tables_that_do_not_exist_and_blocks() -> None:
    table = {"records": [{"rate": 1.0}, {"rate": 2.0}], "ship": {"L": 3.0}}
    result = overridden(table, {"records.2.rate": 5.0, "estimate.rate": 4.0})
    assert result == {"records": [{"rate": 1.0}, {"rate": 5.0}], "ship": {"L": 3.0}, "estimate": {"rate": 4.0}}
    assert table["records"][1]["rate"] == 2.0
    with pytest.raises(InputError, match="no block '3'; they are numbered from 1 to 2"):
        overridden(table, {"records.3.rate": 5.0})
    with pytest.raises(InputError, match="'L' is a value, no table"):
        overridden(table, {"ship.L.x": 5.0})


@pytest.mark.parametrize(("text", "sentence"), [
    ('kind = "gird"', "unknown kind 'gird'; did you mean 'grid'"),
    ("seeds = 3", "key 'kind' is missing"),
    ('kind = "grid"\ntrial = "trial.toml"', "key 'grid' is missing"),
    ('kind = "grid"\ntrials = "trial.toml"\n[grid]\na = [1]', "unknown key 'trials'; did you mean 'trial'"),
    ('kind = "grid"\ntrial = "trial.toml"\n[grid]\n"estimate.ratee" = [1.0]', "unknown key 'estimate.ratee'"),
    ('kind = "grid"\ntrial = "trial.toml"\n[grid]\n"estimate.rate" = [1.0, -1.0]', "estimate.rate = -1.0"),
    ('kind = "grid"\ntrial = "no.toml"\n[grid]\na = [1]', "cannot be read"),
    ('kind = "fleet"\ntrials = "fleet/*.toml"', "matches no file"),
    ('kind = "folds"\ntrial = "trial.toml"\nseeds = 0', "seeds = 0"),
])  # fmt: skip
def test_bad_plans_are_answered_with_one_sentence(trial_folder: Path, text: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        work_of_plan(plan(trial_folder, text))
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_grid_of_a_thousand_million_is_refused_before_anything_is_built(trial_folder: Path) -> None:
    values = list(range(1000))
    text = f'kind = "grid"\ntrial = "trial.toml"\n[grid]\n"a.b" = {values}\n"a.c" = {values}\n"a.d" = {values}\n'
    with pytest.raises(InputError, match="1,000,000,000 tasks, more than the 1,000,000"):
        work_of_plan(plan(trial_folder, text))
