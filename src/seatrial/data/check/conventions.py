"""Declared conventions compared with the data: frame, sign, unit, point, and the side of drift."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Channel, Finding, InputError, Record, Severity, TrialEdit, quantity
from seatrial.core.values.arrays import unwrapped
from seatrial.core.values.notation import COMMANDS, NOTATION, OPPOSITE, positive_direction
from seatrial.data.check.consequences import REVERSED
from seatrial.data.check.motion import (
    DOUBTFUL_RATIO,
    PositionReading,
    RecordedMotion,
    VelocityConvention,
    smoothed_derivative,
)

# Declared conventions to the notation table's: sign, frame, reference point, unwrapped angles.

_VELOCITY_PAIRS = (("u", "v"), ("u_dot", "v_dot"))
_UNWRAPPED_CHANNELS = (
    "psi", "wind_direction", "wind_direction_relative", *(c for c in COMMANDS if c.startswith("alpha"))
)  # fmt: skip

_UPRIGHT_CHANNELS = ("phi", "theta")


def canonical_record(record: Record, reference_point: float = 0.0) -> Record:
    """Return the record in the notation table's conventions, by its declared metadata only.

    Every channel points in the table's positive direction (positive rudder turns to starboard), u and v are body-fixed,
    v, x0 and y0 refer to the point `reference_point` metres forward of midship, headings and wind angles are
    unwrapped, roll and pitch also about upright. Applying it twice changes nothing.

    Raises:
        InputError: a positive direction is unknown, or the heading or yaw rate a conversion needs is missing.
    """
    return _moved_to_reference_point(_in_body_axes(with_standard_signs(record)), reference_point)


def with_standard_signs(record: Record) -> Record:
    """Return the record with the table's signs and angles unwrapped; frames and reference points as they were.

    Raises:
        InputError: a positive direction is neither the notation table's nor its opposite.
    """
    flipped = [s for s, c in record.channels.items() if _has_opposite_sign(s, c, record.name)]
    channels = {s: _with_standard_sign(s, c, flip=s in flipped) for s, c in record.channels.items()}
    record = replace(record, channels=channels)
    return record.with_step(f"sign of {', '.join(flipped)} turned") if flipped else record


def _has_opposite_sign(symbol: str, channel: Channel, record: str) -> bool:
    if symbol not in NOTATION:
        return False
    wanted = positive_direction(symbol, channel.frame)
    if channel.positive == wanted:
        return False
    if channel.positive != OPPOSITE.get(wanted):
        either = f"'{wanted}' or '{OPPOSITE[wanted]}'" if wanted in OPPOSITE else f"'{wanted}'"
        raise InputError(f"record '{record}', channel '{symbol}': positive must be {either}, not '{channel.positive}'")
    return True


def _with_standard_sign(symbol: str, channel: Channel, *, flip: bool) -> Channel:
    values = -channel.values if flip else channel.values
    if symbol in _UNWRAPPED_CHANNELS:
        values = unwrapped(values)
    if symbol in _UPRIGHT_CHANNELS and np.any(np.isfinite(values)):
        values = unwrapped(values)
        values = values - math.tau * np.round(np.nanmean(values) / math.tau)
    positive = positive_direction(symbol, channel.frame) if symbol in NOTATION else channel.positive
    return replace(channel.with_values(values), positive=positive)


def _in_body_axes(record: Record) -> Record:
    """u = x0' cos(psi) + y0' sin(psi), v = -x0' sin(psi) + y0' cos(psi) (Fossen 2021, eq. 2.42 inverted)."""
    for a, b in _VELOCITY_PAIRS:
        frames = {s: record.channel(s).frame for s in (a, b) if s in record}
        if "earth" not in frames.values():
            continue
        if set(frames.values()) != {"earth"} or len(frames) < 2 or "psi" not in record:
            raise InputError(
                f"record '{record.name}': turning earth-fixed {a}, {b} into the ship's axes needs both of them "
                "and the heading 'psi'"
            )
        c, s = np.cos(record["psi"]), np.sin(record["psi"])
        north, east = record.channel(a), record.channel(b)
        ahead = _body_fixed_channel(a, north, north.values * c + east.values * s)
        aside = _body_fixed_channel(b, east, east.values * c - north.values * s)
        record = record.with_channel(a, ahead).with_channel(b, aside, f"{a}, {b} turned into the ship's axes")
    return record


def _body_fixed_channel(symbol: str, channel: Channel, values: Array) -> Channel:
    return replace(channel.with_values(values), frame="body", positive=quantity(symbol).positive)


def _moved_to_reference_point(record: Record, reference_point: float) -> Record:
    """v_P = v + d r, x_P = x + d cos(psi), y_P = y + d sin(psi), d = distance to P (Fossen 2021, section 2.3)."""
    moved, places = [], list[str]()
    for symbol, needed in (("v", "r"), ("v_dot", "r"), ("x0", "psi"), ("y0", "psi")):
        if symbol not in record:
            continue
        channel = record.channel(symbol)
        distance = reference_point - channel.reference_point
        if distance != 0.0:
            if needed not in record:
                raise InputError(
                    f"record '{record.name}': moving '{symbol}' to a point {distance:+g} m off needs channel '{needed}'"
                )
            values = channel.values + distance * _lever(symbol, record)
            record = record.with_channel(symbol, replace(channel.with_values(values), reference_point=reference_point))
            moved.append(symbol)
            places.append(f"{channel.reference_point:g} m")
    same = {s: replace(record.channel(s), reference_point=reference_point) for s in ("u", "u_dot") if s in record}
    record = replace(record, channels={**record.channels, **same})
    if not moved:
        return record
    origin = enumeration(list(dict.fromkeys(places)))
    return record.with_step(f"{', '.join(moved)} moved from x = {origin} to {reference_point:g} m from midship")


def _lever(symbol: str, record: Record) -> Array:
    if symbol in ("x0", "y0"):
        return (np.cos if symbol == "x0" else np.sin)(record["psi"])
    return record["r"] if symbol == "v" else np.gradient(record["r"], record.time)


# Velocities against the derivative of position: frame, sign, unit; the declared reading against the best.

# factor by which another convention must reduce the misfit to be certain; chosen
CERTAIN_RATIO = 3.0
# rms difference from the track over rms speed that is acceptable, rough, and negligible; chosen
ACCEPTABLE_MISFIT, ROUGH_MISFIT, NEGLIGIBLE_MISFIT = 0.3, 0.1, 0.03
# misfit over that of the noise of the positions, up to which a slow craft shows nothing; chosen
NOISE_FACTOR = 2.0
# departure of a factor on the speed from another, relative, up to which they are the same; chosen: units differ by more
SAME_SCALE = 0.1
# heading [rad] by which psi must be off before that is said here; chosen: smaller ones show in closure
LARGE_OFFSET = math.radians(15.0)
# factor from the number in the file, taken as m/s, to the true m/s (SI brochure 2019; 1 kn = 1852 m/h), what to write
_SPEED_UNITS = {
    "in knots": (1852.0 / 3600.0, 'unit = "kn"'),
    "in km/h": (1.0 / 3.6, 'unit = "km/h"'),
    "in mm/s": (1e-3, "scale = 0.001"),
    "in m/s although declared in knots": (3600.0 / 1852.0, 'unit = "m/s"'),
    "in m/s although declared in km/h": (3.6, 'unit = "m/s"'),
}


def velocity_convention_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Findings on u, v and psi of a record; none where it stays at one place."""
    if np.ptp(motion.record["x0"]) + np.ptp(motion.record["y0"]) == 0:
        return ()
    best = motion.best_reading
    comparison = _Comparison(motion, best, motion.misfit(motion.conventions[0]), motion.misfit(best))
    return tuple(_comparison_findings(comparison))


