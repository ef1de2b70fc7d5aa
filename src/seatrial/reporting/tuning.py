"""The page of a tuned controller: recommendation, front, margins, simulation, schedule, block diagram."""

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.bars import bars_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.front_chart import degree_unit, front_chart
from seatrial.core.results.loop_charts import bode_chart, nyquist_chart, sensitivity_chart, styled_controllers
from seatrial.core.results.station import StationKeeping
from seatrial.core.results.tuning import ManoeuvreResponse, Tuning
from seatrial.core.text.numbers import exact, fixed
from seatrial.core.text.words import enumeration
from seatrial.core.values.notation import channel_meaning
from seatrial.reporting import gain_search, station_part, track_part, tuning_rows, tuning_text
from seatrial.reporting.document import page_text
from seatrial.reporting.figures.controlled_runs import manoeuvre_view, seaway_view
from seatrial.reporting.figures.loop_diagram import loop_diagram, signal_order
from seatrial.reporting.figures.paired_differences import difference_chart
from seatrial.reporting.figures.schedule_maps import schedule_chart
from seatrial.reporting.first_screen import FirstScreen
from seatrial.reporting.tables import finding_groups
from seatrial.reporting.time_figures import run_figure

TITLES = {
    "reasons": "Why these gains",
    "findings": "Findings",
    "controllers": "Controllers compared",
    "front": "Front",
    "search": "The published search",
    "margins": "Margins",
    "robustness": "Ships that differ from the model",
    "simulation": "Simulation with limits and stall",
    "disturbances": "Kept in simulated disturbances",
    "manoeuvres": "Response to demands",
    "track": "Track keeping",
    "station": "Station keeping",
    "schedule": "Schedule",
    "bounds": "Lower bounds of any linear controller",
    "loop": "The loop",
    "method": "Method and provenance",
}
FRONT_CAPTION = (
    "Controllers of which none is better than another in every objective, and those compared. Smaller is better along "
    "every axis."
)
SEAWAY_CAPTION = (
    "First sea, the stretch about the largest motion, with all limits and stall. Red, dashed: limits of the actuator."
)
# rows of a schedule from which on it is folded
MAX_UNFOLDED_CONDITIONS = 40


def html(tuning: Tuning) -> str:
    """Return the page as text; sections without content are left out."""
    front, controllers = Markup(svg(front_chart(tuning))), tuning_rows.controller_rows(tuning)
    lead, lead_caption = _lead_figure(tuning)
    has_content = {
        "reasons": bool(tuning.reasons),
        "findings": bool(tuning.findings),
        "front": bool(front) and bool(lead),
        "search": tuning.search is not None,
        "margins": len(styled_controllers(tuning)) > 0,
        "robustness": bool(tuning.robustness),
        "simulation": bool(tuning.seaway_simulations),
        "disturbances": bool(tuning.disturbance_simulations),
        "manoeuvres": bool(tuning.manoeuvres),
        "track": tuning.track is not None,
        "station": tuning.station is not None,
        "schedule": bool(tuning.schedule),
        "bounds": bool(tuning.bounds),
        "loop": bool(tuning.components),
    }
    about = "Answer of the genetic algorithm" if tuning.search else "Recommended gains"
    context: dict[str, object] = {
        "tuning": tuning,
        "titles": {key: title for key, title in TITLES.items() if has_content.get(key, True)},
        "screen": FirstScreen(
            tuning_text.verdict(tuning),
            tuning_text.key_facts(tuning),
            lead or front,
            lead_caption if lead else FRONT_CAPTION if front else "",
        ),
        "about_gains": about,
        "facts": tuning_text.facts(tuning),
        "settings": tuning_text.settings(tuning),
        "gains": list(zip(map(tuning_rows.gain_symbol, tuning.chosen.gains), controllers[0].gains, strict=False)),
        "findings": finding_groups(tuning.findings),
        "output": channel_meaning(tuning.output),
        "actuator": channel_meaning(tuning.actuator),
        "gain_names": [
            (name, tuning_rows.gain_symbol(name), tuning_rows.gain_unit(tuning, name))
            for name in tuning_rows.gain_names(tuning)
        ],
        "objectives": [(name, degree_unit(unit)[1]) for name, unit in tuning.objectives.items()],
        "rms_heads": tuning_rows.rms_headings(tuning),
        "work_heads": tuning_rows.work_headings(tuning),
        "has_reduction": tuning_text.has_reduction(tuning),
        "controllers": controllers,
        "front": front,
        "front_caption": FRONT_CAPTION,
        "search": _search_context(tuning),
        "sensitivities": Markup(svg(sensitivity_chart(tuning))),
        "bode": Markup(svg(bode_chart(tuning))),
        "discrete": tuning_rows.discrete_rows(tuning),
        "reference": tuning_text.reference_sentence(tuning),
        "nyquist": Markup(svg(nyquist_chart(tuning))),
        "robustness": tuning_rows.robustness_rows(tuning),
        "reductions": Markup(_reductions_figure(tuning)),
        "differences": Markup(svg(difference_chart(tuning.paired_differences))),
        "seeds": len(tuning.seaway_simulations[0].linear) if tuning.seaway_simulations else 0,
        "disturbances": tuning_rows.disturbance_rows(tuning),
        "disturbance_heads": tuning_rows.disturbance_headings(tuning),
        "manoeuvres": [(m, _manoeuvre_figure(m, tuning), tuning_text.demand_sentence(m)) for m in tuning.manoeuvres],
        "track": _track_context(tuning),
        "station": {} if tuning.station is None else _station_context(tuning.station),
        "maps": Markup(svg(schedule_chart(tuning.schedule))),
        "schedule": tuning_rows.schedule_table(tuning.schedule),
        "trades": [(tuning_text.step_text(t.largest_step), fixed(t.cost, 3)) for t in tuning.schedule_trades],
        "between": tuning_text.between_sentence(tuning),
        "is_folded": len(tuning.schedule) > MAX_UNFOLDED_CONDITIONS,
        "bounds": [tuning_rows.bound_row(b) for b in tuning.bounds],
        "diagram": Markup(svg(loop_diagram(tuning.components, tuning.output, tuning.actuator))),
        "components": [tuning_rows.component_row(c, tuning.chosen.gains) for c in signal_order(tuning.components)],
    }
    return page_text("tuning.html", context)


