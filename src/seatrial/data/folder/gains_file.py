"""A tuned controller for its maker: gains, margins and schedule as TOML, the schedule as CSV."""

import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import tomli_w

from seatrial.core.results.station import StationKeeping
from seatrial.core.results.tuning import (
    Controller,
    DiscreteController,
    OperatingPoint,
    ReferenceFilter,
    TrackKeeping,
    Tuning,
)
from seatrial.core.values import InputError
from seatrial.core.values.tables import parse_toml, read_table_text
from seatrial.data.folder.orders import channel_display_unit

FORMAT = 1
REVERSED = "reversed"
"""Name of the filter of a plant that turns the other way: a sign."""
_EVERY = 5  # of the points of a table of thrust one is written: 41 of 201; chosen


def gains_toml(tuning: Tuning) -> str:
    """Return ``gains.toml``: chosen gains, their task and constraints, their margins, the schedule if there is one.

    Angles are in degrees where the key says so; what is infinite (no limit, any margin) is left out.
    """
    table: dict[str, Any] = {
        "format": FORMAT,
        "controller": {"name": tuning.name, "plant": tuning.plant, "output": tuning.output,
                       "actuator": tuning.actuator, "seas": list(tuning.seas)},
        "gains": _finite_numbers(tuning.chosen.gains),
        "gain_units": dict(tuning.gain_units),
        "margins": _margin_table(tuning.chosen),
        "constraints": _constraint_table(tuning),
        "provenance": {"seed": tuning.seed, "versions": tuning.versions, "violated": list(tuning.chosen.violated)},
    }  # fmt: skip
    if tuning.discrete is not None:
        table["discrete"] = _discrete_table(tuning.discrete)
        if tuning.discrete.reference is not None:
            table["reference"] = _reference_table(tuning.discrete.reference, tuning.output)
    if tuning.track is not None:
        table["track"] = _track_table(tuning.track)
    if tuning.station is not None:
        table["station"] = _station_table(tuning.station)
    if tuning.schedule:
        table["schedule"] = [_schedule_entry(point) for point in tuning.schedule]
    return tomli_w.dumps(table)


_ORDER = (
    "order = filters in turn of the sum of gain * term(reference - output), plus what is fed forward; it stands for a "
    "sample; a sensor, num / den in s, lies before the sample, noise and resolution before the sensor"
)
_HOLD = (
    "achieved moves to the order no faster than rate, within limit of [constraints]; a term with hold = 1 or -1 keeps "
    "its last output y at a sample where (order - achieved) of the sample before * hold * gain * (new y - last y) > 0"
)
_REFERENCE = (
    "x'' + 2 w x' + w^2 x = w^2 r, w = 1 / time_constant_s, x' no faster than rate, follows what is ordered, r; "
    "level x + velocity x' + acceleration x'', in SI units, is added to the actuator's order"
)


_TRACK = (
    "once a sample psi_d = chi - atan((e + sigma q) / Delta), e to starboard of the leg of course chi, q' = Delta e / "
    "((e + sigma q)^2 + Delta^2); Delta the lookahead, sigma the integral gain; psi_d, no faster than the order's "
    "rate, is the reference of [discrete] in place of [reference], and nothing is fed forward"
)

_STATION = (
    "once a sample, e north, east, heading, which has noise and resolution of [discrete]: order = -(KP R'e + KI R'q + "
    "KD v), R the rotation by the heading; v[k] = "
    "((2 lag - sample) v[k-1] + 2 R'(e[k] - e[k-1])) / (2 lag + sample); q[k] = q[k-1] + sample (e[k] + e[k-1]) / 2, "
    "which waits while thrusters are at their limits; thrust = inverse order, all reduced alike to be within the "
    "tables; share of full command over thrust; it acts after the dead time, for a sample"
)


def _discrete_table(controller: DiscreteController) -> dict[str, Any]:
    """Return the controller as it was simulated."""
    sensor = [
        {"name": component.name, "num": list(component.num), "den": list(component.den)}
        for component in controller.sensor
    ]
    return {
        "sample_s": controller.sample_s,
        "dead_time_s": controller.dead_time,
        "noise": controller.noise,
        "resolution": controller.resolution,
        "rule": "Tustin",
        **({"sensor": sensor} if sensor else {}),
        "order": _ORDER,
        "hold": _HOLD,
        "blocks": [asdict(block) for block in controller.blocks],
    }


