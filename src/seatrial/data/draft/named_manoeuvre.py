"""A run whose file is called after another manoeuvre than the one that it shows."""

import re
from collections.abc import Mapping, Sequence

from seatrial.data.draft.stretch import LogStretch

# what files are called -> the kinds of stretches that fit
_NAMED: Mapping[str, tuple[str, ...]] = {
    r"zig_?-? ?zag|zz": ("zigzag",),
    r"circle|turning": ("circle", "turn", "spin"),
    r"spiral": ("spiral",),
    r"decay": ("decay",),
}


def name_contradiction(name: str, stretches: Sequence[LogStretch]) -> str:
    """Return what the name of a run says that its motion does not show; empty where they agree, or it says nothing.

    stretches: the manoeuvres in the run, with their evidence.
    """
    named = [kinds for word, kinds in _NAMED.items() if re.search(rf"(?<![a-z])({word})(?![a-z])", name, re.IGNORECASE)]
    shown = [stretch for stretch in stretches if not stretch.name.startswith(("straight", "stop"))]
    if len(named) != 1 or not shown or any(one.name.startswith(named[0]) for one in shown):
        return ""
    return f"the name says {named[0][0]}, the motion does not: {shown[0].evidence}"
