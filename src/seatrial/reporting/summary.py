"""The summary in sentences: what was fitted, how well held-out runs are predicted, what limits the result."""

import math

from seatrial.core.results import Coefficient, Fit, Prediction, ReferenceEstimate, Search, Symmetry
from seatrial.core.results.method_comparison import inside_own_intervals
from seatrial.core.text.numbers import duration, estimate_text, exact, fixed, interval, percent, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import Severity
from seatrial.reporting.identifiability_chapter import determined_sentence
from seatrial.reporting.measures import (
    extrapolation_text,
    extrapolation_zone,
    is_inside,
    measure_decimals,
    measure_label,
)
from seatrial.reporting.runs import ERROR_LABELS
from seatrial.reporting.windows import baseline_sentence

# distance of an estimate from its prior's mean, in the prior's standard deviations, from which on they disagree
PRIOR_DISAGREEMENT = 3.0
# letters of the text of a symmetry; of a longer one only the parameters are named
MAX_SYMMETRY_TEXT = 200
_ANGLES = (("theta", "pitch"), ("phi", "roll"))


def facts(fit: Fit) -> list[tuple[str, str]]:
    """Return ship, model and records as pairs of name and text."""
    ship, trained, held = fit.ship, _with_role(fit, "training"), fit.validation
    ratio = f"1:{exact(ship.scale)}"
    scale = f", model scale {ratio}" if ship.scale != 1.0 and ratio not in ship.name else ""
    length = f", L = {exact(ship.length)} m" if "L" in ship.particulars else ""
    free = sum(not c.fixed for c in fit.coefficients)
    seconds = sum(p.measured.duration for p in trained)
    return [
        ("Ship", f"{ship.name}{length}{scale}"),
        ("Model", f"{fit.model.name}, {counted(free, 'free coefficient')} of {len(fit.coefficients)}"),
        ("Fitted to", f"{counted(len(trained), 'run')}, {duration(seconds)} of records"),
        ("Held out", enumeration([p.record for p in held]) if held else "no run"),
        ("Method", fit.method.criterion),
    ]


def sentences(fit: Fit) -> list[str]:
    """Return the summary, most important first."""
    parts = [
        baseline_sentence(fit.validation, ERROR_LABELS),
        *_held_out(fit), _coverage(fit), *_extrapolation(fit), _roll_properties(fit), _identifiability(fit),
        _significance(fit), _truth_coverage(fit), _prior_disagreement(fit), _criterion(fit), _residuals(fit),
        _convergence(fit), _warnings(fit),
    ]  # fmt: skip
    return [sentence for sentence in parts if sentence]


def _with_role(fit: Fit, role: str) -> list[Prediction]:
    return [p for p in fit.predictions if p.role == role]


def _held_out(fit: Fit) -> list[str]:
    held = fit.validation
    if not held:
        return ["No run was held out: the figures show how the model fits, not how it predicts."]
    return [_prediction_sentence(p, fit) for p in held[:4]] + (
        [f"{counted(len(held) - 4, 'further held-out run')} in the table."] if len(held) > 4 else []
    )


def _prediction_sentence(p: Prediction, fit: Fit) -> str:
    parts = []
    if "psi_deg" in p.rms:
        parts.append(f"{significant(p.rms['psi_deg'], 2)}° in heading")
    if "position_m" in p.rms:
        length = 0.0 if fit.model.equations.layout else fit.ship.particulars.get("L", 0.0)
        share = f" ({significant(p.rms['position_m'] / length, 2)} L)" if length > 0 else ""
        parts.append(f"{significant(p.rms['position_m'], 2)} m in position{share}")
    if "z" in p.rms:
        parts.append(f"{significant(p.rms['z'], 2)} m in heave")
    parts += [f"{significant(p.rms[f'{name}_deg'], 2)}° in {text}" for name, text in _ANGLES if f"{name}_deg" in p.rms]
    if not parts and "r" in p.rms:
        parts.append(f"{significant(p.rms['r'] * math.degrees(1.0), 2)} deg/s in yaw rate")
    text = f"{p.record}, not fitted, is predicted open loop over {duration(p.measured.duration)}"
    if p.divergence is not None:
        text = f"{p.record}, not fitted, diverges after {duration(p.divergence.seconds)}; until then it is predicted"
    errors = f" with errors of {enumeration(parts)} (rms)" if parts else ""
    return f"{text}{errors}{_noise_floor(p) if parts else ''}.{_first_measures(p)}"


