"""The first screen of a fit: what it is good for, and its key facts."""

import math
from collections.abc import Set

import numpy as np

from seatrial.core.results import Fit, Prediction, RollCharacteristics, Seakeeping, WindowScore
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.fit import NOT_CONVERGED
from seatrial.core.results.fit_charts import has_band, headline_view
from seatrial.core.results.prediction import ERROR_CHANNELS, ChannelScore, is_sensor_noise
from seatrial.core.results.ship_motions import CraftMeasure, IntervalEstimate, ThrusterCraft
from seatrial.core.text.numbers import EstimateText, estimate_text, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import Severity, worst_first
from seatrial.reporting.coefficients_chapter import relative_half_width
from seatrial.reporting.measures import (
    IntervalVerdict,
    course_facts,
    craft_estimate,
    interval_verdict,
    is_extrapolated,
    unstable_course,
)
from seatrial.reporting.prediction_chapter import shortest_judged
from seatrial.reporting.record_gaps import gap_facts
from seatrial.reporting.section import FirstScreen, KeyFact
from seatrial.reporting.time_figures import run_figure
from seatrial.reporting.verdict import (
    ERROR_LABELS,
    Grade,
    error_scale,
    error_text,
    graded_errors,
    has_converged,
    is_disturbed,
    is_missed,
    largest_error_share,
    verdict,
    worst_errors,
    worst_run,
    worst_share,
)

# What a fit means to those who operate the craft, in a sentence: roll, thrusters, motions in waves.

# measures of a craft with thrusters that a sentence names: key -> text before the value, unit after it
_CRAFT_MEASURES = {
    "top_speed": ("makes", "m/s"),
    "yaw_rate_deg_s": ("turns at", "°/s"),
    "stopping_distance_m": ("stops within", "m"),
}


def operators_sentence(fit: Fit) -> str:
    """Return what the ship does in terms of those who operate it.

    Empty for a model of manoeuvring by a rudder, and for one that does not predict its held-out run.
    """
    if is_missed(fit):
        return ""
    if fit.roll is not None:
        return f"{_roll(fit.roll)}{_at_one_speed(fit)}"
    if fit.thruster_craft is not None:
        return _craft(fit.thruster_craft, _guessed_measures(fit))
    return "" if fit.seakeeping is None else _waves(fit.seakeeping)


def _roll(roll: RollCharacteristics) -> str:
    period, ratio = _estimate(roll.natural_period, " s"), _estimate(roll.damping_ratio.scaled(100.0), " %")
    text = f"The natural period at small angles is {period}. The linear damping is {ratio} of critical"
    if roll.amplitude:
        text += f", {_equivalent_damping(roll)}"
    height = roll.metacentric_height
    if height is None or height.lower == height.upper:  # unknown, or given
        return f"{text}."
    return f"{text}. GM would be {_estimate(height, ' m')} with {roll.gyradius_source.partition(',')[0]}."


def _at_one_speed(fit: Fit) -> str:
    """Damping grows with speed, so that decays at one speed say nothing of another (Himeno 1981)."""
    is_at_one = any(finding.code == "one-speed" for finding in fit.findings)
    return " This is the damping at the speed of these runs only." if is_at_one else ""


def _equivalent_damping(roll: RollCharacteristics) -> str:
    """What a swing of the largest recorded angle is damped by, and whether it is more than small ones."""
    from seatrial.reporting.seakeeping_chapter import share_of_critical

    share, low, high = (
        100.0 * share_of_critical(b[-1], roll.period[-1])
        for b in (roll.damping, roll.damping_lower, roll.damping_upper)
    )
    value = _estimate(IntervalEstimate(share, low, high), " %")
    linear = roll.damping_ratio.scaled(100.0)
    grows, falls = low > linear.upper, high < linear.lower
    kind = "grows with the angle" if grows else "falls with the angle" if falls else "is not shown to change with it"
    return f"the equivalent damping at {math.degrees(roll.amplitude[-1]):.0f}° {value}: damping {kind}"


