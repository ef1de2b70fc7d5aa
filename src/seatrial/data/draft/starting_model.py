"""The model with which a drafted trial begins, and the rate at which its residuals are taken."""

from collections.abc import Sequence, Set
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from seatrial.core.values import Record
from seatrial.core.values.notation import TWIN_DIFFERENCES
from seatrial.data.check.phases import is_free_decay
from seatrial.data.check.water_speed import SpeedAndCurrent, speed_through_water
from seatrial.data.draft.ship_estimates import UNSTATED, EstimatedValue, StatedSize, hull_rudder_propeller, wind_areas
from seatrial.physics.manoeuvres.track import speed
from seatrial.physics.models.published import HIGHER_ORDER_SPREAD, SHARE_SPREAD, SYMMETRIC, share_name
from seatrial.physics.models.registry import family_of

# The model with which a drafted trial begins, by what the logs hold and what is stated of the craft.

_THRUSTERS, _ROLL, _SHIP, _WAVES = "thrusters", "roll", "abkowitz", "heave_pitch"
_MMG, _TWIN, _SHALLOW = "mmg", "mmg_twin", "mmg_shallow"
_FINS = "alpha_f"
_WAVE, _MOTION_IN_WAVES = "zeta", frozenset({"z", "theta"})
_ROLL_MOTION = frozenset({"phi", "p"})
_STEERED_MOTION = frozenset({"psi", "psi_magnetic", "r", "u", "v", "x0", "y0", "lat", "lon"})
# largest rudder angle of one run over that of another, from which on the fall of the gain with it shows; chosen
_AMPLITUDE_RATIO = 1.3
_PEAK_PERCENTILE = 95.0  # of the rudder's distance from amidships: its order, not its overshoot; chosen
_LINEAR_TERMS = ("X_u", "Y_v", "Y_r", "Y_d", "N_v", "N_r", "N_d")  # those that a ship cannot be without
# those of the hull that the model itself frees, and what else its formulas know badly
_MMG_TERMS = (
    "R_0", "X_vv", "X_vr", "X_rr", "X_vvvv", "Y_v", "Y_r", "Y_vvv", "Y_vvr", "Y_vrr", "Y_rrr", "N_v", "N_r", "N_vvv",
    "N_vvr", "N_vrr", "N_rrr", "t_P", "w_P0", "epsilon", "gamma_R_plus", "gamma_R_minus",
)  # fmt: skip
# each of them shows how a ship drifts
_DRIFT = tuple(map(frozenset, (("u", "v"), ("sog", "cog", "psi"), ("x0", "y0", "psi"), ("lat", "lon", "psi"))))
_SHARES = tuple(share_name(name) for name in SHARE_SPREAD)
_APPROACH_S = 5.0  # s from the start of a run whose mean speed is that of the approach; chosen
_SLOW_START = 0.7  # of the speed that a run reaches, below which its start is no approach; chosen
_OTHER_DEPTH = 1.2  # of one depth over another, from which on runs show what changes with it; chosen
_FELT = 3.0  # depth over draught from which on water is deep (PIANC 1992, classes of depth)
_APART = 0.1  # of the largest mean of two rudders or shafts, from which on their difference steers; chosen
_STEADY_RATE = 0.1  # of its median, by which the rate of a propeller may vary that is steady; chosen


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
        particulars: of hull, rudder and propeller, where the model needs them.
        has_wind: whether the recorded wind is an input.
        water: what velocities over ground show of speed and current; None: nothing, or the speed through the water is
            recorded.
    """

    name: str
    why: str = ""
    free: tuple[str, ...] = ()
    free_reason: str = ""
    inputs: tuple[str, ...] = ()
    speed: float = 0.0
    particulars: tuple[EstimatedValue, ...] = ()
    has_wind: bool = False
    water: SpeedAndCurrent | None = None

    @property
    def is_speed_open(self) -> bool:
        """Whether the runs are over ground, on courses that do not separate speed and current."""
        return self.water is not None and not self.water.shows_current

    @property
    def is_in_current(self) -> bool:
        """Whether the runs show a current, and the speed through the water with it."""
        return self.water is not None and self.water.is_separate and self.water.has_current

    @property
    def has_derivatives(self) -> bool:
        """Whether its forces are an expansion in the motions, the one of these that needs mass and inertia."""
        return self.name == _SHIP

    @property
    def has_propeller(self) -> bool:
        """Whether it has forces of hull, propeller and rudder, each its own."""
        return family_of(self.name) == _MMG

    @property
    def is_in_shallow_water(self) -> bool:
        """Whether the depth of the water is an input."""
        return self.name == _SHALLOW

    @property
    def has_two_screws(self) -> bool:
        """Whether it has two screws, each with a rudder behind it."""
        return self.name == _TWIN

    @property
    def has_forces_of_a_ship(self) -> bool:
        """Whether it has the forces of a ship with a rudder."""
        return self.has_derivatives or self.has_propeller

    @property
    def has_thrusters(self) -> bool:
        """Whether it is the model of a craft with thrusters, the one of these with speeds ahead and across."""
        return self.name == _THRUSTERS

    @property
    def heaves(self) -> bool:
        """Whether it is the model of heave and pitch."""
        return self.name == _WAVES

    @property
    def has_waves(self) -> bool:
        """Whether its input is the elevation of the waves."""
        return self.inputs == (_WAVE,)

    @property
    def rolls(self) -> bool:
        """Whether it is the model of roll."""
        return self.name == _ROLL

    @property
    def swings(self) -> bool:
        """Whether runs are decays: what stands for its inputs swings to both sides of its rest."""
        return (self.rolls and _FINS not in self.inputs) or (self.heaves and not self.has_waves)


def starting_model(
    symbols: Set[str], records: Sequence[Record | None], size: StatedSize = UNSTATED, *, has_jet: bool = False
) -> StartingModel:
    """Return the simplest model for the channels that are used, its free coefficients as the runs can show them.

    A ship with a rudder whose speeds ahead and across are recorded, or its track and heading, has one of forces where
    its length is stated: with its propeller where the rate of one is recorded, else where nothing speaks of an engine
    that is not steady.

    has_jet: whether the rudder is the nozzle of a jet.
    """
    commands = tuple(sorted(symbol for symbol in symbols if symbol.startswith(("command_", "rpm_"))))
    if "delta" in symbols:
        return _steered_model(symbols, records, size, has_jet=has_jet)
    if commands:
        why = "of a craft that steers by its thrusters"
        return StartingModel(_THRUSTERS, why, (), "", commands, _approach_speed(records))
    if _WAVE in symbols and symbols & _MOTION_IN_WAVES:
        return StartingModel(_WAVES, "of a craft that waves of recorded elevation move", inputs=(_WAVE,))
    if symbols & _ROLL_MOTION and not symbols & _STEERED_MOTION:
        reason = "linear and quadratic damping, restoring, its cubic term, angle of rest"
        free = ("b_1", "b_2", "c_1", "c_3", "phi_0")
        if any(r is not None and _FINS in r and np.ptp(r[_FINS]) > 0.0 for r in records):
            return StartingModel(_ROLL, "of a ship that fins roll", (*free, "K_alpha"), f"{reason}; the fins", (_FINS,))
        return StartingModel(_ROLL, "of a ship that rolls out from a release", free, reason, ("phi",))
    motions = symbols & _MOTION_IN_WAVES
    if motions and not symbols & _STEERED_MOTION and all(is_free_decay(r) for r in records if r is not None):
        why = "of a craft that heaves and pitches out from a release"
        return StartingModel(_WAVES, why, inputs=tuple(sorted(motions)))
    return StartingModel("")


def with_wind(model: StartingModel, size: StatedSize) -> StartingModel:
    """Return the model with a recorded wind on the areas of a ship of this size."""
    reason = f"{model.free_reason}; the recorded wind"
    particulars = (*model.particulars, *wind_areas(size))
    return replace(model, free=(*model.free, *SYMMETRIC), free_reason=reason, particulars=particulars, has_wind=True)


def in_a_current(model: StartingModel, symbols: Set[str], records: Sequence[Record]) -> StartingModel:
    """Return the model with what fixes, or velocities over ground, show of the speed through the water.

    Where several courses separate it from a current, the speed at which the forces balance is estimated as well.

    symbols: channels that are used; records: of the runs.
    """
    is_over_ground = bool(symbols & {"lat", "x0", "sog"}) and not symbols & {"u", "stw"}
    if not is_over_ground or not model.has_forces_of_a_ship:
        return model
    model = replace(model, water=speed_through_water(records))
    if model.water is None or model.is_speed_open:
        return model
    free = (*model.free, "U_n") if model.has_derivatives else model.free
    return replace(model, speed=model.water.speed, free=free)


def share_current(records: Sequence[Record | None]) -> bool:
    """Return whether no two runs show currents that differ."""
    fits = [speed_through_water([record]) for record in records if record is not None]
    known = [fit for fit in fits if fit is not None and fit.shows_current]
    return all(one.agrees_with(other) for one, other in combinations(known, 2))


def _steered_model(
    symbols: Set[str], records: Sequence[Record | None], size: StatedSize, *, has_jet: bool
) -> StartingModel:
    peaks = [_peak(record["delta"]) for record in records if record is not None and "delta" in record]
    falls = len(peaks) > 1 and max(peaks) > _AMPLITUDE_RATIO * min(peaks)
    approach = _approach_speed(records)
    if size.length and approach and any(one <= symbols for one in _DRIFT):
        screws = 2 if _differ(records) else 1
        particulars = () if has_jet else hull_rudder_propeller(size, approach, _advance(records), screws)
        if particulars:
            name = _TWIN if screws > 1 else _SHALLOW if _is_shallow(records, size) else _MMG
            why = "forces of hull, propeller and rudder; abkowitz, without the last two, holds within the runs only"
            reason = "hull, wake, thrust and the flow at the rudder, near formulas by priors as wide as their errors"
            free = (*_MMG_TERMS, *_SHARES) if name == _SHALLOW and _show_depth(records) else _MMG_TERMS
            return StartingModel(name, why, free, reason, ("delta",), approach, particulars)
        if is_rate_steady(records):
            why = "forces over drift, yaw rate, rudder; mmg goes farther with a propeller's rate (init --gear)"
            reason = "the linear terms; the others near 0, by priors as wide as of published ships"
            free = (*_LINEAR_TERMS, *HIGHER_ORDER_SPREAD)
            return StartingModel(_SHIP, why, free, reason, ("delta",), approach)
    why = "the simplest with a rudder; 'seatrial models' lists others, 'seatrial models NAME' what one needs"
    reason = "gain, time constant, and the fall of the gain with the rudder angle, which differs between the runs"
    return StartingModel("nomoto", why, ("K", "T", "alpha") if falls else (), reason, ("delta",))


def _approach_speed(records: Sequence[Record | None]) -> float:
    """The median over the runs of the speed of the approach [m/s]; 0 where one has none."""
    speeds = [_speed_ahead(record) for record in records if record is not None]
    return float(np.median(speeds)) if speeds and all(speeds) else 0.0


def _speed_ahead(record: Record) -> float:
    """The mean speed of a run at its start; of one that starts slowly what it reaches; 0 where it is not recorded."""
    flow = speed(record)
    if flow is None:
        return 0.0
    reached = float(np.percentile(flow, _PEAK_PERCENTILE))
    start = float(np.mean(flow[record.time - record.time[0] <= _APPROACH_S]))
    return start if start > _SLOW_START * reached else reached


def _differ(records: Sequence[Record | None]) -> bool:
    """Whether two rudders and two shafts are recorded, and a run shows one of these pairs apart."""
    pairs = [(name, TWIN_DIFFERENCES[name]) for name in ("delta", "n")]
    known = [record for record in records if record is not None]
    if not all(difference in record for record in known for _, difference in pairs):
        return False
    return any(_peak(record[apart]) > _APART * _peak(record[mean], 0.0) for record in known for mean, apart in pairs)


def _is_shallow(records: Sequence[Record | None], size: StatedSize) -> bool:
    """Whether a run is over water so shallow that a ship of this size feels the bottom; 0 is no depth."""
    depths = [record["depth"] for record in records if record is not None and "depth" in record]
    return any(np.any((depth > 0.0) & (depth < _FELT * size.form.d)) for depth in depths)


def _show_depth(records: Sequence[Record | None]) -> bool:
    """Whether runs are over depths that differ: one depth does not part a coefficient from its change with depth."""
    depths = [float(np.median(record["depth"])) for record in records if record is not None and "depth" in record]
    known = [depth for depth in depths if depth > 0.0]
    return bool(known) and (len(known) < len(depths) or max(known) > _OTHER_DEPTH * min(known))


def _advance(records: Sequence[Record | None]) -> float:
    """The median over the runs of the way [m] that is made in a turn of the propeller; 0 where it is not recorded."""
    used = [record for record in records if record is not None and "n" in record]
    rates = [float(np.median(one["n"])) for one in used]
    ways = [_speed_ahead(one) / rate for one, rate in zip(used, rates, strict=True) if rate > 0.0]
    return float(np.median(ways)) if ways else 0.0


def is_rate_steady(records: Sequence[Record | None]) -> bool:
    """Return whether the propeller turns at one rate in all runs, as far as it is recorded."""
    rates = [record["n"] for record in records if record is not None and "n" in record]
    if not rates:
        return True
    medians = [float(np.median(rate)) for rate in rates]
    middle = float(np.median(medians))
    low, high = (np.percentile(np.concatenate(rates), one) for one in (100.0 - _PEAK_PERCENTILE, _PEAK_PERCENTILE))
    return max(middle - low, high - middle) <= _STEADY_RATE * abs(middle)


def _peak(rudder: np.ndarray, middle: float | None = None) -> float:
    middle = float(np.median(rudder)) if middle is None else middle
    return max(float(np.percentile(np.abs(rudder - middle), _PEAK_PERCENTILE)), 1e-6)  # rad, for a ratio


# The rate at which residuals of a ship are taken: samples far closer than a ship moves cost time and add little.

# samples in the time of a ship length from which on a log is thinned, and how many are left at least; chosen: held-out
# errors of a tug's model with 9 were those with 36
_MANY, _ENOUGH = 25.0, 9.0


def thinned_rate(records: Sequence[Record | None], length: float, speed: float) -> float | None:
    """Return the rate [Hz] at which residuals are taken, a whole part of the records'; None: that of the records.

    length: of the ship [m]; speed: at which the runs begin [m/s].
    """
    steps = [record.dt for record in records if record is not None and len(record) > 1]
    if not steps or not length or not speed:
        return None
    step = float(np.median(steps))
    samples = length / speed / step
    return 1.0 / (step * int(samples / _ENOUGH)) if samples >= _MANY else None
