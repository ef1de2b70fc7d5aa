"""What the records can tell of a model and what they cannot, in numbers and in words. Plain values only."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Symmetry:
    """A change of parameters that no record of the compared outputs can show, whatever the manoeuvre.

    Attributes:
        parameters: those involved, free and fixed.
        text: in words, with what to fix.
        change: parameter -> relative change for a unit step (absolute where the value is zero).
    """

    parameters: tuple[str, ...]
    text: str
    change: dict[str, float]


@dataclass(frozen=True)
class Direction:
    """One eigen-direction of the Fisher information, weakest first.

    Attributes:
        combination: parameter -> component of a unit vector in relative changes, largest first.
        standard_deviation: of the relative change along it (1: 100 %).
        text: in words.
    """

    combination: dict[str, float]
    standard_deviation: float
    text: str


@dataclass(frozen=True)
class Collinearity:
    """How far one coefficient can be taken for others: variance inflation factor, and the most correlated partner."""

    parameter: str
    variance_inflation: float
    partner: str
    correlation: float


@dataclass(frozen=True)
class Sensitivity:
    """What a coefficient does: rms change of the compared outputs for a change of 10 %, in units of their noise.

    Attributes:
        effect: over all outputs together.
        outputs: output -> its own.
    """

    parameter: str
    effect: float
    outputs: dict[str, float]


@dataclass(frozen=True)
class Consequence:
    """What a wrong fixed value would do.

    Attributes:
        parameter: the fixed one; change: relative.
        moves: free coefficient -> relative change of its estimate, largest first.
        misfit: increase of the sum of squares (chi squared) by which the records would show it.
        text: in words.
    """

    parameter: str
    change: float
    estimate_changes: dict[str, float]
    misfit: float
    text: str


@dataclass(frozen=True)
class Stability:
    """Course stability on a straight course: index C (positive: stable) with its 95 % interval."""

    index: float
    lower: float
    upper: float
    text: str


@dataclass(frozen=True)
class Profile:
    """Profile likelihood of one coefficient: the others are fitted again at each value.

    Attributes:
        values: SI; costs: twice the loss above its minimum, chi squared with one degree of freedom.
        lower, upper: where the cost passes 3.84 (95 %), None where it does not within the values.
    """

    parameter: str
    values: tuple[float, ...]
    costs: tuple[float, ...]
    lower: float | None
    upper: float | None


@dataclass(frozen=True)
class Identifiability:
    """Everything together.

    Attributes:
        effective_parameters: number of parameters the data determine, trace of information over information with prior.
        condition: of the information matrix scaled to unit diagonal.
    """

    structural: tuple[Symmetry, ...]
    directions: tuple[Direction, ...]
    effective_parameters: float
    condition: float
    collinearity: tuple[Collinearity, ...] = ()
    sensitivities: tuple[Sensitivity, ...] = ()
    consequences: tuple[Consequence, ...] = ()
    stability: Stability | None = None
    profiles: tuple[Profile, ...] = ()
