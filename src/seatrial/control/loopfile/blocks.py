"""Tables of a loop file into blocks: transfer functions as given, filters by their kind."""

from collections.abc import Sequence
from dataclasses import replace

from seatrial.control.loopfile.quantities import positive_value
from seatrial.control.loopfile.schema import BlockTable
from seatrial.core.values import InputError
from seatrial.physics.loops import Block
from seatrial.physics.loops.structures import band_pass, low_pass, notch


def block(table: BlockTable, name: str, where: str) -> Block:
    """The block of one table.

    Raises:
        InputError: it is improper, its denominator is zero, or a filter is out of sense.
    """
    made = _filter(table, where)
    if made is not None:
        return replace(made, name=name, source=table.source)
    try:
        return Block(name, table.num or (), table.den or (), table.source)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def blocks(tables: Sequence[BlockTable], where: str) -> tuple[Block, ...]:
    """The blocks of a list, numbered where there are several."""
    kind = where.rsplit(".", maxsplit=1)[-1].removesuffix("s")
    return tuple(
        block(table, table.name or (kind if len(tables) == 1 else f"{kind} {i}"), f"{where}[{i}]")
        for i, table in enumerate(tables, start=1)
    )


def block_text(block: Block) -> str:
    """A transfer function on one line."""
    return f"({_polynomial_text(block.num)}) / ({_polynomial_text(block.den)})"


def _filter(table: BlockTable, where: str) -> Block | None:
    if table.lag is not None:
        return Block("lag", (1.0,), (positive_value(table.lag, "s", f"{where}.lag"), 1.0))
    if table.notch is not None:
        return notch(
            positive_value(table.notch.omega, "rad/s", f"{where}.notch.omega"), table.notch.damping, table.notch.depth
        )
    if table.low_pass is not None:
        return low_pass(
            positive_value(table.low_pass.omega, "rad/s", f"{where}.low_pass.omega"), table.low_pass.damping
        )
    if table.band_pass is not None:
        return band_pass(
            positive_value(table.band_pass.omega, "rad/s", f"{where}.band_pass.omega"), table.band_pass.damping
        )
    if table.high_pass is not None:
        w, z = positive_value(table.high_pass.omega, "rad/s", f"{where}.high_pass.omega"), table.high_pass.damping
        return Block("high-pass", (1.0, 0.0, 0.0), (1.0, 2.0 * z * w, w**2))
    return None


def _polynomial_text(coefficients: tuple[float, ...]) -> str:
    parts = []
    for power, c in zip(range(len(coefficients) - 1, -1, -1), coefficients, strict=True):
        if c:
            parts.append(f"{c:.4g}" + ("" if power == 0 else " s" if power == 1 else f" s^{power}"))
    return " + ".join(parts).replace("+ -", "- ")
