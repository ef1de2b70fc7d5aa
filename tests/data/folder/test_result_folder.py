"""Folders of results: everything a report shows comes back; all files are written or none."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.data.folder.equal_results import assert_equal
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_study import fabricated_study
from tests.reporting.fabricated_tuning import fabricated_fin

from seatrial import api
from seatrial.core.results import (
    Coefficient,
    Fit,
    Measure,
    Method,
    Noise,
    NoiseModel,
    Offset,
    Prediction,
    Residuals,
    Solution,
    Status,
)
from seatrial.core.results.fields import Summarised
from seatrial.core.results.tuning import Tuning
from seatrial.core.values import Finding, InputError, Record, RecordKind, Severity, Ship
from seatrial.data.folder.document import document, strict_json
from seatrial.data.folder.result_folder import folder_files, load_fit, load_result, save_result
from seatrial.physics.models import model_named


def record(name: str, kind: RecordKind = RecordKind.MEASURED) -> Record:
    time = np.arange(0.0, 20.0, 0.1)
    speed = np.full(200, 0.8)
    rudder = np.where(time > 5.0, 0.3, 0.0)
    return Record.from_arrays(name, time, {"u": speed, "psi": time / 3.0, "delta": rudder, "v_j": speed + 1.0}, kind)


@pytest.fixture
def fit() -> Fit:
    model = model_named("waterjet")
    free = model.parameters.free
    first, second = record("first"), record("second")
    coefficients = tuple(Coefficient(p.name, p.unit, p.value, 0.1, -1.0, 1.0, False, p.value) for p in free)
    return Fit(
        question="does it work?",
        ship=Ship("craft", {"L": 9.8}, "paper", 1.0),
        model=model,
        coefficients=(*coefficients, Coefficient("m", "kg", 5540.0, None, None, None, True)),
        covariance=np.eye(len(free)) / 3.0,
        solution=Solution(np.arange(3.0) / 7.0, 1.5, Status.CONVERGED, 9, (3.0, 1.5), 4),
        method=Method("output error", "weak form", "information matrix", ("white residuals",), {"rate": 10.0}),
        offsets=(Offset("delta zero", "first", "rad", 0.01, None),),
        channel_noise=(Noise("u", "m/s", 0.02, 0.1, math.nan, False),),
        residuals=(Residuals("u", 10.0, np.arange(5.0) / 3.0, np.array([1.0, 0.1])),),
        predictions=(
            Prediction("first", "training", first, record("first", RecordKind.SIMULATED), {"u": 0.1}, {}, 2.0),
            Prediction(
                "second",
                "validation",
                second,
                record("second", RecordKind.SIMULATED),
                {"psi_deg": 1.0 / 3.0, "v": math.nan},
                {"overshoot_1_deg": Measure(4.0, math.nan), "overshoot_2_deg": Measure(4.1, 3.9, 3.75, 4.5)},
                2.0,
            ),
        ),
        findings=(Finding(Severity.INFO, "constant", "run first: jet never changes", "1.8 m/s", "none needed"),),
        records=(first, second),
        seed=4,
        elapsed_s=1.25,
        versions={"seatrial": "0.1.0"},
    )


RESULTS: dict[str, Callable[[], Summarised]] = {
    "fit": lambda: complete_fit(fabricated_fit()),
    "design": fabricated_design,
    "tuning": fabricated_fin,
    "study": lambda: fabricated_study(fabricated_fit()),
}


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_comes_back_to_the_last_bit(name: str, tmp_path: Path) -> None:
    result = RESULTS[name]()
    assert_equal(load_result(save_result(result, tmp_path)), result)


@pytest.mark.parametrize("name", RESULTS)
def test_the_page_of_a_folder_is_that_of_the_result(name: str, tmp_path: Path) -> None:
    result = RESULTS[name]()
    page = api.save(result, tmp_path)
    assert api.report(tmp_path, tmp_path / "again.html").read_bytes() == page.read_bytes()


@pytest.mark.parametrize("name", RESULTS)
def test_nothing_but_the_files_of_its_kind_is_written(name: str) -> None:
    files = set(folder_files(RESULTS[name]()))
    products = {"design": {"orders.csv", "plan.csv"}, "tuning": {"gains.toml", "loop.mat", "schedule.csv"}}
    model = {"model.toml"} if name in ("fit", "design") else set()
    document = {"fit": "result.json"}.get(name, f"{name}.json")
    assert files == {"arrays.npz", document, *model, *products.get(name, set())}


def test_a_record_is_stored_once_and_comes_back_as_one(fit: Fit, tmp_path: Path) -> None:
    back = load_fit(save_result(fit, tmp_path))
    assert back.predictions[1].measured is back.records[1]
    assert back.predictions[0].simulated.kind is RecordKind.SIMULATED
    assert list(json.loads((tmp_path / "result.json").read_text())["stored_records"]) == [
        "record0", "record1", "record2", "record3",
    ]  # fmt: skip


def test_infinite_and_unknown_numbers_come_back_as_such(fit: Fit, tmp_path: Path) -> None:
    unknown = NoiseModel("output error", math.nan, {"u": math.inf, "x/y~": -math.inf}, {})
    back = load_fit(save_result(replace(fit, noise_model=unknown), tmp_path)).noise_model
    assert back is not None and math.isnan(back.whiteness_p)
    assert back.process == {"u": math.inf, "x/y~": -math.inf}


def test_nothing_stands_twice_in_a_folder(fit: Fit) -> None:
    table = json.loads(folder_files(complete_fit(fit))["result.json"])
    assert not {"ship", "covariance", "interval_basis", "validation", "intervals", "detail"} & set(table)


def test_a_damaged_entry_is_one_sentence(fit: Fit, tmp_path: Path) -> None:
    path = save_result(complete_fit(fit), tmp_path) / "result.json"
    table = json.loads(path.read_text())
    table["noise_model"]["process"]["u"] = "much"
    path.write_text(strict_json(table))
    with pytest.raises(InputError, match=r"damaged \(noise_model\.process\.u: .*run 'seatrial identify TRIAL --out"):
        load_fit(tmp_path)


@pytest.mark.parametrize("lost", ["coefficients", "files", "stored_records"])
def test_a_document_that_lacks_something_is_refused(fit: Fit, tmp_path: Path, lost: str) -> None:
    path = save_result(fit, tmp_path) / "result.json"
    table = json.loads(path.read_text())
    del table[lost]
    path.write_text(strict_json(table))
    with pytest.raises(InputError, match=r"result.json' is damaged"):
        load_fit(tmp_path)


def test_a_folder_of_an_earlier_version_is_refused_with_the_command_that_remakes_it(fit: Fit, tmp_path: Path) -> None:
    path = save_result(fit, tmp_path) / "result.json"
    path.write_text(strict_json(json.loads(path.read_text()) | {"format": 1}))
    with pytest.raises(InputError, match=rf"format 1, .* run 'seatrial identify TRIAL --out {tmp_path}'$"):
        load_fit(tmp_path)


def test_a_study_of_an_earlier_version_names_no_format(tmp_path: Path) -> None:
    (tmp_path / "study.json").write_text('{"study": "yu2014"}')
    with pytest.raises(InputError, match=r"format 1, .* run 'seatrial reproduce STUDY --out "):
        load_result(tmp_path)


def test_a_fit_is_wanted_and_a_tuning_is_there(tmp_path: Path) -> None:
    save_result(fabricated_fin(), tmp_path)
    with pytest.raises(InputError, match="holds a tuning, no fit"):
        load_fit(tmp_path)


def test_the_json_has_the_documented_entries_and_no_nan(fit: Fit) -> None:
    table = json.loads(strict_json(document(fit)))
    assert list(table["coefficients"][0])[:8] == [
        "name", "unit", "estimate", "standard_error", "lower", "upper", "fixed", "truth",
    ]  # fmt: skip
    assert "truth" not in table["coefficients"][-1]
    assert [v["record"] for v in table["validation"]] == ["second"]
    assert table["intervals"] == "information matrix"
    assert table["validation"][0]["rms"] == {"psi_deg": 1.0 / 3.0, "v": None}
    measure = table["validation"][0]["measures"]["overshoot_1_deg"]
    assert measure == {"measured": 4.0, "simulated": None, "lower": None, "upper": None, "is_determined": True}
    assert table["findings"][0] == {
        "severity": "info", "code": "constant", "text": "run first: jet never changes (1.8 m/s)",
        "evidence": "1.8 m/s", "advice": "none needed",
    }  # fmt: skip
    assert not {"records", "residuals"} & {key for key, value in table.items() if "record0" in json.dumps(value)}


def test_what_was_not_examined_is_null_or_empty(fit: Fit) -> None:
    table = document(fit)
    run = table["validation"][0]
    assert (table["identifiability"], table["noise_model"], table["candidate_models"]) == (None, None, [])
    assert (run["extrapolation"], run["noise_floor"], run["tied_spread"]) == (None, {}, {})


def test_what_the_records_identify_stands_in_the_json(fit: Fit) -> None:
    full = complete_fit(fit)
    table = json.loads(strict_json(document(full)))
    known, written = full.identifiability, table["identifiability"]
    assert known is not None
    assert written["effective_parameters"] == known.effective_parameters
    assert [s["text"] for s in written["structural"]] == [s.text for s in known.structural]
    assert [d["standard_deviation"] for d in written["directions"]] == [
        None, *(d.standard_deviation for d in known.directions[1:]),
    ]  # fmt: skip
    run = table["validation"][0]
    assert run["extrapolation"]["index"] == 1.9 and run["extrapolation"]["ratios"]["yaw_rate"] == 1.9
    assert run["noise_floor"]["position_m"] == 0.19 and run["tied_spread"]["psi_deg"] == 0.31
    assert run["measures"]["overshoot_2_deg"]["lower"] == 3.9 * 0.96
    assert table["candidate_models"][-1]["heading_deg"] is None


def test_the_model_file_knows_the_approach(fit: Fit, tmp_path: Path) -> None:
    from seatrial.data.folder.model_file import read_model_file

    file = read_model_file(save_result(fit, tmp_path) / "model.toml")
    assert file.approach == pytest.approx({"u": 0.8, "v_j": 1.8})
    assert (file.provenance.records[1].name, file.provenance.records[1].role) == ("second", "validation")


def test_other_files_are_left_alone_and_nothing_temporary_stays(fit: Fit, tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("mine")
    save_result(fit, tmp_path)
    save_result(fit, tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arrays.npz", "letter.txt", "model.toml", "result.json"]


def test_the_same_fit_gives_the_same_bytes(fit: Fit, tmp_path: Path) -> None:
    one, two = save_result(fit, tmp_path / "one"), save_result(fit, tmp_path / "two")
    for name in ("arrays.npz", "model.toml", "result.json"):
        assert (one / name).read_bytes() == (two / name).read_bytes()


def test_a_folder_that_cannot_be_written_is_refused(fit: Fit, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        save_result(fit, tmp_path / "file" / "folder")


def test_files_that_do_not_belong_together_are_refused(fit: Fit, tmp_path: Path) -> None:
    save_result(fit, tmp_path)
    with (tmp_path / "model.toml").open("a") as file:
        file.write("# edited\n")
    with pytest.raises(InputError, match="has changed since"):
        load_fit(tmp_path)


def test_a_folder_without_a_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no result folder"):
        load_fit(tmp_path)


def test_a_result_replaces_one_of_another_kind(tmp_path: Path) -> None:
    fit = RESULTS["fit"]()
    folder = api.save(fit, tmp_path / "day").parent
    (folder / "notes.txt").write_text("windy")
    api.save(RESULTS["tuning"](), folder)
    assert isinstance(load_result(folder), Tuning)
    assert not {"result.json", "model.toml"} & {file.name for file in folder.iterdir()}
    assert (folder / "notes.txt").read_text() == "windy"
    api.save(fit, folder)
    assert {file.name for file in folder.iterdir()} == {
        "result.json", "model.toml", "arrays.npz", "report.html", "notes.txt",
    }  # fmt: skip


EDITS = [
    (("solution", "value"), "lost"), (("solution", "point"), 3.0), (("coefficients", 0, "estimate"), "lost"),
    (("coefficients", 0, "name"), None), (("residuals", 0, "autocorrelation"), {}), (("findings", 0, "text"), 1.0),
    (("stored_records", "record0", "channels"), "lost"), (("stored_records", "record0", "provenance", "steps"), [1]),
    (("stored_records", "record0", "channels", "u", "unit"), None), (("stored_records", "record0", "name"), 3),
]  # fmt: skip


@pytest.mark.parametrize(("path", "value"), EDITS)
def test_a_field_that_was_edited_is_refused_by_its_name(
    tmp_path: Path, fit: Fit, path: tuple[str | int, ...], value: object
) -> None:
    """Whatever stands there instead; `lost`: the entry is gone."""
    file = save_result(fit, tmp_path / "r") / "result.json"
    table = json.loads(file.read_text())
    entry = table
    for key in path[:-1]:
        entry = entry[key]
    if value == "lost":
        del entry[path[-1]]
    else:
        entry[path[-1]] = value
    file.write_text(json.dumps(table))
    names = [str(key) for key in path if isinstance(key, str)]
    with pytest.raises(InputError, match=rf"is damaged .*({names[0]}|{names[-1]})"):
        load_result(file.parent)
