"""The tables `[controller]`, `[actuator]` and of objectives of a loop file into a loop on its plant."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.control.loopfile.plant import LoopPlant, block, blocks
from seatrial.control.loopfile.schema import (
    BlockTable,
    ControllerTable,
    ExtendedStructureTable,
    GainTable,
    ObjectiveTable,
    PassTable,
    positive_value,
    symbol_unit,
)
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import NOTATION, InputError, Parameter, Parameters, spelling_hint
from seatrial.physics.loops import Block, LoopSignal, Objective, Term, TransferLoop
from seatrial.physics.loops.autopilot import heading_loop, pitch_loop, speed_loop
from seatrial.physics.loops.objective import (
    motion_interruptions,
    motion_sickness,
    motion_sickness_at,
    motion_sickness_dose,
    squared_deviation,
    variance,
    vertical_acceleration,
)
from seatrial.physics.loops.structures import (
    ADDED_GAINS,
    FREQUENCIES_AND_DAMPINGS,
    PUBLISHED_GAINS,
    ROLL,
    SERVO,
    Preamplifier,
    band_pass,
    fin_loop,
    five_gain_loop,
    low_pass,
    notch,
    with_filters,
    with_terms,
)

# Controllers with more structure on the same plant: a loop with band-pass and low-pass terms or a notch added.

_STRUCTURE_KINDS = ("band-pass", "low-pass")
_NOTCH_DEFAULTS = 0.5, 0.1  # damping ratio and depth of a notch, as in `NotchTable`; chosen
_ROUNDING = 1e-9  # imaginary part over size of a pole, below which it does not swing


def extended_structure(
    loop: TransferLoop, table: ExtendedStructureTable, where: str, wave_frequency: float | None = None
) -> TransferLoop:
    """Return the loop with the filters of the table; band-pass and low-pass have gains of their own, KB and KL.

    Where the file does not set them they stand at the multiples of the plant's own frequency that were found for the
    published fins; a notch at the frequency [rad/s] at which waves move a ship that does not swing by itself. Without
    bounds the new gains may lie within the largest bound of the loop's own, to either side.
    """
    made = _with_terms(loop, table, where)
    if "notch" in table.add:
        made = with_filters(made, _notch(loop, table, where, wave_frequency))
    return replace(made, name=table.name or f"{loop.name} with {' and '.join(table.add)}")


def _with_terms(loop: TransferLoop, table: ExtendedStructureTable, where: str) -> TransferLoop:
    shapes = zip(
        ADDED_GAINS, _STRUCTURE_KINDS, (table.band_pass, table.low_pass), FREQUENCIES_AND_DAMPINGS, strict=True
    )
    made = {
        gain: _part(loop, kind, shape, default, where) for gain, kind, shape, default in shapes if kind in table.add
    }
    if not made:
        return loop
    reach = _reach(loop)
    is_published = loop.gains.names == tuple(PUBLISHED_GAINS) and len(made) == len(ADDED_GAINS)
    try:
        if is_published:
            full = five_gain_loop(loop, *made.values())
        else:
            gains = tuple(
                Parameter(name, 0.0, "1", -1.0, 1.0, free=True, source="loop file", meaning=f"gain of the {block.name}")
                for name, block in made.items()
            )
            full = with_terms(loop, *(Term(name, block) for name, block in made.items()), gains=gains)
    except InputError as error:
        raise InputError(f"{where}.add: {error}") from None
    gains = full.gains
    for name in made:
        gains = gains.bounded(name, -reach, reach)
    return replace(
        full, gains=_clipped_to_bounds(gains.with_values({p.name: p.value for p in loop.gains if not p.free}))
    )


def _part(loop: TransferLoop, kind: str, shape: PassTable | None, default: tuple[float, float], where: str) -> Block:
    make = {"band-pass": band_pass, "low-pass": low_pass}[kind]
    if shape is None:
        own = abs(ROLL.poles[0])
        return make(default[0] / own * _natural_frequency(loop, f"{where}.{kind.replace('-', '_')}"), default[1])
    return make(shape.omega, shape.damping)


def _notch(loop: TransferLoop, table: ExtendedStructureTable, where: str, wave_frequency: float | None) -> Block:
    if table.notch is None and wave_frequency is not None:
        return notch(wave_frequency, *_NOTCH_DEFAULTS)
    if table.notch is None:
        return notch(_natural_frequency(loop, f"{where}.notch"), *_NOTCH_DEFAULTS)
    return notch(table.notch.omega, table.notch.damping, table.notch.depth)


def _clipped_to_bounds(gains: Parameters) -> Parameters:
    """Return values moved into their bounds."""
    return gains.with_values({p.name: min(max(p.value, p.lower), p.upper) for p in gains.free})


def _reach(loop: TransferLoop) -> float:
    """Return the largest bound of any free gain of a loop, to either side: that of gains that are added."""
    return max(max(abs(p.lower), abs(p.upper)) for p in loop.gains.free)


def _natural_frequency(loop: TransferLoop, where: str) -> float:
    """Return the frequency of the least damped pair of poles of the disturbance's block [rad/s]."""
    poles = loop.disturbance.poles
    swinging = poles[poles.imag > _ROUNDING * np.abs(poles)]
    if not swinging.size:
        raise InputError(f"{where}: nothing swings by itself that could set its frequency; give omega and damping")
    return float(np.abs(swinging[np.argmin(-swinging.real / np.abs(swinging))]))


