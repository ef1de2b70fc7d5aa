"""Autopilots in weather beside pole placement and Fossen's rules: heading, rudder and margins, by linear theory.

KVLCC2 as its zigzags gave it, at full size by Froude's law, in sea state 5; the waterjet craft in sea state 3. Both in
waves from the quarter and the bow, with a slow disturbance for wind and current.
"""

import math
import os
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from measure import Line, at_least, at_most

from seatrial import api
from seatrial.control.gain_evaluation import gain_evaluator
from seatrial.control.task import TuningTask
from seatrial.core.results.tuning import Controller, Tuning
from seatrial.core.values import Array
from seatrial.physics.loops.autopilot import heading_gains_at, working_frequency

EXAMPLES = Path(__file__).parents[1] / "examples"
BANDWIDTHS = (0.75, 1.5, 3.0)  # of rivals' closed loops over the plant's working frequency; spread about the usual


def run() -> list[Line]:
    """Return the lines of each craft."""
    return [line for name, task in tasks() for line in _craft(name, task)]


def tasks() -> Iterator[tuple[str, TuningTask]]:
    """Give the name of each craft's trial and the tuning of its autopilot in weather, on the model identified."""
    for trial, loop in (("waterjet", "waterjet_weather"), ("kvlcc2_hsva", "kvlcc2_weather")):
        if trial == "kvlcc2_hsva" and "SEATRIAL_DATA" not in os.environ:
            continue
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "model.toml"
            api.save(api.identify(api.load_trial(EXAMPLES / f"{trial}.toml")), folder)
            yield trial, api.load_loop(EXAMPLES / f"{loop}.toml", model_file=path)


def rivals(task: TuningTask) -> dict[str, dict[str, float]]:
    """Return PID gains by rule for each bandwidth.

    Pole placement has its natural frequency there and a damping ratio of 0.8; Fossen's algorithm (2021, section 15.3)
    a damping ratio of one and the natural frequency that gives the closed loop that bandwidth.
    """
    scale, named = working_frequency(task.loop.plant), {}
    for bandwidth in BANDWIDTHS:
        omega = bandwidth * scale
        named[f"pole placement, {bandwidth:g}"] = heading_gains_at(task.loop.plant, omega, 0.8)
        # omega_b = omega_n sqrt(1 - 2 zeta^2 + sqrt(4 zeta^4 - 4 zeta^2 + 2)) at zeta = 1 (Fossen 2021, section 15.3)
        natural = omega / math.sqrt(math.sqrt(2.0) - 1.0)
        named[f"Fossen, {bandwidth:g}"] = heading_gains_at(task.loop.plant, natural, 1.0)
    return named


def _craft(name: str, task: TuningTask) -> list[Line]:
    made = api.tune(replace(task, baselines=rivals(task)))
    own = made.robustness[0]
    lines = [*_controller(name, made.chosen)]
    for rival in made.baselines:
        lines += _controller(name, rival)
        if math.isfinite(rival.Ms):
            what = f"{name}: larger of heading and rudder-rate rms over those of {rival.name}, best of the fronts"
            ratio = _best_ratio(task, made, rival)
            # the front keeps limits of angle, rate and margin; who breaks them is no rival on it
            lines.append(
                Line(f"{what} (not kept: {'; '.join(rival.violated)})", ratio, "x")
                if rival.violated
                else at_most(what, ratio, "x", 1.0)
            )
    return [
        *lines,
        at_least(f"{name}: ships of the fit that are stable", own.stable_draws, f"of {own.draws}", own.draws),
        at_least(f"{name}: corners that are stable", own.stable_corners, f"of {own.corners}", own.corners),
        Line(f"{name}: largest Ms of the corners", own.corners_Ms, ""),
        at_most(f"{name}: overshoot of a 20 deg course change", 100.0 * made.manoeuvres[0].overshoot, "%", 2.0),
        Line(f"{name}: settling of the course change", made.manoeuvres[0].settling, "s"),
    ]


def _controller(name: str, c: Controller) -> list[Line]:
    heading, rudder, rate = (math.degrees(c.rms[key]) for key in ("output", "actuator", "actuator_rate"))
    return [
        Line(f"{name}, {c.name}: heading rms", heading, "deg"),
        Line(f"{name}, {c.name}: rudder rms", rudder, "deg"),
        Line(f"{name}, {c.name}: rudder-rate rms", rate, "deg/s"),
        Line(f"{name}, {c.name}: Ms", c.Ms, ""),
    ]


def _best_ratio(task: TuningTask, tuning: Tuning, rival: Controller) -> float:
    """Return the least over the fronts of the larger ratio to the rival: below one it is beaten in both."""
    loops = {task.loop.name: task.loop, **{one.name: one for one in task.extended_structures}}
    ratios = []
    for front in (tuning.front, *tuning.extended_fronts):
        evaluator = gain_evaluator(task, loops.get(front.name, task.loop))
        rms = np.sqrt(evaluator.evaluate(front.gains).variances.mean(axis=1))
        ratios.append(_ratios(rms, rival).min())
    return float(min(ratios))


def _ratios(rms: Array, rival: Controller) -> Array:
    return np.maximum(rms[:, 0] / rival.rms["output"], rms[:, 2] / rival.rms["actuator_rate"])
