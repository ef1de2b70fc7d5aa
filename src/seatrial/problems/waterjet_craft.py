"""Song et al. 2025, table 2: a waterjet craft in zigzags under a craft's sensors."""

import numpy as np

from seatrial.core.values import Ship
from seatrial.data.example_series import SENSOR_NOISE, simulate_run, true_model, with_sensor_noise
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw, free_values, off_centre_box, placed_model

_SOURCE = (
    "Song et al. 2025, Chinese Journal of Ship Research 20(1), 65-75, table 2 (CFD) and figure 4; sensors and records "
    "are those of the package's demo"
)
# one of the paper's consecutive zigzags 10/10 to 30/30; it has five of each, which only lengthens the record
_MANOEUVRE = "consecutive-zigzags:1"
# m, m and kg, table 1 of the paper
_SHIP = Ship("waterjet craft of Song et al. 2025", {"L": 9.8, "d": 0.71, "m": 5540.0})
# half range of the factor by which a draw scales each true coefficient, and half width of its box, 1; chosen
_SCALE, _HALF_WIDTH = 0.1, 0.5
# evaluations, each a simulation of 415 s; chosen, half an hour of a craft's computer
_BUDGET = 1000


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem."""
    title = "waterjet craft in zigzags of 415 s, box ±50 % off centre"
    noise = "; ".join(f"{channel} {deviation:.3g}" for channel, deviation in SENSOR_NOISE.items()) + ", SI, white"
    return (BenchmarkProblem("song2025-zigzags", 2, title, _SOURCE, noise, _BUDGET, _draw),)


def _draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    model = placed_model(true_model(), placement, _SCALE, rng)
    clean = simulate_run(model, _MANOEUVRE)
    state = {name: float(clean[name][0]) for name in model.states}
    record = with_sensor_noise(clean, rng, 0)
    box = off_centre_box(free_values(model), _HALF_WIDTH, rng)
    craft = KnownCraft(_SHIP, model, [record], SENSOR_NOISE, [state])
    return craft_draw(craft, box, 0.5 * (box.lower + box.upper))
