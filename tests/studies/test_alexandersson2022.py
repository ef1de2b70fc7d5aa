"""The KVLCC2 benchmark repeated: what a quick run promises, and verdicts and checks that can come out either way."""

import json
import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tests.reporting.fabricated import fabricated_fit

from seatrial import api
from seatrial.core.results import CandidateModel, CheckStatus, Claim, Study, Table, Verdict
from seatrial.core.values import Finding, InputError, Record, Severity
from seatrial.data.folder.document import document, strict_json
from seatrial_studies.alexandersson2022.facts import FACTS
from seatrial_studies.alexandersson2022.reproduction import (
    MEASURED_TURNS,
    PREDICTED_TURNS,
    SIDES,
    BandCoverage,
    BenchmarkReproduction,
    LeftOutRun,
    PredictionCoverage,
    TurnInterval,
    median_noise,
    percent_deviation,
    published_range,
)
from seatrial_studies.cross_validation import jackknife_error
from seatrial_studies.study_file import read_study
from seatrial_studies.study_page import StudyPage


@pytest.fixture(scope="module", params=[pytest.param("quick", marks=pytest.mark.long)])
def quick(data_folder: Path) -> Iterator[Study]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SEATRIAL_DATA", str(data_folder))
        yield api.reproduce("alexandersson2022", quick=True)


def test_quick_run_has_the_promised_keys(quick: Study) -> None:
    table = json.loads(strict_json(document(quick)))
    assert table["name"] == "alexandersson2022" and "112940" in table["source"]
    assert all(set(c) == {"claim", "verdict", "evidence"} for c in table["claims"])
    assert {c["verdict"] for c in table["claims"]} <= set(Verdict)
    assert [set(c) - {"withdrawal", "reason"} for c in table["checks"]] == [{"name", "value", "limit", "holds"}] * 12
    assert len(table["tables"]) == 6 and quick.elapsed_s > 0.0


def test_the_headers_labels_are_refuted(quick: Study) -> None:
    claim = next(c for c in quick.claims if "u, v, p, r" in c.claim)
    assert claim.verdict is Verdict.REFUTED
    assert "wrong-frame 13, mislabelled 13" in claim.evidence


def test_nothing_is_fitted_on_the_validation_run(quick: Study) -> None:
    offsets = next(t for t in quick.tables if t.title == "Offsets by run")
    assert len({row[0] for row in offsets.rows}) == 12
    assert not any("Z_35_05" in str(row[0]) for row in offsets.rows)
    assert [p.record for p in quick.predictions] == ["HSVA_CPMC_KVLCC2_Z_35_05"]


def test_the_page_and_the_json_are_written(quick: Study, tmp_path: Path) -> None:
    page = api.save(quick, tmp_path / "made")
    stored, printed = (
        json.loads((tmp_path / "made" / "study.json").read_text()),
        json.loads(strict_json(document(quick))),
    )
    assert [stored[key] for key in ("claims", "checks", "tables")] == [
        printed[key] for key in ("claims", "checks", "tables")
    ]
    assert "MARIN" in page.read_text() and page.name == "report.html"


def test_the_command_writes_report_and_json_and_prints_what_fails(
    tmp_path: Path,
    run_command: Callable[..., int],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture,
) -> None:
    repetition = made(factor=1.2)
    bare = Study("bare", "Nobody 2022", (claim(repetition, TURNING),), page(repetition).checks())
    installed = SimpleNamespace(name="bare", load=lambda: lambda **_: bare)
    monkeypatch.setattr("seatrial._plugins.entry_points", lambda group: [installed])  # noqa: ARG005
    code = run_command("reproduce", "bare", "--out", tmp_path / "out", "--json", tmp_path / "bare.json")
    said = capsys.readouterr().out
    assert code == 0 and re.search(r"35 deg turn to port, advance \[L\] +3\.7 +3\.01 to 3\.28 +fails", said)
    printed, stored = (json.loads(p.read_text()) for p in (tmp_path / "bare.json", tmp_path / "out" / "study.json"))
    assert printed.items() <= stored.items() and (tmp_path / "out" / "report.html").exists()


