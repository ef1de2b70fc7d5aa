"""The chapter on other estimators: coefficients beside the fit's, the runs they sail, and what they prove."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from markupsafe import Markup

from seatrial.core.figures.scatter import scatter
from seatrial.core.results import Coefficient, Fit, Rival, Sailed, Table
from seatrial.core.results.rival import NO_COMPARISON
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.text.words import counted, listed, sentence, unit
from seatrial.core.values import display
from seatrial.reporting.sheets import Sheet, sheet

NEAR, OFF = 2.0, 10.0
ALIKE = 0.9
_COLUMNS = {
    "psi_deg": ("heading, deg", 1.0), "position_m": ("position, m", 1.0), "u": ("u, m/s", 1.0), "v": ("v, m/s", 1.0),
    "r": ("r, deg/s", math.degrees(1.0)),
}  # fmt: skip


@dataclass(frozen=True)
class Cell:
    """A coefficient as text, the gap to the fit below it, and a word for its size: near, off or far."""

    value: str
    gap: str
    where: str


@dataclass(frozen=True)
class Row:
    """An estimator's coefficients; median and worst are per cent, of the truth where it is known, else of the fit."""

    name: str
    median: str
    worst: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Compared:
    """What the chapter shows; without rows, `said` tells why there is no comparison."""

    said: tuple[str, ...]
    header: tuple[tuple[str, str], ...] = ()
    truth: tuple[str, ...] = ()
    rows: tuple[Row, ...] = ()
    picture: Markup = Markup("")  # noqa: RUF009
    sheets: tuple[Sheet, ...] = ()
    notes: tuple[str, ...] = ()


def rivals(fit: Fit) -> Compared | None:
    """The chapter; None where no comparison was asked for."""
    if not fit.rivals:
        why = [f.text for f in fit.findings if f.code == NO_COMPARISON]
        return Compared((sentence(why[0]),)) if why else None
    known = [c for c in fit.coefficients if not c.fixed]
    first = fit.rivals[0]
    held, fitted = _sailed(fit.rivals, "validation"), _sailed(fit.rivals, "training")
    return Compared(
        said(fit),
        tuple((c.name, unit(c.unit)) for c in known),
        tuple(exact(_shown(c.truth, c), 4) for c in known) if first.error else (),
        tuple(_row(r, first, known) for r in fit.rivals if r.values and (r is first or not r.is_fit)),
        Markup(scatter(_dots(fit.rivals), _axis(first))),
        tuple(sheet(t) for t in (_table("Held-out runs", held), _table("Training runs", fitted)) if t.header[1:]),
        tuple(note for r in fit.rivals for note in _notes(r)),
    )


def said(fit: Fit) -> tuple[str, ...]:
    """Which regression comes nearest, which fail, and what trajectories tell of it."""
    first, others = fit.rivals[0], [r for r in fit.rivals if not r.is_fit]
    solved = [r for r in others if r.values]
    failed = [f"“{r.name}”" for r in others if not r.values]
    lost = [f"“{r.name}”" for r in solved if r.diverged]
    told = [f"{counted(len(others), 'regression').capitalize()} on the same training runs, as recorded."]
    if failed:
        told.append(f"{_many(failed)} of them {'fails' if len(failed) == 1 else 'fail'}: {listed(failed)}.")
    if lost:
        verb = "gives" if len(lost) == 1 else "give"
        told.append(f"{_many(lost)} {verb} coefficients with which a simulated run diverges: {listed(lost)}.")
    if solved:
        told.append(_nearest(first, solved))
    held = sum(c.prior_mean is not None for c in fit.coefficients if not c.fixed)
    if held:
        told.append(f"The fit has priors for {counted(held, 'coefficient')} and the regressions have none, so that "
                    "differences show what the priors do as well.")  # fmt: skip
    return tuple(t for t in (" ".join(told), _of_trajectories(fit, solved)) if t)


def _many(items: Sequence[str]) -> str:
    return "One" if len(items) == 1 else str(len(items))


def _nearest(first: Rival, solved: Sequence[Rival]) -> str:
    best = min(solved, key=lambda r: _middle(r, first))
    if not first.error:
        return f"Nearest to the fit comes “{best.name}”: {_differs(best, first)}."
    own = f"{_share(_middle(first, first))} % and {_share(_worst(first, first))} %"
    return f"Nearest to the known values comes “{best.name}”: {_differs(best, first)}; the fit is {own} off."


def _differs(rival: Rival, first: Rival) -> str:
    off = "off" if first.error else "from the fit"
    return f"{_share(_middle(rival, first))} % {off} in the median, {_share(_worst(rival, first))} % at worst"


