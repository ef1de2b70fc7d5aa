"""Craft models from the columns of table 2, as printed or corrected; their simulation; the misprinted equations."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import sympy as sp

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.example_series import simulate_run
from seatrial.physics.models import waterjet
from seatrial.physics.simulate import initial_state, inputs_of, record_of, trajectory
from seatrial_studies.song2025.published import (
    MISPRINTED_SIGNS,
    SOURCE,
    PublishedManoeuvre,
    Table2Column,
    printed_coefficients,
)

FINISHED = "finished"


@dataclass(frozen=True)
class CoefficientSet:
    """A column of table 2 with the signs of the coefficients `sign_corrected` changed."""

    column: Table2Column
    sign_corrected: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Return the name of the column in tables and figures."""
        return (
            f"{self.column}, {' and '.join(self.sign_corrected)} turned"
            if self.sign_corrected
            else f"{self.column}, as printed"
        )

    def craft(self) -> Model:
        """Return the waterjet craft with these coefficients."""
        values = printed_coefficients(self.column)
        turned = {name: -values[name] for name in self.sign_corrected}
        return waterjet().with_values(values | turned, source=f"{SOURCE}, table 2, {self.title}")


CORRECTED = tuple(CoefficientSet(which, MISPRINTED_SIGNS[which]) for which in Table2Column)
PRINTED = tuple(CoefficientSet(which) for which in Table2Column)
TRUTH = CORRECTED[0]


@dataclass(frozen=True, eq=False)
class ManoeuvreRun:
    """A manoeuvre steered with the helmsman in the loop, or why there is none.

    Attributes:
        record: 10 Hz, from 10 s before the first execute; None where the simulation diverges.
        is_completed: whether the helmsman came to the end of the programme.
        ending: in words.
    """

    record: Record | None
    is_completed: bool
    ending: str


def simulate_manoeuvre(craft: Model, text: str) -> ManoeuvreRun:
    """Simulate one manoeuvre, given by the text of its programme."""
    try:
        record = simulate_run(craft, text)
    except InputError as error:
        return ManoeuvreRun(None, False, str(error))
    ending = next(step for step in record.provenance.steps if FINISHED in step)
    return ManoeuvreRun(record, ending.startswith(FINISHED), ending)


@cache
def reference_record(run: PublishedManoeuvre) -> Record:
    """Return the truth's run: CFD column, N_v corrected, helmsman in the loop, 10 Hz."""
    return manoeuvre_record(TRUTH.craft(), run)


def manoeuvre_record(craft: Model, text: str) -> Record:
    """Return the record of a simulated manoeuvre.

    Raises:
        InputError: the simulation diverges.
    """
    run = simulate_manoeuvre(craft, text)
    if run.record is None:
        raise InputError(run.ending)
    return run.record


def replay_inputs(craft: Model, record: Record) -> Record:
    """Replay the record's inputs through `craft`, up to where the simulation diverges (all of it as a rule)."""
    inputs = inputs_of(craft, record)
    states, outputs = trajectory(craft, inputs, record.dt, initial_state(craft, record, {}))
    is_finite = np.all(np.isfinite(states), axis=1)
    last = len(is_finite) if is_finite.all() else int(np.argmin(is_finite))
    return record_of(craft, record.name, record.time[:last], states[:last], outputs[:last], inputs[:last])


def drift_angle(record: Record) -> Array:
    """Return the drift angle atan2(-v, u) along a record, deg, (n,); positive: bow to starboard of the course."""
    return np.degrees(np.arctan2(-record["v"], record["u"]))


def with_expressions(craft: Model, name: str, expressions: Mapping[str, sp.Expr]) -> Model:
    """Return a model of another name in which some bindings have other expressions, their symbols being `symbol`s."""
    bindings = tuple(b.bound_to(expressions[b.name]) if b.name in expressions else b for b in craft.bindings)
    return replace(craft, equations=replace(craft.equations, name=name, bindings=bindings))


def symbol(name: str) -> sp.Symbol:
    """Return the symbol of a state, input, parameter or binding."""
    return sp.Symbol(name, real=True)