def _estimate(e: IntervalEstimate, unit: str) -> str:
    """A value with its interval: ``2.55 s (2.54 to 2.56 s)``."""
    return _with_interval(estimate_text(e.value, 0.5 * (e.upper - e.lower), e.lower, e.upper), unit)


def _with_interval(text: EstimateText, unit: str) -> str:
    return f"{text.value}{unit} ({text.lower} to {text.upper}{unit})"


def _guessed_measures(fit: Fit) -> Set[str]:
    """Measures that rest on a thrust that no training run shows: at full command by one order alone, or astern."""
    codes = {finding.code for finding in fit.findings}
    if "single-order" in codes:
        return set(_CRAFT_MEASURES)
    return {"stopping_distance_m"} if "no-thrust-astern" in codes else set()


def _craft(craft: ThrusterCraft, guessed: Set[str]) -> str:
    names = [name for name in _CRAFT_MEASURES if name in craft.measures and name not in guessed]
    clauses = [f"{_CRAFT_MEASURES[name][0]} {_measure(craft.measures[name], _CRAFT_MEASURES[name][1])}"
               for name in names]  # fmt: skip
    is_far = any(is_extrapolated(craft.measures[name]) for name in names)
    place = "At full command, beyond the training runs," if is_far else "At full command"
    return f"{place} it {enumeration(clauses)}." if clauses else ""


def _measure(m: CraftMeasure, unit: str) -> str:
    gap = "" if unit.startswith("°") else " "
    if m.lower is None or m.upper is None:
        return f"{significant(m.value, 2)}{gap}{unit} (interval not determined)"
    return _with_interval(craft_estimate(m), f"{gap}{unit}")


def _waves(seakeeping: Seakeeping) -> str:
    heave, pitch = significant(seakeeping.heave_significant, 2), significant(seakeeping.pitch_significant, 2)
    return (
        f"In {seakeeping.sea}, at {significant(seakeeping.speed, 3)} m/s and {seakeeping.heading:.0f}° to the waves, "
        f"significant amplitudes are {heave} m of heave and {pitch}° of pitch."
    )


# The rows at the top of a fit's page: score, baseline, coverage, identifiability, gaps, warnings.

# share of values inside their 95 % intervals that counts as kept; chosen between 0.95 and the scatter of few values
LEAST_COVERAGE = 0.9
# what a prediction is for; velocities are compared with baselines too, but in a clause of their own
_MAIN_CHANNELS = ("psi_deg", "position_m", "z", "theta_deg", "phi_deg")
# names that a row holds, chosen
MAX_NAMES = 4
_BY_SYMPTOM = "docs/bad-fit.md, By symptom"
# training runs that are missed whose errors a row quotes, chosen
_MISSED_RUNS = 2
# half width of a band over the error from which on it is said to be cautious: three times what holds 95 %; chosen
_CAUTIOUS = 6.0


def first_screen(fit: Fit, length: float) -> FirstScreen:
    """Return the verdict, the five rows, and the worst held-out run as track and heading; length: of the ship [m]."""
    held = fit.validation or fit.predictions
    if not held:
        return FirstScreen(verdict(fit), key_facts(fit), lead=operators_sentence(fit))
    p = worst_run(held, error_scale(fit))
    view = headline_view(p, length, fit.model.input_names)
    which = "The held-out run" if len(fit.validation) == 1 else (
        "The worst held-out run" if fit.validation else "The worst training run")  # fmt: skip
    band = " Pale: 95 % band, sensor noise left out." if has_band(p) else ""
    caption = f"{which}, {p.record}: {p.reference_word} and {p.model_word}.{band}"
    return FirstScreen(verdict(fit), key_facts(fit), run_figure(view, is_first=True), caption, operators_sentence(fit))


def key_facts(fit: Fit) -> tuple[KeyFact, ...]:
    """Return the rows; a search that did not converge comes first; what the fit does not contain is said to be so."""
    rows = (_score(fit), *_training_score(fit), *course_facts(fit), _baseline(fit), _coverage(fit),
            _identifiability(fit), *_known_values(fit))  # fmt: skip
    rows = (*rows, *gap_facts(fit))
    return (*rows, _warnings(fit)) if has_converged(fit) else (_warnings(fit), *rows)


