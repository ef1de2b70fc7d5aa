"""Scores of windows and of the baselines beside them."""

from dataclasses import replace

import numpy as np
import pytest
from tests.estimation.identify.conftest import TRUTH
from tests.estimation.predict.test_open_loop import GENTLE, run

from seatrial.core.equations import Model
from seatrial.core.results import Fit
from seatrial.core.values import InputError, Parameters, Prior, Record, Ship
from seatrial.data.trial import EstimateSettings, Role, Run, Trial
from seatrial.data.trial.settings import WindowLength, window_lengths
from seatrial.estimation.identify import identify
from seatrial.estimation.predict.window_scores import (
    ARX,
    CONSTANT_COURSE,
    NARX,
    STAYS,
    at_rest,
    constant_course,
    pooled_rms,
    prior_means,
    stays,
)
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.roll import roll
from seatrial.physics.models.thrusters import thrusters
from seatrial.physics.sensors import Compass, Sensors, with_sensors
from seatrial.physics.simulate.replay import trajectory


@pytest.fixture(scope="module")
def fit() -> Fit:
    rng = np.random.default_rng(4)
    runs = [run(name, GENTLE, rng, phase) for name, phase in (("a", 0.0), ("b", 7.0), ("v", 3.0))]
    roles = (Role.TRAIN, Role.TRAIN, Role.VALIDATE)
    trial = Trial(Ship("craft", {"L": 8.0}), tuple(Run(r, role) for r, role in zip(runs, roles, strict=True)), nomoto())
    return identify(trial, windows="50s,5L")


def test_lengths_are_seconds_or_ship_lengths() -> None:
    assert window_lengths("10s, 5L") == (WindowLength(10.0, "s"), WindowLength(5.0, "L"))
    assert window_lengths("") == ()
    for text in ("10", "5 m", "0s", "-3s"):
        with pytest.raises(InputError, match="write seconds or ship lengths"):
            window_lengths(text)


def test_the_trial_states_windows_unless_the_command_does() -> None:
    rng = np.random.default_rng(4)
    runs = [run(name, GENTLE, rng, phase) for name, phase in (("a", 0.0), ("v", 3.0))]
    roles = (Role.TRAIN, Role.VALIDATE)
    trial = Trial(Ship("craft", {"L": 8.0}), tuple(map(Run, runs, roles)), nomoto(),
                  estimate=EstimateSettings(windows="40s"))  # fmt: skip
    assert [w.window for w in identify(trial).validation[0].windows] == ["40 s"]
    assert [w.window for w in identify(trial, windows="5L").validation[0].windows] == ["5 L"]
    with pytest.raises(InputError, match="'40 m' is no length of a window"):
        EstimateSettings(windows="40 m")


def test_windows_of_both_units_are_scored_with_baselines(fit: Fit) -> None:
    in_seconds, in_lengths = fit.validation[0].windows
    assert (in_seconds.seconds, in_seconds.count) == (50.0, 4)
    assert in_lengths.seconds == pytest.approx(5.0 * 8.0 / 2.0)
    assert {b.name for b in in_seconds.baselines} == {CONSTANT_COURSE, STAYS, ARX, NARX}
    assert fit["T"].estimate == pytest.approx(TRUTH["T"], rel=0.1)
    score = in_seconds.scores["r"]
    assert score.fit_percent > 80.0
    assert 1.0 - score.r_squared == pytest.approx((1.0 - score.fit_percent / 100.0) ** 2)
    (straight,) = [b for b in in_seconds.baselines if b.name == CONSTANT_COURSE]
    assert score.rms < straight.scores["r"].rms
    heading = in_seconds.scores["psi_deg"]
    assert heading.band_share is not None
    # half the band is about two errors wide, where the error is that share of the motion: 1 - R^2, its root
    assert heading.band_share == pytest.approx(2.0 * np.sqrt(1.0 - heading.r_squared), rel=0.6)
    assert straight.scores["r"].rms == pytest.approx(np.sqrt(np.mean(fit.validation[0].measured["r"] ** 2)), rel=0.25)


def test_a_ship_that_rolls_about_its_rest_has_windows_in_seconds_and_a_band_that_holds_its_roll() -> None:
    """Of 0.4 periods and multiples: it travels no ship lengths."""
    ship, rng = roll().with_values({"b_1": 0.05, "c_1": 6.0, "b_2": 0.2}), np.random.default_rng(0)
    decays, truth = [], np.zeros(600)
    for name, angle in (("a", 0.3), ("b", 0.25)):
        states, _ = trajectory(ship, np.zeros((600, 2)), 0.05, np.array([angle, 0.0]))
        noise = 3e-4 * rng.standard_normal(600)
        decays.append(Record.from_arrays(name, 0.05 * np.arange(600.0), {"phi": states[:, 0] + noise}))
        truth = states[:, 0]
    roles = (Role.TRAIN, Role.VALIDATE)
    runs = tuple(Run(d, role) for d, role in zip(decays, roles, strict=True))
    (prediction,) = identify(Trial(Ship("hull", {"L": 5.0}), runs, roll())).validation
    assert [w.window for w in prediction.windows] == ["1 s", "5.1 s"]  # 0.4 periods of 2 pi / sqrt(6) s
    inside = np.abs(prediction.simulated["phi"] - truth) <= prediction.half_width["phi"]
    assert np.mean(inside) > 0.9