def _of_trajectories(fit: Fit, solved: Sequence[Rival]) -> str:
    """How well coefficients that are wrong can sail."""
    first, role = fit.rivals[0], "validation" if fit.validation() else "training"
    alone = [r for r in fit.rivals if r.is_fit][-1]
    counts = [_better(alone, solved, one) for one in dict.fromkeys((role, "training"))]
    told = []
    without = "" if alone is first else ", its offsets set to zero"
    if all(counts):
        told.append(f"Heading nearer the measured one than the fit’s{without}: {' and '.join(counts)}.")
    alike = [r for r in solved if min(_of(r, role).correlation.values(), default=0.0) > ALIKE]
    if alike:
        worst = max(alike, key=lambda r: _middle(r, first))
        least = fixed(min(_of(worst, role).correlation.values()), 3)
        told.append(f"Good trajectories prove nothing about coefficients: those of “{worst.name}” are "
                    f"{_differs(worst, first)}, and yet its u, v and r correlate with the measured ones by {least} or "
                    "better (CC).")  # fmt: skip
    return " ".join(told)


def _better(fit: Rival, solved: Sequence[Rival], role: str) -> str:
    """How many sail runs of a role with a smaller error of heading than the fit; empty where nothing is known."""
    own = _of(fit, role).rms.get("psi_deg")
    headings = [_of(r, role).rms["psi_deg"] for r in solved if "psi_deg" in _of(r, role).rms]
    if own is None or not headings:
        return ""
    runs = "held-out" if role == "validation" else "training"
    number = sum(h < own for h in headings) or "none"
    return f"{number} of the {len(headings)} that sail the {runs} runs"


def _of(rival: Rival, role: str) -> Sailed:
    return rival.validation if role == "validation" else rival.training


def _sailed(items: Sequence[Rival], role: str) -> list[tuple[str, Sailed]]:
    return [(r.name, _of(r, role)) for r in items if r.values]


def _sizes(rival: Rival, first: Rival) -> list[float]:
    return [abs(a) for a in rival.away(first).values()] or [math.nan]


def _middle(rival: Rival, first: Rival) -> float:
    return median(_sizes(rival, first))


def _worst(rival: Rival, first: Rival) -> float:
    return max(_sizes(rival, first))


def _share(value: float) -> str:
    return significant(100.0 * value, 2)


def _shown(value: float | None, c: Coefficient) -> float | None:
    return None if value is None else value * display(c.unit)[0]


def _row(rival: Rival, first: Rival, known: Sequence[Coefficient]) -> Row:
    is_first = rival is first
    away = "" if is_first and not first.error else None
    middle, worst = (_share(part(rival, first)) if away is None else away for part in (_middle, _worst))
    return Row(rival.name, middle, worst, tuple(_error(c) if is_first else _cell(rival, c) for c in known))


def _error(c: Coefficient) -> Cell:
    """The fit's own estimate with its standard error."""
    error = "" if c.standard_error is None else f"± {significant(_shown(c.standard_error, c), 2)}"
    return Cell(significant(_shown(c.estimate, c)), error, "")


def _cell(rival: Rival, c: Coefficient) -> Cell:
    value, gap = significant(_shown(rival.values[c.name], c)), rival.gap.get(c.name)
    if gap is None:
        return Cell(value, "", "")
    where = "near" if abs(gap) <= NEAR else "off" if abs(gap) <= OFF else "far"
    sign = "+" if gap > 0 else ""
    return Cell(value, f"{where}: {sign}{significant(gap, 2)}", where)


def _axis(first: Rival) -> str:
    return "error, per cent of the known value" if first.error else "difference from the fit, per cent of its estimate"


def _dots(items: Sequence[Rival]) -> dict[str, dict[str, tuple[float, bool]]]:
    """Estimator -> coefficient -> size in per cent, and whether it is within two standard errors of the fit."""
    first, made = items[0], {}
    for r in items if first.error else items[1:]:
        if r.is_fit and r is not first:
            continue
        away = r.away(first)
        near = {n: abs(r.gap.get(n, math.inf)) <= NEAR for n in away}
        if away:
            made[r.name] = {n: (100.0 * abs(a), near[n]) for n, a in away.items()}
    return made


def _table(title: str, items: Sequence[tuple[str, Sailed]]) -> Table:
    keys = [k for k in _COLUMNS if any(k in s.rms for _, s in items)]
    channels = list(dict.fromkeys(c for _, s in items for c in s.correlation))
    header = tuple(_COLUMNS[k][0] for k in keys) + tuple(f"CC of {c}" for c in channels)
    rows = []
    for name, s in items:
        errors = [s.rms[k] * _COLUMNS[k][1] if k in s.rms else None for k in keys]
        rows.append((name, *errors, *(s.correlation.get(c) for c in channels)))
    return Table(title, ("Estimator", *header) if header else ("Estimator",), tuple(rows))


def _notes(rival: Rival) -> list[str]:
    """What failed, diverged or was dropped, and constants that were allowed besides."""
    made = [f"{rival.name} failed: {rival.note}"] if rival.note else []
    if rival.diverged:
        made.append(f"{rival.name}: the simulation of {listed(rival.diverged)} diverges")
    made += [f"{rival.name}: {f.text}" for f in rival.findings]
    constants = [f"{significant(b, 2)} in {equations}" for equations, b in rival.bias.items() if b]
    if constants:
        made.append(f"{rival.name}: constants besides the model's terms, {listed(constants)}")
    return made
