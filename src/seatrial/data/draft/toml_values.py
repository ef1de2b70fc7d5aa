"""Values as a TOML file holds them."""

import json


def quoted(value: str | int) -> str:
    """Return a value as TOML writes it; the escapes of JSON are those of TOML."""
    return str(value) if isinstance(value, int) else json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
