"""What a fit says of inputs that followed outputs while its records were made."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import Number
from seatrial.core.text.numbers import p_value, significant
from seatrial.core.text.words import enumeration

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