def _score(fit: Fit) -> KeyFact:
    held, name = fit.validation, "Error, held out"
    if not held:
        is_simulated = bool(fit.predictions) or not fit.records
        why = "no run was held out: name one under validate in the trial file" if is_simulated else (
            "no run was simulated: its waves are not known")  # fmt: skip
        return KeyFact(name, why, "", is_good=False)
    diverged = sum(bool(p.divergence) for p in held)
    if diverged:
        text = f"{counted(diverged, 'run')} {'diverges' if diverged == 1 else 'diverge'}"
        return KeyFact(name, text, "prediction", is_good=False)
    largest = worst_share(fit)
    is_marked = largest is not None and largest.needs_attention
    return KeyFact(name, graded_errors(fit) or worst_errors(held), "prediction", False if is_marked else None)


def _training_score(fit: Fit) -> tuple[KeyFact, ...]:
    """The training runs that the model misses, or by more than those held out; no row where it reproduces them.

    What sensors add is no miss.
    """
    fitted = [p for p in fit.predictions if p.role == "training" and p.divergence is None]
    by = error_scale(fit)
    shares = [
        (share, p) for p in fitted if (share := largest_error_share(p, by)) is not None
        and not is_sensor_noise(share.rms, fit.sensor_errors.get(share.name, 0.0))
    ]  # fmt: skip
    shares.sort(key=lambda row: -row[0].share)
    missed = [p for share, p in shares if share.needs_attention]
    held = [share for p in fit.validation if (share := largest_error_share(p, by)) is not None]
    if not shares or not held:
        return ()
    tested = max(held, key=lambda share: share.share).grade
    (worst, p), name = shares[0], "Error, fitted"
    if not missed:
        is_worse = worst.grade is not tested and tested is Grade.CLOSELY
        return (KeyFact(name, f"{p.record} {worst_errors([p])}: {worst.grade}", "training"),) if is_worse else ()
    texts = [f"{run.record} {worst_errors([run])}" for run in missed[:_MISSED_RUNS]]
    more = [f"{len(missed) - _MISSED_RUNS} more"] if len(missed) > _MISSED_RUNS else []
    errors = "; ".join([*texts, *more])
    if unstable_course(fit) is not None:
        return (KeyFact(name, f"{errors}; a course-unstable craft leaves any whole run", "training"),)
    if is_disturbed(fit, p, worst):
        return (KeyFact(name, f"{errors}; the estimated disturbance leaves as much", "training"),)
    return (KeyFact(name, f"{errors}; model error: {_BY_SYMPTOM}", "training", is_good=False),)


def _longest_windows(p: Prediction) -> WindowScore | None:
    return max(p.windows, key=lambda w: w.seconds, default=None)


