"""What the views show is what the trial file says, what the judge weighs, and what seatrial computes."""

import json
import math
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.workspace.logs import STATED, K, Opened, opened, write_logs, write_trial

import seatrial
from seatrial.workspace.craft_view import craft_view
from seatrial.workspace.folder import opened_trial
from seatrial.workspace.gains_view import gains_view, loop_view, write_autopilot
from seatrial.workspace.jobs import JobRunner, JobState, free_name, note_of
from seatrial.workspace.results_view import fit_folders, simulated_view
from seatrial.workspace.shortcut import write_shortcut

SIDE = ["records", 0, "channels", "delta", "positive"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("views")
    write_logs(folder)
    return folder


@pytest.fixture(scope="module")
def workspace(folder: Path) -> Iterator[Opened]:
    with opened(folder) as served:
        yield served


def edit(workspace: Opened, **content: Any) -> dict[str, Any]:
    """Make an edit on the file as it is."""
    version = workspace.ask("state")[1]["version"]
    status, answer = workspace.ask("edit", {**content, "version": version})
    assert status == 200, answer
    return answer


def checked(workspace: Opened) -> dict[str, Any]:
    """The findings on the file as it is."""
    version = workspace.ask("state")[1]["version"]
    for _ in range(300):
        check = workspace.ask("check")[1]
        if check.get("version") == version and check["complete"]:
            return check
        time.sleep(0.1)
    raise AssertionError("the check does not end")


@pytest.fixture(scope="module")
def drafted(workspace: Opened) -> Opened:
    _, answer = workspace.ask("edit", {"kind": "draft", "version": workspace.ask("state")[1]["version"]})
    assert "no column" in answer["error"] or "recognised" in answer["error"]
    edit(workspace, kind="draft", sizes={"length": 20.0}, columns=list(STATED), name="dinghy")
    return workspace


@pytest.mark.usefixtures("drafted")
def test_the_draft_is_that_of_init(folder: Path) -> None:
    logs = sorted(folder.glob("*.csv"))
    text = seatrial.draft_trial(*logs, folder=folder, length=20.0, columns=STATED, name="dinghy").text
    assert (folder / "trial.toml").read_text(encoding="utf-8") == text


def test_logs_show_each_channel_with_its_reason_and_its_choices(drafted: Opened) -> None:
    (block,) = drafted.ask("logs")[1]["blocks"]
    rows = {row["symbol"]: row for row in block["channels"]}
    assert rows["delta"]["column"] == "C3" and "turn that follows" in rows["delta"]["reason"]
    assert rows["delta"]["sides"] == ["starboard", "port"] and set(rows["delta"]["units"]) == {"deg", "rad"}
    assert [run["role"] for run in block["runs"]] == ["validate", "train", "train"]


def test_the_judges_candidates_are_weighed_by_the_records(drafted: Opened) -> None:
    columns = {one["name"]: one for one in drafted.ask("candidates", {"log": "log_1.csv"})[1]["columns"]}
    assert columns["C3"]["low"] < -10.0 and columns["C3"]["symbol"] == ""  # its heading says nothing
    (block,) = drafted.ask("logs")[1]["blocks"]
    named = drafted.ask("candidates", {"log": block["files"][0], "columns": list(STATED)})[1]["columns"]
    delta = next(one for one in named if one["name"] == "C3")
    sides = {one["reading"]: one for one in delta["candidates"]}
    assert sides['positive = "port"']["nats"] > 1.0
    assert [one["nats"] for one in delta["candidates"]] == sorted(one["nats"] for one in delta["candidates"])


def test_series_are_the_record_and_hold_its_runs(drafted: Opened) -> None:
    series = drafted.ask("series", {"block": 0, "log": "log_1"})[1]
    assert series["samples"] == 481 and series["duration"] == 240.0
    assert series["runs"] == [{"name": "log_1", "role": "validate", "ends": [0.0, 240.0]}]
    assert drafted.ask("series", {"block": 0, "log": "other"})[0] == 422


def test_what_a_person_says_overrules_what_is_guessed(drafted: Opened) -> None:
    assert not [one for one in checked(drafted)["findings"] if one["severity"] == "error"]
    edit(drafted, kind="set", place=SIDE, value="port")
    check = checked(drafted)
    (wrong, *_) = [one for one in check["findings"] if one["code"] == "wrong-sign"]
    assert wrong["advice"]
    edit(drafted, kind="finding", place=wrong["place"], accept=True)
    (block,) = drafted.ask("logs")[1]["blocks"]
    delta = next(row for row in block["channels"] if row["symbol"] == "delta")
    assert delta["side"] == "port" and delta["by_hand"]
    edit(drafted, kind="draft", sizes={"length": 21.0})  # a new draft of the craft leaves it, too
    text = drafted.ask("state")[1]["text"]
    assert 'positive = "port"' in text and 'accept = ["wrong-sign"]' in text
    edit(drafted, kind="set", place=SIDE, value=None)
    edit(drafted, kind="set", place=["accept"], value=None)
    assert not [one for one in checked(drafted)["findings"] if one["severity"] == "error"]


def test_craft_shows_where_each_number_comes_from(drafted: Opened) -> None:
    craft = drafted.ask("craft")[1]
    rows = {row["key"]: row for row in craft["tables"][0]["rows"]}
    assert rows["L"]["standing"] == "stated" and craft["model"] == "nomoto"
    assert {p["name"] for p in craft["parameters"] if p["free"]} == {"K", "T", "alpha"}


def test_craft_shows_what_is_estimated_of_each_thruster(repository: Path) -> None:
    logs = sorted((repository / "examples" / "usv").glob("*.csv"))
    text = seatrial.draft_trial(*logs, folder=logs[0].parent, length=1.0).text
    tables = {tuple(table["place"]): table["rows"] for table in craft_view(text, logs[0].parent / "t.toml")["tables"]}
    arms = [row for k in (0, 1) for row in tables["thruster", k] if row["key"] == "y"]
    assert [row["standing"] for row in arms] == ["estimated", "estimated"]


def test_two_windows_lose_nothing(drafted: Opened) -> None:
    seen = drafted.ask("state")[1]["version"]
    first = {"kind": "role", "block": 0, "name": "log_2", "role": "validate", "version": seen}
    assert drafted.ask("edit", first)[0] == 200
    second = {"kind": "set", "place": ["ship", "name"], "value": "other", "version": seen}
    status, answer = drafted.ask("edit", second)
    assert status == 409 and "changed since" in answer["error"]
    difference = drafted.ask("difference", {"since": seen})[1]["diff"]
    assert any(line.startswith("+validate") for line in difference)
    assert drafted.ask("edit", {**second, "version": answer["version"]})[0] == 200
    (block,) = drafted.ask("logs")[1]["blocks"]
    assert [run["role"] for run in block["runs"]] == ["validate", "validate", "train"]
    assert drafted.ask("undo", {"version": drafted.ask("state")[1]["version"]})[0] == 200
    assert drafted.ask("undo", {"version": drafted.ask("state")[1]["version"]})[0] == 200


@pytest.fixture(scope="module")
def fitted(drafted: Opened) -> Opened:
    status, job = drafted.ask("start-fit", {})
    assert status == 200 and job["state"] == "running"
    wait_for(drafted, "results/fit-1", "done")
    return drafted


def wait_for(workspace: Opened, name: str, state: str) -> dict[str, Any]:
    """The job once it has ended."""
    for _ in range(1200):
        (job,) = [one for one in workspace.ask("state")[1]["jobs"] if one["name"] == name]
        if job["state"] != "running":
            assert job["state"] == state, job
            return job
        time.sleep(0.1)
    raise AssertionError(f"{name} does not end")


def test_a_fit_is_that_of_identify_and_keeps_its_trial_file(fitted: Opened, folder: Path) -> None:
    result = folder / "results" / "fit-1"
    assert (result / "trial.toml").read_text() == (folder / "trial.toml").read_text()
    assert not list(folder.glob(".*.toml"))
    fit = seatrial.identify(folder / "trial.toml")
    (view,) = fitted.ask("fits")[1]["fits"]
    values = {one["name"]: one for one in view["coefficients"]}
    assert {c.name: c.estimate for c in fit.coefficients} == {name: one["value"] for name, one in values.items()}
    assert values["K"]["low"] < K < values["K"]["high"]
    assert "closely" in view["verdict"] and view["tracks"][0]["run"] == "log_1"
    status, page, headers = fitted.request("GET", "/report/results/fit-1/report.html")
    assert status == 200 and page == (result / "report.html").read_bytes()
    assert "sandbox allow-scripts" in headers["content-security-policy"]


def test_a_fit_that_fails_says_why_and_can_be_restored(fitted: Opened) -> None:
    edit(fitted, kind="set", place=SIDE, value="port")
    fitted.ask("start-fit", {"name": "wrong side"})
    job = wait_for(fitted, "results/wrong side", "failed")
    assert "do not pass the checks" in job["message"] and "opposite sign" in job["message"]
    views = {view["name"]: view for view in fitted.ask("fits")[1]["fits"]}
    assert views["results/wrong side"]["message"] == job["message"]
    edit(fitted, kind="restore", name="results/fit-1")
    assert 'positive = "port"' not in fitted.ask("state")[1]["text"]
    assert fitted.ask("start-fit", {"name": "fit-1"})[0] == 422


def test_a_fit_is_stopped(fitted: Opened, folder: Path) -> None:
    fitted.ask("start-fit", {"name": "stopped", "intervals": "bootstrap"})
    assert fitted.ask("stop", {"name": "results/stopped"})[0] == 200
    wait_for(fitted, "results/stopped", "stopped")
    for _ in range(100):
        if note_of(folder / "results" / "stopped"):
            break
        time.sleep(0.1)
    assert not (folder / "results" / "stopped" / "result.json").exists()
    assert fitted.ask("stop", {"name": "results/stopped"})[0] == 422


def test_what_if_moves_a_coefficient_within_its_interval_and_no_further(fitted: Opened, folder: Path) -> None:
    fit = folder / "results" / "fit-1"
    assert fit in fit_folders(folder)
    gain = next(c for c in seatrial.load_fit(fit).coefficients if c.name == "K")
    assert gain.upper is not None
    answer = simulated_view(fit, "turning-circle:20", {"K": gain.upper})
    rate = "steady_yaw_rate_deg_s"
    assert answer["moved"]["measures"][rate] > answer["estimate"]["measures"][rate] > 0.0
    assert simulated_view(fit, "turning-circle:20", {})["moved"] is None
    request = {"fit": "results/fit-1", "manoeuvre": "turning-circle:20", "values": {"K": 2.0 * gain.upper}}
    status, refusal = fitted.ask("simulate", request)
    assert status == 422 and "beyond its 95 % interval" in refusal["error"]
    assert fitted.ask("simulate", request | {"values": {}, "manoeuvre": "loop:9"})[0] == 422


def test_gains_under_the_hand_have_the_margins_that_tune_states(fitted: Opened, folder: Path) -> None:
    model = folder / "results" / "fit-1" / "model.toml"
    with pytest.raises(seatrial.InputError, match="speed"):
        write_autopilot(folder, "autopilot", model)
    assert not (folder / "autopilot.toml").exists()
    loop = write_autopilot(folder, "autopilot", model, 4.0)
    rows = {row["name"]: row for row in loop_view(folder, loop, None)["gains"]}
    gains = {name: row["value"] for name, row in rows.items()}
    answer = gains_view(loop, None, gains)
    assert answer["stable"] and answer["step"]["text"].startswith("overshoots by")
    hasty = gains_view(loop, None, gains | {"KP": rows["KP"]["high"], "KD": 0.0})
    assert hasty["violated"]
    assert fitted.ask("gains", {"loop": "autopilot.toml", "gains": {"KP": 1.0}})[0] == 422
    assert fitted.ask("autopilot", {"fit": "results/fit-1"})[0] == 422  # it is there already
    assert [fact["name"] for fact in answer["facts"]][:3] == ["largest sensitivity Ms", "gain margin", "phase margin"]
    json.dumps(answer, allow_nan=False)


def test_a_job_tells_its_phases_and_its_end(tmp_path: Path) -> None:
    seen = []
    runner = JobRunner(lambda job: seen.append((job.state, [name for name, _ in job.phases])))
    job = runner.start("fit", "absent", tmp_path / "absent", ["identify", str(tmp_path / "no.toml"), "--out", "x"])
    for _ in range(600):
        if job.state is not JobState.RUNNING:
            break
        time.sleep(0.1)
    assert job.state is JobState.FAILED and "cannot be read" in job.message
    assert free_name(tmp_path, "fit") == "fit-1"
    runner.stop_all()


def test_what_is_opened(tmp_path: Path, folder: Path) -> None:
    assert opened_trial(tmp_path) == (tmp_path.resolve() / "trial.toml", [])
    assert opened_trial(folder / "log_1.csv") == (folder.resolve() / "trial.toml", [folder.resolve() / "log_1.csv"])
    with pytest.raises(seatrial.InputError, match="there is no"):
        opened_trial(tmp_path / "none")


def test_a_shortcut_opens_the_folder(tmp_path: Path) -> None:
    path = write_shortcut(tmp_path, tmp_path)
    assert str(tmp_path) in path.read_text() and "seatrial open" in path.read_text()
    with pytest.raises(seatrial.InputError, match="no desktop"):
        write_shortcut(tmp_path, tmp_path / "none")


def test_an_open_column_is_decided_by_hand_and_a_note_is_no_log(tmp_path: Path) -> None:
    (log, *_) = write_logs(tmp_path)
    rows = [line.split(",") for line in log.read_text().splitlines()[1:]]
    text = "".join(f"{t},{psi},{33000.0 + 512.0 * float(delta):.0f}\n" for t, psi, delta in rows)
    for path in tmp_path.glob("*.csv"):
        path.unlink()
    (tmp_path / "run.csv").write_text(f"time [s],heading [deg],rudder.raw\n{text}", encoding="utf-8")
    (tmp_path / "notes.txt").write_text("Departed at noon.\nSea calm.\n", encoding="utf-8")
    with opened(tmp_path) as served:
        edit(served, kind="draft", logs=["notes.txt", "run.csv"], sizes={"length": 8.0})
        (block,) = served.ask("logs")[1]["blocks"]
        (row,) = block["open"]
        assert row["symbol"] == "delta" and row["must_choose"] and "counts" in row["other"]
        assert any(one["code"] == "model" for one in checked(served)["findings"])
        table = row["stated"] | {"zero": 33000.0, "span": 512.0}
        edit(served, kind="channel", block=0, symbol="delta", table=table)
        edit(served, kind="draft")  # craft and model again, the length as it is stated in the file
        (block,) = served.ask("logs")[1]["blocks"]
        delta = next(one for one in block["channels"] if one["symbol"] == "delta")
        assert delta["by_hand"] and "no degrees" in delta["reason"] and not block["open"]
        craft = served.ask("craft")[1]
        assert next(one for one in craft["tables"][0]["rows"] if one["key"] == "L")["value"] == 8.0
        assert not [one for one in checked(served)["findings"] if one["code"] == "model"]


def test_a_file_is_followed_as_it_grows_and_its_fit_is_one_of_the_fits(tmp_path: Path) -> None:
    write_trial(tmp_path)
    (tmp_path / "today.csv").write_bytes((tmp_path / "log_2.csv").read_bytes())
    with opened(tmp_path) as served:
        status, answer = served.ask("edit", {"kind": "follow", "block": 0, "file": "log_1.csv",
                                             "version": served.ask("state")[1]["version"]})  # fmt: skip
        assert status == 422 and "none of the records" in answer["error"]
        edit(served, kind="follow", block=0, file="today.csv")
        assert tomllib.loads(served.ask("state")[1]["text"])["follow"]["rate"] == 2.0
        assert served.ask("onboard")[1] == {}
        served.ask("start-follow", {"once": True})
        assert served.ask("onboard")[1]["name"] == "results/onboard-1"
        status, answer = served.ask("start-follow")
        assert status == 422 and "followed already" in answer["error"]
        wait_for(served, "results/onboard-1", "done")
        while not (stream := served.ask("onboard")[1])["is_over"]:  # the job is done a moment before that is noted
            time.sleep(0.01)
        assert "today.csv" in stream["title"] and stream["snapshot"]["accepted"] == 481
        assert stream["points"] and stream["snapshot"]["rows"][0]["name"] == "K"
        (view,) = served.ask("fits")[1]["fits"]
        assert view["name"] == "results/onboard-1" and view["state"] == "done"


def test_a_tank_record_of_unknown_names_is_drafted_step_by_step(tmp_path: Path) -> None:
    time_s = [0.05 * k for k in range(2400)]
    rows = (
        f"{t:.2f}\t{20 * math.sin(2 * t):.2f}\t{9 * math.sin(2 * t - 0.3):.2f}\t{math.cos(2 * t):.3f}" for t in time_s
    )
    text = "time/s\tprobe/mm\tLVDT/mm\tpitch_gyro/deg\n" + "\n".join(rows) + "\n"
    (tmp_path / "run.txt").write_text(text, encoding="utf-8")
    with opened(tmp_path) as served:
        edit(served, kind="draft", sizes={"length": 2.6}, name="tank")
        assert tomllib.loads(served.ask("state")[1]["text"])["ship"] == {"name": "tank", "L": 2.6}
        columns = {one["name"]: one for one in served.ask("candidates", {"log": "run.txt"})[1]["columns"]}
        for name, symbol in (("probe/mm", "zeta"), ("LVDT/mm", "z")):
            table = {"column": name, "unit": columns[name]["unit"]}
            assert table["unit"] == "mm"
            edit(served, kind="channel", block=0, symbol=symbol, table=table)
        follow = tomllib.loads(served.ask("state")[1]["text"])
        edit(served, kind="follow", block=0, file="today.txt")
        edit(served, kind="draft")  # the waves that the model needs join the block; name and length stay
        tables = tomllib.loads(served.ask("state")[1]["text"])
        assert (
            tables["model"]["name"] == "heave_pitch" and tables["ship"]["L"] == 2.6 and tables["ship"]["name"] == "tank"
        )
        assert tables["records"][0]["waves"]["heading"] == {"value": 180, "unit": "deg"}
        assert tables["records"][0]["channels"] == follow["records"][0]["channels"] and "follow" in tables
        before = served.ask("state")[1]["text"]
        assert not edit(served, kind="draft")["diff"] and served.ask("state")[1]["text"] == before
