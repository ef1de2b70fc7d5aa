"""Pictures of exported models: what other programs compute, beside the model they were written from."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from drawn.look import BLUE, GREEN, GREY, MEASURED, ORANGE, example, thinned
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

import seatrial as st
from seatrial.api.simulation import as_model_file
from seatrial.core.values import Array
from seatrial.exporting import ExportSource
from seatrial.exporting.ardupilot.choice import heading_step, slow_pole, tune_ardupilot
from seatrial.exporting.ardupilot.controller import steered_craft
from seatrial.exporting.gazebo import GZ_SIM, VRX, training_motions, training_runs
from seatrial.exporting.projection import project
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.simulate import replay

DAY = "2026-01-01"  # of the files, which are thrown away
START = {"u": 1.18, "v": 0.0, "r": 0.0, "psi": 0.0, "x0": 0.0, "y0": 0.0}  # SI: the approach of the pages
TURN = r"""
#include "tanker.h"
#include <stdio.h>
int main(void)
{
    double x[TANKER_NX] = {1.18}, u[TANKER_NU] = {0.349, 10.4};
    int k;
    for (k = 0; k <= 1200; k++) {
        printf("%.17g %.17g %.17g\n", x[TANKER_X_x0], x[TANKER_X_y0], x[TANKER_X_psi]);
        tanker_step(&tanker_identified, u, u, 0.1, x);
    }
    return 0;
}
"""


def turn(time: Array) -> st.Record:
    """Return the turn of the pages: 20 degrees of rudder, the propeller at 10.4 revolutions a second."""
    inputs = {"delta": np.full(time.size, 0.349), "n": np.full(time.size, 10.4)}
    return replay(kvlcc2(), st.Record.from_arrays("turn", time, inputs), START)


def rates(state: Array, rudder: float) -> Array:
    """Return the rates (6,) of the model of the pages at its propeller rate, without wind."""
    model = kvlcc2()
    found, jacobian = np.empty(6), np.zeros((6, 6 + 4 + len(model.parameters)))
    inputs = np.array([rudder, 10.4, 0.0, 0.0])
    model.compiled.rates_tangent(0.0, state, inputs, model.parameters.values, found, jacobian)
    return found


def export_c99() -> Figure:
    """The track of the page's turn by the compiled C source, beside `simulate`."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    assert compiler
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        st.export(kvlcc2(), "c99", folder / "tanker")
        (folder / "turn.c").write_text(TURN)
        command = [compiler, "-O2", "-std=c99", "-Itanker", "turn.c", "tanker/tanker.c", "-lm", "-o", "turn"]
        subprocess.run(command, cwd=folder, check=True)
        lines = subprocess.run([folder / "turn"], check=True, capture_output=True, text=True).stdout.splitlines()
    north, east, _ = np.array([line.split() for line in lines], dtype=float).T
    run = turn(0.1 * np.arange(north.size))
    gap = np.hypot(run["x0"] - north, run["y0"] - east).max()
    figure, axes = plt.subplots(figsize=(5.4, 3.4))
    axes.plot(*thinned(run["y0"], run["x0"]), **MEASURED, label="simulate")
    axes.plot(*thinned(east, north), color=BLUE, label="compiled C")
    axes.set(
        xlabel="east [m]", ylabel="north [m]", title=f"20 deg of rudder for two minutes, {gap:.0e} m apart at most"
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend()
    return figure


def export_fmu() -> Figure:
    """The output `range_use` of the exported waterjet craft in circles of growing rudder: above 1 beyond its trials."""
    import fmpy

    fit = example("waterjet")
    figure, axes = plt.subplots()
    with tempfile.TemporaryDirectory() as name:
        st.export(fit, "fmu", Path(name) / "craft.fmu")
        for angle, colour in ((15, GREEN), (25, BLUE), (35, ORANGE)):
            circle = st.simulate(fit, f"turning-circle:{angle}")
            given = np.rec.fromarrays(
                [circle.time, *(circle[n] for n in fit.model.input_names)], names=["time", *fit.model.input_names]
            )
            out = fmpy.simulate_fmu(
                str(Path(name) / "craft.fmu"), stop_time=float(circle.time[-1]), input=given, output=["range_use"],
                output_interval=1.0,
            )  # fmt: skip
            axes.plot(*thinned(out["time"], out["range_use"]), color=colour, label=f"circle of {angle} deg")
    axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(xlabel="time [s]", ylabel="range_use", title="above 1 no trial speaks for the motion")
    axes.legend()
    return figure


def export_casadi() -> Figure:
    """Where the tanker's speed comes to rest, and the slope there: what the program of the page finds."""
    speed = np.linspace(0.6, 1.4, 81)
    rate = np.array([rates(np.array([u, 0.0, 0.0, 0.0, 0.0, 0.0]), 0.0)[0] for u in speed])
    balance = float(np.interp(0.0, -rate, speed))
    figure, axes = plt.subplots()
    axes.plot(speed, 1e3 * rate, color=BLUE)
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.plot([balance], [0.0], "o", color=ORANGE)
    axes.annotate(f"{balance:.3f} m/s", (balance, 0.0), (8, 8), textcoords="offset points", color=ORANGE)
    axes.set(xlabel="speed [m/s]", ylabel="du/dt [mm/s$^2$]", title="surge at 10.4 revolutions a second")
    return figure


def export_matlab() -> Figure:
    """What the step of Euler's rule costs in a turn of a minute, as the program of the page takes it."""
    true = turn(np.linspace(0.0, 60.0, 601))
    steps, errors = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0), []
    for step in steps:
        state = np.array(list(START.values()))
        for _ in range(round(60.0 / step)):
            state = state + step * rates(state, 0.349)
        errors.append(abs(np.degrees(state[3] - true["psi"][-1])))
    figure, axes = plt.subplots(figsize=(5.4, 2.6))
    axes.loglog(steps, errors, "o-", color=BLUE)
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set(xlabel="step [s]", ylabel="error of heading [deg]", title="after a minute of 20 deg of rudder")
    return figure


