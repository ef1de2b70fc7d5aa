"""Ship, model and held-out run with which a drafted trial begins, by what the logs hold."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Record
from seatrial.data.draft.column_guess import ColumnGuess

_THRUSTERS, _ROLL = "thrusters", "roll"
_ROLL_MOTION = frozenset({"phi", "p"})
_STEERED_MOTION = frozenset({"psi", "psi_magnetic", "r", "u", "v", "x0", "y0", "lat", "lon"})
# largest rudder angle of one run over that of another, from which on the fall of the gain with it shows; chosen
_AMPLITUDE_RATIO = 1.3
_PEAK_PERCENTILE = 95.0  # of the rudder's distance from amidships: its order, not its overshoot; chosen
_BEYOND = 0.05  # of the range of an input in the other runs, by which a run may leave it and still lie within; chosen


@dataclass(frozen=True)
class StartingModel:
    """The model with which a trial begins.

    Attributes:
        name: of the model; empty: no input is recognised, and none is proposed.
        why: for people.
        free: coefficients to estimate; empty: the model's default.
        free_reason: why these.
        inputs: channels by whose size and range runs are compared.
    """

    name: str
    why: str = ""
    free: tuple[str, ...] = ()
    free_reason: str = ""
    inputs: tuple[str, ...] = ()

    @property
    def has_thrusters(self) -> bool:
        """Whether it is the model of a craft with thrusters, the one of these with speeds ahead and across."""
        return self.name == _THRUSTERS

    @property
    def swings(self) -> bool:
        """Whether its input is an angle that swings to both sides of its rest."""
        return self.name == _ROLL


def starting_model(symbols: Set[str], records: Sequence[Record | None]) -> StartingModel:
    """Return the simplest model for the channels that are used, its free coefficients as the runs can show them."""
    commands = tuple(sorted(one for one in symbols if one.startswith(("command_", "rpm_"))))
    if "delta" in symbols:
        peaks = [_peak(one["delta"]) for one in records if one is not None and "delta" in one]
        falls = len(peaks) > 1 and max(peaks) > _AMPLITUDE_RATIO * min(peaks)
        why = "the simplest with a rudder; 'seatrial models' lists others, 'seatrial models NAME' what one needs"
        reason = "gain, time constant, and the fall of the gain with the rudder angle, which differs between the runs"
        return StartingModel("nomoto", why, ("K", "T", "alpha") if falls else (), reason, ("delta",))
    if commands:
        return StartingModel(_THRUSTERS, "of a craft that steers by its thrusters", (), "", commands)
    if symbols & _ROLL_MOTION and not symbols & _STEERED_MOTION:
        reason = "linear and quadratic damping, restoring, its cubic term, angle of rest"
        free = ("b_1", "b_2", "c_1", "c_3", "phi_0")
        return StartingModel(_ROLL, "of a ship that rolls out from a release", free, reason, ("phi",))
    return StartingModel("")


def held_out_run(model: StartingModel, records: Mapping[str, Record]) -> str:
    """Return the run to judge the model by: the middle one by size of those whose inputs lie within the others'.

    Empty where there is none: a model is not judged beyond the runs that it is fitted to.
    """
    inside = [name for name in records if _lies_within(model, name, records)]
    sizes = {name: _size(model, records[name]) for name in inside}
    ordered = sorted(inside, key=lambda name: sizes[name])
    return ordered[(len(ordered) - 1) // 2] if ordered else ""


def thruster_tables(guesses: Sequence[ColumnGuess]) -> list[str]:
    """Return one table for each command, with the side on which the motion shows the thruster."""
    used = {g.symbol: g for g in guesses if g.is_used}
    commands = [g for symbol, g in sorted(used.items()) if symbol.startswith(("command_", "rpm_"))]
    sides = [g.side for g in commands]
    names = [g.side if g.side and sides.count(g.side) == 1 else f"thruster_{k}" for k, g in enumerate(commands, 1)]
    is_pair = sorted(names) == ["port", "starboard"]
    lines = list[str]()
    for name, guess in zip(names, commands, strict=True):
        sign = {"port": "-", "starboard": ""}.get(name, "")
        angle = f"alpha_{guess.symbol.rpartition('_')[2]}"
        is_rate = guess.symbol.startswith("rpm")
        unit = ', unit = "rpm" }    # add span = the rpm at full ahead' if is_rate else " }"
        lines += [
            "", "[[thruster]]", f'name = "{name}"', "x = 0.0    # m forward of the point to which positions refer",
            f"y = {sign}0.0    # m to starboard, negative to port: state it",
            *([f'angle = {{ channel = "{angle}" }}'] if angle in used else []),
            f'command = {{ channel = "{guess.symbol}"{unit}',
            *(['same_as = "starboard"    # the same coefficients'] if is_pair and name == "port" else []),
        ]  # fmt: skip
    return lines


def _lies_within(model: StartingModel, name: str, records: Mapping[str, Record]) -> bool:
    rest = [record for key, record in records.items() if key != name]
    for symbol in model.inputs:
        if symbol not in records[name]:
            continue
        ranges = [_range(model, one[symbol]) for one in rest if symbol in one]
        if not ranges:
            return False
        low, high = min(a for a, _ in ranges), max(b for _, b in ranges)
        slack = _BEYOND * (high - low)
        first, last = _range(model, records[name][symbol])
        if first < low - slack or last > high + slack:
            return False
    return bool(rest)


def _range(model: StartingModel, values: np.ndarray) -> tuple[float, float]:
    """Of a roll decay the size of its angles: it swings to both sides, whichever it starts from."""
    used = np.abs(values - np.median(values)) if model.swings else values
    return float(np.min(used)), float(np.max(used))


def _size(model: StartingModel, record: Record) -> float:
    return float(np.sqrt(sum(np.var(record[one]) for one in model.inputs if one in record)))


def _peak(rudder: np.ndarray) -> float:
    return max(float(np.percentile(np.abs(rudder - np.median(rudder)), _PEAK_PERCENTILE)), 1e-6)  # rad, for a ratio
