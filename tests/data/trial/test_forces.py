"""Tables of force points in every convention come out the same; what lies outside is refused in one sentence."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import ForcePoints, InputError
from seatrial.core.values.notation import si_unit
from seatrial.data.trial.forces import read_force_points
from seatrial.data.trial.schema import ForcesTable
from seatrial.physics.models.published import kvlcc2

RHO, LENGTH, DRAUGHT, SPEED = 1000.0, 7.0, 0.46, 1.2
BETA, RATE = np.radians([-12.0, 0.0, 5.0, 20.0]), np.array([0.5, -0.3, 0.0, 0.8]) * SPEED / LENGTH
DELTA = np.radians([0.0, 10.0, -20.0, 35.0])
X, Y, N = np.array([-16.0, -15.0, -20.0, -30.0]), np.array([-80.0, 3.0, 40.0, 150.0]), np.array([200.0, -50.0, 70, 9])

PLAIN = {
    "file": "tank.csv", "includes": "hydrodynamic", "sd_percent": 3.0,
    "motion": {
        "U": {"value": SPEED, "unit": "m/s"}, "beta": {"column": "beta", "unit": "deg", "positive": "bow to starboard"},
        "r": {"column": "r", "unit": "rad/s"}, "delta": {"column": "delta", "unit": "deg"},
        "n": {"value": 624.0, "unit": "rpm"},
    },
    "measured": {f: {"column": f, "unit": unit} for f, unit in (("X", "N"), ("Y", "N"), ("N", "N m"))},
}  # fmt: skip


def model() -> Model:
    """The 7 m KVLCC2."""
    return kvlcc2()


def read(folder: Path, columns: dict[str, np.ndarray], reference_point: float = 0.0, **changes: object) -> ForcePoints:
    """Write the columns, read them as `PLAIN` with changes says."""
    rows = [",".join(columns), *(",".join(f"{v:.17g}" for v in row) for row in zip(*columns.values(), strict=True))]
    (folder / "tank.csv").write_text("\n".join(rows) + "\n")
    return read_force_points(ForcesTable.model_validate(PLAIN | changes), folder, model(), reference_point, "forces[1]")


def columns(**changes: np.ndarray) -> dict[str, np.ndarray]:
    """The table in the house's own conventions, with changed columns."""
    own = {"beta": np.degrees(BETA), "r": RATE, "delta": np.degrees(DELTA), "X": X, "Y": Y, "N": N}
    return own | changes


def demand_house(points: ForcePoints) -> None:
    """Motions and forces are those of the house's axes."""
    expected = {"u": SPEED * np.cos(BETA), "v": -SPEED * np.sin(BETA), "r": RATE, "delta": DELTA, "n": np.full(4, 10.4)}
    for symbol, values in expected.items():
        np.testing.assert_allclose(points.motion[symbol], values, rtol=1e-12, atol=1e-15)
    for symbol, values in {"X": X, "Y": Y, "N": N}.items():
        np.testing.assert_allclose(points.forces[symbol], values, rtol=1e-12, atol=1e-12)


def test_the_package_conventions(tmp_path: Path) -> None:
    points = read(tmp_path, columns())
    demand_house(points)
    assert points.sd["Y"] == pytest.approx(0.03 * 230.0)
    assert points.count == 12


def test_every_sign_turned(tmp_path: Path) -> None:
    turned = columns(beta=-np.degrees(BETA), r=-RATE, delta=-np.degrees(DELTA), X=-X, Y=-Y, N=-N)
    motion = PLAIN["motion"] | {
        "beta": {"column": "beta", "unit": "deg", "positive": "bow to port"},
        "r": {"column": "r", "unit": "rad/s", "positive": "port"},
        "delta": {"column": "delta", "unit": "deg", "positive": "port"},
    }
    sides = {"X": "aft", "Y": "port", "N": "port"}
    measured = {f: {"column": f, "unit": PLAIN["measured"][f]["unit"], "positive": side} for f, side in sides.items()}
    demand_house(read(tmp_path, turned, motion=motion, measured=measured))


@pytest.mark.parametrize(
    ("prime", "area"), [("rho/2 L d U^2", LENGTH * DRAUGHT), ("rho/2 L^2 U^2", LENGTH**2)], ids=["MMG", "SNAME"]
)
def test_prime_systems(tmp_path: Path, prime: str, area: float) -> None:
    unit = RHO / 2 * area * SPEED**2
    primed = columns(r=RATE * LENGTH / SPEED, X=X / unit, Y=Y / unit, N=N / unit / LENGTH)
    motion = PLAIN["motion"] | {"r": {"column": "r", "unit": "1"}}
    measured = {f: {"column": f, "unit": "1", "sd": 0.001} for f in ("X", "Y", "N")}
    points = read(tmp_path, primed, prime=prime, motion=motion, measured=measured)
    demand_house(points)
    assert points.sd["Y"] == pytest.approx(0.001 * unit)
    assert points.sd["N"] == pytest.approx(0.001 * unit * LENGTH)


