"""Waves that nobody recorded, known by their spectrum alone, or contradicted by the motions as they are stated."""

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Fit, Method, RollCharacteristics
from seatrial.core.results.ship_motions import PointMotion, Seakeeping
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.versions import versions
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate.assemble import output_error_problem, training_runs
from seatrial.estimation.estimate.plausibility import weakest_direction
from seatrial.estimation.estimate.point_estimate import PointEstimate, fit_output_error
from seatrial.estimation.estimate.settings import WEAK_FORM_SHIP_LENGTHS
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.identify.characteristics import roll_characteristics
from seatrial.estimation.identify.fit_result import coefficient_table
from seatrial.estimation.identify.identification import WAVE_SLOPE, Identification
from seatrial.estimation.identify.nonlinear_intervals import CHI_SQUARED_LIMIT
from seatrial.estimation.information.covariance import Interval, from_information, inverse
from seatrial.estimation.information.frequency_response import frequency_range, frequency_range_finding
from seatrial.estimation.problem.segments import compared_outputs
from seatrial.estimation.problem.spectral_likelihood import (
    DAMPING,
    RESTORING,
    HeldUnknown,
    SpectralLikelihood,
    UnknownWaves,
    fine_grid,
    hann_transform,
)
from seatrial.numerics.kernels.integrate import evaluate_tangent
from seatrial.numerics.optimise import Optimum, levenberg_marquardt
from seatrial.physics.hydro.excitation import G, encounter_frequency
from seatrial.physics.sea.spectrum import (
    Spectrum,
    WaveEncounter,
    ittc,
    ittc_two_parameter,
    speed_factor,
    wave_frequency,
)
from seatrial.physics.sea.wave_forces import (
    MotionStatistics,
    force_density,
    motion_sickness,
    motion_statistics,
    response_spectrum,
    vertical_motion,
    with_wave_forces,
)
from seatrial.physics.simulate.linear import Complex, frequency_response, linear_system
from seatrial.physics.simulate.replay import inputs_of

# Craft in a sea that nobody recorded, or of which only the spectrum is known: coefficients by its likelihood.

# The identified ship in the waves of its trial: operators, spectra and statistics for the report.

# frequencies of the curves, ours
_POINTS = 160
# shares of the sea's energy below the first and the last frequency, ours
_ENERGY_BAND = (1e-3, 0.99)


def seakeeping(model: Model, records: Sequence[TrialRecord], length: float) -> Seakeeping | None:
    """Of the first run whose meeting with the waves is known; None where none is, and of a model that is not linear."""
    met = next(((r.record, r.waves) for r in records if r.waves is not None), None)
    if met is None or not model.is_affine:
        return None
    record, waves = met
    spectrum = waves.spectrum or recorded_sea(record, waves)
    omega = np.linspace(*spectrum.band(*_ENERGY_BAND), _POINTS)
    omega_e = encounter_frequency(omega, waves.U, waves.beta)
    heave, pitch = transfer_functions(
        model, omega_e, np.stack(waves.excitation.forces(omega, waves.U, waves.beta), axis=1)
    )
    moved, turned = (motion_statistics(spectrum, omega, omega_e, h) for h in (heave, pitch))
    slope = pitch * G / omega**2
    return Seakeeping(
        run=record.name, speed=waves.U, heading=math.degrees(waves.beta),
        sea=f"{spectrum.name}, {spectrum.significant_height:.2f} m"
        + ("" if waves.spectrum else f" and {spectrum.mean_period:.2f} s (as the elevation of {record.name})"),
        omega=_floats(omega), omega_e=_floats(omega_e),
        heave=_floats(np.abs(heave)), heave_phase=_floats(np.degrees(np.angle(heave))),
        pitch=_floats(np.abs(slope)), pitch_phase=_floats(np.degrees(np.angle(slope))),
        sea_density=_floats(spectrum.density(omega)), heave_density=_floats(response_spectrum(spectrum, omega, heave)),
        pitch_density=_floats(response_spectrum(spectrum, omega, np.degrees(1.0) * pitch)),
        heave_significant=moved.significant, pitch_significant=math.degrees(turned.significant),
        zero_crossing_periods=(moved.zero_crossing_period, turned.zero_crossing_period),
        points=tuple(_point_motion(name, share * length, spectrum, omega, omega_e, heave, pitch)
                     for name, share in (("bow", 0.5), ("origin", 0.0), ("stern", -0.5))),
    )  # fmt: skip


