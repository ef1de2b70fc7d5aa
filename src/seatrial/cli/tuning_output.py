"""What `tune` prints: gains with their margins, reasons, controllers compared, simulation, schedule, manoeuvres."""

import math
from typing import TYPE_CHECKING

from seatrial.cli.finding_output import print_warnings
from seatrial.cli.screen import print_heading, print_lines, print_table
from seatrial.cli.summary_output import print_summary

if TYPE_CHECKING:
    from seatrial.core.results.tuning import Controller, Tuning


def print_tuning(tuning: "Tuning") -> None:
    """Print everything a tuning contains, the chosen gains first."""
    from seatrial.core.text.numbers import exact
    from seatrial.reporting.tuning_text import key_facts, verdict

    gains = ", ".join(f"{name} {exact(value, 5)}" for name, value in tuning.chosen.gains.items())
    print_summary(tuning.name, verdict(tuning), key_facts(tuning))
    print_heading("Chosen gains")
    print_lines([f"chosen: {gains}", _margins_text(tuning.chosen), *tuning.reasons], "  ")
    print_heading("Loop")
    print_lines([tuning.plant, *(f"in {sea}" for sea in tuning.seas)], "  ")
    _print_controllers(tuning)
    _print_fronts(tuning)
    _print_search(tuning)
    _print_simulations(tuning)
    _print_schedule(tuning)
    print_lines(f"bound {b.name}: output variance {exact(b.ratio, 3)} of the chosen gains', {b.conditions}"
                for b in tuning.bounds)  # fmt: skip
    _print_robustness(tuning)
    _print_disturbances(tuning)
    _print_manoeuvres(tuning)
    _print_track(tuning)
    _print_station(tuning)
    print_warnings(tuning.findings)
    print_lines([_effort_text(tuning)])


def _effort_text(tuning: "Tuning") -> str:
    """What each part of the work took; with a published search, the parts that it is compared with, too."""
    from seatrial.control.front import FRONT_NAME
    from seatrial.core.text.numbers import duration

    search = tuning.search
    if search is None:
        return f"{tuning.solution.evaluations} controllers tried; {duration(tuning.elapsed_s)}"
    fronts = (tuning.front, *(front for front in tuning.extended_fronts if front.name != FRONT_NAME))
    return "; ".join([
        f"one genetic search: {search.evaluations} controllers tried{_cpu_text(search.cpu_s)}; made with "
        f"{len(search.gains)} seeds",
        *(f"front of {one.name}: {one.evaluations} controllers{_cpu_text(one.cpu_s)}" for one in fronts),
        f"everything with its checks: {duration(tuning.elapsed_s)}",
    ])  # fmt: skip


def _cpu_text(cpu_s: float) -> str:
    from seatrial.core.text.numbers import duration

    return f", {duration(cpu_s)} of CPU time" if math.isfinite(cpu_s) else ""


def _margins_text(c: "Controller") -> str:
    from seatrial.core.text.numbers import exact, fixed
    from seatrial.reporting.tuning_text import margin_texts

    if not math.isfinite(c.Ms):
        return "unstable"
    return f"Ms {exact(c.Ms, 3)}, {', '.join(margin_texts(c))}, damping {fixed(c.damping, 2)}"


def _print_controllers(tuning: "Tuning") -> None:
    from seatrial.core.text.numbers import exact, fixed
    from seatrial.core.values import display_unit
    from seatrial.core.values.notation import channel_unit

    names = (tuning.output, tuning.actuator)
    (output_factor, output_unit), (actuator_factor, actuator_unit) = (display_unit(channel_unit(n)) for n in names)
    rate = f"{actuator_unit}^2" if actuator_unit.endswith("/s") else f"{actuator_unit}/s"
    # without control an integrator carries the output anywhere: there is nothing to compare with
    drifts = any(c.role == "plant" and c.den[-1] == 0.0 for c in tuning.components)
    channels = [f"{names[0]} [{output_unit}]", f"{names[1]} [{actuator_unit}]", f"rate [{rate}]"]
    channels += ["accel. [m/s^2]"] if tuning.motion else []
    rows = [["controller", "reduced %", *channels, "Ms", "sat. %", "rate sat. %", ""]]
    factors = {"output": output_factor, "actuator": actuator_factor, "actuator_rate": actuator_factor}
    factors |= {"motion": 1.0} if tuning.motion else {}
    for c in tuning.compared:
        rows.append([
            c.name, "" if drifts or math.isnan(c.reduction) else fixed(100.0 * c.reduction, 1),
            *(exact(factor * c.rms.get(key, math.nan), 4) for key, factor in factors.items()), exact(c.Ms, 3),
            fixed(100.0 * c.saturation, 1), fixed(100.0 * c.rate_saturation, 1), "; ".join(c.violated),
        ])  # fmt: skip
    print_heading("Controllers compared, by linear theory")
    print_table(rows, flush_left=(0, len(rows[0]) - 1), indent="  ")
    print_heading("Search and simulation")


