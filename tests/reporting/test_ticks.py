"""Every tick of a first screen can be absent, and every sentence that most results print has one that does not."""

import math
from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_study import fabricated_study
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin
from tests.reporting.test_campaign import fabricated_campaign
from tests.reporting.test_key_facts import with_windows
from tests.reporting.test_verification import LEGS, TURNS

from seatrial.core.results import Comparison, Design, Fit, Study
from seatrial.core.results.campaign import CampaignSummary
from seatrial.core.results.tuning import Tuning
from seatrial.core.results.verification import Verification
from seatrial.core.values import Finding, Severity
from seatrial.numerics.optimise import Status
from seatrial.reporting import campaign, comparison, design, key_facts, study, tuning, tuning_text, verification
from seatrial.reporting.page import sections
from seatrial.reporting.section import KeyFact, Level, Section

Result = Fit | Tuning | Design | Verification | CampaignSummary | Comparison | Study
WARNING = Finding(Severity.WARNING, "lag", "a warning")


def facts(result: Result) -> tuple[KeyFact, ...]:
    match result:
        case Fit():
            return key_facts.key_facts(result)
        case Tuning():
            return tuning_text.key_facts(result)
        case Design():
            return design.key_facts(result)
        case Verification():
            return verification.key_facts(result)
        case CampaignSummary():
            return campaign.first_screen(result).facts
        case Comparison():
            return comparison.first_screen(result).facts
        case Study():
            return study.first_screen(result).facts


def clean_fit() -> Fit:
    """A fit of which every row is good."""
    fit = complete_fit(fabricated_fit())
    scored = with_windows(replace(fit, findings=(), noise_model=None), 1.0, 3.0)
    (p,) = scored.validation
    assert fit.identifiability is not None
    complete = replace(fit.identifiability, effective_parameters=sum(not c.fixed for c in fit.coefficients))
    runs = tuple(replace(q, half_width={}, measures={}) if q is p else q for q in scored.predictions)
    return replace(scored, predictions=runs, identifiability=complete)


def held(fit: Fit, **changes: object) -> Fit:
    """The fit with its held-out run changed."""
    runs = tuple(replace(p, **changes) if p.role == "validation" else p for p in fit.predictions)
    return replace(fit, predictions=runs)


def uncovered(fit: Fit, channel: str) -> Fit:
    """The fit whose run, simulated whole, leaves the band of a channel for a third of the time."""
    (p,) = fit.validation
    apart = np.abs(p.measured[channel] - p.simulated[channel])
    return held(fit, half_width={channel: np.full(len(apart), float(np.quantile(apart, 0.67)))})


def unknown_sign(fit: Fit) -> Fit:
    first, *others = fit.coefficients
    around_zero = replace(first, lower=-abs(first.estimate), upper=2.0 * abs(first.estimate))
    return replace(fit, coefficients=(around_zero, *others))


def outside(fit: Fit) -> Fit:
    first, *others = fit.coefficients
    return replace(fit, coefficients=(replace(first, truth=2.0 * first.estimate), *others))


def diverged(result: Design) -> Design:
    errors = result.designed.sampled_relative_error.copy()
    errors[1] = np.nan
    return replace(result, designed=replace(result.designed, sampled_relative_error=errors))


def missed(made: Design, which: int) -> Design:
    confirmation = made.confirmation
    assert confirmation is not None
    errors = confirmation.error.copy()
    errors[which] *= 2.0
    return replace(made, confirmation=replace(confirmation, error=errors))


def strayed(result: Design) -> Design:
    far = np.full(len(result.designed.sampled_distance), 121.0)
    return replace(result, designed=replace(result.designed, sampled_distance=far))


def drawn(result: Tuning, draws: int, stable: int) -> Tuning:
    assert result.track is not None and result.station is not None
    corner = replace(result.track.corner, draws=draws, stable_draws=stable)
    trial = replace(result.station.trial, draws=draws, stable_draws=stable)
    return replace(result, track=replace(result.track, corner=corner), station=replace(result.station, trial=trial))


def clean_fin() -> Tuning:
    """A fin of which every row is good."""
    fin = fabricated_fin()
    better = replace(fin.paired_differences[0])
    held_ships = replace(fin.robustness[0], stable_draws=1000, draws_Ms=1.5)
    slots = tuple(replace(s, is_feasible=True) for s in fin.schedule)
    return replace(fin, paired_differences=(better,), robustness=(held_ships,), schedule=slots, findings=())


def clean_autopilot() -> Tuning:
    return drawn(fabricated_autopilot(), 100, 100)


def robustness(fin: Tuning, **changes: object) -> Tuning:
    return replace(fin, robustness=(replace(fin.robustness[0], **changes),))


def paired(fin: Tuning, lower: float, upper: float) -> Tuning:
    return replace(fin, paired_differences=(replace(fin.paired_differences[0], lower=lower, upper=upper),))


def clean_study() -> Study:
    made = fabricated_study(complete_fit(fabricated_fit()))
    return replace(made, checks=made.checks[:1], findings=())


QUIET_LEGS = replace(
    LEGS, quantities=(replace(LEGS.quantities[0], is_inside=True),),
    corrections=(replace(LEGS.corrections[0], is_moved=False),),
)  # fmt: skip

