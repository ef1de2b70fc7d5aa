"""Motions in a sea of which only the spectrum is known: coefficients by its likelihood, or a reason why not."""

import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Fit, Method
from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.versions import versions
from seatrial.estimation.estimate.singular import weakest_direction
from seatrial.estimation.identify.fit_result import coefficient_table
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.seakeeping import seakeeping
from seatrial.estimation.information.covariance import from_information
from seatrial.estimation.information.frequency_range import frequency_range, frequency_range_finding
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.spectral_likelihood import SpectralLikelihood, fine_grid, hann_transform
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.sea.spectrum import WaveEncounter
from seatrial.physics.sea.wave_forces import force_density
from seatrial.physics.simulate.linear import Complex
from seatrial.physics.simulate.replay import inputs_of

# sensors are first thought this many times worse, so that the search sees the shape before the detail
_NOISE_FACTORS = (100.0, 30.0, 10.0, 3.0)
# relative standard error beyond which a coefficient is not printed, and misfit of a band beyond which the sea is wrong
_MAX_RELATIVE_ERROR, _MAX_MISFIT, _BANDS, _SIGMAS = 0.25, 0.5, 5, 4.0
# coherence of force and moment over the whole band beyond which they count as one
_MAX_COHERENCE = 0.99
# a spectrum has no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))


def identify_by_wave_spectrum(task: Identification) -> Fit:
    """Return the fit of one run by the likelihood of its spectrum; sensor noise must be stated under [noise].

    Raises:
        InputError: more than one training run, no stated noise, waves that do not explain the motions, or coefficients
            that the spectrum does not determine.
    """
    trial = task.trial
    if len(task.train) != 1:
        raise InputError(
            f"a sea known by its spectrum is fitted one run at a time; the trial trains on {len(task.train)}"
        )
    (run,) = task.train
    record, waves = run.record, run.waves
    assert waves is not None
    problem = spectral_problem(trial.model, record, waves, dict(trial.noise))
    _refuse_coherent_forces(problem, record)
    optimum = _maximum_likelihood(problem)
    point, information = optimum.solution.point, optimum.normal.hessian
    _refuse_misfit(problem, point)
    _refuse_uncertain(problem, point, information)
    interval = replace(from_information(information), meaning="Fisher information of the spectral likelihood")
    model = trial.model.with_values(dict(zip(problem.free, map(float, point), strict=True)))
    reason = "neither elevation nor wave force was recorded: the spectrum of the sea stands for them, without phases"
    return Fit(
        question=trial.question or f"Which {model.name} model explains the spectra of these motions?",
        ship=trial.ship,
        model=model,
        coefficients=coefficient_table(model.parameters, problem.free, point, interval, trial.truth),
        covariance=interval.covariance,
        solution=optimum.solution,
        method=Method(
            "likelihood of the motions' spectra (Whittle)",
            "the model's own values, sensors first taken as worse than they are",
            interval.meaning,
            (reason,),
            {"frequencies": len(problem.omega)},
        ),
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=(),
        findings=(*task.findings, frequency_range_finding(frequency_range([record], problem.outputs))),
        records=(record,),
        seed=task.options.seed,
        elapsed_s=time.perf_counter() - task.began,
        versions=versions(),
        seakeeping=seakeeping(model, task.train, trial.ship.length),
    )