def test_drift_at_another_point_is_moved_with_the_yaw_rate(tmp_path: Path) -> None:
    points = read(tmp_path, columns(N=N - 0.25 * Y), origin=0.25)
    np.testing.assert_allclose(points.motion["v"], -SPEED * np.sin(BETA) - 0.25 * RATE)
    np.testing.assert_allclose(points.forces["N"], N)


def test_velocities_in_place_of_the_drift_angle(tmp_path: Path) -> None:
    table = columns() | {"u": SPEED * np.cos(BETA), "v": -SPEED * np.sin(BETA)}
    rest = {s: PLAIN["motion"][s] for s in ("r", "delta", "n")}
    motion = rest | {s: {"column": s, "unit": "m/s"} for s in ("u", "v")}
    demand_house(read(tmp_path, table, motion=motion))
    primed = columns(v=-np.sin(BETA))
    motion = rest | {"U": {"value": SPEED, "unit": "m/s"}, "v": {"column": "v", "unit": "1"}}
    demand_house(read(tmp_path, primed, motion=motion))


def test_a_model_test_at_its_own_scale(tmp_path: Path) -> None:
    root = np.sqrt(4.0)
    small = columns(r=RATE * root, X=X / 4.0**3, Y=Y / 4.0**3, N=N / 4.0**4)
    motion = PLAIN["motion"] | {"U": {"value": SPEED / root, "unit": "m/s"}, "n": {"value": 10.4 * root, "unit": "rps"}}
    demand_house(read(tmp_path, small, scale=4.0, motion=motion))


def test_empty_cells_of_a_force_are_not_measured(tmp_path: Path) -> None:
    points = read(tmp_path, columns(N=np.array([1.0, np.nan, 2.0, 3.0])))
    assert np.isnan(points.forces["N"][1])
    assert points.count == 11


DRIFT = PLAIN["motion"]["beta"]
BAD = {
    "unknown prime system": ({"prime": "rho/2 L^2 d U^2"}, r"unknown prime system .* known are .*rho/2 L d U\^2"),
    "prime and newtons": ({"prime": "rho/2 L d U^2"}, r"measured.X is in 'N' although prime"),
    "no prime system": (
        {"measured": {"Y": {"column": "Y", "unit": "1"}}}, r"without dimension; say of which system: prime ="),
    "origin outside": ({"origin": 4.0}, r"origin = 4 m lies outside the ship, 3.5 m from midship"),
    "drift without sign": (
        {"motion": PLAIN["motion"] | {"beta": {"column": "beta", "unit": "deg"}}}, r"says nothing about its sign"),
    "drift in the wrong unit": (
        {"motion": PLAIN["motion"] | {"beta": {**DRIFT, "unit": "rad"}}}, r"row 2: the drift angle .*check the unit"),
    "no noise": ({"sd_percent": None}, r"measured.X has no standard deviation; give sd"),
    "moment without Y": (
        {"origin": 0.5, "measured": {"N": {"column": "N", "unit": "N m"}}}, r"cannot be moved without Y"),
    "wrong unit": ({"measured": {"Y": {"column": "Y", "unit": "N m"}}}, r"measured.Y.unit: 'N m' does not fit"),
    "wrong direction": (
        {"measured": {"Y": {"column": "Y", "unit": "N", "positive": "aft"}}}, r"write 'starboard' or 'port'"),
    "standing still": ({"motion": {**PLAIN["motion"], "U": {"value": 0.0, "unit": "m/s"}}}, r"speed U .* not positive"),
    "no such column": ({"measured": {"Y": {"column": "Yy", "unit": "N"}}}, r"no column 'Yy' for channel 'Y'"),
    "no such file": ({"file": "other.csv"}, r"forces\[1\].file: there is no file"),
}  # fmt: skip


@pytest.mark.parametrize(("changes", "sentence"), BAD.values(), ids=BAD)
def test_what_lies_outside_is_refused(tmp_path: Path, changes: dict, sentence: str) -> None:
    with pytest.raises(InputError, match=sentence) as refused:
        read(tmp_path, columns(), **changes)
    assert "\n" not in str(refused.value)


def test_motions_that_do_not_go_together_are_refused(tmp_path: Path) -> None:
    for more, sentence in (
        ({"u": {"value": 1.0, "unit": "m/s"}}, "one of them"),
        ({"v": {"value": 0.1, "unit": "1"}}, "both v and the drift angle"),
        ({"beta": {"column": "beta", "value": 1.0, "unit": "deg"}}, "either column or value"),
    ):
        with pytest.raises(ValueError, match=sentence):
            read(tmp_path, columns(), motion=PLAIN["motion"] | more)


def test_units_of_forces_are_known() -> None:
    assert si_unit("kN m") == (1e3, "N m")
