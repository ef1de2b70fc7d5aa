"""Model and held-out run with which a drafted trial begins, by what the logs hold."""

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Record

_THRUSTERS, _ROLL, _SHIP, _WAVES = "thrusters", "roll", "abkowitz", "heave_pitch"
_WAVE, _MOTION_IN_WAVES = "zeta", frozenset({"z", "theta"})
_ROLL_MOTION = frozenset({"phi", "p"})
_STEERED_MOTION = frozenset({"psi", "psi_magnetic", "r", "u", "v", "x0", "y0", "lat", "lon"})
# largest rudder angle of one run over that of another, from which on the fall of the gain with it shows; chosen
_AMPLITUDE_RATIO = 1.3
_PEAK_PERCENTILE = 95.0  # of the rudder's distance from amidships: its order, not its overshoot; chosen
_LINEAR_TERMS = ("X_u", "X_rr", "Y_v", "Y_r", "Y_d", "N_v", "N_r", "N_d")  # the smallest set that turns and slows down
_VELOCITIES = (frozenset({"u", "v"}), frozenset({"sog", "cog", "psi"}))  # either shows how a ship drifts
_APPROACH_S = 5.0  # s from the start of a run whose mean speed is that of the approach; chosen
_STEADY_RATE = 0.1  # of its median, by which the rate of a propeller may vary that is steady; chosen
_CHOICE = 3  # runs from which on the middle one by size is held out
_HARDLY_STEERED = 0.3  # of the largest size of the inputs of a run, below which a run judges nothing; chosen
# of the range of an input in the other runs, by which a run may leave it and still lie within; by which one may where
# no other run lies within; chosen
_BEYOND, _FARTHER_BEYOND = 0.05, 0.25


@dataclass(frozen=True)
class StartingModel:
    """The model with which a trial begins.

    Attributes:
        name: of the model; empty: no input is recognised, and none is proposed.
        why: for people.
        free: coefficients to estimate; empty: the model's default.
        free_reason: why these.
        inputs: channels by whose size and range runs are compared.
        speed: m/s at which the runs begin; 0 where it is not recorded.
    """

    name: str
    why: str = ""
    free: tuple[str, ...] = ()
    free_reason: str = ""
    inputs: tuple[str, ...] = ()
    speed: float = 0.0

    @property
    def has_forces_of_a_ship(self) -> bool:
        """Whether it is the model of a ship's forces, the one of these that needs mass and inertia."""
        return self.name == _SHIP

    @property
    def has_thrusters(self) -> bool:
        """Whether it is the model of a craft with thrusters, the one of these with speeds ahead and across."""
        return self.name == _THRUSTERS

    @property
    def has_waves(self) -> bool:
        """Whether its input is the elevation of the waves."""
        return self.name == _WAVES

    @property
    def swings(self) -> bool:
        """Whether its input is an angle that swings to both sides of its rest."""
        return self.name == _ROLL


def starting_model(symbols: Set[str], records: Sequence[Record | None], length: float = 0.0) -> StartingModel:
    """Return the simplest model for the channels that are used, its free coefficients as the runs can show them.

    A ship with a rudder whose speeds ahead and across are recorded has one of forces where its length [m] is stated and
    its propeller, if it is recorded, turns steadily.
    """
    commands = tuple(sorted(one for one in symbols if one.startswith(("command_", "rpm_"))))
    if "delta" in symbols:
        peaks = [_peak(one["delta"]) for one in records if one is not None and "delta" in one]
        falls = len(peaks) > 1 and max(peaks) > _AMPLITUDE_RATIO * min(peaks)
        speed = _approach_speed(records)
        if length and speed and any(one <= symbols for one in _VELOCITIES) and _is_rate_steady(records):
            why = "forces over drift, yaw rate and rudder; 'seatrial models' lists others"
            reason = f"the linear terms{', and the damping of fast turns, as rudder angles differ' if falls else ''}"
            free = (*_LINEAR_TERMS, "N_rrr") if falls else _LINEAR_TERMS
            return StartingModel(_SHIP, why, free, reason, ("delta",), speed)
        why = "the simplest with a rudder; 'seatrial models' lists others, 'seatrial models NAME' what one needs"
        reason = "gain, time constant, and the fall of the gain with the rudder angle, which differs between the runs"
        return StartingModel("nomoto", why, ("K", "T", "alpha") if falls else (), reason, ("delta",))
    if commands:
        return StartingModel(_THRUSTERS, "of a craft that steers by its thrusters", (), "", commands)
    if _WAVE in symbols and symbols & _MOTION_IN_WAVES:
        return StartingModel(_WAVES, "of a craft that waves of recorded elevation move", inputs=(_WAVE,))
    if symbols & _ROLL_MOTION and not symbols & _STEERED_MOTION:
        reason = "linear and quadratic damping, restoring, its cubic term, angle of rest"
        free = ("b_1", "b_2", "c_1", "c_3", "phi_0")
        return StartingModel(_ROLL, "of a ship that rolls out from a release", free, reason, ("phi",))
    return StartingModel("")


