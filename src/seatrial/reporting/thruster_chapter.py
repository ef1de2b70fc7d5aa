"""The chapter on a craft with thrusters: what it does, its thrust and compass curves, its matrices."""

from collections.abc import Mapping, Sequence
from functools import partial

from seatrial.core.figures.svg_text import svg
from seatrial.core.results.ship_motions import CompassCurve, CraftMeasure, FossenMatrix, ThrusterCraft
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.reporting.figures.thruster_charts import compass_chart, quadrant_chart, thrust_chart
from seatrial.reporting.measures import craft_estimate, is_extrapolated
from seatrial.reporting.section import Level, Picture, Section, TextTable, number, plain_table, table_of, words

MEASURE_LABELS = {
    "top_speed": "top speed, m/s",
    "surge_time_constant_s": "time constant of surge (63 % of top speed), s",
    "yaw_rate_deg_s": "yaw rate of a spin, deg/s",
    "yaw_time_constant_s": "time constant of yaw (63 % of that rate), s",
    "time_360_s": "time of a full turn, s",
    "circle_yaw_rate_deg_s": "yaw rate of a circle at 35 deg, deg/s",
    "tactical_diameter_L": "tactical diameter at 35 deg, craft lengths",
    "time_90_s": "time to 90 deg change of heading at 35 deg, s",
    "stopping_distance_m": "stopping distance, m",
    "stopping_time_s": "stopping time, s",
}
_PROGRAMME_TEXTS = {
    "straight": "straight from rest with full command ahead",
    "spin": "a spin from rest with full opposite commands",
    "turning-circle": "a circle with a steering angle of 35 deg and full command, in still water",
    "stop": "full astern at full speed",
}
FAR_NOTE = "Extrapolated: beyond the training runs, its interval is a lower limit."
_PER_MASS = (
    "No thrust is known in newtons, so that only ratios to m + m_x are determined: M, D and thrusts are those on each "
    "kilogram of it. Multiply all of them by m + m_x."
)
_EQUATION = "M dν/dt + C(M) ν + D(ν) ν = B T, ν = (u, v, r)"
_THRUST_CAPTION = (
    "Dashed: with the loss that speed through the water brings. Bars: how long each command was given, on a root "
    "scale; where there are none, the curve is an extrapolation of its formula."
)
_QUADRANT_CAPTION = (
    "Each thruster’s command over the speed of the craft along it. Outlined: the runs held out. Where they leave the "
    "training runs, above all into another quadrant, the extrapolation index grows and with it the bands."
)
_COMPASS_CAPTION = (
    "True heading minus the heading shown. Bars: how long each heading was shown in the training runs, on a root scale."
)
MATRIX_DIGITS = 4  # significant; chosen


def thruster_section(craft: ThrusterCraft | None) -> Section:
    """Return the chapter on what a craft with thrusters does; empty for a model without thrusters."""
    if craft is None:
        return Section("")
    notes = (*((_PER_MASS,) if craft.force_unit != "N" else ()), *_left_out(craft))
    curves = [
        Section(
            "Thrust over command",
            pictures=(Picture(lambda: svg(thrust_chart(craft.curves, craft.force_unit)), _THRUST_CAPTION),),
        ),
        Section(
            "Where commands and speeds were",
            pictures=(Picture(lambda: svg(quadrant_chart(craft.quadrants)), _QUADRANT_CAPTION),)
            if craft.quadrants
            else (),
        ),
        Section(
            "Deviation of the compass",
            pictures=() if craft.compass is None else (Picture(partial(_compass, craft.compass), _COMPASS_CAPTION),),
        ),
    ]
    matrices = Section(
        "Matrices",
        sentences=(f"{_EQUATION} (Fossen 2021, chapter 6).", *notes),
        parts=_matrix_parts(craft),
        level=Level.PAGE,
        is_folded=True,
    )
    return Section(
        "The craft at full command",
        "thrusters",
        table=_measures(craft.measures),
        note=_programmes(craft.measures),
        parts=(*curves, matrices),
    )


def _compass(deviation: CompassCurve) -> str:
    return svg(compass_chart(deviation))


def _left_out(craft: ThrusterCraft) -> tuple[str, ...]:
    if not craft.left_out:
        return ()
    return (f"Not in these matrices: the terms of {enumeration(craft.left_out)} (see Equations of the model).",)


def _measures(measures: Mapping[str, CraftMeasure]) -> TextTable:
    rows = [(label, measures[name]) for name, label in MEASURE_LABELS.items() if name in measures]
    return table_of(
        rows,
        words("", lambda row: f"{row[0]}{', extrapolated' if is_extrapolated(row[1]) else ''}"),
        number("estimate", lambda row: craft_estimate(row[1]).value),
        number("95 % from", lambda row: craft_estimate(row[1]).lower),
        number("to", lambda row: craft_estimate(row[1]).upper),
    )


def _programmes(measures: Mapping[str, CraftMeasure]) -> str:
    done = {m.programme.partition(":")[0] for m in measures.values()}
    texts = ", ".join(text for kind, text in _PROGRAMME_TEXTS.items() if kind in done)
    far = f" {FAR_NOTE}" if any(is_extrapolated(m) for m in measures.values()) else ""
    return f"Simulated with the estimate: {texts}.{far}" if measures else ""


def _matrix_parts(craft: ThrusterCraft) -> tuple[Section, ...]:
    """M, D(nu) with all its parts in each element, and B: rows surge, sway, yaw."""
    by_name = {m.name: m for m in craft.matrices}
    parts = [m for name, m in by_name.items() if name.startswith("D")]
    damping = [[_sum([(m.name, m.values[i][j]) for m in parts]) for j in range(3)] for i in range(3)]
    M, B = by_name["M"], by_name["B"]
    return (
        _matrix(f"M: {M.meaning}", ("u", "v", "r"), _elements(M), "kg, kg m and kg m²."),
        _matrix("D(ν): damping", ("u", "v", "r"), damping, "SI units, with u and v in m/s, r in rad/s."),
        _matrix(f"B: {B.meaning}", craft.thrusters, _elements(B), "Arms of yaw in m."),
    )


def _matrix(title: str, columns: Sequence[str], elements: Sequence[Sequence[str]], note: str) -> Section:
    rows = [(axis, *row) for axis, row in zip(("surge", "sway", "yaw"), elements, strict=True)]
    return Section(title, table=plain_table(("", *columns), rows), note=note)


def _elements(m: FossenMatrix) -> list[list[str]]:
    return [[_number(value) for value in row] for row in m.values]


def _number(value: float) -> str:
    return "0" if value == 0.0 else significant(value, MATRIX_DIGITS)


def _sum(terms: Sequence[tuple[str, float]]) -> str:
    """The terms of an element of D(nu) that are not zero: of ``D`` as they are, of ``D_u`` times ``|u|``."""
    text = ""
    for name, value in terms:
        if value != 0.0:
            factor = "" if name == "D" else f" |{name[-1]}|"
            sign = ("−" if value < 0.0 else "") if not text else (" − " if value < 0.0 else " + ")
            text += f"{sign}{significant(abs(value), MATRIX_DIGITS)}{factor}"
    return text or "0"
