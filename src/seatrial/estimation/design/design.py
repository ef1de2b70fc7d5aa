"""A task in, a design out: standard manoeuvres measured, orders searched, the best confirmed and warned of."""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from operator import attrgetter

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Confirmation, Design, ManoeuvrePrecision
from seatrial.core.results.design import count_outside_limits, is_within_limits
from seatrial.core.values import Array, Finding, InputError, Record, Severity
from seatrial.core.values.versions import versions
from seatrial.estimation.design.manoeuvre_information import (
    ManoeuvreEvaluator,
    assess_manoeuvre,
    input_series,
    order_table,
    orders_at,
    planned_record,
    sample_count,
    simulate_plan,
)
from seatrial.estimation.design.search import (
    GENERATIONS,
    DesignObjective,
    StandardManoeuvre,
    at_sensor_rate,
    search_orders,
    search_step,
    standard_manoeuvres,
)
from seatrial.estimation.design.task import (
    DesignTask,
    PriorShips,
    coefficient_magnitudes,
    draw_ships,
    relative_spread,
)
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.information.symmetries import refuse_unidentifiable
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Solution, levenberg_marquardt
from seatrial.numerics.workers import map_in_threads
from seatrial.physics.simulate.replay import replay

# Warnings on a design: limits, ships that leave them, unidentified coefficients, trials that do not confirm it.

# drift angle [rad] beyond which hull models are extrapolated, ours
_FAR_DRIFT = math.radians(45.0)
# share of drawn ships that leave the limits, and of fits that must converge, ours
_MANY_LEAVING, _ENOUGH_CONVERGED = 0.2, 0.8


def refuse_violated_limits(task: DesignTask, designed: ManoeuvrePrecision) -> None:
    """Refuse limits that no orders found keep."""
    if is_within_limits(designed, task.request.limits):
        return
    every = task.request.limits.for_every_ship
    drift = float(np.max([designed.drift, *(designed.sampled_drift if every else ())]))
    room = float(np.max([designed.distance, *(designed.sampled_distance if every else ())]))
    limits = task.request.limits
    if drift > limits.drift:
        excess = f"a drift angle of {math.degrees(drift):.3g} deg, {math.degrees(limits.drift):.3g} deg are allowed"
    else:
        excess = f"{room:.3g} m from the start, {limits.sea_room:.3g} m are allowed"
    whom = "some ship of the prior reaches" if every else "the ship reaches"
    less = ", or bind the ship as assumed only: design.every_ship = false" if every else ""
    raise InputError(
        f"[design] cannot be kept: under the best of all orders tried {whom} {excess}; widen that limit, shorten the "
        f"trial, or narrow the inputs' ranges{less}"
    )


def findings(
    task: DesignTask, designed: ManoeuvrePrecision, confirmation: Confirmation | None, *, is_interrupted: bool
) -> tuple[Finding, ...]:
    """Return everything worth a warning, the gravest first."""
    findings = list[Finding]()
    if is_interrupted:
        findings.append(_warning("interrupted", "the work was interrupted; this is the best so far"))  # fmt: skip
        if not is_within_limits(designed, task.request.limits):
            findings.append(_warning("leaves-limits", "these orders leave the limits"))
    return (
        *findings,
        *_unidentifiable(task, designed),
        *_limit_violations(task, designed),
        *_confirmation_findings(designed, confirmation),
    )


def _warning(code: str, text: str, advice: str = "") -> Finding:
    return Finding(Severity.WARNING, code, text, "", advice)


def _unidentifiable(task: DesignTask, designed: ManoeuvrePrecision) -> list[Finding]:
    names = task.model.parameters.free_names
    by_model = designed.relative_error > 1.0
    some = (
        np.any(np.nan_to_num(designed.sampled_relative_error) > 1.0, axis=0) & ~by_model
        if len(designed.sampled_relative_error)
        else np.zeros_like(by_model)
    )
    findings = []
    if by_model.any():
        listed = ", ".join(n for n, bad in zip(names, by_model, strict=True) if bad)
        findings.append(
            _warning(
                "not-identifiable",
                f"even this manoeuvre does not identify {listed}: the standard error exceeds the value",
            )
        )
    if some.any():
        listed = ", ".join(n for n, bad in zip(names, some, strict=True) if bad)
        findings.append(_warning("not-identifiable",
                              f"for some ship of the prior this manoeuvre does not identify {listed}",
                              "design again after a first trial, with --from and its model file"))  # fmt: skip
    return findings


def _limit_violations(task: DesignTask, designed: ManoeuvrePrecision) -> list[Finding]:
    findings, count = [], len(designed.sampled_relative_error)
    farthest = max([designed.drift, *designed.sampled_drift.tolist()])
    if straying := count_outside_limits(designed, task.request.limits):
        severity = Severity.WARNING if straying > _MANY_LEAVING * count else Severity.INFO
        findings.append(Finding(severity, "straying", f"{straying} of {count} ships drawn from the prior leave the "
                             f"limits under these orders, with up to {_drift_text(farthest)}"
                             f"{max(designed.sampled_distance.tolist()):.0f} m from the start"))  # fmt: skip
    elif farthest > _FAR_DRIFT:
        findings.append(_warning("drift", f"the manoeuvre reaches a drift angle of {math.degrees(farthest):.0f} deg "
                              "for some ship of the prior"))  # fmt: skip
    return findings


def _drift_text(farthest: float) -> str:
    return f"{math.degrees(farthest):.0f} deg of drift and " if math.isfinite(farthest) else ""


