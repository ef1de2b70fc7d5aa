"""The page of a tuning says what the gains do and how near instability is; it is whole and asks for nothing."""

import math
import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from tests.reporting.fabricated_tuning import fabricated_autopilot, fabricated_bare, fabricated_fin
from tests.reporting.section_text import cells
from tests.reporting.test_page import HOSTILE, parsed

from seatrial.core.results.tuning import PairedDifference, Tuning
from seatrial.core.values import Finding, Severity
from seatrial.reporting.section import KeyFact
from seatrial.reporting.station_part import (
    capability_figure,
    capability_sentence,
    corner_figure,
    corner_sentence,
    footprint_figure,
    front_figure,
    gain_rows,
    margin_sentence,
    precision_sentence,
    thruster_rows,
    track_rows,
)
from seatrial.reporting.tuning import html
from seatrial.reporting.tuning_rows import (
    disturbance_headings,
    disturbance_rows,
    gain_texts,
    schedule_table,
    transfer_latex,
)
from seatrial.reporting.tuning_text import (
    comparison_sentence,
    demand_sentence,
    energy_sentence,
    guidance_sentence,
    key_facts,
    verdict,
)

LARGEST = 600_000
MADE = {"fin": fabricated_fin, "autopilot": fabricated_autopilot, "bare": fabricated_bare}
SECTIONS = {
    "fin": {
        "reasons",
        "findings",
        "controllers",
        "front",
        "margins",
        "robustness",
        "simulation",
        "schedule",
        "bounds",
        "loop",
        "method",
    },
    "autopilot": {"controllers", "disturbances", "margins", "manoeuvres", "station", "track", "loop", "method"},
    "bare": {"controllers", "method"},
}


@pytest.fixture(scope="module")
def fin() -> Tuning:
    return fabricated_fin()


@pytest.fixture(scope="module")
def page(fin: Tuning) -> str:
    return html(fin)


@pytest.mark.parametrize("name", sorted(MADE))
def test_it_is_small_whole_and_asks_for_nothing(name: str) -> None:
    text = html(MADE[name]())
    tags = parsed(text)
    assert len(text.encode()) < LARGEST
    assert not re.search(r"@import|url\((?!#)", text)
    assert all(link.startswith(("#", "data:,")) for link in tags.links)
    assert {link[1:] for link in tags.links if link.startswith("#")} == SECTIONS[name]
    assert set(tags.ids) >= SECTIONS[name]
    assert not re.search(r"\b(nan|inf)\b", text)


def test_it_has_what_the_tuning_holds(page: str, fin: Tuning) -> None:
    for word in (fin.question, fin.plant, *fin.seas, *fin.reasons, *fin.objectives, *(c.name for c in fin.baselines),
                 *(c.name for c in fin.components), *(b.name.replace("'", "&#39;") for b in fin.bounds),
                 *(f.code for f in fin.findings), fin.front.name, fin.extended_fronts[0].name):  # fmt: skip
        assert word in page
    assert page.count("<svg xmlns") == 10
    assert page.count("<mfrac>") == 7


def test_disturbances_are_shown_predicted_and_simulated() -> None:
    autopilot = fabricated_autopilot()
    assert disturbance_rows(autopilot) == [
        ("slow disturbance", "0.602", "0.591 ± 0.02", "0.630", "1.40", "1.55", "0.292", "0.280")
    ]
    assert [count for *_, count in disturbance_headings(autopilot)] == [3, 2, 2]
    assert "0.591 ± 0.02" in html(autopilot)


def test_a_station_is_shown_with_its_precision_margins_and_capability() -> None:
    autopilot = fabricated_autopilot()
    station = autopilot.station
    assert station is not None
    assert (precision_sentence(station), margin_sentence(station), capability_sentence(station)) == (
        "In 0.3 m/s of current from 4 directions the craft stays within 0.780 m 95 % of the time (0.440 m rms, 0.420 m "
        "by linear theory). The heading is kept to 15° rms (11°), with 9.0 % of full thrust (rms). Of 100 craft that "
        "the fit allows 99 keep the place (0.930 m at most).",
        "Natural frequencies: 0.40 rad/s of position, 0.70 rad/s of heading. Ms of surge, sway and yaw 1.59, 1.42 and "
        "1.58, of all together 1.92; delay margin 0.92 s beyond 0.15 s of dead time.",
        "The thrusters hold a steady current of 1.10 m/s from any direction; shared out as the controller does, 1.00 "
        "m/s. They hold least from 90° off the bow, where bow and stern are at their limits, and 2.00 m/s from 0°.",
    )
    assert gain_rows(station)[0] == ("K_p", "in surge, from the error in surge", "13.00", "N/m")
    assert len(gain_rows(station)) == 8
    assert thruster_rows(station)[1] == ("stern", "−40.0", "60.0", "10")
    page = html(autopilot)
    assert all(figure(station) in page for figure in (footprint_figure, capability_figure, front_figure))
    assert rows(autopilot)["Station"].text == precision_sentence(station)
    assert not rows(autopilot)["Station"].is_good


