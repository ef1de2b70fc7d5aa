"""Bounds: closed forms where there are any, laws that every bound keeps, two independent computations of one number."""

import math
import sys
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from seatrial.control import bounds as bounds_module
from seatrial.control.bounds import (
    BOUND_ROWS,
    NoBound,
    ReferenceVariances,
    bounds,
    fit_shaping_filter,
    full_information,
    is_available,
    least_variance,
    quadratic_bound,
    rational_spectrum,
    reference_variances,
    without_negative_energy,
    youla_bound,
)
from seatrial.control.task import Seaway, TuningTask
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops import (
    Block,
    EncounterSpectrum,
    HullFactor,
    LoopSignal,
    Performance,
    Term,
    TransferLoop,
    margins,
)
from seatrial.physics.loops.encounter_spectrum import disturbance_spectrum
from seatrial.physics.loops.objective import variance
from seatrial.physics.loops.structures import ROLL, fin_loop, five_gain_loop
from seatrial.physics.sea.spectrum import ittc

convex = pytest.mark.skipif(not is_available(), reason="clarabel is not installed (extra 'bounds')")
U = 18.0 * 1852.0 / 3600.0
FIN = fin_loop()


@cache
def beam_sea() -> EncounterSpectrum:
    return task().disturbances[0].exposure(FIN)


def task(loop: TransferLoop = FIN) -> TuningTask:
    met = Seaway(ittc(3.3), U, math.pi / 2.0, HullFactor(100.0, 10.5, 3.4))
    return TuningTask(
        "", "fins", "", loop, (met,), (variance("roll", "rad^2", LoopSignal.OUTPUT),), ControllerConstraints(), U
    )


def plain_loop(plant: Block = ROLL, gain: float = 1.0) -> TransferLoop:
    """Rate feedback through a lag onto a roll."""
    rate = Term("K", Block("rate", (1.0, 0.0), (0.05, 1.0)))
    gains = Parameters((Parameter("K", gain, "1", 0.0, 10.0, free=True),))
    return TransferLoop("plain", (), (rate,), (), (Block("lag", (1.0,), (0.05, 1.0)),), plant, ROLL, gains)


def waves(omega: np.ndarray) -> np.ndarray:
    return np.abs(Block("", (0.1, 0.0, 0.0), (1.0, 0.9, 2.0, 0.7, 0.6)).frequency_response(omega)) ** 2


@cache
def rational_sea() -> EncounterSpectrum:
    return disturbance_spectrum(waves, 1e-3, 1e3, ROLL, "rational")


@pytest.mark.parametrize("q", [0.05, 0.4, 2.0])
def test_full_information_is_wieners_where_that_has_a_closed_form(q: float) -> None:
    """y = a + w, w' = -b w + noise: with weight q^2 of the rate, a = -c w / (1 + q s), c = 1 / (1 + q b)."""
    b, sigma = 0.7, 0.3
    one = Block("one")
    c = 1.0 / (1.0 + q * b)
    output, rate = sigma**2 * (1.0 - 2.0 * c**2 + c**3), sigma**2 * c**2 * b / (q * (1.0 + q * b))
    shaping = Block("waves", (sigma * math.sqrt(2.0 * b / math.pi),), (1.0, b))
    assert full_information(one, one, shaping, ReferenceVariances(1.0, rate)) == pytest.approx(output, rel=1e-6)


def test_a_rational_sea_is_fitted_by_itself() -> None:
    sea = rational_sea()
    shaping = fit_shaping_filter(sea, ROLL)
    assert shaping.misfit < 1e-3
    omega = np.geomspace(0.3, 3.0, 20)
    assert shaping.density(omega) == pytest.approx(waves(omega), rel=0.02)


def test_a_fitted_sea_moves_the_ship_as_much() -> None:
    sea = beam_sea()
    tails, shaping = rational_spectrum(sea, ROLL)
    assert tails.response_variance(ROLL) == pytest.approx(sea.response_variance(ROLL), rel=0.01)
    assert shaping.misfit < 0.02


def test_energies_gathered_on_few_nodes_are_made_positive_and_move_the_ship_as_much() -> None:
    sea = replace(task().disturbances[0], beta=math.radians(45.0)).exposure(FIN)
    made = without_negative_energy(sea)
    assert made.energy.min() > 0.0
    assert np.all(np.diff(made.omega_e) >= 0.0)
    assert made.variance == pytest.approx(sea.variance, rel=1e-9)
    ours, theirs = (reference_variances(FIN, one, FIN.gain_values) for one in (made, sea))
    assert [ours.output, ours.rate] == pytest.approx([theirs.output, theirs.rate], rel=1e-3)


@convex
def test_convex_and_quadratic_bound_meet_where_neither_peak_nor_sensor_matters() -> None:
    loop, sea = plain_loop(), rational_sea()
    convex_one = youla_bound(loop, sea, loop.gain_values, math.inf, sections=24).ratio
    quadratic = quadratic_bound(loop, sea, loop.gain_values).ratio
    assert quadratic * (1.0 - 1e-3) <= convex_one <= 1.03 * quadratic


