"""A tuned controller in sentences: what it does, how near it is to instability, what its limits cost, what it asks."""

import math

import numpy as np

from seatrial.core.results.tuning import Controller, ManoeuvreResponse, PairedDifference, Tuning
from seatrial.core.text.numbers import duration, exact, fixed, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values.channel_text import channel_meaning
from seatrial.data.folder.orders import channel_display_unit

_SIMULATION_LABELS = {"limited": "with angle and rate limits", "stalled": "with stall, too", "linear": "without limits"}


def sentences(tuning: Tuning) -> list[str]:
    """The recommendation: motion, margins, saturation, simulation, comparison, demands, schedule."""
    told = [_motion(tuning), _margins(tuning), _saturation(tuning), _violations(tuning.chosen), _simulation(tuning)]
    told += [comparison_sentence(pair) for pair in tuning.paired_differences]
    told += [demand_sentence(m) for m in tuning.manoeuvres if m.controller == tuning.chosen.name]
    return [sentence for sentence in [*told, _schedule(tuning)] if sentence]


def has_reduction(tuning: Tuning) -> bool:
    """Whether a reduction means something: a loop that follows a demand is judged by what is left, not by that."""
    known = any(math.isfinite(c.reduction) for c in (tuning.chosen, *tuning.baselines))
    return known and not tuning.manoeuvres


def quantity_text(symbol: str, value: float, per: str = "") -> str:
    """A value of a channel of that symbol in the unit people read: ``2.1°``, ``9.1°/s``, ``0.3 m/s``; `per`: ``/s``."""
    factor, shown = channel_display_unit(symbol)
    if shown == "deg":
        return f"{significant(value * factor, 2)}°{per}"
    return f"{significant(value * factor, 2)} {'' if shown == '1' else shown}{per}".rstrip()


def percent(share: float) -> str:
    """``74.2 %``; small shares with two digits, next to nothing as such."""
    if not math.isfinite(share):
        return "–"
    if abs(share) < 5e-4:
        return "next to 0 %" if share else "0 %"
    return f"{fixed(100.0 * share, 1) if abs(share) >= 0.01 else significant(100.0 * share, 1)} %"


def percent_points(share: float) -> str:
    """A difference of reductions in points."""
    return f"{fixed(100.0 * share, 1)} points"


def _motion(tuning: Tuning) -> str:
    c, rms = tuning.chosen, tuning.chosen.rms
    if not math.isfinite(c.Ms):
        return ""
    moved = [quantity_text(tuning.actuator, rms["actuator"])] if "actuator" in rms else []
    moved += [quantity_text(tuning.actuator, rms["actuator_rate"], "/s")] if "actuator_rate" in rms else []
    effort = f", with {' and '.join(moved)} rms of the {channel_meaning(tuning.actuator)}" if moved else ""
    left = quantity_text(tuning.output, rms["output"]) if "output" in rms else ""
    if has_reduction(tuning):
        to = f", to {left} rms" if left else ""
        return (
            f"By linear theory these gains reduce the {channel_meaning(tuning.output)} by "
            f"{percent(c.reduction)}{to}{effort}."
        )
    return f"By linear theory {left} rms of the {channel_meaning(tuning.output)} is left{effort}." if left else ""


def _margins(tuning: Tuning) -> str:
    c = tuning.chosen
    if not math.isfinite(c.Ms):
        return "The loop is unstable with these gains: do not use them."
    allowed = f" ({exact(tuning.constraints.Ms, 3)} allowed)" if math.isfinite(tuning.constraints.Ms) else ""
    borne = [f"a loop gain {significant(c.gain_margin, 2)} times as large"] if math.isfinite(c.gain_margin) else []
    borne += [f"{fixed(math.degrees(c.phase_margin), 0)}° of phase lag"] if math.isfinite(c.phase_margin) else []
    borne += [f"{significant(c.delay_margin, 2)} s of dead time"] if math.isfinite(c.delay_margin) else []
    told = f"The sensitivity peak Ms is {fixed(c.Ms, 2)}{allowed}"
    told += f"; it bears {enumeration(borne)}, one at a time" if borne else ""
    return f"{told}; the least damping ratio is {fixed(c.damping, 2)}." if math.isfinite(c.damping) else f"{told}."


def _saturation(tuning: Tuning) -> str:
    r, c, told = tuning.constraints, tuning.chosen, []
    for limit, share, allowed, per, what in (
        (r.limit, c.saturation, r.saturation, "", "amplitudes"),
        (r.rate, c.rate_saturation, r.rate_saturation, "/s", "rates"),
    ):
        if math.isfinite(limit) and math.isfinite(share):
            told.append(f"{percent(share)} of its {what} would pass {_limit_text(tuning.actuator, limit, per)} "
                        f"({exact(100.0 * allowed, 3)} % allowed)")  # fmt: skip
    return f"Of the {channel_meaning(tuning.actuator)}, at worst {enumeration(told)}." if told else ""


def _limit_text(symbol: str, value: float, per: str = "") -> str:
    """A limit as somebody wrote it."""
    factor, shown = channel_display_unit(symbol)
    return f"{exact(value * factor, 4)}{'°' if shown == 'deg' else '' if shown == '1' else f' {shown}'}{per}"


def _violations(c: Controller) -> str:
    return f"It does not keep what was asked: {'; '.join(c.violated)}." if c.violated else ""


