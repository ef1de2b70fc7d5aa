"""The rows at the top of a fit's page: score, baseline, coverage, identifiability, gaps, warnings."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.results import Fit, Prediction, WindowScore
from seatrial.core.results.fit import NOT_CONVERGED
from seatrial.core.results.fit_charts import has_band, headline_view
from seatrial.core.results.prediction import ChannelScore
from seatrial.core.text.numbers import fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Severity
from seatrial.reporting.correlations import MIN_VARIANCE_INFLATION
from seatrial.reporting.course import course_facts, unstable_course
from seatrial.reporting.first_screen import FirstScreen, KeyFact
from seatrial.reporting.grades import largest_error_share, share_sentence, worst_share
from seatrial.reporting.identifiability_chapter import determined_sentence
from seatrial.reporting.measures import IntervalVerdict, interval_verdict
from seatrial.reporting.operators import operators_sentence
from seatrial.reporting.record_gaps import gap_facts
from seatrial.reporting.runs import ERROR_LABELS, badness
from seatrial.reporting.time_figures import run_figure
from seatrial.reporting.verdict import error_text, has_converged, verdict, worst_errors
from seatrial.reporting.windows import shortest_judged

# share of values inside their 95 % intervals that counts as kept; chosen between 0.95 and the scatter of few values
LEAST_COVERAGE = 0.9
# the same of a run simulated whole, whose errors last as long as the run: one run in twenty may leave its band
# altogether, so that only a run more outside than inside counts; chosen
LEAST_WHOLE_RUN = 0.5
# what a prediction is for; velocities are compared with baselines too, but in a clause of their own
_MAIN_CHANNELS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")
# names that a row holds, chosen
MAX_NAMES = 4
# share of an error from which on the process noise is said to leave it, chosen
_EXPLAINED = 0.7
_BY_SYMPTOM = "docs/bad-fit.md, By symptom"
# training runs that are missed whose errors a row quotes, chosen
_MISSED_RUNS = 2
# error of a fitted run over that of those held out, from which on it is quoted beside it; chosen
_LUCKY = 1.5
# half width of a band over the error from which on it is said to be cautious: three times what holds 95 %; chosen
_CAUTIOUS = 6.0


def first_screen(fit: Fit, length: float) -> FirstScreen:
    """Return the verdict, the five rows, and the worst held-out run as track and heading; length: of the ship [m]."""
    held = fit.validation or fit.predictions
    if not held:
        return FirstScreen(verdict(fit), key_facts(fit), lead=operators_sentence(fit))
    p = max(held, key=badness)
    view = headline_view(p, length, fit.model.input_names)
    which = "The held-out run" if len(fit.validation) == 1 else (
        "The worst held-out run" if fit.validation else "The worst training run")  # fmt: skip
    track = {"x0", "y0"} <= set(p.measured.channels)
    reach = ", up to where it is half as wide as the track is long" if track else ""
    band = f" Pale: 95 % band{reach}." if has_band(p) else ""
    caption = f"{which}, {p.record}: {p.reference_word} and {p.model_word}.{band}"
    return FirstScreen(verdict(fit), key_facts(fit), run_figure(view, is_first=True), caption, operators_sentence(fit))


def key_facts(fit: Fit) -> tuple[KeyFact, ...]:
    """Return the rows; a search that did not converge comes first; what the fit does not contain is said to be so."""
    rows = (_score(fit), *_training_score(fit), *course_facts(fit), _baseline(fit), _coverage(fit),
            _identifiability(fit))  # fmt: skip
    rows = (*rows, *gap_facts(fit))
    return (*rows, _warnings(fit)) if has_converged(fit) else (_warnings(fit), *rows)


def _score(fit: Fit) -> KeyFact:
    held = fit.validation
    if not held:
        return KeyFact("Error, held out", "no run was held out: name one under validate in the trial file", "", False)
    name = "Error, held out (rms)"
    diverged = sum(bool(p.divergence) for p in held)
    if diverged:
        return KeyFact(
            name, f"{counted(diverged, 'run')} {'diverges' if diverged == 1 else 'diverge'}", "prediction", False
        )
    floor = _floor_clause(held)
    course = unstable_course(fit)
    share = f"; {sentence}" if (sentence := share_sentence(held, course)) else ""
    largest = worst_share(held, course)
    is_marked = largest is not None and largest.needs_attention
    text = f"{worst_errors(held)}{share}{floor}{_fitted_clause(fit)}"
    return KeyFact(name, text, "prediction", False if is_marked else None)


def _fitted_clause(fit: Fit) -> str:
    """The fitted run that is missed by more than those held out, so that a lucky one does not stand for all."""
    name = next((n for n in _MAIN_CHANNELS if any(n in p.rms for p in fit.validation)), None)
    if name is None or _training_score(fit):
        return ""
    held = max(p.rms[name] for p in fit.validation if name in p.rms)
    fitted = [p for p in fit.predictions if p.role == "training" and name in p.rms and p.divergence is None]
    worst = max(fitted, key=lambda p: p.rms[name], default=None)
    if worst is None or worst.rms[name] < _LUCKY * held:
        return ""
    return f"; {worst.record}, although fitted, is missed by more: {worst_errors([worst])}; expect errors between them"


def _floor_clause(runs: Sequence[Prediction]) -> str:
    """What the process noise would leave of heading and position by itself, the largest of some runs; may be empty."""
    floors = [error_text(key, max(p.noise_floor[key] for p in runs if key in p.noise_floor))
              for key in ("psi_deg", "position_m") if any(key in p.noise_floor for p in runs)]  # fmt: skip
    return f"; the process noise as estimated, model error in it, would leave {enumeration(floors)}" if floors else ""


def _training_score(fit: Fit) -> tuple[KeyFact, ...]:
    """The training runs that the model misses, the worst first; no row where it reproduces them well."""
    shares = [(share, p) for p in fit.predictions if p.role == "training"
              and (share := largest_error_share(p)) is not None and share.needs_attention]  # fmt: skip
    if not shares or not fit.validation:
        return ()
    shares.sort(key=lambda row: -row[0].share)
    runs = [p for _, p in shares]
    named = [f"{p.record} by {worst_errors([p])} ({share.grade})" for share, p in shares[:_MISSED_RUNS]]
    more = [f"{len(shares) - _MISSED_RUNS} more"] if len(shares) > _MISSED_RUNS else []
    errors = "; ".join([*named, *more])
    if unstable_course(fit) is not None:
        text = (
            f"simulated whole, the model misses {errors}: no evidence of model error, as a deviation of a "
            "course-unstable craft grows by itself; windows of held-out runs judge it"
        )
        return (KeyFact("Error, fitted (rms)", text, "training"),)
    worst, p = shares[0]
    is_explained = p.noise_floor.get(worst.name, 0.0) >= _EXPLAINED * p.rms[worst.name]
    cause = "disturbances or model error" if is_explained else "model error"
    text = f"missed although fitted: {errors}{_floor_clause(runs)}; {cause}, not extrapolation: {_BY_SYMPTOM}"
    return (KeyFact("Error, fitted (rms)", text, "training", is_good=False),)


def _longest_windows(p: Prediction) -> WindowScore | None:
    return max(p.windows, key=lambda w: w.seconds, default=None)


def _baseline(fit: Fit) -> KeyFact:
    """The quantity and run in which the best prediction without the fit comes closest to it, or is better."""
    lost = [(w, p) for p in fit.validation for w in reversed(p.windows) if w.diverged]
    if lost:
        (w, p), *_ = lost
        text = f"none compared: {w.divergence_text} of {w.window}{_run_name(fit, p)}"
        return KeyFact("Closest baseline", text, "prediction", is_good=False)
    compared = [(_ratio(key, w, score), p, w, key) for p in fit.validation if (w := _longest_windows(p))
                for key, score in w.scores.items() if key in _MAIN_CHANNELS
                and math.isfinite(score.rms) and any(key in b.scores for b in w.baselines)]  # fmt: skip
    if not compared:
        return KeyFact("Baseline", "none compared")
    ratio, p, w, key = min(compared, key=lambda row: row[0])
    best = min((b for b in w.baselines if key in b.scores), key=lambda b: b.scores[key].rms)
    text = (
        f"{ERROR_LABELS[key][0]} over {w.window}{_run_name(fit, p)}: {error_text(key, w.scores[key].rms)} by this fit, "
        f"{error_text(key, best.scores[key].rms)} by {best.name}"
    )
    rest = dict.fromkeys(
        f"{ERROR_LABELS[name][0]} by {rival}" for p in fit.validation if (w := _longest_windows(p))
        for name, rival in w.better_baselines.items() if name not in _MAIN_CHANNELS
    )  # fmt: skip
    better = [
        (w.seconds >= shortest_judged(fit), f"{ERROR_LABELS[name][0]} over {w.window} ({rival})")
        for p in fit.validation for w in p.windows for name, rival in w.better_baselines.items()
    ]  # fmt: skip
    elsewhere = list(dict.fromkeys(text for is_judged, text in better if is_judged))
    verdict = "this fit is best in every quantity"
    verdict += f" over the longest windows, not in {enumeration(elsewhere, MAX_NAMES)}" if elsewhere else ""
    verdict += " over windows of a roll period and more" if better and not elsewhere else ""
    if ratio < 1.0 or rest:
        verdict = "; ".join([*(["better without this fit"] if ratio < 1.0 else []),
                             *([f"without this fit {enumeration(list(rest))} is better"] if rest else [])])  # fmt: skip
    is_best = ratio >= 1.0 and not rest
    return KeyFact("Closest baseline", f"{text}; {verdict}", "prediction", None if is_best and elsewhere else is_best)


def _run_name(fit: Fit, p: Prediction) -> str:
    return f" of {p.record}" if len(fit.validation) > 1 else ""


def _ratio(key: str, w: WindowScore, score: ChannelScore) -> float:
    return min(b.scores[key].rms for b in w.baselines if key in b.scores) / max(score.rms, 1e-300)  # not zero


def _coverage(fit: Fit) -> KeyFact:
    """How many values lie inside their intervals, and samples inside their bands; what is too wide to test."""
    name = "Inside 95 % intervals"
    verdicts = [interval_verdict(key, m) for p in fit.validation for key, m in p.measures.items() if m.lower != m.upper]
    inside, outside, wide = (
        sum(v is which for v in verdicts)
        for which in (IntervalVerdict.INSIDE, IntervalVerdict.OUTSIDE, IntervalVerdict.TOO_WIDE)
    )
    texts, shares, untested = list[str](), list[float](), [counted(wide, "manoeuvring value")] if wide else []
    widest = 0.0
    if inside + outside:
        texts.append(f"{inside} of {inside + outside} {fit.validation[0].reference_word} manoeuvring values")
        shares.append(inside / (inside + outside))
    windows = [w for p in fit.validation if (w := _longest_windows(p))]
    for key in dict.fromkeys(key for w in windows for key in w.scores):
        scores = [(w.scores[key], w.count) for w in windows if key in w.scores]
        bands = [(score.inside_band, count) for score, count in scores if score.inside_band is not None]
        if bands and all(score.is_band_too_wide for score, _ in scores if score.inside_band is not None):
            untested.append(f"the band of {ERROR_LABELS[key][0]}")
        elif bands:
            share = sum(share * count for share, count in bands) / sum(count for _, count in bands)
            widest = max(widest, *(_band_over_error(score) for score, _ in scores))
            texts.append(f"{fixed(100.0 * share, 0)} % of the samples of {ERROR_LABELS[key][0]}")
            shares.append(share)
    if not texts and not untested:
        why = "nothing that was recorded has one" if fit.validation else "no run was held out"
        return KeyFact(name, f"none judged: {why}")
    lengths = {w.window for w in windows}
    has_bands = len(texts) > bool(inside + outside)
    over = f", in windows of {lengths.pop()}" if len(lengths) == 1 and has_bands else ""
    too_wide = [f"too wide to test anything: {enumeration(untested)}"] if untested else []
    whole = whole_run_shares(fit.validation)
    widest = max(widest, *(_whole_band_over_error(p) for p in fit.validation))
    breadth = f"cautious: bands {significant(widest, 2)} times as wide as the error, where twice would do"
    cautious = [breadth] if widest > _CAUTIOUS else []
    text = "; ".join(
        [*([f"{enumeration(texts)}{over}"] if texts else []), *_whole_run_text(whole), *too_wide, *cautious]
    )
    is_kept = bool(shares) and min(shares) >= LEAST_COVERAGE and min(whole, default=1.0) >= LEAST_WHOLE_RUN
    return KeyFact(name, text, "prediction", None if is_kept and cautious else is_kept)


def _band_over_error(score: ChannelScore) -> float:
    """Half width of a band over the error, both rms: 2 where it holds 95 % of a Gaussian error; 0 without a band."""
    if score.inside_band is None or score.band_share is None:
        return 0.0
    error = math.sqrt(max(1.0 - score.r_squared, 1e-12))  # over the standard deviation of the motion, as the band
    return score.band_share / error


def _whole_band_over_error(p: Prediction) -> float:
    """The same of the heading of a run that is simulated whole."""
    error, band = p.rms.get("psi_deg", 0.0), p.half_width.get("psi")
    if band is None or not error > 0.0:
        return 0.0
    return math.degrees(float(np.sqrt(np.nanmean(np.square(band))))) / error


def whole_run_shares(runs: Sequence[Prediction]) -> list[float]:
    """Return which share of each run's heading, simulated from its start, lies inside the 95 % band of the pictures."""
    shares = []
    for p in runs:
        if "psi" in p.half_width and "psi" in p.measured and "psi" in p.simulated:
            apart = p.measured["psi"] - p.simulated["psi"]
            apart = np.abs(np.angle(np.exp(1j * apart)))
            judged = np.isfinite(apart) & np.isfinite(p.half_width["psi"])
            if judged.any():
                shares.append(float(np.mean(apart[judged] <= p.half_width["psi"][judged])))
    return shares


