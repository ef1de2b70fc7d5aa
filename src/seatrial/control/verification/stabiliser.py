"""A stabiliser verified: legs on and off, the sea of each, what was predicted in it and what was achieved."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seatrial.control.task import Seaway, TuningTask
from seatrial.core.results.verification import (
    ReductionEstimate,
    VerifiedLeg,
    VerifiedQuantity,
    is_consistent,
    normal_interval,
)
from seatrial.core.values import Array, InputError, Record
from seatrial.core.values.notation import channel_unit
from seatrial.estimation.sea import (
    EncounteredSea,
    LegFit,
    LegPriors,
    ObservedLeg,
    StretchSpectra,
    WaveLeg,
    altered_loop,
    encountered_sea,
    fit_legs,
    stretch_spectra,
)
from seatrial.physics.hydro.excitation import Complex
from seatrial.physics.loops import TransferLoop, reversals_per_hour

# Stretches of a log with the controller on and off, by whether the actuator moves.

_WINDOW_PERIODS = 3.0  # natural periods over which an actuator that is on surely moves; chosen
_STILL_SHARE = 0.03  # of the liveliest window's rms, below which the actuator counts as still; chosen
_STILL_ANGLE = 1e-4  # rad, rms below which an actuator never moved: a resolver's last digit; chosen
_RUN_IN_PERIODS = 2.0  # natural periods after a change of control that belong to neither state; chosen
_SHORTEST_PERIODS = 36.0  # natural periods that a leg must hold: five segments of its spectrum; chosen
_WAVES = "zeta"
_RATE = 24.0  # samples a natural period that the spectra need; chosen


@dataclass(frozen=True, eq=False)
class LoggedLeg:
    """A stretch of one record, every dt [s] from `start` [s]; U: m/s, mean speed.

    values: (n, 2) or (n, 3): output, actuator, and the elevation of the waves where all records hold it; SI.
    """

    record: str
    start: float
    dt: float
    values: Array
    is_controlled: bool
    U: float

    @property
    def stop(self) -> float:
        """Return the time of the last sample [s]."""
        return self.start + self.dt * (len(self.values) - 1)


def natural_period(loop: TransferLoop) -> float:
    """Return the period [s] of the plant's least damped swing.

    Raises:
        InputError: it does not swing.
    """
    poles = loop.plant.poles[loop.plant.poles.imag > 0.0]
    if not poles.size:
        raise InputError(f"the plant of loop '{loop.name}' does not swing; legs in waves need a motion that does")
    return float(2.0 * np.pi / np.abs(poles[np.argmin(-poles.real / np.abs(poles))]))


def legs_on_and_off(records: Sequence[Record], loop: TransferLoop, U: float) -> tuple[LoggedLeg, ...]:
    """Return the legs of all records that are long enough for a spectrum, in order.

    U: m/s, where a record has no channel 'u'.

    Raises:
        InputError: a channel is missing, no leg is long enough, or none has the controller on.
    """
    period = natural_period(loop)
    for record in records:
        if missing := [name for name in (loop.output, loop.actuator) if name not in record]:
            raise InputError(
                f"record '{record.name}' has no channel '{missing[0]}'; a loop from '{loop.actuator}' on "
                f"'{loop.output}' is verified by both: name their columns in [records.channels]"
            )
    waves = (_WAVES,) if all(_WAVES in record for record in records) else ()
    channels = (loop.output, loop.actuator, *waves)
    records = [record.resampled(_RATE / period) for record in records]
    activities = [_activity(record[loop.actuator], round(_WINDOW_PERIODS * period / record.dt)) for record in records]
    liveliest = max((float(np.nanmax(activity, initial=0.0)) for activity in activities), default=0.0)
    if liveliest < _STILL_ANGLE:
        raise InputError(f"'{loop.actuator}' never moves in the log: there is no leg with the controller on")
    legs = [
        leg
        for record, activity in zip(records, activities, strict=True)
        for leg in _legs_of_record(record, channels, activity >= _STILL_SHARE * liveliest, period, U)
    ]
    needed = _SHORTEST_PERIODS * period
    long_enough = tuple(leg for leg in legs if leg.stop - leg.start >= needed)
    if not any(leg.is_controlled for leg in long_enough):
        longest = max((leg.stop - leg.start for leg in legs if leg.is_controlled), default=0.0)
        raise InputError(
            f"the longest leg with the controller on takes {longest:.0f} s; {needed:.0f} s are needed, "
            f"{_SHORTEST_PERIODS:g} natural periods, for a spectrum; log longer legs"
        )
    return long_enough


def _activity(values: Array, window: int) -> Array:
    """Return the rms of the actuator about its mean in a window about each sample, (n,); NaN across gaps."""
    half = max(1, window // 2)
    padded = np.pad(values, half, mode="edge")
    sums, squares = (np.concatenate([[0.0], np.cumsum(np.nan_to_num(v))]) for v in (padded, padded**2))
    width = 2 * half
    mean, square = ((s[width:] - s[:-width])[: len(values)] / width for s in (sums, squares))
    return np.where(np.isfinite(values), np.sqrt(np.maximum(square - mean**2, 0.0)), np.nan)


def _legs_of_record(
    record: Record, channels: tuple[str, ...], is_moving: NDArray[np.bool_], period: float, U: float
) -> list[LoggedLeg]:
    """Return the stretches of one state without gaps, less the run-in and the window's half at inner ends."""
    values = record.matrix(channels)
    state = np.where(np.all(np.isfinite(values), axis=1), is_moving.astype(int), -1)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1, [len(state)]])
    lead, tail = (round(share * period / record.dt) for share in (_RUN_IN_PERIODS, 0.5 * _WINDOW_PERIODS))
    legs = []
    for first, last in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
        start, end = first + (lead if first else 0), last - (tail if last < len(state) else 0)
        if state[first] < 0 or end - start < 2:
            continue
        speed = float(np.nanmean(record["u"][start:end])) if "u" in record else U
        legs.append(LoggedLeg(
            record.name, float(record.time[start]), record.dt, values[start:end], bool(state[first]), speed,
        ))  # fmt: skip
    return legs