def _noise_floor(p: Prediction) -> str:
    units = {"psi_deg": "°", "position_m": " m"}
    floors = [f"{significant(p.noise_floor[name], 2)}{unit}" for name, unit in units.items() if name in p.noise_floor]
    return f"; process noise alone would leave {enumeration(floors)}" if floors else ""


def _first_measures(p: Prediction) -> str:
    measures = {"overshoot_1_deg": ("first overshoot", "°"), "advance_L": ("advance", " L"),
             "tactical_diameter_L": ("tactical diameter", " L")}  # fmt: skip
    texts = []
    for name, (label, unit) in measures.items():
        m = p.measures.get(name)
        if m is not None and m.measured is not None and m.simulated is not None:
            digits = measure_decimals(measure_label(name)[1], m)
            bounds = interval(m.lower, m.upper, digits)
            simulated = f"{fixed(m.simulated, digits)}{unit}{' ' + bounds if bounds else ''}"
            simulated = simulated if m.is_determined else "not determined"
            texts.append(f"{label} {simulated}, {p.reference_word} {fixed(m.measured, digits)}{unit}")
    return f" Simulated {'; '.join(texts)}." if texts else ""


def _coverage(fit: Fit) -> str:
    """How many measured values lie inside their predicted intervals; those without a width are no prediction."""
    judged = [is_inside(m) for p in fit.validation for m in p.measures.values() if m.lower != m.upper]
    verdicts = [inside for inside in judged if inside is not None]
    if not verdicts:
        return ""
    word = fit.validation[0].reference_word
    return f"{sum(verdicts)} of {len(verdicts)} {word} manoeuvring values lie inside their predicted 95 % intervals."


def _extrapolation(fit: Fit) -> list[str]:
    """One sentence for each held-out run that goes well beyond the training runs, the first four."""
    far = [p for p in fit.validation if p.extrapolation and extrapolation_zone(p.extrapolation.index) == "beyond"]
    return [
        f"{p.record} is extrapolation, index {extrapolation_text(p.extrapolation)}" for p in far[:4] if p.extrapolation
    ]


def _identifiability(fit: Fit) -> str:
    """How much the records determine, and what no manoeuvre identifies."""
    identifiability = fit.identifiability
    if identifiability is None:
        return ""
    sentences = [determined_sentence(fit)]
    if identifiability.structural:
        more = len(identifiability.structural) - 1
        further = f" ({counted(more, 'further change')} of this kind in the next section)" if more else ""
        sentences.append(f"{_symmetry(identifiability.structural[0], fit)}{further}.")
    return " ".join(s for s in sentences if s)


def _roll_properties(fit: Fit) -> str:
    """Period, damping and metacentric height."""
    roll = fit.roll
    if roll is None:
        return ""
    period, ratio = (estimate_text(e.value, 0.5 * (e.upper - e.lower), e.lower, e.upper)
                     for e in (roll.natural_period, roll.damping_ratio.scaled(100.0)))  # fmt: skip
    text = (
        f"The natural period at small angles is {period.value} s ({period.lower} to {period.upper} s), the linear "
        f"damping {ratio.value} % of critical ({ratio.lower} to {ratio.upper} %)"
    )
    height = roll.metacentric_height
    if height is None:
        return f"{text}."
    gm = estimate_text(height.value, 0.5 * (height.upper - height.lower), height.lower, height.upper)
    return (
        f"{text}; GM would be {gm.value} m ({gm.lower} to {gm.upper} m) with {roll.gyradius_source.partition(',')[0]}."
    )


def _symmetry(s: Symmetry, fit: Fit) -> str:
    """A change that no manoeuvre identifies: its text, or where that is long its parameters, and which are held."""
    if len(s.text) <= MAX_SYMMETRY_TEXT:
        return f"Not identifiable from any manoeuvre: {s.text.rstrip('.')}"
    fixed_names = [c.name for c in fit.coefficients if c.fixed and c.name in s.parameters]
    held = f"; {enumeration(fixed_names)} {'is' if len(fixed_names) == 1 else 'are'} held at the stated values"
    change = f"changing {enumeration(s.parameters)} together leaves every motion unchanged"
    return f"Not identifiable from any manoeuvre: {change}{held if fixed_names else ''}"


