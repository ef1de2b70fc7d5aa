"""The misprints of the paper, each with what the print does and what stands in its place."""

from seatrial.core.results import Table
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.audit import FinGainAudit
from seatrial_studies.yu2014.published import CHORD, CHORD_OF_LEVER, INERTIA, TARGET_DEG2
from seatrial_studies.yu2014.published_loop import PREAMPLIFIER_LABELS


def misprint_table(audit: FinGainAudit) -> Table:
    """Return the misprints, one row each."""
    both = [(PREAMPLIFIER_LABELS[r], audit.roll_responses[r], audit.fin_rate_readings[r]) for r in Preamplifier]
    rows = [
        (
            "section 2.2, target variance 150.31 deg²",
            f"22² / (2 ln 5) is {audit.target:.2f}; with ln 5 as 1.61, {audit.target_rounded:.2f}",
            f"{TARGET_DEG2}, as printed",
        ),
        (
            "section 2.3, chord 2.22 m, then 2.2 m",
            f"1.18 / 0.53 = {audit.fin_inertia.chord:.3f} m; I = "
            f"{audit.fin_inertia.inertia:.1f} kg m² with {CHORD_OF_LEVER} in the lever, "
            f"{audit.fin_inertia.consistent_inertia:.1f} with {CHORD} throughout",
            f"{INERTIA} kg m²; with eta it cancels in eq. (7)",
        ),
        (
            "section 2.2, fin rate = fin angle times 1/s",
            "; ".join(f"{words}: {integral:.1f}° s rms, an angle summed up" for words, _, (integral, _) in both),
            "times s: " + "; ".join(f"{rate:.1f}°/s" for _, _, (_, rate) in both),
        ),
        (
            "section 3, selection probabilities over a sum of 3",
            f"those of 50 add up to {audit.roulette_sum:.1f}",
            "the sum over the whole population",
        ),
        (
            "section 2.1, Phi is the open-loop transfer function",
            "without feedback it is G_phi: no gain would matter",
            "G_phi / (1 + L), as the block diagram has it",
        ),
        (
            "eq. (2), J2 = (var - 150.31)²",
            "; ".join(f"{words}: {m.fin**2:.0f} deg², {m.saturation_percent:.0f} % saturated" for words, m, _ in both)
            + "; below the target J2 rewards fin motion",
            "as printed, and one-sided beside",
        ),
        (
            "section 2.2, p substituted in “eq. (2)”",
            "eq. (2) is J2, which has no p",
            "in the share of amplitudes beyond 22°, Rayleigh",
        ),
        ("eq. (3), W without the 1 / (2 pi) of J1", "a factor that eq. (7) divides out", "neither has it"),
        ("eq. (7), sigma with 'max', in words 'the fittest'", "two searches, different answers", "max; best beside"),
        (
            "section 3, step of 0.1 s",
            f"a Runge-Kutta step grows by {audit.runge_kutta_growth:.0f} along the gyro's poles -40 ± 49i",
            "no step: variances in the frequency domain",
        ),
        (
            "section 3, codes",
            f"gains with three decimals need {audit.shortest_code_bits} bits",
            f"{audit.shortest_code_bits}",
        ),
        (
            "section 1, servo 550 / (s² + 15 s + 225)",
            f"{audit.servo_gain:.3f}° of fin for a degree ordered",
            "as printed",
        ),
        (
            "section 1, preamplifier with a lag of 30 s",
            f"P acts on the roll angle: Ms {audit.roll_responses[Preamplifier.PRINTED].Ms:.2f}",
            f"as printed, and as a washout beside: Ms {audit.roll_responses[Preamplifier.WASHOUT].Ms:.2f}",
        ),
    ]
    return Table("Misprints and loose ends, with evidence", ("print", "what it does", "here"), tuple(rows))
