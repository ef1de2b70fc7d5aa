"""Each wrong declaration is found, by its own code, and right ones are left in peace."""

import math
from functools import cache

import numpy as np
import pytest
from benchmarks.fault_kinds import KINDS, FaultKind
from benchmarks.planted_faults import simulated
from tests.data.check.ship import in_earth_axes, integral, mirrored, with_declaration, with_values, zigzag
from tests.data.conftest import LONGEST_MESSAGE

from seatrial.core.values import Finding, InputError, Record, Severity
from seatrial.data.check import canonical_record, is_excited
from seatrial.data.check import examine as examine_anew
from seatrial.problems.rolling_ship import rolling_container_ship

examine = cache(examine_anew)


def errors(record: Record) -> list[str]:
    return [finding.code for finding in examine(record) if finding.severity is Severity.ERROR]


def codes(record: Record) -> list[str]:
    return [finding.code for finding in examine(record)]


def found(record: Record, code: str) -> Finding:
    return next(finding for finding in examine(record) if finding.code == code)


@pytest.mark.parametrize("noise", [0.0, 1.0, 3.0])
@pytest.mark.parametrize("amplitude", [0.05, 0.3, 0.6])
def test_right_declarations_are_left_in_peace(noise: float, amplitude: float) -> None:
    record = zigzag(amplitude, noise=noise)
    assert errors(record) == []
    assert errors(in_earth_axes(record)) == []


def test_noise_free_record_gives_no_finding_but_that_its_rudder_steps() -> None:
    assert codes(zigzag()) == ["stepped-input"]


def wrong_frame(record: Record) -> Record:
    turned = in_earth_axes(record)
    return with_values(record, u=turned["u"], v=turned["v"])


WRONG = {
    "velocities over ground": (wrong_frame, "wrong-frame", "earth-fixed"),
    "sway to port": (lambda r: with_values(r, v=-r["v"]), "closure", "v with the opposite sign"),
    "heading to port": (
        lambda r: with_values(r, psi=-r["psi"], r=-r["r"], delta=-r["delta"]), "wrong-frame", "'x0', 'y0' are exchanged"
    ),
    "yaw rate to port": (lambda r: with_values(r, r=-r["r"]), "wrong-sign", "'r' has the opposite sign"),
    "rudder to port": (lambda r: with_declaration(r, "delta", positive="port"), "wrong-sign", "'delta' has"),
    "knots": (lambda r: with_values(r, u=r["u"] * 3600 / 1852, v=r["v"] * 3600 / 1852), "wrong-unit", "in kn"),
}  # fmt: skip


@cache
def wrong_record(name: str, noise: float) -> Record:
    return WRONG[name][0](sideways(noise) if name == "sway to port" else zigzag(noise=noise))


@pytest.mark.long(every=2)
@pytest.mark.parametrize("noise", [1.0, 0.0])
@pytest.mark.parametrize("name", WRONG)
def test_wrong_declarations_are_found(name: str, noise: float) -> None:
    _, code, words = WRONG[name]
    wrong = wrong_record(name, noise)
    assert errors(wrong) == [code]
    assert words in found(wrong, code).message


def sideways(noise: float) -> Record:
    """A ship that drifts as fast as it goes ahead, so that the sign of v matters."""
    record = zigzag(noise=noise)
    v = record["v"] - 1.0
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    return with_values(
        record,
        v=v,
        x0=np.cumsum(record["u"] * c - v * s) * record.dt,
        y0=np.cumsum(record["u"] * s + v * c) * record.dt,
    )


def test_yaw_rate_in_degrees() -> None:
    record = zigzag(noise=1.0)
    wrong = with_values(record, r=np.degrees(record["r"]))
    assert errors(wrong) == ["wrong-unit"]
    assert "'r' is in deg/s" in found(wrong, "wrong-unit").message
    assert "'r' is in rad/s" in found(with_values(record, r=np.radians(record["r"])), "wrong-unit").message


def test_heading_in_radians_declared_in_degrees() -> None:
    record = zigzag(noise=1.0)
    wrong = with_values(record, psi=np.radians(record["psi"]))
    assert set(errors(wrong)) == {"wrong-unit"}
    assert "'psi' is in rad" in found(wrong, "wrong-unit").message


def test_rudder_in_degrees_or_radians() -> None:
    record = zigzag(noise=1.0)
    assert errors(with_values(record, delta=np.degrees(record["delta"]))) == ["wrong-unit"]
    small = found(with_values(record, delta=np.radians(record["delta"])), "wrong-unit")
    assert small.severity is Severity.WARNING


