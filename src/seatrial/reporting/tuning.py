"""The page of a tuned controller: recommendation, front, margins, simulation, schedule, block diagram."""

from functools import partial

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.panels import bars_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.front_chart import front_chart
from seatrial.core.results.loop_charts import bode_chart, nyquist_chart, sensitivity_chart, styled_controllers
from seatrial.core.results.tuning import ManoeuvreResponse, Tuning
from seatrial.core.text.numbers import fixed
from seatrial.core.values.notation import channel_meaning
from seatrial.reporting import station_part, tuning_rows, tuning_text
from seatrial.reporting import station_part as track_part
from seatrial.reporting import tuning_rows as gain_search
from seatrial.reporting.document import chapters_page
from seatrial.reporting.figures.control_charts import (
    difference_chart,
    loop_diagram,
    manoeuvre_view,
    schedule_chart,
    seaway_view,
    signal_order,
)
from seatrial.reporting.section import FirstScreen, Level, Picture, Section, fact_table, finding_section, plain_table
from seatrial.reporting.time_figures import run_figure

FRONT_CAPTION = (
    "Controllers of which none is better than another in every objective, and those compared. Smaller is better along "
    "every axis."
)
SEAWAY_CAPTION = (
    "First sea, the stretch about the largest motion, with all limits and stall. Red, dashed: limits of the actuator."
)
# rows of a schedule from which on it is folded
MAX_UNFOLDED_CONDITIONS = 40


_MAPS_CAPTION = (
    "Share of the motion that remains (rms over that without control) over heading to the waves (0 following) and "
    "speed, for each wave height. Gains of the schedule change little from one condition to the next. Underlined: no "
    "gains are feasible there. The other gains are shown whether or not they keep the constraints; where they do not, "
    "they may reduce more than the schedule."
)
_SENSITIVITY_CAPTION = (
    "Left: share of the disturbance that remains; below 1 the controller helps, above 1 it harms. Right: what of noise "
    "and model errors reaches the output. Red, dashed: the largest Ms allowed."
)
_BODE_CAPTION = (
    "Bode diagram of the open loop. Gain margin: how far |L| lies below 0 dB where the phase crosses −180° (dashed); "
    "phase margin: how far the phase lies above it where |L| crosses 0 dB."
)
_NYQUIST_CAPTION = (
    "Open loop for positive frequencies near −1 (cross). It must stay out of the red circle, which the largest Ms "
    "allowed draws about −1; grey: unit circle."
)
_DIFFERENCE_CAPTION = (
    "Reduction by the chosen gains minus that by others on the same waves, with 95 % intervals; right of zero the "
    "chosen ones are better."
)
_CONVERGENCE_CAPTION = (
    "J of the fittest individual under equal weights, over the generations. The weights of the search change with "
    "every generation, so that J need not fall."
)
_SCATTER_CAPTION = "The answers of all seeds: bars of one gain would be alike if the search had one answer."
_ROBUSTNESS_NOTE = (
    "Ships of the fit are drawn from its covariance. Corners: the plant’s gain and time constants times the factors "
    "shown, and the dead time, at either end of [uncertainty] of the loop file. ∞: unstable."
)
_TRACK_NOTE = (
    "On a straight track: predicted by linear theory; simulated on the linear ship with the guidance as it is, without "
    "limits (95 % intervals) and with those of the actuator. The guidance leaves least of the distance within the "
    "limit of Ms."
)
_SCHEDULE_NOTE = (
    "Cost: rms over that without control; behind it those of other gains in the same condition. Saturation: share of "
    "amplitudes beyond the limit."
)
_ENERGIES = {"drive": "drive_energy", "drag": "drag_energy"}
_ENERGY_NOTE = (
    " Energy with all limits: the drive’s from the rate of the actuator (Yu et al. 2014, eq. (3)), the drag of its "
    "surfaces at the hull (Whicker & Fehlner 1958), without losses of the propulsion. What rolling costs the main "
    "engine is left out: no source gives it."
)
_STAGES = {"without limits": "linear", "with limits of angle and rate": "limited", "with stall, too": "stalled"}
"""How a seaway was simulated, and the attribute that has its reductions."""


