"""What one column is taken for, with the evidence."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from seatrial.data.read import ColumnSpec

RELATIVE = "_relative"
"""The end of the channels of an apparent wind."""


@dataclass(frozen=True)
class ColumnGuess:
    """What one column is taken for.

    Attributes:
        source: as the trial file addresses it.
        symbol, unit, frame, positive, zero, span, scale, kind: as in a channel of the trial file.
        evidence: why.
        other_reading: what it may be instead; empty: it is assigned outright.
        side: of the craft on which the motion or a name shows a thruster or shaft, port or starboard; empty: not shown.
        reference_point: m forward of midship to which it refers; 0: midship, or not examined.
        follows_track: whether the motion shows a velocity to be the derivative of the position, over ground.
        is_used: whether it is the one chosen for its symbol.
        unused_because: why it is not; empty: it is used.
        is_commented: whether its line is a comment, as the model does not take it.
    """

    source: str | int
    symbol: str
    unit: str
    frame: str = ""
    positive: str = ""
    zero: float = 0.0
    span: float = 1.0
    scale: float = 1.0
    kind: str = ""
    evidence: tuple[str, ...] = ()
    other_reading: str = ""
    side: str = ""
    reference_point: float = 0.0
    follows_track: bool = False
    is_used: bool = True
    unused_because: str = ""
    is_commented: bool = False

    @property
    def is_open(self) -> bool:
        """Whether a person must choose."""
        return bool(self.other_reading)

    @property
    def is_of_wind(self) -> bool:
        """Whether it is wind, which a draft may leave out: without it the air is taken for calm."""
        return self.symbol.startswith("wind_")

    @property
    def column(self) -> ColumnSpec:
        """The column as a layout has it."""
        return ColumnSpec(
            self.symbol,
            self.source,
            self.unit,
            self.frame,
            self.positive,
            self.reference_point,
            zero=self.zero,
            span=self.span,
            factor=self.scale,
            kind="command" if self.kind == "command" or self.symbol.startswith("command_") else "",
        )

    def with_evidence(self, text: str) -> "ColumnGuess":
        """Return the guess with one more reason."""
        return replace(self, evidence=(*self.evidence, text))


Changes = Mapping[str, Callable[[ColumnGuess], ColumnGuess]]
"""Channel -> what its guess becomes."""