def _reference_table(reference: ReferenceFilter, output: str) -> dict[str, Any]:
    """Return what the loop follows in place of an order, the rate in the unit of the output."""
    factor, unit = channel_display_unit(output)
    ending = "" if unit == "1" else f"_{unit}".replace("/", "_per_")
    numbers = {
        "time_constant_s": reference.time_constant,
        f"rate{ending}_per_s": reference.rate * factor,
        "level": reference.level,
        "velocity": reference.velocity,
        "acceleration": reference.acceleration,
    }
    return {"rule": _REFERENCE, **_finite_numbers(numbers)}


def controller_gains(path: str | Path) -> dict[str, float]:
    """Return the gains of a ``gains.toml`` for a controller that is its terms alone.

    Raises:
        InputError: what `read_gains` refuses, or the controller has filters that would be left out.
    """
    gains, discrete = read_gains(path), _gains_table(Path(path)).get("discrete", {})
    blocks = discrete.get("blocks", []) if isinstance(discrete, dict) else []
    left_out = [str(b.get("name")) for b in blocks if b.get("role") == "filter" and b.get("name") != REVERSED]
    if left_out:
        raise InputError(
            f"'{path}': the gains were tuned with {', '.join(left_out)}, which has no place there; tune without it"
        )
    return gains


def read_gains(path: str | Path) -> dict[str, float]:
    """Return the gains of a ``gains.toml``, name -> value to the last bit.

    Raises:
        InputError: the file cannot be read, is no TOML, or has no table [gains] of finite numbers.
    """
    gains = _gains_table(Path(path)).get("gains")
    if not isinstance(gains, dict) or not gains:
        raise InputError(f"'{path}' has no table [gains] with a line for each gain, such as KP = 11.053")
    for name, value in gains.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise InputError(f"'{path}': gain {name} = {value!r} is no finite number; write one")
    return {name: float(value) for name, value in gains.items()}


def read_schedule(path: str | Path) -> tuple[OperatingPoint, ...]:
    """Return the schedule of a ``gains.toml``, without the costs of other gains.

    Raises:
        InputError: the file cannot be read, is no TOML, has no schedule, or an entry of it is incomplete.
    """
    entries = _gains_table(Path(path)).get("schedule")
    if not isinstance(entries, list) or not entries:
        raise InputError(
            f"'{path}' has no [[schedule]]: add [schedule] to the loop file, run 'seatrial tune LOOP --out DIR' again"
        )
    try:
        return tuple(_schedule_point(entry) for entry in entries)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"'{path}': an entry of [[schedule]] is incomplete ({error}); run 'seatrial tune LOOP --out DIR' again"
        ) from None


def _gains_table(path: Path) -> Mapping[str, Any]:
    """Return the tables of a ``gains.toml``."""
    try:
        return parse_toml(read_table_text(path))
    except OSError as error:
        raise InputError(f"'{path}' cannot be read ({error.strerror}); give a gains.toml of 'seatrial tune'") from None
    except ValueError as error:
        raise InputError(f"'{path}' is no TOML ({error}); give a gains.toml of 'seatrial tune'") from None


def schedule_csv(tuning: Tuning) -> str:
    """Return the schedule as CSV, a line for each condition; empty without one."""
    if not tuning.schedule:
        return ""
    first = tuning.schedule[0]
    costs = [f"cost {name}" for name in first.baseline_costs]
    judged = ("cost", *costs, "Ms", "saturation", "feasible", "lacks")
    heads = ["U [m/s]", "heading [deg]", "height [m]", *first.gains, *judged]
    rows = [[_csv_cell(head) for head in heads]]
    for s in tuning.schedule:
        numbers = (s.U, math.degrees(s.beta), s.height, *s.gains.values(), s.cost, *s.baseline_costs.values(), s.Ms,
                   s.saturation)  # fmt: skip
        texts = [f"{x:.8g}" if math.isfinite(x) else "" for x in numbers]  # digits of a single-precision number
        rows.append([*texts, "yes" if s.is_feasible else "no", _csv_cell("; ".join(s.lacks))])
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _finite_numbers(values: dict[str, float]) -> dict[str, float]:
    """Return the finite ones as Python floats."""
    return {name: float(value) for name, value in values.items() if math.isfinite(value)}


