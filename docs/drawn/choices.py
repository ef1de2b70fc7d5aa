"""Pictures of choices: what manoeuvres, derivatives, searches and disturbances are worth, measured on the examples."""

import shutil
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from drawn.look import BAND, BLUE, GREEN, GREY, ORANGE, REPOSITORY, SIMULATED, example, thinned
from matplotlib.figure import Figure

import seatrial as st
from seatrial import estimators
from seatrial.api import prepared_run
from seatrial.control.proposals import Stretch, look
from seatrial.control.schedule import gain_schedule, schedule
from seatrial.control.task import ScheduleGrid
from seatrial.core.figures.run import hull_outline
from seatrial.core.results import Fit
from seatrial.core.results.online import Snapshot
from seatrial.core.values import Array
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.published import SHARE_SPREAD, container_ship, share_name
from seatrial.physics.simulate import replay
from seatrial.physics.simulate.steer import manoeuvre
from seatrial.problems.twin_ships import shallow_water_ship, twin_screw_ship

NOMOTO = {"K": 0.15, "T": 8.0, "U": 2.0}  # 1/s, s, m/s: a craft of some 8 m; chosen
TRUE_DIAMETER = 3.0 * 320.0  # m, tactical, of the ship of the tutorial, as the page has it
SHIP_RATE = 100.0 / 60.0  # rps, some 20 kn of the container ship; chosen
HEEL_SHOWN = 400.0  # s; chosen
SEA_STRETCH, LOG_SHOWN = 1200.0, 120.0  # s of the log that the estimate rests on, and that are drawn; chosen
TRUE_SEA = {"height": 2.4, "peak period": 8.5, "heading": np.radians(120.0)}  # m, s, rad, of examples/fins_at_sea.py
LOOKS = (("o", BLUE), ("s", ORANGE), ("^", GREEN), ("D", GREY))
"""Marker and colour of the first, second, ... set of dots."""


def dots(names: list[str], sets: dict[str, Array], label: str) -> Figure:
    """A row for each name, a dot for each set, on a logarithmic axis."""
    figure, axes = plt.subplots(figsize=(5.4, 0.26 * len(names) + 1.2))
    for (marker, colour), (legend, values) in zip(LOOKS, sets.items(), strict=False):
        axes.plot(values, np.arange(len(names)), marker, color=colour, label=legend, markersize=5)
    axes.set_yticks(range(len(names)), names, fontsize=9)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlabel(label)
    figure.legend(loc="outside upper left", ncols=2)
    return figure


def manoeuvres() -> Figure:
    """Half widths of the intervals of a craft identified from zigzags, from a circle, and from both."""
    trial = st.load_trial(REPOSITORY / "examples" / "waterjet.toml")
    zigzag, circle = "consecutive-zigzags_5", "turning-circle_20"
    names, widths = list(trial.model.parameters.free_names), {}
    for legend, training in (("zigzags", (zigzag,)), ("circle", (circle,)), ("both", (zigzag, circle))):
        runs = tuple(
            replace(run, role=st.Role.TRAIN if run.name in training else st.Role.VALIDATE) for run in trial.runs
        )
        fit = st.identify(replace(trial, runs=runs))
        widths[legend] = np.array([half_width(fit, name) / abs(trial.truth[name]) for name in names])
    label = "half width of the 95 % interval, % of the true value, 1000 at most"
    return dots(names, {legend: np.minimum(100.0 * shares, 1000.0) for legend, shares in widths.items()}, label)


