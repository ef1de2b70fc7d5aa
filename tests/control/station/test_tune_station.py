"""A station tuned: no better bandwidths on a grid, simulated as predicted, what cannot be kept refused."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.control.station.station_cases import azimuths, craft, cross_drive, station_task

from seatrial.control.station.craft import generalised_inverse
from seatrial.control.station.station_loop import station_point
from seatrial.control.station.trial import (
    SlowPush,
    StationSetting,
    StationSimulator,
    WavePush,
    draw_craft,
    joined,
    sampled_controller,
    thrust_slopes,
)
from seatrial.control.station.tune_station import (
    StationDesign,
    choose_bandwidth,
    gain_units,
    hull_error,
    largest_bandwidth,
    margin_frequencies,
    station_craft,
    station_disturbances,
    tune_station,
)
from seatrial.control.task import Seaway, StationDemand, TuningTask
from seatrial.core.results.station import StationKeeping
from seatrial.core.values import InputError
from seatrial.physics.loops import HullFactor
from seatrial.physics.loops.loop import Sampling
from seatrial.physics.sea.spectrum import jonswap

HULL = HullFactor(1.2, 0.8, 0.15)


@pytest.fixture(scope="module")
def task(tmp_path_factory: pytest.TempPathFactory) -> TuningTask:
    return station_task(tmp_path_factory.mktemp("station"))


@pytest.fixture(scope="module")
def demand(task: TuningTask) -> StationDemand:
    assert task.station is not None
    return replace(task.station, covariance=craft(task.station.model, 0.05).covariance)


@pytest.fixture(scope="module")
def made(task: TuningTask, demand: StationDemand) -> StationKeeping:
    return tune_station(task, demand, 0, lambda _: None, draws=4)


def test_margins_keep_their_limits(made: StationKeeping, task: TuningTask) -> None:
    m = made.margins
    assert max(m.surge, m.sway, m.yaw) <= task.constraints.Ms + 0.02  # between the frequencies of the search
    assert m.joint <= 3.0
    assert m.delay_margin >= made.dead_time
    assert made.dead_time == pytest.approx(0.1 + 0.5 * made.sample_s)


def test_the_simulated_craft_is_as_precise_as_predicted(made: StationKeeping) -> None:
    """Linear theory about the steady current against the nonlinear craft from eight directions."""
    assert made.trial.position == pytest.approx(made.predicted.position, rel=0.15)
    assert made.trial.heading == pytest.approx(made.predicted.heading, rel=0.25)
    assert made.trial.position < made.trial.radius < 3.0 * made.trial.position
    assert made.trial.cut == 0.0
    assert (made.trial.draws, made.trial.stable_draws) == (4, 4)
    assert made.trial.worst_radius < 2.0 * made.trial.radius


def test_the_front_falls_and_holds_the_choice(made: StationKeeping) -> None:
    front = made.front
    assert np.all(np.diff(front.error) > 0.0) and np.all(np.diff(front.thrust) < 0.0)
    best = int(np.argmin(front.error * front.thrust))
    assert front.position_bandwidth[best] == pytest.approx(made.position_bandwidth)
    assert front.heading_bandwidth[best] == pytest.approx(made.heading_bandwidth)


def test_no_bandwidths_on_a_grid_are_better() -> None:
    own = craft(cross_drive())
    frequencies = margin_frequencies(own, 0.15)
    point = replace(station_point(own, 0.2, 0.5, generalised_inverse(own)), grids=(frequencies,))
    spectrum = SlowPush("gusts", (0.03, 0.03, 0.0, 5.0, 5.0, 0.5), 0.2).spectrum()
    design = StationDesign((point,), generalised_inverse(own), 0.15, 1.6, spectrum, frequencies)
    chosen = choose_bandwidth(design)
    least = hull_error(own, chosen.precision) * chosen.precision.thrust
    top = largest_bandwidth(own, 0.15)
    for position in np.geomspace(0.05, 0.6, 6) * top:
        for heading in np.geomspace(0.05, 0.6, 6) * top:
            loops = design.loops(float(position), float(heading))
            if design.excess(loops) <= 1.0:
                precision = design.precision(loops)
                assert hull_error(own, precision) * precision.thrust > 0.97 * least


def test_spectra_hold_the_variance_of_their_series() -> None:
    """A slow push over many of its times; waves against the spectrum's own second moment, hull much shorter."""
    push = SlowPush("gusts", (0.0, 0.0, 0.0, 5.0, 0.0, 2.0), 0.5)
    assert np.diag(push.spectrum().shares.sum(axis=0).real) == pytest.approx(np.square(push.rms), rel=2e-3)
    made = push.series(0.1, 40_000, np.random.default_rng(0))
    assert np.std(made[2:], axis=1) == pytest.approx([5.0, 0.0, 2.0], rel=0.1)
    sea = Seaway(jonswap(0.5, 6.0), 3.0, math.radians(60.0))
    waves = WavePush(sea, replace(HULL, L=0.01, B=0.01, T=0.01), 9.0)
    shares = np.diag(waves.spectrum().shares.sum(axis=0).real)
    assert shares[0] + shares[1] == pytest.approx(sea.spectrum.moment(2), rel=0.03)
    assert shares[1] / shares[0] == pytest.approx(math.tan(math.radians(60.0)) ** 2)
    assert waves.description.startswith("JONSWAP 0.5 m, long-crested, 60 deg, 0 m/s")
    both = StationSetting(0.0, np.zeros(1), (push, waves)).series(0.0, 0.1, 40_000, 0)
    assert np.all(both[2] == made[2]) and np.ptp(both[0]) > 0.0
    joint = joined([push.spectrum(), waves.spectrum()])
    assert len(joint.omega) == len(joint.shares)


