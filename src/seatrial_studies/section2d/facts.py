"""Facts of the page, by the keys under which the rows of `study.toml` name them."""

from collections.abc import Callable

import numpy as np

from seatrial.core.results import Curve
from seatrial.core.values import Array
from seatrial.physics.hydro import haskind_damping, wavenumber
from seatrial_studies.section2d.analysis import SectionAnalysis, camera_gain
from seatrial_studies.section2d.modes import HEAVE, MeasuredResponse, ModeFit, observation, theory_of_model
from seatrial_studies.section2d.responses import (
    AREA_COEFFICIENT,
    DEPTH,
    FIRST_PROBE_TO_MODEL,
    FORM,
    GM,
    HEIGHTS,
    KG,
    LENGTH,
    MASS,
    PROBES,
    RIG_DAMPING,
    STEADY_TIMING,
    SWAY_STIFFNESS,
    G,
    Timing,
)
from seatrial_studies.study_page import Facts, FactTable

FACTS = FactTable[SectionAnalysis]()
TableRow = tuple[str | float | None, ...]
# the normal distribution's 97.5 % point
TWO_SIDED_95 = 1.96
UNITS = {
    "heave": {
        "gain": "1", "delay": "s", "distance": "m", "extra_added_mass": "kg", "linear_damping": "kg/s",
        "quadratic_damping": "kg/m", "stiffness": "N/m", "excitation": "N/m",
    },
    "roll": {
        "gain": "m", "delay": "s", "extra_added_mass": "kg m^2", "linear_damping": "kg m^2/s",
        "quadratic_damping": "kg m^2", "stiffness": "N m", "excitation": "N m/m",
    },
}  # fmt: skip
MEANINGS = {
    "gain": "gain",
    "delay": "delay of the accelerometers against the probes",
    "distance": "the model beyond its nominal place",
    "extra_added_mass": "added mass beside the computed one",
    "linear_damping": "linear damping beside the wave damping",
    "quadratic_damping": "quadratic damping",
    "stiffness": "stiffness",
}
# s, shortest periods of a documented wave height and of a check; m/m, least sway that a camera shows; share of a
# regression that is explained where it is used
LEAST_HEIGHT_PERIOD_S, LEAST_CHECK_PERIOD_S, LEAST_CAMERA_SWAY, USED_SHARE = 0.85, 0.9, 1e-6, 0.9
DEAD_CAMERA_RUNS = ("3102_4", "4061_2")
# points of a drawn curve, size of a marker as a share of the axis
POINTS, MARKER_SIZE = 60, 0.012


def _motion(fit: ModeFit) -> str:
    return fit.mode.motion.value


def _degrees(response: complex) -> float:
    return float(np.degrees(np.angle(response)))


def largest_errors(fit: ModeFit, shortest: float = LEAST_CHECK_PERIOD_S) -> tuple[float, float]:
    """Largest amplitude and phase error at held-out periods between trained ones; NaN if there are none."""
    held = [s for s in fit.scores if s.is_interpolated and not s.is_training and s.response.run.period >= shortest]
    if not held:
        return float("nan"), float("nan")
    return max(abs(s.amplitude_error) for s in held), max(abs(s.phase_error) for s in held)


@FACTS.declare
def modes(analysis: SectionAnalysis) -> list[Facts]:
    """Natural periods beside the documented ones, and the largest errors at held-out periods."""
    groups = []
    for fit in (analysis.heave, analysis.roll):
        amplitude, phase = largest_errors(fit)
        off = 100.0 * (fit.period / fit.mode.documented_period - 1.0)
        groups.append(
            {
                "motion": _motion(fit),
                "documented_period": fit.mode.documented_period,
                "period": fit.period,
                "period_half": TWO_SIDED_95 * fit.period_error,
                "period_off": off,
                "period_distance": abs(off),
                "amplitude_error": amplitude,
                "phase_error": phase,
            }
        )
    return groups


