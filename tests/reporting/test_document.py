"""A page runs what its policy names and nothing more; figures have their colours for dark screens."""

import base64
import hashlib
import json
import re
from pathlib import Path

import numpy as np

from seatrial.core.figures.chart import Stroke
from seatrial.core.figures.run import RunView, Track
from seatrial.core.results import Fit
from seatrial.reporting.document import chapters_page, environment
from seatrial.reporting.section import FirstScreen
from seatrial.reporting.time_figures import run_figure


def digests(text: str, element: str) -> list[str]:
    bodies = re.findall(rf"<{element}>(.*?)</{element}>", text, re.DOTALL)
    return [f"sha256-{base64.b64encode(hashlib.sha256(body.encode()).digest()).decode()}" for body in bodies]


def test_the_policy_names_every_style_and_script_by_its_hash(page: Path) -> None:
    text = page.read_text()
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)
    assert policy is not None and "unsafe" not in policy[1] and policy[1].startswith("default-src 'none'")
    for element in ("style", "script"):
        names = digests(text, element)
        assert names and all(f"'{name}'" in policy[1] for name in names)
    assert re.findall(r"'sha256-[^']*'", policy[1]) == [f"'{n}'" for e in ("style", "script") for n in digests(text, e)]


def test_no_element_has_a_style_of_its_own_nor_a_handler(page: Path) -> None:
    text = re.sub(r"<(script|style)[^>]*>.*?</\1>", "", page.read_text(), flags=re.DOTALL)
    assert not re.search(r"<[^>]*\s(style|on\w+)=", text)


def test_every_colour_of_figures_and_plots_has_one_for_the_dark(page: Path) -> None:
    text = page.read_text()
    for colour in set(re.findall(r'(?:fill|stroke)="(#[0-9a-f]{6,8})"', text)):
        assert f"[fill='{colour}']" in text
    night = json.loads(re.findall(r'id="night-colours">(.*?)</script>', text)[0])
    strokes = re.findall(r'"stroke":\["(#\w+)"', text)
    assert strokes and set(strokes) <= set(night)


def test_a_page_without_time_series_carries_no_plotting_code() -> None:
    text = chapters_page("kind", "heading", FirstScreen("verdict", ()), ())
    assert "uPlot=" not in text and text.count("<script>") == 1
    assert environment() is environment()


def test_a_run_carries_its_data_and_a_description_for_those_who_do_not_see_it(fit: Fit) -> None:
    from seatrial.core.results.fit_charts import prediction_view

    text = run_figure(prediction_view(fit.predictions[0], 9.8, fit.model.input_names))
    data = json.loads(re.findall(r'json">(.*?)</script>', text)[0])
    assert len(data["panels"]) == len(data["about"]) == 5 and len(data["track"]) == 2
    assert data["about"][0].startswith("ψ [deg] over 4 min 00 s: measured from −")
    assert ("<noscript>" in text and 'class="run square"' in text) or 'class="run strip"' in text


def test_a_strip_of_the_first_screen_is_drawn_for_a_telephone_too() -> None:
    north = np.linspace(0.0, 100.0, 50)
    view = RunView("r", (), (Track(north, 0.1 * north, None, Stroke("#222222", 1.0)),))
    assert run_figure(view, is_first=True).count('class="track narrow"') == 1
    assert "narrow" not in run_figure(view)
