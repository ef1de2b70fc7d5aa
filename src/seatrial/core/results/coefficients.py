"""What a fit says of parameters, noise, session offsets and inputs that followed outputs, and how it was estimated."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field, PlainSerializer, WithJsonSchema

from seatrial.core.results.fields import ABSENT, Number, StoredArray
from seatrial.core.text.numbers import p_value, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import NOT_MEASURED, InputError, display_unit, spelling_hint
from seatrial.core.values.notation import channel_unit

# What a fit says of inputs that followed outputs while its records were made.

# digits of numbers in sentences; standard errors beyond which a distance says no more than that it is large; chosen
_DIGITS, _FAR = 2, 100.0


@dataclass(frozen=True)
class WithoutDisturbance:
    """A coefficient fitted without a disturbance, as output error would fit it, next to the one with."""

    name: str
    estimate: Annotated[Number, Field(description="SI")]
    standard_error: Annotated[Number, Field(description="SI")]
    normalised_difference: Annotated[
        Number, Field(description="this estimate less the one with a disturbance, in standard errors of the latter")
    ]
    standard_error_ratio: Annotated[Number, Field(description="standard error with a disturbance over this one")]


@dataclass(frozen=True)
class FeedbackEvidence:
    """An input that followed an output: the evidence, what is declared of the controller, and what the loop costs."""

    input: str
    output: str
    runs: Annotated[tuple[str, ...], Field(description="names of the training runs in which it did")]
    correlation: Annotated[
        Number | None, Field(description="cross-correlation in the clearest run; null: declared, and no test shows it")
    ] = None
    lag: Annotated[
        Number | None, Field(description="s by which the output precedes the input there; null as above")
    ] = None
    p: Annotated[Number | None, Field(description="that chance gives such correlations; null as above")] = None
    is_declared: Annotated[bool, Field(description="whether the trial declares it under [feedback]")] = False
    reference: Annotated[
        str, Field(description="channel with what was ordered, or a constant, SI; empty: not declared")
    ] = ""
    reference_steps: Annotated[
        int | None, Field(description="how often the reference changes, in all runs; null: not declared")
    ] = None
    reference_p: Annotated[
        Number | None,
        Field(
            description="p-value that innovations do not depend on earlier changes of the reference; null: not tested"
        ),
    ] = None
    controller_correlation: Annotated[
        Number | None, Field(description="between the declared controller's orders and the input; null: not declared")
    ] = None
    controller_delay: Annotated[
        Number | None, Field(description="s by which the input follows these orders; null as above")
    ] = None
    without_disturbance: Annotated[
        tuple[WithoutDisturbance, ...],
        Field(description="the free coefficients fitted without a disturbance; empty: not compared"),
    ] = ()

    @property
    def sentences(self) -> tuple[str, ...]:
        """Return what is known of the loop and what it costs, a sentence each."""
        return tuple(self._sentences())

    def _sentences(self) -> Iterator[str]:
        where = enumeration(self.runs)
        evidence = "as [feedback] declares" if self.is_declared else ""
        if self.correlation is not None and self.lag is not None and self.p is not None:
            test = (
                f"cross-correlation {significant(self.correlation, _DIGITS)}, "
                f"output {significant(self.lag, _DIGITS)} s ahead, {p_value(self.p)}"
            )
            evidence = f"{evidence}; {test}" if evidence else test
        yield f"closed loop: '{self.input}' follows '{self.output}' in {where} ({evidence})"
        if self.without_disturbance:
            yield self._cost
        if self.reference_p is not None:
            verb = "do not depend" if self.reference_p >= REFERENCE_LEVEL else "depend"
            p = p_value(self.reference_p)
            yield f"the innovations {verb} on earlier changes of the reference {self.reference} ({p})"
        if self.controller_correlation is not None and self.controller_delay is not None:
            yield (
                "the declared controller adds nothing to the likelihood, because its orders depend on the craft "
                f"through predicted outputs alone; they agree with '{self.input}' to a correlation of "
                f"{significant(self.controller_correlation, _DIGITS)} at a delay of "
                f"{significant(self.controller_delay, _DIGITS)} s"
            )

    @property
    def _cost(self) -> str:
        worst = max(self.without_disturbance, key=lambda c: abs(c.normalised_difference))
        away, ratio = abs(worst.normalised_difference), worst.standard_error_ratio
        distance = f"more than {_FAR:g}" if away > _FAR else significant(away, _DIGITS)
        text = f"output error without a disturbance would put {worst.name} {distance} standard errors away"
        return (
            f"{text}, with a standard error {significant(1.0 / ratio, _DIGITS)} times as large" if away < _FAR else text
        )


REFERENCE_LEVEL = 0.01
"""p-value below which innovations depend on the reference; chosen: one false alarm in a hundred fits."""


# What a fit says of each parameter and of the noise, how it was estimated, and which models it was compared with.

_ANGLE = "rad"  # unit of parameters that say where something rests or reads zero, not the strength of an effect


def _absent_unless_given(value: float | None) -> object:
    return ABSENT if value is None else value


@dataclass(frozen=True)
class Coefficient:
    """One parameter of the model after the fit, SI units; the interval is at 95 %."""

    name: str
    unit: Annotated[str, Field(description="SI; 1 for a number, in the prime system of the model's source")]
    estimate: Number
    standard_error: Annotated[
        Number | None, Field(description="null for a fixed parameter, and where the method gives no interval")
    ]
    lower: Annotated[Number | None, Field(description="null as `standard_error`")]
    upper: Annotated[Number | None, Field(description="null as `standard_error`")]
    fixed: Annotated[bool, Field(description="whether it was held at its value")]
    truth: Annotated[
        float | None,
        PlainSerializer(_absent_unless_given),
        WithJsonSchema({"type": "number"}),
        Field(description="true value where the records are simulated; else absent"),
    ] = None
    prior_mean: Annotated[float | None, Field(description="null without a prior")] = None
    prior_standard_deviation: Annotated[float | None, Field(description="null without a prior")] = None
    source: Annotated[str, Field(description="where a fixed value or a prior comes from")] = ""
    meaning: Annotated[str, Field(description="one phrase, as the model gives it")] = ""
    latex: Annotated[str, Field(description="symbol in LaTeX, as the model gives it")] = ""

    @property
    def is_unmeasured(self) -> bool:
        """Whether it was held at a value that a rule gives, and no measurement of the craft."""
        return self.fixed and self.source.startswith(NOT_MEASURED)

    @property
    def is_level(self) -> bool:
        """Whether 0 is a value like another, as of an angle: where a ship comes to rest, where a rudder reads zero."""
        return self.unit == _ANGLE

    @property
    def is_sign_open(self) -> bool:
        """Whether its interval contains 0, so that the records do not determine it by itself.

        An interval may be open at an end, where a profile of the likelihood has not ended. A level has none to show.
        """
        if self.standard_error is None or self.is_level:
            return False
        return (self.lower is None or self.lower < 0.0) and (self.upper is None or self.upper > 0.0)


@dataclass(frozen=True)
class Offset:
    """One nuisance parameter of a run or session."""

    name: Annotated[str, Field(description="channel and kind, such as delta zero")]
    group: Annotated[str, Field(description="run or session it belongs to")]
    unit: Annotated[str, Field(description="SI")]
    estimate: Number
    standard_error: Number | None


@dataclass(frozen=True)
class OffsetPopulation:
    """What an offset is over sessions: a new session is predicted with the mean, and its band holds the rest."""

    name: Annotated[str, Field(description="channel and kind, such as delta zero")]
    unit: Annotated[str, Field(description="SI")]
    mean: Annotated[Number, Field(description="expected of a session whose covariate is the average one")]
    standard_error: Annotated[Number, Field(description="of the mean; 0: it is declared, as of a current")]
    deviation: Annotated[Number, Field(description="standard deviation between sessions")]
    covariate: Annotated[str, Field(description="input on whose rms over a session the mean depends; empty: none")] = ""
    slope: Annotated[
        Number | None,
        Field(description="change of the mean for a covariate one standard deviation above the average; null: none"),
    ] = None
    slope_standard_error: Annotated[Number | None, Field(description="null as `slope`")] = None


NO_INTERVALS = "none: the method gives none"
"""What is said of the intervals of a published method."""


@dataclass(frozen=True)
class Method:
    """What was used and why, in sentences a report prints."""

    criterion: Annotated[str, Field(description="criterion of the estimate")]
    start: Annotated[str, Field(description="where the search started")]
    intervals: Annotated[str, Field(description="method of the intervals")]
    reasons: Annotated[tuple[str, ...], Field(description="why these")] = ()
    settings: Annotated[dict[str, int | float | str], Field(description="name -> value used")] = field(
        default_factory=dict
    )
    name: Annotated[str, Field(description="as in `[estimate] method`")] = "auto"

    @property
    def gives_intervals(self) -> bool:
        """Whether the coefficients have intervals."""
        return not self.intervals.startswith(NO_INTERVALS)


@dataclass(frozen=True)
class CandidateModel:
    """One model of the declared family, scored over complete runs left out."""

    name: Annotated[str, Field(description="structure, prior and segment length")]
    free_count: Annotated[int, Field(description="number of free coefficients")]
    heading_deg: Annotated[
        Number | None, Field(description="rms over windows of the runs left out, degrees; null: failed or no heading")
    ]
    position_m: Annotated[Number | None, Field(description="the same of the position, m")]
    is_tied: Annotated[bool, Field(description="not distinguishable from the best one by these runs")]
    is_chosen: bool = False
    note: Annotated[str, Field(description="why it failed; empty where it did not")] = ""
    roll_deg: Annotated[
        Number | None,
        Field(description="rms over complete runs left out, degrees; null: no ship that rolls about rest"),
    ] = None
    gain_percent: Annotated[
        Number | None,
        Field(
            description="by which the error on the runs left out (mean of heading and position, each in units of the "
            "family's mean) is less than that of the member it extends; null: the first, or failed"
        ),
    ] = None


STORED_LEVEL = 0.95
"""Probability of the interval that a coefficient carries, 1."""


def at_level(coefficient: Coefficient, level: float, degrees_of_freedom: float) -> tuple[float, float]:
    """Return the ends of a coefficient's interval at a probability; NaN where an end is not known.

    Each side of the 95 % interval is scaled by the ratio of the two-sided quantiles of Student's t.

    Raises:
        InputError: `level` is not between 0 and 1.
    """
    if not 0.0 < level < 1.0:
        raise InputError(f"the level {level:g} of an interval is not between 0 and 1; give a probability such as 0.95")
    value = coefficient.estimate
    lower, upper = (float("nan") if end is None else end for end in (coefficient.lower, coefficient.upper))
    if level == STORED_LEVEL:
        return lower, upper
    factor = two_sided_quantile(level, degrees_of_freedom) / two_sided_quantile(STORED_LEVEL, degrees_of_freedom)
    return value - factor * (value - lower), value + factor * (upper - value)


def two_sided_quantile(level: float, degrees_of_freedom: float) -> float:
    """Return the half width in standard errors of an interval that holds the value with this probability."""
    from scipy.special import ndtri, stdtrit  # here, as `check` imports this module and has no use for them

    probability = 0.5 * (1.0 + level)
    return float(ndtri(probability) if degrees_of_freedom == float("inf") else stdtrit(degrees_of_freedom, probability))


@dataclass(frozen=True)
class Noise:
    """Estimated noise of one channel and the colour of its residuals."""

    channel: str
    unit: Annotated[str, Field(description="SI")]
    standard_deviation: Annotated[Number, Field(description="in `unit`")]
    correlation_time: Annotated[Number, Field(description="s, integral scale of the residuals' autocorrelation")]
    whiteness_p: Annotated[
        Number,
        Field(
            description="twice the smaller p-value of two portmanteau tests (Ljung & Box 1978; 20 and 100 lags) that "
            "the residuals are white, at most 1"
        ),
    ]
    is_white: Annotated[bool, Field(description="whether the channel passes the test")]


@dataclass(frozen=True)
class DisturbanceCandidate:
    """One model of what disturbs the ship, fitted with the coefficients to the same records."""

    name: Annotated[str, Field(description="kind of disturbance and the states it acts on")]
    log_likelihood: Annotated[
        Number,
        Field(
            description="at its optimum, or near it where it cannot be the likeliest, up to a constant that all share"
        ),
    ]
    degrees_of_freedom: Annotated[int, Field(description="unknowns that describe the disturbance")]
    likelihood_ratio: Annotated[Number, Field(description="twice the log-likelihood above that of the first candidate")]
    critical_ratio: Annotated[Number, Field(description="what chance alone gives once in a thousand cases")]
    whiteness_p: Annotated[
        Number, Field(description="smallest p-value over the channels, times their number, that innovations are white")
    ]
    is_white: Annotated[bool, Field(description="whether the innovations pass the test")]
    parameters: Annotated[
        dict[str, Number], Field(description="memories [s], peak frequency of waves [rad/s] and its damping")
    ]
    left_out_error: Annotated[
        Number | None,
        Field(
            description="geometric mean of the errors on runs, or quarters of few, each simulated by the estimate "
            "without it, over that of the best criterion; null: not judged"
        ),
    ]
    is_chosen: Annotated[bool, Field(description="whether it is behind the estimate")]


@dataclass(frozen=True)
class Waves:
    """Waves at one peak, as instruments show them on top of the craft's own motion."""

    frequency: Annotated[Number, Field(description="of encounter, rad/s")]
    damping: Annotated[Number, Field(description="relative, of the narrow band")]
    rms: Annotated[dict[str, Number], Field(description="channel -> standard deviation that they add to it, SI")]

    @property
    def period(self) -> float:
        """Period of encounter [s]."""
        return 2.0 * math.pi / self.frequency

    @property
    def sentence(self) -> str:
        """Return period and sizes in words."""
        sizes = enumeration([_size_text(channel, size) for channel, size in self.rms.items()])
        return f"Waves of {significant(self.period, 2)} s move the instruments by {sizes} rms."


