"""Generated code against SymPy: values against lambdified expressions, Jacobians against the full expansion."""

import numpy as np
import pytest
import sympy as sp

from seatrial.core.equations import Binding, Model, Sheet
from seatrial.core.equations.generate import partial, source_text
from seatrial.physics.models.waterjet import waterjet


def expanded(model: Model, wanted: tuple[Binding, ...]) -> list[sp.Expr]:
    """The expressions with every binding put in."""
    known: dict[sp.Symbol, sp.Expr] = {}
    for binding in model.bindings:
        known[sp.Symbol(binding.name, real=True)] = binding.expression.xreplace(known)
    return [binding.expression.xreplace(known) for binding in wanted]


def outputs(model: Model) -> tuple[Binding, ...]:
    return tuple(b for name in model.outputs for b in model.bindings if b.name == name)


def base(model: Model) -> list[sp.Symbol]:
    names = (*model.states, *model.input_names, *model.parameters.names)
    return [sp.Symbol(n, real=True) for n in names]


def points(model: Model, rng: np.random.Generator, count: int = 20) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    made = []
    for _ in range(count):
        p = model.parameters.values * rng.uniform(0.8, 1.2, len(model.parameters))
        made.append((rng.normal(size=len(model.states)), rng.uniform(0.2, 1.5, len(model.inputs)), p))
    return made


@pytest.fixture(scope="module", params=["awkward", "waterjet"])
def any_model(request: pytest.FixtureRequest, model: Model) -> Model:
    return {"awkward": model, "waterjet": waterjet()}[request.param]


@pytest.mark.parametrize("kind", ["rates", "outputs", "bindings"])
def test_values_equal_the_lambdified_expressions(any_model: Model, kind: str, rng: np.random.Generator) -> None:
    wanted = {"rates": any_model.equations.rates, "outputs": outputs(any_model), "bindings": any_model.bindings}[kind]
    reference = sp.lambdify(base(any_model), expanded(any_model, wanted), "numpy")
    function = getattr(any_model.compiled, kind)
    for x, u, p in points(any_model, rng):
        out = np.empty(len(wanted))
        function(0.0, x, u, p, out)
        np.testing.assert_allclose(out, reference(*x, *u, *p), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("kind", ["rates", "outputs"])
def test_jacobians_equal_the_full_expansion(any_model: Model, kind: str, rng: np.random.Generator) -> None:
    wanted = {"rates": any_model.equations.rates, "outputs": outputs(any_model)}[kind]
    pattern = {"rates": any_model.compiled.rates_pattern, "outputs": any_model.compiled.outputs_pattern}[kind]
    symbols = base(any_model)
    full = [[partial(e, s) for s in symbols] for e in expanded(any_model, wanted)]
    reference = sp.lambdify(symbols, full, "numpy")
    function = getattr(any_model.compiled, f"{kind}_tangent")
    for x, u, p in points(any_model, rng):
        out, jacobian = np.empty(len(wanted)), np.zeros((len(wanted), len(symbols)))
        function(0.0, x, u, p, out, jacobian)
        expected = np.array(reference(*x, *u, *p), dtype=float).reshape(jacobian.shape)
        np.testing.assert_allclose(jacobian, expected, rtol=1e-10, atol=1e-12)
        assert set(zip(*np.nonzero(expected), strict=True)) <= {tuple(pair) for pair in pattern}


def test_derivatives_of_absolute_value_and_sign() -> None:
    x = sp.Symbol("x", real=True)
    assert partial(sp.Abs(x), x) == sp.sign(x)
    assert partial(sp.sign(x), x) == 0
    assert sp.simplify(partial(x * sp.Abs(x), x) - 2 * sp.Abs(x)) == 0


def test_the_breakdown_of_forces_names_every_binding(model: Model, rng: np.random.Generator) -> None:
    states, inputs = rng.normal(size=(7, 2)), rng.uniform(0.2, 1.0, (7, 2))
    forces = model.forces(states, inputs)
    assert list(forces) == [b.name for b in model.bindings]
    np.testing.assert_allclose(forces["U"], np.sqrt((states**2).sum(axis=1) + 0.1), rtol=1e-14)


def test_unused_bindings_cost_the_rates_nothing(model: Model) -> None:
    rates = source_text(model.equations).split("def rates_tangent")[0]
    assert "unused_" not in rates


def test_a_model_without_inputs_parameters_or_outputs_compiles() -> None:
    sheet = Sheet("still")
    (x,) = sheet.states("x0")
    sheet.rate(x, -x)
    compiled = sheet.model().compiled
    out, jacobian = np.empty(1), np.zeros((1, 1))
    compiled.rates_tangent(0.0, np.array([3.0]), np.empty(0), np.empty(0), out, jacobian)
    assert (out[0], jacobian[0, 0]) == (-3.0, -1.0)


def test_the_hash_follows_equations_and_not_values(model: Model) -> None:
    assert model.with_values({"Y_v": 5.0}).equation_hash == model.equation_hash

    def yaw(gain: int) -> Model:
        sheet = Sheet("yaw")
        (r,) = sheet.states("r")
        sheet.rate(r, -gain * r)
        return sheet.model()

    assert yaw(1).equation_hash == yaw(1).equation_hash != yaw(2).equation_hash


def test_names_that_run_together_keep_their_derivatives_apart() -> None:
    """d(a)/d(b_c) and d(a_b)/d(c) would both read d_a_b_c."""
    sheet = Sheet("run_together")
    b_c, c = sheet.states("b_c c")
    a = sheet.bind("a", 2 * b_c + 3 * c)
    a_b = sheet.bind("a_b", 5 * b_c + 7 * c)
    sheet.rate(b_c, a * a_b)
    sheet.rate(c, a + a_b)
    out, jacobian = np.empty(2), np.zeros((2, 2))
    sheet.model().compiled.rates_tangent(0.0, np.ones(2), np.empty(0), np.empty(0), out, jacobian)
    np.testing.assert_array_equal(jacobian, [[2 * 12 + 5 * 5, 3 * 12 + 7 * 5], [7.0, 10.0]])
