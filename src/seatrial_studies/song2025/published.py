"""What Song et al. 2025 print, and the craft simulated from the columns of their table 2."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache

import numpy as np
import sympy as sp

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.data.example_series import simulate_run
from seatrial.physics.models import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models import waterjet
from seatrial.physics.simulate import initial_state, inputs_of, record_of, trajectory
from seatrial_studies.study_file import Declared, read_study

# What Song et al. 2025 print: tables 1 to 4, what they say of them, and what they leave open.

SOURCE = read_study("song2025").source


class Table2Column(StrEnum):
    """The columns of table 2."""

    CFD = "CFD"
    ORIGINAL = "original SVR"
    IMPROVED = "improved SVR"


class MotionEquation(StrEnum):
    """The equations of motion, by the state whose rate they give."""

    SURGE = "u"
    SWAY = "v"
    YAW = "r"


class PublishedManoeuvre(StrEnum):
    """The manoeuvres of figures 4, 7, 9 and table 4, as programmes."""

    CONSECUTIVE = "consecutive-zigzags:5"
    ZIGZAG_20 = "zigzag:20/20"
    ZIGZAG_35 = "zigzag:35/35"
    TURN_35 = "turning-circle:35"


@dataclass(frozen=True)
class Accuracy:
    """Root mean square errors [m/s, m/s, rad/s] and correlation coefficients of u, v, r, by channel."""

    rmse: dict[str, float]
    cc: dict[str, float]


class PublishedTables(Declared):
    """What the study file quotes: table 1 and section 1.2, what the text says of coefficients, tables 2 to 4."""

    length: float
    beam: float
    block: float
    draught: float
    mass: float
    approach_speed: float
    dropped: tuple[str, ...]
    called_sensitive: tuple[str, ...]
    called_insensitive: tuple[str, ...]
    table_2: dict[Table2Column, tuple[str, ...]]
    table_3: dict[MotionEquation, float]
    table_4: dict[PublishedManoeuvre, Accuracy]


PUBLISHED = PublishedTables.model_validate(read_study("song2025").published)
LENGTH, BEAM, BLOCK, DRAUGHT, MASS = (
    PUBLISHED.length, PUBLISHED.beam, PUBLISHED.block, PUBLISHED.draught, PUBLISHED.mass
)  # fmt: skip
APPROACH_SPEED = PUBLISHED.approach_speed
TABLE_2, TABLE_3, TABLE_4 = PUBLISHED.table_2, PUBLISHED.table_3, PUBLISHED.table_4
CALLED_SENSITIVE, CALLED_INSENSITIVE = PUBLISHED.called_sensitive, PUBLISHED.called_insensitive
DROPPED_COEFFICIENTS = PUBLISHED.dropped

# signs of table 2 that cannot be meant
MISPRINTED_SIGNS = {Table2Column.CFD: ("N_v",), Table2Column.ORIGINAL: ("N_v",), Table2Column.IMPROVED: ("N_v", "Y_vv")}


def printed_coefficients(column: Table2Column) -> dict[str, float]:
    """Return a column of table 2 as printed, by coefficient in the order of `COEFFICIENTS`."""
    return dict(zip(COEFFICIENTS, map(float, TABLE_2[column]), strict=True))


# Craft models from the columns of table 2, as printed or corrected; their simulation; the misprinted equations.

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
