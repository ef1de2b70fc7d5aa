"""The table `[plant]` of a loop file: transfer functions as given, or those of an identified model."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.control.loopfile.schema import (
    BlockTable,
    FinTable,
    HullTable,
    PassTable,
    PlantTable,
    si_value,
    symbol_unit,
)
from seatrial.control.ship import (
    model_at_scale,
    plant_and_disturbance,
    plant_text,
    rate_response,
    steering_input,
    trim_ship,
)
from seatrial.control.task import Effectiveness, Seaway, SlowDisturbance, TrimmedShip
from seatrial.core.equations import Model
from seatrial.core.values import InputError, Ship, spelling_hint
from seatrial.data.folder.model_file import ModelFile, read_model_file
from seatrial.data.trial.amounts import Amount
from seatrial.data.trial.runs import expand_variables
from seatrial.physics.loops import Block, HullFactor, TransferLoop
from seatrial.physics.loops.structures import K_alpha_at, band_pass, high_pass, low_pass, notch
from seatrial.physics.models.thrust_orders import AHEAD, YAW, with_orders
from seatrial.physics.models.thruster_layout import ORDER, layout_of, order_text
from seatrial.physics.simulate.thrust import DEFAULT_AHEAD

# Tables of a loop file into blocks: transfer functions as given, filters by their kind.


def block(table: BlockTable, name: str, where: str) -> Block:
    """Return the block of one table."""
    made = _filter(table)
    if made is not None:
        return replace(made, name=name, source=table.source)
    try:
        return Block(name, table.num or (), table.den or (), table.source)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def blocks(tables: Sequence[BlockTable], where: str) -> tuple[Block, ...]:
    """Return the blocks of a list, numbered where there are several."""
    kind = where.rsplit(".", maxsplit=1)[-1].removesuffix("s")
    return tuple(
        block(table, table.name or (kind if len(tables) == 1 else f"{kind} {i}"), f"{where}[{i}]")
        for i, table in enumerate(tables, start=1)
    )


def block_text(block: Block) -> str:
    """Return a transfer function on one line."""
    return f"({_polynomial_text(block.num)}) / ({_polynomial_text(block.den)})"


def _filter(table: BlockTable) -> Block | None:
    if table.lag is not None:
        return Block("lag", (1.0,), (table.lag, 1.0))
    for kind, create in (("low_pass", low_pass), ("band_pass", band_pass), ("high_pass", high_pass)):
        shape: PassTable | None = getattr(table, kind)
        if shape is not None:
            return create(shape.omega, shape.damping)
    if table.notch is not None:
        return notch(table.notch.omega, table.notch.damping, table.notch.depth)
    return None


def _polynomial_text(coefficients: tuple[float, ...]) -> str:
    parts = []
    for power, c in zip(range(len(coefficients) - 1, -1, -1), coefficients, strict=True):
        if c:
            parts.append(f"{c:.4g}" + ("" if power == 0 else " s" if power == 1 else f" s^{power}"))
    return " + ".join(parts).replace("+ -", "- ")


# The table `[plant]` of a loop file: transfer functions as given, or those of an identified model.

FINS = ("phi", "alpha_f", "alpha_w")
STEERING = ("psi", "delta", "")
_KNOTS = 3600.0 / 1852.0  # kn in 1 m/s: 1 kn is 1852 m an hour (exact)


@dataclass(frozen=True, eq=False)
class LoopPlant:
    """What is controlled, at the speed U [m/s].

    Attributes:
        response: actuator to output; disturbance: what disturbs to output.
        description: where it comes from; trimmed_ship, ship: of a model file, else none.
        craft: model file of a craft with thrusters, by its commands instead of orders; None of any other.
    """

    response: Block
    disturbance: Block
    output: str
    actuator: str
    disturbed_by: str
    U: float
    effectiveness: Effectiveness
    description: str
    trimmed_ship: TrimmedShip | None = None
    ship: Ship | None = None
    craft: ModelFile | None = None


def plant_from_table(
    table: PlantTable, home: Path, own_model: Model | None = None, model_file: Path | ModelFile | None = None
) -> LoopPlant:
    """Return the plant that the table describes.

    Args:
        home: folder of the loop file, from which the model file's path counts.
        model_file: takes the place of `model`.
    """
    if table.model is not None:
        return _plant_of_model(table, model_file or home / expand_variables(table.model), own_model)
    if model_file is not None:
        raise InputError("plant: there is no 'model' that a model file could take the place of; leave --from out")
    if table.roll is not None and table.fin is not None:
        return _plant_of_roll(_responding_block(table.roll, "roll", "plant.roll"), table, table.fin)
    assert table.response is not None and table.output is not None and table.actuator is not None
    response = _responding_block(table.response, "plant", "plant.response")
    return LoopPlant(
        response, response, table.output, table.actuator, table.actuator, _speed(table),
        Effectiveness.CONSTANT,
        f"{table.actuator} to {table.output} as given: {block_text(response)}",
    )  # fmt: skip


def plant_at_speed(
    table: PlantTable,
    plant: LoopPlant,
    U: float,
    home: Path,
    own_model: Model | None,
    model_file: Path | ModelFile | None,
) -> LoopPlant:
    """Return the plant of the table at another speed [m/s]: trimmed there with surge in the model, else by similarity.

    Hydrodynamic forces grow with the square of the speed, so that a course answers a rudder alike in time over U / L:
    P(s) becomes P(s U_0 / U). Of a Nomoto ship K grows with U and T with 1 / U (Fossen 2021, section 7.2).

    Raises:
        InputError: nothing is known of other speeds.
    """
    if U == plant.U:
        return plant
    ship = plant.trimmed_ship
    if ship is not None and "u" in (*ship.model.states, *ship.model.input_names):
        there = table.model_copy(update={"speed": U})
        return plant_from_table(there, home, own_model, model_file)
    if plant.output != "psi" or plant.disturbed_by != plant.actuator:
        raise InputError(
            f"schedule.speeds: how {plant.output} answers {plant.actuator} is known at {plant.U:.4g} m/s alone; give "
            "this speed, or a model with surge"
        )
    response = plant.response.stretched(plant.U / U)
    return replace(
        plant, response=response, disturbance=response, U=U, trimmed_ship=None,
        description=f"{plant.description}, carried to {U:.4g} m/s by similarity",
    )  # fmt: skip


def yaw_acceleration_path(plant: LoopPlant) -> Block:
    """Return the transfer function from a yaw acceleration [rad/s^2] to the heading.

    By the model behind the plant; of a transfer function from the rudder, that over its leading coefficient b: what
    the rudder does first is the yaw acceleration b delta.
    """
    if plant.trimmed_ship is not None:
        return rate_response(plant.trimmed_ship, "r")
    response = plant.response
    if len(response.den) - len(response.num) != 2:
        raise InputError(
            "plant.response: waves act as a yaw acceleration, so that the denominator must be two degrees higher than "
            "the numerator; leave the actuator's lag to actuator.servo"
        )
    return replace(response.scaled(response.den[0] / response.num[0]), name="yaw acceleration to psi")


def hull_factor(table: HullTable | None, ship: Ship | None) -> HullFactor | None:
    """Return the box of the table, or of the ship's own L, B, d; none where neither is known."""
    if table is not None:
        return HullFactor(table.L, table.B, table.T)
    own = {} if ship is None else ship.particulars
    return HullFactor(own["L"], own["B"], own["d"]) if {"L", "B", "d"} <= set(own) else None


