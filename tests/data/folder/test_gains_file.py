"""Files of gains: what other programs read of a tuning, the helmsman's table, proposals; earlier versions load."""

import csv
import io
import math
import shutil
import tomllib
from dataclasses import replace
from pathlib import Path

import control
import numpy as np
import pytest
from scipy.io import loadmat
from tests.data.folder.write_earlier_results import FOLDER, RESULTS
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin, heading_loop

import seatrial as st
from seatrial.api import campaign_status, gather_campaign
from seatrial.core.results import Actuator, TimedOrder
from seatrial.core.results.online import GainMargins, Proposal
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.results.tuning import Component, Tuning
from seatrial.core.values import InputError
from seatrial.data.folder.gains_file import (
    channel_display_unit,
    controller_gains,
    gains_toml,
    loop_mat,
    order_cells,
    order_headings,
    orders_csv,
    proposal_toml,
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


ACTUATORS = (Actuator("delta", -0.6, 0.6, 0.05, 5.0), Actuator("v_j", 1.0, 3.0, 0.5, 5.0))


def test_angles_are_given_in_degrees() -> None:
    assert channel_display_unit("delta") == (pytest.approx(180.0 / math.pi), "deg")
    assert channel_display_unit("no channel of the notation") == (1.0, "1")
    assert order_headings(ACTUATORS) == ["time [s]", "delta [deg]", "v_j [m/s]"]


def test_an_order_is_as_fine_as_a_hundredth_of_the_range() -> None:
    assert order_cells(TimedOrder(6.25, {"delta": math.radians(10.04), "v_j": 1.23456}), ACTUATORS) == [
        "6.25", "10", "1.23",
    ]  # fmt: skip
    assert order_cells(TimedOrder(7.0, {}), ACTUATORS) == ["7", "", ""]


def test_the_file_has_a_line_for_each_order() -> None:
    design = fabricated_design()
    lines = orders_csv(design).splitlines()
    assert lines[0] == "time [s],delta [deg]" and len(lines) == 1 + len(design.orders)


ANY = IntervalEstimate(math.inf, 2.0, math.inf)
ANGLE = IntervalEstimate(1.0, 0.5, 2.0)


def test_infinite_margins_are_left_out_and_angles_are_degrees() -> None:
    margins = GainMargins(ANGLE, ANY, ANGLE, ANY, ANGLE, ANGLE, 40, 40)
    table = tomllib.loads(proposal_toml(Proposal("fins", 0.0, 1200.0, {"KP": 3.0}, ("why",), margins=margins)))
    assert table["gains"] == {"KP": 3.0}
    assert table["margins"]["gain_margin"] == {"lower": 2.0}
    assert table["margins"]["phase_margin_deg"]["value"] == pytest.approx(math.degrees(1.0), rel=1e-5)


def test_a_proposal_without_gains_says_why() -> None:
    table = tomllib.loads(proposal_toml(Proposal("fins", math.nan, math.nan, {}, ("too little roll",))))
    assert not table["has_gains"]
    assert table["reasons"] == ["too little roll"]
    assert "sea" not in table


FILES = Path(__file__).with_name("earlier_files")
LOOPS = {
    "fin_from_decay": "roll", "fin_stabiliser": "", "ride_control": "heave_pitch", "waterjet_autopilot": "waterjet",
    "waterjet_track": "waterjet", "waterjet_weather": "waterjet",
}  # fmt: skip
TRIALS = sorted(path.stem for path in FILES.glob("*.toml") if path.stem not in {*LOOPS, "gains"})


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_loads(name: str) -> None:
    result = st.load(FOLDER / name)
    assert type(result).__name__.lower() == name


def test_the_numbers_of_a_fit_are_those_that_were_written() -> None:
    fit = st.load_fit(FOLDER / "fit")
    assert len(fit.params) == 11 and len(fit.records) == 4
    assert fit.params["Y_v"] == pytest.approx(fit.model.parameters["Y_v"].value, rel=1e-12)
    assert fit.covariance.shape == (11, 11) and np.isfinite(fit.predictions[0].simulated["psi"]).all()
    assert "zigzag_25_25" in [p.record for p in fit.validation]


@pytest.mark.parametrize("path", sorted((FILES / "models").glob("*.toml")), ids=lambda p: p.stem)
def test_a_model_file_loads(path: Path) -> None:
    file = st.load_model(path)
    assert len(file.covariance) == len(file.model.parameters.free)
    assert [source.role for source in file.provenance.records].count("training") >= 1


@pytest.mark.parametrize("name", TRIALS)
def test_a_trial_file_loads(name: str, tmp_path: Path, repository: Path, request: pytest.FixtureRequest) -> None:
    text = (FILES / f"{name}.toml").read_text(encoding="utf-8")
    if "${SEATRIAL_DATA}" in text:
        text = text.replace("${SEATRIAL_DATA}", request.getfixturevalue("data_folder").as_posix())
    (tmp_path / "trial.toml").write_text(text, encoding="utf-8")
    for folder in (repository / "examples").iterdir():
        if folder.is_dir() and f'folder = "{folder.name}"' in text:
            shutil.copytree(folder, tmp_path / folder.name)
    trial = st.load_trial(tmp_path / "trial.toml")
    assert trial.model.states


@pytest.mark.parametrize("name", LOOPS)
def test_a_loop_file_loads(name: str) -> None:
    model = FILES / "models" / f"{LOOPS[name]}.toml" if LOOPS[name] else None
    task = st.load_loop(FILES / f"{name}.toml", model_file=model)
    assert len(task.objectives) > 1


def test_a_file_of_gains_loads() -> None:
    gains = read_gains(FILES / "gains.toml")
    assert gains and all(np.isfinite(list(gains.values())))


def test_a_campaign_loads() -> None:
    assert campaign_status(FILES / "campaign").done == 1
    assert len(gather_campaign(FILES / "campaign").coefficients) == 11
