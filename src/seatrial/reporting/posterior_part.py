"""Draws from the posterior: credible intervals next to the others, how far the chains agree, densities."""

from seatrial.core.figures.svg_text import svg
from seatrial.core.results import CredibleInterval, Posterior
from seatrial.core.text.numbers import EstimateText, estimate_text, fixed
from seatrial.core.values import display_unit
from seatrial.core.values.notation import unit_text
from seatrial.reporting.figures.posterior_densities import posterior_densities
from seatrial.reporting.section import Picture, Section, name, number, table_of, words

_CAPTION = (
    "Draws of each coefficient; between the lines lie 95 % of them, on the dashed lines the ends of the interval "
    "without sampling."
)


def posterior_section(posterior: Posterior | None) -> Section:
    """Return the part on draws from what records and priors leave open; empty where there are none."""
    if posterior is None:
        return Section("")
    table = table_of(
        posterior.coefficients,
        name("Coefficient", lambda c: c.name),
        words("unit", lambda c: unit_text(c.unit)),
        number("mean", lambda c: f"{_text(c).value}{_text(c).power}"),
        number("sd", lambda c: _text(c).error),
        number("95 % credible", lambda c: f"[{_text(c).lower}, {_text(c).upper}]"),
        number("without sampling", lambda c: f"[{_without(c).lower}, {_without(c).upper}]"),
        number("R-hat", lambda c: fixed(c.r_hat, 3)),
        number("independent draws", lambda c: fixed(c.effective_size, 0)),
    )
    return Section(
        "Draws from what records and priors leave open", sentences=posterior.sentences, table=table,
        note=f"Without sampling: {posterior.other_intervals}.",
        pictures=(Picture(lambda: svg(posterior_densities(posterior)), _CAPTION),),
    )  # fmt: skip


def _text(c: CredibleInterval) -> EstimateText:
    factor = display_unit(c.unit)[0]
    return estimate_text(factor * c.mean, factor * c.standard_deviation, factor * c.lower, factor * c.upper)


def _without(c: CredibleInterval) -> EstimateText:
    factor = display_unit(c.unit)[0]
    return estimate_text(factor * c.mean, factor * c.standard_deviation, factor * c.other_lower, factor * c.other_upper)
