"""Pictures of results: what was fitted, predicted, tuned and designed in the examples."""

import tomllib
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from drawn.look import (
    BAND,
    BLUE,
    GREY,
    MEASURED,
    ORANGE,
    REPOSITORY,
    SIMULATED,
    example,
    heading_with_band,
    reports_figure,
    thinned,
    track,
)
from matplotlib.figure import Figure

import seatrial as st
from seatrial.control.controller import components
from seatrial.control.front import Effort
from seatrial.control.tune import tune
from seatrial.estimation.sea import WaveResponses, fit_section
from seatrial.physics.simulate import replay
from seatrial.reporting.figures.control_charts import loop_diagram
from seatrial_studies.section2d.analysis import analyse_records
from seatrial_studies.section2d.responses import (
    BEAM,
    DEPTH,
    DRAUGHT,
    GM,
    KG,
    LENGTH,
    MASS,
    ROLL_RADIUS,
    SWAY_STIFFNESS,
    data_folder,
)


def kvlcc2_zigzag() -> Figure:
    """A tanker's zigzag of a larger rudder angle than any that was fitted."""
    fit = example("kvlcc2_hsva")
    held_out = fit.validation[0]
    figure, axes = plt.subplots(figsize=(4.2, 2.9))  # of the home page: letters that a telephone can show
    heading_with_band(axes, held_out)
    inside = np.abs(held_out.measured["psi"] - held_out.simulated["psi"]) <= held_out.half_width["psi"]
    axes.set_title(f"not fitted; {100.0 * inside.mean():.0f} % of the time inside its band")
    figure.legend(loc="outside upper left", ncols=3, columnspacing=1.0, handlelength=1.4)
    return figure


def kvlcc2_series() -> Figure:
    """What was recorded: the zigzags from which the tanker is identified."""
    fit = example("kvlcc2_hsva")
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    for prediction in fit.predictions:
        if prediction.role == "training":
            axes.plot(*thinned(prediction.measured.time, np.degrees(prediction.measured["psi"])), linewidth=1.0)
    axes.set(xlabel="time [s]", ylabel="heading [deg]", title="what was fitted: twelve zigzags")
    return figure


def kvlcc2_coefficients() -> Figure:
    """Half widths of the intervals over the estimates: beyond 100 % the sign is open."""
    free = [c for c in example("kvlcc2_hsva").coefficients if not c.fixed and c.lower is not None]
    share = np.array([50.0 * (c.upper - c.lower) / abs(c.estimate) for c in free])  # type: ignore[operator]
    order = np.argsort(share)
    figure, axes = plt.subplots(figsize=(5.4, 3.4))
    axes.barh(np.arange(len(free)), share[order], color=[ORANGE if share[i] > 100.0 else BLUE for i in order])
    axes.set_yticks(range(len(free)), [free[i].name for i in order], fontsize=8)
    axes.set_xscale("log")
    axes.set(xlabel="half width of the 95 % interval, % of the estimate", title="what is known of single coefficients")
    return figure


def kvlcc2_turn() -> Figure:
    """The decision: a turning circle that was never run, to both sides."""
    fit = example("kvlcc2_hsva")
    figure, axes = plt.subplots(figsize=(5.4, 3.4))
    inputs = {"n": float(np.median(fit.validation[0].measured["n"]))}
    for side, look in (("35", BLUE), ("35:port", ORANGE)):
        turn = st.simulate(fit.model, f"turning-circle:{side}", inputs=inputs)
        track(axes, turn, fit.ship.length, {"color": look})
    axes.set_title("what was asked: turning circles of 35 deg, model scale")
    return figure


def section_waves() -> Figure:
    """A measured section, free in sway and heave: every second wave period fitted, the others left out."""
    found = analyse_records(data_folder(), quick=True, report_progress=None).responses
    runs = [r for r in found if r.run.scenario == 4 and r.run.period > 0.85]
    omega = np.array([r.run.omega for r in runs])
    table = WaveResponses(
        "sway-heave", omega, np.array([r.wave_amplitude for r in runs]), {"z": np.array([-r.heave for r in runs])}
    )
    particulars = {"L": LENGTH, "B": BEAM, "d": DRAUGHT, "m": MASS, "KG": KG, "k_xx": ROLL_RADIUS, "GM": GM}
    springs = {"c22": sum(SWAY_STIFFNESS) / 2.0, "gain_z": 1.1, "d33": 100.0}
    is_fitted = np.searchsorted(np.unique(np.round(omega, 2)), np.round(omega, 2)) % 2 == 0
    free = ("gain_z", "delay", "a33", "d33")
    fit = fit_section(st.Ship("section", particulars), table.rows(is_fitted), ("sway", "heave"), free, springs, DEPTH)
    fine = np.linspace(4.8, 7.1, 80)  # rad/s
    curve = fit.predicted(WaveResponses("curve", fine, np.full(80, 0.0117), {"z": np.ones(80, dtype=complex)}))["z"]
    figure, axes = plt.subplots()
    axes.plot(2.0 * np.pi / fine, np.abs(curve), **SIMULATED, label="fitted model")
    for chosen, look, label in ((is_fitted, GREY, "measured, fitted"), (~is_fitted, ORANGE, "measured, left out")):
        axes.plot(2.0 * np.pi / omega[chosen], np.abs(table.motions["z"][chosen]), "o", color=look, label=label)
    axes.set(xlabel="wave period [s]", ylabel="heave over wave amplitude, 1")
    axes.legend()
    return figure