def export_gazebo() -> Figure:
    """Heading of the waterjet craft in a zigzag: by its model, by each plugin refitted, and by plain truncation."""
    fit = example("waterjet")
    trained = tuple(prediction.measured for prediction in fit.predictions if prediction.role == "training")
    source = ExportSource(as_model_file(fit), "waterjet", DAY, runs=trained)
    motions, runs = training_motions(source), training_runs(source)
    names = [f"{motion.name}, {plugin}" for plugin in ("VRX", "gz-sim") for motion in motions]
    errors = [error for target in (VRX, GZ_SIM) for error in project(source.file, target, motions, runs).errors]
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    rows = np.arange(len(names))
    axes.hlines(rows, *(np.degrees([getattr(e, k) for e in errors]) for k in ("refitted", "truncated")), color=GREY)
    axes.plot(np.degrees([e.refitted for e in errors]), rows, "o", color=BLUE, label="refitted")
    axes.plot(np.degrees([e.truncated for e in errors]), rows, "s", color=ORANGE, label="truncated")
    axes.set_yticks(rows, names)
    axes.set_xscale("log")
    axes.set_xlabel("rms error of heading [deg]")
    figure.legend(loc="outside upper left", ncols=2)
    return figure


def export_ardupilot() -> Figure:
    """A step of the heading by ArduPilot's own controller with the exported gains, on the nonlinear craft."""
    craft = steered_craft(as_model_file(example("thrusters")))
    tuning = tune_ardupilot(craft)
    step = heading_step(craft, tuning.gains, slow_pole(craft.heading_plant, 2))
    figure, axes = plt.subplots(figsize=(5.4, 2.6))
    shown = step.time <= 15.0
    axes.plot(step.time[shown], np.degrees(step.value[shown]), color=BLUE)
    axes.axhline(30.0, color=GREY, linewidth=0.8, linestyle=":")
    axes.set(
        xlabel="time [s]", ylabel="change of heading [deg]", title="30 deg ordered at 0 s, craft with two thrusters"
    )
    return figure
