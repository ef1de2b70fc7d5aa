"""A gust of 1 N, one percent of thrust: output error believes it is certain and is wrong, prediction error knows.

The craft of Song et al. 2025 in consecutive zigzags of 2075 s at 10 Hz with sensor noise, pushed by random forces on
surge and sway and by the same force at a quarter of its length in yaw. The force is drawn anew every 0.1 s, or is a
first-order Gauss-Markov process with a memory of 5 s. The helmsman steers the pushed craft; steps of 0.01 s, of which
the record keeps every tenth. Every run is identified from coefficients zero. `python benchmarks/gust.py --runs 50`.
"""

import argparse
import math
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import sympy as sp
from measure import Line, at_most, machine
from numba import njit
from numpy.typing import NDArray
from scipy.signal import lfilter

from seatrial.core.equations import Model
from seatrial.core.equations.bindings import Input
from seatrial.core.values import Record
from seatrial.data.example_series.series import (
    APPROACH_S,
    FINE_STEP,
    JET_VELOCITY,
    SAMPLE_RATE,
    SLEW_RATE,
    true_model,
    with_sensor_noise,
)
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import output_error_problem
from seatrial.estimation.estimate.point_estimate import fit_output_error
from seatrial.estimation.estimate.process_noise import fit_prediction_error
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.settings import SEGMENT_SHIP_LENGTHS, WEAK_FORM_SHIP_LENGTHS
from seatrial.estimation.estimate.start import find_start
from seatrial.estimation.information.covariance import from_information
from seatrial.numerics.kernels.steering import steer
from seatrial.numerics.kernels.types import COMMAND_SIGNATURE, OPTIONS
from seatrial.numerics.workers import map_in_processes
from seatrial.physics.manoeuvres import zigzag
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.manoeuvres.steering import FINISHED, Steering, rudder_angles
from seatrial.physics.simulate.approach import approach_speed
from seatrial.physics.simulate.channels import record_of

Array = NDArray[np.float64]
FORCE, LEVER_LENGTHS, HELD, MEMORY = 1.0, 0.25, 0.1, 5.0
EXECUTES, RUNS, SEED = 5, 50, 11
KINDS = ("white", "coloured", "calm")
WITHIN, WRONG, SECONDS = 0.4, 2.0, 10.0
_STEP, _BASE = -2, -1


@njit(COMMAND_SIGNATURE, **OPTIONS)
def forced_helmsman(t, x, memory, u):
    """The zigzag helmsman; behind his memory lie the forces of every step, which become inputs."""
    zigzag.helmsman(t, x, memory, u)
    first = int(memory[_BASE]) + 3 * round(t / memory[_STEP])
    for j in range(3):
        u[2 + j] = memory[first + j]


def craft_with_forces() -> Model:
    """The craft with three more inputs: forces on surge and sway [N], moment in yaw [N m]."""
    craft = true_model()
    inertia = {"u": ("gust_x", "m", "m_x"), "v": ("gust_y", "m", "m_y"), "r": ("gust_n", "I_z", "J_z")}

    def rate(state: str) -> sp.Expr:
        force, mass, added = (sp.Symbol(n, real=True) for n in inertia[state])
        return force / (mass + added)

    rates = tuple(
        replace(b, expression=b.expression + rate(b.name)) if b.name in inertia else b for b in craft.equations.rates
    )
    inputs = (*craft.equations.inputs, *(Input(force) for force, _, _ in inertia.values()))
    return Model(replace(craft.equations, name="waterjet in gusts", rates=rates, inputs=inputs), craft.parameters)