def held_out() -> Figure:
    """The error of a run of the waterjet craft that was not fitted, inside its band."""
    prediction = example("waterjet").validation[0]
    time, error, half = thinned(
        prediction.measured.time,
        np.degrees(prediction.measured["psi"] - prediction.simulated["psi"]),
        np.degrees(prediction.half_width["psi"]),
    )
    figure, axes = plt.subplots()
    axes.fill_between(time, -half, half, **BAND, label="95 % band")
    axes.plot(time, error, **SIMULATED, label="measured less predicted")
    axes.set(xlabel="time [s]", ylabel="heading [deg]", title=f"{prediction.record}, not fitted, open loop")
    axes.legend(loc="lower left")
    return figure


def bad_fit() -> Figure:
    """What a zero of the rudder does to a prediction: the error grows with time."""
    fit = example("waterjet")
    prediction = fit.validation[0]
    measured = prediction.measured
    rudder = measured.channel("delta")
    shifted = measured.with_channel("delta", replace(rudder, values=rudder.values + np.radians(1.5)))
    wrong = st.predict(fit.model, shifted)
    figure, axes = plt.subplots()
    for simulated, look, label in (
        (prediction.simulated, BLUE, "rudder as logged"), (wrong.simulated, ORANGE, "its zero 1.5 deg off"),
    ):  # fmt: skip
        time, error = thinned(measured.time, np.degrees(simulated["psi"] - measured["psi"]))
        axes.plot(time, error, color=look, label=label)
    axes.set(xlabel="time [s]", ylabel="error of heading [deg]", title="an error that grows with time is an offset")
    axes.legend()
    return figure


def criteria() -> Figure:
    """What output error, segments and one-step prediction compare, on one run."""
    model = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    wrong = model.with_values({"K": 0.19, "T": 8.0})
    time = np.arange(0.0, 90.0, 0.5)
    inputs = {"delta": 0.3 * np.sign(np.sin(0.12 * time))}
    run = replay(model, st.Record.from_arrays("run", time, inputs), {"r": 0.0})
    figure, axes = plt.subplots()
    axes.plot(time, np.degrees(run["psi"]), **MEASURED, label="measured")
    whole = replay(wrong, st.Record.from_arrays("run", time, inputs), {"r": 0.0})
    axes.plot(time, np.degrees(whole["psi"]), color=BLUE, label="whole run")
    for first in range(0, time.size, 36):
        part = slice(first, first + 37)
        start = {"r": float(run["r"][first]), "psi": float(run["psi"][first])}
        piece = replay(wrong, st.Record.from_arrays("run", time[part], {"delta": inputs["delta"][part]}), start)
        axes.plot(time[part], np.degrees(piece["psi"]), color=ORANGE, label="segments" if first == 0 else None)
    axes.set(xlabel="time [s]", ylabel="heading [deg]", title="a model with a gain 27 % too large, by two criteria")
    axes.legend()
    return figure


def log_parts() -> Figure:
    """A log with the manoeuvres that were found in it."""
    log = REPOSITORY / "examples" / "usv" / "afternoon_1.csv"
    (records,) = tomllib.loads(st.draft_trial(log).text)["records"]
    columns = np.genfromtxt(log, delimiter=",", names=True)
    time, east, north = (columns[name] for name in ("time_ms", "y_ned", "x_ned"))
    figure, axes = plt.subplots(figsize=(5.4, 3.4))
    for part in records["parts"]:
        first, last = (1e3 * float(part[end].removesuffix(" s")) for end in ("from", "to"))
        inside = (time >= time[0] + first) & (time <= time[0] + last)
        axes.plot(east[inside], north[inside], label=part["name"])
    axes.set(xlabel="east [m]", ylabel="north [m]", title="a log of two minutes, cut by init")
    axes.set_aspect("equal", adjustable="datalim")
    figure.legend(loc="outside right upper", fontsize=8)
    return figure


def front() -> Figure:
    """The front of the fin stabiliser of the example, by a search that is short enough for a picture."""
    task = st.load_loop(REPOSITORY / "examples" / "fin_stabiliser.toml")
    tuning = tune(task, seed=0, effort=Effort(refined=12, fill_rounds=2, neighbours=4000))
    columns = [list(tuning.objectives).index(name) for name in list(tuning.objectives)[:2]]
    figure, axes = plt.subplots(figsize=(5.4, 3.0))
    x, y = np.sqrt(tuning.front.objectives[:, columns]).T
    axes.plot(np.degrees(x), np.degrees(y), "o", markersize=2.5, color=GREY, label="front")
    for controller, look in ((tuning.chosen, BLUE), *((given, ORANGE) for given in tuning.baselines[:1])):
        place = np.degrees(np.sqrt(controller.objectives[columns]))
        axes.plot(*place, "o", color=look, label=controller.name)
    axes.set(xlabel="roll [deg rms]", ylabel="fin angle [deg rms]", title="fins of the example: motion over work")
    axes.legend()
    return figure