def _margin_table(c: Controller) -> dict[str, float]:
    return _finite_numbers({
        "Ms": c.Ms,
        "gain_margin": c.gain_margin,
        "lower_gain_margin": c.lower_gain_margin,
        "phase_margin_deg": math.degrees(c.phase_margin),
        "delay_margin_s": c.delay_margin,
        "damping_ratio": c.damping,
        "reduction": c.reduction,
        "saturation": c.saturation,
        "rate_saturation": c.rate_saturation,
        "noise_gain": c.noise_gain,
        "reversals_per_hour": c.reversals,
        "energy_J": c.energy,
    })  # fmt: skip


def _track_table(track: TrackKeeping) -> dict[str, Any]:
    """Return the guidance of a track with its law, see `TrackKeeping`."""
    numbers = _finite_numbers({
        "lookahead_m": track.lookahead,
        "integral_gain_m_per_s": track.integral_gain,
        "order_rate_deg_per_s": math.degrees(track.order_rate),
        "speed_m_per_s": track.speed,
        "Ms": track.Ms,
    })  # fmt: skip
    return {"rule": _TRACK, **numbers}


def _station_table(station: StationKeeping) -> dict[str, Any]:
    """Return the station keeper: gains, filter and sample time, and of each thruster its share of the force."""
    return {
        "rule": _STATION,
        "sample_s": station.sample_s,
        "dead_time_s": station.dead_time - 0.5 * station.sample_s,
        "filter_lag_s": station.filter_lag.tolist(),
        **{name: getattr(station, name).tolist() for name in ("KP", "KI", "KD")},
        "gain_units": {name: [list(row) for row in units] for name, units in station.gain_units.items()},
        "force_unit": station.force_unit,
        "thrusters": [
            {"name": thruster.name, "inverse": thruster.inverse.tolist(), "thrust": thruster.thrust[::_EVERY].tolist(),
             "share": thruster.share[::_EVERY].tolist()}
            for thruster in station.thrusters
        ],
        **_finite_numbers({
            "Ms_surge": station.margins.surge,
            "Ms_sway": station.margins.sway,
            "Ms_yaw": station.margins.yaw,
            "Ms_joint": station.margins.joint,
            "delay_margin_s": station.margins.delay_margin,
            "radius_m": station.trial.radius,
        }),
    }  # fmt: skip


def _constraint_table(tuning: Tuning) -> dict[str, float]:
    """Return the constraints, keys of angles ending in their unit."""
    r, (factor, unit) = tuning.constraints, channel_display_unit(tuning.actuator)
    ending = "" if unit == "1" else f"_{unit}".replace("/", "_per_")
    return _finite_numbers({
        "Ms": r.Ms,
        "saturation": r.saturation,
        "rate_saturation": r.rate_saturation,
        f"limit{ending}": r.limit * factor,
        f"rate{ending}_per_s": r.rate * factor,
        f"stall{ending}": r.stall * factor,
    })  # fmt: skip


def _schedule_entry(point: OperatingPoint) -> dict[str, Any]:
    return {
        "U": float(point.U),
        "heading_deg": math.degrees(point.beta),
        "height": float(point.height),
        "gains": _finite_numbers(point.gains),
        **_finite_numbers({"cost": point.cost, "Ms": point.Ms, "saturation": point.saturation}),
        "feasible": bool(point.is_feasible),
        "lacks": list(point.lacks),
    }


def _schedule_point(entry: Mapping[str, Any]) -> OperatingPoint:
    """Return what `_schedule_entry` wrote; what it left out as infinite is infinite."""
    gains = {str(name): float(value) for name, value in entry["gains"].items()}
    beta = math.radians(float(entry["heading_deg"]))
    cost, Ms, saturation = (float(entry.get(key, math.inf)) for key in ("cost", "Ms", "saturation"))
    point = OperatingPoint(
        float(entry["U"]), beta, float(entry["height"]), gains, cost, Ms, saturation, {}, bool(entry["feasible"])
    )
    if not all(map(math.isfinite, (point.U, point.beta, point.height, *gains.values()))):
        raise ValueError("a number is not finite")
    return point


def _csv_cell(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if re.search(r'[",\n]', text) else text