def forces(kind: str, rows: int, length: float, rng: np.random.Generator) -> Array:
    """Forces [N, N, N m] of every fine step, (rows, 3)."""
    if kind == "white":
        hold = round(HELD / FINE_STEP)
        unit = np.repeat(rng.standard_normal((rows // hold + 1, 3)), hold, axis=0)[:rows]
    else:
        keep = math.exp(-FINE_STEP / MEMORY)
        kicks = rng.standard_normal((rows, 3))
        kicks[1:] *= math.sqrt(1.0 - keep**2)
        unit = np.asarray(lfilter([1.0], [1.0, -keep], kicks, axis=0))
    return FORCE * unit * [1.0, 1.0, LEVER_LENGTHS * length]


def simulate_run(kind: str, executes: int, rng: np.random.Generator) -> Record:
    """One run of the series with the helmsman in the loop, without sensor noise."""
    craft, pushed_craft = true_model(), craft_with_forces()
    plan, length = programme(f"consecutive-zigzags:{executes}"), craft.parameters["L"].value
    begin = np.zeros(len(craft.states))
    begin[0] = approach_speed(craft, np.array([0.0, JET_VELOCITY]))
    unit = length / begin[0]
    rows = int((APPROACH_S + plan.maximum_lengths * unit) / FINE_STEP) + 1
    push = np.zeros((rows, 3)) if kind == "calm" else forces(kind, rows, length, rng)
    memory = plan.memory(Steering(3, 2, 0, -1.0, SLEW_RATE, FINE_STEP, APPROACH_S, unit))
    memory = np.concatenate([memory, push.ravel(), [FINE_STEP, len(memory)]])
    states, inputs = np.empty((rows, len(begin))), np.empty((rows, 5))
    held = np.array([0.0, JET_VELOCITY, 0.0, 0.0, 0.0])
    rates, values = pushed_craft.compiled.rates, pushed_craft.parameters.values
    steer(rates, forced_helmsman, begin, held, values, memory, FINE_STEP, states, inputs)
    last, kept = round(memory[FINISHED] / FINE_STEP) + 1, round(1.0 / (FINE_STEP * SAMPLE_RATE))
    angles = rudder_angles(inputs[:last, 0])[::kept]
    used = np.stack([angles, np.full(len(angles), JET_VELOCITY)], axis=1)
    time_axis = np.linspace(0.0, (len(used) - 1) / SAMPLE_RATE, len(used))
    return record_of(craft, kind, time_axis, np.ascontiguousarray(states[:last:kept]), np.empty((len(used), 0)), used)


@dataclass(frozen=True)
class Item:
    """One run to be made and identified."""

    kind: str
    stream: np.random.SeedSequence
    executes: int


@dataclass(frozen=True, eq=False)
class GustOutcome:
    """Errors and predicted standard errors of both criteria, (coefficients,), what the gate said, times in s."""

    output_error: tuple[Array, Array]
    innovations: tuple[Array, Array]
    is_needed: bool
    is_white: bool
    ratio: float
    samples: int
    cpu: float
    wall: float


def outcome(item: Item) -> GustOutcome:
    """Make one run; fit it by output error over the whole run, and by prediction error from nothing."""
    model, rng = true_model(), np.random.default_rng(item.stream)
    record = with_sensor_noise(simulate_run(item.kind, item.executes, rng), rng, SEED)
    names = model.parameters.free_names
    runs = Runs.one_session_each([record], model.parameters["L"].value)
    values = np.array([model.parameters[n].value for n in names])
    blank = model.with_values(dict.fromkeys(names, 0.0))
    unit = model.parameters["L"].value / float(np.median(record["u"]))
    begin = find_start(
        output_error_problem(blank, runs, SEGMENT_SHIP_LENGTHS * unit, EstimateSettings(), workers=1), [record],
        WEAK_FORM_SHIP_LENGTHS * unit,
    )  # fmt: skip
    segments = fit_output_error(begin.problem, begin.common_parameters, begin.initial_states, {})
    cpu, wall = time.process_time(), time.perf_counter()
    found = fit_prediction_error(segments)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    problem = output_error_problem(model, runs, np.inf, EstimateSettings(), workers=1)
    whole = fit_output_error(problem, problem.start(), problem.measured_initial_states(), {})
    # the information matrix of white residuals: what output error reports to its user
    reported = from_information(
        replace(whole.problem, inflation=None).normal(whole.common_parameters, whole.optimum.local).without_local()[1]
    )
    return GustOutcome(
        (whole.common_parameters - values, reported.standard_error),
        (found.common_parameters - values, found.interval.standard_error),
        found.test.is_needed,
        found.test.is_white,
        found.test.likelihood_ratio,
        len(record),
        cpu,
        wall,
    )


def outcomes(kind: str, runs: int, executes: int, seed: int, workers: int | None) -> list[GustOutcome]:
    """`runs` runs of one kind."""
    streams = np.random.SeedSequence([seed, KINDS.index(kind)]).spawn(runs)
    return map_in_processes(outcome, [Item(kind, s, executes) for s in streams], workers=workers)


def ratios(pairs: Sequence[tuple[Array, Array]]) -> Array:
    """Root-mean-square error over the root-mean-square predicted one, each coefficient."""
    errors, predicted = np.array([e for e, _ in pairs]), np.array([s for _, s in pairs])
    return np.sqrt(np.mean(errors**2, axis=0) / np.mean(predicted**2, axis=0))


def lines(kind: str, results: Sequence[GustOutcome]) -> list[Line]:
    """The table of one kind against its targets."""
    model, runs = true_model(), len(results)
    names = model.parameters.free_names
    values = np.array([model.parameters[n].value for n in names])
    whole, best = ratios([o.output_error for o in results]), ratios([o.innovations for o in results])
    share = np.sqrt(np.mean([(o.output_error[0] / values) ** 2 for o in results], axis=0))
    shut = sum(not o.is_needed for o in results)
    gate = Line("gate: process noise needed", runs - shut, "", f"{runs} of {runs}", shut == 0)
    if kind == "calm":
        gate = Line("gate: no process noise", shut, "", f"{runs} of {runs}", shut == runs)
    table = [
        gate,
        Line("innovations white", sum(o.is_white for o in results), f"of {runs}"),
        Line("twice the log-likelihood gained, median", float(np.median([o.ratio for o in results])), ""),
        Line("prediction error, samples", float(np.median([o.samples for o in results])), ""),
        at_most("prediction error, one core's time, median", float(np.median([o.cpu for o in results])), "s", SECONDS),
        Line("prediction error, one core's time, largest", max(o.cpu for o in results), "s"),
    ]
    wrong = int(np.argmax(whole))
    worst = Line(f"output error, RMSE / predicted, worst ({names[wrong]})", float(whole[wrong]), "")
    if kind != "calm":
        worst = replace(worst, target=f"> {WRONG:g}", holds=bool(whole[wrong] > WRONG))
    table += [
        worst,
        Line(f"output error, RMSE / value, worst ({names[int(np.argmax(share))]})", float(share.max()), ""),
    ]
    limits = f"{1 - WITHIN:g} to {1 + WITHIN:g}"
    for i, name in enumerate(names):
        error = np.sqrt(np.mean([o.innovations[1][i] ** 2 for o in results])) / abs(values[i])
        what = f"{name}: prediction error, RMSE / predicted ({error:.2%} of the value; output error {whole[i]:.3g})"
        table.append(Line(what, float(best[i]), "", limits, bool(abs(best[i] - 1.0) <= WITHIN)))
    return table


def run() -> list[Line]:
    """All three kinds; some twenty minutes on two cores."""
    return [replace(line, quantity=f"{kind}: {line.quantity}") for kind in KINDS
            for line in lines(kind, outcomes(kind, RUNS, EXECUTES, SEED, None))]  # fmt: skip


def main(arguments: list[str]) -> int:
    """Print a table for each kind of run; 1 if a target is missed."""
    parser = argparse.ArgumentParser(description="output error and prediction error under a gust of 1 N")
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--executes", type=int, default=EXECUTES, help="of each zigzag angle; 5: 2075 s")
    parser.add_argument("--workers", type=int, default=None, help="processes; default: all cores")
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=KINDS)
    given = parser.parse_args(arguments)
    print(machine())
    missed = False
    for kind in given.kinds:
        print(f"{kind} gust, {given.runs} runs:" if kind != "calm" else f"calm, {given.runs} runs:")
        table = lines(kind, outcomes(kind, given.runs, given.executes, given.seed, given.workers))
        for line in table:
            print(f"  {line.quantity:<90} {line.value:>10.4g} {line.unit:<6} {line.verdict}", flush=True)
        missed = missed or any(line.holds is False for line in table)
    return int(missed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