def sides_and_depth() -> Figure:
    """Track of a ferry with shafts against each other, and turning circles of KVLCC2 over less and less water."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.2, 3.6))
    ferry = twin_screw_ship()
    time = np.arange(0.0, 90.0, 0.2)
    # rps: astern faster than ahead, so that the ship stays where it is; chosen
    shafts = {"n": -1.2 + 0.0 * time, "delta": 0.0 * time, "n_difference": 14.0 + 0.0 * time}
    start = dict.fromkeys(ferry.states, 0.0)
    length = ferry.parameters["L"].value
    spin = replay(ferry, st.Record.from_arrays("spin", time, shafts), start)
    for k in range(0, len(time), 75):
        north, east = hull_outline(spin["x0"][k], spin["y0"][k], spin["psi"][k], length).T / length
        left.plot(east, north, color=GREY, linewidth=0.8)
    left.plot(spin["y0"] / length, spin["x0"] / length, color=BLUE)
    left.set_title("port shaft ahead, starboard astern")
    tanker = shallow_water_ship().with_values(dict.fromkeys(map(share_name, SHARE_SPREAD), 1.0))
    draught, length = tanker.parameters["d"].value, tanker.parameters["L"].value
    for ratio, colour in ((0.0, BLUE), (3.0, GREEN), (1.5, ORANGE), (1.2, GREY)):
        held = {"n": 10.4, "depth": ratio * draught}
        turn = manoeuvre(tanker, programme("turning-circle:35"), duration=140.0, inputs=held, speed=1.18)
        label = f"depth {ratio:g} draughts" if ratio else "deep"
        right.plot(turn["y0"] / length, turn["x0"] / length, color=colour, label=label)
    right.legend(loc="lower right", fontsize=8)
    right.set_title("rudder 35°, KVLCC2")
    for axes in (left, right):
        axes.set_aspect("equal")
        axes.set(xlabel="east, lengths", ylabel="north, lengths")
    return figure


def heel() -> Figure:
    """Heel of the published container ship in a turning circle and in a zigzag."""
    ship = container_ship()
    figure, axes = plt.subplots(figsize=(5.4, 3.2))
    for name, colour in (("turning-circle:20", BLUE), ("zigzag:20/20", ORANGE)):
        run = st.simulate(ship, name, inputs={"n": SHIP_RATE})
        axes.plot(*thinned(run.time, np.degrees(run["phi"])), color=colour, label=name.replace(":", ", "))
    axes.axhline(0.0, color=GREY, linewidth=0.8)
    axes.set(xlabel="time [s]", ylabel="roll to starboard [deg]", xlim=(0.0, HEEL_SHOWN))
    axes.legend()
    return figure


def proposed() -> Figure:
    """Roll and fins of the tutorial's log, and the sea that twenty minutes of it show, with the true one."""
    task = st.load_loop(REPOSITORY / "examples" / "fin_stabiliser.toml")
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "examples").symlink_to(REPOSITORY / "examples")
        subprocess.run([sys.executable, "examples/fins_at_sea.py"], cwd=name, check=True)
        time, roll, fins = np.loadtxt(Path(name) / "log.csv", delimiter=",", skiprows=1).T
    stretch = Stretch(0.0, float(time[1]), np.radians(np.column_stack([roll, fins]))[time < SEA_STRETCH], task.U)
    grid = ScheduleGrid((task.U,), (np.radians(90.0).item(),), (2.5,))
    gains = gain_schedule(schedule(task, grid, {}, 1, lambda _: None).points, task.loop.gains.names)
    sea = look(task, gains, stretch).sea
    figure, (log, shown) = plt.subplots(2, 1, figsize=(5.4, 4.4), height_ratios=(1.4, 1.0))
    part = time < LOG_SHOWN
    log.plot(time[part], roll[part], color=BLUE, label="roll")
    log.plot(time[part], fins[part], color=ORANGE, linestyle="--", label="fins")
    log.set(xlabel="time [s]", ylabel="angle [deg]")
    log.legend(loc="upper right", ncols=2)
    estimates = {"height": sea.height, "peak period": sea.period, "heading": sea.heading}
    for row, (label, true) in enumerate(TRUE_SEA.items()):
        found = estimates[label]
        shown.plot([found.lower / true, found.upper / true], [row, row], color=BLUE, linewidth=3.0, alpha=0.5)
        shown.plot(found.value / true, row, "o", color=BLUE)
    shown.axvline(1.0, color=GREY, linewidth=1.0, linestyle=":")
    shown.set_yticks(range(len(TRUE_SEA)), list(TRUE_SEA))
    shown.set(xlabel="estimate with its 95 % interval, over the true value", ylim=(-0.6, len(TRUE_SEA) - 0.4))
    shown.invert_yaxis()
    return figure


