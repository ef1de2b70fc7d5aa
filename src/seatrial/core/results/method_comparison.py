"""A published method set beside the package's own estimate, as tables of text for terminal and page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results.coefficients import Coefficient
from seatrial.core.results.fit import Fit
from seatrial.core.results.published_method import ReferenceEstimate
from seatrial.core.text.numbers import exact, significant
from seatrial.core.text.words import counted

OWN_NAME = "seatrial"
"""What the tables call the package's own estimate."""
# significant digits of estimates, of other numbers
_DIGITS, _FEW_DIGITS = 5, 3


@dataclass(frozen=True)
class ComparisonTable:
    """Rows of text below a header; the first column is flush left, the others are numbers."""

    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


def coefficient_comparison(fit: Fit, reference: ReferenceEstimate) -> ComparisonTable:
    """Return each free coefficient by the method, and by the package with its interval; SI."""
    scatter = fit.search.scatter if fit.search else {}
    compared = {c.name: c for c in reference.coefficients}
    free = [c for c in fit.coefficients if not c.fixed]
    has_truth = any(c.truth is not None for c in free)
    has_intervals = any(compared[c.name].lower is not None for c in free)
    interval_header = ["std. error", "95 % from", "to", "difference/s.e."] if has_intervals else []
    header = ("coefficient", fit.method.name, *(["scatter"] if scatter else []), OWN_NAME, *interval_header,
              *(["known"] if has_truth else []), "unit")  # fmt: skip
    rows = [
        (c.name, exact(c.estimate, _DIGITS), *([significant(scatter[c.name], 2)] if scatter else []),
         exact(compared[c.name].estimate, _DIGITS), *(_interval_cells(c, compared[c.name]) if has_intervals else ()),
         *([exact(c.truth, _DIGITS)] if has_truth else []), c.unit if c.unit != "1" else "")
        for c in free
    ]  # fmt: skip
    return ComparisonTable(header, tuple(rows))


def cost_comparison(fit: Fit, reference: ReferenceEstimate) -> ComparisonTable:
    """Return what each estimate took, and how well it simulates the runs held out, or else the training runs."""
    role = "validation" if fit.validation else "training"
    runs = [p.record for p in fit.predictions if p.role == role]
    errors = {p.record: p.rms for p in fit.predictions}
    own_rms, rms = pooled_rms(reference.rms, runs), pooled_rms(errors, runs)
    keys = list(own_rms)
    word = "held-out" if role == "validation" else "training"
    header = ("estimate", "evaluations", "CPU s", *(["weighted rms"] if fit.search else []),
              *(f"{word} {key}" for key in keys))  # fmt: skip
    evaluations, cpu_s, level = _method_cost(fit)
    first = (fit.method.name, evaluations, cpu_s, *([level] if fit.search else []),
             *(exact(rms.get(key), _FEW_DIGITS) for key in keys))  # fmt: skip
    second = (OWN_NAME, str(reference.evaluations), significant(reference.cpu_s, 2),
              *([exact(reference.record_rms, _DIGITS)] if fit.search else []),
              *(exact(own_rms[key], _FEW_DIGITS) for key in keys))  # fmt: skip
    return ComparisonTable(header, (first, second))


def count_inside_own_intervals(fit: Fit, reference: ReferenceEstimate) -> int:
    """Return how many of the method's values lie inside the 95 % intervals of the package's own estimate."""
    intervals = {c.name: (c.lower, c.upper) for c in reference.coefficients}
    free = [(c.estimate, *intervals[c.name]) for c in fit.coefficients if not c.fixed]
    return sum(a is not None and b is not None and a <= value <= b for value, a, b in free)


def inside_own_intervals(fit: Fit, reference: ReferenceEstimate) -> str:
    """Return how many of the method's values the package's own estimate allows, as a clause."""
    count = sum(not c.fixed for c in fit.coefficients)
    inside = count_inside_own_intervals(fit, reference)
    coefficients = f"{counted(count, 'coefficient')} of {fit.method.name}"
    return f"{inside} of the {coefficients} lie inside the 95 % intervals of {OWN_NAME}"


def pooled_rms(errors: Mapping[str, Mapping[str, float]], runs: Sequence[str]) -> dict[str, float]:
    """Return the root of the mean square of each error over the runs that have it."""
    run_errors = [errors[run] for run in runs if run in errors]
    keys = dict.fromkeys(key for table in run_errors for key in table)
    return {key: float(np.sqrt(np.mean([table[key] ** 2 for table in run_errors if key in table]))) for key in keys}


def _interval_cells(c: Coefficient, reference: Coefficient) -> tuple[str, str, str, str]:
    """Standard error and interval of the package's own estimate, and the method's difference from it."""
    lower, upper = (exact(end, _DIGITS) for end in (reference.lower, reference.upper))
    return significant(reference.standard_error, 2), lower, upper, _difference(c, reference)


def _difference(c: Coefficient, reference: Coefficient) -> str:
    error = reference.standard_error
    return significant((c.estimate - reference.estimate) / error, 2) if error else ""


def _method_cost(fit: Fit) -> tuple[str, str, str]:
    """Evaluations, processor time and weighted rms of the method."""
    search = fit.search
    if search is None:
        seconds = fit.method.settings.get("processor time, s")
        return str(fit.solution.evaluations), significant(seconds, 2) if isinstance(seconds, float) else "", ""
    level = search.restarts[search.used].record_rms
    return str(search.evaluations), significant(search.cpu_s, 2), exact(level, _DIGITS)