@FACTS.declare
def springs(analysis: SectionAnalysis) -> Facts:
    """Sway stiffness run by run, its mean and interval."""
    stiffness, (low, high) = analysis.sway_stiffness, SWAY_STIFFNESS
    half = TWO_SIDED_95 * stiffness.error
    rows: list[TableRow] = [
        (s.run, s.lower, s.upper, s.explained_share, 1e3 * s.delay, 1e3 * s.drift) for s in stiffness.runs
    ]
    rows += [
        (name, size, None, None, None, None)
        for name, size in (("mean of the runs used", stiffness.mean), ("standard error", stiffness.error))
    ]
    return {
        "mean": stiffness.mean,
        "half": half,
        "used": sum(s.explained_share > USED_SHARE for s in stiffness.runs),
        "is_known": np.isfinite(stiffness.mean),
        "meets_range": bool(stiffness.mean - half <= high and stiffness.mean + half >= low),
        "rows": rows,
    }


@FACTS.declare
def guide(analysis: SectionAnalysis) -> Facts:
    """The force in the sway guide run by run, and its power of velocity."""
    fitted = analysis.guide
    forces, dampings = [f.force for f in fitted.runs], [f.damping for f in fitted.runs]
    return {
        "usable": len(fitted.runs),
        "exponent": fitted.exponent,
        "exponent_distance": abs(fitted.exponent),
        "half": TWO_SIDED_95 * fitted.error,
        "forces": forces,
        "median_force": float(np.median(forces)),
        "least_damping": min(dampings, default=np.nan),
        "largest_damping": max(dampings, default=np.nan),
        "velocity": fitted.velocity_at_damping(RIG_DAMPING),
        "rows": [
            (f.run, f.velocity, f.damping, f.force, f.third_harmonic_ratio)
            for f in sorted(fitted.runs, key=lambda f: -f.velocity)
        ],
    }


@FACTS.declare
def separability(analysis: SectionAnalysis) -> Facts:
    """Standard errors of the added mass without ties, by what is assumed of its course."""
    names = ("constant", "linear in frequency", "quadratic in frequency")
    heave = [analysis.untied_errors[order][0] for order in range(len(names))]
    tied = [fit.standard_errors["extra_added_mass"] for fit in (analysis.heave, analysis.roll)]
    return {
        "constant": heave[0],
        "linear": heave[1],
        "quadratic": heave[2],
        "tied": tied[0],
        "rows": [
            *(
                (names[order], *(error if np.isfinite(error) else None for error in errors))
                for order, errors in analysis.untied_errors.items()
            ),
            ("tied by theory (Haskind's relation and the shape)", *tied),
        ],
    }


@FACTS.declare
def form(analysis: SectionAnalysis) -> Facts:
    """The Lewis form: corrections of its added mass, per cent, and GM by the form and by the roll runs."""
    corrections = {
        _motion(fit): 100.0 * fit.all_periods.oscillator.extra_added_mass / _natural_added_mass(fit)
        for fit in (analysis.heave, analysis.roll)
    }
    roll, weight = analysis.roll.extended_fits["stiffness"], MASS * G
    form_GM = form_metacentric_height()
    return {
        "corrections": corrections,
        "largest_correction": max(map(abs, corrections.values())),
        "area_coefficient": AREA_COEFFICIENT,
        "form_GM": form_GM,
        "GM_distance": abs(form_GM / GM - 1.0),
        "seen_GM": roll.oscillator.stiffness / weight,
        "GM_half": TWO_SIDED_95 * roll.errors["stiffness"] / weight,
    }


def _natural_added_mass(fit: ModeFit) -> float:
    return theory_of_model(fit.mode.motion, 2.0 * np.pi / fit.period).added_mass


def form_metacentric_height() -> float:
    """GM [m] of the Lewis form with the documented centre of gravity."""
    return FORM.metacentre - KG


@FACTS.declare
def heights(analysis: SectionAnalysis) -> Facts:
    """Wave heights over the nominal ones, per cent off, periods from 0.85 s on."""
    deviations = {
        nominal: [
            100.0 * (2.0 * r.wave_amplitude / nominal - 1.0)
            for r in analysis.responses
            if r.run.height_index == key and r.run.period >= LEAST_HEIGHT_PERIOD_S
        ]
        for key, nominal in HEIGHTS.items()
    }
    by_height = [
        {"nominal": nominal, "mean": float(np.mean(off)), "off": off, "count": len(off)}
        for nominal, off in deviations.items()
        if off
    ]
    return {
        "by_height": by_height,
        "distances": [abs(each["mean"]) for each in by_height],
        "is_unknown": not by_height,
    }


