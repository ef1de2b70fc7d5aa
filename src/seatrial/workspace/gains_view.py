"""Gains under the hand: margins, actuator, step and sea of a loop with the gains where a hand has put them."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from seatrial import api
from seatrial.control.controller import DEMAND, describe_controller, simulate_manoeuvres
from seatrial.control.gain_evaluation import GainEvaluator, gain_evaluator
from seatrial.control.simulation import UNCONTROLLED, simulate_in_seaway
from seatrial.control.task import Seaway, SimulationSettings, TuningTask
from seatrial.core.results.tuning import Controller
from seatrial.core.text.numbers import significant
from seatrial.core.values import InputError, display_unit
from seatrial.core.values.files import is_file, parse_toml, read_table_text, write_atomically
from seatrial.core.values.notation import NOTATION, channel_letter
from seatrial.workspace.results_view import sampled_curves

_SEED = 0  # of the sea that is shown: the same for all gains, so that they can be compared
_SEA_SECONDS = 300.0  # of the sea that is shown; chosen: some thirty waves
_LEAST_PERCENT = 0.01  # %, below which a share is said to be small; chosen
_KEPT_TASKS = 4  # chosen
AUTOPILOT = """# A heading autopilot, begun from the workspace. Change limits and demand to what your craft has.
question = "Which gains turn the craft by 20 degrees without overshoot, whatever ship the records allow?"
name = "autopilot"
minimise = ["output", "actuator_rate"]

[plant]
model = "{model}"
{speed}
[controller]
kind = "pid"
parts = ["KP", "KD"]

[actuator]
limit = {{ value = 35, unit = "deg" }}    # ASSUMED: usual
rate = {{ value = {rate:.3g}, unit = "deg/s" }}    # {reason}

[limits]
Ms = 1.7

[[slow_disturbances]]
rms = {{ value = 1, unit = "deg" }}    # ASSUMED: of the rudder, what wind and small waves do to the heading
bandwidth = 0.2

[demand]
change = {{ value = 20, unit = "deg" }}
overshoot = 0.02
"""


def loop_view(root: Path, loop: Path, model: Path | None) -> dict[str, Any]:
    """Return the gains of a loop with their ranges, and what gains that a tuning chose are.

    Args:
        model: model file that takes the place of the loop's own; None: that.

    Raises:
        InputError: the loop file or its model cannot be read.
    """
    task = _evaluator(loop, model).task
    gains = task.loop.gains
    rows = [
        {"name": p.name, "meaning": p.meaning, "unit": "" if p.unit == "1" else p.unit,
         "value": float(p.value if math.isfinite(p.value) else 0.5 * (p.lower + p.upper)),
         "low": float(p.lower), "high": float(p.upper)}
        for p in gains
    ]  # fmt: skip
    return {"name": task.name, "gains": rows, "tuned": _tuned(root, set(gains.names))}


def gains_view(loop: Path, model: Path | None, gains: Mapping[str, float]) -> dict[str, Any]:
    """Return what the loop does with these gains: margins, what is violated, a step and a sea.

    Raises:
        InputError: other gains than the loop has, or values beyond their ranges.
    """
    task = _evaluator(loop, model).task
    names = task.loop.gains.names
    if set(gains) != set(names):
        raise InputError(f"the loop has the gains {', '.join(names)}; give exactly these")
    values = np.array([float(gains[name]) for name in names])
    if not np.all(np.isfinite(values)):
        raise InputError("a gain is no finite number")
    controller = describe_controller(_evaluator(loop, model), "under the hand", values)
    return {
        "facts": _facts(controller, task), "violated": list(controller.violated),
        "stable": math.isfinite(controller.Ms), "step": _step(task, values, controller),
        "sea": _sea(task, values, controller),
    }  # fmt: skip


def write_autopilot(root: Path, name: str, model: Path, speed: float | None = None) -> Path:
    """Write the loop file of a heading autopilot for an identified craft and return its path.

    speed: m/s, of a model that has none.

    Raises:
        InputError: there is a file of that name, the craft has no rudder, or its speed is not known or another one.
    """
    file = api.load_model(model)
    if not file.model.has_rudder or file.model.is_roll:
        raise InputError("an autopilot needs a craft that is steered by a rudder; write a loop file for other loops")
    path = root / f"{name}.toml"
    if is_file(path):
        raise InputError(f"there is a file '{path.name}' already")
    rate = api.rudder_rate_of(file)
    text = AUTOPILOT.format(
        model=model.relative_to(root).as_posix(), rate=math.degrees(rate.value), reason=rate.origin,
        speed="" if speed is None else f"speed = {speed:g}    # m/s, as stated\n",
    )  # fmt: skip
    write_atomically(path, text.encode())
    try:
        gain_evaluator(api.load_loop(path))
    except InputError as error:
        path.unlink()
        raise InputError(str(error).removeprefix(f"{path}: ")) from None
    return path


def _evaluator(loop: Path, model: Path | None) -> GainEvaluator:
    return _kept_evaluator(loop, model, tuple(p.stat().st_mtime_ns for p in (loop, model) if p is not None))


@lru_cache(maxsize=_KEPT_TASKS)
def _kept_evaluator(loop: Path, model: Path | None, changed: tuple[int, ...]) -> GainEvaluator:  # noqa: ARG001
    return gain_evaluator(api.load_loop(loop, model_file=model))


def _tuned(root: Path, names: set[str]) -> list[dict[str, Any]]:
    """The gains that tunings below the folder chose, of loops with gains of these names."""
    rows = []
    for path in sorted(root.glob("*/*/gains.toml")) + sorted(root.glob("*/gains.toml")):
        try:
            table = parse_toml(read_table_text(path))
        except (OSError, ValueError):
            continue
        values = table.get("gains", table)
        gains = {key: float(value) for key, value in values.items() if key in names and isinstance(value, int | float)}
        if set(gains) == names:
            rows.append({"name": path.parent.relative_to(root).as_posix(), "gains": gains})
    return rows


def _facts(controller: Controller, task: TuningTask) -> list[dict[str, Any]]:
    """Margins and the actuator's use as people read them, those that a limit is exceeded by marked."""
    limits, unit = task.constraints, NOTATION[task.loop.actuator].unit if task.loop.actuator in NOTATION else "1"
    factor, read_unit = display_unit(unit)
    actuator = channel_letter(task.loop.actuator)
    rows = [
        ("largest sensitivity Ms", controller.Ms, "", controller.Ms <= limits.Ms),
        ("gain margin", 20.0 * math.log10(max(controller.gain_margin, 1e-300)), "dB", None),  # 1e-300: no log of 0
        ("phase margin", math.degrees(controller.phase_margin), "°", None),
        ("delay margin", controller.delay_margin, "s", controller.delay_margin >= limits.delay),
        (f"{actuator}, rms", factor * controller.rms.get("actuator", math.nan), read_unit, None),
        (f"{actuator} beyond its limit", 100.0 * controller.saturation, "%",
         controller.saturation <= limits.saturation),
        ("rate beyond its limit", 100.0 * controller.rate_saturation, "%",
         controller.rate_saturation <= limits.rate_saturation),
    ]  # fmt: skip
    if task.demand is None:
        rows.append(("motion reduced by", 100.0 * controller.reduction, "%", None))
    return [
        {"name": name, "text": _text(value, unit), "good": None if good is None else bool(good)}
        for name, value, unit, good in rows
        if not math.isnan(value)
    ]


