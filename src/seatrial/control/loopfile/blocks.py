"""Tables of a loop file into blocks: transfer functions as given, filters by their kind."""

from collections.abc import Sequence
from dataclasses import replace

from seatrial.control.loopfile.quantities import positive_value
from seatrial.control.loopfile.schema import BlockTable, PassTable
from seatrial.core.values import InputError
from seatrial.physics.loops import Block
from seatrial.physics.loops.structures import band_pass, high_pass, low_pass, notch


def block(table: BlockTable, name: str, where: str) -> Block:
    """Return the block of one table."""
    made = _filter(table, where)
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


def _filter(table: BlockTable, where: str) -> Block | None:
    if table.lag is not None:
        return Block("lag", (1.0,), (positive_value(table.lag, "s", f"{where}.lag"), 1.0))
    for kind, create in (("low_pass", low_pass), ("band_pass", band_pass), ("high_pass", high_pass)):
        shape: PassTable | None = getattr(table, kind)
        if shape is not None:
            return create(positive_value(shape.omega, "rad/s", f"{where}.{kind}.omega"), shape.damping)
    if table.notch is not None:
        omega = positive_value(table.notch.omega, "rad/s", f"{where}.notch.omega")
        return notch(omega, table.notch.damping, table.notch.depth)
    return None


def _polynomial_text(coefficients: tuple[float, ...]) -> str:
    parts = []
    for power, c in zip(range(len(coefficients) - 1, -1, -1), coefficients, strict=True):
        if c:
            parts.append(f"{c:.4g}" + ("" if power == 0 else " s" if power == 1 else f" s^{power}"))
    return " + ".join(parts).replace("+ -", "- ")
