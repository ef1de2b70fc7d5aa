"""Offsets of sessions and closed loops: whose values a record gets, and what is said of them."""

from seatrial.core.results import (
    Offset,
    OffsetPopulation,
    SessionOffset,
    fitted_session,
    offsets_text,
    session_offsets_of,
)
from seatrial.core.results.coefficients import FeedbackEvidence, WithoutDisturbance


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


def test_a_tested_loop_gives_its_evidence_and_its_cost() -> None:
    lost = WithoutDisturbance("T", 1e6, 1e7, 5e5, 1e-7)
    near = WithoutDisturbance("K", 0.12, 0.001, -3.0, 10.0)
    loop = FeedbackEvidence("delta", "psi", ("run",), -0.6, 0.1, 1e-9, without_disturbance=(near,))
    assert loop.sentences == (
        "closed loop: 'delta' follows 'psi' in run (cross-correlation −0.60, output 0.10 s ahead, p < 0.001)",
        "output error without a disturbance would put K 3.0 standard errors away, with a standard error 0.10 times as "
        "large",
    )
    far = FeedbackEvidence("delta", "psi", ("run",), without_disturbance=(near, lost), is_declared=True)
    assert far.sentences == (
        "closed loop: 'delta' follows 'psi' in run (as [feedback] declares)",
        "output error without a disturbance would put T more than 100 standard errors away",
    )


def test_reference_and_controller_are_evidence() -> None:
    loop = FeedbackEvidence("delta", "psi", ("a", "b"), is_declared=True, reference="psi_ref", reference_p=1e-4,
                      controller_correlation=0.98, controller_delay=1.7)  # fmt: skip
    _, reference, controller = loop.sentences
    assert reference == "the innovations depend on earlier changes of the reference psi_ref (p < 0.001)"
    assert controller.endswith("they agree with 'delta' to a correlation of 0.98 at a delay of 1.7 s")
