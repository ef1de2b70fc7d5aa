"""The page of a fit: one self-contained HTML file with style and figures; nothing is fetched or fitted."""

from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup

from seatrial.core.figures.heat_map import heat_map
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit
from seatrial.core.results.fit_charts import coefficients_chart
from seatrial.core.text.numbers import duration, significant
from seatrial.core.text.words import common_prefix
from seatrial.core.values.arrays import correlation_matrix
from seatrial.reporting import (
    ahead,
    baselines,
    identifiability_chapter,
    published_chapter,
    roll_chapter,
    runs,
    seakeeping_chapter,
    summary,
    tables,
    thruster_chapter,
)
from seatrial.reporting.citations import Citations
from seatrial.reporting.correlations import correlation_text
from seatrial.reporting.figures.record_charts import channel_overview, track_overview
from seatrial.reporting.figures.residual_charts import residual_chart
from seatrial.reporting.figures.search_charts import attempts_chart
from seatrial.reporting.mathml import inline, pieces

if TYPE_CHECKING:
    from jinja2 import Environment

TITLES = {
    "answer": "Summary",
    "published": "The published method and the package’s own estimate",
    "identifiability": "Identifiability: what the records determine",
    "records": "Records",
    "findings": "Findings",
    "coefficients": "Coefficients",
    "rolling": "Roll: period, damping, metacentric height",
    "thrusters": "The craft: speed, turn, stop, thrust, matrices",
    "prediction": "Prediction of held-out runs",
    "training": "Fit of the training runs",
    "ahead": "Prediction some samples ahead",
    "frequency": "Frequency response: records and model",
    "baselines": "Other estimators on the same records",
    "residuals": "Residuals",
    "waves": "Motions in waves",
    "offsets": "Offsets",
    "standards": "IMO standards",
    "model": "Equations of the model",
    "fixed": "Fixed values and priors",
    "method": "Method and provenance",
}


def html(fit: Fit) -> str:
    """Return the page as text."""
    citations = Citations()
    length = fit.ship.length if "L" in fit.ship.particulars else 0.0
    identifiability, seakeeping, comparison = (
        identifiability_chapter.identifiability_chapter(fit),
        fit.seakeeping,
        baselines.baseline_chapter(fit),
    )
    has_thrusters = bool(fit.model.equations.layout)
    is_steered = "psi" in fit.model.states or "delta" in fit.model.input_names
    has_content = {
        "published": fit.reference is not None,
        "identifiability": bool(identifiability),
        "rolling": fit.roll is not None,
        "thrusters": fit.thruster_craft is not None,
        "waves": seakeeping is not None,
        "standards": is_steered and not has_thrusters,  # they are for ships of 100 m and more
        "training": bool(fit.predictions),
        "ahead": bool(fit.k_step_errors),
        "frequency": bool(fit.frequency_responses),
        "residuals": bool(fit.residuals),
        "baselines": comparison is not None,
    }
    context: dict[str, object] = {
        "fit": fit,
        "titles": {key: title for key, title in TITLES.items() if has_content.get(key, True)},
        "is_steered": is_steered,
        "waves": None
        if seakeeping is None
        else {"tables": seakeeping_chapter.tables(seakeeping), "figures": seakeeping_chapter.figures(seakeeping)},
        "rolling": None
        if fit.roll is None
        else {"tables": roll_chapter.tables(fit.roll, fit.ship.scale), "figures": roll_chapter.figures(fit.roll)},
        "craft": thruster_chapter.thruster_chapter(fit.thruster_craft),
        "published": published_chapter.published_chapter(fit),
        "identifiability": identifiability,
        "baselines": comparison,
        "answer": summary.sentences(fit),
        "facts": summary.facts(fit),
        "scores": runs.score_table(fit.predictions, 0.0 if has_thrusters else length),
        "records": tables.records(fit),
        "without": _prefix_note(fit),
        "tracks": Markup(svg(track_overview(fit.records, length))),
        "channels": [Markup(svg(chart)) for chart in channel_overview(fit.records)],
        "findings": tables.finding_groups(fit.findings),
        "equations": tables.equations(fit.model, citations),
        "sign_conventions": tables.sign_conventions(fit.model),
        "coefficients": tables.coefficients(fit.coefficients),
        "has_intervals": any(c.lower is not None for c in fit.coefficients if not c.fixed),
        "has_truth": any(c.truth is not None for c in fit.coefficients if not c.fixed),
        "has_meaning": any(c.meaning for c in fit.coefficients if not c.fixed),
        "has_prior": any(c.prior_mean is not None for c in fit.coefficients if not c.fixed),
        "forest": Markup(svg(coefficients_chart(fit.coefficients))),
        "correlation": Markup(_correlation_figure(fit)),
        "correlated": correlation_text(fit.model.parameters.free_names, fit.covariance),
        "runs": runs.run_sections(fit.predictions, length, fit.model.input_names),
        "ahead": ahead.k_step_chapter(fit),
        "frequency": ahead.frequency_chapter(fit),
        "noise": tables.noise(fit.channel_noise),
        "whiteness": Markup(svg(residual_chart(fit.residuals))),
        "offsets": tables.offsets(fit.offsets),
        "standards": runs.standards(fit.predictions, length, fit.ship.scale),
        "fixed": tables.fixed_parameters(fit.coefficients, citations),
        "priors": tables.priors(fit.coefficients, fit.model, citations),
        "ship_source": citations.mark(fit.ship.source),
        "settings": tables.settings(fit.method),
        "attempts": Markup(svg(attempts_chart(fit.search_attempts))),
        "citations": citations,
    }
    return environment().get_template("report.html").render(context)


def _prefix_note(fit: Fit) -> str:
    prefix = common_prefix([r.name for r in fit.records])
    return f" Names without their common beginning, {prefix}" if prefix else ""


def _correlation_figure(fit: Fit) -> str:
    """The lower triangle of the correlations; empty for fewer than two free coefficients."""
    names = fit.model.parameters.free_names
    if len(names) < 2 or fit.covariance.shape != (len(names), len(names)):
        return ""
    below = correlation_matrix(fit.covariance)[1:, :-1]
    return svg(heat_map("correlations of the free coefficients", names[1:], names[:-1], below, is_lower=True))


@cache
def environment() -> "Environment":
    """Return the templates with everything escaped by default, and the filters they use."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from seatrial.reporting.compiled_templates import CompiledTemplates

    templates = Environment(
        loader=PackageLoader("seatrial.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        bytecode_cache=CompiledTemplates(),
    )
    templates.filters["duration"] = duration
    templates.filters["significant"] = significant
    templates.filters["math"] = lambda latex: Markup(inline(latex))
    templates.filters["breakable"] = lambda latex: Markup("".join(pieces(latex)))
    return templates
