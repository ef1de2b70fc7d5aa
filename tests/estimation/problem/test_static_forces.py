"""Static force points: exact Jacobians, recovery of the coefficients, what the forces include, the addend's place."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pytest

from seatrial.core.values import Array, ForceContent, ForcePoints, InputError
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.numerics.optimise import NormalEquations, levenberg_marquardt
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.mmg import HULL, mmg
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.models.published import kvlcc2
from seatrial.physics.models.waterjet import waterjet
from seatrial.physics.simulate.steer import manoeuvre

SPEED, LENGTH = 1.2, 7.0


def points(includes: ForceContent = ForceContent.HYDRODYNAMIC, **forces: Array) -> ForcePoints:
    """Drift by yaw rate by rudder angle at one speed; forces zero unless given."""
    grid = np.array(list(product(np.radians((-15.0, -7.0, 0.0, 8.0, 16.0)), (-0.8, -0.3, 0.0, 0.5), (-0.4, 0.0, 0.6))))
    beta, r, delta = grid.T
    motion = {
        "u": SPEED * np.cos(beta), "v": -SPEED * np.sin(beta), "r": r * SPEED / LENGTH, "delta": delta,
        "n": np.full(len(beta), 10.4),
    }  # fmt: skip
    known = forces or {f: np.zeros(len(beta)) for f in ("X", "Y", "N")}
    return ForcePoints("tank", motion, known, {"X": 0.3, "Y": 2.0, "N": 5.0}, includes)


def measured_of(includes: ForceContent) -> ForcePoints:
    """The forces KVLCC2's published coefficients give, without noise."""
    forces = StaticForces(kvlcc2(), points(includes)).forces(kvlcc2().parameters.values)
    return points(includes, X=forces[:, 0], Y=forces[:, 1], N=forces[:, 2])


@pytest.mark.parametrize("includes", list(ForceContent))
def test_the_gradient_is_that_of_the_cost(includes: ForceContent) -> None:
    term, values = StaticForces(kvlcc2(), points(includes)), kvlcc2().parameters.values
    free = [kvlcc2().parameters.index(n) for n in (*HULL, "a_H", "w_P0", "m_y_prime")]
    steps = [1e-5 * np.eye(len(values))[i] for i in free]
    differences = [(term.cost(values + h) - term.cost(values - h)) / 2e-5 for h in steps]
    found = term.normal(values, free)
    np.testing.assert_allclose(found.gradient, differences, rtol=1e-6, atol=1e-8 * np.max(np.abs(found.gradient)))
    assert found.cost == pytest.approx(term.cost(values))


@dataclass(frozen=True)
class Alone:
    """Force points as a problem of their own."""

    term: StaticForces
    free: tuple[str, ...]

    @property
    def lower(self) -> Array:
        """None."""
        return np.full(len(self.free), -np.inf)

    @property
    def upper(self) -> Array:
        """None."""
        return np.full(len(self.free), np.inf)

    def _values(self, shared: Array) -> Array:
        return self.term.model.with_values(dict(zip(self.free, shared, strict=True))).parameters.values

    def cost(self, shared: Array, local: Array) -> float:
        """Of the points."""
        del local
        return self.term.cost(self._values(shared))

    def normal(self, shared: Array, local: Array) -> NormalEquations:
        """Of the points."""
        places = [self.term.model.parameters.index(n) for n in self.free]
        found = self.term.normal(self._values(shared), places)
        nothing = np.zeros((0, 0))
        return NormalEquations(
            found.cost, found.gradient, found.hessian, local, np.zeros((0, 0, 0)), nothing[:, :, None]
        )


@pytest.mark.parametrize("includes", list(ForceContent))
def test_points_without_noise_give_back_the_hull(includes: ForceContent) -> None:
    problem = Alone(StaticForces(kvlcc2(), _without_inertia(measured_of(includes))), HULL)
    found = levenberg_marquardt(problem, np.zeros(len(HULL)), np.zeros((0, 0)))
    truth = [kvlcc2().parameters[n].value for n in HULL]
    np.testing.assert_allclose(found.solution.point, truth, atol=1e-9)


def _without_inertia(given: ForcePoints) -> ForcePoints:
    """`forces` gives what a balance feels where only pressures were wanted: take the rigid body out."""
    if given.includes is not ForceContent.PRESSURE:
        return given
    m, x_G = (kvlcc2().parameters[n].value for n in ("m", "x_G"))
    u, v, r = (given.motion[s] for s in ("u", "v", "r"))
    body = {"X": m * (v * r + x_G * r**2), "Y": -m * u * r, "N": -m * x_G * u * r}
    return replace(given, forces={f: values - body[f] for f, values in given.forces.items()})


