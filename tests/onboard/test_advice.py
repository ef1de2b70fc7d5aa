"""What would help: the bound after standard manoeuvres, in words, and words alone where nothing can be weighed."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results.online import EstimatorPhase, Snapshot
from seatrial.core.values import NOTATION, Channel, Record, Ship
from seatrial.data.example_series import JET_VELOCITY, SENSOR_NOISE
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.data.trial.trial import Trial
from seatrial.onboard.advice import (
    ManoeuvreAdviser,
    advice,
    candidate_manoeuvres,
    fisher_information,
    ranked_candidates,
)
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.published import QI2025_SHIP, theoretical_coefficients
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import waterjet
from seatrial_studies.seaway import FIN

CRAFT = Ship("craft", {"L": 9.8, "B": 3.17, "d": 0.71})


def _trial(model, ship, channels, rate=2.0) -> Trial:
    columns = tuple(ColumnSpec(c, k + 2, NOTATION[c].unit) for k, c in enumerate(channels))
    stream = Stream(source=StreamSource.STDIN, layout=Layout("text", ColumnSpec("time", 1, "s"), columns), rate=rate)
    return Trial(ship=ship, runs=(), model=model, stream=stream)


def _snapshot(model, errors, noise, untold) -> Snapshot:
    free = model.parameters.free
    names, value = tuple(p.name for p in free), np.array([p.value for p in free])
    units = tuple(p.unit for p in free)
    return Snapshot(100.0, 200, 1, EstimatorPhase.WINDOW, names, units, value, errors, noise=noise, unidentified=untold)


def _record(rows=401, dt=0.5, **channels) -> Record:
    made = {
        n: Channel.from_notation(n, np.broadcast_to(np.asarray(v, dtype=float), rows).copy())
        for n, v in channels.items()
    }
    return Record("so far", dt * np.arange(rows), made)


@pytest.fixture(scope="module")
def craft():
    """A waterjet craft that has gone straight ahead with some weaving: nothing but X_uu is known well."""
    model = waterjet()
    trial = _trial(model, CRAFT, ("psi", "u", "v", "r", "delta", "v_j"))
    names = model.parameters.free_names
    share = np.array([0.01 if n == "X_uu" else 3.0 for n in names])
    value = np.array([p.value for p in model.parameters.free])
    error = share * np.abs(value)
    time = 0.5 * np.arange(401)
    records = (_record(psi=0.02 * np.sin(time), u=0.75, v=0.0, r=0.0, delta=0.05 * np.sin(time), v_j=JET_VELOCITY),)
    noise = {n: SENSOR_NOISE[n] for n in ("psi", "u", "v", "r")}
    return trial, _snapshot(model, error, noise, tuple(n for n in names if n != "X_uu")), np.diag(error**2), records


def test_a_standard_manoeuvre_is_named_with_numbers(craft):
    trial, snapshot, covariance, records = craft
    text = advice(snapshot, trial, covariance, records)
    assert "would reduce the standard error of" in text
    assert "from 300 % to" in text
    assert any(word in text for word in ("a zigzag", "zigzags", "a turning circle", "a random binary sequence"))
    assert len(text) < 300


def test_the_best_leaves_fewest_untold_and_none_is_worse_than_before(craft):
    trial, snapshot, covariance, records = craft
    found = ranked_candidates(snapshot, trial, trial.model, covariance, records)
    left = [int(np.sum(p.relative_errors[1:] > 1.0)) for p in found]
    assert left == sorted(left)
    before = snapshot.standard_error / np.abs(snapshot.value)
    assert all(np.all(p.relative_errors <= before * (1.0 + 1e-6)) for p in found)


def test_a_helmsman_s_manoeuvre_comes_before_a_random_one_of_like_worth(craft):
    trial, snapshot, covariance, records = craft
    found = ranked_candidates(snapshot, trial, trial.model, covariance, records)
    places = [snapshot.names.index(n) for n in snapshot.unidentified]

    def left(one):
        return int(np.sum(one.relative_errors[places] > 1.0)), float(
            np.exp(np.mean(np.log(one.relative_errors[places])))
        )

    steered = [left(p) for p in found if not p.candidate.is_random]
    first = left(found[0])
    assert steered
    for count, error in steered if found[0].candidate.is_random else []:
        assert (first[0], 2.0 * first[1]) <= (count, error)


def test_what_is_promised_is_the_bound_of_both_together(craft):
    """(C^-1 + M)^-1, and M grows as the noise falls: a tenth of the noise is a hundred times the information."""
    trial, snapshot, covariance, records = craft
    best = ranked_candidates(snapshot, trial, trial.model, covariance, records)[0]
    gained = fisher_information(trial.model, best.candidate, snapshot.noise, 2.0)
    expected = np.sqrt(np.diag(np.linalg.inv(np.linalg.inv(covariance) + gained))) / np.abs(snapshot.value)
    np.testing.assert_allclose(best.relative_errors, expected, rtol=1e-6)
    quiet = {n: 0.1 * v for n, v in snapshot.noise.items()}
    np.testing.assert_allclose(fisher_information(trial.model, best.candidate, quiet, 2.0), 100.0 * gained, rtol=1e-6)


def test_fins_are_moved_in_calm_water():
    model = theoretical_coefficients(135).applied_to(heave_pitch()).with_values(FIN)
    trial = _trial(model, QI2025_SHIP, ("delta_f1", "z", "theta"), rate=10.0)
    value = np.array([p.value for p in model.parameters.free])
    error = 2.0 * np.abs(value)
    snapshot = _snapshot(model, error, {"z": 0.01, "theta": 3.5e-4}, model.parameters.free_names)
    text = advice(snapshot, trial, np.diag(error**2), (_record(z=0.0, theta=0.0),))
    assert "delta_f1" in text
    assert "would reduce the standard error of" in text


def test_without_fins_that_lift_waves_are_asked_for():
    model = theoretical_coefficients(135).applied_to(heave_pitch())
    trial = _trial(model, QI2025_SHIP, ("F3", "M5", "z", "theta"), rate=10.0)
    error = 2.0 * np.abs([p.value for p in model.parameters.free])
    snapshot = _snapshot(model, error, {"z": 0.01, "theta": 3.5e-4}, model.parameters.free_names)
    assert "waves" in advice(snapshot, trial, np.diag(error**2), (_record(z=0.0, theta=0.0),))


@pytest.fixture(scope="module")
def rolled():
    """A free roll from 5 degrees that tells nothing of the restoring's hardening."""
    model = roll().with_values({"b_1": 0.06, "b_2": 0.35, "c_1": 0.698, "c_3": -0.25})
    names = model.parameters.free_names
    trial = _trial(model, CRAFT, ("phi",), rate=10.0)
    value = np.array([p.value for p in model.parameters.free])
    error = np.array([4.0 if n == "c_3" else 0.1 * max(abs(v), 0.01) for n, v in zip(names, value, strict=True)])
    time = 0.1 * np.arange(751)
    record = _record(751, 0.1, phi=np.radians(5.0) * np.exp(-0.03 * time) * np.cos(0.835 * time))
    return trial, _snapshot(model, error, {"phi": 1e-3}, ("c_3",)), np.diag(error**2), (record,)


