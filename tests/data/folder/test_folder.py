"""The result folder: everything a report shows comes back; it is whole or it is not there."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.complete_fit import complete_fit

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
from seatrial.core.values import Finding, InputError, Record, RecordKind, Severity, Ship
from seatrial.data.folder.design_json import design_schema
from seatrial.data.folder.fit_json import FitDocument, fit_json, fit_schema, strict_json
from seatrial.data.folder.online_json import online_schema
from seatrial.data.folder.result_folder import load_fit, save_fit
from seatrial.data.trial.schema import trial_schema
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
        noise=(Noise("u", "m/s", 0.02, 0.1, math.nan),),
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


def test_a_fit_comes_back_from_its_folder(fit: Fit, tmp_path: Path) -> None:
    back = load_fit(save_fit(fit, tmp_path / "new" / "folder"))
    assert back.model.parameters == fit.model.parameters
    assert np.array_equal(back.covariance, fit.covariance)
    assert np.array_equal(back.solution.point, fit.solution.point)
    assert back.solution.status is Status.CONVERGED
    assert (back.coefficients, back.method, back.offsets) == (fit.coefficients, fit.method, fit.offsets)
    assert (back.findings, back.ship, back.seed, back.versions) == (fit.findings, fit.ship, fit.seed, fit.versions)
    assert math.isnan(back.noise[0].whiteness_p)
    assert np.array_equal(back.residuals[0].values, fit.residuals[0].values)
    assert back.predictions[1].rms["psi_deg"] == 1.0 / 3.0
    assert np.array_equal(back.records[1]["psi"], fit.records[1]["psi"])
    assert back.predictions[1].measured is back.records[1]
    assert back.predictions[0].simulated.kind is RecordKind.SIMULATED


def test_what_the_records_tell_comes_back_to_the_last_bit(fit: Fit, tmp_path: Path) -> None:
    full = complete_fit(fit)
    back = load_fit(save_fit(full, tmp_path))
    assert back.identifiability == full.identifiability
    assert (back.noise_model, back.candidate_models) == (full.noise_model, full.candidate_models)
    assert back.baselines == full.baselines and len(back.baselines) == 5
    for p, q in zip(back.predictions, full.predictions, strict=True):
        assert (p.extrapolation, p.noise_floor, p.tied_spread, p.measures.keys()) == (
            q.extrapolation, q.noise_floor, q.tied_spread, q.measures.keys(),
        )  # fmt: skip
        assert list(p.half_width) == list(q.half_width)
        assert all(np.array_equal(p.half_width[s], q.half_width[s]) for s in q.half_width)


def test_numbers_that_are_none_come_back_as_such(fit: Fit, tmp_path: Path) -> None:
    unknown = NoiseModel("output error", math.nan, {"u": math.inf}, {})
    back = load_fit(save_fit(replace(fit, noise_model=unknown), tmp_path)).noise_model
    assert back is not None and math.isnan(back.whiteness_p) and back.process == {"u": math.inf}


def test_a_folder_from_before_is_read(fit: Fit, tmp_path: Path) -> None:
    path = save_fit(fit, tmp_path) / "result.json"
    table = json.loads(path.read_text())
    for name in ("identifiability", "noise_model", "candidate_models", "baselines"):
        del table["detail"][name]
    for entry in table["detail"]["predictions"]:
        for name in ("extrapolation", "half_width", "noise_floor", "tied_spread"):
            del entry[name]
    path.write_text(strict_json(table))
    back = load_fit(tmp_path)
    assert (back.identifiability, back.noise_model, back.candidate_models, back.baselines) == (None, None, (), ())
    assert back.predictions[0].half_width == {}


def test_a_damaged_entry_is_one_sentence(fit: Fit, tmp_path: Path) -> None:
    path = save_fit(complete_fit(fit), tmp_path) / "result.json"
    table = json.loads(path.read_text())
    table["detail"]["noise_model"]["process"]["u"] = "much"
    path.write_text(strict_json(table))
    with pytest.raises(InputError, match=r"damaged \(process\.u: .*identify' again$"):
        load_fit(tmp_path)


def test_the_json_has_the_documented_entries_and_no_nan(fit: Fit) -> None:
    table = json.loads(strict_json(fit_json(fit)))
    assert list(table) == [
        "coefficients", "intervals", "validation", "identifiability", "noise", "candidate_models", "seakeeping", "roll",
        "baselines", "findings", "elapsed_s", "versions", "seed",
    ]  # fmt: skip
    assert list(table["coefficients"][0]) == [
        "name", "unit", "estimate", "standard_error", "lower", "upper", "fixed", "truth",
    ]  # fmt: skip
    assert "truth" not in table["coefficients"][-1]
    assert [v["record"] for v in table["validation"]] == ["second"]
    assert table["validation"][0]["rms"] == {"psi_deg": 1.0 / 3.0, "v": None}
    measure = table["validation"][0]["measures"]["overshoot_1_deg"]
    assert measure == {"measured": 4.0, "simulated": None, "lower": None, "upper": None}
    assert list(table["findings"][0]) == ["severity", "code", "text", "advice"]
    FitDocument.model_validate(table)


def test_what_was_not_examined_is_null_or_empty(fit: Fit) -> None:
    table = fit_json(fit)
    run = table["validation"][0]
    assert (table["identifiability"], table["noise"], table["candidate_models"]) == (None, None, [])
    assert (run["extrapolation_index"], run["extrapolation"], run["noise_floor"], run["tied_spread"]) == (
        None,
        {},
        {},
        {},
    )


def test_what_the_records_tell_stands_in_the_json(fit: Fit) -> None:
    full = complete_fit(fit)
    table = json.loads(strict_json(fit_json(full)))
    FitDocument.model_validate(table)
    known = full.identifiability
    assert known is not None
    said = table["identifiability"]
    assert said["effective_parameters"] == known.effective_parameters
    assert [s["text"] for s in said["structural"]] == [s.text for s in known.structural]
    assert said["structural"][0]["parameters"] == list(known.structural[0].parameters)
    assert [d["standard_deviation"] for d in said["directions"]] == [
        None, *(d.standard_deviation for d in known.directions[1:]),
    ]  # fmt: skip
    assert said["directions"][1]["combination"] == known.directions[1].combination
    assert list(table["noise"]) == ["method", "whiteness_p", "process", "measurement", "text"]
    run = table["validation"][0]
    assert run["extrapolation_index"] == 1.9 and run["extrapolation"]["yaw_rate"] == 1.9
    assert run["noise_floor"]["position_m"] == 0.19 and run["tied_spread"]["psi_deg"] == 0.31
    assert run["measures"]["overshoot_2_deg"]["lower"] == 3.9 * 0.96
    assert [m["is_chosen"] for m in table["candidate_models"]] == [True, False, False, False]
    assert table["candidate_models"][-1]["heading_deg"] is None


def test_the_model_file_knows_the_approach(fit: Fit, tmp_path: Path) -> None:
    from seatrial.data.folder.model_file import read_model_file

    file = read_model_file(save_fit(fit, tmp_path) / "model.toml")
    assert file.approach == pytest.approx({"u": 0.8, "v_j": 1.8})
    assert file.provenance.records[1][:2] == ("second", "validation")


def test_other_files_are_left_alone_and_nothing_temporary_stays(fit: Fit, tmp_path: Path) -> None:
    (tmp_path / "letter.txt").write_text("mine")
    save_fit(fit, tmp_path)
    save_fit(fit, tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["arrays.npz", "letter.txt", "model.toml", "result.json"]


def test_the_same_fit_gives_the_same_bytes(fit: Fit, tmp_path: Path) -> None:
    one, two = save_fit(fit, tmp_path / "one"), save_fit(fit, tmp_path / "two")
    for name in ("arrays.npz", "model.toml", "result.json"):
        assert (one / name).read_bytes() == (two / name).read_bytes()


def test_a_folder_that_cannot_be_written_is_refused(fit: Fit, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be written"):
        save_fit(fit, tmp_path / "file" / "folder")


def test_files_that_do_not_belong_together_are_refused(fit: Fit, tmp_path: Path) -> None:
    save_fit(fit, tmp_path)
    with (tmp_path / "model.toml").open("a") as file:
        file.write("# edited\n")
    with pytest.raises(InputError, match="has changed since"):
        load_fit(tmp_path)


def test_a_folder_without_a_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is no result folder"):
        load_fit(tmp_path)


@pytest.mark.parametrize(
    ("name", "schema"),
    [("design", design_schema), ("online", online_schema), ("result", fit_schema), ("trial", trial_schema)],
)
def test_the_published_schemas_are_those_in_force(name: str, schema, repository: Path) -> None:
    published = json.loads((repository / "docs" / f"{name}.schema.json").read_text())
    assert published == schema(), f"write docs/{name}.schema.json again: python docs/write_schemas.py"
