"""The page of a tuned controller: recommendation, front, margins, simulation, schedule, the loop itself."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures import demanded, fronts, loop_diagram, margins, schedule_maps, voyages
from seatrial.core.figures.bars import bars
from seatrial.core.results import Bars
from seatrial.core.results.tuning import Tuning
from seatrial.core.text.words import channel
from seatrial.reporting import told_tuning, tuning_rows
from seatrial.reporting.page import environment
from seatrial.reporting.tables import findings

TITLES = {
    "answer": "Recommendation",
    "findings": "Findings",
    "controllers": "Controllers compared",
    "front": "Front",
    "margins": "Margins",
    "sailed": "Simulation with limits and stall",
    "manoeuvres": "Demands followed",
    "schedule": "Schedule",
    "bounds": "What no linear controller does better",
    "loop": "The loop",
    "method": "How it was made",
}
FOLDED = 40


def html(tuning: Tuning) -> str:
    """The page as text; sections without content are left out."""
    drawn, controllers = fronts.fronts(tuning), tuning_rows.controller_rows(tuning)
    shown = {
        "findings": bool(tuning.findings), "front": bool(drawn), "margins": len(margins.styled(tuning)) > 0,
        "sailed": bool(tuning.sailed), "manoeuvres": bool(tuning.manoeuvres), "schedule": bool(tuning.schedule),
        "bounds": bool(tuning.bounds), "loop": bool(tuning.components),
    }  # fmt: skip
    context: dict[str, object] = {
        "tuning": tuning,
        "titles": {key: title for key, title in TITLES.items() if shown.get(key, True)},
        "answer": told_tuning.sentences(tuning),
        "facts": told_tuning.facts(tuning),
        "settings": told_tuning.settings(tuning),
        "gains": list(zip(map(tuning_rows.gain_symbol, tuning.chosen.gains), controllers[0].gains, strict=False)),
        "findings": findings(tuning.findings),
        "output": channel(tuning.output),
        "actuator": channel(tuning.actuator),
        "gain_names": [(name, tuning_rows.gain_symbol(name)) for name in tuning_rows.gain_names(tuning)],
        "objectives": [
            (name, fronts.people_s(unit)[1]) for name, unit in zip(tuning.objectives, tuning.units, strict=True)
        ],
        "rms_heads": tuning_rows.rms_heads(tuning),
        "has_reduction": told_tuning.is_compared(tuning),
        "controllers": controllers,
        "front": Markup(drawn),
        "sensitivities": Markup(margins.sensitivities(tuning)),
        "nyquist": Markup(margins.nyquist(tuning)),
        "reductions": Markup(_reductions(tuning)),
        "differences": Markup(voyages.differences(tuning.paired)),
        "histories": Markup(voyages.histories(tuning)),
        "seeds": voyages.seeds_of(tuning.sailed),
        "manoeuvres": [(m, Markup(demanded.manoeuvre(m, tuning)), told_tuning.followed(m)) for m in tuning.manoeuvres],
        "maps": Markup(schedule_maps.schedule_maps(tuning.schedule)),
        "schedule": tuning_rows.schedule_sheet(tuning.schedule),
        "is_folded": len(tuning.schedule) > FOLDED,
        "bounds": [tuning_rows.bound_row(b) for b in tuning.bounds],
        "diagram": Markup(loop_diagram.diagram(tuning.components, tuning.output, tuning.actuator)),
        "components": [
            tuning_rows.component_row(c, tuning.chosen.gains) for c in loop_diagram.in_order(tuning.components)
        ],
    }
    return environment().get_template("tuning.html").render(context)


def _reductions(tuning: Tuning) -> str:
    """Bars of mean reductions: a group for each controller, a bar for each stage of what an actuator cannot do."""
    if not tuning.sailed:
        return ""
    stages = {
        "without limits": [s.linear for s in tuning.sailed],
        "with angle and rate limits": [s.limited for s in tuning.sailed],
        "with stall, too": [s.stalled for s in tuning.sailed],
    }
    series = {name: tuple(100.0 * float(np.mean(row)) for row in rows) for name, rows in stages.items()}
    return bars(Bars("Reductions", tuple(s.name for s in tuning.sailed), series, "reduction of rms [%]", ""))