def test_a_roll_rate_that_is_the_yaw_rate() -> None:
    record = zigzag(noise=1.0)
    roll = Record.from_arrays("a", record.time, {"p": record["r"]}).channel("p")
    other = with_values(record.with_channel("p", roll), r=0.1 * np.gradient(record["r"], record.dt))
    assert errors(other) == ["mislabelled"]


@pytest.mark.parametrize("distance", [0.25, -1.5])
def test_another_reference_point_shows_in_closure_and_nowhere_else(distance: float) -> None:
    record = zigzag()
    shifted = with_values(record, v=record["v"] + distance * record["r"])
    assert codes(shifted) == ["closure", "stepped-input"]
    finding = found(shifted, "closure")
    assert finding.severity is Severity.ERROR
    assert f"{distance:+.3g} m ahead" in finding.message
    assert codes(with_declaration(shifted, "v", reference_point=distance)) == ["stepped-input"]


def test_velocities_over_ground_of_another_point_say_nothing_of_the_unit_of_the_heading() -> None:
    """Positions stated to be of an antenna 6 m aft, velocities of the same receiver stated to be of midship."""
    record, d = in_earth_axes(zigzag(noise=1.0)), -6.0
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    away = with_values(record, x0=record["x0"] + d * c, y0=record["y0"] + d * s,
                       u=record["u"] - d * record["r"] * s, v=record["v"] + d * record["r"] * c)  # fmt: skip
    for symbol in ("x0", "y0"):
        away = with_declaration(away, symbol, reference_point=d)
    assert errors(away) == ["closure"]
    assert "m ahead" in found(away, "closure").message
    both = with_declaration(with_declaration(away, "u", reference_point=d), "v", reference_point=d)
    assert errors(both) == []


def test_a_current_shows_in_closure() -> None:
    record = zigzag()
    finding = found(with_values(record, x0=record["x0"] + 0.1 * record.time), "closure")
    assert finding.severity is Severity.WARNING and "current or velocity bias of 0.1 m/s" in finding.message


def test_an_error_of_the_speed_below_what_a_good_log_has_is_a_note() -> None:
    record = zigzag()
    speed = float(np.mean(np.hypot(record["u"], record["v"])))
    for share, is_small in ((0.004, True), (0.03, False)):
        finding = found(with_values(record, x0=record["x0"] + share * speed * record.time), "closure")
        assert (finding.severity is Severity.INFO) == is_small


def test_a_heading_turned_by_a_share_of_the_speed_below_that_is_a_note() -> None:
    record = zigzag()
    for angle, is_small in ((0.004, True), (0.03, False)):  # rad
        finding = found(with_values(record, psi=record["psi"] + angle), "closure")
        assert "misalignment" in finding.message
        assert (finding.severity is Severity.INFO) == is_small


def test_a_lag_in_which_the_velocity_hardly_turns_is_a_note() -> None:
    """At 0.064 rad/s rms the velocity turns by 0.77 % of itself in 0.12 s, by 3.2 % in 0.5 s."""
    record = zigzag()
    assert float(np.sqrt(np.mean(record["r"] ** 2))) == pytest.approx(0.064, rel=0.01)
    for lag, is_small in ((0.12, True), (0.5, False)):  # s
        late = {s: np.interp(record.time - lag, record.time, record[s]) for s in ("u", "v", "psi")}
        earth = in_earth_axes(with_values(record, **late))
        finding = found(with_values(earth, psi=record["psi"]), "closure")
        assert "lag of" in finding.message
        assert (finding.severity is Severity.INFO) == is_small


@pytest.mark.parametrize("samples", [5, -8])
def test_lags_are_measured(samples: int) -> None:
    record = zigzag(noise=1.0)
    late = with_values(record, r=np.roll(record["r"], samples)).rows(slice(20, -20))
    finding = found(late, "lag")
    assert ("lags behind" in finding.message) == (samples > 0)
    assert ("earlier into the file" in finding.advice) == (samples > 0) and "write r " in finding.advice
    assert float(finding.message.split("about ")[1].split(" s")[0]) == pytest.approx(abs(samples) * 0.1, abs=0.06)


def test_rudder_that_never_moves() -> None:
    record = with_values(zigzag(noise=1.0), delta=np.full(3000, 0.01))
    finding = found(record, "no-excitation")
    assert "never moves" in finding.message and "zigzag" in finding.advice
    assert not is_excited(record) and is_excited(zigzag())


def test_a_ship_that_rolls_out_under_way_needs_no_moving_rudder() -> None:
    ship = rolling_container_ship()
    decay = ship.noisy(ship.runs()[-1], np.random.default_rng(0))
    assert "no-excitation" not in codes(decay)