@convex
def test_no_allowance_leaves_the_uncontrolled_motion_and_any_allowance_none() -> None:
    loop, sea = plain_loop(), rational_sea()
    free = sea.response_variance(ROLL)
    assert least_variance(loop, sea, 0.0, 2.0, 8) == free
    assert least_variance(loop, sea, 1e-10 * free, 2.0, 8) == pytest.approx(free, rel=1e-3)
    assert least_variance(loop, sea, 1e8 * free, math.inf, 16) < 1e-4 * free


@convex
def test_more_rate_and_a_higher_peak_never_harm() -> None:
    sea = beam_sea()
    held = reference_variances(FIN, sea, FIN.gain_values).rate
    by_rate = [least_variance(FIN, sea, factor * held, 1.5, 8) for factor in (0.25, 0.5, 1.0, 2.0)]
    by_peak = [least_variance(FIN, sea, held, peak, 8) for peak in (1.1, 1.32, 2.0, 4.0)]
    assert np.all(np.diff(by_rate) < 0.0)
    assert np.all(np.diff(by_peak) < 0.0)


@convex
def test_no_bound_lies_below_what_no_causality_would_allow() -> None:
    """Frequency by frequency: T = 1 / (1 + lambda |s / P|^2) of the least roll at a rate energy."""
    sea = beam_sea()
    w = sea.omega_e
    free, price = (
        np.abs(ROLL.frequency_response(w)) ** 2 * sea.energy,
        w**2 / np.abs(FIN.plant.frequency_response(w)) ** 2,
    )
    for weight in (1e-3, 1e-2, 1e-1):
        T = 1.0 / (1.0 + weight * price)
        least = least_variance(FIN, sea, float(np.sum(T**2 * price * free)), math.inf, 16)
        assert least >= float(np.sum((1.0 - T) ** 2 * free)) * (1.0 - 1e-6)


@convex
def test_random_gains_never_beat_their_bound() -> None:
    sea, loop = beam_sea(), five_gain_loop(FIN)
    generator = np.random.default_rng(3)
    drawn = generator.uniform([0.0, 0.0, 0.0, -20.0, -20.0], [40.0, 50.0, 100.0, 30.0, 20.0], (60, 5))
    made = Performance(loop, sea, BOUND_ROWS).evaluate(drawn)
    kept = np.flatnonzero((made.Ms < 3.0) & (made.Ms > 1.05))[:6]
    assert len(kept) == 6
    for i in kept:
        assert youla_bound(loop, sea, drawn[i], float(made.Ms[i]) * 1.001, sections=12).ratio < 1.0
        assert quadratic_bound(loop, sea, drawn[i]).ratio < 1.0


@convex
def test_the_published_fins_leave_room_and_five_gains_take_some() -> None:
    made = bounds(task(), FIN, FIN.gain_values)
    assert [b.name for b in made] == [
        "any linear controller", "any linear controller, waves with tails", "everything known",
    ]  # fmt: skip
    alone, tails, known = (b.ratio for b in made)
    assert 0.14 < alone < 0.18
    assert 0.43 < tails < 0.46
    assert 0.30 < known < 0.33
    assert all("ITTC" in b.conditions for b in made)
    assert "Ms <= 2" in made[0].conditions
    sea, richer = beam_sea(), five_gain_loop(FIN)
    ratio = (
        reference_variances(richer, sea, richer.gain_values).output
        / reference_variances(FIN, sea, FIN.gain_values).output
    )
    assert alone < ratio < 1.0


def test_without_clarabel_the_quadratic_one_remains(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds_module, "is_available", lambda: False)
    assert [b.name for b in bounds(task(), FIN, FIN.gain_values)] == ["everything known"]


def test_without_clarabel_the_convex_one_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "clarabel", None)
    with pytest.raises(InputError, match=r"pip install 'seatrial\[bounds\]'"):
        youla_bound(FIN, beam_sea(), FIN.gain_values, 2.0)


def test_plants_that_integrate_have_no_bound() -> None:
    loop = plain_loop(Block("yaw", (1.0,), (10.0, 1.0, 0.0)))
    with pytest.raises(NoBound, match="block 'yaw' of loop 'plain' integrates"):
        youla_bound(loop, rational_sea(), loop.gain_values, 2.0)
    assert bounds(task(loop), loop, loop.gain_values) == ()


def test_refused() -> None:
    sea = beam_sea()
    with pytest.raises(InputError, match="largest Ms above 1, not 1"):
        least_variance(FIN, sea, 1.0, 1.0, 4)
    gains = np.array([1000.0, 0.0, 0.0])
    assert not margins(FIN.with_gains(gains)).is_stable
    with pytest.raises(InputError, match="is unstable with the gains"):
        quadratic_bound(FIN, sea, gains)
