"""Figures of the study: responses over the wave period, and the two waves of one run."""

from collections.abc import Callable

import numpy as np

from seatrial.core.results import Curve, Figure
from seatrial.core.values import Array
from seatrial.estimation.problem.oscillator import Observed
from seatrial.physics.hydro.dispersion import wavenumber
from seatrial_studies.section2d import tank
from seatrial_studies.section2d.modes import ModeFit, theory_at
from seatrial_studies.section2d.numbers import Numbers
from seatrial_studies.section2d.runs import STEADY
from seatrial_studies.section2d.tables import name

POINTS, MARK = 60, 0.012


def figures(made: Numbers) -> tuple[Figure, ...]:
    """Amplitude and phase of heave and roll, and the waves of one run."""
    return (*responses(made.heave), *responses(made.roll), waves(made))


def responses(fit: ModeFit) -> tuple[Figure, Figure]:
    """Amplitude and phase; the curve is computed in waves of the smaller nominal height."""
    what = name(fit).capitalize()
    note = "Curve: trained on half of the periods. Phase against the onward wave at the model, positive leads."
    size = _figure(fit, f"{what} over the wave period", "amplitude [m/m]", lambda r: float(abs(r)))
    angle = _figure(fit, f"{what}: phase", "phase [deg]", lambda r: float(np.degrees(np.angle(r))))
    return Figure(*size, note), Figure(*angle, note)


def waves(made: Numbers) -> Figure:
    """Onward and back, with the steady stretch."""
    run, parts = made.example
    start, stop = run.window(STEADY)
    edge = 1.1 * float(np.max(np.abs(parts.onward)))
    frame = Curve("steady stretch", np.array([start, start, stop, stop]), 1e3 * np.array([-edge, edge, edge, -edge]))
    time = run.record.time
    return Figure(
        f"Waves at the model, run {run.name}",
        "time [s]",
        "elevation [mm]",
        (Curve("onward", time, 1e3 * parts.onward), Curve("back", time, 1e3 * parts.back), frame),
        "Separated over the whole record from four probes.",
    )


def _figure(
    fit: ModeFit, title: str, y_label: str, shown: Callable[[complex], float]
) -> tuple[str, str, str, tuple[Curve, ...]]:
    periods = np.array([s.response.run.period for s in fit.scores])
    smooth = np.linspace(periods.min(), periods.max(), POINTS)
    computed = np.array([shown(_computed(fit, float(p))) for p in smooth])
    measured = np.array([shown(fit.mode.measured(s.response)) for s in fit.scores])
    trained = np.array([s.trained for s in fit.scores])
    room = (MARK * float(np.ptp(smooth)), 1.6 * MARK * float(np.ptp(computed)))
    marks = (
        _marks("trained", periods[trained], measured[trained], room),
        _marks("held out", periods[~trained], measured[~trained], room),
    )
    return title, "wave period [s]", y_label, (Curve("computed", smooth, computed), *marks)


def _computed(fit: ModeFit, period: float) -> complex:
    omega = 2.0 * np.pi / period
    theory = theory_at(fit.mode.motion, omega, fit.mode.sign)
    wave = 0.5 * min(tank.HEIGHTS.values())
    return fit.trained.oscillator.seen(Observed(omega, float(wavenumber(omega, tank.DEPTH)), wave, 1.0, 1.0, theory))


def _marks(label: str, x: Array, y: Array, room: tuple[float, float]) -> Curve:
    """A diamond about each point."""
    gap = np.full(len(x), np.nan)
    across = np.stack([x - room[0], x, x + room[0], x, x - room[0], gap], axis=1).ravel()
    upward = np.stack([y, y + room[1], y, y - room[1], y, gap], axis=1).ravel()
    return Curve(label, across, upward)
