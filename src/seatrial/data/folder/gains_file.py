"""What a tuning gives its maker: gains with margins, proposals, the helmsman's table, the loop as a MAT-file."""

import keyword
import math
import re
from collections.abc import Mapping
from dataclasses import asdict
from functools import reduce
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from seatrial.core.results import Actuator, Design, TimedOrder
from seatrial.core.results.online import HeadingRange, Proposal
from seatrial.core.results.ship_motions import IntervalEstimate
from seatrial.core.results.station import StationKeeping
from seatrial.core.results.tuning import (
    Component,
    Controller,
    DiscreteController,
    OperatingPoint,
    ReferenceFilter,
    TrackKeeping,
    Tuning,
)
from seatrial.core.values import NOTATION, InputError, display_unit
from seatrial.core.values.files import parse_toml, read_table_text

# The helmsman's table in the units people read: as columns of text, and as the file for the trial.

TIME_DECIMALS = 3
"""Decimals of a time in seconds: milliseconds, below any helmsman's delay."""
RANGE_DECIMALS = 2
"""Decimals of an order relative to its range: the last digit is less than a hundredth of it."""


def channel_display_unit(name: str) -> tuple[float, str]:
    """Return the factor from SI and the unit of an input as people read it."""
    return display_unit(NOTATION[name].unit if name in NOTATION else "1")


def order_headings(actuators: tuple[Actuator, ...]) -> list[str]:
    """Return the headings: ``time [s]``, then each input with its unit."""
    return ["time [s]", *(f"{a.name} [{channel_display_unit(a.name)[1]}]" for a in actuators)]


def order_cells(order: TimedOrder, actuators: tuple[Actuator, ...]) -> list[str]:
    """Return time and orders as text; an input that the order does not change stays empty."""
    return [_decimal_text(order.time, TIME_DECIMALS), *(_order_text(order, a) for a in actuators)]


def orders_csv(design: Design) -> str:
    """Return the table as CSV."""
    rows = [order_headings(design.actuators), *(order_cells(order, design.actuators) for order in design.orders)]
    return "\n".join(",".join(cells) for cells in rows) + "\n"


def _order_text(order: TimedOrder, actuator: Actuator) -> str:
    if actuator.name not in order.values:
        return ""
    factor = channel_display_unit(actuator.name)[0]
    reach = (actuator.upper - actuator.lower) * factor
    return _decimal_text(order.values[actuator.name] * factor, max(0, RANGE_DECIMALS - math.floor(math.log10(reach))))


def _decimal_text(value: float, decimals: int) -> str:
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


# A tuned controller for its maker: gains, margins and schedule as TOML, the schedule as CSV.

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


# Proposed gains as a file for the person who may set them: gains, sea, craft, margins and reasons as TOML.
PROPOSAL = "proposal.toml"
_DIGITS = 6  # of what is estimated: finer than any interval, short enough to be read; chosen


def proposal_toml(proposal: Proposal) -> str:
    """Return ``proposal.toml``: angles in degrees where the key says so; what is infinite (any margin) is left out."""
    table: dict[str, Any] = {
        "format": FORMAT,
        "note": "a proposal for a person to judge; nothing sets it",
        "loop": proposal.loop,
        "has_gains": proposal.has_gains,
        "is_new": proposal.is_new,
        "reasons": list(proposal.reasons),
        "stretch": _finite({"start_s": proposal.start, "stop_s": proposal.stop, "U": proposal.U}),
        "gains": proposal.gains,
        "gain_units": proposal.gain_units,
    }
    if proposal.sea is not None:
        sea = proposal.sea
        table["sea"] = {
            "height": _interval(sea.height),
            "peak_period": _interval(sea.period),
            "heading_deg": _interval(sea.heading, math.degrees(1.0)),
            "is_heading_determined": sea.is_heading_determined,
            "headings": [_heading_range(heading) for heading in sea.headings],
        }
    if proposal.craft:
        table["craft"] = {property_change.name: _interval(property_change.factor) for property_change in proposal.craft}
    if proposal.margins is not None:
        m = proposal.margins
        table["margins"] = {
            "Ms": _interval(m.Ms),
            "gain_margin": _interval(m.gain_margin),
            "phase_margin_deg": _interval(m.phase_margin, math.degrees(1.0)),
            "delay_margin_s": _interval(m.delay_margin),
            "reduction": _interval(m.reduction),
            "saturation": _interval(m.saturation),
            "stable_draws": m.stable_draws,
            "draws": m.draws,
        }
    return tomli_w.dumps(table)


def _interval(estimated: IntervalEstimate, factor: float = 1.0) -> dict[str, float]:
    ends = {"value": estimated.value, "lower": estimated.lower, "upper": estimated.upper}
    return _finite({name: _rounded(factor * value) for name, value in ends.items()})


