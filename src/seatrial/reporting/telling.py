"""What this record can and cannot tell: the values of a fit in words for a naval architect; nothing is computed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures import decades
from seatrial.core.figures.plot import unit_of
from seatrial.core.figures.profiles import profiles
from seatrial.core.results import Consequence, Direction, Disturbance, Fit, Identifiability, Member, Stability, Symmetry
from seatrial.core.text import words
from seatrial.core.text.numbers import DASH, fixed, rounded, significant
from seatrial.core.values import display
from seatrial.reporting.tables import assumption

WELL, VAGUE = 0.1, 1.0
STANDS_IN = 10.0
WHITE = 0.01
MOVES, FIRST_TEXTS, FIRST_ROWS, FIRST_DIRECTIONS, FIRST_BARS = 5, 5, 10, 16, 20


@dataclass(frozen=True)
class Structural:
    """A change no record can show, and what is assumed of the parameters in it; `is_open`: nothing is."""

    text: str
    assumed: tuple[str, ...]
    further: tuple[str, ...]
    is_open: bool


@dataclass(frozen=True)
class Zone:
    """How many combinations are told well, vaguely or not; `key` names the colour."""

    key: str
    title: str
    text: str


@dataclass(frozen=True)
class ConsequenceRow:
    """What a wrong assumed value would do."""

    parameter: str
    change: str
    moves: str
    misfit: str


@dataclass(frozen=True)
class NoiseRow:
    """Noise of a state or channel in the unit people read."""

    name: str
    meaning: str
    value: str
    unit: str


@dataclass(frozen=True)
class NoiseWords:
    """Criterion, whiteness and intensities."""

    method: str
    text: str
    whiteness: str
    process: tuple[NoiseRow, ...]
    quiet: str
    measurement: tuple[NoiseRow, ...]


@dataclass(frozen=True)
class FamilyRow:
    """One model of the family; `standing`: tied, worse or failed, and whether it is used."""

    name: str
    free: int
    heading: str
    position: str
    roll: str
    standing: str
    note: str
    is_chosen: bool


@dataclass(frozen=True)
class Telling:
    """Everything the section shows; empty parts are left out of the page."""

    is_examined: bool
    structural: tuple[Structural, ...]
    determined: str
    zones: tuple[Zone, ...]
    directions: Markup
    weakest: tuple[str, ...]
    weaker: tuple[str, ...]
    further: str
    condition: str
    collinear: tuple[tuple[str, str, str, str], ...]
    collinear_more: tuple[tuple[str, str, str, str], ...]
    are_sensitivities: bool
    sensitivities: Markup
    sensitivities_more: str
    consequences: tuple[ConsequenceRow, ...]
    said: tuple[str, ...]
    stability: str
    noise: NoiseWords | None
    profiles: Markup
    unbounded: str
    family: tuple[FamilyRow, ...]
    has_notes: bool
    rolls: bool


def telling(fit: Fit) -> Telling | None:
    """The section, or None where the fit holds nothing of it."""
    known = fit.identifiability
    if known is None and fit.disturbance is None and not fit.family:
        return None
    has = known or Identifiability((), (), math.nan, math.nan)
    names = [c.name for c in fit.coefficients]
    strongest = sorted(has.sensitivities, key=lambda s: -s.effect)
    pairs = _collinear(has)
    texts = tuple(words.sentence(d.text, names) for d in has.directions if d.standard_deviation >= WELL)
    return Telling(
        is_examined=known is not None,
        structural=tuple(_structural(s, fit, names) for s in has.structural),
        determined=determined(fit),
        zones=_zones(has.directions),
        directions=Markup(decades.directions(has.directions[:FIRST_DIRECTIONS])),
        weakest=texts[:FIRST_TEXTS],
        weaker=texts[FIRST_TEXTS:],
        further=_further(has.directions[FIRST_DIRECTIONS:]),
        condition=rounded(has.condition) if math.isfinite(has.condition) else "",
        collinear=tuple(pairs[:FIRST_ROWS]),
        collinear_more=tuple(pairs[FIRST_ROWS:]),
        are_sensitivities=bool(strongest),
        sensitivities=Markup(decades.sensitivities(strongest[:FIRST_BARS])),
        sensitivities_more=_small(len(strongest) - FIRST_BARS),
        consequences=tuple(_consequence(c) for c in has.consequences),
        said=tuple(words.sentence(c.text, names) for c in has.consequences if c.text),
        stability=_stability(has.stability, names) if has.stability else "",
        noise=_noise(fit.disturbance, names) if fit.disturbance else None,
        profiles=Markup(profiles(has.profiles, {c.name: c.unit for c in fit.coefficients})),
        unbounded=_unbounded(has),
        family=tuple(_member(m) for m in fit.family),
        has_notes=any(m.note for m in fit.family),
        rolls=any(m.roll_deg is not None for m in fit.family),
    )


def determined(fit: Fit) -> str:
    """How many coefficients the records determine, one sentence; empty where that is not known."""
    known = fit.identifiability
    free = [c for c in fit.coefficients if not c.fixed]
    if known is None or not math.isfinite(known.effective_parameters):
        return ""
    number = round(known.effective_parameters)
    if number >= len(free):
        return f"The records determine all {len(free)} free coefficients."
    rest = "comes from the priors" if any(c.prior_mean is not None for c in free) else "is left open"
    return f"The records determine about {number} of {len(free)} free coefficients; the rest {rest}."


def _structural(s: Symmetry, fit: Fit, names: Sequence[str]) -> Structural:
    inside = sorted((c for c in fit.coefficients if c.name in s.parameters), key=lambda c: not c.fixed)
    assumed = tuple(text for text in (assumption(c) for c in inside) if text)
    return Structural(
        words.sentence(s.text, names),
        assumed[:FIRST_TEXTS],
        assumed[FIRST_TEXTS:],
        is_open=bool(inside) and not assumed,
    )


def _zones(items: Sequence[Direction]) -> tuple[Zone, ...]:
    if not items:
        return ()
    spreads = [d.standard_deviation for d in items]
    well = sum(s < WELL for s in spreads)
    vague = sum(WELL <= s < VAGUE for s in spreads)
    rest = len(items) - well - vague
    return (
        Zone("well", "Told well", f"{words.counted(well, 'combination')}, to better than 10 %"),
        Zone("vague", "Told vaguely", f"{words.counted(vague, 'combination')}, to between 10 % and 100 %"),
        Zone("not", "Not told", f"{words.counted(rest, 'combination')}, to no better than 100 %"
             + (": there a prior or an assumption speaks, not the record" if rest else "")),
    )  # fmt: skip


def _further(rest: Sequence[Direction]) -> str:
    if not rest:
        return ""
    worst = 100.0 * max(d.standard_deviation for d in rest)
    number = words.counted(len(rest), "further combination").capitalize()
    return f"{number} not drawn, {significant(worst, 2)} % or better."


def _collinear(known: Identifiability) -> list[tuple[str, str, str, str]]:
    items = sorted(known.collinearity, key=lambda c: -c.variance_inflation)
    return [
        (c.parameter, significant(c.variance_inflation, 2) if math.isfinite(c.variance_inflation) else "∞", c.partner,
         fixed(c.correlation, 2))
        for c in items
        if c.variance_inflation > STANDS_IN
    ]  # fmt: skip


def _small(rest: int) -> str:
    return (
        f" {words.counted(rest, 'further coefficient').capitalize()} with smaller effects not drawn."
        if rest > 0
        else ""
    )


def _consequence(c: Consequence) -> ConsequenceRow:
    largest = list(c.moves.items())[:MOVES]
    moves = ", ".join(f"{name} {words.signed_percent(move)}" for name, move in largest)
    return ConsequenceRow(c.parameter, words.signed_percent(c.change), moves or DASH, significant(c.misfit, 2))


def _stability(s: Stability, names: Sequence[str]) -> str:
    value = f"C = {significant(s.index, 2)} [{significant(s.lower, 2)}, {significant(s.upper, 2)}]"
    return f"{words.sentence(s.text, names)} {value}.".strip()


def _noise(d: Disturbance, names: Sequence[str]) -> NoiseWords:
    p = "p < 0.001" if d.whiteness_p < 0.001 else f"p = {significant(d.whiteness_p, 2)}"
    if not math.isfinite(d.whiteness_p):
        whiteness = ""
    elif d.whiteness_p >= WHITE:
        whiteness = f"What is left looks like noise: it is white in every channel (smallest {p})."
    else:
        whiteness = (
            f"What is left is not white (smallest {p}): model error or disturbances remain that this criterion does "
            "not describe."
        )
    active = {state: q for state, q in d.process.items() if q > 0}
    quiet = [state for state in d.process if state not in active]
    return NoiseWords(
        d.method,
        words.sentence(d.text, names) if d.text else "",
        whiteness,
        tuple(_noise_row(state, q, "/√s") for state, q in active.items()),
        words.listed(quiet),
        tuple(_noise_row(channel, s, "") for channel, s in d.measurement.items()),
    )


def _noise_row(name: str, value: float, ending: str) -> NoiseRow:
    si = unit_of(name)
    unit = words.unit(si)
    return NoiseRow(name, words.channel(name), significant(value * display(si)[0], 2), f"{unit or '1'}{ending}"
                    if ending else unit)  # fmt: skip


def _unbounded(known: Identifiability) -> str:
    loose = [p.parameter for p in known.profiles if p.lower is None or p.upper is None]
    if not loose:
        return ""
    return f"Not bounded within the values tried: {words.listed(loose)}."


def _member(m: Member) -> FamilyRow:
    failed = m.heading_deg is None and m.position_m is None and m.roll_deg is None
    standing = "failed" if failed else "tied" if m.tied else "worse"
    standing = f"used, {standing}" if m.chosen else standing
    return FamilyRow(m.name, m.free, significant(m.heading_deg, 3), significant(m.position_m, 3),
                     significant(m.roll_deg, 3), standing, m.note, m.chosen)  # fmt: skip
