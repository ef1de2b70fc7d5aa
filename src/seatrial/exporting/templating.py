"""Templates of exported files; numbers are written so that they read back to the last bit."""

from functools import cache
from typing import TYPE_CHECKING, Any

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
