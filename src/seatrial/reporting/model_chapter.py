"""Chapters on the model and the method: equations with their sources, how the estimate came about, references."""

from collections.abc import Mapping

from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import LatexEquation, latex_equations
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit
from seatrial.core.text.numbers import duration, exact
from seatrial.core.text.words import sentence
from seatrial.core.values import NOTATION, quantity
from seatrial.core.values.notation import channel_letter, channel_meaning
from seatrial.reporting.citations import Citations
from seatrial.reporting.figures.search_charts import attempts_chart
from seatrial.reporting.mathml import pieces
from seatrial.reporting.section import Level, Picture, Section, fact_table
from seatrial.reporting.summary import convergence_sentence, search_status

_LJUNG_BOX = "Ljung & Box 1978, On a measure of lack of fit in time series models, Biometrika 65, 297–303"
_MARQUARDT = (
    "Marquardt 1970, Generalized inverses, ridge regression, biased linear estimation, and nonlinear estimation, "
    "Technometrics 12, 591–612"
)
_IMO = "IMO 2002, Standards for ship manoeuvrability, resolution MSC.137(76)"
_ATTEMPTS = (
    "Loss (negative log-likelihood, the noise of each channel at its residuals’ own) of each search above the lowest "
    "end, where it started and where it ended; 0: the search that the estimate goes on from, ∞: the model diverges "
    "there."
)


def equation_section(model: Model, citations: Citations) -> Section:
    """Return the chapter on the equations of the model, each with its source."""
    lines = latex_equations(model)
    rates, definitions = ([e for e in lines if e.is_rate is which] for which in (True, False))
    about = sentence(model.equations.meaning) if model.equations.meaning else ""
    return Section(
        "Equations of the model",
        "model",
        sentences=(f"{about} {sign_conventions(model)} SI units, angles in radians.".strip(),),
        parts=(
            Section("Rates of the states", widget=_equations(rates, citations)),
            Section(
                f"Definitions ({len(definitions)}), in order of calculation",
                widget=_equations(definitions, citations),
                is_folded=True,
            ),
        ),
        level=Level.PAGE,
        is_folded=True,
    )


def _equations(lines: list[LatexEquation], citations: Citations) -> Markup:
    """The lines, each breaking between its pieces, with unit and source beside them."""
    row = Markup('<div class="equation"><div class="formula">{}</div><div class="from">{}{}</div></div>')
    return Markup("").join(
        row.format(
            Markup("").join(Markup(piece + "<wbr>") for piece in pieces(e.latex)), _unit(e), citations.mark(e.source)
        )
        for e in lines
    )


def _unit(e: LatexEquation) -> str:
    return "" if e.is_rate or e.unit == "1" else f"[{e.unit.replace('^2', '²').replace('^3', '³')}] "


def sign_conventions(model: Model) -> str:
    """Return the sentences on axes and positive directions in a model's equations, as the model declares its inputs."""
    heading = "; heading ψ clockwise from north" if "psi" in model.observables else ""
    sentences = [f"Axes: x forward, y to starboard, z down{heading}."]
    for item in model.inputs:
        letter, usual = channel_letter(item.name), quantity(item.name).positive if item.name in NOTATION else ""
        turned = "when it turns the craft to " if item.name == "delta" else ""
        if item.is_reversed:
            sentences.append(
                f"In these equations {letter} is positive {turned}{item.direction}; records, plots and tables give it "
                f"positive to {usual}."
            )
        elif turned:
            sentences.append(f"{channel_meaning(item.name).capitalize()} {letter} is positive {turned}{usual}.")
    return " ".join(sentences)


def method_section(fit: Fit, citations: Citations) -> Section:
    """Return the chapter on how the estimate came about, with the references of the page."""
    search = (
        f"{fit.search.effort}, all iterations spent"
        if fit.search
        else (f"{search_status(fit)}; {fit.solution.evaluations} evaluations")
    )
    facts: dict[str, str | Markup] = {
        "Criterion": fit.method.criterion,
        "Start": fit.method.start,
        "Intervals": fit.method.intervals,
        "Search": search,
        **{
            f"{key[:1].upper()}{key[1:]}": v if isinstance(v, str) else exact(v)
            for key, v in fit.method.settings.items()
        },
        **({"Ship’s particulars": citations.mark(fit.ship.source)} if fit.ship.source else {}),
        "Seed": str(fit.seed),
        "Elapsed": duration(fit.elapsed_s),
        "Versions": version_text(fit.versions),
    }
    attempts = (Picture(lambda: svg(attempts_chart(fit.search_attempts)), _ATTEMPTS),) if fit.search_attempts else ()
    text = convergence_sentence(fit)
    return Section(
        "Method and provenance",
        "method",
        sentences=(text,) if text else (),
        table=fact_table(facts),
        parts=(
            Section("Searches from several starting points", pictures=attempts),
            Section("Why this method", points=fit.method.reasons),
            Section("References", widget=references(fit, citations)),
        ),
        level=Level.PAGE,
        is_folded=True,
    )


def version_section(versions: Mapping[str, str], facts: Mapping[str, str] | None = None) -> Section:
    """Return the chapter on what a result was computed with."""
    table = fact_table({**(facts or {}), "Versions": version_text(versions)})
    return Section("Provenance", "provenance", table=table, level=Level.PAGE, is_folded=True)


def version_text(versions: Mapping[str, str]) -> str:
    """Return packages with their versions."""
    return ", ".join(f"{package} {version}" for package, version in versions.items())


def references(fit: Fit, citations: Citations) -> Markup:
    """Return the publications that the page cites, in order, and those of its methods."""
    entries = [
        Markup('<li id="reference-{}">{}</li>').format(k + 1, entry) for k, entry in enumerate(citations.entries())
    ]
    named = [_LJUNG_BOX, *([_MARQUARDT] if fit.identifiability and fit.identifiability.collinearity else []), _IMO]
    entries += [Markup("<li>{}</li>").format(text) for text in named]
    return Markup('<ol class="references">{}</ol>').format(Markup("").join(entries))