def _text(value: float, unit: str) -> str:
    text = f"below {_LEAST_PERCENT:g}" if unit == "%" and value < _LEAST_PERCENT else significant(value, 3)
    return f"{text} {unit}".rstrip() if math.isfinite(value) else "any"


def _step(task: TuningTask, gains: Any, controller: Controller) -> dict[str, Any] | None:
    """The change that is ordered, without ships drawn; None where the loop follows no demand or is unstable."""
    if task.demand is None or not math.isfinite(controller.Ms):
        return None
    try:
        answer = simulate_manoeuvres(task, task.loop, "under the hand", gains, _SEED, draws=0)[0]
    except InputError:
        return None
    settling = "does not settle within 5 %" if math.isnan(answer.settling) else f"settles in {answer.settling:.3g} s"
    names = {task.loop.output: task.loop.output, DEMAND: task.loop.output, task.loop.actuator: task.loop.actuator}
    return sampled_curves(answer.record, names) | {
        "text": f"overshoots by {100.0 * answer.overshoot:.2g} %, {settling}"
    }


def _sea(task: TuningTask, gains: Any, controller: Controller) -> dict[str, Any] | None:
    """The loop in its first sea with the limits of the actuator; None where it has no sea or is unstable."""
    seas = [disturbance for disturbance in task.disturbances if isinstance(disturbance, Seaway)]
    if not seas or not math.isfinite(controller.Ms):
        return None
    settings = replace(task.simulation or SimulationSettings(), seeds=1, duration=_SEA_SECONDS)
    try:
        answer = simulate_in_seaway(replace(task, simulation=settings), task.loop, "under the hand", gains, _SEED)
    except InputError:
        return None
    output = task.loop.output
    names = {output: output, f"{output}_{UNCONTROLLED}": output, task.loop.actuator: task.loop.actuator}
    text = f"motion reduced by {100.0 * float(answer.limited[0]):.0f} % in this sea"
    return sampled_curves(answer.record, names) | {"text": text}
