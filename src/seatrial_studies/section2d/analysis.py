"""The numbers of the study, in the order in which they are made; what is frozen before periods held out are scored."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

import numpy as np

from seatrial.core.values import Finding, ProgressReporter
from seatrial.data.check import with_standard_signs
from seatrial_studies.section2d.guide import Guide, fit_guide_damping
from seatrial_studies.section2d.instrument_comparison import (
    InstrumentComparison,
    compare_instruments,
    dead_channel_findings,
)
from seatrial_studies.section2d.modes import HEAVE, ROLL, Mode, ModeFit, fit_mode, observation, split_periods
from seatrial_studies.section2d.responses import (
    SectionResponse,
    calibrate_probes,
    measure_response,
    relative_difference,
    waves_at_model,
)
from seatrial_studies.section2d.runs import STEADY_TIMING, FlumeRun, Timing, read_runs
from seatrial_studies.section2d.separability import untied_mass_error
from seatrial_studies.section2d.springs import SwayStiffness, sway_stiffness
from seatrial_studies.section2d.tank import CAMERA
from seatrial_studies.section2d.wave_separation import Probes, SeparatedWaves

ALTERNATIVE_TIMINGS = (Timing(0.5, 0.5), Timing(0.5, 1.5), Timing(1.5, 1.5), Timing(2.5, 2.5), Timing(2.5, 3.5))
POLYNOMIAL_ORDERS = (0, 1, 2)
_CLOCK_MARGINS_S = (3.0, 6.0)


@dataclass(frozen=True)
class RepeatedRuns:
    """Runs of one setting: spread of heave and roll about their mean, per cent and degrees."""

    names: tuple[str, ...]
    heave: tuple[float, float]
    roll: tuple[float, float]


@dataclass(frozen=True, eq=False)
class SectionAnalysis:
    """Everything tables, claims and checks rest on.

    Attributes:
        probes: calibrated on the runs whose periods train heave.
        untied_errors: order -> standard error of heave's and roll's added mass without any tie.
        coupled_runs: sway-heave-roll and heave-roll runs' heave against the oscillator trained on sway-heave ones.
        timing_fits, damping_fits: fits with other stretches or other laws of damping; empty in the quick version.
        example_waves: the two waves of one run.
    """

    runs: tuple[FlumeRun, ...]
    probes: Probes
    responses: tuple[SectionResponse, ...]
    heave: ModeFit
    roll: ModeFit
    untied_errors: Mapping[int, tuple[float, float]]
    repeated_runs: tuple[RepeatedRuns, ...]
    coupled_runs: tuple[tuple[SectionResponse, float, float], ...]
    clocks: Mapping[str, InstrumentComparison]
    dead_channel_findings: tuple[Finding, ...]
    sway_stiffness: SwayStiffness
    guide: Guide
    timing_fits: tuple[tuple[Timing, ModeFit, ModeFit], ...]
    damping_fits: tuple[tuple[str, ModeFit, ModeFit], ...]
    example_waves: tuple[FlumeRun, SeparatedWaves]


def analyse_records(folder: Path, *, quick: bool, report_progress: ProgressReporter | None) -> SectionAnalysis:
    """Read, check, calibrate, fit; all settings stand before anything held out is scored.

    Raises:
        InputError: the folder's records cannot be read or do not suffice.
    """
    report = report_progress or (lambda _: None)
    report("reading the records")
    runs = read_runs(folder)
    used = [r for r in runs if r.scenario == HEAVE.scenario and is_long_enough(r)]
    train, _ = split_periods([r.period_index for r in used])
    probes = calibrate_probes([r for r in used if r.period_index in train])
    report("waves and motions at the model")
    responses, heave, roll = fit_both_modes(runs, probes, STEADY_TIMING)
    untied = {
        order: (_untied_error(HEAVE, responses, order), _untied_error(ROLL, responses, order))
        for order in POLYNOMIAL_ORDERS
    }
    dead = tuple(f for r in runs for f in dead_channel_findings(r.record, CAMERA))
    report("instruments against one another")
    alive = [r for r in runs if not dead_channel_findings(r.record, CAMERA)]
    springs = sway_stiffness(alive)
    return SectionAnalysis(
        runs=runs,
        probes=probes,
        responses=responses,
        heave=heave,
        roll=roll,
        untied_errors=untied,
        repeated_runs=group_repeated_runs(responses),
        coupled_runs=tuple((r, *_prediction_error(heave, r)) for r in responses if r.run.scenario != HEAVE.scenario),
        clocks={r.name: compare_camera_clock(r) for r in alive},
        dead_channel_findings=dead,
        sway_stiffness=springs,
        guide=fit_guide_damping([r for r in runs if is_long_enough(r)], springs.value),
        timing_fits=() if quick else tuple((t, *fit_both_modes(runs, probes, t)[1:]) for t in ALTERNATIVE_TIMINGS),
        damping_fits=() if quick else _alternative_dampings(responses, heave, roll),
        example_waves=_example_waves(runs, probes),
    )


def fit_both_modes(
    runs: Sequence[FlumeRun], probes: Probes, timing: Timing
) -> tuple[tuple[SectionResponse, ...], ModeFit, ModeFit]:
    """Responses, heave, and roll with the distance that heave's training periods found.

    Raises:
        InputError: too few runs or periods.
    """
    responses = tuple(measure_response(r, probes, timing) for r in runs if is_long_enough(r, timing))
    heave = fit_mode(HEAVE, responses)
    distance = heave.half_of_periods.oscillator.distance
    return responses, heave, fit_mode(replace(ROLL, start=replace(ROLL.start, distance=distance)), responses)


def is_long_enough(run: FlumeRun, timing: Timing = STEADY_TIMING) -> bool:
    """Return whether a whole wave period lies between the ramp and the beach's reflection."""
    start, stop = run.steady_window(timing)
    return stop - start >= run.period