def transfer_functions(model: Model, omega_e: Array, forces: Complex) -> tuple[Complex, Complex]:
    """Heave [up, m/m] and pitch [bow down, rad/m] for forces per metre of wave (n, 2), F3 [up] and M5 [bow down].

    The model's own axes turn all four signs, which leaves their ratios as they are.
    """
    inputs = [model.input_names.index(n) for n in ("F3", "M5")]
    response = frequency_response(linear_system(model, ("z", "theta")), omega_e)[:, :, inputs]
    motion = np.einsum("kyu,ku->ky", response, forces)
    return motion[:, 0], motion[:, 1]


def recorded_sea(record: Record, waves: WaveEncounter) -> Spectrum:
    """Return the sea with the significant height and the mean period of the elevation that was recorded.

    The periodogram at the frequencies of encounter is moved to those of the waves, up to the share of its energy above
    which the noise of the probe counts. Where the ship runs with the waves, to which one of
    three waves an encounter belongs is not known: there the period is that of the ITTC sea of that height.
    """
    elevation = record["zeta"] - np.mean(record["zeta"])
    height = 4.0 * float(np.std(elevation))
    if speed_factor(waves.U, waves.beta) > 0.0:
        return ittc(height)
    omega_e = 2.0 * np.pi * np.fft.rfftfreq(len(elevation), record.dt)[1:]
    energy = np.abs(np.fft.rfft(elevation)[1:]) ** 2
    kept = np.cumsum(energy) <= _ENERGY_BAND[1] * np.sum(energy)
    omega = wave_frequency(omega_e, waves.U, waves.beta)
    mean = float(np.sum(energy[kept] * omega[kept]) / np.sum(energy[kept]))
    return ittc_two_parameter(height, 2.0 * math.pi / mean)


def _point_motion(
    name: str, x: float, spectrum: Spectrum, omega: Array, omega_e: Array, heave: Complex, pitch: Complex
) -> PointMotion:
    motion: MotionStatistics = motion_statistics(spectrum, omega, omega_e, vertical_motion(heave, pitch, x))
    return PointMotion(name, x, motion.significant, motion.acceleration, motion_sickness(motion))


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)


# Roll in a sea that nobody recorded: natural period and equivalent linear damping by its spectrum's likelihood.

FREE_COEFFICIENTS = ("b_1", "c_1")
# lowest and highest frequency over that of the largest roll, ours
_BAND_EDGES = (0.45, 3.0)
# share of the waves' largest density that must be left at the natural frequency, and relative standard errors
_MIN_WAVE_SHARE, _MAX_DAMPING_ERROR, _MAX_RESTORING_ERROR = 0.05, 0.4, 0.15
# excess of power in a band that is tolerated, beyond which the sea is wrong, number of bands, standard errors allowed
# beyond it, ours
_MAX_MISFIT, _BANDS, _SIGMAS = 0.5, 5, 4.0
# frequencies over which the spectrum is averaged for its peak; fewest swings of a record, ours
_SMOOTHING_BINS, _MIN_CYCLES = 9, 40
_NEGLIGIBLE, _EVALUATIONS = 1e-6, 100  # promised gain of log-likelihood that ends a search, and its length; chosen
# a spectrum has no local unknowns
_NO_INITIAL_STATES = np.zeros((0, 0))


