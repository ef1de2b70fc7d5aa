"""Values marked as estimated in a trial file are named, and say so where they stand."""

from pathlib import Path

import pytest

from seatrial.core.values import NOT_MEASURED, Severity
from seatrial.data.trial import load_trial
from seatrial.data.trial.plausibility import ESTIMATED, ESTIMATED_VALUES, with_estimates_named

SHIP = """
[ship]
name = "craft"
L = 62.0    # m, as stated
m = 1.5e6    # ESTIMATED: kg, of a hull with L/B 6; write the displacement if you know it
x_G = 0.0
I_z = 3.6e8    # ESTIMATED: kg m^2, gyradius L/4
rho = 1025.0
U_n = 6.5

[model]
name = "abkowitz"
free = ["X_u", "Y_v", "N_r", "N_d"]

[model.fixed]
X_udot = -0.0006    # ESTIMATED: Zhou et al. 1983; a guess
# Y_vdot = -0.01    # ESTIMATED: not in use

[design]
duration = 300.0
rate = 2.0

[design.inputs.delta]
lower = -0.6
upper = 0.6
unit = "rad"
hold = 5.0
rate = 0.05
"""
CATAMARAN = """
[ship]
name = "craft"
L = 3.5

[model]
name = "thrusters"

[[thruster]]
name = "port"
x = 0.0
y = -0.53    # ESTIMATED: m to starboard, from L; measure it
command = { channel = "command_1" }

[[thruster]]
name = "starboard"
x = 0.0
y = 0.62
command = { channel = "command_2" }

[design]
duration = 300.0
rate = 2.0

[design.inputs.command_1]
lower = -1.0
upper = 1.0
unit = "1"
hold = 5.0
rate = 1.0

[design.inputs.command_2]
lower = -1.0
upper = 1.0
unit = "1"
hold = 5.0
rate = 1.0
"""


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "trial.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_marked_values_are_a_warning_and_carry_their_source(tmp_path: Path) -> None:
    trial = load_trial(written(tmp_path, SHIP))
    (finding,) = [f for f in trial.findings if f.code == ESTIMATED_VALUES]
    assert finding.severity is Severity.WARNING
    assert finding.message == f"m, I_z and X_udot are {NOT_MEASURED}"
    assert trial.model.parameters["m"].source == f"{NOT_MEASURED}: kg, of a hull with L/B 6"
    assert trial.model.parameters["X_udot"].source == f"{NOT_MEASURED}: Zhou et al. 1983"
    assert trial.model.parameters["m"].value == 1.5e6
    assert not trial.model.parameters["rho"].source.startswith(NOT_MEASURED)


@pytest.mark.parametrize("within", ["within 35 %, ", "within 35%, ", "within 35.0 % "])
def test_what_a_mark_says_that_a_value_is_within_is_its_standard_deviation(tmp_path: Path, within: str) -> None:
    text = SHIP.replace(f"{ESTIMATED}: kg, of", f"{ESTIMATED}: {within}kg, of")
    parameters = load_trial(written(tmp_path, text)).model.parameters
    prior = parameters["m"].prior
    assert prior is not None and prior.standard_deviation == pytest.approx(0.35 * 1.5e6)
    assert parameters["m"].source == f"{NOT_MEASURED}: kg, of a hull with L/B 6"
    assert parameters["I_z"].prior is None and not parameters["m"].free


def test_of_thrusters_the_marked_lever_alone_is_named(tmp_path: Path) -> None:
    trial = load_trial(written(tmp_path, CATAMARAN))
    (finding,) = [f for f in trial.findings if f.code == ESTIMATED_VALUES]
    assert finding.message == f"y_port is {NOT_MEASURED}" and finding.consequence
    assert trial.model.parameters["y_port"].source.startswith(NOT_MEASURED)


@pytest.mark.parametrize("text", [SHIP, CATAMARAN])
def test_without_marks_nothing_is_said(tmp_path: Path, text: str) -> None:
    trial = load_trial(written(tmp_path, text.replace(f"# {ESTIMATED}", "# measured")))
    assert not [f for f in trial.findings if f.code == ESTIMATED_VALUES]
    assert with_estimates_named(trial, "") is trial
