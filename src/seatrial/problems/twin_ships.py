"""Ships with two screws or two jets, and ships in shallow water, that are known: their trials and their sensors."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record, Ship
from seatrial.physics.hydro.empirical import (
    HullForm,
    added_mass,
    displacement,
    interaction_coefficients,
    propulsion,
    yoshimura,
)
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.mmg import mmg_shallow, mmg_twin
from seatrial.physics.models.published import kvlcc2_l7, share_name, twin_screw_formulas
from seatrial.physics.models.waterjet import waterjet_twin
from seatrial.physics.simulate.replay import replay
from seatrial.physics.simulate.states import balancing_input, held_inputs
from seatrial.physics.simulate.steer import manoeuvre

# particulars of a model of a ferry [m, m^2, kg/m^3]; chosen
_FERRY = {
    "L": 6.0, "B": 1.0, "d": 0.25, "C_b": 0.60, "x_G": 0.0, "rho": 1000.0, "D_P": 0.18, "A_R": 0.025, "H_R": 0.20,
    "y_P": 0.22,
}  # fmt: skip
# pitch ratio, area ratio and blades of its propellers; chosen
_PROPELLER = (1.0, 0.6, 4)
# m, rad, m/s, rad/s: standard deviations of the instruments of a model in a tank; chosen
_IN_A_TANK = {
    "x0": 0.02, "y0": 0.02, "psi": math.radians(0.1), "u": 0.01, "v": 0.01, "r": math.radians(0.05),
}  # fmt: skip
_DT, _APPROACH, _SECONDS = 0.2, 10.0, 120.0  # sample, approach and longest manoeuvre [s]; chosen
_SPEED = 1.5  # m/s of the ferry's approach; chosen
_MANOEUVRES = ("zigzag:10/10", "zigzag:20/20", "turning-circle:35")
# seconds for which orders of a kick are held; chosen
_HOLD = 12.0
_DEGREE = math.radians(1.0)
# kicks: share of the rate ahead at the mean, difference over it, mean rudder and difference [deg]; chosen
_KICKS = (
    (0.5, 0.0, 0.0, 0.0), (0.0, 2.0, 0.0, 0.0), (0.5, 0.6, 10.0, 0.0), (0.0, -2.0, 0.0, 0.0), (0.6, 0.0, 0.0, 30.0),
    (0.6, -0.8, -15.0, -20.0), (-0.4, 0.0, 0.0, 0.0), (0.7, 0.3, 20.0, 15.0),
)  # fmt: skip


def twin_screw_ship() -> Model:
    """Return the model of a ferry with two screws and rudders: coefficients by formulas, flow at the rudders chosen."""
    form = HullForm.from_ship(Ship("ferry", _FERRY))
    aspect = _FERRY["H_R"] ** 2 / _FERRY["A_R"]
    estimates = (
        yoshimura(form), added_mass(form), interaction_coefficients(form, aspect), propulsion(form, *_PROPELLER),
        displacement(form, _FERRY["rho"]),
    )  # fmt: skip
    values = {name: value for estimate in estimates for name, value in estimate.values.items()}
    values |= twin_screw_formulas(form.C_b, form.B, form.d, _FERRY["D_P"])
    # flow straightening of the starboard side either way; wake that changes with drift; chosen
    values |= {"gamma_R_plus": 0.45, "gamma_R_minus": 0.30, "C_1": 2.0, "C_2_plus": 1.2, "C_2_minus": 1.05}
    ferry = {name: value for name, value in _FERRY.items() if name not in values}
    model = mmg_twin()
    parameters = {name: value for name, value in {**values, **ferry}.items() if name in model.parameters}
    return model.with_values(parameters, source="formulas; chosen")


# m/s of the jets and of the craft's approach: some 10 kn of the published craft; chosen
_JET, _CRAFT_SPEED = 9.0, 5.0
# kicks: share of the jet's speed at the mean, difference over it, nozzles' mean and difference [deg], mean share of the
# buckets and its difference; chosen
_JET_KICKS = (
    (0.6, 0.0, 0.0, 0.0, 0.0, 0.0), (0.8, 0.4, 0.0, 0.0, 0.0, 0.0), (0.8, -0.4, 10.0, 0.0, 0.0, 0.0),
    (0.9, 0.0, -20.0, 0.0, 0.0, 0.0), (0.7, 0.0, 0.0, 30.0, 0.5, 1.0), (0.7, 0.3, 20.0, -15.0, 0.2, 0.0),
    (0.6, 0.0, 0.0, 0.0, 0.9, 0.0), (0.7, 0.0, -10.0, 0.0, 0.5, -1.0), (1.0, 0.0, 15.0, 0.0, 0.0, 0.0),
)  # fmt: skip
# m, rad, m/s, rad/s: standard deviations of a craft's sensors with differential positions; chosen
_UNDER_WAY = {
    "x0": 0.1, "y0": 0.1, "psi": math.radians(0.2), "u": 0.03, "v": 0.03, "r": math.radians(0.1),
}  # fmt: skip


def twin_jet_craft() -> Model:
    """Return the published waterjet craft with two nozzles and buckets; what a turned jet sends ahead is free too."""
    model = waterjet_twin()
    return model.with_parameters(model.parameters.freed("c_b"))


DEPTHS = (0.0, 1.5)
"""Depths over draught of the two sets of trials, 0: deep; chosen."""
# shares of the published change that are true, 1; chosen
_TRUE_SHARES = {"Y_v": 1.3, "Y_r": 0.8, "N_v": 1.2, "N_r": 0.9, "R_0": 1.1}
# speed of the tanker's approach and rate over it [m/s, 1/m]; as of its trials in deep water
_TANKER_SPEED, _TANKER_RATE = 1.18, 10.4 / 1.18


def shallow_water_ship() -> Model:
    """Return the 7 m model of KVLCC2; the shares of the change of its linear derivatives are chosen, and free."""
    shares = {share_name(name): value for name, value in _TRUE_SHARES.items()}
    model = kvlcc2_l7().applied_to(mmg_shallow()).with_values(shares)
    return model.with_parameters(model.parameters.freed(*shares))


@dataclass(frozen=True)
class KnownTrials:
    """A ship that is known, runs without noise, and the standard deviations of its instruments, SI."""

    model: Model
    runs: Sequence[Record]
    noise: Mapping[str, float]

    @property
    def length(self) -> float:
        """Length between perpendiculars [m]."""
        return self.model.parameters["L"].value

    def noisy(self, rng: np.random.Generator) -> list[Record]:
        """Return what instruments record of the runs."""
        return [self._noisy(run, rng) for run in self.runs]

    def _noisy(self, run: Record, rng: np.random.Generator) -> Record:
        channels = dict(run.channels)
        for name, spread in self.noise.items():
            channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
        return replace(run, channels=channels)


def twin_screw_trials(model: Model | None = None) -> KnownTrials:
    """Return manoeuvres of the ferry and a run of kicks: shafts against each other, rudders apart, astern."""
    model = model or twin_screw_ship()
    n = balancing_input(model, held_inputs(model, {"n": 1.0}, "delta"), "n", _SPEED)
    runs = [_steered(model, text, _SPEED, {"n": n}) for text in _MANOEUVRES]
    units = {"n": n, "n_difference": n, "delta": _DEGREE, "delta_difference": _DEGREE}
    return KnownTrials(model, [*runs, _kicks(model, units, _KICKS, 0.5 * _SPEED)], _IN_A_TANK)


def twin_jet_trials(model: Model | None = None) -> KnownTrials:
    """Return manoeuvres of the waterjet craft and a run of kicks: jets against each other, nozzles apart, buckets."""
    model = model or twin_jet_craft()
    runs = [_steered(model, text, _CRAFT_SPEED, {"v_j": _JET}) for text in _MANOEUVRES]
    units = {
        "v_j": _JET, "v_j_difference": _JET, "delta": _DEGREE, "delta_difference": _DEGREE, "bucket": 1.0,
        "bucket_difference": 1.0,
    }  # fmt: skip
    return KnownTrials(model, [*runs, _kicks(model, units, _JET_KICKS, 0.5 * _CRAFT_SPEED)], _UNDER_WAY)


def _kicks(model: Model, units: Mapping[str, float], kicks: Sequence[Sequence[float]], speed: float) -> Record:
    """Orders to both sides, each set held for some seconds; units: of the columns of the kicks, SI."""
    time = np.arange(0.0, _HOLD * len(kicks), _DT)
    place = np.minimum((time / _HOLD).astype(int), len(kicks) - 1)
    inputs = dict(zip(units, np.array(kicks)[place].T * np.array([*units.values()])[:, None], strict=True))
    start = dict.fromkeys(model.states, 0.0) | {"u": speed}
    return _kept(replay(model, Record.from_arrays("kicks", time, inputs), start), tuple(inputs))


def shallow_water_trials(model: Model | None = None, depths: Sequence[float] = DEPTHS) -> KnownTrials:
    """Return the same manoeuvres of the tanker at each depth over draught; 0: deep."""
    model = model or shallow_water_ship()
    draught, n = model.parameters["d"].value, _TANKER_RATE * _TANKER_SPEED
    runs = [
        replace(_steered(model, text, _TANKER_SPEED, {"n": n, "depth": ratio * draught}), name=f"{text} at {ratio:g} d")
        for ratio in depths
        for text in _MANOEUVRES
    ]
    return KnownTrials(model, runs, _IN_A_TANK)


def _steered(model: Model, text: str, speed: float, inputs: Mapping[str, float]) -> Record:
    run = manoeuvre(model, programme(text), dt=_DT, duration=_SECONDS, approach=_APPROACH, speed=speed, inputs=inputs)
    return _kept(run, tuple(dict.fromkeys((*inputs, *(n for n in model.input_names if n in run)))))


def _kept(run: Record, inputs: Sequence[str]) -> Record:
    return replace(run, channels={name: run.channel(name) for name in (*_IN_A_TANK, *inputs)})