def _size_text(channel: str, size: float) -> str:
    factor, unit = display_unit(channel_unit(channel))
    return f"{significant(size * factor, 2)} {unit} ({channel})"


@dataclass(frozen=True)
class NoiseModel:
    """Process noise in the states and measurement noise in the channels, as the criterion of the fit allows for."""

    method: Annotated[str, Field(description="output error or prediction error, the criterion of the fit")]
    whiteness_p: Annotated[
        Number,
        Field(
            description="smallest p-value over the channels, times their number, that the residuals (innovations) are "
            "white"
        ),
    ]
    process: Annotated[
        dict[str, Number],
        Field(description="state -> intensity, SI unit of the state over the root of a second; 0: none needed"),
    ]
    measurement: Annotated[dict[str, Number], Field(description="channel -> standard deviation, SI")]
    text: Annotated[str, Field(description="why this criterion")] = ""
    is_white: Annotated[bool, Field(description="whether all channels pass the test of whiteness")] = False
    disturbance: Annotated[str, Field(description="kind of disturbance that the criterion allows for")] = "none"
    added: Annotated[
        dict[str, Number],
        Field(description="its parameters: memories [s], peak frequency of waves [rad/s] and its damping"),
    ] = field(default_factory=dict)
    candidates: Annotated[
        tuple[DisturbanceCandidate, ...], Field(description="disturbances that were compared; empty: none were needed")
    ] = ()
    closed_loop: Annotated[
        FeedbackEvidence | None,
        Field(description="a controller that was on in training runs; null: no input follows outputs"),
    ] = None
    waves: Annotated[tuple[Waves, ...], Field(description="first-order motion on the sensors; empty: none")] = ()
    wave_cost: Annotated[
        Number | None,
        Field(description="median over the coefficients of standard error over that without waves; null: no waves"),
    ] = None

    @property
    def wave_sentences(self) -> list[str]:
        """Return what waves the log shows, and what they cost."""
        if not self.waves:
            return []
        cost = [] if self.wave_cost is None else [
            f"Without them the standard errors would be {significant(1.0 / self.wave_cost, 2)} times as large (median)."
        ]  # fmt: skip
        return [*(w.sentence for w in self.waves), *cost]


