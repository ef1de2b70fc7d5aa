"""A rolling ship in wind in the form of an open benchmark: training runs, test runs of their kind, test runs beyond it.

The form is that of the simulated ship-motion data set of Baier & Staab 2022 (doi 10.18419/darus-2905) as system
identification uses it: 1 Hz, inputs propeller, rudder and wind, outputs u, v, p, r, phi; windows are predicted from
their inputs alone behind a beginning of 100 s, and judged by the rms error of each output. The records are made here,
by the model of Son & Nomoto 1981 with the container ship S175; regressions see the true wind off the bow.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.assemble import Runs, output_error_problem
from seatrial.estimation.predict.open_loop import open_loop_runs
from seatrial.estimation.predict.window_scores import (
    ARX,
    NARX,
    AutoRegression,
    Features,
    fit_auto_regression,
    linear_features,
    quadratic_features,
)
from seatrial.estimation.predict.windows import Windows
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.models.published import SON_NOMOTO, container_ship, s175
from seatrial.physics.simulate.replay import replay
from seatrial.problems import rolling_ship
from seatrial.problems.problem import BenchmarkProblem, Placement, ProblemDraw
from seatrial.problems.rolling_ship import rolling_container_ship
from seatrial.problems.trial_problem import KnownCraft, craft_draw, free_values, off_centre_box, placed_model

OUTPUTS = ("u", "v", "p", "r", "phi")
INPUTS = ("n", "delta", "wind_speed", "wind_direction")
BEGINNING_S, WINDOW_S = 100.0, 500.0
"""Seconds of a window that a method sees, as the open benchmark has it, and of the whole window; chosen."""
_DT, _SECONDS = 1.0, 1500.0  # s: sample of the data set, length of a run; chosen
# runs of each kind; chosen
_RUNS = {"training": 8, "inside": 4, "outside": 4}
# of orders: shortest and longest time that one is held [s]; rate of the rudder [rad/s]; memory of gusts [s]; chosen
_HOLD_S, _RUDDER_RATE, _GUST_S = (30.0, 120.0), math.radians(2.3), 20.0
# of the anemometer: standard deviations of speed [m/s] and direction [rad]; chosen
_ANEMOMETER = {"wind_speed": 0.5, "wind_direction": math.radians(3.0)}
# areas above water, lever and series of the wind's force of a container ship, deck empty; chosen, of usual size
_ABOVE_WATER = {"A_T": 550.0, "A_L": 2500.0, "h_W": 10.0, "C_X1": -0.7, "C_Y1": -0.8, "C_N2": -0.05}
WIND_TERMS = ("C_X1", "C_Y1", "C_N2", "h_W")
SETTINGS = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)


@dataclass(frozen=True)
class Distribution:
    """What a run is made of: least and largest propeller rate [rpm], rudder [deg], wind speed [m/s]."""

    rpm: tuple[float, float]
    rudder: float
    wind: tuple[float, float]


# rpm, deg and m/s; chosen
ROUTINE = Distribution((60.0, 100.0), 10.0, (3.0, 10.0))
# rpm, deg and m/s; chosen
BEYOND = Distribution((45.0, 110.0), 25.0, (12.0, 18.0))


@dataclass(frozen=True, eq=False)
class WindRecords:
    """Noisy runs to train with, and test runs of the same distribution and of another."""

    training: Sequence[Record]
    inside: Sequence[Record]
    outside: Sequence[Record]


def ship_in_wind() -> Model:
    """Return the true model: S175 with areas above water; its free coefficients and those of the wind are free."""
    model = container_ship().with_values(_ABOVE_WATER)
    return model.with_parameters(model.parameters.freed(*WIND_TERMS))


def wind_records(model: Model, rng: np.random.Generator) -> WindRecords:
    """Return the records of a draw: random orders of propeller and rudder under gusty wind from any side."""
    noise = {name: rolling_container_ship().noise[name] for name in (*OUTPUTS, "psi")} | _ANEMOMETER

    def recorded(kind: str, distribution: Distribution) -> list[Record]:
        clean = [_run(model, f"{kind}_{k + 1}", distribution, rng) for k in range(_RUNS[kind])]
        return [_noisy(run, noise, rng) for run in clean]

    return WindRecords(recorded("training", ROUTINE), recorded("inside", ROUTINE), recorded("outside", BEYOND))


def _run(model: Model, name: str, distribution: Distribution, rng: np.random.Generator) -> Record:
    count = round(_SECONDS / _DT) + 1
    rpm = _orders(count, *distribution.rpm, rng)
    rudder = _slewed(np.radians(_orders(count, -distribution.rudder, distribution.rudder, rng)))
    mean, side = rng.uniform(*distribution.wind), rng.uniform(0.0, 2.0 * np.pi)
    wind = {
        "wind_speed": np.maximum(mean * (1.0 + 0.15 * _gusts(count, rng)), 0.0),  # 0.15: share of gusts; chosen
        "wind_direction": side + np.radians(5.0) * _gusts(count, rng),  # 5 deg: of its gusts; chosen
    }
    inputs = {"n": rpm / 60.0, "delta": rudder} | wind  # 60 s a minute
    planned = Record.from_arrays(name, _DT * np.arange(count, dtype=np.float64), inputs)
    start = dict.fromkeys(model.states, 0.0) | {"u": 7.33 / 70.0 * float(rpm[0])}  # m/s a rpm on a straight course
    run = replay(model, planned, start)
    return replace(run, channels={c: run.channel(c) for c in (*OUTPUTS, "psi", *INPUTS)})


def _orders(count: int, low: float, high: float, rng: np.random.Generator) -> Array:
    """Levels between two values, each held for a random time, (count,)."""
    values: list[float] = []
    while len(values) < count:
        values += [rng.uniform(low, high)] * round(rng.uniform(*_HOLD_S) / _DT)
    return np.array(values[:count])


def _slewed(orders: Array) -> Array:
    """What a rudder follows that moves at its rate, (n,)."""
    angle = np.zeros(len(orders))
    for k in range(1, len(orders)):
        step = _RUDDER_RATE * _DT
        angle[k] = angle[k - 1] + np.clip(orders[k] - angle[k - 1], -step, step)
    return angle


def _gusts(count: int, rng: np.random.Generator) -> Array:
    """A first-order process of variance 1, (count,)."""
    keep, white = math.exp(-_DT / _GUST_S), rng.standard_normal(count)
    values = np.empty(count)
    values[0] = white[0]
    for k in range(1, count):
        values[k] = keep * values[k - 1] + math.sqrt(1.0 - keep**2) * white[k]
    return values


def _noisy(run: Record, noise: Mapping[str, float], rng: np.random.Generator) -> Record:
    channels = dict(run.channels)
    for name, spread in noise.items():
        channels[name] = channels[name].with_values(run[name] + spread * rng.standard_normal(len(run)))
    return replace(run, channels=channels)


# How predictions are judged.


def windows_of(runs: Sequence[Record]) -> Windows:
    """Return the test windows of runs."""
    return Windows.cut(runs, WINDOW_S)


def rms_behind_beginning(windows: Windows, predicted: Sequence[Record]) -> dict[str, float]:
    """Return the rms error of each output over all windows behind their beginning, SI; infinite after a divergence."""
    first = round(BEGINNING_S / windows.dt)
    errors = {}
    for name in OUTPUTS:
        gaps = [p[name][first:] - w[name][first:] for w, p in zip(windows.pieces, predicted, strict=True)]
        mean = float(np.mean(np.square(gaps)))
        errors[name] = math.sqrt(mean) if math.isfinite(mean) else math.inf
    return errors


def normalised(errors: Mapping[str, float], windows: Windows) -> float:
    """Return the rms over the outputs of errors in standard deviations of what the windows show."""
    spread = {name: float(np.std(np.concatenate([w[name] for w in windows.pieces]))) for name in OUTPUTS}
    return math.sqrt(float(np.mean([(errors[name] / spread[name]) ** 2 for name in OUTPUTS])))


def predicted_by(template: OutputError, model: Model, windows: Windows) -> list[Record]:
    """Return windows predicted by a model from their inputs, each from the state that fits its beginning."""
    nothing = np.zeros((len(windows.records), template.unknowns_per_session))
    return [run.record for run in open_loop_runs(template, model, windows, nothing, BEGINNING_S)]


# Rivals: regressions of all outputs, which see the wind off the bow.

Predictor = Callable[[Windows], Sequence[Record]]


def rivals(model: Model, training: Sequence[Record]) -> Mapping[str, Predictor]:
    """Return an ARX and a NARX model of the outputs, trained, by name."""
    records = [_with_wind_off_the_bow(record) for record in training]
    predictors: dict[str, Predictor] = {}
    for name, features in ((ARX, linear_features), (NARX, quadratic_features)):
        regression = fit_auto_regression(model, records, partial(_of_wind_components, features), BEGINNING_S, OUTPUTS)
        assert regression is not None  # the runs hold all outputs
        predictors[name] = partial(_regressed, regression)
    return predictors


def _regressed(regression: AutoRegression, windows: Windows) -> Sequence[Record]:
    relative = replace(windows, records=[_with_wind_off_the_bow(record) for record in windows.records])
    return regression.predict(relative, BEGINNING_S)


def _with_wind_off_the_bow(record: Record) -> Record:
    """The direction of the true wind counted from the measured heading."""
    direction = record.channel("wind_direction")
    return record.with_channel("wind_direction", direction.with_values(direction.values - record["psi"]))


def _of_wind_components(features: Features, velocities: Array, inputs: Array) -> Array:
    """Features of inputs (..., lags, nu) whose last two, speed and direction of the wind, count ahead and abeam."""
    speed, direction = inputs[..., -2], inputs[..., -1]
    wind = np.stack([speed * np.cos(direction), speed * np.sin(direction)], axis=-1)
    return features(velocities, np.concatenate([inputs[..., :-2], wind], axis=-1))


def training_problem(model: Model, records: WindRecords) -> OutputError:
    """Return output error over the training runs, its channels those that are recorded."""
    runs = Runs.one_session_each(list(records.training), s175().ship.length)
    return output_error_problem(model, runs, np.inf, SETTINGS, workers=1)


@dataclass(frozen=True, eq=False)
class OutsideYardstick:
    """Measures coefficients by the windows outside the distribution of the training runs.

    Attributes:
        template: the problem whose free coefficients are judged; narx: normalised error of a NARX model.
    """

    template: OutputError
    windows: Windows
    narx: float
    truth: Array | None = None
    bound: Array | None = None

    @property
    def unit(self) -> str:
        """What an error of 1 is."""
        return "that of a NARX model over windows outside the training distribution, rms over u, v, p, r and phi"

    @property
    def success_limit(self) -> float:
        """Half the error of the NARX model; chosen."""
        return 0.5

    def error(self, values: Array) -> float:
        """Return the normalised error over that of the NARX model; infinite after a divergence."""
        model = self.template.model.with_values(dict(zip(self.template.free, values.tolist(), strict=True)))
        try:
            predicted = predicted_by(self.template, model, self.windows)
        except InputError:
            return math.inf
        return normalised(rms_behind_beginning(self.windows, predicted), self.windows) / self.narx


# half range of the factor by which a draw scales the true coefficients, and half width of their box, 1; chosen
_SCALE, _HALF_WIDTH = 0.1, 0.5
# evaluations, each a simulation of the training runs; chosen
_BUDGET = 1000


def problems() -> tuple[BenchmarkProblem, ...]:
    """Return the problems of the ship: its trials without wind, and this one."""
    title = "container ship with roll in wind, judged outside the training distribution"
    noise = "u, v 0.05 m/s, p 0.02 deg/s, r 0.01 deg/s, phi, psi 0.1 deg, wind 0.5 m/s and 3 deg, white"
    source = f"form: doi 10.18419/darus-2905; ship: {SON_NOMOTO}"
    return (*rolling_ship.problems(), BenchmarkProblem("s175-wind", 1, title, source, noise, _BUDGET, _draw))


def _draw(rng: np.random.Generator, placement: Placement) -> ProblemDraw:
    model = placed_model(ship_in_wind(), placement, _SCALE, rng)
    records = wind_records(model, rng)
    noise = {name: rolling_container_ship().noise[name] for name in (*OUTPUTS, "psi")}
    starts = [{name: float(run[name][0]) for name in model.states if name in run} for run in records.training]
    box = off_centre_box(free_values(model), _HALF_WIDTH, rng)
    craft = KnownCraft(s175().ship, model, list(records.training), noise, starts, SETTINGS)
    draw = craft_draw(craft, box, 0.5 * (box.lower + box.upper))
    windows = windows_of(records.outside)
    narx = normalised(rms_behind_beginning(windows, rivals(model, records.training)[NARX](windows)), windows)
    return replace(draw, yardstick=OutsideYardstick(training_problem(model, records), windows, narx))
