"""Thrust that falls over a run, and a dead band, are named by score tests: a catamaran by equations of the test."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Array, Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify.terms import drifting_thrust_finding, held_couplings
from seatrial.physics.models.thruster_layout import CATAMARAN, Damping, ThrustCurve, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

NOISE = {"u": 0.01, "v": 0.01, "r": 0.01, "psi": 0.005, "x0": 0.02, "y0": 0.02}
STEP, ROWS, WITHIN = 0.1, 900, 5


def rates(x: Array, port: float, starboard: float) -> Array:
    """Fossen's craft in three degrees of freedom on each kg, M_u 1, M_v 1.5, M_r 0.1, thrusters 0.3 m off."""
    u, v, r, psi = x[:4]
    X = port + starboard - 0.3 * u - 0.3 * u * abs(u)
    Y = -v - v * abs(v)
    N = 0.3 * (port - starboard) - 0.2 * r - 0.2 * r * abs(r)
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    return np.array([X + 1.5 * v * r, (Y - u * r) / 1.5, (N - 0.5 * u * v) / 0.1, r, north, east])


def run(sag: float, seed: int, dead: float = 0.0) -> Record:
    """A run of 90 s, orders held for 2 s, whose thrust falls straight by a share `sag`; steps of 0.02 s.

    dead: share of the order that gives no thrust to either side.
    """
    rng = np.random.default_rng(seed)
    orders = np.repeat(rng.uniform(-0.3, 1.0, (ROWS // 20, 2)), 20, axis=0)
    states, h = np.zeros((ROWS, 6)), STEP / WITHIN
    for k in range(ROWS - 1):
        x = states[k]
        thrust = np.sign(orders[k]) * np.maximum(np.abs(orders[k]) - dead, 0.0) / (1.0 - dead) * (1.0 - sag * k / ROWS)
        for _ in range(WITHIN):
            a = rates(x, *thrust)
            b = rates(x + 0.5 * h * a, *thrust)
            c = rates(x + 0.5 * h * b, *thrust)
            x = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + rates(x + h * c, *thrust))
        states[k + 1] = x
    noisy = {n: states[:, i] + s * rng.standard_normal(ROWS) for i, (n, s) in enumerate(NOISE.items())}
    commands = {f"command_{i + 1}": orders[:, i] for i in range(2)}
    return Record.from_arrays(f"run {seed}", np.asarray(STEP * np.arange(ROWS), np.float64), {**noisy, **commands})


def fitted(records: tuple[Record, ...], method: EstimateMethod) -> Estimation:
    layout = ThrusterLayout(
        tuple(replace(one, curve=ThrustCurve.LINEAR, lag=0.0) for one in CATAMARAN.thrusters), Damping.DIAGONAL
    )
    model = thrusters(layout)
    model = model.with_parameters(model.parameters.fixed("k_J", "k_4"))
    return estimate_model(model, Runs.one_session_each(records, 1.0), EstimateSettings(method=method))


@pytest.mark.parametrize("dead", [0.08, 0.0])
def test_a_dead_band_that_is_held_at_zero_is_named(dead: float) -> None:
    findings = held_couplings(fitted((run(0.0, 3, dead), run(0.0, 4, dead)), EstimateMethod.OUTPUT_ERROR))
    assert ("dead" in [f.text.split()[0] for f in findings]) == (dead > 0.0)


@pytest.mark.parametrize("sag", [0.15, 0.0, -0.15])
@pytest.mark.parametrize(
    "method", [EstimateMethod.OUTPUT_ERROR, pytest.param(EstimateMethod.AUTO, marks=pytest.mark.long)]
)
def test_thrust_that_drifts_is_named_with_its_size(sag: float, method: EstimateMethod) -> None:
    records = (run(sag, 1), run(sag, 2))
    findings = drifting_thrust_finding(fitted(records, method), records)
    if not sag:
        assert findings == ()
        return
    (finding,) = findings
    assert finding.code == "thrust-drifts"
    assert ("falls" if sag > 0.0 else "rises") in finding.text
    share = float(finding.text.split(" by ")[-1].split()[0]) / 100.0
    assert share == pytest.approx(0.15, abs=0.04)
