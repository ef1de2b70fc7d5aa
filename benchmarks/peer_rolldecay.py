"""Run by the peer's own Python: decays of `task.npz` fitted by classes of rolldecay-estimators, into `peer.json`.

The classes know no angle of rest: our estimate of it is taken off. They begin at the first angle and rate as recorded,
so a release by hand would count against them: they get each decay from several rows on. Each class searches with its
own start (at the release) and with one by derivatives of the record, which its cubic class needs.
Usage: python peer_rolldecay.py FOLDER
"""

import json
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from rolldecayestimators.direct_estimator_cubic import (
    EstimatorCubic,
    EstimatorLinear,
    EstimatorQuadratic,
    EstimatorQuadraticB,
    EstimatorQuadraticBandC,
)
from scipy.signal import savgol_filter

CLASSES = {
    "linear damping": EstimatorLinear,
    "quadratic damping": EstimatorQuadraticB,
    "quadratic damping, cubic restoring": EstimatorQuadraticBandC,
    "quadratic damping, fifth-order restoring": EstimatorQuadratic,
    "cubic damping, fifth-order restoring": EstimatorCubic,
}
EVALUATIONS = 200


def decay(time_s: np.ndarray, swing: np.ndarray) -> pd.DataFrame:
    """The angle from its rest with smoothed derivatives, as the classes want it."""
    dt = time_s[1] - time_s[0]
    columns = {"phi": swing}
    columns |= {f"phi{k}d": savgol_filter(swing, 11, 4, deriv=k, delta=dt) for k in (1, 2)}
    return pd.DataFrame(columns, index=time_s - time_s[0])


def later(data: pd.DataFrame, row: int) -> pd.DataFrame:
    """The record from a row on."""
    cut = data.iloc[row:].copy()
    cut.index = cut.index - cut.index[0]
    return cut


def fitted(kind: type, data: pd.DataFrame, start: dict[str, float]) -> dict[str, object]:
    """R2 and seconds of one search; the reason where it fails."""
    began = time.perf_counter()
    try:
        estimator = kind(maxfev=EVALUATIONS, ftol=1e-10, p0=start)
        estimator.assert_success = False
        estimator.fit(data)
        score = float(estimator.score(data))
    except Exception as error:
        return {"r2": None, "why": f"{type(error).__name__}: {error}"[:120], "seconds": time.perf_counter() - began}
    return {"r2": score if np.isfinite(score) else None, "why": "", "seconds": time.perf_counter() - began}


def by_derivatives(kind: type, data: pd.DataFrame) -> dict[str, float]:
    """Coefficients from accelerations, for a start."""
    estimator = kind(fit_method="derivation")
    estimator.fit(data)
    return {k: max(v, 1e-6) if k == "B_1A" else v for k, v in estimator.parameters.items()}


def main(folder: Path) -> None:
    """All classes on all decays; keys: run, class, then the row they begin at."""
    warnings.simplefilter("ignore")
    task, made = np.load(folder / "task.npz"), {}
    for run in task["runs"]:
        data = decay(task[f"{run}/time"], task[f"{run}/phi"])
        for name, kind in CLASSES.items():
            begin = by_derivatives(kind, data)
            made.setdefault(str(run), {})[name] = {
                "its own start": fitted(kind, data, {}),
                **{str(k): fitted(kind, later(data, k), begin) for k in task[f"{run}/rows"].tolist()},
            }
    (folder / "peer.json").write_text(json.dumps(made))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
