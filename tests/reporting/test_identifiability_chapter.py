"""The page says what the records can and cannot tell: all that a fit holds of it, and nothing where it holds none."""

import math
import re
from dataclasses import replace
from pathlib import Path

import pytest
from tests.reporting.complete_fit import complete_fit, tanker
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.section_text import cells, part

from seatrial.core.results import Extrapolation, Fit, Identifiability, NoiseModel
from seatrial.data.folder.result_folder import load_fit, save_result
from seatrial.reporting.identifiability_chapter import determined_sentence, identifiability_section
from seatrial.reporting.page import html

TITLE = "Identifiability: what the records determine"
COMBINATIONS = "Combinations that these runs determine well, poorly and not at all"
HOSTILE = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def full(fit: Fit) -> Fit:
    return fit


@pytest.fixture(scope="module")
def page_of_full(full: Fit) -> str:
    return html(full)


def headings(text: str) -> list[str]:
    return re.findall(r"<h[34][^>]*>([^<]*)", text)


def test_it_stands_after_coefficients_and_findings_and_in_the_contents(page_of_full: str) -> None:
    titles = re.findall(r'<h2 id="(\w+)">', page_of_full)
    assert titles[:4] == ["prediction", "coefficients", "findings", "identifiability"]
    assert '<a href="#identifiability">' in page_of_full and page_of_full.count(TITLE) == 2


def test_everything_the_fit_says_is_on_the_page(full: Fit, page_of_full: str) -> None:
    known, disturbance = full.identifiability, full.noise_model
    assert known is not None and known.stability is not None and disturbance is not None
    texts = [*(s.text for s in known.structural), known.stability.text]
    texts += [d.text for d in known.directions if d.standard_deviation >= 0.1]
    texts += [m.name for m in full.candidate_models] + [m.note for m in full.candidate_models]
    for said in texts:
        assert said[1:] in page_of_full
    assert f"The criterion of this fit is {disturbance.method}." in page_of_full
    assert "deg/s/√s" in page_of_full and "m/s/√s" in page_of_full
    for label in ("profile likelihoods", "how well combinations"):
        assert page_of_full.count(f'aria-label="{label}') == 1


def test_without_any_of_it_there_is_no_heading_and_no_section() -> None:
    bare = html(fabricated_fit())
    assert TITLE not in bare and 'href="#identifiability"' not in bare
    assert "95 % band of the simulated" not in bare and "xtrapolation index" not in bare


def test_parts_that_are_empty_have_no_heading() -> None:
    fit = fabricated_fit()
    only_noise = html(replace(fit, noise_model=NoiseModel("output error", math.nan, {}, {})))
    assert TITLE in only_noise and "Noise, and the criterion chosen for it" in headings(only_noise)
    assert "Models compared" not in only_noise and "Straight course" not in only_noise
    least = html(replace(fit, identifiability=Identifiability((), (), math.nan, math.nan)))
    assert "Structurally identifiable" in least
    assert not {
        "Combinations that these runs determine well, poorly and not at all",
        "If an assumed value is wrong",
    } & set(headings(least))
    assert not re.search(r"\bnan\b", least)


def test_the_same_page_comes_from_the_result_folder(full: Fit, page_of_full: str, tmp_path: Path) -> None:
    assert html(load_fit(save_result(full, tmp_path))) == page_of_full


