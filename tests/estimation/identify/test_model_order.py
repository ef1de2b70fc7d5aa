"""A second pole and a zero are named where the craft has them, and only there."""

import re
from collections.abc import Mapping

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.results import Fit
from seatrial.core.values import Record, Ship
from seatrial.data.trial import Role, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.simulate import manoeuvre

CARGO_SHIP = {"K": 0.11, "T_1": 25.0, "T_2": 3.0, "T_3": 6.0}
FIRST_ORDER = {"K": 0.11, "T": 22.0}


def zigzag(craft: Model, angle: int, rng: np.random.Generator) -> Record:
    """A zigzag with the noise of a compass, a sample a second."""
    run = manoeuvre(craft, programme(f"zigzag:{angle}/{angle}"), duration=400.0, slew_rate=0.04).renamed(f"{angle}")
    run = run.resampled(1.0).without("r", "r_rest", "x0", "y0")
    return run.with_channel("psi", run.channel("psi").with_values(run["psi"] + 0.002 * rng.standard_normal(len(run))))


def fitted(craft: Model, model: Model, *, is_held_out: bool = True) -> Fit:
    rng = np.random.default_rng(3)
    role = Role.VALIDATE if is_held_out else Role.TRAIN
    runs = (Run(zigzag(craft, 20, rng)), Run(zigzag(craft, 10, rng), role))
    return identify(Trial(Ship("ship", {"L": 100.0}), runs, model))


def order_findings(fit: Fit) -> list[str]:
    return [f.text + f.advice for f in fit.findings if f.code == "held-coupling"]


@pytest.mark.parametrize("is_held_out", [True, False])
def test_the_second_order_of_a_ship_is_named_with_its_values_and_the_edit(is_held_out: bool) -> None:
    craft = nomoto2().with_values(CARGO_SHIP)
    (text,) = order_findings(fitted(craft, nomoto(), is_held_out=is_held_out))
    assert text.startswith("T_2 and T_3 are no terms of the model and the training runs speak against it")
    found = {name: float(value) for name, value in re.findall(r"(\w+) (-?[\d.]+)(?=,| and|\))", text)}
    assert {n: found[n] for n in CARGO_SHIP} == pytest.approx(CARGO_SHIP, rel=0.1)
    assert text.endswith('under [model] write name = "nomoto2", free = ["K", "T_1", "T_2", "T_3"]')


@pytest.mark.parametrize(
    ("craft", "values", "model"),
    [(nomoto(), FIRST_ORDER, nomoto()), (nomoto2(), CARGO_SHIP, nomoto2())],
)
def test_no_order_is_named_of_a_model_that_has_that_of_the_ship(
    craft: Model, values: Mapping[str, float], model: Model
) -> None:
    assert order_findings(fitted(craft.with_values(values), model)) == []
