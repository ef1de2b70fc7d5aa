"""Thrusters on the wrong side, inverted, dead or misread, planted in simulated records; else silence."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError, Record, Severity
from seatrial.data.check.inputs import SURE_EFFECT, refuse_impossible_commands, thruster_effects, thruster_findings
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, CommandInput, Thruster, ThrusterLayout
from seatrial.physics.simulate.replay import replay

NOISE = {"u": 0.03, "v": 0.03, "r": 0.02}


def driven(seed: int, seconds: int = 120) -> Record:
    """A run of steps of both thrusters, every 3 s, with noise of a small craft's log."""
    model, generator = model_named("thrusters"), np.random.default_rng(seed)
    commands = np.repeat(generator.uniform(-1.0, 1.0, size=(seconds // 3, 2)), 30, axis=0)
    inputs = {"command_1": commands[:, 0], "command_2": commands[:, 1]}
    planned = Record.from_arrays(f"run {seed}", 0.1 * np.arange(len(commands)), inputs)
    run = replay(model, planned, dict.fromkeys(model.states, 0.0))
    for channel, spread in NOISE.items():
        noisy = run[channel] + spread * generator.standard_normal(len(run))
        run = run.with_channel(channel, run.channel(channel).with_values(noisy), "noise")
    return run


RECORDS = [driven(seed) for seed in (1, 2)]


def layout(port: Callable[[Thruster], Thruster], starboard: Callable[[Thruster], Thruster]) -> ThrusterLayout:
    first, second = CATAMARAN.thrusters
    return replace(CATAMARAN, thrusters=(port(first), starboard(second)))


def as_it_is(thruster: Thruster) -> Thruster:
    return thruster


def other_side(thruster: Thruster) -> Thruster:
    return replace(thruster, y=-thruster.y)


def inverted(thruster: Thruster) -> Thruster:
    return replace(thruster, command=replace(thruster.command, span=-1.0))


def test_nothing_is_said_of_thrusters_that_are_as_declared() -> None:
    assert thruster_findings(CATAMARAN, RECORDS) == ()


@pytest.mark.parametrize(
    ("port", "starboard", "sentences"),
    [
        (inverted, as_it_is, ["'port' ('command_1') works inverted"]),
        (other_side, other_side, ["'port' ('command_1') turns the craft as one on the other side", "'starboard'"]),
        (
            as_it_is,
            lambda t: other_side(inverted(t)),
            ["'starboard' ('command_2') works inverted and turns the craft as one on the other side"],
        ),
    ],
)
def test_sides_and_signs_are_found(
    port: Callable[[Thruster], Thruster], starboard: Callable[[Thruster], Thruster], sentences: list[str]
) -> None:
    findings = thruster_findings(layout(port, starboard), RECORDS)
    assert [f.code for f in findings] == ["thruster-side"] * len(sentences)
    assert all(f.severity is Severity.ERROR and f.advice for f in findings)
    assert all(text in f.text for f, text in zip(findings, sentences, strict=True))


def test_what_turning_does_to_the_speed_ahead_is_no_effect_of_a_thruster() -> None:
    time, generator = np.arange(0.0, 200.0, 0.1), np.random.default_rng(7)
    commands = np.repeat(generator.uniform(0.0, 1.0, size=(len(time) // 40, 2)), 40, axis=0)
    r, v = 1.2 * np.sin(0.5 * time), 0.6 * np.cos(0.35 * time)  # rad/s and m/s: fast turns with drift
    thrust = np.sum(commands**2, axis=1)
    u = np.zeros(len(time))
    for k in range(len(time) - 1):  # surge in turning axes: du/dt = thrust - damping + v r
        u[k + 1] = u[k] + 0.1 * (0.5 * thrust[k] - 0.5 * u[k] + v[k] * r[k])
    u += 0.05 * generator.standard_normal(len(time))
    channels = {"u": u, "v": v, "r": r, "command_1": commands[:, 0], "command_2": commands[:, 1]}
    record = Record.from_arrays("run", time, channels)
    assert min(one.surge for one in thruster_effects(CATAMARAN, [record])) > 2.0 * SURE_EFFECT


def test_commands_that_move_together_say_nothing_of_sides() -> None:
    record = driven(3)
    record = record.with_channel("command_2", record.channel("command_1"), "one joystick")
    assert [f for f in thruster_findings(layout(as_it_is, other_side), [record]) if f.code == "thruster-side"] == []


def test_a_dead_command_and_readings_out_of_range_are_named() -> None:
    dead = RECORDS[0].with_channel(
        "command_1", RECORDS[0].channel("command_2").with_values(np.zeros(len(RECORDS[0]))), ""
    )
    (finding,) = thruster_findings(CATAMARAN, [dead])
    assert finding.text.startswith("thruster 'port': its command 'command_1' never moves")
    pulses = layout(lambda t: replace(t, command=CommandInput("command_1", 1500.0, 400.0)), as_it_is)
    (finding,) = thruster_findings(pulses, RECORDS)
    assert finding.code == "command-range"
    assert "correct unit, zero and span" in finding.advice


def test_shares_that_a_thruster_takes_for_per_cent_are_scaled_twice() -> None:
    percent = layout(lambda t: replace(t, command=CommandInput("command_1", 0.0, 100.0)), as_it_is)
    (finding,) = thruster_findings(percent, RECORDS)
    assert finding.code == "command-range" and finding.severity is Severity.ERROR
    assert "scaled twice" in finding.message and "channels.command_1" in finding.advice


def test_a_direction_in_degrees_is_seen() -> None:
    pod = Thruster("pod", -0.5, 0.0, CommandInput("command_1"), AngleInput("alpha_1"))
    degrees = Record.from_arrays("pod", RECORDS[0].time, {
        "command_1": RECORDS[0]["command_1"], "alpha_1": 180.0 * RECORDS[0]["command_2"], "u": RECORDS[0]["u"],
    })  # fmt: skip
    (finding,) = thruster_findings(ThrusterLayout((pod,)), [degrees])
    assert finding.code == "wrong-unit"
    assert 'set unit = "deg" for alpha_1' in finding.advice


def test_records_without_the_thrusters_are_left_alone() -> None:
    assert thruster_findings(CATAMARAN, [Record.from_arrays("other", RECORDS[0].time, {"u": RECORDS[0]["u"]})]) == ()


def test_inputs_that_no_thruster_can_follow_are_refused() -> None:
    craft, time = model_named("thrusters"), 0.1 * np.arange(50)
    shares = {"command_1": np.full(50, 0.5), "command_2": np.full(50, -1.0)}
    refuse_impossible_commands(craft, Record.from_arrays("plan", time, shares))
    pulses = Record.from_arrays("plan", time, shares | {"command_2": np.linspace(1100.0, 1900.0, 50)})
    with pytest.raises(InputError, match=r"record 'plan': thruster 'starboard': 'command_2' goes to 1.9e\+03 of full"):
        refuse_impossible_commands(craft, pulses)
    refuse_impossible_commands(model_named("nomoto"), pulses)
