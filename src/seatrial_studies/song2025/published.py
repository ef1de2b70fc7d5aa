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

# What Song et al. 2025 print: tables 1 to 4, what they say of them, and what they leave open.

SOURCE = (
    "Song Lifei, Wang Yuqing, Peng Wei, Li Peiyong, Liu Yushan, Zhang Yongfeng: Hydrodynamic coefficients "
    "identification of ship simplified modular model based on support vector regression (in Chinese), Chinese Journal "
    "of Ship Research 20(1), 2025, 65-75, doi 10.19693/j.issn.1673-3185.03832"
)


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


# table 1; lengths in m, mass in kg
LENGTH, BEAM, BLOCK, DRAUGHT, MASS = 9.8, 3.17, 0.251, 0.71, 5540.0

# section 1.2
APPROACH_SPEED = 0.8  # m/s

_TABLE_2 = {
    Table2Column.CFD: (
        -0.03125,
        0.04657,
        0.00414,
        -0.27670,
        0.08811,
        -1.00740,
        -0.16437,
        -0.07020,
        0.17080,
        -0.05240,
        -0.04350,
    ),
    Table2Column.ORIGINAL: (
        -0.0302,
        0.0693,
        0.0277,
        -0.0309,
        0.0920,
        -0.0860,
        -0.0151,
        -0.0973,
        0.1506,
        -0.0511,
        -0.0414,
    ),
    Table2Column.IMPROVED: (
        -0.0314,
        0.0470,
        0.0031,
        -0.2534,
        0.0861,
        0.6083,
        -0.0331,
        -0.0699,
        0.1701,
        -0.0521,
        -0.0430,
    ),
}

# condition numbers of the correlation matrices, as labelled
TABLE_3 = {MotionEquation.SWAY: 50.189, MotionEquation.SURGE: 7737.52, MotionEquation.YAW: 6352.2}

TABLE_4 = {
    PublishedManoeuvre.CONSECUTIVE: Accuracy(
        {"u": 0.0189, "v": 0.0090, "r": 0.0089}, {"u": 0.9890, "v": 0.9947, "r": 0.9955}
    ),
    PublishedManoeuvre.ZIGZAG_35: Accuracy(
        {"u": 0.0335, "v": 0.0853, "r": 0.0957}, {"u": 0.9853, "v": 0.9941, "r": 0.9938}
    ),
    PublishedManoeuvre.TURN_35: Accuracy(
        {"u": 0.0164, "v": 0.0151, "r": 0.0023}, {"u": 0.9997, "v": 0.9984, "r": 0.9996}
    ),
}

# the text below figure 2; N_vv and N_vr, in no equation, must be N_vvr and N_vrr, and Y_rr stands twice, once for Y_vr
CALLED_SENSITIVE = ("X_uu", "X_rr", "Y_vv", "Y_rr", "Y_v", "Y_r", "N_v", "N_r", "N_rr")
CALLED_INSENSITIVE = ("X_vv", "N_vv", "N_vr")
# candidates of eq. (2) that Lasso takes out, eq. (13)
DROPPED_COEFFICIENTS = ("N_vrr", "N_vvr")

# signs of table 2 that cannot be meant
MISPRINTED_SIGNS = {Table2Column.CFD: ("N_v",), Table2Column.ORIGINAL: ("N_v",), Table2Column.IMPROVED: ("N_v", "Y_vv")}


@dataclass(frozen=True)
class SupportVectorStatement:
    """What the paper says, translated, and where."""

    source: str
    text: str


STATEMENTS = {
    "accurate": SupportVectorStatement(
        "conclusion 1, abstract",
        "SVR identifies the hydrodynamic coefficients of the modular model successfully, with high accuracy",
    ),
    "improved": SupportVectorStatement(
        "section 3.1",
        "the improved model's coefficients are closer to CFD's: differencing and centring can to some degree remove "
        "parameter drift",
    ),
    "cleaning": SupportVectorStatement("conclusion 2", "thorough cleaning removes bad data and raises the accuracy"),
    "lasso": SupportVectorStatement(
        "conclusion 3", "Lasso takes out coefficients of little importance and so reduces multicollinearity"
    ),
    "sensitive": SupportVectorStatement(
        "section 1.3.2",
        "the coefficients kept are all of high sensitivity, those taken out of low sensitivity",
    ),
    "collinear": SupportVectorStatement(
        "section 3.2",
        "multicollinearity remains and parameter drift cannot be avoided, but the model's validity is not affected",
    ),
    "predicts": SupportVectorStatement(
        "sections 3.3, 4",
        "predicted motions and forces agree well with the reference; the white-box model predicts and generalises well",
    ),
    "robust": SupportVectorStatement("abstract", "the model is robust"),
    "wider": SupportVectorStatement("conclusion 1", "the modular model's speed can be extended to a wider range"),
}


def printed_coefficients(column: Table2Column) -> dict[str, float]:
    """Return a column of table 2 as printed, by coefficient in the order of `COEFFICIENTS`."""
    return dict(zip(COEFFICIENTS, _TABLE_2[column], strict=True))


PRINTED_DECIMALS = {Table2Column.CFD: 5, Table2Column.ORIGINAL: 4, Table2Column.IMPROVED: 4}
"""Decimals with which the columns of table 2 are printed."""


def printed_texts(column: Table2Column) -> list[str]:
    """Return a column of table 2 with the digits of the print."""
    return [f"{value:.{PRINTED_DECIMALS[column]}f}" for value in _TABLE_2[column]]


def printed_differences(column: Table2Column) -> dict[str, float]:
    """Relative differences of a column's printed values from the CFD column's, per cent, with their sign."""
    true = printed_coefficients(Table2Column.CFD)
    return {name: 100.0 * (value / true[name] - 1.0) for name, value in printed_coefficients(column).items()}


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
