"""The text of a drafted trial file: every line with its evidence, what is unsure as a comment."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

import numpy as np

from seatrial.core.text.words import counted
from seatrial.data.check.water_speed import SpeedAndCurrent
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.held_out import NOTHING_HELD_OUT, HeldOutRuns
from seatrial.data.draft.naming import columns_not_needed, not_needed_text
from seatrial.data.draft.ship_estimates import (
    BREADTH_ERROR,
    EstimatedValue,
    StatedSize,
    added_masses,
    is_in_basin,
    main_dimensions,
    mass_properties,
    speed_in_header,
    stated_values,
)
from seatrial.data.draft.starting_model import StartingModel
from seatrial.data.draft.stored_parameters import antenna_place
from seatrial.data.draft.stretches import LogStretch, name_contradiction, used_parts
from seatrial.data.draft.survey import LogSurvey, TopicSummary
from seatrial.data.read import ColumnSpec
from seatrial.data.read.layout import TimeSpec
from seatrial.data.trial.plausibility import ESTIMATED
from seatrial.physics.hydro.excitation import G

# Values as a TOML file holds them.


def quoted(value: str | int) -> str:
    """Return a value as TOML writes it; the escapes of JSON are those of TOML."""
    return str(value) if isinstance(value, int) else json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


# What a drafted trial needs of a craft in waves: its hull's stiffness, waves met, how elevation becomes force.

# Parsons 2003, Parametric design, in Lamb (ed.), Ship Design and Construction, vol. 1, SNAME, ch. 11
_SOURCE = "Parsons 2003"
# standard deviations over the value, of heave and of pitch: of a waterplane whose coefficient is right within 0.05
# (D'Arcangelo 1969, in Parsons 2003)
_STIFFNESS_ERRORS = (0.1, 0.2)
ASSUMED = "ASSUMED"
"""Mark of a line of a draft that holds what is usual, not what a log shows."""


def ship_in_waves(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return breadth, draught, mass, pitch inertia and stiffness [SI] of a ship of this size."""
    form, mass = size.form, {mass_property.key: mass_property for mass_property in mass_properties(size)}
    fullness = (
        1.0 + 2.0 * form.C_b
    ) / 3.0  # waterplane coefficient; Schneekluth & Bertram 1998, eq. (1.58), V sections
    pitch = 0.350 * fullness**2 - 0.405 * fullness + 0.146  # I_L / (B L^3); D'Arcangelo 1969, in Parsons 2003
    weight = size.density * G
    water = f"in water of {size.density:g} kg/m^3" if size.rho else "in sea water"
    text = f"{water}, of a waterplane with C_WP {fullness:.2f} ({_SOURCE})"
    pitch_stiffness = weight * pitch * form.B * form.L**3
    heave_error, pitch_error = (math.hypot(error, 0.0 if size.beam else BREADTH_ERROR) for error in _STIFFNESS_ERRORS)
    return (
        *main_dimensions(size),
        mass["m"],
        replace(mass["I_z"], key="I5", text="kg m^2, in pitch, gyradius L/4"),
        EstimatedValue("c33", weight * fullness * form.L * form.B, f"N/m, heave by heave, {text}", error=heave_error),
        EstimatedValue("c35", 0.0, "N/rad, heave by pitch; 0 of a waterplane alike fore and aft"),
        EstimatedValue("c53", 0.0, "N m/m, pitch by heave; equal to c35"),
        EstimatedValue("c55", pitch_stiffness, f"N m/rad, pitch by pitch, {text}", error=pitch_error),
    )


def wave_lines(speed: float | None) -> list[str]:
    """Return what the waves did to the runs, as it is in a towing tank; a ship's log states heading and speed.

    speed: m/s, as the headers of all runs state it; None: they do not.
    """
    known = f"speed = {speed:g}    # m/s, as the header says" if speed is not None else ""
    return [
        "",
        "[records.waves]",
        f'heading = {{ value = 180, unit = "deg" }}    # {ASSUMED}: head seas; 0 is following, 90 beam',
        known or f"speed = 0.0    # {ASSUMED}: m/s of the craft, or of the carriage that tows it",
    ]


def excitation_lines() -> list[str]:
    """Return how the elevation becomes a force."""
    return [
        "[excitation]",
        'source = "box"    # wave forces on a box of L, B and d; "table" or "capytaine": of the hull',
        "",
    ]


