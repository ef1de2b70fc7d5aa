"""What to warn of in a tuning."""

from seatrial.control.assess import Judge
from seatrial.control.choose import TOO_MUCH_LOST
from seatrial.control.task import Demand
from seatrial.core.results.tuning import Controller, Front, Manoeuvre, Paired, Sailed, Slot
from seatrial.core.values import Finding, Severity

_ON_BOUND = 1e-3
_ENOUGH = 0.97


def findings(
    judge: Judge, chosen: Controller, rivals: tuple[Controller, ...], front: Front, *,
    sailed: tuple[Sailed, ...], paired: tuple[Paired, ...], schedule: tuple[Slot, ...],
    manoeuvres: tuple[Manoeuvre, ...], is_interrupted: bool,
) -> tuple[Finding, ...]:  # fmt: skip
    """Everything worth a word, the gravest first."""
    found = list[Finding]()
    if is_interrupted:
        found.append(_warning("interrupted", "the work was interrupted; what follows the last step shown is missing",
                              "let it finish before the gains are used"))  # fmt: skip
    found += _of_gains(judge, chosen)
    found += _sailed(sailed, paired)
    found += _followed(judge.task.demand, manoeuvres)
    if front.hypervolume < _ENOUGH:
        found.append(_warning("coarse-front", f"the front covers {100.0 * front.hypervolume:.1f} % of what a grid of "
                              "all gains does", "give it another seed"))  # fmt: skip
    wanting = [slot for slot in schedule if not slot.is_feasible]
    if wanting:
        found.append(_warning("schedule-infeasible", f"in {len(wanting)} of {len(schedule)} conditions no gains keep "
                              "the restrictions; the nearest are given", "slow down or turn there"))  # fmt: skip
    found += [
        Finding(Severity.INFO, "rival-breaks-limits", f"controller '{rival.name}' does not keep: {said}", "", "")
        for rival in rivals
        for said in rival.broken
    ]
    return tuple(found)


def _warning(code: str, text: str, advice: str) -> Finding:
    return Finding(Severity.WARNING, code, text, "", advice)


def _of_gains(judge: Judge, chosen: Controller) -> list[Finding]:
    found = []
    for gain in judge.loop.gains.free:
        width, value = gain.upper - gain.lower, chosen.gains[gain.name]
        if gain.lower == 0.0 and abs(value) <= _ON_BOUND * width:
            found.append(Finding(Severity.INFO, "gain-at-zero", f"gain {gain.name} ends at zero: its term is not "
                                 "needed", "", "leave the term out"))  # fmt: skip
            continue
        for end, bound in (("lower", gain.lower), ("upper", gain.upper)):
            if abs(value - bound) <= _ON_BOUND * width:
                found.append(_warning("gain-on-bound", f"gain {gain.name} ends on its {end} bound {bound:g}",
                                      "widen the bound, or leave the term out where it is zero"))  # fmt: skip
    if chosen.broken:
        found.append(_warning("breaks-limits", f"the chosen gains do not keep: {'; '.join(chosen.broken)}", "try more"))
    return found


def _sailed(sailed: tuple[Sailed, ...], paired: tuple[Paired, ...]) -> list[Finding]:
    found = []
    if sailed and sailed[0].lost >= TOO_MUCH_LOST:
        found.append(_warning("lost-to-limits", f"{100.0 * sailed[0].lost:.1f} points of reduction are lost to the "
                              "actuator's angle and rate limits", "ask for less saturation"))  # fmt: skip
    for pair in paired:
        if pair.lower <= 0.0:
            found.append(_warning("not-better", f"over {pair.seeds} seas the chosen gains do not surely beat "
                                  f"'{pair.other}' {pair.what}: {100.0 * pair.mean:+.1f} points, interval "
                                  f"{100.0 * pair.lower:+.1f} to {100.0 * pair.upper:+.1f}", "keep those, or give more "
                                  "freedom"))  # fmt: skip
    return found


def _followed(demand: Demand | None, manoeuvres: tuple[Manoeuvre, ...]) -> list[Finding]:
    found = []
    if demand is None or not manoeuvres:
        return found
    first = manoeuvres[0]
    if not first.overshoot <= demand.overshoot:
        found.append(_warning("overshoot", f"the demand is overshot by {100.0 * first.overshoot:.1f} % where "
                              f"{100.0 * demand.overshoot:.1f} % are allowed", "slow the reference down"))  # fmt: skip
    if first.stable_draws < first.draws:
        lost = first.draws - first.stable_draws
        found.append(_warning("unstable-draws", f"{lost} of {first.draws} ships that the fit allows are not stable "
                              "under these gains", "more trials, or more margin (less Ms)"))  # fmt: skip
    return found
