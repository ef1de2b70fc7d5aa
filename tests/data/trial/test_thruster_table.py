"""Thrusters and sensors of a trial file: units, defaults, and one sentence for what is wrong."""

import math
from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.physics.models.thruster_layout import ThrusterLayout

FILE = """
[ship]
name = "craft"
L = 1.2
m = 17.0
{ship}

[model]
name = "thrusters"
{model}

[[thruster]]
name = "port"
{place}
{first}
same_as = "starboard"

[[thruster]]
name = "starboard"
x = -0.4
y = {{ value = 30.0, unit = "cm" }}
{second}

[sensors]
{sensors}

[[records]]
files = "run.csv"
time = {{ column = 1 }}
channels = {{ r = {{ column = 2, unit = "rad/s" }} }}
"""
PARTS = {
    "ship": "", "model": "", "place": "x = -0.4\ny = -0.3", "first": 'command = { channel = "command_1" }',
    "second": 'command = { channel = "command_2" }', "sensors": "",
}  # fmt: skip


def layout(tmp_path: Path, **parts: str) -> ThrusterLayout:
    path = tmp_path / "trial.toml"
    (tmp_path / "run.csv").touch()  # found, and read by nobody
    path.write_text(FILE.format(**(PARTS | parts)))
    return ThrusterLayout.from_text(load_trial(path).model.equations.layout)


def test_commands_are_shares_of_full_unless_the_file_says_otherwise(tmp_path: Path) -> None:
    pulse = 'command = { channel = "command_1", unit = "us", zero = 1511, positive = "astern" }'
    turns = 'command = { channel = "rpm_2", unit = "rpm", span = 3000 }'
    port, starboard = layout(tmp_path, first=pulse, second=turns).thrusters
    assert (port.command.zero, port.command.span) == (1511.0, -400.0)
    assert (starboard.command.zero, starboard.command.span) == (0.0, 50.0)
    assert (starboard.x, starboard.y) == (-0.4, pytest.approx(0.3))


def test_a_direction_is_an_angle_or_a_channel(tmp_path: Path) -> None:
    text = PARTS["first"] + '\nangle = { channel = "alpha_1", lag = 0.5, rate = { value = 60, unit = "deg/s" } }'
    fixed = PARTS["second"] + '\nangle = { value = 90, unit = "deg" }'
    port, starboard = layout(tmp_path, first=text, second=fixed).thrusters
    assert port.angle.rate == pytest.approx(math.radians(60.0))  # type: ignore[union-attr]
    assert starboard.angle == pytest.approx(math.pi / 2)


def test_a_known_thrust_gives_masses_and_forces(tmp_path: Path) -> None:
    found = layout(tmp_path, second=PARTS["second"] + "\nbollard = 35.0")
    assert found.mass == pytest.approx(1.05 * 17.0)
    assert found.has_bollard
    model = load_trial(tmp_path / "trial.toml").model
    assert not model.parameters["k_f"].free
    assert model.parameters["k_f"].value == 35.0
    assert model.parameters["M_u"].free


def test_wind_and_voltage_act_where_the_ship_has_areas_and_a_nominal_voltage(tmp_path: Path) -> None:
    found = layout(tmp_path, ship="A_T = 0.2\nA_L = 0.5\nV_0 = 14.8")
    assert (found.has_wind, found.has_voltage, found.mass) == (True, True, pytest.approx(1.05 * 17.0))
    model = load_trial(tmp_path / "trial.toml").model
    assert set(model.input_names) >= {"wind_speed", "wind_direction", "voltage"}
    assert (model.parameters["A_L"].value, model.parameters["V_0"].value) == (0.5, 14.8)
    assert not model.parameters["M_u"].free  # the mass is the scale of forces


def test_a_rudder_stands_behind_its_screw(tmp_path: Path) -> None:
    screw = 'command = { channel = "rpm_1", unit = "rpm" }\ncurve = "open-water"\ndiameter = 0.1\ndelay = 0.3'
    rudder = "\nrudder = { x = -0.5, area = 0.01, span = 0.12 }"
    first, _ = layout(tmp_path, first=f"{screw}{rudder}".replace("rpm_1", "rpm_2"), second=screw).thrusters
    assert (first.rudder.channel, first.rudder.span, first.delay) == ("delta", 0.12, 0.3)  # type: ignore[union-attr]
    with pytest.raises(InputError, match='a rudder needs the slipstream of its screw; add curve = "open-water"'):
        layout(tmp_path, first=PARTS["first"] + rudder)


@pytest.mark.parametrize(
    ("parts", "sentence"),
    [
        ({"place": "y = 0.3"}, "key 'thruster.1..x' is missing; add it"),
        ({"first": PARTS["first"] + '\ncurve = "cubic"'}, "'power', 'quadratic', 'linear', 'knots' or 'open-water'"),
        ({"first": 'command = { channel = "comand_1" }'}, "did you mean 'command_1'"),
        ({"first": 'command = { channel = "delta" }'}, "'delta' is no channel in 1"),
        ({"first": 'command = { channel = "rpm_1", unit = "rpm" }'}, "add command.span, the rpm at full command"),
        ({"first": PARTS["first"] + "\nangle = 90.0"}, 'angle = { value = 90, unit = "deg" }'),
        ({"first": PARTS["first"] + '\ncurve = "open-water"\ndiameter = 0.1'}, "give a command in rpm or rps"),
        ({"first": PARTS["first"] + '\nlagg = 0.1'}, "unknown key 'thruster.1..lagg'; did you mean 'lag'"),
        ({"first": PARTS["first"] + "\ndelay = 0.01"}, "delay = 0.01 s; give 0 for none, or 0.1 s and more"),
        ({"model": 'damping = "some"'}, "should be 'diagonal', 'full' or 'cross-flow'"),
        ({"sensors": 'compass = "magnetic"'}, "sensors.compass"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_in_one_sentence(tmp_path: Path, parts: dict[str, str], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as refusal:
        layout(tmp_path, **parts)
    assert len(str(refusal.value)) < 500


def test_thrusters_that_cannot_turn_the_craft_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "trial.toml"
    path.write_text(FILE.format(**PARTS).replace("y = -0.3", "y = 0.0").replace("value = 30.0", "value = 0.0"))
    with pytest.raises(InputError, match=r"'port', 'starboard' all push through the origin .* state x and y of each"):
        load_trial(path)


def test_thrusters_belong_to_their_model(tmp_path: Path) -> None:
    path = tmp_path / "trial.toml"
    path.write_text(FILE.format(**PARTS).replace('name = "thrusters"', 'name = "nomoto"'))
    with pytest.raises(InputError, match="is of the model 'thrusters' and the model is 'nomoto'"):
        load_trial(path)
