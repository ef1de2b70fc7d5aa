"""Qi et al. 2025: eight coefficients at three headings, by one sample an iteration or by the whole record."""

from seatrial.problems import BenchmarkProblem, PaperClaim
from seatrial_studies.benchmark_problems.heave_pitch import HeavePitchSetting, Judged, heave_pitch_problem
from seatrial_studies.published_ship import HEADINGS, SIGNIFICANT_HEIGHT
from seatrial_studies.qi2025.published import SOURCE
from seatrial_studies.qi2025.reproduction import ITERATIONS, NARROW_HALF_WIDTH, WIDE_HALF_WIDTH

# candidates of the paper's searches: a population of 40 in 200 iterations
_BUDGET = 40 * ITERATIONS
_CLAIMS = (
    PaperClaim("IWHO is far more accurate than WHO", "iwho", "who"),
    PaperClaim("PSO is far less accurate than IWHO", "iwho", "pso"),
    PaperClaim("PSO is less accurate than WHO", "who", "pso"),
)


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return three settings at each heading of the tables."""
    return tuple(problem for heading in HEADINGS for problem in _settings(heading))


def _settings(heading: int) -> tuple[BenchmarkProblem, ...]:
    settings = {
        "paper": (NARROW_HALF_WIDTH, True, Judged.ONE_SAMPLE, "box ±10 %, one sample an iteration"),
        "off-centre": (WIDE_HALF_WIDTH, False, Judged.ONE_SAMPLE, "box ±50 % off centre, one sample an iteration"),
        "whole": (WIDE_HALF_WIDTH, False, Judged.WHOLE_RECORD, "box ±50 % off centre, whole record with noise"),
    }
    return tuple(
        heave_pitch_problem(
            f"qi2025-{heading}-{name}", f"heave and pitch at {heading}°, {words}", SOURCE, _BUDGET,
            HeavePitchSetting(
                heading, SIGNIFICANT_HEIGHT, width, is_centred, judged, has_noise=judged is Judged.WHOLE_RECORD
            ),
            _CLAIMS,
        )
        for name, (width, is_centred, judged, words) in settings.items()
    )  # fmt: skip
