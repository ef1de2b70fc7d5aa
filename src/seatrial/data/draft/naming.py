"""What a column may be, by its name: the messages of known loggers first, then the names that people use."""

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from functools import cache

from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, si_unit, spelling_hint
from seatrial.core.values.notation import UNIT_WORDS
from seatrial.data.read.layout import log_quantity
from seatrial.data.readings import name_table

# Names as the table of names has them: in small letters without accents, in English, by their patterns.

# letters that do not come apart into a letter and its accent
_LETTERS = str.maketrans({"ø": "o", "æ": "ae", "ß": "ss", "œ": "oe", "ł": "l", "đ": "d"})
# between the words of a name that sets them apart by capitals: RudderAngle, ShaftRPM
_CAPITALS = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def without_accents(text: str) -> str:
    """Return a text in small letters, without accents."""
    apart = unicodedata.normalize("NFKD", text.lower().translate(_LETTERS))
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def plain_name(name: str) -> str:
    """Return a heading in small letters and figures without accents, with a line between words."""
    return re.sub(r"[^a-z0-9]+", "_", without_accents(name)).strip("_")


@cache
def _english() -> Mapping[str, str]:
    languages = name_table()["languages"].values()
    return {word: english for language in languages for english, words in language.items() for word in words.split()}


def in_english(plain: str) -> str:
    """Return a plain name with the headings of other languages in it, the longest first, by their English ones.

    plain: small letters without accents, words joined by underscores.
    """
    words, english = plain.split("_"), list[str]()
    while words:
        count = next((k for k in range(len(words), 0, -1) if "_".join(words[:k]) in _english()), 0)
        english.append(_english()["_".join(words[:count])] if count else words[0])
        words = words[count or 1 :]
    return "_".join(english)


@cache
def _pattern(text: str) -> re.Pattern[str]:
    """A pattern of the table with its parts filled in."""
    return re.compile(re.sub(r"(?<!P)<(\w+)>", lambda part: name_table()["parts"][part[1]], text))


@dataclass(frozen=True)
class NameRule:
    """A pattern of a name, or of ``topic/field`` of a logger, and what it names; an empty unit is found by behaviour.

    unused_because: why a column of this name is not taken by itself. note: what else is to be known of one.
    other_reading: what it may be as well. first: added to the number in the name. side: of the craft on which it is.
    is_sided: whether the name may say the side besides. reason, beside: why it is not needed, and channels of which
    one is then used.
    """

    pattern: str
    symbol: str = ""
    unit: str = ""
    frame: str = ""
    positive: str = ""
    scale: float = 1.0
    unused_because: str = ""
    note: str = ""
    logger: str = ""
    other_reading: str = ""
    first: int = 0
    side: str = ""
    is_sided: bool = False
    reason: str = ""
    beside: Sequence[str] = field(default_factory=tuple)

    def match(self, text: str) -> re.Match[str] | None:
        """Return the match of all of a name."""
        return _pattern(self.pattern).fullmatch(text)


@cache
def _messages() -> list[NameRule]:
    return [NameRule(**row, logger=logger) for logger, rows in name_table()["messages"].items() for row in rows]


@cache
def _words() -> list[NameRule]:
    return [NameRule(**row) for row in name_table()["names"]["words"]]


@cache
def _commands() -> list[NameRule]:
    return [rule for rule in _words() if rule.symbol.startswith(_COMMAND)]


# What a column may be, by its name.

APPARENT_WIND = "the apparent wind, if so called wind_speed_relative, wind_direction_relative"
"""The other reading of a wind whose heading says neither true nor apparent."""
_COMMAND = "command_"
_SIDES = ("port", "starboard")
# words of topics that hold orders or limits, not measurements
_ORDERS = re.compile(r"set_?point|target|desired|reference|goal|limits?\b|cmd|command|(^|/)[re]_")
# loggers whose messages are all known: other messages say nothing
_KNOWN_LOGGERS = ("ulog", "ardupilot-bin", "ardupilot-tlog", "nmea0183", "nmea2000")
# column of a table into which an autopilot's log was exported: ``ATT.Yaw``, ``XKF1[0].VN``
_EXPORTED = re.compile(r"/?([A-Za-z]\w*(?:\[\d+\])?)[./](\w+(?:\[\d+\])?)")
_ONLY_FIELD, _TOPIC_PARTS = "data", 3  # of ROS's std_msgs; names of folders before that of a topic that are read
# of motions: a heading of another of these than a channel has means another quantity
_MOTION_UNITS = frozenset({"m", "m/s", "m/s^2", "rad", "rad/s"})
# degrees behind a heading, from true or magnetic north, or a rate; the serial number of the instrument before them
_DEGREES, _SERIAL = re.compile(r"\s*°([MT]?)(/s|/min)?(?:ec)?$"), re.compile(r"\s\d{6}#?\s*$")
_BRACKETS = re.compile(r"[\[(]([^\])]*)[\])]")


