"""The callback by which a long computation reports its progress."""

from collections.abc import Callable

ProgressReporter = Callable[[str], None]
