"""The page of a designed manoeuvre: what it is worth beside standard ones, how to steer it, where the ship goes."""

import math
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.equations.latex import symbol
from seatrial.core.figures import channels, steered
from seatrial.core.figures.errors import Dots, dots
from seatrial.core.results import Actuator, Design, Worth
from seatrial.core.results.worths import best_rival, drawn_errors, error_of, has_track, keeps, ranked, worst_drawn
from seatrial.core.text import words
from seatrial.core.text.numbers import DASH, exact, fixed, significant
from seatrial.core.values import NOTATION
from seatrial.data.folder.orders import row, shown_unit
from seatrial.reporting import told_design
from seatrial.reporting.mathml import inline
from seatrial.reporting.page import environment
from seatrial.reporting.tables import findings
from seatrial.reporting.told_design import NOTHING

TITLES = {
    "answer": "Question and answer",
    "orders": "What to steer",
    "coefficients": "What it tells of each coefficient",
    "track": "Where the ship goes",
    "ships": "If the ship is not as assumed",
    "confirmation": "Simulated trials",
    "findings": "Findings",
    "method": "How it was made",
}
MOST_COLUMNS, FEW, MOST_RIVALS = 4, 12, 3
_TOWARDS = {"starboard": "to starboard", "port": "to port"}


@dataclass(frozen=True)
class WorthRow:
    """One manoeuvre as text, errors in per cent."""

    name: str
    worst: str
    mean: str
    drawn: str
    drift: str
    room: str
    is_designed: bool
    keeps: bool


@dataclass(frozen=True)
class CoefficientRow:
    """One coefficient: relative standard errors in per cent under the design and the rivals; fits beside the bound."""

    symbol: Markup
    name: str
    value: str
    spread: str
    designed: str
    rivals: tuple[str, ...]
    found: str
    foretold: str


def html(design: Design) -> str:
    """The page as text; sections without content are left out."""
    rivals = ranked(design)
    track = steered.track(design) if has_track(design) else ""
    shown = {
        "track": bool(track),
        "ships": bool(len(design.designed.drawn)),
        "confirmation": design.confirmation is not None,
        "findings": bool(design.findings),
    }
    context: dict[str, object] = {
        "design": design,
        "titles": {key: title for key, title in TITLES.items() if shown.get(key, True)},
        "answer": told_design.sentences(design),
        "facts": told_design.facts(design),
        "settings": told_design.settings(design),
        "worths": [_worth(w, design) for w in (design.designed, *rivals)],
        "heads": order_heads(design.actuators),
        "meanings": order_meanings(design.actuators),
        "order_columns": order_columns(design),
        "over_time": Markup(steered.over_time(design)),
        "channels": [Markup(figure) for figure in channels.overview([design.designed.executed])],
        "has_track": has_track(design),
        "rivals": [w.name for w in rivals[:MOST_RIVALS]],
        "coefficients": _coefficients(design, rivals[:MOST_RIVALS]),
        "speed": _approach(design),
        "errors": Markup(_errors(design)),
        "track": Markup(track),
        "ships": Markup(_ships(design, rivals)),
        "findings": findings(design.findings),
    }
    return environment().get_template("design.html").render(context)


def per_cent(share: float) -> str:
    """Per cent with two digits, as far as they mean anything."""
    if math.isnan(share):
        return DASH
    return significant(100.0 * share, 2) if share < NOTHING else f"> {significant(100.0 * NOTHING, 1)}"


def clock(seconds: float) -> str:
    """``2:05``, ``0:07.5``."""
    minutes, rest = divmod(round(seconds, 2), 60.0)
    return f"{int(minutes)}:{exact(rest, 4).rjust(2, '0') if rest >= 10 else '0' + exact(rest, 4)}"


def order_heads(actuators: tuple[Actuator, ...]) -> list[tuple[Markup, str]]:
    """Symbol and unit of each column of the helmsman's table after the time."""
    return [(Markup(inline(_latex(a.name))), shown_unit(a.name)[1]) for a in actuators]


def order_meanings(actuators: tuple[Actuator, ...]) -> list[tuple[Markup, str]]:
    """Symbol and meaning of each input, with its positive direction."""
    return [(Markup(inline(_latex(a.name))), _meaning(a.name)) for a in actuators]


def _latex(name: str) -> str:
    return NOTATION[name].latex if name in NOTATION else symbol(name)


def _meaning(name: str) -> str:
    if name not in NOTATION or NOTATION[name].positive == "none":
        return words.channel(name)
    return f"{NOTATION[name].meaning}, positive {_TOWARDS.get(NOTATION[name].positive, NOTATION[name].positive)}"


def order_columns(design: Design) -> list[list[list[str]]]:
    """The helmsman's table cut into columns that stand side by side: minutes and seconds, then the orders."""
    rows = [
        [clock(order.time), *(cell.replace("-", "−") or DASH for cell in row(order, design.actuators)[1:])]
        for order in design.orders
    ]
    count = min(MOST_COLUMNS, max(1, math.ceil(len(rows) / FEW)))
    each = math.ceil(len(rows) / count) if rows else 1
    return [rows[k : k + each] for k in range(0, len(rows), each)]


def _approach(design: Design) -> str:
    """The option of `simulate` that starts a replay as the design did; empty for a model without surge."""
    executed = design.designed.executed
    return f" --speed {float(executed['u'][0]):.7g}" if "u" in design.model.states and "u" in executed else ""


def _worth(worth: Worth, design: Design) -> WorthRow:
    return WorthRow(
        worth.name, per_cent(worth.worst), per_cent(worth.mean), per_cent(worst_drawn(worth)),
        fixed(math.degrees(worth.drift), 1) if math.isfinite(worth.drift) else DASH, significant(worth.room, 3),
        worth is design.designed, keeps(worth, design.limits),
    )  # fmt: skip


def _coefficients(design: Design, rivals: tuple[Worth, ...]) -> list[CoefficientRow]:
    known = design.confirmation
    return [
        CoefficientRow(
            Markup(inline(design.model.parameters[name].latex or symbol(name))),
            name,
            significant(design.model.parameters[name].value, 4),
            per_cent(float(design.spread[i])),
            per_cent(float(design.designed.relative[i])),
            tuple(per_cent(float(rival.relative[i])) for rival in rivals),
            per_cent(float(known.error[i])) if known else "",
            per_cent(float(known.bound[i])) if known else "",
        )
        for i, name in enumerate(design.coefficients)
    ]


def _errors(design: Design) -> str:
    """Dots for each coefficient: the design and the best standard manoeuvre."""
    rival = best_rival(design)
    series = [Dots(rival.name, [[100.0 * float(x)] for x in rival.relative], "open")] if rival else []
    series.append(Dots("designed", [[100.0 * float(x)] for x in design.designed.relative], "filled"))
    return dots(design.coefficients, series, "relative standard error, per cent of the coefficient")


def _ships(design: Design, rivals: tuple[Worth, ...]) -> str:
    """A row for each manoeuvre, a dot for each ship drawn from the prior."""
    worths = (design.designed, *rivals)
    drawn = Dots("ships drawn from the prior", [[100.0 * x for x in drawn_errors(w, design.criterion)] for w in worths],
                 "open")  # fmt: skip
    assumed = Dots("the ship as assumed", [[100.0 * error_of(w, design.criterion)] for w in worths], "tick")
    kind = "worst" if design.criterion == "worst" else "mean"
    return dots([w.name for w in worths], [drawn, assumed], f"{kind} relative standard error, per cent")
