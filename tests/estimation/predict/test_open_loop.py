"""Predictions of what a model has: one without a heading is compared, but has no manoeuvring measures."""

import numpy as np
import pytest

from seatrial.core.equations import Sheet
from seatrial.core.values import InputError, Record
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.settings import ship_length_seconds
from seatrial.estimation.identify import estimate_model
from seatrial.estimation.predict.open_loop import predict_run, simulate_open_loop
from seatrial.physics.simulate import replay


def test_a_model_of_yaw_rate_alone_is_predicted_without_measures(rng: np.random.Generator) -> None:
    sheet = Sheet("yaw_rate")
    (r,) = sheet.states("r")
    delta = sheet.input("delta")
    T = sheet.parameter("T", 8.0, "s", free=True, lower=0.1, upper=100.0)
    K = sheet.parameter("K", 0.2, "1/s", free=True)
    sheet.rate(r, (K * delta - r) / T)
    model = sheet.model()
    time = 0.2 * np.arange(1500)
    rudder = 0.2 * np.sign(np.sin(0.1 * time))
    truth = replay(model, Record.from_arrays("run", time, {"delta": rudder, "u": np.ones(1500)}), {"r": 0.0})
    noisy = truth["r"] + 1e-3 * rng.standard_normal(1500)
    record = Record.from_arrays("run", time, {"r": noisy, "delta": rudder, "u": np.ones(1500)})
    settings = EstimateSettings().with_known_timing(model.input_names)
    found = estimate_model(model.with_values({"T": 3.0, "K": 0.1}), Runs.one_session_each([record], 10.0), settings)
    run = simulate_open_loop(
        found.estimate.problem,
        found.model,
        record,
        np.empty(0),
        10.0,
    )
    made = predict_run(found.model, record, "validation", run, 10.0, 10.0)
    assert made.measures == {}
    assert set(made.rms) == {"r"}
    assert made.rms["r"] < 1.1e-3


def test_records_without_speed_take_their_time_scale_from_the_segments(rng: np.random.Generator) -> None:
    time = 0.2 * np.arange(100)
    silent = Record.from_arrays("run", time, {"r": rng.standard_normal(100)})
    assert ship_length_seconds([silent], 10.0, 15.0) == 10.0
    for length in (None, np.inf):
        with pytest.raises(InputError, match="no forward speed"):
            ship_length_seconds([silent], 10.0, length)