# The tables `[controller]` and `[actuator]` of a loop file into a loop on its plant; sentences begin with the key.

PID = ("KP", "KI", "KD")
MEANINGS = {"KP": "proportional gain", "KI": "gain of the integral", "KD": "gain of the filtered derivative"}


def loop_from_tables(
    table: ControllerTable, servo: Sequence[BlockTable], plant: LoopPlant, name: str, dead_time: float
) -> TransferLoop:
    """Return the loop that the tables describe; the published one brings its own servo where none is given.

    dead_time: of the actuator [s].
    """
    own = blocks(servo, "actuator.servo")
    match table.kind:
        case "yu2014":
            if plant.output != "phi":
                raise InputError(f"controller.kind: 'yu2014' is a fin loop, not one on '{plant.output}'; write 'pid'")
            made = fin_loop(Preamplifier[table.preamplifier.upper()])
            made = replace(made, servo=own or (SERVO,))
        case "pid":
            made = replace(_pid_loop(table, plant, dead_time), servo=own)
        case "blocks":
            made = _loop_of_blocks(table, plant, own)
    if table.kind != "blocks":
        made = replace(made, gains=gains_from_tables(table.gains, made.gains))
    return replace(
        made,
        name=name,
        sensor=(*made.sensor, *blocks(table.sensor, "controller.sensor")),
        filters=(*made.filters, *blocks(table.filters, "controller.filters")),
        plant=plant.response,
        disturbance=plant.disturbance,
        output=plant.output,
        actuator=plant.actuator,
        disturbance_input=plant.disturbed_by,
    )


def gains_from_tables(tables: Mapping[str, GainTable], known_gains: Parameters) -> Parameters:
    """Return the known gains with what the file says instead."""
    for name in tables:
        if name not in known_gains:
            hint = spelling_hint(name, [*known_gains.names])
            raise InputError(f"controller.gains: no part of the controller has a gain '{name}'{hint}")
    made = Parameters(tuple(_gain(gain, tables.get(gain.name, GainTable())) for gain in known_gains))
    if not made.free:
        raise InputError("controller.gains: every gain is fixed, there is nothing to tune; free one")
    return made


