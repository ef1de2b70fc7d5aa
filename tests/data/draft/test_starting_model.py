"""The model and the held-out run of a draft follow from its channels and runs."""

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.starting_model import held_out_run, starting_model, thruster_tables

TIME = np.arange(400) * 0.5


def zigzag(rudder_deg: float) -> Record:
    delta = np.radians(rudder_deg) * np.sign(np.sin(0.2 * TIME))
    return Record.from_arrays("run", TIME, {"delta": delta, "psi": np.zeros(400)})


def decay(angle_deg: float) -> Record:
    phi = np.radians(angle_deg) * np.exp(-0.05 * TIME) * np.cos(TIME)
    return Record.from_arrays("run", TIME, {"phi": phi})


@pytest.mark.parametrize(
    ("symbols", "name"),
    [
        ({"delta", "psi", "command_1"}, "nomoto"),
        ({"command_1", "command_2", "psi", "phi"}, "thrusters"),
        ({"phi", "p"}, "roll"),
        ({"phi", "psi"}, ""),
        ({"lat", "lon"}, ""),
    ],
)
def test_the_model_follows_from_the_channels(symbols: set[str], name: str) -> None:
    assert starting_model(symbols, []).name == name


def test_the_fall_of_the_gain_is_free_where_rudder_angles_differ() -> None:
    symbols = {"delta", "psi"}
    assert starting_model(symbols, [zigzag(10.0), zigzag(20.0), None]).free == ("K", "T", "alpha")
    assert starting_model(symbols, [zigzag(20.0), zigzag(22.0)]).free == ()


def test_the_middle_run_within_the_others_is_held_out() -> None:
    records = {"a": zigzag(10.0), "b": zigzag(20.0), "c": zigzag(30.0)}
    model = starting_model({"delta"}, list(records.values()))
    assert held_out_run(model, records) == "a"  # c leaves what the others show
    assert held_out_run(model, records | {"d": zigzag(30.0)}) == "b"


def test_no_run_is_held_out_whose_side_no_other_shows() -> None:
    port = Record.from_arrays("p", TIME, {"delta": np.where(TIME > 20.0, -0.3, 0.0)})
    starboard = Record.from_arrays("s", TIME, {"delta": np.where(TIME > 20.0, 0.3, 0.0)})
    records = {"p": port, "s": starboard}
    assert held_out_run(starting_model({"delta"}, list(records.values())), records) == ""
    assert held_out_run(starting_model({"delta"}, [port]), {"p": port}) == ""


def test_the_smaller_of_two_decays_is_held_out_to_whichever_side_it_starts() -> None:
    records = {"large": decay(15.0), "small": decay(-10.0)}
    assert held_out_run(starting_model({"phi"}, list(records.values())), records) == "small"


def test_thrusters_are_named_by_the_side_that_the_motion_shows() -> None:
    left, right = (ColumnGuess(s, f"command_{k}", "1", side=s) for k, s in ((1, "port"), (2, "starboard")))
    text = "\n".join(thruster_tables([left, right]))
    assert 'name = "port"\nx = 0.0' in text and "y = -0.0" in text
    assert text.count("same_as") == 1
    unknown = thruster_tables([ColumnGuess("a", "command_1", "1"), ColumnGuess("b", "alpha_1", "rad")])
    assert 'name = "thruster_1"' in unknown and 'angle = { channel = "alpha_1" }' in unknown
