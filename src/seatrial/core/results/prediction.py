"""Runs simulated and compared with their measurement: open loop, over windows, samples ahead."""

import math
from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from pydantic import Field

from seatrial.core.results.coefficients import Offset
from seatrial.core.results.fields import ListedArray, Number, ReportedFinding, StoredArray, StoredRecord
from seatrial.core.values import Array, Record, RecordKind

# How far the motions of a run spread: what errors of its prediction are compared with.

MOTIONS = {"psi_deg": ("psi",), "position_m": ("x0", "y0"), "z": ("z",), "theta_deg": ("theta",), "phi_deg": ("phi",)}
"""Name of an error, as in `Prediction.rms` -> the channels of that motion."""
_DEGREES = math.degrees(1.0)
ERROR_CHANNELS: Mapping[str, tuple[tuple[str, ...], float]] = {
    "psi_deg": (("psi",), _DEGREES), "position_m": (("x0", "y0"), 1.0), "theta_deg": (("theta",), _DEGREES),
    "phi_deg": (("phi",), _DEGREES), "z": (("z",), 1.0), "u": (("u",), 1.0), "v": (("v",), 1.0), "r": (("r",), 1.0),
}  # fmt: skip
"""Name of an error, as in `Prediction.rms` -> its channels, and the factor from their unit to its own."""
_NOISE_SHARE = math.sqrt(2.0)  # of error over sensor noise up to which half of its square is noise; chosen
HEADING_SPREAD = math.pi / math.sqrt(3.0)
"""rad, standard deviation of a heading that points anywhere alike: turns on and on spread it no further."""
HELD_COURSE_SPREAD = math.radians(10.0)
"""rad, by which a heading that is held over a whole run counts as spread: what a helmsman leaves of it is no motion to
measure a model by; chosen: of a 10/10 zigzag."""
_HELD_WITHIN = math.radians(5.0)  # standard deviation of a heading below which it is held; chosen: of small zigzags


def motion_spread(name: str, motions: Sequence[Array]) -> float:
    """Return the standard deviation of the channels of a motion together, in the unit of its error.

    A heading that turns on and on spreads no further than one that points anywhere alike.

    Args:
        name: of its error, as in `Prediction.rms`.
        motions: shape (n,) each, SI.
    """
    spread = math.sqrt(sum(float(np.nanvar(motion)) for motion in motions))
    if name == "psi_deg":
        spread = min(spread, HEADING_SPREAD)
    return spread * (_DEGREES if name.endswith("_deg") else 1.0)


def motion_spreads(names: Container[str], measured: Record, length: float = 0.0) -> dict[str, float]:
    """Return what errors of these names over a whole run are compared with, as far as it holds their channels.

    Of a held course the way run is no motion to measure a model by: what counts is how far one 10 degrees off leads.

    Args:
        names: of errors, as in `Prediction.rms`.
        measured: the run.
        length: of the ship, m, as for `with_hull_ends`.
    """
    compared = (name for name, channels in MOTIONS.items() if name in names and all(c in measured for c in channels))
    spreads = {name: motion_spread(name, [measured[c] for c in MOTIONS[name]]) for name in compared}
    if spreads.get("psi_deg", math.inf) < _DEGREES * _HELD_WITHIN:
        spreads["psi_deg"] = _DEGREES * HELD_COURSE_SPREAD
        if "position_m" in spreads:
            spreads["position_m"] *= math.sin(HELD_COURSE_SPREAD)
    return with_hull_ends(spreads, length)


def with_hull_ends(spreads: dict[str, float], length: float) -> dict[str, float]:
    """Return spreads with that of the position at least as far as the heading swings the ends of the hull.

    On the spot the place is no motion to measure a model by: it wanders by what receivers err by.

    Args:
        spreads: name of an error -> standard deviation of its motion, in its unit.
        length: of the ship, m; 0: not known.
    """
    if not {"psi_deg", "position_m"} <= spreads.keys():
        return spreads
    swung = 0.5 * length * min(spreads["psi_deg"] / _DEGREES, 1.0)  # rad; L / 2 all round, by its two coordinates
    return spreads | {"position_m": max(spreads["position_m"], swung)}