def test_a_track_is_shown_with_its_guidance_and_corner() -> None:
    autopilot = fabricated_autopilot()
    track = autopilot.track
    assert track is not None
    assert guidance_sentence(track) == (
        "Line of sight with a lookahead distance of 300 m and an integral gain of 1.50 m/s, at 7.00 m/s; with the "
        "heading loop closed Ms 1.60, gain margin 12 dB, phase margin 48° and delay margin 35 s."
    )
    assert corner_sentence(track) == (
        "At a corner of 60°, taken 200 m before it, the craft goes 41.0 m beyond the new leg and settles on it, in 0.3 "
        "m/s of current towards the outside. Of 100 ships that the fit allows 99 keep a track (55.0 m at most)."
    )
    assert track_rows(autopilot, track) == [
        ("current of 0.3 m/s", "12.3", "12.1 ± 0.4", "12.2", "1.15", "1.15", "0.115", "0.115")
    ]
    assert corner_figure(track) in html(autopilot)
    assert rows(autopilot)["Track"].text == guidance_sentence(track)


def test_the_same_tuning_gives_the_same_bytes(page: str) -> None:
    assert html(fabricated_fin()) == page


def rows(tuning: Tuning) -> dict[str, KeyFact]:
    return {fact.name: fact for fact in key_facts(tuning)}


def test_the_recommendation_is_stated_in_degrees_and_per_cent(fin: Tuning) -> None:
    facts = rows(fin)
    assert verdict(fin) == (
        "Simulated with all limits, these gains reduce the roll angle by 68.2 %; without limits, by 74.2 %."
    )
    assert verdict(replace(fin, seaway_simulations=())) == (
        "By linear theory these gains reduce the roll angle by 74.0 %, to 2.1° rms."
    )
    assert facts["Margins"].text.startswith(
        "Gain margin 9 dB, phase margin 86° and delay margin 0.48 s. Sensitivity peak Ms 1.67 (2 allowed)"
    )
    assert facts["Actuator"].text.endswith("2.3 % of its rates exceed 25°/s (20 % allowed).")
    assert "with stall beyond 18°" in facts["Simulated"].text
    better = "it is better than ‘given’ by 7.1 points (95 % interval 6.2 to 8.0, 20 realisations)."
    assert better in facts["Compared"].text
    assert "does not differ significantly from ‘given’" in facts["Compared"].text
    assert facts["Schedule"].text.partition(". ")[0].endswith("kept in 17 of 18")
    assert facts["Schedule"].is_good is False


def test_other_ships_are_held_only_within_the_peak_allowed(fin: Tuning) -> None:
    (first, *others), peak = fin.robustness, fin.constraints.Ms
    held = replace(first, stable_draws=first.draws, draws_Ms=peak, corners_Ms=peak)
    for robustness, is_good in ((held, True), (replace(held, corners_Ms=1.1 * peak), False), (first, False)):
        assert rows(replace(fin, robustness=(robustness, *others)))["Other ships"].is_good is is_good


def test_what_is_worse_is_called_worse() -> None:
    assert "it is worse than ‘x’ by 3.0 points" in comparison_sentence(
        PairedDifference("x", "limited", -0.03, -0.04, -0.02, 20)
    )


def test_an_unstable_loop_is_not_recommended() -> None:
    assert verdict(fabricated_bare()) == "The loop is unstable with these gains: do not use them."
    assert "Margins" not in rows(fabricated_bare())


def test_restrictions_that_are_broken_are_stated(fin: Tuning) -> None:
    broken = replace(fin, chosen=replace(fin.chosen, violated=("Ms 2.3, 2 allowed",)))
    assert rows(broken)["Constraints"] == KeyFact(
        "Constraints", "It violates the constraints: Ms 2.3, 2 allowed.", "controllers", is_good=False
    )
    text = html(fin)
    assert text.count(">violated<") == 1 and text.count("infeasible") == sum(not s.is_feasible for s in fin.schedule)


def test_demands_are_stated_with_the_ships_drawn() -> None:
    chosen, given = fabricated_autopilot().manoeuvres
    assert demand_sentence(chosen) == (
        "In the course change of 20 deg it does not overshoot and settles in 96.0 s. Of 100 ships that the fit "
        "allows 100 are stable, and each overshoots by 0.4 % at most."
    )
    assert demand_sentence(given).endswith("overshoots by 6.8 % and does not settle.")
    assert demand_sentence(replace(chosen, worst_overshoot=0.0)).endswith("are stable, and none overshoots.")
    lost = replace(chosen, stable_draws=99, worst_overshoot=math.inf)
    assert demand_sentence(lost).endswith("Of 100 ships that the fit allows 99 are stable; "
                                   "the simulation of at least one diverges.")  # fmt: skip


