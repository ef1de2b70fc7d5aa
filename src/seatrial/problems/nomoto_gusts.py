"""Nomoto's steering model under gusts with a memory: a random rudder, and a controller on courses."""

import math
from dataclasses import replace
from functools import partial

import numpy as np

from seatrial.core.values import Ship
from seatrial.physics.models import nomoto
from seatrial.problems.boxes import off_centre_box, scaled_values
from seatrial.problems.disturbed_craft import AMPLITUDE, Disturbance, DisturbedCraft, independent_nomoto
from seatrial.problems.gust_bound import limit_of
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw

# 1/s and s of a ship of 50 m; chosen
_K, _T = 0.15, 8.0
NOMOTO = DisturbedCraft(
    "nomoto",
    nomoto().with_values({"K": _K, "T": _T}),
    {"r": AMPLITUDE * _K / _T},
    {"psi": math.radians(0.05), "r": math.radians(0.02)},  # rad and rad/s of a good compass and gyro, chosen
    50.0,  # m, length of the ship, chosen
    {"K": 0.1, "T": 10.0},  # 1/s and s where a search starts, chosen
    constant={"u": 5.0},  # m/s, recorded speed, chosen
)
"""The steering model of first order; a gust of size 1 is what the rudder of a programme does."""
# standard deviation over that of the rudder's effect, and memory [s], of the gusts; chosen
_GUSTS = Disturbance(0.3, 5.0)
# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.2, 0.5
# evaluations of two unknowns; chosen
_BUDGET = 1000
_SOURCE = "ours; the model is that of Nomoto et al. 1957, Int. Shipbuilding Progress 4(35), 354-370"


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem with a random rudder, and with a controller that answers to the gusts."""
    words = {"open": "a random binary rudder", "closed": "a controller on courses of ±10°"}
    noise = "gusts of 0.3 times the rudder's effect with a memory of 5 s; psi 0.05 deg, r 0.02 deg/s, white"
    return tuple(
        BenchmarkProblem(
            f"nomoto-gusts-{name}", 2, f"K and T of a steering model under gusts, {text}, 600 s", _SOURCE, noise,
            _BUDGET, partial(_draw, is_closed=name == "closed"),
        )
        for name, text in words.items()
    )  # fmt: skip


def _draw(rng: np.random.Generator, placement: Placement, *, is_closed: bool) -> ProblemDraw:
    truth = np.array([_K, _T])
    if placement is Placement.SHIFTED:
        truth = scaled_values(truth, _SCALE, rng)
    model = nomoto().with_values({"K": float(truth[0]), "T": float(truth[1])})
    craft = replace(NOMOTO, model=model, driven={"r": float(AMPLITUDE * truth[0] / truth[1])})
    (record,) = independent_nomoto(craft, _GUSTS, 1, rng, is_closed=is_closed)
    bound = limit_of(craft, _GUSTS, record).standard_error
    box = off_centre_box(truth, _HALF_WIDTH, rng)
    known = KnownCraft(
        Ship("steering model", {"L": NOMOTO.length}), model, [record], NOMOTO.sensors, dict.fromkeys(model.states, 0.0),
        disturbance_bound=bound,
    )  # fmt: skip
    return craft_draw(known, box, 0.5 * (box.lower + box.upper))