def _responding_block(table: BlockTable, name: str, where: str) -> Block:
    """Return a block whose output answers."""
    made = block(table, name, where)
    if not any(made.num):
        raise InputError(f"{where}.num is zero: nothing would move; give its coefficients, highest power first")
    return made


def _speed(table: PlantTable) -> float:
    if table.speed is not None:
        return table.speed
    if table.fin is not None and table.fin.at_speed is not None:
        return table.fin.at_speed
    raise InputError("key 'plant.speed' is missing; add it, such as { value = 18, unit = \"kn\" }")


def _plant_of_roll(roll: Block, table: PlantTable, fin: FinTable) -> LoopPlant:
    U = _speed(table)
    K_alpha, law, words = _fin_effect(fin, fin.K_alpha or 0.0, U)
    return LoopPlant(
        replace(roll.scaled(K_alpha), name="fins to roll"), roll, *FINS, U, law,
        f"roll as given: {block_text(roll)}, {words}",
    )  # fmt: skip


def _fin_effect(table: FinTable, known_K_alpha: float, U: float) -> tuple[float, Effectiveness, str]:
    """Return K_alpha at the speed U from the known one, how it goes with the speed, and both in words."""
    law = Effectiveness(table.law)
    at = U if table.at_speed is None else table.at_speed
    K_alpha = known_K_alpha if law is Effectiveness.CONSTANT else K_alpha_at(U, at, known_K_alpha)
    how = "at any speed" if law is Effectiveness.CONSTANT else "growing with the square of the speed"
    return K_alpha, law, f"fins worth {K_alpha:.4g} rad of wave slope for each radian at {U * _KNOTS:.3g} kn, {how}"