def _baseline(fit: Fit) -> KeyFact:
    """The quantity and run in which the best prediction without the fit comes closest to it, or is better."""
    diverged = [(w, p) for p in fit.validation for w in reversed(p.windows) if w.diverged]
    if diverged:
        (w, p), *_ = diverged
        text = f"none compared: {w.divergence_text} of {w.window}{_run_name(fit, p)}"
        return KeyFact("Closest baseline", text, "prediction", is_good=False)
    compared = [(_ratio(key, w, score), p, w, key) for p in fit.validation if (w := _longest_windows(p))
                for key, score in w.scores.items() if key in _MAIN_CHANNELS
                and math.isfinite(score.rms) and any(key in b.scores for b in w.baselines)]  # fmt: skip
    if not compared:
        return KeyFact("Baseline", "none compared")
    ratio, p, w, key = min(compared, key=lambda row: row[0])
    error, noise = w.scores[key].rms, fit.sensor_errors
    best = min((b for b in w.baselines if key in b.scores), key=lambda b: b.scores[key].rms)
    text = (
        f"{best.name} {error_text(key, best.scores[key].rms)}, this fit {error_text(key, error)} in "
        f"{ERROR_LABELS[key][0]} over {w.window}{_run_name(fit, p)}"
    )
    velocities = dict.fromkeys(
        ERROR_LABELS[name][0] for p in fit.validation if (w := _longest_windows(p))
        for name in w.better_baselines(noise) if name not in _MAIN_CHANNELS
    )  # fmt: skip
    shorter = dict.fromkeys(
        f"{ERROR_LABELS[name][0]} over {w.window}" for p in fit.validation for w in p.windows
        for name in w.better_baselines(noise) if w.seconds >= shortest_judged(fit)
    )  # fmt: skip
    better = list(velocities or shorter)
    if is_sensor_noise(error, noise.get(key, 0.0)) and ratio < 1.0:
        return KeyFact("Closest baseline", f"{text}: both within sensor noise", "prediction")
    is_best = ratio >= 1.0 and not velocities
    limits = f"; a baseline is better in {enumeration(better, MAX_NAMES)}" if ratio >= 1.0 and better else (
        "; the baseline is better" if ratio < 1.0 else "")  # fmt: skip
    return KeyFact("Closest baseline", f"{text}{limits}", "prediction", None if is_best and better else is_best)


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
    measures = [f"{inside} of {counted(inside + outside, 'measure')}"] if inside + outside else []
    shares = [inside / (inside + outside)] if measures else []
    bands, untested = _band_shares(fit)
    whole = whole_run_shares(fit)
    judged = [*shares, *bands.values(), *whole.values()]
    untested = [*([counted(wide, "measure")] if wide else []), *untested]
    if not judged and not untested:
        why = "nothing that was recorded has one" if fit.validation else "no run was held out"
        return KeyFact(name, f"none judged: {why}")
    lengths = {w.window for p in fit.validation if (w := _longest_windows(p))}
    over = f" over {next(iter(lengths))}" if len(lengths) == 1 and bands else ""
    texts = [*measures, *(f"{fixed(100.0 * share, 0)} % of {label}" for label, share in bands.items())]
    widest = max((_band_over_error(score) for p in fit.validation if (w := _longest_windows(p))
                  for score in w.scores.values()), default=0.0)  # fmt: skip
    widest = max(widest, *(_whole_band_over_error(p) for p in fit.validation))
    uncovered = {label: share for label, share in whole.items() if share < LEAST_COVERAGE}
    clauses = [
        *([f"{', '.join(texts)}{over}"] if texts else []),
        *(f"{fixed(100.0 * share, 0)} % of {label}, simulated whole" for label, share in uncovered.items()),
        *([f"too wide to test: {enumeration(untested)}"] if untested else []),
        *(
            [f"bands {significant(widest, 2)} times as wide as the error: cautious, as 2 hold 95 %"]
            if widest > _CAUTIOUS
            else []
        ),
    ]
    is_kept = bool(shares or bands) and min(judged, default=0.0) >= LEAST_COVERAGE
    return KeyFact(name, "; ".join(clauses), "prediction", None if is_kept and widest > _CAUTIOUS else is_kept)


def _band_shares(fit: Fit) -> tuple[dict[str, float], list[str]]:
    """Share of samples inside the bands of the longest windows, by quantity; quantities whose bands test nothing."""
    shares, untested = dict[str, float](), list[str]()
    windows = [w for p in fit.validation if (w := _longest_windows(p))]
    for key in dict.fromkeys(key for w in windows for key in w.scores):
        scores = [(w.scores[key], w.count) for w in windows if key in w.scores]
        bands = [(score.inside_band, count) for score, count in scores if score.inside_band is not None]
        label = ERROR_LABELS[key][0]
        if bands and all(score.is_band_too_wide for score, _ in scores if score.inside_band is not None):
            untested.append(f"the band of {label}")
        elif bands:
            shares[label] = sum(share * count for share, count in bands) / sum(count for _, count in bands)
    return shares, untested


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


