"""The tables `[controller]` and `[actuator]` of a loop file into a loop on its plant; sentences begin with the key."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from seatrial.control.loopfile.blocks import block, blocks
from seatrial.control.loopfile.plant import LoopPlant
from seatrial.control.loopfile.quantities import positive_value
from seatrial.control.loopfile.schema import BlockTable, ControllerTable, GainTable
from seatrial.core.values import InputError, Parameter, Parameters, spelling_hint
from seatrial.physics.loops import Block, Term, TransferLoop
from seatrial.physics.loops.autopilot import heading_loop, pitch_loop, speed_loop
from seatrial.physics.loops.structures import SERVO, Preamplifier, fin_loop

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
            made = fin_loop(Preamplifier[table.preamplifier.upper()], K_q=table.K_q)
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
    given = None if table.derivative_filter is None else positive_value(
        table.derivative_filter, "s", "controller.derivative_filter"
    )  # fmt: skip
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
    return _parallel_loop(plant, tuple(Term(part, _part(part, given)) for part in parts), table.gains, ())


def _shortest(table: ControllerTable) -> float:
    """Return the shortest derivative filter [s] that does not ring by Tustin's rule: half the sample time declared."""
    return 0.0 if table.sample_s is None else 0.5 * positive_value(table.sample_s, "s", "controller.sample_s")


def _part(name: str, tau: float | None) -> Block:
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
