"""Tables and figures of the study."""

from collections.abc import Callable

import numpy as np

from seatrial.core.results import Curve, Figure, Table
from seatrial.core.values import Array
from seatrial.physics.hydro import haskind_damping, wavenumber
from seatrial_studies.section2d.analysis import (
    SectionAnalysis,
    clock_table,
    guide_table,
    probe_table,
    spring_table,
    wave_table,
)
from seatrial_studies.section2d.modes import HEAVE, MeasuredResponse, ModeFit, observation, theory_of_model
from seatrial_studies.section2d.responses import DEPTH, HEIGHTS, LENGTH, RIG_DAMPING, STEADY_TIMING, SWAY_STIFFNESS

# Tables of the study.

TableRow = tuple[str | float | None, ...]
UNITS = {
    "heave": {
        "gain": "",
        "delay": "s",
        "distance": "m",
        "extra_added_mass": "kg",
        "linear_damping": "kg/s",
        "quadratic_damping": "kg/m",
        "stiffness": "N/m",
    },
    "roll": {
        "gain": "m",
        "delay": "s",
        "extra_added_mass": "kg m^2",
        "linear_damping": "kg m^2/s",
        "quadratic_damping": "kg m^2",
        "stiffness": "N m",
    },
}
COEFFICIENT_MEANINGS = {
    "gain": "gain",
    "delay": "delay of the accelerometers against the probes",
    "distance": "the model beyond its nominal place",
    "extra_added_mass": "added mass beside the computed one",
    "linear_damping": "linear damping beside the wave damping",
    "quadratic_damping": "quadratic damping",
    "stiffness": "stiffness",
}
DOCUMENTED_DAMPING = {"heave": f"{RIG_DAMPING:g} (rig)", "roll": None}
# the normal distribution's 97.5 % point
TWO_SIDED_95 = 1.96
LEAST_CAMERA_SWAY = 1e-6


def tables(analysis: SectionAnalysis) -> tuple[Table, ...]:
    """Return all tables in the order of the page."""
    return (
        score_table(analysis.heave),
        score_table(analysis.roll),
        coefficient_table(analysis),
        period_table(analysis.heave),
        period_table(analysis.roll),
        separability_table(analysis),
        repeatability_table(analysis),
        coupled_run_table(analysis),
        *((timing_table(analysis),) if analysis.timing_fits else ()),
        *((damping_table(analysis),) if analysis.damping_fits else ()),
        clock_table(analysis),
        spring_table(analysis),
        guide_table(analysis),
        probe_table(analysis),
        wave_table(analysis),
    )


def motion_name(fit: ModeFit) -> str:
    """Return heave or roll."""
    return fit.mode.motion.value


def score_table(fit: ModeFit) -> Table:
    """Return measured and predicted responses, trained and held out."""
    rows: list[TableRow] = []
    for s in sorted(fit.scores, key=lambda s: -s.response.run.period):
        value = fit.mode.measured_response(s.response)
        standing = "trained" if s.is_training else "held out" if s.is_interpolated else "held out, beyond the trained"
        rows.append(
            (s.response.run.name, s.response.run.period, standing, abs(value), float(np.degrees(np.angle(value))),
             s.amplitude_error, s.phase_error)
        )  # fmt: skip
    numbers = 2 * len({s.response.run.period_index for s in fit.scores if s.is_training})
    exactly = " Its unknowns are as many as the trained numbers, which are met exactly." * (
        len(fit.mode.free) == numbers
    )
    what = "measured" if fit.mode is HEAVE else "accelerometers' difference"
    return Table(
        f"{motion_name(fit).capitalize()}: half of the periods train, the others are predicted",
        (
            "run",
            "period [s]",
            "standing",
            f"{what} [m/m]",
            "phase [deg]",
            "amplitude error [%]",
            "phase error [deg]",
        ),
        tuple(rows),
        "Per m of the onward wave at the model. Trained are half of the periods, from the longest to the shortest, "
        "evenly spread; probes, gain, delay, distance and coefficients are frozen before the others are scored, and "
        "the amplitude that sets the quadratic damping is the predicted one. Below 0.9 s heave is small "
        f"and what the accelerometers feel of sway counts.{exactly}",
    )