def spectral_problem(model: Model, record: Record, waves: WaveEncounter, noise: dict[str, float]) -> SpectralLikelihood:
    """The problem of one record.

    Raises:
        InputError: a channel's noise is not stated, a channel has gaps, or no motion was recorded.
    """
    outputs = compared_outputs(model, [record])
    for name in outputs:
        if name not in noise:
            raise InputError(f"a sea known by its spectrum needs the sensor noise of '{name}'; state it under [noise]")
        if not np.all(np.isfinite(record[name])):
            raise InputError(f"record '{record.name}': channel '{name}' has gaps, which a spectrum cannot have")
    assert waves.spectrum is not None
    omega, motions = hann_transform(np.stack([record[o] for o in outputs], axis=1), record.dt)
    _, inputs = hann_transform(inputs_of(model, record), record.dt)
    low, high = _usable_bins(motions, noise, outputs, record.dt)
    kept = slice(low, high)
    fine = fine_grid(omega[kept])
    half = 0.5 * (fine[1] - fine[0])
    edges = np.concatenate([fine - half, [fine[-1] + half]])
    density = np.zeros((len(fine), len(model.inputs), len(model.inputs)), dtype=np.complex128)
    place = [model.input_names.index(n) for n in ("F3", "M5")]
    felt = force_density(waves.spectrum, waves.excitation, waves.U, waves.beta, np.maximum(edges, 0.0))
    density[:, place[0] : place[1] + 1, place[0] : place[1] + 1] = felt
    levels = np.array([noise[o] for o in outputs])
    return SpectralLikelihood(
        model, omega[kept], outputs, motions[kept], inputs[kept], fine, density, levels, record.dt
    )


def _usable_bins(motions: Complex, noise: dict[str, float], outputs: Sequence[str], dt: float) -> tuple[int, int]:
    """Bins from the third on up to where no motion rises above its sensor's noise."""
    level = np.array([noise[o] ** 2 for o in outputs]) * dt / np.pi
    above = np.flatnonzero(np.any(np.abs(motions) ** 2 > 20.0 * level, axis=1))  # power over that of the noise; chosen
    last = int(above[-1]) + 1 if len(above) else len(motions)
    return 8, max(last, 32)  # bins, first and fewest; chosen


def _maximum_likelihood(problem: SpectralLikelihood) -> Optimum:
    point = problem.start()
    for factor in _NOISE_FACTORS:
        coarse = replace(problem, noise=problem.noise * factor)
        # of half the sum of squares; chosen
        point = levenberg_marquardt(coarse, point, _NO_INITIAL_STATES, negligible=1e-3).solution.point
    # of half the sum of squares; chosen
    return levenberg_marquardt(problem, point, _NO_INITIAL_STATES, negligible=1e-6)


def _refuse_coherent_forces(problem: SpectralLikelihood, record: Record) -> None:
    """Raises:
    InputError: heave force and pitch moment of the waves move as one all over the band, as abeam.
    """
    first, second = (problem.model.input_names.index(n) for n in ("F3", "M5"))
    across = np.abs(np.sum(problem.input_densities[:, first, second])) ** 2
    separate = np.sum(problem.input_densities[:, first, first].real) * np.sum(
        problem.input_densities[:, second, second].real
    )
    if across > _MAX_COHERENCE * separate:
        raise InputError(
            f"record '{record.name}': in this sea the waves' force and moment keep one ratio at all frequencies "
            f"(coherence {across / separate:.3f}), which its spectrum cannot take apart; "
            "record the elevation or the wave forces, or another heading"
        )


def _refuse_misfit(problem: SpectralLikelihood, point: Array) -> None:
    """Raises:
    InputError: a band in which the motions are not those that sea and model would give.
    """
    share = problem.misfit(point)
    for piece in np.array_split(np.arange(len(share)), _BANDS):
        mean = float(np.mean(share[piece]))
        if abs(mean - 1.0) > max(_MAX_MISFIT, _SIGMAS / np.sqrt(len(piece))):
            low, high = problem.omega[piece[[0, -1]]]
            raise InputError(
                f"sea and model do not explain the motions met between {low:.2g} and {high:.2g} rad/s: they have "
                f"{mean:.2g} times the power expected there; check height, period and heading, or record the elevation"
            )


def _refuse_uncertain(problem: SpectralLikelihood, point: Array, information: Array) -> None:
    """Raises:
    InputError: a coefficient whose standard error is more than a quarter of it.
    """
    error = from_information(information).standard_error / np.abs(point)
    worst = int(np.argmax(error))
    if error[worst] > _MAX_RELATIVE_ERROR:
        raise InputError(
            f"the sea's spectrum does not determine {problem.free[worst]} "
            f"(standard error {100 * error[worst]:.0f} %) nor "
            f"the direction {weakest_direction(information, problem.free, point)[1]}; record the elevation or "
            "the wave forces"
        )
