"""The records' chapter: channels, residuals and the wind."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit, Noise, Offset, OffsetPopulation
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.text.numbers import DASH, estimate_text, exact, p_value, significant
from seatrial.core.text.numbers import fixed as decimals
from seatrial.core.text.words import common_prefix
from seatrial.core.values import Record, display_unit
from seatrial.core.values.notation import channel_meaning, unit_text
from seatrial.reporting.figures.record_charts import residual_series, track_overview, whiteness_chart
from seatrial.reporting.model_chapter import residual_sentence, steering_zero_note
from seatrial.reporting.runs import drawn_predictions, hidden_runs_sentence
from seatrial.reporting.section import Cell, Level, Picture, Section, name, number, table_of, words

# The wind of the day, as it was recorded beside the runs.

_WIND = {"wind_speed", "wind_direction"}


def wind_sentence(records: Sequence[Record]) -> str:
    """Return the mean of the recorded true wind over all samples, and the range over the runs; empty without any.

    The mean is that of the velocity towards north and east; directions are those that the wind comes from.
    """
    winds = [r["wind_speed"] * np.exp(1j * r["wind_direction"]) for r in records if set(r.channels) >= _WIND]
    means = [complex(np.nanmean(wind)) for wind in winds if np.isfinite(wind).any()]
    if not means:
        return ""
    mean = complex(np.nanmean(np.concatenate(winds)))
    course = round(math.degrees(math.atan2(mean.imag, mean.real))) % 360
    text = f"Wind as recorded, mean over the runs: {significant(abs(mean), 2)} m/s from {course:03d}°"
    if len(means) == 1:
        return f"{text}."
    low, high = (significant(f(abs(one) for one in means), 2) for f in (min, max))
    return f"{text}, {low} to {high} m/s in single runs."


# Chapters on the records: what they are, what the fit leaves of them, and what is off by session.

_WHITENESS_NOTE = (
    "Whiteness: two portmanteau tests (Ljung & Box 1978; 20 and 100 lags); p is twice the smaller of their p-values. A "
    "channel is white from p = 0.01 divided by the number of channels."
)
_ASSUMED_SPREAD = "One session was recorded: how offsets differ between sessions is assumed, not estimated."
_SESSION_NOTE = "A held-out run of a session that was fitted takes that session's offsets, another what is expected."


def record_section(fit: Fit) -> Section:
    """Return the chapter on the records: role, length, channels, tracks, and where they come from."""
    held, drawn = {p.record for p in fit.validation}, {p.record for p in drawn_predictions(fit.predictions)}
    prefix = common_prefix([r.name for r in fit.records])
    without = f" Names without their common beginning, {prefix}." if prefix else ""
    caption = (
        "Tracks from above, metres; long and narrow ones lie on their side, north (x₀) to the right and east (y₀) "
        f"downwards, the others with north up. Ships at equal times, to scale.{without} "
        f"{hidden_runs_sentence(fit.predictions)}"
    )
    length = fit.ship.particulars.get("L", 0.0)
    tracked = [r for r in fit.records if r.name in drawn] or list(fit.records)
    table = table_of(
        fit.records,
        words("Record", lambda r: r.name),
        words("Role", lambda r: "held out" if r.name in held else "fitted"),
        number("duration", lambda r: decimals(r.duration, 0), "s"),
        number("samples", lambda r: decimals(float(len(r)), 0)),
        number("rate", lambda r: exact((len(r) - 1) / r.duration, 3) if r.duration > 0 else DASH, "Hz"),
        words("Channels", lambda r: ", ".join(r.channels)),
        is_marked=lambda r: r.name in held,
    )
    sentences = (text,) if (text := wind_sentence(fit.records)) else ()
    picture = Picture(lambda: svg(track_overview(tracked, length)), caption)
    return Section(
        "Records",
        "records",
        sentences,
        table=table,
        pictures=(picture,),
        parts=(_provenance(fit.records),),
        level=Level.PAGE,
        is_folded=True,
    )


def _provenance(records: tuple[Record, ...]) -> Section:
    table = table_of(
        records,
        words("Record", lambda r: r.name),
        words("Source", lambda r: r.provenance.source.rsplit("/", 1)[-1] or DASH),
        name("SHA-256, first 12", lambda r: r.provenance.sha256[:12]),
        words("Steps", lambda r: "; ".join(r.provenance.steps) or "none"),
    )
    return Section("Where the records come from and what was done to them", table=table, is_folded=True)


def residual_section(fit: Fit) -> Section:
    """Return the chapter on what the fit leaves of the training runs."""
    table = table_of(
        fit.channel_noise,
        name("Channel", lambda n: n.channel),
        words("", lambda n: channel_meaning(n.channel), is_wide=True),
        number("noise, std. dev.", lambda n: significant(n.standard_deviation * display_unit(n.unit)[0], 3)),
        words("unit", lambda n: unit_text(n.unit)),
        number("correlation time", _correlation_time, "s"),
        number("whiteness p", lambda n: p_value(n.whiteness_p).removeprefix("p ").removeprefix("= ")),
        words("", lambda n: "white" if n.is_white else "not white"),
    )
    pictures = (
        (
            Picture(lambda: residual_series(fit.residuals), "Residuals of the training runs, one after another."),
            Picture(
                lambda: svg(whiteness_chart(fit.residuals)),
                "Autocorrelation of the residuals with the 95 % band of "
                "white residuals; their histogram beside the normal distribution (dashed).",
            ),
        )
        if fit.residuals
        else ()
    )
    sentences = (text,) if (text := residual_sentence(fit)) else ()
    return Section(
        "Residuals",
        "residuals",
        sentences,
        table=table,
        note=_WHITENESS_NOTE if table else "",
        pictures=pictures,
        level=Level.PAGE,
        is_folded=True,
    )


def _correlation_time(n: Noise) -> str:
    """Of coloured residuals: that of white ones is their sample interval."""
    return "" if n.is_white else significant(n.correlation_time, 2)


def offset_section(fit: Fit) -> Section:
    """Return the chapter on what sessions are off by: what is expected of a new one, and of each that was fitted."""
    population = table_of(
        fit.offset_populations,
        words("", lambda one: one.name),
        number("expected", lambda one: _value_text(one, one.mean)),
        number("std. error", lambda one: _value_text(one, one.standard_error) if one.standard_error > 0.0 else ""),
        number("between sessions", lambda one: _value_text(one, one.deviation)),
        words("unit", lambda one: unit_text(one.unit)),
        words("depends on the rms of", _covariate),
    )
    is_single = len({offset.group for offset in fit.offsets}) == 1
    return Section(
        "Offsets of a new session",
        "offsets",
        sentences=(_ASSUMED_SPREAD,) if population and is_single else (),
        note=steering_zero_note(fit) if population else "",
        table=population,
        parts=(_of_sessions(fit.offsets),),
        is_folded=True,
    )


def _covariate(population: OffsetPopulation) -> str:
    """The input, with the change for one standard deviation of it, and whether that is more than chance explains."""
    if population.slope is None or population.slope_standard_error is None:
        return ""
    size, error = (_value_text(population, value) for value in (population.slope, population.slope_standard_error))
    is_chance = abs(population.slope) <= two_sided_quantile(STORED_LEVEL, math.inf) * population.slope_standard_error
    return f"{population.covariate}: {size} ± {error} a standard deviation{', by chance' if is_chance else ''}"


def _value_text(population: OffsetPopulation, value: float) -> str:
    return significant(value * display_unit(population.unit)[0], 2)


def _of_sessions(offsets: tuple[Offset, ...]) -> Section:
    names = dict.fromkeys((o.name, o.unit) for o in offsets)
    cells = {(o.group, o.name): _offset_cell(o) for o in offsets}

    def of_group(name: str, group: str) -> Cell | None:
        return cells.get((group, name))

    table = table_of(
        list(dict.fromkeys(o.group for o in offsets)),
        words("Run or session", lambda group: group),
        *(number(offset, partial(of_group, offset), unit_text(unit)) for offset, unit in names),
    )
    return Section("Offsets of each session", table=table, note=_SESSION_NOTE if table else "", level=Level.DETAIL)


def _offset_cell(o: Offset) -> Cell:
    factor = display_unit(o.unit)[0]
    error = None if o.standard_error is None else o.standard_error * factor
    text = estimate_text(o.estimate * factor, error, None, None)
    return Cell(f"{text.value}{text.power}", f"± {text.error}" if text.error not in ("", DASH) else "")