@dataclass(frozen=True)
class _Comparison:
    """The declared reading of a motion and the best one, with their misfits."""

    motion: RecordedMotion
    best: VelocityConvention
    declared_misfit: float
    best_misfit: float

    def is_better_by(self, ratio: float, least: float) -> bool:
        """Return whether the best reading departs from the declared one, which is worse than `least` and by `ratio`."""
        return self.motion.is_refuted and self.declared_misfit > max(least, ratio * self.best_misfit)

    def finding(
        self, severity: Severity, code: str, text: str, advice: str, edits: tuple[TrialEdit, ...] = ()
    ) -> Finding:
        """Return a finding whose evidence are the misfits."""
        evidence = (
            f"rms misfit with the derivative of position {self.declared_misfit:.1%} as declared, "
            f"{self.best_misfit:.1%} otherwise"
        )
        return Finding(severity, code, f"record '{self.motion.record.name}': {text}", evidence, advice, edits=edits)


def _comparison_findings(comparison: _Comparison) -> list[Finding]:
    best, motion = comparison.best, comparison.motion
    angle, misfit = motion.heading_offset() if motion.frame == "body" else (0.0, np.inf)
    if abs(angle) > LARGE_OFFSET and misfit * CERTAIN_RATIO < comparison.best_misfit:
        return [_heading_offset_finding(comparison, angle, misfit)]
    if comparison.best_misfit > max(ACCEPTABLE_MISFIT, NOISE_FACTOR * motion.noise_misfit):
        text = "u, v fit the derivative of position in no frame"
        advice = "check columns, units and noise of positions and velocities"
        return [comparison.finding(Severity.WARNING, "velocity-frame", text, advice)]
    findings = _speed_unit_findings(motion, best)
    if comparison.is_better_by(CERTAIN_RATIO, NEGLIGIBLE_MISFIT):
        return [*_contradiction_findings(comparison), *findings]
    if comparison.is_better_by(DOUBTFUL_RATIO, ROUGH_MISFIT):
        doubts = _contradiction_findings(comparison)
        readings = "; ".join(doubt.message.partition(": ")[2] for doubt in doubts)
        text = f"another reading fits the position better: {readings}"
        advice = "check frame, sign and unit of u, v and psi"
        return [comparison.finding(Severity.WARNING, doubts[0].code, text, advice), *findings]
    return findings


