"""Tables of the study."""

import numpy as np

from seatrial.core.results import Table
from seatrial.physics.hydro.multipoles import haskind_damping
from seatrial_studies.section2d import tank
from seatrial_studies.section2d.instruments import clock_table, guide_table, probe_table, spring_table, wave_table
from seatrial_studies.section2d.modes import HEAVE, ModeFit, observed, theory_at
from seatrial_studies.section2d.numbers import Numbers
from seatrial_studies.section2d.runs import STEADY

Row = tuple[str | float | None, ...]
UNITS = {
    "heave": {
        "gain": "",
        "delay": "s",
        "distance": "m",
        "added": "kg",
        "linear": "kg/s",
        "quadratic": "kg/m",
        "stiffness": "N/m",
    },
    "roll": {
        "gain": "m",
        "delay": "s",
        "added": "kg m^2",
        "linear": "kg m^2/s",
        "quadratic": "kg m^2",
        "stiffness": "N m",
    },
}
MEANING = {
    "gain": "gain",
    "delay": "delay of the accelerometers against the probes",
    "distance": "the model beyond its nominal place",
    "added": "added mass beside the computed one",
    "linear": "linear damping beside the wave damping",
    "quadratic": "quadratic damping",
    "stiffness": "stiffness",
}
DAMPING = {"heave": f"{tank.RIG_DAMPING:g} (rig)", "roll": None}
TWO_SIDED_95 = 1.96
LEAST_SEEN = 1e-6


def tables(made: Numbers) -> tuple[Table, ...]:
    """All tables, in the order of the page."""
    return (
        scores(made.heave),
        scores(made.roll),
        coefficients(made),
        by_period(made.heave),
        by_period(made.roll),
        separability(made),
        repeatability(made),
        coupled(made),
        *((timings(made),) if made.timings else ()),
        *((dampings(made),) if made.dampings else ()),
        clock_table(made),
        spring_table(made),
        guide_table(made),
        probe_table(made),
        wave_table(made),
    )


def name(fit: ModeFit) -> str:
    """heave or roll."""
    return fit.mode.motion.value


def scores(fit: ModeFit) -> Table:
    """Measured and predicted responses, trained and held out."""
    rows: list[Row] = []
    for s in sorted(fit.scores, key=lambda s: -s.response.run.period):
        value = fit.mode.measured(s.response)
        standing = "trained" if s.trained else "held out" if s.between else "held out, beyond the trained"
        rows.append(
            (s.response.run.name, s.response.run.period, standing, abs(value), float(np.degrees(np.angle(value))),
             s.amplitude, s.phase)
        )  # fmt: skip
    numbers = 2 * len({s.response.run.index for s in fit.scores if s.trained})
    exactly = " Its unknowns are as many as the trained numbers, which are met exactly." * (
        len(fit.mode.free) == numbers
    )
    what = "measured" if fit.mode is HEAVE else "accelerometers' difference"
    return Table(
        f"{name(fit).capitalize()}: half of the periods train, the others are predicted",
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
        "the amplitude that sets the quadratic damping is the predicted one. Below .9 s heave is small "
        f"and what the accelerometers feel of sway counts.{exactly}",
    )