@dataclass(frozen=True, eq=False)
class _SpectralFit:
    """The fit of one run by its spectrum, and where its searches ended."""

    record: Record
    problem: UnknownWaves
    optima: tuple[Optimum, ...]

    @property
    def optimum(self) -> Optimum:
        """The best of the ends."""
        return min(self.optima, key=lambda optimum: optimum.solution.value)


def identify_in_unknown_waves(task: Identification) -> Fit:
    """Return the fit of runs by the likelihood of their roll's spectra, each in a sea of its own.

    A run that shows no ship of its own is left out, with its reason.

    Raises:
        InputError: of every run gaps, too short a record, or waves that cannot be distinguished from the ship.
    """
    trial, fits, left_out = task.trial, list[_SpectralFit](), list[InputError]()
    for record in task.runs.records:
        try:
            fits.append(_fitted_spectrum(record))
        except InputError as error:
            left_out.append(error)
    if not fits:
        raise left_out[0]
    records = [fit.record for fit in fits]
    profiled = [profiled_logarithm([(fit.problem, fit.optima) for fit in fits], k) for k in (DAMPING, RESTORING)]
    _refuse_vague(profiled)
    b_1, c_1 = (math.exp(p.best) for p in profiled)
    errors = np.array([b_1, c_1]) * [p.standard_error for p in profiled]
    interval = Interval(
        np.diag(errors**2), np.inf, "profile of the spectral likelihood, the sea's fitted at each value"
    )
    ends = {n: (math.exp(p.low), math.exp(p.high)) for n, p in zip(FREE_COEFFICIENTS, profiled, strict=True)}
    model = _linear_model(trial.model, b_1, c_1, float(np.mean([np.mean(record["phi"]) for record in records])))
    characteristics = roll_characteristics(model, interval, FREE_COEFFICIENTS, records, trial.ship)
    first = fits[0]
    return Fit(
        question=trial.question or "What are natural period and damping of this ship's roll in waves?",
        ship=trial.ship,
        model=model,
        coefficients=coefficient_table(
            model.parameters, FREE_COEFFICIENTS, np.array([b_1, c_1]), interval, trial.truth, ends
        ),
        covariance=interval.covariance,
        solution=first.optimum.solution,
        method=Method(
            "likelihood of the roll's spectrum (Whittle), the sea's own spectrum estimated with it",
            "the largest roll, waves longer and shorter than it",
            interval.meaning,
            (
                "no input was recorded and no initial state explains the motion: waves that nobody measured",
                *(f"a run is left out: {error}" for error in left_out),
            ),
            {"frequencies": sum(len(fit.problem.omega) for fit in fits)},
        ),
        offsets=(),
        channel_noise=(),
        residuals=(),
        predictions=(),
        findings=(*task.findings, _linear_equivalent_finding(records), *_unused_prior_findings(trial.model)),
        records=tuple(records),
        seed=task.options.seed,
        elapsed_s=time.perf_counter() - task.began,
        versions=versions(),
        roll=None
        if characteristics is None
        else _with_spectrum(characteristics, first.problem, first.optimum.solution.point),
    )


def _fitted_spectrum(record: Record) -> _SpectralFit:
    problem = spectral_problem(record)
    fit = _SpectralFit(record, problem, spectral_optima(problem))
    point = fit.optimum.solution.point
    if not all(problem.lower[k] < point[k] < problem.upper[k] for k in (DAMPING, RESTORING)):
        raise InputError(f"record '{record.name}': the roll's spectrum shows no resonance; {_ADVICE}")
    _refuse_unidentifiable(record.name, problem, fit.optimum)
    return fit


