"""A fit nobody made: zigzags of a first-order ship with sensor noise, dressed as a fit of the waterjet model."""

import math
from dataclasses import replace

import numpy as np

from seatrial.core.results import Coefficient, Fit, Measure, Method, Noise, Offset, Prediction, Residuals
from seatrial.core.values import Array, Finding, Prior, Record, Severity, Ship
from seatrial.numerics.optimise import Solution, Status
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.waterjet import waterjet

NOISE = {"u": 0.02, "v": 0.02, "r": math.radians(0.1), "psi": math.radians(0.2), "x0": 0.5, "y0": 0.5}
STEP = 0.2


def zigzag(name: str, angle: float, *, gain: float = 0.11, duration: float = 240.0) -> Record:
    """A zigzag angle/angle [deg] of r' = (K delta - r) / T with a helmsman of 4 deg/s."""
    count = int(duration / STEP)
    psi, r, delta, x, y, side = 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    rows = []
    for i in range(count):
        if i * STEP > 10 and side * psi > math.radians(angle):
            side = -side
        wanted = side * math.radians(angle) if i * STEP > 10 else 0.0
        delta += float(np.clip(wanted - delta, -0.07 * STEP, 0.07 * STEP))
        r += STEP * (gain * delta - r) / 4.0
        psi += STEP * r
        u, v = 0.8 - 4.0 * r * r, -1.2 * r
        x += STEP * (u * math.cos(psi) - v * math.sin(psi))
        y += STEP * (u * math.sin(psi) + v * math.cos(psi))
        rows.append((x, y, psi, u, v, r, delta, 1.866))
    columns = np.array(rows).T
    names = ("x0", "y0", "psi", "u", "v", "r", "delta", "v_j")
    return Record.from_arrays(name, np.arange(count) * STEP, dict(zip(names, columns, strict=True)))


def noisy(record: Record, rng: np.random.Generator) -> Record:
    """The record with sensor noise, as if read from a file."""
    made = record
    for name, deviation in NOISE.items():
        channel = record.channel(name)
        made = made.with_channel(name, channel.with_values(record[name] + deviation * rng.standard_normal(len(record))))
    source = replace(record.provenance, source=f"trials/{record.name}.csv").with_step("resampled to 5 Hz")
    return replace(made, provenance=source)


