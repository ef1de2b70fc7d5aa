"""Templates of exported files; numbers are written so that they read back to the last bit."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.core.equations.bindings import stored

if TYPE_CHECKING:
    from jinja2 import Environment


@cache
def _environment() -> "Environment":
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("seatrial.exporting"),
        autoescape=lambda name: name is not None and name.endswith(".xml"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def rendered(template: str, **values: Any) -> bytes:
    """Return a template of this package filled in, as UTF-8; XML is escaped."""
    return _environment().get_template(template).render(**values).encode()


def stored_text(key: Sequence[object], write: Callable[[], dict[str, list[str]]]) -> dict[str, list[str]]:
    """Return the lines of generated functions by name, from the compile cache where it holds them.

    key: what decides the text, with the same `repr` in every process.
    """
    return stored("exported", key, write, (Path(__file__).parent,))