def _pid_loop(table: ControllerTable, plant: LoopPlant, dead_time: float) -> TransferLoop:
    """KP + KI / s + KD s / (tau s + 1) on the error; bounds from the plant where it is of a kind that gives them."""
    if len(set(table.parts)) != len(table.parts):
        raise InputError("controller.parts names a part twice; name each once")
    parts = table.parts or tuple(name for name in PID if name in table.gains)
    given = table.derivative_filter
    parts = parts or (("KP", "KI") if plant.output == "u" else PID)
    if plant.output == "u" and "KD" not in parts:
        delay = dead_time + _shortest(table)
        return _with_parts(speed_loop(plant.response, plant.disturbance, (), delay=delay), parts)
    try:
        if plant.output == "psi":
            return heading_loop(
                plant.response, plant.disturbance, (), parts=parts, derivative_filter=given,
                shortest_filter=_shortest(table), delay=dead_time + _shortest(table),
            )  # fmt: skip
        return pitch_loop(
            plant.response, plant.disturbance, (), parts=parts, derivative_filter=given,
            shortest_filter=_shortest(table),
        )  # fmt: skip
    except InputError as error:
        if "KD" in parts and given is None:
            raise InputError(f"controller: {error}; give 'derivative_filter' and bounds of the gains") from None
    return _parallel_loop(plant, tuple(Term(part, _term_block(part, given)) for part in parts), table.gains, ())


def _shortest(table: ControllerTable) -> float:
    """Return the shortest derivative filter [s] that does not ring by Tustin's rule: half the sample time declared."""
    return 0.0 if table.sample_s is None else 0.5 * table.sample_s


def _term_block(name: str, tau: float | None) -> Block:
    match name:
        case "KP":
            return Block("proportional")
        case "KI":
            return Block("integral", (1.0,), (1.0, 0.0))
        case _:
            return Block("derivative", (1.0, 0.0), (tau or 0.0, 1.0))


def _with_parts(loop: TransferLoop, parts: tuple[str, ...]) -> TransferLoop:
    terms = tuple(term for term in loop.terms if term.gain in parts)
    return replace(loop, terms=terms, gains=Parameters(tuple(gain for gain in loop.gains if gain.name in parts)))


def _loop_of_blocks(table: ControllerTable, plant: LoopPlant, servo: tuple[Block, ...]) -> TransferLoop:
    terms = tuple(
        Term(t.gain, block(t, t.name or t.gain, f"controller.terms[{i}]")) for i, t in enumerate(table.terms, start=1)
    )
    names = [term.gain for term in terms]
    if len(set(names)) != len(names):
        raise InputError("controller.terms: two terms have the same gain; give each its own")
    return _parallel_loop(plant, terms, table.gains, servo)


def _parallel_loop(
    plant: LoopPlant, terms: tuple[Term, ...], gains: Mapping[str, GainTable], servo: tuple[Block, ...]
) -> TransferLoop:
    bare = Parameters(tuple(Parameter(t.gain, meaning=MEANINGS.get(t.gain, ""), free=True) for t in terms))
    return TransferLoop("loop", (), terms, (), servo, plant.response, plant.disturbance, gains_from_tables(gains, bare))


def _gain(known_gain: Parameter, table: GainTable) -> Parameter:
    """What the file says of a gain; what it leaves open stays as known, a value without any lies in the middle."""
    where = f"controller.gains.{known_gain.name}"
    if table.fixed and table.value is not None:
        return Parameter(known_gain.name, table.value, known_gain.unit, source="loop file", meaning=known_gain.meaning)
    lower = known_gain.lower if table.lower is None else table.lower
    upper = known_gain.upper if table.upper is None else table.upper
    if not abs(lower) + abs(upper) < float("inf"):
        raise InputError(
            f"{where}: the gain has no bounds to be tuned in; give lower and upper, or its value with fixed = true"
        )
    if not lower < upper:
        raise InputError(f"{where}: lower = {lower:g} is not below upper = {upper:g}; give the smaller first")
    if table.value is not None and not lower <= table.value <= upper:
        raise InputError(f"{where}: value = {table.value:g} lies outside its bounds {lower:g} to {upper:g}; move one")
    is_known = known_gain.value == known_gain.value
    start = min(max(known_gain.value, lower), upper) if is_known else 0.5 * (lower + upper)
    value = start if table.value is None else table.value
    source = known_gain.source if is_known and value == known_gain.value else "loop file"
    return replace(known_gain, value=value, lower=lower, upper=upper, free=True, source=source)


