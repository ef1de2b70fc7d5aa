"""What the records identify of a model and what they do not, in numbers and in sentences."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number

NOT_CONVERGED, SIGN_OPEN = "not-converged", "sign-open"
"""Codes of the findings that coefficients must not be used, or some of them not alone."""
COURSE_UNSTABLE = "course-unstable"
"""Code of the finding that a craft does not hold a straight course by itself."""


@dataclass(frozen=True)
class Symmetry:
    """A change of parameters that no record of the compared outputs can show, whatever the manoeuvre."""

    parameters: Annotated[tuple[str, ...], Field(description="those involved, free and fixed")]
    text: Annotated[str, Field(description="in a sentence, with what to fix")]
    change: Annotated[
        dict[str, Number],
        Field(description="parameter -> relative change for a unit step; absolute where the value is zero"),
    ]


@dataclass(frozen=True)
class Direction:
    """One combination of free coefficients with an independent error (eigen-direction of the Fisher information)."""

    combination: Annotated[
        dict[str, Number], Field(description="parameter -> part of a unit vector of relative changes, largest first")
    ]
    standard_deviation: Annotated[
        Number, Field(description="of the relative change along it, 1: 100 %; null: no information at all")
    ]
    text: str


@dataclass(frozen=True)
class Collinearity:
    """How far one coefficient can be replaced by others, and by which most."""

    parameter: str
    variance_inflation: Annotated[Number, Field(description="factor; null: without limit")]
    partner: Annotated[str, Field(description="the most correlated other coefficient")]
    correlation: Annotated[Number, Field(description="with the partner, -1 to 1")]


@dataclass(frozen=True)
class Sensitivity:
    """Change of the compared outputs (rms, in units of their noise) for 10 % of a coefficient."""

    parameter: str
    effect: Annotated[Number, Field(description="over all outputs together")]
    outputs: Annotated[dict[str, Number], Field(description="output -> its own change")]


@dataclass(frozen=True)
class Consequence:
    """What a wrong assumed value would do to the estimates."""

    parameter: Annotated[str, Field(description="the fixed one")]
    change: Annotated[Number, Field(description="relative")]
    estimate_changes: Annotated[
        dict[str, Number], Field(description="free coefficient -> relative change of its estimate, largest first")
    ]
    misfit: Annotated[Number, Field(description="increase of chi squared by which the records would show it")]
    text: str


@dataclass(frozen=True)
class Stability:
    """Course stability on a straight course; intervals are at 95 %."""

    index: Annotated[Number, Field(description="stability index C, positive: stable")]
    lower: Number
    upper: Number
    text: str
    speed: Annotated[Number | None, Field(description="ahead, m/s; null: not stated")] = None
    growth_rate: Annotated[
        Number | None,
        Field(description="largest real part of the eigenvalues of sway and yaw, 1/s; positive: a deviation grows"),
    ] = None
    growth_lower: Annotated[Number | None, Field(description="end of its interval, 1/s")] = None
    growth_upper: Annotated[Number | None, Field(description="end of its interval, 1/s")] = None
    stable_below: Annotated[
        Number | None, Field(description="speed below which an unstable craft is stable, m/s; null: none in the runs")
    ] = None

    @property
    def is_unstable(self) -> bool:
        """Whether a deviation grows beyond doubt: the whole interval of its rate lies above zero, or C's below.

        C is the product of two rates, and the one that decides may be well known where the other is not.
        """
        return self.upper < 0.0 or (self.growth_lower is not None and self.growth_lower > 0.0)

    @property
    def is_stable(self) -> bool:
        """Whether a deviation dies out beyond doubt: the whole interval of its rate lies below zero."""
        return self.growth_upper is not None and self.growth_upper < 0.0


@dataclass(frozen=True)
class Profile:
    """Profile likelihood of one coefficient: the others are fitted again at each value."""

    parameter: str
    values: Annotated[tuple[Number, ...], Field(description="SI")]
    costs: Annotated[
        tuple[Number, ...],
        Field(description="twice the loss above its minimum: chi squared, one degree of freedom"),
    ]
    lower: Annotated[Number | None, Field(description="where the cost passes 3.84 (95 %); null: not within the values")]
    upper: Annotated[Number | None, Field(description="as `lower`")]


@dataclass(frozen=True)
class Identifiability:
    """What the records identify, together."""

    structural: Annotated[tuple[Symmetry, ...], Field(description="changes that no record can show")]
    directions: Annotated[tuple[Direction, ...], Field(description="weakest first")]
    effective_parameters: Annotated[
        Number,
        Field(description="number of coefficients that the data determine (trace of information over it with prior)"),
    ]
    condition: Annotated[
        Number, Field(description="condition number of the information scaled to unit diagonal; null: singular")
    ]
    collinearity: tuple[Collinearity, ...] = ()
    sensitivities: tuple[Sensitivity, ...] = ()
    consequences: tuple[Consequence, ...] = ()
    stability: Annotated[Stability | None, Field(description="null: not known")] = None
    profiles: tuple[Profile, ...] = ()
