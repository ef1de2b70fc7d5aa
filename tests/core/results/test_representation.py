"""What an interactive session shows of a noun: a line or two, a table, HTML."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.reporting.complete_fit import tanker
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_study import fabricated_study
from tests.reporting.fabricated_tuning import fabricated_fin

from seatrial.core.results.fields import Summarised, Summary
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
