"""Runs simulated open loop and compared with their measurement, and what their intervals are made of."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import ListedArray, Number, StoredArray, StoredRecord


@dataclass(frozen=True)
class Measure:
    """One manoeuvring measure, measured against simulated."""

    measured: Annotated[Number | None, Field(description="null: the record does not show it")]
    simulated: Annotated[Number | None, Field(description="null: the simulation does not show it")]
    lower: Annotated[
        Number | None, Field(description="95 % interval of the simulated value; null until a method defends it")
    ] = None
    upper: Annotated[Number | None, Field(description="as `lower`")] = None


@dataclass(frozen=True)
class Extrapolation:
    """How far a prediction leaves the training runs."""

    index: Annotated[Number, Field(description="largest of the ratios; up to 1 is interpolation")]
    ratios: Annotated[
        dict[str, Number],
        Field(description="yaw_rate, drift, rudder, speed of the run over those of the training runs"),
    ]


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
        Field(description="psi, x0, y0 -> half width of its 95 % band at every sample, shape (n,), SI"),
    ] = field(default_factory=dict)
    noise_floor: Annotated[
        dict[str, Number],
        Field(description="rms errors, keys as in `rms`, that process noise alone leaves with a perfect model"),
    ] = field(default_factory=dict)
    tied_spread: Annotated[
        dict[str, Number], Field(description="standard deviation over tied models, keys as in `measures` and `rms`")
    ] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class IntervalBasis:
    """What intervals of any further prediction of a fit are made of; kept in model.toml.

    Attributes:
        covariance: of the free coefficients, without the spread of tied models, shape (n, n).
        degrees_of_freedom: of Student's t.
        factor: multiplies a predicted standard deviation where no training run shows that kind of measure.
        measure_deviation: kind of measure -> standard deviation that is added, in its unit.
        offsets: offset (``delta zero``) -> standard deviation between sessions, SI.
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
