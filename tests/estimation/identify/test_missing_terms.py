"""Terms that a model lacks or holds at zero are named by a score test: craft by equations of the test."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import lfilter

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.trial import EstimateMethod, EstimateSettings
from seatrial.estimation.estimate.assemble import Runs
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.settings import EstimatorOptions
from seatrial.estimation.identify.model_selection import apply_variant, variants
from seatrial.estimation.identify.terms import held_couplings
from seatrial.physics.models import model_named
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import TABLE_2, waterjet

L, D, M, RHO, JET, SPEED = 9.8, 0.71, 5540.0, 1025.0, 1.866, 0.8
NOISE = {"u": 0.01, "v": 0.01, "r": 0.001, "psi": 0.003, "x0": 0.1, "y0": 0.1}
CROSS = {"N_vrr": 0.15, "N_vvr": -0.2}


def waterjet_rates(nozzle: Callable[[float], float], cross: Mapping[str, float]) -> Callable[..., list[float]]:
    """Equations of Song et al. 2025 with both cross terms in yaw, written out here."""
    c, q = TABLE_2, 0.5 * RHO * L * D
    m_x, m_y, inertia = M * 1.0281, M * 1.785, M * L**2 * (0.25**2 + 0.0699)

    def rates(t: float, x: np.ndarray) -> list[float]:
        u, v, r, psi = x[:4]
        U, w, delta = float(np.hypot(u, v)), L * r, nozzle(t)
        thrust = RHO * 0.035 * JET * (JET - u)
        X = q * (c["X_uu"] * u**2 + c["X_vv"] * v**2 + c["X_rr"] * w**2) + thrust * np.cos(delta)
        Y = q * ((c["Y_v"] * v + c["Y_r"] * w) * U + c["Y_vv"] * v * abs(v) + c["Y_vr"] * abs(v) * w)
        Y += q * c["Y_rr"] * w * abs(w) + thrust * np.sin(delta)
        N = q * L * ((c["N_v"] * v + c["N_r"] * w) * U + c["N_rr"] * w * abs(w))
        N += q * L * (cross["N_vrr"] * v * w**2 + cross["N_vvr"] * v**2 * w) / U - 0.45 * L * thrust * np.sin(delta)
        north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
        return [(X + m_y * v * r) / m_x, (Y - m_x * u * r) / m_y, N / inertia, r, north, east]

    return rates


GUST_MEMORY = 8.0  # s


def gusts_of(size: float, rng: np.random.Generator) -> np.ndarray:
    """Accelerations of sway and yaw with a memory, at the samples, (600, 2)."""
    kept = np.exp(-0.5 / GUST_MEMORY)
    shocks = size * np.sqrt(1.0 - kept**2) * rng.standard_normal((600, 2)) * [1.0, 1.0 / 3.0]
    return np.asarray(lfilter([1.0], [1.0, -kept], shocks, axis=0))


def waterjet_run(
    name: str, degrees: float, period: float, cross: Mapping[str, float], seed: int, gust: float = 0.0
) -> Record:
    """Five minutes of nozzle to and fro, straight from sample to sample, 2 Hz; gust: its acceleration, rms [m/s^2]."""
    time, rng = 0.5 * np.arange(600), np.random.default_rng(seed)
    nozzle = np.radians(degrees) * np.clip(8.0 * np.sin(2.0 * np.pi * time / period), -1.0, 1.0)
    calm = waterjet_rates(lambda t: float(np.interp(t, time, nozzle)), cross)
    gusts = gusts_of(gust, np.random.default_rng(1000 + seed))

    def rates(t: float, x: np.ndarray) -> list[float]:
        surge, sway, yaw, *rest = calm(t, x)
        return [
            surge,
            sway + float(np.interp(t, time, gusts[:, 0])),
            yaw + float(np.interp(t, time, gusts[:, 1])),
            *rest,
        ]

    start = [SPEED, 0.0, 0.0, 0.0, 0.0, 0.0]
    motion = solve_ivp(rates, (0.0, time[-1]), start, t_eval=time, rtol=1e-8, atol=1e-9, max_step=0.5).y
    noisy = {n: row + s * rng.standard_normal(len(time)) for (n, s), row in zip(NOISE.items(), motion, strict=True)}
    return Record.from_arrays(
        name, np.asarray(time, np.float64), {**noisy, "delta": -nozzle, "v_j": np.full(len(time), JET)}
    )


def fitted_waterjet(
    cross: Mapping[str, float],
    model: Model | None = None,
    method: EstimateMethod = EstimateMethod.AUTO,
    gust: float = 0.0,
) -> Estimation:
    sizes = ((10.0, 90.0), (20.0, 120.0), (35.0, 160.0), (30.0, 100.0))
    runs = [waterjet_run(f"run {i}", *size, cross, i, gust) for i, size in enumerate(sizes)]
    return estimate_model(
        model or waterjet(),
        Runs.one_session_each(runs, L),
        EstimateSettings(method=method),
        EstimatorOptions(workers=1),
    )


@pytest.mark.parametrize(
    "method", [EstimateMethod.OUTPUT_ERROR, pytest.param(EstimateMethod.AUTO, marks=pytest.mark.long)]
)
def test_terms_that_the_waterjet_lacks_are_named(method: EstimateMethod) -> None:
    (finding,) = held_couplings(fitted_waterjet(CROSS, method=method))
    assert finding.code == "held-coupling"
    assert finding.text.split()[0] in CROSS
    assert "is no term of the model" in finding.text
    assert 'name = "waterjet_candidates"' in finding.advice


@pytest.mark.long
@pytest.mark.long
def test_terms_are_tested_by_output_error_where_the_fit_has_gusts_among_its_states() -> None:
    estimation = fitted_waterjet(CROSS, gust=0.012)
    assert estimation.process_noise is not None
    assert estimation.process_noise.problem.runs.model.name == "waterjet with gusts"
    assert all(finding.code == "held-coupling" for finding in held_couplings(estimation))


def test_terms_that_the_waterjet_lacks_can_be_freed() -> None:
    wide = fitted_waterjet(CROSS, model_named("waterjet_candidates"))
    assert held_couplings(wide) == ()
    for name, truth in {**TABLE_2, **CROSS}.items():
        place = wide.estimate.problem.free.index(name)
        assert abs(wide.model.parameters[name].value - truth) < 2.0 * wide.interval.half_width[place]


def test_a_waterjet_of_the_models_own_terms_lacks_none() -> None:
    assert held_couplings(fitted_waterjet(dict.fromkeys(CROSS, 0.0))) == ()


def test_a_choice_of_model_reaches_both_terms() -> None:
    (variant,) = (v for v in variants(waterjet(), None, False) if set(v.freed) == set(CROSS))
    chosen = apply_variant(waterjet(), variant)
    assert set(chosen.parameters.free_names) == {*waterjet().parameters.free_names, *CROSS}
    assert set(apply_variant(waterjet(), variants(waterjet(), None, False)[0]).parameters.names).isdisjoint(CROSS)


@pytest.mark.parametrize("c_5", [-60.0, 0.0])
def test_a_term_of_roll_that_is_held_at_zero_is_named(c_5: float) -> None:
    """Decays from 25 to 15 degrees with restoring of fifth order, fitted with a cubic one."""
    decays = [roll_decay(f"decay {i}", np.radians(heel), c_5, i) for i, heel in enumerate((25.0, -20.0, 15.0, 24.0))]
    model = roll().with_values({"b_1": 0.1, "b_2": 0.4, "c_1": 6.0, "c_3": 2.0})
    kept = ("b_1", "b_2", "c_1", "c_3", "phi_0")
    parameters = model.parameters.fixed(*(n for n in model.parameters.free_names if n not in kept)).freed(*kept)
    model = model.with_parameters(parameters.with_values({"b_3": 0.0, "c_5": 0.0}))
    findings = held_couplings(
        estimate_model(model, Runs.one_session_each(decays, 5.0), None, EstimatorOptions(workers=1))
    )
    assert [f.text.split()[0] for f in findings] == (["c_5"] if c_5 else [])


def roll_decay(name: str, heel: float, c_5: float, seed: int) -> Record:
    """A roll from rest with the angle's noise of 0.05 degrees, 20 Hz."""
    time, noise = 0.05 * np.arange(1000), np.random.default_rng(seed)

    def rates(_: float, x: np.ndarray) -> list[float]:
        return [x[1], -6.0 * x[0] - 2.0 * x[0] ** 3 - c_5 * x[0] ** 5 - 0.1 * x[1] - 0.4 * x[1] * abs(x[1])]

    phi = solve_ivp(rates, (0.0, time[-1]), [heel, 0.0], t_eval=time, rtol=1e-8, atol=1e-10).y[0]
    return Record.from_arrays(
        name, np.asarray(time, np.float64), {"phi": phi + np.radians(0.05) * noise.standard_normal(len(time))}
    )