def test_disturbances_of_the_file_reach_the_station(task: TuningTask, demand: StationDemand) -> None:
    own = station_craft(demand)
    sea = Seaway(jonswap(0.1, 2.0), 1.0, 2.0)
    found = station_disturbances(replace(task, disturbances=(sea, *task.disturbances)), demand, own)
    assert [type(one) for one in found] == [SlowPush, SlowPush, WavePush, SlowPush]
    last = found[-1]
    assert isinstance(last, SlowPush)
    # about half ahead, by 0.002 of full command on four thrusters of arm 0.8 cos 45: slope p k_f c^(p-1)
    moment = 0.002 * 4.0 * 0.8 * math.sqrt(0.5) * 60.0 * 1.8 * 0.5**0.8
    assert last.rms[5] == pytest.approx(moment, rel=0.05)


def test_craft_drawn_differ_and_one_that_runs_away_is_not_counted(made: StationKeeping, demand: StationDemand) -> None:
    own = station_craft(demand)
    drawn = draw_craft(own, 3, 1)
    assert len({one.model.parameters["M_v"].value for one in drawn}) == 3
    assert draw_craft(replace(own, covariance=np.empty((0, 0))), 3, 1) == []
    stronger = own.with_values({"k_f": 66.0})
    assert thrust_slopes(stronger, own) == pytest.approx(np.full(4, 1.1))
    point = station_point(own, demand.current, 0.0, generalised_inverse(own))
    frequencies, spectrum = margin_frequencies(own, 0.15), SlowPush("none", (0.01,) * 6, 1.0).spectrum()
    design = StationDesign((point,), generalised_inverse(own), 0.15, 1.6, spectrum, frequencies)
    slow = design.loops(made.position_bandwidth, 0.2 * made.heading_bandwidth)[0]
    setting = StationSetting(demand.current, np.zeros(1), ())
    simulator = StationSimulator(slow, sampled_controller(slow, Sampling(0.1, 0.1)), setting, 0)
    assert simulator.respond(2).stable_draws == 0


def test_units_follow_that_of_force() -> None:
    assert gain_units("N")["KP"] == (("N/m", "N/m", "N/rad"), ("N/m", "N/m", "N/rad"), ("N", "N", "N m/rad"))
    assert gain_units("N")["KI"][2] == ("N/s", "N/s", "N m/(rad s)")
    assert gain_units("N/kg")["KD"][1] == ("N s/(kg m)", "N s/(kg m)", "N s/(kg rad)")


def test_limits_that_no_bandwidth_keeps_are_refused_with_what_is_possible() -> None:
    own = craft(cross_drive())
    spectrum = SlowPush("gusts", (0.01,) * 6, 0.2).spectrum()
    point, frequencies = station_point(own, 0.2, 0.5, generalised_inverse(own)), margin_frequencies(own, 0.15)
    with pytest.raises(InputError, match=r"no bandwidth keeps the limits.*Ms 1\.\d+ for 1.01[^0-9]"):
        choose_bandwidth(StationDesign((point,), generalised_inverse(own), 0.15, 1.01, spectrum, frequencies))


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ([("gust_bandwidth = 0.2", "")], "gust and gust_bandwidth go together"),
        (
            [("gust = 5", 'gust = { value = 5, unit = "m/s" }')],
            "station.gust: 'm/s' is no unit of what is",
        ),
        ([("current = 0.25", "current = 3")], r"at times 3.08 m/s; the thrusters hold 2\.2"),
        ([("current = 0.25", "current = -1")], "station.current: -1 is not positive"),
        ([('model = "model.toml"', 'model = "model.toml"\noutput = "u"\nspeed = 1.0')], "beside its heading loop"),
    ],
)
def test_a_station_that_is_none_is_refused(tmp_path: Path, changes: list[tuple[str, str]], says: str) -> None:
    with pytest.raises(InputError, match=says):
        station_task(tmp_path, *changes)


def test_azimuths_have_lags_of_thrust_and_of_turning() -> None:
    own = craft(azimuths())
    assert own.lags == pytest.approx(np.full(8, 0.35 + 0.5))
    assert own.delay == 0.0
    assert own.force_unit == "N/kg"
    assert own.tables[0].least == 0.0
