"""Everything the verdicts rest on: modes, guide, springs, and the instruments compared with one another."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

import numpy as np

from seatrial.core.values import Array, Finding, ProgressReporter, Record, Severity
from seatrial.data.check import with_standard_signs
from seatrial_studies.cross_validation import jackknife_error
from seatrial_studies.section2d.modes import (
    HEAVE,
    ROLL,
    Mode,
    ModeFit,
    SwayStiffness,
    fit_mode,
    observation,
    split_periods,
    sway_stiffness,
    untied_mass_error,
)
from seatrial_studies.section2d.responses import (
    CAMERA,
    STEADY_TIMING,
    FlumeRun,
    Probes,
    SectionResponse,
    SeparatedWaves,
    Timing,
    calibrate_probes,
    harmonics,
    measure_response,
    read_runs,
    relative_difference,
    steady_samples,
    waves_at_model,
)

# The sway guide: what its force has in phase with the sway velocity, run by run, and how that goes with velocity.


@dataclass(frozen=True)
class Friction:
    """One run.

    Attributes:
        velocity: amplitude of sway velocity, m/s.
        damping: force against velocity over velocity, N s/m: linear damping of equal work.
        force: amplitude of that force, N.
        third_harmonic_ratio: third harmonic of the holding force over its first; 1/3 for dry friction alone.
    """

    run: str
    velocity: float
    damping: float
    force: float
    third_harmonic_ratio: float


@dataclass(frozen=True)
class Guide:
    """All runs; damping goes with exp(level) velocity^exponent: 0 linear, -1 dry friction, 1 quadratic."""

    runs: tuple[Friction, ...]
    exponent: float
    level: float
    error: float

    def velocity_at_damping(self, damping: float) -> float:
        """m/s at which the damping is that many N s/m."""
        return float(np.exp((np.log(damping) - self.level) / self.exponent))


def fit_guide_damping(runs: Sequence[FlumeRun], stiffness: float) -> Guide:
    """Of runs that sway freely.

    Args:
        stiffness: of the springs, N/m.

    Raises:
        InputError: a run's steady stretch holds no whole wave period.
    """
    made = tuple(f for f in (guide_friction(r, stiffness) for r in runs if r.scenario in (3, 4)) if f.damping > 0.0)
    if len(made) < 3:
        return Guide(made, float("nan"), float("nan"), float("nan"))
    points = np.log(np.array([(f.velocity, f.damping) for f in made]))
    left = [_fit_line(np.delete(points, k, axis=0))[0] for k in range(len(made))]
    return Guide(made, *_fit_line(points), jackknife_error(left))


def guide_friction(run: FlumeRun, stiffness: float) -> Friction:
    """One run's steady stretch.

    Raises:
        InputError: the stretch holds no whole wave period.
    """
    rows, record = steady_samples(run), run.record
    time = record.time[rows]
    sway = harmonics(time, (record["S_1"] - record["S_2"])[rows], run.omega).first / stiffness
    force = harmonics(time, record["F_y"][rows], run.omega)
    velocity = 1j * run.omega * sway
    damping = -(force.first / velocity).real
    third = float(abs(force.amplitudes[2]) / abs(force.first))
    return Friction(run.name, abs(velocity), damping, damping * abs(velocity), third)


def _fit_line(points: Array) -> tuple[float, float]:
    slope, level = np.polyfit(points[:, 0], points[:, 1], 1)
    return float(slope), float(level)


# Instruments against one another: channels that never move, delay, gain and clock between two of the same motion.

MIN_CHANGES = 3


@dataclass(frozen=True)
class InstrumentComparison:
    """One instrument against another in a steady regular wave.

    Attributes:
        delay: s by which the first lags the second at the window's middle, modulo the wave period, within half of it.
        clock_drift: s per s; a clock that runs slow by 1 % drifts by 0.01.
        gain: amplitude of the second over that of the first, median over windows.
        delay_scatter: s, scatter of the delay about its line.
    """

    delay: float
    clock_drift: float
    gain: float
    delay_scatter: float


def dead_channel_findings(record: Record, symbols: Iterable[str] | None = None) -> tuple[Finding, ...]:
    """Channels that hold (nearly) one value throughout while the record lasts; one finding each."""
    made = []
    for symbol in symbols if symbols is not None else record.channels:
        values = record[symbol]
        changes = int(np.count_nonzero(np.diff(values)))
        if changes < MIN_CHANGES:
            made.append(
                Finding(
                    Severity.ERROR,
                    "dead-channel",
                    f"{record.name}: channel '{symbol}' ({record.channel(symbol).label}) does not move",
                    f"{changes} changes in {len(record)} samples",
                    "leave the channel of this record out",
                )
            )
    return tuple(made)


def compare_instruments(
    time: Array, first: Array, second: Array, omega: float, periods: float = 2.0
) -> InstrumentComparison:
    """Delay, drift and gain between two channels of one motion from their phases in sliding windows.

    Args:
        time, first, second: (n,), a stretch of regular waves in which both move.
        omega: rad/s.
        periods: length of a window.
    """
    dt = float(time[1] - time[0])
    length = max(8, round(periods * 2.0 * np.pi / omega / dt))
    turning = np.exp(-1j * omega * time)
    kernel = np.hanning(length + 2)[1:-1]
    one, two = (np.convolve((x - x.mean()) * turning, kernel / kernel.sum(), "valid") for x in (first, second))
    middle = time[length // 2 : length // 2 + len(one)]
    phase = np.unwrap(np.angle(two * one.conj()))
    delays = phase / omega
    centre = 0.5 * (time[0] + time[-1])
    slope, offset = np.polyfit(middle - centre, delays, 1) if len(middle) > 2 else (0.0, float(delays.mean()))
    period = 2.0 * np.pi / omega
    left = delays - offset - slope * (middle - centre)
    return InstrumentComparison(
        float((offset + 0.5 * period) % period - 0.5 * period),
        float(slope),
        float(np.median(np.abs(two) / np.maximum(np.abs(one), 1e-300))),
        float(np.std(left)),
    )


# The numbers of the study, in the order in which they are made; what is frozen before periods held out are scored.

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

    return (("linear", *fit_with("linear_damping")), ("none but of waves", *fit_with("")))


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


# What the instruments say of one another: findings.

DRIFT_LIMIT, LEAST_PERIOD_S = 0.001, 0.9


def camera_gain(analysis: SectionAnalysis) -> tuple[float, float, float]:
    """Median, smallest, largest ratio of accelerometers' to camera's heave, periods from 0.9 s on; NaN without."""
    long = {r.name for r in analysis.runs if r.period >= LEAST_PERIOD_S}
    gains = [c.gain for name, c in analysis.clocks.items() if name in long]
    return (float(np.median(gains)), min(gains), max(gains)) if gains else (np.nan, np.nan, np.nan)


def instrument_findings(analysis: SectionAnalysis) -> tuple[Finding, ...]:
    """Dead channels, a camera clock that drifts, a gain between camera and accelerometers."""
    drifting = {name: c for name, c in analysis.clocks.items() if abs(c.clock_drift) > DRIFT_LIMIT}
    drifts = [1e3 * c.clock_drift for c in drifting.values()]
    median, least, most = camera_gain(analysis)
    clock = Finding(
        Severity.WARNING,
        "clock-drift",
        f"the camera's clock runs apart from the accelerometers' in {len(drifting)} of {len(analysis.clocks)} runs",
        f"{min(drifts):+.1f} to {max(drifts):+.1f} ms per s" if drifts else "",
        "take phases from the accelerometers, from the camera amplitudes only",
    )
    gain = Finding(
        Severity.WARNING,
        "instrument-gain",
        "heave by the accelerometers exceeds heave by the camera",
        f"factor {median:.3f}, from {least:.3f} to {most:.3f} over runs with periods from 0.9 s on",
        "estimate one gain along with the coefficients",
    )
    return (
        *analysis.dead_channel_findings,
        *((clock,) if drifting else ()),
        *((gain,) if np.isfinite(median) else ()),
        *_short_stretch_findings(analysis),
    )


def _short_stretch_findings(analysis: SectionAnalysis) -> list[Finding]:
    return [
        Finding(
            Severity.INFO,
            "no-steady-stretch",
            f"{r.name}: less than one wave period lies between the ramp and the beach's reflection",
            f"period {r.period:.3f} s",
            "such waves need a shorter ramp or a longer flume; the run gives no response",
        )
        for r in analysis.runs
        if not is_long_enough(r)
    ]
