"""The identified craft with thrusters in its users' terms: thrust curves, what it does at full command, matrices."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import IntervalBasis
from seatrial.core.results.coefficients import STORED_LEVEL, two_sided_quantile
from seatrial.core.results.ship_motions import (
    CommandCurve,
    CompassCurve,
    CraftMeasure,
    FossenMatrix,
    QuadrantMap,
    ThrusterCraft,
)
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.information.extrapolation import extrapolation, thruster_conditions
from seatrial.estimation.predict.draws import measure_intervals, perturbed_models
from seatrial.physics.manoeuvres import measures
from seatrial.physics.models.thrust_orders import inertia_matrix, thrust_configuration
from seatrial.physics.models.thruster_layout import AngleInput, Thruster, ThrusterLayout, layout_of
from seatrial.physics.simulate.steer import RUDDER_RATE, rudder_rate
from seatrial.physics.simulate.thrust import AHEAD, craft_manoeuvre, craft_programme

CIRCLE = "turning-circle:35"
"""Of a craft that is steered by an angle, with full command ahead; 35 deg as of a rudder (IMO MSC.137(76)); chosen."""
_PROGRAMMES: Mapping[str, Mapping[str, str]] = {
    "straight:100": {"top_speed": "steady_speed", "surge_time_constant_s": "time_constant_s"},
    "spin:100": {
        "yaw_rate_deg_s": "steady_yaw_rate_deg_s", "time_360_s": "time_360_s", "yaw_time_constant_s": "time_constant_s",
    },
    CIRCLE: {
        "circle_yaw_rate_deg_s": "steady_yaw_rate_deg_s", "tactical_diameter_L": "tactical_diameter_L",
        "time_90_s": "time_90_s",
    },
    "stop:100": {"stopping_distance_m": "stopping_distance_m", "stopping_time_s": "stopping_time_s"},
}  # fmt: skip
"""Programmes that are simulated -> name of a measure here -> among those of the programme."""
_SHARES, _BINS, _HEADINGS = 41, 20, 36
"""Points of a thrust curve, bins of commands, points and bins of a compass curve (every 10 deg); chosen."""
_CELLS, _FASTEST_PERCENTILE = 12, 99.5  # of a quadrant map, to each side; per cent of its samples; chosen
_SPEED_PERCENTILE = 95.0  # of the training runs' speeds ahead: that of the second thrust curve; chosen
# coefficient -> matrix, row, column: the terms of docs/thrusters.md as D(nu) has them
_DAMPING: Mapping[str, tuple[str, int, int]] = {
    "X_u": ("D", 0, 0), "Y_v": ("D", 1, 1), "Y_r": ("D", 1, 2), "N_u": ("D", 2, 0), "N_v": ("D", 2, 1),
    "N_r": ("D", 2, 2), "X_uu": ("D_u", 0, 0), "Y_uv": ("D_u", 1, 1), "N_uu": ("D_u", 2, 0), "N_ur": ("D_u", 2, 2),
    "Y_vv": ("D_v", 1, 1), "N_rr": ("D_r", 2, 2),
}  # fmt: skip
_MEANINGS = {
    "D": "linear damping", "D_u": "damping with |u|", "D_v": "damping with |v|", "D_r": "damping with |r|",
}  # fmt: skip
_NO_MATRIX = ("Y_ur", "N_uv", "N_fin", "D_c")  # terms with the sign of u, and the strips of cross-flow


def thruster_craft(
    model: Model, records: Sequence[Record], basis: IntervalBasis, length: float, held_out: Sequence[Record] = ()
) -> ThrusterCraft | None:
    """Return what follows from the coefficients of a craft with thrusters; None for any other model.

    Args:
        model: at the estimate; records: the training runs.
        basis: covariance of the free coefficients, degrees of freedom, envelope of the training runs.
        length: of the craft [m]; held_out: runs that were not fitted.
    """
    if not model.has_thrusters:
        return None
    layout = layout_of(model)
    matrices = (_inertia(model), *_damping(model), _configuration(model, layout))
    return ThrusterCraft(
        "N" if layout.has_bollard else "N/kg",
        craft_measures(model, basis, length),
        tuple(_curve(model, layout, leader, records, basis) for leader in layout.leaders),
        matrices,
        tuple(t.name for t in layout.thrusters),
        _quadrants(model.equations.layout, records, held_out),
        tuple(n for n in _NO_MATRIX if n in model.parameters and model.parameters[n].value != 0.0),
        _compass(model, records, basis),
    )


def craft_measures(model: Model, basis: IntervalBasis, length: float) -> dict[str, CraftMeasure]:
    """Return what the craft does at full command: speed, turn and stop, with 95 % intervals; SI, turn rate in deg/s.

    A programme through which it cannot be simulated, or not by its thrusters, has no measure.
    """
    found: dict[str, CraftMeasure] = {}
    layout = layout_of(model)
    rate = rudder_rate(1.0, basis.training_envelope.get(RUDDER_RATE)).value
    for text, names in _PROGRAMMES.items():
        try:
            orders = craft_programme(layout, text)
            full = {AHEAD: 1.0} if text == CIRCLE else {}
            steer = partial(craft_manoeuvre, orders=orders, inputs=full, slew_rate=rate)
            run = steer(model)
            values, intervals = measures(run, length), measure_intervals(model, basis, steer, length)
        except InputError:
            continue
        reached = extrapolation(run, basis.training_envelope, model.equations.layout)
        index = None if reached is None else reached.index
        for name, source in names.items():
            if source in values:
                lower, upper = intervals.get(source) or (None, None)
                found[name] = CraftMeasure(values[source], lower, upper, text, index)
    return found


def _curve(
    model: Model, layout: ThrusterLayout, leader: Thruster, records: Sequence[Record], basis: IntervalBasis
) -> CommandCurve:
    alike = [t for t in layout.thrusters if layout.leader(t) is leader]
    share = np.linspace(-1.0, 1.0, _SHARES)
    ahead = np.concatenate([r["u"][r["u"] > 0.0] for r in records if "u" in r] or [np.zeros(0)])
    speed = float(np.percentile(ahead, _SPEED_PERCENTILE)) if len(ahead) else 0.0
    still, half = _with_band(model, basis, lambda m: _thrust(m, leader, share, 0.0))
    orders = [(r[t.command.channel] - t.command.zero) / t.command.span for r in records for t in alike]
    counts, edges = np.histogram(np.clip(np.concatenate(orders), -1.0, 1.0), _BINS, (-1.0, 1.0))
    return CommandCurve(
        tuple(t.name for t in alike), _floats(share), _floats(still), _floats(still - half), _floats(still + half),
        speed, _floats(_thrust(model, leader, share, speed)), _floats(edges), _floats(counts / max(counts.sum(), 1)),
    )  # fmt: skip


def _thrust(model: Model, thruster: Thruster, share: Array, speed: float) -> Array:
    """Thrust at shares of full command, the craft moving along the thruster at `speed` [m/s]."""
    angle = 0.0 if isinstance(thruster.angle, AngleInput) else thruster.angle
    states, inputs = np.zeros((len(share), len(model.states))), np.zeros((len(share), len(model.input_names)))
    states[:, model.states.index("u")] = speed * math.cos(angle)
    states[:, model.states.index("v")] = speed * math.sin(angle)
    lagging = f"c_{thruster.name}"
    if lagging in model.states:
        states[:, model.states.index(lagging)] = share
    inputs[:, model.input_names.index(thruster.command.channel)] = thruster.command.zero + thruster.command.span * share
    if "voltage" in model.input_names:
        inputs[:, model.input_names.index("voltage")] = model.parameters["V_0"].value
    return model.forces(states, inputs)[f"T_{thruster.name}"].copy()


def _with_band(model: Model, basis: IntervalBasis, curve: Callable[[Model], Array]) -> tuple[Array, Array]:
    """A curve of the estimate and the half width of its 95 % band, to first order, (n,) each."""
    steps = [0.5 * (curve(up) - curve(down)) for up, down in perturbed_models(model, basis)]
    variance = np.sum(np.square(steps), axis=0) if steps else 0.0
    centre = curve(model)
    return centre, two_sided_quantile(STORED_LEVEL, basis.degrees_of_freedom) * np.sqrt(variance + 0.0 * centre)


def _quadrants(layout: str, records: Sequence[Record], held_out: Sequence[Record]) -> tuple[QuadrantMap, ...]:
    """Command over speed of each thruster, training runs and runs held out in the same cells."""
    trained, other = thruster_conditions(layout, records), thruster_conditions(layout, held_out)
    maps = []
    for name, conditions in trained.items():
        both = [conditions, *([other[name]] if name in other else [])]
        reach = max(float(np.percentile(np.abs(c.speed), _FASTEST_PERCENTILE)) for c in both) or 1.0
        edges = np.linspace(-1.0, 1.0, _CELLS + 1), np.linspace(-reach, reach, _CELLS + 1)
        shares = [
            np.histogram2d(np.clip(c.order, -1.0, 1.0), np.clip(c.speed, -reach, reach), edges)[0] / len(c.order)
            for c in both
        ]
        rows = [tuple(_floats(row) for row in share) for share in shares]
        maps.append(QuadrantMap(name, _floats(edges[0]), _floats(edges[1]), rows[0], rows[1] if len(rows) > 1 else ()))
    return tuple(maps)


def _compass(model: Model, records: Sequence[Record], basis: IntervalBasis) -> CompassCurve | None:
    if "compass_A" not in model.parameters:
        return None
    heading = np.linspace(0.0, 2.0 * np.pi, _HEADINGS + 1)
    terms = {"compass_A": np.ones_like(heading), "compass_B": np.sin(heading), "compass_C": np.cos(heading)}

    def deviation(craft: Model) -> Array:
        return np.sum([craft.parameters[n].value * x for n, x in terms.items() if n in craft.parameters], axis=0)

    centre, half = _with_band(model, basis, deviation)
    shown = np.concatenate([r["psi"][np.isfinite(r["psi"])] for r in records if "psi" in r] or [np.zeros(0)])
    counts, _ = np.histogram(np.mod(shown, 2.0 * np.pi), _HEADINGS, (0.0, 2.0 * np.pi))
    return CompassCurve(
        _floats(heading), _floats(centre), _floats(centre - half), _floats(centre + half),
        _floats(counts / max(counts.sum(), 1)),
    )  # fmt: skip


def _inertia(model: Model) -> FossenMatrix:
    """Mass and added mass (Fossen 2021, eqs. (6.14) and (6.40), surge, sway and yaw)."""
    units = tuple(tuple(_inertia_unit(i, j) for j in range(3)) for i in range(3))
    values = tuple(_floats(row) for row in inertia_matrix(model))
    return FossenMatrix("M", "mass and added mass", values, units)


def _inertia_unit(row: int, column: int) -> str:
    return ("kg", "kg m", "kg m^2")[(row == 2) + (column == 2)]


def _damping(model: Model) -> list[FossenMatrix]:
    """D and its parts with |u|, |v| and |r|, as far as they are not zero; the forces are minus these times nu."""
    parts = {name: np.zeros((3, 3)) for name in _MEANINGS}
    for coefficient, (name, row, column) in _DAMPING.items():
        parts[name][row, column] = 0.0 - model.parameters.value_of(coefficient, 0.0)  # not -0
    return [
        FossenMatrix(name, _MEANINGS[name], tuple(_floats(row) for row in part), _damping_units(name))
        for name, part in parts.items()
        if name == "D" or np.any(part)
    ]


def _damping_units(name: str) -> tuple[tuple[str, ...], ...]:
    """Force or moment over (u, v, r), for D_u and D_v over m/s once more, for D_r over rad/s."""
    suffix = {"D": ("kg/s", "kg m/s", "kg m^2/s"), "D_u": ("kg/m", "kg", "kg m"), "D_v": ("kg/m", "kg", "kg m"),
              "D_r": ("kg", "kg m", "kg m^2")}[name]  # fmt: skip
    return tuple(tuple(suffix[(i == 2) + (j == 2)] for j in range(3)) for i in range(3))


def _configuration(model: Model, layout: ThrusterLayout) -> FossenMatrix:
    """B: rows of (cos a, sin a, x sin a - y cos a), the side force of the wash with them (Fossen 2021, section 9.2)."""
    angles = [0.0 if isinstance(t.angle, AngleInput) else t.angle for t in layout.thrusters]
    X, Y, N = thrust_configuration(model, layout.thrusters, angles)
    units = tuple(tuple(unit for _ in layout.thrusters) for unit in ("1", "1", "m"))
    azimuth = any(isinstance(t.angle, AngleInput) for t in layout.thrusters)
    meaning = "forces over thrusts" + (", azimuth thrusters ahead" if azimuth else "")
    return FossenMatrix("B", meaning, (_floats(X), _floats(Y), _floats(N)), units)


def _floats(values: Array) -> tuple[float, ...]:
    return tuple(float(v) for v in values)
