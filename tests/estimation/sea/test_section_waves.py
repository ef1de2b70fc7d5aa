"""Sections in regular waves: what was put in comes out, in every combination of motions; what is open is said."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError, Record, Ship
from seatrial.estimation.sea import SectionFit, WaveResponses, fit_section, read_responses
from seatrial.estimation.sea.section_waves import CHANNELS
from seatrial.physics.hydro.section import MOTIONS, FloatingSection
from seatrial.physics.simulate import replay
from seatrial_studies.section2d.responses import harmonics

SHIP = Ship("section", {"B": 0.4, "d": 0.2, "L": 0.6, "m": 46.0, "KG": 0.11, "k_xx": 0.14, "GM": 0.06})
FORM_ALONE = Ship("section", {name: value for name, value in SHIP.particulars.items() if name != "GM"})
OMEGA = np.array([3.8, 4.3, 4.8, 5.1, 5.4, 5.8, 6.4, 7.2, 8.1])
TRUTH = {"a33": -2.0, "a44": 0.03, "c22": 60.0, "d33": 150.0, "d44": 0.3, "b22": 4.0, "f22": 0.2, "gain_phi": 1.05,
         "delay": 0.01}  # fmt: skip
FREE = {
    "sway": ("c22", "b22"), "heave": ("a33", "d33"), "roll": ("a44", "d44"),
}  # fmt: skip
COMBINATIONS = [
    ("sway",), ("heave",), ("roll",), ("sway", "heave"), ("heave", "roll"), ("sway", "roll"), ("sway", "heave", "roll")
]  # fmt: skip


def known(motions: tuple[str, ...], values: dict[str, float] | None = None) -> SectionFit:
    """A section whose coefficients are known."""
    return SectionFit(
        FloatingSection.from_ship(SHIP), motions, np.inf, TRUTH if values is None else values, {}, 0.0, ()
    )


def table_of(fit: SectionFit, rng: np.random.Generator | None = None, omega: np.ndarray = OMEGA) -> WaveResponses:
    """Its responses in waves of 12 and 20 mm, with errors of 0.5 % where they are drawn."""
    amplitude = np.where(np.arange(len(omega)) % 2, 0.012, 0.02)
    bare = WaveResponses("table", omega, amplitude, {"z": np.ones(len(omega), dtype=complex)})
    motions = fit.predicted(bare)
    if rng is not None:
        motions = {c: v * (1.0 + 0.005 * (rng.standard_normal((2, len(v))).T @ [1.0, 1j])) for c, v in motions.items()}
    return replace(bare, motions=motions)


@pytest.mark.parametrize("motions", COMBINATIONS, ids="-".join)
def test_what_was_put_in_comes_out_in_any_combination(motions: tuple[str, ...]) -> None:
    free = tuple(name for motion in motions for name in FREE[motion])
    others = {name: value for name, value in TRUTH.items() if name not in free}
    found = fit_section(SHIP, table_of(known(motions)), motions, free, others)
    assert [found.values[n] for n in free] == pytest.approx([TRUTH[n] for n in free], rel=1e-4)
    assert found.misfit < 1e-4
    assert not found.open


def test_periods_left_out_are_predicted_within_their_noise(rng: np.random.Generator) -> None:
    motions = ("heave", "roll")
    table = table_of(known(motions), rng)
    trained = np.arange(len(OMEGA)) % 2 == 0
    found = fit_section(SHIP, table.rows(trained), motions, ("a33", "d33", "a44", "d44", "gain_phi", "delay"))
    for amplitude, phase in found.errors_of(table.rows(~trained)).values():
        assert np.max(np.abs(amplitude)) < 1.5
        assert np.max(np.abs(phase)) < 1.5


def test_the_errors_stated_are_those_made(rng: np.random.Generator) -> None:
    free, motions = ("a33", "d33", "a44", "d44"), ("heave", "roll")
    others = {name: value for name, value in TRUTH.items() if name not in free}
    fits = [fit_section(SHIP, table_of(known(motions), rng), motions, free, others) for _ in range(60)]
    for name in free:
        made = np.sqrt(np.mean([(f.values[name] - TRUTH[name]) ** 2 for f in fits]))
        assert np.sqrt(np.mean([f.errors[name] ** 2 for f in fits])) == pytest.approx(made, rel=0.35)


@pytest.mark.parametrize("motions", [("sway", "heave", "roll"), ("heave", "roll")], ids="-".join)
def test_the_model_simulated_in_waves_answers_as_the_table_has_it(motions: tuple[str, ...]) -> None:
    """Harmonic balance leaves the higher harmonics of friction out: 1 % of the amplitude."""
    values = {name: value for name, value in TRUTH.items() if name in ("a33", "a44", "c22", "d33", "d44", "b22")}
    fit, omega, amplitude = known(motions, values), 5.3, 0.012
    time = 0.02 * np.arange(6000)
    force = FloatingSection.from_ship(SHIP).hydrodynamics(omega).excitation * amplitude
    waves = np.real(force[:, None] * np.exp(1j * omega * time))
    record = Record.from_arrays("waves", time, {"F2": waves[0], "F3": -waves[1], "M4": waves[2]})
    moved = replay(fit.model(omega), record, dict.fromkeys(("y0", "v", "z", "z_dot", "phi", "p"), 0.0))
    bare = WaveResponses("one", np.array([omega]), np.array([amplitude]), {"z": np.ones(1, dtype=complex)})
    last = slice(4500, 4500 + round(20 * 2.0 * np.pi / omega / 0.02))
    for channel, expected in fit.predicted(bare).items():
        made = harmonics(time[last], moved[channel][last], omega).first / amplitude
        assert made == pytest.approx(complex(expected[0]), rel=0.01)
    held = [CHANNELS[m] for m in MOTIONS if m.value not in motions]
    assert all(np.ptp(moved[channel]) == 0.0 for channel in held)


def test_damping_radiates_what_a_drifting_section_takes_from_the_wave() -> None:
    """Without losses the wave's power stays in the wave: that of force over velocity is that of radiation damping."""
    body, omega = FloatingSection.from_ship(SHIP), 5.0
    made = body.hydrodynamics(omega)
    fit = known(("sway", "heave", "roll"), {"c22": 60.0})
    bare = WaveResponses("one", np.array([omega]), np.array([0.01]), {"z": np.ones(1, dtype=complex)})
    velocity = 1j * omega * np.array([v[0] for v in fit.predicted(bare).values()])
    power = 0.5 * np.real(np.vdot(velocity, made.excitation))
    assert power == pytest.approx(0.5 * np.real(np.vdot(velocity, made.damping @ velocity)), rel=1e-5)