def test_what_is_included_matters_only_in_a_turn() -> None:
    values, straight = kvlcc2().parameters.values, points().motion["r"] == 0
    summed, held = (
        StaticForces(kvlcc2(), points(i)).forces(values) for i in (ForceContent.HYDRODYNAMIC, ForceContent.BALANCE)
    )
    np.testing.assert_allclose(summed[straight], held[straight], rtol=1e-12)
    m = kvlcc2().parameters["m"].value
    turning = points().motion["r"] > 0
    assert np.all((summed - held)[turning, 1] > 1.0 * m * (points().motion["u"] * points().motion["r"])[turning])


def test_a_model_with_the_rudder_to_port_gets_the_angle_turned() -> None:
    motion = {"u": [1.6], "v": [0.0], "r": [0.0], "delta": [0.2], "v_j": [1.9]}
    given = ForcePoints("jet", {k: np.array(v) for k, v in motion.items()}, {"Y": np.zeros(1)}, {"Y": 1.0})
    forces = StaticForces(waterjet(), given).forces(waterjet().parameters.values)
    assert forces[0, 1] < 0 < forces[0, 2]


def test_values_nobody_measured_weigh_nothing() -> None:
    values, full = kvlcc2().parameters.values, points()
    holes = {f: np.where(np.arange(len(full)) % 2 == 0, x, np.nan) for f, x in full.forces.items()}
    half = StaticForces(kvlcc2(), replace(full, forces={"Y": holes["Y"]}))
    forces = half.forces(values)[::2, 1]
    assert half.cost(values) == pytest.approx(0.5 * np.sum((forces / 2.0) ** 2))


def test_the_problem_adds_points_to_all_runs_and_to_no_run_left_out() -> None:
    model = kvlcc2().with_parameters(kvlcc2().parameters.only_free(("Y_v", "N_r")))
    run = manoeuvre(model, programme("zigzag:10/10"), dt=0.5, duration=20.0, inputs={"n": 10.4})
    plain = OutputError(model, cut_segments(model, [run], ("u", "v", "r"), None), np.array([0.01, 0.01, 0.001]))
    term = StaticForces(model, points())
    fused = replace(plain, extra_terms=(term,))
    shared, local = plain.start() * 1.1, plain.measured_initial_states()
    own = term.normal(fused._parameter_values(shared), [model.parameters.index(n) for n in ("Y_v", "N_r")])
    with_points, without = fused.normal(shared, local), plain.normal(shared, local)
    np.testing.assert_allclose(with_points.gradient - without.gradient, own.gradient, rtol=1e-9)
    np.testing.assert_allclose(with_points.hessian - without.hessian, own.hessian, rtol=1e-9)
    assert with_points.cost == pytest.approx(fused.cost(shared, local))
    assert fused.cost(shared, local) == pytest.approx(plain.cost(shared, local) + own.cost)
    np.testing.assert_allclose(fused.prior_precision(shared), own.hessian)
    pinned = replace(fused, pinned=shared)
    assert pinned.cost(shared, local) == replace(plain, pinned=shared).cost(shared, local), "only initial states move"
    one, other = (
        p.assemble(p.segment_normals(shared, local), shared, np.arange(1), with_prior=False) for p in (fused, plain)
    )
    np.testing.assert_array_equal(one.hessian, other.hessian)


def test_abkowitz_names_its_forces_too() -> None:
    assert StaticForces(abkowitz(), points()).force_names == ("X_sum", "Y_sum", "N_sum")
    with pytest.raises(InputError, match=r"abkowitz.*no forces X_H.*includes = \"hull\""):
        StaticForces(abkowitz(), points(ForceContent.HULL))


def test_models_and_points_that_do_not_go_together_are_refused() -> None:
    with pytest.raises(InputError, match="model 'nomoto' has no forces"):
        StaticForces(nomoto(), points())
    motion = {s: x for s, x in points().motion.items() if s != "n"}
    with pytest.raises(InputError, match=r"do not say 'n'.*forces.motion"):
        StaticForces(kvlcc2(), replace(points(), motion=motion))
    StaticForces(kvlcc2(), replace(points(ForceContent.HULL), motion=motion))
    loose = kvlcc2().with_parameters(kvlcc2().parameters.freed("m"))
    with pytest.raises(InputError, match=r"need a known 'm'.*fix it"):
        StaticForces(loose, points(ForceContent.PRESSURE))
    assert "X_sum" in {b.name for b in mmg().bindings}


def test_tables_that_say_nothing_are_refused() -> None:
    with pytest.raises(InputError, match="hold no force"):
        replace(points(), forces={"Y": np.full(len(points()), np.nan)})
    with pytest.raises(InputError, match="'Y' has no positive standard deviation"):
        replace(points(), sd={"X": 1.0, "Y": 0.0, "N": 1.0})
    with pytest.raises(InputError, match="lack 'r'"):
        replace(points(), motion={s: x for s, x in points().motion.items() if s != "r"})
    holed = points().motion["u"].copy()
    holed[3] = np.nan
    with pytest.raises(InputError, match="'u' is not a number in point 4"):
        replace(points(), motion={**points().motion, "u": holed})
