"""The chapter on identifiability: what the records determine and what they do not; nothing is computed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import (
    CandidateModel,
    Consequence,
    Direction,
    Fit,
    Identifiability,
    NoiseModel,
    Stability,
    Symmetry,
)
from seatrial.core.text.numbers import DASH, p_value, rounded, signed_percent, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import NOT_MEASURED, display_unit
from seatrial.core.values.notation import channel_meaning, channel_unit, unit_text
from seatrial.reporting.coefficient_uses import WELL_DETERMINED, CoefficientUse, coefficient_uses, meaning_lines
from seatrial.reporting.correlations import strong_partners
from seatrial.reporting.disturbance_table import DisturbanceRow, disturbance_rows
from seatrial.reporting.figures.directions import direction_chart, profile_chart
from seatrial.reporting.posterior_part import PosteriorPart, posterior_part
from seatrial.reporting.record_gaps import RecordGap, record_gaps
from seatrial.reporting.tables import assumption

# relative standard deviation up to which a combination is well determined, and up to which poorly
POORLY_DETERMINED = 1.0
# how a result names the criterion that simulates runs whole
_OUTPUT_ERROR = "output error"
LEAST_MISFIT = 0.01  # rise of chi^2 below which it is called 0: a tenth of a standard error, squared
LEAST_SHIFT = 5e-4  # relative change of an estimate that is named: 0.1 % when rounded
# entries of each kind that are shown unfolded
MAX_SHIFTS, MAX_TEXTS, MAX_ROWS, MAX_DIRECTIONS = 5, 5, 12, 16


@dataclass(frozen=True)
class SymmetryRow:
    """A change that no record shows, and what is assumed of its parameters; `has_no_assumption`: nothing is."""

    text: str
    assumptions: tuple[str, ...]
    more_assumptions: tuple[str, ...]
    has_no_assumption: bool


@dataclass(frozen=True)
class AccuracyClass:
    """How many combinations are well, poorly or not determined; `key` names the colour."""

    key: str
    title: str
    text: str


@dataclass(frozen=True)
class ConsequenceRow:
    """What a wrong assumed value would do."""

    parameter: str
    change: str
    shifts: str
    misfit: str


@dataclass(frozen=True)
class NoiseRow:
    """Noise of a state or channel in the unit people read."""

    name: str
    meaning: str
    value: str
    unit: str


@dataclass(frozen=True)
class NoiseText:
    """Criterion, whiteness and intensities.

    is_whole_run: residuals are those of runs simulated whole, into which process noise has gone.
    """

    method: str
    text: str
    whiteness: str
    process: tuple[NoiseRow, ...]
    quiet_states: str
    measurement: tuple[NoiseRow, ...]
    is_whole_run: bool
    candidates: tuple[DisturbanceRow, ...]
    closed_loop: str
    waves: str
    has_disturbance: bool


@dataclass(frozen=True)
class CandidateModelRow:
    """One model of the family; `standing`: tied, worse or failed, and whether it is used."""

    name: str
    free: int
    heading: str
    position: str
    roll: str
    standing: str
    note: str
    is_chosen: bool


@dataclass(frozen=True)
class IdentifiabilityChapter:
    """Everything the chapter shows; empty parts are left out of the page."""

    is_examined: bool
    structural: tuple[SymmetryRow, ...]
    determined_sentence: str
    meaning: tuple[tuple[str, str], ...]
    gaps: tuple[RecordGap, ...]
    uses: tuple[CoefficientUse, ...]
    more_uses: tuple[CoefficientUse, ...]
    accuracy_classes: tuple[AccuracyClass, ...]
    accuracy_note: str
    directions: Markup
    weakest: tuple[str, ...]
    weaker: tuple[str, ...]
    more_directions: str
    condition: str
    consequences: tuple[ConsequenceRow, ...]
    stability: str
    stability_condition: str
    noise: NoiseText | None
    profiles: Markup
    unbounded: str
    posterior: PosteriorPart | None
    models: tuple[CandidateModelRow, ...]
    has_notes: bool
    is_roll: bool


def identifiability_chapter(fit: Fit) -> IdentifiabilityChapter | None:
    """Return the chapter; None where the fit contains nothing of it."""
    identifiability = fit.identifiability
    if identifiability is None and fit.noise_model is None and not fit.candidate_models:
        return None
    content = identifiability or Identifiability((), (), math.nan, math.nan)
    names = [c.name for c in fit.coefficients]
    basis = math.inf if fit.interval_basis is None else fit.interval_basis.degrees_of_freedom
    strong = strong_partners(fit.model.parameters.free_names, fit.covariance, basis)
    uses = coefficient_uses(fit.coefficients, content, strong)
    texts = tuple(sentence(d.text, names) for d in content.directions if d.standard_deviation >= WELL_DETERMINED)
    return IdentifiabilityChapter(
        is_examined=identifiability is not None,
        structural=tuple(_symmetry_row(s, fit, names) for s in content.structural),
        determined_sentence=determined_sentence(fit),
        meaning=meaning_lines(fit, content, uses),
        gaps=record_gaps(fit),
        uses=uses[:MAX_ROWS],
        more_uses=uses[MAX_ROWS:],
        accuracy_classes=_accuracy_classes(content.directions),
        accuracy_note=_accuracy_note(content),
        directions=Markup(svg(direction_chart(content.directions[:MAX_DIRECTIONS]))),
        weakest=texts[:MAX_TEXTS],
        weaker=texts[MAX_TEXTS:],
        more_directions=_more_directions(content.directions[MAX_DIRECTIONS:]),
        condition=rounded(content.condition) if math.isfinite(content.condition) else "",
        consequences=tuple(_consequence_row(c, fit) for c in content.consequences),
        stability=_stability_sentence(content.stability, names) if content.stability else "",
        stability_condition="craft returns to a straight course at equal orders of its thrusters"
        if fit.model.has_thrusters
        else "ship returns to a straight course with the rudder amidships",
        noise=_noise_text(fit.noise_model, names) if fit.noise_model else None,
        profiles=Markup(svg(profile_chart(content.profiles, {c.name: c.unit for c in fit.coefficients}))),
        unbounded=_unbounded_sentence(content),
        posterior=None if fit.posterior is None else posterior_part(fit.posterior),
        models=tuple(_model_row(m) for m in fit.candidate_models),
        has_notes=any(m.note for m in fit.candidate_models),
        is_roll=any(m.roll_deg is not None for m in fit.candidate_models),
    )


def determined_sentence(fit: Fit) -> str:
    """Return what the records determine: combinations of coefficients, and whose signs they leave open.

    A sign is open where the 95 % interval contains 0. Empty where that is not known.
    """
    identifiability = fit.identifiability
    free = [c for c in fit.coefficients if not c.fixed]
    if identifiability is None or not math.isfinite(identifiability.effective_parameters):
        return ""
    number, vague = round(identifiability.effective_parameters), [c.name for c in free if c.is_sign_open]
    if number >= len(free):
        tied = {name for symmetry in identifiability.structural for name in symmetry.parameters}
        held = [c.name for c in fit.coefficients if c.fixed and c.name in tied]
        every = f"all {len(free)} free coefficients" if len(free) > 1 else "the free coefficient"
        text = f"The records determine {every}{f', given {_held_text(fit, held)}' if held else ''}."
    else:
        rest = "; the priors give the others" if any(c.prior_mean is not None for c in free) else ""
        text = f"The records determine about {number} of {len(free)} combinations of the free coefficients{rest}."
    signs = "signs" if len(vague) > 1 else "sign"
    return f"{text} The {signs} of {enumeration(vague)} {'are' if len(vague) > 1 else 'is'} open." if vague else text


def _held_text(fit: Fit, names: Sequence[str]) -> str:
    """Values that were held, those that nobody measured apart: ``the stated m and the estimated I_z``."""
    unmeasured = {c.name for c in fit.coefficients if c.is_unmeasured}
    stated, estimated = ([n for n in names if (n in unmeasured) is which] for which in (False, True))
    parts = (("stated", stated), ("estimated", estimated))
    return " and ".join(f"the {word} {enumeration(group)}" for word, group in parts if group)


def _symmetry_row(s: Symmetry, fit: Fit, names: Sequence[str]) -> SymmetryRow:
    inside = sorted((c for c in fit.coefficients if c.name in s.parameters), key=lambda c: not c.fixed)
    assumed = tuple(text for text in (assumption(c) for c in inside) if text)
    has_no_assumption = bool(inside) and not assumed
    return SymmetryRow(sentence(s.text, names), assumed[:MAX_TEXTS], assumed[MAX_TEXTS:], has_no_assumption)


def _accuracy_classes(items: Sequence[Direction]) -> tuple[AccuracyClass, ...]:
    if not items:
        return ()
    spreads = [d.standard_deviation for d in items]
    well = sum(s < WELL_DETERMINED for s in spreads)
    vague = sum(WELL_DETERMINED <= s < POORLY_DETERMINED for s in spreads)
    rest = len(items) - well - vague
    return (
        AccuracyClass("well", "Well determined", f"{counted(well, 'combination')}, to better than 10 %"),
        AccuracyClass("vague", "Poorly determined", f"{counted(vague, 'combination')}, to between 10 % and 100 %"),
        AccuracyClass("not", "Not determined", f"{counted(rest, 'combination')}, to no better than 100 %"
             + (": their values come from priors or assumptions" if rest else "")),
    )  # fmt: skip


def _accuracy_note(content: Identifiability) -> str:
    """Return why classes and first sentence count differently; empty where they agree."""
    known = sum(d.standard_deviation < POORLY_DETERMINED for d in content.directions)
    if not math.isfinite(content.effective_parameters) or known == round(content.effective_parameters):
        return ""
    return (
        "Counted by how exactly the records have them, without the priors; the first sentence of this chapter counts "
        "of each the share that comes from the records and not from its prior (MacKay 1992), and so differs."
    )


def _more_directions(rest: Sequence[Direction]) -> str:
    if not rest:
        return ""
    worst = 100.0 * max(d.standard_deviation for d in rest)
    number = counted(len(rest), "further combination").capitalize()
    return f"{number} not drawn, {significant(worst, 2)} % or better."


def _consequence_row(c: Consequence, fit: Fit) -> ConsequenceRow:
    is_guess = any(coefficient.is_unmeasured for coefficient in fit.coefficients if coefficient.name == c.parameter)
    parameter = f"{c.parameter} ({NOT_MEASURED})" if is_guess else c.parameter
    is_open = {coefficient.name for coefficient in fit.coefficients if coefficient.is_sign_open}
    changes = ((n, x) for n, x in c.estimate_changes.items() if n not in is_open and abs(x) >= LEAST_SHIFT)
    largest = list(changes)[:MAX_SHIFTS]
    moves = ", ".join(f"{name} {signed_percent(move)}" for name, move in largest)
    misfit = significant(c.misfit, 2) if c.misfit >= LEAST_MISFIT else "0"
    return ConsequenceRow(parameter, signed_percent(c.change), moves or DASH, misfit)


def _stability_sentence(s: Stability, names: Sequence[str]) -> str:
    value = f"C = {significant(s.index, 2)} [{significant(s.lower, 2)}, {significant(s.upper, 2)}]"
    return f"{sentence(s.text, names)} {value}.".strip()


def _noise_text(d: NoiseModel, names: Sequence[str]) -> NoiseText:
    p, values = p_value(d.whiteness_p), "innovations" if d.disturbance != "none" else "residuals"
    if not math.isfinite(d.whiteness_p):
        whiteness = ""
    elif d.is_white:
        whiteness = f"The {values} are white in every channel (Ljung-Box with 20 and 100 lags, {p})."
    else:
        whiteness = (
            f"The {values} are not white (Ljung-Box with 20 and 100 lags, {p}): they contain model error or "
            "disturbances that this criterion does not describe."
        )
    active = {state: q for state, q in d.process.items() if q > 0}
    quiet = [state for state in d.process if state not in active]
    return NoiseText(
        d.method,
        sentence(d.text, names) if d.text else "",
        whiteness,
        tuple(_noise_row(state, q, "/√s") for state, q in active.items()),
        enumeration(quiet),
        tuple(_noise_row(channel, s, "") for channel, s in d.measurement.items()),
        d.method == _OUTPUT_ERROR and bool(active),
        disturbance_rows(d.candidates),
        " ".join(sentence(text) for text in d.closed_loop.sentences) if d.closed_loop else "",
        " ".join(d.wave_sentences),
        d.disturbance != "none",
    )


def _noise_row(name: str, value: float, ending: str) -> NoiseRow:
    si = channel_unit(name)
    unit, size = unit_text(si), significant(value * display_unit(si)[0], 2)
    return NoiseRow(name, channel_meaning(name), size, f"{unit or '1'}{ending}" if ending else unit)


def _unbounded_sentence(identifiability: Identifiability) -> str:
    loose = [p.parameter for p in identifiability.profiles if p.lower is None or p.upper is None]
    if not loose:
        return ""
    return f"Not bounded within the values tried: {enumeration(loose)}."


def _model_row(m: CandidateModel) -> CandidateModelRow:
    failed = m.heading_deg is None and m.position_m is None and m.roll_deg is None
    standing = "failed" if failed else "tied" if m.is_tied else "worse"
    standing = f"used, {standing}" if m.is_chosen else standing
    return CandidateModelRow(m.name, m.free_count, significant(m.heading_deg, 3), significant(m.position_m, 3),
                     significant(m.roll_deg, 3), standing, m.note, m.is_chosen)  # fmt: skip