def _criterion(fit: Fit) -> str:
    noise_model = fit.noise_model
    if noise_model is None:
        return ""
    active = [state for state, q in noise_model.process.items() if q > 0]
    noise = f"process noise in {enumeration(active)}" if active else "no process noise"
    text = f" {sentence(noise_model.text, [c.name for c in fit.coefficients])}" if noise_model.text else ""
    return f"The criterion is {noise_model.method}, with {noise}.{text}"


def _free_coefficients(fit: Fit) -> list[Coefficient]:
    return [c for c in fit.coefficients if not c.fixed]


def _significance(fit: Fit) -> str:
    free = _free_coefficients(fit)
    if fit.reference is not None:
        return _published_sentence(fit, fit.reference)
    vague = [c.name for c in free if c.lower is not None and c.upper is not None and c.lower < 0 < c.upper]
    if not vague:
        return f"All {len(free)} free coefficients differ from zero at the 95 % level."
    return (
        f"{len(vague)} of {len(free)} free coefficients do not differ significantly from zero at the 95 % level "
        f"({enumeration(vague)})."
    )


def _published_sentence(fit: Fit, reference: ReferenceEstimate) -> str:
    """How a published method's values compare with the package's own estimate."""
    return (
        f"The method gives no intervals. {inside_own_intervals(fit, reference)}, the package’s own estimate, which the "
        "next section shows with it."
    )


def _truth_coverage(fit: Fit) -> str:
    comparable = [
        c for c in _free_coefficients(fit) if c.truth is not None and c.lower is not None and c.upper is not None
    ]
    if not comparable:
        return ""
    inside = [c for c in comparable if c.lower <= c.truth <= c.upper]  # type: ignore[operator]
    return f"{len(inside)} of {len(comparable)} 95 % intervals contain the comparable value of the coefficient."


def _prior_disagreement(fit: Fit) -> str:
    off = [
        c.name
        for c in _free_coefficients(fit)
        if c.prior_mean is not None
        and c.prior_standard_deviation
        and abs(c.estimate - c.prior_mean) > PRIOR_DISAGREEMENT * c.prior_standard_deviation
    ]
    if not off:
        return ""
    return (
        f"{counted(len(off), 'coefficient').capitalize()} ended more than {PRIOR_DISAGREEMENT:g} prior "
        "standard deviations from "
        f"the prior ({enumeration(off)}): records and prior disagree there."
    )


def _residuals(fit: Fit) -> str:
    if not fit.channel_noise:
        return ""
    coloured = [n.channel for n in fit.channel_noise if not n.is_white]
    if not coloured:
        return "The residuals are white in all channels (Ljung-Box with 20 and 100 lags)."
    return (
        f"The residuals are not white in {len(coloured)} of {len(fit.channel_noise)} channels "
        f"({enumeration(coloured)}): model error "
        "or disturbances remain."
    )


def _convergence(fit: Fit) -> str:
    if fit.search is not None:
        return _search_end(fit.search)
    return "" if fit.solution.status.is_success else f"The search did not converge: {fit.solution.status.value}."


def _search_end(search: Search) -> str:
    """What a search by a population can say of its end: its restarts and their scatter, no test of convergence."""
    text = f"The search has no test of convergence: it spends all its iterations, here {search.effort}."
    if search.track is not None:
        return text  # a stream is followed once
    used = search.restarts[search.used].values
    shares = {name: sd / abs(used[name]) for name, sd in search.scatter.items() if used[name] != 0.0}
    if not shares:
        return f"{text} More restarts would show how far its values scatter."
    widest = max(shares, key=lambda name: shares[name])
    return f"{text} Its values scatter over the restarts by up to {percent(shares[widest])} % ({widest})."


def _warnings(fit: Fit) -> str:
    codes = list(dict.fromkeys(f.code for f in fit.findings if f.severity is not Severity.INFO))
    if fit.reference is not None and not codes:
        return ""  # the checks judge records and the package's own estimate, not a published method
    return (
        f"The checks warn of: {enumeration(codes)} (see Findings)." if codes else "The checks found nothing to warn of."
    )