@FACTS.declare
def wavenumbers(analysis: SectionAnalysis) -> Facts:
    """Listed wave numbers against those at the flume's depth, the farthest off first."""
    listed = {(r.nominal.omega, r.nominal.wavenumber) for r in analysis.runs}
    off = [
        {"period": 2.0 * np.pi / omega, "error": 100.0 * (k / float(wavenumber(omega, DEPTH)) - 1.0)}
        for omega, k in sorted(listed)
    ]
    first, second, *_ = sorted(off, key=lambda each: -abs(each["error"]))
    return {"first": first, "second": second, "largest": abs(first["error"])}


@FACTS.declare
def clocks(analysis: SectionAnalysis) -> Facts:
    """The camera against the accelerometers, run by run, and runs whose camera is dead."""
    cameras = analysis.clocks
    dead = sorted({f.message.split(":")[0] for f in analysis.dead_channel_findings})
    expected = sorted({r.name for r in analysis.runs} & set(DEAD_CAMERA_RUNS))
    return {
        "drift": 1e3 * max((abs(c.clock_drift) for c in cameras.values()), default=0.0),
        "gain": camera_gain(analysis)[0],
        "dead": dead,
        "dead_count": float(len(dead)),
        "known": expected,
        "known_are_dead": set(expected) <= set(dead),
        "rows": [
            *((name, 1e3 * c.delay, 1e3 * c.clock_drift, 1e3 * c.delay_scatter, c.gain) for name, c in cameras.items()),
            *((name, None, None, None, None) for name in dead),
        ],
    }


@FACTS.declare
def scores(analysis: SectionAnalysis) -> list[Facts]:
    """Measured and predicted responses, trained and held out."""
    return [_scores(fit) for fit in (analysis.heave, analysis.roll)]


def _scores(fit: ModeFit) -> Facts:
    rows: list[TableRow] = []
    for s in sorted(fit.scores, key=lambda s: -s.response.run.period):
        measured, run = fit.mode.measured_response(s.response), s.response.run
        standing = "trained" if s.is_training else "held out" if s.is_interpolated else "held out, beyond the trained"
        cells = (abs(measured), _degrees(measured), s.amplitude_error, s.phase_error)
        rows.append((run.name, run.period, standing, *cells))
    numbers = 2 * len({s.response.run.period_index for s in fit.scores if s.is_training})
    return {
        "Motion": _motion(fit).capitalize(),
        "channel": "measured" if fit.mode.motion is HEAVE.motion else "accelerometers' difference",
        "is_exact": len(fit.mode.free) == numbers,
        "rows": rows,
    }


@FACTS.declare
def coefficients(analysis: SectionAnalysis) -> Facts:
    """Estimates on all periods with both kinds of intervals, beside what is documented."""
    stiffness, low_to_high = analysis.sway_stiffness, f"{SWAY_STIFFNESS[0]:g} to {SWAY_STIFFNESS[1]:g}"
    springs = _coefficient("sway: stiffness of the springs [N/m]", stiffness.mean, stiffness.error, None, low_to_high)
    return {"rows": [*_mode_coefficients(analysis.heave), *_mode_coefficients(analysis.roll), springs]}


def _mode_coefficients(fit: ModeFit) -> list[TableRow]:
    name, estimates, errors = _motion(fit), fit.all_periods, fit.standard_errors
    units, rig = UNITS[name], f"{RIG_DAMPING:g} (rig)" if fit.mode.motion is HEAVE.motion else None
    mass = _natural_added_mass(fit) + estimates.oscillator.extra_added_mass
    off, period = 1e3 * (fit.period - fit.mode.documented_period), f"{fit.mode.documented_period:g} s"
    beside = f"{name}: damping beside the wave damping, there, waves 0.024 m high [{units['linear_damping']}]"
    hydrostatic = f"{fit.mode.start.stiffness:.4g} (hydrostatic)"
    return [
        *(
            _coefficient(
                f"{name}: {MEANINGS[key]} [{units[key]}]", getattr(estimates.oscillator, key), errors[key],
                estimates.errors[key],
            )
            for key in fit.mode.free
        ),
        _coefficient(
            f"{name}: added mass at the natural period [{units['extra_added_mass']}]", mass,
            errors["extra_added_mass"], estimates.errors["extra_added_mass"],
        ),
        _coefficient(f"{name}: natural period, ms over the documented", off, 1e3 * fit.period_error, None, period),
        _coefficient(beside, fit.viscous_damping, fit.viscous_damping_error, None, rig),
        *(
            _coefficient(
                f"{name}: {MEANINGS[key]}, freed as well [{units[key]}]", getattr(free.oscillator, key), None,
                free.errors[key], hydrostatic if key == "stiffness" else rig,
            )
            for key, free in fit.extended_fits.items()
        ),
    ]  # fmt: skip