@dataclass(frozen=True, eq=False)
class Residuals:
    """Residuals of one channel of the training runs, in order, for whiteness plots."""

    channel: str
    rate: Annotated[float, Field(description="Hz")]
    values: Annotated[StoredArray, Field(description="shape (n,), SI; runs one after another")]
    autocorrelation: Annotated[
        StoredArray, Field(description="shape (k,), lags 0, 1, ... at `rate`, averaged over segments")
    ]


# What logs of a session were found to be off by: a zero, gain or delay of an input, or a parameter of that session.

KINDS = ("zero", "gain", "delay")
"""Corrections of an input: added to the logged value, multiplied with it, and time by which it acts later [s]."""
NEW_SESSION = "new"
"""Stands for a session of which nothing was fitted."""


@dataclass(frozen=True)
class SessionOffset:
    """One kind of offset: its value in each session that was fitted, and what another session is expected to have.

    Attributes:
        name: input and kind of correction (``delta zero``), or a parameter that each session has of its own.
        unit: of SI.
        expected: of a session that was not fitted.
        by_session: session -> estimate.
    """

    name: str
    unit: str
    expected: float
    by_session: Mapping[str, float] = field(default_factory=dict)

    @property
    def is_of_input(self) -> bool:
        """Whether it corrects a logged input; else it is a parameter, such as a current."""
        return self.correction[1] in KINDS

    @property
    def correction(self) -> tuple[str, str]:
        """The input and the kind of its correction; the name and nothing for a parameter."""
        symbol, _, kind = self.name.partition(" ")
        return symbol, kind

    def value_in(self, session: str | None) -> float:
        """Return the value in a session; where none is stated, of the only one there is, or as expected of another.

        Raises:
            InputError: no session of that name was fitted.
        """
        if session is None:
            return next(iter(self.by_session.values())) if len(self.by_session) == 1 else self.expected
        if session == NEW_SESSION and session not in self.by_session:
            return self.expected
        if session not in self.by_session:
            raise InputError(
                f"no session '{session}' was fitted{spelling_hint(session, list(self.by_session))}; state "
                f"'{NEW_SESSION}' for what is expected of another one"
            )
        return self.by_session[session]

    def text(self, session: str | None) -> str:
        """Return name, value and unit, angles in degrees: ``delta zero 2.4 deg``."""
        factor, unit = display_unit(self.unit)
        return f"{self.name} {significant(factor * self.value_in(session), 2)} {unit}".removesuffix(" 1")


def session_offsets_of(offsets: Sequence[Offset], populations: Sequence[OffsetPopulation]) -> tuple[SessionOffset, ...]:
    """Return the offsets of a fit, kind by kind."""
    return tuple(
        SessionOffset(
            population.name,
            population.unit,
            population.mean,
            {o.group: o.estimate for o in offsets if o.name == population.name},
        )
        for population in populations
    )


def fitted_session(offsets: Sequence[SessionOffset], session: str) -> str:
    """Return the session where it was fitted, or else what stands for a new one."""
    return session if any(session in offset.by_session for offset in offsets) else NEW_SESSION


def offsets_text(offsets: Sequence[SessionOffset], session: str | None) -> str:
    """Return the values of a session and which it is: ``delta zero 2.4 deg (session 'day 1')``.

    Raises:
        InputError: no session of that name was fitted.
    """
    fitted = list(offsets[0].by_session)
    name = fitted[0] if session is None and len(fitted) == 1 else session
    whose = f"session '{name}'" if name in fitted else "expected of a new session"
    return f"{', '.join(offset.text(session) for offset in offsets)} ({whose})"