# Mean squares of a loop in waves: as linear theory has them in a sea, and as the spectra of legs show them.

_LEAST_WAVES = 0.01  # of the largest density of the elevation, below which there are no waves; chosen


@dataclass(frozen=True)
class LoopMoments:
    """Mean squares, SI: of the output without control and with it, of the actuator, its rate and its acceleration."""

    free: float
    output: float
    actuator: float
    rate: float
    acceleration: float

    @property
    def reduction(self) -> float:
        """Return the share of the output's rms that control takes off."""
        return 1.0 - math.sqrt(self.output / self.free)

    @property
    def reversals(self) -> float:
        """Return how often the actuator turns back in an hour."""
        return reversals_per_hour(math.sqrt(self.rate), math.sqrt(self.acceleration))


def mean_moments(moments: Sequence[LoopMoments]) -> LoopMoments:
    """Return the mean of legs of equal weight."""
    rows = [(moment.free, moment.output, moment.actuator, moment.rate, moment.acceleration) for moment in moments]
    return LoopMoments(*np.mean(rows, axis=0).tolist())


def predicted_moments(loop: TransferLoop, sea: EncounteredSea, unknowns: Array) -> LoopMoments:
    """Return the moments of a loop at its gains in a sea of these unknowns (3 + j,)."""
    omega = sea.omega_e
    free = np.abs(loop.disturbance.frequency_response(omega)) ** 2 * sea.disturbance_energy(unknowns)
    controller = loop.gain_values @ loop.controller_terms(omega)
    output = free / np.abs(1.0 + controller * loop.plant.frequency_response(omega)) ** 2
    actuator = np.abs(controller) ** 2 * output
    sums = (free, output, actuator, omega**2 * actuator, omega**4 * actuator)
    return LoopMoments(*(float(np.sum(part)) for part in sums))