def _heading_offset_finding(comparison: _Comparison, angle: float, misfit: float) -> Finding:
    turned = replace(comparison, best_misfit=misfit)
    text = f"psi is off by {math.degrees(angle):+.1f} deg: a misaligned compass, a magnetic variation, or another zero"
    edit = TrialEdit("channels.psi.offset", f"{angle:.6g}", "rad")
    return turned.finding(Severity.ERROR, "heading-zero", text, "", (edit,))


def _contradiction_findings(comparison: _Comparison) -> list[Finding]:
    motion, best = comparison.motion, comparison.best
    statements = (*_position_statements(best), *_velocity_statements(motion, best), *_heading_statements(best))
    return [comparison.finding(Severity.ERROR, code, text, "", edits) for code, text, edits in statements]


_Statement = tuple[str, str, tuple[TrialEdit, ...]]  # code, text, edits of a finding


def _position_statements(best: VelocityConvention) -> list[_Statement]:
    match best.position:
        case PositionReading.EXCHANGED:
            edit = TrialEdit("channels.x0", exchanged_with="channels.y0")
            return [("position-axes", "x0 and y0 are exchanged (x0 counts to the east)", (edit,))]
        case PositionReading.REVERSED_EAST:
            return [("position-sign", "y0 has the opposite sign", (_reversed("y0"),))]
        case _:
            return []


def _velocity_statements(motion: RecordedMotion, best: VelocityConvention) -> list[_Statement]:
    record, statements = motion.record, list[_Statement]()
    if best.is_exchanged:
        edit = TrialEdit("channels.u", exchanged_with="channels.v")
        statements.append(("velocity-axes", "u and v are exchanged", (edit,)))
    if best.frame != motion.frame:
        labels = ", ".join(f"'{record.channel(s).label or s}'" for s in ("u", "v"))
        words = {"earth": "earth-fixed (north, east)", "body": "the ship's own (surge, sway)"}[best.frame]
        text = f"u, v ({labels}) are {words} velocities, not '{motion.frame}' as declared"
        edits = tuple(TrialEdit(f"channels.{s}.frame", f'"{best.frame}"') for s in ("u", "v"))
        statements.append(("velocity-frame", text, edits))
    if best.v_sign < 0:
        statements.append(("velocity-sign", "v has the opposite sign", (_reversed("v"),)))
    return statements


def _heading_statements(best: VelocityConvention) -> list[_Statement]:
    if best.psi_from_east:
        edit = TrialEdit("channels.psi.frame", '"enu"')
        return [("heading-zero", "psi counts from east, counter-clockwise, not from north", (edit,))]
    if best.psi_factor == -1.0:
        return [("heading-sign", "psi turns the other way", (_reversed("psi"),))]
    if best.psi_factor != 1.0:
        wrong, right = ("radians", "degrees") if best.psi_factor < 1.0 else ("degrees", "radians")
        edit = TrialEdit("channels.psi.unit", f'"{right[:3]}"')
        return [("angle-unit", f"psi is in {right}, not in {wrong}", (edit,))]
    return []


def _reversed(symbol: str) -> TrialEdit:
    return TrialEdit(f"channels.{symbol}.positive", REVERSED)


