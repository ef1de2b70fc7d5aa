"""Sessions by a template of the file name."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial.load import load_trial
from seatrial.data.trial.run_data import session_of, valid_session


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


def test_all_runs_are_of_one_session() -> None:
    assert {session_of(Path(name), valid_session("all")) for name in ("a.csv", "2026-05-14_b.csv")} == {"all"}


def test_a_day_is_that_of_the_name_else_of_the_time_stamps() -> None:
    assert session_of(Path("2026-05-14_b.csv"), "day", lambda: "2026-05-15") == "2026-05-14"
    assert session_of(Path("b.csv"), "day", lambda: "2026-05-15") == "2026-05-15"
    with pytest.raises(InputError, match=r"no date is found in time stamps and the file name 'b.csv'"):
        session_of(Path("b.csv"), "day")


def test_runs_of_one_day_share_a_session_by_their_date_column(tmp_path: Path) -> None:
    for name, day in (("a", "14.08.2026"), ("b", "14.08.2026"), ("c", "15.08.2026")):
        rows = "".join(f"{day};07:30:{k:02d};{k}\n" for k in range(40))
        (tmp_path / f"{name}.csv").write_text(f"Date;UTC;Rudder\n{rows}")
    (tmp_path / "trial.toml").write_text(
        '[ship]\nname = "craft"\nL = 35.0\n[model]\nname = "nomoto"\n[[records]]\nfiles = ["*.csv"]\nsession = "day"\n'
        'time = { column = "UTC", unit = "utc", date = "Date" }\nchannels.delta = { column = "Rudder", unit = "deg" }\n'
    )
    sessions = [run.session for run in load_trial(tmp_path / "trial.toml").runs]
    assert sessions == ["2026-08-14", "2026-08-14", "2026-08-15"]