def _heading_range(one: HeadingRange) -> dict[str, float]:
    return {
        "from_deg": _rounded(math.degrees(one.lower)),
        "to_deg": _rounded(math.degrees(one.upper)),
        "probability": _rounded(one.probability),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def _finite(values: dict[str, float]) -> dict[str, float]:
    return {name: float(value) for name, value in values.items() if math.isfinite(value)}


# The chosen loop of a tuning as a MAT-file: every block, the controller and the open loop as polynomials.

HEADER = b"MATLAB 5.0 MAT-file, a feedback loop written by seatrial".ljust(116)
"""Text at the start of a MAT-file, 116 bytes by its format; it names no date, so that the same loop gives the same
bytes."""
RESERVED = {"end", "function", "otherwise", "switch", "case", "parfor", "spmd", "persistent", "catch", *keyword.kwlist}
"""Words that MATLAB or Python do not take for a variable."""
LONGEST_NAME = 60
"""Characters of a variable's name; MATLAB takes 63, a number may follow."""
POLYNOMIALS = ("controller_num", "controller_den", "open_loop_num", "open_loop_den")
Rational = tuple[NDArray[Any], NDArray[Any]]


def loop_mat(tuning: Tuning) -> bytes:
    """Return the chosen loop as a MAT-file of version 5; the same tuning gives the same bytes.

    A struct for each block (``num``, ``den``, ``role``, ``name``, ``gain``, ``value``), ``gains``, and where there are
    terms ``controller_num``, ``controller_den`` (K, from the output to the actuator, which moves by minus K y) and
    ``open_loop_num``, ``open_loop_den`` (L = P K). Powers of s fall, angles are radians.
    """
    from scipy.io import savemat

    gains = tuning.chosen.gains
    content: dict[str, Any] = {"gains": {_matlab_name(name): value for name, value in gains.items()}}
    for name, component in _matlab_names(tuning.components, {*content, *POLYNOMIALS}).items():
        content[name] = {
            "num": np.array(component.num), "den": np.array(component.den), "role": component.role,
            "name": component.name, "gain": component.gain,
            "value": gains.get(component.gain, 1.0) if component.gain else 1.0,
        }  # fmt: skip
    if any(c.role == "term" for c in tuning.components):
        controller, loop = controller_polynomials(tuning), open_loop_polynomials(tuning)
        content |= dict(zip(POLYNOMIALS, (*controller, *loop), strict=True))
    buffer = BytesIO()
    savemat(buffer, content, format="5", long_field_names=True, oned_as="row")  # type: ignore[arg-type]
    return HEADER + buffer.getvalue()[len(HEADER) :]


def controller_polynomials(tuning: Tuning) -> Rational:
    """Return K(s) = sensors * (sum of gain_i term_i) * filters * servo as num and den, highest power first.

    An integrator whose gain is zero is left out: it moves nothing.

    Raises:
        InputError: a term's gain is not among the chosen ones.
    """
    terms = [c for c in tuning.components if c.role == "term"]
    for term in terms:
        if term.gain not in tuning.chosen.gains:
            raise InputError(f"term '{term.name}' is multiplied by '{term.gain}', which is none of the chosen gains")
    moving = [c for c in terms if c.den[-1] or tuning.chosen.gains[c.gain]]
    dens = list(dict.fromkeys(c.den for c in moving))
    parallel = np.zeros(1)
    for term in moving:
        other_dens = (den for den in dens if den != term.den)
        numerator = reduce(np.polymul, other_dens, tuning.chosen.gains[term.gain] * np.array(term.num))
        parallel = np.polyadd(parallel, np.atleast_1d(numerator))
    sum_of_terms = np.atleast_1d(parallel), reduce(np.polymul, dens, np.ones(1))
    return _product(sum_of_terms, tuple(c for c in tuning.components if c.role in ("sensor", "filter", "servo")))


def open_loop_polynomials(tuning: Tuning) -> Rational:
    """Return L(s) = P(s) K(s) as num and den; the loop is closed negatively."""
    return _product(controller_polynomials(tuning), tuple(c for c in tuning.components if c.role == "plant"))


def _product(first: Rational, components: tuple[Component, ...]) -> Rational:
    num, den = first
    for c in components:
        num, den = np.polymul(num, c.num), np.polymul(den, c.den)
    return num, den


def _matlab_names(components: tuple[Component, ...], reserved: set[str]) -> dict[str, Component]:
    """Return each block under a different name that MATLAB takes for a variable."""
    named: dict[str, Component] = {}
    for c in components:
        word = stem = _matlab_name(c.name if c.name.startswith(c.role) else f"{c.role}_{c.name}")
        count = 2
        while word in named or word in reserved:
            word, count = f"{stem}_{count}", count + 1
        named[word] = c
    return named


def _matlab_name(name: str) -> str:
    """Return a name of letters, digits and underscores, a letter first."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:LONGEST_NAME] or "unnamed"
    return f"x_{word}" if not word[0].isalpha() else f"{word}_" if word.lower() in RESERVED else word
