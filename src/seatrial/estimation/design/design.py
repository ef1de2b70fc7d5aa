"""A task in, a design out: standard manoeuvres measured, orders searched, both scored finely, the best confirmed."""

import math
import time
from collections.abc import Callable
from operator import attrgetter

import numpy as np

from seatrial.core.results import Design, ManoeuvrePrecision
from seatrial.core.values import InputError
from seatrial.core.values.versions import versions
from seatrial.estimation.design.confirm import confirm_design
from seatrial.estimation.design.findings import findings, refuse_violated_limits
from seatrial.estimation.design.manoeuvre_information import ManoeuvreEvaluator, assess_manoeuvre, simulate_plan
from seatrial.estimation.design.orders import input_series, order_table, orders_at, planned_record, sample_count
from seatrial.estimation.design.search import GENERATIONS, DesignObjective, at_sensor_rate, search_orders
from seatrial.estimation.design.search_step import search_step
from seatrial.estimation.design.ships import draw_ships, relative_spread
from seatrial.estimation.design.standard_manoeuvres import StandardManoeuvre, standard_manoeuvres
from seatrial.estimation.design.task import DesignTask
from seatrial.estimation.information.symmetries import refuse_unidentifiable

# simulated trials that confirm a design, ours
CONFIRMATION_RUNS = 20


def design(
    task: DesignTask,
    seed: int = 0,
    report_progress: Callable[[str], None] = lambda _: None,
    confirmation_runs: int = CONFIRMATION_RUNS,
    generations: int = GENERATIONS,
) -> Design:
    """Return the manoeuvre that identifies the task's coefficients best within its limits, with the standard ones.

    Args:
        seed: of the ships, the search and the noise; the same seed gives the same bits.
        confirmation_runs: simulated trials that are fitted to confirm the bound; 0: none.
        generations: of the evolution strategy.

    Raises:
        InputError: no record of these sensors could determine the coefficients, or the limits cannot be kept.
    """
    began = time.perf_counter()
    refuse_unidentifiable(task.model, tuple(task.sensors), ())
    seeds = np.random.SeedSequence(seed).generate_state(3)
    ships = draw_ships(task, int(seeds[0]))
    bench = ManoeuvreEvaluator(task, ships, search_step(task, ships))
    report_progress("standard manoeuvres")
    standard = standard_manoeuvres(bench)
    _refuse_impossible_limits(bench, standard)
    yardstick = DesignObjective.from_standards(bench, standard)
    result = search_orders(yardstick, int(seeds[1]), report_progress, generations)
    fine, orders = at_sensor_rate(bench), orders_at(task, result.solution.point)
    inputs = input_series(task, orders, fine.dt)
    planned = planned_record(task, inputs, fine.dt)
    report_progress("scoring at the sensors' rate")
    designed = assess_manoeuvre("designed", fine, inputs, simulate_plan(task, planned, "designed"))
    if not result.is_interrupted:
        refuse_violated_limits(task, designed)
    baselines = tuple(_evaluate_standard(fine, one) for one in standard)
    tried, interrupted = None, result.is_interrupted
    if confirmation_runs and not interrupted:
        try:
            tried = confirm_design(
                task,
                inputs,
                planned,
                draw_ships(task, int(seeds[2]), confirmation_runs - 1),
                int(seeds[2]),
                report_progress,
            )
        except KeyboardInterrupt:
            interrupted = True
    return Design(
        question=task.question or f"Which manoeuvre identifies the coefficients of {task.ship.name} best?",
        ship=task.ship.name,
        model=task.model,
        coefficients=task.model.parameters.free_names,
        sensors=dict(task.sensors),
        rate=task.request.rate,
        duration=task.request.duration,
        actuators=task.request.actuators,
        limits=task.request.limits,
        criterion=task.request.criterion.value,
        relative_spread=relative_spread(task),
        designed=designed,
        baselines=baselines,
        orders=order_table(task, orders),
        plan=planned,
        solution=result.solution,
        confirmation=tried,
        findings=findings(task, designed, tried, is_interrupted=interrupted),
        seed=seed,
        elapsed_s=time.perf_counter() - began,
        versions=versions(),
    )


def _refuse_impossible_limits(evaluator: ManoeuvreEvaluator, standards: list[StandardManoeuvre]) -> None:
    """Refuse a limit that the ship assumed leaves without any order and under every standard manoeuvre."""
    task = evaluator.task
    precision = evaluator.evaluate(np.tile(task.neutral_inputs, (sample_count(task, evaluator.dt), 1)))
    for what, reached, limit, factor, unit in (
        ("drift angle", attrgetter("drift"), task.request.limits.drift, math.degrees(1.0), "deg"),
        ("distance", attrgetter("distance"), task.request.limits.sea_room, 1.0, "m"),
    ):
        value = reached(precision)[0]
        if value > limit and all(reached(evaluator.evaluate(r.inputs_for(evaluator)))[0] > limit for r in standards):
            raise InputError(
                f"[design] cannot be kept: without any order the ship reaches a {what} of {factor * value:.3g} {unit}, "
                f"and more than the {factor * limit:.3g} {unit} allowed under every standard manoeuvre, too; "
                "widen that limit or shorten the trial"
            )


def _evaluate_standard(evaluator: ManoeuvreEvaluator, standard: StandardManoeuvre) -> ManoeuvrePrecision:
    inputs = standard.inputs_for(evaluator)
    nominal_inputs = inputs[0] if inputs.ndim == 3 else inputs
    return assess_manoeuvre(
        standard.name,
        evaluator,
        inputs,
        simulate_plan(evaluator.task, planned_record(evaluator.task, nominal_inputs, evaluator.dt), standard.name),
    )
