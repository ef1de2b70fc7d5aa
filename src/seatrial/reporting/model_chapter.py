"""The model's chapter: equations, what stands behind its numbers, sources, and how it was found."""

import html
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from markupsafe import Markup

from seatrial.core.equations import Model
from seatrial.core.equations.latex import LatexEquation, latex_equations
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit, Search
from seatrial.core.text.numbers import duration, exact, percent
from seatrial.core.text.words import counted, enumeration, sentence
from seatrial.core.values import NOTATION, quantity
from seatrial.core.values.notation import channel_letter, channel_meaning
from seatrial.reporting.mathml import pieces
from seatrial.reporting.section import Level, Picture, Section, fact_table

# Publications named in sources, numbered in order of appearance.

_CITATION = re.compile(
    r"(?P<key>[A-Z][\w'’-]+(?: (?:&|and) [A-Z][\w'’-]+| et al\.)? (?:19|20)\d\d)"
    r"(?P<place>, (?:doi 10\.[^\s,;)]+|[A-Z][A-Za-z. ]+? \d+, \d+-\d+))?"
)
_DOI = re.compile(r"doi (10\.[^\s,;)]+)")


class Citations:
    """Numbers publications as texts are marked; the list is complete once everything has been marked."""

    def __init__(self) -> None:
        self._publications: dict[str, str] = {}

    def mark(self, text: str) -> Markup:
        """Return the text, escaped, with ``[k]`` in place of every publication in it."""
        parts, at = [], 0
        for match in _CITATION.finditer(text):
            parts.append(html.escape(text[at : match.start()]))
            parts.append(self._link(match["key"], match[0]))
            at = match.end()
        return Markup("".join([*parts, html.escape(text[at:])]))

    def _link(self, key: str, text: str) -> str:
        if len(text) > len(self._publications.get(key, "")):
            self._publications[key] = text
        number = list(self._publications).index(key) + 1
        return (
            f'<a class="cite" href="#reference-{number}" title="{html.escape(self._publications[key])}">[{number}]</a>'
        )

    def entries(self) -> list[Markup]:
        """Return the publications in order, DOIs as links."""
        linked = r'<a href="https://doi.org/\1">doi:\1</a>'
        return [Markup(_DOI.sub(linked, html.escape(text.replace("-", "\u2013") if "doi" not in text else text)))
                for text in self._publications.values()]  # fmt: skip


# Sentences at the head of a fit's sections: what the ship is, what limits coefficients, residuals and search.

# offset of a rudder or nozzle, and the coefficients of models that have the same effect: hull, side forces of a screw
_STEERING_ZERO, _ASYMMETRIES = "delta zero", ("Y_0", "N_0", "Y_T", "N_T")


def facts(fit: Fit) -> list[str]:
    """Return ship, model and records in a few words each."""
    ship = fit.ship
    trained = [p for p in fit.predictions if p.role == "training"]
    ratio = f"1:{exact(ship.scale)}"
    scale = [f"model scale {ratio}"] if ship.scale != 1.0 and ratio not in ship.name else []
    length = [f"L = {exact(ship.length)} m"] if "L" in ship.particulars else []
    free = sum(not c.fixed for c in fit.coefficients)
    seconds = sum(p.measured.duration for p in trained)
    return [
        *length, *scale, f"model {fit.model.name} with {counted(free, 'free coefficient')}",
        f"fitted to {counted(len(trained), 'run')}, {duration(seconds)} of records", fit.method.criterion,
    ]  # fmt: skip


def residual_sentence(fit: Fit) -> str:
    """Return in which channels the residuals are not white; empty where that is not known."""
    if not fit.channel_noise:
        return ""
    coloured = [n.channel for n in fit.channel_noise if not n.is_white]
    if not coloured:
        return "The residuals are white in all channels (Ljung-Box with 20 and 100 lags)."
    return (
        f"The residuals are not white in {len(coloured)} of {len(fit.channel_noise)} channels "
        f"({enumeration(coloured)}): model error "
        "or disturbances remain."
    )


