"""What to warn of in a tuning."""

import math
from dataclasses import dataclass, field

import numpy as np

from seatrial.control.choice import MAX_SATURATION_LOSS
from seatrial.control.gain_evaluation import ON_BOUND, GainEvaluator, gains_on_bound
from seatrial.control.schedule import Schedule
from seatrial.control.station.tune_station import STATION_DIRECTIONS
from seatrial.control.task import Demand
from seatrial.core.results.station import StationKeeping
from seatrial.core.results.tuning import (
    Controller,
    DisturbanceSimulation,
    ManoeuvreResponse,
    PairedDifference,
    ParetoFront,
    PerformanceBound,
    SeawaySimulation,
    TrackKeeping,
    TuningMethod,
)
from seatrial.core.values import Finding, Severity
from seatrial.physics.loops.discrete import ringing_blocks
from seatrial.physics.loops.performance import calm_actuator

_NO_RESTRICTIONS = (
    "the genetic search knows no restriction: run without --method, or take 'own front' (reference in tuning.json)"
)
MAX_LIMITED_RATIO = 1.1  # of the output's rms with limits over that without; chosen
MAX_CALM_RATE = 0.1  # of the actuator's largest rate, that noise alone may take, rms; chosen
MAX_STATION_CUT = 0.05  # share of the time in which limits cut the force ordered on station; chosen
_LEAST_COVERAGE = 0.98  # share of the hypervolume of the checking grid, 1 % below that of 100 points a gain; chosen


@dataclass
class Checks:
    """What is computed of the chosen controller; an interruption keeps what is there."""

    simulations: tuple[SeawaySimulation, ...] = ()
    comparisons: tuple[PairedDifference, ...] = ()
    manoeuvres: tuple[ManoeuvreResponse, ...] = ()
    disturbances: tuple[DisturbanceSimulation, ...] = ()
    schedule: Schedule = field(default_factory=Schedule)
    bounds: tuple[PerformanceBound, ...] = ()
    track: TrackKeeping | None = None
    station: StationKeeping | None = None
    is_interrupted: bool = False


def findings(
    evaluator: GainEvaluator,
    chosen: Controller,
    baselines: tuple[Controller, ...],
    front: ParetoFront,
    checks: Checks,
    method: TuningMethod = TuningMethod.FRONT,
) -> tuple[Finding, ...]:
    """Return everything to warn of, the gravest first; advice is such as the `method` can follow."""
    found = list[Finding]()
    if checks.is_interrupted:
        found.append(_warning("interrupted", "the work was interrupted; what follows the last step shown is missing"))
    ship = evaluator.task.trimmed_ship
    found += [
        _warning("warned-fit", f"of the fit whose model this is: {text}")
        for text in (ship.warnings if ship is not None else ())
    ]
    found += _gain_findings(evaluator, chosen, method)
    found += _zero_gain_findings(evaluator, chosen, front)
    found += _simulation_findings(checks.simulations, checks.comparisons, method)
    found += _demand_findings(evaluator.task.demand, checks.manoeuvres)
    found += [
        _warning("lost-to-limits", f"the output is {s.limited['output'] / s.unlimited['output']:.2g} times as large "
                 f"with the actuator's limits as without, in {s.disturbance}",
                 _advice("set a lower limit on saturation", method))
        for s in checks.disturbances
        if s.limited["output"] > MAX_LIMITED_RATIO * s.unlimited["output"]
    ]  # fmt: skip
    found += _noise_findings(evaluator, chosen)
    found += _track_findings(checks.track)
    found += _station_findings(checks.station)
    if front.hypervolume < _LEAST_COVERAGE:
        found.append(_warning("coarse-front", f"the front covers {100.0 * front.hypervolume:.1f} % of what a grid of "
                              "all gains does"))  # fmt: skip
    points, between = checks.schedule.points, checks.schedule.check
    if wanting := [point for point in points if not point.is_feasible]:
        first = wanting[0]
        lacks = f": at {first.U:.3g} m/s, {math.degrees(first.beta):.0f} deg, {'; '.join(first.lacks)}"
        found.append(_warning("schedule-infeasible", f"in {len(wanting)} of {len(points)} conditions the gains do not "
                              f"keep all that is asked{lacks if first.lacks else ''}"))  # fmt: skip
    if points and between is None:
        found.append(_warning("schedule-not-smooth", "no one set of gains keeps the restrictions in all conditions, so "
                              "that each has its own and neighbours may differ by any step"))  # fmt: skip
    if between is not None and between.feasible < between.conditions:
        found.append(_warning("schedule-infeasible", f"with interpolated gains {between.conditions - between.feasible} "
                              f"of {between.conditions} conditions on and between the schedule's break the "
                              "restrictions", "add conditions to [schedule]"))  # fmt: skip
    found += [
        Finding(Severity.INFO, "rival-breaks-limits", f"controller '{rival.name}' does not keep: {broken}")
        for rival in baselines
        for broken in rival.violated
    ]
    return tuple(found)


