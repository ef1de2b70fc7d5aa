"""The page of a study: claims, verdicts, checks; empty sections are left out; JSON keys as promised."""

from pathlib import Path

from seatrial.core.results import Claim, Study, Verdict
from seatrial.data.folder.document import document
from seatrial.reporting.study import html, outcome


def test_claims_and_checks_are_there(study_page: Path, study: Study) -> None:
    text = study_page.read_text()
    for word in ("confirmed", "refuted", "unknowable", "holds", "fails", "0.85 to 1.2", study.source, "3.25",
                 "holds in its own setting", "search box about the truth", "few runs", "withdrawn"):  # fmt: skip
        assert word in text


def test_outcome_names_what_fails(study: Study) -> None:
    assert outcome(study) == [
        "Not all of them: the fit has two optima.",
        "4 claims judged: 1 confirmed, 1 holds in its own setting, 1 refuted, 1 unknowable.",
        "3 checks: 1 holding, 1 failing, 1 withdrawn. Failing: RMSE over bound.",
    ]


def test_empty_sections_are_left_out() -> None:
    bare = Study("bare", "Nobody 2020", (Claim("<b>", Verdict.UNKNOWABLE, "none"),), ())
    text = html(bare)
    assert 'href="#claims"' in text and 'href="#checks"' not in text and "<b>" not in text


def test_table_for_json(study: Study) -> None:
    table = document(study)
    assert table["claims"][0] == {
        "claim": "The model predicts a turn within 5 %", "verdict": "confirmed", "evidence": "advance −1.6 %",
    }  # fmt: skip
    assert table["claims"][2]["setting"] == "search box about the truth"
    assert [set(check) - {"name", "value", "limit", "holds"} for check in table["checks"]] == [
        set(), {"reason"}, {"withdrawal"},
    ]  # fmt: skip


def test_figures_of_every_kind_have_title_and_note(study_page: Path, study: Study) -> None:
    text = study_page.read_text()
    assert text.count("<figure") >= len(study.figures) == 4
    for figure in study.figures:
        assert figure.title in text and f'aria-label="{figure.title}"' in text and figure.note in text
