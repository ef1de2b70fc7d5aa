"""What is known while the record is still being made, as strict JSON: the one source of the documented schema."""

from dataclasses import asdict
from typing import Any

from pydantic import Field

from seatrial.core.results.online import SampleCounts, Snapshot
from seatrial.data.folder.fit_entries import Entry, FindingEntry, Number
from seatrial.data.folder.fit_json import finding_entry


class OnlineCoefficientEntry(Entry):
    """One free coefficient, SI."""

    name: str
    unit: str
    estimate: Number
    standard_error: Number = Field(description="null where nothing is known")
    is_identified: bool = Field(description="false where the samples so far do not tell it")


class ChangeEntry(Entry):
    """Whether the latest stretch tells other coefficients than what came before."""

    since: Number = Field(description="s on the stream's clock")
    statistic: Number
    degrees_of_freedom: int
    p: Number
    is_significant: bool
    most_changed: str


class CountsEntry(Entry):
    """What happened to the samples."""

    accepted: int
    late: int
    repeated: int
    not_finite: int
    missing: int
    jumps: int
    garbled: int
    checksum: int
    dropped: int
    truncated: int
    last_problem: str = Field(description="the latest trouble in words")


class OnlineDocument(Entry):
    """What `follow --json` writes without `--once`: the last estimate."""

    time: Number = Field(description="s on the stream's clock; null: no sample came")
    samples: int
    runs: int
    phase: str = Field(description="waiting, window or recursive")
    coefficients: list[OnlineCoefficientEntry]
    noise: dict[str, Number] = Field(description="rms of the residuals of each channel, SI")
    advice: str = Field(description="which manoeuvre would help; empty if nothing is untold")
    change: ChangeEntry | None
    counts: CountsEntry
    findings: list[FindingEntry]


def online_json(snapshot: Snapshot | None, counts: SampleCounts) -> dict[str, Any]:
    """The documented schema, ready for `strict_json`; None where no sample came."""
    told = CountsEntry.model_validate(asdict(counts))
    if snapshot is None:
        return OnlineDocument(
            time=None, samples=0, runs=0, phase="waiting", coefficients=[], noise={}, advice="", change=None,
            counts=told, findings=[],
        ).model_dump()  # fmt: skip
    rows = zip(snapshot.names, snapshot.units, snapshot.value, snapshot.standard_error, strict=True)
    return OnlineDocument(
        time=snapshot.time,
        samples=snapshot.samples,
        runs=snapshot.runs,
        phase=snapshot.phase.value,
        coefficients=[
            OnlineCoefficientEntry(
                name=name,
                unit=unit,
                estimate=value,
                standard_error=error,
                is_identified=name not in snapshot.unidentified,
            )
            for name, unit, value, error in rows
        ],
        noise=dict(snapshot.noise),
        advice=snapshot.advice,
        change=None if snapshot.change is None else ChangeEntry.model_validate(snapshot.change),
        counts=told,
        findings=[finding_entry(f) for f in snapshot.findings],
    ).model_dump()


def online_schema() -> dict[str, Any]:
    """JSON Schema of `online_json`."""
    return OnlineDocument.model_json_schema()