def coefficient_table(analysis: SectionAnalysis) -> Table:
    """Return estimates on all periods with both kinds of intervals, beside what is documented."""
    rows: list[TableRow] = []
    for fit in (analysis.heave, analysis.roll):
        units, first = UNITS[motion_name(fit)], f"{motion_name(fit)}: "
        for key in fit.mode.free:
            label = f"{first}{COEFFICIENT_MEANINGS[key]} [{units[key] or '1'}]"
            rows.append(
                _coefficient_row(
                    label,
                    getattr(fit.all_periods.oscillator, key),
                    fit.standard_errors[key],
                    fit.all_periods.errors[key],
                )
            )
        added = (
            theory_of_model(fit.mode.motion, 2.0 * np.pi / fit.period).added_mass
            + fit.all_periods.oscillator.extra_added_mass
        )
        label = f"{first}added mass at the natural period [{units['extra_added_mass']}]"
        rows.append(
            _coefficient_row(
                label, added, fit.standard_errors["extra_added_mass"], fit.all_periods.errors["extra_added_mass"]
            )
        )
        off, documented = 1e3 * (fit.period - fit.mode.documented_period), f"{fit.mode.documented_period:g} s"
        rows.append(
            _coefficient_row(
                f"{first}natural period, ms over the documented", off, 1e3 * fit.period_error, None, documented
            )
        )
        label = f"{first}damping beside the wave damping, there, waves 0.024 m high [{units['linear_damping']}]"
        rows.append(
            _coefficient_row(
                label, fit.viscous_damping, fit.viscous_damping_error, None, DOCUMENTED_DAMPING[motion_name(fit)]
            )
        )
        for key, free in fit.extended_fits.items():
            documented = (
                f"{fit.mode.start.stiffness:.4g} (hydrostatic)"
                if key == "stiffness"
                else DOCUMENTED_DAMPING[motion_name(fit)]
            )
            label = f"{first}{COEFFICIENT_MEANINGS[key]}, freed as well [{units[key]}]"
            rows.append(_coefficient_row(label, getattr(free.oscillator, key), None, free.errors[key], documented))
    low, high = SWAY_STIFFNESS
    rows.append(
        _coefficient_row(
            "sway: stiffness of the springs [N/m]",
            analysis.sway_stiffness.mean,
            analysis.sway_stiffness.error,
            None,
            f"{low:g} to {high:g}",
        )
    )
    return Table(
        "Coefficients from all periods",
        ("coefficient", "estimate", "95 % from", "to", "s.e., left out", "s.e., residuals", "documented"),
        tuple(rows),
        "Intervals by leaving each wave period (for the springs each run) out where there is one (jackknife), else "
        "from residuals. The rig's documented damping "
        "is one of sway. Heave's gain is that of the accelerometers against the wave; the camera shows what part of it "
        "is theirs.",
    )


def _coefficient_row(
    label: str, value: float, jackknife_error: float | None, residual_error: float | None, documented: str | None = None
) -> TableRow:
    error = jackknife_error if jackknife_error is not None else residual_error or 0.0
    return (
        label,
        value,
        value - TWO_SIDED_95 * error,
        value + TWO_SIDED_95 * error,
        jackknife_error,
        residual_error,
        documented,
    )


def period_table(fit: ModeFit) -> Table:
    """Return added mass, dampings and excitation at each wave period."""
    rows: list[TableRow] = []
    seen: set[int] = set()
    for s in sorted(fit.scores, key=lambda s: -s.response.run.period):
        run = s.response.run
        if run.period_index in seen:
            continue
        seen.add(run.period_index)
        one, shaped = observation(fit.mode, s.response), fit.all_periods.oscillator
        excitation = abs(one.theory.excitation)
        haskind = haskind_damping(excitation / LENGTH, run.omega) * LENGTH
        rows.append(
            (run.period, one.theory.added_mass + shaped.extra_added_mass, one.theory.damping, haskind,
             shaped.extra_equivalent_damping(one.theory, run.omega, s.response.wave_amplitude), excitation,
             float(np.degrees(np.angle(one.theory.excitation))))
        )  # fmt: skip
    mass, damping, force = ("kg", "kg/s", "N/m") if fit.mode is HEAVE else ("kg m^2", "kg m^2/s", "N m/m")
    return Table(
        f"{motion_name(fit).capitalize()}: coefficients by wave period",
        ("period [s]", f"added mass [{mass}]", f"wave damping [{damping}]", "by Haskind", "beside it",
         f"excitation [{force}]", "phase [deg]"),
        tuple(rows),
        "Potential theory of the documented Lewis form in deep water (Ursell 1949, Tasai 1959 and 1961), added mass "
        "with the fitted constant; damping beside it is the fitted quadratic one at the run's amplitude. Haskind's "
        "relation in two dimensions, b = |X|^2 / (2 rho g c_g) per length, ties wave damping to excitation.",
    )  # fmt: skip


def separability_table(analysis: SectionAnalysis) -> Table:
    """Return the standard error of the added mass without ties."""
    names = ("constant", "linear in frequency", "quadratic in frequency")
    rows: list[TableRow] = [
        (names[order], *(None if not np.isfinite(e) else e for e in errors))
        for order, errors in analysis.untied_errors.items()
    ]
    rows.append(
        (
            "tied by theory (Haskind's relation and the shape)",
            analysis.heave.standard_errors["extra_added_mass"],
            analysis.roll.standard_errors["extra_added_mass"],
        )
    )
    return Table(
        "Added mass without a tie",
        ("added mass, damping, log excitation and its phase are", "heave, standard error [kg]", "roll [kg m^2]"),
        tuple(rows),
        "At one period two numbers are measured and four wanted: nothing separates them. Over all periods it depends "
        "on what is assumed of their course; a dash: not determined at all. "
        "To call everything constant is a tie of its own, and a false one: over these periods theory has added mass "
        "vary by a third and wave damping tenfold.",
    )