def _whole_run_text(shares: Sequence[float]) -> list[str]:
    """What lies inside where runs are simulated whole; nothing where nearly all does."""
    if min(shares, default=1.0) >= LEAST_COVERAGE:
        return []
    low, high = (fixed(100.0 * share, 0) for share in (min(shares), max(shares)))
    return [f"simulated whole, {low if low == high else f'{low} to {high}'} % of the heading of a run"]


def _identifiability(fit: Fit) -> KeyFact:
    text = determined_sentence(fit)
    if not text:
        return KeyFact("Identifiability", "not examined", "identifiability" if fit.noise_model else "")
    free = [c for c in fit.coefficients if not c.fixed]
    is_complete = fit.identifiability is not None and round(fit.identifiability.effective_parameters) >= len(free)
    is_complete = is_complete and not any(c.is_sign_open for c in free)
    limits = _determination_limits(fit)
    return KeyFact("Identifiability", "; ".join([text.removesuffix("."), *limits]), "identifiability",
                   is_complete and not limits)  # fmt: skip


def _determination_limits(fit: Fit) -> list[str]:
    """What keeps the coefficients from being used by themselves further: no optimum, collinearity."""
    limits = [] if has_converged(fit) else ["but the search did not converge, and this holds at no optimum"]
    collinear = fit.identifiability.collinearity if fit.identifiability else ()
    inflated = [c for c in collinear if c.variance_inflation >= MIN_VARIANCE_INFLATION]
    if inflated:
        most = max(c.variance_inflation for c in inflated)
        names = enumeration([c.parameter for c in inflated], MAX_NAMES)
        limits.append(f"{names} only together with others (variance inflation up to {significant(most, 2)})")
    return limits


def _warnings(fit: Fit) -> KeyFact:
    codes = list(dict.fromkeys(f.code for f in fit.findings if f.severity is not Severity.INFO))
    texts = codes if has_converged(fit) else ["the search did not converge", *(c for c in codes if c != NOT_CONVERGED)]
    if not texts:
        return KeyFact("Warnings", "none", "findings" if fit.findings else "", is_good=True)
    return KeyFact("Warnings", enumeration(texts), "findings" if codes else "method", is_good=False)
