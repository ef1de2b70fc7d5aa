"""Sessions by a template of the file name."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial.session import session_of, valid_session


@pytest.mark.parametrize(
    ("name", "template", "session"),
    [
        ("zigzag_20200901_01", "*_{day}_*", "20200901"),
        ("a_b_c_d", "*_{day}_*", "b"),
        ("zz1_d2", "zz?_{day}", "d2"),
        ("2020-09-01_zz", "{day}_zz", "2020-09-01"),
        ("zz[1]", "zz[[]{n}]", "1"),
    ],
)
def test_the_braces_stand_for_the_first_and_shortest_part(name: str, template: str, session: str) -> None:
    assert session_of(Path(f"{name}.csv"), template) == session


def test_a_template_that_does_not_fit_is_refused_at_once() -> None:
    with pytest.raises(InputError, match="does not fit the file name"):
        session_of(Path("a" * 200 + ".csv"), "*a" * 20 + "{day}" + "*b" * 20)


@pytest.mark.parametrize("rule", ["(a+)+$", "*_*", "{day}{day}", "{}"])
def test_a_rule_without_one_place_is_refused(rule: str) -> None:
    with pytest.raises(ValueError, match="is no template"):
        valid_session(rule)