def test_a_roll_is_released_from_a_larger_angle(rolled):
    trial, snapshot, covariance, records = rolled
    text = advice(snapshot, trial, covariance, records)
    assert "a free decay from" in text
    assert "c_3 from 400 % to" in text


def test_larger_angles_tell_more(rolled):
    trial, snapshot, _, records = rolled
    place = snapshot.names.index("c_3")
    made = [
        fisher_information(trial.model, o, snapshot.noise, 10.0)[place, place]
        for o in candidate_manoeuvres(trial, trial.model, records, snapshot.noise)
    ]
    assert np.all(np.diff(made) > 0.0)


def test_what_cannot_be_simulated_is_answered_in_words(craft):
    trial, snapshot, covariance, records = craft
    far = np.full(len(snapshot.names), 1e6)
    lost, covariance = replace(snapshot, value=far, standard_error=3.0 * far), np.diag((3.0 * far) ** 2)
    straight = tuple(r.with_channel("delta", Channel.from_notation("delta", np.zeros(len(r)))) for r in records)
    assert "zigzag" in advice(lost, trial, covariance, straight)


class _Known:
    def __init__(self, covariance, records):
        self.covariance, self._records, self.asked = covariance, records, 0

    def records(self):
        self.asked += 1
        return self._records


def test_it_looks_once_a_minute_at_most_and_says_nothing_where_all_is_stated(craft):
    trial, snapshot, covariance, records = craft
    known, now = _Known(covariance, records), [0.0]
    adviser = ManoeuvreAdviser(trial, known, clock=lambda: now[0])
    first = adviser.with_advice(snapshot)
    for now[0] in (1.0, 30.0, 59.0):
        assert adviser.with_advice(snapshot).advice == first.advice
    assert known.asked == 1
    now[0] = 61.0
    adviser.with_advice(snapshot)
    assert known.asked == 2
    all_identified = replace(snapshot, unidentified=())
    assert adviser.with_advice(all_identified) is all_identified
    waiting = replace(snapshot, phase=EstimatorPhase.WAITING)
    assert adviser.with_advice(waiting) is waiting


def test_an_estimator_that_knows_no_covariance_goes_unadvised(craft):
    trial, snapshot, *_ = craft
    assert ManoeuvreAdviser(trial, object()).with_advice(snapshot) is snapshot
