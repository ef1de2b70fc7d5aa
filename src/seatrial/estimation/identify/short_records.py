"""Records too short or too calm for intervals of the information under a disturbance: profiles, and warnings."""

import numpy as np

from seatrial.core.equations.augment import MEMORY_PREFIX
from seatrial.core.results import Profile
from seatrial.core.text.numbers import significant
from seatrial.core.values import Finding, ProgressReporter, Severity
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.profile import innovation_profiles

FEWEST_MEMORIES = 40.0
"""Memories of a disturbance that records last at least, for intervals of the information to hold; chosen: in fewer too
few intervals of simulated craft hold the truth (`python benchmarks/gusts.py --short`)."""

LONGEST_ADVICE = 10.0
"""Times the duration of the runs that a record is advised to last at most: a memory that calls for more is a quarter of
the runs or longer, and not distinguishable from a slow error of the model; chosen."""

FEWEST_REFERENCE_STEPS = 4
"""Changes of the reference that records of a closed loop contain at least, for the same reason; chosen."""

_LARGEST_SHARE = 0.1
"""Standard error over estimate above which an interval symmetric about the estimate is no longer one of the likelihood:
the standard error grows with the estimate, so that small estimates seem too certain; chosen."""

_MOST_COEFFICIENTS, _MOST_SAMPLES = 6, 10_000
"""Free coefficients and samples up to which profiles are computed without being required: seconds; chosen."""


def short_record_findings(estimation: Estimation, profiles: tuple[Profile, ...]) -> list[Finding]:
    """Return warnings of few memories and few changes of the reference; profiles: behind the intervals, or none."""
    consequence = (
        "intervals come from a profile likelihood and may still be too narrow" if profiles else
        "intervals may be too narrow; --intervals profile gives better ones"
    )  # fmt: skip
    findings, seconds, steps = [], _seconds(estimation), _reference_steps(estimation)
    if _has_few_memories(estimation):
        memory = _longest_memory(estimation)
        missing = FEWEST_MEMORIES * memory - seconds
        advice = f"record at least {significant(missing, 2)} s more, {FEWEST_MEMORIES * memory:.0f} s in all"
        if FEWEST_MEMORIES * memory > LONGEST_ADVICE * seconds:
            advice = (
                "a disturbance with a memory as long as the runs is the model's misfit rather than the sea: free more "
                "coefficients or take a richer model"
            )
        text = f"the records are short compared with the memory of the disturbance: {consequence}"
        evidence = f"{seconds:.0f} s, memory {memory:.3g} s"
        findings.append(Finding(Severity.WARNING, "few-memories", text, evidence, advice))
    if steps is not None and steps < FEWEST_REFERENCE_STEPS:
        findings.append(Finding(Severity.WARNING, "few-reference-steps", f"the reference changes seldom: {consequence}",
                                f"{steps} times in all runs",
                                f"record at least {FEWEST_REFERENCE_STEPS} changes of it"))  # fmt: skip
    return findings


def default_profiles(estimation: Estimation, report_progress: ProgressReporter | None = None) -> tuple[Profile, ...]:
    """Return profiles of the coefficients where the information's intervals do not suffice under a disturbance.

    That is in short records, and where a standard error exceeds a tenth of its estimate. None where no disturbance was
    estimated, and where profiles would take long.
    """
    noise, problem, steps = estimation.process_noise, estimation.estimate.problem, _reference_steps(estimation)
    if noise is None or not estimation.has_process_noise:
        return ()
    errors, values = estimation.interval.standard_error, estimation.estimate.common_parameters
    is_short = _has_few_memories(estimation) or (steps is not None and steps < FEWEST_REFERENCE_STEPS)
    is_vague = bool(np.any((errors > _LARGEST_SHARE * np.abs(values))[: len(problem.free)]))
    is_small = len(problem.free) <= _MOST_COEFFICIENTS and len(problem.data.inputs) <= _MOST_SAMPLES
    if not (is_small and (is_short or is_vague)):
        return ()
    return innovation_profiles(noise, errors, problem.free, report_progress)


def _has_few_memories(estimation: Estimation) -> bool:
    return _seconds(estimation) < FEWEST_MEMORIES * _longest_memory(estimation)


def _longest_memory(estimation: Estimation) -> float:
    """Return the longest memory of the disturbance [s]; 0: it has none."""
    added = estimation.noise_model.added
    return max((t for name, t in added.items() if name.startswith(MEMORY_PREFIX)), default=0.0)


def _seconds(estimation: Estimation) -> float:
    """Return the duration of all runs [s]."""
    data = estimation.estimate.problem.data
    return len(data.inputs) * data.dt


def _reference_steps(estimation: Estimation) -> int | None:
    loop = estimation.noise_model.closed_loop
    return None if loop is None else loop.reference_steps