def half_width(fit: Fit, name: str) -> float:
    """Return half the width of the interval of a coefficient, infinite where it has none."""
    found = fit[name]
    return np.inf if found.lower is None or found.upper is None else 0.5 * (found.upper - found.lower)


def regressions() -> Figure:
    """Errors of coefficients by three derivatives in a regression, and by output error, on one noisy record."""
    trial = st.load_trial(REPOSITORY / "examples" / "waterjet.toml")
    record, names = prepared_run(trial, "consecutive-zigzags_5"), list(trial.model.parameters.free_names)
    truth = np.array([trial.truth[name] for name in names])
    errors = {}
    for legend, operator in (
        ("Euler", estimators.Euler()), ("central", estimators.Central()), ("weak form, 20 s", estimators.Weak(20.0)),
    ):  # fmt: skip
        regression = estimators.LinearRegression(legend, operator, estimators.OrdinaryLeastSquares())
        errors[legend] = 100.0 * np.abs(regression.estimate(trial.model, [record]).values / truth - 1.0)
    fit = example("waterjet")
    errors["identify"] = 100.0 * np.abs(np.array([fit[name].estimate for name in names]) / truth - 1.0)
    return dots(names, errors, "error of the coefficient, % of the true value")


def searches() -> Figure:
    """The error of the best point over evaluations: three published searches, and least squares with slopes."""
    problem = st.problems.problem_named("qi2025-135-whole")
    yardstick = problem.draw(0).yardstick
    figure, axes = plt.subplots()
    for name, colour in (("pso", ORANGE), ("iwho", GREEN), ("cma-es", GREY), ("output-error", BLUE)):
        answer = st.problems.attempt(st.problems.method_named(name), problem, seed=0)
        spent = [count for count, _ in answer.trace]
        axes.step(spent, [yardstick.error(point) for _, point in answer.trace], where="post", color=colour, label=name)
    axes.axhline(1.0, color=GREY, linewidth=0.8, linestyle=":")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set(xlabel="evaluations", ylabel="error over the bound", title="heave and pitch, eight coefficients")
    figure.legend(loc="outside upper left", ncols=4)
    return figure


def entered() -> Figure:
    """Errors over the Cramér-Rao bound of four methods on the same eight draws of a problem."""
    problem = st.problems.problem_named("qi2025-135-whole")
    names = ("random", "pso", "iwho", "de", "cma-es", "output-error")
    figure, axes = plt.subplots()
    for row, name in enumerate(names):
        method = st.problems.method_named(name)
        answers = [st.problems.attempt(method, problem, seed=seed) for seed in range(8)]
        errors = [problem.draw(seed).yardstick.error(answer.values) for seed, answer in enumerate(answers)]
        axes.plot(errors, np.full(len(errors), row), "o", color=BLUE if name == "output-error" else GREY, alpha=0.7)
        evaluations = int(np.median([answer.evaluations for answer in answers]))
        axes.annotate(
            f"{evaluations:,} evaluations", (1.01, row), xycoords=("axes fraction", "data"), va="center", fontsize=8
        )
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set(xlabel="error over the Cramér-Rao bound, eight draws", title=problem.name)
    return figure


def gusts() -> Figure:
    """Intervals of a gain from thirty records of a craft in gusts; those that miss the truth are marked."""
    rng = np.random.default_rng(7)
    gains = [st.identify(gusty_trial(rng))["K"] for _ in range(30)]
    is_inside = [gain.lower <= NOMOTO["K"] <= gain.upper for gain in gains]
    figure, axes = plt.subplots(figsize=(5.4, 2.6))
    for k, (gain, holds) in enumerate(zip(gains, is_inside, strict=True)):
        axes.plot([k, k], [gain.lower, gain.upper], color=GREY if holds else ORANGE, linewidth=1.6)
    axes.axhline(NOMOTO["K"], color=BLUE, linewidth=1.0)
    title = f"four minutes at 2 Hz in gusts: {sum(is_inside)} of 30 intervals hold the truth"
    axes.set(xlabel="simulated trial", ylabel="gain K [1/s]", title=title)
    return figure


