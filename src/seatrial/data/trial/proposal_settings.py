"""The table `[proposal]` of a trial file: for which loop gains are proposed while a stream is followed."""

from pathlib import Path

from pydantic.dataclasses import dataclass

from seatrial.data.trial.amounts import STRICT_FIELDS
from seatrial.data.trial.schema_errors import raises_input_error
from seatrial.data.trial.settings import Positive


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ProposalSettings:
    """`[proposal]`: gains proposed for the sea and the craft that the latest stretch of the stream shows.

    Attributes:
        loop: the loop file that was tuned.
        gains: the ``gains.toml`` of its tuning, with a schedule.
        stretch_s: length of the stretch at one speed and heading that a proposal rests on [s].
        every_s: s of the stream between two proposals.
    """

    loop: Path
    gains: Path
    stretch_s: Positive = 1200.0
    every_s: Positive = 300.0
