"""The page of a verification: sections that have content, sentences, and marks."""

from dataclasses import replace

import numpy as np
from tests.reporting.section_text import cells

from seatrial.core.results.verification import (
    ModelCorrection,
    ReductionEstimate,
    Verification,
    VerifiedChange,
    VerifiedLeg,
    VerifiedQuantity,
)
from seatrial.reporting.pages import report_page
from seatrial.reporting.verification import (
    changes_chart,
    html,
    key_facts,
    quantity_forest,
    sections,
    spectra_chart,
    verdict,
)

NAN = float("nan")
REDUCTION = VerifiedQuantity("reduction", "1", 0.78, 0.77, 0.79, 0.65, 0.6, 0.7, False)
OMEGA = np.linspace(0.5, 1.3, 9)
LEG = VerifiedLeg("leg <1>", 0.0, 900.0, True, 9.0, 2.0, 1.8, 2.2, 8.0, 7.8, 8.2, 0.02, 0.1, 0.97, 0.99, OMEGA,
                  np.ones(9), 2.0 * np.ones(9))  # fmt: skip
MOVED = ModelCorrection("K", "1/s", 0.2, 0.01, 0.14, 0.13, 0.15, True)
LEGS = Verification(
    "fins", "as given", "phi", "alpha_f", {"KP": 11.0}, (LEG, replace(LEG, is_controlled=False, gain_ratio=NAN)),
    (REDUCTION,), (ReductionEstimate("legs as they are", 0.66, 0.6, 0.72),), (MOVED,), (), {"numpy": "2"},
)  # fmt: skip
SERIES = np.linspace(0.0, 0.35, 50)
CHANGE = VerifiedChange("turns", 120.0, 0.35, 0.0, 0.02, 40.0, 43.0, "psi", "delta", 0.5, SERIES, SERIES, SERIES,
                        SERIES, SERIES)  # fmt: skip
TURNS = replace(
    LEGS, output="psi", actuator="delta", legs=(), reductions=(), corrections=(), changes=(CHANGE,),
    quantities=(
        VerifiedQuantity("overshoot", "1", 0.02, 0.01, 0.03, 0.022, NAN, NAN, True),
        VerifiedQuantity("settling time", "s", 40.0, 37.0, 44.0, 50.0, NAN, NAN, False),
    ),
)  # fmt: skip


def test_the_verdict_gives_what_was_achieved_and_whether_it_was_predicted() -> None:
    assert verdict(LEGS) == (
        "The controller took 65.0 % off the roll angle (95 % interval 60.0 to 70.0 %), not as predicted: the model "
        "says 78.0 %."
    )
    assert verdict(TURNS) == (
        "Changes of the heading overshoot by 2.2 % (predicted 1.0 to 3.0 %) and settle in 50.0 s (predicted 37.0 to "
        "44.0 s)."
    )


def test_tables_are_those_that_have_rows() -> None:
    legs, turns = ({chapter.key: cells(chapter.table) for chapter in sections(v)} for v in (LEGS, TURNS))
    assert list(legs) == ["quantities", "reductions", "model", "legs", "method"]
    assert list(turns) == ["quantities", "changes", "method"]
    assert legs["quantities"][0] == ("reduction", "%", "78.0", "77.0 to 79.0", "65.0", "60.0 to 70.0", "outside")
    assert turns["quantities"][1][5:] == ("–", "outside")
    assert legs["legs"][1][-1] == "–"


def test_key_facts_name_what_moved() -> None:
    facts = {fact.name: fact for fact in key_facts(LEGS)}
    assert (facts["Model"].text, facts["Model"].is_good) == ("K: 0.2 → 0.14", False)
    assert facts["Legs"].text == "1 with control, 1 without"
    assert facts["Outside"].text == "reduction"
    assert {fact.name: fact for fact in key_facts(TURNS)}["Model"].text == "not estimated anew"


def test_pages_have_their_figures_and_escape_names() -> None:
    page = html(LEGS)
    assert "leg &lt;1&gt;" in page
    assert "leg <1>" not in page
    assert report_page(LEGS) == page
    assert "time from the order" in html(TURNS)
    assert changes_chart(LEGS) is None
    assert spectra_chart(TURNS) is None
    assert len(quantity_forest(TURNS).panels) == 1
