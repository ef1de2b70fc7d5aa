"""A fabricated fit of a published search, beside the package's own."""

from dataclasses import replace

import numpy as np

from seatrial.core.results import Fit, Method, ReferenceEstimate, Search, SearchRestart

RISE = 1.02
"""By how much the used restart is off the package's own estimate."""


def published(fit: Fit, fitness: str = "record") -> Fit:
    """The fit as if a wild horse optimiser had found 2 % more than the package's own estimate."""
    free = [c for c in fit.coefficients if not c.fixed]

    def restart(factor: float, level: float) -> SearchRestart:
        values = {c.name: c.estimate * factor for c in free}
        return SearchRestart(values, level, 120, 0.5, (0.9, 0.5, level))

    restarts = (restart(0.9, 0.3), restart(RISE, 0.2))
    search = Search(
        fitness, 40, 3, {c.name: (-10.0 * abs(c.estimate), 10.0 * abs(c.estimate)) for c in free}, {"r": 0.01},
        240, 1.0,
        restarts[1].history, 1, restarts, {c.name: 0.1 * abs(c.estimate) for c in free},
        trace={c.name: (c.estimate, 1.1 * c.estimate, RISE * c.estimate) for c in free},
    )  # fmt: skip
    reference = ReferenceEstimate(
        fit.coefficients, fit.method, 7, 0.25, {p.record: p.rms for p in fit.predictions}, record_rms=0.1
    )
    method = Method("improved wild horse optimiser (Qi et al. 2025)", "points drawn", "none: the method gives none",
                    settings={"population": 40}, name="iwho")  # fmt: skip
    coefficients = tuple(
        c if c.fixed else replace(c, estimate=RISE * c.estimate, standard_error=None, lower=None, upper=None)
        for c in fit.coefficients
    )
    return replace(
        fit, coefficients=coefficients, covariance=np.empty((0, 0)), method=method, identifiability=None,
        noise_model=None, baselines=(), search=search, reference=reference,
    )  # fmt: skip