def test_texts_are_escaped(full: Fit) -> None:
    known, disturbance = full.identifiability, full.noise_model
    assert known is not None and known.stability is not None and disturbance is not None
    hostile = replace(
        full,
        identifiability=replace(
            known,
            structural=tuple(replace(s, text=HOSTILE) for s in known.structural),
            directions=tuple(replace(d, text=HOSTILE, combination={HOSTILE: 1.0}) for d in known.directions),
            collinearity=tuple(replace(c, parameter=HOSTILE, partner=HOSTILE) for c in known.collinearity),
            sensitivities=tuple(replace(s, parameter=HOSTILE) for s in known.sensitivities),
            consequences=tuple(replace(c, text=HOSTILE, parameter=HOSTILE) for c in known.consequences),
            stability=replace(known.stability, text=HOSTILE),
            profiles=tuple(replace(p, parameter=HOSTILE) for p in known.profiles),
        ),
        noise_model=replace(disturbance, text=HOSTILE, method=HOSTILE, process={HOSTILE: 1.0}),
        candidate_models=tuple(replace(m, name=HOSTILE, note=HOSTILE) for m in full.candidate_models),
        predictions=tuple(replace(p, extrapolation=Extrapolation(3.0, {HOSTILE: 3.0})) for p in full.predictions),
    )
    text = html(hostile)
    assert HOSTILE not in text and text.count("<script>") == html(full).count("<script>")


def test_intervals_of_measures_say_whether_they_hold(full: Fit) -> None:
    p = next(p for p in full.predictions if p.role == "validation")
    m = p.measures["overshoot_1_deg"]
    missed = replace(p, measures=p.measures | {"overshoot_1_deg": replace(m, measured=9.9)})
    assert html(full).count("OUTSIDE") == 0
    assert html(replace(full, predictions=(missed,))).count("OUTSIDE") == 1


def test_the_number_of_determined_coefficients_is_said_of_the_free_ones(full: Fit) -> None:
    known = full.identifiability
    assert known is not None
    whole = replace(full, identifiability=replace(known, effective_parameters=10.9))
    said = determined_sentence(whole)
    assert said == "The records determine all 11 free coefficients, given the stated L."
    free = replace(whole, identifiability=replace(known, effective_parameters=10.9, structural=()))
    assert determined_sentence(free) == "The records determine all 11 free coefficients."
    without = tuple(replace(c, prior_mean=None) for c in full.coefficients)
    assert determined_sentence(replace(full, coefficients=without)).endswith("combinations of the free coefficients.")


def test_coefficients_that_are_determined_only_together_are_named(full: Fit) -> None:
    first, second, *rest = full.coefficients
    vague = (replace(first, lower=-1.0, upper=2.0), replace(second, lower=-1.0, upper=2.0), *rest)
    known = full.identifiability
    assert known is not None
    whole = replace(full, coefficients=vague, identifiability=replace(known, effective_parameters=11.0, structural=()))
    assert determined_sentence(whole) == (
        f"The records determine all 11 free coefficients. The signs of {first.name} and {second.name} are open."
    )
    fewer = replace(whole, coefficients=(vague[0], second, *rest))
    assert determined_sentence(fewer).endswith(f" The sign of {first.name} is open.")
    part = replace(whole, identifiability=replace(known, effective_parameters=9.2, structural=()))
    assert determined_sentence(part).startswith("The records determine about 9 of 11 combinations of the free coeffi")


def test_counts_that_differ_are_explained(full: Fit) -> None:
    known = full.identifiability
    assert known is not None
    exact = sum(d.standard_deviation < 1.0 for d in known.directions)
    for number, is_explained in ((float(exact), False), (exact - 2.0, True), (math.nan, False)):
        chapter = identifiability_section(replace(full, identifiability=replace(known, effective_parameters=number)))
        assert bool(part(chapter, COMBINATIONS).note) is is_explained


def test_a_tanker_with_many_coefficients_folds_what_is_long() -> None:
    fit = complete_fit(tanker())
    text = html(fit)
    assert (
        "The records determine about 23 of 43 combinations of the free coefficients; the priors give the others."
        in text
    )
    assert "27 further combinations not drawn" in text and "<summary>31 more</summary>" in text
    assert len(text.encode()) < 1_500_000


def test_directions_are_sorted_by_how_well_they_are_determined(full: Fit) -> None:
    known = full.identifiability
    assert known is not None
    counts = [int(row[1]) for row in cells(part(identifiability_section(full), COMBINATIONS).table)]
    assert sum(counts) == len(known.directions) and counts == [4, 3, 4]