# The tables of a drafted trial file that stand before its records: ship, model, thrusters, sensors, offsets.

# from the centre line to a thruster of a pair, of the breadth: (1 - 0.24) / 2, in the middle of each hull of a
# catamaran that takes 0.24 of it; of the length where the breadth is not stated; both chosen
_LEVER_OF_BEAM, _LEVER_OF_LENGTH = 0.38, 0.15
# formulas for what the records leave open, as 'seatrial models mmg' lists them
_FORMULAS = ("yoshimura", "zhou", "interaction", "propulsion", "displacement")
_CURRENT = 0.3  # m/s, standard deviation of an unknown current; as the advice of the checks
_LEAST_SPEED_ERROR = 0.005  # of a speed, for what its model of turns leaves out; chosen
OPEN_SPEED = "# OPEN U_n"
"""Begins the line that asks for the speed through the water."""
_NO_RATES: Mapping[str, float] = MappingProxyType({})
_UNNAMED = "craft"  # a craft whose name is not stated; ours
_NO_CURRENT = (
    f"# current = {_CURRENT:g}    # m/s: taken for a model in a basin, where none runs; uncomment it for open water"
)


def tables_text(
    model: StartingModel, guesses: Sequence[ColumnGuess], size: StatedSize, rate: float | None = None,
    heels: tuple[float, float] | None = None, largest: Mapping[str, float] = _NO_RATES,
) -> list[str]:  # fmt: skip
    """Return the lines of ship and model, and of what else the model needs; of a model without a name what is missing.

    guesses: of all sources of the longest run; rate: at which residuals are taken [Hz]; None: that of the records.
    heels: least and largest about which roll decays swing [rad]; None: one serves all.
    largest: reading of the channels of thrusters' rates, in the unit of their columns.
    """
    ship = ["[ship]", f"name = {quoted(size.name or _UNNAMED)}", *_ship_lines(model, size), ""]
    if not model.name:
        return [
            *(ship if size.length else []),
            "# 'seatrial check' needs neither ship nor model, 'seatrial identify' both: 'seatrial models' lists them.",
            "# OPEN: no input (rudder, propeller, thruster) was found, and a model needs one: name its column below.",
            "",
        ]
    names = ", ".join(f'"{name}"' for name in model.free)
    return [
        *ship,
        "[model]",
        f'name = "{model.name}"    # {model.why}',
        *(_prior_lines(model) if model.has_propeller else []),
        *(['priors_from = ["higher_order"]'] if model.has_derivatives else []),
        *([f"free = [{names}]    # {model.free_reason}"] if model.free else []),
        *_speed_prior_lines(model),
        *(
            ["", "[model.fixed]", *(added_mass.line for added_mass in added_masses(size))]
            if model.has_derivatives
            else []
        ),
        *(thruster_tables(guesses, size, largest) if model.has_thrusters else []),
        "",
        *(excitation_lines() if model.has_waves else []),
        *_sensor_lines(model, guesses),
        *_offset_lines(model, guesses, size, rate),
        *(_heel_lines(*heels) if heels else []),
    ]


def _heel_lines(least: float, largest: float) -> list[str]:
    """That each decay has a heel of its own: held in common, the difference would widen every interval."""
    seen = f"they roll about {math.degrees(least):.1f} to {math.degrees(largest):.1f} deg"
    return ["[estimate]", f'offsets = ["phi"]    # the heel of each decay: {seen}', ""]


def _prior_lines(model: StartingModel) -> list[str]:
    sources = ", ".join(
        f'"{formula}"'
        for formula in (
            *_FORMULAS,
            *(["twin_screws"] if model.has_two_screws else []),
            *(["shallow"] if model.is_in_shallow_water else []),
            *(["wind"] if model.has_wind else []),
        )
    )
    return [f"priors_from = [{sources}]", "prior_sd_percent = 50    # of coefficients whose scatter is not known"]


