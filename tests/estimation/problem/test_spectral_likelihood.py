"""Likelihood of spectra: exact gradient, power as expected at the truth, and lines in the frequency domain."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array, Record
from seatrial.estimation.identify.waves import wave_spectrum_problem as spectral_problem
from seatrial.estimation.problem.spectral_likelihood import SpectralLikelihood
from seatrial.physics.hydro.excitation import encounter_frequency
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.sea.realise import Spacing
from seatrial.physics.sea.spectrum import WaveEncounter, ittc
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE, SPEED, SeawayScenario, box_hull, simulate_seaway_run

NONE = np.zeros((0, 0))


def problem(heading: int = 135) -> tuple[SpectralLikelihood, Array]:
    voyage = SeawayScenario(heading, duration=400.0, spacing=Spacing.JITTERED, line_count=300)
    made = simulate_seaway_run(voyage, np.random.default_rng(4))
    record = made.with_sensor_noise(np.random.default_rng(5), voyage)
    recorded = {name: record.channel(name) for name in ("delta_f1", "z", "theta")}
    record = Record(record.name, record.time, recorded, record.kind)
    waves = WaveEncounter(box_hull(), SPEED, math.radians(heading), ittc(2.27))
    truth = np.array([made.truth.parameters[n].value for n in COEFFICIENTS])
    return spectral_problem(made.truth, record, waves, {"z": HEAVE_NOISE, "theta": PITCH_NOISE}), truth


def test_the_gradient_is_that_of_the_cost() -> None:
    spectral, truth = problem()
    point = truth * np.linspace(0.9, 1.1, 8)
    exact = spectral.normal(point, NONE).gradient
    for j, value in enumerate(point):
        step = np.zeros(8)
        step[j] = 1e-5 * abs(value)
        slope = (spectral.cost(point + step, NONE) - spectral.cost(point - step, NONE)) / (2 * step[j])
        assert exact[j] == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("heading", [135, 180])
def test_at_the_truth_the_motions_have_the_power_expected(heading: int) -> None:
    spectral, truth = problem(heading)
    met = spectral.omega < encounter_frequency(np.array(ittc(2.27).band()), SPEED, math.radians(heading))[1]
    assert np.mean(spectral.misfit(truth)[met]) == pytest.approx(1.0, abs=0.15)
