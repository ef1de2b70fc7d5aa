"""A design nobody searched: nozzle angles drawn at random for the waterjet craft, with made-up errors."""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.results import Actuator, Confirmation, Design, ManoeuvrePrecision, TimedOrder, TrialLimits
from seatrial.core.values import Finding, Record, RecordKind, Severity
from seatrial.numerics.optimise import Solution, Status
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate import replay

HOLD, DURATION, RATE, JET = 6.0, 120.0, 5.0, 1.866
DRAWS = 5
LIMITS = TrialLimits(drift=math.radians(20.0), sea_room=120.0)


def planned(name: str, angles: list[float]) -> Record:
    """Nozzle angles [deg], each held for six seconds."""
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    step = np.minimum((time / HOLD).astype(int), len(angles) - 1)
    inputs = {"delta": np.radians(np.array(angles))[step], "v_j": np.full(len(time), JET)}
    return Record.from_arrays(name, time, inputs, RecordKind.PLANNED)


def fabricated_design() -> Design:
    """One design and three standard manoeuvres; one of them leaves the limits, one loses a ship."""
    rng = np.random.default_rng(3)
    angles = [float(a) for a in np.round(rng.uniform(-35.0, 35.0, 20))]
    model = waterjet()
    plan = planned("designed", angles)
    rivals = (
        _fabricated_manoeuvre("zigzag:20/20", planned("z", [20.0, 20.0, -20.0, -20.0] * 5), 0.05, rng),
        _fabricated_manoeuvre("prbs:35:10", planned("p", [35.0, -35.0] * 10), 0.03, rng),
        _fabricated_manoeuvre("turning-circle:35", planned("t", [35.0] * 20), 0.3, rng),
    )
    drawn = rivals[1].sampled_relative_error.copy()
    drawn[2] = np.nan
    return Design(
        question="How to steer for ten minutes?",
        ship="waterjet craft",
        model=model,
        coefficients=COEFFICIENTS,
        sensors={"u": 0.02, "psi": math.radians(0.2), "x0": 0.5},
        rate=RATE,
        duration=DURATION,
        actuators=(Actuator("delta", -math.radians(35.0), math.radians(35.0), math.radians(10.0), HOLD),),
        limits=LIMITS,
        criterion="worst",
        relative_spread=np.full(len(COEFFICIENTS), 0.3),
        designed=_fabricated_manoeuvre("designed", plan, 0.01, rng),
        baselines=(rivals[0], replace(rivals[1], sampled_relative_error=drawn), replace(rivals[2], distance=180.0)),
        orders=tuple(TimedOrder(HOLD * k, {"delta": math.radians(a)}) for k, a in enumerate(angles)),
        plan=plan,
        solution=Solution(np.radians(angles), 0.31, Status.EXHAUSTED, 1234, (0.9, 0.5, 0.31), 7),
        confirmation=Confirmation(40, 39, np.geomspace(0.01, 0.1, 11), np.geomspace(0.011, 0.09, 11)),
        findings=(
            Finding(Severity.WARNING, "design-drift", "The drift limit binds", "19.9 deg", "Allow a larger angle"),
        ),
        seed=7,
        elapsed_s=12.5,
        versions={"seatrial": "0.1.0"},
    )  # fmt: skip


def _fabricated_manoeuvre(name: str, plan: Record, error: float, rng: np.random.Generator) -> ManoeuvrePrecision:
    executed = replay(waterjet(), plan, {"u": 0.8, "v": 0.0, "r": 0.0}).renamed(name)
    relative = error * np.geomspace(1.0, 10.0, len(COEFFICIENTS)) * rng.uniform(0.7, 1.4, len(COEFFICIENTS))
    drawn = relative * rng.uniform(0.8, 1.8, (DRAWS, len(COEFFICIENTS)))
    distance = np.hypot(executed["x0"], executed["y0"])
    none = np.zeros(len(drawn))
    return ManoeuvrePrecision(name, relative, drawn, math.radians(18.0), float(distance.max()), none, none, executed)