def gusty_trial(rng: np.random.Generator) -> st.Trial:
    """Return a trial at 2 Hz of a craft on which gusts act like a rudder of 1 degree rms with a memory of 5 s."""
    step, memory, size = 0.5, 5.0, np.radians(1.0)
    time = np.arange(0.0, 240.0, step)
    order = 0.2 * np.clip(3.0 * np.sin(0.12 * time), -1.0, 1.0)
    gust, decay = np.zeros(time.size), np.exp(-step / memory)
    for k in range(1, time.size):
        gust[k] = decay * gust[k - 1] + size * np.sqrt(1.0 - decay**2) * rng.standard_normal()
    model = st.models.nomoto().with_values(NOMOTO)
    true = replay(model, st.Record.from_arrays("run", time, {"delta": order + gust}), {"r": 0.0})
    noisy = {"psi": true["psi"] + np.radians(0.3) * rng.standard_normal(time.size), "delta": order}
    runs = (st.Run(st.Record.from_arrays("run", time, noisy)),)
    return st.Trial(st.Ship("craft", {"L": 8.0}), runs, st.models.nomoto())


def followed() -> Figure:
    """Two coefficients with their intervals while a record grows."""
    shown: list[Snapshot] = []
    trial = st.load_trial(REPOSITORY / "examples" / "waterjet_follow.toml")
    st.follow(trial, once=True, show=lambda snapshot, _: shown.append(snapshot))
    known = [s for s in shown if s.value.size and np.isfinite(s.standard_error).all()]
    time = np.array([s.time for s in known])
    figure, both = plt.subplots(2, 1, sharex=True, figsize=(5.4, 3.4))
    for axes, name in zip(both, ("Y_v", "N_r"), strict=True):
        value, error = (
            np.array([getattr(s, k)[s.names.index(name)] for s in known]) for k in ("value", "standard_error")
        )
        truth = trial.truth[name]
        axes.fill_between(time, value - 1.96 * error, value + 1.96 * error, **BAND)
        axes.plot(time, value, **SIMULATED)
        axes.axhline(truth, color=ORANGE, linewidth=1.0)
        axes.set(ylabel=name, ylim=(2.0 * truth, -truth))
    both[1].set_xlabel("time since the logger began [s]")
    both[0].set_title("estimate with its 95 % interval, and the truth")
    return figure


def own_model() -> Figure:
    """The model of the page in a zigzag: heading, rudder, and the speed that it loses."""
    sheet = st.Sheet("yaw_with_drag", source="as on the page", meaning="yaw with a quadratic speed loss")
    r, psi, u = sheet.states("r psi u")
    delta = sheet.input("delta")
    T, K, alpha = sheet.parameter("T", 8.0), sheet.parameter("K", 0.12), sheet.parameter("alpha", 0.4)
    u_0, c_r = sheet.parameter("u_0", 1.2), sheet.parameter("c_r", 3.0)
    sheet.rate(r, (K * delta - r - alpha * r**3) / T)
    sheet.rate(psi, r)
    sheet.rate(u, (u_0 - u) / (5 * T) - c_r * u * r**2)
    run = st.simulate(sheet.model(), "zigzag:20/20", speed=1.2, rudder_rate=np.radians(5.0))
    figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(5.4, 3.2))
    time, heading, rudder, speed = thinned(run.time, np.degrees(run["psi"]), np.degrees(run["delta"]), run["u"])
    upper.plot(time, heading, color=BLUE, label="heading")
    upper.plot(time, rudder, color=ORANGE, label="rudder")
    upper.set_ylabel("angle [deg]")
    figure.legend(loc="outside upper left", ncols=2)
    lower.plot(time, speed, color=GREEN)
    lower.set(xlabel="time [s]", ylabel="speed [m/s]")
    return figure


