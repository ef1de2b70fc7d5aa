"""The chapter on a craft with thrusters: what it does, its thrust and compass curves, its matrices."""

from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results.ship_motions import CraftMeasure, FossenMatrix, ThrusterCraft
from seatrial.core.text.numbers import DASH, estimate_text, significant
from seatrial.core.text.words import enumeration
from seatrial.reporting.figures.thruster_charts import compass_chart, quadrant_chart, thrust_chart
from seatrial.reporting.measures import is_extrapolated
from seatrial.reporting.text_tables import TextTable

MEASURE_LABELS = {
    "top_speed": "top speed, m/s", "surge_time_constant_s": "time constant of surge (63 % of top speed), s",
    "yaw_rate_deg_s": "yaw rate of a spin, deg/s", "yaw_time_constant_s": "time constant of yaw (63 % of that rate), s",
    "time_360_s": "time of a full turn, s", "circle_yaw_rate_deg_s": "yaw rate of a circle at 35 deg, deg/s",
    "tactical_diameter_L": "tactical diameter at 35 deg, craft lengths",
    "time_90_s": "time to 90 deg change of heading at 35 deg, s", "stopping_distance_m": "stopping distance, m",
    "stopping_time_s": "stopping time, s",
}  # fmt: skip
_PROGRAMME_TEXTS = {
    "straight": "straight from rest with full command ahead", "spin": "a spin from rest with full opposite commands",
    "turning-circle": "a circle with a steering angle of 35 deg and full command, in still water",
    "stop": "full astern at full speed",
}  # fmt: skip
FAR_NOTE = "* beyond the training runs: read the interval as a lower limit."
_PER_MASS = (
    "No thrust is known in newtons, so that only ratios to m + m_x are determined: M, D and thrusts are those on each "
    "kilogram of it. Multiply all of them by m + m_x."
)
MATRIX_DIGITS = 4  # significant; chosen


@dataclass(frozen=True)
class ThrusterChapter:
    """Tables and figures, each figure with its caption."""

    measures: TextTable | None
    thrust: Markup
    thrust_caption: str
    quadrants: Markup | None
    compass: Markup | None
    matrices: tuple[TextTable, ...]
    equation: str
    notes: tuple[str, ...]


def thruster_chapter(craft: ThrusterCraft | None) -> ThrusterChapter | None:
    """Return the chapter; None for a model without thrusters."""
    if craft is None:
        return None
    notes = (*((_PER_MASS,) if craft.force_unit != "N" else ()), *_left_out(craft))
    caption = (
        "Dashed: with the loss that speed through the water brings. Bars: how long each command was given, on a root "
        "scale; where there are none, the curve is an extrapolation of its formula."
    )
    return ThrusterChapter(
        _measures_table(craft.measures) if craft.measures else None,
        Markup(svg(thrust_chart(craft.curves, craft.force_unit))), caption,
        Markup(svg(quadrant_chart(craft.quadrants))) if craft.quadrants else None,
        None if craft.compass is None else Markup(svg(compass_chart(craft.compass))),
        _matrix_tables(craft), "M dν/dt + C(M) ν + D(ν) ν = B T, ν = (u, v, r)", notes,
    )  # fmt: skip


def _left_out(craft: ThrusterCraft) -> tuple[str, ...]:
    if not craft.left_out:
        return ()
    return (f"Not in these matrices: the terms of {enumeration(craft.left_out)} (see Equations of the model).",)


def _measures_table(measures: dict[str, CraftMeasure]) -> TextTable:
    rows, far = [], False
    for name, label in MEASURE_LABELS.items():
        m = measures.get(name)
        if m is None:
            continue
        far = far or is_extrapolated(m)
        error = None if m.lower is None or m.upper is None else 0.5 * (m.upper - m.lower)
        text = estimate_text(m.value, error, m.lower, m.upper)
        star = " *" if is_extrapolated(m) else ""
        rows.append((f"{label}{star}", text.value, text.lower or DASH, text.upper or DASH))
    done = {m.programme.partition(":")[0] for m in measures.values()}
    texts = ", ".join(text for kind, text in _PROGRAMME_TEXTS.items() if kind in done)
    note = f"Simulated with the estimate: {texts}.{f' {FAR_NOTE}' if far else ''}"
    return TextTable(
        "What the craft does at full command", ("", "estimate", "95 % from", "to"), (False, True, True, True),
        tuple(rows), note,
    )  # fmt: skip


def _matrix_tables(craft: ThrusterCraft) -> tuple[TextTable, ...]:
    """M, D(nu) with all its parts in each element, and B: rows surge, sway, yaw."""
    by_name = {m.name: m for m in craft.matrices}
    parts = [m for name, m in by_name.items() if name.startswith("D")]
    damping = [[_sum([(m.name, m.values[i][j]) for m in parts]) for j in range(3)] for i in range(3)]
    M, B = by_name["M"], by_name["B"]
    return (
        _matrix_table(f"M: {M.meaning}", ("u", "v", "r"), _elements(M), "kg, kg m and kg m²."),
        _matrix_table("D(ν): damping", ("u", "v", "r"), damping, "SI units, with u and v in m/s, r in rad/s."),
        _matrix_table(f"B: {B.meaning}", craft.thrusters, _elements(B), "Arms of yaw in m."),
    )


def _matrix_table(title: str, columns: Sequence[str], elements: Sequence[Sequence[str]], note: str) -> TextTable:
    rows = tuple((axis, *row) for axis, row in zip(("surge", "sway", "yaw"), elements, strict=True))
    return TextTable(title, ("", *columns), (False, *(True for _ in columns)), rows, note)


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
