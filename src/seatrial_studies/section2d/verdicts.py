"""Claims with their verdicts, and checks; each verdict follows from numbers by a rule that stands here."""

import numpy as np

from seatrial.core.results import Check, Claim, Verdict
from seatrial.physics.hydro import wavenumber
from seatrial_studies.section2d.analysis import SectionAnalysis, camera_gain
from seatrial_studies.section2d.modes import ModeFit, theory_of_model
from seatrial_studies.section2d.responses import (
    AREA_COEFFICIENT,
    DEPTH,
    FORM,
    GM,
    HEIGHTS,
    KG,
    MASS,
    RIG_DAMPING,
    SWAY_STIFFNESS,
    G,
)
from seatrial_studies.section2d.tables import TWO_SIDED_95, largest_errors, motion_name

AMPLITUDE_LIMIT, PHASE_LIMIT, PERIOD_LIMIT = 1.5, 1.5, 1.0
HEIGHT_LIMIT, WAVENUMBER_LIMIT, SEPARABLE_LIMIT, SHAPE_LIMIT = 5.0, 1.0, 20.0, 10.0
LEAST_HEIGHT_PERIOD_S = 0.85
DEAD_CAMERA_RUNS = ("3102_4", "4061_2")


def claims(analysis: SectionAnalysis) -> tuple[Claim, ...]:
    """Return the claims on what is documented of the records."""
    return (
        natural_period_claim(analysis.heave),
        natural_period_claim(analysis.roll),
        sway_stiffness_claim(analysis),
        rig_damping_claim(analysis),
        separability_claim(analysis),
        lewis_form_claim(analysis),
        metacentric_height_claim(analysis),
        wave_heights_claim(analysis),
        wavenumbers_claim(analysis),
        common_clock_claim(analysis),
    )


def natural_period_claim(fit: ModeFit) -> Claim:
    """Confirmed where the estimate lies within 1 %."""
    off = 100.0 * (fit.period / fit.mode.documented_period - 1.0)
    return Claim(
        f"The natural period in {motion_name(fit)} is {fit.mode.documented_period:g} s",
        Verdict.CONFIRMED if abs(off) <= PERIOD_LIMIT else Verdict.REFUTED,
        f"{fit.period:.4f} s from forced motions, 95 % interval ±{TWO_SIDED_95 * fit.period_error:.4f} s by leaving "
        f"each wave period out; off by {off:+.2f} %",
    )


def sway_stiffness_claim(analysis: SectionAnalysis) -> Claim:
    """Confirmed where the 95 % interval meets the documented range; undecidable without two usable runs."""
    low, high = SWAY_STIFFNESS
    mean, half = analysis.sway_stiffness.mean, TWO_SIDED_95 * analysis.sway_stiffness.error
    used = [s for s in analysis.sway_stiffness.runs if s.explained_share > 0.9]
    if not np.isfinite(mean):
        verdict = Verdict.UNKNOWABLE
    else:
        verdict = Verdict.CONFIRMED if mean - half <= high and mean + half >= low else Verdict.REFUTED
    return Claim(
        f"The springs in sway have {low:g} to {high:g} N/m",
        verdict,
        f"{mean:.1f} N/m ±{half:.1f} (95 %, runs left out) from tensions over the camera's sway in {len(used)} runs",
    )


