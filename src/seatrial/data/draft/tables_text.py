"""The tables of a drafted trial file that stand before its records: ship, model, thrusters, sensors, offsets."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.data.check.water_speed import SpeedAndCurrent
from seatrial.data.draft.basin import is_in_basin
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.ship_estimates import StatedSize, added_masses, mass_properties, stated_values
from seatrial.data.draft.starting_model import StartingModel
from seatrial.data.draft.toml_values import quoted
from seatrial.data.draft.waves_text import excitation_lines, ship_in_waves
from seatrial.data.trial.estimated_values import ESTIMATED

# from the centre line to a thruster of a pair, of the breadth: (1 - 0.24) / 2, in the middle of each hull of a
# catamaran that takes 0.24 of it; of the length where the breadth is not stated; both chosen
_LEVER_OF_BEAM, _LEVER_OF_LENGTH = 0.38, 0.15
# formulas for what the records leave open, as 'seatrial models mmg' lists them
_FORMULAS = ("yoshimura", "zhou", "interaction", "propulsion", "displacement")
_CURRENT = 0.3  # m/s, standard deviation of an unknown current; as the advice of the checks
_LEAST_SPEED_ERROR = 0.005  # of a speed, for what its model of turns leaves out; chosen
OPEN_SPEED = "# OPEN U_n"
"""Begins the line that asks for the speed through the water."""
_UNNAMED = "craft"  # a craft whose name is not stated; ours
_NO_CURRENT = (
    f"# current = {_CURRENT:g}    # m/s: taken for a model in a basin, where none runs; uncomment it for open water"
)


def tables_text(
    model: StartingModel, guesses: Sequence[ColumnGuess], size: StatedSize, rate: float | None = None,
    heels: tuple[float, float] | None = None,
) -> list[str]:  # fmt: skip
    """Return the lines of ship and model, and of what else the model needs; of a model without a name what is missing.

    guesses: of all sources of the longest run; rate: at which residuals are taken [Hz]; None: that of the records.
    heels: least and largest about which roll decays swing [rad]; None: one serves all.
    """
    if not model.name:
        return [
            "# 'seatrial check' needs neither ship nor model, 'seatrial identify' both: 'seatrial models' lists them.",
            "# OPEN: no input (rudder, propeller, thruster) was found, and a model needs one: name its column below.",
            "",
        ]
    names = ", ".join(f'"{name}"' for name in model.free)
    return [
        "[ship]",
        f"name = {quoted(size.name or _UNNAMED)}",
        *_ship_lines(model, size),
        "",
        "[model]",
        f'name = "{model.name}"    # {model.why}',
        *(_prior_lines(model) if model.has_propeller else []),
        *([f"free = [{names}]    # {model.free_reason}"] if model.free else []),
        *_speed_prior_lines(model),
        *(
            ["", "[model.fixed]", *(added_mass.line for added_mass in added_masses(size))]
            if model.has_derivatives
            else []
        ),
        *(thruster_tables(guesses, size) if model.has_thrusters else []),
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
    sources = ", ".join(f'"{formula}"' for formula in (*_FORMULAS, *(["wind"] if model.has_wind else [])))
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
    if model.has_waves and size.length:
        lines += [wave.line for wave in ship_in_waves(size)]
    if model.has_thrusters and size.mass:
        lines.append(
            f"m = {size.mass:g}    # kg, as stated: forces come out on each kg of m + m_x until a thruster has bollard"
        )
    if model.swings:
        lines += _roll_lines(size)
    written = {line.partition(" =")[0] for line in lines}
    return [*lines, *(stated_value.line for stated_value in stated_values(size) if stated_value.key not in written)]


def _speed_lines(model: StartingModel) -> list[str]:
    """The speed through the water at which the runs begin; OPEN where only that over ground is known."""
    water = model.water
    if water is not None and model.is_speed_open:
        return [
            f"{OPEN_SPEED}: m/s through the water, which was not recorded; one course does not show it beside a "
            f"current. The runs show {model.speed:.2f} over ground: right in still water, else write the log's speed",
            f"# U_n = {model.speed:.2f}",
        ]
    if water is not None:
        left = f"what {_current_text(water)} leaves of" if model.is_in_current else "no current shows in"
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


def thruster_tables(guesses: Sequence[ColumnGuess], size: StatedSize) -> list[str]:
    """Return one table for each command, on the side that the motion or its name shows."""
    used = {g.symbol: g for g in guesses if g.is_used}
    commands = [g for symbol, g in sorted(used.items()) if symbol.startswith(("command_", "rpm_"))]
    sides = [g.side for g in commands]
    names = [g.side if g.side and sides.count(g.side) == 1 else f"thruster_{k}" for k, g in enumerate(commands, 1)]
    is_pair = sorted(names) == ["port", "starboard"]
    lines = list[str]()
    for name, guess in zip(names, commands, strict=True):
        sign = {"port": -1.0, "starboard": 1.0}.get(name, 0.0)
        angle = f"alpha_{guess.symbol.rpartition('_')[2]}"
        is_rate = guess.symbol.startswith("rpm")
        unit = ', unit = "rpm" }    # add span = the rpm at full ahead' if is_rate else " }"
        lines += [
            "", "[[thruster]]", f'name = "{name}"',
            _place_line(size.length, is_turned=angle in used),
            _lever_line(sign, size),
            *([f'angle = {{ channel = "{angle}" }}'] if angle in used else []),
            f'command = {{ channel = "{guess.symbol}"{unit}',
            *(['same_as = "starboard"    # the same coefficients'] if is_pair and name == "port" else []),
        ]  # fmt: skip
    return lines


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
    """That velocities are those of a receiver: fitted as if through the water, a current would end in coefficients."""
    if model.has_thrusters and any(g.is_used and g.symbol == "u" and g.follows_track for g in guesses):
        return ["[sensors]", 'velocity = "ground"    # as the positions change, over ground: a current is in them', ""]
    if not _is_over_ground(guesses) or not (model.has_thrusters or model.has_forces_of_a_ship):
        return []
    return ["[sensors]", 'velocity = "ground"    # of a receiver, over ground: a current is in them', ""]


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
