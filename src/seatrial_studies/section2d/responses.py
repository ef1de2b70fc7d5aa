"""Runs to responses: heave, roll, sway per wave amplitude at the model, in the steady stretch."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array
from seatrial.data.check import with_standard_signs
from seatrial_studies.section2d.harmonics import harmonics, whole_periods
from seatrial_studies.section2d.runs import STEADY_TIMING, FlumeRun, Timing
from seatrial_studies.section2d.tank import DEPTH, FIRST_PROBE_TO_MODEL, PROBE_PLACES, PROBES
from seatrial_studies.section2d.wave_separation import Probes, SeparatedWaves, calibrate_wave_probes, separate_waves

HARMONIC_ORDERS = (1, 2, 3)


@dataclass(frozen=True, eq=False)
class SectionResponse:
    """One run in its steady stretch; complex amplitudes per m of the wave that goes on, at the model.

    Attributes:
        period_count: whole periods in the stretch.
        wave_amplitude: amplitude of the wave that goes on, m.
        paddle_ratio: wave amplitude over the paddle's stroke.
        reflected_ratio: of the wave that comes back.
        transmitted_ratio: elevation behind the model.
        heave: up, from the mean of both accelerometers, m/m.
        roll: starboard over port accelerometer, m/m: roll angle times the distance between them.
        sway: from the accelerometer, m/m; force: holding force, N/m.
        camera_heave, camera_roll: amplitudes only; the camera's clock is its own. Zero where it is dead.
        relative_error: relative standard error of the heave amplitude by the harmonic fit.
    """

    run: FlumeRun
    period_count: int
    wave_amplitude: float
    paddle_ratio: float
    reflected_ratio: float
    transmitted_ratio: float
    heave: complex
    roll: complex
    sway: complex
    force: complex
    camera_heave: float
    camera_roll: float
    camera_sway: float
    relative_error: float


def calibrate_probes(runs: Sequence[FlumeRun]) -> Probes:
    """Places and gains from those runs.

    Raises:
        InputError: no run.
    """
    return calibrate_wave_probes([(r.elevations(PROBES), r.record.dt, r.omega) for r in runs], DEPTH, PROBE_PLACES)


def waves_at_model(run: FlumeRun, probes: Probes) -> SeparatedWaves:
    """Both waves at the model's place, whole record."""
    return separate_waves(run.elevations(PROBES), run.record.dt, run.omega, probes, FIRST_PROBE_TO_MODEL)


def steady_samples(run: FlumeRun, timing: Timing = STEADY_TIMING) -> slice:
    """Return the samples of whole periods in the window.

    Raises:
        InputError: the window holds no period.
    """
    return whole_periods(run.record.time, *run.steady_window(timing), run.omega)


def measure_response(run: FlumeRun, probes: Probes, timing: Timing = STEADY_TIMING) -> SectionResponse:
    """Return the complex amplitudes of one run.

    Raises:
        InputError: the window holds no period.
    """
    waves, rows, w = waves_at_model(run, probes), steady_samples(run, timing), run.omega
    record, time = with_standard_signs(run.record), run.record.time[rows]

    def first(values: Array) -> complex:
        return harmonics(time, values[rows], w, HARMONIC_ORDERS).first

    onward = first(waves.incident)
    up = harmonics(time, -0.5 * (record["z_ddot_1"] + record["z_ddot_2"])[rows], w, HARMONIC_ORDERS)
    difference = first(record["z_ddot_2"] - record["z_ddot_1"])
    turned = [first(record[s]) for s in ("v_dot", "F_y")]
    camera = [abs(first(record[s])) for s in ("z", "phi", "y0")]
    return SectionResponse(
        run=run,
        period_count=round((time[-1] - time[0]) / run.period),
        wave_amplitude=abs(onward),
        paddle_ratio=abs(onward) / _stroke_amplitude(run),
        reflected_ratio=abs(first(waves.reflected) / onward),
        transmitted_ratio=abs(first(record["zeta_6"]) / onward),
        heave=-up.first / w**2 / onward,
        roll=-difference / w**2 / onward,
        sway=-turned[0] / w**2 / onward,
        force=turned[1] / onward,
        camera_heave=camera[0] / abs(onward),
        camera_roll=camera[1] / abs(onward),
        camera_sway=camera[2] / abs(onward),
        relative_error=up.relative_error,
    )


def _stroke_amplitude(run: FlumeRun) -> float:
    _, full, left = run.stroke_times
    part = run.record.between(full, left)
    return abs(harmonics(part.time, part["x_wm"], run.omega, (1,)).first)


def relative_difference(one: complex, other: complex) -> tuple[float, float]:
    """Return one over the other: per cent of amplitude, degrees of phase."""
    ratio = one / other
    return 100.0 * (abs(ratio) - 1.0), float(np.degrees(np.angle(ratio)))
