"""Draws from the posterior on the page: credible intervals next to the others, how far the chains agree, densities."""

from dataclasses import dataclass

from markupsafe import Markup

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import CredibleInterval, Posterior
from seatrial.core.text.numbers import estimate_text, fixed
from seatrial.core.values import display_unit
from seatrial.core.values.notation import unit_text
from seatrial.reporting.figures.posterior_densities import posterior_densities
from seatrial.reporting.text_tables import TextTable

_HEADER = ("Coefficient", "", "mean", "sd", "95 % credible", "without sampling", "R-hat", "independent draws")


@dataclass(frozen=True)
class PosteriorPart:
    """The table with its sentences, and the figure."""

    table: TextTable
    densities: Markup


def posterior_part(posterior: Posterior) -> PosteriorPart:
    """Return what the page shows of the draws."""
    numeric = (False, False, *(True for _ in _HEADER[2:]))
    note = f"{' '.join(posterior.sentences)} Without sampling: {posterior.other_intervals}."
    rows = tuple(_row(c) for c in posterior.coefficients)
    table = TextTable("Draws from what records and priors leave open", _HEADER, numeric, rows, note)
    return PosteriorPart(table, Markup(svg(posterior_densities(posterior))))


def _row(c: CredibleInterval) -> tuple[str, ...]:
    factor = display_unit(c.unit)[0]
    mean, sd, *ends = (
        factor * v for v in (c.mean, c.standard_deviation, c.lower, c.upper, c.other_lower, c.other_upper)
    )
    own, other = (estimate_text(mean, sd, low, high) for low, high in (ends[:2], ends[2:]))
    cells = (own.value + own.power, own.error, f"[{own.lower}, {own.upper}]", f"[{other.lower}, {other.upper}]")
    return (c.name, unit_text(c.unit), *cells, fixed(c.r_hat, 3), fixed(c.effective_size, 0))
