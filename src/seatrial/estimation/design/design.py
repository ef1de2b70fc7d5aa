"""A task in, a design out: standard manoeuvres measured, orders searched, both scored finely, the best confirmed."""

import math
import time
from collections.abc import Callable
from operator import attrgetter

import numpy as np

from seatrial.core.results import Design, Worth
from seatrial.core.values import InputError
from seatrial.core.values.versions import versions
from seatrial.estimation.design.confirm import confirmed
from seatrial.estimation.design.findings import findings, refuse_left
from seatrial.estimation.design.orders import inputs, plan, rows, split, table
from seatrial.estimation.design.search import GENERATIONS, Yardstick, coarse, finer, search
from seatrial.estimation.design.ships import ships, spread
from seatrial.estimation.design.standards import Standard, standards
from seatrial.estimation.design.task import Task
from seatrial.estimation.design.worth import Bench, executed, worth
from seatrial.estimation.information.symmetries import refuse_structural

CONFIRMED_WITH = 20


def design(
    task: Task,
    seed: int = 0,
    progress: Callable[[str], None] = lambda _: None,
    confirming: int = CONFIRMED_WITH,
    generations: int = GENERATIONS,
) -> Design:
    """The manoeuvre that tells the task's coefficients best within its limits, beside the standard ones.

    Args:
        seed: of the ships, the search and the noise; the same seed gives the same bits.
        confirming: simulated trials that are fitted to confirm the bound; 0: none.
        generations: of the evolution strategy.

    Raises:
        InputError: no record of these sensors could tell the coefficients apart, or the limits cannot be kept.
    """
    began = time.perf_counter()
    refuse_structural(task.model, tuple(task.sensors), ())
    seeds = np.random.SeedSequence(seed).generate_state(3)
    bench = Bench(task, ships(task, int(seeds[0])), coarse(task))
    progress("standard manoeuvres")
    standard = standards(bench)
    _refuse_unkept(bench, standard)
    yardstick = Yardstick.of(bench, standard)
    found = search(yardstick, int(seeds[1]), progress, generations)
    fine, orders = finer(bench), split(task, found.solution.point)
    made = inputs(task, orders, fine.dt)
    planned = plan(task, made, fine.dt)
    progress("scoring at the sensors' rate")
    designed = worth("designed", fine, made, executed(task, planned, "designed"))
    if not found.is_interrupted:
        refuse_left(task, designed)
    others = tuple(_scored(fine, one) for one in standard)
    tried, interrupted = None, found.is_interrupted
    if confirming and not interrupted:
        try:
            tried = confirmed(task, made, planned, ships(task, int(seeds[2]), confirming - 1), int(seeds[2]), progress)
        except KeyboardInterrupt:
            interrupted = True
    return Design(
        question=task.question or f"Which manoeuvre tells the coefficients of {task.ship.name} best?",
        ship=task.ship.name,
        model=task.model,
        coefficients=task.model.parameters.free_names,
        sensors=dict(task.sensors),
        rate=task.rate,
        duration=task.duration,
        actuators=task.actuators,
        limits=task.limits,
        criterion=task.criterion.value,
        spread=spread(task),
        designed=designed,
        rivals=others,
        orders=table(task, orders),
        plan=planned,
        solution=found.solution,
        confirmation=tried,
        findings=findings(task, designed, tried, is_interrupted=interrupted),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )


def _refuse_unkept(bench: Bench, standard: list[Standard]) -> None:
    """Refuse a limit that the ship assumed leaves without any order and under every standard manoeuvre."""
    task = bench.task
    told = bench.told(np.tile(task.quiet, (rows(task, bench.dt), 1)))
    for what, reached, limit, factor, unit in (
        ("drift angle", attrgetter("drift"), task.limits.drift, math.degrees(1.0), "deg"),
        ("distance", attrgetter("room"), task.limits.room, 1.0, "m"),
    ):
        value = reached(told)[0]
        if value > limit and all(reached(bench.told(r.made(bench)))[0] > limit for r in standard):
            raise InputError(
                f"[design] cannot be kept: without any order the ship reaches a {what} of {factor * value:.3g} {unit}, "
                f"and more than the {factor * limit:.3g} {unit} allowed under every standard manoeuvre, too; "
                "widen that limit or shorten the trial"
            )


def _scored(fine: Bench, standard: Standard) -> Worth:
    made = standard.made(fine)
    own = made[0] if made.ndim == 3 else made
    return worth(standard.name, fine, made, executed(fine.task, plan(fine.task, own, fine.dt), standard.name))