def rig_damping_claim(analysis: SectionAnalysis) -> Claim:
    """Refuted as one number where the damping's exponent of velocity is not 0 within its 95 % interval."""
    found, half = analysis.guide, TWO_SIDED_95 * analysis.guide.error
    claim = f"The rig damps sway with {RIG_DAMPING:g} N s/m"
    if not np.isfinite(found.exponent):
        return Claim(claim, Verdict.UNKNOWABLE, "fewer than three runs sway freely")
    dampings, forces = [f.damping for f in found.runs], [f.force for f in found.runs]
    steady = abs(found.exponent) <= half
    inside = min(dampings) <= RIG_DAMPING <= max(dampings)
    return Claim(
        claim,
        Verdict.REFUTED if not steady else Verdict.CONFIRMED if inside else Verdict.REFUTED,
        f"the holding force in phase with sway velocity is {min(forces):.2f} to {max(forces):.2f} N (median "
        f"{np.median(forces):.2f}), as linear damping {min(dampings):.1f} to {max(dampings):.0f} N s/m. It goes with "
        f"velocity to the power {found.exponent:.2f} ±{half:.2f} (95 %), dry friction (-1) rather than one coefficient "
        f"(0). The documented value is met at about {found.velocity_at_damping(RIG_DAMPING):.3f} m/s",
    )


def separability_claim(analysis: SectionAnalysis) -> Claim:
    """Refuted where the added mass is not known within 20 kg once its course over frequency is free to first order."""
    plain, linear = analysis.untied_errors[0][0], analysis.untied_errors[1][0]
    return Claim(
        "Motions in regular waves identify added mass, damping and excitation without a computed shape",
        Verdict.REFUTED if linear > SEPARABLE_LIMIT else Verdict.CONFIRMED,
        f"at one period nothing separates them; over all periods the standard error of heave's added mass is "
        f"{plain:.1f} kg if all are constant, {linear:.0f} kg if linear in frequency, "
        f"{analysis.untied_errors[2][0]:.0f} kg if quadratic. With Haskind's relation and the shape it is "
        f"{analysis.heave.standard_errors['extra_added_mass']:.1f} kg",
    )


def lewis_form_claim(analysis: SectionAnalysis) -> Claim:
    """Confirmed where the added masses need less than 10 % of correction."""
    texts, worst_share = [], 0.0
    for fit in (analysis.heave, analysis.roll):
        theory = theory_of_model(fit.mode.motion, 2.0 * np.pi / fit.period).added_mass
        share = 100.0 * fit.all_periods.oscillator.extra_added_mass / theory
        worst_share = max(worst_share, abs(share))
        texts.append(f"{motion_name(fit)} {share:+.1f} %")
    return Claim(
        "The section is a Lewis form with the documented beam, draught and mass",
        Verdict.CONFIRMED if worst_share < SHAPE_LIMIT else Verdict.REFUTED,
        f"correction of its computed added mass: {', '.join(texts)}; area coefficient {AREA_COEFFICIENT:.3f}",
    )


def metacentric_height_claim(analysis: SectionAnalysis) -> Claim:
    """Refuted where GM of the form with the documented KG is off by more than 5 %."""
    gm, roll = form_metacentric_height(), analysis.roll.extended_fits["stiffness"]
    weight = MASS * G
    seen, half = roll.oscillator.stiffness / weight, TWO_SIDED_95 * roll.errors["stiffness"] / weight
    return Claim(
        f"GM of {GM:g} m goes with the documented beam, draught and KG",
        Verdict.CONFIRMED if abs(gm / GM - 1.0) <= 0.05 else Verdict.REFUTED,
        f"with KG {KG:g} m they give {gm:.4f} m for the Lewis form; freed, the roll runs give {seen:.4f} "
        f"±{half:.4f} m (95 %), too wide to judge, for they show little more than stiffness over inertia. The "
        "documented GM is kept, and the fitted inertia goes with it",
    )


def form_metacentric_height() -> float:
    """GM [m] of the Lewis form with the documented centre of gravity."""
    return FORM.metacentre - KG


