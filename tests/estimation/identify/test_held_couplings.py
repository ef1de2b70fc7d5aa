"""A coupling that is held at zero is named where the runs speak against it, and only there."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings, Role, Run, Trial
from seatrial.estimation.estimate import Estimation, Runs, estimate_model
from seatrial.estimation.identify import identify
from seatrial.estimation.identify.terms import held_couplings
from seatrial.physics.models.thruster_layout import CATAMARAN, Damping, ThrustCurve, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.simulate.replay import replay

NOISE = {"u": 0.01, "v": 0.01, "r": 0.01, "psi": 0.005, "x0": 0.02, "y0": 0.02}


def catamaran() -> Model:
    layout = ThrusterLayout(
        tuple(replace(one, curve=ThrustCurve.LINEAR, lag=0.0) for one in CATAMARAN.thrusters), Damping.DIAGONAL
    )
    model = thrusters(layout)
    return model.with_parameters(model.parameters.fixed("k_J", "k_4"))


def run_of(N_uv: float, rng: np.random.Generator, name: str = "run") -> Record:
    """A run of the catamaran with this coupling."""
    return simulated(catamaran().with_values({"X_u": -0.3, "M_v": 1.5, "N_uv": N_uv}), rng, name)


def simulated(model: Model, rng: np.random.Generator, name: str) -> Record:
    """A run of 60 s from rest, orders held for 2 s."""
    orders = {f"command_{k}": np.repeat(rng.uniform(-0.3, 1.0, 30), 20) for k in (1, 2)}
    planned = Record.from_arrays(name, 0.1 * np.arange(600), orders)
    clean = replay(model, planned, dict.fromkeys(model.states, 0.0))
    noisy = {c: clean.channel(c).with_values(clean[c] + s * rng.standard_normal(600)) for c, s in NOISE.items()}
    return replace(planned, channels=dict(planned.channels) | noisy)


@pytest.mark.parametrize(
    ("N_uv", "criterion"),
    [(0.4, "output-error"), (0.0, "output-error"), pytest.param(0.4, "auto", marks=pytest.mark.long)],
)
def test_a_coupling_of_the_truth_is_named_with_what_it_moves(
    N_uv: float, criterion: str, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    record, model = run_of(N_uv, rng), catamaran()
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


@pytest.mark.long(every=2)
@pytest.mark.parametrize("is_of_the_craft", [True, False])
def test_freeing_is_advised_where_held_out_runs_gain(is_of_the_craft: bool, rng: np.random.Generator) -> None:
    """Held-out runs are the craft's own, or those of the model that holds the coupling at zero."""
    train, settings = run_of(0.4, rng, "train"), EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    held = estimate_model(catamaran(), Runs.one_session_each((train,), 1.0), settings).model
    validate = run_of(0.4, rng, "validate") if is_of_the_craft else simulated(held, rng, "validate")
    runs = (Run(train), Run(validate, Role.VALIDATE))
    fit = identify(Trial(Ship("catamaran", {"L": 1.0}), runs, catamaran(), settings))
    named = [f.message.split()[0] for f in fit.findings if f.code == "held-coupling"]
    assert named[:1] == (["N_uv"] if is_of_the_craft else [])