def _warning(code: str, text: str, advice: str = "") -> Finding:
    return Finding(Severity.WARNING, code, text, "", advice)


def _advice(advice: str, method: TuningMethod) -> str:
    """Return advice to restrict or to search on, replaced where the search can do neither."""
    return _NO_RESTRICTIONS if method is TuningMethod.GENETIC else advice


def _gain_findings(evaluator: GainEvaluator, chosen: Controller, method: TuningMethod) -> list[Finding]:
    loop = evaluator.loop
    found = [
        _warning("gain-on-bound", f"gain {name} ends on the {end} bound {bound:g} of the search: a better one "
                 "may lie beyond", f"widen it: [controller.gains.{name}] {end} in the loop file")
        for name, end, bound in gains_on_bound(loop, np.array([chosen.gains[gain] for gain in loop.gains.names]))
    ]  # fmt: skip
    if chosen.violated:
        found.append(_warning("breaks-limits", f"the chosen gains do not keep: {'; '.join(chosen.violated)}",
                              _advice("try more", method)))  # fmt: skip
    return found


def _zero_gain_findings(evaluator: GainEvaluator, chosen: Controller, front: ParetoFront) -> list[Finding]:
    """Return which terms the chosen gains leave out, whether others of the front use them, what that leaves behind."""
    found, loop = list[Finding](), evaluator.loop
    where = "on the front" if evaluator.task.demand is None else "on the front, where the demand does not count,"
    for gain, term in zip(loop.gains, loop.terms, strict=True):
        if not gain.free or gain.lower != 0.0 or abs(chosen.gains[gain.name]) > ON_BOUND * gain.upper:
            continue
        text, advice = f"gain {gain.name} ends at zero", ""
        if front.gain_names == loop.gains.names:  # those of a structure with more terms have a front of their own
            used = front.gains[:, front.gain_names.index(gain.name)].max(initial=0.0)
            text += f"; {where} it reaches {used:.3g}" if used > ON_BOUND * gain.upper else " as on the whole front"
        if term.block.den[-1] == 0.0:  # a pole at the origin: an integral
            text += "; the disturbances stated have no steady part, and such a part would leave an offset"
            advice = (
                "where a steady wind or current acts, keep the integral: write a lower bound above zero, "
                f"[controller.gains.{gain.name}] lower, in the loop file"
            )
        found.append(Finding(Severity.INFO, "gain-at-zero", text, "", advice))
    return found


def _simulation_findings(
    simulations: tuple[SeawaySimulation, ...], comparisons: tuple[PairedDifference, ...], method: TuningMethod
) -> list[Finding]:
    found = []
    if simulations and simulations[0].saturation_loss >= MAX_SATURATION_LOSS:
        found.append(_warning("lost-to-limits", f"{100.0 * simulations[0].saturation_loss:.1f} points of reduction are "
                              "lost to the actuator's angle and rate limits",
                              _advice("set a lower limit on saturation", method)))  # fmt: skip
    for pair in comparisons:
        if pair.lower <= 0.0:
            found.append(_warning("not-better", f"over {pair.seeds} realisations the chosen gains do not surely beat "
                                  f"'{pair.baseline}' {pair.stage}: {100.0 * pair.mean:+.1f} points, interval "
                                  f"{100.0 * pair.lower:+.1f} to {100.0 * pair.upper:+.1f}"))  # fmt: skip
    return found


