"""A zigzag that is predicted from turning circles alone is named as an extrapolation."""

import numpy as np
import pytest

from seatrial.core.values import Record, Ship
from seatrial.data.trial import Role, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.reporting.measures import extrapolation_text


def run(name: str, text: str, seed: int) -> Record:
    ship = nomoto().with_values({"K": 0.15, "T": 8.0})
    plan = manoeuvre(ship, programme(text), dt=0.5, speed=2.0, approach=5.0, duration=120.0)
    noise = np.random.default_rng(seed).standard_normal((2, len(plan)))
    values = {"r": plan["r"] + 1e-3 * noise[0], "psi": plan["psi"] + 2e-3 * noise[1]}
    return Record.from_arrays(name, plan.time, {"delta": plan["delta"], "u": np.full(len(plan), 2.0), **values})


@pytest.mark.parametrize(("trained", "codes"), [("turning-circle:20", ["untrained-manoeuvre"]), ("zigzag:20/20", [])])
def test_a_kind_that_was_never_trained_is_named(trained: str, codes: list[str]) -> None:
    runs = (run("a", trained, 1), run("b", trained, 2), run("held", "zigzag:15/15", 3))
    roles = (Role.TRAIN, Role.TRAIN, Role.VALIDATE)
    fit = identify(Trial(Ship("craft", {"L": 8.0}), tuple(map(Run, runs, roles)), nomoto()))
    found = [f for f in fit.findings if f.code == "untrained-manoeuvre"]
    assert [f.code for f in found] == codes
    reached = fit.validation[0].extrapolation
    assert reached is not None
    assert ("no training run is a zigzag" in extrapolation_text(reached)) is bool(codes)