def sections(tuning: Tuning) -> tuple[Section, ...]:
    """Return the chapters of a tuning that have content, in order."""
    facts = {**dict(tuning_text.facts(tuning)), **dict(tuning_text.settings(tuning))}
    chapters = (
        Section("Why these gains", "reasons", points=tuning.reasons),
        finding_section(tuning.findings),
        _controllers(tuning),
        _front(tuning),
        _search(tuning),
        _margins(tuning),
        _robustness(tuning),
        _simulation(tuning),
        _disturbances(tuning),
        _manoeuvres(tuning),
        _track(tuning),
        station_part.station_section(tuning.station),
        _schedule(tuning),
        _bounds(tuning),
        _loop(tuning),
        Section("Method and provenance", "method", table=fact_table(facts), level=Level.PAGE, is_folded=True),
    )
    return tuple(chapter for chapter in chapters if chapter)


def html(tuning: Tuning) -> str:
    """Return the page as text; chapters without content are left out."""
    front = Markup(svg(front_chart(tuning)))
    lead, lead_caption = _lead_figure(tuning)
    values = tuning_rows.gain_texts([tuning.chosen.gains], list(tuning.chosen.gains))[0]
    screen = FirstScreen(
        tuning_text.verdict(tuning),
        tuning_text.key_facts(tuning),
        lead or front,
        lead_caption if lead else _front_caption(tuning) if front else "",
        gains_title="Answer of the genetic algorithm" if tuning.search else "Recommended gains",
        gains=tuple(zip(map(tuning_rows.gain_symbol, tuning.chosen.gains), values, strict=True)),
    )
    name = f"{tuning.name[:1].upper()}{tuning.name[1:]}"
    return chapters_page(
        "Tuned controller", name, screen, sections(tuning), title=f"{tuning.name}: tuned", question=tuning.question
    )


def _lead_figure(tuning: Tuning) -> tuple[Markup, str]:
    """The roughest stretch of a simulated sea, with its caption; both empty without a simulation."""
    view = seaway_view(tuning)
    return (run_figure(view, is_wide=True), SEAWAY_CAPTION) if view else (Markup(), "")


def _controllers(tuning: Tuning) -> Section:
    """What each controller does to the motion; then its gains, objectives, margins and work."""
    names = [c.name for c in tuning.compared]
    details = Section(
        "Gains, objectives, margins and work",
        table=plain_table(("", *names), tuning_rows.detail_rows(tuning)),
        level=Level.DETAIL,
        is_folded=True,
    )
    table = plain_table(("", *names), tuning_rows.effect_rows(tuning))
    note = "By linear theory. Beyond limits: share of the amplitudes and rates of the actuator, at worst."
    points = tuple(
        f"{c.name} violates the constraints: {'; '.join(c.violated)}." for c in tuning.compared if c.violated
    )
    return Section("Controllers compared", "controllers", points=points, table=table, note=note, parts=(details,))


def _front(tuning: Tuning) -> Section:
    """The front, where another picture stands on the first screen."""
    chart = front_chart(tuning)
    if chart is None or seaway_view(tuning) is None:
        return Section("")
    return Section("Front", "front", pictures=(Picture(lambda: svg(chart), _front_caption(tuning)),), level=Level.PAGE)


def _front_caption(tuning: Tuning) -> str:
    """What the front is of, and what its controllers need not keep."""
    demand = " They keep the limits; they need not follow the demand." if tuning.manoeuvres else ""
    more = " With three objectives and more, a front fills a region in each pair." if len(tuning.objectives) > 2 else ""
    return f"{FRONT_CAPTION}{demand}{more}"


def _search(tuning: Tuning) -> Section:
    """The published search beside the package's own front."""
    search = tuning.search
    if search is None:
        return Section("")
    settings = fact_table({name: str(value) for name, value in search.settings.items()})
    pictures = (
        Picture(lambda: svg(gain_search.convergence_chart(search)), _CONVERGENCE_CAPTION),
        Picture(lambda: svg(gain_search.scatter_chart(search)), _SCATTER_CAPTION),
    )
    return Section(
        "The published search",
        "search",
        sentences=gain_search.search_sentences(tuning),
        table=gain_search.search_table(tuning),
        note=gain_search.search_note(tuning),
        pictures=pictures,
        parts=(Section("Settings of the search", table=settings, level=Level.PAGE, is_folded=True),),
    )


