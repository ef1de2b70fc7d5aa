"""Results side by side: verdicts, scores, coefficients with intervals and tracks; and manoeuvres simulated at once."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from seatrial import api
from seatrial.core.figures.time_plot import packed
from seatrial.core.results import Fit
from seatrial.core.results.coefficients import Coefficient
from seatrial.core.text.numbers import estimate_text
from seatrial.core.text.words import printable
from seatrial.core.values import InputError, Record
from seatrial.core.values.files import is_file
from seatrial.core.values.notation import POSITIONS, channel_label, display_values, reading_order
from seatrial.core.values.record_chart import has_moving_track, is_constant
from seatrial.data.folder.model_file import ModelFile
from seatrial.reporting.key_facts import key_facts
from seatrial.reporting.verdict import verdict
from seatrial.workspace.jobs import note_of

RESULT, MODEL, TRIAL_COPY = "result.json", "model.toml", "trial.toml"
_LONGEST = 2000  # letters of a sentence that is shown; chosen
_KEPT_FITS = 8  # that stay in memory; chosen: as many as one compares
_TRACK_POINTS = 400  # of a track or a curve on the screen; chosen
_CURVES = 4  # channels of a simulated manoeuvre that are drawn; chosen


def fit_folders(root: Path) -> list[Path]:
    """Return the folders of fits below a folder, and those in which one was begun from here; the oldest first."""
    folders = {path.parent for name in (RESULT, "job.json") for path in root.glob(f"*/*/{name}")}
    folders |= {path.parent for name in (RESULT, "job.json") for path in root.glob(f"*/{name}")}
    fits = [path for path in folders if is_file(path / RESULT) or note_of(path).get("kind") == "fit"]
    return sorted(fits, key=lambda path: (path.stat().st_mtime, path.name))


def fit_view(root: Path, folder: Path) -> dict[str, Any]:
    """Return what a page shows of a fit; of one that failed or was stopped why.

    Raises:
        InputError: it cannot be read.
    """
    name = folder.relative_to(root).as_posix()
    pages = {f"has_{page}": is_file(folder / f"{page}.html") for page in ("report", "poster")}
    head = {"name": name, "has_trial": is_file(folder / TRIAL_COPY), **pages}
    note = note_of(folder)
    if not is_file(folder / RESULT):
        return head | {
            "state": note.get("state", "stopped"),
            "message": printable(str(note.get("message", "")), _LONGEST),
        }
    fit = loaded_fit(folder)
    return head | {
        "state": "done",
        "model": fit.model.name,
        "verdict": printable(verdict(fit), _LONGEST),
        "facts": [
            {"name": fact.name, "text": printable(str(fact.text), _LONGEST), "good": fact.is_good}
            for fact in key_facts(fit)
        ],
        "coefficients": [_coefficient(coefficient) for coefficient in fit.coefficients],
        "tracks": [_run(p.record, p.measured, p.simulated) for p in fit.validation],
        "manoeuvres": manoeuvres_of(fit.model),
        "speed": _approach(folder),
    }  # fmt: skip


def _coefficient(c: Coefficient) -> dict[str, Any]:
    ends = {"low": c.lower, "high": c.upper}
    texts = estimate_text(c.estimate, c.standard_error, c.lower, c.upper)
    return {
        "shown": f"{texts.value}{texts.power}", "interval": f"{texts.lower} to {texts.upper}{texts.power}",
        "name": c.name, "meaning": c.meaning, "unit": "" if c.unit == "1" else c.unit, "value": c.estimate,
        "fixed": c.fixed, "guessed": c.is_unmeasured, "sign_open": c.is_sign_open, "source": c.source,
        **{key: None if value is None or not math.isfinite(value) else float(value) for key, value in ends.items()},
    }  # fmt: skip


def _approach(folder: Path) -> float | None:
    speed = loaded_model(folder).approach.get("u")
    return None if speed is None else float(f"{speed:.4g}")


def loaded_fit(folder: Path) -> Fit:
    """Return the fit of a folder, as it is on disk now.

    Raises:
        InputError: it cannot be read.
    """
    return _fit(folder, (folder / RESULT).stat().st_mtime_ns)


def loaded_model(folder: Path) -> ModelFile:
    """Return the model file of a folder, as it is on disk now.

    Raises:
        InputError: there is none, or it cannot be read.
    """
    if not is_file(folder / MODEL):
        raise InputError(f"'{folder.name}' holds no model; start the fit again")
    return _model(folder, (folder / MODEL).stat().st_mtime_ns)


@lru_cache(maxsize=_KEPT_FITS)
def _fit(folder: Path, changed: int) -> Fit:  # noqa: ARG001  changed: a part of the key
    return api.load_fit(folder)


@lru_cache(maxsize=_KEPT_FITS)
def _model(folder: Path, changed: int) -> ModelFile:  # noqa: ARG001
    return api.load_model(folder / MODEL)


def manoeuvres_of(model: Any) -> list[str]:
    """Return the manoeuvres that a craft of this kind is tried by, as `simulate` takes them."""
    if model.is_roll:
        return ["release:10", "release:20"]
    if model.has_thrusters:
        return ["spin:50", "straight:50", "stop:50"]
    if not model.has_rudder:
        return []
    return ["turning-circle:35", "turning-circle:35:port", "zigzag:10/10", "zigzag:20/20", "pull-out"]


def simulated_view(
    folder: Path, manoeuvre: str, values: Mapping[str, float], speed: float | None = None
) -> dict[str, Any]:
    """Return a manoeuvre simulated with coefficients where a hand has put them, beside that of the estimates.

    Args:
        values: of free coefficients, within their intervals; others stay as estimated. speed: approach speed [m/s].

    Raises:
        InputError: a value beyond its interval, no such coefficient, or a manoeuvre that cannot be simulated.
    """
    fit, file = loaded_fit(folder), loaded_model(folder)
    for name, value in values.items():
        _require_within(fit, name, value)
    moved = replace(file, model=file.model.with_values(dict(values)))
    return {
        "estimate": _manoeuvre(file, manoeuvre, speed), "moved": _manoeuvre(moved, manoeuvre, speed) if values else None
    }  # fmt: skip


def _require_within(fit: Fit, name: str, value: float) -> None:
    coefficient = next((c for c in fit.coefficients if c.name == name and not c.fixed), None)
    if coefficient is None:
        raise InputError(f"'{name}' is no free coefficient of this fit")
    low, high, slack = coefficient.lower, coefficient.upper, 1e-9 * abs(coefficient.estimate)  # of a slider's rounding
    if low is None or high is None or not low - slack <= value <= high + slack:
        raise InputError(f"{name} = {value:.4g} lies beyond its 95 % interval; the records say nothing there")


def _manoeuvre(file: ModelFile, manoeuvre: str, speed: float | None) -> dict[str, Any]:
    from seatrial.physics.manoeuvres import measures

    record = api.simulate(file, manoeuvre, speed=speed)
    length = 0.0 if file.ship is None else file.ship.particulars.get("L", 0.0)
    values = measures(record, length) if length and file.model.has_rudder else {}
    return {
        **_curves(record),
        "measures": {name: float(f"{value:.4g}") for name, value in values.items() if math.isfinite(value)},
    }


def _curves(record: Record) -> dict[str, Any]:
    """Track and first channels of a record."""
    names = [name for name in reading_order(list(record.channels)) if not is_constant(record, name)]
    first = [name for name in names if name not in POSITIONS][:_CURVES]
    return sampled_curves(record, {name: name for name in first})


def sampled_curves(record: Record, names: Mapping[str, str]) -> dict[str, Any]:
    """Return channels of a record, and its track where it moves, on an even grid of its samples.

    names: channel -> the one whose unit it is read in, such as ``phi_uncontrolled`` -> ``phi``; absent ones left out.
    """
    kept = np.unique(np.linspace(0, len(record) - 1, min(_TRACK_POINTS, len(record))).astype(int))
    curves = []
    for name, like in names.items():
        if name in record:
            unit = record.channel(name).unit
            text = "" if name == like else name.removeprefix(like).replace("_", " ")
            values = display_values(like, record[name], unit)
            curves.append({"label": channel_label(like, unit), "name": text.strip(), "values": packed(values[kept])})
    track = None
    if has_moving_track(record):
        track = {"north": packed(record["x0"][kept]), "east": packed(record["y0"][kept])}
    ends = [float(record.time[0]), float(record.time[-1])]
    return {"time": ends, "count": len(kept), "curves": curves, "track": track}


def _run(name: str, measured: Record, simulated: Record) -> dict[str, Any]:
    return {"run": name, "measured": _curves(measured), "simulated": _curves(simulated)}