def spectral_problem(record: Record) -> UnknownWaves:
    """The band about the largest roll.

    Raises:
        InputError: gaps, or fewer than forty swings.
    """
    phi = record["phi"]
    if not np.all(np.isfinite(phi)):
        raise InputError(f"record '{record.name}': channel 'phi' has gaps, which a spectrum cannot have; repair it")
    omega, motion = hann_transform(phi[:, None], record.dt)
    power = np.abs(motion[:, 0]) ** 2
    centre = float(omega[np.argmax(_smoothed(power))]) if len(omega) >= _SMOOTHING_BINS else 0.0
    if record.duration * centre < 2.0 * np.pi * _MIN_CYCLES:
        raise InputError(
            f"record '{record.name}': {record.duration * centre / (2.0 * np.pi):.0f} swings in waves that nobody "
            f"measured are too few for a spectrum; record {_MIN_CYCLES} at least, or the wave slope {WAVE_SLOPE}"
        )
    low, high = (edge * centre for edge in _BAND_EDGES)
    return UnknownWaves(omega, power, centre).band_limited(low, high)


def spectral_optima(problem: UnknownWaves) -> tuple[Optimum, ...]:
    """Return where searches from several points end: a broad sea with a sharp resonance, a sharp one with a broad."""
    return tuple(
        levenberg_marquardt(problem, begin, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE, evaluations=_EVALUATIONS)
        for begin in problem.start_points()
    )


# standard errors by the information between refits, and to which they go beyond the outermost end of a search; chosen:
# unknowns of the sea at a bound make those too small, three times where a sharp sea passes for a broad resonance
_PROFILE_STEP, _PROFILE_REACH = 0.5, 6.0


@dataclass(frozen=True)
class ProfiledLogarithm:
    """A logarithm by its profile likelihood: where it is least, and the outermost ends of its 95 % region."""

    best: float
    low: float
    high: float

    @property
    def standard_error(self) -> float:
        """Of the logarithm, by the width of the region."""
        return (self.high - self.low) / (2.0 * math.sqrt(CHI_SQUARED_LIMIT))


def profiled_logarithm(runs: Sequence[tuple[UnknownWaves, Sequence[Optimum]]], place: int) -> ProfiledLogarithm:
    """Return a coefficient of the ship, the same in all runs, with the sea of each run fitted again at each value.

    Refits go on from their neighbour, outward from each end of a search: a broad and a sharp sea.
    """
    ends = [optimum.solution.point[place] for _, optima in runs for optimum in optima]
    errors = np.array([_deviation(problem, optima, place) for problem, optima in runs])
    step, reach = _PROFILE_STEP / np.sqrt(np.sum(errors**-2.0)), _PROFILE_REACH * np.max(errors)
    grid = np.arange(min(ends) - reach, max(ends) + reach + step, step)
    twice = np.sum([2.0 * _profile(problem, optima, place, grid) for problem, optima in runs], axis=0)
    least = int(np.clip(np.argmin(twice), 1, len(grid) - 2))
    left, mid, right = twice[least - 1 : least + 2]
    shift = 0.5 * (left - right) / (left - 2.0 * mid + right) if left - 2.0 * mid + right > 0.0 else 0.0
    lowest = mid - 0.25 * (left - right) * shift
    excess = twice - lowest - CHI_SQUARED_LIMIT
    inside = np.flatnonzero(excess < 0.0)
    low, high = _root(grid, excess, inside[0], -1), _root(grid, excess, inside[-1], 1)
    return ProfiledLogarithm(float(grid[least] + shift * step), low, high)


def _deviation(problem: UnknownWaves, optima: Sequence[Optimum], place: int) -> float:
    """Standard error of an unknown by the information at the best end, with those on a bound known."""
    best = min(optima, key=lambda optimum: optimum.solution.value)
    point = best.solution.point
    inside = np.flatnonzero((point > problem.lower) & (point < problem.upper))
    covariance = inverse(best.normal.hessian[np.ix_(inside, inside)])
    return float(np.sqrt(np.diag(covariance))[inside == place][0])


def _root(grid: Array, excess: Array, last: int, way: int) -> float:
    """Where the excess rises through 0 behind the last point below, straight between points; the end of the grid."""
    if not 0 <= last + way < len(grid) or not np.isfinite(excess[last + way]):
        return float(grid[last])
    share = excess[last] / (excess[last] - excess[last + way])
    return float(grid[last] + share * (grid[last + way] - grid[last]))


