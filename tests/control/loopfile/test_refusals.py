"""Whatever is wrong with a loop file is said in one sentence with file and key."""

from pathlib import Path

import pytest
from tests.control.loop_files import AUTOPILOT, FIN, model_file, nomoto, roll, write_loop_file

from seatrial.control.loopfile.load import tuning_task
from seatrial.core.values import InputError

SEA = 'heading = { value = 90, unit = "deg" }'
ROLL = "den = [1.43242, 0.3796, 1.0]"
KIND = 'kind = "yu2014"'


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([(ROLL, "den = [1.43242, -0.3796, 1.0]")], "'fins to roll' has a pole in the right half plane"),
        ([("K_alpha", "K_alfa")], "unknown key 'plant.fin.K_alfa'; did you mean 'K_alpha'"),
        ([("height = 3.3", "hight = 3.3")], "unknown key 'seas[1].hight'; did you mean 'height'"),
        ([(KIND, "")], "key 'controller.kind' is missing"),
        ([(KIND, 'kind = "pd"')], "controller.kind = 'pd'"),
        ([(SEA, 'heading = { value = 0, unit = "deg" }')], "seas[1]: the sea has no wave slope across the ship"),
        ([(SEA, 'heading = { value = 180, unit = "deg" }')], "seas[1]: the sea has no wave slope across the ship"),
        ([(SEA, "heading = 90")], "seas[1].heading: 90 rad is no heading to the waves"),
        ([(SEA, 'heading = { value = 9, unit = "m" }')], "seas[1].heading: 'm' is no unit of what is measured in rad"),
        ([("height = 3.3", "height = 0")], "seas[1].height: 0 is not positive"),
        ([("height = 3.3", "")], "seas[1]: spectrum 'ittc' needs a height"),
        ([("height = 3.3", "height = 3.3\nperiod = 8")], "seas[1]: spectrum 'ittc' has no period"),
        ([('spectrum = "ittc"\nheight = 3.3', 'spectrum = "sea-state"\nstate = 0')], "sea state 0"),
        ([('"ittc"\nheight = 3.3', '"jonswap"\nheight = 3.3\nperiod = 8\ngamma = 50')], "seas[1].gamma: the peak"),
        ([("value = 22", "value = -22")], "actuator.limit = -22 is not positive"),
        ([('{ value = 22, unit = "deg" }', "22")], "actuator.limit = 22 rad is half a turn or more"),
        ([("[actuator]", "[limits]\nMs = 0.9\n[actuator]")], "limits.Ms = 0.9: input should be greater than 1"),
        ([("[actuator]", "[limits]\nsaturation = -0.1\n[actuator]")], "limits.saturation = -0.1"),
        ([("[actuator]", "[actuator]\nservo = [{ num = [1.0, 0.0], den = [1.0] }]")], "servo[1]: block 'servo'"),
        ([("[actuator]", "[actuator]\nservo = [{ num = [1.0] }]")], "actuator.servo[1]: give num and den"),
        ([(KIND, 'kind = "blocks"')], "controller: kind 'blocks' needs at least one entry in [[controller.terms]]"),
        ([(KIND, 'kind = "pid"\npreamplifier = "washout"')], "controller: kind 'pid' knows no 'preamplifier'"),
        ([(KIND, 'kind = "blocks"\nterms = [{ gain = "K1", num = [1], den = [1] }]')], "K1: the gain has no bounds"),
        (
            [(KIND, 'kind = "blocks"\nterms = [{ gain = "K", num = [1], den = [1] }]\ngains = { K = { lower = 1 } }')],
            "controller.gains.K: the gain has no bounds",
        ),
        ([(KIND, KIND + "\ngains = { KQ = { value = 1 } }")], "no part of the controller has a gain 'KQ'; did"),
        ([(KIND, KIND + "\ngains = { KP = { value = 200 } }")], "controller.gains.KP: value = 200 lies outside"),
        ([(KIND, KIND + "\ngains = { KP = { fixed = true } }")], "controller.gains.KP: a fixed gain needs its value"),
        ([(KIND, KIND + "\ngains = { KP = { lower = 3, upper = 1 } }")], "lower = 3 is not below upper = 1"),
        (
            [(KIND, KIND + "\ngains = { KP = { value = 1, fixed = true }, KI = { value = 1, fixed = true }, "
              "KD = { value = 1, fixed = true } }")],
            "every gain is fixed",
        ),
        (
            [("[actuator]", "[baselines.hand]\nKP = 1\nKI = 1\nKd = 1\n[actuator]")],
            "hand: the controller has no gain 'Kd'",
        ),
        ([("[actuator]", "[baselines.hand]\nKP = 1\nKI = 1\n[actuator]")], "baselines.hand: gain KD is missing"),
        ([('speed = { value = 18, unit = "kn" }', "")], "key 'plant.speed' is missing"),
        ([("K_alpha = 0.256", "K_alpha = -0.256")], "plant.fin.K_alpha = -0.256"),
        ([("[plant.fin]\nK_alpha = 0.256", "")], "plant: roll needs a table [plant.fin]"),
        ([("[actuator]", "minimise = []\n[actuator]")], "unknown key 'controller.minimise'"),
        ([("[plant]", "minimise = []\n[plant]")], "minimise is an empty list"),
        ([("[plant]", 'minimise = "roll"\n[plant]')], "minimise = 'roll' is no list"),
        ([("[plant]", 'minimise = ["roll", "fin", "output"]\n[plant]')], "the roll angle is named twice"),
        ([("[[seas]]", "[seas]")], "seas is one table where a list of them belongs; write it as [[seas]]"),
        ([('{ value = 25, unit = "deg/s" }', "25")], "actuator.rate = 25 is half a turn a second or more"),
        ([(ROLL, "den = [1.43242, 0.0, 1.0]")], "'fins to roll' swings undamped at 0.8355 rad/s"),
        (
            [(ROLL, "den = [1.43242, 1e-6, 1.0]")],
            "swings undamped at 0.8355 rad/s (a period of 7.52 s with a damping ratio of 4e-07)",
        ),
        (
            [(ROLL, "den = [0.0143242, 0.003796, 0.01]")],
            "without control phi would reach 721 deg rms (ITTC one-parameter 3.3 m, long-crested, 90 deg, 9.26 m/s)",
        ),
        ([("num = [1.0]", "num = [-1.0]")], "plant.roll: a positive alpha_f rolls the ship to starboard by convention"),
        (
            [("[actuator]", "[actuator]\nservo = [{ num = [-2.0], den = [0.1, 1.0] }]")],
            "actuator.servo[1] answers an order of 1 with -2",
        ),
        ([("num = [1.0]", "num = [0.0]")], "plant.roll.num is zero"),
        ([("[actuator]", "[simulation]\nduration = 1e12\n[actuator]")], "simulation: 20 seas of 1e+12 s"),
        ([("[plant]", 'minimise = ["yaw"]\n[plant]')], "minimise[1].name = 'yaw'"),
        ([("[plant]", 'minimise = ["motion_sickness"]\n[plant]')], "minimise[1]: 'motion_sickness' needs lever"),
        ([("[plant]", 'minimise = ["energy"]\n[plant]')], "minimise[1]: 'energy' needs [actuator] inertia"),
        ([("[actuator]", "[actuator]\narea = 5.0")], "needs both area and aspect_ratio"),
        (
            [("[plant]", 'minimise = ["fin_off_target"]\n[plant]'), ('limit = { value = 22, unit = "deg" }', "")],
            "minimise[1]: there is neither a target nor an [actuator] limit",
        ),
        (
            [("[actuator]", '[[extended_structures]]\nadd = ["notch", "notch"]\n[actuator]')],
            "extended_structures[1]: add names a part twice",
        ),
        (
            [("[actuator]", "[schedule]\nspeeds = [9.0]\nheadings = [0.0, 1.0]\nheights = [3.0]\n[actuator]")],
            "schedule.headings: the sea has no wave slope across the ship at a heading of 0 deg",
        ),
        ([("[actuator]", "[schedule]\nspeeds = []\nheadings = [1.0]\nheights = [3.0]\n[actuator]")], "schedule.speeds"),
        ([("[actuator]", "[simulation]\nstep = 500\n[actuator]")], "simulation: steps of 500 s"),
        ([("[actuator]", "[simulation]\nseeds = 1\n[actuator]")], "simulation.seeds = 1 gives no interval"),
        ([("[actuator]", "[demand]\nchange = 0.1\n[actuator]")], "demand: a roll stabiliser follows no demand"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_fin_file_is_said(changes: list[tuple[str, str]], says: str, tmp_path: Path) -> None:
    path = write_loop_file(tmp_path, FIN, *changes)
    with pytest.raises(InputError) as refused:
        tuning_task(path)
    said = str(refused.value)
    assert says in said and str(path) in said and "\n" not in said


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([("bandwidth = 0.05", "bandwidth = -1")], "slow_disturbances[1].bandwidth: -1 is not positive"),
        ([('rms = { value = 1, unit = "deg" }\n', "")], "key 'slow_disturbances[1].rms' is missing"),
        ([('model = "model.toml"', 'model = "absent.toml"')], "absent.toml' cannot be read"),
        ([('model = "model.toml"', 'model = "loop.toml"')], "loop.toml' is no seatrial model file"),
        ([('model = "model.toml"', 'model = "model.toml"\nactuator = "rudder"')], "plant.actuator: 'rudder' is no"),
        ([('model = "model.toml"', 'model = "model.toml"\noutput = "r"')], "plant: model 'nomoto' of"),
        ([('model = "model.toml"', 'model = "model.toml"\n[plant.fin]\nK_alpha = 1')], "key 'plant.speed' is missing"),
        ([('model = "model.toml"', 'model = "model.toml"\ninputs = { n = 10 }')], "plant.inputs.n: 'n' is no input"),
        (
            [('[[slow_disturbances]]\nrms = { value = 1, unit = "deg" }\nbandwidth = 0.05', "")],
            "nothing disturbs the loop",
        ),
        (
            [("[[slow_disturbances]]", f"[[seas]]\nheight = 2\n{SEA}\n[[slow_disturbances]]")],
            "seas[1]: the sea has no yaw moment of the waves at a heading of 90 deg",
        ),
        ([("[demand]", 'minimise = ["roll"]\n[demand]')], "unknown key 'slow_disturbances[1].minimise'"),
        ([("[plant]", 'minimise = ["roll"]\n[plant]')], "minimise[1]: 'roll' is a word of roll stabilisers"),
        ([('kind = "pid"\nparts = ["KP", "KD"]', 'kind = "yu2014"')], "controller.kind: 'yu2014' is a fin loop"),
        ([("value = 20", "value = 0")], "demand.change = 0 is not positive"),
        ([('parts = ["KP", "KD"]', 'parts = ["KP", "KX"]')], "controller.parts[2] = 'KX'"),
        ([('parts = ["KP", "KD"]', 'parts = ["KP", "KP"]')], "controller.parts names a part twice"),
        ([('parts = ["KP", "KD"]', "derivative_filter = -1")], "controller.derivative_filter: -1 is not positive"),
        ([("[demand]", "[demand]\nduration = 1e3")], "which is no key any more; leave it out: thirty time constants"),
        ([("[demand]", "[demand]\novershoot = 2")], "demand.overshoot = 2"),
        ([("[demand]", "[simulation]\n[demand]")], "simulation: there is no block [[seas]]"),
        (
            [
                (
                    'model = "model.toml"',
                    "response = { num = [-0.08], den = [10.0, 1.0, 0.0] }\nspeed = 7\n"
                    'output = "psi"\nactuator = "delta"',
                )
            ],
            "plant.response: a positive delta turns the ship to starboard by convention, here it first does the",
        ),
        (
            [("[demand]", "[schedule]\nspeeds = [7]\nheadings = [1]\nheights = [2]\n[demand]")],
            "schedule: there is no block [[seas]]",
        ),
    ],
)
def test_what_is_wrong_with_an_autopilot_file_is_said(
    changes: list[tuple[str, str]], says: str, tmp_path: Path
) -> None:
    model_file(tmp_path, nomoto())
    path = write_loop_file(tmp_path, AUTOPILOT, *changes)
    with pytest.raises(InputError) as refused:
        tuning_task(path)
    assert says in str(refused.value) and "\n" not in str(refused.value)


