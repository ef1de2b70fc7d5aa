"""What a session shows of a noun, in text, tables and HTML; a part that cannot be computed is a finding."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.reporting.complete_fit import tanker
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_study import fabricated_study
from tests.reporting.fabricated_tuning import fabricated_fin

from seatrial.core.results.fields import MissingParts, Summarised, Summary
from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.physics.models.published import kvlcc2

LONGEST = 2000
"""Characters of the longest representation of a noun: what a terminal shows without scrolling."""
EXAMPLE = Path(__file__).parents[3] / "examples" / "waterjet.toml"
NOUNS: dict[str, tuple[Callable[[], object], tuple[str, ...]]] = {
    "record": (
        lambda: fabricated_fit().records[0],
        ("zigzag_10_10", "measured", "1200 samples over 239.8 s", "psi [rad]"),
    ),
    "parameters": (lambda: kvlcc2().parameters, ("free", "fixed", "X_vv")),
    "model": (kvlcc2, ("states u, v, r", "inputs delta")),
    "trial": (lambda: load_trial(EXAMPLE), ("waterjet.toml", "train", "validate")),
    "fit": (tanker, ("Fit of model", "43 free", "converged")),
    "prediction": (lambda: tanker().predictions[0], ("HSVA_Z_10_05", "rms")),
    "design": (fabricated_design, ("waterjet craft", "coefficients 11")),
    "tuning": (fabricated_fin, ("fin stabiliser", "alpha_f")),
    "study": (lambda: fabricated_study(fabricated_fit()), ("somebody2022", "1 holding, 1 failing, 1 withdrawn")),
}


@pytest.mark.parametrize("name", NOUNS)
def test_a_noun_says_what_it_is_in_a_line_or_two(name: str) -> None:
    make, contents = NOUNS[name]
    text = repr(make())
    assert len(text) <= LONGEST
    assert all(part in text for part in contents), text


@pytest.mark.parametrize("name", ["fit", "design", "tuning", "study"])
def test_a_result_shows_its_summary_in_a_notebook(name: str) -> None:
    result = NOUNS[name][0]()
    assert isinstance(result, Summarised)
    html, summary = result._repr_html_(), result.summary()
    assert html.count("<tr>") == 1 + len(summary.facts) + len(summary.rows)
    assert summary.title in html


def test_a_summary_is_an_aligned_table() -> None:
    table = Summary("Two", ("name", "value"), (("a", "1.5"), ("long one", "-10")), {"seed": "3"}, ("A note.",))
    assert str(table).splitlines() == [
        "Two",
        "===============",
        "seed: 3",
        "---------------",
        "name      value",
        "a           1.5",
        "long one    -10",
        "===============",
        "A note.",
    ]
    assert repr(table) == str(table)


def test_html_takes_no_markup_from_names() -> None:
    assert "<b>" not in Summary("<b>", ("<b>",), (("<b>",),), {"<b>": "<b>"}, ("<b>",))._repr_html_()


def test_what_cannot_be_computed_is_said_and_replaced() -> None:
    def refused() -> str:
        raise InputError("the table ends at 2.3 rad/s")

    parts = MissingParts()
    assert parts.computed("the motions in waves", refused, "") == ""
    assert parts.computed("the inverse", lambda: float(np.linalg.inv(np.zeros((2, 2)))[0, 0]), 0.0) == 0.0
    assert parts.computed("the mean", lambda: 3.0, 0.0) == 3.0
    first, second = parts.findings
    assert first.code == "part-missing"
    assert first.text == (
        "the result is without the motions in waves, which could not be computed (the table ends at 2.3 rad/s)"
    )
    assert second.evidence == "LinAlgError: Singular matrix"