def logged_moments(products: Complex, omega: Array, plant: Complex) -> LoopMoments:
    """Return the moments of a leg, its output without control as y - P a.

    products: (k, c, c), means over segments of transforms times conjugate transforms, output and actuator first;
    omega: (k,), rad/s; plant: P, (k,).
    """
    outputs, actuators = (np.real(products[:, place, place]) for place in (0, 1))
    free = outputs - 2.0 * np.real(plant * products[:, 1, 0]) + np.abs(plant) ** 2 * actuators
    step = float(omega[1] - omega[0])
    sums = (free, outputs, actuators, omega**2 * actuators, omega**4 * actuators)
    return LoopMoments(*(float(np.sum(part)) * step for part in sums))


def plain_reduction(on: Complex, off: Complex) -> float:
    """Return the reduction of the rms between mean products (k, c, c) with and without control."""
    controlled, free = (float(np.sum(np.real(part[:, 0, 0]))) for part in (on, off))
    return 1.0 - math.sqrt(controlled / free)


def reduction_by_waves(on: Complex, off: Complex) -> float:
    """Return the reduction with the motion without control carried to the waves met with it, frequency by frequency.

    on, off: mean products (k, 3, 3), the recorded elevation last. Frequencies at which there are no waves are left out.
    """
    waves_on, waves_off = (np.real(part[:, 2, 2]) for part in (on, off))
    strong = waves_off > _LEAST_WAVES * np.max(waves_off)
    carried = np.sum((np.real(off[:, 0, 0]) * waves_on)[strong] / waves_off[strong])
    return 1.0 - math.sqrt(float(np.sum(np.real(on[strong, 0, 0])) / carried))


# What chance makes of a value of spectra: segments of each leg left out in turn.

_TOGETHER = 2  # segments left out together, as neighbours overlap


def products(spectra: StretchSpectra) -> Complex:
    """Return transforms times conjugate transforms of each segment, (m, k, c, c)."""
    return np.einsum("mkc,mkd->mkcd", spectra.transforms, spectra.transforms.conj())


