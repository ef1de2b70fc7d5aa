"""A page from a file: rows are refused or worded, rules give verdicts, declarations are complete."""

from typing import Any

import numpy as np
import pytest

from seatrial.core.results import Curve, Figure, Verdict
from seatrial.core.values import InputError
from seatrial_studies.study_file import parse_study, read_study, shared_phrases
from seatrial_studies.study_page import Facts, FactTable, StudyPage, fact_text, worded

HEAD = """
name = "turning"
source = "a paper"
title = "Turning"
question = "Does it turn?"
paper_figures = [["Figure 1", "heave", ["Heave", "Pitch"]], ["Figure 2", "a block diagram", "It shows no result."]]
symbols = [["m", "mass", "kg", "1"]]
assumptions = [["h", "lost", "2 m"]]
deviations = [["eq. 1", "+", "-", "sign"]]
limits = { near = 0.1 }
"""
CLAIM = """
[[claims]]
claim = "It turns to {side}"
section = "section 2"
evidence = "turns"
wording = "off by {error:.1%}{more}"
rule = [
    { verdict = "holds in its own setting", when = [["error", "at most", "near"]], setting = "to {side}" },
    { verdict = "refuted" },
]
[claims.phrases]
more = { when = ["is_far"], then = ", which is far" }
"""
CHECK = """
[[checks]]
name = "error to {side}"
evidence = "turns"
value = "error"
at_most = "near"
"""
TABLES = """
[[tables]]
title = "Turns"
evidence = "all_turns"
header = ["side", "error"]
rows = [["limit", "{near}"]]
[[tables]]
declarations = true
note = "Two runs."
"""
FIGURE = """
[[figures]]
title = "Track to {side}"
evidence = "turns"
x_label = "y"
y_label = "x"
is_map = true
"""
FACTS = FactTable[dict[str, float]]()


@FACTS.declare
def turns(evidence: dict[str, float]) -> list[Facts]:
    track = Curve("track", np.zeros(2), np.ones(2))
    return [{"side": side, "error": e, "is_far": e > 0.5, "curves": [track]} for side, e in evidence.items()]


@FACTS.declare
def all_turns(evidence: dict[str, float]) -> Facts:
    return {"rows": list(evidence.items())}


def page() -> StudyPage[dict[str, float]]:
    declared = parse_study(HEAD + CLAIM + CHECK + TABLES + FIGURE, "study.toml")
    return StudyPage(declared, FACTS, {"port": 0.05, "starboard": 0.75})


def test_a_row_stands_once_for_each_group_of_facts_and_its_rule_gives_the_verdict() -> None:
    port, starboard = page().claims()
    assert (port.claim, port.verdict) == ("It turns to port (section 2)", Verdict.HOLDS_IN_OWN_SETTING)
    assert (port.setting, port.evidence) == ("to port", "off by 5.0 %")
    assert (starboard.verdict, starboard.evidence) == (Verdict.REFUTED, "off by 75.0 %, which is far")
    assert [(c.name, c.holds, c.limit) for c in page().checks()] == [
        ("error to port", True, 0.1), ("error to starboard", False, 0.1),
    ]  # fmt: skip


def test_tables_have_declared_rows_before_computed_ones_and_figures_are_drawn() -> None:
    turned, *declared = page().tables()
    assert turned.rows == (("limit", 0.1), ("port", 0.05), ("starboard", 0.75))
    titles = {table.title: table for table in declared}
    assert list(titles) == ["Figures of the paper", "Symbols", "Assumed", "Deviations from the print"]
    assert titles["Assumed"].note == "Two runs."
    assert titles["Figures of the paper"].rows[0] == ("Figure 1", "heave", "Heave, Pitch")
    drawn = page().figures()
    assert all(isinstance(figure, Figure) and figure.is_map for figure in drawn)
    assert page().file.missing_counterparts(["Pitch"]) == ("Heave",)


@pytest.mark.parametrize(
    ("line", "changed", "words"),
    [
        ('section = "section 2"', 'sections = "2"', "sections.*not permitted"),
        ('["Heave", "Pitch"]', '""', "paper_figures.*at least 1"),
        ('{ verdict = "refuted" },', "", "has to hold always"),
        ('at_most = "near"', "", "one limit"),
        ('"refuted"', '"untrue"', "claims.0.rule"),
        ("[[tables]]", "[tables", "no TOML"),
    ],
)
def test_a_file_that_is_wrong_is_refused_with_the_key(line: str, changed: str, words: str) -> None:
    text = HEAD + CLAIM + CHECK + TABLES + FIGURE
    with pytest.raises(InputError, match=words):
        parse_study(text.replace(line, changed, 1), "study.toml")


@pytest.mark.parametrize(
    ("fact", "form", "text"),
    [
        (0.1234, ".1%", "12.3 %"), (0.1234, "~2%", "12 %"), (3.14159, "~3", "3.14"), ([1.0, 2.0], ".1f", "1.0/2.0"),
        (np.array([0.3, 0.1]), ".0% to", "10 to 30 %"), ([0.1, 0.2], ".0% and", "10 % and 20 %"),
        (("a", "b"), " ,", "a, b"), ((), " ,", "none"), ("word", "", "word"), (7, "", "7"),
    ],
)  # fmt: skip
def test_facts_become_words(fact: Any, form: str, text: str) -> None:
    assert fact_text(fact, form) == text


def test_a_wording_without_its_fact_is_refused() -> None:
    with pytest.raises(InputError, match=r"no fact 'speed\.mean'"):
        worded("at {speed.mean} m/s", {"speed": 1.0})


def test_one_row_does_not_take_one_fact_from_two_functions() -> None:
    table = FactTable[int]()

    @table.declare
    def turns(_: int) -> Facts:
        return {"near": 0.3}

    declared = parse_study(HEAD + CLAIM + CHECK + TABLES + FIGURE, "study.toml")
    with pytest.raises(InputError, match="fact 'near'"):
        StudyPage(declared, table, 0).claims()


def test_evidence_that_no_function_computes_is_refused_with_the_nearest_key() -> None:
    declared = parse_study((HEAD + CLAIM + CHECK + TABLES).replace('"turns"', '"turn"'), "study.toml")
    with pytest.raises(InputError, match=r"no function computes the evidence 'turn'.*turns"):
        StudyPage(declared, FACTS, {"port": 0.05}).claims()


def test_two_functions_may_not_have_one_name() -> None:
    with pytest.raises(ValueError, match="rename one"):
        FACTS.declare(turns)


@pytest.mark.parametrize("name", ["alexandersson2022", "meng2014", "qi2025", "section2d", "song2025", "yu2014"])
def test_study_files_declare_their_own_study(name: str) -> None:
    assert read_study(name).name == name
    assert "work is counted" in shared_phrases()["time_is_no_verdict"]
