"""The chapter on a craft with thrusters: measures, curves and matrices as text; what ships have is left out."""

import re
from dataclasses import replace

import pytest
from tests.reporting.section_text import cells, part, text_of

from seatrial.core.results import (
    CommandCurve,
    CompassCurve,
    CraftMeasure,
    Extrapolation,
    Fit,
    FossenMatrix,
    ThrusterCraft,
)
from seatrial.physics.models import model_named
from seatrial.reporting.page import html
from seatrial.reporting.thruster_chapter import thruster_section

UNITS = (("kg",) * 3,) * 3
CRAFT = ThrusterCraft(
    force_unit="N/kg",
    measures={
        "top_speed": CraftMeasure(2.5595, 2.5523, 2.5668, "straight:100", 1.4),
        "stopping_time_s": CraftMeasure(1.26, None, None, "stop:100", 1.0),
    },
    curves=(
        CommandCurve(("port", "starboard"), (-1.0, 0.0, 1.0), (-1.1, 0.0, 1.6), (-1.2, 0.0, 1.5), (-1.0, 0.0, 1.7),
                    1.5, (-0.9, 0.0, 1.3), (-1.0, 0.0, 1.0), (0.25, 0.75)),
    ),
    matrices=(
        FossenMatrix("M", "mass and added mass", ((1.0, 0.0, 0.0), (0.0, 1.6, 0.0), (0.0, 0.0, 0.15)), UNITS),
        FossenMatrix("D", "linear damping", ((0.1, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 0.1)), UNITS),
        FossenMatrix("D_u", "damping with |u|", ((0.3, 0.0, 0.0), (0.0, -0.25, 0.0), (0.0, 0.0, 0.0)), UNITS),
        FossenMatrix("B", "forces over thrusts", ((1.0, 1.0), (0.0, 0.0), (0.3, -0.3)), (("1",) * 2,) * 3),
    ),
    thrusters=("port", "starboard"),
    left_out=("N_uv",),
    compass=CompassCurve((0.0, 3.14, 6.28), (0.1, -0.1, 0.1), (0.05, -0.15, 0.05), (0.15, -0.05, 0.15), (0.5, 0.5)),
)  # fmt: skip


def test_measures_have_digits_by_their_interval_and_a_mark_beyond_the_training_runs() -> None:
    chapter = thruster_section(CRAFT)
    assert cells(chapter.table)[0] == ("top speed, m/s, extrapolated", "2.56", "2.55", "2.57")
    assert cells(chapter.table)[1][:2] == ("stopping time, s", "1.26")
    assert "Extrapolated: beyond the training runs" in chapter.note


def test_damping_is_one_matrix_with_all_its_parts() -> None:
    _, damping, configuration = (cells(one.table) for one in part(thruster_section(CRAFT), "Matrices").parts)
    assert damping[0] == ("surge", "0.1000 + 0.3000 |u|", "0", "0")
    assert damping[1][2] == "0.5000 − 0.2500 |u|"
    assert configuration[2] == ("yaw", "0.3000", "−0.3000")


def test_ratios_to_the_mass_and_terms_without_a_matrix_are_named() -> None:
    _, *notes = part(thruster_section(CRAFT), "Matrices").sentences
    assert len(notes) == 2 and "N_uv" in notes[1]
    known = thruster_section(replace(CRAFT, force_unit="N", left_out=(), compass=None))
    assert len(part(known, "Matrices").sentences) == 1 and "Deviation of the compass" not in text_of(known)


@pytest.fixture(scope="module")
def page(fit: Fit) -> str:
    return html(replace(fit, model=model_named("thrusters"), thruster_craft=CRAFT))


def test_the_page_of_such_a_craft_has_no_imo_table_and_no_ship_lengths(page: str) -> None:
    assert "The craft at full command" in page
    assert "IMO standards" not in page
    assert 'position <span class="u">L' not in page and " L) (rms)" not in page


def test_the_page_of_a_ship_has_no_such_chapter(fit: Fit) -> None:
    text = html(fit)
    assert "The craft at full command" not in text and "IMO standards" in text


WITHOUT_RUDDER = ("waves", "roll", "thrusters")


def of_kind(fit: Fit, kind: str) -> Fit:
    """The fit as one of a craft without a rudder: its runs have no rudder angle, its model no such input."""
    model = model_named({"waves": "heave_pitch", "roll": "roll", "thrusters": "thrusters"}[kind])
    runs = tuple(
        replace(p, measured=p.measured.without("delta"), measures={}, extrapolation=Extrapolation(1.4, {"drift": 1.4}))
        for p in fit.predictions
    )
    assert fit.identifiability is not None and fit.identifiability.stability is not None
    stability = replace(fit.identifiability.stability, text="the craft is course stable at 1.6 m/s")
    return replace(
        fit, model=model, predictions=runs, records=tuple(r.without("delta") for r in fit.records), offsets=(),
        thruster_craft=CRAFT if kind == "thrusters" else None, frequency_responses=(), findings=(), question="",
        identifiability=replace(fit.identifiability, stability=stability if kind == "thrusters" else None),
        ship=replace(fit.ship, name="craft"),
    )  # fmt: skip


@pytest.mark.parametrize("kind", WITHOUT_RUDDER)
def test_the_page_of_a_craft_without_a_rudder_does_not_speak_of_one(fit: Fit, kind: str) -> None:
    text = re.sub(r"(?s)<(script|style).*?</\1>", "", html(of_kind(fit, kind)))
    found = re.findall(r".{60}\brudder\b.{20}", text)
    assert not found
    if kind == "thrusters":
        assert "a craft with equal orders of its thrusters returns to a straight course" in text
        assert "largest ratio of yaw rate, drift, command or speed" in text


def test_the_page_of_a_ship_with_a_rudder_does(fit: Fit) -> None:
    text = html(fit)
    assert "a ship with the rudder amidships returns to a straight course" in text
    assert "largest ratio of yaw rate, drift, rudder or speed" in text