def jackknife_deviation(legs: Sequence[Complex], value: Callable[[Sequence[Complex]], float]) -> float:
    """Return the standard deviation of a value of the legs' mean products, (k, c, c) each.

    legs: products of each leg's segments, (m, k, c, c). Pairs of segments are left out in turn (delete-group jackknife:
    Kott 2001, Journal of Official Statistics 17, 521-526); legs are independent.
    """
    means = [leg.mean(axis=0) for leg in legs]
    total = 0.0
    for k, leg in enumerate(legs):
        groups = np.array_split(np.arange(len(leg)), max(2, len(leg) // _TOGETHER))
        values = [value([*means[:k], np.delete(leg, g, axis=0).mean(axis=0), *means[k + 1 :]]) for g in groups]
        count = len(groups)
        total += (count - 1) / count * float(np.sum((np.array(values) - np.mean(values)) ** 2))
    return float(np.sqrt(total))


# A stabiliser verified: legs on and off, the sea of each, what was predicted in it and what was achieved.

SEGMENT_PERIODS = 12.0  # natural periods in a segment of a spectrum: a damping ratio of 0.1 spans some bins; chosen
_LOWEST, _HIGHEST = 0.15, 5.0  # frequencies over the natural one that are looked at; chosen
_STRONG = 0.03  # of the output's largest density, down to which the sea is sought in it; chosen
# standard deviations of the logarithms of height and peak period from one leg to the next: legs follow one another
# within an hour; chosen
SEA_CHANGE = (0.1, 0.05)
# logarithms of frequencies over the natural one at which what excites the roll may depart from spectrum and effective
# slope as assumed, how far apart departures have little in common, and standard deviations of the logarithm of energy,
# of which the log's evidence takes one; chosen
_DEPARTURES, _DEPARTURE_LENGTH, _DEVIATIONS = np.linspace(-1.2, 1.2, 13), 0.5, (0.1, 0.3, 1.0)
# standard deviation of a coefficient or of the actuator's effect of a ship that may have changed, as a share of it: a
# prior so wide that where the log knows it to 5 % it draws the estimate by no more than 1 % of the difference; chosen
OTHER_DAY = 0.5
_DAMPING_DEVIATION = 0.3  # of the logarithm of the damping before the log: what decay tests scatter by; chosen
_WAVE_COLUMN = 2  # of a leg's values, where waves were recorded
_LEAST_COHERENCE = 0.6  # of what the actuator did with what the gains order; chosen
BY_MODEL = "the actuator's effect taken off by the model as the log corrects it"
BY_WAVES = "legs on against legs off, each frequency carried to the waves recorded"
AS_THEY_ARE = "legs on against legs off, as if the sea had been the same"


@dataclass(frozen=True, eq=False)
class _Leg:
    """A leg with its spectra: `spectra` over the whole band for energies, those of `waves` where the output is strong.

    loop: with the gains, at the leg's speed, as the model has it.
    """

    logged: LoggedLeg
    loop: TransferLoop
    spectra: StretchSpectra
    waves: WaveLeg

    def predicted(self, sea: Array) -> LoopMoments:
        """Return the moments in a sea of these unknowns (3 + j,)."""
        return predicted_moments(self.loop, self.waves.sea, sea)

    def logged_moments(self, mean_products: Complex, ship: Array) -> LoopMoments:
        """Return the moments that mean products (k, 2, 2) show with the ship's factors (3,)."""
        plant = altered_loop(self.loop, ship).plant
        return logged_moments(mean_products, self.spectra.omega, plant.frequency_response(self.spectra.omega))


@dataclass(frozen=True, eq=False)
class StabiliserLog:
    """What the log of a stabiliser shows: fields as of `Verification`; `fit`: ship and seas."""

    legs: tuple[VerifiedLeg, ...]
    quantities: tuple[VerifiedQuantity, ...]
    reductions: tuple[ReductionEstimate, ...]
    fit: LegFit


def prior_deviations(task: TuningTask) -> Array:
    """Return standard deviations of the logarithms of the plant's factors before the log, (3,)."""
    return np.array([task.uncertainty.gain, task.uncertainty.time, _DAMPING_DEVIATION])


def departure_frequencies(loop: TransferLoop) -> Array:
    """Return the encounter frequencies [rad/s] at which the excitation may depart from the assumed one, (j,)."""
    return np.asarray(2.0 * math.pi / natural_period(loop) * np.exp(_DEPARTURES))


def departure_covariance(deviation: float) -> Array:
    """Return the covariance of the departures of the roll's excitation from the assumed one before the log, (j, j)."""
    apart = np.abs(_DEPARTURES[:, None] - _DEPARTURES) / _DEPARTURE_LENGTH
    return np.asarray(deviation**2 * np.exp(-apart))


def verify_stabiliser(task: TuningTask, gains: Array, records: Sequence[Record]) -> StabiliserLog:
    """Return what the records show of a stabiliser with the gains (g,).

    Raises:
        InputError: no sea in the task, no leg with control, legs too short, or an actuator that does not follow the
            gains.
    """
    seaway = next((disturbance for disturbance in task.disturbances if isinstance(disturbance, Seaway)), None)
    if seaway is None:
        raise InputError(f"tuning '{task.name}' names no sea; add [[seas]] with the heading of the legs")
    if seaway.path is not None:
        raise InputError(f"the loop on '{task.loop.output}' is not verified in waves; that of roll is")
    loop = task.loop.with_gains(gains)
    legs = [_prepared(task, leg, loop, seaway) for leg in legs_on_and_off(records, loop, task.U)]
    ship, waves = np.hypot(prior_deviations(task), [OTHER_DAY, 0.0, 0.0]), [leg.waves for leg in legs]
    priors = (LegPriors(ship, np.array(SEA_CHANGE), departure_covariance(deviation)) for deviation in _DEVIATIONS)
    fit = max((fit_legs(waves, prior) for prior in priors), key=lambda fit: fit.evidence)
    verified = tuple(_verified_leg(leg, fit, k) for k, leg in enumerate(legs))
    quantities = _quantities(legs, fit)
    return StabiliserLog(verified, quantities, _reductions(legs, quantities[0]), fit)


def _prepared(task: TuningTask, leg: LoggedLeg, loop: TransferLoop, seaway: Seaway) -> _Leg:
    at_speed, period = task.loop_at(leg.U, loop), natural_period(loop)
    spectra = stretch_spectra(leg.values, leg.dt, SEGMENT_PERIODS * period).band_limited(
        _LOWEST * 2.0 * math.pi / period, _HIGHEST * 2.0 * math.pi / period
    )
    strong = spectra.strong_band(0, _STRONG)
    sea = encountered_sea(strong.omega, leg.U, seaway.beta, seaway.effect, departure_frequencies(loop))
    expected = 2.0 * math.pi / seaway.spectrum.modal_frequency
    return _Leg(leg, at_speed, spectra, WaveLeg(ObservedLeg(strong, at_speed), sea, expected))


def _verified_leg(leg: _Leg, fit: LegFit, place: int) -> VerifiedLeg:
    """Return a leg with its sea, and how its actuator followed the gains.

    Raises:
        InputError: it did not.
    """
    (height, period), (height_sd, period_sd) = fit.seas[place, :2], fit.sea_deviations(place)[:2]
    heights, periods = (_log_normal_interval(*pair) for pair in ((height, height_sd), (period, period_sd)))
    mean, logged = products(leg.spectra).mean(axis=0), leg.logged
    moments = leg.logged_moments(mean, fit.ship)
    ratio, coherence = _followed_gains(leg, mean) if logged.is_controlled else (math.nan, math.nan)
    if coherence < -_LEAST_COHERENCE:
        actuator = leg.loop.actuator
        raise InputError(
            f"record '{logged.record}': '{actuator}' moves against these gains (coherence {coherence:.2f}); it is "
            f"positive the other way than the notation has it: declare that for '{actuator}' in [records.channels]"
        )
    if coherence < _LEAST_COHERENCE:
        raise InputError(
            f"record '{logged.record}': from {logged.start:.0f} s on the actuator does not follow these gains "
            f"(coherence {coherence:.2f} with what they order of the output); give the gains that were on"
        )
    strong = leg.waves.spectra
    return VerifiedLeg(
        logged.record, logged.start, logged.stop, logged.is_controlled, logged.U,
        math.exp(height), *heights, math.exp(period), *periods,
        math.sqrt(moments.output), math.sqrt(moments.actuator), ratio, coherence,
        strong.omega, np.real(strong.cross_density(0, 0)), _predicted_density(leg, fit.seas[place]),
    )  # fmt: skip


def _log_normal_interval(centre: float, deviation: float) -> tuple[float, float]:
    """Return the ends of the 95 % interval of a quantity whose logarithm is normal."""
    low, high = normal_interval(centre, deviation)
    return math.exp(low), math.exp(high)


def _followed_gains(leg: _Leg, mean: Complex) -> tuple[float, float]:
    """Return what the actuator did over what the gains order of the output, in phase, and the coherence of both."""
    controller = leg.loop.gain_values @ leg.loop.controller_terms(leg.spectra.omega)
    ordered = float(np.sum(np.abs(controller) ** 2 * np.real(mean[:, 0, 0])))
    in_phase = float(np.real(np.sum(-controller.conj() * mean[:, 1, 0])))
    return in_phase / ordered, in_phase / math.sqrt(ordered * float(np.sum(np.real(mean[:, 1, 1]))))


def _predicted_density(leg: _Leg, sea: Array) -> Array:
    """Return the density of the output by the model as it was, with control where it was on, in the sea met."""
    omega_e = leg.waves.sea.omega_e
    response = leg.loop.disturbance.frequency_response(omega_e)
    if leg.logged.is_controlled:
        response = response / (1.0 + leg.loop.open_loop(omega_e))
    return leg.waves.sea.density(sea, np.abs(response) ** 2)


def _quantities(legs: Sequence[_Leg], fit: LegFit) -> tuple[VerifiedQuantity, ...]:
    """Return predicted and achieved values over the legs with control, the reduction first."""
    places = [k for k, leg in enumerate(legs) if leg.logged.is_controlled]
    on = [legs[k] for k in places]
    data = [products(leg.spectra) for leg in on]
    means = [leg.mean(axis=0) for leg in data]

    def predicted(seas: Array) -> LoopMoments:
        return mean_moments([leg.predicted(sea) for leg, sea in zip(on, seas[places], strict=True)])

    def achieved(mean_products: Sequence[Complex], ship: Array) -> LoopMoments:
        return mean_moments([leg.logged_moments(mean, ship) for leg, mean in zip(on, mean_products, strict=True)])

    def row(name: str, unit: str, value: Callable[[LoopMoments], float]) -> VerifiedQuantity:
        by_model, spread = value(predicted(fit.seas)), fit.deviation(lambda _, seas: value(predicted(seas)))
        by_log = value(achieved(means, fit.ship))
        sampling = jackknife_deviation(data, lambda mean_products: value(achieved(mean_products, fit.ship)))
        scatter = math.hypot(sampling, fit.deviation(lambda ship, _: value(achieved(means, ship))))
        return VerifiedQuantity(
            name, unit, by_model, *normal_interval(by_model, spread), by_log, *normal_interval(by_log, scatter),
            is_consistent(by_model, by_log, spread, scatter),
        )  # fmt: skip

    moved, mover = channel_unit(on[0].loop.output), channel_unit(on[0].loop.actuator)
    return (
        row("reduction", "1", lambda m: m.reduction),
        row("output rms", moved, lambda m: math.sqrt(m.output)),
        row("actuator rms", mover, lambda m: math.sqrt(m.actuator)),
        row("actuator rate rms", f"{mover}/s", lambda m: math.sqrt(m.rate)),
        row("actuator reversals", "1/h", lambda m: m.reversals),
    )


def _reductions(legs: Sequence[_Leg], by_model: VerifiedQuantity) -> tuple[ReductionEstimate, ...]:
    """Return the reduction by the model, and where there are legs without control, by what the legs themselves show."""
    estimates = [ReductionEstimate(BY_MODEL, by_model.achieved, by_model.lower, by_model.upper)]
    data, is_on = [products(leg.spectra) for leg in legs], [leg.logged.is_controlled for leg in legs]

    def estimate(method: str, value: Callable[[Complex, Complex], float]) -> ReductionEstimate:
        def of_means(means: Sequence[Complex]) -> float:
            on, off = (np.mean([m for m, state in zip(means, is_on, strict=True) if state is kind], axis=0)
                       for kind in (True, False))  # fmt: skip
            return value(on, off)

        reduction = of_means([leg.mean(axis=0) for leg in data])
        return ReductionEstimate(method, reduction, *normal_interval(reduction, jackknife_deviation(data, of_means)))

    if not all(is_on) and legs[0].logged.values.shape[1] > _WAVE_COLUMN:
        estimates.append(estimate(BY_WAVES, reduction_by_waves))
    if not all(is_on):
        estimates.append(estimate(AS_THEY_ARE, plain_reduction))
    return tuple(estimates)
