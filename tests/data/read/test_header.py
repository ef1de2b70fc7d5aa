"""Names and units are found above the numbers, however many lines stand there."""

import pytest

from seatrial.data.read.log import TableHeader, table_header

NAMES, UNITS = ("t", "heading", "rudder"), ("s", "deg", "degC")


@pytest.mark.parametrize(
    ("rows", "header"),
    [
        ([NAMES], TableHeader(NAMES)),
        ([("trial of a ferry",), NAMES], TableHeader(NAMES)),
        ([NAMES, UNITS], TableHeader(NAMES, UNITS)),
        ([("a title", "", ""), NAMES, ("[s]", "(deg)", ""), ("", "", "")], TableHeader(NAMES, ("s", "deg", ""))),
        ([("first", "second", "third"), ("t", "u", "psi")], TableHeader(("t", "u", "psi"))),
        ([("t", "Port", ""), ("time", "Nozzle", "RPM")], TableHeader(("time", "Port Nozzle", "Port [RPM]"))),
        (
            [("t", "Port", ""), ("time", "Nozzle", "RPM"), ("s", "deg", "1/min")],
            TableHeader(("time", "Port Nozzle", "Port RPM"), ("s", "deg", "1/min")),
        ),
        ([UNITS], TableHeader(UNITS)),
        ([], TableHeader()),
    ],
    ids=[
        "names",
        "title",
        "units",
        "brackets",
        "names like units",
        "groups",
        "groups and units",
        "units alone",
        "nothing",
    ],
)
def test_the_last_row_holds_names_or_units(rows: list[tuple[str, ...]], header: TableHeader) -> None:
    assert table_header(rows) == header


def test_columns_beyond_the_header_have_no_name() -> None:
    header = TableHeader(("t",), ("s",))
    assert header.names_of(3) == ("t", "", "") and header.units_of(3) == ("s", "", "")
    assert TableHeader(NAMES).names_of(2) == NAMES[:2] and TableHeader(NAMES).units_of(2) == ()