def _ship_lines(model: StartingModel, size: StatedSize) -> list[str]:
    stated = f"L = {size.length:g}    # m, length of the craft, as stated"
    missing = "L = 0.0    # MISSING: m, length of the craft, the one number that this file lacks"
    lines = [stated if size.length else missing]
    lines += [f"scale = {size.scale:g}    # a model 1:{size.scale:g}, as stated"] if size.scale else []
    lines += [particular.line for particular in model.particulars]
    if model.has_derivatives:
        lines += [mass_property.line for mass_property in mass_properties(size)]
        lines += _speed_lines(model)
    if model.heaves and size.length:
        lines += [wave.line for wave in ship_in_waves(size)]
    if model.has_thrusters and size.mass:
        lines.append(
            f"m = {size.mass:g}    # kg, as stated: forces come out on each kg of m + m_x until a thruster has bollard"
        )
    if model.rolls:
        lines += _roll_lines(size)
    written = {line.partition(" =")[0] for line in lines}
    return [*lines, *(stated_value.line for stated_value in stated_values(size) if stated_value.key not in written)]


def _speed_lines(model: StartingModel) -> list[str]:
    """The speed through the water at which the runs begin; OPEN where only that over ground is known."""
    water = model.water
    if water is not None and model.is_speed_open:
        return [
            f"{OPEN_SPEED}: m/s through the water, which was not recorded; the courses do not separate it from "
            f"a current. The runs show {model.speed:.2f} over ground: right in still water, else write the log's speed",
            f"# U_n = {model.speed:.2f}",
        ]
    if water is not None:
        none = f"no current above {water.least_current:.2g} m/s shows in"
        left = f"what {_current_text(water)} leaves of" if model.is_in_current else none
        return [
            f"U_n = {water.speed:.2f}    # m/s through the water: {left} the speeds over ground on several courses; "
            "estimated, within what they show"
        ]
    return [f"U_n = {model.speed:.2f}    # m/s, speed at which the runs begin, as recorded"]


def _current_text(water: SpeedAndCurrent) -> str:
    towards = np.degrees(np.arctan2(water.east, water.north)) % 360.0
    return f"a current of {water.current:.2f} m/s towards {towards:.0f} deg"


def _speed_prior_lines(model: StartingModel) -> list[str]:
    """What the runs show of the speed that is estimated with the current."""
    if model.water is None or "U_n" not in model.free:
        return []
    spread = max(model.water.speed_error, _LEAST_SPEED_ERROR * model.water.speed)
    return [
        "",
        "[model.priors.U_n]",
        f"mean = {model.water.speed:.3f}",
        f"sd = {spread:.2g}    # m/s, standard error of the speed that the fixes of all runs show",
    ]


def _roll_lines(size: StatedSize) -> list[str]:
    """The breadth and the metacentric height, each to be stated where the other one is to follow from the period."""
    if size.gm:
        return [f"GM = {size.gm:g}    # m, metacentric height, as stated: the period gives the radius of gyration"]
    breadth = f"B = {size.beam:g}    # m, breadth, as stated" if size.beam else "# B = 0.0    # m, breadth"
    return [
        f"{breadth}: with it GM follows from the period, within some 40 %",
        "# GM = 0.0    # m, metacentric height, if known: the period then gives the radius of gyration (init --gm)",
    ]


def thruster_tables(
    guesses: Sequence[ColumnGuess], size: StatedSize, largest: Mapping[str, float] = _NO_RATES
) -> list[str]:  # fmt: skip
    """Return one table for each command, on the side that the motion or its name shows; largest: readings of rates."""
    used = {g.symbol: g for g in guesses if g.is_used}
    commands = [g for symbol, g in sorted(used.items()) if symbol.startswith(("command_", "rpm_"))]
    sides = [g.side for g in commands]
    names = [g.side if g.side and sides.count(g.side) == 1 else f"thruster_{k}" for k, g in enumerate(commands, 1)]
    is_pair = sorted(names) == ["port", "starboard"]
    lines = list[str]()
    for name, guess in zip(names, commands, strict=True):
        sign = {"port": -1.0, "starboard": 1.0}.get(name, 0.0)
        angle = f"alpha_{guess.symbol.rpartition('_')[2]}"
        unit = _rate_text(largest[guess.symbol]) if guess.symbol in largest else " }"
        lines += [
            "", "[[thruster]]", f'name = "{name}"',
            _place_line(size.length, is_turned=angle in used),
            _lever_line(sign, size),
            *([f'angle = {{ channel = "{angle}" }}'] if angle in used else []),
            f'command = {{ channel = "{guess.symbol}"{unit}',
            *(['same_as = "starboard"    # the same coefficients'] if is_pair and name == "port" else []),
        ]  # fmt: skip
    return lines


