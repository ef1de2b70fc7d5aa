"""The page of a design says what it is worth, how to steer it and where it fails; it is small and asks for nothing."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.test_page import HOSTILE, parsed

from seatrial.core.results import Actuator, Design, TimedOrder, TrialLimits
from seatrial.reporting.design import (
    actuator_text,
    html,
    key_facts,
    minutes_seconds,
    order_table,
    order_warnings,
    percent_text,
    sections,
    verdict,
)
from seatrial.reporting.measures import manoeuvre_name
from seatrial.reporting.section import KeyFact

LARGEST = 300_000


@pytest.fixture(scope="module")
def design() -> Design:
    return fabricated_design()


@pytest.fixture(scope="module")
def page(design: Design) -> str:
    return html(design)


def test_it_is_small_whole_and_asks_for_nothing(page: str) -> None:
    tags = parsed(page)
    assert len(page.encode()) < LARGEST
    assert not re.search(r"@import|url\((?!#)", page)
    assert all(link.startswith(("#", "data:,")) for link in tags.links)
    assert {link[1:] for link in tags.links if link.startswith("#")} <= set(tags.ids)


def test_it_has_what_the_design_holds(page: str, design: Design) -> None:
    for word in (
        design.question,
        design.ship,
        *design.coefficients,
        *(manoeuvre_name(w.name) for w in design.baselines),
        "design-drift",
    ):
        assert word in page
    assert page.count("<svg") >= 4 and 'class="series"' in page
    assert "leaves the limits" in page


def test_the_same_design_gives_the_same_bytes(page: str) -> None:
    assert html(fabricated_design()) == page


def rows(design: Design) -> dict[str, KeyFact]:
    return {fact.name: fact for fact in key_facts(design)}


def test_the_verdict_compares_with_the_best_that_keeps_the_limits(design: Design) -> None:
    best = 100.0 * design.baselines[1].worst
    assert f"; the best standard manoeuvre within the limits has {best:.0f} %." in verdict(design)
    facts = rows(design)
    drawn = facts["Ships that differ"].text
    assert drawn.endswith("smaller than with any standard manoeuvre within the limits on 5 of 5.")
    assert facts["Simulated trials"].text == (
        "39 of 40 simulated trials could be fitted; their errors are 0.91 to 1.11 of those predicted."
    )
    assert facts["Limits"].text.startswith(
        "The ship as assumed reaches at most a drift angle of 18.0° (20.0° allowed) and "
    )


def test_errors_of_simulated_trials_beyond_those_predicted_are_marked_with_the_coefficient(design: Design) -> None:
    confirmation = design.confirmation
    assert confirmation is not None
    errors = confirmation.bound.copy()
    errors[2] *= 9.0
    fact = rows(replace(design, confirmation=replace(confirmation, error=errors)))["Simulated trials"]
    assert fact.is_good is False
    assert fact.text.endswith(
        f"their errors are 1.00 to 9.00 of those predicted, most that of {design.coefficients[2]}."
    )
    untried = replace(design, confirmation=replace(confirmation, converged_runs=0, error=np.full(11, np.nan)))
    assert rows(untried)["Simulated trials"].is_good is None


def test_a_design_that_is_no_better_says_so(design: Design) -> None:
    worse = replace(design, designed=replace(design.designed, relative_error=design.baselines[0].relative_error * 2.0))
    assert ", no better: the best" in verdict(worse)


def test_a_design_that_leaves_the_limits_says_so_where_the_orders_stand(design: Design) -> None:
    straying = replace(design, limits=TrialLimits(math.radians(10.0)))
    fact = rows(straying)["Limits"]
    assert "leaves the limits: it reaches" in fact.text and fact.is_good is False
    assert any("leaves the limits: it reaches" in text for text in order_warnings(straying))
    card = next(chapter for chapter in sections(straying) if chapter.key == "orders")
    assert any("leaves the limits: it reaches" in text for text in card.sentences) and card.table
    assert order_warnings(replace(design, findings=())) == []


def test_a_ship_that_is_lost_is_said(design: Design) -> None:
    drawn = design.designed.sampled_relative_error.copy()
    drawn[1] = np.nan
    changed = replace(design, designed=replace(design.designed, sampled_relative_error=drawn))
    assert rows(changed)["Ships that differ"].text.endswith("on 4 of 5; 1 ship cannot be simulated.")


def test_a_design_with_next_to_nothing_renders(design: Design) -> None:
    first = replace(
        design.designed,
        sampled_relative_error=np.empty((0, 11)),
        executed=design.plan,
        relative_error=np.full(11, np.inf),
    )
    bare = replace(
        design,
        designed=first,
        baselines=(),
        confirmation=None,
        findings=(),
        limits=TrialLimits(),
        orders=(),
        question="",
    )
    text = html(bare)
    for absent in ("#ships", "#confirmation", "#findings", "#track"):
        assert f'href="{absent}"' not in text
    assert "there is no standard manoeuvre to compare it with" in text


def test_text_from_files_is_escaped(design: Design) -> None:
    text = html(replace(design, question=HOSTILE, ship=HOSTILE))
    assert HOSTILE not in text


def test_times_are_read_off_a_stopwatch() -> None:
    assert [minutes_seconds(t) for t in (0.0, 7.5, 65.0, 600.0, 59.999)] == ["0:00", "0:07.5", "1:05", "10:00", "1:00"]


def test_orders_stand_side_by_side_in_their_order(design: Design) -> None:
    table = order_table(design)
    assert [heading.title for heading in table.headings] == ["time", "delta", "time", "delta"]
    lines = [[cell.text for cell in row.cells] for row in table.rows]
    times = [line[k] for k in (0, 2) for line in lines]
    assert times[: len(design.orders)] == [minutes_seconds(o.time) for o in design.orders]
    assert lines[0][1] == "−29"


def test_an_order_that_leaves_an_input_alone_has_a_dash(design: Design) -> None:
    two = (*design.actuators, Actuator("v_j", 0.0, 3.0, math.inf, 6.0))
    changed = replace(design, actuators=two, orders=(TimedOrder(0.0, {"v_j": 1.5}),))
    assert [[cell.text for cell in row.cells] for row in order_table(changed).rows] == [["0:00", "–", "1.5"]]


def test_numbers_are_people_s() -> None:
    assert [percent_text(x) for x in (0.0123, 0.5, 12.34, math.inf)] == ["1.2", "50", "1\u202f200", "> 10\u202f000"]
    jumping = Actuator("delta", -0.1, 0.1, math.inf, 4.0)
    assert actuator_text(jumping) == "delta −5.72958 to 5.72958 deg, may jump, orders 4 s apart at least"