@pytest.mark.parametrize("folder", [None, "nowhere"])
def test_without_the_records_it_says_what_to_do(folder: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SEATRIAL_DATA", raising=False)
    if folder:
        monkeypatch.setenv("SEATRIAL_DATA", folder)
    with pytest.raises(InputError, match=r"SEATRIAL_DATA.*set it to their folder"):
        api.reproduce("alexandersson2022", quick=True)


def test_the_paper_s_errors_follow_from_its_table() -> None:
    errors = {
        m: [percent_deviation(getattr(PREDICTED_TURNS[s], m), getattr(MEASURED_TURNS[s], m)) for s in SIDES]
        for m in ("advance", "diameter")
    }
    assert errors["advance"] == pytest.approx([-1.8, -2.0], abs=0.05)
    assert errors["diameter"] == pytest.approx([6.2, 3.1], abs=0.05)
    assert published_range("advance") == pytest.approx((3.009, 3.283), abs=1e-3)


def made(heading: float = 8.0, position: float = 4.0, factor: float = 1.0, warm: float = 1.0) -> BenchmarkReproduction:
    """A repetition nobody computed: errors on the validation run, turns as a multiple of the measured ones."""
    fit = fabricated_fit()
    rms = {"psi_deg": heading, "position_m": position}
    predictions = tuple(replace(p, rms=rms) for p in fit.predictions)
    turns = {s: replace(t, advance=factor * t.advance, diameter=factor * t.diameter) for s, t in MEASURED_TURNS.items()}
    noise = {n.channel: 0.01 * n.standard_deviation for n in fit.channel_noise}
    return BenchmarkReproduction(replace(fit, predictions=predictions), warm, turns, {}, {}, noise, (), margins())


def margins(width: float = 0.2, share: float = 0.95) -> PredictionCoverage:
    """Intervals of the tactical diameter of this half width about MARIN's, in ship lengths, and shares inside bands."""
    measured = {s: t.diameter for s, t in MEASURED_TURNS.items()}
    turns = tuple(TurnInterval(s, "tactical diameter", d - width, d + width, d) for s, d in measured.items())
    run = BandCoverage("run", 5, {"psi": share, "x0": share, "y0": share})
    return PredictionCoverage(turns, (run, run), (run,))


def test_full_refits_and_the_family_are_judged_and_shown_where_they_were_made() -> None:
    wide = margins(width=0.4).turn_intervals
    members = (
        CandidateModel("own", 9, 1.4, 0.2, is_tied=False, is_chosen=True),
        CandidateModel("other", 11, 1.2, 0.2, is_tied=True),
    )
    with_tied = replace(margins(), tied_turn_intervals=wide, family=members)
    assert held(replace(made(), coverage=with_tied))[8:] == [True, True, False, False, True, True]
    shown = tables(replace(made(), coverage=with_tied))
    how = [row[1] for row in shown["Intervals of the 35 deg turns"].rows]
    assert how == ["one-step jackknife"] * 2 + ["jackknife, tied models"] * 2
    assert [row[-1] for row in shown[FAMILY].rows] == ["the trial's", "tied"]
    assert FAMILY not in tables(made())
    evidence = claim(replace(certain(), coverage=with_tied), UNCERTAINTY).evidence
    assert evidence.count("hold 2 of 2") == 2 and "tied models" in evidence


TURNING, ZIGZAG, FILTERING = "Zigzags alone", "A model of zigzags", "These records must be freed"
UNCERTAINTY, LABELS = "Realisations drawn", "Columns 5 to 8"
FAMILY = "The family of models on runs left out"


def page(repetition: BenchmarkReproduction) -> StudyPage[BenchmarkReproduction]:
    return StudyPage(read_study("alexandersson2022"), FACTS, repetition)


def claim(repetition: BenchmarkReproduction, start: str) -> Claim:
    return next(c for c in page(repetition).claims() if c.claim.startswith(start))


def tables(repetition: BenchmarkReproduction) -> dict[str, Table]:
    return {table.title: table for table in page(repetition).tables()}


def held(repetition: BenchmarkReproduction) -> list[bool]:
    return [check.holds for check in page(repetition).checks()]


def test_checks_hold_and_fail() -> None:
    assert held(made()) == [True] * 12
    assert held(made(heading=11.1, position=6.1, warm=5.1))[:3] == [False] * 3
    withdrawn = [check.name for check in page(made()).checks() if check.status is CheckStatus.WITHDRAWN]
    assert withdrawn == ["fit, warm [s]", "identify as a whole [s]"]
    assert held(made(factor=1.2))[4:8] == [False] * 4
    assert held(made(factor=math.nan, heading=math.nan)) == [False, True, True, True] + [False] * 4 + [True] * 4


def test_checks_of_intervals_hold_and_fail() -> None:
    wide, sure = (replace(made(), coverage=m) for m in (margins(width=0.4), margins(share=1.0)))
    assert held(wide)[8:] == [False, False, True, True]
    assert held(sure)[8:] == [True, True, False, True]
    assert held(replace(made(), coverage=margins(share=0.7)))[8:] == [True, True, False, False]
    assert margins().turn_intervals[0].half_width == pytest.approx(100 * 0.2 / MEASURED_TURNS["port"].diameter)
    assert TurnInterval("port", "advance", 2.0, 4.0, 3.9).relative_deviation == pytest.approx(0.9)
    assert margins().turn_intervals[0].contains_measured and "hold 2 of 2" in claim(certain(), UNCERTAINTY).evidence


def certain() -> BenchmarkReproduction:
    """A repetition with one run left out."""
    base = made()
    return replace(base, left_out_runs=(LeftOutRun("run", base.fit.validation[0], 3, 1.5, 0.2, base.turns),) * 2)


@pytest.mark.parametrize(
    ("heading", "factor", "turning", "zigzag"),
    [
        (8.0, 1.04, Verdict.CONFIRMED, Verdict.CONFIRMED),
        (8.0, 1.06, Verdict.REFUTED, Verdict.CONFIRMED),
        (20.0, 1.06, Verdict.UNKNOWABLE, Verdict.UNKNOWABLE),
        (20.0, 1.04, Verdict.CONFIRMED, Verdict.UNKNOWABLE),
    ],
)
def test_verdicts_follow_the_numbers(heading: float, factor: float, turning: Verdict, zigzag: Verdict) -> None:
    repetition = made(heading=heading, factor=factor)
    assert claim(repetition, TURNING).verdict is turning
    assert claim(repetition, ZIGZAG).verdict is zigzag


def test_noise_is_blamed_only_where_there_is_some() -> None:
    quiet = made()
    noisy = replace(quiet, noise_levels={n.channel: n.standard_deviation for n in quiet.fit.channel_noise})
    assert claim(quiet, FILTERING).verdict is Verdict.REFUTED
    assert claim(noisy, FILTERING).verdict is Verdict.UNKNOWABLE
    assert claim(made(heading=20.0), FILTERING).verdict is Verdict.UNKNOWABLE


def test_labels_are_refuted_only_where_every_run_speaks() -> None:
    finding = [Finding(Severity.ERROR, c, "wrong", "1") for c in ("wrong-frame", "mislabelled")]
    all_of_them = {"a": tuple(finding), "b": tuple(finding)}
    assert claim(replace(made(), label_findings=all_of_them), LABELS).verdict is Verdict.REFUTED
    assert claim(replace(made(), label_findings=all_of_them | {"c": ()}), LABELS).verdict is Verdict.UNKNOWABLE
    assert claim(made(), LABELS).verdict is Verdict.UNKNOWABLE


@pytest.mark.parametrize(("spread", "verdict"), [(0.001, Verdict.REFUTED), (0.05, Verdict.UNKNOWABLE)])
def test_certainty_is_judged_by_leaving_runs_out(spread: float, verdict: Verdict) -> None:
    base = made(factor=1.05)
    whole = base.fit.validation[0]
    entries = tuple(
        LeftOutRun(f"run {k}", whole, 3, 1.5, 0.2, {s: replace(t, diameter=t.diameter * (1.0 + spread * (k - 1)))
                                                for s, t in base.turns.items()})
        for k in range(3)
    )  # fmt: skip
    repetition = replace(base, left_out_runs=entries)
    assert claim(repetition, UNCERTAINTY).verdict is verdict
    assert claim(base, UNCERTAINTY).verdict is Verdict.UNKNOWABLE
    shown = tables(repetition)
    assert shown["Leave one run out"].rows[-1] == ("median", 8.0, 4.0, None, 1.5, 0.2)
    turned = shown["Turning circles with one run left out"].rows[-1]
    assert turned[1] == pytest.approx(0.0, abs=1e-12)


def test_jackknife_of_a_mean_is_its_standard_error(rng: np.random.Generator) -> None:
    values = rng.standard_normal(12)
    without = [float(np.delete(values, k).mean()) for k in range(12)]
    assert jackknife_error(without) == pytest.approx(float(values.std(ddof=1)) / math.sqrt(12))


def test_noise_from_sample_to_sample_is_found_beneath_a_motion(rng: np.random.Generator) -> None:
    time = np.arange(8000) * 0.05
    psi = 0.3 * np.sin(0.2 * time) + 1e-3 * rng.standard_normal(len(time))
    found = median_noise([Record.from_arrays("run", time, {"psi": psi})], ["psi", "r"])
    assert set(found) == {"psi"}
    assert found["psi"] == pytest.approx(1e-3, rel=0.03)