def group_repeated_runs(responses: Sequence[SectionResponse]) -> tuple[RepeatedRuns, ...]:
    """Settings run more than once."""
    order = sorted(responses, key=lambda r: r.run.name)
    groups = [list(group) for _, group in groupby(order, key=lambda r: r.run.name[:4])]
    return tuple(
        RepeatedRuns(
            tuple(r.run.name for r in group),
            _largest_deviations([r.heave for r in group]),
            _largest_deviations([r.roll for r in group]),
        )
        for group in groups
        if len(group) > 1
    )


def compare_camera_clock(run: FlumeRun) -> InstrumentComparison:
    """Return the camera's heave against the accelerometers' mean, integrated twice, about the steady stretch."""
    record = with_standard_signs(run.record)
    start, stop = run.steady_window(STEADY_TIMING)
    part = record.between(start - _CLOCK_MARGINS_S[0], min(stop + _CLOCK_MARGINS_S[1], float(record.time[-1])))
    lifted = -0.5 * (part["z_ddot_1"] + part["z_ddot_2"]) / run.omega**2
    return compare_instruments(part.time, part["z"], lifted, run.omega)


def _alternative_dampings(
    responses: Sequence[SectionResponse], heave: ModeFit, roll: ModeFit
) -> tuple[tuple[str, ModeFit, ModeFit], ...]:
    def fit_with(free: str) -> tuple[ModeFit, ModeFit]:
        one, two = (_with_damping(fit.mode, free) for fit in (heave, roll))
        return fit_mode(one, responses), fit_mode(two, responses)

    return (("linear", *fit_with("linear")), ("none but of waves", *fit_with("")))


def _with_damping(mode: Mode, free: str) -> Mode:
    kept = tuple(name for name in mode.free if name != "quadratic_damping") + ((free,) if free else ())
    return replace(mode, start=replace(mode.start, quadratic_damping=0.0), free=kept)


def _untied_error(mode: Mode, responses: Sequence[SectionResponse], order: int) -> float:
    used = [observation(mode, r) for r in responses if r.run.scenario == mode.scenario]
    return untied_mass_error(used, mode.start.inertia, mode.start.stiffness, order)


def _prediction_error(fit: ModeFit, response: SectionResponse) -> tuple[float, float]:
    return relative_difference(
        fit.half_of_periods.oscillator.measured_response(observation(fit.mode, response)),
        fit.mode.measured_response(response),
    )


def _largest_deviations(values: Sequence[complex]) -> tuple[float, float]:
    mean = complex(np.mean(values))
    deviations = [relative_difference(v, mean) for v in values]
    return max(abs(a) for a, _ in deviations), max(abs(p) for _, p in deviations)


def _example_waves(runs: Sequence[FlumeRun], probes: Probes) -> tuple[FlumeRun, SeparatedWaves]:
    chosen = next((r for r in runs if r.scenario == HEAVE.scenario), runs[0])
    return chosen, waves_at_model(chosen, probes)