def _rate_text(largest: float) -> str:
    """The end of a command that is a rate: what coefficients call full is the largest of the runs."""
    return f', unit = "rpm", span = {largest:.4g} }}    # rpm called full ahead: the most in the runs'


def _place_line(length: float, *, is_turned: bool) -> str:
    """Where a thruster lies along the craft: of one that is turned at the transom, from which its moment follows."""
    if not is_turned:
        return "x = 0.0    # m forward of midship; counts where thrust can act sideways"
    return f"x = {-0.5 * length:.2f}    # {ESTIMATED}: m forward of midship, of an outboard at the transom; measure it"


def _lever_line(sign: float, size: StatedSize) -> str:
    """Where a thruster lies across: of a pair an estimate, which no prediction depends on."""
    share, origin = (_LEVER_OF_BEAM * size.beam, "B") if size.beam else (_LEVER_OF_LENGTH * size.length, "L")
    lever = sign * share
    if not lever:
        return "y = 0.0    # m to starboard, negative to port: measure it where it is not on the centre line"
    return f"y = {lever:.2f}    # {ESTIMATED}: m to starboard, from {origin}; measure it: yaw coefficients go with it"


def _sensor_lines(model: StartingModel, guesses: Sequence[ColumnGuess]) -> list[str]:
    """That velocities are a receiver's, turned by the compass: a current and its zero would end in coefficients."""
    if model.has_thrusters and any(g.is_used and g.symbol == "u" and g.follows_track for g in guesses):
        return ["[sensors]", 'velocity = "ground"    # as the positions change, over ground: a current is in them', ""]
    if not _is_over_ground(guesses) or not (model.has_thrusters or model.has_forces_of_a_ship):
        return []
    zero = 'compass = "offset"    # what turned them ahead and aside: several courses separate its zero from a current'
    shows_zero = model.water is not None and model.water.shows_current
    receiver = 'velocity = "ground"    # of a receiver, over ground: a current is in them'
    return ["[sensors]", receiver, *([zero] if shows_zero else []), ""]


def _offset_lines(
    model: StartingModel, guesses: Sequence[ColumnGuess], size: StatedSize, rate: float | None
) -> list[str]:
    """What differs from day to day: a current, where positions or velocities show it, and the zero of the rudder."""
    if not (model.has_forces_of_a_ship or model.has_thrusters):
        return []
    shows_current = _is_over_ground(guesses) or any(g.is_used and g.symbol in ("lat", "x0") for g in guesses)
    is_still = model.has_forces_of_a_ship and is_in_basin(guesses, size)
    current = _NO_CURRENT if is_still else _current_line(model)
    zero = 'offsets = ["delta"]    # the zero of the rudder\'s indicator'
    lines = [f"rate = {rate:.4g}    # Hz, of residuals: the log has more samples than the ship moves"] if rate else []
    lines += [*([current] if shows_current else []), *([zero] if model.has_forces_of_a_ship else [])]
    return ["[estimate]", *lines, ""] if lines else []


def _current_line(model: StartingModel) -> str:
    """The size of a current: as the runs show it, else as usual."""
    if model.water is None or not model.is_in_current:
        return f"current = {_CURRENT:g}    # m/s, of which nothing is known but that it is of this size"
    size = max(_CURRENT, math.ceil(10.0 * model.water.current) / 10.0)
    return f"current = {size:g}    # m/s, of its size: the runs show {_current_text(model.water)}"


def _is_over_ground(guesses: Sequence[ColumnGuess]) -> bool:
    return any(g.is_used and (g.symbol == "sog" or (g.symbol == "u" and g.frame in ("earth", "enu"))) for g in guesses)


# The text of a drafted trial file: every line with its evidence, what is unsure as a comment.

NO_ANTENNA = (
    "# antenna = { x = 0.0, y = 0.0 }    # m forward of midship, to starboard: state it; each metre that it is forward "
    "of this counts as 0.017 m/s of sway for each deg/s of yaw (init --antenna)"
)
"""The line that asks for the place of an antenna of which nothing is known."""
_OF_RECEIVER = frozenset({"lat", "sog"})  # channels that a GNSS antenna shows
_UNUSED_SHOWN = 12  # names of columns without a channel in the comment; chosen


