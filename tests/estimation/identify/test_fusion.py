"""Force points beside records: the trial file to the fit, and a prediction that hardly moves with the prior."""

from pathlib import Path

import fusion
import numpy as np
import pytest

from seatrial.core.results import Fit
from seatrial.core.values import ForcePoints, InputError
from seatrial.data.trial import EstimateMethod, load_trial
from seatrial.estimation.identify import identify
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.models.published import kvlcc2

TRIAL = """
[ship]
name = "tanker"
L = 7.0
B = 1.27
d = 0.46
C_b = 0.81

[[records]]
files = "zigzag.csv"
time = { column = "time", unit = "s" }
[records.channels]
u = { column = "u", unit = "m/s" }
v = { column = "v", unit = "m/s" }
r = { column = "r", unit = "rad/s" }
psi = { column = "psi", unit = "rad" }
delta = { column = "delta", unit = "rad" }
n = { column = "n", unit = "rps" }

[[forces]]
file = "tank.csv"
includes = "hydrodynamic"
sd_percent = 1
source = "a tank"
[forces.motion]
u = { column = "u", unit = "m/s" }
v = { column = "v", unit = "m/s" }
r = { column = "r", unit = "rad/s" }
delta = { column = "delta", unit = "rad" }
n = { value = 10.4, unit = "rps" }
[forces.measured]
X = { column = "X", unit = "N" }
Y = { column = "Y", unit = "N", positive = "SIDE" }
N = { column = "N", unit = "N m" }

[model]
name = "mmg"
parameter_set = "kvlcc2"
priors_from = "yoshimura"
prior_sd_percent = 100
free = ["Y_v", "Y_r", "Y_vvv", "Y_vrr", "N_v", "N_r", "N_rrr", "N_vvr"]
[model.fixed]
"""


def write(folder: Path, side: str) -> Path:
    """A zigzag with noise, a table of points and the trial file over both."""
    rng, ship = np.random.default_rng(4), kvlcc2()
    run = fusion.noisy(fusion.manoeuvre(ship, fusion.programme("zigzag:20/20"), dt=0.5, inputs={"n": 10.4}), rng)
    table(folder / "zigzag.csv", {"time": run.time} | {s: run[s] for s in ("u", "v", "r", "psi", "delta", "n")})
    points: ForcePoints = fusion.simulate_captive_points(ship, rng, 1.2, revolutions=10.4, percent=1.0)
    motion = {s: points.motion[s] for s in ("u", "v", "r", "delta")}
    table(folder / "tank.csv", motion | dict(points.forces))
    extra = "\n".join(
        f"{n} = {kvlcc2().parameters[n].value!r}" for n in ("m", "I_z", "x_G", "rho", "D_P", "A_R", "H_R")
    )
    (folder / "trial.toml").write_text(TRIAL.replace("SIDE", side) + extra + "\n")
    return folder / "trial.toml"


def table(path: Path, columns: dict[str, np.ndarray]) -> None:
    """A CSV file."""
    rows = [",".join(columns), *(",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True))]
    path.write_text("\n".join(rows) + "\n")


@pytest.fixture(scope="module")
def fused(tmp_path_factory: pytest.TempPathFactory) -> Fit:
    """The fit of one zigzag and the points."""
    return identify(load_trial(write(tmp_path_factory.mktemp("fusion"), "starboard")))


def test_points_and_record_give_the_coefficients(fused: Fit) -> None:
    truth = kvlcc2().parameters
    for c in fused.coefficients:
        if not c.fixed:
            assert abs(c.estimate - truth[c.name].value) <= 4.0 * c.standard_error, c.name
    yaw = next(c for c in fused.coefficients if c.name == "N_v")
    assert yaw.standard_error < 0.02 * abs(yaw.estimate)


def test_the_result_says_what_was_fused_and_cites_the_prior(fused: Fit) -> None:
    (said,) = [f for f in fused.findings if f.code == "force-points"]
    assert "tank.csv" in said.message
    levels = [float(part.split()[-1]) for part in said.evidence.split(": ")[1].split(", ")]
    assert all(0.7 < level < 1.4 for level in levels), (
        "points and records are of one ship, their noise is the stated one"
    )
    assert "Yoshimura & Masumoto" in next(c for c in fused.coefficients if c.name == "N_v").source


def test_a_turned_force_is_refused_with_the_way_to_declare_it(tmp_path: Path) -> None:
    trial = load_trial(write(tmp_path, "port"))
    with pytest.raises(InputError, match=r"column 'Y' \(Y\) looks turned.*turn positive of forces.measured.Y round"):
        identify(trial)


@pytest.mark.long
def test_the_predicted_turn_hardly_moves_with_the_prior() -> None:
    """A sample of the benchmark, which also chooses a disturbance; output error alone takes a third of the time."""
    alone, together = fusion.compare_with_captive(seed=13, spreads=(10.0, 100.0), method=EstimateMethod.OUTPUT_ERROR)
    assert together.points <= fusion.LIMIT
    loose = max(alone.predicted)
    missed = [abs(moved.predicted[loose] - moved.truth) for moved in (alone, together)]
    assert missed[1] < missed[0], "where the prior says little, the points do"


def test_points_of_another_ship_are_noticed() -> None:
    ship = kvlcc2()
    points = fusion.simulate_captive_points(ship, np.random.default_rng(2), 1.2, revolutions=10.4)
    other = ship.with_values({"N_v": 1.5 * ship.parameters["N_v"].value})
    gap = StaticForces(other, points).residuals(other.parameters.values)
    assert np.sqrt(np.mean(gap["N"] ** 2)) > 2.0
    assert np.sqrt(np.mean(gap["Y"] ** 2)) < 1.3
