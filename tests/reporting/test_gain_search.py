"""The chapter on a published search: one table with the own front, what it cost, and nothing without a search."""

from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_tuning import fabricated_fin
from tests.reporting.section_text import cells, header

from seatrial.cli.application import result_document
from seatrial.cli.result_output import print_tuning
from seatrial.core.results.tuning import GainSearch, Tuning, TuningMethod
from seatrial.reporting.tuning import html
from seatrial.reporting.tuning_rows import convergence_chart, scatter_chart, search_sentences, search_table


@pytest.fixture(scope="module")
def tuning() -> Tuning:
    """A tuning whose gains come from a search of three seeds."""
    plain = fabricated_fin()
    gains = np.array([list(plain.chosen.gains.values()), [30.0, 2.0, 10.0], [80.0, 40.0, 90.0]])
    search = GainSearch(
        source="Yu et al. 2014", settings={"population": "50"}, objectives={"J1": "rad^2", "J2": "", "J3": "rad^2/s^2"},
        evaluations=10_000, cpu_s=0.05, histories=np.linspace(0.9, 0.3, 30).reshape(3, 10),
        gain_names=("KP", "KI", "KD"), lower=np.zeros(3), upper=np.array([100.0, 50.0, 100.0]), gains=gains,
        spread=np.ptp(gains, axis=0) / [100.0, 50.0, 100.0], values=np.tile(plain.chosen.objectives, (3, 1)),
        Ms=np.array([1.5, 2.5, 80.0]), is_feasible=(True, False, False), dominated=2, hypervolume=0.61,
    )  # fmt: skip
    own = replace(plain.baselines[0], name="own front")
    return replace(plain, method=TuningMethod.GENETIC, search=search, reference=own)


def test_one_table_has_the_own_front_the_answer_and_the_scatter(tuning: Tuning) -> None:
    table = search_table(tuning)
    assert header(table) == ("", "own front", "genetic algorithm", "least", "median", "largest")
    rows = {row[0]: row[1:] for row in cells(table)}
    assert rows["KP"] == ("11.05", "19.4", "19.4", "30", "80")
    assert rows["Ms"][2:] == ("1.5", "2.5", "80")
    assert rows["keeps the limits"] == ("yes", "yes", "", "1 of 3", "")
    assert rows["evaluations"][1] == "10\N{NARROW NO-BREAK SPACE}000" or rows["evaluations"][1].startswith("10")


def test_what_the_search_covers_and_costs_is_said(tuning: Tuning) -> None:
    covered, cost = search_sentences(tuning)
    assert "covers 0.61" in covered
    assert "0.050 s of CPU time" in cost


def test_curves_and_bars_show_every_seed(tuning: Tuning) -> None:
    assert tuning.search is not None
    assert len(convergence_chart(tuning.search).legend) == 3
    assert scatter_chart(tuning.search) is not None


def test_page_terminal_and_document_have_it(tuning: Tuning, capsys: pytest.CaptureFixture) -> None:
    page = html(tuning)
    assert "The published search" in page and "Settings of the search" in page
    assert "Answer of the genetic algorithm" in page and "Recommendation" not in page
    print_tuning(tuning)
    said = capsys.readouterr().out
    assert "own front" in said and "s of CPU time" in said
    assert "one genetic search: 10000 controllers tried, 0.0500 s of CPU time; made with 3 seeds; front of" in said
    document = result_document(tuning)
    assert document["method"] == "genetic" and document["search"]["evaluations"] == 10_000
    assert len(document["search"]["history"]) == 10 and document["search"]["cpu_s"] == 0.05
    assert document["reference"]["name"] == "own front"


def test_without_a_search_there_is_no_chapter() -> None:
    plain = fabricated_fin()
    assert not search_table(plain) and search_sentences(plain) == ()
    assert "The published search" not in html(plain)
    assert "Recommended gains" in html(plain)
