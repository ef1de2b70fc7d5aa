"""Coefficients of thrust astern are free only where a training run has an order astern."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Channel, Prior, Record
from seatrial.estimation.identify.warnings import single_order_findings, with_unexcited_thrust_held
from seatrial.physics.models import model_named
from seatrial.physics.models.thruster_layout import CATAMARAN, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

ASTERN = {"k_b", "p_b", "k_4"}


def run(port: float, starboard: float) -> Record:
    """Ten seconds of one order each, as shares of full command."""
    time = np.arange(100) * 0.1
    orders = {"command_1": port, "command_2": starboard}
    channels = {name: Channel(np.full(100, value), "1", "body", "ahead") for name, value in orders.items()}
    return Record("run", time, channels)


def test_orders_ahead_alone_hold_thrust_astern() -> None:
    model, findings = with_unexcited_thrust_held(thrusters(), [run(0.8, 0.2), run(0.5, 0.0)])
    assert set(thrusters().parameters.free_names) - set(model.parameters.free_names) == ASTERN
    (finding,) = findings
    assert finding.code == "no-thrust-astern"
    assert "k_b, p_b and k_4 are held" in finding.message


def test_one_order_astern_of_either_of_a_pair_is_enough() -> None:
    model, findings = with_unexcited_thrust_held(thrusters(), [run(0.8, 0.2), run(0.5, -0.3)])
    assert model.parameters.free_names == thrusters().parameters.free_names
    assert findings == ()


def test_each_thruster_with_coefficients_of_its_own_is_judged_alone() -> None:
    layout = ThrusterLayout(tuple(replace(one, same_as="") for one in CATAMARAN.thrusters))
    first, second = (one.name for one in layout.thrusters)
    model, (finding,) = with_unexcited_thrust_held(thrusters(layout), [run(-0.5, 0.5)])
    gone = set(thrusters(layout).parameters.free_names) - set(model.parameters.free_names)
    assert gone == {f"{name}_{second}" for name in ASTERN}
    assert second in finding.message
    assert f" {first}" not in finding.message


def test_a_prior_keeps_a_coefficient_free() -> None:
    model = thrusters()
    model = model.with_parameters(model.parameters.with_priors({"k_b": Prior(1.0, 0.2)}))
    held, _ = with_unexcited_thrust_held(model, [run(0.5, 0.5)])
    assert "k_b" in held.parameters.free_names
    assert "p_b" not in held.parameters.free_names


def test_one_order_astern_does_not_separate_exponent_and_thrust() -> None:
    runs = [run(0.8, 0.2), run(0.5, 0.0), run(-0.4, 0.0), run(0.3, -0.4)]
    (finding,) = single_order_findings(thrusters(), runs)
    assert finding.code == "single-order" and "orders astern of port or starboard only near 40 %" in finding.message
    assert "k_b and p_b together" in finding.message and "full command is 2.5 times that order" in finding.evidence
    assert single_order_findings(thrusters(), [*runs, run(-0.8, 0.0)]) == ()


def test_one_order_ahead_is_named_likewise_and_a_fixed_exponent_ends_it() -> None:
    model, runs = thrusters(), [run(0.5, 0.5), run(-0.4, -0.9)]
    (finding,) = single_order_findings(model, runs)
    assert "orders ahead of" in finding.message and "k_f and p_f together" in finding.message
    assert single_order_findings(model.with_parameters(model.parameters.fixed("p_f")), runs) == ()
    known = model.with_parameters(model.parameters.with_priors({"p_f": Prior(2.0, 0.2)}))
    assert single_order_findings(known, runs) == ()


def test_without_orders_or_thrusters_there_is_no_single_one() -> None:
    assert single_order_findings(thrusters(), [run(0.0, 0.0)]) == ()
    assert single_order_findings(model_named("nomoto"), [run(0.5, 0.5)]) == ()