@dataclass(frozen=True, eq=False)
class RecordsBlock:
    """One block of records of the file.

    Attributes:
        name: of the run; empty: the runs are called after their files.
        sources: each log with its guesses; of files of one kind the longest.
        files: those of one kind; empty for a run with a name.
        stretches: manoeuvres in the run, or in each of the files.
        parts: those of them that are offered as runs of their own.
        validate: the runs to keep out of the estimation; empty: none of this block.
        has_waves: whether the waves are an input.
        is_released: whether each run is a roll decay, to be used from its release on.
        antenna: m forward of midship, as stated; None: not stated.
    """

    name: str
    sources: tuple[tuple[LogSurvey, tuple[ColumnGuess, ...]], ...]
    files: tuple[LogSurvey, ...]
    stretches: tuple[tuple[LogStretch, ...], ...]
    parts: tuple[tuple[LogStretch, ...], ...]
    validate: HeldOutRuns = NOTHING_HELD_OUT
    session: str = ""
    has_waves: bool = False
    is_released: bool = False
    antenna: float | None = None


def trial_text(
    blocks: Sequence[RecordsBlock], tables: Sequence[str], left_out: Mapping[Path, str], folder: Path
) -> str:
    """Return the TOML file; only its first block gives the evidence.

    tables: the lines before the records. left_out: files that are no source of a run, with the reason. folder: where
    the file will lie; the paths in it count from there.
    """
    lines = [
        "# Drafted by seatrial init. Lines say why. OPEN: choose one. ESTIMATED: write a better number if you have it.",
        "",
        *tables,
        *(f"# left out: {_comment(_relative(path, folder))}: {_comment(why)}" for path, why in left_out.items()),
    ]
    for number, block in enumerate(blocks):
        written = _block_lines(block, folder)
        lines += written if number == 0 else ["", *map(_without_evidence, written)]
    return "\n".join(lines) + "\n"


def _block_lines(block: RecordsBlock, folder: Path) -> list[str]:
    lines = ["[[records]]"]
    if block.files:
        files = ", ".join(quoted(_relative(survey.path, folder)) for survey in block.files)
        lines += [f"files = [{files}]", *_role_lines(block), *_antenna_lines(block)]
        for survey, guesses in block.sources:
            lines += [*_layout_lines(survey), *_channel_lines(survey, guesses)]
        names = ["" if len(block.files) == 1 else survey.path.stem for survey in block.files]
        lines += _part_lines(dict(zip(names, block.stretches, strict=True)), block.parts)
        return [*lines, *(wave_lines(_common_speed(block.files)) if block.has_waves else [])]
    lines += [
        f"name = {quoted(block.name)}",
        *_role_lines(block),
        *_antenna_lines(block),
        *_part_lines({"": block.stretches[0]}, block.parts),
    ]
    nothing_used = not any(g.is_used for _, guesses in block.sources for g in guesses)
    for survey, guesses in block.sources:
        if not nothing_used and not any(g.is_used for g in guesses):
            name = _comment(survey.path.name)
            lines += [f"# {name}: {line.removeprefix('# ')}" for line in _unused_lines(survey, guesses)]
        else:
            lines += ["", "[[records.sources]]", f"file = {quoted(_relative(survey.path, folder))}"]
            lines += [*_layout_lines(survey), *_channel_lines(survey, guesses)]
    return lines


def _common_speed(files: Sequence[LogSurvey]) -> float | None:
    """The speed [m/s] that all headers state; None where one states none or another."""
    speeds = {speed_in_header(file) for file in files}
    return speeds.pop() if len(speeds) == 1 else None


def _without_evidence(line: str) -> str:
    """A line of a further block: its evidence stands in the first one."""
    return line if line.startswith("#") else line.partition("    # ")[0]


def _role_lines(block: RecordsBlock) -> list[str]:
    """Which runs judge the model, and from where on a decay counts."""
    names, why = block.validate.names, block.validate.why
    kept = f"{block.validate.share}, kept out of the estimation, to judge the model by"
    reason = f"{kept}{f': {why}' if why else ''}; choose others if you like"
    listed = ", ".join(map(quoted, names))
    lines = [f"validate = {listed if len(names) == 1 else f'[{listed}]'}    # {reason}"] if names else []
    lines += [block.session] if block.session else []
    return [*lines, "from_release = true    # drops what lies before the release"] if block.is_released else lines


