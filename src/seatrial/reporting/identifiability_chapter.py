"""The chapter of what the records determine, with the draws of a posterior."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import (
    CandidateModel,
    Consequence,
    CredibleInterval,
    DisturbanceCandidate,
    Fit,
    Identifiability,
    NoiseModel,
    Posterior,
    Symmetry,
)
from seatrial.core.text.numbers import (
    DASH,
    EstimateText,
    estimate_text,
    fixed,
    p_value,
    rounded,
    signed_percent,
    significant,
)
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import NOT_MEASURED, display_unit
from seatrial.core.values.notation import channel_meaning, channel_unit, unit_text
from seatrial.reporting.coefficients_chapter import (
    WELL_DETERMINED,
    CoefficientUse,
    Use,
    assumption,
    coefficient_uses,
    correlation_section,
    meaning_sentences,
    strong_partners,
)
from seatrial.reporting.figures.coefficient_charts import direction_chart, posterior_densities, profile_chart
from seatrial.reporting.record_gaps import RecordGap, record_gaps
from seatrial.reporting.section import Cell, Level, Picture, Section, TextTable, name, number, table_of, words

# Draws from the posterior: credible intervals next to the others, how far the chains agree, densities.

_CAPTION = (
    "Draws of each coefficient; between the lines lie 95 % of them, on the dashed lines the ends of the interval "
    "without sampling."
)


def posterior_section(posterior: Posterior | None) -> Section:
    """Return the part on draws from what records and priors leave open; empty where there are none."""
    if posterior is None:
        return Section("")
    table = table_of(
        posterior.coefficients,
        name("Coefficient", lambda c: c.name),
        words("unit", lambda c: unit_text(c.unit)),
        number("mean", lambda c: f"{_text(c).value}{_text(c).power}"),
        number("sd", lambda c: _text(c).error),
        number("95 % credible", lambda c: f"[{_text(c).lower}, {_text(c).upper}]"),
        number("without sampling", lambda c: f"[{_without(c).lower}, {_without(c).upper}]"),
        number("R-hat", lambda c: fixed(c.r_hat, 3)),
        number("independent draws", lambda c: fixed(c.effective_size, 0)),
    )
    return Section(
        "Draws from what records and priors leave open", sentences=posterior.sentences, table=table,
        note=f"Without sampling: {posterior.other_intervals}.",
        pictures=(Picture(lambda: svg(posterior_densities(posterior)), _CAPTION),),
    )  # fmt: skip


def _text(c: CredibleInterval) -> EstimateText:
    factor = display_unit(c.unit)[0]
    return estimate_text(factor * c.mean, factor * c.standard_deviation, factor * c.lower, factor * c.upper)


def _without(c: CredibleInterval) -> EstimateText:
    factor = display_unit(c.unit)[0]
    return estimate_text(factor * c.mean, factor * c.standard_deviation, factor * c.other_lower, factor * c.other_upper)


# The chapter on identifiability: what the records determine and what they do not; nothing is computed.

_LIMITS = (WELL_DETERMINED, 1.0)
"""Relative standard deviations between which combinations are well, poorly and not determined; chosen."""
_CLASSES = (
    "well determined, to better than 10 %",
    "poorly determined, to between 10 % and 100 %",
    "not determined: values come from priors or assumptions",
)
# how a result names the criterion that simulates runs whole
_OUTPUT_ERROR = "output error"
LEAST_MISFIT = 0.01  # rise of chi^2 below which it is called 0: a tenth of a standard error, squared
LEAST_SHIFT = 5e-4  # relative change of an estimate that is named: 0.1 % when rounded
_IDENTIFIABLE = (
    "Structurally identifiable: no change of coefficients was found that leaves the compared outputs unchanged in "
    "every manoeuvre."
)
_USE_NOTE = (
    "Interval: half its width, per cent of the estimate. Effect: root-mean-square change of everything compared when "
    "the coefficient changes by 10 %, in units of the noise; below 1 it matters little in these runs. A variance "
    "inflation of 100 makes an interval ten times as wide as if all others were known (Marquardt 1970)."
)
_DIRECTIONS = (
    "Each line is one combination of coefficients whose error is independent of the others, the weakest first; numbers "
    "are its parts, as relative changes. Filled: determined to better than 10 %. Open: to 10–100 %. Square: no better."
)
_WEAKEST = (
    "By the information of the records alone. Intervals that come from runs left out, or from several disturbance "
    "models, are wider."
)
_CONSEQUENCES = (
    "The changes that the estimates would make, and the rise of χ² that would remain, were the assumed value changed "
    "by that much. It is no evidence that the value is wrong. Coefficients whose sign is open are left out."
)
_PROFILES = (
    "Loss of likelihood (twice its logarithm) when a coefficient is held at another value and all others are fitted "
    "again. Below the line lies its 95 % interval; a flat curve means that the records do not determine it."
)
_PROCESS = (
    "Process noise acts on the ship and is not in the model: gusts, waves, unsteady flow. Measurement noise is in the "
    "readings only."
)
_WHOLE_RUN = (
    "Process noise acts on the ship and is not in the model: gusts, waves, unsteady flow. Residuals are those of whole "
    "runs or segments: process noise and errors of the model have gone into them."
)
_DISTURBANCE = "The disturbance acts on the craft with a memory of its own and is not in the model."
_NO_PROCESS = "No process noise is allowed for: what lies between ship and model counts as noise of the readings."
_CANDIDATES = (
    "Candidates that predict left-out runs, or quarters of few, alike are ranked by likelihood. One is preferred to a "
    "simpler one where twice the gain of log-likelihood exceeds what chance gives once in a thousand cases. Ratios and "
    "limits are against the first row."
)
_MODELS = (
    "Each model was fitted again without each run in turn and judged by windows of the run left out, root mean square. "
    "Models that these runs do not distinguish from the best are tied."
)
_ROLL_MODELS = (
    "Each model predicted runs that it was not fitted to, root mean square. Models within 10 % of the least error are "
    "tied; of these the one with the fewest coefficients is the best."
)
# entries of each kind that are shown unfolded
MAX_SHIFTS, MAX_TEXTS, MAX_ROWS, MAX_DIRECTIONS = 5, 5, 12, 16


def identifiability_section(fit: Fit) -> Section:
    """Return the chapter; empty where the fit contains nothing of it."""
    identifiability = fit.identifiability
    content = identifiability or Identifiability((), (), math.nan, math.nan)
    names = [c.name for c in fit.coefficients]
    basis = math.inf if fit.interval_basis is None else fit.interval_basis.degrees_of_freedom
    strong = strong_partners(fit.model.parameters.free_names, fit.covariance, basis)
    uses = coefficient_uses(fit.coefficients, content, strong)
    examined = identifiability is not None
    sentences = (determined_sentence(fit), *meaning_sentences(fit, content, uses)) if examined else ()
    return Section(
        "Identifiability: what the records determine",
        "identifiability",
        sentences=tuple(text for text in sentences if text),
        parts=(
            *(_examined(fit, content, uses, names) if examined else ()),
            posterior_section(fit.posterior),
            *_noise(fit.noise_model, names),
        ),
        level=Level.DETAIL,
        is_folded=True,
    )


def _examined(
    fit: Fit, content: Identifiability, uses: Sequence[CoefficientUse], names: Sequence[str]
) -> tuple[Section, ...]:
    """What was examined: gaps, uses, symmetries, combinations, correlations, assumptions, stability, profiles."""
    return (
        _gaps(record_gaps(fit)),
        _uses(uses),
        _symmetries(fit, content, names),
        _combinations(content, names),
        correlation_section(fit, _condition_note(content)),
        _consequences(fit, content),
        _profiles(fit, content),
    )


def _gaps(gaps: Sequence[RecordGap]) -> Section:
    table = table_of(
        gaps,
        words("Not in the training runs", lambda gap: gap.name),
        words("Why it matters", lambda gap: gap.text),
        name("Such a run: seatrial simulate", lambda gap: gap.command),
    )
    return Section("Not in the training runs", table=table, level=Level.PAGE)


def _uses(uses: Sequence[CoefficientUse]) -> Section:
    tones = {Use.SIGN_OPEN: "bad", Use.NO_INTERVAL: "bad"}
    table = table_of(
        uses,
        name("Coefficient", lambda use: use.name),
        number("95 % interval", lambda use: use.half_width, "%"),
        number("effect of 10 %", lambda use: use.effect, "noise"),
        number("variance inflation", lambda use: use.variance_inflation),
        name("most correlated with", lambda use: use.partner),
        words("Known", lambda use: Cell(use.use.value, tone=tones.get(use.use, ""))),
        unfolded=MAX_ROWS,
    )
    return Section("Each coefficient", table=table, note=_USE_NOTE if table else "", level=Level.PAGE)


def _symmetries(fit: Fit, content: Identifiability, names: Sequence[str]) -> Section:
    """What no manoeuvre can separate, and what is assumed of it."""
    points = [_symmetry_text(s, fit, names) for s in content.structural]
    return Section(
        "Not identifiable from any manoeuvre",
        sentences=() if points else (_IDENTIFIABLE,),
        points=tuple(points),
        level=Level.DETAIL,
        is_folded=True,
    )


def _symmetry_text(s: Symmetry, fit: Fit, names: Sequence[str]) -> str:
    inside = sorted((c for c in fit.coefficients if c.name in s.parameters), key=lambda c: not c.fixed)
    assumed = [text for text in (assumption(c) for c in inside) if text]
    if inside and not assumed:
        return f"{sentence(s.text, names)} Nothing is assumed of any of these: their values are arbitrary."
    more = f" and {len(assumed) - MAX_TEXTS} more" if len(assumed) > MAX_TEXTS else ""
    held = f" Assumed here: {'; '.join(assumed[:MAX_TEXTS])}{more}." if assumed else ""
    return f"{sentence(s.text, names)}{held}"


def _combinations(content: Identifiability, names: Sequence[str]) -> Section:
    """How many combinations are determined well, poorly and not at all; the weakest as a picture and in words."""
    if not content.directions:
        return Section("")
    spreads = [d.standard_deviation for d in content.directions]
    counts = np.bincount(np.searchsorted(_LIMITS, spreads, side="right"), minlength=len(_CLASSES)).tolist()
    classes = table_of(
        zip(_CLASSES, counts, strict=True),
        words("", lambda row: row[0]),
        number("combinations", lambda row: str(row[1])),
    )
    weakest = [sentence(d.text, names) for d in content.directions if d.standard_deviation >= WELL_DETERMINED]
    rest = content.directions[MAX_DIRECTIONS:]
    worst = significant(100.0 * max((d.standard_deviation for d in rest), default=0.0), 2)
    hidden = (
        f" {counted(len(rest), 'further combination').capitalize()} not drawn, {worst} % or better." if rest else ""
    )
    picture = Picture(lambda: svg(direction_chart(content.directions[:MAX_DIRECTIONS])), f"{_DIRECTIONS}{hidden}")
    more = f"{len(weakest) - MAX_TEXTS} more determined to no better than 10 %"
    return Section(
        "Combinations that these runs determine well, poorly and not at all",
        table=classes,
        note=_accuracy_note(content),
        pictures=(picture,),
        parts=(
            Section("The weakest in words", points=tuple(weakest[:MAX_TEXTS]), note=_WEAKEST if weakest else ""),
            Section(more, points=tuple(weakest[MAX_TEXTS:]), is_folded=True),
        ),
        level=Level.PAGE,
        is_folded=True,
    )


def _condition_note(content: Identifiability) -> str:
    if not math.isfinite(content.condition):
        return ""
    return (
        f"Condition number of the information, scaled to unit diagonal: {rounded(content.condition)} (1: every "
        "coefficient by itself). Condition and variance inflation are by the information alone; these correlations "
        "include, as the intervals do, the spread over runs and disturbance models."
    )


def _consequences(fit: Fit, content: Identifiability) -> Section:
    table = table_of(
        content.consequences,
        name("Assumed", lambda c: _assumed_name(c, fit)),
        number("wrong by", lambda c: signed_percent(c.change)),
        words("changes of the estimates", lambda c: _shifts(c, fit)),
        number("misfit χ² rises by", lambda c: significant(c.misfit, 2) if c.misfit >= LEAST_MISFIT else "0"),
    )
    return Section(
        "If an assumed value is wrong",
        table=table,
        note=_CONSEQUENCES if table else "",
        level=Level.PAGE,
        is_folded=True,
    )


def _assumed_name(c: Consequence, fit: Fit) -> str:
    is_guess = any(coefficient.is_unmeasured for coefficient in fit.coefficients if coefficient.name == c.parameter)
    return f"{c.parameter} ({NOT_MEASURED})" if is_guess else c.parameter


def _shifts(c: Consequence, fit: Fit) -> str:
    is_open = {coefficient.name for coefficient in fit.coefficients if coefficient.is_sign_open}
    changes = [(n, x) for n, x in c.estimate_changes.items() if n not in is_open and abs(x) >= LEAST_SHIFT]
    return ", ".join(f"{name} {signed_percent(move)}" for name, move in changes[:MAX_SHIFTS]) or DASH


def _profiles(fit: Fit, content: Identifiability) -> Section:
    if not content.profiles:
        return Section("")
    loose = [p.parameter for p in content.profiles if p.lower is None or p.upper is None]
    unbounded = f" Not bounded within the values tried: {enumeration(loose)}." if loose else ""
    units = {c.name: c.unit for c in fit.coefficients}
    picture = Picture(lambda: svg(profile_chart(content.profiles, units)), f"{_PROFILES}{unbounded}")
    return Section(
        "How sharply single coefficients are determined", pictures=(picture,), level=Level.PAGE, is_folded=True
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


def _accuracy_note(content: Identifiability) -> str:
    """Return why classes and first sentence count differently; empty where they agree."""
    known = sum(d.standard_deviation < _LIMITS[-1] for d in content.directions)
    if not math.isfinite(content.effective_parameters) or known == round(content.effective_parameters):
        return ""
    return (
        "Counted by how exactly the records have them, without the priors; the first sentence of this chapter counts "
        "of each the share that comes from the records and not from its prior (MacKay 1992), and so differs."
    )


def _noise(d: NoiseModel | None, names: Sequence[str]) -> tuple[Section, ...]:
    """The criterion with what it takes for noise and disturbances, and the disturbances that were compared."""
    if d is None:
        return ()
    active = {state: q for state, q in d.process.items() if q > 0}
    quiet = [state for state in d.process if state not in active]
    is_whole_run = d.method == _OUTPUT_ERROR and bool(active)
    loop = d.closed_loop.sentences if d.closed_loop else ()
    sentences = [
        f"The criterion of this fit is {d.method}.",
        sentence(d.text, names) if d.text else "",
        _whiteness(d),
        _WHOLE_RUN
        if is_whole_run
        else _PROCESS
        if active
        else _DISTURBANCE
        if d.disturbance != "none"
        else _NO_PROCESS,
        *d.wave_sentences,
        *map(sentence, loop),
    ]
    none_needed = f" None needed in {enumeration(quiet)}." if quiet else ""
    note = f"After t seconds it changes a state by this times √t where the state is not damped.{none_needed}"
    return (
        Section(
            "Noise, and the criterion chosen for it",
            sentences=tuple(text for text in sentences if text),
            parts=(
                _disturbances(d.candidates),
                Section("Process noise", table=_noise_table(active, "State", "/√s"), note=note if active else ""),
                Section(
                    "Residuals" if is_whole_run else "Measurement noise",
                    table=_noise_table(d.measurement, "Channel", ""),
                ),
            ),
            level=Level.DETAIL,
            is_folded=True,
        ),
    )


def _whiteness(d: NoiseModel) -> str:
    p, values = p_value(d.whiteness_p), "innovations" if d.disturbance != "none" else "residuals"
    if not math.isfinite(d.whiteness_p):
        return ""
    if d.is_white:
        return f"The {values} are white in every channel (Ljung-Box with 20 and 100 lags, {p})."
    return (
        f"The {values} are not white (Ljung-Box with 20 and 100 lags, {p}): they contain model error or disturbances "
        "that this criterion does not describe."
    )


def _disturbances(candidates: Sequence[DisturbanceCandidate]) -> Section:
    """The disturbances that were compared: one row each, as users of continuous-time stochastic models know it."""
    table = table_of(
        candidates,
        words("Disturbance", lambda c: Cell(c.name, "used" if c.is_chosen else "")),
        number("log-likelihood", lambda c: fixed(c.log_likelihood, 1)),
        number("degrees of freedom", lambda c: str(c.degrees_of_freedom)),
        number("likelihood ratio", lambda c: fixed(c.likelihood_ratio, 1) if c.critical_ratio > 0.0 else ""),
        number("by chance", lambda c: fixed(c.critical_ratio, 1) if c.critical_ratio > 0.0 else ""),
        words("innovations", lambda c: f"{'white' if c.is_white else 'not white'}, {p_value(c.whiteness_p)}"),
        number("error left out, over the least", lambda c: fixed(c.left_out_error, 2) if c.left_out_error else ""),
        words(
            "estimated", lambda c: ", ".join(f"{n} {significant(v, 2)}" for n, v in c.parameters.items()), is_wide=True
        ),
        is_marked=lambda c: c.is_chosen,
    )
    return Section("Disturbances compared", table=table, note=_CANDIDATES if table else "")


def _noise_table(values: Mapping[str, float], first: str, ending: str) -> TextTable:
    return table_of(
        values.items(),
        name(first, lambda row: row[0]),
        words("", lambda row: "" if channel_meaning(row[0]) == row[0] else channel_meaning(row[0])),
        number("std. dev.", lambda row: significant(row[1] * display_unit(channel_unit(row[0]))[0], 2)),
        words("unit", lambda row: f"{unit_text(channel_unit(row[0])) or ('1' if ending else '')}{ending}"),
    )


def model_section(candidates: Sequence[CandidateModel]) -> Section:
    """Return the chapter on the models of the family with their errors on the runs left out; empty: none were."""
    is_roll = any(m.roll_deg is not None for m in candidates)
    table = table_of(
        candidates,
        words("Model", lambda m: m.name),
        number("free", lambda m: str(m.free_count)),
        number("roll", lambda m: significant(m.roll_deg, 3), "deg"),
        number("heading", lambda m: significant(m.heading_deg, 3), "deg"),
        number("position", lambda m: significant(m.position_m, 3), "m"),
        words("", _standing),
        words("note", lambda m: m.note),
        is_marked=lambda m: m.is_chosen,
    )
    note = _ROLL_MODELS if is_roll else _MODELS
    return Section(
        "Models compared on runs left out", "models", table=table, note=note if table else "", is_folded=True
    )


def _standing(m: CandidateModel) -> Cell:
    """Whether the runs left out distinguish a model from the best, and whether it is used."""
    if m.heading_deg is None and m.position_m is None and m.roll_deg is None:
        return Cell("failed", tone="bad")
    parts = ["used" if m.is_chosen else "", "tied" if m.is_tied else "", _gain(m)]
    return Cell(", ".join(part for part in parts if part))


def _gain(m: CandidateModel) -> str:
    """By how much a model errs less, or more, than the one it extends."""
    if not m.gain_percent:
        return ""
    return f"{fixed(abs(m.gain_percent), 1)} % {'better' if m.gain_percent > 0.0 else 'worse'}"
