"""What two fits differ in: coefficients, and the conditions that they were made under."""

from collections.abc import Mapping, Sequence

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.results.comparison import ComparedFit, Difference, JointTest
from seatrial.core.text.numbers import exact
from seatrial.core.values import Finding, Record, Severity
from seatrial.data.trial.records import approach_condition
from seatrial.estimation.information.differences import QuantityInterval, differences, joint_test

_ROUNDING, _ALIKE = 1e-6, 5e-3
"""Relative differences up to which two stated values, and two measured approaches, count as the same; chosen."""


_MOST_NAMES = 4
"""Training runs that are named; more are counted; chosen."""


def compared_fit(fit: Fit, name: str) -> ComparedFit:
    """Return what a fit is, in words."""
    records = tuple(r.name for r in _training_records(fit))
    return ComparedFit(name, fit.ship.name, fit.model.name, fit.method.criterion, fit.intervals, records)


def coefficient_differences(first: Fit, second: Fit) -> tuple[tuple[Difference, ...], JointTest | None]:
    """Return differences of the coefficients that are free in both fits of one model, and the test of all together."""
    if first.model.name != second.model.name:
        return (), None
    free = [{c.name: c for c in fit.coefficients if not c.fixed} for fit in (first, second)]
    names = [name for name, c in free[0].items() if name in free[1] and free[1][name].unit == c.unit]
    first_values, second_values = (
        [QuantityInterval(n, one[n].unit, one[n].estimate, one[n].lower, one[n].upper) for n in names] for one in free
    )
    covariances = [_covariance(fit, names) for fit in (first, second)]
    apart = np.array([free[1][n].estimate - free[0][n].estimate for n in names])
    both = [c for c in covariances if c is not None]
    test = joint_test(apart, both[0] + both[1]) if len(both) == len(covariances) else None
    return differences(first_values, second_values), test


def _covariance(fit: Fit, names: Sequence[str]) -> np.ndarray | None:
    """Covariance of some free coefficients; None where the fit has none."""
    free = list(fit.model.parameters.free_names)
    if fit.covariance.shape != (len(free), len(free)):
        return None
    rows = [free.index(n) for n in names]
    return fit.covariance[np.ix_(rows, rows)]


def changes(first: Fit, second: Fit) -> tuple[str, ...]:
    """Return what else differs between two fits: ship, approach, model, records, criterion; a sentence each."""
    particulars = _changed(first.ship.particulars, second.ship.particulars, _ROUNDING)
    approaches = [approach_condition(_training_records(f), f.model) for f in (first, second)]
    approach = _changed(approaches[0], approaches[1], _ALIKE)
    free = [set(f.model.parameters.free_names) for f in (first, second)]
    pairs = {
        "ship": (first.ship.name, second.ship.name),
        "model": (first.model.name, second.model.name),
        "criterion": (first.method.criterion, second.method.criterion),
        "intervals": (first.intervals, second.intervals),
    }
    texts = [f"{name}: {a} → {b}" for name, (a, b) in pairs.items() if a != b]
    texts += [f"particulars: {', '.join(particulars)}"] if particulars else []
    texts += [f"approach: {', '.join(approach)}"] if approach else []
    for text, names in (("only in the first", free[0] - free[1]), ("only in the second", free[1] - free[0])):
        texts += [f"free {text}: {', '.join(sorted(names))}"] if names else []
    runs = [[r.name for r in _training_records(f)] for f in (first, second)]
    if runs[0] != runs[1]:
        texts.append(f"training runs: {_listed(runs[0])} → {_listed(runs[1])}")
    return tuple(texts)


def _listed(names: Sequence[str]) -> str:
    """The names, or how many there are."""
    return ", ".join(names) if len(names) <= _MOST_NAMES else f"{len(names)} runs"


def _changed(first: Mapping[str, float], second: Mapping[str, float], tolerance: float) -> list[str]:
    """Name with both values, of those that differ by more than a share of them; a dash where one is not stated."""
    texts = []
    for name in dict.fromkeys([*first, *second]):
        a, b = first.get(name), second.get(name)
        if a is None or b is None or abs(a - b) > tolerance * max(abs(a), abs(b)):
            texts.append(f"{name} {exact(a, 4)} → {exact(b, 4)}")
    return texts


def findings(first: Fit, second: Fit) -> tuple[Finding, ...]:
    """Return a warning where fits share records, and where their models cannot be compared by coefficients."""
    warnings = []
    contents = {_content(r) for r in _training_records(first)}
    shared = [r.name for r in _training_records(second) if _content(r) in contents]
    if shared:
        warnings.append(Finding(
            Severity.WARNING, "shared-records", "both fits use the same records, so that their errors are not "
            "independent: intervals of the differences hold for independent ones and are mostly too wide here",
            f"{len(shared)} of {len(_training_records(second))} training runs", "compare fits of different records",
        ))  # fmt: skip
    if first.model.name != second.model.name:
        warnings.append(Finding(
            Severity.INFO, "other-model", f"a {first.model.name} and a {second.model.name} model have no coefficients "
            "in common; manoeuvres are compared alone", "", "identify both with one model",
        ))  # fmt: skip
    return tuple(warnings)


def _content(record: Record) -> bytes:
    """What makes a record the same under any name."""
    return b"".join(record[c].tobytes() for c in sorted(record.channels))


def _training_records(fit: Fit) -> list[Record]:
    held_out = {p.record for p in fit.validation}
    return [r for r in fit.records if r.name not in held_out]
