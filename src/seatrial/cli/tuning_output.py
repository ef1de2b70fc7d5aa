"""What `tune` prints: gains with their margins, reasons, the controllers beside one another, what simulation says."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.core.results.tuning import Controller, Tuning

_SEVERITY_MARK = {"error": "ERROR  ", "warning": "warning", "info": "note   "}


def print_tuning(tuning: "Tuning") -> None:
    """Everything a tuning says, the chosen gains first."""
    print(f"{tuning.name}: {tuning.plant}")
    for sea in tuning.seas:
        print(f"  in {sea}")
    print("chosen: " + ", ".join(f"{name} {value:.5g}" for name, value in tuning.chosen.gains.items()))
    print(f"  {_margins_text(tuning.chosen)}")
    for reason in tuning.reasons:
        print(f"  {reason}")
    _print_controllers(tuning)
    _print_fronts(tuning)
    _print_simulations(tuning)
    _print_schedule(tuning)
    for bound in tuning.bounds:
        print(f"bound {bound.name}: output variance {bound.ratio:.3g} of the chosen gains', {bound.conditions}")
    _print_manoeuvres(tuning)
    for finding in tuning.findings:
        advice = f": {finding.advice}" if finding.advice else ""
        print(f"{_SEVERITY_MARK[finding.severity.value]} [{finding.code}] {finding.text}{advice}")
    print(f"{tuning.solution.evaluations} controllers tried; {tuning.elapsed_s:.1f} s")


def _margins_text(c: "Controller") -> str:
    if not math.isfinite(c.Ms):
        return "unstable"
    factor = "any" if math.isinf(c.gain_margin) else f"{c.gain_margin:.3g}"
    phase = "any" if math.isinf(c.phase_margin) else f"{math.degrees(c.phase_margin):.3g} deg"
    delay = "any" if math.isinf(c.delay_margin) else f"{c.delay_margin:.3g} s"
    return f"Ms {c.Ms:.3g}, gain margin {factor}, phase margin {phase}, delay margin {delay}, damping {c.damping:.2g}"


def _print_controllers(tuning: "Tuning") -> None:
    from seatrial.core.values import NOTATION, display_unit

    units = {name: NOTATION[name].unit if name in NOTATION else "1" for name in (tuning.output, tuning.actuator)}
    shown = {name: display_unit(unit) for name, unit in units.items()}
    unit = shown[tuning.actuator][1]
    rate = f"{unit}^2" if unit.endswith("/s") else f"{unit}/s"
    # without control an integrator carries the output anywhere: there is nothing to compare with
    drifts = any(c.role == "plant" and c.den[-1] == 0.0 for c in tuning.components)
    heads = (f"{name} [{shown[name][1]}]" for name in (tuning.output, tuning.actuator))
    print(
        f"{'controller':20s} {'reduced %':>9s} "
        + " ".join(f"{head:>14s}" for head in (*heads, f"rate [{rate}]"))
        + f" {'Ms':>6s} {'sat. %':>7s} {'rate sat. %':>11s}"
    )
    factors = (shown[tuning.output][0], shown[tuning.actuator][0], shown[tuning.actuator][0])
    for c in (tuning.chosen, *tuning.baselines):
        sizes = [
            factor * c.rms.get(key, math.nan)
            for factor, key in zip(factors, ("output", "actuator", "actuator_rate"), strict=True)
        ]
        cells = " ".join(f"{size:14.4g}" for size in sizes)
        beyond = f"{100.0 * c.saturation:7.1f} {100.0 * c.rate_saturation:11.1f}"
        notes = "; ".join(c.violated)
        reduction = "" if drifts or math.isnan(c.reduction) else f"{100.0 * c.reduction:.1f}"
        print(f"{c.name:20s} {reduction:>9s} {cells} {c.Ms:6.3g} {beyond}  {notes}".rstrip())


def _print_fronts(tuning: "Tuning") -> None:
    for front in (tuning.front, *tuning.extended_fronts):
        volume = "" if math.isnan(front.hypervolume) else f", {front.hypervolume:.4f} of a grid's hypervolume"
        print(f"front of {front.name}: {len(front.gains)} controllers{volume}")


def _print_simulations(tuning: "Tuning") -> None:
    import numpy as np

    if tuning.seaway_simulations:
        seeds = len(tuning.seaway_simulations[0].linear)
        print(f"{f'simulated, {seeds} seas':20s} {'linear %':>9s} {'limits %':>9s} {'stall %':>9s}")
    for s in tuning.seaway_simulations:
        cells = " ".join(f"{100.0 * float(np.mean(part)):9.1f}" for part in (s.linear, s.limited, s.stalled))
        print(f"{s.name:20s} {cells}")
    for p in tuning.paired_differences:
        points = f"{100.0 * p.mean:+.2f} [{100.0 * p.lower:+.2f}, {100.0 * p.upper:+.2f}] points"
        print(f"  against '{p.baseline}', {p.stage}: {points} over {p.seeds} seas")


def _print_schedule(tuning: "Tuning") -> None:
    if not tuning.schedule:
        return
    count = len(tuning.schedule)
    own = sum(slot.cost for slot in tuning.schedule) / count
    others = {
        name: sum(slot.baseline_costs[name] for slot in tuning.schedule) / count
        for name in tuning.schedule[0].baseline_costs
    }
    beside = ", ".join(f"{name} {cost:.3f}" for name, cost in others.items())
    lacking = sum(not slot.is_feasible for slot in tuning.schedule)
    note = f"; {lacking} without feasible gains" if lacking else ""
    print(f"schedule of {count} conditions: mean cost {own:.3f}" + (f" ({beside})" if beside else "") + note)


def _print_manoeuvres(tuning: "Tuning") -> None:
    for m in tuning.manoeuvres:
        settled = "does not settle" if math.isnan(m.settling) else f"settled in {m.settling:.4g} s"
        draws = f", stable for {m.stable_draws} of {m.draws} ships that the fit allows" if m.draws else ""
        worst = (
            "" if math.isnan(m.worst_overshoot) else f" (of all ships drawn at most {100.0 * m.worst_overshoot:.2g} %)"
        )
        print(f"{m.name}, {m.controller}: overshoot {100.0 * m.overshoot:.2g} %{worst}, {settled}{draws}")