def _simulation(tuning: Tuning) -> str:
    own = [s for s in tuning.seaway_simulations if s.name == tuning.chosen.name]
    if not own or not len(own[0].linear):
        return ""
    s = own[0]
    linear, limited, stalled = (float(np.mean(x)) for x in (s.linear, s.limited, s.stalled))
    told = (
        f"Simulated in {counted(len(s.linear), 'sea')}, it reduces the motion by {percent(linear)} without limits and "
        f"by {percent(limited)} with those of angle and rate: they cost {percent_points(s.saturation_loss)}"
    )
    if math.isfinite(tuning.constraints.stall):
        told += f"; with stall beyond {_limit_text(tuning.actuator, tuning.constraints.stall)}, by {percent(stalled)}"
    return f"{told}."


def comparison_sentence(pair: PairedDifference) -> str:
    """One paired difference; says where the interval holds zero."""
    how = _SIMULATION_LABELS.get(pair.stage, pair.stage)
    ends = f"95 % interval {fixed(100.0 * pair.lower, 1)} to {fixed(100.0 * pair.upper, 1)}"
    tail = f"({ends}, {counted(pair.seeds, 'sea')})"
    if pair.lower <= 0.0 <= pair.upper:
        return (
            f"Over the same seas, {how}, it cannot be told from ‘{pair.baseline}’: {percent_points(pair.mean)} {tail}."
        )
    word = "better" if pair.mean > 0.0 else "worse"
    return f"Over the same seas, {how}, it is {word} than ‘{pair.baseline}’ by {percent_points(abs(pair.mean))} {tail}."


def demand_sentence(m: ManoeuvreResponse) -> str:
    """How a demand was followed, on the ship as identified and on those drawn."""
    told = f"In the {m.name} it {_overshoot_text(m.overshoot)}"
    told += f" and settles in {significant(m.settling, 3)} s" if math.isfinite(m.settling) else " and does not settle"
    if m.draws:
        told += f"; {m.stable_draws} of {m.draws} ships that the fit allows are stable"
        if math.isfinite(m.worst_overshoot):
            worst = f"overshoots by {percent(m.worst_overshoot)} at most" if m.worst_overshoot > 0.0 else "overshoots"
            told += f", and {'each' if m.worst_overshoot > 0.0 else 'none'} {worst}"
        told += "; not every one comes through the simulation" if math.isinf(m.worst_overshoot) else ""
    return f"{told}."


def _overshoot_text(share: float) -> str:
    return f"overshoots by {percent(share)}" if share > 0.0 else "does not overshoot"


def _schedule(tuning: Tuning) -> str:
    slots = tuning.schedule
    if not slots:
        return ""
    mean = float(np.mean([s.cost for s in slots]))
    told = f"A schedule over {counted(len(slots), 'condition')} leaves {percent(mean)} of the motion on average"
    others = {name: [s.baseline_costs.get(name, math.nan) for s in slots] for name in slots[0].baseline_costs}
    beside = [_other_gains_text(name, costs) for name, costs in others.items()]
    told += f", where {enumeration(beside)}" if beside else ""
    kept = sum(s.is_feasible for s in slots)
    return f"{told}; it keeps what was asked in {'all' if kept == len(slots) else f'{kept} of {len(slots)}'}."


def _other_gains_text(name: str, costs: list[float]) -> str:
    """What other gains leave on average, or in how many conditions they are unstable."""
    unstable = sum(math.isinf(cost) for cost in costs)
    if unstable:
        return f"‘{name}’ is unstable in {unstable}"
    return f"‘{name}’ leaves {percent(float(np.mean(costs)))}"


def facts(tuning: Tuning) -> list[tuple[str, str]]:
    """What was asked for."""
    r = tuning.constraints
    kept = [f"Ms ≤ {exact(r.Ms, 3)}"] if math.isfinite(r.Ms) else []
    for limit, share, per in ((r.limit, r.saturation, ""), (r.rate, r.rate_saturation, "/s")):
        if math.isfinite(limit):
            what = "amplitudes" if not per else "rates"
            kept.append(f"{exact(100.0 * share, 3)} % of the {what} beyond {_limit_text(tuning.actuator, limit, per)}")
    return [
        ("Plant", tuning.plant),
        ("Tuned in", "; ".join(tuning.seas) or "no sea"),
        ("To be kept small", ", ".join(tuning.objectives)),
        ("To be kept", "; ".join(kept) or "nothing but stability"),
    ]


def settings(tuning: Tuning) -> list[tuple[str, str]]:
    """How it was made."""
    fronts = [f for f in (tuning.front, *tuning.extended_fronts) if len(f.objectives)]
    said = [
        f"{f.name}: {counted(len(f.objectives), 'point')} of {exact(f.evaluations)} evaluations"
        + (f", hypervolume {fixed(f.hypervolume, 3)} of a brute-force grid’s" if math.isfinite(f.hypervolume) else "")
        for f in fronts
    ]
    return [
        ("Fronts", "; ".join(said)),
        ("Evaluations", exact(tuning.solution.evaluations, 12)),
        ("Seed", str(tuning.seed)),
        ("Elapsed", duration(tuning.elapsed_s)),
        ("Versions", ", ".join(f"{name} {version}" for name, version in tuning.versions.items())),
    ]


def unit_label(symbol: str, per: str = "") -> str:
    """Unit of a channel as people read it; `per`: ``/s`` for its rate."""
    shown = channel_display_unit(symbol)[1]
    return (f"1{per}" if per else "") if shown == "1" else f"{shown}{per}"
