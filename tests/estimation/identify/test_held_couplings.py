"""A coupling that is held at zero is named where the runs speak against it, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify.held_couplings import held_couplings
from seatrial.physics.models.thruster_layout import CATAMARAN, Damping, ThrustCurve, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import replay

NOISE = {"u": 0.01, "v": 0.01, "r": 0.01, "psi": 0.005, "x0": 0.02, "y0": 0.02}


@pytest.mark.parametrize(("N_uv", "criterion"), [(0.4, "output-error"), (0.0, "output-error"), (0.4, "auto")])
def test_a_coupling_of_the_truth_is_named_with_what_it_moves(
    N_uv: float, criterion: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    layout = ThrusterLayout(
        tuple(replace(one, curve=ThrustCurve.LINEAR, lag=0.0) for one in CATAMARAN.thrusters), Damping.DIAGONAL
    )
    model, time = thrusters(layout), 0.1 * np.arange(600)
    model = model.with_parameters(model.parameters.fixed("k_J", "k_4"))
    truth = {"X_u": -0.3, "M_v": 1.5, "N_uv": N_uv}
    orders = {f"command_{k}": np.repeat(rng.uniform(-0.3, 1.0, 30), 20) for k in (1, 2)}
    planned = Record.from_arrays("run", time, orders)
    clean = replay(model.with_values(truth), planned, dict.fromkeys(model.states, 0.0))
    noisy = {c: clean.channel(c).with_values(clean[c] + s * rng.standard_normal(600)) for c, s in NOISE.items()}
    record = replace(planned, channels=dict(planned.channels) | noisy)
    settings = EstimateSettings(method=EstimateMethod(criterion))
    estimation = estimate_model(model, Runs.one_session_each((record,), 1.0), settings)
    findings = held_couplings(estimation)
    if N_uv == 0.0:
        assert findings == ()
        return
    assert findings[0].message.startswith("N_uv is held at 0 and the training runs speak against it, by ")
    assert "M_v by " in findings[0].evidence
    assert findings[0].advice.endswith('"N_uv"]')
    size = float(findings[0].message.split(" by ")[-1].split()[0])
    wide = replace(estimation.interval, covariance=size**2 * estimation.interval.covariance)
    monkeypatch.setattr(Estimation, "interval", wide)
    assert held_couplings(estimation) == ()  # within one standard error of what is not known
