"""What other programs read of a tuning: gains that come back, a loop that python-control closes alike, strict JSON."""

import csv
import io
import tomllib
from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest
from scipy.io import loadmat
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin, heading_loop

from seatrial.core.results.tuning import Component, Tuning
from seatrial.core.values import InputError
from seatrial.data.folder.gains_file import (
    controller_gains,
    gains_toml,
    loop_mat,
    read_gains,
    read_schedule,
    schedule_csv,
)
from seatrial.physics.loops import TransferLoop, margins
from seatrial.physics.loops.structures import fin_loop

MADE = {"fin": fabricated_fin, "autopilot": fabricated_autopilot, "bare": fabricated_bare}


@pytest.fixture(scope="module", params=sorted(MADE))
def tuning(request: pytest.FixtureRequest) -> Tuning:
    return MADE[request.param]()


@pytest.fixture(scope="module")
def fin() -> Tuning:
    return fabricated_fin()


def loaded(tuning: Tuning) -> dict:
    return loadmat(io.BytesIO(loop_mat(tuning)), squeeze_me=True, struct_as_record=False)


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "gains.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_gains_come_back_to_the_last_bit(tuning: Tuning, tmp_path: Path) -> None:
    uneven = {name: value / 3.0 for name, value in tuning.chosen.gains.items()}
    changed = replace(tuning, chosen=replace(tuning.chosen, gains=uneven))
    assert read_gains(written(tmp_path, gains_toml(changed))) == uneven


def test_gains_stand_beside_what_they_keep(fin: Tuning) -> None:
    table = tomllib.loads(gains_toml(fin))
    assert table["constraints"]["limit_deg"] == pytest.approx(22.0)
    assert table["constraints"]["rate_deg_per_s"] == pytest.approx(25.0)
    assert table["margins"]["Ms"] == fin.chosen.Ms
    assert table["controller"]["seas"] == list(fin.seas)
    assert [slot["gains"] for slot in table["schedule"]] == [slot.gains for slot in fin.schedule]


def test_what_is_unlimited_is_left_out() -> None:
    bare = tomllib.loads(gains_toml(fabricated_bare()))
    assert set(bare["constraints"]) == {"Ms", "saturation", "rate_saturation"}
    assert "Ms" not in bare["margins"] and "schedule" not in bare


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("gains = 3", "has no table \\[gains\\]"),
        ("[gains]", "has no table \\[gains\\]"),
        ("[gains]\nKP = nan", "gain KP = nan is no finite number"),
        ('[gains]\nKP = "3"', "gain KP = '3' is no finite number"),
        ("[gains]\nKP = true", "gain KP = True is no finite number"),
        ("KP : 3", "is no TOML"),
    ],
)
def test_a_file_without_gains_is_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        read_gains(written(tmp_path, text))


def test_a_file_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"'.*absent.toml' cannot be read"):
        read_gains(tmp_path / "absent.toml")


@pytest.mark.parametrize(("make", "loop"), [(fabricated_fin, fin_loop()), (fabricated_autopilot, heading_loop())])
def test_the_rebuilt_loop_closes_as_the_tuning_says(make, loop: TransferLoop) -> None:
    tuning = make()
    known = loaded(tuning)
    open_loop = control.tf(known["open_loop_num"], known["open_loop_den"])
    sensitivity = control.feedback(control.tf(1, 1), open_loop)
    fine = np.geomspace(tuning.chosen.omega[0], tuning.chosen.omega[-1], 40_001)
    assert np.max(np.abs(sensitivity(1j * fine))) == pytest.approx(tuning.chosen.Ms, rel=1e-6)
    tuned = loop.with_gains(np.array(list(tuning.chosen.gains.values())))
    assert margins(tuned).Ms == tuning.chosen.Ms
    poles = np.sort_complex(control.feedback(open_loop, control.tf(1, 1)).poles())
    assert poles == pytest.approx(np.sort_complex(tuned.closed_loop_poles), rel=1e-6)


def test_blocks_in_parallel_and_in_a_row_give_the_same_open_loop(fin: Tuning) -> None:
    known = loaded(fin)
    blocks = [value for name, value in known.items() if name.split("_")[0] in ("sensor", "servo", "plant", "term")]
    systems = {role: [(b, control.tf(b.num, b.den)) for b in blocks if b.role == role]
               for role in ("sensor", "servo", "plant", "term")}  # fmt: skip
    s = 1j * fin.chosen.omega
    through = np.prod([tf(s) for role in ("sensor", "servo", "plant") for _, tf in systems[role]], axis=0)
    summed = np.sum([getattr(known["gains"], b.gain) * tf(s) for b, tf in systems["term"]], axis=0)
    assert through * summed == pytest.approx(fin.chosen.open_loop, rel=1e-9)
    K = control.tf(known["controller_num"], known["controller_den"])
    plant = systems["plant"][0][1]
    assert K(s) * plant(s) == pytest.approx(fin.chosen.open_loop, rel=1e-9)


