"""Craft with thrusters whose coefficients are known, under steps of all commands and a small craft's sensors."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.physics.models.thruster_layout import (
    CATAMARAN,
    AngleInput,
    CommandInput,
    Damping,
    Rudder,
    ThrustCurve,
    Thruster,
    ThrusterLayout,
)
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.states import actuator_motion
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw, off_centre_box, scaled_values

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
    """A craft that is known: its thrusters, the true coefficients, and the range of each input's steps.

    version: of its problem. accept: what checks of its records object to, and what is right.
    """

    layout: ThrusterLayout
    values: Mapping[str, float]
    ranges: Mapping[str, tuple[float, float]]
    version: int = 2
    accept: tuple[str, ...] = ()

    @property
    def truth(self) -> Model:
        """The model with the true coefficients; those that are not listed are known to be what the model has."""
        model = thrusters(self.layout).with_values(dict(self.values))
        return model.with_parameters(model.parameters.only_free(tuple(self.values)))


def _azimuths() -> ThrusterLayout:
    """Return a small ferry with four equal pods at the corners of a rectangle; values chosen."""
    # forward and to starboard of the origin [m]
    places = ((1.8, -0.8), (1.8, 0.8), (-1.8, 0.8), (-1.8, -0.8))
    # time constant of turning a pod [s], length of the hull [m]
    azimuth_lag, length = 0.4, 5.0
    pods = tuple(
        Thruster(
            f"pod_{k}", x, y, CommandInput(f"command_{k}"), AngleInput(f"alpha_{k}", azimuth_lag),
            curve=ThrustCurve.QUADRATIC, same_as="" if k == 1 else "pod_1",
        )
        for k, (x, y) in enumerate(places, start=1)
    )  # fmt: skip
    return ThrusterLayout(pods, Damping.CROSS_FLOW, length)


def _twin_screw() -> ThrusterLayout:
    """Return a model ship with two equal screws and a rudder behind each; values chosen."""
    # length of the hull [m] and its mass [kg]
    length, mass = 4.4, 400.0
    # place forward of the origin [m], movable area [m^2], height [m]
    rudder = Rudder("delta", -2.2, 0.03, 0.25)
    # forward and to starboard of the origin [m], diameter [m], time constant of spinning up [s]
    x, side, diameter, lag = -2.0, 0.3, 0.2, 0.4
    screws = tuple(
        Thruster(name, x, y, CommandInput(f"rpm_{k}"), curve=ThrustCurve.OPEN_WATER, diameter=diameter, lag=lag,
                 same_as=leader, rudder=rudder)
        for k, (name, y, leader) in enumerate((("port", -side, "starboard"), ("starboard", side, "")), start=1)
    )  # fmt: skip
    return ThrusterLayout(screws, Damping.DIAGONAL, length, mass)


CRAFTS: Mapping[str, KnownThrusterCraft] = {
    "two-fixed": KnownThrusterCraft(
        CATAMARAN,
        {
            "tau": 0.3, "tau_down": 0.15, "k_f": 1.6, "k_b": 1.1, "p_f": 1.6, "p_b": 1.4, "k_J": 0.15, "k_4": 0.05,
            "X_u": -0.1, "X_uu": -0.3, "Y_v": -0.6, "Y_vv": -1.5, "N_r": -0.1, "N_rr": -0.2, "N_ur": -0.2,
            "Y_uv": -0.5, "Y_NT": 0.1, "M_v": 1.6, "M_r": 0.15,
        },
        {"command_1": (-1.0, 1.0), "command_2": (-1.0, 1.0)},
    ),
    "azimuths": KnownThrusterCraft(
        _azimuths(),
        {
            "tau": 0.35, "tau_down": 0.2, "tau_a": 0.5, "k_f": 0.25, "k_b": 0.2, "k_J": 0.05, "k_4": 0.1,
            "X_u": -0.03, "X_uu": -0.08, "Y_v": -0.05, "N_r": -0.2, "D_c": 0.03, "M_v": 1.5, "M_r": 2.2,
        },
        {f"command_{k}": (-1.0, 1.0) for k in (1, 2, 3, 4)} | {f"alpha_{k}": (-1.5, 1.5) for k in (1, 2, 3, 4)},
        version=3,  # angles within half a turn of one another: no step is ambiguous
    ),
    "twin-screw": KnownThrusterCraft(
        _twin_screw(),
        {
            "tau": 0.5, "tau_down": 0.3, "k_0": 0.45, "k_1": -0.35, "k_0_astern": -0.3, "f_alpha": 3.0, "gamma_R": 0.4,
            "X_u": -20.0, "X_uu": -25.0, "Y_v": -120.0, "Y_vv": -250.0, "N_r": -150.0, "N_rr": -300.0, "M_v": 600.0,
            "M_r": 700.0,
        },
        {"rpm_1": (-4.0, 10.0), "rpm_2": (-4.0, 10.0), "delta": (-0.5, 0.5)},
        version=3,
        accept=("command-range",),  # its inputs are turns a second, no shares of full command
    ),
}  # fmt: skip
"""Craft by name, SI; values chosen: a catamaran of 1 m, a ferry of 5 m by mass, a model ship of 4.4 m and 400 kg."""


_WORDS = {"two-fixed": "two fixed thrusters", "azimuths": "four azimuths", "twin-screw": "two screws and rudders"}


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return a problem for each craft."""
    noise = "u, v 0.03 m/s, r 0.01 rad/s, psi 0.01 rad, x0, y0 0.1 m, white"
    return tuple(
        BenchmarkProblem(
            f"thrusters-{name}", craft.version,
            f"a craft with {_WORDS[name]}, three runs of 60 s of steps of all commands, box ±50 % off centre",
            "ours", noise, _BUDGET, partial(_draw, craft),
        )
        for name, craft in CRAFTS.items()
    )  # fmt: skip


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


def _draw(craft: KnownThrusterCraft, rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    names = craft.truth.parameters.free_names
    truth = np.array([craft.values[name] for name in names])
    if placement is Placement.SHIFTED:
        truth = scaled_values(truth, _SCALE, rng)
    craft = replace(craft, values={**craft.values, **dict(zip(names, truth.tolist(), strict=True))})
    records = [noisy(run, rng) for run in simulated_runs(craft, rng)]
    box = off_centre_box(truth, _HALF_WIDTH, rng)
    ship = Ship("craft with thrusters", {"L": craft.layout.length})
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    known_craft = KnownCraft(ship, craft.truth, records, NOISE, [{}] * len(records), settings)
    draw = craft_draw(known_craft, box, 0.5 * (box.lower + box.upper))
    return draw if draw.trial is None else replace(draw, trial=replace(draw.trial, accept=craft.accept))
