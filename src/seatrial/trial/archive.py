"""Records and arrays to one .npz and back, to the last bit; what they mean stands in a table beside them."""

import io
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from seatrial.values import Array, Channel, Kind, Provenance, Record, frozen


def npz_bytes(arrays: Mapping[str, Array]) -> bytes:
    """A compressed .npz file."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **dict(arrays))  # type: ignore[arg-type]
    return buffer.getvalue()


def npz_arrays(content: bytes) -> dict[str, Array]:
    """The inverse of `npz_bytes`; pickles are refused."""
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        return {name: frozen(file[name]) for name in file.files}


def record_table(record: Record) -> dict[str, Any]:
    """Everything of a record but its numbers."""
    channels = {
        symbol: {key: getattr(c, key) for key in ("unit", "frame", "positive", "reference_point", "label")}
        for symbol, c in record.channels.items()
    }
    return {
        "name": record.name,
        "kind": record.kind.value,
        "provenance": asdict(record.provenance),
        "channels": channels,
    }


def record_arrays(record: Record, prefix: str) -> dict[str, Array]:
    """The record's numbers under `prefix/symbol`."""
    return {f"{prefix}/t": record.time} | {f"{prefix}/{s}": c.values for s, c in record.channels.items()}


def record_from(table: Mapping[str, Any], arrays: Mapping[str, Array], prefix: str) -> Record:
    """The inverse of `record_table` and `record_arrays`."""
    channels = {s: Channel(arrays[f"{prefix}/{s}"], **about) for s, about in table["channels"].items()}
    origin = table["provenance"]
    provenance = Provenance(origin["source"], origin["sha256"], tuple(origin["steps"]))
    return Record(table["name"], arrays[f"{prefix}/t"], channels, Kind(table["kind"]), provenance)


def distinct(records: Sequence[Record]) -> list[Record]:
    """Each record object once, in order."""
    return list({id(record): record for record in records}.values())