@dataclass(frozen=True)
class NameGuess:
    """What the name of a column says.

    Attributes:
        rule: what it names.
        symbol: with the number of a thruster filled in.
        unit: stated by the file, by the name, or by the logger's documentation; empty: not known.
        evidence: for people.
        side: of the craft, port or starboard, that it names; empty: none.
    """

    rule: NameRule
    symbol: str
    unit: str
    evidence: str
    side: str = ""


def guess_by_name(topic: str, name: str, stated_unit: str, log_format: str = "text") -> NameGuess | None:
    """Return what a column is by its name, None where the name says nothing.

    Messages of autopilots and buses are known one by one; of other topics of orders those of thrusters count.
    stated_unit: the unit that the file states; it overrides what the name says.
    """
    exported = _EXPORTED.fullmatch(name) if log_format == "text" else None
    message, column = exported.groups() if exported else (topic, name)
    for rule in _messages() if message else ():
        if match := rule.match(f"{message}/{column}".lower()):
            last = message.rpartition("/")[2] if log_format == "text" else message  # not the folders of a user
            return _guess(rule, match, _known_unit(stated_unit) or rule.unit, f"{rule.logger} {last}".strip())
    if column == _ONLY_FIELD and (command := command_of_topic(topic, _known_unit(stated_unit))):
        return command
    last = topic if log_format != "text" else topic.rpartition("/")[2]  # folders are called as anybody likes
    if log_format in _KNOWN_LOGGERS:
        return None
    rules = _commands() if _ORDERS.search(last.lower()) else _words()
    degrees = _DEGREES.search(name)
    unit = _known_unit(stated_unit) or bracketed_unit(name) or (f"deg{degrees[2] or ''}" if degrees else "")
    bare = _SERIAL.sub("", _BRACKETS.sub("", name[: degrees.start()] if degrees else name))
    for text, word_unit in (*_readings(plain_name(bare)), *_readings(plain_name(_CAPITALS.sub("_", bare)))):
        guess = _guess_by_text(in_english(text), rules, unit or word_unit, is_unit_needed=bool(word_unit))
        if guess is not None:
            return _from_magnetic_north(guess) if degrees and degrees[1] == "M" else guess
    return None


def _guess_by_text(text: str, rules: Sequence[NameRule], unit: str, *, is_unit_needed: bool) -> NameGuess | None:
    """The first rule that holds of a name in English, the side of the craft left out where a quantity may have one."""
    side, bare = _side_apart(text)
    for rule in rules:
        match = rule.match(text) or (rule.match(bare) if side and rule.is_sided else None)
        guess = _guess(rule, match, unit, "its name", side) if match else None
        if guess is not None and (guess.unit or not is_unit_needed):  # not heave for a ``z`` in rad/s
            return guess
    return None


def _side_apart(text: str) -> tuple[str, str]:
    """The side that the first or the last word of a name says, and the other words; empty where neither does."""
    for side in _SIDES:
        words = _pattern(
            f"((<{side}>|<{side}_letter>)_)?(?P<quantity>.{{2,}}?)(_(<{side}>|<{side}_letter>))?"
        ).fullmatch(text)
        if words and words["quantity"] != text:
            return side, words["quantity"]
    return "", text


def _from_magnetic_north(guess: NameGuess) -> NameGuess | None:
    """The heading from magnetic north; a course from there is none that is read."""
    return replace(guess, symbol="psi_magnetic") if guess.symbol == "psi" else None


def command_of_topic(topic: str, unit: str = "") -> NameGuess | None:
    """Return what the only field of a message is whose topic is called after a thruster, as ``thrusters/left/cmd``."""
    parts = [plain_name(_CAPITALS.sub("_", part)) for part in topic.split("/")]
    for count in range(1, _TOPIC_PARTS + 1):
        name = "_".join(parts[-count:])
        for rule in _commands():
            if match := rule.match(name):
                return _guess(rule, match, unit, f"its topic {parts[-1]}")
    return None


def bracketed_unit(name: str) -> str:
    """Return the unit that stands in brackets in a heading; empty where none does."""
    return next((known for text in _BRACKETS.findall(name) if (known := _known_unit(text))), "")


def unit_in_heading(name: str) -> str:
    """Return the unit that a heading states in brackets or as a quotient, heave/mm (ISO 80000-1, 7.1.4)."""
    parts = name.split("/")
    quotients = (_known_unit("/".join(parts[k:])) for k in range(1, len(parts)))
    return bracketed_unit(name) or next(filter(None, quotients), "")


def _readings(plain: str) -> list[tuple[str, str]]:
    """A name with the unit behind it: as it is, then without what only says from where it comes."""
    heads = [plain]
    while instrument := _pattern("<instrument>").match(heads[-1]):
        heads.append(heads[-1][instrument.end() :])
    qualifiers = _pattern("<qualifier>")
    bare = list(dict.fromkeys(name for head in heads for name in (head, qualifiers.sub("", head)) if name))
    whole = [reading for name in bare for reading in _with_unit_word(name)]
    cut = ((qualifiers.sub("", name), unit) for name, unit in whole if unit)
    return [*whole, *(reading for reading in cut if reading not in whole and reading[0])]


