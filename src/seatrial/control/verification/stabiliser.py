"""A stabiliser verified: legs on and off, the sea of each, what was predicted in it and what was achieved."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.control.task import Seaway, TuningTask
from seatrial.control.verification.legs import LoggedLeg, legs_on_and_off, natural_period
from seatrial.control.verification.moments import (
    LoopMoments,
    logged_moments,
    mean_moments,
    plain_reduction,
    predicted_moments,
    reduction_by_waves,
)
from seatrial.control.verification.spread import jackknife_deviation, products
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
from seatrial.physics.loops import TransferLoop

SEGMENT_PERIODS = 12.0  # natural periods in a segment of a spectrum: a damping ratio of 0.1 spans some bins; chosen
_LOWEST, _HIGHEST = 0.15, 5.0  # frequencies over the natural one that are looked at; chosen
_STRONG = 0.03  # of the output's largest density, down to which the sea is sought in it; chosen
# standard deviations of the logarithms of height and peak period from one leg to the next: legs follow one another
# within an hour; chosen
SEA_CHANGE = (0.1, 0.05)
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
        """Return the moments in a sea of these unknowns (3,)."""
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


def verify_stabiliser(task: TuningTask, gains: Array, records: Sequence[Record]) -> StabiliserLog:
    """Return what the records show of a stabiliser with the gains (g,).

    Raises:
        InputError: no sea in the task, no leg with control, legs too short, or an actuator that does not follow the
            gains.
    """
    seaway = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if seaway is None:
        raise InputError(f"tuning '{task.name}' names no sea; add [[seas]] with the heading of the legs")
    if seaway.path is not None:
        raise InputError(f"the loop on '{task.loop.output}' is not verified in waves; that of roll is")
    loop = task.loop.with_gains(gains)
    legs = [_prepared(task, leg, loop, seaway) for leg in legs_on_and_off(records, loop, task.U)]
    fit = fit_legs([leg.waves for leg in legs], LegPriors(prior_deviations(task), np.array(SEA_CHANGE)))
    verified = tuple(_verified_leg(leg, fit, k) for k, leg in enumerate(legs))
    quantities = _quantities(legs, fit)
    return StabiliserLog(verified, quantities, _reductions(legs, quantities[0]), fit)


def _prepared(task: TuningTask, leg: LoggedLeg, loop: TransferLoop, seaway: Seaway) -> _Leg:
    at_speed, period = task.loop_at(leg.U, loop), natural_period(loop)
    spectra = stretch_spectra(leg.values, leg.dt, SEGMENT_PERIODS * period).band_limited(
        _LOWEST * 2.0 * math.pi / period, _HIGHEST * 2.0 * math.pi / period
    )
    strong = spectra.strong_band(0, _STRONG)
    sea = encountered_sea(strong.omega, leg.U, seaway.beta, seaway.effect)
    expected = 2.0 * math.pi / seaway.spectrum.modal_frequency
    return _Leg(leg, at_speed, spectra, WaveLeg(ObservedLeg(strong, at_speed), sea, expected))


def _verified_leg(leg: _Leg, fit: LegFit, place: int) -> VerifiedLeg:
    """Return a leg with its sea, and how its actuator followed the gains.

    Raises:
        InputError: it did not.
    """
    (height, period, _), (height_sd, period_sd, _) = fit.seas[place], fit.sea_deviations(place)
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
    made = [ReductionEstimate(BY_MODEL, by_model.achieved, by_model.lower, by_model.upper)]
    data, is_on = [products(leg.spectra) for leg in legs], [leg.logged.is_controlled for leg in legs]

    def estimate(method: str, value: Callable[[Complex, Complex], float]) -> ReductionEstimate:
        def of_means(means: Sequence[Complex]) -> float:
            on, off = (np.mean([m for m, state in zip(means, is_on, strict=True) if state is kind], axis=0)
                       for kind in (True, False))  # fmt: skip
            return value(on, off)

        reduction = of_means([leg.mean(axis=0) for leg in data])
        return ReductionEstimate(method, reduction, *normal_interval(reduction, jackknife_deviation(data, of_means)))

    if not all(is_on) and legs[0].logged.values.shape[1] > _WAVE_COLUMN:
        made.append(estimate(BY_WAVES, reduction_by_waves))
    if not all(is_on):
        made.append(estimate(AS_THEY_ARE, plain_reduction))
    return tuple(made)
