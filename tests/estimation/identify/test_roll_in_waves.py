"""Roll in irregular waves: with the wave slope recorded, and with waves that nobody measured; the truth is known."""

import math
from pathlib import Path

import numpy as np
import pytest
from tests.simulated_roll import SHIP, simulate_roll_record

from seatrial.core.equations import Model
from seatrial.core.results import Fit
from seatrial.core.values import InputError, Record
from seatrial.data.trial import load_trial
from seatrial.estimation.estimate import EstimatorOptions, Runs, estimate_model
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.identification import is_unforced_roll
from seatrial.estimation.identify.waves import profiled_logarithm, spectral_optima, spectral_problem
from seatrial.estimation.problem.spectral_likelihood import DAMPING, RESTORING
from seatrial.physics.models.roll import roll
from seatrial.physics.sea.spectrum import Spectrum, bretschneider, jonswap

PERIOD = 10.0


def freed(*names: str) -> Model:
    """Roll with these coefficients free and the others at zero."""
    parameters = roll().parameters
    held = [n for n in parameters.free_names if n not in names]
    return roll().with_parameters(parameters.fixed(*held))


def test_a_recorded_wave_slope_gives_all_coefficients_back() -> None:
    """Within 3.5 standard errors; quadratic damping and softening restoring."""
    true = {**SHIP, "b_2": 0.3, "c_3": -0.2}
    record = simulate_roll_record(bretschneider(2.0, 9.0), 3, true, duration=400.0, dt=0.1)
    names = ("b_1", "b_2", "c_1", "c_3", "phi_0")
    found = estimate_model(freed(*names), Runs.one_session_each([record], 100.0), options=EstimatorOptions(workers=1))
    off = (found.estimate.common_parameters[:5] - [true[n] for n in names]) / found.interval.standard_error[:5]
    assert np.abs(off).max() < 3.5
    assert np.all(found.interval.standard_error[[0, 2]] < 0.02 * found.estimate.common_parameters[[0, 2]])
    assert not is_unforced_roll(found.model, [record])


def test_the_share_of_the_slope_that_it_feels_can_be_stated_too() -> None:
    """The probe shows a slope a quarter too steep."""
    record = simulate_roll_record(bretschneider(2.0, 9.0), 4, duration=400.0, dt=0.1)
    steep = record.channel("alpha_w").with_values(1.25 * record["alpha_w"])
    model = freed("b_1", "c_1", "phi_0")
    model = model.with_parameters(model.parameters.freed("r_w"))
    found = estimate_model(
        model,
        Runs.one_session_each([record.with_channel("alpha_w", steep)], 100.0),
        options=EstimatorOptions(workers=1),
    )
    assert found.model.parameters["r_w"].value == pytest.approx(0.8, rel=2e-3)


@pytest.mark.long(every=4)
@pytest.mark.parametrize(
    ("spectrum", "seed"),
    [(bretschneider(2.0, 9.0), 1), (bretschneider(2.0, 12.0), 2), (jonswap(2.0, 9.0), 1), (jonswap(2.0, 12.0), 2)],
)
def test_unmeasured_waves_leave_natural_period_and_damping_in_their_intervals(spectrum: Spectrum, seed: int) -> None:
    """From the roll angle alone, half an hour; damping to a third, the period to some per cent."""
    problem = spectral_problem(simulate_roll_record(spectrum, seed))
    optima = spectral_optima(problem)
    damping, restoring = (profiled_logarithm([(problem, optima)], place) for place in (DAMPING, RESTORING))
    assert damping.low < math.log(SHIP["b_1"]) < damping.high and damping.standard_error < 0.35
    assert restoring.low < math.log(SHIP["c_1"]) < restoring.high and restoring.standard_error < 0.06


def test_several_runs_share_the_ship_and_narrow_its_interval() -> None:
    runs = []
    for seed in (1, 2):
        problem = spectral_problem(simulate_roll_record(bretschneider(2.0, 12.0), seed, dt=0.5))
        runs.append((problem, spectral_optima(problem)))
    both, *single = (profiled_logarithm(some, RESTORING) for some in (runs, runs[:1], runs[1:]))
    assert both.standard_error < min(one.standard_error for one in single)
    assert both.low < math.log(SHIP["c_1"]) < both.high


def test_a_sea_that_peaks_at_the_natural_period_is_refused(tmp_path: Path) -> None:
    """A sharp sea with a broad resonance explains such roll as well as a broad sea with a sharp one."""
    with pytest.raises(InputError, match="cannot distinguish ship and waves"):
        trial_of(tmp_path, simulate_roll_record(jonswap(2.0, PERIOD), 3, dt=0.5))


def trial_of(tmp_path: Path, record: Record, more: str = "") -> Fit:
    """Identified through a trial file that names the roll angle only."""
    np.savetxt(tmp_path / "sea.csv", np.column_stack([record.time, record["phi"]]), delimiter=",", header="t,phi",
               comments="")  # fmt: skip
    text = f"""
[data]
folder = "{tmp_path}"
[ship]
name = "patrol boat"
L = 100.0
B = 10.5
[[records]]
files = "*.csv"
time = {{ column = "t", unit = "s" }}
channels.phi = {{ column = "phi", unit = "rad" }}
[model]
name = "roll"
{more}"""
    (tmp_path / "trial.toml").write_text(text)
    return identify(load_trial(tmp_path / "trial.toml"))


def test_a_trial_of_roll_alone_becomes_a_fit_with_its_reason(tmp_path: Path) -> None:
    """Linear equivalent, and a spectrum in place of curves over amplitude."""
    fit = trial_of(tmp_path, simulate_roll_record(bretschneider(2.0, 12.0), 1, dt=0.5))
    assert [c.name for c in fit.coefficients if not c.fixed] == ["b_1", "c_1"]
    assert "Whittle" in fit.method.criterion
    assert "equivalent-linear" in [f.code for f in fit.findings]
    assert fit.roll is not None
    assert fit.roll.natural_period.lower < PERIOD < fit.roll.natural_period.upper
    assert fit.roll.amplitude == ()
    assert len(fit.roll.spectrum) > 100


def test_waves_without_energy_at_the_natural_frequency_are_refused(tmp_path: Path) -> None:
    """They tell their own period, not the ship's."""
    with pytest.raises(InputError, match="waves have next to no energy at the natural frequency"):
        trial_of(tmp_path, simulate_roll_record(bretschneider(2.0, 6.5), 2, duration=600.0, dt=0.5))


def test_a_record_of_a_few_samples_has_no_spectrum() -> None:
    with pytest.raises(InputError, match="too few for a spectrum"):
        spectral_problem(simulate_roll_record(bretschneider(2.0, 9.0), 1).rows(slice(9)))


def test_too_short_a_record_is_refused(tmp_path: Path) -> None:
    """With the number of swings it has."""
    with pytest.raises(InputError, match="swings in waves that nobody measured are too few"):
        trial_of(tmp_path, simulate_roll_record(bretschneider(2.0, 12.0), 1, duration=200.0, dt=0.5))


@pytest.mark.parametrize("growth", [0.0, 0.004])
def test_roll_that_never_decays_is_refused(tmp_path: Path, growth: float) -> None:
    """Nothing drives the ship and it swings on: no damping can be estimated, and none is printed."""
    time = np.arange(0.0, 120.0, 0.1)
    record = Record.from_arrays("sea", time, {"phi": 0.1 * np.exp(growth * time) * np.cos(0.7 * time)})
    with pytest.raises(InputError, match="record 'sea': the roll does not decay"):
        trial_of(tmp_path, record)