def _plant_of_model(table: PlantTable, source: Path | ModelFile, own_model: Model | None) -> LoopPlant:
    file = source if isinstance(source, ModelFile) else read_model_file(source, own_model)
    path = Path("model.toml") if isinstance(source, ModelFile) else source  # as messages name it
    if table.scale is not None:
        file = model_at_scale(file, table.scale)
    craft = file if file.model.has_thrusters else None
    if craft is not None:
        file = replace(file, model=with_orders(file.model), approach={})
        table = _by_orders(table, file.model)
    output, actuator, disturbance = _signal_names(table, file, path)
    words, law, speed = "", Effectiveness.CONSTANT, None if table.speed is None else _speed(table)
    if table.fin is not None:
        speed = _speed(table)
        K_alpha, law, words = _fin_effect(table.fin, _known_K_alpha(table.fin, file.model, path), speed)
        file = replace(file, model=file.model.with_values({"K_alpha": K_alpha}))
    elif "K_alpha" in file.model.parameters and not file.model.parameters["K_alpha"].value:
        raise InputError(
            f"plant: model '{file.model.name}' of '{path}' rolls and knows no fins; add [plant.fin] with K_alpha, or "
            "name a model that is steered"
        )
    inputs = {name: si_value(value, symbol_unit(name), f"plant.inputs.{name}") for name, value in table.inputs.items()}
    for name in inputs:
        _demand_known(name, file.model.input_names, f"plant.inputs.{name}", file.model, "input")
    ship = trim_ship(file, output=output, actuator=actuator, disturbance=disturbance, speed=speed, inputs=inputs)
    _refuse_without_effect(ship, inputs)
    response, disturbed = plant_and_disturbance(ship, table.amplitude)
    turned = ""
    if craft is not None and actuator == ORDER:
        turned = order_text(layout_of(craft.model))
    about = "" if table.amplitude is None else f"linearised at a roll of {math.degrees(table.amplitude):.3g} deg"
    return LoopPlant(
        response, disturbed, output, actuator, disturbance or actuator,
        _trim_speed(ship, file) if speed is None else speed, law,
        ", ".join(part for part in (plant_text(ship), turned, about, words) if part), ship, file.ship, craft,
    )  # fmt: skip


def _refuse_without_effect(ship: TrimmedShip, inputs: Mapping[str, float]) -> None:
    """Refuse an input that changes no rate of the model about its trim: what it needs is missing."""
    model = ship.model
    rates, without = np.empty(len(model.states)), np.empty(len(model.states))
    model.compiled.rates(0.0, ship.state, ship.inputs, model.parameters.values, rates)
    for name, value in inputs.items():
        changed = ship.inputs.copy()
        # another value of the same size; of a direction another direction
        changed[model.input_names.index(name)] += max(abs(value), 1.0)
        model.compiled.rates(0.0, ship.state, changed, model.parameters.values, without)
        if value and np.array_equal(rates, without):
            raise InputError(
                f"plant.inputs.{name} = {value:g} has no effect in model '{model.name}': it lacks what that acts on; "
                "leave the input out, or give the model the coefficients it needs (of wind the areas)"
            )


def _by_orders(table: PlantTable, ordered: Model) -> PlantTable:
    """The table of a craft with thrusters, with what is steered by which order, and the order ahead about which.

    The heading is steered by the angle of its thrusters where they turn, else by the yaw order.
    """
    output = table.output or "psi"
    actuator = table.actuator or {"psi": steering_input(ordered), "u": AHEAD}.get(output)
    held = {AHEAD: Amount(value=DEFAULT_AHEAD)} if table.speed is None else {}
    return table.model_copy(
        update={"output": output, "actuator": actuator, "inputs": held | {YAW: Amount(value=0.0)} | dict(table.inputs)}
    )


def _signal_names(table: PlantTable, file: ModelFile, path: Path) -> tuple[str, str, str]:
    """Return the output, actuator and disturbance: as said, or those by which a model of its kind is controlled."""
    model, given = file.model, (table.output, table.actuator, table.disturbance)
    for name, known, key, what in zip(
        given,
        (model.observables, model.input_names, model.input_names),
        ("plant.output", "plant.actuator", "plant.disturbance"),
        ("output", "input", "input"),
        strict=True,
    ):
        if name:
            _demand_known(name, known, key, model, what)
    for own in (STEERING, FINS):  # of a ship that turns and rolls, the heading
        has_them = own[0] in model.observables and set(own[1:]) - {""} <= set(model.input_names)
        if has_them and table.output in (None, own[0]) and table.actuator in (None, own[1]):
            return own[0], own[1], own[2] if table.disturbance is None else table.disturbance
    if table.output is None or table.actuator is None:
        raise InputError(
            f"plant: model '{model.name}' of '{path}' is not one that fins or a rudder alone control; give output (one "
            f"of {', '.join(model.observables)}) and actuator (one of {', '.join(model.input_names)})"
        )
    return table.output, table.actuator, table.disturbance or ""