def test_a_loop_that_follows_is_judged_by_what_is_left() -> None:
    autopilot = fabricated_autopilot()
    changed = replace(autopilot, chosen=replace(autopilot.chosen, reduction=0.9999))
    assert verdict(changed).startswith("By linear theory 0.60° rms of the heading remains, with 1.4° and 0.29°/s rms")
    assert "reduction" not in html(changed)


def test_findings_stand_by_severity(fin: Tuning) -> None:
    grave = Finding(Severity.ERROR, "grave", "It capsizes")
    text = html(replace(fin, findings=(*fin.findings, grave)))
    assert text.index("<code>grave") < text.index("<code>gain-bound") < text.index("<code>schedule")


def test_a_schedule_that_is_unstable_elsewhere_says_so(fin: Tuning) -> None:
    lost = replace(fin.schedule[0], baseline_costs={"given": math.inf, "chosen everywhere": 0.3})
    changed = replace(fin, schedule=(lost, *fin.schedule[1:]))
    assert "‘given’ is unstable in 1" in rows(changed)["Schedule"].text
    assert "unstable" in cells(schedule_table(changed.schedule))[0]


def test_what_rounding_left_of_a_zero_is_zero() -> None:
    rows = [{"KP": 12.5, "KI": 7e-15}, {"KP": 3.0, "KI": 0.25}, {"KP": 1e-6}]
    assert gain_texts(rows, ["KP", "KI"]) == [
        ("12.5", "0"),
        ("3", "0.25"),
        ("1×10⁻⁶".replace("×", "\u202f×\u202f"), "–"),
    ]


def test_a_rival_off_the_front_s_scale_or_unstable_is_no_trouble(fin: Tuning) -> None:
    lost = replace(fin.baselines[0], objectives=np.full(3, np.inf), Ms=math.inf, gain_margin=math.nan,
                   phase_margin=math.nan, delay_margin=math.nan, reduction=-math.inf)  # fmt: skip
    text = html(replace(fin, baselines=(lost,)))
    assert not re.search(r"\b(nan|inf)\b", text)


@pytest.mark.parametrize(
    ("num", "den", "latex"),
    [
        ((400.0, 0.0), (1.0, 80.0, 4000.0), r"\frac{400 s}{s^{2} + 80 s + 4000}"),
        ((1.0,), (1.0,), "1"),
        ((-1.0, 2.0), (1.0,), "-s + 2"),
        ((3e-7,), (1.0, 0.0), r"\frac{3 \cdot 10^{-7}}{s}"),
        ((0.0,), (1.0,), "0"),
    ],
)
def test_transfer_functions_read_as_in_a_book(num: tuple[float, ...], den: tuple[float, ...], latex: str) -> None:
    assert transfer_latex(num, den) == latex


@pytest.mark.parametrize("make", [fabricated_fin, fabricated_autopilot])
def test_text_from_files_is_escaped(make: Callable[[], Tuning]) -> None:
    tuning = make()
    hostile = replace(
        tuning, question=HOSTILE, name=HOSTILE, plant=HOSTILE, seas=(HOSTILE,), reasons=(HOSTILE,),
        baselines=tuple(replace(c, name=HOSTILE, violated=(HOSTILE,)) for c in tuning.baselines),
        objectives=dict(zip((HOSTILE, *list(tuning.objectives)[1:]), tuning.units, strict=True)),
        front=replace(tuning.front, name=HOSTILE),
        components=tuple(replace(c, name=HOSTILE, source=HOSTILE) for c in tuning.components),
        seaway_simulations=tuple(replace(s, name=HOSTILE) for s in tuning.seaway_simulations),
        schedule=tuple(replace(s, baseline_costs={HOSTILE: 0.3}) for s in tuning.schedule),
        bounds=tuple(replace(b, note=HOSTILE) for b in tuning.bounds),
        manoeuvres=tuple(replace(m, name=HOSTILE) for m in tuning.manoeuvres),
    )  # fmt: skip
    assert parsed(html(hostile)).scripts == parsed(html(tuning)).scripts


def test_energy_saved_is_said_in_megajoules_with_its_interval() -> None:
    saved, lost, equal = (
        energy_sentence(PairedDifference("x", "stalled", *ends, 20))
        for ends in ((9.48e6, 8.97e6, 1.0e7), (-2e6, -3e6, -1e6), (1e5, -1e6, 1.2e6))
    )
    assert saved == "That is 9.48 MJ less than by ‘x’ (95 % interval 8.97 to 10.0, 20 realisations)."
    assert lost == "That is 2.00 MJ more than by ‘x’ (95 % interval 1.00 to 3.00, 20 realisations)."
    assert equal.startswith("The difference to ‘x’ is not significant: 0.100 MJ less (95 % interval −1.00 to 1.20")


def test_equal_controllers_share_one_row() -> None:
    tuning = fabricated_fin()
    given = tuning.baselines[0]
    same = replace(tuning, designs=(replace(tuning.chosen, name="hard-working"),))
    assert [c.name for c in same.compared] == ["chosen, hard-working", *(c.name for c in tuning.baselines)]
    assert given.name in tuning.shared_names and len(tuning.compared) == len(tuning._named)
