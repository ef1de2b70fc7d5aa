"""How a long computation tells where it is."""

from collections.abc import Callable

Progress = Callable[[str], None]