def _speed_unit_findings(motion: RecordedMotion, best: VelocityConvention) -> list[Finding]:
    k = motion.speed_scale(best)
    if k <= 0 or abs(k - 1.0) < SAME_SCALE:
        return []
    unit, (factor, key_value) = min(_SPEED_UNITS.items(), key=lambda item: abs(math.log(k / item[1][0])))
    name, evidence = f"record '{motion.record.name}'", f"derivative of position is {k:.3g} times the velocity"
    if abs(math.log(k / factor)) < SAME_SCALE:
        key, value = key_value.split(" = ")
        edits = tuple(TrialEdit(f"channels.{symbol}.{key}", value) for symbol in ("u", "v"))
        return [Finding(Severity.ERROR, "speed-unit", f"{name}: u, v are {unit}", evidence, edits=edits)]
    advice = "check units, the scale of the log, and whether the speed is through water"
    text = f"{name}: u, v and the positions differ in scale"
    return [Finding(Severity.WARNING, "speed-scale", text, evidence, advice)]


# Drift in turns: a hull turns with its bow to the inside, and a record that has it outside is off somewhere.

LEAST_TURN = float(np.radians(180.0))
"""Change of heading in one direction that counts as a turn [rad]: a steady current averages out over more; chosen."""
LEAST_DRIFT = float(np.radians(2.0))
"""Drift to the outside of the turn from which on it is said [rad]: some errors of a compass; chosen."""
_SLOW = 0.3  # share of the record's highest speed ahead, below which a craft spins rather than turns; chosen


@dataclass(frozen=True)
class _Turn:
    """A turn's mean drift to its outside [rad], and how far the point without drift lies aft of midship [m]."""

    is_starboard: bool
    outward: float
    aft: float


def drift_side_findings(motion: RecordedMotion) -> tuple[Finding, ...]:
    """Return a warning `drift-side` where the bow points out of every turn, at midship as declared; else nothing.

    Forces on the hull need a drift to the inside (Fossen 2021, Handbook of Marine Craft Hydrodynamics and Motion
    Control, 2nd ed., section 3.3, sideslip and crab angle): sway is negative in a turn to starboard.
    """
    turns = _turns(motion)
    if not turns or any(turn.outward < LEAST_DRIFT for turn in turns):
        return ()
    sides = [
        f"{np.degrees(np.mean([t.outward for t in turns if t.is_starboard == side])):.1f} deg in turns to {name}"
        for side, name in ((True, "starboard"), (False, "port"))
        if any(t.is_starboard == side for t in turns)
    ]
    aft = float(np.median([t.aft for t in turns]))
    return (Finding(
        Severity.WARNING, "drift-side", f"record '{motion.record.name}': the bow points out of the turn, where that of "
        "a ship points into it", f"{', '.join(sides)}; the point without drift lies {significant(aft, 2)} m aft of "
        "where the velocities are said to be",
        "if the antenna is ahead of midship, state it: antenna = { x = ..., y = ... } under [[records]]; else check "
        "the signs of v, of heading and of course",
        "sway is that of another motion, and so are all coefficients of sway",
    ),)  # fmt: skip


def _turns(motion: RecordedMotion) -> list[_Turn]:
    """Turns by their later half, where the drift has settled."""
    record = motion.record
    psi, dt = record["psi"], record.dt
    inner = smoothed_derivative(psi, dt, motion.window_samples)
    margin = (len(psi) - len(inner)) // 2
    rate = np.pad(inner, (margin, len(psi) - len(inner) - margin), mode="edge")
    ahead, aside = _body_velocities(motion)
    aside = aside - rate * record.channel("v").reference_point
    edges = [0, *(np.flatnonzero(np.diff(np.sign(rate)) != 0) + 1).tolist(), len(psi)]
    turns = []
    for first, last in pairwise(edges):
        if last - first < 2 or abs(psi[last - 1] - psi[first]) < LEAST_TURN:
            continue
        later = slice(first + int(np.searchsorted(_turned(psi[first:last]), 0.5)), last)
        u, v, r = (np.nanmean(values[later]) for values in (ahead, aside, rate))
        if u > _SLOW * np.nanmax(ahead) and r != 0.0:
            turns.append(_Turn(bool(r > 0.0), float(np.sign(r) * np.arctan2(v, u)), float(v / r)))
    return turns


def _turned(psi: Array) -> Array:
    """Share of a turn's change of heading that is done, (n,), never decreasing."""
    return np.maximum.accumulate(np.abs(psi - psi[0]) / abs(psi[-1] - psi[0]))


def _body_velocities(motion: RecordedMotion) -> tuple[Array, Array]:
    """Velocities ahead and to starboard [m/s], (n,) each."""
    u, v, psi = (motion.record[s] for s in ("u", "v", "psi"))
    if motion.frame == "body":
        return u, v
    return u * np.cos(psi) + v * np.sin(psi), v * np.cos(psi) - u * np.sin(psi)