def _demand_known(name: str, names: tuple[str, ...], where: str, model: Model, kind: str) -> None:
    if name not in names:
        raise InputError(f"{where}: '{name}' is no {kind} of model '{model.name}'{spelling_hint(name, [*names])}")


def _known_K_alpha(table: FinTable, model: Model, path: Path) -> float:
    """Return K_alpha of the loop file, or of the model where that was identified."""
    if "K_alpha" not in model.parameters:
        raise InputError(f"plant.fin: model '{model.name}' of '{path}' has no K_alpha; leave the table out")
    own = model.parameters["K_alpha"]
    if table.K_alpha is not None and own.free:
        raise InputError(f"plant.fin: '{path}' has an identified K_alpha; leave K_alpha out")
    if table.K_alpha is None and not own.value:
        raise InputError(f"plant.fin: key 'K_alpha' is missing, and the model of '{path}' knows no fins; add it")
    return own.value if table.K_alpha is None else table.K_alpha


def _trim_speed(ship: TrimmedShip, file: ModelFile) -> float:
    model = file.model
    if model.has_speed:
        return float(ship.state[model.states.index("u")])
    if model.parameters.value_of("U", 0.0) > 0.0:
        return float(model.parameters["U"].value)
    if file.approach.get("u", 0.0) > 0.0:
        return float(file.approach["u"])
    raise InputError("key 'plant.speed' is missing, and the model file does not state the ship's speed; add it")


# Loop files whose numbers are valid but cannot be meant: motions no ship makes, actuators that push the wrong way.

_WILDEST_RMS = math.radians(30.0)  # rad: the highest third of such amplitudes is 60 degrees and more; chosen
# actuator -> output and what a positive one does to it by the conventions of the notation
_POSITIVE_EFFECTS = {
    ("delta", "psi"): "turns the ship to starboard",
    ("alpha_f", "phi"): "rolls the ship to starboard",
}


def refuse_reversed_plant(plant: LoopPlant, where: str) -> None:
    """Refuse a plant whose actuator first moves the output against the convention of its sign.

    The first motion after a step has the sign of the leading coefficients, also where the plant is unstable.
    """
    effect = _POSITIVE_EFFECTS.get((plant.actuator, plant.output))
    first = plant.response.num[0] / plant.response.den[0]
    if effect is None or first > 0.0:
        return
    remedy = (
        f"reverse the signs of {where}.num"
        if plant.trimmed_ship is None
        else f"give {plant.actuator} its sign in [records.channels] of the trial (positive = ...) and identify again"
    )
    raise InputError(
        f"{where}: a positive {plant.actuator} {effect} by convention, here it first does the opposite; {remedy}"
    )


def refuse_reversed_servo(servo: Sequence[Block]) -> None:
    """Refuse a servo that moves the actuator against its order."""
    for i, block in enumerate(servo, start=1):
        if block.gain < 0.0:
            raise InputError(
                f"actuator.servo[{i}] answers an order of 1 with {block.gain:.3g}: the actuator would move against its "
                "order; reverse the signs of its num"
            )


def refuse_wild_motion(disturbances: Sequence[Seaway | SlowDisturbance], loop: TransferLoop, plant: LoopPlant) -> None:
    """Refuse what would move an angle further without control than linear theory, or a ship, allows."""
    if symbol_unit(plant.output) != "rad" or not math.isfinite(loop.disturbance.gain):
        return
    for one in disturbances:
        rms = math.sqrt(one.exposure(loop).response_variance(one.disturbed(loop).disturbance))
        if rms > _WILDEST_RMS:
            raise InputError(
                f"without control {plant.output} would reach {math.degrees(rms):.3g} deg rms ({one.description}), more "
                f"than any ship survives; check height and period of the sea, and the plant: damping ratio "
                f"{_least_damping(loop.disturbance):.2g}, {loop.disturbance.gain:.3g} of the output for a constant 1 "
                "of the disturbance"
            )


def _least_damping(block: Block) -> float:
    poles = block.poles
    return float(np.min(-poles.real / np.abs(poles), initial=1.0))
