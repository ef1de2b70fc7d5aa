"""What the instruments say of one another: findings, and the tables of clocks, springs and probes."""

import numpy as np

from seatrial.core.results import Table
from seatrial.core.values import Finding, Severity
from seatrial_studies.section2d import tank
from seatrial_studies.section2d.analysis import SectionAnalysis, is_long_enough

TableRow = tuple[str | float | None, ...]
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


def clock_table(analysis: SectionAnalysis) -> Table:
    """Return the camera run by run."""
    rows: list[TableRow] = [
        (name, 1e3 * c.delay, 1e3 * c.clock_drift, 1e3 * c.delay_scatter, c.gain) for name, c in analysis.clocks.items()
    ]
    rows += [
        (name, None, None, None, None)
        for name in sorted({f.message.split(":")[0] for f in analysis.dead_channel_findings})
    ]
    return Table(
        "The camera against the accelerometers, in heave",
        ("run", "delay of the camera [ms]", "drift [ms/s]", "scatter [ms]", "accelerometers / camera"),
        tuple(rows),
        "From the phase at the wave frequency in sliding windows of two periods, delays modulo the period; dashes: "
        "the camera is dead. Phases are therefore taken from the accelerometers.",
    )


def spring_table(analysis: SectionAnalysis) -> Table:
    """Sway stiffness run by run."""
    springs = analysis.sway_stiffness
    rows: list[TableRow] = [
        (s.run, s.lower, s.upper, s.explained_share, 1e3 * s.delay, 1e3 * s.drift) for s in springs.runs
    ]
    rows.append(("mean of the runs used", springs.mean, None, None, None, None))
    rows.append(("standard error", springs.error, None, None, None, None))
    return Table(
        "Sway stiffness: difference of both spring tensions over the camera's sway",
        ("run", "tension on sway [N/m]", "sway on tension [N/m]", "explained", "delay [ms]", "drift [ms/s]"),
        tuple(rows),
        f"Documented {tank.SWAY_STIFFNESS[0]:g} to {tank.SWAY_STIFFNESS[1]:g} N/m. Used are runs with more than nine "
        "tenths explained; noise on the camera lowers the first regression and not the second, so the mean is that of "
        "their geometric means.",
    )


def guide_table(analysis: SectionAnalysis) -> Table:
    """Return the force in the sway guide run by run."""
    rows: list[TableRow] = [
        (f.run, f.velocity, f.damping, f.force, f.third_harmonic_ratio)
        for f in sorted(analysis.guide.runs, key=lambda f: -f.velocity)
    ]
    return Table(
        "The sway guide: holding force in phase with sway velocity",
        ("run", "velocity [m/s]", "as linear damping [N s/m]", "force [N]", "third harmonic / first"),
        tuple(rows),
        f"The damping goes with velocity to the power {analysis.guide.exponent:.2f} "
        f"±{1.96 * analysis.guide.error:.2f} (95 %, "
        "runs left out): 0 would be linear, -1 is dry friction, whose third harmonic is a third of the first. Sway is "
        "taken from the springs.",
    )


def probe_table(analysis: SectionAnalysis) -> Table:
    """Places and gains."""
    probes = analysis.probes
    rows: list[TableRow] = [
        (f"WP_{name[-1]}", float(x), float(g))
        for name, x, g in zip(tank.PROBES, probes.positions, probes.gains, strict=True)
    ]
    rows.append(
        (
            "model (the distance fitted with heave included)",
            tank.FIRST_PROBE_TO_MODEL + _place_correction(analysis),
            None,
        )
    )
    return Table(
        "Wave probes",
        ("probe", "place [m beyond WP_1]", "gain"),
        tuple(rows),
        "Not documented: places and gains are those that let one wave onward and one back explain the probes, ramps "
        f"and all, in the runs that train heave; {100.0 * probes.misfit:.1f} % of the amplitude remain.",
    )


def wave_table(analysis: SectionAnalysis) -> Table:
    """Waves at the model, run by run."""
    rows: list[TableRow] = [
        (
            r.run.name,
            r.run.period,
            r.period_count,
            2e3 * r.wave_amplitude,
            2e3 * r.wave_amplitude / (1e3 * tank.HEIGHTS[r.run.height_index]),
            r.paddle_ratio,
            r.reflected_ratio,
            r.transmitted_ratio,
        )
        for r in analysis.responses
        if r.run.height_index in tank.HEIGHTS
    ]
    return Table(
        "Waves at the model",
        (
            "run",
            "period [s]",
            "periods used",
            "height [mm]",
            "/ nominal",
            "amplitude / stroke",
            "back / onward",
            "beyond / onward",
        ),
        tuple(rows),
        "The onward wave is what excites the model; the nominal heights are 0.024 and 0.040 m.",
    )


def _place_correction(analysis: SectionAnalysis) -> float:
    return analysis.heave.half_of_periods.oscillator.distance