def _profile(problem: UnknownWaves, optima: Sequence[Optimum], place: int, grid: Array) -> Array:
    """The cost with one unknown held at each value of the grid, all others fitted, (k,)."""
    costs = np.full(len(grid), np.inf)
    for optimum in optima:
        start = int(np.clip(np.searchsorted(grid, optimum.solution.point[place]), 0, len(grid) - 1))
        for way in (range(start, len(grid)), range(start - 1, -1, -1)):
            point = np.delete(optimum.solution.point, place)
            for k in way:
                again = levenberg_marquardt(
                    HeldUnknown(problem, place, float(grid[k])), point, _NO_INITIAL_STATES, negligible=_NEGLIGIBLE,
                    evaluations=_EVALUATIONS,
                )  # fmt: skip
                point, cost = again.solution.point, again.solution.value
                if not cost < costs[k] - _NEGLIGIBLE:
                    break
                costs[k] = cost
    return costs


def _linear_model(model: Model, b_1: float, c_1: float, rest: float) -> Model:
    values = dict.fromkeys(("b_2", "b_3", "c_3", "c_5"), 0.0) | {"b_1": b_1, "c_1": c_1, "phi_0": rest}
    made = model.with_values(values)
    parameters = made.parameters.fixed(*(n for n in made.parameters.free_names if n not in FREE_COEFFICIENTS))
    return made.with_parameters(parameters.freed(*FREE_COEFFICIENTS))


_ADVICE = "record the wave slope alpha_w, or a decay in calm water"


def _refuse_unidentifiable(run: str, problem: UnknownWaves, optimum: Optimum) -> None:
    """Raises:
    InputError: waves without energy at the natural frequency, or a spectrum that is not met.
    """
    point, power = optimum.solution.point, problem.power
    moment, natural = problem.moment_density(point, problem.omega), np.exp(0.5 * point[[RESTORING]])
    share = float(problem.moment_density(point, natural)[0] / np.max(moment))
    if share < _MIN_WAVE_SHARE:
        raise InputError(
            f"record '{run}': the waves have next to no energy at the natural frequency ({100 * share:.1f} % of their "
            f"peak), so that the roll shows their period and not the ship's; {_ADVICE}"
        )
    ratio = power / problem.windowed_density(point)
    for piece in np.array_split(np.arange(len(ratio)), _BANDS):
        mean = float(np.mean(ratio[piece]))
        # variance of a periodogram under a Hann window
        if abs(mean - 1.0) > max(_MAX_MISFIT, _SIGMAS * np.sqrt(35.0 / 18.0 / len(piece))):
            low, high = problem.omega[piece[[0, -1]]]
            raise InputError(
                f"record '{run}': no sea of one peak explains the roll between {low:.2g} and {high:.2g} rad/s, which "
                f"has {mean:.2g} times the power expected there; {_ADVICE}"
            )


def _refuse_vague(profiled: Sequence[ProfiledLogarithm]) -> None:
    """Raises:
    InputError: standard errors of the logarithms of b_1 and c_1 that are too large to be of use.
    """
    damping, restoring = (p.standard_error for p in profiled)
    if damping > _MAX_DAMPING_ERROR or restoring > _MAX_RESTORING_ERROR:
        raise InputError(
            f"the roll's spectrum cannot distinguish ship and waves (standard errors of b_1 {100 * damping:.0f} %, "
            f"c_1 {100 * restoring:.0f} %); record longer, or {_ADVICE}"
        )


def _linear_equivalent_finding(records: Sequence[Record]) -> Finding:
    rms = float(np.degrees(np.std(np.concatenate([record["phi"] - np.mean(record["phi"]) for record in records]))))
    what = f"b_1 and c_1 are the linear equivalent of roll in this sea, {rms:.2g} deg rms"
    evidence = "other coefficients held at zero; the sea is taken to have one peak (JONSWAP) and to fall off with depth"
    return Finding(Severity.INFO, "equivalent-linear", what, evidence)


