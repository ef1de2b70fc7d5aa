"""What logs of a session were found to be off by: a zero, gain or delay of an input, or a parameter of that session."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from seatrial.core.results.coefficients import Offset, OffsetPopulation
from seatrial.core.text.numbers import significant
from seatrial.core.values import InputError, display_unit, spelling_hint

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