def _lead_figure(tuning: Tuning) -> tuple[Markup, str]:
    """The roughest stretch of a simulated sea, with its caption; both empty without a simulation."""
    view = seaway_view(tuning)
    return (run_figure(view, is_wide=True), SEAWAY_CAPTION) if view else (Markup(), "")


def _manoeuvre_figure(m: ManoeuvreResponse, tuning: Tuning) -> Markup:
    view = manoeuvre_view(m, tuning)
    return run_figure(view, is_wide=True) if view else Markup()


def _track_context(tuning: Tuning) -> dict[str, object]:
    """What the chapter on track keeping shows; empty without one."""
    if tuning.track is None:
        return {}
    return {
        "sentences": (tuning_text.guidance_sentence(tuning.track), track_part.corner_sentence(tuning.track)),
        "heads": [("distance", "m", 3), *tuning_rows.disturbance_headings(tuning)[1:]],
        "rows": track_part.track_rows(tuning, tuning.track),
        "figure": track_part.corner_figure(tuning.track),
        "caption": track_part.CAPTION,
    }


def _station_context(station: StationKeeping) -> dict[str, object]:
    """What the chapter on station keeping shows."""
    return {
        "sentences": station_part.station_sentences(station),
        "footprint": station_part.footprint_figure(station),
        "footprint_caption": station_part.FOOTPRINT_CAPTION,
        "capability": station_part.capability_figure(station),
        "capability_caption": station_part.CAPABILITY_CAPTION,
        "front": station_part.front_figure(station),
        "front_caption": station_part.FRONT_CAPTION,
        "gains": station_part.gain_rows(station),
        "thrusters": station_part.thruster_rows(station),
        "sample": exact(station.sample_s, 3),
        "varying": enumeration(station.disturbances),
    }


def _search_context(tuning: Tuning) -> dict[str, object]:
    """What the chapter on a published search shows; empty without one."""
    if tuning.search is None:
        return {}
    return {
        "table": gain_search.search_table(tuning),
        "sentences": gain_search.search_sentences(tuning),
        "settings": tuning.search.settings,
        "convergence": Markup(svg(gain_search.convergence_chart(tuning.search))),
        "scatter": Markup(svg(gain_search.scatter_chart(tuning.search))),
    }


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
    names = [s.name for s in tuning.seaway_simulations]
    return svg(bars_chart("reductions", names, series, "reduction of rms [%]"))