def test_a_model_that_knows_no_fins_and_one_of_another_kind_are_refused(tmp_path: Path) -> None:
    plant = ("roll = { num = [1.0], den = [1.43242, 0.3796, 1.0] }", 'model = "model.toml"')
    model_file(tmp_path, roll())
    with pytest.raises(InputError, match=r"knows no fins; add \[plant.fin\]"):
        tuning_task(write_loop_file(tmp_path, FIN, plant, ("[plant.fin]\nK_alpha = 0.256", "")))
    with pytest.raises(InputError, match=r"model 'roll' of .* rolls and knows no fins.* name a model that is steered"):
        tuning_task(write_loop_file(tmp_path, AUTOPILOT))
    model_file(tmp_path, nomoto())
    with pytest.raises(InputError, match=r"model 'nomoto' of .* has no K_alpha"):
        tuning_task(write_loop_file(tmp_path, FIN, plant))
    with pytest.raises(InputError, match="no 'model' that a model file could take the place of"):
        tuning_task(write_loop_file(tmp_path, FIN), model_file=tmp_path / "model.toml")


@pytest.mark.parametrize(("text", "says"), [("[plant\n", "is no valid TOML"), (None, "cannot be read")])
def test_no_toml_and_no_file_are_said(text: str | None, says: str, tmp_path: Path) -> None:
    path = tmp_path / "loop.toml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=says):
        tuning_task(path)
