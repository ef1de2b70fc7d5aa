"""What a closed loop was and costs, in words."""

from seatrial.core.results.coefficients import FeedbackEvidence, WithoutDisturbance


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