def sensor_errors(noise: Mapping[str, float]) -> dict[str, float]:
    """Return the errors that a perfect model would show: rms of the sensors' noise, in the unit of each error.

    noise: standard deviation of channels, SI.
    """
    return {
        name: factor * math.hypot(*(noise[c] for c in channels))
        for name, (channels, factor) in ERROR_CHANNELS.items()
        if all(c in noise for c in channels)
    }


def is_sensor_noise(rms: float, noise: float) -> bool:
    """Return whether an error is mostly noise of the sensor, rms of both in one unit."""
    return rms <= _NOISE_SHARE * noise


# Errors of predictions some samples ahead, from the samples up to each moment.


@dataclass(frozen=True)
class KStepErrors:
    """How far one channel is missed k samples ahead, by the fit's Kalman filter, over all runs of a role.

    Inputs are those recorded. Without a disturbance in the fit every horizon has the error of a simulation.
    """

    channel: str
    unit: Annotated[str, Field(description="SI")]
    role: Annotated[str, Field(description="validation or training")]
    steps: Annotated[tuple[int, ...], Field(description="horizons k, samples")]
    seconds: Annotated[tuple[Number, ...], Field(description="the same, s")]
    rms: Annotated[tuple[Number, ...], Field(description="root-mean-square error at each horizon, `unit`")]
    fit_percent: Annotated[
        tuple[Number, ...],
        Field(description="100 (1 - |error| / |measured - mean|) at each horizon, as MATLAB's compare (NRMSE)"),
    ]
    held_rms: Annotated[
        tuple[Number, ...],
        Field(description="root-mean-square error of a baseline: the last measured value stays as it is, `unit`"),
    ]
    count: Annotated[tuple[int, ...], Field(description="number of predictions at each horizon")]


# Predictions over windows of a run, with baselines that anybody could make.


@dataclass(frozen=True)
class ChannelScore:
    """How one channel is predicted over all windows of a length; null where a window diverges."""

    rms: Annotated[Number, Field(description="root-mean-square error, unit as in `Prediction.rms`")]
    fit_percent: Annotated[
        Number, Field(description="100 (1 - |error| / |measured - mean|), as MATLAB's compare (NRMSE); 100 is perfect")
    ]
    r_squared: Annotated[Number, Field(description="1 - sum of squared errors over that about the mean")]
    inside_band: Annotated[
        Number | None,
        Field(description="share of samples inside their 95 % band (sensor noise and waves included); null: no band"),
    ] = None
    band_share: Annotated[
        Number | None,
        Field(description="rms half width of the band over the standard deviation of the motion; null: no band"),
    ] = None

    @property
    def band_over_error(self) -> float | None:
        """Return the rms half width of the band over the rms error, about 2 where the band is right; None: no band."""
        if self.band_share is None or not self.r_squared < 1.0:
            return None
        return self.band_share / math.sqrt(1.0 - self.r_squared)  # the error is that share of the motion

    @property
    def is_band_too_wide(self) -> bool:
        """Whether the band is wider than the motion itself, so that the mean of the motion would lie inside it, too."""
        return self.band_share is not None and self.band_share > 1.0


@dataclass(frozen=True)
class WindowBaseline:
    """A prediction that needs no fit of this model, over the same windows from the same beginnings."""

    name: str
    scores: Annotated[
        dict[str, ChannelScore], Field(description="keys as in `WindowScore.scores`, as far as it predicts them")
    ]


