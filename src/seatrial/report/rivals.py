"""The chapter on other estimators: coefficients beside the fit's, the runs they sail, and one sentence on what counts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median

from markupsafe import Markup

from seatrial.report.figures.scatter import scatter
from seatrial.report.numbers import exact, fixed, significant
from seatrial.report.sheets import Sheet, sheet
from seatrial.report.words import counted, listed, sentence, unit
from seatrial.results import Coefficient, Fit, Rival, Sailed, Table
from seatrial.results.rival import NO_COMPARISON
from seatrial.values import display

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
    first, others = fit.rivals[0], fit.rivals[1:]
    held, fitted = _sailed(fit.rivals, "validation"), _sailed(fit.rivals, "training")
    return Compared(
        said(fit),
        tuple((c.name, unit(c.unit)) for c in known),
        tuple(exact(_shown(c.truth, c), 4) for c in known) if first.error else (),
        tuple(_row(r, first, known) for r in fit.rivals if r.values),
        Markup(scatter(_dots(fit.rivals), _axis(first))),
        tuple(sheet(t) for t in (_table("Held-out runs", held), _table("Training runs", fitted)) if t.header[1:]),
        tuple(note for r in others for note in _notes(r)),
    )


def said(fit: Fit) -> tuple[str, ...]:
    """Which regression comes nearest, which fail, and what trajectories tell of it."""
    first, others = fit.rivals[0], fit.rivals[1:]
    solved = [r for r in others if r.values]
    failed = [r.name for r in others if not r.values]
    lost = [r.name for r in solved if r.diverged]
    told = [f"{counted(len(others), 'regression').capitalize()} on the same training runs, as recorded: without offsets, "
            "priors or bounds."]  # fmt: skip
    if failed:
        told.append(f"{len(failed)} of them {'fails' if len(failed) == 1 else 'fail'}: {listed(failed)}.")
    if lost:
        verb = "gives" if len(lost) == 1 else "give"
        told.append(f"{len(lost)} {verb} coefficients with which a simulated run diverges: {listed(lost)}.")
    if solved:
        told.append(_nearest(first, solved))
    return tuple(t for t in (" ".join(told), _of_trajectories(fit, solved)) if t)


def _nearest(first: Rival, solved: Sequence[Rival]) -> str:
    best = min(solved, key=lambda r: _middle(r, first))
    numbers = f"{_share(_middle(best, first))} % off in the median, {_share(_worst(best, first))} % at worst"
    if not first.error:
        return f"Nearest to the fit comes {best.name}: {numbers}."
    own = f"{_share(_middle(first, first))} % and {_share(_worst(first, first))} %"
    return f"Nearest to the known values comes {best.name}: {numbers}; the fit is {own} off."


def _of_trajectories(fit: Fit, solved: Sequence[Rival]) -> str:
    """How well coefficients that are wrong can sail."""
    role = "validation" if fit.validation() else "training"
    runs = "held-out runs" if role == "validation" else "training runs"
    told, own = [], _of(fit.rivals[0], role).rms.get("psi_deg")
    headings = [_of(r, role).rms["psi_deg"] for r in solved if "psi_deg" in _of(r, role).rms]
    if own is not None and headings:
        better = sum(h < own for h in headings)
        number = {0: "None", len(headings): "All"}.get(better, f"{better} of {len(headings)}")
        told.append(f"{number} of those that sail the {runs} predict their heading better than the fit.")
    alike = [r for r in solved if min(_of(r, role).correlation.values(), default=0.0) > ALIKE]
    if alike:
        worst = max(alike, key=lambda r: _middle(r, fit.rivals[0]))
        least = min(_of(worst, role).correlation.values())
        told.append(
            f"Good trajectories prove nothing about coefficients: with {worst.name} measured and simulated u, v and r "
            f"correlate by {fixed(least, 3)} or better (CC), and its coefficients are "
            f"{_share(_middle(worst, fit.rivals[0]))} % off in the median, {_share(_worst(worst, fit.rivals[0]))} % "
            "at worst."
        )
    return " ".join(told)


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
    for r in items if items[0].error else items[1:]:
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
        rows.append((name, *errors, *(f"{s.correlation[c]:.3f}" if c in s.correlation else None for c in channels)))
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
