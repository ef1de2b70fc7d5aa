"""The table [design]: a trial without records is one to be planned; what it says wrongly is refused with its key."""

import math
from pathlib import Path

import pytest

from seatrial.core.results import Actuator, TrialLimits
from seatrial.core.values import InputError
from seatrial.data.trial import load_records, load_trial

PLANNED = """
question = "how to steer?"

[ship]
name = "craft"
L = 9.8

[model]
name = "waterjet"

[noise]
u = 0.02
psi = { sd = 0.2, unit = "deg" }

[design]
duration = { value = 10, unit = "min" }
rate = 5
criterion = "mean"
draws = 7
prior_percent = 25
speed = { value = 2, unit = "kn" }
drift = { value = 20, unit = "deg" }
sea_room = 500

[design.inputs.delta]
lower = -35
upper = 30
unit = "deg"
rate = 10
hold = 4

[design.held]
v_j = 1.866
"""


STIFFNESS = "c33 = 3e6\nc35 = 0.0\nc53 = 0.0\nc55 = 6e8"


@pytest.fixture
def planned(tmp_path: Path) -> Path:
    path = tmp_path / "planned.toml"
    path.write_text(PLANNED)
    return path


def test_what_it_says_is_kept_in_si(planned: Path) -> None:
    request = load_trial(planned).design_request
    assert request is not None
    deg = math.pi / 180.0
    (delta,) = request.actuators
    assert (delta.name, delta.hold) == ("delta", 4.0)
    assert (delta.lower, delta.upper, delta.rate) == pytest.approx((-35 * deg, 30 * deg, 10 * deg))
    assert request.limits.drift == pytest.approx(20 * deg)
    assert (request.limits.sea_room, request.duration, request.rate) == (500.0, 600.0, 5.0)
    assert (request.criterion, request.draws, request.relative_spread) == ("mean", 7, 0.25)
    assert request.speed == pytest.approx(2 * 1852 / 3600)
    assert request.held == {"v_j": 1.866}


def test_what_it_does_not_say_is_free(planned: Path) -> None:
    text = PLANNED.replace("rate = 10\n", "").replace("sea_room = 500\n", "")
    text = text.replace('drift = { value = 20, unit = "deg" }\n', "").replace(
        'speed = { value = 2, unit = "kn" }\n', ""
    )
    planned.write_text(text)
    request = load_trial(planned).design_request
    assert request is not None
    assert request.limits == TrialLimits(for_every_ship=True)
    assert request.actuators[0] == Actuator("delta", math.radians(-35), math.radians(30), math.inf, 4.0)
    assert request.speed is None


def test_records_are_missed_where_they_are_needed(planned: Path) -> None:
    trial = load_trial(planned)
    with pytest.raises(InputError, match=r"planned.toml: there are no \[\[records\]\] to read"):
        load_records(trial)


def test_neither_records_nor_a_design_is_refused(planned: Path) -> None:
    planned.write_text(PLANNED[: PLANNED.index("[design]")])
    with pytest.raises(InputError, match=r"key 'records' is missing; add it, or a \[design\] table"):
        load_trial(planned)


def test_all_keys_that_the_table_lacks_are_named_at_once(planned: Path) -> None:
    text = PLANNED.replace('duration = { value = 10, unit = "min" }\n', "").replace("hold = 4\n", "")
    planned.write_text(text.replace('unit = "deg"\nrate', "rate"))
    lacking = r"keys 'design.duration', 'design.inputs.delta.unit' and 'design.inputs.delta.hold' are missing; add them"
    with pytest.raises(InputError, match=lacking):
        load_trial(planned)


WRONG = [
    ("unknown key", "draws = 7", "drows = 7", r"unknown key 'design.drows'; did you mean 'draws'"),
    ("unknown key of an input", "lower = -35", "lowr = -35", r"unknown key 'design.inputs.delta.lowr'.*'lower'"),
    ("missing", "duration = { value = 10, unit = \"min\" }\n", "", "key 'design.duration' is missing"),
    ("no hold", "hold = 4\n", "", "key 'design.inputs.delta.hold' is missing"),
    ("limits swapped", "upper = 30", "upper = -40", r"design.inputs.delta: lower = -35 is not below upper = -40"),
    ("unknown input", "[design.inputs.delta]", "[design.inputs.deltas]", r"'deltas' is no input.*'delta'"),
    ("unknown held", "v_j = 1.866", "v_k = 1.866", r"design.held.v_k: 'v_k' is no input.*'v_j'"),
    ("moved and held", "v_j = 1.866", "delta = 0", "'delta' is named under both"),
    ("unit of an input", 'unit = "deg"\nrate', 'unit = "m/s"\nrate', r"design.inputs.delta.unit: 'm/s' is no unit"),
    ("unknown unit", 'unit = "deg"\nrate', 'unit = "degree"\nrate', r"design.inputs.delta.unit: unknown unit 'degree'"),
    ("rate", "rate = 10\n", "rate = 0\n", r"design.inputs.delta.rate = 0: input should be greater than 0"),
    ("hold", "hold = 4", "hold = 4000", r"design.inputs.delta.hold = 4000 s is longer than the trial"),
    ("drift in degrees", '{ value = 20, unit = "deg" }', "20", r"design.drift: 1145.92 degrees are no limit"),
    ("drift", '{ value = 20, unit = "deg" }', "-0.1", r"design.drift: -0.1 is not positive"),
    ("kind of amount", "sea_room = 500", 'sea_room = { value = 5, unit = "s" }', r"design.sea_room: 's' is no unit"),
    ("sea room", "sea_room = 500", "sea_room = 0", r"design.sea_room: 0 is not positive"),
    ("sea room of a bathtub", "sea_room = 500", "sea_room = 9", "9 m are less than the ship's length of 9.8 m"),
    ("duration", '{ value = 10, unit = "min" }', "1", "are fewer than 20 samples"),
    ("criterion", '"mean"', '"best"', r"design.criterion = 'best'"),
    ("not a number", "sea_room = 500", "sea_room = nan", r"design.sea_room"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "says"), [w[1:] for w in WRONG], ids=[w[0] for w in WRONG])
def test_wrong_entries_are_refused_with_file_and_key(planned: Path, old: str, new: str, says: str) -> None:
    assert old in PLANNED
    planned.write_text(PLANNED.replace(old, new, 1))
    with pytest.raises(InputError, match=says) as caught:
        load_trial(planned)
    assert str(caught.value).startswith(f"{planned}: ")


def test_a_speed_needs_a_model_that_has_one(planned: Path) -> None:
    text = PLANNED.replace('name = "waterjet"', 'name = "heave_pitch"').replace("delta", "delta_f1")
    text = text.replace("v_j = 1.866", "").replace("L = 9.8", f"L = 60.0\nm = 4e5\nI5 = 1e8\n{STIFFNESS}")
    planned.write_text(text)
    with pytest.raises(InputError, match=r"design.speed: model 'heave_pitch' has no surge velocity u"):
        load_trial(planned)
