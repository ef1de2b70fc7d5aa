"""Offsets of sessions: whose values a record gets, and the sentence that says so."""

from seatrial.core.results import (
    Offset,
    OffsetPopulation,
    SessionOffset,
    fitted_session,
    offsets_text,
    session_offsets_of,
)


def test_the_only_session_of_a_fit_is_that_of_a_record_unless_it_is_a_new_one() -> None:
    only = SessionOffset("delta zero", "rad", 0.01, {"all": 0.04})
    assert (only.value_in(None), only.value_in("all"), only.value_in("new")) == (0.04, 0.04, 0.01)
    assert offsets_text([only], None) == "delta zero 2.3 deg (session 'all')"
    assert offsets_text([only], "new") == "delta zero 0.57 deg (expected of a new session)"
    assert fitted_session([only], "all") == "all" and fitted_session([only], "some run") == "new"


def test_offsets_of_a_fit_are_gathered_by_kind() -> None:
    offsets = [
        Offset(name, day, unit, value, 0.001)
        for day, zero, current in (("1 May", 0.04, 0.3), ("2 May", 0.02, -0.1))
        for name, unit, value in (("current_north", "m/s", current), ("delta zero", "rad", zero))
    ]
    kinds = [
        OffsetPopulation("current_north", "m/s", 0.0, 0.0, 0.2),
        OffsetPopulation("delta zero", "rad", 0.03, 0.01, 0.01),
    ]
    current, zero = session_offsets_of(offsets, kinds)
    assert current == SessionOffset("current_north", "m/s", 0.0, {"1 May": 0.3, "2 May": -0.1})
    assert zero == SessionOffset("delta zero", "rad", 0.03, {"1 May": 0.04, "2 May": 0.02})
    assert (current.correction, zero.correction) == (("current_north", ""), ("delta", "zero"))
    assert (zero.value_in(None), zero.value_in("2 May")) == (0.03, 0.02)
