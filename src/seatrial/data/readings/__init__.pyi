from seatrial.data.readings.candidates import (
    ColumnReading,
    JointReading,
    NamedColumn,
    is_impossible,
    mistaken_units,
    name_table,
    without_codes,
)
from seatrial.data.readings.grids import Samples
from seatrial.data.readings.search import (
    OPEN_NATS,
    JudgedStatements,
    ReadingVerdict,
    RefutedStatement,
    judge,
    judge_statements,
)

__all__ = [
    "OPEN_NATS", "ColumnReading", "JointReading", "JudgedStatements", "NamedColumn", "ReadingVerdict",
    "RefutedStatement", "Samples", "is_impossible", "judge", "judge_statements", "mistaken_units", "name_table",
    "without_codes",
]  # fmt: skip