def axes_and_signs() -> Figure:
    """Axes and positive directions, seen from above."""
    figure, axes = plt.subplots(figsize=(5.4, 4.0))
    heading, size = np.radians(35.0), 4.0
    north, east = hull_outline(0.0, 0.0, heading, size).T
    axes.fill(east, north, facecolor="none", edgecolor=GREY, linewidth=1.4)
    ahead = np.array([np.sin(heading), np.cos(heading)])
    starboard = np.array([np.cos(heading), -np.sin(heading)])

    def arrow(start: Array, way: Array, text: str, colour: str) -> None:
        axes.annotate("", start + way, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.6})
        axes.annotate(text, start + 1.12 * way, color=colour, ha="center", va="center", fontsize=9)

    def turning(centre: Array, radius: float, begin: float, end: float, text: str, colour: str) -> None:
        angles = np.radians(np.linspace(begin, end, 40))
        x, y = centre[0] + radius * np.sin(angles), centre[1] + radius * np.cos(angles)
        axes.plot(x, y, color=colour, linewidth=1.4)
        axes.annotate("", (x[-1], y[-1]), (x[-3], y[-3]), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.4})
        axes.annotate(text, (x[20] * 1.12, y[20] * 1.12), color=colour, ha="center", va="center", fontsize=9)

    origin = np.zeros(2)
    arrow(origin, np.array([0.0, 4.2]), "$x_0$ north", GREY)
    arrow(origin, np.array([4.6, 0.0]), "$y_0$ east", GREY)
    arrow(origin, 3.6 * ahead, "$u$", BLUE)
    arrow(origin, 2.0 * starboard, "$v$", BLUE)
    turning(origin, 3.0, 0.0, 33.0, "psi", ORANGE)
    turning(origin, 1.3, 45.0, 115.0, "$r$", BLUE)
    stern, edge = -0.5 * size * ahead, heading + np.pi - np.radians(30.0)  # a rudder of 30 deg to starboard
    tip = stern + 0.9 * np.array([np.sin(edge), np.cos(edge)])
    axes.plot(*zip(stern, tip, strict=True), color=GREEN, linewidth=3.0)
    axes.annotate("delta > 0", tip + np.array([0.2, -0.1]), color=GREEN, ha="left", fontsize=9)
    axes.set(xlim=(-4.6, 5.6), ylim=(-3.4, 5.0), aspect="equal")
    axes.axis("off")
    return figure


def both_sides() -> Figure:
    """A circle to starboard by the tutorial's model, fitted to runs to both sides and to one, and the true diameter."""
    page = (REPOSITORY / "docs" / "tutorials" / "zigzags.md").read_text(encoding="utf-8")
    text = page.split(":caption: mmg.toml\n")[1].split("```")[0]
    one_side = text.replace('"logs/*.csv"', '"logs/circle_35_port.csv", "logs/zigzag_*.csv"')
    figure, axes = plt.subplots(figsize=(5.4, 3.8))
    with tempfile.TemporaryDirectory() as name:
        shutil.copytree(REPOSITORY / "examples" / "ship", Path(name) / "logs")
        for kind, trial_file, colour in (("both sides", text, BLUE), ("one side", one_side, ORANGE)):
            path = Path(name) / "trial.toml"
            path.write_text(trial_file, encoding="utf-8")
            fit = st.identify(path)
            circle = st.simulate(fit, "turning-circle:35")
            axes.plot(*thinned(circle["y0"], circle["x0"]), color=colour, label=f"fitted to {kind}")
    axes.axvline(TRUE_DIAMETER, color=GREY, linewidth=1.0, linestyle=":")
    axes.set(
        xlabel="east [m]",
        ylabel="north [m]",
        title="35 deg of rudder in still water; dotted: the true tactical diameter",
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="lower right")
    return figure