def _coefficient(
    label: str, size: float, jackknife_error: float | None, residual_error: float | None, documented: str | None = None
) -> TableRow:
    error = jackknife_error if jackknife_error is not None else residual_error or 0.0
    half = TWO_SIDED_95 * error
    return label, size, size - half, size + half, jackknife_error, residual_error, documented


@FACTS.declare
def by_period(analysis: SectionAnalysis) -> list[Facts]:
    """Added mass, dampings and excitation at each wave period."""
    return [_by_period(fit) for fit in (analysis.heave, analysis.roll)]


def _by_period(fit: ModeFit) -> Facts:
    units, shaped = UNITS[_motion(fit)], fit.all_periods.oscillator
    scores = sorted(fit.scores, key=lambda s: -s.response.run.period)
    first_of = {s.response.run.period_index: s.response for s in reversed(scores)}
    rows = []
    for response in dict(reversed(first_of.items())).values():
        run, theory = response.run, observation(fit.mode, response).theory
        excitation = abs(theory.excitation)
        beside = shaped.extra_equivalent_damping(theory, run.omega, response.wave_amplitude)
        haskind = haskind_damping(excitation / LENGTH, run.omega) * LENGTH
        mass = theory.added_mass + shaped.extra_added_mass
        rows.append((run.period, mass, theory.damping, haskind, beside, excitation, _degrees(theory.excitation)))
    return {
        "Motion": _motion(fit).capitalize(),
        "mass": units["extra_added_mass"],
        "damping": units["linear_damping"],
        "force": units["excitation"],
        "rows": rows,
    }


@FACTS.declare
def repeated(analysis: SectionAnalysis) -> Facts:
    """The largest deviation from the mean of repeated runs."""
    return {"rows": [(", ".join(r.names), *r.heave, *r.roll) for r in analysis.repeated_runs]}


@FACTS.declare
def coupled(analysis: SectionAnalysis) -> Facts:
    """Runs of the other holdings; heave as the sway-heave runs predict it."""
    gain = analysis.roll.all_periods.oscillator.gain
    runs = sorted(analysis.coupled_runs, key=lambda c: (c[0].run.scenario, -c[0].run.period))
    return {
        "rows": [
            (
                r.run.name, r.run.period, abs(r.heave), _degrees(r.heave), amplitude, phase, abs(r.roll) / abs(gain),
                _degrees(r.roll * np.sign(gain)), r.camera_sway if r.camera_sway > LEAST_CAMERA_SWAY else None,
            )
            for r, amplitude, phase in runs
        ]
    }  # fmt: skip


@FACTS.declare
def stretches(analysis: SectionAnalysis) -> Facts:
    """The largest held-out errors with other steady stretches."""
    fits: list[tuple[Timing, ModeFit, ModeFit]] = [
        (STEADY_TIMING, analysis.heave, analysis.roll),
        *analysis.timing_fits,
    ]
    return {
        "is_full": analysis.timing_fits,
        "rows": [
            (timing.settling_s, timing.allowed_reflection_s, *largest_errors(heave), *largest_errors(roll))
            for timing, heave, roll in fits
        ],
    }


@FACTS.declare
def dampings(analysis: SectionAnalysis) -> Facts:
    """The largest held-out errors with other laws of damping."""
    fits = [("quadratic, in force", analysis.heave, analysis.roll), *analysis.damping_fits]
    return {
        "is_full": analysis.damping_fits,
        "rows": [
            (label, *largest_errors(heave), heave.period, *largest_errors(roll), roll.period)
            for label, heave, roll in fits
        ],
    }


