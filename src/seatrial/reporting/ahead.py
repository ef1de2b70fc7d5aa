"""Chapters on predictions some samples ahead and on frequency responses."""

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit, FrequencyResponse, KStepErrors
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.values import display_unit
from seatrial.core.values.notation import channel_letter
from seatrial.reporting.figures.frequency_chart import frequency_chart
from seatrial.reporting.figures.k_step_chart import k_step_chart
from seatrial.reporting.section import Column, Level, Picture, Section, number, table_of, words

_ROLES = {"validation": "held-out runs", "training": "training runs"}
_AHEAD_NOTE = (
    "The Kalman filter of the fit takes the measured samples up to a moment; model and recorded inputs go on from "
    "there. Root-mean-square error over many moments, in brackets that of the last value held. With noise of the "
    "sensors only, every horizon has the error of a simulation."
)
_COMPARED_NOTE = (
    "Cross-spectrum over input spectrum (H1; Welch 1967) of what was measured, and by the same estimator of the model "
    "simulated with the same inputs. Compared: frequencies at which the input has a thousandth of its largest density "
    "or more and the 95 % region of the records leaves zero out. Chance takes the model out of the region at one in "
    "twenty. Where a controller was on, disturbances bias the response of the records."
)


def k_step_section(fit: Fit) -> Section:
    """Return the chapter on errors over the horizon; empty where the fit has none."""
    if not fit.k_step_errors:
        return Section("")
    longest = max(fit.k_step_errors, key=lambda e: len(e.steps))
    dt = longest.seconds[0] / longest.steps[0]
    horizons = sorted({k for e in fit.k_step_errors for k in e.steps})
    ordered = [e for role in _ROLES for e in fit.k_step_errors if e.role == role]
    table = table_of(
        ordered,
        words("Channel", lambda e: f"{channel_letter(e.channel)}, {display_unit(e.unit)[1]}"),
        words("runs", lambda e: _ROLES[e.role]),
        *(_horizon_column(k, k * dt) for k in horizons),
    )
    picture = Picture(lambda: svg(k_step_chart(fit.k_step_errors)), "Root-mean-square error over the horizon.")
    return Section(
        "Prediction some samples ahead",
        "ahead",
        table=table,
        note=_AHEAD_NOTE,
        pictures=(picture,),
        level=Level.DETAIL,
        is_folded=True,
    )


def _horizon_column(steps: int, seconds: float) -> Column[KStepErrors]:
    def text(e: KStepErrors) -> str:
        if steps not in e.steps:
            return ""
        factor, place = display_unit(e.unit)[0], e.steps.index(steps)
        return f"{significant(factor * e.rms[place], 3)} ({significant(factor * e.held_rms[place], 3)})"

    return number(f"{steps} ({exact(seconds, 3)} s)", text)


def frequency_section(fit: Fit) -> Section:
    """Return the chapter on frequency responses of records and model; empty where the fit has none."""
    if not fit.frequency_responses:
        return Section("")
    table = table_of(
        fit.frequency_responses,
        words("Response", lambda r: f"{channel_letter(r.output)} over {channel_letter(r.input)}"),
        number("excited", lambda r: " to ".join(significant(w, 2) for w in r.excited_range), "rad/s"),
        number("compared", lambda r: str(int(r.is_compared.sum()))),
        number("model inside", lambda r: _where_compared(r, str(int((r.is_inside & r.is_compared).sum())))),
        number("coherence there, mean", _coherence),
    )
    caption = "Magnitude and phase with the 95 % region of the records (Jenkins & Watts 1968, section 10.3)."
    picture = Picture(
        lambda: "" if (chart := frequency_chart(fit.frequency_responses)) is None else svg(chart), caption
    )
    return Section(
        "Frequency response: records and model",
        "frequency",
        table=table,
        note=_COMPARED_NOTE,
        pictures=(picture,),
        level=Level.DETAIL,
        is_folded=True,
    )


def _where_compared(r: FrequencyResponse, text: str) -> str:
    return text if r.is_compared.any() else ""


def _coherence(r: FrequencyResponse) -> str:
    return fixed(float(r.coherence[r.is_compared].mean()), 2) if r.is_compared.any() else ""
