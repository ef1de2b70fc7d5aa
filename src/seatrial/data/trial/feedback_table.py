"""The controller that was on while runs were recorded: table `[feedback]` of a trial file, a value in Python."""

import fnmatch
from collections.abc import Sequence
from typing import Annotated, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator
from pydantic.dataclasses import dataclass

from seatrial.core.values import NOTATION, Array, InputError, Record, si_unit
from seatrial.data.trial.amounts import STRICT_FIELDS, Amount, raises_input_error

RATE_OF = {"psi": "r", "phi": "p", "theta": "theta_dot"}
"""Channel that a controller holds -> the channel of its rate."""

# relative difference of two sample times that are one; chosen: clocks of loggers
_SAMPLE_TOLERANCE = 0.01


def _as_patterns(value: object) -> object:
    return (value,) if isinstance(value, str) else value


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class ControllerGains:
    """`[feedback.controller]`: gain (reference - output) - rate_gain (rate of the output) + integral_gain (integral).

    Attributes:
        gain: input over output, SI; rate_gain: the same times s; integral_gain: the same over s.
        sample_s: time between two orders [s].
    """

    gain: float
    rate_gain: float = 0.0
    integral_gain: float = 0.0
    sample_s: Annotated[float, Field(gt=0)]

    def order(self, error: Array, rate: Array) -> Array:
        """Return what the controller orders without limits, SI; error (rows,) of the output, its rate (rows,)."""
        integral = (error.cumsum() - 0.5 * (error[0] + error)) * self.sample_s  # trapezoids
        return self.gain * error - self.rate_gain * rate + self.integral_gain * integral


@raises_input_error
@dataclass(frozen=True, kw_only=True, config=STRICT_FIELDS)
class Feedback:
    """`[feedback]`: which input a controller worked, and what is known of it.

    Attributes:
        input: the input that it worked; output: the channel that it held.
        reference: the channel with what was ordered, or a constant, SI without a unit; None: not known.
        controller: its gains; None: not known.
        runs: patterns of the names of the runs in which it was on.
    """

    input: str
    output: str
    reference: str | Annotated[float, Field(strict=True)] | Amount | None = None
    controller: ControllerGains | None = None
    runs: Annotated[tuple[str, ...], BeforeValidator(_as_patterns), Field(min_length=1)] = ("*",)

    @model_validator(mode="after")
    def _constant_is_one_of_the_output(self) -> Self:
        unit = self.reference.unit if isinstance(self.reference, Amount) else None
        if unit is not None and self.output in NOTATION and si_unit(unit)[1] != NOTATION[self.output].unit:
            raise ValueError(f"reference: '{unit}' is no unit of '{self.output}'; write {NOTATION[self.output].unit}")
        return self

    @model_validator(mode="after")
    def _controller_is_complete(self) -> Self:
        if self.controller is not None and self.reference is None:
            raise ValueError(
                "a controller without a reference orders nothing that can be compared; add the reference, a channel or "
                "a constant, or leave the controller out"
            )
        if self.controller is not None and self.controller.rate_gain and self.output not in RATE_OF:
            raise ValueError(f"controller.rate_gain: no channel is the rate of '{self.output}'; leave it out")
        return self

    @property
    def constant(self) -> float | None:
        """Return the constant that was ordered, SI; None where it was none."""
        if isinstance(self.reference, Amount):
            return self.reference.in_si
        return None if isinstance(self.reference, str) else self.reference

    def concerns(self, record: Record) -> bool:
        """Return whether the controller was on in this run."""
        return any(fnmatch.fnmatchcase(record.name, pattern) for pattern in self.runs)

    def reference_of(self, record: Record) -> Array | None:
        """Return what was ordered, (rows,), SI; None where that is not known, or the controller was off."""
        if self.reference is None or not self.concerns(record):
            return None
        return record[self.reference] if isinstance(self.reference, str) else np.full(len(record), self.constant)

    def order_of(self, record: Record) -> Array | None:
        """Return what the controller orders in this run, (rows,), SI; None where it or its reference is not known."""
        reference = self.reference_of(record)
        if reference is None or self.controller is None:
            return None
        output, rate = record[self.output], RATE_OF.get(self.output, "")
        error = reference - output
        if record.channel(self.output).unit == "rad":  # both are unwrapped, each from its own first sample
            error = error - 2.0 * np.pi * np.round(np.median(error) / (2.0 * np.pi))
        return self.controller.order(error, record[rate] if rate in record else 0.0 * output)


def refuse_unusable_feedback(feedback: Feedback, records: Sequence[Record], where: str = "") -> None:
    """Refuse a declaration that the records do not allow.

    where: what the sentence begins with, such as the trial file.

    Raises:
        InputError: no run matches, a channel is missing in one, or the controller's sample time is not that of a run.
    """
    concerned = [record for record in records if feedback.concerns(record)]
    if not concerned:
        names = ", ".join(f"'{r.name}'" for r in records)
        raise InputError(f"{where}feedback.runs matches no training run; those are {names}")
    for record in concerned:
        for key, channel in _required_channels(feedback).items():
            if channel not in record:
                edit = f"add {channel} under [records.channels]"
                if key == "reference":
                    edit += ', or give a constant, reference = { value = 0, unit = "deg" }'
                raise InputError(f"{where}feedback.{key}: record '{record.name}' has no channel '{channel}'; {edit}")
        gains = feedback.controller
        if gains is not None and abs(gains.sample_s - record.dt) > _SAMPLE_TOLERANCE * record.dt:
            raise InputError(
                f"{where}feedback.controller.sample_s is {gains.sample_s:g} s, but record '{record.name}' has a sample "
                f"every {record.dt:g} s; write rate = {1.0 / gains.sample_s:.6g} under [estimate], or correct sample_s"
            )


def _required_channels(feedback: Feedback) -> dict[str, str]:
    """Key of the table -> channel that each run must hold."""
    channels = {"input": feedback.input, "output": feedback.output}
    if isinstance(feedback.reference, str):
        channels["reference"] = feedback.reference
    if feedback.controller is not None and feedback.controller.rate_gain and feedback.output in RATE_OF:
        channels["controller.rate_gain"] = RATE_OF[feedback.output]
    return channels