def _unused_prior_findings(model: Model) -> list[Finding]:
    names = [p.name for p in model.parameters.free if p.prior is not None]
    what = f"the priors of {', '.join(names)} were not used"
    return [Finding(Severity.WARNING, "prior-not-used", what, "the likelihood of a spectrum has none")] if names else []


def _smoothed(power: Array) -> Array:
    window = np.hanning(_SMOOTHING_BINS + 2)[1:-1]
    return np.asarray(np.convolve(power, window / window.sum(), "same"), dtype=np.float64)


def _with_spectrum(roll: RollCharacteristics, problem: UnknownWaves, point: Array) -> RollCharacteristics:
    """Recorded and expected densities over frequency in place of curves over amplitude, which a line has none of."""
    rows = zip(problem.omega, _smoothed(problem.power), problem.windowed_density(point), strict=True)
    return replace(
        roll, amplitude=(), damping=(), damping_lower=(), damping_upper=(), period=(), period_lower=(),
        period_upper=(), swings=(), spectrum=tuple((float(w), float(s), float(e)) for w, s, e in rows),
    )  # fmt: skip


# Motions in a sea of which only the spectrum is known: coefficients by its likelihood, or a reason why not.

# sensors are first thought this many times worse, so that the search sees the shape before the detail
_NOISE_FACTORS = (100.0, 30.0, 10.0, 3.0)
_MAX_RELATIVE_ERROR = 0.25  # standard error beyond which a coefficient is not printed, over its value; chosen
# coherence of force and moment over the whole band beyond which they count as one
_MAX_COHERENCE = 0.99


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
    problem = wave_spectrum_problem(trial.model, record, waves, dict(trial.noise))
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


def wave_spectrum_problem(
    model: Model, record: Record, waves: WaveEncounter, noise: dict[str, float]
) -> SpectralLikelihood:
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


# Waves that the motions contradict as stated: a probe upside down or elsewhere, another speed of encounter.

_SHARES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8)  # of the ship's length, of the probe to either side; chosen
_SPEEDS = (0.8, 0.9, 1.1, 1.2)  # over the stated one; chosen
# of the residuals, and of the motion's standard deviation, of what the reading that is named leaves at most: beside
# forces of a box for a hull's a wrong one leaves 0.67 of the residuals, and does not follow closely; chosen
_MOST_LEFT, _CLOSE = 0.6, 0.1
_SHORT_EVALUATIONS, _ROUNDS = 12, 2  # of each short fit; chosen


@dataclass(frozen=True)
class WaveReading:
    """How the waves may have been met other than stated.

    Attributes:
        sign: of the elevation; forward: m, of the probe ahead of its stated place; speed: over that stated.
    """

    sign: float = 1.0
    forward: float = 0.0
    speed: float = 1.0

    @property
    def text(self) -> str:
        """Return what it says, in words."""
        if self.sign < 0.0:
            return "the elevation zeta is positive down"
        if self.forward:
            way = "forward" if self.forward > 0.0 else "aft"
            return f"the probe stands {significant(abs(self.forward), 2)} m {way} of where the trial says"
        return f"the craft meets the waves at {significant(self.speed, 2)} of the speed that the trial says"

    def reread(self, item: TrialRecord) -> TrialRecord:
        """Return a run with the forces of waves that are met so; one without an elevation stays as it is."""
        if item.waves is None or "zeta" not in item.record:
            return item
        zeta = item.record.channel("zeta")
        moved = replace(zeta.with_values(self.sign * zeta.values), reference_point=zeta.reference_point + self.forward)
        channels = {n: c for n, c in item.record.channels.items() if n not in ("F3", "M5")} | {"zeta": moved}
        waves = replace(item.waves, U=self.speed * item.waves.U)
        bare = replace(item.record, channels=channels)
        return replace(item, record=with_wave_forces(bare, waves.excitation, waves.U, waves.beta), waves=waves)


