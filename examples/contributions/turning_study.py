"""A study to copy: one claim of a paper, checked by a simulation of our own."""

import time

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Check, Claim, Study, Table, Verdict
from seatrial.core.values import ProgressReporter, Record
from seatrial.core.values.versions import versions
from seatrial.physics.models import model_named
from seatrial.physics.simulate import replay

SOURCE = "Nomoto et al. 1957, Int. Shipbuilding Progress 4(35), eq. (6)"
RUDDER = np.radians(10.0)  # [rad] a moderate rudder, for which the linear equation is meant
# how far the simulated rate may lie from K delta [-]: the exponential leaves exp(-10) after ten time constants
TOLERANCE = 1e-4


def study(*, quick: bool, seed: int, report_progress: ProgressReporter | None) -> Study:
    """Return the study of the steady yaw rate after a step of the rudder.

    Args:
        quick: one time constant instead of three; every study offers a version of at most half a minute.
        seed: of everything drawn at random; nothing here.
        report_progress: receives one line for each step, if given.
    """
    start = time.perf_counter()
    rows = []
    for time_constant in (10.0,) if quick else (5.0, 10.0, 20.0):  # [s] quick to sluggish ships
        if report_progress:
            report_progress(f"time constant {time_constant:g} s")
        model = model_named("nomoto").with_values({"T": time_constant})
        rows.append((time_constant, steady_rate(model, 10.0 * time_constant) / (model.parameters["K"].value * RUDDER)))
    error = max(abs(ratio - 1.0) for _, ratio in rows)
    verdict = Verdict.CONFIRMED if error < TOLERANCE else Verdict.REFUTED
    return Study(
        name="nomoto1957",
        source=SOURCE,
        title="Steady yaw rate of the first-order steering equation",
        question="Does the yaw rate settle at K times the rudder angle?",
        claims=(Claim("After a step of the rudder r settles at K delta.", verdict, f"largest error {error:.1e}"),),
        checks=(Check("relative error of the steady rate [-]", error, TOLERANCE, error < TOLERANCE),),
        tables=(Table("Steady rates", ("T [s]", "r / (K delta) [-]"), tuple(rows)),),
        seed=seed,
        elapsed_s=time.perf_counter() - start,
        versions=versions(),
    )


def steady_rate(model: Model, duration: float) -> float:
    """Return the yaw rate [rad/s] after a step of the rudder held for `duration` [s], from a straight course."""
    time_base = np.linspace(0.0, duration, 1001)
    orders = Record.from_arrays("step", time_base, {"delta": np.full(len(time_base), RUDDER)})
    return float(replay(model, orders, dict.fromkeys(model.states, 0.0))["r"][-1])