@dataclass(frozen=True)
class WindowScore:
    """A run cut into windows of one length, each predicted open loop from the state estimated in its beginning."""

    window: Annotated[str, Field(description="as required: 10 s, 5 L (ship lengths at the run's speed)")]
    seconds: Annotated[Number, Field(description="length of the windows")]
    count: Annotated[int, Field(description="number of windows")]
    scores: Annotated[dict[str, ChannelScore], Field(description="keys as in `Prediction.rms`")] = field(
        default_factory=dict
    )
    baselines: tuple[WindowBaseline, ...] = ()
    diverged: Annotated[int, Field(description="number of windows in which the model diverges")] = 0

    @property
    def divergence_text(self) -> str:
        """Return in how many windows the model diverges; empty where it does in none."""
        return f"the model diverges in {self.diverged} of {self.count} windows" if self.diverged else ""

    def better_baselines(self, noise: Mapping[str, float]) -> dict[str, str]:
        """Return the channel of each baseline that errs less than the fit -> name of the best one there.

        An error of the fit without a number, after a divergence, is compared with none, and so is one that is sensor
        noise: what lies below that no record shows. noise: as of `sensor_errors`.
        """
        better: dict[str, str] = {}
        for channel, score in self.scores.items():
            if not math.isfinite(score.rms) or is_sensor_noise(score.rms, noise.get(channel, 0.0)):
                continue
            rivals = [
                (b.scores[channel].rms, b.name) for b in self.baselines if b.scores.get(channel, score).rms < score.rms
            ]
            if rivals:
                better[channel] = min(rivals)[1]
        return better


# Runs simulated open loop and compared with their measurement, by the fit and by other estimators.


@dataclass(frozen=True)
class Measure:
    """One manoeuvring measure, measured against simulated."""

    measured: Annotated[Number | None, Field(description="null: the record does not show it")]
    simulated: Annotated[Number | None, Field(description="null: the simulation does not show it")]
    lower: Annotated[
        Number | None, Field(description="95 % interval of the simulated value; null until a method defends it")
    ] = None
    upper: Annotated[Number | None, Field(description="as `lower`")] = None
    is_determined: Annotated[
        bool, Field(description="false: the records leave the simulated value open, its interval would say nothing")
    ] = True


@dataclass(frozen=True)
class Extrapolation:
    """How far a prediction leaves the training runs."""

    index: Annotated[Number, Field(description="largest of the ratios; up to 1 is interpolation")]
    ratios: Annotated[
        dict[str, Number],
        Field(
            description="yaw_rate, drift, rudder, fastest speed of the run over those of the training runs, and their "
            "slowest speed over the run's. Of a command NAME ahead or astern, by the direction of motion: 1 and the "
            "distance beyond the training runs as a share of the whole range. Of the rudder to the side that was used "
            "less: the same, as a share of their largest angle"
        ),
    ]
    untrained_kind: Annotated[
        str,
        Field(description="kind of manoeuvre, as zigzag, that no training run shows; empty: none"),
    ] = ""


@dataclass(frozen=True)
class Divergence:
    """Where a simulated run leaves all bounds, and what drives it there; the run is scored up to that time."""

    time: Annotated[Number, Field(description="s on the record's clock, first sample that is not scored")]
    seconds: Annotated[Number, Field(description="s from the run's first sample that are scored")]
    state: Annotated[str, Field(description="the state that leaves its bounds first")]
    terms: Annotated[
        tuple[str, ...],
        Field(description="parameters whose terms in the state's equation drive it away, the strongest first"),
    ] = ()


_EXPLAINED = 0.7  # share of an error from which on a disturbance is said to leave it; chosen


