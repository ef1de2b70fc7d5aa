"""Likelihood of spectra: exact gradient, power as expected at the truth, and lines in the frequency domain."""

import math

import numpy as np
import pytest

from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial.trial import WaveEncounter
from seatrial.estimation.identify.strategies.wave_spectrum import spectral_problem
from seatrial.estimation.problem.line_least_squares import line_least_squares
from seatrial.estimation.problem.spectral_likelihood import SpectralLikelihood
from seatrial.numerics.optimise import levenberg_marquardt
from seatrial.physics.models.heave_pitch_coefficients import COEFFICIENTS, physical_start_values
from seatrial.physics.sea.encounter import encounter_frequency
from seatrial.physics.sea.realise import Spacing
from seatrial.physics.sea.spectrum import ittc
from seatrial.physics.simulate.harmonics import Complex
from seatrial_studies.seaway import (
    HEAVE_NOISE,
    PITCH_NOISE,
    SPEED,
    SeawayRun,
    SeawayScenario,
    box_hull,
    simulate_seaway_run,
)

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


def lined(made: SeawayRun) -> Complex:
    forces = np.zeros((len(made.lines.omega), 4), complex)
    forces[:, :2] = -made.lines.forces(box_hull())
    return forces


@pytest.mark.parametrize("heading", [90, 135, 180])
def test_known_lines_give_the_coefficients_within_the_bound(heading: int) -> None:
    voyage = SeawayScenario(heading, has_fin=False, duration=240.0)
    made = simulate_seaway_run(voyage, np.random.default_rng(3))
    known = dict(zip(made.truth.parameters.names, made.truth.parameters.values, strict=True))
    start, forces = made.truth.with_values(physical_start_values(known)), lined(made)
    truth = np.array([known[n] for n in COEFFICIENTS])
    errors = []
    for draw in range(30):
        record = made.with_sensor_noise(np.random.default_rng(draw), voyage).between(40.0, 240.0)
        motions = np.stack([record["z"], record["theta"]], axis=1)
        lines = line_least_squares(start, record.time, motions, ("z", "theta"), np.array(voyage.noise),
                            made.lines.omega_e, forces)  # fmt: skip
        found = levenberg_marquardt(lines, lines.start(), NONE, evaluations=80)
        errors.append((found.solution.point - truth) / np.sqrt(np.diag(np.linalg.inv(found.normal.hessian))))
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(1.0, abs=0.2)
    assert np.abs(np.mean(errors, axis=0)).max() < 0.7


def test_lines_closer_than_the_record_shows_are_refused() -> None:
    voyage = SeawayScenario(180, has_fin=False, duration=60.0)
    made = simulate_seaway_run(voyage, np.random.default_rng(3))
    motions = np.stack([made.record["z"], made.record["theta"]], axis=1)
    omega = made.lines.omega_e.copy()
    omega[1] = omega[0] + 1e-6
    with pytest.raises(InputError, match="does not tell apart lines"):
        line_least_squares(made.truth, made.record.time, motions, ("z", "theta"), np.ones(2), omega, lined(made))
