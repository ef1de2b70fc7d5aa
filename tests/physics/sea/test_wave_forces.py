"""Wave forces from an elevation: against those of the lines themselves; records that cannot give them."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.physics.hydro.tabulated import TabulatedExcitation, WaveTable
from seatrial.physics.sea.spectrum import ittc
from seatrial.physics.sea.wave_forces import force_density, with_wave_forces
from seatrial_studies.seaway import SPEED, SeawayScenario, box_hull, simulate_seaway_run


def bare(record: Record) -> Record:
    kept = {name: c for name, c in record.channels.items() if name not in ("F3", "M5")}
    return Record(record.name, record.time, kept, record.kind)


@pytest.mark.parametrize("heading", [90, 135, 180])
def test_forces_from_the_elevation_equal_those_of_the_lines(heading: int) -> None:
    made = simulate_seaway_run(SeawayScenario(heading, duration=400.0), np.random.default_rng(1)).record
    felt = with_wave_forces(bare(made), box_hull(), SPEED, np.radians(heading))
    known = made.between(float(felt.time[0]), float(felt.time[-1]))
    for name in ("F3", "M5"):
        assert np.std(felt[name] - known[name]) < 0.01 * np.std(known[name])


@pytest.mark.parametrize("heading", [90, 150, 180])
def test_a_probe_ahead_of_midship_sees_waves_from_ahead_earlier(heading: int) -> None:
    """Long-crested waves of five lines, their elevation written down at midship and 12 m ahead of it."""
    beta, ahead, time = np.radians(heading), 12.0, np.arange(4000) * 0.1
    omega, phase = np.array([0.5, 0.61, 0.74, 0.83, 0.97]), np.array([0.1, 2.0, 4.1, 5.0, 3.3])
    k = omega**2 / 9.81
    met = omega - k * SPEED * np.cos(beta)
    elevations = [np.cos(np.outer(time, met) - k * x * np.cos(beta) + phase).sum(axis=1) for x in (0.0, ahead)]
    at_midship, there = (Record.from_arrays("run", time, {"zeta": zeta}) for zeta in elevations)
    there = there.with_channel("zeta", replace(there.channel("zeta"), reference_point=ahead))
    expected, found = (with_wave_forces(one, box_hull(), SPEED, beta) for one in (at_midship, there))
    middle = slice(500, -500)  # the ends are continued by prediction, each by its own
    for name in ("F3", "M5"):
        difference = found[name][middle] - expected[name][: len(found[name])][middle]
        assert np.std(difference) < 0.01 * np.std(expected[name])


def test_a_record_with_forces_keeps_them() -> None:
    made = simulate_seaway_run(SeawayScenario(135), np.random.default_rng(1)).record
    kept = with_wave_forces(made, box_hull(), SPEED, 2.0)
    assert np.array_equal(kept["F3"], made["F3"])
    assert kept["u"][0] == SPEED


@pytest.mark.parametrize(("change", "said"), [("short", "too short"), ("gap", "no value at sample 7"),
                                              ("still", "never moves"), ("none", "neither wave forces")])  # fmt: skip
def test_records_that_tell_no_force_are_refused(change: str, said: str) -> None:
    record = bare(simulate_seaway_run(SeawayScenario(135), np.random.default_rng(1)).record)
    zeta = record["zeta"].copy()
    if change == "gap":
        zeta[7] = np.nan
    if change == "still":
        zeta[:] = 0.3
    channels = {**record.channels, "zeta": record.channel("zeta").with_values(zeta)}
    if change == "none":
        channels.pop("zeta")
    made = Record("run", record.time, channels, record.kind)
    with pytest.raises(InputError, match=said):
        with_wave_forces(made.rows(slice(0, 300)) if change == "short" else made, box_hull(), SPEED, np.radians(135))


@pytest.mark.parametrize("heading", [45, 90, 180])
def test_the_density_of_the_force_holds_its_variance(heading: int) -> None:
    beta, edges = np.radians(heading), np.linspace(0.0, 12.0, 600)
    density = force_density(ittc(2.27), box_hull(), SPEED, beta, edges)
    omega = np.linspace(*ittc(2.27).band(5e-4, 0.9995), 20_000)
    F3, M5 = box_hull().forces(omega, SPEED, beta)
    for j, force in enumerate((F3, M5)):
        whole = np.trapezoid(np.abs(force) ** 2 * ittc(2.27).density(omega), omega)
        assert np.sum(density[:, j, j].real * np.diff(edges)) == pytest.approx(whole, rel=2e-3)
    np.testing.assert_allclose(density[:, 0, 1], density[:, 1, 0].conj())


def table_to(highest: float) -> TabulatedExcitation:
    """The box's own forces in head seas, tabulated from 0.1 rad/s."""
    omega = np.linspace(0.1, highest, 400)
    forces = np.stack(box_hull().forces(omega, SPEED, np.pi), axis=1)[:, None, :]
    return TabulatedExcitation(WaveTable("own table", omega, np.array([np.pi]), forces))


def test_a_table_need_not_reach_the_noise_of_the_probe(rng: np.random.Generator) -> None:
    """The sea ends near 2 rad/s; 2 cm of probe noise reach to the record's last frequency."""
    made = bare(simulate_seaway_run(SeawayScenario(180, duration=400.0), np.random.default_rng(1)).record)
    noisy = made.with_channel(
        "zeta", made.channel("zeta").with_values(made["zeta"] + 0.02 * rng.standard_normal(len(made)))
    )
    wide, narrow = (with_wave_forces(noisy, table_to(high), SPEED, np.pi) for high in (20.0, 3.0))
    step = narrow.provenance.steps[-1]
    assert "0.1 to 3 rad/s" in step and "of the energy of 'zeta'" in step
    assert "beyond" not in wide.provenance.steps[-1]
    for name in ("F3", "M5"):
        assert np.std(narrow[name] - wide[name]) < 0.02 * np.std(wide[name])


def test_a_table_that_lacks_the_sea_is_refused() -> None:
    made = bare(simulate_seaway_run(SeawayScenario(180, duration=400.0), np.random.default_rng(1)).record)
    with pytest.raises(InputError, match=r"forces are known from 0.1 to 0.7 rad/s; beyond lies .* give forces"):
        with_wave_forces(made, table_to(0.7), SPEED, np.pi)
