"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.core.results import Check, Claim
from seatrial_studies.declarations import TIME_IS_NO_VERDICT
from seatrial_studies.meng2014 import model_claims, search_claims
from seatrial_studies.meng2014.evidence import CloudSwarmEvidence
from seatrial_studies.meng2014.model_claims import SINGULAR_CURVATURE
from seatrial_studies.meng2014.reproduction import BoxPlacement
from seatrial_studies.meng2014.search_claims import error_shares
from seatrial_studies.meng2014.unknowns import BEAM_WAVES, ONE_FIN

# limits of our own checks, set beforehand: share within 5 %, ratio of times, relative error without noise, rms of
# errors over the Cramer-Rao bound
MOST_SHARE, LEAST_TIME_RATIO, EXACT_ERROR, BOUND_RATIO_RANGE = 0.5, 50.0, 1e-9, (0.7, 1.3)
# records simulated by ICPSO over those by our fit, each slope counted as one; our choice
LEAST_EVALUATION_RATIO = 50.0


def claims(evidence: CloudSwarmEvidence) -> tuple[Claim, ...]:
    """Return the claims, each with its evidence."""
    return (*search_claims.claims(evidence), *model_claims.claims(evidence))


def checks(evidence: CloudSwarmEvidence) -> tuple[Check, ...]:
    """Ours; each can fail. Both estimates are near the noise: at one heading, few runs order them by chance."""
    ours, flat = evidence.output_error_ratio, evidence.twelve_unknowns.curvatures
    exact = max(float(np.max(np.abs(o.noise_free_errors))) for o in evidence.output_error.values())
    share = error_shares(evidence, BoxPlacement.CENTRED)[0]
    return (
        Check.between("our errors over the Cramer-Rao bound", ours, *BOUND_RATIO_RANGE),
        Check.at_most("the same, not above ICPSO's off centre", ours, evidence.swarm_ratio),
        Check.at_most("our largest relative error, noise-free", exact, EXACT_ERROR),
        *(
            Check.at_most(f"flattest direction of twelve unknowns, {name}", flat[name], SINGULAR_CURVATURE)
            for name in (BEAM_WAVES, ONE_FIN)
        ),
        Check(
            "ICPSO's values within 5 %, ±10 % about the truth, share", share, f"above {MOST_SHARE}", share > MOST_SHARE
        ),
        Check.at_least("ICPSO's time over ours", evidence.time_ratio, LEAST_TIME_RATIO).withdrawn(TIME_IS_NO_VERDICT),
        Check.at_least(
            "records simulated by ICPSO over those by our fit", evidence.simulation_ratio, LEAST_EVALUATION_RATIO
        ),
    )