def thrust_curve() -> Figure:
    """Thrust over command, with its band."""
    craft = example("thrusters").thruster_craft
    assert craft is not None
    curve = craft.curves[0]
    figure, axes = plt.subplots()
    share = 100.0 * np.array(curve.share)
    axes.fill_between(share, np.array(curve.lower), np.array(curve.upper), **BAND, label="95 % band")
    axes.plot(share, curve.thrust, **SIMULATED, label="at rest")
    axes.plot(share, curve.at_speed, color=ORANGE, label=f"at {curve.speed:.1f} m/s")
    axes.set(xlabel="command [% of full]", ylabel=f"thrust [{craft.force_unit}]", title=", ".join(curve.thrusters))
    axes.legend()
    return figure


def roll_decay() -> Figure:
    """A decay and the damping over the amplitude that it shows."""
    fit = example("fin_decay")
    roll, prediction = fit.roll, fit.validation[0]
    assert roll is not None
    figure, (left, right) = plt.subplots(1, 2, figsize=(5.4, 2.5))
    left.plot(*thinned(prediction.measured.time, np.degrees(prediction.measured["phi"])), **MEASURED)
    left.plot(*thinned(prediction.simulated.time, np.degrees(prediction.simulated["phi"])), **SIMULATED)
    left.set(xlabel="time [s]", ylabel="roll [deg]", title="a release, not fitted")
    amplitude = np.degrees(roll.amplitude)
    right.fill_between(amplitude, np.array(roll.damping_lower), np.array(roll.damping_upper), **BAND)
    right.plot(amplitude, roll.damping, **SIMULATED)
    right.set(xlabel="amplitude [deg]", ylabel="damping b_e [1/s]", title="what it shows")
    return figure


def heave_pitch() -> Figure:
    """Heave in waves of a voyage that was not fitted."""
    prediction = example("heave_pitch").validation[0]
    late = prediction.measured.time > prediction.measured.time[-1] - 60.0
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    axes.plot(prediction.measured.time[late], prediction.measured["z"][late], **MEASURED, label="measured")
    axes.plot(prediction.simulated.time[late], prediction.simulated["z"][late], **SIMULATED, label="predicted")
    axes.set(xlabel="time [s]", ylabel="heave [m]", title="the last minute of a voyage that was not fitted")
    axes.legend(loc="lower left", ncols=2)
    return figure


def designed() -> Figure:
    """Orders designed for heave and pitch, in calm water."""
    design = st.design(REPOSITORY / "examples" / "heave_pitch_design.toml", seed=0)
    figure, axes = plt.subplots(figsize=(5.4, 2.4))
    for name, label in (("delta_f1", "first fin"), ("delta_f2", "second fin")):
        early = design.plan.time < 30.0
        axes.plot(design.plan.time[early], np.degrees(design.plan[name][early]), label=label)
    axes.set(xlabel="time [s]", ylabel="angle [deg]", title="orders that identify heave and pitch best, half a minute")
    figure.legend(loc="outside right upper")
    return figure


def coverage() -> Figure:
    """Estimates of sixty simulated trials with their intervals: those that miss the truth are marked."""
    model = st.models.nomoto().with_values({"K": 0.15, "T": 8.0, "U": 2.0})
    time = np.arange(0.0, 120.0, 0.5)
    inputs = {"delta": 0.3 * np.sign(np.sin(0.12 * time))}
    clean = replay(model, st.Record.from_arrays("zigzag", time, inputs), {"r": 0.0})
    rng = np.random.default_rng(4)
    figure, axes = plt.subplots()
    for k in range(60):
        noisy = {"psi": clean["psi"] + np.radians(0.5) * rng.standard_normal(time.size), **inputs}
        trial = st.Trial(
            st.Ship("craft", {"L": 8.0}), (st.Run(st.Record.from_arrays("zigzag", time, noisy)),), st.models.nomoto()
        )
        gain = st.identify(trial)["K"]
        is_inside = gain.lower <= 0.15 <= gain.upper
        axes.plot([k, k], [gain.lower, gain.upper], color=GREY if is_inside else ORANGE, linewidth=1.6)
    axes.axhline(0.15, color=BLUE, linewidth=1.0)
    axes.set(xlabel="simulated trial", ylabel="gain K [1/s]", title="95 % intervals and the truth")
    return figure


def loop_blocks() -> Figure:
    """The loop of the fin stabiliser of the example as the report draws it."""
    task = st.load_loop(REPOSITORY / "examples" / "fin_stabiliser.toml")
    chart = loop_diagram(components(task.disturbances[0].disturbed(task.loop)), "phi", "alpha_f")
    assert chart is not None
    return reports_figure(chart, 8.0)