def _noise_findings(evaluator: GainEvaluator, chosen: Controller) -> list[Finding]:
    """Return what the sensor's errors alone make of the actuator, and blocks that ring at the samples."""
    loop, found = evaluator.loop.with_gains(np.array([*chosen.gains.values()])), []
    sampling = loop.required_sampling
    if ringing := ringing_blocks(loop, sampling.sample_s):
        found.append(_warning("rings", f"at samples of {sampling.sample_s:g} s {', '.join(ringing)} rings: by "
                              "Tustin's rule its output changes sign at every sample"))  # fmt: skip
    if sampling.noise_variance and math.isfinite(chosen.Ms):
        _, rms_rate = calm_actuator(loop)
        share = rms_rate / evaluator.task.constraints.rate
        if share > MAX_CALM_RATE:
            found.append(_warning("works-in-calm", f"in calm water the sensor's errors alone move the actuator at "
                                  f"{100.0 * share:.0f} % of its largest rate (rms)"))  # fmt: skip
    return found


def _track_findings(track: TrackKeeping | None) -> list[Finding]:
    if track is None:
        return []
    found, corner = [], track.corner
    if not corner.is_kept:
        text = "the craft does not settle on the track behind the corner: it swings beyond the acceptance to the end"
        found.append(_warning("not-settled", text, "a longer demand.time_constant, or a larger acceptance"))
    if corner.stable_draws < corner.draws or math.isinf(corner.worst_overshoot):
        lost = f"{corner.draws - corner.stable_draws} of {corner.draws} ships that the fit allows"
        text = f"{lost} do not keep a track under this guidance, or run away at the corner"
        found.append(_warning("unstable-draws", text))
    free, held = (
        math.hypot(*(getattr(s, stage)["output"] for s in track.disturbances)) for stage in ("unlimited", "limited")
    )
    if held > MAX_LIMITED_RATIO * free:
        text = f"the distance from the track is {held / free:.2g} times as large with the actuator's limits as without"
        found.append(_warning("lost-to-limits", text, "allow the actuator more, or less Ms"))
    return found


def _station_findings(station: StationKeeping | None) -> list[Finding]:
    if station is None:
        return []
    found, trial = [], station.trial
    if trial.stable_draws < trial.draws:
        text = f"{trial.draws - trial.stable_draws} of {trial.draws} craft that the fit allows do not keep the station"
        found.append(_warning("unstable-draws", text))
    if len(trial.directions) < STATION_DIRECTIONS:
        text = (
            f"the station was tried in a current from {len(trial.directions)} of {STATION_DIRECTIONS} directions: from "
            "the others the thrusters do not hold its strongest"
        )
        found.append(_warning("station-not-held", text))
    if trial.cut > MAX_STATION_CUT:
        text = f"the thrusters' limits cut the force ordered {100.0 * trial.cut:.2g} % of the time on station"
        advice = "give a slower current, or more of full command (station.limit)"
        found.append(_warning("lost-to-limits", text, advice))
    return found


def _demand_findings(demand: Demand | None, manoeuvres: tuple[ManoeuvreResponse, ...]) -> list[Finding]:
    found = []
    if demand is None or not manoeuvres:
        return found
    first = manoeuvres[0]
    if not first.overshoot <= demand.overshoot:
        found.append(_warning("overshoot", f"the demand is overshot by {100.0 * first.overshoot:.1f} % where "
                              f"{100.0 * demand.overshoot:.1f} % are allowed"))  # fmt: skip
    if first.is_to_settle and math.isnan(first.settling):
        found.append(_warning("not-settled", f"the {first.name} does not settle within 5 % in the "
                              f"{demand.duration:.3g} s that are simulated"))  # fmt: skip
    if first.settling > demand.settling:
        found.append(_warning("slow", f"the demand takes {first.settling:.3g} s to settle, {demand.settling:.3g} s are "
                              "allowed"))  # fmt: skip
    if first.stable_draws < first.draws:
        lost = first.draws - first.stable_draws
        found.append(_warning("unstable-draws", f"{lost} of {first.draws} ships that the fit allows are not stable "
                              "under these gains"))  # fmt: skip
    return found