def test_long_waves_carry_the_section_with_them() -> None:
    """Deep-water limit: heave follows the elevation, sway the water, roll the slope of the wave."""
    omega = np.array([0.3])
    bare = WaveResponses("long", omega, np.array([0.01]), {"z": np.ones(1, dtype=complex)})
    free = replace(known(("sway", "heave", "roll"), {}), section=FloatingSection.from_ship(FORM_ALONE))
    moved = free.predicted(bare)
    assert moved["z"][0] == pytest.approx(-1.0, abs=0.02)
    assert abs(moved["y0"][0]) == pytest.approx(1.0, abs=0.02)
    assert moved["phi"][0] == pytest.approx(1j * omega[0] ** 2 / 9.81, rel=0.03)


def test_heave_is_the_same_whatever_else_is_free() -> None:
    alone, with_all = (table_of(known(m)).motions["z"] for m in (("heave",), ("sway", "heave", "roll")))
    np.testing.assert_allclose(alone, with_all, rtol=1e-9)


def test_what_the_table_leaves_open_is_said() -> None:
    table = table_of(known(("heave",)), np.random.default_rng(1))
    few = table.rows(np.array([3, 4, 5]))
    found = fit_section(SHIP, few, ("heave",), ("a33", "c33", "d33", "gain_z"), {"delay": 0.01})
    assert any("a33 and c33 are known only together" in sentence for sentence in found.open)
    with pytest.raises(InputError, match=r"does not identify .*they change the responses together alike"):
        fit_section(SHIP, table.rows(np.array([2, 2])), ("heave",), ("a33", "c33"))
    with pytest.raises(InputError, match="does not show a44"):
        fit_section(SHIP, table, ("heave",), ("a33", "a44"))
    with pytest.raises(InputError, match="3 unknowns cannot be identified from 2 numbers"):
        fit_section(SHIP, table.rows(np.array([2, 2])), ("heave",), ("a33", "b33", "d33"))


@pytest.mark.parametrize(
    ("motions", "free", "message"),
    [
        (("heave",), ("a33",), "held in roll: add 'roll' to the motions"),
        (("heave", "rol"), ("a33",), "'rol' is no motion of a section; did you mean 'roll'"),
        (("heave", "roll"), ("a32",), "no coefficient 'a32'; did you mean"),
    ],
)
def test_what_does_not_go_together_is_refused(motions: tuple[str, ...], free: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        fit_section(SHIP, table_of(known(("heave", "roll"))), motions, free)


def test_particulars_that_are_missing_are_named() -> None:
    with pytest.raises(InputError, match="lacks a positive KG, k_xx"):
        FloatingSection.from_ship(Ship("section", {"B": 0.4, "d": 0.2, "L": 0.6, "m": 46.0}))


def written(folder: Path, text: str) -> Path:
    (folder / "table.csv").write_text(text, encoding="utf-8")
    return folder / "table.csv"


def test_a_table_is_read_by_amplitude_or_by_parts(tmp_path: Path) -> None:
    text = "# run 1\nperiod, wave_amplitude, z_amplitude, z_phase_deg, phi_real, phi_imag\n1.2, 0.01, 2.0, 90, 1, -1\n"
    made = read_responses(written(tmp_path, text))
    assert made.omega == pytest.approx([2.0 * np.pi / 1.2])
    assert made.motions["z"] == pytest.approx([2j])
    assert made.motions["phi"] == pytest.approx([1 - 1j])


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("wave_amplitude,z_real,z_imag", "one of the columns omega"),
        ("omega,z_real,z_imag", "no column 'wave_amplitude'"),
        ("omega,wave_amplitude,z_amplitude", "'z' lacks a column"),
        ("omega,wave_amplitude,z_real,z_imag,phi_phase", "unknown column 'phi_phase'; did you mean 'phi_phase_deg'"),
    ],
)
def test_a_table_that_lacks_something_says_what(tmp_path: Path, header: str, message: str) -> None:
    row = ",".join("1" for _ in header.split(","))
    with pytest.raises(InputError, match=message):
        read_responses(written(tmp_path, f"{header}\n{row}\n"))