def whole_run_shares(fit: Fit) -> dict[str, float]:
    """Return the share of headings and positions inside their 95 % bands where runs are simulated whole, by quantity.

    A sample scatters about the band by the noise of its sensor and by waves.
    """
    noise = {} if fit.noise_model is None else fit.noise_model.measurement
    shares = dict[str, float]()
    for key in ("psi_deg", "position_m"):
        parts = [_inside_band(p, c, noise.get(c, 0.0)) for p in fit.validation for c in ERROR_CHANNELS[key][0]]
        if len(samples := np.concatenate([np.zeros(0, bool), *parts])):
            shares[ERROR_LABELS[key][0]] = float(np.mean(samples))
    return shares


def _inside_band(p: Prediction, channel: str, noise: float) -> np.ndarray:
    """Whether each sample of a channel lies inside its band, widened by the sensor's noise; none without a band."""
    if not all(channel in values for values in (p.half_width, p.measured, p.simulated)):
        return np.zeros(0, bool)
    apart = p.measured[channel] - p.simulated[channel]
    apart = np.abs(np.angle(np.exp(1j * apart)) if channel == "psi" else apart)
    band = np.hypot(p.half_width[channel], two_sided_quantile(STORED_LEVEL, math.inf) * noise)
    judged = np.isfinite(apart) & np.isfinite(band)
    return apart[judged] <= band[judged]


def _known_values(fit: Fit) -> tuple[KeyFact, ...]:
    """How many known values lie inside the intervals, and which do not; no row where none is known."""
    known = [c for c in fit.coefficients if not c.fixed and c.truth is not None and c.lower is not None]
    outside = [c.name for c in known if not (c.lower or 0.0) <= (c.truth or 0.0) <= (c.upper or 0.0)]
    text = f"{len(known) - len(outside)} of {len(known)} inside their 95 % intervals"
    names = f"; outside: {enumeration(outside, MAX_NAMES)}" if outside else ""
    return (KeyFact("Known values", f"{text}{names}", "coefficients", not outside),) if known else ()


def _identifiability(fit: Fit) -> KeyFact:
    """How many coefficients the records determine, whose sign they leave open, and the least certain of the others."""
    content, free = fit.identifiability, [c for c in fit.coefficients if not c.fixed]
    if content is None or not math.isfinite(content.effective_parameters):
        return KeyFact("Identifiability", "not examined", "identifiability" if fit.noise_model else "")
    number = round(content.effective_parameters)
    is_complete = number >= len(free)
    every = {1: "the coefficient", 2: "both coefficients"}.get(len(free), f"all {len(free)} coefficients")
    text = every if is_complete else f"{number} of {len(free)} combinations of coefficients"
    if not is_complete and any(c.prior_mean is not None for c in free):
        text += ", the others by their priors"
    vague = [c.name for c in free if c.is_sign_open]
    widths = {c.name: width for c in free if not c.is_sign_open and math.isfinite(width := relative_half_width(c))}
    widest = max(widths, key=lambda name: widths[name], default="")
    clauses = [
        text,
        *([f"sign open: {enumeration(vague, MAX_NAMES)}"] if vague else []),
        *(
            [f"least certain{' of the others' if vague else ''}: {widest} ± {significant(100.0 * widths[widest], 2)} %"]
            if widest
            else []
        ),
        *([] if has_converged(fit) else ["the search did not converge"]),
    ]
    is_good = is_complete and not vague and has_converged(fit)
    return KeyFact("Identifiability", "; ".join(clauses), "identifiability", is_good)


def _warnings(fit: Fit) -> KeyFact:
    codes = list(dict.fromkeys(f.code for f in worst_first(fit.findings) if f.severity is not Severity.INFO))
    if not has_converged(fit):
        codes = [NOT_CONVERGED, *(code for code in codes if code != NOT_CONVERGED)]
    if not codes:
        return KeyFact("Warnings", "none", "findings" if fit.findings else "", is_good=True)
    consequences = f"; then {enumeration(codes[1:], MAX_NAMES - 1)}" if codes[1:] else ""
    text = f"{'begin with ' if consequences else ''}{codes[0]}{consequences}"
    return KeyFact("Warnings", text, "findings" if fit.findings else "method", is_good=False)