def _margins(tuning: Tuning) -> Section:
    if not styled_controllers(tuning):
        return Section("")
    pictures = (
        Picture(lambda: svg(sensitivity_chart(tuning)), _SENSITIVITY_CAPTION),
        Picture(lambda: svg(bode_chart(tuning)), _BODE_CAPTION),
    )
    nyquist = Section(
        "Nyquist diagram",
        pictures=(Picture(lambda: svg(nyquist_chart(tuning)), _NYQUIST_CAPTION),),
        level=Level.PAGE,
        is_folded=True,
    )
    return Section("Margins", "margins", pictures=pictures, parts=(nyquist,), level=Level.PAGE)


def _robustness(tuning: Tuning) -> Section:
    header = ("", "stable ships of the fit", "their largest Ms", "stable corners", "their largest Ms", "at")
    table = plain_table(header, tuning_rows.robustness_rows(tuning), flush_left=(0, -1))
    note = _ROBUSTNESS_NOTE if table else ""
    return Section("Ships that differ from the model", "robustness", table=table, note=note)


def _simulation(tuning: Tuning) -> Section:
    """Reductions in simulated seas: mean of each controller by what an actuator cannot do, and paired differences."""
    runs = tuning.seaway_simulations
    if not runs:
        return Section("")
    energies = {f"{part}, MJ/h": key for part, key in _ENERGIES.items() if len(getattr(runs[0], key))}
    rows = [
        (
            tuning.shared_names[s.name],
            *(fixed(100.0 * float(np.mean(getattr(s, stage))), 1) for stage in _STAGES.values()),
            *(tuning_text.megajoules(float(np.mean(getattr(s, key)))) for key in energies.values()),
        )
        for s in runs
        if s.name in tuning.shared_names
    ]  # fmt: skip
    seeds = len(runs[0].linear)
    seas = f"{tuning_text.realisations(tuning, seeds)}{'' if seeds == 1 else ', the same for every controller'}"
    pictures = [
        Picture(lambda: _reductions_figure(tuning), f"Reduction of the rms against no control, mean over {seas}.")
    ]
    if tuning.paired_differences:
        pictures.append(Picture(lambda: svg(difference_chart(tuning.paired_differences)), _DIFFERENCE_CAPTION))
    return Section(
        "Simulation with limits and stall",
        "simulation",
        table=plain_table(("reduction of the rms, %", *_STAGES, *energies), rows),
        note=f"Mean over {seas}.{_ENERGY_NOTE if energies else ''}",
        pictures=tuple(pictures),
    )


def _disturbances(tuning: Tuning) -> Section:
    runs = tuning.disturbance_simulations
    table = tuning_rows.rms_table(tuning_rows.disturbance_headings(tuning), tuning_rows.disturbance_rows(tuning))
    note = "" if not runs else (
        f"Predicted by linear theory; simulated in {runs[0].seeds} realisations of each disturbance on the linear "
        "plant, with 95 % intervals, then with the actuator’s limits of angle and rate."
    )  # fmt: skip
    return Section("Kept in simulated disturbances", "disturbances", table=table, note=note)


def _manoeuvres(tuning: Tuning) -> Section:
    points = tuple(f"{m.controller}: {tuning_text.demand_sentence(m)}" for m in tuning.manoeuvres)
    pictures = tuple(Picture(partial(_manoeuvre_figure, m, tuning), _manoeuvre_caption(m)) for m in tuning.manoeuvres)
    return Section("Response to demands", "manoeuvres", points=points, pictures=pictures)


def _manoeuvre_figure(m: ManoeuvreResponse, tuning: Tuning) -> Markup:
    view = manoeuvre_view(m, tuning)
    return run_figure(view, is_wide=True) if view else Markup()


def _manoeuvre_caption(m: ManoeuvreResponse) -> str:
    reference = " Reference: the demand as it is smoothed before the controller." if "reference" in m.record else ""
    draws = " Pale: range of the ships drawn from the covariance of the fit." if m.draws else ""
    title = f"{m.name[:1].upper()}{m.name[1:]}"
    return f"{title}, {m.controller}: model with the actuator's limits.{reference}{draws}"