@FACTS.declare
def probes(analysis: SectionAnalysis) -> Facts:
    """Places and gains of the probes, and the model's place."""
    places = analysis.probes
    names = [f"WP_{name[-1]}" for name in PROBES]
    place = FIRST_PROBE_TO_MODEL + analysis.heave.half_of_periods.oscillator.distance
    model = ("model (the distance fitted with heave included)", place, None)
    each = zip(names, places.positions.tolist(), places.gains.tolist(), strict=True)
    return {"misfit": places.misfit, "rows": [*each, model]}


@FACTS.declare
def waves(analysis: SectionAnalysis) -> Facts:
    """Waves at the model, run by run."""
    return {
        "rows": [
            (
                r.run.name, r.run.period, r.period_count, 2e3 * r.wave_amplitude,
                2e3 * r.wave_amplitude / (1e3 * HEIGHTS[r.run.height_index]), r.paddle_ratio, r.reflected_ratio,
                r.transmitted_ratio,
            )
            for r in analysis.responses
            if r.run.height_index in HEIGHTS
        ]
    }  # fmt: skip


@FACTS.declare
def responses(analysis: SectionAnalysis) -> list[Facts]:
    """Amplitude and phase of heave and roll over the wave period, computed in waves of the smaller nominal height."""
    groups = []
    for fit in (analysis.heave, analysis.roll):
        name = _motion(fit).capitalize()
        size = _response_curves(fit, lambda response: float(abs(response)))
        groups.append({"title": f"{name} over the wave period", "unit": "amplitude [m/m]", "curves": size})
        groups.append({"title": f"{name}: phase", "unit": "phase [deg]", "curves": _response_curves(fit, _degrees)})
    return groups


def _response_curves(fit: ModeFit, component: Callable[[complex], float]) -> list[Curve]:
    periods = np.array([s.response.run.period for s in fit.scores])
    smooth = np.linspace(periods.min(), periods.max(), POINTS)
    computed = np.array([component(_computed_response(fit, float(p))) for p in smooth])
    measured = np.array([component(fit.mode.measured_response(s.response)) for s in fit.scores])
    trained = np.array([s.is_training for s in fit.scores])
    size = (MARKER_SIZE * float(np.ptp(smooth)), 1.6 * MARKER_SIZE * float(np.ptp(computed)))
    return [
        Curve("computed", smooth, computed),
        _markers("trained", periods[trained], measured[trained], size),
        _markers("held out", periods[~trained], measured[~trained], size),
    ]


def _computed_response(fit: ModeFit, period: float) -> complex:
    omega = 2.0 * np.pi / period
    theory = theory_of_model(fit.mode.motion, omega, fit.mode.sign)
    wave = 0.5 * min(HEIGHTS.values())
    return fit.half_of_periods.oscillator.measured_response(
        MeasuredResponse(omega, float(wavenumber(omega, DEPTH)), wave, 1.0, 1.0, theory)
    )


def _markers(label: str, x: Array, y: Array, size: tuple[float, float]) -> Curve:
    """A diamond about each point."""
    gap = np.full(len(x), np.nan)
    across = np.stack([x - size[0], x, x + size[0], x, x - size[0], gap], axis=1).ravel()
    upward = np.stack([y, y + size[1], y, y - size[1], y, gap], axis=1).ravel()
    return Curve(label, across, upward)


@FACTS.declare
def example_waves(analysis: SectionAnalysis) -> Facts:
    """Onward and back at the model in one run, with the steady stretch."""
    run, parts = analysis.example_waves
    start, stop = run.steady_window(STEADY_TIMING)
    edge = 1.1 * float(np.max(np.abs(parts.incident)))
    frame = Curve("steady stretch", np.array([start, start, stop, stop]), 1e3 * np.array([-edge, edge, edge, -edge]))
    pair = (("onward", parts.incident), ("back", parts.reflected))
    return {"run": run.name, "curves": [*(Curve(name, run.record.time, 1e3 * each) for name, each in pair), frame]}
