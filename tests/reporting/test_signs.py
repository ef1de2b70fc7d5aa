"""What texts say of sides is what the equations do: both sides, models whose input counts to port and to starboard."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated import fabricated_fit

import seatrial as st
from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Ship
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting.source import input_variables
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.replay import trajectory
from seatrial.reporting.design import order_meaning
from seatrial.reporting.measures import manoeuvre_name
from seatrial.reporting.model_chapter import sign_conventions
from seatrial.reporting.verdict import run_name

SMALL = 0.01  # rad, of the rudder in the model's own sign
STEERED = {"waterjet": (waterjet, {"v_j": 1.866}), "mmg": (kvlcc2, {"n": 10.2}), "nomoto": (nomoto, {})}


def yaw_side(model: Model, inputs: dict[str, float]) -> str:
    """The side to which a positive input of the equations turns the craft, compared with a negative one."""
    start = np.array([1.0 if s == "u" else 0.0 for s in model.states])
    rates = []
    for sign in (1.0, -1.0):
        row = [sign * SMALL if n == "delta" else inputs.get(n, 0.0) for n in model.input_names]
        states, _ = trajectory(model, np.tile(row, (5, 1)), 0.1, start)
        rates.append(states[-1, model.states.index("r")])
    return "starboard" if rates[0] > rates[1] else "port"


@pytest.mark.parametrize("name", STEERED)
def test_the_declared_side_of_the_rudder_is_that_of_the_equations(name: str) -> None:
    make, inputs = STEERED[name]
    model = make()
    side = yaw_side(model, inputs)
    (delta,) = [i for i in model.inputs if i.name == "delta"]
    assert delta.direction == side
    assert f"positive when it turns the craft to {side}" in sign_conventions(model)
    (exported,) = [v for v in input_variables(model) if v.name == "delta"]
    assert exported.note.endswith(f"positive {side}")


@pytest.mark.parametrize(("manoeuvre", "side"), [("turning-circle:20", 1.0), ("turning-circle:20:port", -1.0)])
@pytest.mark.parametrize("name", ["waterjet", "mmg"])
def test_a_turn_to_a_side_is_called_so_and_goes_there(name: str, manoeuvre: str, side: float) -> None:
    """Records count the rudder positive to starboard, whatever the equations do."""
    make, inputs = STEERED[name]
    file = ModelFile(make(), ship=Ship("craft", {"L": 7.0}))
    record = st.simulate(file, manoeuvre, speed=1.0, inputs=inputs)
    words = "starboard" if side > 0.0 else "port"
    assert side * record["psi"][-1] > 1.0 and side * record["delta"][-1] > 0.3  # rad
    assert record.channel("delta").positive == "starboard"
    (held,) = fabricated_fit().validation
    assert run_name(replace(held, measured=record)) == f"turning circle to {words} with 20° rudder"
    assert manoeuvre_name(manoeuvre).endswith("to port") == (side < 0.0)


def test_orders_count_positive_as_the_records_do() -> None:
    assert order_meaning("delta").endswith(f"positive to {NOTATION['delta'].positive}")
    assert order_meaning("n") == NOTATION["n"].meaning or "positive" in order_meaning("n")
    assert order_meaning("command_of_mine") == "command_of_mine"