def _antenna_lines(block: RecordsBlock) -> list[str]:
    """Where the antenna is, as stated or as a log has it, where fixes or velocities over ground are used."""
    used = {g.symbol for _, guesses in block.sources for g in guesses if g.is_used}
    is_of_receiver = bool(used & _OF_RECEIVER) or ("x0" in used and not used & {"u", "v"})
    if block.antenna is not None and is_of_receiver:
        return [f"antenna = {{ x = {block.antenna:g}, y = 0.0 }}    # m forward of midship, as stated; to starboard"]
    if block.antenna is not None and "x0" in used:
        return ["# the stated antenna is not used: a pose with velocities is of the point that its estimator says"]
    if not used & _OF_RECEIVER:
        return []
    places = [place for survey, _ in block.sources if (place := antenna_place(survey.log.parameters)) is not None]
    if not places:
        return [NO_ANTENNA]
    why = f"{places[0].evidence}; add the place of the autopilot where that is not midship"
    return [f"antenna = {{ x = {places[0].x:g}, y = {places[0].y:g} }}    # {why}"]


def _layout_lines(survey: LogSurvey) -> list[str]:
    lines = []
    layout = survey.layout
    if layout.header_lines > 1:
        lines.append(f"header_lines = {layout.header_lines}")
    if layout.encoding != "utf-8":
        lines.append(f"encoding = {quoted(layout.encoding)}")
    topic = next((one for one in survey.topics if one.time is not None), None)
    if topic is None or topic.time is None:
        why = "".join(f" ({_comment(one.time_note)})" for one in survey.topics[:1] if one.time_note)
        return [*lines, f"# OPEN: no column is recognised as the time{why}; add time = {{ column = ..., unit = ... }}"]
    offset = topic.time.clock_offset if isinstance(topic.time, TimeSpec) else 0.0
    if offset:
        lines.append(
            f"clock_offset = {offset:g}    # its clock runs {-offset:g} s ahead of the other sources: local time"
        )
    if topic.time.source:
        lines.append(f"time = {_time_table(topic.time)}    # {_comment(topic.time_note)}")
    return lines


def _time_table(time: ColumnSpec) -> str:
    parts = [f"column = {quoted(time.source)}"]
    if time.unit != "s":
        parts.append(f"unit = {quoted(time.unit)}")
    if isinstance(time, TimeSpec):
        others = {"nanoseconds": time.nanoseconds, "date": time.date, "week": time.week}
        parts += [f"{key} = {quoted(source)}" for key, source in others.items() if source]
    return f"{{ {', '.join(parts)} }}"


