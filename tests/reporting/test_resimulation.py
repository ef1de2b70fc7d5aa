"""Sliders of a page: what they hold, how exact inputs and script are, what a browser simulates with them."""

import base64
import json
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from benchmarks.export_c99 import STEP, complete_model, own_steps, random_states
from tests.reporting.fabricated import fabricated_fit, zigzag

import seatrial as st
from seatrial.core.equations import Model
from seatrial.core.results import Fit, Prediction
from seatrial.core.values import Array, Record
from seatrial.physics.models import model_named
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.replay import inputs_of, trajectory
from seatrial.reporting.pages import report_page
from seatrial.reporting.runs import _coded, corrected_inputs, replay_script, resimulation

if TYPE_CHECKING:
    from playwright.sync_api import Browser

ZERO = 0.02  # rad: of the rudder in the run
PATIENCE = 300_000  # ms: of a loaded machine; only a page that stands still takes as long


def simulated_fit() -> Fit:
    """The fabricated fit with its held-out run truly simulated, with a rudder's zero."""
    fit = fabricated_fit()
    (held,) = fit.validation
    shifted = replace(held, offsets={"delta zero": ZERO})
    start = np.array([held.measured[s][0] for s in fit.model.states])
    states, _ = trajectory(fit.model, corrected_inputs(shifted, fit), held.measured.dt, start)
    record = held.simulated
    for name, values in zip(fit.model.states, states.T, strict=True):
        record = record.with_channel(name, record.channel(name).with_values(values))
    return replace(
        fit, predictions=(*(p for p in fit.predictions if p is not held), replace(shifted, simulated=record))
    )


@pytest.fixture(scope="module")
def fit() -> Fit:
    return simulated_fit()