def test_the_same_loop_gives_the_same_bytes_without_a_date(tuning: Tuning) -> None:
    once = loop_mat(tuning)
    assert once == loop_mat(tuning)
    assert once[:116].decode("ascii").rstrip() == "MATLAB 5.0 MAT-file, a feedback loop written by seatrial"
    assert once[124:128] == b"\x00\x01IM"


def test_blocks_of_one_name_and_of_odd_names_are_all_kept(fin: Tuning) -> None:
    odd = [Component("filter", name, (1.0,), (1.0, 1.0)) for name in ("notch", "notch", "2 Hz / ω", "")]
    known = loaded(replace(fin, components=(*fin.components, *odd)))
    filters = {name for name in known if name.startswith("filter")}
    assert filters == {"filter_notch", "filter_notch_2", "filter_2_Hz", "filter"}


def test_a_term_without_its_gain_is_refused(fin: Tuning) -> None:
    stray = Component("term", "lag", (1.0,), (1.0, 1.0), "KX")
    with pytest.raises(InputError, match="term 'lag' is multiplied by 'KX', which is none of the chosen gains"):
        loop_mat(replace(fin, components=(stray,)))


def test_a_loop_without_blocks_has_its_gains(fin: Tuning) -> None:
    known = loaded(fabricated_bare())
    assert vars(known["gains"])["KP"] == fin.chosen.gains["KP"]
    assert "open_loop_num" not in known


def test_the_schedule_is_a_table(fin: Tuning) -> None:
    rows = list(csv.DictReader(io.StringIO(schedule_csv(fin))))
    assert len(rows) == len(fin.schedule)
    assert [float(row["heading [deg]"]) for row in rows[:3]] == [45.0, 90.0, 135.0]
    assert [float(row["KP"]) for row in rows] == [slot.gains["KP"] for slot in fin.schedule]
    assert float(rows[0]["cost given"]) == pytest.approx(fin.schedule[0].baseline_costs["given"], rel=1e-7)
    assert {row["feasible"] for row in rows} == {"yes", "no"}
    assert schedule_csv(fabricated_bare()) == ""


def test_a_station_keeper_is_written_with_gains_units_and_thrusters() -> None:
    table = tomllib.loads(gains_toml(fabricated_autopilot()))["station"]
    assert table["KP"] == [[13.0, 0.0, 0.0], [0.0, 19.5, 0.0], [0.0, 0.0, 5.2]]
    assert table["gain_units"]["KP"][0] == ["N/m", "N/m", "N/rad"]
    assert table["thrusters"][0]["inverse"] == [[0.5, 0.0, 0.4]]
    assert (table["sample_s"], table["Ms_joint"]) == (0.1, 1.92)
    assert "station" not in tomllib.loads(gains_toml(fabricated_fin()))


def test_the_guidance_of_a_track_is_written_with_its_units() -> None:
    table = tomllib.loads(gains_toml(fabricated_autopilot()))["track"]
    assert table["lookahead_m"] == 300.0
    assert table["integral_gain_m_per_s"] == 1.5
    assert table["order_rate_deg_per_s"] == pytest.approx(1.1459, abs=1e-4)
    assert "track" not in tomllib.loads(gains_toml(fabricated_fin()))


def test_the_schedule_comes_back(fin: Tuning, tmp_path: Path) -> None:
    points = read_schedule(written(tmp_path, gains_toml(fin)))
    assert [point.gains for point in points] == [point.gains for point in fin.schedule]
    assert [point.beta for point in points] == pytest.approx([point.beta for point in fin.schedule])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [("[gains]\nKP = 1.0\n", "has no"), ("[[schedule]]\nU = 9.0\n", "is incomplete"), ("U =", "is no TOML")],
)
def test_a_file_without_a_schedule_is_refused(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=sentence):
        read_schedule(written(tmp_path, text))


def test_gains_that_need_a_filter_have_no_place_without_it(tmp_path: Path) -> None:
    path = tmp_path / "gains.toml"
    lines = "[gains]\nKP = 1.0\n[discrete]\nsample_s = 0.1\n[[discrete.blocks]]\nrole = 'filter'\nname = '{}'\n"
    path.write_text(lines.format("notch"), encoding="utf-8")
    with pytest.raises(InputError, match="tuned with notch, which has no place there"):
        controller_gains(path)
    path.write_text(lines.format("reversed"), encoding="utf-8")
    assert controller_gains(path) == {"KP": 1.0}