def convergence_sentence(fit: Fit) -> str:
    """Return that a search did not converge, or how a search by a population ended; empty for one that did."""
    if fit.search is not None:
        return _search_end(fit.search)
    return "" if fit.solution.status.is_success else f"The search did not converge: {search_status(fit)}."


def search_status(fit: Fit) -> str:
    """Return how the search ended, without what only the caller of an optimiser can do about it."""
    return fit.solution.status.value.partition(";")[0]


def steering_zero_note(fit: Fit) -> str:
    """Return what else a rudder or nozzle amidships that turns the ship may come from; empty where all that is free."""
    present = [c for c in fit.coefficients if c.name in _ASYMMETRIES]
    held = [c.name for c in present if c.fixed and c.estimate == 0.0]
    if not any(offset.name == _STEERING_ZERO for offset in fit.offsets) or (present and not held):
        return ""
    where = f"held at zero here ({enumeration(held)})" if held else "which this model does not have"
    return (
        f"{_STEERING_ZERO} is known only as the angle at which the ship goes straight: a side force of the propeller "
        f"or an asymmetric hull, {where}, would look the same."
    )


def _search_end(search: Search) -> str:
    """What a search by a population can say of its end: its restarts and their scatter, no test of convergence."""
    text = f"The search has no test of convergence: it spends all its iterations, here {search.effort}."
    if search.track is not None:
        return text  # a stream is followed once
    used = search.restarts[search.used].values
    shares = {name: sd / abs(used[name]) for name, sd in search.scatter.items() if used[name] != 0.0}
    if not shares:
        return f"{text} More restarts would show how far its values scatter."
    widest = max(shares, key=lambda name: shares[name])
    return f"{text} Its values scatter over the restarts by up to {percent(shares[widest])} % ({widest})."


# Units of a craft whose thrust is not known in newtons: its forces and masses are those on each kilogram.

_FACTOR = re.compile(r"(?P<name>[A-Za-z]+)(\^(?P<power>[\d.]+))?")


def with_mass_specific_units(fit: Fit) -> Fit:
    """Return the fit with the units that its coefficients have: those of the model, or these over kilograms.

    Without a thrust in newtons the equations hold for forces and masses over m + m_x.
    """
    if fit.thruster_craft is None or fit.thruster_craft.force_unit == "N":
        return fit
    return replace(fit, coefficients=tuple(replace(c, unit=mass_specific_unit(c.unit)) for c in fit.coefficients))


def mass_specific_unit(unit: str) -> str:
    """Return a unit over kilograms to the power in which it holds mass or force: ``kg m^2/s`` -> ``m^2/s``."""
    powers = dict(_powers(unit))
    mass = powers.get("kg", 0.0) + powers.get("N", 0.0)
    if not mass:
        return unit
    powers["kg"] = powers.get("kg", 0.0) - mass
    above = [_text(name, power) for name, power in powers.items() if power > 0.0]
    below = [_text(name, -power) for name, power in powers.items() if power < 0.0]
    if not below:
        return " ".join(above) or "1"
    divisor = below[0] if len(below) == 1 else f"({' '.join(below)})"
    return f"{' '.join(above) or '1'}/{divisor}"


def _powers(unit: str) -> Iterator[tuple[str, float]]:
    """Symbols of a unit with their powers, those below the line negative."""
    for sign, part in zip((1.0, -1.0), unit.split("/"), strict=False):
        for factor in _FACTOR.finditer(part):
            yield factor["name"], sign * float(factor["power"] or 1.0)


def _text(name: str, power: float) -> str:
    return name if power == 1.0 else f"{name}^{power:g}"


# Chapters on the model and the method: equations with their sources, how the estimate came about, references.

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


def _attempts_figure(fit: Fit) -> str:
    from seatrial.reporting.figures.search_charts import attempts_chart

    return svg(attempts_chart(fit.search_attempts))


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
    attempts = (Picture(lambda: _attempts_figure(fit), _ATTEMPTS),) if fit.search_attempts else ()
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
