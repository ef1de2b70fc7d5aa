"""The tables `[controller]` and `[actuator]` of a loop file into a loop on its plant; sentences begin with the key."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from seatrial.control.loopfile.amounts import positive
from seatrial.control.loopfile.blocks import block, blocks
from seatrial.control.loopfile.plant import Plant
from seatrial.control.loopfile.schema import BlockTable, ControllerTable, GainTable
from seatrial.core.values import InputError, Parameter, Parameters, nearest
from seatrial.physics.loops import Block, Term, TransferLoop
from seatrial.physics.loops.autopilot import heading_loop, pitch_loop, speed_loop
from seatrial.physics.loops.fin import SERVO, Preamplifier, fin_loop

PID = ("KP", "KI", "KD")
MEANINGS = {"KP": "proportional gain", "KI": "gain of the integral", "KD": "gain of the filtered derivative"}


def loop_asked(table: ControllerTable, servo: Sequence[BlockTable], plant: Plant, name: str) -> TransferLoop:
    """The loop that the tables describe; the published one brings its own servo where none is given.

    Raises:
        InputError: an improper block, an unknown gain, one without bounds, all gains fixed.
    """
    own = blocks(servo, "actuator.servo")
    match table.kind:
        case "yu2014":
            if plant.output != "phi":
                raise InputError(f"controller.kind: 'yu2014' is a fin loop, not one on '{plant.output}'; write 'pid'")
            made = fin_loop(Preamplifier[table.preamplifier.upper()], K_q=table.K_q)
            made = replace(made, servo=own or (SERVO,))
        case "pid":
            made = replace(_pid(table, plant), servo=own)
        case "blocks":
            made = _in_blocks(table, plant, own)
    if table.kind != "blocks":
        made = replace(made, gains=gains_of(table.gains, made.gains))
    return replace(
        made,
        name=name,
        sensor=(*made.sensor, *blocks(table.sensor, "controller.sensor")),
        filters=(*made.filters, *blocks(table.filters, "controller.filters")),
        plant=plant.response,
        disturbance=plant.disturbance,
        output=plant.output,
        actuator=plant.actuator,
        disturbed_by=plant.disturbed_by,
    )


def gains_of(tables: Mapping[str, GainTable], known: Parameters) -> Parameters:
    """The known gains with what the file says instead.

    Raises:
        InputError: a gain that no term has, one without bounds, or none free.
    """
    for name in tables:
        if name not in known:
            hint = nearest(name, [*known.names])
            raise InputError(f"controller.gains: no part of the controller has a gain '{name}'{hint}")
    made = Parameters(tuple(_gain(gain, tables.get(gain.name, GainTable())) for gain in known))
    if not made.free:
        raise InputError("controller.gains: every gain is fixed, there is nothing to tune; free one")
    return made


def _pid(table: ControllerTable, plant: Plant) -> TransferLoop:
    """KP + KI / s + KD s / (tau s + 1) on the error; bounds from the plant where it is of a kind that gives them."""
    if len(set(table.parts)) != len(table.parts):
        raise InputError("controller.parts names a part twice; name each once")
    parts = table.parts or tuple(name for name in PID if name in table.gains)
    given = None if table.derivative_filter is None else positive(
        table.derivative_filter, "s", "controller.derivative_filter"
    )  # fmt: skip
    parts = parts or (("KP", "KI") if plant.output == "u" else PID)
    if plant.output == "u" and "KD" not in parts:
        return _only(speed_loop(plant.response, plant.disturbance, ()), parts)
    make = heading_loop if plant.output == "psi" else pitch_loop
    try:
        return make(plant.response, plant.disturbance, (), parts=parts, derivative_filter=given)
    except InputError as error:
        if "KD" in parts and given is None:
            raise InputError(f"controller: {error}; give 'derivative_filter' and bounds of the gains") from None
    return _loop(plant, tuple(Term(part, _part(part, given)) for part in parts), table.gains, ())


def _part(name: str, tau: float | None) -> Block:
    match name:
        case "KP":
            return Block("proportional")
        case "KI":
            return Block("integral", (1.0,), (1.0, 0.0))
        case _:
            return Block("derivative", (1.0, 0.0), (tau or 0.0, 1.0))


def _only(loop: TransferLoop, parts: tuple[str, ...]) -> TransferLoop:
    terms = tuple(term for term in loop.terms if term.gain in parts)
    return replace(loop, terms=terms, gains=Parameters(tuple(gain for gain in loop.gains if gain.name in parts)))


def _in_blocks(table: ControllerTable, plant: Plant, servo: tuple[Block, ...]) -> TransferLoop:
    terms = tuple(
        Term(t.gain, block(t, t.name or t.gain, f"controller.terms[{i}]")) for i, t in enumerate(table.terms, start=1)
    )
    names = [term.gain for term in terms]
    if len(set(names)) != len(names):
        raise InputError("controller.terms: two terms have the same gain; give each its own")
    return _loop(plant, terms, table.gains, servo)


def _loop(
    plant: Plant, terms: tuple[Term, ...], gains: Mapping[str, GainTable], servo: tuple[Block, ...]
) -> TransferLoop:
    bare = Parameters(tuple(Parameter(t.gain, meaning=MEANINGS.get(t.gain, ""), free=True) for t in terms))
    return TransferLoop("loop", (), terms, (), servo, plant.response, plant.disturbance, gains_of(gains, bare))


def _gain(known: Parameter, table: GainTable) -> Parameter:
    """What the file says of a gain; what it leaves open stays as known, a value without any lies in the middle."""
    where = f"controller.gains.{known.name}"
    if table.fixed and table.value is not None:
        return Parameter(known.name, table.value, known.unit, source="loop file", meaning=known.meaning)
    lower = known.lower if table.lower is None else table.lower
    upper = known.upper if table.upper is None else table.upper
    if not abs(lower) + abs(upper) < float("inf"):
        raise InputError(
            f"{where}: the gain has no bounds to be tuned in; give lower and upper, or its value with fixed = true"
        )
    if not lower < upper:
        raise InputError(f"{where}: lower = {lower:g} is not below upper = {upper:g}; give the smaller first")
    if table.value is not None and not lower <= table.value <= upper:
        raise InputError(f"{where}: value = {table.value:g} lies outside its bounds {lower:g} to {upper:g}; move one")
    is_known = known.value == known.value
    start = min(max(known.value, lower), upper) if is_known else 0.5 * (lower + upper)
    value = start if table.value is None else table.value
    source = known.source if is_known and value == known.value else "loop file"
    return replace(known, value=value, lower=lower, upper=upper, free=True, source=source)