def contradicted_waves(task: Identification) -> Finding | None:
    """Return a warning `sensor-error` with the reading of the waves that explains the motions far better; None: none.

    Each is tried by a short fit of output error; one with a craft that does not come to rest is none. None is tried
    where the residuals of the stated waves are mostly noise, of which no reading leaves less.
    """
    if not any(r.waves is not None and "zeta" in r.record for r in task.train):
        return None
    stated = _short_fit(task, WaveReading())
    if stated is None or _noise(stated) > _MOST_LEFT * _unexplained(stated):
        return None
    places = [WaveReading(forward=side * share * task.runs.length) for share in _SHARES for side in (-1.0, 1.0)]
    readings = [WaveReading(sign=-1.0), *places, *(WaveReading(speed=share) for share in _SPEEDS)]
    fits = {reading: _short_fit(task, reading) for reading in readings}
    left = {reading: _unexplained(fit) for reading, fit in fits.items() if fit is not None and _comes_to_rest(fit)}
    if not left:
        return None
    best, before = min(left, key=lambda reading: left[reading]), _unexplained(stated)
    return _finding(best, left[best], before) if left[best] <= min(_MOST_LEFT * before, _CLOSE) else None


def _short_fit(task: Identification, reading: WaveReading) -> PointEstimate | None:
    """The fit of a few evaluations; None: no such craft can meet such waves."""
    try:
        runs = training_runs(task.trial, [reading.reread(r) for r in task.train])
        problem = output_error_problem(task.trial.model, runs, np.inf, task.settings)
    except InputError:
        return None
    with np.errstate(all="ignore"):  # a search may pass craft that run away
        start = find_start(problem, runs.records, WEAK_FORM_SHIP_LENGTHS * task.resolved_time)
        return fit_output_error(
            start.problem, start.common_parameters, start.initial_states, runs.noise,
            rounds=_ROUNDS, evaluations=_SHORT_EVALUATIONS, further_searches=0,
        )  # fmt: skip


def _unexplained(fit: PointEstimate) -> float:
    """Root mean square of the residuals over the motion's spread."""
    return float(np.sqrt(np.nanmean((fit.residuals() / np.nanstd(fit.problem.data.measured, axis=0)) ** 2)))


def _noise(fit: PointEstimate) -> float:
    """Root mean square of the noise over the motion's spread, by differences of neighbouring residuals.

    Half their mean square is the variance of noise beside a slow course (von Neumann et al. 1941, Annals of
    Mathematical Statistics 12, 153).
    """
    residuals, data = fit.residuals(), fit.problem.data
    steps = np.concatenate([np.diff(residuals[a:b], axis=0) for a, b in pairwise(data.offsets)])
    return float(np.sqrt(0.5 * np.nanmean((steps / np.nanstd(data.measured, axis=0)) ** 2)))


def _comes_to_rest(fit: PointEstimate) -> bool:
    """Whether the free motion of a linear model dies out."""
    model = fit.model
    nx, width = len(model.states), len(model.states) + len(model.inputs) + len(model.parameters)
    out, jacobian = np.empty((1, nx)), np.zeros((1, nx, width))
    at_rest = np.zeros((1, nx)), np.zeros((1, len(model.inputs))), model.parameters.values[None]
    evaluate_tangent(model.compiled.rates_tangent, *at_rest, 1.0, out, jacobian)
    return bool(np.max(np.linalg.eigvals(jacobian[0, :, :nx]).real) < 0.0)


def _finding(reading: WaveReading, least: float, stated: float) -> Finding:
    return Finding(
        Severity.WARNING, "sensor-error", f"the motions contradict the waves as they are stated: {reading.text}",
        f"tried here: read so, they leave {significant(least, 2)} of the motions unexplained, as stated "
        f"{significant(stated, 2)} (standard deviations)",
        "check the sign and the place of the wave probe, and the speed under [records.waves]",
    )  # fmt: skip
