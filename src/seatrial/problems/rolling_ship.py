"""Ships that turn and roll and are known: in zigzags, turns and roll decays under a ship's sensors."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.abkowitz import abkowitz_roll
from seatrial.physics.models.mmg import mmg_roll
from seatrial.physics.models.published import SON_NOMOTO, container_ship, kvlcc2_l7, s175
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.trial_problem import KnownCraft, craft_draw, free_values, off_centre_box, placed_model

# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.1, 0.5
# evaluations, each a simulation of six runs; chosen
_BUDGET = 1000
SETTINGS = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)


@dataclass(frozen=True)
class RollingShip:
    """A ship and how its trials are run.

    Attributes:
        model: the truth, with its free coefficients.
        noise: channel -> standard deviation, SI.
        manoeuvres: programme -> speed [m/s]; decays: initial heel [deg] -> speed [m/s].
        propulsion: propeller rate over speed [1/m]; 0: the model has no propeller.
        dt, approach, seconds, decay: sample, approach, longest manoeuvre and length of a decay [s].
    """

    model: Model
    noise: Mapping[str, float]
    manoeuvres: Mapping[str, float]
    decays: Mapping[float, float]
    propulsion: float
    dt: float
    approach: float
    seconds: float
    decay: float

    @property
    def length(self) -> float:
        """Length between perpendiculars [m]."""
        return self.model.parameters["L"].value

    def runs(self, model: Model | None = None) -> list[Record]:
        """Return manoeuvres and decays under way, of this ship or of a `model` like it, without noise."""
        model = model or self.model
        runs = [
            manoeuvre(
                model, programme(text), dt=self.dt, duration=self.seconds, approach=self.approach, speed=speed,
                inputs=self._inputs(speed),
            )
            for text, speed in self.manoeuvres.items()
        ]  # fmt: skip
        runs += [self._decay(model, heel, speed) for heel, speed in self.decays.items()]
        kept = (*self.noise, *self._inputs(1.0), "delta")
        return [replace(run, channels={c: run.channel(c) for c in kept}) for run in runs]

    def noisy(self, run: Record, rng: np.random.Generator) -> Record:
        """Return what instruments record of a run."""
        channels = dict(run.channels)
        for name, spread in self.noise.items():
            channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
        return replace(run, channels=channels)

    def _inputs(self, speed: float) -> dict[str, float]:
        return {"n": self.propulsion * speed} if self.propulsion else {}

    def _decay(self, model: Model, heel: float, speed: float) -> Record:
        """A ship under way let go from a heel [deg], rudder amidships."""
        time = np.arange(0.0, self.decay + self.dt, self.dt)
        inputs = {name: np.full(len(time), value) for name, value in ({"delta": 0.0} | self._inputs(speed)).items()}
        start = dict.fromkeys(model.states, 0.0) | {"u": speed, "phi": math.radians(heel)}
        return replay(model, Record.from_arrays(f"decay_{heel:g}", time, inputs), start)


# m, rad, m/s, rad/s, rad, rad/s: standard deviations of a ship's receiver, log, compass and gyros; chosen
_AT_SEA = {
    "x0": 1.0, "y0": 1.0, "psi": math.radians(0.1), "u": 0.05, "v": 0.05, "r": math.radians(0.01),
    "phi": math.radians(0.1), "p": math.radians(0.02),
}  # fmt: skip
# the same of a model in a tank; chosen
_IN_A_TANK = {
    "x0": 0.02, "y0": 0.02, "psi": math.radians(0.1), "u": 0.01, "v": 0.01, "r": math.radians(0.05),
    "phi": math.radians(0.1), "p": math.radians(0.2),
}  # fmt: skip
# speeds [m/s] on a straight course at 70, 100, 85 and 40 rpm; chosen
_MANOEUVRES = {"zigzag:10/10": 7.33, "zigzag:20/20": 10.47, "turning-circle:35": 8.90, "turning-circle:15": 10.47}
# speeds [m/s] of the model in a tank; chosen: as tried by SIMMAN, and one slower
_TANK_MANOEUVRES = {"zigzag:10/10": 1.18, "zigzag:20/20": 1.18, "turning-circle:35": 1.18, "turning-circle:15": 0.9}
# speed [m/s] of every run about which is expanded, that of 70 rpm
_EXPANDED_SPEED = 7.33
_ONE_SPEED = dict.fromkeys(_MANOEUVRES, _EXPANDED_SPEED)
_S175_PROPULSION = 70.0 / 60.0 / 7.329588  # rps over m/s of a straight course


def rolling_container_ship() -> RollingShip:
    """Return the container ship S175 as published."""
    # decays at 70 and 40 rpm, s: chosen
    return RollingShip(
        container_ship(), _AT_SEA, _MANOEUVRES, decays={10.0: 7.33, -10.0: 4.19}, propulsion=_S175_PROPULSION,
        dt=1.0, approach=60.0, seconds=900.0, decay=400.0,
    )  # fmt: skip


# levers, roll inertia and damping of the tanker; chosen: a tender ship, k_xx 0.4 B, added inertia a fifth of it
_TANKER_ROLL = {
    "GM": 0.03, "I_x": 844.0, "J_x_prime": 3.06e-4, "l_y_prime": 0.01, "z_H_prime": 0.03, "z_R_prime": 0.03,
    "b_1": 0.03, "b_2": 0.2, "Y_phi": -0.005, "N_phi": -0.005,
}  # fmt: skip


def rolling_tanker() -> RollingShip:
    """Return the 7 m model of KVLCC2 with chosen values of what concerns roll."""
    model = kvlcc2_l7().applied_to(mmg_roll().with_values(_TANKER_ROLL))
    # decays at two speeds, 10.4 rps at 1.18 m/s, s: chosen
    return RollingShip(
        model, _IN_A_TANK, _TANK_MANOEUVRES, decays={10.0: 1.18, -10.0: 0.6}, propulsion=10.4 / 1.18,
        dt=0.2, approach=10.0, seconds=150.0, decay=60.0,
    )  # fmt: skip


# the hull of S175 in the expansion: centripetal terms of added masses moved into Y_r, X_vr and K_r; rudder as printed
# for the linear model (Fossen 1994, appendix E.1.3), resistance chosen
_EXPANSION = {
    "X_udot": -0.000238, "Y_vdot": -0.007049, "N_rdot": -0.000419, "Y_rdot": -0.00035245, "N_vdot": -0.00035245,
    "Y_pdot": 0.00022063, "K_vdot": 0.00022063, "K_pdot": -0.0000034,
    "X_u": -0.0012, "X_uu": 0.0, "X_vv": -0.00386, "X_rr": 0.0002, "X_dd": -0.001, "X_vr": 0.00394,
    "Y_v": -0.0116, "Y_r": 0.002182, "Y_d": -0.002578, "Y_vvv": -0.109, "Y_vvr": 0.0214, "Y_vrr": -0.0405,
    "Y_rrr": 0.00177, "N_v": -0.0038545, "N_r": -0.00222, "N_d": 0.00126, "N_vvv": 0.001492, "N_vvr": -0.0424,
    "N_vrr": 0.00156, "N_rrr": -0.00229, "Y_phi": -0.000063, "N_phi": -0.0001424,
    "K_v": 0.0003026, "K_r": -0.0000556, "K_d": 0.0000855, "K_p": -0.0000075, "x_G": 0.0, "U_n": 7.33,
}  # fmt: skip


def rolling_expansion() -> RollingShip:
    """Return the expansion of Abkowitz with the hull of S175 at one speed."""
    model = abkowitz_roll().with_values(_EXPANSION).with_ship(s175().ship)
    decays = dict.fromkeys((10.0, -10.0), _EXPANDED_SPEED)  # deg to either side; chosen
    # s, as of the container ship; chosen
    return RollingShip(
        model, _AT_SEA, _ONE_SPEED, decays, propulsion=0.0, dt=1.0, approach=60.0, seconds=900.0, decay=400.0
    )


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problem."""
    title = "container ship with roll, 4 manoeuvres and 2 decays, box ±50 % off centre"
    noise = "x0, y0 1 m, psi, phi 0.1 deg, u, v 0.05 m/s, r 0.01 deg/s, p 0.02 deg/s, white"
    return (BenchmarkProblem("s175-trials", 1, title, SON_NOMOTO, noise, _BUDGET, _draw),)


def _draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    ship = rolling_container_ship()
    model = placed_model(ship.model, placement, _SCALE, rng)
    clean = ship.runs(model)
    starts = [{name: float(run[name][0]) for name in model.states} for run in clean]
    records = [ship.noisy(run, rng) for run in clean]
    box = off_centre_box(free_values(model), _HALF_WIDTH, rng)
    craft = KnownCraft(s175().ship, model, records, ship.noise, starts, SETTINGS)
    return craft_draw(craft, box, 0.5 * (box.lower + box.upper))