def held_out_run(model: StartingModel, records: Mapping[str, Record]) -> str:
    """Return the run to judge the model by: the upper middle one by size of those whose inputs lie within the others'.

    Of two the smaller one, since the larger one shows more to the estimate.

    Empty where there is none: a model is not judged beyond the runs that it is fitted to, nor by one that hardly
    steers.
    """
    if not model.inputs:
        return ""
    sizes = {name: _size(model, record) for name, record in records.items()}
    steered = [name for name, size in sizes.items() if size > _HARDLY_STEERED * max(sizes.values())]
    within = ([n for n in steered if _lies_within(model, n, records, share)] for share in (_BEYOND, _FARTHER_BEYOND))
    inside = next((names for names in within if names), [])
    ordered = sorted(inside, key=lambda name: sizes[name])
    return ordered[len(ordered) // 2 if len(ordered) >= _CHOICE else 0] if ordered else ""


def _lies_within(model: StartingModel, name: str, records: Mapping[str, Record], beyond: float) -> bool:
    rest = [record for key, record in records.items() if key != name]
    for symbol in model.inputs:
        if symbol not in records[name]:
            continue
        ranges = [_range(model, one[symbol]) for one in rest if symbol in one]
        if not ranges:
            return False
        low, high = min(a for a, _ in ranges), max(b for _, b in ranges)
        slack = beyond * (high - low)
        first, last = _range(model, records[name][symbol])
        if first < low - slack or last > high + slack:
            return False
    return bool(rest)


def _range(model: StartingModel, values: np.ndarray) -> tuple[float, float]:
    """Of a roll decay the size of its angles: it swings to both sides, whichever it starts from."""
    used = np.abs(values - np.median(values)) if model.swings else values
    return float(np.min(used)), float(np.max(used))


def _size(model: StartingModel, record: Record) -> float:
    """The rms of the inputs; of a roll decay about its rest."""
    parts = (record[one] for one in model.inputs if one in record)
    return float(np.sqrt(sum(np.var(one) if model.swings else np.mean(one**2) for one in parts)))


def _approach_speed(records: Sequence[Record | None]) -> float:
    """The median over the runs of the speed at their start [m/s]; 0 where one has none."""
    used = [one for one in records if one is not None]
    if not used or not all({"u", "v"} <= set(one.channels) for one in used):
        return 0.0
    starts = (one.time - one.time[0] <= _APPROACH_S for one in used)
    speeds = [np.mean(np.hypot(one["u"], one["v"])[rows]) for one, rows in zip(used, starts, strict=True)]
    return float(np.median(speeds))


def _is_rate_steady(records: Sequence[Record | None]) -> bool:
    """Whether the propeller turns at one rate in all runs, as far as it is recorded."""
    rates = [one["n"] for one in records if one is not None and "n" in one]
    if not rates:
        return True
    medians = [float(np.median(one)) for one in rates]
    middle = float(np.median(medians))
    low, high = (np.percentile(np.concatenate(rates), one) for one in (100.0 - _PEAK_PERCENTILE, _PEAK_PERCENTILE))
    return max(middle - low, high - middle) <= _STEADY_RATE * abs(middle)


def _peak(rudder: np.ndarray) -> float:
    return max(float(np.percentile(np.abs(rudder - np.median(rudder)), _PEAK_PERCENTILE)), 1e-6)  # rad, for a ratio
