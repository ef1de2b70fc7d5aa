"""Pictures of the files to copy: what each example of a contribution does."""

import importlib.util
import json
import tempfile
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import matplotlib.pyplot as plt
import numpy as np
from drawn.look import BLUE, GREEN, GREY, ORANGE, REPOSITORY, example, reports_figure, thinned
from matplotlib.figure import Figure

import seatrial as st
from seatrial import estimators
from seatrial.api import prepared_run
from seatrial.data.read import ColumnSpec, Layout
from seatrial.physics.models import model_from_file
from seatrial.physics.simulate import replay

FOLDER = REPOSITORY / "examples" / "contributions"


def contribution(name: str) -> ModuleType:
    """Return a file to copy as a module."""
    spec = importlib.util.spec_from_file_location(name, FOLDER / f"{name}.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def contributed_model() -> Figure:
    """Yaw rate and speed of the model to copy in a turn."""
    model = model_from_file(FOLDER / "yaw_model.py")
    run = st.simulate(model, "turning-circle:20", speed=1.2, rudder_rate=np.radians(5.0), duration=120.0)
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    time, rate, speed = thinned(run.time, np.degrees(run["r"]), run["u"])
    axes.plot(time, rate, color=BLUE, label="yaw rate [deg/s]")
    axes.plot(time, speed, color=ORANGE, label="speed [m/s]")
    axes.set(xlabel="time [s]", title="a turn with 20 deg of rudder", ylim=(0.0, None))
    axes.legend()
    return figure


def contributed_check() -> Figure:
    """A record that the check to copy warns of, with what it says."""
    time = np.arange(0.0, 60.0, 0.2)
    rolling = np.radians(4.0) * np.sin(2.0 * np.pi * time / 7.0) - np.radians(3.0)
    (finding,) = contribution("heel_check").heel_findings(st.Record.from_arrays("leg", time, {"phi": rolling}))
    figure, axes = plt.subplots(figsize=(5.4, 2.2))
    axes.plot(time, np.degrees(rolling), color=BLUE)
    axes.axhline(np.degrees(np.median(rolling)), color=ORANGE, linewidth=1.2)
    axes.set(xlabel="time [s]", ylabel="roll [deg]")
    axes.set_title(finding.text, fontsize=8)
    return figure


def contributed_estimator() -> Figure:
    """Errors of least squares and of least deviations on a record whose yaw rate has five spikes of 1 rad/s."""
    trial = st.load_trial(REPOSITORY / "examples" / "waterjet.toml")
    record, names = prepared_run(trial, "consecutive-zigzags_5"), list(trial.model.parameters.free_names)
    values = record["r"].copy()
    values[200::800] += 1.0  # rad/s: a spike of the sensor
    spoilt = record.with_channel("r", replace(record.channel("r"), values=values))
    truth = np.array([trial.truth[name] for name in names])
    squares = estimators.LinearRegression("least squares", estimators.Weak(20.0), estimators.OrdinaryLeastSquares())
    figure, axes = plt.subplots(figsize=(5.4, 3.6))
    for method, look, label in (
        (squares, {"marker": "s", "color": ORANGE}, "least squares"),
        (contribution("least_deviations_estimator").LeastDeviations(20.0), {"marker": "o", "color": BLUE}, "to copy"),
    ):
        errors = 100.0 * np.abs(method.estimate(trial.model, [spoilt]).values / truth - 1.0)
        axes.plot(errors, range(len(names)), linestyle="", label=label, **look)
    axes.set_yticks(range(len(names)), names, fontsize=9)
    axes.set_xscale("log")
    axes.set_xlabel("error of the coefficient, % of the true value")
    figure.legend(loc="outside upper left", ncols=2)
    return figure


def contributed_figure() -> Figure:
    """The figure to copy, of a run that was not fitted."""
    prediction = example("waterjet").validation[0]
    residuals = np.degrees(prediction.measured["r"] - prediction.simulated["r"])
    deviation = np.degrees(
        next(noise.standard_deviation for noise in example("waterjet").channel_noise if noise.channel == "r")
    )
    chart = contribution("residuals_figure").residual_chart(prediction.measured.time, residuals, deviation, "r [deg/s]")
    return reports_figure(chart, 7.0)


def contributed_optimiser() -> Figure:
    """The best fitness over evaluations of the search to copy and of two built-in ones on one problem."""
    problem = st.problems.problem_named("qi2025-135-whole")
    yardstick = problem.draw(0).yardstick
    figure, axes = plt.subplots(figsize=(5.4, 2.6))
    for name, colour in (("to copy", BLUE), ("pso", ORANGE), ("cma-es", GREEN)):
        method = (
            st.problems.entered_method(contribution("shrinking_search_optimiser").ShrinkingSearch)
            if name == "to copy"
            else st.problems.method_named(name)
        )
        answer = st.problems.attempt(method, problem, seed=0)
        spent = [count for count, _ in answer.trace]
        axes.step(spent, [yardstick.error(point) for _, point in answer.trace], where="post", color=colour, label=name)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set(xlabel="evaluations", ylabel="error over the bound")
    axes.legend()
    return figure


def contributed_reader() -> Figure:
    """A file of one JSON object a line as the reader to copy hands it on: an empty cell stays empty."""
    lines = [{"t": k, "heading": None if 18 <= k < 24 else round(20.0 * np.sin(0.15 * k), 1)} for k in range(60)]
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "log.jsonl"
        path.write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
        layout = Layout("jsonl", ColumnSpec("time", "t", "s"), (ColumnSpec("psi", "heading", "deg"),))
        (table,) = contribution("json_lines_reader").read_json_lines(path, layout).tables
    time, heading = (np.array(cells, dtype=float) for cells in table.cells)
    figure, axes = plt.subplots(figsize=(5.4, 2.2))
    axes.plot(time, heading, ".-", color=BLUE, linewidth=0.8)
    axes.axvspan(18, 23, color=GREY, alpha=0.2)
    axes.set(xlabel="t", ylabel="heading", title="as in the file: six cells are null, and stay so")
    return figure


def contributed_study() -> Figure:
    """Yaw rate over K delta after a step of the rudder: the claim that the study to copy checks."""
    study = contribution("turning_study")
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    for constant, colour in ((5.0, BLUE), (10.0, ORANGE), (20.0, GREEN)):
        model = st.models.nomoto().with_values({"T": constant})
        time = np.linspace(0.0, 100.0, 301)
        orders = st.Record.from_arrays("step", time, {"delta": np.full(time.size, study.RUDDER)})
        rate = replay(model, orders, dict.fromkeys(model.states, 0.0))["r"]
        axes.plot(time, rate / (model.parameters["K"].value * study.RUDDER), color=colour, label=f"T {constant:g} s")
    axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(xlabel="time [s]", ylabel="r / (K delta)")
    axes.legend()
    return figure
