"""A comparison nobody made: two loadings of a craft."""

from seatrial.core.results import ComparedFit, Comparison, Difference, JointTest, ManoeuvreDifferences
from seatrial.core.values import Finding, Severity


def fabricated_comparison() -> Comparison:
    """Coefficients and measures of which some differ, one is not determined, and one manoeuvre fails."""
    first, second = (
        ComparedFit(f"results/{name}", "craft", "nomoto", "prediction error", "information matrix", (f"{name} 1",))
        for name in ("laden", "ballast")
    )
    coefficients = (
        Difference("K", "1/s", 0.15, 0.19, 0.04, 0.02, 0.06, is_significant=True),
        Difference("T", "s", 8.0, 7.6, -0.4, -2.4, 1.6, is_significant=False),
    )
    turn = (
        Difference("tactical_diameter_L", "", 3.1, 2.8, -0.3, -0.4, -0.2, is_significant=True),
        Difference("steady_drift_deg", "", 12.0, 12.5, 0.5),
    )
    note = Finding(Severity.WARNING, "shared-records", "both fits use the same records", "1 of 2", "compare others")
    return Comparison(
        first, second, ("particulars: d 0.71 → 0.55",), coefficients, JointTest(18.2, 2, 1.1e-4),
        (ManoeuvreDifferences("turning-circle:35:port", turn), ManoeuvreDifferences("spiral", (), "it diverges")),
        (note,), {"seatrial": "0.1.0"},
    )  # fmt: skip
