from seatrial.data.readings.candidates import NamedColumn, ColumnReading, is_impossible
from seatrial.data.readings.grids import Samples
from seatrial.data.readings.search import OPEN_NATS, ReadingVerdict, judge

__all__ = ["OPEN_NATS", "ColumnReading", "NamedColumn", "ReadingVerdict", "Samples", "is_impossible", "judge"]
