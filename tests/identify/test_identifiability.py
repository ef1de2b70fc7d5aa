"""What a fit of simulated trials tells, against the craft that made them and against fits with wrong assumptions."""

from dataclasses import replace

import numpy as np
import pytest

from seatrial.estimate.fit import Identified
from seatrial.estimate.settings import Criterion
from seatrial.identify import Settings, identified
from seatrial.identify.identifiability import consequences, identifiability, sensitivities
from seatrial.identify.profile import LIMIT, profiles
from seatrial.results import Identifiability
from seatrial.simulate import replay
from seatrial.studies.series import noisy, run, truth
from seatrial.values import Record

RATE, EXECUTES = 2.0, 5


@pytest.fixture(scope="module")
def record() -> Record:
    """The consecutive zigzags of the demonstration, 2075 s."""
    return noisy(run(truth(), f"consecutive-zigzags:{EXECUTES}").resampled(RATE), np.random.default_rng(3), 3)


@pytest.fixture(scope="module")
def found(record: Record) -> Identified:
    settings = Settings(criterion=Criterion.OUTPUT_ERROR, workers=1)
    return identified(truth(), [record], [record.name], 9.8, settings)


@pytest.fixture(scope="module")
def told(found: Identified) -> Identifiability:
    return identifiability(found, (), {"u": 0.8, "v_j": 1.866}, 9.8)


def test_the_weakest_direction_is_the_one_of_this_craft(told: Identifiability) -> None:
    """X_rr against X_vv and Y_vr, in relative changes."""
    weakest = told.directions[0].combination
    assert set(list(weakest)[:3]) == {"X_rr", "Y_vr", "X_vv"}
    assert weakest["X_rr"] * weakest["X_vv"] < 0 and weakest["X_rr"] * weakest["Y_vr"] < 0
    assert told.directions[0].standard_deviation > 5 * told.directions[2].standard_deviation
    assert told.effective_parameters == 11


def test_the_craft_is_stable_on_her_course(told: Identifiability) -> None:
    assert told.stability is not None
    assert told.stability.lower > 0


def test_a_wrong_added_mass_moves_the_estimates_as_foretold(found: Identified, record: Record) -> None:
    """One Gauss-Newton step against a fit with the wrong value."""
    foretold = next(c for c in consequences(found) if c.parameter == "m_y")
    model = truth()
    wrong = model.with_values({"m_y": 1.02 * model.parameters["m_y"].value})
    settings = Settings(criterion=Criterion.OUTPUT_ERROR, workers=1)
    again = identified(wrong, [record], [record.name], 9.8, settings)
    for name in ("Y_v", "X_vv", "Y_rr"):
        i = found.made.problem.free.index(name)
        moved = (again.made.shared[i] - found.made.shared[i]) / found.made.shared[i]
        assert moved == pytest.approx(0.2 * foretold.moves[name], rel=0.15), name
    assert foretold.moves["Y_v"] == pytest.approx(0.15, abs=0.02)
    assert "Y_v" in foretold.text and "only" in foretold.text


def test_sensitivities_are_changes_of_the_simulated_outputs(found: Identified, record: Record) -> None:
    effect = {s.parameter: s for s in sensitivities(found)}["N_r"]
    model, start = found.model, found.made.optimum.local[0]
    initial = dict(zip(found.made.problem.starts, start, strict=True))
    value = model.parameters["N_r"].value
    up, down = (replay(model.with_values({"N_r": value * f}), record, initial) for f in (1.001, 0.999))
    noise = dict(zip(found.made.problem.data.outputs, found.made.problem.noise, strict=True))
    for output in ("r", "psi"):
        slope = np.sqrt(np.mean(((up[output] - down[output]) / 0.002) ** 2)) / noise[output]
        assert effect.outputs[output] == pytest.approx(0.1 * slope, rel=1e-2)


def test_the_profile_of_a_well_known_coefficient_is_its_interval(found: Identified) -> None:
    (profile,) = profiles(found.made, found.interval.standard_error, ["N_rr"])
    i = found.made.problem.free.index("N_rr")
    centre, half = found.made.shared[i], found.interval.half_width[i]
    assert profile.lower == pytest.approx(centre - half, abs=0.15 * half)
    assert profile.upper == pytest.approx(centre + half, abs=0.15 * half)
    assert np.all(np.diff(profile.values) > 0) and min(profile.costs) == 0.0 and max(profile.costs) > LIMIT


def test_a_direction_held_by_a_prior_does_not_count_as_told(found: Identified) -> None:
    """A prior much tighter than the records takes a parameter from them."""
    from seatrial.values import Prior

    problem = found.made.problem
    tight = {"X_rr": Prior(0.00414, 1e-7, "tight")}
    model = problem.model.with_parameters(problem.model.parameters.with_priors(tight))
    held = replace(problem, model=model)
    normal = held.normal(found.made.shared, found.made.optimum.local)
    made = replace(found.made, problem=held, optimum=replace(found.made.optimum, normal=normal))
    told = identifiability(replace(found, made=made), (), {}, 9.8)
    assert told.effective_parameters == pytest.approx(10.0, abs=0.1)
    assert told.stability is None