def _channel_lines(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    lines = []
    for guess in guesses:
        why = _comment("; ".join(guess.evidence))
        line = f"channels.{guess.symbol} = {_channel_table(guess)}"
        if not guess.is_used:
            continue
        if guess.is_open and guess.is_commented:
            lines.append(f"# {line}    # {why}; or {guess.other_reading}")
        elif guess.is_open:
            lines += [f"# OPEN {guess.symbol}: {why}; or {guess.other_reading}", f"# {line}"]
        else:
            lines.append(f"{'# ' if guess.is_commented else ''}{line}    # {why}")
    lines += [f"# left out: column {_comment(fault)}" for topic in survey.topics for fault in topic.faults]
    return [*lines, *_unused_lines(survey, guesses)]


def known_unneeded(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> dict[str, str]:
    """Return the columns that are known and stand for no channel, as none is needed, with the reason."""
    return columns_not_needed(_without_channel(survey, guesses), {g.symbol for g in guesses if g.is_used})


def unrecognised_columns(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    """Return the names of columns that stand for nothing that is known: by name nothing, or text."""
    known = known_unneeded(survey, guesses)
    return [name for name in _without_channel(survey, guesses) if name not in known]


def _without_channel(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    known = {str(guess.source) for guess in guesses if guess.is_used or guess.unused_because}
    return [
        name for topic in survey.topics for name in (*_column_names(topic), *topic.text_columns) if name not in known
    ]


def _column_names(topic: TopicSummary) -> list[str]:
    return [f"{topic.topic}/{column.name}" if topic.topic else column.name for column in topic.columns]


def _unused_lines(survey: LogSurvey, guesses: Sequence[ColumnGuess]) -> list[str]:
    """Columns that are not used: those that are recognised with the reason, the others by name."""
    named = {str(source) for guess in guesses if guess.is_used for source in (guess.source, guess.twin)}
    columns = [name for topic in survey.topics for name in _column_names(topic)]
    reasons = {str(g.source): f"{g.symbol}, {g.unused_because}" for g in guesses if g.unused_because}
    recognised = [f"{name} ({reasons[name]})" for name in columns if name in reasons and name not in named]
    rest = unrecognised_columns(survey, guesses)
    more = f", and {len(rest) - _UNUSED_SHOWN} more ('seatrial check {survey.path.name}' lists them)"
    shown = ", ".join(rest[:_UNUSED_SHOWN]) + (more if len(rest) > _UNUSED_SHOWN else "")
    lines = [f"# not used: {_comment(', '.join(recognised))}"] if recognised else []
    known = known_unneeded(survey, guesses)
    lines += [f"# known, not needed: {_comment(not_needed_text(known))}"] if known else []
    return [*lines, f"# not used, names not recognised: {_comment(shown)}"] if rest else lines


def _channel_table(guess: ColumnGuess) -> str:
    twin = [f"twin = {quoted(guess.twin)}"] if guess.twin else []
    parts = [f"column = {quoted(guess.source)}", *twin, f"unit = {quoted(guess.unit or '1')}"]
    words = (("frame", guess.frame), ("positive", guess.positive), ("kind", guess.kind))
    parts += [f"{key} = {quoted(value)}" for key, value in words if value]
    numbers = (
        ("reference_point", guess.reference_point, 0.0),
        ("zero", guess.zero, 0.0),
        ("span", guess.span, 1.0),
        ("scale", guess.scale, 1.0),
        ("offset", guess.offset, 0.0),
    )
    parts += [f"{key} = {value:g}" for key, value, default in numbers if value != default]
    return f"{{ {', '.join(parts)} }}"


def _part_lines(stretches: Mapping[str, Sequence[LogStretch]], parts: Sequence[Sequence[LogStretch]]) -> list[str]:
    """What each run is, and the manoeuvres that are runs of their own.

    stretches: of each run, by the name of its file, which is empty where there is no other.
    """
    offered = {name: part for name, part in zip(stretches, parts, strict=True) if part}
    lines = [_run_line(name, found) for name, found in stretches.items() if found and name not in offered]
    if not offered:
        return lines
    lines += [
        f"# Each of these parts is a run of its own{_left_out_text(offered.values())}.",
        "parts = [",
    ]
    for name, part in offered.items():
        used, file = used_parts(part), f"file = {quoted(name)}, " if name else ""
        lines += [
            f'{"   " if one in used else "#  "} {{ {file}name = {quoted(one.name)}, from = "{one.start:.6g} s", '
            f'to = "{one.stop:.6g} s" }},    # {one.evidence}'
            for one in part
        ]
    return [*lines, "]"]


def _left_out_text(parts: Iterable[Sequence[LogStretch]]) -> str:
    """What of the logs no part holds, as it follows upon what the parts are."""
    has_gaps = any(after.start > before.stop for part in parts for before, after in pairwise(used_parts(part)))
    return "; what lies between them is not used" if has_gaps else ", each from where the one before ends"


def _run_line(name: str, stretches: Sequence[LogStretch]) -> str:
    contradiction = name_contradiction(name, stretches)
    note = f"; NOTE: {contradiction}" if contradiction else ""
    return f"# {_comment(name)}{': ' if name else ''}{run_text(stretches)}{note}"


def run_text(stretches: Sequence[LogStretch]) -> str:
    """Return what a run that stays whole is: its manoeuvre, or the kinds of several."""
    if len(stretches) == 1:
        return f"{stretches[0].name}: {stretches[0].evidence}"
    kinds = list(dict.fromkeys(stretch.kind_text for stretch in stretches))
    return f"{counted(len(stretches), 'manoeuvre')}: {', '.join(kinds)}"


def _comment(text: str) -> str:
    """Text from a log that stays within its line."""
    return "".join(letter if letter.isprintable() else "?" for letter in text)


def _relative(path: Path, folder: Path) -> str:
    """The path as it counts from the trial file; absolute where it lies elsewhere."""
    full = path.resolve()
    return full.relative_to(folder).as_posix() if full.is_relative_to(folder) else full.as_posix()