def coefficients(made: Numbers) -> Table:
    """Estimates on all periods with both kinds of intervals, beside what is documented."""
    rows: list[Row] = []
    for fit in (made.heave, made.roll):
        units, first = UNITS[name(fit)], f"{name(fit)}: "
        for key in fit.mode.free:
            label = f"{first}{MEANING[key]} [{units[key] or '1'}]"
            rows.append(_row(label, getattr(fit.whole.oscillator, key), fit.errors[key], fit.whole.errors[key]))
        added = theory_at(fit.mode.motion, 2.0 * np.pi / fit.period).added + fit.whole.oscillator.added
        label = f"{first}added mass at the natural period [{units['added']}]"
        rows.append(_row(label, added, fit.errors["added"], fit.whole.errors["added"]))
        off, told = 1e3 * (fit.period - fit.mode.documented), f"{fit.mode.documented:g} s"
        rows.append(_row(f"{first}natural period, ms over the documented", off, 1e3 * fit.period_error, None, told))
        label = f"{first}damping beside the wave damping, there, waves .024 m high [{units['linear']}]"
        rows.append(_row(label, fit.beside, fit.beside_error, None, DAMPING[name(fit)]))
        for key, free in fit.freed.items():
            told = f"{fit.mode.start.stiffness:.4g} (hydrostatic)" if key == "stiffness" else DAMPING[name(fit)]
            label = f"{first}{MEANING[key]}, freed as well [{units[key]}]"
            rows.append(_row(label, getattr(free.oscillator, key), None, free.errors[key], told))
    low, high = tank.SWAY_STIFFNESS
    rows.append(
        _row(
            "sway: stiffness of the springs [N/m]", made.springs.mean, made.springs.error, None, f"{low:g} to {high:g}"
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


def _row(label: str, value: float, jack: float | None, white: float | None, documented: str | None = None) -> Row:
    error = jack if jack is not None else white or 0.0
    return (label, value, value - TWO_SIDED_95 * error, value + TWO_SIDED_95 * error, jack, white, documented)


def by_period(fit: ModeFit) -> Table:
    """Added mass, dampings and excitation at each wave period."""
    rows: list[Row] = []
    seen: set[int] = set()
    for s in sorted(fit.scores, key=lambda s: -s.response.run.period):
        run = s.response.run
        if run.index in seen:
            continue
        seen.add(run.index)
        one, shaped = observed(fit.mode, s.response), fit.whole.oscillator
        excitation = abs(one.theory.excitation)
        haskind = haskind_damping(excitation / tank.LENGTH, run.omega) * tank.LENGTH
        rows.append(
            (run.period, one.theory.added + shaped.added, one.theory.damping, haskind,
             shaped.equivalent_damping(one.theory, run.omega, s.response.wave), excitation,
             float(np.degrees(np.angle(one.theory.excitation))))
        )  # fmt: skip
    mass, damping, force = ("kg", "kg/s", "N/m") if fit.mode is HEAVE else ("kg m^2", "kg m^2/s", "N m/m")
    return Table(
        f"{name(fit).capitalize()}: coefficients by wave period",
        ("period [s]", f"added mass [{mass}]", f"wave damping [{damping}]", "by Haskind", "beside it",
         f"excitation [{force}]", "phase [deg]"),
        tuple(rows),
        "Potential theory of the documented Lewis form in deep water (Ursell 1949, Tasai 1959 and 1961), added mass "
        "with the fitted constant; damping beside it is the fitted quadratic one at the run's amplitude. Haskind's "
        "relation in two dimensions, b = |X|^2 / (2 rho g c_g) per length, ties wave damping to excitation.",
    )  # fmt: skip


def separability(made: Numbers) -> Table:
    """Standard error of the added mass without ties."""
    names = ("constant", "linear in frequency", "quadratic in frequency")
    rows: list[Row] = [
        (names[order], *(None if not np.isfinite(e) else e for e in errors)) for order, errors in made.untied.items()
    ]
    rows.append(
        ("tied by theory (Haskind's relation and the shape)", made.heave.errors["added"], made.roll.errors["added"])
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


def repeatability(made: Numbers) -> Table:
    """Largest deviation from the mean of repeated runs."""
    rows: list[Row] = [(", ".join(r.names), *r.heave, *r.roll) for r in made.repeats]
    return Table(
        "Repeated runs",
        ("runs", "heave [%]", "[deg]", "difference of accelerometers [%]", "[deg]"),
        tuple(rows),
        "Largest deviation from the mean. In the sway-heave runs (4...) the difference is no roll but the holding's "
        "compliance and what the accelerometers feel of sway.",
    )


def coupled(made: Numbers) -> Table:
    """Runs of the other holdings; heave as the sway-heave runs predict it."""
    arm = abs(made.roll.whole.oscillator.gain)
    rows: list[Row] = [
        (r.run.name, r.run.period, abs(r.heave), float(np.degrees(np.angle(r.heave))), amplitude, phase,
         abs(r.roll) / arm, float(np.degrees(np.angle(r.roll * np.sign(made.roll.whole.oscillator.gain)))),
         r.camera_sway if r.camera_sway > LEAST_SEEN else None)
        for r, amplitude, phase in sorted(made.coupled, key=lambda c: (c[0].run.scenario, -c[0].run.period))
    ]  # fmt: skip
    return Table(
        "Coupled runs: sway-heave-roll (3...), and heave in the heave-roll runs (6...)",
        ("run", "period [s]", "heave [m/m]", "[deg]", "predicted [%]", "[deg]", "roll [rad/m]", "[deg]", "sway [m/m]"),
        tuple(rows),
        "Reported, not fitted; predicted is heave, by the oscillator trained on the sway-heave runs. Roll is the "
        "accelerometers' difference over the fitted gain. Sway is the camera's, low where its clock drifts through the "
        "stretch; a dash: the camera is dead.",
    )  # fmt: skip


def timings(made: Numbers) -> Table:
    """Worst held-out errors had the stretch been another."""
    rows: list[Row] = []
    for timing, heave, roll in ((STEADY, made.heave, made.roll), *made.timings):
        rows.append((timing.settling, timing.allowed, *worst(heave), *worst(roll)))
    return Table(
        "Other steady stretches",
        ("settling [s]", "of the reflection allowed [s]", "heave [%]", "[deg]", "roll [%]", "[deg]"),
        tuple(rows),
        "Largest errors at held-out periods between trained ones from .9 s on; the first row is the choice in force.",
    )


def dampings(made: Numbers) -> Table:
    """Worst held-out errors had another law of damping been chosen."""
    rows: list[Row] = [
        (label, *worst(heave), heave.period, *worst(roll), roll.period)
        for label, heave, roll in (("quadratic, in force", made.heave, made.roll), *made.dampings)
    ]
    return Table(
        "Other dampings beside the wave damping",
        ("damping", "heave [%]", "[deg]", "natural period [s]", "roll [%]", "[deg]", "natural period [s]"),
        tuple(rows),
        "Largest errors at held-out periods between trained ones from .9 s on. That it is quadratic was decided by "
        "fits to all periods, not by the training ones alone; the table shows what the decision is worth.",
    )


def worst(fit: ModeFit, shortest: float = 0.9) -> tuple[float, float]:
    """Largest amplitude and phase error at held-out periods between trained ones; NaN if there are none."""
    held = [s for s in fit.scores if s.between and not s.trained and s.response.run.period >= shortest]
    if not held:
        return float("nan"), float("nan")
    return max(abs(s.amplitude) for s in held), max(abs(s.phase) for s in held)
