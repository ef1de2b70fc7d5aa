"""The page of a tuned controller: recommendation, front, margins, simulation, schedule, the loop itself."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures import fronts, loop_diagram, manoeuvre_response, margins, schedule_maps, seaway_simulations
from seatrial.core.figures.bars import bars
from seatrial.core.results import Bars
from seatrial.core.results.tuning import Tuning
from seatrial.core.text.words import channel_meaning
from seatrial.reporting import tuning_rows, tuning_text
from seatrial.reporting.page import environment
from seatrial.reporting.tables import finding_groups

TITLES = {
    "answer": "Recommendation",
    "findings": "Findings",
    "controllers": "Controllers compared",
    "front": "Front",
    "margins": "Margins",
    "simulation": "Simulation with limits and stall",
    "manoeuvres": "Demands followed",
    "schedule": "Schedule",
    "bounds": "What no linear controller does better",
    "loop": "The loop",
    "method": "How it was made",
}
MAX_UNFOLDED_CONDITIONS = 40


def html(tuning: Tuning) -> str:
    """The page as text; sections without content are left out."""
    drawn, controllers = fronts.fronts(tuning), tuning_rows.controller_rows(tuning)
    shown = {
        "findings": bool(tuning.findings),
        "front": bool(drawn),
        "margins": len(margins.styled_controllers(tuning)) > 0,
        "simulation": bool(tuning.seaway_simulations),
        "manoeuvres": bool(tuning.manoeuvres),
        "schedule": bool(tuning.schedule),
        "bounds": bool(tuning.bounds),
        "loop": bool(tuning.components),
    }
    context: dict[str, object] = {
        "tuning": tuning,
        "titles": {key: title for key, title in TITLES.items() if shown.get(key, True)},
        "answer": tuning_text.sentences(tuning),
        "facts": tuning_text.facts(tuning),
        "settings": tuning_text.settings(tuning),
        "gains": list(zip(map(tuning_rows.gain_symbol, tuning.chosen.gains), controllers[0].gains, strict=False)),
        "findings": finding_groups(tuning.findings),
        "output": channel_meaning(tuning.output),
        "actuator": channel_meaning(tuning.actuator),
        "gain_names": [(name, tuning_rows.gain_symbol(name)) for name in tuning_rows.gain_names(tuning)],
        "objectives": [
            (name, fronts.degree_unit(unit)[1]) for name, unit in zip(tuning.objectives, tuning.units, strict=True)
        ],
        "rms_heads": tuning_rows.rms_headings(tuning),
        "has_reduction": tuning_text.has_reduction(tuning),
        "controllers": controllers,
        "front": Markup(drawn),
        "sensitivities": Markup(margins.sensitivities(tuning)),
        "nyquist": Markup(margins.nyquist(tuning)),
        "reductions": Markup(_reductions_figure(tuning)),
        "differences": Markup(seaway_simulations.differences(tuning.paired_differences)),
        "histories": Markup(seaway_simulations.time_histories(tuning)),
        "seeds": seaway_simulations.seed_count(tuning.seaway_simulations),
        "manoeuvres": [
            (m, Markup(manoeuvre_response.manoeuvre(m, tuning)), tuning_text.demand_sentence(m))
            for m in tuning.manoeuvres
        ],
        "maps": Markup(schedule_maps.schedule_maps(tuning.schedule)),
        "schedule": tuning_rows.schedule_table(tuning.schedule),
        "is_folded": len(tuning.schedule) > MAX_UNFOLDED_CONDITIONS,
        "bounds": [tuning_rows.bound_row(b) for b in tuning.bounds],
        "diagram": Markup(loop_diagram.diagram(tuning.components, tuning.output, tuning.actuator)),
        "components": [
            tuning_rows.component_row(c, tuning.chosen.gains) for c in loop_diagram.signal_order(tuning.components)
        ],
    }
    return environment().get_template("tuning.html").render(context)


def _reductions_figure(tuning: Tuning) -> str:
    """Bars of mean reductions: a group for each controller, a bar for each stage of what an actuator cannot do."""
    if not tuning.seaway_simulations:
        return ""
    stages = {
        "without limits": [s.linear for s in tuning.seaway_simulations],
        "with angle and rate limits": [s.limited for s in tuning.seaway_simulations],
        "with stall, too": [s.stalled for s in tuning.seaway_simulations],
    }
    series = {name: tuple(100.0 * float(np.mean(row)) for row in rows) for name, rows in stages.items()}
    return bars(
        Bars("Reductions", tuple(s.name for s in tuning.seaway_simulations), series, "reduction of rms [%]", "")
    )
