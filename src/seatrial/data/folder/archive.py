"""Records and arrays to one .npz and back, to the last bit; what they mean stands in the document."""

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from seatrial.core.values import Array, Channel, Provenance, Record, RecordKind, frozen


def npz_bytes(arrays: Mapping[str, Array]) -> bytes:
    """Return a compressed .npz file."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **dict(arrays))  # type: ignore[arg-type]
    return buffer.getvalue()


def npz_arrays(content: bytes) -> dict[str, Array]:
    """Return the inverse of `npz_bytes`; pickles are refused."""
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        return {name: frozen(file[name]) for name in file.files}


def record_arrays(record: Record, prefix: str) -> dict[str, Array]:
    """Return the record's numbers under `prefix/symbol`."""
    return {f"{prefix}/t": record.time} | {f"{prefix}/{s}": c.values for s, c in record.channels.items()}


def record_from_arrays(table: Mapping[str, Any], arrays: Mapping[str, Array], prefix: str) -> Record:
    """Return the record of its metadata and arrays, the inverse of `Record.metadata` and `record_arrays`."""
    channels = {s: Channel(arrays[f"{prefix}/{s}"], **metadata) for s, metadata in table["channels"].items()}
    provenance = Provenance.from_metadata(table["provenance"])
    return Record(table["name"], arrays[f"{prefix}/t"], channels, RecordKind(table["kind"]), provenance)
