"""Ship, parameters and provenance as tables of a model file and back."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from seatrial.core.values import Parameter, Prior, Ship
from seatrial.data.folder.interval_tables import number_table


@dataclass(frozen=True)
class RecordSource:
    """A record behind a model: name, role (``training`` or ``validation``) and SHA-256 of the file it was read from."""

    name: str
    role: str
    sha256: str


@dataclass(frozen=True)
class ModelProvenance:
    """Where a model's values come from.

    Attributes:
        records: every record used.
        method: criterion, in a sentence.
        seed: of the estimate.
        versions: package -> version.
    """

    records: tuple[RecordSource, ...] = ()
    method: str = ""
    seed: int | None = None
    versions: Mapping[str, str] | None = None


def provenance_table(provenance: ModelProvenance) -> dict[str, Any]:
    """Return the table ``provenance`` of a model file."""
    table: dict[str, Any] = {
        "method": provenance.method,
        "versions": dict(provenance.versions or {}),
        "records": [asdict(record) for record in provenance.records],
    }
    return table if provenance.seed is None else table | {"seed": provenance.seed}


def provenance(table: Mapping[str, Any]) -> ModelProvenance:
    """Return the inverse of `provenance_table`."""
    records = tuple(RecordSource(str(r["name"]), str(r["role"]), str(r["sha256"])) for r in table["records"])
    return ModelProvenance(records, str(table["method"]), table.get("seed"), dict(table["versions"]))


def ship_table(ship: Ship) -> dict[str, Any]:
    """Return the table ``ship`` of a model file: particulars by symbol, SI."""
    return {
        "name": ship.name, "source": ship.source, "scale": float(ship.scale), **number_table(ship.particulars)
    }  # fmt: skip


def ship(table: Mapping[str, Any] | None) -> Ship | None:
    """Return the inverse of `ship_table`; None without a table."""
    if table is None:
        return None
    particulars = {name: float(value) for name, value in table.items() if name not in ("name", "source", "scale")}
    return Ship(table["name"], particulars, table["source"], float(table["scale"]))


def parameter_table(p: Parameter) -> dict[str, Any]:
    """Return the table of one parameter; what is infinite or empty is left out."""
    table: dict[str, Any] = {"value": float(p.value), "unit": p.unit, "free": p.free}
    bounds = {"lower": float(p.lower), "upper": float(p.upper)}
    table |= {key: bound for key, bound in bounds.items() if math.isfinite(bound)}
    if p.scale:
        table["scale"] = float(p.scale)
    if p.prior is not None:
        mean, deviation = float(p.prior.mean), float(p.prior.standard_deviation)
        table["prior"] = {"mean": mean, "sd": deviation, "source": p.prior.source}
    texts = {"meaning": p.meaning, "source": p.source, "latex": p.latex}
    return table | {key: text for key, text in texts.items() if text}


def parameter(name: str, table: Mapping[str, Any]) -> Parameter:
    """Return the inverse of `parameter_table`."""
    prior = table.get("prior")
    return Parameter(
        name=name,
        value=float(table["value"]),
        unit=str(table["unit"]),
        lower=float(table.get("lower", -math.inf)),
        upper=float(table.get("upper", math.inf)),
        scale=float(table.get("scale", 0.0)),
        prior=None if prior is None else Prior(float(prior["mean"]), float(prior["sd"]), str(prior["source"])),
        free=bool(table["free"]),
        source=str(table.get("source", "")),
        meaning=str(table.get("meaning", "")),
        latex=str(table.get("latex", "")),
    )