def repeatability_table(analysis: SectionAnalysis) -> Table:
    """Return the largest deviation from the mean of repeated runs."""
    rows: list[TableRow] = [(", ".join(r.names), *r.heave, *r.roll) for r in analysis.repeated_runs]
    return Table(
        "Repeated runs",
        ("runs", "heave [%]", "[deg]", "difference of accelerometers [%]", "[deg]"),
        tuple(rows),
        "Largest deviation from the mean. In the sway-heave runs (4...) the difference is no roll but the holding's "
        "compliance and what the accelerometers feel of sway.",
    )


def coupled_run_table(analysis: SectionAnalysis) -> Table:
    """Runs of the other holdings; heave as the sway-heave runs predict it."""
    arm = abs(analysis.roll.all_periods.oscillator.gain)
    rows: list[TableRow] = [
        (r.run.name, r.run.period, abs(r.heave), float(np.degrees(np.angle(r.heave))), amplitude, phase,
         abs(r.roll) / arm, float(np.degrees(np.angle(r.roll * np.sign(analysis.roll.all_periods.oscillator.gain)))),
         r.camera_sway if r.camera_sway > LEAST_CAMERA_SWAY else None)
        for r, amplitude, phase in sorted(analysis.coupled_runs, key=lambda c: (c[0].run.scenario, -c[0].run.period))
    ]  # fmt: skip
    return Table(
        "Coupled runs: sway-heave-roll (3...), and heave in the heave-roll runs (6...)",
        ("run", "period [s]", "heave [m/m]", "[deg]", "predicted [%]", "[deg]", "roll [rad/m]", "[deg]", "sway [m/m]"),
        tuple(rows),
        "Reported, not fitted; predicted is heave, by the oscillator trained on the sway-heave runs. Roll is the "
        "accelerometers' difference over the fitted gain. Sway is the camera's, low where its clock drifts through the "
        "stretch; a dash: the camera is dead.",
    )  # fmt: skip


def timing_table(analysis: SectionAnalysis) -> Table:
    """Return the worst held-out errors with other stretches."""
    rows: list[TableRow] = []
    for timing, heave, roll in ((STEADY_TIMING, analysis.heave, analysis.roll), *analysis.timing_fits):
        rows.append((timing.settling_s, timing.allowed_reflection_s, *largest_errors(heave), *largest_errors(roll)))
    return Table(
        "Other steady stretches",
        ("settling [s]", "of the reflection allowed [s]", "heave [%]", "[deg]", "roll [%]", "[deg]"),
        tuple(rows),
        "Largest errors at held-out periods between trained ones from 0.9 s on; the first row is the choice in force.",
    )


def damping_table(analysis: SectionAnalysis) -> Table:
    """Return the worst held-out errors with other laws of damping."""
    rows: list[TableRow] = [
        (label, *largest_errors(heave), heave.period, *largest_errors(roll), roll.period)
        for label, heave, roll in (("quadratic, in force", analysis.heave, analysis.roll), *analysis.damping_fits)
    ]
    return Table(
        "Other dampings beside the wave damping",
        ("damping", "heave [%]", "[deg]", "natural period [s]", "roll [%]", "[deg]", "natural period [s]"),
        tuple(rows),
        "Largest errors at held-out periods between trained ones from 0.9 s on. That it is quadratic was decided by "
        "fits to all periods, not by the training ones alone; the table shows what the decision is worth.",
    )


def largest_errors(fit: ModeFit, shortest: float = 0.9) -> tuple[float, float]:
    """Largest amplitude and phase error at held-out periods between trained ones; NaN if there are none."""
    held = [s for s in fit.scores if s.is_interpolated and not s.is_training and s.response.run.period >= shortest]
    if not held:
        return float("nan"), float("nan")
    return max(abs(s.amplitude_error) for s in held), max(abs(s.phase_error) for s in held)


# Figures of the study: responses over the wave period, and the two waves of one run.

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
    wave = 0.5 * min(HEIGHTS.values())
    return fit.half_of_periods.oscillator.measured_response(
        MeasuredResponse(omega, float(wavenumber(omega, DEPTH)), wave, 1.0, 1.0, theory)
    )


def _marker_curve(label: str, x: Array, y: Array, marker_size: tuple[float, float]) -> Curve:
    """A diamond about each point."""
    gap = np.full(len(x), np.nan)
    across = np.stack([x - marker_size[0], x, x + marker_size[0], x, x - marker_size[0], gap], axis=1).ravel()
    upward = np.stack([y, y + marker_size[1], y, y - marker_size[1], y, gap], axis=1).ravel()
    return Curve(label, across, upward)
