"""One simulated record identified as a user would, and what came of it; results kept in a file a cell at a time.

Shared by `waves.py` and `criteria.py`.
"""

import hashlib
import json
import math
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
from simulated_seas import Craft, SimulatedRun

import seatrial as st

WINDOW = "30s"  # windows in which left-out runs are predicted: some three time constants of the ships; chosen
SOURCE = "drawn about the truth, for this benchmark"
ANY_ZERO = math.radians(10.0)  # rad, prior deviation of a rudder's zero that says as good as nothing; chosen


@dataclass(frozen=True)
class Outcome:
    """What one fit came to.

    Attributes:
        draw: number of the record. refusal: the sentence by which it was refused; empty: it was not.
        estimate, lower, upper: of each free coefficient; an end that is open is None.
        whole, windows: rms of the left-out run against what was measured: psi [deg], position [m] where measured.
        motion: the same of the whole run against the craft's own motion, without waves and noise.
        seconds: of CPU; bound: standard errors at the truth; empty: not computed. findings: their codes.
        extra: what a benchmark adds, such as the CPU seconds of the same record without waves.
    """

    draw: int
    refusal: str = ""
    estimate: Mapping[str, float] = field(default_factory=dict)
    lower: Mapping[str, float | None] = field(default_factory=dict)
    upper: Mapping[str, float | None] = field(default_factory=dict)
    is_converged: bool = False
    criterion: str = ""
    disturbance: str = ""
    whole: Mapping[str, float] = field(default_factory=dict)
    windows: Mapping[str, float] = field(default_factory=dict)
    motion: Mapping[str, float] = field(default_factory=dict)
    seconds: float = math.nan
    bound: Mapping[str, float] = field(default_factory=dict)
    findings: tuple[str, ...] = ()
    extra: Mapping[str, float] = field(default_factory=dict)


def trial_of(
    craft: Craft, train: SimulatedRun, held: SimulatedRun, settings: st.EstimateSettings, draw: int
) -> st.Trial:
    """Return a trial of one training and one left-out run; priors of the craft are drawn about the truth."""
    model, rng = craft.model, np.random.default_rng([draw, 99])  # a stream of its own
    truth = craft.truth
    if craft.prior:
        deviations = {name: craft.prior * abs(value) for name, value in truth.items()}
        # no further than 1.5 deviations, so that no mass or damping changes its sign
        means = {n: truth[n] + d * float(np.clip(rng.standard_normal(), -1.5, 1.5)) for n, d in deviations.items()}
        priors = {n: st.Prior(mean, deviations[n], SOURCE) for n, mean in means.items()}
        model = model.with_parameters(model.parameters.with_values(means).with_priors(priors))
    else:
        model = model.with_values(dict(craft.guess))
    runs = (st.Run(train.record, session="day"), st.Run(held.record, st.Role.VALIDATE, session="day"))
    return st.Trial(craft.ship, runs, model, settings, truth=truth)


def outcome(trial: st.Trial, held: SimulatedRun, draw: int) -> Outcome:
    """Identify a trial and return what came of it."""
    began = time.process_time()
    try:
        fit = st.identify(trial, windows=WINDOW)
    except st.InputError as error:
        return Outcome(draw, str(error), seconds=time.process_time() - began)
    except Exception as error:  # a failure of the package is a result of this benchmark
        return Outcome(draw, f"{type(error).__name__}: {error}", seconds=time.process_time() - began)
    seconds = time.process_time() - began
    if not fit.validation:
        said = "; ".join(f"{f.code}: {f.message}" for f in fit.findings if f.code == "not-predicted")
        return Outcome(draw, said or "the held-out run was not predicted", seconds=seconds)
    free = [c for c in fit.coefficients if not c.fixed]
    prediction = fit.validation[0]
    scores = prediction.windows[0].scores if prediction.windows else {}
    return Outcome(
        draw, "", {c.name: float(c.estimate) for c in free}, {c.name: _end(c.lower) for c in free},
        {c.name: _end(c.upper) for c in free}, fit.solution.status.is_success, fit.method.criterion,
        fit.noise_model.disturbance if fit.noise_model else "", {k: float(v) for k, v in prediction.rms.items()},
        {k: float(s.rms) for k, s in scores.items()}, motion_errors(prediction.simulated, held), seconds,
        findings=tuple(sorted({f.code for f in fit.findings})),
    )  # fmt: skip


def _end(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def motion_errors(simulated: st.Record, held: SimulatedRun) -> dict[str, float]:
    """Return rms differences from the craft's own motion; infinite where the simulation diverges."""
    rows = np.round((simulated.time - held.record.time[0]) / held.step).astype(int)
    here = np.round((held.record.time - held.record.time[0]) / held.step).astype(int)
    at = np.searchsorted(here, rows).clip(0, len(here) - 1)
    errors = {"psi_deg": np.degrees(simulated["psi"] - held.motion["psi"][at])}
    if "x0" in held.record.channels:
        gaps = [simulated[c] - held.motion[c][at] for c in ("x0", "y0")]
        errors["position_m"] = np.hypot(*gaps)
    rms = {name: float(np.sqrt(np.mean(e**2))) for name, e in errors.items()}
    return {name: value if math.isfinite(value) else math.inf for name, value in rms.items()}


def digest(runs: Sequence[SimulatedRun]) -> str:
    """Return a hash of the recorded values."""
    found = hashlib.sha256()
    for run in runs:
        for name in sorted(run.record.channels):
            found.update(np.ascontiguousarray(run.record[name]).tobytes())
    return found.hexdigest()[:12]


def commit() -> str:
    """Return the commit of the checkout."""
    run = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False)
    return run.stdout.strip()


class ResultFile:
    """Results by cell in a JSON file, written anew after each cell, so that what is interrupted can be continued."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.cells: dict[str, dict] = json.loads(path.read_text("utf-8")) if path and path.exists() else {}

    def draws(self, key: str) -> set[int]:
        """Return the numbers of the records of a cell that are there."""
        return {record["draw"] for record in self.cells.get(key, {}).get("records", [])}

    def add(self, key: str, cell: Mapping[str, object], outcomes: Sequence[Outcome], data: str, **more: object) -> None:
        """Keep further records of a cell, and what a benchmark says of it besides."""
        kept = self.cells.setdefault(key, {"cell": dict(cell), "records": []})
        kept.update(more, commit=commit(), data=data)
        kept["records"] += [asdict(one) for one in outcomes]
        if self.path is not None:
            whole = self.path.with_suffix(".tmp")
            whole.write_text(json.dumps(self.cells, indent=1, default=float) + "\n", "utf-8")
            whole.replace(self.path)

    def outcomes(self, key: str) -> list[Outcome]:
        """Return the records of a cell."""
        return [Outcome(**record) for record in self.cells.get(key, {}).get("records", [])]
