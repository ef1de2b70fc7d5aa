"""Which field of which NMEA sentence gives which channel."""

from collections.abc import Sequence

from seatrial.core.values import InputError, spelling_hint
from seatrial.data.read.layout import ColumnSpec

# field -> SI unit; a second word distinguishes the quantities of one sentence
_FIELD_UNITS = {
    **dict.fromkeys(("HDT", "THS", "HDM", "VHW heading", "RSA", "RSA port"), "rad"),
    "ROT": "rad/s",
    **dict.fromkeys(("VBW", "VBW transverse", "VBW ground", "VBW ground transverse", "VHW"), "m/s"),
    **{f"{kind} {part}": "m/s" for kind in ("VTG", "RMC") for part in ("north", "east")},
    **{f"{kind} {part}": "m" for kind in ("GGA", "RMC", "GNS", "GLL") for part in ("lat", "lon")},
    **{f"RPM {source}{number}": "rps" for source in "SE" for number in range(5)},  # five shafts, five engines
}
_TRANSDUCER_PREFIX = "XDR "

# (channel, frame) -> fields, the best first
_DEFAULT_FIELDS: dict[tuple[str, str], tuple[str, ...]] = {
    ("psi", "earth"): ("HDT", "THS", "VHW heading"),
    ("r", "body"): ("ROT",),
    ("delta", "body"): ("RSA", "XDR RUDDER"),
    ("u", "body"): ("VBW", "VHW"),
    ("v", "body"): ("VBW transverse",),
    ("u", "earth"): ("VTG north", "RMC north"),
    ("v", "earth"): ("VTG east", "RMC east"),
    ("x0", "earth"): ("GGA lat", "RMC lat", "GNS lat", "GLL lat"),
    ("y0", "earth"): ("GGA lon", "RMC lon", "GNS lon", "GLL lon"),
    ("phi", "body"): ("XDR ROLL", "XDR HEEL"),
    ("theta", "body"): ("XDR PTCH", "XDR PITCH"),
    ("z", "body"): ("XDR HEAV", "XDR HEAVE"),
    ("n", "none"): ("RPM S0", "RPM S1", "RPM S2"),
    **{(f"rpm_{k}", "none"): (f"RPM S{k}", f"RPM E{k}") for k in range(1, 5)},  # four shafts or engines
}


def columns_by_field(columns: Sequence[ColumnSpec]) -> dict[str, list[tuple[int, int]]]:
    """Return field -> (index of the column, rank, 0 the best) for each column that it can fill.

    A column named after its channel (or numbered) takes the usual fields, the best that arrives; one named after a
    field (``VBW ground``, ``XDR ROLL1``) takes that alone.

    Raises:
        InputError: no sentence contains the channel, or the field is unknown or measures something else.
    """
    ranks: dict[str, list[tuple[int, int]]] = {}
    for index, column in enumerate(columns):
        for rank, field in enumerate(_column_fields(column)):
            ranks.setdefault(field, []).append((index, rank))
    return ranks


def _column_fields(column: ColumnSpec) -> tuple[str, ...]:
    source = column.source
    if isinstance(source, int) or source == column.symbol:
        usual = _DEFAULT_FIELDS.get((column.symbol, column.declared_frame))
        if usual is None:
            raise InputError(
                f"no NMEA 0183 sentence contains channel '{column.symbol}' in frame '{column.declared_frame}'; name a "
                f"transducer, such as 'XDR NAME', or leave the channel out"
            )
        return usual
    if source.startswith(_TRANSDUCER_PREFIX):
        return (_TRANSDUCER_PREFIX + source.removeprefix(_TRANSDUCER_PREFIX).strip().upper(),)
    if source not in _FIELD_UNITS:
        raise InputError(
            f"channel '{column.symbol}': no NMEA field '{source}'{spelling_hint(source, sorted(_FIELD_UNITS))}"
        )
    if _FIELD_UNITS[source] != column.quantity.unit:
        raise InputError(
            f"channel '{column.symbol}' cannot come from NMEA '{source}', which is in {_FIELD_UNITS[source]}"
        )
    return (source,)