def _print_fronts(tuning: "Tuning") -> None:
    from seatrial.core.text.numbers import fixed

    for front in (tuning.front, *tuning.extended_fronts):
        volume = "" if math.isnan(front.hypervolume) else f", {fixed(front.hypervolume, 4)} of a grid's hypervolume"
        print_lines([f"front of {front.name}: {len(front.gains)} controllers{volume}"])


def _print_search(tuning: "Tuning") -> None:
    from seatrial.reporting.gain_search import search_sentences, search_table

    table = search_table(tuning)
    if table is not None:
        print_table([table.header, *table.rows])
        print_lines(search_sentences(tuning), "  ")


def _print_simulations(tuning: "Tuning") -> None:
    import numpy as np

    from seatrial.core.text.numbers import fixed, interval

    if tuning.seaway_simulations:
        head = [f"simulated, {len(tuning.seaway_simulations[0].linear)} seas", "linear %", "limits %", "stall %"]
        rows = [[s.name, *(fixed(100.0 * float(np.mean(part)), 1) for part in (s.linear, s.limited, s.stalled))]
                for s in tuning.seaway_simulations]  # fmt: skip
        print_table([head, *rows])
    for p in tuning.paired_differences:
        points = f"{fixed(100.0 * p.mean, 2)} {interval(100.0 * p.lower, 100.0 * p.upper, 2)} points"
        print_lines([f"compared with '{p.baseline}', {p.stage}: {points} over {p.seeds} seas"], "  ")


def _print_schedule(tuning: "Tuning") -> None:
    from seatrial.core.text.numbers import fixed
    from seatrial.reporting.tuning_text import step_text

    if not tuning.schedule:
        return
    count = len(tuning.schedule)
    mean = sum(point.cost for point in tuning.schedule) / count
    baselines = {name: sum(point.baseline_costs[name] for point in tuning.schedule) / count
                 for name in tuning.schedule[0].baseline_costs}  # fmt: skip
    compared = ", ".join(f"{name} {fixed(cost, 3)}" for name, cost in baselines.items())
    infeasible = sum(not point.is_feasible for point in tuning.schedule)
    note = f"; {infeasible} without feasible gains" if infeasible else ""
    text = f"schedule of {count} conditions: mean cost {fixed(mean, 3)}"
    print_lines([text + (f" ({compared})" if compared else "") + note])
    trades = ", ".join(f"{step_text(trade.largest_step)} {fixed(trade.cost, 3)}" for trade in tuning.schedule_trades)
    if trades:
        print_lines([f"mean cost by the largest step of a gain between neighbours: {trades}"], "  ")


def _print_robustness(tuning: "Tuning") -> None:
    from seatrial.reporting.tuning_rows import robustness_rows

    if tuning.robustness:
        header = ("ships that differ", "stable draws", "largest Ms", "stable corners", "largest Ms", "at")
        print_table([header, *robustness_rows(tuning)], flush_left=(0, len(header) - 1))


def _print_disturbances(tuning: "Tuning") -> None:
    from seatrial.reporting.tuning_rows import disturbance_headings, disturbance_rows

    if tuning.disturbance_simulations:
        (_, unit, _), *_ = disturbance_headings(tuning)
        header = (f"{tuning.output} kept, rms [{unit}]", "predicted", "simulated", "with limits")
        print_table([header, *(row[:4] for row in disturbance_rows(tuning))])


def _print_track(tuning: "Tuning") -> None:
    from seatrial.reporting.track_part import corner_sentence, track_rows
    from seatrial.reporting.tuning_text import guidance_sentence

    if tuning.track is not None:
        print_lines([guidance_sentence(tuning.track)])
        header = ("distance from the track, rms [m]", "predicted", "simulated", "with limits")
        print_table([header, *(row[:4] for row in track_rows(tuning, tuning.track))])
        print_lines([corner_sentence(tuning.track)], "  ")


def _print_station(tuning: "Tuning") -> None:
    from seatrial.reporting.station_part import gain_rows, station_sentences, thruster_rows

    station = tuning.station
    if station is not None:
        print_heading("Station keeping")
        print_lines(station_sentences(station), "  ")
        print_table([("gain", "force", "value", "unit"), *gain_rows(station)], flush_left=(0, 1, 3))
        unit = station.force_unit
        header = ("thruster", f"full astern [{unit}]", f"full ahead [{unit}]", "used, rms [%]")
        print_table([header, *thruster_rows(station)])


def _print_manoeuvres(tuning: "Tuning") -> None:
    from seatrial.core.text.numbers import exact

    for m in tuning.manoeuvres:
        settled = f"settles in {exact(m.settling, 4)} s"
        if math.isnan(m.settling):
            settled = "does not settle" if m.is_to_settle else "not held for long enough to settle"
        draws = f", stable for {m.stable_draws} of {m.draws} ships that the fit allows" if m.draws else ""
        worst = (
            "" if math.isnan(m.worst_overshoot) else f" (at most {exact(100.0 * m.worst_overshoot, 2)} % of all drawn)"
        )
        print_lines([f"{m.name}, {m.controller}: overshoot {exact(100.0 * m.overshoot, 2)} %{worst}, {settled}{draws}"])
