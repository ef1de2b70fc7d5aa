"""The numbers of the study, in the order in which they are made; what is frozen before periods held out are scored."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from pathlib import Path

import numpy as np

from seatrial.core.values import Finding, Progress
from seatrial.data.check.conventions import signed
from seatrial.data.check.instruments import Clocks, clocks, dead_channels
from seatrial.estimation.problem.separation import Probes, Waves
from seatrial_studies.section2d.guide import Guide, guide
from seatrial_studies.section2d.modes import HEAVE, ROLL, Mode, ModeFit, halves, mode_fit, observed
from seatrial_studies.section2d.responses import (
    Response,
    calibrated_probes,
    difference,
    response,
    waves_at_model,
)
from seatrial_studies.section2d.runs import STEADY, Run, Timing, runs_of
from seatrial_studies.section2d.separable import untied_error
from seatrial_studies.section2d.springs import Stiffness, stiffness
from seatrial_studies.section2d.tank import CAMERA

OTHER_TIMINGS = (Timing(0.5, 0.5), Timing(0.5, 1.5), Timing(1.5, 1.5), Timing(2.5, 2.5), Timing(2.5, 3.5))
ORDERS = (0, 1, 2)
_AROUND_S = (3.0, 6.0)


@dataclass(frozen=True)
class Repeat:
    """Runs of one setting: spread of heave and roll about their mean, per cent and degrees."""

    names: tuple[str, ...]
    heave: tuple[float, float]
    roll: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Numbers:
    """Everything tables, claims and checks rest on.

    Attributes:
        probes: calibrated on the runs whose periods train heave.
        untied: order -> standard error of heave's and roll's added mass without any tie.
        coupled: sway-heave-roll and heave-roll runs' heave against the oscillator trained on sway-heave ones.
        timings, dampings: fits had other stretches or laws of damping been chosen; empty in the quick version.
        example: the two waves of one run.
    """

    runs: tuple[Run, ...]
    probes: Probes
    responses: tuple[Response, ...]
    heave: ModeFit
    roll: ModeFit
    untied: Mapping[int, tuple[float, float]]
    repeats: tuple[Repeat, ...]
    coupled: tuple[tuple[Response, float, float], ...]
    clocks: Mapping[str, Clocks]
    dead: tuple[Finding, ...]
    springs: Stiffness
    guide: Guide
    timings: tuple[tuple[Timing, ModeFit, ModeFit], ...]
    dampings: tuple[tuple[str, ModeFit, ModeFit], ...]
    example: tuple[Run, Waves]


def numbers(folder: Path, *, quick: bool, progress: Progress | None) -> Numbers:
    """Read, check, calibrate, fit; all settings stand before anything held out is scored.

    Raises:
        InputError: the folder's records cannot be read or do not suffice.
    """
    tell = progress or (lambda _: None)
    tell("reading the records")
    runs = runs_of(folder)
    used = [r for r in runs if r.scenario == HEAVE.scenario and is_long_enough(r)]
    train, _ = halves([r.index for r in used])
    probes = calibrated_probes([r for r in used if r.index in train])
    tell("waves and motions at the model")
    responses, heave, roll = both(runs, probes, STEADY)
    untied = {order: (_untied(HEAVE, responses, order), _untied(ROLL, responses, order)) for order in ORDERS}
    dead = tuple(f for r in runs for f in dead_channels(r.record, CAMERA))
    tell("instruments against one another")
    alive = [r for r in runs if not dead_channels(r.record, CAMERA)]
    springs = stiffness(alive)
    return Numbers(
        runs=runs,
        probes=probes,
        responses=responses,
        heave=heave,
        roll=roll,
        untied=untied,
        repeats=repeats(responses),
        coupled=tuple((r, *_predicted(heave, r)) for r in responses if r.run.scenario != HEAVE.scenario),
        clocks={r.name: camera_clocks(r) for r in alive},
        dead=dead,
        springs=springs,
        guide=guide([r for r in runs if is_long_enough(r)], springs.known),
        timings=() if quick else tuple((t, *both(runs, probes, t)[1:]) for t in OTHER_TIMINGS),
        dampings=() if quick else _other_dampings(responses, heave, roll),
        example=_example(runs, probes),
    )


def both(runs: Sequence[Run], probes: Probes, timing: Timing) -> tuple[tuple[Response, ...], ModeFit, ModeFit]:
    """Responses, heave, and roll with the distance that heave's training periods found.

    Raises:
        InputError: too few runs or periods.
    """
    responses = tuple(response(r, probes, timing) for r in runs if is_long_enough(r, timing))
    heave = mode_fit(HEAVE, responses)
    distance = heave.trained.oscillator.distance
    return responses, heave, mode_fit(replace(ROLL, start=replace(ROLL.start, distance=distance)), responses)


def is_long_enough(run: Run, timing: Timing = STEADY) -> bool:
    """Whether a whole wave period lies between the ramp and the beach's reflection."""
    start, stop = run.window(timing)
    return stop - start >= run.period


def repeats(responses: Sequence[Response]) -> tuple[Repeat, ...]:
    """Settings run more than once."""
    order = sorted(responses, key=lambda r: r.run.name)
    groups = [list(group) for _, group in groupby(order, key=lambda r: r.run.name[:4])]
    return tuple(
        Repeat(
            tuple(r.run.name for r in group),
            _spread([r.heave for r in group]),
            _spread([r.roll for r in group]),
        )
        for group in groups
        if len(group) > 1
    )


def camera_clocks(run: Run) -> Clocks:
    """The camera's heave against the accelerometers' mean, integrated twice, about the steady stretch."""
    record = signed(run.record)
    start, stop = run.window(STEADY)
    part = record.between(start - _AROUND_S[0], min(stop + _AROUND_S[1], float(record.time[-1])))
    lifted = -0.5 * (part["z_ddot_1"] + part["z_ddot_2"]) / run.omega**2
    return clocks(part.time, part["z"], lifted, run.omega)


def _other_dampings(
    responses: Sequence[Response], heave: ModeFit, roll: ModeFit
) -> tuple[tuple[str, ModeFit, ModeFit], ...]:
    def made(free: str) -> tuple[ModeFit, ModeFit]:
        one, two = (_damped(fit.mode, free) for fit in (heave, roll))
        return mode_fit(one, responses), mode_fit(two, responses)

    return (("linear", *made("linear")), ("none but of waves", *made("")))


def _damped(mode: Mode, free: str) -> Mode:
    kept = tuple(name for name in mode.free if name != "quadratic") + ((free,) if free else ())
    return replace(mode, start=replace(mode.start, quadratic=0.0), free=kept)


def _untied(mode: Mode, responses: Sequence[Response], order: int) -> float:
    used = [observed(mode, r) for r in responses if r.run.scenario == mode.scenario]
    return untied_error(used, mode.start.inertia, mode.start.stiffness, order)


def _predicted(fit: ModeFit, one: Response) -> tuple[float, float]:
    return difference(fit.trained.oscillator.seen(observed(fit.mode, one)), fit.mode.measured(one))


def _spread(values: Sequence[complex]) -> tuple[float, float]:
    mean = complex(np.mean(values))
    told = [difference(v, mean) for v in values]
    return max(abs(a) for a, _ in told), max(abs(p) for _, p in told)


def _example(runs: Sequence[Run], probes: Probes) -> tuple[Run, Waves]:
    chosen = next((r for r in runs if r.scenario == HEAVE.scenario), runs[0])
    return chosen, waves_at_model(chosen, probes)