def _track(tuning: Tuning) -> Section:
    track = tuning.track
    if track is None:
        return Section("")
    headings = [("distance", "m", 3), *tuning_rows.disturbance_headings(tuning)[1:]]
    return Section(
        "Track keeping",
        "track",
        sentences=(track_part.corner_sentence(track),),
        table=tuning_rows.rms_table(headings, track_part.track_rows(tuning, track)),
        note=_TRACK_NOTE,
        pictures=(Picture(lambda: track_part.corner_figure(track), track_part.CAPTION),),
    )


def _schedule(tuning: Tuning) -> Section:
    if not tuning.schedule:
        return Section("")
    between = tuning_text.between_sentence(tuning)
    ending = " Gains are interpolated straight in speed, heading and height, so that they never jump."
    trades = [(tuning_text.step_text(t.largest_step), fixed(t.cost, 3)) for t in tuning.schedule_trades]
    gains = Section(
        f"Gains of the schedule ({len(tuning.schedule)} conditions)",
        table=tuning_rows.schedule_table(tuning.schedule),
        note=_SCHEDULE_NOTE,
        level=Level.PAGE,
        is_folded=len(tuning.schedule) > MAX_UNFOLDED_CONDITIONS,
    )
    return Section(
        "Schedule",
        "schedule",
        sentences=(f"{between}{ending}",) if between else (),
        table=plain_table(("largest step of a gain between neighbours", "mean cost"), trades),
        pictures=(Picture(lambda: svg(schedule_chart(tuning.schedule)), _MAPS_CAPTION),),
        parts=(gains,),
    )


def _bounds(tuning: Tuning) -> Section:
    output = channel_meaning(tuning.output)
    note = (
        f"Variance and rms of the {output} over those of the chosen gains. A bound holds for the spectrum it was "
        "computed with."
    )
    header = ("Bound", "variance", "rms", "held equal", "what it means")
    table = plain_table(header, map(tuning_rows.bound_row, tuning.bounds), flush_left=(0, 3, 4))
    return Section("Lower bounds of any linear controller", "bounds", table=table, note=note if table else "")


def _loop(tuning: Tuning) -> Section:
    """The blocks of the loop, and those of the controller on board."""
    if not tuning.components:
        return Section("")
    output = channel_meaning(tuning.output)
    caption = f"From the {output} back to it: the controller moves the actuator against what it measures."
    drawing = Picture(lambda: svg(loop_diagram(tuning.components, tuning.output, tuning.actuator)), caption)
    return Section(
        "The loop",
        "loop",
        table=tuning_rows.component_table(signal_order(tuning.components), tuning.chosen.gains),
        note="s in rad/s, angles in rad. The same blocks stand in loop.mat, which MATLAB and python-control read.",
        pictures=(drawing,),
        parts=(_board(tuning),),
        level=Level.PAGE,
        is_folded=True,
    )


def _board(tuning: Tuning) -> Section:
    """The difference equations of the controller on board."""
    discrete = tuning.discrete
    if discrete is None:
        return Section("")
    late = f" and {discrete.dead_time} s late" if discrete.dead_time else ""
    reference = tuning_text.reference_sentence(tuning)
    note = (
        "Tustin's rule. Every term takes the sensor's value x; their outputs y, each times its gain, are added, the "
        f"sum goes through the filters in turn, and the servo's order is minus that, held for a sample{late}. "
        f"{f'{reference} ' if reference else ''}The integral keeps its output while the order is beyond what the "
        "actuator can do and it would grow. All digits and rules stand in gains.toml."
    )
    title = f"The controller on board, sampled every {discrete.sample_s} s"
    return Section(title, table=tuning_rows.discrete_table(discrete), note=note, is_folded=True)


def _reductions_figure(tuning: Tuning) -> str:
    """Bars of mean reductions: a group for each controller, a bar for each stage of what an actuator cannot do."""
    series = {
        label: tuple(100.0 * float(np.mean(getattr(s, stage))) for s in tuning.seaway_simulations)
        for label, stage in _STAGES.items()
    }
    names = [s.name for s in tuning.seaway_simulations]
    return svg(bars_chart("reductions", names, series, "reduction of rms [%]"))
