"""The section in waves on the real records: held-out periods, natural periods, stiffness, dead channels."""

import importlib
import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial import api
from seatrial.core.results import Verdict
from seatrial.core.values import InputError, Ship
from seatrial.data.folder.document import document, strict_json
from seatrial.estimation.sea import WaveResponses, fit_section
from seatrial_studies.cross_validation import jackknife_error
from seatrial_studies.section2d import study
from seatrial_studies.section2d.analysis import SectionAnalysis, analyse_records
from seatrial_studies.section2d.facts import FACTS, largest_errors
from seatrial_studies.section2d.modes import CROSS_AXIS, HEAVE, REPEATABILITY, split_periods
from seatrial_studies.section2d.responses import (
    BEAM,
    DEPTH,
    DRAUGHT,
    GM,
    HEAVE_PERIOD,
    HEIGHTS,
    KG,
    LENGTH,
    MASS,
    ROLL_PERIOD,
    ROLL_RADIUS,
    STEADY_TIMING,
    SWAY_STIFFNESS,
    read_periods,
)
from seatrial_studies.study_file import read_study
from seatrial_studies.study_page import StudyPage


@pytest.fixture(scope="module")
def made(data_folder: Path) -> Iterator[SectionAnalysis]:
    folder = data_folder / "section2d_waves"
    if not folder.is_dir():
        pytest.skip("the section's records are not here")
    yield analyse_records(folder, quick=True, report_progress=None)


def page(made: SectionAnalysis) -> StudyPage[SectionAnalysis]:
    return StudyPage(read_study("section2d"), FACTS, made)


def verdict(made: SectionAnalysis, start: str) -> Verdict:
    return next(c.verdict for c in page(made).claims() if c.claim.startswith(start))


def test_periods_held_out_between_trained_ones_are_predicted(made: SectionAnalysis) -> None:
    for fit in (made.heave, made.roll):
        amplitude, phase = largest_errors(fit)
        assert amplitude <= 1.5 and phase <= 1.5
        held = [s for s in fit.scores if not s.is_training]
        assert len({s.response.run.period_index for s in held}) >= 2


def test_a_section_of_ones_own_is_predicted_at_periods_left_out(made: SectionAnalysis) -> None:
    """Heave with free sway, by the table alone: each period from 0.9 s on that lies between others."""
    runs = [r for r in made.responses if r.run.scenario == HEAVE.scenario and r.run.period > 0.75]
    runs.sort(key=lambda r: -r.run.period)
    leaks = np.array([CROSS_AXIS * abs(r.sway / r.heave) for r in runs])
    table = WaveResponses(
        "sway-heave", np.array([r.run.omega for r in runs]), np.array([r.wave_amplitude for r in runs]),
        {"z": np.array([-r.heave for r in runs])}, {"z": np.hypot(REPEATABILITY, leaks)},
    )  # fmt: skip
    particulars = {"L": LENGTH, "B": BEAM, "d": DRAUGHT, "m": MASS, "KG": KG, "GM": GM, "k_xx": ROLL_RADIUS}
    ship, begun = Ship("section", particulars), {"gain_z": 1.1, "d33": 100.0, "c22": np.mean(SWAY_STIFFNESS)}
    indices = np.array([r.run.period_index for r in runs])
    for index in (4, 6, 8):
        fit = fit_section(
            ship, table.rows(indices != index), ("sway", "heave"), ("gain_z", "delay", "a33", "d33"), begun, DEPTH
        )
        amplitude, phase = fit.errors_of(table.rows(indices == index))["z"]
        assert np.max(np.abs(amplitude)) <= 1.5
        assert np.max(np.abs(phase)) <= 1.5


def test_natural_periods_are_the_documented_ones(made: SectionAnalysis) -> None:
    assert made.heave.period == pytest.approx(HEAVE_PERIOD, rel=0.01)
    assert made.roll.period == pytest.approx(ROLL_PERIOD, rel=0.01)


def test_nothing_of_a_held_out_period_trains(made: SectionAnalysis) -> None:
    """Changing what was measured there leaves the trained oscillator as it is."""
    from seatrial_studies.section2d.modes import fit_mode

    held = {s.response.run.name for s in made.heave.scores if not s.is_training}
    bent = [replace(r, heave=1.1 * r.heave) if r.run.name in held else r for r in made.responses]
    again = fit_mode(HEAVE, bent)
    assert again.half_of_periods.oscillator == made.heave.half_of_periods.oscillator
    assert largest_errors(again)[0] > 5.0


def test_sway_stiffness_meets_the_documented_range(made: SectionAnalysis) -> None:
    low, high = SWAY_STIFFNESS
    assert (
        made.sway_stiffness.mean - 2.0 * made.sway_stiffness.error <= high
        and made.sway_stiffness.mean + 2.0 * made.sway_stiffness.error >= low
    )
    assert made.sway_stiffness.error < 1.0


