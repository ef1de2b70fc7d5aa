"""A study that repeats no paper, with everything its page can show."""

import numpy as np

from seatrial.core.results import Bars, Check, Claim, Curve, Figure, Fit, Matrix, Study, Table, Verdict


def fabricated_study(fit: Fit) -> Study:
    """A study with everything its page can show."""
    at = np.linspace(0.0, 60.0, 2000)
    return Study(
        name="somebody2022",
        source="Somebody et al. 2022, doi 10.1000/xyz",
        title="A benchmark repeated",
        question="Does a second pair of hands reach the published numbers?",
        answer=("Not all of them: the fit has two optima.",),
        claims=(
            Claim("The model predicts a turn within 5 %", Verdict.CONFIRMED, "advance −1.6 %"),
            Claim("The fit is unique", Verdict.REFUTED, "two optima, 3 % apart"),
            Claim("It identifies within 1 %", Verdict.HOLDS_IN_OWN_SETTING, "0.4 %", "search box about the truth"),
            Claim("The tank was still", Verdict.UNKNOWABLE, "no current was measured"),
        ),
        checks=(
            Check("heading rms of the held-out run [deg]", 8.21, 11.0, True),
            Check("RMSE over bound", 1.31, "0.85 to 1.2", False, "few runs"),
            Check("time, s", 1.0, 0.5, False).withdrawn("a time is the machine's"),
        ),
        tables=(Table("Turning circle", ("source", "advance [L]"), (("paper", 3.25), ("ours", None)), "35° to port."),),
        figures=(
            Figure("Heading", "t [s]", "ψ [deg]", (Curve("ours", at, np.sin(at)), Curve("theirs", at, np.cos(at)))),
            Bars("Errors", ("Y_v", "N_r"), {"theirs": (12.0, -40.0), "ours": (0.3, None)}, "error [%]", "Dash: none."),
            Bars("Effects", ("Y_v", "N_r"), {"one": (1e-3, 0.0), "all": (30.0, 2.0)}, "effect [1]", "", True),
            Matrix("Correlations", ("Y_v", "Y_r"), ("v", "r"), np.array([[1.0, -0.97], [np.nan, 0.2]]), "Of terms."),
        ),
        predictions=fit.predictions[:1],
        findings=fit.findings[:1],
        seed=3,
        elapsed_s=12.0,
        versions={"seatrial": "0.1.0"},
    )