def _confirmation_findings(designed: ManoeuvrePrecision, confirmation: Confirmation | None) -> list[Finding]:
    findings = []
    if lost := designed.diverged:
        findings.append(
            _warning(
                "lost",
                f"{lost} of {len(designed.sampled_relative_error)} ships drawn from the prior cannot be simulated "
                "under these orders",
            )
        )
    if confirmation is not None and confirmation.converged_runs < _ENOUGH_CONVERGED * confirmation.runs:
        findings.append(
            _warning(
                "unconfirmed",
                f"only {confirmation.converged_runs} of {confirmation.runs} simulated trials "
                "could be fitted, so that the errors predicted are not confirmed",
            )
        )
    return findings


# A design tried on simulated trials: noisy records of ships the prior allows, fitted by output error.

# half width of the windows of the weak form over the shortest hold, ours
WINDOW_PER_HOLD = 1.5
# of the criterion: a move of some 1e-4 standard errors
NEGLIGIBLE_DECREASE = 1e-8
# standard deviations above the mean of chi squared, beyond which a fit is taken to be a wrong one; chosen
NOISE_DEVIATIONS = 5.0


def confirm_design(
    task: DesignTask,
    model_inputs: Array,
    planned: Record,
    ships: PriorShips,
    seed: int,
    report_progress: Callable[[str], None],
) -> Confirmation:
    """Return what a noisy record and a fit of every ship err by; `model_inputs`: the plan's at the sensors' rate.

    Each error counts over the one predicted for its ship, so that a ship that shows little outweighs no other.
    """
    predicted = ManoeuvreEvaluator(task, ships, 1.0 / task.request.rate).evaluate(model_inputs).relative_errors
    streams = np.random.SeedSequence(seed).spawn(ships.count)

    def fitted(number: int) -> Solution | None:
        ship = _model_with_values(task.model, ships.parameters[number])
        record = _simulate_trial(task, ship, planned, np.random.default_rng(streams[number]))
        return None if record is None else _fit_record(task, record)

    report_progress(f"confirming: {ships.count} simulated trials")
    results = map_in_threads(fitted, list(range(ships.count)))
    places = [task.model.parameters.index(n) for n in task.model.parameters.free_names]
    magnitudes = coefficient_magnitudes(task, ships.parameters)
    ratios, bounds = [], []
    for number, result in enumerate(results):
        if result is not None and result.status.is_success:
            error = (result.point - ships.parameters[number, places]) / magnitudes[number]
            ratios.append(error / predicted[number])
            bounds.append(predicted[number])
    none = np.full((1, len(places)), np.nan)
    bound = _rms(bounds or none)
    return Confirmation(ships.count, len(ratios), _rms(ratios or none) * bound, bound)


def _fit_record(task: DesignTask, record: Record) -> Solution:
    """Return the fit from the weak form's start; where it leaves more than noise, the better of it and another start.

    The other start is the model's own values.
    """
    outputs = tuple(task.sensors)
    problem = OutputError(
        task.model, cut_segments(task.model, [record], outputs, None), np.array(list(task.sensors.values())), workers=1
    )
    local = np.array([[task.initial_state[task.model.states.index(s)] for s in problem.starts]])
    count = len(record) * len(outputs)
    # half of chi squared, whose mean is its degrees of freedom, and its variance twice these
    noise = 0.5 * (count + NOISE_DEVIATIONS * math.sqrt(2.0 * count))
    solutions: list[Solution] = []
    for shared in (*_weak_form_start(task, problem, record), problem.start()):
        solutions.append(levenberg_marquardt(problem, shared, local, negligible=NEGLIGIBLE_DECREASE).solution)
        if solutions[-1].status.is_success and solutions[-1].value <= noise:
            break
    return min(solutions, key=lambda solution: solution.value)


def _weak_form_start(task: DesignTask, problem: OutputError, record: Record) -> list[Array]:
    """Return the weak form's start; none where the sensors do not show every state."""
    try:
        return [find_start(problem, [record], WINDOW_PER_HOLD * task.shortest_hold).common_parameters]
    except InputError:
        return []


def _model_with_values(model: Model, values: Array) -> Model:
    return model.with_values(dict(zip(model.parameters.names, values.tolist(), strict=True)))


def _simulate_trial(task: DesignTask, ship: Model, planned: Record, generator: np.random.Generator) -> Record | None:
    """Return sensors and inputs of a ship that follows the plan; None where the simulation diverges."""
    start = dict(zip(ship.states, task.initial_state.tolist(), strict=True))
    try:
        simulated = replay(ship, planned, start)
    except InputError:
        return None
    channels = {name: simulated.channel(name) for name in ship.input_names}
    for name, deviation in task.sensors.items():
        channel = simulated.channel(name)
        channels[name] = channel.with_values(channel.values + deviation * generator.standard_normal(len(simulated)))
    return replace(simulated, channels=channels)


def _rms(values: "list[Array] | Array") -> Array:
    return np.sqrt(np.mean(np.square(values), axis=0))


# A task in, a design out: standard manoeuvres measured, orders searched, both scored finely, the best confirmed.

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
    solution, interrupted = search_orders(yardstick, int(seeds[1]), report_progress, generations)
    fine, orders = at_sensor_rate(bench), orders_at(task, solution.point)
    inputs = input_series(task, orders, fine.dt)
    planned = planned_record(task, inputs, fine.dt)
    report_progress("scoring at the sensors' rate")
    designed = assess_manoeuvre("designed", fine, inputs, simulate_plan(task, planned, "designed"))
    if not interrupted:
        refuse_violated_limits(task, designed)
    baselines = tuple(_evaluate_standard(fine, one) for one in standard)
    tried = None
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
        solution=solution,
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