def wave_heights_claim(analysis: SectionAnalysis) -> Claim:
    """Confirmed where the mean of each nominal height is met within 5 %, periods from 0.85 s on."""
    texts, good = [], True
    for key, nominal in HEIGHTS.items():
        off = [
            100.0 * (2.0 * r.wave_amplitude / nominal - 1.0)
            for r in analysis.responses
            if r.run.height_index == key and r.run.period >= LEAST_HEIGHT_PERIOD_S
        ]
        if off:
            texts.append(
                f"{nominal:g} m: {np.mean(off):+.1f} % ({min(off):+.1f} to {max(off):+.1f} %, {len(off)} runs)"
            )
            good &= bool(abs(np.mean(off)) <= HEIGHT_LIMIT)
    return Claim(
        "The waves are 0.024 and 0.040 m high",
        Verdict.UNKNOWABLE if not texts else Verdict.CONFIRMED if good else Verdict.REFUTED,
        "onward wave at the model, periods from 0.85 s on; " + "; ".join(texts),
    )


def wavenumbers_claim(analysis: SectionAnalysis) -> Claim:
    """Refuted where a listed wave number is off by more than 1 % at the flume's depth."""
    rows = sorted({(r.nominal.omega, r.nominal.wavenumber) for r in analysis.runs})
    off = {2.0 * np.pi / w: 100.0 * (k / float(wavenumber(w, DEPTH)) - 1.0) for w, k in rows}
    worst_first = sorted(off.items(), key=lambda item: -abs(item[1]))
    texts = " and ".join(f"{error:+.1f} % at {period:.2f} s" for period, error in worst_first[:2])
    return Claim(
        "The wave numbers listed with the periods hold in the flume",
        Verdict.REFUTED if abs(worst_first[0][1]) > WAVENUMBER_LIMIT else Verdict.CONFIRMED,
        f"they are omega^2/g; at {DEPTH:g} m depth they are off by {texts}, less at shorter periods",
    )


def common_clock_claim(analysis: SectionAnalysis) -> Claim:
    """Refuted where the camera's clock drifts by more than 1 ms per s in some run or camera channels are dead."""
    drift = max((abs(c.clock_drift) for c in analysis.clocks.values()), default=0.0)
    dead = sorted({f.message.split(":")[0] for f in analysis.dead_channel_findings})
    return Claim(
        "All channels of a run share one clock and one scale",
        Verdict.REFUTED if drift > 1e-3 or dead else Verdict.CONFIRMED,
        f"the camera drifts by up to {1e3 * drift:.0f} ms per s against the accelerometers, which show heave "
        f"{camera_gain(analysis)[0]:.2f} times the camera's"
        + (f"; its channels are dead in {' and '.join(dead)}" if dead else ""),
    )


def checks(analysis: SectionAnalysis) -> tuple[Check, ...]:
    """Return the checks of our own numbers against limits set beforehand."""
    rows = []
    for fit in (analysis.heave, analysis.roll):
        amplitude, phase = largest_errors(fit)
        off = abs(100.0 * (fit.period / fit.mode.documented_period - 1.0))
        rows += [
            (f"{motion_name(fit)}, held-out periods from 0.9 s on, amplitude [%]", amplitude, AMPLITUDE_LIMIT),
            (f"{motion_name(fit)}, held-out periods from 0.9 s on, phase [deg]", phase, PHASE_LIMIT),
            (f"{motion_name(fit)}, natural period off the documented [%]", off, PERIOD_LIMIT),
        ]
    low, high = SWAY_STIFFNESS
    half = TWO_SIDED_95 * analysis.sway_stiffness.error
    meets = bool(analysis.sway_stiffness.mean - half <= high and analysis.sway_stiffness.mean + half >= low)
    dead = {f.message.split(":")[0] for f in analysis.dead_channel_findings}
    known = {r.name for r in analysis.runs} & set(DEAD_CAMERA_RUNS)
    return (
        *(Check(what, value, limit, bool(value <= limit)) for what, value, limit in rows),
        Check("sway stiffness [N/m]", analysis.sway_stiffness.mean, f"{low:g} to {high:g} within its interval", meets),
        Check(
            "runs with dead camera channels",
            float(len(dead)),
            f"among them {', '.join(sorted(known)) or 'none'}",
            known <= dead,
        ),
    )