@dataclass(frozen=True, eq=False)
class Prediction:
    """One run simulated open loop, compared with its measurement."""

    record: Annotated[str, Field(description="name of the run")]
    role: Annotated[str, Field(description="validation or training")]
    measured: StoredRecord
    simulated: StoredRecord
    rms: Annotated[
        dict[str, Number], Field(description="psi_deg, position_m, u and v (m/s), r (rad/s), as far as measured")
    ]
    measures: Annotated[
        dict[str, Measure],
        Field(description="such as overshoot_1_deg, advance_L; names end in _L (ship lengths), _deg or _s"),
    ]
    initial_seconds: Annotated[
        Number, Field(description="s of the start of the run from which the initial state was estimated")
    ]
    extrapolation: Annotated[Extrapolation | None, Field(description="null: not known")] = None
    half_width: Annotated[
        dict[str, StoredArray],
        Field(description="psi, x0, y0, phi, z, theta -> half width of its 95 % band at every sample, (n,), SI"),
    ] = field(default_factory=dict)
    noise_floor: Annotated[
        dict[str, Number],
        Field(
            description="rms errors, keys as in `rms`, that the process noise of the fit leaves by itself, model error "
            "in it"
        ),
    ] = field(default_factory=dict)
    tied_spread: Annotated[
        dict[str, Number], Field(description="standard deviation over tied models, keys as in `measures` and `rms`")
    ] = field(default_factory=dict)
    divergence: Annotated[
        Divergence | None, Field(description="null: the simulation lasts as long as the run; else NaN follows it")
    ] = None
    offsets: Annotated[
        dict[str, Number],
        Field(
            description="offset of the run (delta zero; gain; delay, s) or parameter of its session -> value with "
            "which it was simulated, SI; empty: none"
        ),
    ] = field(default_factory=dict)
    session: Annotated[str, Field(description="with whose runs it shares its offsets; empty: not known")] = ""
    windows: Annotated[
        tuple[WindowScore, ...], Field(description="windows of the run, each predicted by itself; validation runs only")
    ] = ()

    def is_left_by_disturbance(self, name: str, error: float) -> bool:
        """Return whether the process noise of the fit leaves most of an error, a key of `rms`, by itself.

        Where its floor is not known, it would leave more.
        """
        return self.noise_floor.get(name, error) >= _EXPLAINED * error

    @property
    def is_reference_simulated(self) -> bool:
        """Return whether the record that the run is compared with is itself a simulation."""
        return self.measured.kind is RecordKind.SIMULATED

    @property
    def reference_word(self) -> str:
        """Return what figures and tables call that record: ``measured``, or ``reference`` where it is simulated."""
        return "reference" if self.is_reference_simulated else "measured"

    @property
    def model_word(self) -> str:
        """Return what they call the model's run: ``simulated``, or ``model`` where the other one is simulated too."""
        return "model" if self.is_reference_simulated else "simulated"


@dataclass(frozen=True, eq=False)
class IntervalBasis:
    """What intervals of any further prediction of a fit are made of; kept in model.toml.

    Attributes:
        covariance: of the free coefficients, without the spread of tied models, shape (n, n).
        degrees_of_freedom: of Student's t.
        factor: multiplies a predicted standard deviation where no training run shows that kind of measure.
        measure_deviation: kind of measure -> standard deviation that is added, in its unit.
        offsets: offset (``delta zero``) -> standard deviation between sessions, SI; empty where one session alone was
            recorded, which shows nothing of it.
        process: state -> intensity of process noise, SI over the root of a second.
        training_envelope: what the training runs cover, SI (see `estimation.information.motion_envelope`).
        tied: parameter -> value of each tied model.
    """

    covariance: ListedArray
    degrees_of_freedom: float
    factor: float = 1.0
    measure_deviation: dict[str, float] = field(default_factory=dict)
    offsets: dict[str, float] = field(default_factory=dict)
    process: dict[str, float] = field(default_factory=dict)
    training_envelope: dict[str, float] = field(default_factory=dict)
    tied: tuple[dict[str, float], ...] = ()


NO_COMPARISON = "no-comparison"
"""Code of the finding that says why other estimators could not be compared."""