def test_friction_in_the_guide_is_dry(made: SectionAnalysis) -> None:
    assert made.guide.exponent + 2.0 * made.guide.error < -0.5
    near = [f for f in made.guide.runs if f.run.startswith("3102")]
    assert all(7.0 < f.damping < 9.0 and f.third_harmonic_ratio == pytest.approx(1.0 / 3.0, abs=0.08) for f in near)
    assert verdict(made, "The rig damps") is Verdict.REFUTED
    linear = replace(made, guide=replace(made.guide, exponent=0.05, error=0.2))
    assert verdict(linear, "The rig damps") is Verdict.CONFIRMED


def test_dead_camera_channels_are_found_and_no_others(made: SectionAnalysis) -> None:
    assert {f.message.split(":")[0] for f in made.dead_channel_findings} == {"3102_4", "4061_2"}


def test_the_waves_have_their_nominal_height(made: SectionAnalysis) -> None:
    ratios = [2.0 * r.wave_amplitude / HEIGHTS[r.run.height_index] for r in made.responses if r.run.period > 0.85]
    assert np.mean(ratios) == pytest.approx(1.0, abs=0.03) and np.ptp(ratios) < 0.06


def test_energy_is_not_made_by_the_section(made: SectionAnalysis) -> None:
    assert all(r.reflected_ratio**2 + r.transmitted_ratio**2 < 1.05 for r in made.responses)


def test_the_stretch_lies_between_ramp_and_reflection(made: SectionAnalysis) -> None:
    for r in made.responses:
        start, stop = r.run.steady_window(STEADY_TIMING)
        assert r.run.stroke_times[1] < start < stop <= r.run.record.time[-1]


def test_accelerometers_and_camera_differ_by_the_known_gain(made: SectionAnalysis) -> None:
    from seatrial_studies.section2d.analysis import camera_gain

    assert camera_gain(made)[0] == pytest.approx(1.13, abs=0.03)


def test_without_a_tie_the_added_mass_is_open(made: SectionAnalysis) -> None:
    plain, linear, quadratic = (made.untied_errors[k][0] for k in (0, 1, 2))
    assert plain < 1.0 < 20.0 < linear < quadratic


def test_claims_and_checks_can_come_out_the_other_way(made: SectionAnalysis) -> None:
    off = replace(made, heave=replace(made.heave, period=1.25), dead_channel_findings=())
    assert verdict(off, "The natural period in heave") is Verdict.REFUTED
    assert [c.name for c in page(off).checks() if not c.holds] == [
        "heave, natural period off the documented [%]",
        "runs with dead camera channels",
    ]
    assert verdict(replace(made, dead_channel_findings=(), clocks={}), "All channels") is Verdict.CONFIRMED
    assert all(c.holds for c in page(made).checks())


def test_every_table_has_as_many_cells_as_its_header(made: SectionAnalysis) -> None:
    for table in page(made).tables():
        assert table.rows and all(len(row) == len(table.header) for row in table.rows), table.title


def test_half_of_the_periods_train_and_the_extremes_are_among_them() -> None:
    assert split_periods([2, 4, 6, 8, 10, 11, 13, 4]) == ((2, 6, 10, 13), (4, 8, 11))
    assert split_periods([4, 6, 9, 11, 11]) == ((4, 11), (6, 9))


def test_the_jackknife_of_a_mean_is_its_standard_error(rng: np.random.Generator) -> None:
    x = rng.standard_normal(12)
    left = [float(np.mean(np.delete(x, k))) for k in range(12)]
    assert jackknife_error(left) == pytest.approx(float(np.std(x, ddof=1) / np.sqrt(12)))


def test_the_command_writes_a_page(made: SectionAnalysis, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = importlib.import_module("seatrial_studies.section2d")
    monkeypatch.setattr(module, "data_folder", lambda: tmp_path)
    monkeypatch.setattr(module, "analyse_records", lambda *_, **__: made)
    done = study(quick=True, seed=0, report_progress=None)
    page = api.save(done, tmp_path / "out")
    table = json.loads(strict_json(document(done)))
    assert table["name"] == "section2d" and len(table["checks"]) == 8 and "Haskind" in page.read_text()


@pytest.mark.parametrize("folder", [None, "nowhere"])
def test_without_the_records_it_says_one_sentence(
    folder: str | None,
    run_command: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    if folder:
        monkeypatch.setenv("SEATRIAL_DATA", folder)
    code = run_command("reproduce", "section2d")
    said = capsys.readouterr().err
    sentences = [line for line in said.strip().splitlines() if line.startswith("seatrial: ")]
    assert code == 2 and len(sentences) == 1 and "set it to their folder" in sentences[0]


def test_a_broken_list_of_periods_is_named(tmp_path: Path) -> None:
    (tmp_path / "periods.csv").write_text("index,period_s\n1,1.2\n")
    with pytest.raises(InputError, match="index, period in s"):
        read_periods(tmp_path / "periods.csv")
