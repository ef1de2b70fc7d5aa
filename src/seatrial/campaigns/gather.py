"""The table of a campaign: a row for each row of each task, in the order of the plan, whoever did the tasks and when.

Times are no part of it: on processors of one type it is the same to the bit whatever the workers, shards and restarts.
"""

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.campaigns.journal import body_of
from seatrial.campaigns.outcome import DecodedBody, decoded
from seatrial.campaigns.store import Store
from seatrial.campaigns.work import Scalar
from seatrial.core.values import InputError
from seatrial.core.values.files import write_atomically

TASK, FAILURE, PROCESSOR, ALGEBRA = "task", "failure", "processor", "linear_algebra"
_TASK_DIGITS = 16  # hexadecimal digits of an identity in the table: chosen, no two of a million alike


@dataclass(frozen=True, eq=False)
class CampaignTable:
    """Columns of equal length; `keys` names those that distinguish tasks."""

    columns: Mapping[str, Sequence[Scalar]]
    keys: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.columns[TASK])


def campaign_table(store: Store) -> CampaignTable:
    """Return the table of what a store holds: rows of tasks that are done, one row with a sentence of a failed one.

    Raises:
        InputError: a journal cannot be read, or no task has ended yet.
    """
    keys, names = dict[str, None](), dict[str, None]()
    bodies: list[tuple[str, DecodedBody]] = []
    for identity, body in _bodies(store):
        keys |= dict.fromkeys(body.keys)
        names |= dict.fromkeys(body.columns)
        bodies.append((identity, body))
    if not bodies:
        raise InputError(f"the campaign in '{store.folder}' has no result yet; run it first")
    names = {name: None for name in names if name not in keys}
    columns: dict[str, list[Scalar]] = {name: [] for name in (TASK, *keys, *names, FAILURE, PROCESSOR, ALGEBRA)}
    for identity, body in bodies:
        _append(columns, identity, body, tuple(keys), tuple(names))
    return CampaignTable(columns, tuple(keys))


def _bodies(store: Store) -> Iterator[tuple[str, DecodedBody]]:
    stored = store.outcomes()
    for identity in store.identities:
        entry = stored.done.get(identity) or stored.failed.get(identity)
        if entry is not None:
            yield identity.hex()[:_TASK_DIGITS], decoded(body_of(entry))


def _append(
    columns: dict[str, list[Scalar]], task: str, body: DecodedBody, keys: tuple[str, ...], names: tuple[str, ...]
) -> None:
    count = max((len(values) for values in body.columns.values()), default=0)
    if body.failure:
        count = 1
    for name in keys:
        columns[name] += [_scalar(body.keys.get(name))] * count
    for name in names:
        columns[name] += body.columns.get(name, [None] * count)
    facts = {TASK: task, FAILURE: body.failure or None, PROCESSOR: body.processor, ALGEBRA: body.linear_algebra}
    for name, value in facts.items():
        columns[name] += [value] * count


def _scalar(value: Any) -> Scalar:
    """Return the value of an override as a cell: a list or table as its JSON text."""
    return json.dumps(value, sort_keys=True) if isinstance(value, list | tuple | dict) else value


def write_table(table: CampaignTable, path: Path) -> None:
    """Write the table as CSV or Parquet, by the ending of its name; whole or not at all.

    Raises:
        InputError: another ending, Parquet without pyarrow, or the file cannot be written.
    """
    if path.suffix == ".csv":
        write_atomically(path, _csv(table))
    elif path.suffix == ".parquet":
        write_atomically(path, _parquet(table))
    else:
        raise InputError(f"'{path}' is neither a .csv nor a .parquet file; name one that is")


def _csv(table: CampaignTable) -> bytes:
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(table.columns)
    writer.writerows(zip(*table.columns.values(), strict=True))
    return text.getvalue().encode()


def _parquet(table: CampaignTable) -> bytes:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise InputError(
            "a .parquet file needs pyarrow; run: pip install 'seatrial[formats]', or name a .csv"
        ) from None
    columns = {name: pyarrow.array(_of_one_type(values)) for name, values in table.columns.items()}
    buffer = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), buffer)
    return buffer.getvalue()


def _of_one_type(values: Sequence[Scalar]) -> Sequence[Scalar]:
    """Return whole numbers among others as others, and anything else that is mixed as text."""
    kinds = {type(value) for value in values if value is not None}
    if kinds <= {int, float} and len(kinds) > 1:
        return [None if value is None else float(value) for value in values]  # type: ignore[arg-type]
    return values if len(kinds) <= 1 else [None if value is None else str(value) for value in values]
