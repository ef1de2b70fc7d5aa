"""Heave and pitch through a trial file: forces, elevation, or only the sea; and what is not identifiable is refused."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from tests.wave_trials import WITH_BOX, waves_table, write_wave_trial

from seatrial.core.results import Fit
from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify
from seatrial.physics.models.heave_pitch import heave_pitch_zoh
from seatrial.physics.sea.realise import Spacing
from seatrial.physics.simulate.linear import LinearBatch
from seatrial.reporting.page import html
from seatrial_studies.seaway import SeawayScenario, ship

FORCES = ("F3", "M5", "delta_f1", "z", "theta")
NOISE = '[noise]\nz = 0.01\ntheta = { sd = 0.02, unit = "deg" }\n'
# as many lines as a spectrum needs to be one
long = partial(SeawayScenario, duration=400.0, spacing=Spacing.JITTERED, line_count=300)
SEA = 'spectrum = "ittc", height = 2.27'


def errors(fit: Fit) -> np.ndarray:
    """Errors of the free coefficients in their standard errors."""
    free = [c for c in fit.coefficients if not c.fixed]
    return np.array([(c.estimate - c.truth) / c.standard_error for c in free])  # type: ignore[operator]


def shares(fit: Fit) -> np.ndarray:
    """Errors of the free coefficients over their true values."""
    return np.array([c.estimate / c.truth - 1.0 for c in fit.coefficients if not c.fixed])  # type: ignore[operator]


@pytest.mark.long(every=3)
@pytest.mark.parametrize("heading", [90, 135, 180])
def test_recorded_forces_give_the_coefficients_back(tmp_path: Path, heading: int) -> None:
    fit = identify(load_trial(write_wave_trial(tmp_path, [SeawayScenario(heading), SeawayScenario(heading)], FORCES)))
    assert np.abs(errors(fit)).max() < 4.0
    assert np.mean(np.abs(shares(fit))) < 0.005
    assert fit.method.criterion == "output error over whole runs"
    (held_out,) = fit.validation
    assert held_out.rms["z"] < 0.012
    assert held_out.rms["theta_deg"] < 0.024


def test_the_elevation_and_a_box_do_for_the_forces(tmp_path: Path) -> None:
    path = write_wave_trial(tmp_path, [SeawayScenario(135)], ("zeta", *FORCES[2:]), WITH_BOX, waves_table(135))
    fit = identify(load_trial(path))
    assert np.abs(errors(fit)).max() < 4.0
    assert np.abs(shares(fit)).max() < 0.05


def test_gain_and_delay_of_a_force_are_found(tmp_path: Path) -> None:
    voyages = [SeawayScenario(135, noise=(0.001, 1e-5))]
    path = write_wave_trial(tmp_path, voyages, FORCES, "[estimate]\ngains = ['M5']\ndelays = ['M5']\n")
    table = np.loadtxt(tmp_path / "run0.csv", delimiter=",", skiprows=1)
    table[:, 2] = np.interp(table[:, 0] + 0.1, table[:, 0], table[:, 2]) / 1.05  # early by .1 s, 5 % small
    np.savetxt(tmp_path / "run0.csv", table, delimiter=",", header=",".join(["time", *FORCES]), comments="", fmt="%.9g")
    found = {o.name: o.estimate for o in identify(load_trial(path)).offsets}
    assert found["M5 gain"] == pytest.approx(1.05, abs=0.01)
    assert found["M5 delay"] == pytest.approx(0.1, abs=0.01)


@pytest.mark.long(every=3)
@pytest.mark.parametrize("heading", [45, 135, 180])
def test_the_spectrum_of_the_sea_will_do_with_a_fin(tmp_path: Path, heading: int) -> None:
    path = write_wave_trial(tmp_path, [long(heading)], FORCES[2:], WITH_BOX + NOISE, waves_table(heading, SEA))
    fit = identify(load_trial(path))
    assert np.abs(errors(fit)).max() < 4.0
    assert np.abs(shares(fit)).max() < 0.25
    page = html(fit)
    assert "Motions in waves" in page
    assert 'id="residuals"' not in page


def test_beam_seas_known_by_their_spectrum_are_refused(tmp_path: Path) -> None:
    path = write_wave_trial(tmp_path, [long(90)], FORCES[2:], WITH_BOX + NOISE, waves_table(90, SEA))
    with pytest.raises(InputError, match="record the elevation"):
        identify(load_trial(path))


@pytest.mark.long
def test_a_sea_twice_as_high_as_it_was_is_refused(tmp_path: Path) -> None:
    wrong = SEA.replace("2.27", "5.0")
    path = write_wave_trial(tmp_path, [long(135)], FORCES[2:], WITH_BOX + NOISE, waves_table(135, wrong))
    with pytest.raises(InputError, match="check height, period and heading"):
        identify(load_trial(path))


@pytest.mark.parametrize("duration", [60.0, pytest.param(200.0, marks=pytest.mark.long)])
def test_waves_that_nobody_measured_are_refused(tmp_path: Path, duration: float) -> None:
    with pytest.raises(InputError, match="although no wave is recorded"):
        identify(load_trial(write_wave_trial(tmp_path, [SeawayScenario(135, duration=duration)], FORCES[2:])))


@pytest.mark.long
def test_calm_water_needs_no_waves(tmp_path: Path) -> None:
    calm = identify(load_trial(write_wave_trial(tmp_path, [SeawayScenario(135, has_waves=False)], FORCES[2:])))
    assert np.abs(errors(calm)).max() < 4.0


def test_nothing_that_moves_is_no_excitation(tmp_path: Path) -> None:
    path = write_wave_trial(tmp_path, [SeawayScenario(135, has_waves=False, has_fin=False)], FORCES)
    with pytest.raises(InputError, match="no excitation"):
        identify(load_trial(path))


@pytest.mark.parametrize(
    ("voyage", "channels"),
    [
        (SeawayScenario(135, has_waves=False), FORCES[2:]),
        (SeawayScenario(90, has_fin=False), ("F3", "M5", "z", "theta")),
    ],
    ids=["fin alone", "beam waves alone"],
)
def test_twelve_unknowns_of_one_input_are_refused_with_their_direction(
    tmp_path: Path, voyage: SeawayScenario, channels: tuple[str, ...]
) -> None:
    path = write_wave_trial(tmp_path, [voyage], channels)
    text = path.read_text().replace('"heave_pitch"', f'"heave_pitch"\nfree = {ALL_TWELVE}\n')
    path.write_text(text)
    # one input gives five equations between powers of s for the six coefficients of heave, and five for those of pitch:
    # either direction may be the one that is named
    with pytest.raises(InputError, match=r"do not determine the direction .*c[35]"):
        identify(load_trial(path))


def test_twelve_unknowns_of_waves_and_fin_are_stated(tmp_path: Path) -> None:
    path = write_wave_trial(tmp_path, [SeawayScenario(135)], FORCES)
    path.write_text(path.read_text().replace('"heave_pitch"', f'"heave_pitch"\nfree = {ALL_TWELVE}\n'))
    fit = identify(load_trial(path))
    assert np.abs(errors_of_eight(fit)).max() < 4.5


ALL_TWELVE = '["a33", "a35", "a55", "a53", "b33", "b35", "b55", "b53", "c33", "c35", "c53", "c55"]'


def errors_of_eight(fit: Fit) -> np.ndarray:
    """Errors in standard errors of those whose truth the trial states."""
    known = [c for c in fit.coefficients if not c.fixed and c.truth is not None]
    return np.array([(c.estimate - c.truth) / c.standard_error for c in known])  # type: ignore[operator]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("18, unit", "180, unit"), "in knots"),
        (("value = 135", "value = 200"), "is it in degrees"),
        (('source = "box"', 'source = "table"'), "needs a file"),
        (('[excitation]\nsource = "box"', ""), "nothing turns the elevation into forces"),
        (("value = 135", "value = 30"), "up to three waves"),
    ],
)
def test_waves_out_of_sense_are_one_sentence(tmp_path: Path, change: tuple[str, str], said: str) -> None:
    path = write_wave_trial(tmp_path, [SeawayScenario(135)], ("zeta", *FORCES[2:]), WITH_BOX, waves_table(135))
    path.write_text(path.read_text().replace(*change))
    with pytest.raises(InputError, match=said):
        identify(load_trial(path))


def test_unmeasured_disturbances_beside_measured_waves_become_process_noise(tmp_path: Path) -> None:
    voyage, rng = SeawayScenario(135, duration=100.0), np.random.default_rng(0)
    path = write_wave_trial(tmp_path, [voyage], FORCES)
    table = np.loadtxt(tmp_path / "run0.csv", delimiter=",", skiprows=1)
    model, count = ship(135), len(table)
    pushed = np.zeros((count, 4))
    pushed[:, :2] = rng.normal(size=(count, 2)) * [2e5, 2e6]
    batch = LinearBatch(heave_pitch_zoh().with_parameters(model.parameters), pushed, np.array([0, count]), 0.1,
                        ("z", "theta"))  # fmt: skip
    table[:, 4:] += batch.simulate(0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0)))[0]
    np.savetxt(tmp_path / "run0.csv", table, delimiter=",", header=",".join(["time", *FORCES]), comments="", fmt="%.9g")
    fit = identify(load_trial(path))
    assert fit.noise_model is not None
    assert fit.noise_model.method == "prediction error"
    assert set(fit.noise_model.process) <= {"z_dot", "theta_dot"}
    assert np.abs(errors(fit)).max() < 4.0
