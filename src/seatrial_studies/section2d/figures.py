"""Figures of the study: responses over the wave period, and the two waves of one run."""

from collections.abc import Callable

import numpy as np

from seatrial.core.results import Curve, Figure
from seatrial.core.values import Array
from seatrial.physics.hydro import wavenumber
from seatrial_studies.section2d import tank
from seatrial_studies.section2d.analysis import SectionAnalysis
from seatrial_studies.section2d.modes import ModeFit, theory_of_model
from seatrial_studies.section2d.oscillator import MeasuredResponse
from seatrial_studies.section2d.runs import STEADY_TIMING
from seatrial_studies.section2d.tables import motion_name

POINTS, MARKER_SIZE = 60, 0.012


def figures(analysis: SectionAnalysis) -> tuple[Figure, ...]:
    """Amplitude and phase of heave and roll, and the waves of one run."""
    return (*response_figures(analysis.heave), *response_figures(analysis.roll), wave_figure(analysis))


def response_figures(fit: ModeFit) -> tuple[Figure, Figure]:
    """Amplitude and phase; the curve is computed in waves of the smaller nominal height."""
    what = motion_name(fit).capitalize()
    note = "Curve: trained on half of the periods. Phase against the onward wave at the model, positive leads."
    size = _response_curves(fit, f"{what} over the wave period", "amplitude [m/m]", lambda r: float(abs(r)))
    angle = _response_curves(fit, f"{what}: phase", "phase [deg]", lambda r: float(np.degrees(np.angle(r))))
    return Figure(*size, note), Figure(*angle, note)


def wave_figure(analysis: SectionAnalysis) -> Figure:
    """Onward and back, with the steady stretch."""
    run, parts = analysis.example_waves
    start, stop = run.steady_window(STEADY_TIMING)
    edge = 1.1 * float(np.max(np.abs(parts.incident)))
    frame = Curve("steady stretch", np.array([start, start, stop, stop]), 1e3 * np.array([-edge, edge, edge, -edge]))
    time = run.record.time
    return Figure(
        f"Waves at the model, run {run.name}",
        "time [s]",
        "elevation [mm]",
        (Curve("onward", time, 1e3 * parts.incident), Curve("back", time, 1e3 * parts.reflected), frame),
        "Separated over the whole record from four probes.",
    )


def _response_curves(
    fit: ModeFit, title: str, y_label: str, component: Callable[[complex], float]
) -> tuple[str, str, str, tuple[Curve, ...]]:
    periods = np.array([s.response.run.period for s in fit.scores])
    smooth = np.linspace(periods.min(), periods.max(), POINTS)
    computed = np.array([component(_computed_response(fit, float(p))) for p in smooth])
    measured = np.array([component(fit.mode.measured_response(s.response)) for s in fit.scores])
    trained = np.array([s.is_training for s in fit.scores])
    room = (MARKER_SIZE * float(np.ptp(smooth)), 1.6 * MARKER_SIZE * float(np.ptp(computed)))
    marks = (
        _marker_curve("trained", periods[trained], measured[trained], room),
        _marker_curve("held out", periods[~trained], measured[~trained], room),
    )
    return title, "wave period [s]", y_label, (Curve("computed", smooth, computed), *marks)


def _computed_response(fit: ModeFit, period: float) -> complex:
    omega = 2.0 * np.pi / period
    theory = theory_of_model(fit.mode.motion, omega, fit.mode.sign)
    wave = 0.5 * min(tank.HEIGHTS.values())
    return fit.half_of_periods.oscillator.measured_response(
        MeasuredResponse(omega, float(wavenumber(omega, tank.DEPTH)), wave, 1.0, 1.0, theory)
    )


def _marker_curve(label: str, x: Array, y: Array, marker_size: tuple[float, float]) -> Curve:
    """A diamond about each point."""
    gap = np.full(len(x), np.nan)
    across = np.stack([x - marker_size[0], x, x + marker_size[0], x, x - marker_size[0], gap], axis=1).ravel()
    upward = np.stack([y, y + marker_size[1], y, y - marker_size[1], y, gap], axis=1).ravel()
    return Curve(label, across, upward)
