"""What a record tells of two ships that nobody measured: a waterjet craft and a tanker like KVLCC2."""

from dataclasses import replace

import numpy as np
from tests.reporting.fabricated import fabricated_fit

from seatrial.core.results import (
    Baseline,
    CandidateModel,
    Coefficient,
    Collinearity,
    Consequence,
    Direction,
    DisturbanceCandidate,
    Extrapolation,
    Fit,
    Identifiability,
    KStepErrors,
    Measure,
    NoiseModel,
    OpenLoopScores,
    Prediction,
    Profile,
    Sensitivity,
    Stability,
    Symmetry,
)
from seatrial.core.values import Finding, Parameter, Prior, Severity, Ship
from seatrial.estimation.information.frequency_response import frequency_responses
from seatrial.physics.models.published import YASUKAWA, kvlcc2


def complete_fit(fit: Fit) -> Fit:
    """The fit with every field filled that says what the records can and cannot tell."""
    return replace(
        fit,
        predictions=tuple(with_bounds(p) for p in fit.predictions),
        identifiability=identifiability(fit),
        noise_model=disturbance(),
        candidate_models=family(),
        baselines=baselines(fit),
        k_step_errors=tuple(k_step_errors(c, unit, role) for c, unit in (("r", "rad/s"), ("psi", "rad"))
                            for role in ("training", "validation")),
        frequency_responses=frequency_responses(fit.model, fit.predictions, ("u", "v", "r", "psi", "x0", "y0")),
    )  # fmt: skip


def k_step_errors(channel: str, unit: str, role: str) -> KStepErrors:
    """Errors that grow with the horizon, the held-out runs' up to a horizon less."""
    steps = (1, 3, 10, 30)[: 4 if role == "training" else 3]
    seconds = np.array([0.2 * k for k in steps])
    rms, held = (tuple((size * (0.01 + seconds)).tolist()) for size in (1e-3, 2e-3))
    return KStepErrors(channel, unit, role, steps, tuple(seconds.tolist()), rms, (99.0,) * len(steps), held,
                       (400,) * len(steps))  # fmt: skip


def tanker() -> Fit:
    """A tanker with 43 free coefficients, each with a prior, dressed in the zigzags of the waterjet craft."""
    base = kvlcc2()
    names = [p.name for p in base.parameters if p.value and p.name not in ("L", "d", "rho", "U_0", "m")][:43]
    parameters = base.parameters.only_free(names)
    priors = {n: Prior(parameters[n].value, 0.1 * abs(parameters[n].value), f"{YASUKAWA}, 10 %") for n in names}
    model = base.with_parameters(parameters.with_priors(priors))
    fit = fabricated_fit(names=("HSVA_Z_10_05", "HSVA_Z_20_05", "HSVA_Z_30_05", "HSVA_Z_35_05"))
    order = model.parameters.free_names
    spread = np.array([0.05 * abs(parameters[n].value) for n in order])
    return replace(
        fit,
        question="Can zigzags alone predict a 35/5 zigzag that was never fitted?",
        ship=Ship("KVLCC2, model 1:45.7", {"L": 7.0, "B": 1.27, "d": 0.455}, YASUKAWA),
        model=model,
        covariance=np.corrcoef(np.random.default_rng(6).standard_normal((43, 60))) * np.outer(spread, spread),
        coefficients=tuple(_coefficient(p) for p in model.parameters),
    )


def _coefficient(p: Parameter) -> Coefficient:
    if not p.free or p.prior is None:
        return Coefficient(p.name, p.unit, p.value, None, None, None, True, source=p.source, meaning=p.meaning)
    error = 0.5 * p.prior.standard_deviation
    return Coefficient(
        p.name, p.unit, p.value, error, p.value - 1.96 * error, p.value + 1.96 * error, False, None, p.prior.mean,
        p.prior.standard_deviation, p.source, p.meaning, p.latex,
    )  # fmt: skip


def identifiability(fit: Fit) -> Identifiability:
    """Directions over the free coefficients from 900 % down to .3 %, one of them not reached at all."""
    free = [c for c in fit.coefficients if not c.fixed]
    names = [c.name for c in free]
    fixed = [c.name for c in fit.coefficients if c.fixed and c.estimate]
    spread = [np.inf, *np.geomspace(9.0, 0.003, len(names) - 1)]
    directions = tuple(_direction(names, k, float(s)) for k, s in enumerate(spread))
    return Identifiability(
        structural=(
            Symmetry(
                (*names[:3], fixed[0]),
                f"all coefficients, thrust and inertias can be scaled together. Fix or give a prior for one of "
                f"{names[0]}, {fixed[0]}",
                {names[0]: 1.0, names[1]: 1.0, names[2]: 1.0, fixed[0]: 1.0},
            ),
            Symmetry(
                (names[3], names[4]), f"{names[3]} and {names[4]} act only as a sum", {names[3]: 1.0, names[4]: -0.4}
            ),
        ),
        directions=directions,
        effective_parameters=0.54 * len(names),
        condition=3.1e6,
        collinearity=tuple(
            Collinearity(n, float(v), names[-1 - k], (-1) ** k * float(np.sqrt(1 - 1 / v)))
            for k, (n, v) in enumerate(zip(names, np.geomspace(400, 1.5, len(names)), strict=True))
        ),
        sensitivities=tuple(
            Sensitivity(n, float(e), {"u": float(e) / 3, "psi": float(e) / 2})
            for n, e in zip(names, np.geomspace(40, 0.02, len(names)), strict=True)
        ),
        consequences=tuple(
            Consequence(
                n, 0.1, {names[0]: 0.13, names[1]: -0.08, names[2]: 0.021}, chi,
                f"{n} 10 % too large moves {names[0]} by +13 %, {names[1]} by −8 %",
            )
            for n, chi in zip(fixed, (0.2, 35.0, 3.0), strict=False)
        ),
        stability=Stability(-0.0021, -0.0094, 0.0048, "the records do not tell whether the ship is course stable"),
        profiles=tuple(
            _profile(names[k], free[k].estimate, shape) for k, shape in enumerate((4.0, 1.0, 0.2))
        ),
    )  # fmt: skip


