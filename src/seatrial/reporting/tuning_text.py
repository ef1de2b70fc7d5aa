"""A tuned controller in sentences: reduction, margins, saturation, simulation, comparison, schedule."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.core.results.station import StationTrial
from seatrial.core.results.tuning import (
    Controller,
    CornerResponse,
    ManoeuvreResponse,
    PairedDifference,
    SeawaySimulation,
    TrackKeeping,
    Tuning,
)
from seatrial.core.text.numbers import duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import Severity
from seatrial.core.values.notation import channel_meaning
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting.section import KeyFact
from seatrial.reporting.station_part import precision_sentence

_MEGAJOULE = 1e6  # J in 1 MJ, by definition
_SIMULATION_LABELS = {"limited": "with angle and rate limits", "stalled": "with stall, too", "linear": "without limits"}


def verdict(tuning: Tuning) -> str:
    """Return what the gains do to the motion, or that they must not be used, in one sentence."""
    chosen = [m for m in tuning.manoeuvres if m.controller == tuning.chosen.name]
    if not math.isfinite(tuning.chosen.Ms):
        return _margins(tuning)
    return _motion(tuning) or next((response_sentence(m) for m in chosen), _margins(tuning))


def key_facts(tuning: Tuning) -> tuple[KeyFact, ...]:
    """Return the rows at the top: margins, actuator, simulation, comparison, demands, schedule, warnings."""
    c, pairs = tuning.chosen, tuning.paired_differences
    demands = [demand_sentence(m) for m in tuning.manoeuvres if m.controller == c.name]
    warned = list(dict.fromkeys(f.code for f in tuning.findings if f.severity is not Severity.INFO))
    rows = (
        KeyFact("Margins", _margins(tuning), "margins", _keeps_margins(tuning)),
        KeyFact("Other ships", _other_ships(tuning), "robustness", _holds_other_ships(tuning)),
        KeyFact("Constraints", _violations(c), "controllers", not c.violated),
        KeyFact("Actuator", _saturation(tuning), "controllers"),
        KeyFact("Simulated", _simulation(tuning), "simulation"),
        KeyFact("Compared", " ".join(map(comparison_sentence, pairs)), "simulation",
                _is_better(pairs)),
        KeyFact("Energy", _energy(tuning), "simulation"),
        KeyFact("Demands", " ".join(demands), "manoeuvres"),
        KeyFact("Track", guidance_sentence(tuning.track) if tuning.track else "", "track",
                _holds_draws(tuning.track.corner) if tuning.track else None),
        KeyFact("Station", precision_sentence(tuning.station) if tuning.station else "", "station",
                _holds_draws(tuning.station.trial) if tuning.station else None),
        KeyFact("Schedule", _schedule(tuning), "schedule", _is_schedule_kept(tuning)),
    )  # fmt: skip
    text = " ".join(_on_bounds(tuning)) or enumeration(warned) or "none"
    warnings = KeyFact("Warnings", text, "findings" if tuning.findings else "", not warned)
    return (*(row for row in rows if row.text and row.text != verdict(tuning)), warnings)


def _keeps_margins(tuning: Tuning) -> bool | None:
    """Return whether the chosen gains keep the constraints; None where no sensitivity peak was required."""
    c = tuning.chosen
    is_kept = math.isfinite(c.Ms) and not c.violated
    return None if is_kept and not math.isfinite(tuning.constraints.Ms) else is_kept


def _is_better(pairs: Sequence[PairedDifference]) -> bool | None:
    """Return whether a controller is better in every comparison, worse in one; None: chance may have made it so."""
    return False if any(pair.upper < 0.0 for pair in pairs) else all(pair.lower > 0.0 for pair in pairs) or None


def _holds_draws(tried: CornerResponse | StationTrial) -> bool | None:
    """Return whether all ships drawn from the fit are stable; None where none was drawn."""
    return tried.stable_draws == tried.draws if tried.draws else None


def _is_schedule_kept(tuning: Tuning) -> bool:
    check = tuning.schedule_check
    return all(s.is_feasible for s in tuning.schedule) and (check is None or check.feasible == check.conditions)


def _on_bounds(tuning: Tuning) -> list[str]:
    """Return the warnings that a gain ends on a bound of the search."""
    return [sentence(f"{f.text}; {f.advice}") for f in tuning.findings if f.code == "gain-on-bound"]


def motion_name(tuning: Tuning) -> str:
    """Return what the reductions are of, in words."""
    return tuning.motion or channel_meaning(tuning.output)


def has_reduction(tuning: Tuning) -> bool:
    """Return whether a reduction is shown: a loop that follows a demand is judged by the remaining error."""
    is_known = any(math.isfinite(c.reduction) for c in tuning.compared)
    return is_known and not tuning.manoeuvres


def quantity_text(symbol: str, value: float, per: str = "") -> str:
    """Return a value of that channel in display units: ``2.1°``, ``0.3 m/s``; `per`: ``/s`` for its rate."""
    factor, unit = channel_display_unit(symbol)
    if unit == "deg":
        return f"{significant(value * factor, 2)}°{per}"
    return f"{significant(value * factor, 2)} {'' if unit == '1' else unit}{per}".rstrip()


def percent(share: float) -> str:
    """Return a share in per cent: ``74.2 %``; below 1 % with one digit; ``less than 0.05 %``."""
    if not math.isfinite(share):
        return "–"
    if abs(share) < 5e-4:  # rounds to 0.0 %
        return "less than 0.05 %" if share else "0 %"
    return f"{fixed(100.0 * share, 1) if abs(share) >= 0.01 else significant(100.0 * share, 1)} %"


def percent_points(share: float, decimals: int = 1) -> str:
    """Return a difference of reductions in percentage points."""
    return f"{fixed(100.0 * share, decimals)} points"


def _motion(tuning: Tuning) -> str:
    c, rms = tuning.chosen, tuning.chosen.rms
    if not math.isfinite(c.Ms):
        return ""
    moved = [quantity_text(tuning.actuator, rms["actuator"])] if "actuator" in rms else []
    moved += [quantity_text(tuning.actuator, rms["actuator_rate"], "/s")] if "actuator_rate" in rms else []
    effort = f", with {' and '.join(moved)} rms of the {channel_meaning(tuning.actuator)}" if moved else ""
    remaining = quantity_text(tuning.output, rms["output"]) if "output" in rms else ""
    if has_reduction(tuning) and (simulated := _simulated(tuning)):
        stalled, linear = (percent(float(np.mean(x))) for x in (simulated.stalled, simulated.linear))
        return (
            f"Simulated with all limits, these gains reduce the {motion_name(tuning)} by {stalled}; without limits, by "
            f"{linear}."
        )
    if has_reduction(tuning):
        remaining = f"{significant(rms['motion'], 2)} m/s²" if tuning.motion else remaining
        to = f", to {remaining} rms" if remaining else ""
        return f"By linear theory these gains reduce the {motion_name(tuning)} by {percent(c.reduction)}{to}."
    return (
        f"By linear theory {remaining} rms of the {channel_meaning(tuning.output)} remains{effort}."
        if remaining
        else ""
    )


def _margins(tuning: Tuning) -> str:
    c = tuning.chosen
    if not math.isfinite(c.Ms):
        return "The loop is unstable with these gains: do not use them."
    allowed = f" ({exact(tuning.constraints.Ms, 3)} allowed)" if math.isfinite(tuning.constraints.Ms) else ""
    peak = f"Sensitivity peak Ms {fixed(c.Ms, 2)}{allowed}"
    damping = f", least damping ratio {fixed(c.damping, 2)}" if math.isfinite(c.damping) else ""
    return f"{sentence(enumeration(margin_texts(c)))} {peak}{damping}."


def _other_ships(tuning: Tuning) -> str:
    """Return how the chosen controller holds ships that differ from the model; nothing where it was not tried."""
    if not tuning.robustness:
        return ""
    r = tuning.robustness[0]
    draws = [f"{r.stable_draws} of {r.draws} ships drawn from the fit"] if r.draws else []
    text = f"Stable: {enumeration([*draws, f'{r.stable_corners} of {r.corners} corners of the uncertainty'])}"
    allowed = f" ({exact(tuning.constraints.Ms, 3)} allowed)" if math.isfinite(tuning.constraints.Ms) else ""
    largest, where = max((r.corners_Ms, f"at {r.worst_corner}"), (r.draws_Ms if r.draws else 0.0, "of a ship drawn"))
    peak = f"; Ms up to {fixed(largest, 2)}{allowed} {where}" if math.isfinite(largest) else ""
    return f"{text}{peak}."


def _holds_other_ships(tuning: Tuning) -> bool:
    """Return whether ships that differ are stable too, with no sensitivity peak above the largest allowed."""
    return all(
        r.stable_draws == r.draws
        and r.stable_corners == r.corners
        and not max(r.draws_Ms if r.draws else 0.0, r.corners_Ms) > tuning.constraints.Ms
        for r in tuning.robustness[:1]
    )


def guidance_sentence(track: TrackKeeping) -> str:
    """Return lookahead distance and integral gain along a track with the margins of the outer loop."""
    return (
        f"Line of sight with a lookahead distance of {significant(track.lookahead, 3)} m and an integral gain of "
        f"{significant(track.integral_gain, 3)} m/s, at {significant(track.speed, 3)} m/s; with the heading loop "
        f"closed Ms {fixed(track.Ms, 2)}, {enumeration(margin_texts(track))}."
    )


def margin_texts(c: Controller | TrackKeeping) -> list[str]:
    """Return gain margin [dB], phase margin [deg] and delay margin [s] as text."""
    gain = f"{fixed(20.0 * math.log10(c.gain_margin), 0)} dB" if 0.0 < c.gain_margin < math.inf else "unlimited"
    phase = f"{fixed(math.degrees(c.phase_margin), 0)}°" if math.isfinite(c.phase_margin) else "unlimited"
    delay = f"{significant(c.delay_margin, 2)} s" if math.isfinite(c.delay_margin) else "unlimited"
    return [f"gain margin {gain}", f"phase margin {phase}", f"delay margin {delay}"]


def _saturation(tuning: Tuning) -> str:
    r, c, shares = tuning.constraints, tuning.chosen, []
    for limit, share, allowed, per, name in (
        (r.limit, c.saturation, r.saturation, "", "amplitudes"),
        (r.rate, c.rate_saturation, r.rate_saturation, "/s", "rates"),
    ):
        if math.isfinite(limit) and math.isfinite(share):
            shares.append(f"{percent(share)} of its {name} exceed {_limit_text(tuning.actuator, limit, per)} "
                        f"({exact(100.0 * allowed, 3)} % allowed)")  # fmt: skip
    return f"Of the {channel_meaning(tuning.actuator)}, at worst {enumeration(shares)}." if shares else ""


def _limit_text(symbol: str, value: float, per: str = "") -> str:
    """A limit as somebody wrote it."""
    factor, unit = channel_display_unit(symbol)
    return f"{exact(value * factor, 4)}{'°' if unit == 'deg' else '' if unit == '1' else f' {unit}'}{per}"


def _violations(c: Controller) -> str:
    return f"It violates the constraints: {'; '.join(c.violated)}." if c.violated else ""


def realisations(tuning: Tuning, count: int) -> str:
    """Return in what was simulated: ``20 realisations of the first sea``, where the gains were tuned in several."""
    return f"{counted(count, 'realisation')} of the {'first ' if len(tuning.seas) > 1 else ''}sea"


def _simulated(tuning: Tuning) -> SeawaySimulation | None:
    """Return the simulated seas of the chosen controller; None without any."""
    chosen = (s for s in tuning.seaway_simulations if s.name == tuning.chosen.name and len(s.linear))
    return next(chosen, None)


def _simulation(tuning: Tuning) -> str:
    s = _simulated(tuning)
    if s is None:
        return ""
    linear, limited, stalled = (float(np.mean(x)) for x in (s.linear, s.limited, s.stalled))
    text = (
        f"Simulated in {realisations(tuning, len(s.linear))}, it reduces the {tuning.motion or 'motion'} by "
        f"{percent(linear)} without limits and by {percent(limited)} with those of angle and rate"
    )
    if math.isfinite(tuning.constraints.stall):
        text += f"; with stall beyond {_limit_text(tuning.actuator, tuning.constraints.stall)}, by {percent(stalled)}"
    return f"{text}."


def _energy(tuning: Tuning) -> str:
    """Return what the actuator takes in an hour, and what that saves against given gains."""
    s = _simulated(tuning)
    if s is None:
        return ""
    parts = [(name, values) for name, values in (("drive", s.drive_energy), ("drag", s.drag_energy)) if len(values)]
    if not parts:
        return ""
    needs = enumeration([f"{megajoules(float(np.mean(values)))} MJ by {name}" for name, values in parts])
    savings = " ".join(energy_sentence(pair) for pair in tuning.energy_savings)
    return f"With all limits the actuator takes {needs} in an hour. {savings}".rstrip()


def megajoules(energy: float) -> str:
    """Return an energy [J] in MJ, without its unit."""
    return significant(energy / _MEGAJOULE, 3)


def energy_sentence(pair: PairedDifference) -> str:
    """Return what the chosen gains save against others; not significant where the interval contains zero."""
    sign, word = (1.0, "less") if pair.mean > 0.0 else (-1.0, "more")
    lower, upper = sorted((sign * pair.lower, sign * pair.upper))
    mean = megajoules(sign * pair.mean)
    ends = f"95 % interval {megajoules(lower)} to {megajoules(upper)}, {counted(pair.seeds, 'realisation')}"
    if pair.lower <= 0.0 <= pair.upper:
        return f"The difference to ‘{pair.baseline}’ is not significant: {mean} MJ {word} ({ends})."
    return f"That is {mean} MJ {word} than by ‘{pair.baseline}’ ({ends})."


def comparison_sentence(pair: PairedDifference) -> str:
    """Return one paired difference; not significant where the interval contains zero."""
    stage = _SIMULATION_LABELS.get(pair.stage, pair.stage)
    width = 100.0 * (pair.upper - pair.lower)
    decimals = max(1, -math.floor(math.log10(width))) if 0.0 < width < math.inf else 1  # so many that the ends differ
    ends = f"95 % interval {fixed(100.0 * pair.lower, decimals)} to {fixed(100.0 * pair.upper, decimals)}"
    tail = f"({ends}, {counted(pair.seeds, 'realisation')})"
    start = f"On the same waves, {stage}, it"
    if pair.lower <= 0.0 <= pair.upper:
        change = f"does not differ significantly from ‘{pair.baseline}’: {percent_points(pair.mean, decimals)}"
    else:
        word = "better" if pair.mean > 0.0 else "worse"
        change = f"is {word} than ‘{pair.baseline}’ by {percent_points(abs(pair.mean), decimals)}"
    return f"{start} {change} {tail}."


def response_sentence(m: ManoeuvreResponse) -> str:
    """Return the response to a demand, of the ship as identified."""
    text = f"In the {m.name} it {_overshoot_text(m.overshoot)}"
    if math.isfinite(m.settling):
        text += f" and settles in {significant(m.settling, 3)} s"
    elif m.is_to_settle:
        text += " and does not settle"
    return f"{text}."


def demand_sentence(m: ManoeuvreResponse) -> str:
    """Return the response to a demand, of the ship as identified and of those drawn from its covariance."""
    if not m.draws:
        return response_sentence(m)
    text = f"Of {m.draws} ships that the fit allows {m.stable_draws} are stable"
    if math.isfinite(m.worst_overshoot):
        worst = f"overshoots by {percent(m.worst_overshoot)} at most" if m.worst_overshoot > 0.0 else "overshoots"
        text += f", and {'each' if m.worst_overshoot > 0.0 else 'none'} {worst}"
    text += "; the simulation of at least one diverges" if math.isinf(m.worst_overshoot) else ""
    return f"{response_sentence(m)} {text}."


def reference_sentence(tuning: Tuning) -> str:
    """Return what the loop follows in place of an order; nothing where it follows none."""
    made = None if tuning.discrete is None else tuning.discrete.reference
    if made is None:
        return ""
    text = f"What is ordered goes through a critically damped filter of {significant(made.time_constant, 3)} s"
    if math.isfinite(made.rate):
        factor, unit = channel_display_unit(tuning.output)
        ending = "1/s" if unit == "1" else f"{unit}/s"
        text += f", no faster than {significant(made.rate * factor, 3)} {ending}"
    return f"{text}."


def _overshoot_text(share: float) -> str:
    return f"overshoots by {percent(share)}" if share > 0.0 else "does not overshoot"


def step_text(largest_step: float) -> str:
    """Return a largest step between neighbouring gains in words."""
    if not math.isfinite(largest_step):
        return "any"
    return f"{fixed(100.0 * largest_step, 0)} %"


def between_sentence(tuning: Tuning) -> str:
    """Return how the schedule fares with its gains interpolated between its conditions."""
    check = tuning.schedule_check
    if check is None:
        return ""
    return (
        f"With gains interpolated, {check.feasible} of {check.conditions} conditions on and midway between those of "
        f"the schedule keep the constraints; the largest Ms is {fixed(check.Ms, 2)}."
    )


def _schedule(tuning: Tuning) -> str:
    slots = tuning.schedule
    if not slots:
        return ""
    mean = float(np.mean([s.cost for s in slots]))
    text = f"A schedule over {counted(len(slots), 'condition')} leaves {percent(mean)} of the motion on average"
    baseline_costs = {name: [s.baseline_costs.get(name, math.nan) for s in slots] for name in slots[0].baseline_costs}
    comparisons = [_other_gains_text(name, costs) for name, costs in baseline_costs.items()]
    baselines = f" Other gains: {enumeration(comparisons)}." if comparisons else ""
    kept = sum(s.is_feasible for s in slots)
    check = tuning.schedule_check
    between = f" and, with gains interpolated, in {check.feasible} of {check.conditions}" if check else ""
    conditions = "all" if kept == len(slots) else f"{kept} of {len(slots)}"
    return f"{text}; the constraints are kept in {conditions}{between}.{baselines}"


def _other_gains_text(name: str, costs: list[float]) -> str:
    """What other gains leave on average, or in how many conditions they are unstable."""
    unstable = sum(math.isinf(cost) for cost in costs)
    if unstable:
        return f"‘{name}’ is unstable in {unstable}"
    return f"‘{name}’ leaves {percent(float(np.mean(costs)))}"


def facts(tuning: Tuning) -> list[tuple[str, str]]:
    """Return plant, seas, objectives and constraints as pairs of name and text."""
    r = tuning.constraints
    kept = [f"Ms ≤ {exact(r.Ms, 3)}"] if math.isfinite(r.Ms) else []
    for limit, share, per in ((r.limit, r.saturation, ""), (r.rate, r.rate_saturation, "/s")):
        if math.isfinite(limit):
            name = "amplitudes" if not per else "rates"
            kept.append(f"{exact(100.0 * share, 3)} % of the {name} beyond {_limit_text(tuning.actuator, limit, per)}")
    return [
        ("Plant", tuning.plant),
        ("Tuned in", "; ".join(tuning.seas) or "no sea"),
        ("Objectives", ", ".join(tuning.objectives)),
        ("Constraints", "; ".join(kept) or "stability"),
    ]


def settings(tuning: Tuning) -> list[tuple[str, str]]:
    """Return fronts, evaluations and provenance as pairs of name and text."""
    fronts = [f for f in (tuning.front, *tuning.extended_fronts) if len(f.objectives)]
    texts = [
        f"{f.name}: {counted(len(f.objectives), 'point')} of {exact(f.evaluations)} evaluations"
        + (f", hypervolume {fixed(f.hypervolume, 3)} of a brute-force grid’s" if math.isfinite(f.hypervolume) else "")
        for f in fronts
    ]
    return [
        ("Fronts", "; ".join(texts)),
        ("Evaluations", exact(tuning.solution.evaluations, 12)),  # every digit of a count
        ("Seed", str(tuning.seed)),
        ("Elapsed", duration(tuning.elapsed_s)),
        ("Versions", ", ".join(f"{name} {version}" for name, version in tuning.versions.items())),
    ]


def unit_label(symbol: str, per: str = "") -> str:
    """Return the display unit of a channel; `per`: ``/s`` for its rate."""
    unit = channel_display_unit(symbol)[1]
    return (f"1{per}" if per else "") if unit == "1" else f"{unit}{per}"