# What is to be made small, by the names a loop file uses, as objectives.

# name -> where the variance is taken, power of the frequency
_VARIANCES = {
    "output": (LoopSignal.OUTPUT, 0),
    "output_rate": (LoopSignal.OUTPUT, 1),
    "output_acceleration": (LoopSignal.OUTPUT, 2),
    "actuator": (LoopSignal.ACTUATOR, 0),
    "actuator_rate": (LoopSignal.ACTUATOR, 1),
}
_DERIVATIVES = ("", "rate of the ", "acceleration of the ")


def objective(table: ObjectiveTable, plant: LoopPlant, constraints: ControllerConstraints, where: str) -> Objective:
    """Return the objective of that name."""
    if table.x is not None:
        return _objective_at_point(table, table.x)
    what = _generic_name(table.name, plant, where)
    if what == "motion_interruptions":
        return motion_interruptions(table.height or 0.0, table.friction)
    if what == "motion_sickness":
        return motion_sickness(table.lever or 0.0)
    if what == "actuator_off_target":
        name = f"{_meaning(plant.actuator)} off its target"
        return squared_deviation(
            name, LoopSignal.ACTUATOR, _target_rms(table, plant, constraints, where) ** 2, one_sided=table.one_sided
        )
    seen, power = _VARIANCES[what]
    symbol = plant.output if seen is LoopSignal.OUTPUT else plant.actuator
    return variance(f"variance of the {_DERIVATIVES[power]}{_meaning(symbol)}", _unit(symbol, power), seen, power)


def objective_places(tables: Sequence[ObjectiveTable]) -> tuple[float, ...]:
    """Return the places [m forward of the origin] that objectives name, each once."""
    return tuple(dict.fromkeys(table.x for table in tables if table.x is not None))


def _objective_at_point(table: ObjectiveTable, x: float) -> Objective:
    match table.name:
        case "vertical_acceleration":
            return vertical_acceleration(x)
        case "motion_sickness":
            return motion_sickness_at(x)
        case _:
            return motion_sickness_dose(x, table.duration)


def _generic_name(name: str, plant: LoopPlant, where: str) -> str:
    """Return the name for any loop: `roll` is the output of a fin stabiliser, `fin` its actuator."""
    on_roll = name.startswith("roll") or name in ("motion_interruptions", "motion_sickness")
    if (on_roll and plant.output != "phi") or (name.startswith("fin") and plant.actuator != "alpha_f"):
        raise InputError(
            f"{where}: '{name}' is a word of roll stabilisers, the loop moves '{plant.output}' by '{plant.actuator}'; "
            "write output or actuator"
        )
    return name.replace("roll", "output", 1) if name.startswith("roll") else name.replace("fin", "actuator", 1)


def _target_rms(table: ObjectiveTable, plant: LoopPlant, constraints: ControllerConstraints, where: str) -> float:
    """Return root mean square aimed at: as given, or that at which the allowed share of amplitudes exceeds the limit.

    exp(-limit^2 / (2 variance)) = share (Rayleigh; Yu et al. 2014, eq. (2), 150.31 deg^2 for 22 deg and 20 %).
    """
    if table.target is not None:
        return positive_value(table.target, symbol_unit(plant.actuator), f"{where}.target")
    if not math.isfinite(constraints.limit):
        raise InputError(f"{where}: there is neither a target nor an [actuator] limit to take it from; add one")
    return constraints.limit / math.sqrt(2.0 * math.log(1.0 / constraints.saturation))


def _meaning(symbol: str) -> str:
    return NOTATION[symbol].meaning if symbol in NOTATION else symbol


def _unit(symbol: str, power: int) -> str:
    unit = symbol_unit(symbol)
    base = f"{unit}^2" if unit.isalpha() else "1" if unit == "1" else f"({unit})^2"
    return base + ("" if power == 0 else f"/s^{2 * power}")