def _direction(names: list[str], k: int, spread: float) -> Direction:
    picked = [names[(k + j) % len(names)] for j in range(3)]
    combination = dict(zip(picked, (0.74, -0.56, 0.37), strict=True))
    how = "is not determined at all" if not np.isfinite(spread) else f"is known to {100 * spread:.2g} % only"
    return Direction(combination, spread, f"{picked[0]} up with {picked[1]} down and a little more {picked[2]} {how}")


def _profile(name: str, estimate: float, shape: float) -> Profile:
    x = np.linspace(-2.5, 2.5, 21)
    costs = shape * x**2 * (1 + 0.2 * x)
    inside = x[costs <= 3.84]
    wide = bool(inside[0] == x[0])
    values = estimate * (1 + 0.05 * x)
    ends = (float(estimate * (1 + 0.05 * inside[0])), float(estimate * (1 + 0.05 * inside[-1])))
    return Profile(name, tuple(values), tuple(costs), None if wide else min(ends), None if wide else max(ends))


def disturbance() -> NoiseModel:
    """Wind that an output error would have taken for coefficients."""
    return NoiseModel(
        "prediction error",
        0.23,
        {"u": 0.0018, "v": 0.0023, "r": 0.0011, "psi": 0.0},
        {"u": 0.02, "psi": 0.0017, "x0": 0.5, "y0": 0.5},
        "with output error the residuals stay coloured (p < 0.001); allowing for process noise raises the "
        "log-likelihood by 412 with 3 further parameters",
        is_white=True,
        disturbance="first-order Markov on u, v, r",
        added={"gust_memory_r": 4.8},
        candidates=(
            DisturbanceCandidate("none", -812.4, 0, 0.0, 0.0, 0.0, False, {}, None, False),
            DisturbanceCandidate("white", 7312.4, 3, 16249.6, 16.3, 3e-9, False, {}, 1.31, False),
            DisturbanceCandidate(
                "first-order Markov on u, v, r",
                7724.1,
                6,
                17073.0,
                22.5,
                0.23,
                True,
                {"gust_memory_u": 6.1, "gust_memory_v": 5.2, "gust_memory_r": 4.8},
                1.0,
                True,
            ),
        ),
    )


def family() -> tuple[CandidateModel, ...]:
    """Two tied models, one worse, one that failed."""
    return (
        CandidateModel("full, priors 10 %, segments of 10 s", 43, 1.52, 0.61, is_tied=True, is_chosen=True),
        CandidateModel("full, priors 30 %, segments of 10 s", 43, 1.49, 0.66, is_tied=True),
        CandidateModel("without even terms, priors 10 %", 37, 2.31, 0.92, is_tied=False),
        CandidateModel("full, no priors", 43, None, None, is_tied=False, note="run Z_20_05 diverged after 41 s"),
    )


def baselines(fit: Fit) -> tuple[Baseline, ...]:
    """The fit 1 % off, an estimator near it, one farther off that sails well, one that diverges, one that failed."""
    free = [c for c in fit.coefficients if not c.fixed]
    dropped = Finding(Severity.INFO, "lasso-dropped", "Lasso drops N_r from the r equation")

    def baseline_at(name: str, off: float, gap: float, heading: float, cc: float) -> Baseline:
        sails = OpenLoopScores({"psi_deg": heading, "position_m": 2.0, "r": 0.002}, {"u": cc, "v": cc, "r": 0.999})
        values = {c.name: (1.0 + off) * c.estimate for c in free}
        return Baseline(name, values, dict.fromkeys(values, gap), dict.fromkeys(values, off), sails, sails)

    lost = OpenLoopScores(diverged=(fit.predictions[-1].record,))
    return (
        replace(baseline_at(f"this fit: {fit.method.criterion}", 0.01, 0.0, 0.5, 0.99), is_fit=True),
        baseline_at("weak form", 0.05, 1.5, 0.8, 0.99),
        replace(baseline_at("ridge", 0.6, -7.0, 1.1, 0.98), findings=(dropped,), bias={"u": 0.003}),
        replace(baseline_at("Euler", 9.0, 450.0, 0.0, 0.0), training=OpenLoopScores(), validation=lost),
        Baseline("pipeline", note="run a is too short"),
    )


def with_bounds(p: Prediction) -> Prediction:
    """With a band that widens, intervals, floor, spread, and an extrapolation index for the run held out."""
    t = p.simulated.time - p.simulated.time[0]
    ends = {
        name: Measure(m.measured, m.simulated, 0.96 * m.simulated, 1.035 * m.simulated) if m.simulated else m
        for name, m in p.measures.items()
    }
    held = p.role == "validation"
    return replace(
        p,
        measures=ends,
        half_width={"psi": 0.02 + 0.0012 * t, "x0": 0.5 + 0.03 * t, "y0": 0.5 + 0.05 * t},
        noise_floor={"psi_deg": 1.4, "position_m": 0.19, "r": 0.0004},
        tied_spread={"psi_deg": 0.31, "position_m": 0.08, "overshoot_1_deg": 0.22},
        extrapolation=Extrapolation(1.9, {"yaw_rate": 1.9, "drift": 1.3, "rudder": 1.25, "fastest": 0.98})
        if held
        else None,
    )
