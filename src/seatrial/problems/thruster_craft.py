"""A craft with two thrusters whose coefficients are known, under steps of both commands and a small craft's sensors."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.physics.models.thruster_layout import CATAMARAN, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.actuators import actuator_motion
from seatrial.physics.simulate.replay import replay
from seatrial.problems.boxes import off_centre_box, scaled_values
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw

# m/s, m/s, rad/s, rad, m, m: standard deviations of a small craft's receiver and compass; chosen
NOISE = {"u": 0.03, "v": 0.03, "r": 0.01, "psi": 0.01, "x0": 0.1, "y0": 0.1}
SECONDS, STEP_S, DT = 60, 3, 0.1
"""Length of a run, of a step of the commands, and of a sample [s]."""
# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.1, 0.5
# evaluations, each a simulation of three runs; chosen
_BUDGET = 1000


@dataclass(frozen=True)
class KnownThrusterCraft:
    """A craft that is known: its thrusters, the true coefficients, and the range of each input's steps."""

    layout: ThrusterLayout
    values: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]

    @property
    def truth(self) -> Model:
        """The model with the true coefficients."""
        return thrusters(self.layout).with_values(dict(self.values))


# SI; a catamaran of 1 m, values chosen
TWO_FIXED = KnownThrusterCraft(
    CATAMARAN,
    {
        "tau": 0.3, "tau_down": 0.15, "k_f": 1.6, "k_b": 1.1, "p_f": 1.6, "p_b": 1.4, "k_J": 0.15, "k_4": 0.05,
        "X_u": -0.1, "X_uu": -0.3, "Y_v": -0.6, "Y_vv": -1.5, "N_r": -0.1, "N_rr": -0.2, "N_ur": -0.2,
        "Y_uv": -0.5, "Y_NT": 0.1, "M_v": 1.6, "M_r": 0.15,
    },
    {"command_1": (-1.0, 1.0), "command_2": (-1.0, 1.0)},
)  # fmt: skip


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem."""
    noise = "u, v 0.03 m/s, r 0.01 rad/s, psi 0.01 rad, x0, y0 0.1 m, white"
    title = "a craft with two thrusters, three runs of 60 s of steps of both commands, box ±50 % off centre"
    return (BenchmarkProblem("thrusters-two-fixed", 1, title, "ours", noise, _BUDGET, _draw),)


def simulated_runs(craft: KnownThrusterCraft, rng: np.random.Generator, count: int = 3) -> list[Record]:
    """Return runs of steps of all inputs, without noise."""
    model, runs = craft.truth, []
    for k in range(count):
        steps = rng.uniform(0.0, 1.0, size=(SECONDS // STEP_S, len(craft.ranges)))
        shares = np.repeat(steps, round(STEP_S / DT), axis=0)
        inputs = {n: low + (high - low) * shares[:, j] for j, (n, (low, high)) in enumerate(craft.ranges.items())}
        planned = Record.from_arrays(f"run_{k + 1}", DT * np.arange(len(shares), dtype=np.float64), inputs)
        columns = np.stack([inputs[n] for n in model.input_names], axis=1)
        settled = {n: float(motion[0]) for n, motion in actuator_motion(model, columns, DT).items()}
        run = replay(model, planned, dict.fromkeys(model.states, 0.0) | settled)
        runs.append(replace(run, channels={n: run.channel(n) for n in (*NOISE, *inputs)}))
    return runs


def noisy(run: Record, rng: np.random.Generator) -> Record:
    """Return what instruments record of a run."""
    channels = dict(run.channels)
    for name, spread in NOISE.items():
        channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
    return replace(run, channels=channels)


def _draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    names = TWO_FIXED.truth.parameters.free_names
    truth = np.array([TWO_FIXED.values[name] for name in names])
    if placement is Placement.SHIFTED:
        truth = scaled_values(truth, _SCALE, rng)
    craft = replace(TWO_FIXED, values={**TWO_FIXED.values, **dict(zip(names, truth.tolist(), strict=True))})
    records = [noisy(run, rng) for run in simulated_runs(craft, rng)]
    box = off_centre_box(truth, _HALF_WIDTH, rng)
    ship = Ship("catamaran with two thrusters", {"L": craft.layout.length})
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    known = KnownCraft(ship, craft.truth, records, NOISE, dict.fromkeys(craft.truth.states, 0.0), settings)
    return craft_draw(known, box, 0.5 * (box.lower + box.upper))