def test_a_baseline_that_errs_less_is_named(fit: Fit) -> None:
    for window in fit.validation[0].windows:
        for channel, name in window.better_baselines({}).items():
            (rival,) = [b for b in window.baselines if b.name == name]
            assert rival.rms[channel] < window.scores[channel].rms


def test_straight_on_is_exact_on_a_straight_course() -> None:
    time = 0.5 * np.arange(40)
    values = {
        "psi": np.full(40, 0.3),
        "u": np.full(40, 2.0),
        "r": np.zeros(40),
        "x0": 1.0 + 1.9 * time,
        "y0": 0.6 * time,
    }
    record = Record.from_arrays("straight", time, values)
    predicted = constant_course(record, 5.0)
    for channel in values:
        np.testing.assert_allclose(predicted[channel], record[channel], atol=1e-9)
    assert not np.any(at_rest(record, 5.0)["psi"])
    still = stays(record, 5.0)
    assert still["x0"] == pytest.approx(np.full(40, np.mean(values["x0"][:11])))
    assert still["psi"] == pytest.approx(values["psi"])
    assert not np.any(still["u"])


def test_errors_of_several_channels_pool_as_their_norm() -> None:
    time = np.arange(4.0)
    still = Record.from_arrays("still", time, {"x0": np.zeros(4), "y0": np.zeros(4)})
    away = Record.from_arrays("away", time, {"x0": np.full(4, 3.0), "y0": np.full(4, 4.0)})
    assert pooled_rms([still], [away], ("x0", "y0")) == pytest.approx(5.0)


def test_the_band_of_a_decay_holds_what_gusts_do_to_the_roll() -> None:
    """White roll accelerations, 0.004 rad/s^2 over the root of a second, that whole runs leave in the residuals."""
    rng, step, samples = np.random.default_rng(2), 0.005, 800
    records = []
    for name, angle in (("a", 0.3), ("b", -0.28), ("c", 0.25), ("v", 0.27)):
        phi, p, measured = angle, 0.0, []
        for k in range(10 * samples):
            if k % 10 == 0:
                measured.append(phi)
            gust = 0.004 * rng.standard_normal() / np.sqrt(step)
            phi, p = phi + step * p, p + step * (gust - 0.08 * p - 0.2 * abs(p) * p - 1.3 * phi)
        noisy = np.array(measured) + 5e-4 * rng.standard_normal(samples)
        records.append(Record.from_arrays(name, 0.05 * np.arange(float(samples)), {"phi": noisy}))
    roles = (Role.TRAIN, Role.TRAIN, Role.TRAIN, Role.VALIDATE)
    ship = roll().with_parameters(roll().parameters.only_free(("b_1", "b_2", "c_1")))
    fit = identify(Trial(Ship("boat", {"L": 20.0}), tuple(map(Run, records, roles)), ship), windows="10s")
    (window,) = fit.validation[0].windows
    inside = window.scores["phi_deg"].inside_band
    assert inside is not None
    assert inside > 0.9


def with_priors(model: Model, names: set[str]) -> Model:
    """The model with a prior about the value of each of these coefficients."""
    known = (replace(p, prior=Prior(p.value, 0.5)) if p.name in names else p for p in model.parameters)
    return replace(model, parameters=Parameters(tuple(known)))


def test_priors_of_instruments_alone_are_no_knowledge_of_a_craft() -> None:
    craft = thrusters()
    measured = with_sensors(craft, Sensors(compass=Compass.HARMONIC))
    assert any(p.prior is not None for p in measured.parameters.free)
    assert prior_means(measured) == {}


def test_some_priors_beside_start_values_are_no_published_craft() -> None:
    assert prior_means(with_priors(thrusters(), {"M_v", "Y_v"})) == {}


def test_priors_of_all_coefficients_are_a_craft_that_was_not_fitted() -> None:
    craft = thrusters()
    free = set(craft.parameters.free_names)
    measured = with_sensors(with_priors(craft, free), Sensors(compass=Compass.OFFSET))
    assert prior_means(measured) == {n: craft.parameters[n].value for n in free} | {"compass_A": 0.0}
