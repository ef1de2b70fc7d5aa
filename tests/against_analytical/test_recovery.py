"""Every model recovers its own simulated truth: no noise, no guess for what enters linearly, 1e-8 or better."""

import math
from dataclasses import dataclass

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify import estimate_model
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.abkowitz import STANDARD, abkowitz
from seatrial.physics.models.mmg import HULL
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.published import kvlcc2, kvlcc2_l7
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

MODEL_SCALE_SLEW = math.radians(15.8)

# a course-stable ship of moderate turning, in the L^2 prime system
TANKER = dict(
    zip(
        STANDARD,
        (
            -0.0036, -0.0018, -0.0026, 0.0007, -0.002, 0.0148,
            1e-4, -0.0207, 0.004, -0.004, -0.1056, 0.0249, -0.0257, 0.0005,
            -5e-5, -0.0090, -0.0042, 0.002, -0.002, -0.0193, 0.0036, -0.00085,
        ),
        strict=True,
    )
)  # fmt: skip
ADDED_MASS = {"X_udot": -0.00145, "Y_vdot": -0.01465, "N_rdot": -0.0007, "U_n": 1.18}


@dataclass(frozen=True, eq=False)
class Case:
    """A model with its truth, where the search starts, and what is steered."""

    truth: Model
    start: Model
    records: tuple[Record, ...]
    length: float


def _zeroed(truth: Model, names: tuple[str, ...]) -> Model:
    return truth.with_values(dict.fromkeys(names, 0.0))


def _waterjet() -> Case:
    model = waterjet()
    record = manoeuvre(
        model, programme("consecutive-zigzags:1"), inputs={"v_j": 1.866}, slew_rate=math.radians(4.0), approach=10.0
    )
    return Case(model, _zeroed(model, COEFFICIENTS), (record,), 9.8)


def _nomoto() -> Case:
    model = nomoto().with_values({"K": 0.15, "T": 8.0, "U": 1.0})
    return Case(
        model, nomoto().with_values({"U": 1.0}), (manoeuvre(model, programme("zigzag:20/20"), dt=0.2, speed=1.0),), 7.0
    )


def _nomoto2() -> Case:
    model = nomoto2().with_values({"K": 0.15, "T_1": 15.0, "T_2": 3.0, "T_3": 5.0, "U": 1.0})
    return Case(
        model, nomoto2().with_values({"U": 1.0}), (manoeuvre(model, programme("zigzag:20/20"), dt=0.2, speed=1.0),), 7.0
    )


def _abkowitz() -> Case:
    model = abkowitz().with_values(TANKER | ADDED_MASS).with_ship(kvlcc2_l7().ship)
    records = tuple(
        manoeuvre(model, programme(text), speed=1.18, slew_rate=MODEL_SCALE_SLEW)
        for text in ("zigzag:20/20", "zigzag:10/10", "zigzag:35/5")
    )
    return Case(model, _zeroed(model, STANDARD), records, 7.0)


def _mmg() -> Case:
    model = kvlcc2()
    records = tuple(
        manoeuvre(model, programme(text), inputs={"n": 10.4}, slew_rate=MODEL_SCALE_SLEW)
        for text in ("zigzag:20/20", "zigzag:10/10", "turning-circle:35", "zigzag:35/5")
    )
    return Case(model, _zeroed(model, HULL), records, 7.0)


CASES = {"waterjet": _waterjet, "nomoto": _nomoto, "nomoto2": _nomoto2, "abkowitz": _abkowitz, "mmg": _mmg}


def _recovered(case: Case) -> Estimation:
    return estimate_model(case.start, Runs.one_session_each(case.records, case.length))


@pytest.mark.parametrize("name", [*list(CASES)[:-1], pytest.param("mmg", marks=pytest.mark.long)])
def test_truth_comes_back_from_nothing(name: str) -> None:
    case = CASES[name]()
    assert all(np.abs(record["u"]).min() > 0.3 for record in case.records if "u" in record)
    found = _recovered(case)
    wrong = {
        n: abs(found.model.parameters[n].value / case.truth.parameters[n].value - 1.0)
        for n in case.truth.parameters.free_names
    }
    assert max(wrong.values()) <= 1e-8, wrong
    assert found.estimate.optimum.solution.status.is_success
    assert found.criterion == "output error over whole runs"