def _with_unit_word(plain: str) -> list[tuple[str, str]]:
    """The name as it is, and without its last word or two where they are a unit (``yaw_rate_deg_s``: deg/s)."""
    words = plain.split("_")
    ends = ((words[:-count], "/".join(words[-count:])) for count in (2, 1) if len(words) > count)
    return [(plain, ""), *(("_".join(head), UNIT_WORDS[end]) for head, end in ends if end in UNIT_WORDS)]


def _guess(rule: NameRule, match: re.Match[str], unit: str, evidence: str, side: str = "") -> NameGuess | None:
    symbol = rule.symbol
    if "{}" in symbol:
        symbol = symbol.format(max(int(match["number"]) + rule.first, 1))
    try:
        expected = log_quantity(symbol).unit
    except InputError:
        return None
    is_share = symbol == "delta" and unit == "percent"
    if unit and unit != "us" and not is_share and si_unit(unit)[1] != expected:
        if not rule.logger and {si_unit(unit)[1], expected} <= _MOTION_UNITS:
            return None  # ``Gyro X (deg/s)`` is no position, although it ends in x
        unit = ""
    side = rule.side or side
    if symbol.startswith(_COMMAND):
        side = named_side(match.string) or next((word for word in _SIDES if _has_letter(match.string, word)), "")
    return NameGuess(
        rule, symbol, unit, evidence, side if rule.side or rule.is_sided or symbol.startswith(_COMMAND) else ""
    )


def _has_letter(plain: str, side: str) -> bool:
    """Whether one of the words of a name is a letter that stands for a side."""
    return _pattern(f"(^|_)<{side}_letter>(_|$)").search(plain) is not None


def named_side(name: str) -> str:
    """Return the side of the craft that a heading names, port or starboard; empty where it names none."""
    plain = plain_name(_CAPITALS.sub("_", _BRACKETS.sub("", name)))
    return next((side for side in _SIDES if _pattern(f"(^|_|<thruster>)<{side}>(_|$)").search(plain)), "")


def _known_unit(text: str) -> str:
    word = text.strip().lower()
    if word in UNIT_WORDS:
        return UNIT_WORDS[word]
    try:
        si_unit(text.strip())
    except InputError:
        return ""
    return text.strip()


# Columns whose meaning is stated: the name of each, as the log has it, and what it is.

StatedColumns = Mapping[str, str]
"""Heading of a column -> ``time``, or a channel or name that a draft knows, such as ``psi`` or ``heading``."""
TIME = "time"
CHANNELS = "lat, lon, sog, cog, psi, r, u, v, delta, n, phi, theta, z, zeta, command_1"
"""Channels that logs hold most often."""
NOTHING_STATED: StatedColumns = {}


def stated_columns(texts: Iterable[str]) -> dict[str, str]:
    """Return what texts such as ``Klokke=time`` state, the heading before the last equals sign.

    Raises:
        InputError: a text without an equals sign, a heading stated twice, or a meaning that a draft does not know.
    """
    stated = dict[str, str]()
    for text in texts:
        heading, equals, meaning = (part.strip() for part in text.rpartition("="))
        if not equals or not heading or not meaning:
            raise InputError(f"--column '{text}': write HEADING=CHANNEL, as in --column 'Klokke=time'")
        if heading in stated:
            raise InputError(f"--column '{text}': the column '{heading}' is stated twice; state it once")
        if meaning != TIME and guess_by_name("", meaning, "") is None:
            raise InputError(
                f"--column '{text}': '{meaning}' is no channel that a log can hold; known are {TIME}, {CHANNELS}"
            )
        stated[heading] = meaning
    return stated


def refuse_absent(stated: StatedColumns, headings: Iterable[str]) -> None:
    """Refuse a stated column that no log has.

    Raises:
        InputError: there is one; the heading most like it is named.
    """
    known = list(dict.fromkeys(headings))
    for heading in stated:
        if heading not in known:
            raise InputError(f"--column '{heading}=...': no log has this column{spelling_hint(heading, known)}")


# Columns that are known and that no draft takes, with the reason: others say the same, or they show no motion.

_NAMES_SHOWN = 4  # columns of one reason that a line names; ours


@cache
def _unneeded(kind: str) -> list[NameRule]:
    return [NameRule(**row) for row in name_table()["unneeded"][kind]]


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
    rules = (*_unneeded("words"), *_unneeded("messages"))
    given = [rule.reason for rule in rules if rule.reason in reasons.values()]
    by_reason = {why: [name for name in reasons if reasons[name] == why] for why in given}
    parts = [f"{enumeration(names, _NAMES_SHOWN)} ({why})" for why, names in by_reason.items()][:most]
    rest = sum(len(names) for names in list(by_reason.values())[len(parts) :])
    return "; ".join([*parts, f"{rest} more, in the file"] if rest else parts)


def _reason(name: str, used: Set[str]) -> str:
    last = in_english(plain_name(_BRACKETS.sub("", name).rpartition("/")[2]))
    matched = [rule for rule in _unneeded("messages") if rule.match(name.lower())]
    matched += [rule for rule in _unneeded("words") if rule.match(last)]
    return next((rule.reason for rule in matched if not rule.beside or used & set(rule.beside)), "")
