"""Columns that are known and that no draft takes, with the reason: others say the same, or they show no motion."""

import re
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from seatrial.core.text.words import enumeration
from seatrial.data.draft.languages import in_english, plain_name

_UNIT = re.compile(r"\[.*?\]|\(.*?\)")  # in brackets behind a heading
_NAMES_SHOWN = 4  # columns of one reason that a line names; ours
_PLACES = frozenset({"lat", "x0"})
_ANGLES = frozenset({"delta", "alpha_1"})
_HEADINGS = frozenset({"psi"})
_ROLL = frozenset({"phi"})
_ORDERED = "order(ed)?|command(ed)?|cmd|demand(ed)?|set_?point|target|desired"


@dataclass(frozen=True)
class _Rule:
    """A pattern of names in small letters, and why they are not needed.

    beside: channels of which one is used where that holds; empty: it holds always.
    """

    pattern: str
    reason: str
    beside: frozenset[str] = frozenset()


# messages of MAVLink, common.xml, as topic/field
_MESSAGES = (
    _Rule(r"global_position_int/v[xy]|vfr_hud/groundspeed", "the positions show the speed over ground", _PLACES),
    _Rule(
        r"global_position_int/hdg|vfr_hud/heading|gps\d?_raw(_int)?/yaw", "another column has the heading", _HEADINGS
    ),
    _Rule(r"gps\d?_raw(_int)?/(lat|lon|vel|cog)", "of the receiver alone; the estimated position is used", _PLACES),
    _Rule(r"vfr_hud/throttle", "the mean of the outputs, each of which is known", frozenset({"command_1"})),
    _Rule(r"servo_output_raw/servo\d+_raw", "an output that does not change, or is disabled"),
    _Rule(r"attitude/pitchspeed", "no model in the plane takes it"),
    _Rule(r"\w+/((relative_)?alt|alt_ellipsoid|vz|climb|airspeed)", "height and air: no model in the plane takes them"),
    _Rule(r"\w+/time_(boot_ms|usec)", "the log has stamps of its own"),
    _Rule(
        r"(sys_status|power_status|heartbeat|meminfo|system_time|timesync)/\w+|servo_output_raw/port|"
        r"gps\d?_raw(_int)?/(fix_type|eph|epv|satellites_visible|(h|v|vel|hdg)_acc)",
        "the state of autopilot and receiver",
    ),
)
# what people call columns of a table
_WORDS = (
    _Rule(rf"(rudder|helm|steering|nozzle)_(angle_)?({_ORDERED})", "an order; the angle that follows is used", _ANGLES),
    _Rule(rf"({_ORDERED})_(rudder|helm|steering|nozzle)(_angle)?", "an order; the angle that follows is used", _ANGLES),
    _Rule(
        r"(gps_|gnss_)?(speed|velocity)(_(kmh|kn|knots|kts|mps|m_s))?",
        "the positions show the speed over ground",
        _PLACES,
    ),
    _Rule(r"[hvp]dop|n?_?(um_)?sats?(ellites)?(_used)?|fix(_(type|quality))?|rssi", "the state of the receiver"),
    _Rule(r"g_?f[xyz]|(lin(ear)?_)?acc(el)?(eration)?_?[xyz]", "no model takes accelerations"),
    _Rule(r"(imu_)?(gyro?_?x|roll_?(rate|speed)|w_?x)(_rate)?", "the roll angle shows it", _ROLL),
    _Rule(r"(imu_)?(gyro?_?y|pitch_?(rate|speed)|w_?y)(_rate)?", "no model in the plane takes it"),
    _Rule(r"((prop(eller)?|shaft|(main_)?engine)_)?(power|torque)(_kw|_knm)?", "no model takes power or torque"),
)


def columns_not_needed(names: Sequence[str], used: Set[str]) -> dict[str, str]:
    """Return those of the columns that are known and not needed, with the reason; the others are left to be named.

    Args:
        names: of columns that stand for no channel, as the trial file addresses them.
        used: channels of the same log that are used.
    """
    reasons = {name: _reason(name, used) for name in names}
    return {name: reason for name, reason in reasons.items() if reason}


def not_needed_text(reasons: Mapping[str, str], most: int | None = None) -> str:
    """Return the columns with why they are not needed, those of one reason together, those of motions first.

    most: reasons that are given; None: all.
    """
    given = [word.reason for word in (*_WORDS, *_MESSAGES) if word.reason in reasons.values()]
    by_reason = {why: [name for name in reasons if reasons[name] == why] for why in given}
    parts = [f"{enumeration(names, _NAMES_SHOWN)} ({why})" for why, names in by_reason.items()][:most]
    rest = sum(len(names) for names in list(by_reason.values())[len(parts) :])
    return "; ".join([*parts, f"{rest} more, in the file"] if rest else parts)


def _reason(name: str, used: Set[str]) -> str:
    field = plain_name(_UNIT.sub("", name).rpartition("/")[2])
    matched = [message for message in _MESSAGES if re.fullmatch(message.pattern, name.lower())]
    matched += [word for word in _WORDS if re.fullmatch(word.pattern, in_english(field))]
    return next((one.reason for one in matched if not one.beside or one.beside & used), "")