def data(text: str) -> dict:
    """What the script of the page reads."""
    found = re.search(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_every_free_coefficient_has_a_slider_about_its_estimate(fit: Fit) -> None:
    held = data(resimulation(fit))
    free = [c for c in fit.coefficients if not c.fixed]
    assert [s["value"] for s in held["sliders"]] == [c.estimate for c in free]
    assert all(s["low"] < s["value"] < s["high"] for s in held["sliders"])
    (run,) = held["runs"]
    assert [run["parameters"][s["place"]] for s in held["sliders"]] == [c.estimate for c in free]
    assert [c["name"] for c in run["channels"]] == ["y₀", "x₀", "ψ"]


def with_two_runs(fit: Fit) -> Fit:
    """The fit with a second, better held-out run: the first half of the first."""
    (held,) = fit.validation
    half = slice(0, len(held.measured) // 2)
    measured, simulated = (
        Record.from_arrays("shorter", r.time[half], {name: r[name][half] for name in r.channels})
        for r in (held.measured, held.simulated)
    )
    better = {name: 0.5 * error for name, error in held.rms.items()}
    second = replace(held, record="shorter", measured=measured, simulated=simulated, rms=better)
    return replace(fit, predictions=(*fit.predictions, second))


def test_the_worst_run_is_shown_first_and_those_that_the_page_has_no_room_for_are_named(
    fit: Fit, monkeypatch: pytest.MonkeyPatch
) -> None:
    (held,) = fit.validation
    text = resimulation(with_two_runs(fit))
    assert [len(run["start"]) for run in data(text)["runs"]] == [len(fit.model.states)] * 2
    assert f"<option selected>{held.record}</option><option>shorter</option>" in text
    monkeypatch.setattr("seatrial.reporting.runs.MAX_LETTERS", 10)
    text = resimulation(with_two_runs(fit))
    assert len(data(text)["runs"]) == 1 and "Left out, so that the page stays small: shorter." in text


def test_inputs_are_those_of_the_prediction(fit: Fit) -> None:
    (p,) = fit.validation
    recorded = inputs_of(fit.model, p.measured)
    both = replace(p, offsets={"delta zero": 0.1, "delta gain": 2.0, "delta delay": p.measured.dt})
    column = corrected_inputs(both, fit)[:, fit.model.input_names.index("delta")]
    delta = recorded[:, fit.model.input_names.index("delta")]
    np.testing.assert_allclose(column[1:], 2.0 * delta[:-1] + 0.1, rtol=0.0, atol=1e-12)


def test_without_a_held_out_run_or_a_model_of_steps_there_are_none(fit: Fit) -> None:
    trained = tuple(replace(p, role="training") for p in fit.predictions)
    assert resimulation(replace(fit, predictions=trained)) == ""
    assert resimulation(replace(fit, model=model_named("heave_pitch"))) == ""
    assert resimulation(replace(fit, coefficients=tuple(replace(c, fixed=True) for c in fit.coefficients))) == ""
    assert "resimulation" in report_page(fit)


def page_with(browser: "Browser", fit: Fit, folder: Path, width: int = 1100):
    path = folder / "report.html"
    path.write_text(report_page(fit), encoding="utf-8")
    page = browser.new_page(viewport={"width": width, "height": 900})
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(path.as_uri())
    page.locator(".resimulation > summary").press("Enter")
    return page, said


def move(page, k: int, place: int) -> None:
    script = f"n => {{ n.value = {place}; n.dispatchEvent(new Event('input')); }}"
    page.locator(".slider input").nth(k).evaluate(script)
    page.evaluate("() => new Promise(drawn => requestAnimationFrame(() => requestAnimationFrame(drawn)))")


def heading_error(p: Prediction) -> float:
    return float(np.degrees(np.sqrt(np.mean((p.simulated["psi"] - p.measured["psi"]) ** 2))))


def test_a_browser_simulates_the_run_and_a_moved_slider_changes_it(
    browser: "Browser", fit: Fit, tmp_path: Path
) -> None:
    page, said = page_with(browser, fit, tmp_path)
    page.wait_for_selector(".resimulation[data-examined]", state="attached", timeout=PATIENCE)
    state = page.locator(".resimulation .state")
    before = re.search(r"heading ([\d.]+) \(([\d.]+)\) deg", state.inner_text())
    assert before is not None
    assert before[1] == before[2] == f"{heading_error(fit.validation[0]):.3g}"
    move(page, 3, 900)
    after = re.search(r"heading ([\d.]+) \(([\d.]+)\) deg", state.inner_text())
    assert after is not None and after[1] != after[2] == before[2]
    page.locator(".resimulation .reset").click()
    assert state.inner_text().count(before[2]) >= 2
    assert page.locator(".resimulation svg").count() == 2
    assert said == []


def test_another_run_is_chosen_and_the_sliders_stay(browser: "Browser", fit: Fit, tmp_path: Path) -> None:
    page, said = page_with(browser, with_two_runs(fit), tmp_path)
    state, choice = page.locator(".resimulation .state"), page.locator(".resimulation select")
    move(page, 3, 900)
    first, moved = state.inner_text(), page.locator(".slider output").nth(3).inner_text()
    choice.select_option("shorter")
    assert state.inner_text().startswith("Error (rms)") and state.inner_text() != first
    assert page.locator(".slider output").nth(3).inner_text() == moved
    assert page.locator(".resimulation svg").count() == 2
    page.wait_for_selector(".resimulation[data-examined]", state="attached", timeout=PATIENCE)
    choice.select_option(index=0)
    assert state.inner_text() == first
    assert said == []


def test_a_coefficient_that_makes_the_run_diverge_is_reported(browser: "Browser", fit: Fit, tmp_path: Path) -> None:
    """Y_v far on either side: on one of them the craft no longer comes back from a sway."""
    wide = tuple(replace(c, lower=c.estimate - 3.0, upper=c.estimate + 3.0) if c.name == "Y_v" else c
                 for c in fit.coefficients)  # fmt: skip
    page, said = page_with(browser, replace(fit, coefficients=wide), tmp_path, 390)
    page.wait_for_selector(".resimulation[data-examined]", state="attached", timeout=PATIENCE)
    k = [c.name for c in wide if not c.fixed].index("Y_v")
    assert "the run diverges above" in page.locator(".slider .range").nth(k).inner_text()
    move(page, k, 1000)
    assert "the simulation diverges after" in page.locator(".resimulation .state").inner_text()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert said == []


def test_a_run_that_the_page_cannot_repeat_is_not_drawn(browser: "Browser", tmp_path: Path) -> None:
    page, _ = page_with(browser, fabricated_fit(), tmp_path)
    page.locator(".resimulation .state", has_text="cannot be simulated here").wait_for(timeout=PATIENCE)
    assert page.locator(".resimulation svg").count() == 0
    assert page.locator(".slider input:not([disabled])").count() == 0


SAMPLES = 5000


def decoded(coded: object) -> np.ndarray:
    if isinstance(coded, float):
        return np.full(SAMPLES, coded)
    if isinstance(coded, dict):
        places = np.frombuffer(base64.b64decode(coded["index"]), "<u2" if coded["wide"] else "<u1")
        return np.frombuffer(base64.b64decode(coded["table"]), "<f8")[places]
    assert isinstance(coded, str)
    return np.frombuffer(base64.b64decode(coded), "<f8")


@pytest.mark.parametrize(("digits", "most_kilobytes"), [(0, 8), (1, 20), (2, 54), (12, 54)])
def test_a_column_comes_back_to_the_bit(digits: int, most_kilobytes: float, rng: np.random.Generator) -> None:
    rudder = np.radians(np.round(20.0 * np.sin(0.01 * np.arange(SAMPLES)) + rng.standard_normal(SAMPLES), digits))
    coded = _coded(rudder)
    np.testing.assert_array_equal(decoded(coded), rudder)
    assert len(json.dumps(coded)) < 1e3 * most_kilobytes


def test_a_constant_column_is_its_value() -> None:
    assert _coded(np.full(SAMPLES, 1.5)) == 1.5


# relative, of a step: rounding, and sines of another library; of the range, over a run: what they grow to
STEP_TOLERANCE, RUN_TOLERANCE = 1e-12, 1e-9


@pytest.fixture(scope="session")
def node() -> str:
    """The machine's JavaScript."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("no node on this machine; install Node.js to run the script of a page")
    return found


def replayed(node: str, folder: Path, model: Model, starts: Array, inputs: Array, dt: float = STEP) -> Array:
    """States of every run, (runs, samples, states), from starts (runs, states) and inputs (runs, samples, nu)."""
    runs = [
        {"dt": dt, "count": len(columns), "start": start.tolist(), "inputs": columns.T.tolist(),
         "held": [i.is_held for i in model.inputs], "limits": [1e9] * len(start)}
        for start, columns in zip(starts, inputs, strict=True)
    ]  # fmt: skip
    (folder / "runs.json").write_text(json.dumps({"runs": runs, "p": model.parameters.values.tolist()}))
    end = 'const { runs, p } = JSON.parse(require("fs").readFileSync("runs.json"));\n'
    end += "console.log(JSON.stringify(runs.map(run => replay(rates, run, p).states.map(one => [...one]))));"
    (folder / "run.js").write_text(replay_script(model) + end)
    done = subprocess.run([node, "run.js"], cwd=folder, capture_output=True, text=True, check=True)
    return np.array(json.loads(done.stdout), dtype=float).transpose(0, 2, 1)


@pytest.mark.parametrize("name", ["waterjet", "thrusters", "abkowitz", "roll", "mmg"])
def test_a_step_is_that_of_the_simulation(name: str, node: str, tmp_path: Path, rng: np.random.Generator) -> None:
    model = complete_model(name, rng)
    draw = random_states(model, 200, rng)
    there = replayed(node, tmp_path, model, draw.states, draw.inputs)[:, 1]
    here = own_steps(model, draw)
    size = np.maximum(np.maximum(np.abs(here), np.abs(draw.states)), draw.scale)
    fine = np.isfinite(here).all(axis=1)
    assert fine.mean() > 0.9  # nearly all draws must count
    assert np.max(np.abs(there - here)[fine] / size[fine]) <= STEP_TOLERANCE


@pytest.mark.parametrize("held", [(), ("delta",)])
def test_a_run_stays_with_the_simulation(held: tuple[str, ...], node: str, tmp_path: Path) -> None:
    model, record = waterjet().with_held(held), zigzag("zigzag_20_20", 20.0)
    inputs = inputs_of(model, record)
    start = np.array([record[s][0] for s in model.states])
    here, _ = trajectory(model, inputs, record.dt, start)
    (there,) = replayed(node, tmp_path, model, start[None], inputs[None], record.dt)
    assert len(here) > 1000
    assert np.max(np.abs(there - here) / np.ptp(here, axis=0)) <= RUN_TOLERANCE


def test_a_run_that_diverges_ends_where_it_leaves_its_limits(node: str, tmp_path: Path) -> None:
    sheet = st.Sheet("runaway", "a text book")
    (x,) = sheet.states("x")
    sheet.rate(x, x**3 * sheet.parameter("k", 1.0, free=True))
    (states,) = replayed(node, tmp_path, sheet.model(), np.array([[1.0]]), np.empty((1, 50, 0)))
    assert np.isfinite(states[:3]).all() and np.isnan(states[-1]).all()