CLEAN: dict[str, Callable[[], Result]] = {
    "fit": clean_fit,
    "fin": clean_fin,
    "autopilot": clean_autopilot,
    "design": lambda: replace(fabricated_design(), findings=()),
    "verification": lambda: QUIET_LEGS,
    "campaign": lambda: replace(fabricated_campaign(), failures=(), findings=()),
    "comparison": lambda: replace(fabricated_comparison(), changes=(), findings=()),
    "study": clean_study,
}
PLANTED: list[tuple[str, str, Callable[..., Result]]] = [
    ("fit", "Closest baseline", lambda fit: with_windows(fit, 3.0, 1.0)),
    ("fit", "Inside 95 % intervals", lambda fit: with_windows(fit, 1.0, 3.0, inside=0.8)),
    ("fit", "Inside 95 % intervals", lambda fit: uncovered(fit, "psi")),
    ("fit", "Inside 95 % intervals", lambda fit: uncovered(fit, "x0")),
    ("fit", "Identifiability", unknown_sign),
    ("fit", "Identifiability",
     lambda fit: replace(fit, identifiability=replace(fit.identifiability, effective_parameters=2.0))),
    ("fit", "Identifiability", lambda fit: replace(fit, solution=replace(fit.solution, status=Status.STALLED))),
    ("fit", "Known values", outside),
    ("fit", "Warnings", lambda fit: replace(fit, findings=(WARNING,))),
    ("fit", "Warnings", lambda fit: replace(fit, solution=replace(fit.solution, status=Status.STALLED))),
    ("fin", "Margins", lambda fin: replace(fin, chosen=replace(fin.chosen, violated=("Ms 2.3, 2 allowed",)))),
    ("fin", "Margins", lambda fin: replace(fin, constraints=replace(fin.constraints, Ms=math.inf))),
    ("fin", "Other ships", lambda fin: robustness(fin, corners_Ms=2.01)),
    ("fin", "Other ships", lambda fin: robustness(fin, stable_draws=999)),
    ("fin", "Compared", lambda fin: paired(fin, -0.01, 0.02)),
    ("fin", "Compared", lambda fin: paired(fin, -0.02, -0.01)),
    ("fin", "Schedule", lambda fin: replace(fin, schedule=fabricated_fin().schedule)),
    ("fin", "Warnings", lambda fin: replace(fin, findings=(WARNING,))),
    ("autopilot", "Margins",
     lambda pilot: replace(pilot, chosen=replace(pilot.chosen, violated=("Ms 1.8, 1.7 allowed",)))),
    *(("autopilot", name, lambda pilot, n=n: drawn(pilot, n, n - (n > 0)))
      for name in ("Track", "Station") for n in (0, 100)),
    ("autopilot", "Warnings", lambda pilot: replace(pilot, findings=(WARNING,))),
    ("design", "Simulated trials", lambda made: missed(made, 3)),
    ("design", "Limits", strayed),
    ("design", "Limits", diverged),
    ("design", "Warnings", lambda made: replace(made, findings=(WARNING,))),
    ("verification", "Inside", lambda v: replace(v, quantities=LEGS.quantities)),
    ("verification", "Inside", lambda v: replace(v, quantities=())),
    ("verification", "Model", lambda v: replace(v, corrections=LEGS.corrections)),
    ("verification", "Model", lambda _: TURNS),
    ("verification", "Warnings", lambda v: replace(v, findings=(WARNING,))),
    ("campaign", "Failures", lambda c: replace(c, failures=fabricated_campaign().failures)),
    ("campaign", "Failures", lambda c: replace(c, status=replace(c.status, done=0))),
    ("campaign", "Warnings", lambda c: replace(c, findings=(WARNING,))),
    ("comparison", "What else changed", lambda c: replace(c, changes=("particulars: d 0.71 → 0.55",))),
    ("comparison", "Warnings", lambda c: replace(c, findings=(WARNING,))),
    ("study", "Checks", lambda made: replace(made, checks=fabricated_study(clean_fit()).checks)),
    ("study", "Checks", lambda made: replace(made, checks=fabricated_study(clean_fit()).checks[2:])),
    ("study", "Warnings", lambda made: replace(made, findings=(WARNING,))),
]  # fmt: skip


def good(result: Result) -> set[str]:
    return {fact.name for fact in facts(result) if fact.is_good}


@pytest.mark.parametrize(("kind", "name", "plant"), PLANTED)
def test_a_tick_is_absent_where_its_fault_is_planted(kind: str, name: str, plant: Callable[..., Result]) -> None:
    clean = CLEAN[kind]()
    assert name in good(clean)
    assert name not in good(plant(clean))


@pytest.mark.parametrize("kind", CLEAN)
def test_every_tick_has_a_planted_fault(kind: str) -> None:
    every = {fact.name for fact in facts(CLEAN[kind]())}
    assert good(CLEAN[kind]()) <= {name for planted, name, _ in PLANTED if planted == kind} <= every


def sentences(parts: Iterable[Section]) -> set[str]:
    """What sections say on the terminal besides their tables and notes."""
    texts = set[str]()
    for part in parts:
        if part.level is Level.NORMAL:
            texts |= {*map(str, (*part.sentences, *part.points)), *sentences(part.parts)}
    return texts


def test_no_sentence_is_printed_with_every_result_of_its_kind() -> None:
    """The helmsman's card aside, whose orders stand above how they are to be read."""
    whole = complete_fit(fabricated_fit())
    bare = replace(whole, predictions=(), coefficients=(), offsets=(), findings=(), identifiability=None, roll=None)
    assert not sentences(sections(whole)) & sentences(sections(bare))
    assert not sentences(tuning.sections(fabricated_fin())) & sentences(tuning.sections(fabricated_bare()))
    first, other = fabricated_design(), replace(fabricated_design(), confirmation=None, baselines=(), findings=())
    first_parts, other_parts = ([s for s in design.sections(d) if s.key != "orders"] for d in (first, other))
    assert not sentences(first_parts) & sentences(other_parts)