@dataclass(frozen=True)
class OpenLoopScores:
    """Runs simulated open loop, scored together; rms and correlation are empty where one diverges."""

    rms: Annotated[
        dict[str, Number], Field(description="keys as in `Prediction.rms`, root of the mean of squares over the runs")
    ] = field(default_factory=dict)
    correlation: Annotated[
        dict[str, Number], Field(description="u, v, r: Pearson's coefficient of measured and simulated, mean over runs")
    ] = field(default_factory=dict)
    diverged: Annotated[tuple[str, ...], Field(description="names of the runs whose simulation diverges")] = ()


@dataclass(frozen=True)
class RowScore:
    """Rows of one equation that were kept for testing, predicted by the regression."""

    rmse: Annotated[Number, Field(description="of the target, its unit")]
    correlation: Annotated[Number, Field(description="Pearson's coefficient of target and prediction")]
    explained: Annotated[Number, Field(description="1 - residual variance over variance, about the mean (R squared)")]
    rows: Annotated[int, Field(description="number of rows")]


@dataclass(frozen=True)
class Baseline:
    """An estimator on the records of a fit; first the fit itself, then, if it has any, without its offsets."""

    name: str
    values: Annotated[dict[str, Number], Field(description="coefficient -> SI; empty where the estimator failed")] = (
        field(default_factory=dict)
    )
    normalised_difference: Annotated[
        dict[str, Number], Field(description="coefficient -> difference from the fit's estimate in its standard errors")
    ] = field(default_factory=dict)
    error: Annotated[dict[str, Number], Field(description="relative, where the true value is known and not zero")] = (
        field(default_factory=dict)
    )
    training: Annotated[
        OpenLoopScores, Field(description="training runs with these values, from the initial states of the fit")
    ] = field(default_factory=OpenLoopScores)
    validation: Annotated[OpenLoopScores, Field(description="the same of the runs that were not fitted")] = field(
        default_factory=OpenLoopScores
    )
    bias: Annotated[
        dict[str, Number], Field(description="equation -> constant that the estimator allowed itself in addition")
    ] = field(default_factory=dict)
    test: Annotated[dict[str, RowScore], Field(description="equation -> score on rows kept for testing")] = field(
        default_factory=dict
    )
    findings: tuple[ReportedFinding, ...] = ()
    note: Annotated[str, Field(description="why the estimator failed; empty where it did not")] = ""
    is_fit: Annotated[bool, Field(description="whether these are the coefficients of the fit")] = False

    @property
    def diverged(self) -> tuple[str, ...]:
        """Return the names of all runs whose simulation diverges."""
        return (*self.training.diverged, *self.validation.diverged)

    def relative_deviation(self, fit: "Baseline") -> dict[str, float]:
        """Return the relative error of each coefficient where the truth is known, else its difference from the fit."""
        if fit.error:
            return self.error
        return {n: value / fit.values[n] - 1.0 for n, value in self.values.items() if fit.values.get(n)}


# The current that a fit estimated for the session of a run.

CURRENT_NORTH, CURRENT_EAST = "current_north", "current_east"
"""Parameters of a session: velocity of the water towards north and east, m/s."""


@dataclass(frozen=True)
class EstimatedCurrent:
    """Velocity of the water over ground towards north and east with standard errors, m/s."""

    north: float
    east: float
    north_error: float = 0.0
    east_error: float = 0.0

    @property
    def speed(self) -> float:
        """The current's speed, m/s."""
        return math.hypot(self.north, self.east)


def estimated_current(p: Prediction, offsets: Sequence[Offset]) -> EstimatedCurrent | None:
    """Return the current of a run's session; None where none was estimated, as of a session that was not fitted.

    offsets: of the fit.
    """
    north, east = (_of_session(p, offsets, name) for name in (CURRENT_NORTH, CURRENT_EAST))
    if north is None or east is None:
        return None
    return EstimatedCurrent(north.estimate, east.estimate, north.standard_error or 0.0, east.standard_error or 0.0)


def _of_session(p: Prediction, offsets: Sequence[Offset], name: str) -> Offset | None:
    return next((o for o in offsets if o.name == name and o.group == p.session), None)