def fabricated_fit(*, names: tuple[str, ...] = ("zigzag_10_10", "zigzag_20_20", "zigzag_30_30", "zigzag_25_25")) -> Fit:
    """Three training runs and one held out; truth, priors, offsets, findings: everything a report can show."""
    rng = np.random.default_rng(5)
    angles = [10.0, 20.0, 30.0, 25.0] * (len(names) // 4 + 1)
    records = tuple(noisy(zigzag(n, a), rng) for n, a in zip(names, angles, strict=False))
    predictions = tuple(
        _prediction(record, zigzag(record.name, a, gain=0.112), "validation" if k == 3 else "training")
        for k, (record, a) in enumerate(zip(records, angles, strict=False))
    )
    base = waterjet()
    prior = Prior(base.parameters["X_rr"].value * 1.1, 0.001, "Song et al. 2025, 25 % assumed")
    model = base.with_parameters(base.parameters.with_priors({"X_rr": prior}))
    shape = rng.standard_normal((len(COEFFICIENTS), 14))
    spread = np.abs([base.parameters[n].value for n in COEFFICIENTS]) * np.geomspace(0.003, 0.22, len(COEFFICIENTS))
    covariance = np.corrcoef(shape) * np.outer(spread, spread)
    estimates = {
        n: base.parameters[n].value + s * rng.standard_normal() for n, s in zip(COEFFICIENTS, spread, strict=True)
    }
    model = model.with_values(estimates, source="estimated")
    return Fit(
        question="Do noisy zigzags give back known coefficients, and predict manoeuvres that were not fitted?",
        ship=Ship("waterjet craft", {"L": 9.8, "B": 3.17, "d": 0.71, "m": 5540.0}, "Song et al. 2025, table 1"),
        model=model,
        coefficients=tuple(
            _coefficient(model.parameters[n].latex, n, estimates[n], s, base.parameters[n].value, prior)
            for n, s in zip(COEFFICIENTS, spread, strict=True)
        )
        + tuple(
            Coefficient(p.name, p.unit, p.value, None, None, None, True, source=p.source, meaning=p.meaning)
            for p in model.parameters
            if not p.free
        ),
        covariance=covariance,
        solution=Solution(np.array(list(estimates.values())), 5123.4, Status.CONVERGED, 23, (9e4, 6e3, 5123.4), 7),
        method=Method(
            "output error over whole runs",
            "weak form, windows of 3 ship lengths",
            "information matrix of the criterion, corrected for the residuals’ autocorrelation",
            ("the residuals over whole runs are white (Ljung-Box, p 0.3)",),
            {"rate_Hz": 5.0, "window_L": 3.0, "loss": "squares"},
        ),
        offsets=tuple(
            Offset("delta zero", n, "rad", math.radians(0.2 * k - 0.3), math.radians(0.05))
            for k, n in enumerate(names[:3])
        ),
        channel_noise=tuple(
            Noise(c, {"u": "m/s", "v": "m/s", "r": "rad/s"}.get(c, "rad" if c == "psi" else "m"), s, 0.2, p, p > 0.01)
            for (c, s), p in zip(NOISE.items(), (0.41, 0.62, 0.003, 0.08, 0.3, 0.00002), strict=True)
        ),
        residuals=tuple(_residuals(c, s, rng, colour=0.6 if c in ("r", "y0") else 0.0) for c, s in NOISE.items()),
        predictions=predictions,
        findings=(
            Finding(Severity.WARNING, "residual-colour", "Residuals of r and y0 are coloured",
                    "correlation time 0.4 s", "Look for a lag between the gyro and the GNSS, or shorten the segments"),
            Finding(Severity.INFO, "weak-direction", "X_rr, X_vv and Y_vr are known only in combination",
                    "-0.70 X_rr + 0.49 X_vv + 0.47 Y_vr has a standard deviation of 26 %",
                    "A turning circle would tell them apart"),
            Finding(Severity.INFO, "velocity-frame", "u and v of all runs agree with the track", "rms 0.03 m/s"),
        ),
        records=records,
        seed=7,
        elapsed_s=4.21,
        versions={"seatrial": "0.1.0", "python": "3.11.2", "numpy": "2.1.0", "numba": "0.60.0"},
    )  # fmt: skip


def _prediction(measured: Record, simulated: Record, role: str) -> Prediction:
    difference = {s: simulated[s] - measured[s] for s in ("psi", "u", "v", "r", "x0", "y0")}
    rms = {s: float(np.sqrt(np.mean(difference[s] ** 2))) for s in ("u", "v", "r")}
    rms["psi_deg"] = float(np.degrees(np.sqrt(np.mean(difference["psi"] ** 2))))
    rms["position_m"] = float(np.sqrt(np.mean(difference["x0"] ** 2 + difference["y0"] ** 2)))
    measures = {
        "overshoot_1_deg": Measure(8.31, 8.42),
        "overshoot_2_deg": Measure(9.07, 8.88, 8.2, 9.6),
        "initial_turning_L": Measure(1.62, 1.58),
        "approach_speed": Measure(0.8, 0.79),
        "period_s": Measure(62.4, None),
    }
    return Prediction(measured.name, role, measured, simulated, rms, measures, 5.0)


def _coefficient(latex: str, name: str, value: float, error: float, truth: float, prior: Prior) -> Coefficient:
    known = prior if name == "X_rr" else None
    return Coefficient(
        name, "1", value, error, value - 1.96 * error, value + 1.96 * error, False, truth,
        known.mean if known else None, known.standard_deviation if known else None,
        "Song et al. 2025, table 2", "", latex,
    )  # fmt: skip


def _residuals(channel: str, spread: float, rng: np.random.Generator, *, colour: float) -> Residuals:
    values: Array = rng.standard_normal(3600) * spread
    for i in range(1, len(values)):
        values[i] += colour * values[i - 1]
    centred = values - values.mean()
    lags = [float(np.mean(centred[: len(centred) - k] * centred[k:])) for k in range(40)]
    return Residuals(channel, 5.0, values, np.array(lags) / lags[0])
