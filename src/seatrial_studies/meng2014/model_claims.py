"""Claims of the model, the law and the record, each verdict by a rule on numbers."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial.core.text import significant
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence, error_text
from seatrial_studies.meng2014.reproduction import SwarmAlgorithm
from seatrial_studies.meng2014.unknowns import BEAM_WAVES, ONE_FIN, WAVES_AND_FIN
from seatrial_studies.seaway import HEAVE_NOISE, PITCH_NOISE

# relative curvature below which a direction is lost in rounding
SINGULAR_CURVATURE = 1e-11
# relative error below which a coefficient counts as found without noise; our choice
FOUND_ERROR = 1e-4


def claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """What the paper says of unknowns, law and record."""
    return (
        twelve_unknowns_claim(evidence),
        velocity_law_claim(evidence),
        coinciding_curves_claim(evidence),
        theory_as_truth_claim(),
    )


def twelve_unknowns_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Held in waves with a fin, where all twelve are found; refuted where even these leave a direction open."""
    flat, errors = evidence.twelve_unknowns.curvatures, evidence.twelve_unknowns.errors
    beam, fin, both = (flat[name] for name in (BEAM_WAVES, ONE_FIN, WAVES_AND_FIN))
    text = (
        f"waves and a moving fin together identify twelve (flattest direction {significant(both, 1)} of the steepest), "
        f"and our fit finds all of them without noise within {significant(max(errors.values()), 1)} at all five "
        f"headings; beam waves alone could not ({significant(beam, 1)}), nor one fin alone ({significant(fin, 1)}). "
        "The paper lists twelve and searches eight, the stiffnesses being taken from theory. Box, noise and sea are "
        "assumed"
    )
    claim = "Twelve parameters are to be identified"
    if both < SINGULAR_CURVATURE or max(errors.values()) > FOUND_ERROR:
        return Claim(claim, Verdict.REFUTED, text)
    if max(beam, fin) < SINGULAR_CURVATURE:
        return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, "waves and a moving fin together, both known")
    return Claim(claim, Verdict.CONFIRMED, text)


def velocity_law_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where most runs by the law as printed end above the least fitness."""
    printed = evidence.reproduction.unweighted_searches
    stuck = evidence.is_stuck(printed)
    return Claim(
        "The velocity law is eq. (4)",
        Verdict.REFUTED if np.mean(stuck) > 0.5 else Verdict.UNKNOWABLE,
        "it has no inertia weight, while eq. (6) adjusts one. As printed, with c1 = c2 = 2.05, velocities do not die "
        f"out: {stuck.sum()} of {stuck.size} runs end above the least fitness, the mean error off centre is "
        f"{error_text(printed)}, with the weight "
        f"{error_text(evidence.off_centre(SwarmAlgorithm.ICPSO))}{_less_by_chance(evidence)}. Eq. (6) "
        "itself is lost; ours is of the kind ascribed to Wei et al. 2009, unverified",
    )


def _less_by_chance(evidence: CloudSwarmEvidence) -> str:
    """Return the headings at which the law as printed has the smaller error, though its fitness is worse."""
    printed, weighted = evidence.reproduction.unweighted_searches, evidence.off_centre(SwarmAlgorithm.ICPSO)
    less = [f"{h}°" for h, f in printed.items() if np.mean(f.mean_error) < np.mean(weighted[h].mean_error)]
    return f"; smaller as printed at {', '.join(less)}, where noise decides and the fitness is worse" if less else ""


def coinciding_curves_claim(evidence: CloudSwarmEvidence) -> Claim:
    """Refuted where coefficients more than 10 % off move the ship by less than the noise from the true motion."""
    wrong = 100.0 * np.abs(evidence.undetected_change.relative_change)
    worst = COEFFICIENTS[int(np.argmax(wrong))]
    heave, pitch = evidence.undetected_change.heave_rms, evidence.undetected_change.pitch_rms
    hidden = wrong.max() > 10.0 and heave <= HEAVE_NOISE and pitch <= np.degrees(PITCH_NOISE)
    return Claim(
        "Curves that coincide (figures 2, 3) show that the dynamics are described accurately",
        Verdict.REFUTED if hidden else Verdict.UNKNOWABLE,
        f"with coefficients up to {wrong.max():.0f} % off ({worst}) the motion at 135° differs from the true one by "
        f"{100 * heave:.1f} cm and {pitch:.3f}° rms; the noise is {100 * HEAVE_NOISE:.0f} cm and "
        f"{np.degrees(PITCH_NOISE):.2f}°. To the eye that is within the noise; a fit of the whole record separates "
        "them",
    )


def theory_as_truth_claim() -> Claim:
    """Undecidable: nothing is printed."""
    return Claim(
        "Theoretical values at 0, 45, 90, 135 and 180° serve as truth",
        Verdict.UNKNOWABLE,
        "they are not printed; assumed are those of Qi et al. 2025, which has none at 0 and 45°: there those of 90°. "
        "The table 'Assumed' lists what else is",
    )
