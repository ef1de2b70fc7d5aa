"""Meng et al. 2014: eight coefficients, or twelve with the stiffnesses, in sea state 3 under waves and a fin."""

from seatrial.problems import BenchmarkProblem, PaperClaim
from seatrial_studies.benchmark_problems.heave_pitch import HeavePitchSetting, Judged, heave_pitch_problem
from seatrial_studies.meng2014.reproduction import SEA_STATE_3, SOURCE, WIDE_HALF_WIDTH

# degrees: of the paper's headings the one at which neither motion is small; chosen
_HEADING = 135
# candidates: the paper's swarm of 60 particles in 200 iterations; more change nothing that noise does not decide
_BUDGET = 60 * 200


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem with eight and with twelve unknowns."""
    return tuple(
        heave_pitch_problem(
            f"meng2014-{count}", f"heave and pitch at {_HEADING}°, {count} unknowns, box ±50 % off centre", SOURCE,
            _BUDGET,
            HeavePitchSetting(
                _HEADING, SEA_STATE_3, WIDE_HALF_WIDTH, False, Judged.WHOLE_RECORD, has_noise=True, has_fin=True,
                stiffnesses=has_stiffnesses,
            ),
            (PaperClaim("the cloud improves the accuracy of the swarm", "icpso", "pso"),),
        )
        for count, has_stiffnesses in ((8, False), (12, True))
    )  # fmt: skip
