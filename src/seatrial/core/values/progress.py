"""How a long computation tells where it is."""

from collections.abc import Callable

ProgressReporter = Callable[[str], None]