def test_dead_stuck_and_constant_channels() -> None:
    record = zigzag(noise=1.0)
    n = Record.from_arrays("a", record.time, {"n": np.full(3000, 10.0)}).channel("n")
    assert codes(record.with_channel("n", n)) == ["stepped-input", "constant"]
    r = np.array(record["r"])
    r[1000:1400] = r[1000]
    assert "stuck" in codes(with_values(record, r=r))
    assert "dead-channel" in codes(with_values(record, v=np.zeros(3000)))


def test_getting_under_way_and_coasting() -> None:
    record = zigzag()
    t = record.time
    n = np.where((t > 10) & (t < 280), 10.0, 0.0)
    u = 1.2 * (1 - np.exp(-np.maximum(t - 10, 0) / 15.0))
    made = Record.from_arrays("start", t, {"u": u, "n": n})
    assert codes(made) == ["stuck", "stepped-input", "acceleration-phase", "coasting", "propeller-stopped"]
    assert float(found(made, "acceleration-phase").message.split("t = ")[1].split()[0]) == pytest.approx(34, abs=4)


def test_wrapped_heading_is_mentioned() -> None:
    record = zigzag()
    psi = record["psi"] + 3.0
    wrapped = with_values(record, psi=(psi + np.pi) % (2 * np.pi) - np.pi)
    finding = found(wrapped, "angle-wrap")
    assert finding.severity is Severity.INFO
    assert "readings of psi jump by a whole turn" in finding.message
    np.testing.assert_allclose(np.ptp(canonical_record(wrapped)["psi"]), np.ptp(psi))


def test_a_coarse_compass_that_rests_at_north_was_read_in_every_row() -> None:
    """It rests at 0 deg for a minute, then falls to 359.5 deg: half a degree, not a jump to what was missed."""
    t = np.arange(600.0)
    delta = np.where(t < 60.0, 0.0, np.radians(15.0) * np.sign(np.sin(t / 20.0)))
    psi = -np.radians(40.0) * np.sin(np.maximum(t - 60.0, 0.0) / 40.0)
    step = np.radians(0.5)
    made = Record.from_arrays("north", t, {"delta": delta, "psi": np.round(psi / step) * step % (2.0 * np.pi)})
    assert not {"empty-cells", "empty-rows", "rows-dropped"} & set(codes(made))


@pytest.mark.parametrize("name", ["right", *WRONG])
def test_the_mirror_image_is_judged_alike(name: str) -> None:
    record = wrong_record(name, 1.0) if name in WRONG else zigzag(noise=1.0)
    ours, theirs = examine(record), examine(mirrored(record))
    assert [(f.code, f.severity) for f in ours] == [(f.code, f.severity) for f in theirs]


def test_every_finding_names_the_record_and_gives_numbers_and_advice() -> None:
    record = with_declaration(wrong_frame(zigzag(noise=1.0)), "delta", positive="port")
    for finding in examine(record):
        assert "'zigzag'" in finding.message
        assert any(c.isdigit() for c in finding.evidence) and finding.advice
        assert not math.isnan(len(finding.text))


@pytest.mark.long(every=2)
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_what_a_check_says_of_a_planted_fault_is_short(kind: FaultKind, rng: np.random.Generator) -> None:
    record = simulated("tanker", 3).rows(slice(0, 1500)).renamed("20240513_zigzag_20_20_starboard_second L 7.0")
    try:
        texts = [text for f in examine(kind.spoil(record, rng)) for text in (f.text, f.consequence, f.advice)]
    except InputError as error:
        texts = [str(error)]
    assert max(map(len, texts)) <= LONGEST_MESSAGE, max(texts, key=len)


@pytest.mark.parametrize(("speed", "is_said"), [(0.1, False), (1.0, True)])
def test_velocities_below_the_noise_of_the_positions_contradict_nothing(speed: float, is_said: bool) -> None:
    """A craft that spins; u, v are of another motion, which positions show within 3 cm only where it is fast."""
    rng, time = np.random.default_rng(3), 0.05 * np.arange(330)
    psi = 0.9 * time
    north, east = (speed * integral(f(1.7 * time), 0.05) + 0.03 * rng.standard_normal(330) for f in (np.cos, np.sin))
    values = {"x0": north, "y0": east, "psi": psi, "u": speed * np.cos(2.6 * time), "v": speed * np.sin(0.4 * time)}
    findings = examine(Record.from_arrays("spin", time, values))
    assert any(f.code == "closure" for f in findings) is is_said
