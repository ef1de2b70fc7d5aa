"""The callback by which a long computation reports its progress."""

from collections.abc import Callable

ProgressReporter = Callable[[str], None]
"""Takes one line: the phase, and after a colon how far it is, ``prediction: 3 of 12, zigzag_20``."""
