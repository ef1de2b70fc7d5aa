"""The approach condition of a set of records: the steady state from which a simulated manoeuvre starts by default."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.check.approach_phase import approach_fault, first_execution

# how much of each record before its first rudder execution is taken for the approach, s
APPROACH_SECONDS = 2.0


def approach_condition(records: Sequence[Record], model: Model) -> dict[str, float]:
    """Return surge velocity and inputs other than rudder and wind: median over records of each one's approach.

    Of records whose approach is steady; of all where none is.
    """
    steady = [record for record in records if not approach_fault(record)]
    symbols = ["u", *(name for name in model.input_names if name != "delta" and not name.startswith("wind"))]
    condition = {}
    for symbol in symbols:
        values = [_approach_value(r, symbol) for r in steady or records if symbol in r]
        if values:
            condition[symbol] = float(np.median(values))
    return condition


def _approach_value(record: Record, symbol: str) -> float:
    stop = float(record.time[0])
    if "delta" in record:
        stop = float(record.time[first_execution(record)])
    stop = max(stop, float(record.time[0]) + APPROACH_SECONDS)
    within = (record.time >= stop - APPROACH_SECONDS) & (record.time <= stop)
    return float(np.mean(record[symbol][within]))
