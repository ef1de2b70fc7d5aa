"""The approach condition of a set of records: the steady state from which a simulated manoeuvre starts by default."""

from collections.abc import Sequence

import numpy as np

from seatrial.equations import Model
from seatrial.values import Record

# how much of each record before its first rudder execution is taken for the approach, s; an execution is what
# passes this part of the record's largest rudder angle
APPROACH_SECONDS = 2.0
EXECUTION = 0.2


def approach_of(records: Sequence[Record], model: Model) -> dict[str, float]:
    """Surge velocity and inputs other than rudder and wind: median over records of each one's approach."""
    symbols = ["u", *(name for name in model.input_names if name != "delta" and not name.startswith("wind"))]
    found = {}
    for symbol in symbols:
        values = [_approach(r, symbol) for r in records if symbol in r]
        if values:
            found[symbol] = float(np.median(values))
    return found


def _approach(record: Record, symbol: str) -> float:
    stop = float(record.time[0])
    if "delta" in record:
        rudder = np.abs(record["delta"])
        stop = float(record.time[int(np.argmax(rudder >= EXECUTION * np.max(rudder)))])
    stop = max(stop, float(record.time[0]) + APPROACH_SECONDS)
    within = (record.time >= stop - APPROACH_SECONDS) & (record.time <= stop)
    return float(np.mean(record[symbol][within]))
